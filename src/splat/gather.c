/* splat/gather.c - splatting in gather form; see splat/gather.h. */
#include "splat/gather.h"
#include "splat/gather_vec.h"

#include <math.h>

/* Pixels and windows added to bounds, so that rounding loses nothing; the map
 * of reached windows decides. */
#define SLACK 1e-3

#define CHUNK SNOW_GATHER_CHUNK /* pixels located at once */

/* The alpha of an opaque pixel. */
#define OPAQUE (1 - 0x1p-22f)

#if SNOW_HAS_AVX
/* Runs of set bits from pixel `begin` (a multiple of 16) to before `end` and
 * the image's edge; returns their number. */
static int find_runs(const uint16_t *reached, int begin, int end, int width,
                     snow_run *runs) {
    int count = 0, open = -1; /* start of the run that is still open */
    for (int x = begin; x < end; x += CHUNK) {
        unsigned bits = reached[x / CHUNK];
        if (x + CHUNK > width)
            bits &= (1u << (width - x)) - 1;
        if (bits == (open < 0 ? 0 : 0xffff))
            continue; /* no run begins or ends here */
        for (int at = 0; at < CHUNK;) {
            unsigned rest = (open < 0 ? bits : ~bits & 0xffff) >> at;
            if (!rest)
                break;
            at += __builtin_ctz(rest);
            if (open >= 0)
                runs[count++] = (snow_run){open, x + at};
            open = open < 0 ? x + at : -1;
        }
    }
    if (open >= 0) {
        int last = (end + CHUNK - 1) & -CHUNK;
        runs[count++] = (snow_run){open, last < width ? last : width};
    }
    return count;
}

/* Forces stored values to be loaded again rather than kept in registers: a load
 * spreads weights at no cost. */
#define THROUGH_MEMORY __asm__("" ::: "memory")

typedef struct gather_level {
    snow_gather_fn *grey;
    snow_gather_fn *rgba_small; /* two voxels in reach */
    snow_gather_fn *rgba;
} gather_level;

#define SELECT_AVX2
#include "simd/select.h"
#define WHOLE(word) snow_p16_##word
#include "splat/gather_isa.h"

#define SELECT_AVX512
#include "simd/select.h"
#define WHOLE(word) snow_b16_##word
#include "splat/gather_isa.h"

static snow_gather_fn *pick(snow_isa isa, int channels, int taps_u) {
    if (isa != SNOW_ISA_AVX2 && isa != SNOW_ISA_AVX512)
        return NULL;
    const gather_level *level =
        isa == SNOW_ISA_AVX2 ? &level_avx2 : &level_avx512;
    if (channels == 2)
        return level->grey;
    return taps_u <= 2 ? level->rgba_small : level->rgba;
}
#else
static snow_gather_fn *pick(snow_isa isa, int channels, int taps_u) {
    (void)isa;
    (void)channels;
    (void)taps_u;
    return NULL;
}
#endif

snow_status snow_places_make(snow_context *context, int width,
                             snow_places *places) {
    size_t pixels = ((size_t)width + CHUNK - 1) / CHUNK * CHUNK;
    SNOW_TRY(snow_reserve(context, &places->window, 0, pixels / CHUNK,
                          13 * CHUNK * sizeof(int32_t) + sizeof(uint16_t)));
    places->row_u = places->window + pixels;
    places->row_v = places->row_u + pixels;
    places->rest_u = (float *)(void *)(places->row_v + pixels);
    places->rest_v = places->rest_u + pixels;
    places->u = places->rest_v + pixels;
    places->v = places->u + 4 * pixels;
    places->reached = (uint16_t *)(void *)(places->v + 4 * pixels);
    return SNOW_STATUS_OK;
}

snow_status snow_gatherer_make(snow_context *context, const snow_placement *p,
                               snow_kernel kernel, int support, int channels,
                               snow_isa isa, snow_gatherer *g, bool *serves) {
    snow_scaled_kernel u = snow_scaled_kernel_make(
        kernel, support, hypot(p->inverse[0][0], p->inverse[0][1]));
    snow_scaled_kernel v = snow_scaled_kernel_make(
        kernel, support, hypot(p->inverse[1][0], p->inverse[1][1]));
    *serves = false;
    if (!snow_kernel_table_serve(&u) || !snow_kernel_table_serve(&v))
        return SNOW_STATUS_OK;
    int taps_u = snow_scaled_kernel_taps(&u);
    g->placement = p;
    g->gather = pick(isa, channels, taps_u);
    g->shape = (snow_dense_shape){.columns = p->columns,
                                  .rows = p->rows,
                                  .channels = channels,
                                  .taps_u = taps_u,
                                  .taps_v = snow_scaled_kernel_taps(&v),
                                  .padded_u = (taps_u + 3) / 4 * 4};
    if (!g->gather || !snow_dense_serves(&g->shape))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_kernel_table_make(context, &u, &g->phases_u));
    SNOW_TRY(snow_kernel_table_make(context, &v, &g->phases_v));
    g->cubic = g->phases_u.cubic && g->phases_v.cubic;
    *serves = true;
    return SNOW_STATUS_OK;
}

void snow_gatherer_fini(snow_context *context, snow_gatherer *g) {
    snow_kernel_table_fini(context, &g->phases_u);
    snow_kernel_table_fini(context, &g->phases_v);
    *g = (snow_gatherer){0};
}

/* Image position of voxel (0, 0) of a slice. */
static void slice_origin(const snow_placement *p, int64_t slice,
                         double origin[2]) {
    for (int i = 0; i < 2; i++)
        origin[i] = p->origin[i] + (double)slice * p->step_slice[i];
}

void snow_gather_rows(const snow_gatherer *g, const snow_dense *d,
                      int64_t slice, int *top, int *bottom) {
    const snow_placement *p = g->placement;
    double origin[2], low = INFINITY, high = -INFINITY;
    slice_origin(p, slice, origin);
    for (int corner = 0; corner < 4; corner++) {
        double u = corner & 1 ? (double)d->c1 - 1 + g->shape.taps_u
                              : (double)d->c0 - g->shape.taps_u;
        double v = corner & 2 ? (double)d->r1 - 1 + g->shape.taps_v
                              : (double)d->r0 - g->shape.taps_v;
        double y = origin[1] + u * p->step_u[1] + v * p->step_v[1];
        low = y < low ? y : low; /* fmin() here is more than GCC 12 can take */
        high = y > high ? y : high; /* on ARM: it ends in an internal error */
    }
    *top = (int)fmin(fmax(low - 1, 0), p->height);
    *bottom = (int)fmax(fmin(high + 1, p->height), 0);
    if (d->c0 >= d->c1)
        *top = *bottom = 0;
}

/* Narrows pixels [*first, *end) to where at + x step is in [low, high]. */
static void narrow(double at, double step, double low, double high,
                   double *first, double *end) {
    if (fabs(step) * *end < SLACK) {
        if (at < low - SLACK || at > high + SLACK)
            *end = *first;
        return;
    }
    double a = (low - at) / step, b = (high - at) / step;
    double from = (a < b ? a : b) - 1, upto = (a < b ? b : a) + 1;
    *first = from > *first ? from : *first; /* fmax() may be a call */
    *end = upto < *end ? upto : *end;
}

int snow_gather_row(const snow_gatherer *g, const snow_dense *d, int64_t slice,
                    int y, const uint16_t *open, const snow_places *places,
                    float *pixels, snow_run *runs) {
    const snow_placement *p = g->placement;
    double origin[2], first = 0, end = p->width;
    slice_origin(p, slice, origin);
    double x0 = 0.5 - origin[0], y0 = y + 0.5 - origin[1];
    snow_line line = {
        .u = p->inverse[0][0] * x0 + p->inverse[0][1] * y0 + g->phases_u.reach +
             g->shape.taps_u,
        .v = p->inverse[1][0] * x0 + p->inverse[1][1] * y0 + g->phases_v.reach +
             g->shape.taps_v,
        .du = p->inverse[0][0],
        .dv = p->inverse[1][0],
        .open = open,
    };
    narrow(line.u, line.du, (double)d->c0 + 1, (double)d->c1 + g->shape.taps_u,
           &first, &end);
    narrow(line.v, line.dv, (double)d->r0 + 1, (double)d->r1 + g->shape.taps_v,
           &first, &end);
    if (!(first < end))
        return 0;
    line.first = (int)first;
    line.end = (int)ceil(end);
    return g->gather(g, d, &line, places, pixels, runs);
}

/* Whether any of `count` floats is the alpha of an opaque pixel; without a
 * branch, so that the compiler can vectorize it. */
static bool any_opaque(const float *floats, int count) {
    int any = 0;
    for (int n = 0; n < count; n++)
        any |= floats[n] >= OPAQUE;
    return any;
}

void snow_gather_close(const float *pixels, snow_run run, int channels,
                       uint16_t *open) {
    for (int x = run.first, end; x < run.end; x = end) {
        const float *chunk = pixels + (size_t)x * (size_t)channels;
        uint16_t *bits = &open[x / CHUNK];
        end = (x / CHUNK + 1) * CHUNK;
        end = end < run.end ? end : run.end;
        if (!*bits || !any_opaque(chunk, (end - x) * channels))
            continue;
        for (int n = 0; n < end - x; n++)
            if (chunk[(n + 1) * channels - 1] >= OPAQUE)
                *bits &= (uint16_t) ~(1u << ((x + n) % CHUNK));
    }
}
