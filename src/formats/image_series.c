/* formats/image_series.c - reads a folder or a pattern of files with one slice
 * each.
 *
 * The files' own reader makes a volume of one slice from each, cropped in x and
 * y; these are stacked.  Files outside the box along z are not opened.  A
 * missing number among the names is a missing slice, and refused.  If any file
 * is DICOM, formats/dicom/files.c reads them. */
#include "formats/dicom/dicom.h"
#include "formats/opening.h"
#include "io/folder.h"

#include <stdio.h>
#include <string.h>

/* What all files have in common, from the first file. */
typedef struct stack {
    snow_context *context;
    snow_format_finder *find;
    const snow_format *format;
    const snow_folder *files;    /* the files of the format, in order */
    snow_volume_options options; /* options for a slice */
    snow_volume_info first;      /* the first slice, uncropped */
    snow_volume_info slice;      /* of each slice */
    bool cropped;                /* slices are read in part */
} stack;

/* The format of the file's name, if its files are slices; a companion, which
 * describes other files, is not. */
static const snow_format *slice_format(const stack *s, const char *path) {
    const snow_format *format = s->find(path);
    return format && format->slices && !snow_has_suffix(path, SNOW_COMPANION)
               ? format
               : NULL;
}

/* Returns whether any file is a slice, or one that cannot be a preview. */
static bool holds_any(const stack *s, const snow_folder *files, bool previews) {
    for (size_t i = 0; i < files->count; i++) {
        const snow_format *format = slice_format(s, files->paths[i]);
        if (format && (previews || !format->previews))
            return true;
    }
    return false;
}

/* Keeps the files whose names belong to slices: folders also hold notes and
 * tables, and previews beside the slices.  All must have one format. */
static snow_status choose_files(stack *s, const char *path,
                                snow_folder *files) {
    size_t kept = 0, others = 0;
    bool previews = holds_any(s, files, false);
    for (size_t i = 0; i < files->count; i++) {
        const snow_format *format = slice_format(s, files->paths[i]);
        if (!format || (previews && format->previews))
            continue;
        if (!s->format)
            s->format = format;
        if (format == s->format)
            files->paths[kept++] = files->paths[i];
        else
            others++;
    }
    if (others)
        return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                         "has %zu files of %s among others; give a pattern "
                         "that matches one kind, such as \"folder/*.tif\"",
                         kept, s->format->name);
    if (!kept) {
        char name[256];
        if (snow_is_folder(s->context, path) &&
            snow_folder_below(path, name, sizeof name))
            return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                             "has no slices itself, only folders such as %s; "
                             "name one of them",
                             name);
        return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                         "names no slices; give a folder or a pattern of .tif, "
                         ".png, .jpg or DICOM files");
    }
    files->count = kept;
    s->files = files;
    return SNOW_STATUS_OK;
}

#define DIGITS "0123456789"

/* Returns whether two names differ in their numbers only. */
static bool same_form(const char *a, const char *b) {
    for (;; a++, b++) {
        const size_t x = strspn(a, DIGITS), y = strspn(b, DIGITS);
        if (!x != !y || a[x] != b[y])
            return false;
        a += x;
        b += y;
        if (!*a)
            return true;
    }
}

/* Number `which` of a name, from 0; -1 if there is none. */
static int64_t number_at(const char *path, int which) {
    const char *at = snow_path_name(path);
    for (at += strcspn(at, DIGITS); *at && which; which--) {
        at += strspn(at, DIGITS);
        at += strcspn(at, DIGITS);
    }
    int64_t value = *at ? 0 : -1;
    for (; *at >= '0' && *at <= '9'; at++)
        value = (value * 10 + (*at - '0')) % 1000000000000000000;
    return value;
}

/* A name of the form that most names with a number have, if there is one, by
 * the votes of Boyer and Moore (1981). */
static const char *usual_form(const snow_folder *files, size_t *numbered) {
    const char *best = NULL;
    size_t votes = 0;
    *numbered = 0;
    for (size_t i = 0; i < files->count; i++) {
        const char *name = snow_path_name(files->paths[i]);
        if (!name[strcspn(name, DIGITS)])
            continue;
        ++*numbered;
        if (!votes)
            best = name;
        votes = same_form(best, name) ? votes + 1 : votes - 1;
    }
    return best;
}

/* Keeps names with a number, as previews and masks beside slices have none; a
 * second name with one is a second stack. */
static snow_status choose_names(stack *s, snow_folder *files) {
    size_t numbered, count = 0, kept = 0, left = 0;
    char list[160] = "";
    const char *form = usual_form(files, &numbered);
    if (2 * numbered <= files->count) /* letters may be the order */
        return SNOW_STATUS_OK;
    for (size_t i = 0; i < files->count; i++)
        count += same_form(form, snow_path_name(files->paths[i]));
    for (size_t i = 0; i < files->count; i++) {
        const char *name = snow_path_name(files->paths[i]);
        const bool has = name[strcspn(name, DIGITS)] != 0;
        if (has && 2 * count >= numbered && !same_form(form, name))
            return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                             "%s has a number, but is not named as the other "
                             "slices, such as %s; give a pattern of one name",
                             name, form);
        if (has) {
            files->paths[kept++] = files->paths[i];
            continue;
        }
        if (left++ < 3)
            snow_append(list, sizeof list, "%s%.48s", *list ? ", " : "", name);
    }
    files->count = kept;
    if (left)
        snow_notify(s->context, "%zu file%s without a number %s left out: %s%s",
                    left, left > 1 ? "s" : "", left > 1 ? "are" : "is", list,
                    left > 3 ? ", ..." : "");
    return SNOW_STATUS_OK;
}

/* Numbers may begin anywhere, but one of each name must have equal steps. */
static snow_status check_numbers(const stack *s) {
    char *const *paths = s->files->paths;
    size_t uneven = 1;
    bool any = false;
    for (int which = 0; s->files->count > 1; which++) {
        int64_t before = number_at(paths[0], which);
        const int64_t step = number_at(paths[1], which) - before;
        bool all = before >= 0, varies = false;
        size_t at = 0; /* the first that is no such step after that before it */
        for (size_t i = 1; i < s->files->count && all; i++) {
            const int64_t number = number_at(paths[i], which);
            all = number >= 0;
            varies |= number != before;
            if (!at && number - before != step)
                at = i;
            before = number;
        }
        if (!all)
            break;
        if (!at && varies)
            return SNOW_STATUS_OK;
        uneven = at ? at : uneven;
        any = true;
    }
    if (!any) /* names without numbers have no gaps */
        return SNOW_STATUS_OK;
    return snow_fail(
        s->context, SNOW_STATUS_BAD_INPUT,
        "its files are not numbered in equal steps (%s, then %s); add "
        "the missing slices, or give a pattern that matches the others",
        paths[uneven - 1], paths[uneven]);
}

/* Opens a file; messages begin with its name. */
static snow_status read_file(const stack *s, size_t index,
                             snow_volume_info *info, snow_volume **out) {
    snow_source *source;
    SNOW_TRY(snow_source_open(s->context, s->files->paths[index], &source));
    snow_status status = s->format->read(source, &s->options, info, out);
    if (status != SNOW_STATUS_OK)
        snow_fail_in_file(s->context, status, snow_source_name(source));
    snow_source_close(source);
    return status;
}

static snow_status compare(const stack *s, size_t index,
                           const snow_volume_info *info,
                           const snow_volume_info *other) {
    const snow_volume_info *first = &s->first;
    if (info->type == other->type &&
        memcmp(info->dims, other->dims, sizeof info->dims) == 0)
        return SNOW_STATUS_OK;
    return snow_fail(
        s->context, SNOW_STATUS_BAD_INPUT,
        "%s: has %lldx%lldx%lld voxels of %s, but the first slice has "
        "%lldx%lldx%lld of %s; all slices of a volume must be alike",
        s->files->paths[index], (long long)info->dims[0],
        (long long)info->dims[1], (long long)info->dims[2],
        snow_type_name(info->type), (long long)first->dims[0],
        (long long)first->dims[1], (long long)first->dims[2],
        snow_type_name(first->type));
}

/* Looks at a whole file: a box may lie in two of different sizes. */
static snow_status look(const stack *s, size_t index, snow_volume_info *info) {
    stack whole = *s;
    memset(whole.options.crop, 0, sizeof whole.options.crop);
    return read_file(&whole, index, info, NULL);
}

static snow_status read_slice(const stack *s, size_t index, snow_volume **out) {
    snow_volume_info info;
    if (s->cropped) {
        SNOW_TRY(look(s, index, &info));
        SNOW_TRY(compare(s, index, &info, &s->first));
    }
    SNOW_TRY(read_file(s, index, &info, out));
    return compare(s, index, &info, &s->slice);
}

/* A file with several slices would be a volume of its own, perhaps a time
 * step. */
static snow_status look_at_first(stack *s) {
    SNOW_TRY(read_file(s, 0, &s->first, NULL));
    s->slice = s->first;
    if (s->first.dims[2] == 1 && s->first.times == 1) {
        double pixel = s->first.matrix[0][0];
        if (pixel != 1 && s->first.matrix[2][2] == -pixel &&
            !snow_spacing_given(&s->options))
            snow_notify(s->context, SNOW_WIDTH_IS_DISTANCE, pixel);
        return SNOW_STATUS_OK;
    }
    return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                     "%s: has %lld slices, so it is a volume of its own; open "
                     "one file at a time",
                     s->files->paths[0],
                     (long long)(s->first.dims[2] * s->first.times));
}

/* Warnings are given for the first slice only: each slice has the same. */
static snow_status read_slices(stack *s, int64_t first, snow_volume *volume) {
    size_t bytes = (size_t)(s->slice.dims[0] * s->slice.dims[1]) *
                   snow_type_size(s->slice.type);
    snow_warning_fn *warning = s->context->warning;
    snow_status status = SNOW_STATUS_OK;
    s->context->warning = NULL;
    for (int64_t z = 0; z < volume->info.dims[2] && status == SNOW_STATUS_OK;
         z++) {
        snow_volume *slice = NULL;
        snow_monitor_part whole = snow_monitor_divide(
            s->context->monitor, (double)z, (double)volume->info.dims[2]);
        status = read_slice(s, (size_t)(first + z), &slice);
        snow_monitor_whole(s->context->monitor, whole);
        if (status == SNOW_STATUS_OK)
            memcpy((unsigned char *)volume->owned + (size_t)z * bytes,
                   slice->voxels, bytes);
        snow_volume_close(slice);
    }
    s->context->warning = warning;
    return status;
}

/* Returns whether the first file leads to all others, which are one volume
 * whatever their names. */
static bool is_set(const stack *s) {
    snow_volume_info info;
    size_t files;
    snow_warning_fn *warning = s->context->warning;
    s->context->warning = NULL;
    const bool is = !strcmp(s->format->name, "tiff") &&
                    look(s, 0, &info) == SNOW_STATUS_OK &&
                    sscanf(info.storage, SNOW_SET_OF_FILES, &files) == 1 &&
                    files >= s->files->count;
    s->context->warning = warning;
    return is;
}

/* The box is applied to all slices along z, then each slice is cropped alike.
 * The first slice gives the size for a box without an end. */
static snow_status read_stack(stack *s, snow_folder *files,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_region window;
    if (options->series)
        return snow_fail(
            s->context, SNOW_STATUS_BAD_USAGE,
            "--series %.64s: only DICOM files have series; remove the option",
            options->series);
    s->options = *options;
    if (is_set(s))
        return read_file(s, 0, info, out);
    memset(s->options.crop, 0, sizeof s->options.crop);
    SNOW_TRY(choose_names(s, files));
    SNOW_TRY(check_numbers(s));
    SNOW_TRY(look_at_first(s));
    *info = s->slice;
    info->dims[2] = (int64_t)s->files->count;
    SNOW_TRY(snow_region_lay_out(s->context, options, info, &window));
    if (!out)
        return SNOW_STATUS_OK;
    for (int i = 0; i < 2; i++)
        s->cropped |= window.count[i] != s->first.dims[i];
    for (int i = 0; i < 2 && s->cropped; i++) {
        s->options.crop[i][0] = window.first[i];
        s->options.crop[i][1] = window.first[i] + window.count[i];
        s->slice.dims[i] = window.count[i];
    }
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(s->context, info, &volume));
    return snow_volume_give(read_slices(s, window.first[2], volume), volume,
                            out);
}

/* A folder without slices may hold folders of DICOM files, as disks do, whose
 * files then take the place of its own. */
static snow_status look_below(const stack *s, const char *path,
                              snow_folder *files, bool *found) {
    char name[256];
    snow_folder below;
    if (!snow_folder_below(path, name, sizeof name))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_folder_list_below(s->context, path, &below));
    *found = snow_dicom_among(s->context, &below, s->find);
    if (*found) {
        const snow_folder own = *files;
        *files = below;
        below = own;
        snow_notify(s->context,
                    "the folder has no slices itself; those of the folders "
                    "below it, such as %s, are read",
                    name);
    }
    snow_folder_free(&below);
    return SNOW_STATUS_OK;
}

snow_status snow_stack_read(snow_context *context, const char *path,
                            const snow_volume_options *options,
                            snow_format_finder *find, snow_volume_info *info,
                            snow_volume **out) {
    snow_folder files;
    stack s = {.context = context, .find = find};
    SNOW_TRY(snow_folder_list(context, path, &files));
    snow_status status = SNOW_STATUS_OK;
    bool dicom = snow_dicom_among(context, &files, find);
    if (!dicom && !holds_any(&s, &files, true) && snow_is_folder(context, path))
        status = look_below(&s, path, &files, &dicom);
    if (status != SNOW_STATUS_OK) {
        /* the message is there */
    } else if (dicom) {
        status = snow_dicom_read_files(context, &files, options, info, out);
    } else {
        status = choose_files(&s, path, &files);
        if (status == SNOW_STATUS_OK)
            status = read_stack(&s, &files, options, info, out);
    }
    snow_folder_free(&files);
    return status;
}
