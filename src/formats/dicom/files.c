/* formats/dicom/files.c - selects the files of a volume: one file with those of
 * its series beside it, or all of a folder, of which one series is chosen.
 *
 * A folder is one level deep.  Files that are not DICOM, and those without an
 * image (reports, indices), are ignored.  A damaged file, or one named like
 * DICOM, is not ignored, as it may be a slice. */
#include "formats/dicom/dicom.h"

#include <stdio.h>
#include <string.h>

/* Enough bytes to recognise DICOM. */
#define PROBE_BYTES 4096

/* The size of the smallest DICOM file: the bytes before the mark, and the
 * mark. */
#define HEAD_BYTES 132

/* DICOMDIR, which lists the files of a disk, is no image. */
static bool is_directory(const unsigned char *bytes, size_t size) {
    static const char class_of[] = "1.2.840.10008.1.3.10";
    for (size_t at = HEAD_BYTES; at + sizeof class_of <= size && at < 512; at++)
        if (!memcmp(bytes + at, class_of, sizeof class_of - 1))
            return true;
    return false;
}

/* Opens a file and reads its first bytes; *got is 0 if there are none. */
static snow_status probe(snow_context *context, const char *path, bool *is,
                         size_t *got) {
    unsigned char bytes[PROBE_BYTES];
    snow_source *source;
    *is = false;
    *got = 0;
    SNOW_TRY(snow_source_open(context, path, &source));
    snow_status status = snow_source_peek(source, bytes, sizeof bytes, got);
    *is = status == SNOW_STATUS_OK && snow_dicom_probe(bytes, *got) &&
          !is_directory(bytes, *got);
    snow_source_close(source);
    return status;
}

bool snow_dicom_among(snow_context *context, const snow_folder *files,
                      snow_format_finder *find) {
    for (size_t i = 0; i < files->count; i++) {
        const snow_format *format = find(files->paths[i]);
        bool is;
        size_t got;
        if ((!format || format == &snow_format_dicom) &&
            probe(context, files->paths[i], &is, &got) == SNOW_STATUS_OK && is)
            return true;
    }
    return false;
}

/* The most series that a note lists; a disk can have hundreds. */
#define MOST_LISTED 12

typedef struct collection {
    snow_context *context;
    dicom_image **images; /* one block each: frames point to them */
    size_t image_count;
    dicom_frame *frames;
    size_t frame_count;
    snow_seekable *store; /* of the given file; NULL: none */
    bool gaps;            /* slices may be missing or cut */
    size_t copies;        /* files with the same image as another */
    size_t twins;         /* files with its UID, but another image */
    size_t scraps;     /* files too short for DICOM that may have been slices */
    const char *scrap; /* the first of them */
} collection;

static void free_collection(collection *c) {
    for (size_t i = 0; i < c->image_count; i++)
        snow_release(c->context, c->images[i]);
    snow_release(c->context, c->images);
    snow_release(c->context, c->frames);
}

/* Whether a file before has the same image; UIDs are not always unique. */
static snow_status find_copy(collection *c, dicom_reader *reader,
                             dicom_image *image, bool *found) {
    dicom_frame frame;
    bool twin = false;
    *found = false;
    for (size_t i = 0; i < c->image_count && *image->instance && !*found; i++) {
        dicom_image *other = c->images[i];
        if (strcmp(other->instance, image->instance) != 0)
            continue;
        if (!twin)
            snow_dicom_read_frame(reader, image, 0, &frame);
        twin = true;
        SNOW_TRY(snow_dicom_is_copy(reader, c->store, image, &frame, other,
                                    &c->frames[other->first], found));
    }
    c->copies += *found;
    c->twins += twin && !*found;
    return SNOW_STATUS_OK;
}

/* If `series` is given, images of others are left out. */
static snow_status add_image(collection *c, dicom_reader *reader, char *path,
                             const char *series) {
    bool copy;
    dicom_image image;
    if (reader->cut && (!c->gaps || !path))
        return SNOW_STATUS_BAD_INPUT; /* the message is there */
    SNOW_TRY(snow_dicom_read_image(c->context, reader, &image));
    if (!image.rows || (series && strcmp(image.series, series) != 0))
        return SNOW_STATUS_OK;
    image.path = path;
    SNOW_TRY(find_copy(c, reader, &image, &copy));
    if (copy)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(c->context, c->images, c->image_count,
                          c->image_count + 1));
    dicom_image *kept = snow_allocate(c->context, sizeof *kept);
    if (!kept)
        return SNOW_STATUS_NO_MEMORY;
    *kept = image;
    c->images[c->image_count++] = kept;
    bool lost = reader->cut;
    size_t first = kept->first = c->frame_count;
    if (c->gaps && path)
        SNOW_TRY(snow_dicom_find_cut(reader, kept, &lost));
    for (int64_t n = 0; n < kept->slices; n++) {
        SNOW_TRY(SNOW_RESERVE(c->context, c->frames, c->frame_count,
                              c->frame_count + 1));
        snow_dicom_read_frame(reader, kept, n, &c->frames[c->frame_count++]);
    }
    for (size_t i = first; i < c->frame_count; i++)
        c->frames[i].lost = lost;
    return SNOW_STATUS_OK;
}

/* A path of NULL is the given file. */
static snow_status add_path(collection *c, char *path, const char *series) {
    dicom_reader reader;
    snow_status status =
        snow_dicom_open(c->context, path, c->store, NULL, &reader);
    if (status == SNOW_STATUS_OK) {
        status = add_image(c, &reader, path, series);
        snow_dicom_close(&reader);
    }
    if (status != SNOW_STATUS_OK && path)
        snow_fail_in_file(c->context, status, path);
    return status;
}

/* A file that is not DICOM, perhaps truncated, or damaged.  One that cannot be
 * opened or read ends all in any case (io/lookup.h). */
static snow_status add_scrap(collection *c, const char *path,
                             snow_status status, size_t bytes) {
    bool named = snow_format_has_name(&snow_format_dicom, path);
    if (status == SNOW_STATUS_OK && named)
        status =
            snow_fail(c->context, SNOW_STATUS_BAD_INPUT,
                      "is named like DICOM but is not; it may be a truncated "
                      "slice: get it again, or remove it from the folder");
    if (status == SNOW_STATUS_NO_MEMORY || named) {
        snow_fail_in_file(c->context, status, path);
        return status;
    }
    /* Its name may be that of a slice: "IM_0004", "1.2.840.4", "4.dcm". */
    const char *dot = strrchr(snow_path_name(path), '.');
    const bool may_be = !dot || (dot[1] >= '0' && dot[1] <= '9');
    if ((status != SNOW_STATUS_OK || bytes < HEAD_BYTES) && may_be &&
        !c->scraps++)
        c->scrap = snow_path_name(path);
    return SNOW_STATUS_OK;
}

/* Adds the images of a file, if there are any.  One that cannot be read is left
 * out where slices may be missing. */
static snow_status add_file(collection *c, char *path, const char *series) {
    bool is;
    size_t bytes;
    snow_status status = probe(c->context, path, &is, &bytes);
    status = is ? add_path(c, path, series) : add_scrap(c, path, status, bytes);
    if (c->gaps)
        snow_lookup_begin(c->context);
    if (!c->gaps || status != SNOW_STATUS_BAD_INPUT)
        return status;
    snow_notify(c->context, "%.200s; it is left out",
                snow_context_message(c->context));
    return SNOW_STATUS_OK;
}

static void warn_scraps(const collection *c) {
    if (c->twins)
        snow_notify(c->context,
                    "%zu file%s the SOP instance UID of another but not its "
                    "image, as some programs that remove names leave it; all "
                    "are used",
                    c->twins, c->twins > 1 ? "s have" : " has");
    if (c->scraps)
        snow_notify(
            c->context,
            "%zu file%s beside the images (%.60s%s) cannot be read or %s too "
            "short to be DICOM; slices of the volume may be missing",
            c->scraps, c->scraps > 1 ? "s" : "", c->scrap,
            c->scraps > 1 ? ", ..." : "", c->scraps > 1 ? "are" : "is");
}

/* --- choice --------------------------------------------------------------- */

/* The frames of the collection in groups. */
typedef struct choice {
    collection *c;
    dicom_group *groups;
    size_t count;
} choice;

static const dicom_image *image_of(const choice *all, size_t index) {
    return all->c->frames[all->groups[index].first].image;
}

/* One line: "0: CT 512x512, 20 images "Thorax 1.0"; 1: MR ...". */
static void list_series(const choice *all, size_t taken, char *out,
                        size_t capacity) {
    size_t used = 0;
    for (size_t i = 0; i < all->count && used < capacity; i++) {
        const dicom_image *image = image_of(all, i);
        const bool named = *image->description;
        if (i == MOST_LISTED) {
            snprintf(out + used, capacity - used, ", and %zu more",
                     all->count - i);
            return;
        }
        used += (size_t)snprintf(
            out + used, capacity - used,
            "%s%zu: %s%s%lldx%lld, %zu image%s%s%s%s%s",
            i ? "; " : "", i, image->modality, *image->modality ? " " : "",
            (long long)snow_dicom_columns(image),
            (long long)snow_dicom_rows(image), all->groups[i].count,
            all->groups[i].count > 1 ? "s" : "", named ? " \"" : "",
            image->description, named ? "\"" : "",
            i == taken ? " (taken)" : "");
    }
}

/* Parses an index below `count`; a UID has points in it. */
static bool is_index(const char *text, size_t count, size_t *out) {
    int64_t value;
    if (strchr(text, '.') || !snow_parse_int64(text, &value) || value < 0 ||
        (uint64_t)value >= count)
        return false;
    *out = (size_t)value;
    return true;
}

/* The group that a folder is opened for, of those that `series` allows, a UID
 * or NULL: the largest, of segmentations only where there are no other images;
 * `count` if none is allowed. */
static size_t best_group(const choice *all, const char *series) {
    size_t best = all->count, most = 0;
    for (size_t i = 0; i < all->count; i++) {
        const dicom_image *image = image_of(all, i);
        size_t rank =
            all->groups[i].count + (image->segments ? 0 : all->c->frame_count);
        if ((series && strcmp(image->series, series) != 0) || rank <= most)
            continue;
        best = i;
        most = rank;
    }
    return best;
}

static snow_status choose_group(const choice *all, const char *series,
                                size_t *out) {
    char text[1024];
    size_t taken = all->count;
    if (!series || !is_index(series, all->count, &taken))
        taken = best_group(all, series);
    list_series(all, taken, text, sizeof text);
    if (taken == all->count)
        return snow_fail(all->c->context, SNOW_STATUS_BAD_USAGE,
                         "--series %.64s: there is no such series; it has %zu: "
                         "%s",
                         series, all->count, text);
    if (all->count > 1 && !series)
        snow_notify(all->c->context,
                    "the input has %zu series of images: %s; --series selects "
                    "another by its number or UID",
                    all->count, text);
    *out = taken;
    return SNOW_STATUS_OK;
}

/* Makes the volume of the selected group. */
static snow_status read_chosen(collection *c, snow_seekable *store,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    size_t taken = 0;
    const dicom_input input = {c->context, store, c->images, c->image_count};
    choice all = {.c = c};
    all.groups =
        snow_allocate_array(c->context, c->frame_count, sizeof *all.groups);
    if (!all.groups)
        return SNOW_STATUS_NO_MEMORY;
    all.count = snow_dicom_group(c->frames, c->frame_count, all.groups);
    if (!options->series && all.count == c->frame_count &&
        snow_dicom_join(c->context, c->frames, all.count)) {
        all.groups[0].count = all.count;
        all.count = 1;
    }
    snow_status status = choose_group(&all, options->series, &taken);
    dicom_stack stack;
    if (status == SNOW_STATUS_OK)
        status =
            snow_dicom_stack(c->context, c->frames + all.groups[taken].first,
                             all.groups[taken].count, c->gaps, &stack);
    if (status == SNOW_STATUS_OK) {
        status = (stack.frames->image->segments ? snow_dicom_read_segments
                                                : snow_dicom_read_stack)(
            &input, &stack, options, info, out);
        snow_dicom_stack_free(&stack);
    }
    snow_release(c->context, all.groups);
    return status;
}

snow_status snow_dicom_read_files(snow_context *context, snow_folder *files,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out) {
    collection c = {.context = context, .gaps = options->allow_gaps};
    snow_status status = SNOW_STATUS_OK;
    if (c.gaps) /* each file is looked at again */
        snow_lookup_begin(context);
    for (size_t i = 0; i < files->count && status == SNOW_STATUS_OK; i++) {
        snow_monitor_report(context->monitor, SNOW_STAGE_READ, (double)i,
                            (double)files->count * DICOM_HEADER_SHARE);
        status = add_file(&c, files->paths[i], NULL);
    }
    if (status == SNOW_STATUS_OK)
        warn_scraps(&c);
    if (status == SNOW_STATUS_OK && !c.frame_count)
        status = snow_fail(context, SNOW_STATUS_BAD_INPUT,
                           "its DICOM files have no images; subfolders are not "
                           "read, so name the one with the images");
    if (status == SNOW_STATUS_OK && c.copies)
        snow_notify(context,
                    "%zu file%s with the same image as another file %s ignored",
                    c.copies, c.copies > 1 ? "s" : "",
                    c.copies > 1 ? "are" : "is");
    if (status == SNOW_STATUS_OK)
        status = read_chosen(&c, NULL, options, info, out);
    free_collection(&c);
    return status;
}

/* --- one file ------------------------------------------------------------- */

/* Lists the files of the folder that a path is in, including itself. */
static snow_status list_siblings(snow_context *context, const char *path,
                                 snow_folder *out) {
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    char *folder = snow_allocate_clear(context, length + 2);
    if (!folder)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(folder, slash ? path : ".", slash ? length : 1);
    snow_status status = snow_folder_list(context, folder, out);
    snow_release(context, folder);
    return status;
}

/* Returns whether two names have the same suffix, as ".dcm" and ".DCM", or both
 * have none.  A number after the last point is not a suffix. */
static bool ends_alike(const char *a, const char *b) {
    const char *x = strrchr(snow_path_name(a), '.');
    const char *y = strrchr(snow_path_name(b), '.');
    const bool plain_x = !x || (x[1] >= '0' && x[1] <= '9');
    const bool plain_y = !y || (y[1] >= '0' && y[1] <= '9');
    return plain_x || plain_y ? plain_x && plain_y : snow_has_suffix(b, x);
}

/* Adds the images of the same series in the folder, except the given file,
 * which is there already.  One that is damaged may be a slice, and one that
 * cannot be opened is no reason to refuse if it is named unlike a slice of this
 * series; a warning reports them. */
static snow_status add_siblings(collection *c, const char *path,
                                snow_folder *files) {
    const char *series = c->images[0]->series;
    const char *first = NULL;
    size_t unread = 0;
    for (size_t i = 0; i < files->count; i++) {
        char *file = files->paths[i];
        if (strcmp(snow_path_name(file), snow_path_name(path)) == 0)
            continue;
        const bool whole = !*c->context->lost;
        snow_status status = add_file(c, file, series);
        if (status == SNOW_STATUS_NO_MEMORY)
            return status;
        const bool lost = whole && *c->context->lost && !ends_alike(path, file);
        if (lost)
            snow_lookup_begin(c->context);
        if ((lost || status != SNOW_STATUS_OK) && !unread++)
            first = snow_path_name(file);
    }
    if (unread)
        snow_notify(c->context,
                    "%zu file%s beside it cannot be read (%.60s%s); slices of "
                    "the volume may be missing",
                    unread, unread > 1 ? "s" : "", first,
                    unread > 1 ? ", ..." : "");
    warn_scraps(c);
    return SNOW_STATUS_OK;
}

/* Keeps the time of a stack that contains the given file; returns false if
 * none does. */
static bool keep_its_time(dicom_stack *stack, dicom_frame *frames) {
    size_t times = stack->times, count = stack->places * times, time = times;
    for (size_t i = 0; i < count; i++)
        if (!frames[i].image->path)
            time = i % times;
    if (time == times)
        return false;
    for (size_t i = 0; i < stack->places; i++)
        frames[i] = frames[i * times + time];
    stack->times = 1;
    return true;
}

/* *made: the frames of the folder's files form one volume with the given
 * one. */
static snow_status gather_stack(collection *c, dicom_stack *out, bool *made) {
    dicom_group *groups =
        snow_allocate_array(c->context, c->frame_count, sizeof *groups);
    if (!groups)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = SNOW_STATUS_OK;
    size_t count = snow_dicom_group(c->frames, c->frame_count, groups);
    *made = false;
    for (size_t i = 0; i < count && !*made && status != SNOW_STATUS_NO_MEMORY;
         i++) {
        dicom_frame *frames = c->frames + groups[i].first;
        status =
            snow_dicom_stack(c->context, frames, groups[i].count, c->gaps, out);
        if (status != SNOW_STATUS_OK)
            continue;
        *made = keep_its_time(out, frames);
        if (!*made)
            snow_dicom_stack_free(out);
    }
    snow_release(c->context, groups);
    return status == SNOW_STATUS_NO_MEMORY ? status : SNOW_STATUS_OK;
}

/* Reads the volume that a slice belongs to.  *done is false if there is none,
 * and the slice is shown alone. */
static snow_status read_with_siblings(collection *c, snow_source *source,
                                      snow_seekable *store,
                                      const snow_volume_options *options,
                                      snow_volume_info *info, snow_volume **out,
                                      bool *done) {
    const dicom_frame alone = c->frames[0];
    snow_folder files;
    dicom_stack stack;
    bool made = false;
    const char *path = snow_source_name(source);
    SNOW_TRY(list_siblings(c->context, path, &files));
    snow_status status = add_siblings(c, path, &files);
    const dicom_input input = {c->context, store, c->images, c->image_count};
    if (status == SNOW_STATUS_OK && c->frame_count > 1)
        status = gather_stack(c, &stack, &made);
    *done = false;
    if (made) {
        *done = stack.places > 1;
        if (*done) {
            snow_notify(
                c->context,
                "is one of %zu slices of a series in its folder; all are used",
                stack.places);
            status = snow_dicom_read_stack(&input, &stack, options, info, out);
        }
        snow_dicom_stack_free(&stack);
    } else if (status == SNOW_STATUS_OK && c->frame_count > 1) {
        snow_notify(c->context,
                    "is used alone: the slices of its series in its folder do "
                    "not form a volume; open the folder to see why");
    }
    c->frames[0] = alone;
    c->frame_count = 1;
    snow_folder_free(&files);
    return status;
}

static snow_status read_dicom(snow_source *source,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    collection c = {.context = context, .gaps = options->allow_gaps};
    snow_seekable *store;
    SNOW_TRY(snow_seekable_open(source, &store));
    c.store = store;
    bool done = false;
    snow_status status = add_path(&c, NULL, NULL);
    if (status == SNOW_STATUS_OK && !c.frame_count)
        status = snow_fail(context, SNOW_STATUS_BAD_INPUT,
                           "is a DICOM file without an image; open one with "
                           "an image, or their folder");
    if (status == SNOW_STATUS_OK && c.frame_count == 1 && c.frames[0].placed &&
        *c.images[0]->series && !c.images[0]->segments &&
        snow_source_has_siblings(source))
        status =
            read_with_siblings(&c, source, store, options, info, out, &done);
    if (status == SNOW_STATUS_OK && !done)
        status = read_chosen(&c, store, options, info, out);
    free_collection(&c);
    snow_seekable_close(store);
    return status;
}

const snow_format snow_format_dicom = {
    .name = "dicom",
    .text = "DICOM: a folder, a slice of a series, frames in one file (.dcm)",
    .suffixes = {".dcm", ".dcm.gz", ".dicom", ".ima"},
    .probe = snow_dicom_probe,
    .crops = true,
    .series = true,
    .channels = true,
    .read = read_dicom,
};
