/* volume/mask.c - the voxels that a mask and planes leave out.
 *
 * They become NaN, which is no value: histograms do not count it, no transfer
 * function shows it, and no encoding holds it.  So a mask costs nothing after
 * this, it only makes the set of interesting voxels smaller.
 *
 * Invariant: a voxel inside keeps its data value exactly.  The type follows
 * from the native one alone, not from the values, so that all parts of a volume
 * have the same. */
#include "volume/mask.h"

#include "volume/clip_planes.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 1024

/* Beyond it doubles, through which masks are looked at, hold not all. */
#define LABEL_MOST ((INT64_C(1) << 53) - 1)

/* This is a share of the least spacing: files that keep matrices in single
 * precision, or as quaternions, differ by less, and another convention for the
 * middle of a voxel by half. */
#define PLACE_TOLERANCE 0.1

/* --- labels --------------------------------------------------------------- */

/* One whole number; *text goes behind it. */
static bool read_label(const char **text, int64_t *out) {
    const char *digits = *text + (**text == '-');
    char *end;
    if (!isdigit((unsigned char)*digits))
        return false;
    long long value = strtoll(*text, &end, 10); /* at its ends if too large */
    if (value > LABEL_MOST || value < -LABEL_MOST)
        return false;
    *text = end;
    *out = value;
    return true;
}

static bool read_range(const char **text, snow_label_range *out) {
    snow_label_range range;
    if (!read_label(text, &range.first))
        return false;
    range.last = range.first;
    if (**text == '-' || **text == ':') {
        (*text)++;
        if (!read_label(text, &range.last) || range.last < range.first)
            return false;
    }
    *out = range;
    return true;
}

bool snow_labels_parse(const char *text, snow_label_range *ranges,
                       size_t capacity, size_t *count) {
    snow_label_range read[SNOW_LABELS_MAX];
    size_t n = 0;
    if (!text)
        return false;
    do {
        if (n == capacity || n == SNOW_LABELS_MAX ||
            !read_range(&text, &read[n]))
            return false;
        n++;
    } while (*text++ == ',');
    if (text[-1])
        return false;
    memcpy(ranges, read, n * sizeof *ranges);
    *count = n;
    return true;
}

/* --- the grid ------------------------------------------------------------- */

/* Returns whether the file gives a position or directions. A file without them
 * is at 0 along the world's axes, or turned so that an image's rows go down. */
static bool has_place(const snow_volume_info *info) {
    bool given = info->medical;
    bool image = info->matrix[1][1] < 0 && info->matrix[2][2] < 0;
    for (int row = 0; row < 3; row++) {
        given |= info->matrix[row][3] != 0;
        for (int axis = 0; axis < 3; axis++)
            given |= row == axis
                         ? info->matrix[row][axis] < 0 && !(image && row)
                         : info->matrix[row][axis] != 0;
    }
    return given;
}

static void place_of(const snow_volume_info *info, const int64_t at[3],
                     double out[3]) {
    for (int row = 0; row < 3; row++) {
        out[row] = info->matrix[row][3];
        for (int axis = 0; axis < 3; axis++)
            out[row] += info->matrix[row][axis] * (double)at[axis];
    }
}

/* How far apart two matrices put a corner of the grid, at most. */
static double find_difference(const snow_volume_info *a,
                              const snow_volume_info *b) {
    double most = 0;
    for (int n = 0; n < 8; n++) {
        int64_t at[3];
        double p[3], q[3], off = 0;
        for (int axis = 0; axis < 3; axis++)
            at[axis] = (n >> axis) & 1 ? a->dims[axis] - 1 : 0;
        place_of(a, at, p);
        place_of(b, at, q);
        for (int row = 0; row < 3; row++)
            off += (p[row] - q[row]) * (p[row] - q[row]);
        most = fmax(most, off);
    }
    return sqrt(most);
}

/* Worlds of patients and others cannot be compared. */
snow_status snow_grids_compare(snow_context *context,
                               const snow_volume_info *volume,
                               const snow_volume_info *other, const char *what,
                               bool *same) {
    const int64_t *v = volume->dims, *m = other->dims;
    const double *spacing = volume->spacing;
    double least = fmin(fmin(spacing[0], spacing[1]), spacing[2]);
    bool placed = has_place(volume) && has_place(other) &&
                  volume->medical == other->medical;
    *same =
        memcmp(v, m, sizeof volume->dims) == 0 &&
        (!placed || find_difference(volume, other) <= PLACE_TOLERANCE * least);
    if (*same || placed)
        return SNOW_STATUS_OK;
    return snow_fail(
        context, SNOW_STATUS_BAD_INPUT,
        "the %s has %lldx%lldx%lld voxels, the volume %lldx%lldx%lld, and not "
        "both have a place in one world; resample the %s onto the volume's "
        "grid",
        what, (long long)m[0], (long long)m[1], (long long)m[2],
        (long long)v[0], (long long)v[1], (long long)v[2], what);
}

/* --- voxels --------------------------------------------------------------- */

snow_type snow_masked_type(snow_type type) {
    return snow_type_size(type) <= 2 || type == SNOW_TYPE_FLOAT32
               ? SNOW_TYPE_FLOAT32
               : SNOW_TYPE_FLOAT64;
}

void snow_mask_info(snow_volume_info *info) {
    info->eight_bits |= snow_type_size(info->type) == 1;
    info->whole |= info->type < SNOW_TYPE_FLOAT32;
    info->type = snow_masked_type(info->type);
}

/* Which of a mask's values are inside. */
typedef struct inside {
    const snow_label_range *labels;
    size_t count;
    double last; /* labels come in runs: what was asked last, */
    bool answer; /*   and what was answered */
} inside;

static bool is_label(const inside *in, double value) {
    for (size_t i = 0; i < in->count; i++)
        if (value >= (double)in->labels[i].first &&
            value <= (double)in->labels[i].last)
            return value == floor(value);
    return false;
}

/* NaN is never what was asked last, and is no label. */
static bool is_inside(inside *in, double value) {
    if (!in->count)
        return value != 0 && !isnan(value);
    if (value != in->last) {
        in->last = value;
        in->answer = is_label(in, value);
    }
    return in->answer;
}

/* Native values, or NaN, in the type of the masked volume. */
static void store(snow_volume *made, int64_t first, size_t count,
                  const double *values) {
    if (made->info.type == SNOW_TYPE_FLOAT64) {
        memcpy((double *)made->owned + first, values, count * sizeof *values);
        return;
    }
    float *to = (float *)made->owned + first;
    for (size_t i = 0; i < count; i++)
        to[i] = (float)values[i];
}

/* Values where the mask is, from linear index `first` on. */
static void mask_values(const snow_volume *mask, inside *in, int64_t first,
                        size_t count, double *values) {
    const double slope = mask->info.slope, intercept = mask->info.intercept;
    double marks[BLOCK];
    snow_volume_stored(mask, first, count, marks);
    for (size_t i = 0; i < count; i++)
        if (!is_inside(in, slope * marks[i] + intercept))
            values[i] = NAN;
}

/* *any: whether any voxel is left.  The mask may be
 * NULL. */
static snow_status leave_out(const snow_volume *volume, const snow_cuts *by,
                             inside *in, snow_volume *made, bool *any) {
    const int64_t *dims = volume->info.dims;
    int64_t all = dims[0] * dims[1] * dims[2];
    const double slope = volume->info.slope, from = volume->info.intercept;
    snow_monitor monitor;
    snow_status status = SNOW_STATUS_OK;
    double values[BLOCK];
    *any = false;
    snow_monitor_begin_reading(volume->context, &monitor);
    for (int64_t first = 0; first < all && !status &&
                            !snow_pass_is_stopped(volume, &monitor, first);
         first += BLOCK) {
        size_t count = all - first < BLOCK ? (size_t)(all - first) : BLOCK;
        snow_volume_stored(volume, first, count, values);
        /* What an earlier cut has left out is beyond its planes, which cut
         * again. */
        for (size_t i = 0; volume->clip && i < count; i++)
            if (isnan(values[i]))
                values[i] =
                    snow_clip_planes_value(volume->clip, first + (int64_t)i);
        for (size_t i = 0; i < count && !made->had_negative; i++)
            made->had_negative = slope * values[i] + from < 0;
        if (by->mask)
            mask_values(by->mask, in, first, count, values);
        if (made->clip)
            status = snow_clip_planes_apply(made->clip, dims, first, count,
                                            by->keeps_clipped, values);
        for (size_t i = 0; i < count && !*any; i++)
            *any = !isnan(values[i]);
        store(made, first, count, values);
    }
    if (!status)
        status = snow_monitor_status(volume->context->monitor);
    return snow_monitor_end(&monitor, status);
}

snow_status snow_labels_check(snow_context *context,
                              const snow_volume_info *info) {
    if (info->type < SNOW_TYPE_FLOAT32 && info->slope == 1 &&
        info->intercept == 0)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "--labels: picks whole numbers, and these values are %s; "
                     "give --mask FILE beside it, or convert the volume",
                     info->type < SNOW_TYPE_FLOAT32 ? "scaled" : "fractions");
}

bool snow_labels_pick(snow_volume *volume, const snow_label_range *labels,
                      size_t count) {
    const size_t size = snow_type_size(volume->info.type);
    const int64_t *dims = volume->info.dims;
    const int64_t all = dims[0] * dims[1] * dims[2];
    inside in = {.labels = labels, .count = count, .last = NAN};
    double values[BLOCK];
    bool any = false;
    for (int64_t first = 0; first < all; first += BLOCK) {
        size_t many = all - first < BLOCK ? (size_t)(all - first) : BLOCK;
        snow_volume_stored(volume, first, many, values);
        for (size_t i = 0; i < many; i++)
            if (is_inside(&in, values[i]))
                any = true;
            else
                memset((char *)volume->owned + ((size_t)first + i) * size, 0,
                       size);
    }
    volume->labelled = true;
    return any;
}

snow_status snow_mask_apply(const snow_volume *volume, const snow_cuts *by,
                            bool *any, snow_volume **out) {
    inside in = {.labels = by->labels, .count = by->label_count, .last = NAN};
    snow_volume_info info = volume->info;
    snow_volume *made;
    if (volume->left_out.any)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "the volume was opened for one look and lacks voxels "
                         "that a mask or clip planes may uncover; mask and "
                         "clip it when it is opened, or open it without "
                         "one_look (snow_ranks_options)");
    snow_mask_info(&info);
    SNOW_TRY(snow_volume_new(volume->context, &info, &made));
    made->is_part = volume->is_part;
    made->lost_clip = volume->lost_clip;
    made->masked = volume->masked || by->mask;
    made->had_negative = volume->had_negative;
    made->part = volume->part;
    made->knows_origin = volume->knows_origin;
    memcpy(made->origin, volume->origin, sizeof made->origin);
    memcpy(made->patient, volume->patient, sizeof made->patient);
    snow_status status =
        volume->labelled
            ? snow_volume_set_labels(made, volume->labels, volume->label_count)
            : SNOW_STATUS_OK;
    if (status == SNOW_STATUS_OK)
        status = snow_clip_planes_new(volume->context, &info, volume->clip,
                                      by->planes, by->plane_count, &made->clip);
    if (status == SNOW_STATUS_OK)
        status = leave_out(volume, by, &in, made, any);
    if (status == SNOW_STATUS_OK)
        *out = made;
    else
        snow_volume_close(made);
    return status;
}

snow_status snow_mask_cut_again(snow_volume *volume) {
    const snow_cuts by = {.keeps_clipped = true};
    bool any;
    return leave_out(volume, &by, NULL, volume, &any);
}

snow_status snow_volume_mask(const snow_volume *volume, const snow_volume *mask,
                             const snow_label_range *labels, size_t count,
                             snow_volume **out) {
    const snow_cuts by = {
        .mask = mask,
        .labels = labels,
        .label_count = count,
        .keeps_clipped = !volume->is_part,
    };
    bool any;
    snow_volume *fitted;
    snow_cuts fitting = by;
    SNOW_TRY(snow_volume_need_voxels(volume));
    SNOW_TRY(snow_volume_resample(mask, volume, true, "mask", &fitted));
    fitting.mask = fitted ? fitted : mask;
    snow_status status = snow_mask_apply(volume, &fitting, &any, out);
    snow_volume_close(fitted);
    return status;
}

snow_status snow_volume_clip(const snow_volume *volume, const double *planes,
                             size_t count, snow_volume **out) {
    const snow_cuts by = {
        .planes = planes,
        .plane_count = count,
        .keeps_clipped = !volume->is_part,
    };
    bool any;
    SNOW_TRY(snow_volume_need_voxels(volume));
    if (count > SNOW_CLIPS_MAX)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "too many clip planes: %zu, at most %d", count,
                         SNOW_CLIPS_MAX);
    SNOW_TRY(snow_planes_check(volume->context, planes, count));
    return snow_mask_apply(volume, &by, &any, out);
}

/* --- options -------------------------------------------------------------- */

bool snow_mask_asked(const snow_volume_options *options) {
    if (!options)
        return false;
    bool clips = false;
    for (int n = 0; n < SNOW_CLIPS_MAX; n++)
        clips |= snow_is_plane(options->clip[n]);
    return options->mask || options->labels || clips;
}

void snow_mask_warn(snow_context *context, const snow_volume_options *options,
                    const double mask_range[2]) {
    if (options->mask)
        snow_notify(context,
                    "%s: no voxel is left inside this mask, whose values are "
                    "%g to %g; correct --labels, or the mask",
                    options->mask, mask_range[0], mask_range[1]);
    else
        snow_notify(context, "--clip: no voxel is left; these are beyond "
                             "A x + B y + C z = D of the world");
}
