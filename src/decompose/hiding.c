/* decompose/hiding.c - see hiding.h.  Numbers are whole ones, so that all ranks
 * find the same slabs. */
#include "decompose/hiding.h"

#include <math.h>
#include <string.h>

/* A pixel is closed behind this optical depth, where it is within half an 8-bit
 * step of opaque; and that depth as a number. */
#define CLOSED_DEPTH 6.234
#define CLOSED 8192

/* Samples are fewer, so that a cut takes little time. */
#define SAMPLES_MOST (INT64_C(1) << 21)

/* Voxels from ray to ray of a row, at least; so many rays are a span. */
#define LEAST_STEP 2
#define RAYS_OF_SPAN 16

/* What a sample is worth of interesting voxels, where rays are four apart. */
#define SAMPLE 2

/* A span in which nothing is drawn costs so much less
 * (classify/count_interesting.c). */
#define SPARE 12

/* Trials of a cut. */
#define TRIALS 9

/* --- rays ----------------------------------------------------------------- */

/* Where rays meet the middle slice: scale * voxel + shift. */
typedef struct line {
    double scale, shift;
} line;

/* The distance of a slice from the eye, at least one slice. */
static double distance_to(const snow_hiding *h, double slice) {
    const double away = h->viewer.along[h->axes[2]];
    return fmax((slice - h->viewer.eye[h->axes[2]]) * away, 1);
}

static line line_of(const snow_hiding *h, int on, int64_t slice) {
    const snow_viewer *viewer = &h->viewer;
    const double middle = (double)(h->dims[2] - 1) / 2;
    line l = {1, (middle - (double)slice) * viewer->along[h->axes[on]] *
                     viewer->along[h->axes[2]]};
    if (viewer->perspective) {
        l.scale = distance_to(h, middle) / distance_to(h, (double)slice);
        l.shift = viewer->eye[h->axes[on]] * (1 - l.scale);
    }
    return l;
}

/* The rays that meet the grid, from a step on. */
static void place_rays(snow_hiding *h, int on) {
    double low = INFINITY, high = -INFINITY;
    for (int end = 0; end < 2; end++) {
        const line l = line_of(h, on, end ? h->dims[2] - 1 : 0);
        low = fmin(low, l.shift);
        high = fmax(high, l.shift + l.scale * (double)(h->dims[on] - 1));
    }
    h->first[on] = low;
    h->rays[on] = (int64_t)fmin((high - low) / h->step[on], 0x1p31) + 1;
    if (on == 0)
        h->rays[0] = ((h->rays[0] - 1) / RAYS_OF_SPAN + 1) * RAYS_OF_SPAN;
}

static bool are_many(const snow_hiding *h) {
    return (double)h->dims[0] / h->step[0] * (double)h->dims[1] / h->step[1] *
               (double)h->dims[2] >
           SAMPLES_MOST;
}

snow_status snow_hiding_new(snow_context *context, const int64_t dims[3],
                            int axis, const snow_viewer *viewer, double length,
                            snow_hiding *out) {
    const int axes[3] = {axis == 0, axis == 2 ? 1 : 2, axis};
    *out = (snow_hiding){
        .viewer = *viewer, .length = length, .step = {LEAST_STEP, 1}};
    for (int n = 0; n < 3; n++) {
        out->axes[n] = axes[n];
        out->dims[n] = dims[axes[n]];
    }
    place_rays(out, 0);
    place_rays(out, 1);
    while (are_many(out) && out->rays[0] * out->rays[1] > RAYS_OF_SPAN) {
        const int on = out->step[1] < 8 * out->step[0];
        out->step[on] *= 2;
        place_rays(out, on);
    }
    const size_t words = snow_hiding_words(out);
    SNOW_TRY(SNOW_RESERVE(context, out->depths, 0, words));
    memset(out->depths, 0, words * sizeof *out->depths);
    return SNOW_STATUS_OK;
}

void snow_hiding_free(snow_context *context, snow_hiding *hiding) {
    snow_release(context, hiding->depths);
}

size_t snow_hiding_words(const snow_hiding *hiding) {
    return (size_t)(hiding->rays[0] * hiding->rays[1] * hiding->dims[2] / 4);
}

/* A ray has the voxel next to it, and no other. */
int64_t snow_hiding_ray(const snow_hiding *h, int on, int64_t slice,
                        int64_t at) {
    const line l = line_of(h, on, slice);
    const double place = l.scale * (double)at + l.shift - h->first[on];
    const double ray = rint(place / h->step[on]);
    const double next = ray * h->step[on] + h->first[on] - l.shift;
    if (rint(next / l.scale) != (double)at || ray < 0 ||
        ray >= (double)h->rays[on])
        return -1;
    return (int64_t)ray;
}

void snow_hiding_add(snow_hiding *h, const int64_t ray[2], int64_t slice,
                     double opacity) {
    const int64_t sample = (slice * h->rays[1] + ray[1]) * h->rays[0] + ray[0];
    const double depth =
        -log1p(-fmin(opacity, 1)) * h->length / CLOSED_DEPTH * CLOSED;
    const int64_t number = (int64_t)fmax(fmin(depth, CLOSED), 1);
    h->depths[sample / 4] |= number << 16 * (sample % 4);
}

/* --- slabs ---------------------------------------------------------------- */

/* A walk along all rays at once, from front to back, four to a number. */
typedef struct walk {
    const snow_hiding *hiding;
    const int64_t *sums;
    int64_t words, slices; /* of a slice; in all */
    int span;
    uint64_t *before; /* depths of rays, from the front of the slab */
    double looked;    /* the cost of a slice where nothing is seen */
    double *alone;    /* of slices that nothing hides, by rays of a voxel */
} walk;

/* The slice that is so many behind the first. */
static int64_t slice_at(const walk *w, int64_t number) {
    return w->hiding->viewer.along[w->hiding->axes[2]] < 0
               ? w->slices - 1 - number
               : number;
}

/* A bit each of four numbers: the lowest. */
#define LOWEST UINT64_C(0x0001000100010001)

/* What is drawn of a span, whose samples are before the next slice then: a
 * pixel beside a sample is drawn as well. */
static int cost_of_span(const walk *w, const uint64_t *depths,
                        uint64_t *before) {
    uint64_t seen = 0, drawn = 0;
    for (int n = 0; n < RAYS_OF_SPAN / 4; n++) {
        const uint64_t open = ~before[n] / CLOSED & LOWEST;
        const uint64_t there = (depths[n] + 0x7fff * LOWEST) >> 15 & LOWEST;
        seen += there & open;
        drawn |= (there | there << 16 | there >> 16) & open;
        before[n] += depths[n] & open * 0xffff;
    }
    return drawn
               ? w->span - w->span / SPARE + (int)(seen * LOWEST >> 48) * SAMPLE
               : 0;
}

/* The rays along `on` that meet a slice. */
static void find_rays(const snow_hiding *h, int on, int64_t slice,
                      int64_t *first, int64_t *end) {
    const line l = line_of(h, on, slice);
    const double low = l.shift - h->first[on];
    const double high = low + l.scale * (double)(h->dims[on] - 1);
    *first = (int64_t)fmax(low / h->step[on], 0);
    *end = (int64_t)fmin(high / h->step[on] + 2, (double)h->rays[on]);
}

/* The cost of a slice by its samples that can be seen. */
static double cost_seen(const walk *w, int64_t slice) {
    const snow_hiding *h = w->hiding;
    const uint64_t *depths = (const uint64_t *)h->depths + slice * w->words;
    int64_t cost = 0, first[2], end[2];
    find_rays(h, 0, slice, &first[0], &end[0]);
    find_rays(h, 1, slice, &first[1], &end[1]);
    for (int64_t row = first[1]; row < end[1]; row++)
        for (int64_t ray = first[0] / RAYS_OF_SPAN * RAYS_OF_SPAN; ray < end[0];
             ray += RAYS_OF_SPAN) {
            const int64_t n = (row * h->rays[0] + ray) / 4;
            cost += cost_of_span(w, depths + n, w->before + n);
        }
    return (double)cost + w->looked;
}

/* What is before slices from the front of a slab on: nothing. */
static void begin_slab(const walk *w) {
    memset(w->before, 0, (size_t)w->words * sizeof *w->before);
}

static double cost_behind(const walk *w, int64_t number) {
    const int64_t slice = slice_at(w, number);
    return (double)(w->sums[slice + 1] - w->sums[slice]) * cost_seen(w, slice) /
           w->alone[slice];
}

/* Fills slabs from the front up to a cost; false: there are too few. */
static bool fill(const walk *w, double most, int64_t longest, int parts,
                 int64_t *starts) {
    int64_t at = 0;
    for (int part = 0; part < parts; part++) {
        double sum = 0;
        starts[part] = at;
        begin_slab(w);
        int64_t end = at;
        for (; end < w->slices && end < at + longest; end++) {
            sum += cost_behind(w, end);
            if (sum > most)
                break;
        }
        at = end;
    }
    starts[parts] = at;
    return at == w->slices;
}

/* Trials between a cost that is too small and one that suffices. */
static void search(const walk *w, int64_t longest, int parts, int64_t *trial,
                   int64_t *starts) {
    double low = 0, high = (double)w->sums[w->slices] / parts;
    const size_t bytes = ((size_t)parts + 1) * sizeof *starts;
    while (!fill(w, high, longest, parts, starts)) {
        low = high;
        high *= 1.5;
    }
    for (int n = 0; n < TRIALS; n++) {
        const double middle = (low + high) / 2;
        if (fill(w, middle, longest, parts, trial)) {
            memcpy(starts, trial, bytes);
            high = middle;
        } else
            low = middle;
    }
}

/* Slabs from front to back are ranks from last to first. */
static void turn(int64_t slices, int parts, int64_t *starts) {
    for (int low = 0, high = parts; low <= high; low++, high--) {
        const int64_t start = slices - starts[low];
        starts[low] = slices - starts[high];
        starts[high] = start;
    }
}

snow_status snow_hiding_cut(snow_context *context, const snow_hiding *hiding,
                            const int64_t *sums, int span, int64_t longest,
                            int parts, int64_t *starts) {
    walk w = {.hiding = hiding,
              .sums = sums,
              .words = hiding->rays[0] * hiding->rays[1] / 4,
              .slices = hiding->dims[2],
              .span = span};
    w.looked = (double)(span / SPARE) * (double)hiding->dims[0] *
               (double)hiding->dims[1] /
               (RAYS_OF_SPAN * hiding->step[0] * hiding->step[1]);
    int64_t *trial = NULL;
    snow_status status = SNOW_RESERVE(context, trial, 0, parts + 1);
    if (status == SNOW_STATUS_OK)
        status = SNOW_RESERVE(context, w.before, 0, w.words);
    if (status == SNOW_STATUS_OK)
        status = SNOW_RESERVE(context, w.alone, 0, w.slices);
    if (status == SNOW_STATUS_OK) {
        for (int64_t slice = 0; slice < w.slices; slice++) {
            begin_slab(&w);
            const double near = line_of(hiding, 0, slice).scale;
            w.alone[slice] = cost_seen(&w, slice) / (near * near);
        }
        search(&w, longest, parts, trial, starts);
        if (slice_at(&w, 0))
            turn(w.slices, parts, starts);
    }
    snow_release(context, w.alone);
    snow_release(context, w.before);
    snow_release(context, trial);
    return status;
}
