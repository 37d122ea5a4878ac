/* transfer/scan.c - whether a volume of floats with fractions is a scan, whose
 * file did not come along: an array of CT or MR, say, divided by its maximum.
 *
 * Two traits of scans are looked for.  Noise turns from voxel to voxel: of
 * three values beside one another the middle one is the largest or the smallest
 * in two of three cases (turning points: Bienaymé 1874), in computed turbulence
 * in less than half.  And scanners write whole numbers: whatever they were
 * multiplied with, their values lie on even steps.  Analytic fields may do so
 * too, but are smooth.  Thresholds were found by trying real volumes and
 * phantoms.
 *
 *   turns          0      0.15            0.5     2/3
 *   on steps       field   |  scan
 *   others         field                   |  scan, unless of both signs */
#include "transfer/walk.h"

#include <math.h>

#define ROUGH 0.15
#define NOISY 0.5

/* Values are counted in bins.  Steps are at least so many bins, and no more
 * than a share of the square of the number of values: of so few random values
 * two would be nearer to one another. */
#define TABLES 4
#define BINS (TABLES * SNOW_DIGITS)
#define LEAST_STEP 7
#define CHANCE 8

/* Differences below this share of the values' reach are nothing. */
#define FLAT 0.001

/* The state of looking at the voxels. */
typedef struct scan_look {
    const snow_histogram *histogram;
    double low, scale, flat;
    uint64_t *bins, turns, slopes; /* of three voxels */
} scan_look;

/* Voxels that begin at `x` in a row of `width`. */
static void look_at(scan_look *s, const double *values, size_t count,
                    uint64_t x, uint64_t width) {
    for (size_t i = 0; i < count; i++) {
        double bin = (values[i] - s->low) * s->scale;
        if (bin >= 0 && bin < BINS)
            s->bins[(size_t)bin]++;
    }
    for (size_t i = 2; i < count; i++) {
        double before = values[i - 1] - values[i - 2];
        double after = values[i] - values[i - 1];
        bool within = (x + i) % width >= 2;
        if (!within || !(fabs(before) > s->flat) || !(fabs(after) > s->flat))
            continue;
        s->slopes++;
        s->turns += (before > 0) != (after > 0);
    }
}

/* `user` points to a scan_look. */
static snow_status look_at_slab(const snow_volume *slab, void *user) {
    double values[SNOW_WALK_BLOCK];
    size_t count;
    scan_look *s = user;
    snow_voxel_walk w = snow_voxel_walk_begin(s->histogram, slab, false,
                                              SNOW_HISTOGRAM_SAMPLED);
    while ((count = snow_voxel_walk_next_block(&w, values)))
        look_at(s, values, count, w.at - count, (uint64_t)w.box.dims[0]);
    return SNOW_STATUS_OK;
}

static bool on_steps(const uint64_t *bins) {
    double values = 0, step = BINS;
    for (int i = 0, last = -BINS; i < BINS; i++) {
        if (!bins[i])
            continue;
        step = fmin(step, i - last);
        last = i;
        values++;
    }
    return step >= LEAST_STEP && BINS / step <= values * values / CHANCE;
}

static snow_status look(const snow_histogram *histogram, scan_look *s) {
    SNOW_TRY(snow_histogram_visit(histogram, SNOW_HISTOGRAM_SAMPLED,
                                  look_at_slab, s));
    SNOW_TRY(snow_histogram_sum(histogram, &s->turns, 1));
    SNOW_TRY(snow_histogram_sum(histogram, &s->slopes, 1));
    for (int n = 0; n < TABLES; n++)
        SNOW_TRY(
            snow_histogram_sum_table(histogram, s->bins + n * SNOW_DIGITS));
    return SNOW_STATUS_OK;
}

snow_status snow_is_scan(const snow_histogram *histogram, double low,
                         double high, bool is_signed, bool *is_scan) {
    scan_look s = {.histogram = histogram,
                   .low = low,
                   .scale = BINS / (high - low),
                   .flat = FLAT * (high - low)};
    snow_status status = snow_histogram_new_tables(histogram, TABLES, &s.bins);
    if (status == SNOW_STATUS_OK)
        status = look(histogram, &s);
    double turns = (double)s.turns / (double)(s.slopes ? s.slopes : 1);
    *is_scan =
        status == SNOW_STATUS_OK && ((turns >= NOISY && !is_signed) ||
                                     (turns >= ROUGH && on_steps(s.bins)));
    snow_release(histogram->volume->context, s.bins);
    return status;
}
