/* volume/refine.c - cells that are several voxels wide, as the voxels
 * (refine.h). */
#include "volume/refine.h"
#include "base/minmax.h"

#include <math.h>
#include <string.h>

/* The centres around a cell's own, which is in the middle; those that voxels
 * are blended from lie within. */
#define STENCIL (2 * SNOW_REFINE_REACH + 1)
#define OWN SNOW_REFINE_REACH
#define INNER (OWN - 2)

/* Values that are blended at once, if all are there. */
#define AT_ONCE 64

/* The exponent of a double: all ones of what is not finite, which one more at
 * its end carries into the sign. */
#define EXPONENT UINT64_C(0x7ff0000000000000)
#define EXPONENT_END (UINT64_C(1) << 52)

/* The weights of a voxel's inner stencil, and on which side of its cell's
 * centre it lies: the last of the centres is not among its four, or the
 * first. */
typedef struct place {
    double weights[5];
    bool above, centred;
} place;

typedef struct refining {
    const double *cells;
    const snow_box *box;
    const int64_t *ratio;
    place *places[3];    /* of the voxels of a cell */
    double *none;        /* a slice of no values, ... */
    double *slice, *row; /* ... of blended ones, a row of them, without values
                            before and behind, ... */
    double *part;        /* ... one voxel of each of its cells, ... */
    double *out;         /* ... and a row of voxels */
} refining;

/* Lagrange's weights of the four centres at `at`, counted from the cell's. */
static void weigh(double at, place *out) {
    *out = (place){.above = at > 0, .centred = fabs(at) < 1e-12};
    if (out->centred)
        return;
    const int first = out->above ? 1 : 0;
    for (int i = first; i < first + 4; i++) {
        double weight = 1;
        for (int j = first; j < first + 4; j++)
            if (j != i)
                weight *= (at - (j - 2)) / (i - j);
        out->weights[i] = weight;
    }
}

/* What follows on d, c, b, a: by the parabola through the last three where
 * values go on smoothly, but not past 0; else the last one again. */
static double extrapolate(double a, double b, double c, double d) {
    if (!isfinite(b) || !isfinite(c))
        return a;
    const double last = a - b, bend = last - (b - c);
    const double before = isfinite(d) ? (b - c) - (c - d) : bend;
    const double next = a + last + bend;
    const double low = fmin(fabs(bend), fabs(before));
    const double high = fmax(fabs(bend), fabs(before));
    if (!(high <= 0.5 * fabs(last) ||
          (high <= 2 * low && (bend > 0) == (before > 0))) ||
        !isfinite(next))
        return a;
    return (next > 0 && a < 0) || (next < 0 && a > 0) ? 0 : next;
}

/* Replaces missing values of the inner stencil, whose own is there. */
static void complete(double p[STENCIL]) {
    const bool below = isfinite(p[OWN - 1]), above = isfinite(p[OWN + 1]);
    if (!above)
        p[OWN + 1] = extrapolate(p[OWN], p[OWN - 1], p[OWN - 2], p[OWN - 3]);
    if (!below)
        p[OWN - 1] =
            above ? extrapolate(p[OWN], p[OWN + 1], p[OWN + 2], p[OWN + 3])
                  : p[OWN];
    if (!above || !isfinite(p[OWN + 2]))
        p[OWN + 2] = extrapolate(p[OWN + 1], p[OWN], p[OWN - 1], p[OWN - 2]);
    if (!below || !isfinite(p[OWN - 2]))
        p[OWN - 2] = extrapolate(p[OWN - 1], p[OWN], p[OWN + 1], p[OWN + 2]);
}

static double at_place(const double p[STENCIL], const place *at) {
    const double *inner = p + INNER, *four = inner + at->above;
    double sum = 0;
    for (int i = 0; i < 5; i++)
        sum += at->weights[i] * inner[i];
    const double low =
        SNOW_MIN(SNOW_MIN(four[0], four[1]), SNOW_MIN(four[2], four[3]));
    const double high =
        SNOW_MAX(SNOW_MAX(four[0], four[1]), SNOW_MAX(four[2], four[3]));
    return sum < low ? low : SNOW_MIN(high, sum);
}

/* Returns whether its own value can be blended with others; completes these. */
static bool prepare(double p[STENCIL]) {
    if (!isfinite(p[OWN]))
        return false;
    if (!isfinite(p[OWN - 2] + p[OWN - 1] + p[OWN] + p[OWN + 1] + p[OWN + 2]))
        complete(p);
    return true;
}

/* Blends `count` values as if all were there; whether all are.  Without a
 * branch, so that several are blended at once. */
static bool blend_all(const double *const from[STENCIL], const place *at,
                      int64_t count, double *restrict out) {
    const double *const *inner = from + INNER, *const *four = inner + at->above;
    const double *a = inner[0], *b = inner[1], *c = inner[2], *d = inner[3],
                 *e = inner[4];
    const double *first = four[0], *last = four[3];
    const double *left = four[1], *right = four[2], *w = at->weights;
    const double wa = w[0], wb = w[1], wc = w[2], wd = w[3], we = w[4];
    uint64_t lacks = 0;
    for (int64_t i = 0; i < count; i++) {
        const double low =
            SNOW_MIN(SNOW_MIN(first[i], left[i]), SNOW_MIN(right[i], last[i]));
        const double high =
            SNOW_MAX(SNOW_MAX(first[i], left[i]), SNOW_MAX(right[i], last[i]));
        const double sum =
            0 + wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i] + we * e[i];
        out[i] = sum < low ? low : SNOW_MIN(high, sum);
        const double all = a[i] + b[i] + c[i] + d[i] + e[i];
        uint64_t bits;
        memcpy(&bits, &all, sizeof bits);
        lacks |= (bits & EXPONENT) + EXPONENT_END;
    }
    return !(lacks >> 63);
}

/* Blends rows or slices, or a row with itself moved aside, value by value. */
static void blend(const double *const from[STENCIL], const place *at,
                  int64_t count, double *out) {
    if (at->centred) {
        memcpy(out, from[OWN], (size_t)count * sizeof *out);
        return;
    }
    for (int64_t first = 0; first < count; first += AT_ONCE) {
        const int64_t left = count - first;
        const int64_t some = left < AT_ONCE ? left : AT_ONCE;
        const double *part[STENCIL];
        for (int k = 0; k < STENCIL; k++)
            part[k] = from[k] + first;
        if (blend_all(part, at, some, out + first))
            continue;
        for (int64_t i = 0; i < some; i++) {
            double p[STENCIL];
            for (int k = 0; k < STENCIL; k++)
                p[k] = part[k][i];
            out[first + i] = prepare(p) ? at_place(p, at) : p[OWN];
        }
    }
}

/* The rows or slices around number `own` of `count`, `step` values apart. */
static void choose(const refining *r, const double *first, int64_t step,
                   int64_t own, int64_t count, const double *out[STENCIL]) {
    for (int i = 0; i < STENCIL; i++) {
        int64_t at = own + i - OWN;
        out[i] = at >= 0 && at < count ? first + at * step : r->none;
    }
}

/* A row of cells as voxels `first` .. `first + count - 1` of the grid: the
 * first voxels of all cells, the second ones, and so on. */
static void spread_row(const refining *r, int64_t first, int64_t count) {
    const int64_t ratio = r->ratio[0], cell = first / ratio;
    const int64_t cells = (first + count - 1) / ratio - cell + 1;
    const double *from[STENCIL];
    for (int i = 0; i < STENCIL; i++)
        from[i] = r->row + (cell - r->box->first[0]) + i - OWN;
    for (int64_t k = 0; k < ratio; k++) {
        blend(from, &r->places[0][k], cells, r->part);
        const int64_t before = first - cell * ratio - k; /* -ratio .. ratio */
        const int64_t skipped = before > 0 ? 1 : 0;
        double *to = r->out - before;
        for (int64_t i = skipped; i * ratio < count + before; i++)
            to[i * ratio] = r->part[i];
    }
}

/* Blends slices only where a row of them is wanted. */
static void refine_slice(const refining *r, const snow_box *voxels, int64_t z,
                         snow_refined_fn *take, void *user) {
    const snow_box *box = r->box;
    const int64_t width = box->count[0], slice = width * box->count[1];
    const double *from[STENCIL];
    bool blended = false;
    for (int64_t y = voxels->first[1]; y < voxels->first[1] + voxels->count[1];
         y++) {
        if (!take(user, y, z, NULL))
            continue;
        if (!blended) {
            choose(r, r->cells, slice, z / r->ratio[2] - box->first[2],
                   box->count[2], from);
            blend(from, &r->places[2][z % r->ratio[2]], slice, r->slice);
            blended = true;
        }
        choose(r, r->slice, width, y / r->ratio[1] - box->first[1],
               box->count[1], from);
        blend(from, &r->places[1][y % r->ratio[1]], width, r->row);
        spread_row(r, voxels->first[0], voxels->count[0]);
        take(user, y, z, r->out);
    }
}

void snow_cells_add(const double *values, const float *shares, int64_t first,
                    int64_t count, const int64_t ratio[3], double *to_values,
                    float *to_shares) {
    const float part = 1 / (float)(ratio[0] * ratio[1] * ratio[2]);
    int64_t left = ratio[0] - first % ratio[0], at = 0;
    for (int64_t i = 0; i < count; i++) {
        const float share = shares ? shares[i] : isfinite(values[i]) ? 1 : 0;
        if (share > 0)
            to_values[at] += (double)(share * part) * values[i];
        to_shares[at] += share * part;
        if (--left == 0) {
            left = ratio[0];
            at++;
        }
    }
}

/* All scratch memory, in one block of values and one of places. */
static snow_status allocate_scratch(snow_context *context, refining *r,
                                    const snow_box *voxels, place **places,
                                    double **values) {
    const int64_t *count = r->box->count;
    const uint64_t slice = (uint64_t)(count[0] * count[1]);
    *values = snow_allocate_array(
        context,
        2 * slice + (uint64_t)(2 * count[0] + 2 * OWN + voxels->count[0]),
        sizeof **values);
    *places = snow_allocate_array(
        context, (uint64_t)(r->ratio[0] + r->ratio[1] + r->ratio[2]),
        sizeof **places);
    if (!*values || !*places)
        return SNOW_STATUS_NO_MEMORY;
    r->none = *values;
    r->slice = r->none + slice;
    r->row = r->slice + slice + OWN;
    r->part = r->row + count[0] + OWN;
    r->out = r->part + count[0];
    for (uint64_t i = 0; i < slice; i++)
        r->none[i] = NAN;
    for (int i = 0; i < OWN; i++)
        r->row[i - OWN] = r->row[count[0] + i] = NAN;
    place *at = *places;
    for (int axis = 0; axis < 3; axis++) {
        r->places[axis] = at;
        for (int64_t k = 0; k < r->ratio[axis]; k++)
            weigh(((double)k + 0.5) / (double)r->ratio[axis] - 0.5, at++);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_cells_refine(snow_context *context, const double *cells,
                              const snow_box *box, const int64_t ratio[3],
                              const snow_box *voxels, snow_refined_fn *take,
                              void *user) {
    refining r = {.cells = cells, .box = box, .ratio = ratio};
    place *places = NULL;
    double *values = NULL;
    snow_status status =
        allocate_scratch(context, &r, voxels, &places, &values);
    if (status == SNOW_STATUS_OK)
        for (int64_t z = voxels->first[2];
             z < voxels->first[2] + voxels->count[2]; z++)
            refine_slice(&r, voxels, z, take, user);
    snow_release(context, places);
    snow_release(context, values);
    return status;
}
