/* formats/amr/grid.c - levels and boxes as one even grid. */
#include "formats/amr/amr.h"
#include "volume/mask.h"

#include <stdio.h>
#include <string.h>

/* Voxels of a grid, unless the base level has more: levels that would make more
 * are not shown. */
#define MOST_VOXELS 0x1p33

/* Cells along an axis, so that no product of two overflows. */
#define MOST_CELLS 0x1p31

void snow_amr_cells(const amr_grid *grid, int level, int64_t out[3]) {
    memcpy(out, grid->cells, 3 * sizeof *out);
    for (int l = 1; l <= level; l++)
        for (int i = 0; i < 3; i++)
            out[i] *= grid->ratio[l][i];
}

snow_status snow_amr_add(amr_grid *grid, int level, const snow_box *box) {
    int64_t cells[3];
    snow_amr_cells(grid, level, cells);
    for (int i = 0; i < 3; i++)
        if (box->first[i] < 0 || box->count[i] < 1 ||
            box->count[i] > cells[i] ||
            box->first[i] > cells[i] - box->count[i])
            return snow_fail(grid->context, SNOW_STATUS_BAD_INPUT,
                             "box %zu has cells %lld to %lld of level %d along "
                             "%c, which has %lld; write the file again",
                             grid->count, (long long)box->first[i],
                             (long long)(box->first[i] + box->count[i] - 1),
                             level, "xyz"[i], (long long)cells[i]);
    if (grid->count == AMR_MOST_BOXES)
        return snow_fail(grid->context, SNOW_STATUS_BAD_INPUT,
                         "has more than %d boxes; it is damaged",
                         AMR_MOST_BOXES);
    SNOW_TRY(
        SNOW_RESERVE(grid->context, grid->boxes, grid->count, grid->count + 1));
    grid->boxes[grid->count++] = (amr_box){level, *box};
    return SNOW_STATUS_OK;
}

void snow_amr_free(amr_grid *grid) {
    SNOW_DROP(grid->context, grid->boxes);
    grid->count = 0;
}

snow_status snow_amr_check(const amr_grid *grid) {
    double cells[3];
    for (int i = 0; i < 3; i++) {
        cells[i] = (double)grid->cells[i];
        for (int l = 1; l < grid->levels; l++)
            cells[i] *= (double)grid->ratio[l][i];
        if (!(cells[i] >= 1 && cells[i] <= MOST_CELLS))
            return snow_fail(grid->context, SNOW_STATUS_BAD_INPUT,
                             "its finest level has %.0f cells along %c, more "
                             "than any file; correct its domain and ratios",
                             cells[i], "xyz"[i]);
    }
    return SNOW_STATUS_OK;
}

/* Makes a box of a level one of the level below, if that has it whole. */
static bool divide(snow_box *box, const int64_t ratio[3]) {
    for (int i = 0; i < 3; i++)
        if (box->first[i] % ratio[i] || box->count[i] % ratio[i])
            return false;
    for (int i = 0; i < 3; i++) {
        box->first[i] /= ratio[i];
        box->count[i] /= ratio[i];
    }
    return true;
}

static double voxels_of(const amr_grid *grid, int level) {
    int64_t cells[3];
    snow_amr_cells(grid, level, cells);
    return (double)cells[0] * (double)cells[1] * (double)cells[2];
}

/* The first level covers its grid, or much of it: a few bytes must not make a
 * large one.  Leaves fill it together. */
static snow_status check_cover(const amr_grid *grid) {
    double covered = 0;
    if (grid->leaves)
        return SNOW_STATUS_OK;
    for (size_t i = 0; i < grid->count; i++)
        if (grid->boxes[i].level == 0)
            covered += (double)snow_box_voxels(&grid->boxes[i].box);
    if (64 * covered >= voxels_of(grid, 0))
        return SNOW_STATUS_OK;
    return snow_fail(grid->context, SNOW_STATUS_BAD_INPUT,
                     "its boxes of level 0 have %.0f of %.0f cells; write the "
                     "file again",
                     covered, voxels_of(grid, 0));
}

/* The coarsest level whose cells can be means of whole boxes. */
static int coarsest_of(const amr_grid *grid) {
    int level = 0;
    for (size_t n = 0; n < grid->count && grid->leaves; n++) {
        const amr_box *box = &grid->boxes[n];
        int at = box->level;
        snow_box cells = box->box;
        while (at > level && divide(&cells, grid->ratio[at]))
            at--;
        level = at > level ? at : level;
    }
    return level;
}

/* The finest level that is wanted and has few enough cells. */
static void choose_level(amr_grid *grid, int64_t wanted) {
    const int least = coarsest_of(grid);
    int last =
        (int)(wanted && wanted < grid->levels ? wanted : grid->levels) - 1;
    if (last < least)
        snow_notify(grid->context,
                    "--levels %d: the blocks of this file have too few cells "
                    "for that; %d levels are shown",
                    last + 1, least + 1);
    last = last < least ? least : last;
    grid->finest = last;
    while (grid->finest > least && voxels_of(grid, grid->finest) > MOST_VOXELS)
        grid->finest--;
    if (grid->finest < last)
        snow_notify(grid->context,
                    "level %d of %d is the finest that is shown: the next one "
                    "would make %.3g voxels",
                    grid->finest, last, voxels_of(grid, grid->finest + 1));
}

static void add(snow_volume_info *info, const char *before, int64_t number,
                const char *behind) {
    size_t used = strlen(info->storage);
    snprintf(info->storage + used, sizeof info->storage - used, "%s%lld%s",
             before, (long long)number, behind);
}

/* "3 levels, ratios 2, 4x4x1, boxes 8, 20, 64". */
static void set_storage(const amr_grid *grid, snow_volume_info *info) {
    *info->storage = 0;
    add(info, "", grid->levels, grid->levels == 1 ? " level" : " levels");
    for (int l = 1; l < grid->levels; l++) {
        const int64_t *ratio = grid->ratio[l];
        const bool same = ratio[0] == ratio[1] && ratio[1] == ratio[2];
        const char *first = grid->levels > 2 ? ", ratios " : ", ratio ";
        add(info, l > 1 ? ", " : first, ratio[0], "");
        for (int i = 1; i < 3 && !same; i++)
            add(info, "x", ratio[i], "");
    }
    for (int l = 0; l < grid->levels; l++) {
        int64_t boxes = 0;
        for (size_t i = 0; i < grid->count; i++)
            boxes += grid->boxes[i].level == l;
        add(info, l ? ", " : ", boxes ", boxes, "");
    }
}

snow_status snow_amr_describe(amr_grid *grid,
                              const snow_volume_options *options,
                              snow_volume_info *info) {
    SNOW_TRY(check_cover(grid));
    choose_level(grid, options->levels);
    snow_amr_cells(grid, grid->finest, info->dims);
    info->type = snow_masked_type(grid->type);
    for (int i = 0; i < 3; i++) {
        double step =
            grid->size[i] * (double)grid->cells[i] / (double)info->dims[i];
        info->matrix[i][i] = step;
        info->matrix[i][3] = grid->corner[i] + step / 2;
    }
    set_storage(grid, info);
    for (size_t i = 0; i < grid->count && grid->leaves; i++) {
        amr_box *box = &grid->boxes[i];
        while (box->level > grid->finest)
            (void)divide(&box->box, grid->ratio[box->level--]);
    }
    if (grid->finest > 0 && !options->each_time)
        snow_notify(grid->context,
                    "%d levels are shown on the grid of the finest, "
                    "%lldx%lldx%lld voxels",
                    grid->finest + 1, (long long)info->dims[0],
                    (long long)info->dims[1], (long long)info->dims[2]);
    return SNOW_STATUS_OK;
}
