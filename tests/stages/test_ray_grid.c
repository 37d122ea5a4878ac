/* tests/stages/test_ray_grid.c - how much of a slab is predicted to be drawn,
 * and slabs that are cut by it. */
#include "support/support.h"

#include "decompose/ray_grid.h"

#include <string.h>

#define SIDE 64

/* What opacities a volume has: a voxel's. */
typedef float opacity_fn(int64_t u, int64_t v, int64_t slice);

static float plate(int64_t u, int64_t v, int64_t slice) {
    (void)u;
    (void)v;
    return slice >= 20 && slice < 24 ? 1 : 0.001F;
}

static float half_plate(int64_t u, int64_t v, int64_t slice) {
    (void)v;
    return u < SIDE / 2 && slice < 2 ? 1 : 0.001F;
}

static float nearly_clear(int64_t u, int64_t v, int64_t slice) {
    (void)u;
    (void)v;
    (void)slice;
    return 0.001F;
}

static const int64_t dims[3] = {SIDE, SIDE, SIDE};

/* Slices along z, all of whose voxels are interesting. */
static snow_ray_grid fill(snow_context *context, opacity_fn *opacity,
                          double slope, bool nearest_first) {
    const snow_ray_view view = {.axes = {0, 1, 2},
                                .slope = {slope, 0},
                                .path = 1,
                                .nearest_first = nearest_first};
    snow_ray_grid grid;
    snow_ray_grid_make(&view, dims, 1, &grid);
    grid.sums = snow_allocate_clear(context, snow_ray_grid_cells(&grid) *
                                                 sizeof *grid.sums);
    assert_non_null(grid.sums);
    for (int64_t z = 0; z < SIDE; z++)
        for (int64_t y = 0; y < SIDE; y++)
            for (int64_t x = 0; x < SIDE; x++)
                grid.sums[snow_ray_grid_place(&grid, 0, x) +
                          snow_ray_grid_place(&grid, 1, y) +
                          snow_ray_grid_place(&grid, 2, z)] +=
                    snow_ray_grid_word(&grid, opacity(x, y, z));
    return grid;
}

static void walk(opacity_fn *opacity, double slope, bool nearest_first,
                 int64_t first, int64_t count, double *shares) {
    snow_context *context = support_context();
    snow_ray_grid grid = fill(context, opacity, slope, nearest_first);
    snow_ray_walk walk;
    assert_int_equal(snow_ray_walk_new(context, &grid, 24, &walk),
                     SNOW_STATUS_OK);
    double before[SIDE]; /* of another slab, which leaves nothing behind */
    snow_ray_walk_slab(&walk, 0, SIDE, before);
    snow_ray_walk_slab(&walk, first, count, shares);
    snow_ray_walk_free(context, &walk);
    snow_release(context, grid.sums);
    snow_context_free(context);
}

static void what_is_behind_an_opaque_plate_is_not_drawn(void **state) {
    (void)state;
    double shares[SIDE];
    walk(plate, 0, true, 0, SIDE, shares);
    for (int n = 0; n < 20; n++)
        assert_true(shares[n] > 0.999);
    for (int n = 24; n < SIDE; n++)
        assert_true(shares[n] < 0.001);
    walk(plate, 0, false, 0, SIDE, shares);
    for (int n = 0; n < 20; n++)
        assert_true(shares[n] < 0.001);
    for (int n = 24; n < SIDE; n++)
        assert_true(shares[n] > 0.999);
}

static void a_slab_begins_with_open_pixels(void **state) {
    (void)state;
    double shares[SIDE];
    walk(plate, 0, true, 25, 30, shares);
    for (int n = 0; n < 30; n++)
        assert_true(shares[n] > 0.999);
}

/* Rays that move aside by half a voxel a slice: those that the plate ends are
 * beside the other half of the last slice, or beyond the volume. */
static void the_shear_moves_what_is_hidden(void **state) {
    (void)state;
    double straight[SIDE], aside[2][SIDE];
    walk(half_plate, 0, true, 0, SIDE, straight);
    walk(half_plate, 0.5, true, 0, SIDE, aside[0]);
    walk(half_plate, -0.5, true, 0, SIDE, aside[1]);
    assert_true(straight[SIDE - 1] > 0.49 && straight[SIDE - 1] < 0.51);
    assert_true(aside[0][SIDE - 1] > 0.49 && aside[0][SIDE - 1] < 0.51);
    assert_true(aside[1][SIDE - 1] > 0.9);
}

/* The dearest slab of some boxes, by slices that cost 1000 each. */
static double dearest(snow_context *context, const snow_ray_grid *grid,
                      const snow_box *boxes, int ranks) {
    snow_ray_walk walk;
    double most = 0, shares[SIDE];
    assert_int_equal(snow_ray_walk_new(context, grid, 24, &walk),
                     SNOW_STATUS_OK);
    for (int rank = 0; rank < ranks; rank++) {
        double sum = 0;
        snow_ray_walk_slab(&walk, boxes[rank].first[2], boxes[rank].count[2],
                           shares);
        for (int64_t n = 0; n < boxes[rank].count[2]; n++)
            sum += 1000 * shares[n];
        most = sum > most ? sum : most;
    }
    snow_ray_walk_free(context, &walk);
    return most;
}

static void cut(opacity_fn *opacity, int ranks, double *by_counts,
                double *by_rays) {
    snow_context *context = support_context();
    snow_ray_grid grid = fill(context, opacity, 0, true);
    const snow_partition_grid all = {.dims = {SIDE, SIDE, SIDE}, .axis = 2};
    snow_block_counts counts = snow_block_counts_for_slabs(&all);
    int64_t costs[SIDE], next = 0;
    snow_box boxes[SIDE];
    for (int n = 0; n < SIDE; n++)
        costs[n] = 1000;
    counts.counts = costs;
    counts.span = 24;
    assert_int_equal(snow_partition_counted(context, &counts, ranks, boxes),
                     SNOW_STATUS_OK);
    *by_counts = dearest(context, &grid, boxes, ranks);
    counts.rays = &grid;
    assert_int_equal(snow_partition_by_rays(context, &counts, ranks, boxes),
                     SNOW_STATUS_OK);
    *by_rays = dearest(context, &grid, boxes, ranks);
    for (int rank = 0; rank < ranks; rank++) {
        assert_int_equal(boxes[rank].first[2], next);
        next += boxes[rank].count[2];
    }
    assert_int_equal(next, SIDE);
    snow_release(context, grid.sums);
    snow_context_free(context);
}

static void slabs_with_hidden_slices_are_thicker(void **state) {
    (void)state;
    double by_counts, by_rays;
    cut(plate, 2, &by_counts, &by_rays);
    assert_true(by_rays < 0.85 * by_counts);
    for (int ranks = 1; ranks < 12; ranks++) {
        cut(plate, ranks, &by_counts, &by_rays);
        assert_true(by_rays <= by_counts);
        cut(nearly_clear, ranks, &by_counts, &by_rays);
        assert_true(by_rays <= by_counts);
    }
}

/* Cells of every size count every voxel once, and words of a cell do not run
 * into one another. */
static void cells_cover_large_volumes(void **state) {
    (void)state;
    static const int64_t large[3] = {4096, 1, 1000};
    for (int axis = 0; axis < 3; axis++) {
        const snow_ray_view view = {
            .axes = {(axis + 1) % 3, (axis + 2) % 3, axis}, .path = 1};
        snow_ray_grid grid;
        snow_ray_grid_make(&view, large, 3, &grid);
        int64_t last = 0;
        for (int i = 0; i < 3; i++) {
            assert_true(grid.cell[i] * grid.cells[i] >= large[view.axes[i]]);
            assert_true(snow_ray_grid_place(&grid, i, 0) == 0);
            last += snow_ray_grid_place(&grid, i, large[i] - 1);
        }
        assert_int_equal(last + 1, (int64_t)snow_ray_grid_cells(&grid));
        assert_true(snow_ray_grid_cells(&grid) <= 16 * 16 * 32);
    }
}

/* Slices 1000 times as far apart as voxels: rays leave the volume between two
 * layers, so that a plate hides nothing.  A prediction needs no more memory
 * than for any other view. */
static void steep_rays_need_no_more_memory(void **state) {
    (void)state;
    double shares[SIDE];
    for (int sign = -1; sign <= 1; sign += 2) {
        walk(plate, sign * 1000.0, true, 0, SIDE, shares);
        assert_true(shares[19] > 0.999 && shares[24] > 0.999);
        walk(plate, sign * 1e300, true, 0, SIDE, shares);
        assert_true(shares[SIDE - 1] > 0.999);
    }
}

static void faint_voxels_close_rays(void **state) {
    (void)state;
    snow_context *context = support_context();
    const snow_ray_grid grid = fill(context, plate, 0, true);
    for (int n = 1; n < 8; n++)
        assert_true(grid.closes[n] > grid.closes[n - 1]);
    assert_true(grid.closes[2] > 1.9 * grid.closes[1]);
    snow_release(context, grid.sums);
    snow_context_free(context);
}

/* A cell full of opaque voxels; of large volumes not all slices count. */
static void sums_of_large_cells_do_not_overflow(void **state) {
    (void)state;
    static const int64_t sides[] = {64, 1000, 4096, 20000};
    for (size_t n = 0; n < 4; n++) {
        const int64_t step = sides[n] / 256 > 1 ? sides[n] / 256 : 1;
        const snow_ray_view view = {.axes = {1, 2, 0}, .path = 1};
        const int64_t all[3] = {sides[n], sides[n], sides[n]};
        snow_ray_grid grid;
        snow_ray_grid_make(&view, all, step, &grid);
        const int64_t voxels =
            grid.cell[0] * grid.cell[2] * ((grid.cell[1] - 1) / step + 1);
        const int64_t word = snow_ray_grid_word(&grid, 1);
        assert_true(grid.whole > 0 && grid.closes[255] > 0);
        assert_int_equal(voxels * word >> 32, voxels);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_behind_an_opaque_plate_is_not_drawn),
        cmocka_unit_test(a_slab_begins_with_open_pixels),
        cmocka_unit_test(the_shear_moves_what_is_hidden),
        cmocka_unit_test(slabs_with_hidden_slices_are_thicker),
        cmocka_unit_test(cells_cover_large_volumes),
        cmocka_unit_test(steep_rays_need_no_more_memory),
        cmocka_unit_test(faint_voxels_close_rays),
        cmocka_unit_test(sums_of_large_cells_do_not_overflow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
