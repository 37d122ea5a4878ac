/* tests/stages/test_costs.c - what drawing costs, by blocks of a volume, beside
 * counts of voxels. */
#include "support/support.h"

#include "classify/count_interesting.h"
#include "decompose/ray_grid.h"
#include "parallel/partition.h"

#include <string.h>

#define COST 24

static const int64_t dims[3] = {75, 41, 9};

/* Sparse clusters; 1 where a voxel is interesting. */
static void fill(unsigned char *voxels) {
    uint64_t seed = 5;
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++)
            for (int64_t x = 0; x < dims[0]; x++, voxels++)
                *voxels = (x / 9 + y / 7 + z) % 11 < 2 &&
                          support_random(&seed) % 3 == 0 && z != 4;
}

/* Interesting voxels of a slice along an axis. */
static int64_t voxels_of_slice(const unsigned char *voxels, int axis,
                               int64_t slice) {
    int64_t sum = 0;
    for (int64_t n = 0; n < dims[0] * dims[1] * dims[2]; n++) {
        const int64_t at[3] = {n % dims[0], n / dims[0] % dims[1],
                               n / dims[0] / dims[1]};
        sum += at[axis] == slice && voxels[n];
    }
    return sum;
}

static void count_slices(const snow_volume *volume,
                         const snow_transfer *transfer, int axis, int threads,
                         int span, int64_t counts[75]) {
    const snow_partition_grid grid = {.dims = {dims[0], dims[1], dims[2]},
                                      .axis = axis};
    snow_block_counts blocks = snow_block_counts_for_slabs(&grid);
    memset(counts, 0, 75 * sizeof *counts);
    blocks.counts = counts;
    blocks.span = span;
    assert_int_equal(snow_count_interesting_blocks(
                         volume, transfer, 0, SNOW_ISA_AUTO, threads, &blocks),
                     SNOW_STATUS_OK);
}

/* A volume of the voxels above, of which 1 is seen and 0 is not. */
static void open_voxels(snow_context *context, const unsigned char *voxels,
                        snow_volume **volume, snow_transfer **transfer) {
    static const snow_opacity_point opacities[] = {{0, 0}, {1, 1}};
    static const snow_color_point colors[] = {{0, 1, 1, 1}};
    const snow_look look = {.size = sizeof look,
                            .colors = colors,
                            .color_count = 1,
                            .opacities = opacities,
                            .opacity_count = 2};
    snow_volume_info info;
    snow_volume_info_init(&info);
    memcpy(info.dims, dims, sizeof dims);
    info.type = SNOW_TYPE_UINT8;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(*volume, &look, transfer),
                     SNOW_STATUS_OK);
}

/* Without a cost of spans a slice costs its voxels.  With one it costs some
 * spans more: at least as many as hold its voxels, and none where there are
 * none.  Threads change nothing. */
static void costs_are_those_of_voxels_and_spans(void **state) {
    (void)state;
    snow_context *context = support_context();
    static unsigned char voxels[75 * 41 * 9];
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    fill(voxels);
    open_voxels(context, voxels, &volume, &transfer);
    for (int axis = 0; axis < 3; axis++) {
        int64_t plain[75], costs[75], again[75];
        count_slices(volume, transfer, axis, 1, 0, plain);
        count_slices(volume, transfer, axis, 1, COST, costs);
        for (int threads = 2; threads <= 3; threads++) {
            count_slices(volume, transfer, axis, threads, COST, again);
            assert_memory_equal(again, costs, sizeof costs);
        }
        for (int64_t n = 0; n < dims[axis]; n++) {
            int64_t here = voxels_of_slice(voxels, axis, n);
            int64_t spans = (costs[n] - here) / COST;
            assert_int_equal(plain[n], here);
            assert_int_equal(here + spans * COST, costs[n]);
            assert_true(spans <= dims[0] * dims[1]);
            if (axis == 2) {
                assert_true(spans * SNOW_COST_SPAN >= here);
                assert_true(here || spans == 0);
            }
        }
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Samples lie between rows: a voxel is drawn with those of its own row and of
 * the next one, behind the last row with its own alone. */
static void a_voxel_costs_a_span_in_its_row_and_in_the_next(void **state) {
    (void)state;
    snow_context *context = support_context();
    static const struct {
        int64_t x, y;
        int spans[2]; /* of rows along x, and along y */
    } places[] = {{40, 20, {2, 2}}, {74, 20, {2, 1}}, {40, 40, {1, 2}}};
    for (size_t n = 0; n < sizeof places / sizeof *places; n++) {
        static unsigned char voxels[75 * 41 * 9];
        snow_volume *volume = NULL;
        snow_transfer *transfer = NULL;
        memset(voxels, 0, sizeof voxels);
        voxels[(4 * dims[1] + places[n].y) * dims[0] + places[n].x] = 1;
        open_voxels(context, voxels, &volume, &transfer);
        for (int axis = 0; axis < 3; axis++) {
            int64_t costs[75], sum = 0;
            count_slices(volume, transfer, axis, 1, COST, costs);
            for (int64_t i = 0; i < dims[axis]; i++)
                sum += costs[i];
            assert_int_equal(sum, 1 + COST * places[n].spans[axis == 0]);
        }
        snow_transfer_free(transfer);
        snow_volume_close(volume);
    }
    snow_context_free(context);
}

/* Opacities of quarters, which a constant gradient opacity halves. */
static const snow_opacity_point quarters[] = {{0, 0}, {4, 1}};
static const snow_opacity_point halves[] = {{0, 0.5}, {100, 0.5}};
static const snow_color_point white[] = {{0, 1, 1, 1}};

static void make_volume(snow_context *context, const int64_t sides[3],
                        snow_type type, bool gradient, const void *voxels,
                        snow_volume **volume, snow_transfer **transfer) {
    const snow_look look = {.size = sizeof look,
                            .colors = white,
                            .color_count = 1,
                            .opacities = quarters,
                            .opacity_count = 2,
                            .gradient_opacities = gradient ? halves : NULL,
                            .gradient_opacity_count = gradient ? 2 : 0};
    snow_volume_info info;
    snow_volume_info_init(&info);
    memcpy(info.dims, sides, sizeof info.dims);
    info.type = type;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(*volume, &look, transfer),
                     SNOW_STATUS_OK);
}

/* The sums of the cells by a loop over all voxels. */
static void expect_sums(const snow_ray_grid *grid, const unsigned char *voxels,
                        double factor) {
    static int64_t sums[16 * 16 * 32];
    const size_t cells = snow_ray_grid_cells(grid);
    assert_true(cells <= 16 * 16 * 32);
    memset(sums, 0, sizeof sums);
    for (int64_t z = 0; z < dims[2]; z += grid->step)
        for (int64_t y = 0; y < dims[1]; y++)
            for (int64_t x = 0; x < dims[0]; x++) {
                const int value = voxels[(z * dims[1] + y) * dims[0] + x];
                if (value)
                    sums[snow_ray_grid_place(grid, 0, x) +
                         snow_ray_grid_place(grid, 1, y) +
                         snow_ray_grid_place(grid, 2, z)] +=
                        snow_ray_grid_word(grid, (float)(value * factor / 4));
            }
    assert_memory_equal(grid->sums, sums, cells * sizeof *sums);
}

static void count_with_rays(snow_type type, bool gradient, int64_t step) {
    snow_context *context = support_context();
    static unsigned char bytes[75 * 41 * 9];
    static float floats[75 * 41 * 9];
    snow_volume *volume;
    snow_transfer *transfer;
    fill(bytes);
    for (int n = 0; n < 75 * 41 * 9; n++) {
        bytes[n] = (unsigned char)(bytes[n] * (1 + n % 3));
        floats[n] = bytes[n];
    }
    make_volume(context, dims, type, gradient,
                type == SNOW_TYPE_UINT8 ? (void *)bytes : (void *)floats,
                &volume, &transfer);
    for (int axis = 0; axis < 3; axis++)
        for (int threads = 1; threads <= 3; threads++) {
            const snow_partition_grid all = {
                .dims = {dims[0], dims[1], dims[2]}, .axis = axis};
            const snow_ray_view view = {
                .axes = {(axis + 1) % 3, (axis + 2) % 3, axis}, .path = 1};
            int64_t slices[75] = {0};
            static int64_t sums[16 * 16 * 32];
            snow_ray_grid rays;
            snow_block_counts counts = snow_block_counts_for_slabs(&all);
            memset(sums, 0, sizeof sums);
            snow_ray_grid_make(&view, dims, step, &rays);
            rays.sums = sums;
            counts.counts = slices;
            counts.step = step;
            counts.rays = &rays;
            assert_int_equal(snow_count_interesting_blocks(volume, transfer, 0,
                                                           SNOW_ISA_AUTO,
                                                           threads, &counts),
                             SNOW_STATUS_OK);
            expect_sums(&rays, bytes, gradient ? 0.5 : 1);
        }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void rays_are_counted_by_opacities(void **state) {
    (void)state;
    for (int64_t step = 1; step <= 2; step++) {
        count_with_rays(SNOW_TYPE_UINT8, false, step);
        count_with_rays(SNOW_TYPE_FLOAT32, false, step);
        count_with_rays(SNOW_TYPE_UINT8, true, step);
    }
}

/* Four opaque slices in front, and faint ones behind them. */
#define PLATE 64
static unsigned char plate[PLATE * PLATE * PLATE];

static void fill_plate(void) {
    memset(plate, 1, sizeof plate);
    memset(plate, 4, (size_t)PLATE * PLATE * 4);
}

static void cut_plate(snow_comm *comm, snow_context *context,
                      bool nearest_first, bool hides, int64_t ends[2]) {
    static const int64_t sides[3] = {PLATE, PLATE, PLATE};
    const int ranks = 2;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_box boxes[2];
    make_volume(context, sides, SNOW_TYPE_UINT8, false, plate, &volume,
                &transfer);
    const snow_partition_params order = {
        .cut = SNOW_PARTITION_COUNTED,
        .ranks = ranks,
        .grid = {.dims = {PLATE, PLATE, PLATE}, .axis = 2},
        .span = COST,
        .hides = hides,
        .rays = {
            .axes = {0, 1, 2}, .path = 0.01, .nearest_first = nearest_first}};
    assert_int_equal(
        snow_partition_boxes(comm, &order, volume, transfer, boxes, NULL),
        SNOW_STATUS_OK);
    for (int n = 0; n < ranks; n++)
        ends[n] = boxes[n].first[2] + boxes[n].count[2];
    snow_transfer_free(transfer);
    snow_volume_close(volume);
}

/* The slab in front has more slices, for the plate hides most of them. */
static void slices_behind_an_opaque_plate_cost_less(void **state) {
    (void)state;
    snow_context *context = support_context();
    int64_t ends[2];
    fill_plate();
    cut_plate(NULL, context, true, false, ends);
    assert_int_equal(ends[0], PLATE / 2);
    cut_plate(NULL, context, true, true, ends);
    assert_true(ends[0] >= 40);
    assert_int_equal(ends[1], PLATE);
    snow_context_free(context);
}

/* Ranks whose rays differ: as those of two machines may, by a last bit. */
static snow_status cut_by_own_rays(snow_comm *comm, void *user) {
    int64_t(*ends)[2] = user;
    const int rank = snow_comm_rank(comm);
    cut_plate(comm, snow_comm_context(comm), !rank, true, ends[rank]);
    return SNOW_STATUS_OK;
}

static void all_ranks_take_the_same_boxes(void **state) {
    (void)state;
    snow_context *context = support_context();
    int64_t ends[2][2], alone[2];
    fill_plate();
    cut_plate(NULL, context, false, true, alone);
    assert_int_equal(snow_comm_run_threads(context, 2, cut_by_own_rays, ends),
                     SNOW_STATUS_OK);
    assert_memory_equal(ends[0], ends[1], sizeof ends[0]);
    assert_int_not_equal(ends[1][0], alone[0]);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(costs_are_those_of_voxels_and_spans),
        cmocka_unit_test(a_voxel_costs_a_span_in_its_row_and_in_the_next),
        cmocka_unit_test(rays_are_counted_by_opacities),
        cmocka_unit_test(slices_behind_an_opaque_plate_cost_less),
        cmocka_unit_test(all_ranks_take_the_same_boxes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
