/* tests/stages/test_ray_grid.c - how much of a slab is predicted to be drawn,
 * and volumes that are cut by it, and by what their voxels cost. */
#include "support/support.h"

#include "decompose/ray_grid.h"
#include "parallel/partition.h"

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

/* --- cuts of volumes ------------------------------------------------------ */

#define VOXELS (SIDE * SIDE * SIDE)

/* Two slabs of a volume whose values are opacities in quarters. */
typedef struct cut_volume {
    const unsigned char *values;
    bool floats;
    bool halved; /* by a constant gradient opacity */
    int span;
    bool hides, farthest_first;
} cut_volume;

static void open_quarters(snow_context *context, const cut_volume *c,
                          const void *voxels, snow_volume **volume,
                          snow_transfer **transfer) {
    static const snow_opacity_point quarters[] = {{0, 0}, {4, 1}};
    static const snow_opacity_point halves[] = {{0, 0.5}, {100, 0.5}};
    static const snow_color_point white[] = {{0, 1, 1, 1}};
    const snow_look look = {.size = sizeof look,
                            .colors = white,
                            .color_count = 1,
                            .opacities = quarters,
                            .opacity_count = 2,
                            .gradient_opacities = c->halved ? halves : NULL,
                            .gradient_opacity_count = c->halved ? 2 : 0};
    snow_volume_info info;
    snow_volume_info_init(&info);
    memcpy(info.dims, dims, sizeof info.dims);
    info.type = c->floats ? SNOW_TYPE_FLOAT32 : SNOW_TYPE_UINT8;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(*volume, &look, transfer),
                     SNOW_STATUS_OK);
}

/* How many slices the first slab has. */
static int64_t cut_in_two(snow_comm *comm, snow_context *context,
                          const cut_volume *c) {
    float *floats = malloc(VOXELS * sizeof *floats);
    for (int n = 0; n < VOXELS; n++)
        floats[n] = c->values[n];
    snow_volume *volume;
    snow_transfer *transfer;
    snow_box boxes[2];
    open_quarters(context, c,
                  c->floats ? (const void *)floats : (const void *)c->values,
                  &volume, &transfer);
    const snow_partition_params order = {
        .cut = SNOW_PARTITION_COUNTED,
        .ranks = 2,
        .grid = {.dims = {SIDE, SIDE, SIDE}, .axis = 2},
        .span = c->span,
        .hides = c->hides,
        .rays = {.axes = {0, 1, 2},
                 .path = 0.01,
                 .nearest_first = !c->farthest_first}};
    assert_int_equal(
        snow_partition_boxes(comm, &order, volume, transfer, boxes, NULL),
        SNOW_STATUS_OK);
    assert_int_equal(boxes[0].count[2] + boxes[1].count[2], SIDE);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    free(floats);
    return boxes[0].count[2];
}

/* Four opaque slices in front, and faint ones behind them. */
static unsigned char opaque[VOXELS];

static void fill_opaque(void) {
    memset(opaque, 1, sizeof opaque);
    memset(opaque, 4, (size_t)SIDE * SIDE * 4);
}

/* The slab in front has more slices, for the plate hides most of them, but
 * where gradients make it faint. */
static void slices_behind_an_opaque_plate_cost_less(void **state) {
    (void)state;
    snow_context *context = support_context();
    cut_volume c = {.values = opaque, .span = 24};
    fill_opaque();
    assert_int_equal(cut_in_two(NULL, context, &c), SIDE / 2);
    c.hides = true;
    for (int floats = 0; floats < 2; floats++) {
        c.floats = floats;
        assert_true(cut_in_two(NULL, context, &c) >= 40);
    }
    c.halved = true;
    assert_true(cut_in_two(NULL, context, &c) < 36);
    snow_context_free(context);
}

/* As many voxels in each slice: in whole rows, and scattered over all. */
static void scattered_voxels_cost_more(void **state) {
    (void)state;
    snow_context *context = support_context();
    static unsigned char values[VOXELS];
    for (int n = 0; n < VOXELS; n++)
        values[n] = n < VOXELS / 2 ? n / SIDE % 4 == 0 : n % 4 == 0;
    cut_volume c = {.values = values};
    assert_int_equal(cut_in_two(NULL, context, &c), SIDE / 2);
    c.span = 24;
    assert_in_range(cut_in_two(NULL, context, &c), SIDE / 2 + 4, SIDE - 4);
    snow_context_free(context);
}

/* Ranks whose rays differ: as those of two machines may, by a last bit. */
static snow_status cut_by_own_rays(snow_comm *comm, void *user) {
    int64_t *counts = user;
    const int rank = snow_comm_rank(comm);
    const cut_volume c = {.values = opaque,
                          .span = 24,
                          .hides = true,
                          .farthest_first = rank != 0};
    counts[rank] = cut_in_two(comm, snow_comm_context(comm), &c);
    return SNOW_STATUS_OK;
}

static void all_ranks_take_the_same_boxes(void **state) {
    (void)state;
    snow_context *context = support_context();
    int64_t counts[2];
    const cut_volume c = {
        .values = opaque, .span = 24, .hides = true, .farthest_first = true};
    fill_opaque();
    const int64_t alone = cut_in_two(NULL, context, &c);
    assert_int_equal(snow_comm_run_threads(context, 2, cut_by_own_rays, counts),
                     SNOW_STATUS_OK);
    assert_int_equal(counts[0], counts[1]);
    assert_int_not_equal(counts[1], alone);
    snow_context_free(context);
}

/* Of boxes of all kinds, by any number of threads. */
static void loads_are_the_voxels_in_boxes(void **state) {
    (void)state;
    snow_context *context = support_context();
    static unsigned char values[VOXELS];
    uint64_t seed = 5;
    for (int n = 0; n < VOXELS; n++)
        values[n] = (n / 9 + n / 3000) % 11 < 2 && support_random(&seed) % 3;
    snow_volume *volume;
    snow_transfer *transfer;
    open_quarters(context, &(const cut_volume){NULL}, values, &volume,
                  &transfer);
    for (int n = 0; n < 18; n++) {
        enum { RANKS = 5 };
        const snow_partition_params order = {
            .cut = n % 2 ? SNOW_PARTITION_BRICKS : SNOW_PARTITION_COUNTED,
            .ranks = RANKS,
            .grid = {.dims = {SIDE, SIDE, SIDE}, .axis = n / 2 % 3},
            .threads = 1 + n / 6};
        snow_box boxes[RANKS];
        int64_t loads[RANKS];
        assert_int_equal(
            snow_partition_boxes(NULL, &order, volume, transfer, boxes, loads),
            SNOW_STATUS_OK);
        for (int at = 0; at < VOXELS; at++) {
            const snow_box voxel = {
                {at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE}, {1, 1, 1}};
            snow_box shared;
            for (int rank = 0; values[at] && rank < RANKS; rank++)
                loads[rank] -=
                    snow_box_intersect(&voxel, &boxes[rank], &shared);
        }
        for (int rank = 0; rank < RANKS; rank++)
            assert_int_equal(loads[rank], 0);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_behind_an_opaque_plate_is_not_drawn),
        cmocka_unit_test(a_slab_begins_with_open_pixels),
        cmocka_unit_test(the_shear_moves_what_is_hidden),
        cmocka_unit_test(cells_cover_large_volumes),
        cmocka_unit_test(steep_rays_need_no_more_memory),
        cmocka_unit_test(sums_of_large_cells_do_not_overflow),
        cmocka_unit_test(slices_behind_an_opaque_plate_cost_less),
        cmocka_unit_test(scattered_voxels_cost_more),
        cmocka_unit_test(all_ranks_take_the_same_boxes),
        cmocka_unit_test(loads_are_the_voxels_in_boxes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
