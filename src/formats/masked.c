/* formats/masked.c - a volume and its mask, both from files. */
#include "formats/opening.h"
#include "io/source.h"
#include "volume/clip_planes.h"
#include "volume/mask.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A volume and its mask, on the way to be opened. */
typedef struct opening {
    snow_context *context;
    snow_open_fn *open;
    const char *path;
    const char *mask_path;       /* NULL: planes alone */
    bool stream;                 /* the volume comes as one */
    snow_volume_options options; /* of the volume, without mask */
    snow_volume_options mask;    /* of the mask */
    snow_volume_info grid;       /* of the whole mask */
    bool same;                   /* it has the voxels of the whole volume */
    snow_label_range labels[SNOW_LABELS_MAX];
    size_t count;
    double clip[SNOW_CLIPS_MAX][4];
} opening;

static bool is_cropped(const snow_volume_options *options) {
    static const int64_t none[3][2];
    return memcmp(options->crop, none, sizeof none) != 0;
}

/* What the options say by themselves. */
static snow_status check_options(opening *o,
                                 const snow_volume_options *options) {
    o->options = *options;
    o->options.mask = o->options.labels = NULL;
    memset(o->options.clip, 0, sizeof o->options.clip);
    memcpy(o->clip, options->clip, sizeof o->clip);
    SNOW_TRY(snow_planes_check(o->context, o->clip[0], SNOW_CLIPS_MAX));
    if (!options->mask && !options->labels)
        return SNOW_STATUS_OK;
    if (options->labels && !snow_labels_parse(options->labels, o->labels,
                                              SNOW_LABELS_MAX, &o->count))
        return snow_fail(o->context, SNOW_STATUS_BAD_USAGE,
                         "--labels %.64s: not a list of labels; give up to %d "
                         "whole numbers and ranges, such as 1,4-7",
                         options->labels, SNOW_LABELS_MAX);
    if (!options->mask)
        return SNOW_STATUS_OK;
    o->mask_path = options->mask;
    memcpy(o->mask.spacing, options->spacing, sizeof options->spacing);
    if (snow_source_is_stream(o->mask_path))
        return snow_fail(o->context, SNOW_STATUS_BAD_USAGE,
                         "%s: a mask is read from a file; write it to one",
                         o->mask_path);
    o->stream = snow_source_is_stream(o->path);
    if (o->stream && is_cropped(options))
        return snow_fail(o->context, SNOW_STATUS_BAD_USAGE,
                         "--crop: with a mask both must be files; write the "
                         "volume to one");
    return SNOW_STATUS_OK;
}

/* A header alone, without the warnings that its reading makes too. */
static snow_status look(const opening *o, const char *path,
                        const snow_volume_options *options,
                        snow_volume_info *out) {
    snow_context *context = o->context;
    snow_warning_fn *warning = context->warning;
    context->warning = NULL;
    snow_status status = o->open(context, path, options, out, NULL);
    context->warning = warning;
    return status;
}

/* Options that a file may need are those of the volume. */
static snow_status look_at_mask(opening *o) {
    char why[512];
    snow_status status = look(o, o->mask_path, &o->mask, &o->grid);
    if (status != SNOW_STATUS_BAD_USAGE)
        return status;
    snprintf(why, sizeof why, "%.500s", o->context->message);
    return snow_fail(o->context, status,
                     "%s (not for a mask: snowglass convert makes a .nrrd of "
                     "it)",
                     why);
}

/* Where a volume lies in the world, along its axes: "0..9 x 5..8 x 3..4". */
static void write_box(const snow_volume_info *info, char text[128]) {
    double ends[3][2];
    for (int row = 0; row < 3; row++) {
        ends[row][0] = ends[row][1] = info->matrix[row][3];
        for (int axis = 0; axis < 3; axis++) {
            double way =
                info->matrix[row][axis] * (double)(info->dims[axis] - 1);
            ends[row][way > 0] += way;
        }
    }
    snow_text_print(text, 128, "%.5g..%.5g x %.5g..%.5g x %.5g..%.5g",
                    ends[0][0], ends[0][1], ends[1][0], ends[1][1], ends[2][0],
                    ends[2][1]);
}

/* A mask on another grid is read as far as the box needs it. */
static snow_status crop_mask(opening *o, const snow_volume_info *volume) {
    static const int64_t none[3][2];
    char at[2][128];
    if (snow_volume_box_of(&o->grid, volume, none, o->mask.crop)) {
        snow_volume_box_of(&o->grid, volume,
                           (const int64_t(*)[2])o->options.crop, o->mask.crop);
        return SNOW_STATUS_OK;
    }
    write_box(&o->grid, at[0]);
    write_box(volume, at[1]);
    return snow_fail(o->context, SNOW_STATUS_BAD_INPUT,
                     "%s: the mask lies at %s of the world, and the volume at "
                     "%s: they do not meet; give the mask of this volume",
                     o->mask_path, at[0], at[1]);
}

/* Boxes of two grids are the same box only if the grids are the same, so the
 * whole ones are compared.  A stream is compared when it was read. */
static snow_status look_at_both(opening *o) {
    snow_volume_options whole = o->options;
    snow_volume_info info;
    SNOW_TRY(look_at_mask(o));
    if (o->grid.times > 1)
        o->mask.time = o->options.time;
    if (o->stream)
        return SNOW_STATUS_OK;
    memset(whole.crop, 0, sizeof whole.crop);
    SNOW_TRY(look(o, o->path, &whole, &info));
    snow_status status =
        snow_grids_compare(o->context, &info, &o->grid, "mask", &o->same);
    if (status != SNOW_STATUS_OK)
        return snow_fail_within(o->context, status, "%s", o->mask_path);
    if (!o->same)
        return crop_mask(o, &info);
    memcpy(o->mask.crop, o->options.crop, sizeof o->mask.crop);
    return SNOW_STATUS_OK;
}

/* An empty picture must not pass for one of an empty volume.  A box may be
 * empty, as that of a rank often is; who reads all boxes looks at all. */
static void note_empty(const opening *o, const snow_volume *mask,
                       snow_volume *volume) {
    snow_volume_statistics m = {.size = sizeof m, .min = NAN, .max = NAN};
    snow_volume_options options = o->options;
    options.mask = o->mask_path;
    if (mask)
        snow_volume_get_statistics(mask, &m);
    volume->emptied = true;
    volume->mask_range[0] = m.min;
    volume->mask_range[1] = m.max;
    if (!is_cropped(&options))
        snow_mask_warn(o->context, &options, volume->mask_range);
}

static snow_status leave_out_of(const opening *o, const snow_volume *volume,
                                const snow_volume *mask, snow_volume **out) {
    const snow_cuts by = {
        .mask = mask,
        .labels = o->labels,
        .label_count = o->count,
        .planes = o->clip[0],
        .plane_count = SNOW_CLIPS_MAX,
        .keeps_clipped = !volume->is_part && !o->context->leaves_clipped,
    };
    bool any;
    SNOW_TRY(snow_mask_apply(volume, &by, &any, out));
    if (!any)
        note_empty(o, mask, *out);
    return SNOW_STATUS_OK;
}

/* The boxes of grids without a place have offsets, which look like one. */
static snow_status read_mask(const opening *o, const snow_volume *volume,
                             snow_volume **out) {
    snow_volume_info info;
    snow_volume *mask = NULL, *fitted = NULL;
    if (!o->mask_path)
        return leave_out_of(o, volume, NULL, out);
    SNOW_TRY(o->open(o->context, o->mask_path, &o->mask, &info, &mask));
    if (o->same)
        memcpy(mask->info.matrix, volume->info.matrix, sizeof info.matrix);
    snow_status status =
        snow_volume_resample(mask, volume, true, "mask", &fitted);
    if (status == SNOW_STATUS_OK)
        status = leave_out_of(o, volume, fitted ? fitted : mask, out);
    else
        snow_fail_within(o->context, status, "%s", o->mask_path);
    snow_volume_close(fitted);
    snow_volume_close(mask);
    return status;
}

static snow_status open_both(opening *o, snow_volume_info *info,
                             snow_volume **out) {
    static const double none[SNOW_CLIPS_MAX][4];
    const bool picks = o->count && !o->mask_path;
    /* A mask or planes leave something out, not labels alone. */
    const bool cut = o->mask_path || memcmp(o->clip, none, sizeof none) != 0;
    snow_volume_info whole;
    snow_volume *volume;
    if (o->mask_path)
        SNOW_TRY(look_at_both(o));
    if (!out) {
        SNOW_TRY(o->open(o->context, o->path, &o->options, info, NULL));
        if (picks) /* of the numbers that are there before a cut */
            SNOW_TRY(snow_labels_check(o->context, info));
        if (cut)
            snow_mask_info(info);
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(o->open(o->context, o->path, &o->options, &whole, &volume));
    snow_status status = SNOW_STATUS_OK;
    if (picks)
        status = snow_labels_check(o->context, &whole);
    if (picks && status == SNOW_STATUS_OK &&
        !snow_labels_pick(volume, o->labels, o->count) &&
        !is_cropped(&o->options))
        snow_notify(o->context,
                    "--labels: no voxel has such a label; snowglass info "
                    "lists those that there are");
    if (status == SNOW_STATUS_OK && !cut) {
        *out = volume;
        return SNOW_STATUS_OK;
    }
    if (status == SNOW_STATUS_OK)
        status = read_mask(o, volume, out);
    snow_volume_close(volume);
    return status;
}

snow_status snow_masked_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_open_fn *open, snow_volume_info *info,
                             snow_volume **out) {
    opening *o = snow_allocate_clear(context, sizeof *o);
    if (!o)
        return SNOW_STATUS_NO_MEMORY;
    o->context = context;
    o->open = open;
    o->path = path;
    snow_status status = check_options(o, options);
    if (status == SNOW_STATUS_OK)
        status = open_both(o, info, out);
    snow_release(context, o);
    return status;
}
