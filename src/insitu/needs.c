/* insitu/needs.c - which cells of each level a rank's voxels are refined from:
 * at the finest level the voxels, and of each level below what is around those
 * that no finer cell covers. */
#include "insitu/internal.h"

#include <string.h>

#define REACH 3 /* of snow_cells_refine */

static int64_t larger(int64_t a, int64_t b) {
    return a > b ? a : b;
}

static int64_t smaller(int64_t a, int64_t b) {
    return a < b ? a : b;
}

snow_box snow_level_cells_in(const snow_box *voxels, const int64_t size[3]) {
    snow_box out;
    for (int i = 0; i < 3; i++) {
        out.first[i] = (voxels->first[i] + size[i] - 1) / size[i];
        out.count[i] = larger(
            0, (voxels->first[i] + voxels->count[i]) / size[i] - out.first[i]);
    }
    return out;
}

static void unite(snow_box *all, const snow_box *more) {
    if (!snow_box_voxels(all)) {
        *all = *more;
        return;
    }
    for (int i = 0; i < 3; i++) {
        const int64_t end = larger(all->first[i] + all->count[i],
                                   more->first[i] + more->count[i]);
        all->first[i] = smaller(all->first[i], more->first[i]);
        all->count[i] = end - all->first[i];
    }
}

/* The part of a level where coarser cells are what there is. */
static snow_box find_refined(const snow_insitu_levels *levels, int level,
                             const snow_box *cells) {
    snow_box all = {{0, 0, 0}, {0, 0, 0}};
    for (int64_t n = 0; n < levels->count; n++) {
        const snow_level_brick *brick = &levels->bricks[n];
        for (int64_t p = brick->pieces[0];
             p < brick->pieces[1] && brick->level < level; p++) {
            const snow_box piece =
                snow_level_cells_in(&levels->pieces[p], levels->sizes[level]);
            snow_box shared;
            if (snow_box_intersect(&piece, cells, &shared))
                unite(&all, &shared);
        }
    }
    return all;
}

/* The cells of the level below that those of a box are refined from. */
static snow_box find_below(const snow_insitu *insitu, int level,
                           const snow_box *refined) {
    const int64_t *size = insitu->levels.sizes[level];
    const int64_t *below = insitu->levels.sizes[level - 1];
    snow_box out = {{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < 3 && snow_box_voxels(refined); i++) {
        const int64_t ratio = below[i] / size[i];
        const int64_t last = refined->first[i] + refined->count[i] - 1;
        out.first[i] = larger(0, refined->first[i] / ratio - REACH);
        out.count[i] = smaller(insitu->whole.dims[i] / below[i],
                               last / ratio + REACH + 1) -
                       out.first[i];
    }
    return out;
}

void snow_insitu_find_needs(const snow_insitu *insitu, const snow_box *wanted,
                            snow_level_needs *out) {
    const snow_insitu_levels *levels = &insitu->levels;
    memset(out, 0, sizeof *out);
    out->cells[levels->finest] = *wanted;
    for (int l = levels->finest; l > 0; l--) {
        out->refined[l] = find_refined(levels, l, &out->cells[l]);
        out->cells[l - 1] = find_below(insitu, l, &out->refined[l]);
    }
}
