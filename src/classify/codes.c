/* classify/codes.c - which voxels are interesting, and their codes (model,
 * point 3; section 3 of the paper stores interesting voxels only).
 *
 * Between two neighbouring opacity points the opacity is monotone in the native
 * value, in rounded arithmetic too, since each step of snow_transfer_opacity
 * is. So the interesting values of such a stretch are a run at one of its ends,
 * and bisection finds that end to the last bit, for floating-point types as for
 * integers. No native value needs to be evaluated on its own. */
#include "classify/codes.h"

#include <math.h>
#include <string.h>

#include "base/exp_log.h"

/* The largest number of stretches that share the codes: at least 7 codes for
 * each. With more control values, only every n-th counts. */
#define STRETCHES_MOST 8192

/* The native values that a quantizer's type can have, in the order of their
 * data values. A place counts the values of 8- and 16-bit types; for other
 * types it counts the doubles from -infinity to infinity. */
typedef struct survey {
    const snow_quantizer *quantizer;
    const snow_transfer *transfer;
    bool wide;
    int64_t first, last; /* places; negated if data fall as natives rise */
} survey;

static bool is_wide(snow_type type) {
    return snow_type_size(type) > 2;
}

/* The double that is `place` doubles above 0 (below, if negative). */
static double double_at(int64_t place) {
    uint64_t bits =
        place < 0 ? (uint64_t)-place | (uint64_t)1 << 63 : (uint64_t)place;
    return snow_double_of(bits);
}

static double native_at(const survey *s, int64_t place) {
    if (s->quantizer->slope < 0)
        place = -place;
    return s->wide ? double_at(place) : (double)place;
}

static double data_at(const survey *s, int64_t place) {
    return s->quantizer->slope * native_at(s, place) + s->quantizer->intercept;
}

static bool interesting_at(const survey *s, int64_t place) {
    return snow_is_interesting(
        snow_transfer_opacity(s->transfer, data_at(s, place)),
        s->quantizer->threshold);
}

/* The middle of two places; their difference may overflow an int64_t. */
static int64_t middle_of(int64_t low, int64_t high) {
    return low + (int64_t)(((uint64_t)high - (uint64_t)low) / 2);
}

/* The first place from `low` on whose data value is not below `value`; one
 * after the last place if none is. */
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

/* The first place after `first` that differs from `first` in being interesting;
 * `last` does. */
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

/* All runs of interesting places. There are at most one more than opacity
 * points. */
static size_t survey_all(const survey *s, place_run *runs) {
    const snow_transfer *transfer = s->transfer;
    size_t count = 0;
    int64_t begin = s->first;
    if (transfer->log) /* values up to 0 are transparent */
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

/* Stores the runs as native values, in rising order. */
static void store_native_runs(const survey *s, const place_run *runs,
                              size_t count, snow_quantizer *quantizer) {
    bool falls = quantizer->slope < 0;
    quantizer->native_run_count = count;
    for (size_t n = 0; n < count; n++) {
        place_run run = runs[falls ? count - 1 - n : n];
        quantizer->native_runs[n].first =
            native_at(s, falls ? run.last : run.first);
        quantizer->native_runs[n].last =
            native_at(s, falls ? run.first : run.last);
    }
}

static snow_status find_native_runs(snow_context *context,
                                    const snow_transfer *transfer,
                                    snow_quantizer *quantizer) {
    survey s = {.quantizer = quantizer,
                .transfer = transfer,
                .wide = is_wide(quantizer->type),
                .first = quantizer->lowest,
                .last = quantizer->lowest + (int64_t)quantizer->codes - 1};
    if (s.wide) {
        s.last = (int64_t)snow_bits_of(INFINITY);
        s.first = -s.last;
    } else if (quantizer->slope < 0) {
        int64_t first = s.first;
        s.first = -s.last;
        s.last = -first;
    }
    size_t capacity = transfer->opacity_count + 1;
    place_run *runs;
    SNOW_TRY(snow_reserve(context, &quantizer->places,
                          &quantizer->places_capacity, 0,
                          capacity * sizeof *runs));
    SNOW_TRY(snow_reserve(context, &quantizer->native_runs,
                          &quantizer->native_runs_capacity, 0,
                          capacity * sizeof *quantizer->native_runs));
    runs = quantizer->places;
    store_native_runs(&s, runs, survey_all(&s, runs), quantizer);
    return SNOW_STATUS_OK;
}

/* 8- and 16-bit types: the runs as codes, and the table of all codes. */
static snow_status make_table(snow_context *context,
                              snow_quantizer *quantizer) {
    SNOW_TRY(snow_reserve(context, &quantizer->keep, &quantizer->keep_capacity,
                          0, quantizer->codes));
    memset(quantizer->keep, 0, quantizer->codes);
    bool fits = quantizer->native_run_count <= SNOW_KEPT_RUNS;
    quantizer->run_count = fits ? (int)quantizer->native_run_count : -1;
    for (size_t n = 0; n < quantizer->native_run_count; n++) {
        int32_t first =
            (int32_t)quantizer->native_runs[n].first - quantizer->lowest;
        int32_t last =
            (int32_t)quantizer->native_runs[n].last - quantizer->lowest;
        memset(quantizer->keep + first, 1, (size_t)(last - first) + 1);
        if (fits) {
            quantizer->runs[n].first = (uint16_t)first;
            quantizer->runs[n].last = (uint16_t)last;
        }
    }
    return SNOW_STATUS_OK;
}

/* --- wider types ---------------------------------------------------------- */

/* Merges the values of both kinds of points into `stops`, without duplicates.
 */
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
                              snow_quantizer *quantizer) {
    size_t points = transfer->color_count + transfer->opacity_count;
    SNOW_TRY(snow_reserve(context, &quantizer->stops,
                          &quantizer->stops_capacity, 0,
                          points * sizeof *quantizer->stops));
    size_t count = merge_values(transfer, quantizer->stops);
    if (count > STRETCHES_MOST) {
        size_t step = (count - 1) / STRETCHES_MOST + 1, kept = 0;
        double last = quantizer->stops[count - 1];
        for (size_t n = 0; n + 1 < count; n += step)
            quantizer->stops[kept++] = quantizer->stops[n];
        quantizer->stops[kept++] = last;
        count = kept;
    }
    quantizer->stop_count = count;
    /* One code lies below the first stop and one above the last. */
    quantizer->stretch_codes =
        count > 1 ? (quantizer->codes - 2) / (count - 1) : 0;
    return SNOW_STATUS_OK;
}

/* The number of stops that are not above a value. */
static size_t stops_up_to(const snow_quantizer *quantizer, double value) {
    size_t low = 0, high = quantizer->stop_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (quantizer->stops[middle] > value)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static size_t wide_code(const snow_quantizer *quantizer, double value) {
    size_t up_to = stops_up_to(quantizer, value);
    if (up_to == 0)
        return 0;
    size_t first = 1 + (up_to - 1) * quantizer->stretch_codes;
    if (up_to == quantizer->stop_count)
        return first;
    double a = quantizer->stops[up_to - 1], b = quantizer->stops[up_to];
    double part = quantizer->log    ? snow_part_of_decades(value, a, b)
                  : isfinite(b - a) ? (value - a) / (b - a)
                                    : (value / 2 - a / 2) / (b / 2 - a / 2);
    size_t place = (size_t)(part * (double)quantizer->stretch_codes);
    return first + (place < quantizer->stretch_codes
                        ? place
                        : quantizer->stretch_codes - 1);
}

/* The value at a fraction of the way from a to b, in logarithms. */
static double between_decades(double a, double b, double part) {
    double from = snow_log2_rising(a), to = snow_log2_rising(b);
    double value = snow_exp2(from + (to - from) * part);
    return value > a ? value : a;
}

/* The middle of a code's part of its stretch. It stays within the stretch
 * whatever the rounding, so that no value falls on the wrong side of a step. */
static double wide_value(const snow_quantizer *quantizer, size_t code) {
    const double *stops = quantizer->stops;
    if (code == 0)
        return nextafter(stops[0], -INFINITY);
    size_t stretch = quantizer->stop_count;
    if (quantizer->stretch_codes) /* 32-bit division is faster */
        stretch = (uint32_t)(code - 1) / (uint32_t)quantizer->stretch_codes;
    if (stretch + 1 >= quantizer->stop_count)
        return stops[quantizer->stop_count - 1];
    size_t place = code - 1 - stretch * quantizer->stretch_codes;
    double part = ((double)place + 0.5) / (double)quantizer->stretch_codes;
    double a = stops[stretch], b = stops[stretch + 1];
    double value =
        isfinite(b - a) ? a + (b - a) * part : a * (1 - part) + b * part;
    if (quantizer->log)
        value = between_decades(a, b, part);
    return value < b ? value : nextafter(b, -INFINITY);
}

/* --- quantizers - --------------------------------------------------------- */

snow_status snow_quantizer_make(snow_context *context,
                                const snow_volume *volume,
                                const snow_transfer *transfer, double threshold,
                                snow_quantizer *quantizer) {
    const snow_volume_info *info = &volume->info;
    quantizer->type = info->type;
    quantizer->slope = info->slope;
    quantizer->intercept = info->intercept;
    quantizer->threshold = threshold;
    quantizer->bytes = snow_type_size(info->type) == 1 ? 1 : 2;
    quantizer->codes = snow_type_size(info->type) == 1 ? 256 : 65536;
    quantizer->lowest = info->type == SNOW_TYPE_INT8    ? INT8_MIN
                        : info->type == SNOW_TYPE_INT16 ? INT16_MIN
                                                        : 0;
    quantizer->log = transfer->log;
    quantizer->run_count = 0;
    quantizer->stop_count = quantizer->stretch_codes = 0;
    SNOW_TRY(find_native_runs(context, transfer, quantizer));
    return is_wide(info->type) ? make_stops(context, transfer, quantizer)
                               : make_table(context, quantizer);
}

void snow_quantizer_fini(snow_context *context, snow_quantizer *quantizer) {
    snow_release(context, quantizer->keep);
    snow_release(context, quantizer->native_runs);
    snow_release(context, quantizer->places);
    snow_release(context, quantizer->stops);
    *quantizer = (snow_quantizer){.type = SNOW_TYPE_NONE};
}

bool snow_quantizer_same(const snow_quantizer *a, const snow_quantizer *b) {
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
static bool in_runs(const snow_quantizer *quantizer, double native) {
    size_t low = 0, high = quantizer->native_run_count; /* first run beyond */
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (quantizer->native_runs[middle].first <= native)
            low = middle + 1;
        else
            high = middle;
    }
    return low > 0 && native <= quantizer->native_runs[low - 1].last;
}

bool snow_quantizer_code(const snow_quantizer *quantizer, double native,
                         uint16_t *code) {
    if (!is_wide(quantizer->type)) {
        *code = (uint16_t)(native - quantizer->lowest + 0.5);
        return quantizer->keep[*code];
    }
    bool interesting = in_runs(quantizer, native);
    *code = interesting
                ? (uint16_t)wide_code(quantizer, quantizer->slope * native +
                                                     quantizer->intercept)
                : 0;
    return interesting;
}

double snow_quantizer_value(const snow_quantizer *quantizer, size_t code) {
    if (is_wide(quantizer->type))
        return wide_value(quantizer, code);
    return quantizer->slope * ((double)quantizer->lowest + (double)code) +
           quantizer->intercept;
}
