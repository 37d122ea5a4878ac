/* classify/codes.c - which voxels are interesting, and their codes (model,
 * point 3; section 3 of the paper stores the interesting ones only).
 *
 * Between two neighbouring opacity points the opacity rises or falls with the
 * native value, in rounded arithmetic too: each step of snow_transfer_opacity
 * is monotone.  So within such a stretch the interesting values are a run at
 * one of its ends, and bisection finds that end to the last bit, for floating
 * types as for integers.  Nothing has to be evaluated per native value. */
#include "classify/codes.h"

#include <math.h>
#include <string.h>

#include "base/power.h"

/* The most stretches that codes are dealt out to: 7 codes for each at least.
 * Of more control values only every so many-th counts. */
#define STRETCHES_MOST 8192

/* The native values that a coder's type can have, in the order of their data
 * values.  A place counts the values of 8- and 16-bit types, and otherwise the
 * doubles from -infinity to infinity. */
typedef struct survey {
    const snow_coder *coder;
    const snow_transfer *transfer;
    bool wide;
    int64_t first, last; /* places; -places where data fall as natives rise */
} survey;

static bool is_wide(snow_type type) {
    return snow_type_size(type) > 2;
}

/* The double that is so many places above 0, and so for negative places. */
static double double_at(int64_t place) {
    uint64_t bits =
        place < 0 ? (uint64_t)-place | (uint64_t)1 << 63 : (uint64_t)place;
    return snow_double_of(bits);
}

static double native_at(const survey *s, int64_t place) {
    if (s->coder->slope < 0)
        place = -place;
    return s->wide ? double_at(place) : (double)place;
}

static double data_at(const survey *s, int64_t place) {
    return s->coder->slope * native_at(s, place) + s->coder->intercept;
}

static bool interesting_at(const survey *s, int64_t place) {
    return snow_is_interesting(
        snow_transfer_opacity(s->transfer, data_at(s, place)),
        s->coder->threshold);
}

/* Half-way between two places, which may lie further apart than an int64_t
 * tells. */
static int64_t middle_of(int64_t low, int64_t high) {
    return low + (int64_t)(((uint64_t)high - (uint64_t)low) / 2);
}

/* The first place from `low` on whose data value is not below `value`; one
 * after the last when there is none. */
static int64_t place_of(const survey *s, double value, int64_t low) {
    int64_t high = s->last + 1;
    while (low < high) {
        int64_t middle = middle_of(low, high);
        if (data_at(s, middle) >= value)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* The first place after `first` that is not as interesting as `first`, where
 * `last` is not. */
static int64_t turn_between(const survey *s, int64_t first, int64_t last) {
    bool interesting = interesting_at(s, first);
    int64_t low = first + 1, high = last;
    while (low < high) {
        int64_t middle = middle_of(low, high);
        if (interesting_at(s, middle) == interesting)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

typedef struct place_run {
    int64_t first, last;
} place_run;

/* Adds the interesting places of one stretch to the runs. */
static size_t survey_stretch(const survey *s, int64_t first, int64_t last,
                             place_run *runs, size_t count) {
    bool begins = interesting_at(s, first), ends = interesting_at(s, last);
    if (!begins && !ends)
        return count;
    if (begins && !ends)
        last = turn_between(s, first, last) - 1;
    else if (!begins)
        first = turn_between(s, first, last);
    if (count && runs[count - 1].last + 1 == first)
        runs[count - 1].last = last;
    else
        runs[count++] = (place_run){first, last};
    return count;
}

/* All runs of interesting places, of which there is room for one more than
 * there are opacity points. */
static size_t survey_all(const survey *s, place_run *runs) {
    const snow_transfer *transfer = s->transfer;
    size_t count = 0;
    int64_t begin = s->first;
    if (transfer->log) /* what is not above 0 is transparent */
        begin = place_of(s, snow_double_of(1), begin);
    for (size_t n = 0; n <= transfer->opacity_count; n++) {
        int64_t end = s->last + 1;
        if (n < transfer->opacity_count)
            end = place_of(s, transfer->opacities[n].value, begin);
        if (end > begin)
            count = survey_stretch(s, begin, end - 1, runs, count);
        begin = end;
    }
    return count;
}

/* The runs in native values, rising. */
static void store_native_runs(const survey *s, const place_run *runs,
                              size_t count, snow_coder *coder) {
    bool falls = coder->slope < 0;
    coder->native_run_count = count;
    for (size_t n = 0; n < count; n++) {
        place_run run = runs[falls ? count - 1 - n : n];
        coder->native_runs[n].first =
            native_at(s, falls ? run.last : run.first);
        coder->native_runs[n].last = native_at(s, falls ? run.first : run.last);
    }
}

static snow_status find_native_runs(snow_context *context,
                                    const snow_transfer *transfer,
                                    snow_coder *coder) {
    survey s = {.coder = coder,
                .transfer = transfer,
                .wide = is_wide(coder->type),
                .first = coder->lowest,
                .last = coder->lowest + (int64_t)coder->codes - 1};
    if (s.wide) {
        s.last = (int64_t)snow_bits_of(INFINITY);
        s.first = -s.last;
    } else if (coder->slope < 0) {
        int64_t first = s.first;
        s.first = -s.last;
        s.last = -first;
    }
    size_t room = transfer->opacity_count + 1;
    place_run *runs;
    SNOW_TRY(snow_reserve(context, &coder->places, &coder->places_capacity, 0,
                          room * sizeof *runs));
    SNOW_TRY(snow_reserve(context, &coder->native_runs,
                          &coder->native_runs_capacity, 0,
                          room * sizeof *coder->native_runs));
    runs = coder->places;
    store_native_runs(&s, runs, survey_all(&s, runs), coder);
    return SNOW_OK;
}

/* 8- and 16-bit types: the runs as codes, and the table of all codes. */
static snow_status make_table(snow_context *context, snow_coder *coder) {
    SNOW_TRY(snow_reserve(context, &coder->keep, &coder->keep_capacity, 0,
                          coder->codes));
    memset(coder->keep, 0, coder->codes);
    bool fits = coder->native_run_count <= SNOW_KEPT_RUNS;
    coder->run_count = fits ? (int)coder->native_run_count : -1;
    for (size_t n = 0; n < coder->native_run_count; n++) {
        int32_t first = (int32_t)coder->native_runs[n].first - coder->lowest;
        int32_t last = (int32_t)coder->native_runs[n].last - coder->lowest;
        memset(coder->keep + first, 1, (size_t)(last - first) + 1);
        if (fits) {
            coder->runs[n].first = (uint16_t)first;
            coder->runs[n].last = (uint16_t)last;
        }
    }
    return SNOW_OK;
}

/* --- wider types ----------------------------------------------------------
 */

/* Merges the values of both kinds of points into `stops`, each once. */
static size_t merge_values(const snow_transfer *transfer, double *stops) {
    size_t count = 0, color = 0, opacity = 0;
    while (color < transfer->color_count || opacity < transfer->opacity_count) {
        bool of_color = opacity == transfer->opacity_count ||
                        (color < transfer->color_count &&
                         transfer->colors[color].value <
                             transfer->opacities[opacity].value);
        double value = of_color ? transfer->colors[color++].value
                                : transfer->opacities[opacity++].value;
        if (!count || stops[count - 1] < value)
            stops[count++] = value;
    }
    return count;
}

static snow_status make_stops(snow_context *context,
                              const snow_transfer *transfer,
                              snow_coder *coder) {
    size_t points = transfer->color_count + transfer->opacity_count;
    SNOW_TRY(snow_reserve(context, &coder->stops, &coder->stops_capacity, 0,
                          points * sizeof *coder->stops));
    size_t count = merge_values(transfer, coder->stops);
    if (count > STRETCHES_MOST) {
        size_t step = (count - 1) / STRETCHES_MOST + 1, kept = 0;
        double last = coder->stops[count - 1];
        for (size_t n = 0; n + 1 < count; n += step)
            coder->stops[kept++] = coder->stops[n];
        coder->stops[kept++] = last;
        count = kept;
    }
    coder->stop_count = count;
    /* One code lies below the first stop and one above the last. */
    coder->stretch_codes = count > 1 ? (coder->codes - 2) / (count - 1) : 0;
    return SNOW_OK;
}

/* How many stops are not above a value. */
static size_t stops_up_to(const snow_coder *coder, double value) {
    size_t low = 0, high = coder->stop_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (coder->stops[middle] > value)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static size_t wide_code(const snow_coder *coder, double value) {
    size_t up_to = stops_up_to(coder, value);
    if (up_to == 0)
        return 0;
    size_t first = 1 + (up_to - 1) * coder->stretch_codes;
    if (up_to == coder->stop_count)
        return first;
    double a = coder->stops[up_to - 1], b = coder->stops[up_to];
    double part = coder->log        ? snow_part_of_decades(value, a, b)
                  : isfinite(b - a) ? (value - a) / (b - a)
                                    : (value / 2 - a / 2) / (b / 2 - a / 2);
    size_t place = (size_t)(part * (double)coder->stretch_codes);
    return first +
           (place < coder->stretch_codes ? place : coder->stretch_codes - 1);
}

/* The value that is such a part of the way from a to b in its logarithm. */
static double between_decades(double a, double b, double part) {
    double from = snow_log2_rising(a), to = snow_log2_rising(b);
    double value = snow_exp2(from + (to - from) * part);
    return value > a ? value : a;
}

/* The middle of a code's part of its stretch, which stays within the stretch
 * whatever the rounding: a step is never taken for its other side. */
static double wide_value(const snow_coder *coder, size_t code) {
    const double *stops = coder->stops;
    if (code == 0)
        return nextafter(stops[0], -INFINITY);
    size_t stretch = coder->stop_count;
    if (coder->stretch_codes) /* in 32 bits, which divide faster */
        stretch = (uint32_t)(code - 1) / (uint32_t)coder->stretch_codes;
    if (stretch + 1 >= coder->stop_count)
        return stops[coder->stop_count - 1];
    size_t place = code - 1 - stretch * coder->stretch_codes;
    double part = ((double)place + 0.5) / (double)coder->stretch_codes;
    double a = stops[stretch], b = stops[stretch + 1];
    double value =
        isfinite(b - a) ? a + (b - a) * part : a * (1 - part) + b * part;
    if (coder->log)
        value = between_decades(a, b, part);
    return value < b ? value : nextafter(b, -INFINITY);
}

/* --- coders ---------------------------------------------------------------
 */

static int32_t lowest_of(snow_type type) {
    return type == SNOW_INT8 ? INT8_MIN : type == SNOW_INT16 ? INT16_MIN : 0;
}

snow_status snow_coder_make(snow_context *context, const snow_volume *volume,
                            const snow_transfer *transfer, double threshold,
                            snow_coder *coder) {
    const snow_volume_info *info = &volume->info;
    coder->type = info->type;
    coder->slope = info->slope;
    coder->intercept = info->intercept;
    coder->threshold = threshold;
    coder->bytes = snow_type_size(info->type) == 1 ? 1 : 2;
    coder->codes = snow_type_size(info->type) == 1 ? 256 : 65536;
    coder->lowest = lowest_of(info->type);
    coder->log = transfer->log;
    coder->run_count = 0;
    coder->stop_count = coder->stretch_codes = 0;
    SNOW_TRY(find_native_runs(context, transfer, coder));
    return is_wide(info->type) ? make_stops(context, transfer, coder)
                               : make_table(context, coder);
}

void snow_coder_fini(snow_context *context, snow_coder *coder) {
    snow_release(context, coder->keep);
    snow_release(context, coder->native_runs);
    snow_release(context, coder->places);
    snow_release(context, coder->stops);
    *coder = (snow_coder){.type = SNOW_TYPE_NONE};
}

bool snow_coder_same(const snow_coder *a, const snow_coder *b) {
    if (a->type != b->type || a->native_run_count != b->native_run_count)
        return false;
    for (size_t n = 0; n < a->native_run_count; n++)
        if (a->native_runs[n].first != b->native_runs[n].first ||
            a->native_runs[n].last != b->native_runs[n].last)
            return false;
    if (!is_wide(a->type))
        return true;
    if (a->slope != b->slope || a->intercept != b->intercept ||
        a->stop_count != b->stop_count || a->log != b->log)
        return false;
    for (size_t n = 0; n < a->stop_count; n++)
        if (a->stops[n] != b->stops[n])
            return false;
    return true;
}

/* Whether one of the runs holds a native value; NaN is in none. */
static bool in_runs(const snow_coder *coder, double native) {
    size_t low = 0, high = coder->native_run_count; /* first run beyond */
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (coder->native_runs[middle].first <= native)
            low = middle + 1;
        else
            high = middle;
    }
    return low > 0 && native <= coder->native_runs[low - 1].last;
}

bool snow_coder_code(const snow_coder *coder, double native, uint16_t *code) {
    if (!is_wide(coder->type)) {
        *code = (uint16_t)(native - coder->lowest + 0.5);
        return coder->keep[*code];
    }
    bool interesting = in_runs(coder, native);
    *code = interesting ? (uint16_t)wide_code(coder, coder->slope * native +
                                                         coder->intercept)
                        : 0;
    return interesting;
}

double snow_coder_value(const snow_coder *coder, size_t code) {
    if (is_wide(coder->type))
        return wide_value(coder, code);
    return coder->slope * ((double)coder->lowest + (double)code) +
           coder->intercept;
}
