/* decompose/ray_grid.c - see ray_grid.h. */
#include "decompose/ray_grid.h"
#include "base/minmax.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Cells across at most, and along the slices; the least voxels of a cell
 * across.  Finer grids did not predict times better. */
#define COLUMNS_MOST 16
#define LAYERS_MOST 32
#define CELL_LEAST 4

/* A pixel is opaque when less than half a step of 8 bits shines through. */
#define FAINT (0.5 / 255)

/* Rays of a cell end one after another: all are open until it has closed half
 * of this many pixels a pixel, and none behind all of it (fitted to times:
 * docs/measurements/ranks.md). */
#define CLOSED 1.5

/* Rows are drawn by so many voxels at a time. */
#define SPAN 32

/* Steps of what closes all rays: enough for faint voxels. */
#define WHOLE_MOST (1 << 20)

/* --- cells ---------------------------------------------------------------- */

static void fill_closes(snow_ray_grid *g) {
    const double faint = log(FAINT);
    /* The sum of a cell whose voxels are all opaque stays below 2^32. */
    int64_t voxels = g->cell[0] * g->cell[1] * g->cell[2];
    for (int i = 0; i < 3; i++)
        if (g->view.axes[i] == 2)
            voxels = voxels / g->cell[i] * ((g->cell[i] - 1) / g->step + 1);
    assert(voxels < INT32_MAX);
    const int64_t most = UINT32_MAX / voxels;
    g->whole = (uint32_t)(most < WHOLE_MOST ? most : WHOLE_MOST);
    for (int n = 0; n < SNOW_RAY_STEPS; n++) {
        const double through = 1 - (double)n / (SNOW_RAY_STEPS - 1);
        const double part =
            through > 0 ? fmin(g->view.path * log(through) / faint, 1) : 1;
        g->closes[n] = (uint32_t)(part / CLOSED * g->whole + 0.5);
    }
}

void snow_ray_grid_make(const snow_ray_view *view, const int64_t dims[3],
                        int64_t step, snow_ray_grid *out) {
    *out = (snow_ray_grid){.view = *view, .step = step > 1 ? step : 1};
    for (int i = 0; i < 3; i++) {
        out->dims[i] = dims[view->axes[i]];
        int64_t most = i < 2 ? COLUMNS_MOST : LAYERS_MOST;
        out->cell[i] = i < 2 ? CELL_LEAST : 1;
        /* Each has slices that are counted. */
        while (out->cell[i] * most < out->dims[i] ||
               (view->axes[i] == 2 && out->cell[i] < out->step))
            out->cell[i] *= 2;
        out->cells[i] = (out->dims[i] - 1) / out->cell[i] + 1;
    }
    fill_closes(out);
}

size_t snow_ray_grid_cells(const snow_ray_grid *g) {
    return (size_t)(g->cells[0] * g->cells[1] * g->cells[2]);
}

int64_t snow_ray_grid_place(const snow_ray_grid *g, int axis, int64_t voxel) {
    int64_t step = 1;
    for (int i = 0; i < 3; step *= g->cells[i], i++)
        if (g->view.axes[i] == axis)
            return voxel / g->cell[i] * step;
    return 0;
}

/* --- what is drawn -------------------------------------------------------- */

static void average(snow_ray_walk *w) {
    const snow_ray_grid *g = w->grid;
    const int64_t *sum = g->sums;
    float *drawn = w->drawn, *closing = w->closing;
    for (int64_t s = 0; s < g->cells[2]; s++)
        for (int64_t v = 0; v < g->cells[1]; v++)
            for (int64_t u = 0; u < g->cells[0]; u++, sum++) {
                /* How many of the volume's voxels in the cell are counted. */
                const int64_t at[3] = {u, v, s};
                double voxels = 1;
                for (int i = 0; i < 3; i++) {
                    const int64_t step = g->view.axes[i] == 2 ? g->step : 1;
                    const int64_t first = at[i] * g->cell[i];
                    const int64_t end =
                        SNOW_MIN(first + g->cell[i], g->dims[i]);
                    voxels *= (double)((end + step - 1) / step -
                                       (first + step - 1) / step);
                }
                const double part = voxels > 0 ? 1 / voxels : 0;
                *drawn++ = (float)((double)(*sum >> 32) * part);
                *closing++ = (float)((double)(*sum & INT64_C(0xffffffff)) *
                                     part / g->whole);
            }
}

snow_status snow_ray_walk_new(snow_context *context, const snow_ray_grid *g,
                              int span, snow_ray_walk *out) {
    *out = (snow_ray_walk){.grid = g, .span = (float)span};
    const size_t cells = snow_ray_grid_cells(g);
    SNOW_TRY(SNOW_RESERVE(context, out->drawn, 0, cells));
    SNOW_TRY(SNOW_RESERVE(context, out->closing, 0, cells));
    SNOW_TRY(SNOW_RESERVE(context, out->closed, 0, g->cells[0] * g->cells[1]));
    average(out);
    return SNOW_STATUS_OK;
}

void snow_ray_walk_free(snow_context *context, snow_ray_walk *w) {
    snow_release(context, w->drawn);
    snow_release(context, w->closing);
    snow_release(context, w->closed);
}

/* The costs of what is there, and of what is drawn of it. */
typedef struct work {
    float all, drawn;
} work;

/* `count` cells of a row, which share spans: as much of a span is drawn as of
 * its cell that is most open. */
static void pass_cells(const snow_ray_walk *w, size_t at, float slices,
                       int64_t count, float *closed, work *sum) {
    const float cell = (float)w->grid->cell[0];
    const float span = w->span * fmaxf(cell / SPAN, 1);
    float widest = 0;
    bool any = false;
    for (int64_t u = 0; u < count; u++) {
        const float here = w->drawn[at + (size_t)u];
        const float closing = w->closing[at + (size_t)u] * slices;
        const float after = fminf(closed[u] + closing, 1);
        const float open =
            (fminf(2 * (1 - closed[u]), 1) + fminf(2 * (1 - after), 1)) / 2;
        closed[u] = after;
        if (here == 0)
            continue;
        any = true;
        widest = fmaxf(widest, open);
        sum->all += cell * here;
        sum->drawn += cell * here * open;
    }
    sum->all += any ? span : 0;
    sum->drawn += span * widest;
}

static void clear_closed(snow_ray_walk *w) {
    const int64_t *cells = w->grid->cells;
    memset(w->closed, 0, (size_t)(cells[0] * cells[1]) * sizeof *w->closed);
}

/* Rays move aside by (u, v) cells.  Those that leave the volume do not come
 * back; others come in, open. */
static void move_rays(snow_ray_walk *w, int64_t u, int64_t v) {
    const int64_t columns = w->grid->cells[0], rows = w->grid->cells[1];
    for (int64_t n = 0; n < rows; n++) {
        const int64_t row = v > 0 ? rows - 1 - n : n, from = row - v;
        float *to = w->closed + row * columns;
        const bool inside = from >= 0 && from < rows;
        const int64_t first = u > 0 ? u : 0, end = columns + (u < 0 ? u : 0);
        if (inside)
            memmove(to + first, w->closed + from * columns + first - u,
                    (size_t)(end - first) * sizeof *to);
        memset(to, 0, (size_t)(inside ? first : columns) * sizeof *to);
        memset(to + end, 0, (size_t)(columns - end) * sizeof *to);
    }
}

/* To the layer around slice `at`. */
static void move_to(snow_ray_walk *w, double at) {
    const int64_t *cells = w->grid->cells;
    double by[2];
    for (int i = 0; i < 2; i++) {
        /* How far aside rays are in slice `at`, in cells. */
        const snow_ray_grid *g = w->grid;
        const double side =
            floor(at * g->view.slope[i] / (double)g->cell[i] + 0.5);
        by[i] = side - w->side[i];
        w->side[i] = side;
    }
    /* Steep rays cross the whole volume between two layers. */
    if (fabs(by[0]) < (double)cells[0] && fabs(by[1]) < (double)cells[1])
        move_rays(w, (int64_t)by[0], (int64_t)by[1]);
    else
        clear_closed(w);
}

/* Slices of one layer of cells. */
static double pass_layer(snow_ray_walk *w, int64_t first, int64_t count) {
    const snow_ray_grid *g = w->grid;
    const int64_t together = g->cell[0] < SPAN ? SPAN / g->cell[0] : 1;
    size_t at = (size_t)(first / g->cell[2] * g->cells[1] * g->cells[0]);
    work sum = {0, 0};
    move_to(w, (double)first + (double)count / 2);
    for (int64_t v = 0; v < g->cells[1]; v++, at += (size_t)g->cells[0])
        for (int64_t u = 0; u < g->cells[0]; u += together) {
            const int64_t left = g->cells[0] - u;
            pass_cells(w, at + (size_t)u, (float)count,
                       left < together ? left : together,
                       w->closed + v * g->cells[0] + u, &sum);
        }
    return sum.all > 0 ? sum.drawn / sum.all : 1;
}

void snow_ray_walk_slab(snow_ray_walk *w, int64_t first, int64_t count,
                        double *shares) {
    const snow_ray_grid *g = w->grid;
    clear_closed(w);
    for (int64_t n = 0, run; n < count; n += run) {
        int64_t at = first + n;
        run = g->cell[2] - at % g->cell[2];
        if (!g->view.nearest_first) {
            at = first + count - 1 - n;
            run = at % g->cell[2] + 1;
        }
        run = run < count - n ? run : count - n;
        if (!g->view.nearest_first)
            at -= run - 1;
        const double share = pass_layer(w, at, run);
        for (int64_t k = 0; k < run; k++)
            shares[at - first + k] = share;
    }
}

/* --- slabs ---------------------------------------------------------------- */

/* Cuts that are tried. */
#define ROUNDS 6

/* What all slices cost in their slabs; returns the cost of the most
 * expensive slab. */
static int64_t cost_slabs(snow_ray_walk *w, const snow_block_counts *counts,
                          const snow_box *boxes, int ranks, double *shares,
                          int64_t *costs) {
    const int axis = counts->grid.axis;
    int64_t most = 0;
    for (int rank = 0; rank < ranks; rank++) {
        const int64_t first = boxes[rank].first[axis];
        const int64_t count = boxes[rank].count[axis];
        int64_t sum = 0;
        snow_ray_walk_slab(w, first, count, shares);
        for (int64_t n = 0; n < count; n++) {
            costs[first + n] =
                (int64_t)((double)counts->counts[first + n] * shares[n]);
            sum += costs[first + n];
        }
        most = sum > most ? sum : most;
    }
    return most;
}

typedef struct search {
    snow_ray_walk walk;
    double *shares;
    int64_t *costs;
    snow_box *boxes;
} search;

static snow_status search_slabs(snow_context *context, search *s,
                                const snow_block_counts *counts, int ranks,
                                snow_box *boxes) {
    const int64_t slices = counts->blocks[counts->grid.axis];
    snow_block_counts costs = *counts;
    int64_t least = INT64_MAX;
    SNOW_TRY(snow_ray_walk_new(context, counts->rays, counts->span, &s->walk));
    SNOW_TRY(SNOW_RESERVE(context, s->shares, 0, slices));
    SNOW_TRY(SNOW_RESERVE(context, s->costs, 0, slices));
    SNOW_TRY(SNOW_RESERVE(context, s->boxes, 0, ranks));
    for (int round = 0; round < ROUNDS; round++) {
        SNOW_TRY(snow_partition_counted(context, &costs, ranks, s->boxes));
        const int64_t most =
            cost_slabs(&s->walk, counts, s->boxes, ranks, s->shares, s->costs);
        costs.counts = s->costs;
        if (most >= least)
            continue;
        least = most;
        memcpy(boxes, s->boxes, (size_t)ranks * sizeof *boxes);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_partition_by_rays(snow_context *context,
                                   const snow_block_counts *counts, int ranks,
                                   snow_box *boxes) {
    search s = {.shares = NULL};
    const snow_status status = search_slabs(context, &s, counts, ranks, boxes);
    snow_ray_walk_free(context, &s.walk);
    snow_release(context, s.shares);
    snow_release(context, s.costs);
    snow_release(context, s.boxes);
    return status;
}
