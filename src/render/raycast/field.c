/* render/raycast/field.c - see field.h. */
#include "render/raycast/field.h"

#include "base/exp_log.h"
#include "transfer/scale.h"
#include "volume/clip_planes.h"

#include <math.h>
#include <string.h>

/* So that rounding does not decide where half of the weights is just there. */
#define ENOUGH (0.5 - 1e-9)

snow_status snow_field_make(const snow_volume *volume,
                            const snow_transfer *transfer,
                            const snow_settings *settings, bool modes,
                            snow_field *out) {
    const int64_t *dims = volume->info.dims;
    snow_volume_statistics figures;
    snow_volume_info whole;
    snow_field field = {
        .volume = volume,
        .steps = {1, dims[0], dims[0] * dims[1]},
        .taps = settings->kernel == SNOW_KERNEL_BSPLINE ? 4 : 2,
        .log = transfer->log && !modes,
        .linear = modes ? 0 : transfer->linear,
        .infinite_is_hole = modes,
    };
    snow_volume_whole(volume, &whole);
    if (volume->is_part)
        memcpy(field.stored, volume->part.stored, sizeof field.stored);
    snow_volume_statistics_init(&figures);
    if (!modes && volume->info.type >= SNOW_TYPE_FLOAT32)
        SNOW_TRY(snow_volume_get_statistics(volume, &figures));
    field.least = figures.min;
    field.most = figures.max;
    for (int axis = 0; axis < 3; axis++) {
        int64_t side = field.dims[axis] = whole.dims[axis];
        field.low[axis] = side > 1 ? 0 : -0.5;
        field.high[axis] = side > 1 ? (double)(side - 1) : 0.5;
    }
    *out = field;
    return SNOW_STATUS_OK;
}

/* --- windows -------------------------------------------------------------- */

/* A native value as the field knows it: NaN where it is a hole. */
static double field_value_of(const snow_field *field, double native) {
    const snow_volume_info *info = &field->volume->info;
    double value = info->slope * native + info->intercept;
    if (isinf(value)) {
        if (field->infinite_is_hole)
            return NAN;
        value = value > 0 ? field->most : field->least;
    }
    if (field->linear > 0)
        return snow_scale_place((snow_scale){false, field->linear}, value);
    if (!field->log)
        return value;
    return value > 0 ? snow_log2_rising(value) : NAN;
}

/* Values that clip planes have left out are those of a field that is cut. */
static void fill(const snow_field *field, snow_field_window *w) {
    const snow_clip_planes *clip = field->volume->clip;
    double *value = w->values;
    w->holes = false;
    w->least = INFINITY;
    w->most = -INFINITY;
    for (int z = 0; z < w->count[2]; z++)
        for (int y = 0; y < w->count[1]; y++) {
            int64_t row =
                (w->first[0] - field->stored[0]) * field->steps[0] +
                (w->first[1] - field->stored[1] + y) * field->steps[1] +
                (w->first[2] - field->stored[2] + z) * field->steps[2];
            snow_volume_stored(field->volume, row, (size_t)w->count[0], value);
            for (int x = 0; x < w->count[0]; x++, value++) {
                if (clip && isnan(*value))
                    *value = snow_clip_planes_value(clip, row + x);
                *value = field_value_of(field, *value);
                w->holes |= isnan(*value);
                w->least = fmin(w->least, *value);
                w->most = fmax(w->most, *value);
            }
        }
    w->filled = true;
}

/* The kernel's weights of voxels floor(x) - taps / 2 + 1 and on. */
static void kernel_weights(int taps, double part, double weights[4]) {
    double rest = 1 - part, square = part * part, cube = square * part;
    if (taps == 2) {
        weights[0] = rest;
        weights[1] = part;
        return;
    }
    weights[0] = rest * rest * rest / 6;
    weights[1] = (4 - 6 * square + 3 * cube) / 6;
    weights[2] = (1 + 3 * part + 3 * square - 3 * cube) / 6;
    weights[3] = cube / 6;
}

/* Adds the weight of a voxel to those of the voxels that it is made of, where
 * it is beyond the ends: v[-k] = 2 v[0] - v[k]. */
static void add_weight(int64_t voxel, double weight, int64_t last,
                       int64_t first, double *weights) {
    if (voxel < 0 || voxel > last) {
        int64_t end = voxel < 0 ? 0 : last;
        weights[end - first] += 2 * weight;
        add_weight(2 * end - voxel, -weight, last, first, weights);
        return;
    }
    weights[voxel - first] += weight;
}

/* Voxels and weights along one axis, of those that are in memory. */
static void place_axis(const snow_field *field, int axis, double at,
                       int64_t *first, int *count,
                       double weights[SNOW_FIELD_TAPS]) {
    const int taps = field->taps;
    const int64_t dims = field->dims[axis], stored = field->stored[axis];
    const int64_t here = field->volume->info.dims[axis];
    double whole = floor(at), kernel[SNOW_FIELD_TAPS];
    int64_t begin = (int64_t)whole - taps / 2 + 1;
    int64_t least = stored + here - taps;
    *count = here < taps ? (int)here : taps;
    *first = begin < least ? begin : least;
    *first = *first > stored ? *first : stored;
    memset(weights, 0, SNOW_FIELD_TAPS * sizeof *weights);
    if (dims == 1) {
        weights[0] = 1;
        return;
    }
    kernel_weights(taps, at - whole, kernel);
    for (int n = 0; n < taps; n++)
        if (kernel[n] != 0)
            add_weight(begin + n, kernel[n], dims - 1, *first, weights);
}

void snow_field_place(const snow_field *field, const double at[3],
                      snow_field_window *w) {
    int64_t first[3];
    w->beyond = false;
    for (int axis = 0; axis < 3; axis++) {
        place_axis(field, axis, at[axis], &first[axis], &w->count[axis],
                   w->weights[axis]);
        w->beyond |= at[axis] < field->low[axis] - 1e-9 ||
                     at[axis] > field->high[axis] + 1e-9;
    }
    if (w->filled && memcmp(first, w->first, sizeof first) == 0)
        return;
    memcpy(w->first, first, sizeof first);
    fill(field, w);
}

/* The sum of weighted values, those that are not holes, and of their weights;
 * false where one beyond the ends is a hole. */
static bool add_values(const snow_field_window *w, double sums[2]) {
    const double *value = w->values;
    sums[0] = sums[1] = 0;
    for (int z = 0; z < w->count[2]; z++)
        for (int y = 0; y < w->count[1]; y++)
            for (int x = 0; x < w->count[0]; x++, value++) {
                double weight =
                    w->weights[2][z] * w->weights[1][y] * w->weights[0][x];
                if (weight == 0)
                    continue;
                if (!isnan(*value)) {
                    sums[0] += weight * *value;
                    sums[1] += weight;
                } else if (w->beyond)
                    return false;
            }
    return true;
}

static double whole_value(const snow_field_window *w) {
    const double *value = w->values;
    double sum = 0;
    for (int z = 0; z < w->count[2]; z++) {
        double slice = 0;
        for (int y = 0; y < w->count[1]; y++) {
            double row = 0;
            for (int x = 0; x < w->count[0]; x++)
                row += w->weights[0][x] * *value++;
            slice += w->weights[1][y] * row;
        }
        sum += w->weights[2][z] * slice;
    }
    return sum;
}

double snow_field_value(const snow_field_window *w) {
    double sums[2];
    if (!w->holes)
        return whole_value(w);
    return add_values(w, sums) && sums[1] >= ENOUGH ? sums[0] / sums[1] : NAN;
}

/* --- gradients ------------------------------------------------------------ */

/* The difference of two values, times a factor; what is rounding alone has no
 * direction. */
static double way_of(double from, double to, double factor) {
    return fabs(to - from) > 1e-13 * (fabs(from) + fabs(to))
               ? factor * (to - from)
               : 0;
}

static double difference(double before, double here, double after) {
    if (!isnan(before) && !isnan(after))
        return way_of(before, after, 0.5);
    if (!isnan(after) && !isnan(here))
        return way_of(here, after, 1);
    if (!isnan(before) && !isnan(here))
        return way_of(before, here, 1);
    return 0;
}

void snow_field_gradient(const snow_field *field, const double at[3],
                         double here, snow_field_window sides[6],
                         double gradient[3]) {
    for (int axis = 0; axis < 3; axis++) {
        double ends[2];
        gradient[axis] = 0;
        if (field->volume->info.dims[axis] == 1)
            continue;
        for (int n = 0; n < 2; n++) {
            double there[3] = {at[0], at[1], at[2]};
            there[axis] += n ? 1 : -1;
            snow_field_window *side = &sides[2 * axis + n];
            snow_field_place(field, there, side);
            ends[n] = snow_field_value(side);
        }
        gradient[axis] = difference(ends[0], here, ends[1]);
    }
}

/* --- labels --------------------------------------------------------------- */

static double membership(const snow_field_window *w, double label) {
    const double *value = w->values;
    double sum = 0;
    for (int z = 0; z < w->count[2]; z++)
        for (int y = 0; y < w->count[1]; y++)
            for (int x = 0; x < w->count[0]; x++)
                if (*value++ == label)
                    sum +=
                        w->weights[2][z] * w->weights[1][y] * w->weights[0][x];
    return sum;
}

double snow_field_label(const snow_field *field, const double at[3],
                        const snow_field_window *w, bool nearest) {
    int count = w->count[0] * w->count[1] * w->count[2];
    double sums[2], most = 0, found = NAN;
    if (nearest) {
        int64_t place[3];
        for (int axis = 0; axis < 3; axis++) {
            double end = (double)(field->volume->info.dims[axis] - 1);
            place[axis] = (int64_t)fmin(fmax(floor(at[axis] + 0.5), 0), end) -
                          w->first[axis];
        }
        return w->values[place[0] +
                         w->count[0] * (place[1] + w->count[1] * place[2])];
    }
    if (!add_values(w, sums) || !(sums[1] >= ENOUGH))
        return NAN;
    for (int n = 0; n < count; n++) {
        double label = w->values[n];
        if (isnan(label) || label == found)
            continue;
        double share = membership(w, label);
        if (share > most + 1e-12 || (share > most - 1e-12 && label > found)) {
            most = share;
            found = label;
        }
    }
    return found;
}

/* Weights of the voxels around a place along an axis, and their slopes; zeros
 * where there are none. */
typedef struct label_taps {
    int count;
    int64_t at[SNOW_LABEL_TAPS];
    double weight[SNOW_LABEL_TAPS], slope[SNOW_LABEL_TAPS];
} label_taps;

/* `sides`: there are none beyond the grid, else as the last ones there. */
static void find_taps(const snow_field *field, int axis, double place,
                      int reach, bool sides, label_taps *taps) {
    const double end = (double)field->volume->info.dims[axis] - 1;
    place = end > 0 ? place : (double)field->stored[axis]; /* of one voxel */
    double first = floor(place) - reach + 1;
    taps->count = 2 * reach;
    for (int n = 0; n < taps->count; n++) {
        double way = place - (first + n), x = fabs(way) / reach;
        double at = first + n - (double)field->stored[axis];
        const double there = !sides || (at >= 0 && at <= end);
        taps->at[n] = (int64_t)fmin(fmax(at, 0), end) * field->steps[axis];
        taps->weight[n] = there * (1 - x * x * (3 - 2 * x)) / reach;
        taps->slope[n] =
            there * (way < 0 ? 6 : -6) * x * (1 - x) / (reach * reach);
    }
}

/* The weights and slopes of the voxels of a row that have a label, or where it
 * is NaN any value, summed. */
static void add_row(const snow_field *field, int64_t row,
                    const label_taps *taps, double label, double sums[2]) {
    const int64_t *at = taps->at;
    double natives[SNOW_LABEL_TAPS];
    sums[0] = sums[1] = 0;
    snow_volume_stored(field->volume, row + at[0],
                       (size_t)(at[taps->count - 1] - at[0] + 1), natives);
    for (int n = 0; n < taps->count; n++) {
        double native = natives[at[n] - at[0]];
        if (field->volume->clip && isnan(native))
            native = snow_clip_planes_value(field->volume->clip, row + at[n]);
        double value = field_value_of(field, native);
        if (isnan(label) ? isnan(value) : value != label)
            continue;
        sums[0] += taps->weight[n];
        sums[1] += taps->slope[n];
    }
}

static void smooth_gradient(const snow_field *field, const label_taps taps[3],
                            double label, double gradient[3]) {
    const label_taps *v = &taps[1], *w = &taps[2];
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (int z = 0; z < w->count; z++)
        for (int y = 0; y < v->count; y++) {
            double row[2];
            add_row(field, v->at[y] + w->at[z], &taps[0], label, row);
            gradient[0] += row[1] * v->weight[y] * w->weight[z];
            gradient[1] += row[0] * v->slope[y] * w->weight[z];
            gradient[2] += row[0] * v->weight[y] * w->slope[z];
        }
    /* What cancels out but for rounding has no direction. */
    for (int axis = 0; axis < 3; axis++)
        if (fabs(gradient[axis]) < 1e-9)
            gradient[axis] = 0;
}

void snow_field_label_gradient(const snow_field *field, const double at[3],
                               double label, double gradient[3]) {
    label_taps taps[3];
    for (int axis = 0; axis < 3; axis++)
        find_taps(field, axis, at[axis], SNOW_LABEL_TAPS / 2, true,
                  &taps[axis]);
    smooth_gradient(field, taps, label, gradient);
}

void snow_field_add_border(const snow_field *field, const double at[3],
                           double gradient[3]) {
    label_taps taps[3];
    double border[3];
    if (!(field->border > 0))
        return;
    for (int axis = 0; axis < 3; axis++)
        find_taps(field, axis, at[axis], 2, false, &taps[axis]);
    smooth_gradient(field, taps, NAN, border);
    for (int axis = 0; axis < 3; axis++)
        gradient[axis] += field->border * border[axis];
}
