/* formats/amr/gather.c - cells of all levels as the voxels of a box.
 *
 *   down   each level, the finest first: its cells, but those below finer ones,
 *          in whose place are the means of these
 *   up     each level, the coarsest first: where it has no cells, voxels are
 *          refined from the level below (volume/refine.h)
 *
 * So the borders of levels are places like any other to those that look across.
 * A level is held around the box only: by as many cells as voxels are refined
 * from, and of the rows of those that are divided by theirs what the file
 * has. */
#include "formats/amr/amr.h"
#include "volume/refine.h"

#include <math.h>
#include <string.h>

/* A share of a cell that is all of it, but for rounding. */
#define ALL 0.999

/* Cells of a level below the finest one. */
typedef struct level_cells {
    snow_box box;
    double *values; /* sums, and later means */
    float *shares;  /* of a cell: with a value; covered by cells, whatever their
                       values */
    float *covered;
    unsigned char *begun; /* 1 for each row that has them; no memory of others
                             is touched, which is most where fine levels are
                             small */
} level_cells;

typedef struct gathering {
    const amr_grid *grid;
    snow_box box;    /* of voxels */
    snow_box around; /* those that cells in levels[] are divided to */
    level_cells levels[AMR_MOST_LEVELS];
    snow_volume *out;
    unsigned char *taken; /* a bit for each voxel that has a cell */
    int level;            /* that is refined to, and so takes rows */
} gathering;

/* --- room ----------------------------------------------------------------- */

static int64_t place_in(const snow_box *box, const int64_t at[3]) {
    return ((at[2] - box->first[2]) * box->count[1] + at[1] - box->first[1]) *
               box->count[0] +
           at[0] - box->first[0];
}

/* Clears the row of a cell where it has not begun. */
static void begin_row(level_cells *to, int64_t place) {
    const int64_t width = to->box.count[0], row = place / width;
    const size_t first = (size_t)(row * width), count = (size_t)width;
    if (to->begun[row])
        return;
    to->begun[row] = 1;
    memset(to->values + first, 0, count * sizeof *to->values);
    memset(to->shares + first, 0, count * sizeof *to->shares);
    memset(to->covered + first, 0, count * sizeof *to->covered);
}

static snow_box divided(const snow_box *box, const int64_t ratio[3]) {
    snow_box out = *box;
    for (int i = 0; i < 3; i++) {
        out.first[i] *= ratio[i];
        out.count[i] *= ratio[i];
    }
    return out;
}

/* The needed cells of each level below `grid->finest`. */
static void place_levels(gathering *g, snow_box needed[AMR_MOST_LEVELS]) {
    const amr_grid *grid = g->grid;
    needed[grid->finest] = g->box;
    for (int l = grid->finest; l > 0; l--) {
        int64_t cells[3];
        snow_amr_cells(grid, l - 1, cells);
        /* The cells of the level below that those of a box are refined from. */
        snow_box out;
        for (int i = 0; i < 3; i++) {
            int64_t first =
                needed[l].first[i] / grid->ratio[l][i] - SNOW_REFINE_REACH;
            int64_t end = (needed[l].first[i] + needed[l].count[i] - 1) /
                              grid->ratio[l][i] +
                          SNOW_REFINE_REACH + 1;
            out.first[i] = first > 0 ? first : 0;
            out.count[i] = (end < cells[i] ? end : cells[i]) - out.first[i];
        }
        needed[l - 1] = out;
    }
    g->around = needed[0];
    for (int l = 0; l < grid->finest; l++) {
        g->levels[l].box = g->around;
        g->around = divided(&g->around, grid->ratio[l + 1]);
    }
}

static snow_status make_room(gathering *g) {
    snow_context *context = g->grid->context;
    for (int l = 0; l < g->grid->finest; l++) {
        level_cells *cells = &g->levels[l];
        const uint64_t count = (uint64_t)snow_box_voxels(&cells->box);
        const int64_t rows = cells->box.count[1] * cells->box.count[2];
        cells->values =
            snow_allocate_array(context, count, sizeof *cells->values);
        cells->shares =
            snow_allocate_array(context, 2 * count, sizeof *cells->shares);
        cells->begun = snow_allocate_clear(context, (size_t)rows);
        if (!cells->values || !cells->shares || !cells->begun)
            return SNOW_STATUS_NO_MEMORY;
        cells->covered = cells->shares + count;
    }
    g->taken =
        snow_allocate_clear(context, (size_t)snow_box_voxels(&g->box) / 8 + 1);
    return g->taken ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* --- voxels --------------------------------------------------------------- */

static void store(const gathering *g, int64_t voxel, double value) {
    if (g->out->info.type == SNOW_TYPE_FLOAT32)
        ((float *)g->out->owned)[voxel] = (float)value;
    else
        ((double *)g->out->owned)[voxel] = value;
}

static bool is_taken(const gathering *g, int64_t voxel) {
    return g->taken[voxel / 8] >> voxel % 8 & 1;
}

/* --- down ----------------------------------------------------------------- */

/* Adds a row of cells of level `level`, each with its share of values and of
 * cover, to the level below. */
static void add_below(gathering *g, int level, const int64_t at[3],
                      int64_t count, const double *values, const float *shares,
                      const float *covered) {
    const int64_t *ratio = g->grid->ratio[level];
    level_cells *to = &g->levels[level - 1];
    const int64_t cell[3] = {at[0] / ratio[0], at[1] / ratio[1],
                             at[2] / ratio[2]};
    const float part = 1 / (float)(ratio[0] * ratio[1] * ratio[2]);
    int64_t place = place_in(&to->box, cell);
    int64_t left = ratio[0] - at[0] % ratio[0];
    begin_row(to, place);
    snow_cells_add(values, shares, at[0], count, ratio, to->values + place,
                   to->shares + place);
    for (int64_t i = 0; i < count; i++) {
        to->covered[place] += (covered ? covered[i] : 1) * part;
        if (--left == 0) {
            left = ratio[0];
            place++;
        }
    }
}

/* Takes a row of the finest cells. */
static void take_voxels(gathering *g, const int64_t at[3], int64_t count,
                        const double *values) {
    const snow_box *box = &g->box;
    int64_t first = at[0] > box->first[0] ? at[0] : box->first[0];
    int64_t end = at[0] + count, last = box->first[0] + box->count[0];
    if (at[1] >= box->first[1] && at[1] < box->first[1] + box->count[1] &&
        at[2] >= box->first[2] && at[2] < box->first[2] + box->count[2])
        for (int64_t x = first; x < end && x < last; x++) {
            const int64_t voxel =
                place_in(box, (const int64_t[3]){x, at[1], at[2]});
            store(g, voxel, values[x - at[0]]);
            g->taken[voxel / 8] |= (unsigned char)(1 << voxel % 8);
        }
    if (g->grid->finest > 0)
        add_below(g, g->grid->finest, at, count, values, NULL, NULL);
}

/* Takes a row of cells of a level that others may cover. */
static void take_cells(level_cells *to, const int64_t at[3], int64_t count,
                       const double *values) {
    const int64_t place = place_in(&to->box, at);
    begin_row(to, place);
    for (int64_t i = place; i < place + count; i++) {
        const float own = to->covered[i] < (float)ALL ? 1 - to->covered[i] : 0;
        if (own <= 0)
            continue;
        to->covered[i] = 1;
        if (!isfinite(values[i - place]))
            continue;
        to->values[i] += (double)own * values[i - place];
        to->shares[i] += own;
    }
}

/* Takes what a box of the file has of the cells around. */
static snow_status take_box(gathering *g, size_t number, double **row) {
    const amr_grid *grid = g->grid;
    const amr_box *box = &grid->boxes[number];
    const snow_box *wanted =
        box->level == grid->finest ? &g->around : &g->levels[box->level].box;
    snow_box part;
    snow_volume *cells;
    if (!snow_box_intersect(&box->box, wanted, &part))
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(grid->context, *row, 0, part.count[0]));
    SNOW_TRY(grid->read(grid->user, number, &part, &cells));
    for (int64_t n = 0; n < part.count[1] * part.count[2]; n++) {
        const int64_t at[3] = {part.first[0], part.first[1] + n % part.count[1],
                               part.first[2] + n / part.count[1]};
        snow_volume_stored(cells, n * part.count[0], (size_t)part.count[0],
                           *row);
        if (box->level == grid->finest)
            take_voxels(g, at, part.count[0], *row);
        else
            take_cells(&g->levels[box->level], at, part.count[0], *row);
    }
    snow_volume_close(cells);
    return SNOW_STATUS_OK;
}

/* Sums of a row become means, which are added to the level below. */
static void finish_row(gathering *g, int level, int64_t row) {
    level_cells *cells = &g->levels[level];
    const snow_box *box = &cells->box;
    const int64_t width = box->count[0], first = row * width;
    const int64_t at[3] = {box->first[0], box->first[1] + row % box->count[1],
                           box->first[2] + row / box->count[1]};
    for (int64_t i = first; i < first + width; i++)
        cells->values[i] = cells->shares[i] > 0
                               ? cells->values[i] / (double)cells->shares[i]
                               : NAN;
    if (level > 0)
        add_below(g, level, at, width, cells->values + first,
                  cells->shares + first, cells->covered + first);
}

/* Rows that have not begun have no value, where voxels are refined from
 * them. */
static void finish_level(gathering *g, int level, const snow_box *needed) {
    level_cells *cells = &g->levels[level];
    const snow_box *box = &cells->box;
    const int64_t width = box->count[0];
    for (int64_t row = 0; row < box->count[1] * box->count[2]; row++) {
        const int64_t z = box->first[2] + row / box->count[1];
        if (cells->begun[row])
            finish_row(g, level, row);
        else if (z >= needed->first[2] &&
                 z < needed->first[2] + needed->count[2])
            for (int64_t i = row * width; i < (row + 1) * width; i++)
                cells->values[i] = NAN;
    }
}

static snow_status go_down(gathering *g,
                           const snow_box needed[AMR_MOST_LEVELS]) {
    const amr_grid *grid = g->grid;
    snow_monitor *monitor = grid->context->monitor;
    snow_status status = SNOW_STATUS_OK;
    double *row = NULL;
    size_t done = 0;
    for (int l = grid->finest; l >= 0; l--) {
        for (size_t i = 0; i < grid->count && status == SNOW_STATUS_OK; i++) {
            if (grid->boxes[i].level != l)
                continue;
            snow_monitor_part whole = snow_monitor_divide(
                monitor, (double)done++, (double)grid->count);
            status = take_box(g, i, &row);
            snow_monitor_whole(monitor, whole);
        }
        if (l < grid->finest && status == SNOW_STATUS_OK)
            finish_level(g, l, &needed[l]);
    }
    snow_release(grid->context, row);
    return status;
}

/* --- up ------------------------------------------------------------------- */

/* Rows of voxels, where no cell was taken. */
static bool fill_voxels(void *user, int64_t y, int64_t z, const double *row) {
    gathering *g = user;
    const int64_t at[3] = {g->box.first[0], y, z};
    const int64_t place = place_in(&g->box, at), count = g->box.count[0];
    for (int64_t x = 0; x < count; x++) {
        if (is_taken(g, place + x))
            continue;
        if (!row)
            return true;
        store(g, place + x, row[x]);
    }
    return false;
}

/* Rows of cells, where none are covered; `row` begins at the needed ones. */
typedef struct level_rows {
    level_cells *cells;
    const snow_box *needed;
} level_rows;

static bool fill_cells(void *user, int64_t y, int64_t z, const double *row) {
    const level_rows *rows = user;
    const int64_t at[3] = {rows->needed->first[0], y, z};
    const int64_t place = place_in(&rows->cells->box, at);
    const bool begun = rows->cells->begun[place / rows->cells->box.count[0]];
    for (int64_t x = 0; x < rows->needed->count[0]; x++) {
        if (begun && rows->cells->covered[place + x] > 0)
            continue;
        if (!row)
            return true;
        rows->cells->values[place + x] = row[x];
    }
    return false;
}

static snow_status go_up(gathering *g, const snow_box needed[AMR_MOST_LEVELS]) {
    const amr_grid *grid = g->grid;
    if (grid->finest == 0) {
        /* Without a level below what is not taken has no value. */
        const int64_t all = snow_box_voxels(&g->box);
        for (int64_t i = 0; i < all; i++)
            if (!is_taken(g, i))
                store(g, i, NAN);
    }
    for (int l = 1; l <= grid->finest; l++) {
        const level_cells *from = &g->levels[l - 1];
        const bool last = l == grid->finest;
        level_rows rows = {&g->levels[l], &needed[l]};
        SNOW_TRY(snow_cells_refine(
            grid->context, from->values, &from->box, grid->ratio[l], &needed[l],
            last ? fill_voxels : fill_cells, last ? (void *)g : (void *)&rows));
    }
    return SNOW_STATUS_OK;
}

/* --- all of it ------------------------------------------------------------ */

snow_status snow_amr_read(const amr_grid *grid,
                          const snow_volume_options *options,
                          snow_volume_info *info, snow_volume **out) {
    gathering g = {.grid = grid};
    snow_box needed[AMR_MOST_LEVELS];
    snow_region region;
    SNOW_TRY(snow_region_lay_out(grid->context, options, info, &region));
    if (!out)
        return SNOW_STATUS_OK;
    memcpy(g.box.first, region.first, sizeof g.box.first);
    memcpy(g.box.count, region.count, sizeof g.box.count);
    place_levels(&g, needed);
    SNOW_TRY(snow_volume_new(grid->context, info, &g.out));
    snow_status status = make_room(&g);
    if (status == SNOW_STATUS_OK)
        status = go_down(&g, needed);
    if (status == SNOW_STATUS_OK)
        status = go_up(&g, needed);
    for (int l = 0; l < g.grid->finest; l++) {
        snow_release(g.grid->context, g.levels[l].values);
        snow_release(g.grid->context, g.levels[l].shares);
        snow_release(g.grid->context, g.levels[l].begun);
    }
    snow_release(g.grid->context, g.taken);
    return snow_volume_give(status, g.out, out);
}
