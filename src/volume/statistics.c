/* volume/statistics.c - where voxels lie, and figures over all of them: range,
 * sums, histogram.
 *
 * Voxels are turned to doubles a block at a time; that loop alone is written
 * per scalar type.  What follows sees data values (after slope and intercept)
 * in storage order, so that sums have one order of additions on all machines.
 */
#include "volume/stream.h"

#include <math.h>
#include <string.h>

#define BLOCK 1024
#define WATCHED (64 * BLOCK) /* voxels between two questions for a stop */

/* The weights of `wsum` repeat after this many voxels; a prime, so that no
 * row length hides a swap of axes. */
#define WEIGHT_PERIOD 1009

void snow_volume_set_pitch(snow_volume *volume, const int64_t pitch[2]) {
    const int64_t *dims = volume->info.dims;
    const int64_t dense[2] = {dims[0], dims[0] * dims[1]};
    if (memcmp(pitch, dense, sizeof dense) != 0)
        memcpy(volume->pitch, pitch, sizeof volume->pitch);
}

void snow_volume_steps(const snow_volume *volume, int64_t out[3]) {
    const int64_t *dims = volume->info.dims, *pitch = volume->pitch;
    out[0] = 1;
    out[1] = pitch[0] ? pitch[0] : dims[0];
    out[2] = pitch[0] ? pitch[1] : dims[0] * dims[1];
}

static void to_doubles(const snow_volume *volume, int64_t first, size_t count,
                       double *out) {
    switch (volume->info.type) {
#define WIDEN(name, c_type, text)                                    \
    case SNOW_TYPE_##name: {                                         \
        const c_type *from = (const c_type *)volume->voxels + first; \
        for (size_t i = 0; i < count; i++)                           \
            out[i] = (double)from[i];                                \
        break;                                                       \
    }
        SNOW_TYPE_MAP(WIDEN)
#undef WIDEN
    case SNOW_TYPE_NONE:
        break;
    }
}

int64_t snow_volume_run(const snow_volume *volume, int64_t first,
                        uint64_t *count) {
    const int64_t *dims = volume->info.dims;
    if (!volume->pitch[0])
        return first;
    const int64_t x = first % dims[0], row = first / dims[0];
    if (*count > (uint64_t)(dims[0] - x))
        *count = (uint64_t)(dims[0] - x);
    return row / dims[1] * volume->pitch[1] + row % dims[1] * volume->pitch[0] +
           x;
}

void snow_volume_stored(const snow_volume *volume, int64_t first, size_t count,
                        double *out) {
    while (count) {
        uint64_t here = count;
        const int64_t at = snow_volume_run(volume, first, &here);
        to_doubles(volume, at, (size_t)here, out);
        first += (int64_t)here;
        count -= (size_t)here;
        out += here;
    }
}

/* For single looks; loops take snow_volume_stored a block at a time. */
double snow_volume_native(const snow_volume *volume, int64_t index) {
    double value = NAN;
    snow_volume_stored(volume, index, 1, &value);
    return value;
}

int32_t snow_type_lowest(snow_type type) {
    return type == SNOW_TYPE_INT8    ? INT8_MIN
           : type == SNOW_TYPE_INT16 ? INT16_MIN
                                     : 0;
}

/* Extremes, as values of a type whose extremes vectors of any machine find:
 * with the sign bit turned over where `flip` has it. */
#define EXTREMES(name, type, vector, flip)                         \
    case SNOW_TYPE_##name: {                                       \
        const type *stored = (const type *)volume->voxels + first; \
        vector least = (vector)(stored[0] ^ (flip)), most = least; \
        for (size_t n = 0; n < count; n++) {                       \
            vector here = (vector)(stored[n] ^ (flip));            \
            least = here < least ? here : least;                   \
            most = here > most ? here : most;                      \
        }                                                          \
        *low = (type)(least ^ (flip));                             \
        *high = (type)(most ^ (flip));                             \
        return true;                                               \
    }

/* Finds the extremes of values in memory without a gap. */
static bool find_extremes(const snow_volume *volume, int64_t first,
                          size_t count, int32_t *low, int32_t *high) {
    switch (volume->info.type) {
        EXTREMES(INT8, int8_t, uint8_t, 0x80)
        EXTREMES(UINT8, uint8_t, uint8_t, 0)
        EXTREMES(INT16, int16_t, int16_t, 0)
        EXTREMES(UINT16, uint16_t, int16_t, 0x8000)
    default:
        return false;
    }
}

bool snow_volume_extremes(const snow_volume *volume, int64_t first,
                          size_t count, int32_t *low, int32_t *high) {
    *low = INT32_MAX;
    *high = INT32_MIN;
    while (count) {
        uint64_t here = count;
        int32_t least, most;
        const int64_t at = snow_volume_run(volume, first, &here);
        if (!find_extremes(volume, at, (size_t)here, &least, &most))
            return false;
        *low = least < *low ? least : *low;
        *high = most > *high ? most : *high;
        first += (int64_t)here;
        count -= (size_t)here;
    }
    return true;
}

/* What names no modality is CT if it is a patient's, has more than 8 bits, and
 * begins at air or at a padding below. */
bool snow_are_hounsfield(const snow_volume_info *info, double low,
                         double high) {
    const bool ct = !strcmp(info->modality, "CT");
    return info->medical && (ct || !*info->modality) &&
           !snow_has_8_bits(info) && low >= -4096 && low < (ct ? 0 : -900) &&
           high < 32768;
}

/* The product was checked when the volume was made. */
static int64_t voxel_count(const snow_volume *volume) {
    const int64_t *dims = volume->info.dims;
    return dims[0] * dims[1] * dims[2];
}

/* The data values from `first` on into a block; returns how many. */
static size_t next_block(const snow_volume *volume, int64_t first,
                         double values[BLOCK]) {
    int64_t left = voxel_count(volume) - first;
    size_t count = left < BLOCK ? (size_t)left : BLOCK;
    double slope = volume->info.slope, intercept = volume->info.intercept;
    snow_volume_stored(volume, first, count, values);
    for (size_t i = 0; i < count; i++)
        values[i] = slope * values[i] + intercept;
    return count;
}

/* The index in storage order gives the weight, so that wsum notices voxels that
 * are right but in the wrong place. */
static void measure_value(snow_volume_statistics *m, double value,
                          int64_t index) {
    if (!isfinite(value))
        return;
    /* The comparisons are false for the NaN that stands there at first. */
    if (!(value >= m->min))
        m->min = value;
    if (!(value <= m->max))
        m->max = value;
    m->finite++;
    m->sum += value;
    m->wsum += value * (double)(index % WEIGHT_PERIOD + 1);
}

bool snow_pass_is_stopped(const snow_volume *volume, snow_monitor *own,
                          int64_t first) {
    if (first % WATCHED != 0)
        return false;
    if (own->entered)
        snow_monitor_report(own, SNOW_STAGE_READ, (double)first,
                            (double)voxel_count(volume));
    return snow_monitor_look(volume->context->monitor, 0);
}

/* One thread and one order: the sums are compared to the last bit with those
 * of other readers. */
snow_status snow_volume_get_statistics(const snow_volume *volume,
                                       snow_volume_statistics *out) {
    snow_volume_statistics m = {
        .voxels = voxel_count(volume), .min = NAN, .max = NAN};
    snow_monitor monitor;
    double values[BLOCK];
    size_t count;
    snow_monitor_begin_reading(volume->context, &monitor);
    for (int64_t first = 0; volume->voxels && first < m.voxels &&
                            !snow_pass_is_stopped(volume, &monitor, first);
         first += (int64_t)count) {
        count = next_block(volume, first, values);
        for (size_t i = 0; i < count; i++)
            measure_value(&m, values[i], first + (int64_t)i);
    }
    SNOW_TRY(snow_monitor_end(&monitor,
                              snow_monitor_status(volume->context->monitor)));
    return SNOW_RECORD_FILL(volume->context, snow_volume_statistics, &m, out);
}

/* The bin of a value is that of snowglass/volume.h to the last bit: floor of
 * the scaled distance, with the upper end in the last bin. */
snow_status snow_volume_histogram(const snow_volume *volume, double lo,
                                  double hi, size_t bins, uint64_t *counts) {
    SNOW_TRY(snow_volume_need_voxels(volume));
    if (!isfinite(lo) || !isfinite(hi) || !(lo < hi) || !bins)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "invalid histogram from %g to %g in %zu bins: ends "
                         "must be finite and rising, with at least one bin",
                         lo, hi, bins);
    memset(counts, 0, bins * sizeof *counts);
    /* Halves, where the whole range is more than a double can hold. */
    double scale = isfinite(hi - lo) ? 1 : 0.5;
    double range = scale * hi - scale * lo;
    snow_monitor monitor;
    double values[BLOCK];
    size_t count;
    snow_monitor_begin_reading(volume->context, &monitor);
    for (int64_t first = 0; first < voxel_count(volume) &&
                            !snow_pass_is_stopped(volume, &monitor, first);
         first += (int64_t)count) {
        count = next_block(volume, first, values);
        for (size_t i = 0; i < count; i++) {
            if (!(values[i] >= lo && values[i] <= hi))
                continue;
            double bin =
                floor((scale * values[i] - scale * lo) / range * (double)bins);
            counts[bin < (double)bins ? (size_t)bin : bins - 1]++;
        }
    }
    return snow_monitor_end(&monitor,
                            snow_monitor_status(volume->context->monitor));
}
