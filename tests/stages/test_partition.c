/* tests/stages/test_partition.c - cuts of a grid: nothing twice, nothing left
 * out, and how equal the loads are. */
#include "support/support.h"

#include "decompose/partition.h"

#include <math.h>

typedef enum kind { EQUAL, COUNTED, BRICKS } kind;

/* A grid with borders at the multiples of a number, or anywhere for 1. */
static snow_partition_grid grid_of(const int64_t dims[3], int axis,
                                   int64_t multiple) {
    static int64_t borders[1025];
    snow_partition_grid grid = {{dims[0], dims[1], dims[2]}, axis, NULL, 0};
    if (multiple == 1)
        return grid;
    grid.borders = borders;
    for (int64_t at = 0; at < dims[axis]; at += multiple)
        borders[grid.count++] = at;
    borders[grid.count] = dims[axis];
    return grid;
}

/* Block counts as a cut needs them, with counts of `inside` (NULL: none). */
typedef int64_t inside_fn(const int64_t dims[3], const snow_box *block);

static snow_block_counts count(kind how, const snow_partition_grid *grid,
                               int ranks, inside_fn *inside) {
    snow_block_counts t = how == BRICKS
                              ? snow_block_counts_for_bricks(grid, ranks)
                              : snow_block_counts_for_slabs(grid);
    t.counts = calloc(snow_block_counts_blocks(&t), sizeof *t.counts);
    assert_non_null(t.counts);
    int64_t *to = t.counts, at[3];
    for (at[2] = 0; at[2] < t.blocks[2]; at[2]++)
        for (at[1] = 0; at[1] < t.blocks[1]; at[1]++)
            for (at[0] = 0; at[0] < t.blocks[0]; at[0]++, to++) {
                const int64_t end[3] = {at[0] + 1, at[1] + 1, at[2] + 1};
                snow_box box = snow_block_counts_box(&t, at, end);
                *to = inside ? inside(grid->dims, &box) : 0;
            }
    return t;
}

static void cut(snow_context *context, kind how,
                const snow_block_counts *block_counts, int ranks,
                snow_box *boxes) {
    if (how == EQUAL)
        snow_partition_equal(&block_counts->grid, ranks, boxes);
    else if (how == COUNTED)
        assert_int_equal(
            snow_partition_counted(context, block_counts, ranks, boxes),
            SNOW_STATUS_OK);
    else
        assert_int_equal(
            snow_partition_bricks(context, block_counts, ranks, boxes),
            SNOW_STATUS_OK);
}

/* The voxels of an ellipsoid that fills the grid: of a row those between two
 * roots. */
static int64_t ellipsoid(const int64_t dims[3], const snow_box *block) {
    int64_t sum = 0;
    for (int64_t z = 0; z < block->count[2]; z++)
        for (int64_t y = 0; y < block->count[1]; y++) {
            double v =
                2 * ((double)(block->first[1] + y) + 0.5) / (double)dims[1] - 1;
            double w =
                2 * ((double)(block->first[2] + z) + 0.5) / (double)dims[2] - 1;
            double square = 1 - v * v - w * w;
            if (square <= 0)
                continue;
            double half = (double)dims[0] / 2, reach = half * sqrt(square);
            double low = ceil(half - reach - 0.5),
                   high = floor(half + reach - 0.5) + 1;
            low = fmax(low, (double)block->first[0]);
            high = fmin(high, (double)(block->first[0] + block->count[0]));
            sum += high > low ? (int64_t)(high - low) : 0;
        }
    return sum;
}

/* Each voxel in exactly one box; borders along the axis at multiples. */
static void check_cover(const int64_t dims[3], int axis, int64_t multiple,
                        const snow_box *boxes, int ranks) {
    static unsigned char seen[64 * 64 * 64];
    memset(seen, 0, sizeof seen);
    for (int rank = 0; rank < ranks; rank++) {
        const snow_box *b = &boxes[rank];
        int64_t end = b->first[axis] + b->count[axis];
        for (int i = 0; i < 3; i++)
            assert_true(b->first[i] >= 0 && b->count[i] >= 0 &&
                        b->first[i] + b->count[i] <= dims[i]);
        if (!snow_box_voxels(b))
            continue;
        assert_int_equal(b->first[axis] % multiple, 0);
        assert_true(end % multiple == 0 || end == dims[axis]);
        for (int64_t z = 0; z < b->count[2]; z++)
            for (int64_t y = 0; y < b->count[1]; y++)
                for (int64_t x = 0; x < b->count[0]; x++)
                    seen[((b->first[2] + z) * dims[1] + b->first[1] + y) *
                             dims[0] +
                         b->first[0] + x]++;
    }
    for (int64_t i = 0; i < dims[0] * dims[1] * dims[2]; i++)
        assert_int_equal(seen[i], 1);
}

static uint64_t random_state = 17;

static int64_t noise(const int64_t dims[3], const snow_box *block) {
    (void)dims;
    return support_random(&random_state) % 4
               ? 0
               : (int64_t)(support_random(&random_state) %
                           (uint64_t)(snow_box_voxels(block) + 1));
}

static void every_voxel_is_in_exactly_one_box(void **state) {
    (void)state;
    snow_context *context = support_context();
    static snow_box boxes[4096];
    static int64_t loads[4096];
    static const int some_ranks[] = {1, 2, 3, 5, 7, 8, 16, 31, 64, 500, 4096};
    for (int round = 0; round < 400; round++) {
        kind how = (kind)(round % 3);
        int64_t dims[3], sum = 0;
        for (int i = 0; i < 3; i++)
            dims[i] = 1 + (int64_t)(support_random(&random_state) % 30);
        int axis = (int)(support_random(&random_state) % 3);
        int64_t multiple = 1 + (int64_t)(support_random(&random_state) % 9);
        int ranks = some_ranks[support_random(&random_state) % 11];
        snow_partition_grid grid = grid_of(dims, axis, multiple);
        snow_block_counts block_counts =
            count(how, &grid, ranks, round % 5 ? noise : NULL);
        cut(context, how, &block_counts, ranks, boxes);
        check_cover(dims, axis, multiple, boxes, ranks);
        snow_partition_loads(&block_counts, boxes, ranks, loads);
        for (int rank = 0; rank < ranks; rank++)
            sum += loads[rank];
        for (size_t i = 0; i < snow_block_counts_blocks(&block_counts); i++)
            sum -= block_counts.counts[i];
        assert_int_equal(sum, 0);
        free(block_counts.counts);
    }
    snow_context_free(context);
}

/* The largest load over the mean one: the time of all ranks relative to that of
 * equal loads; 1 without any load. */
static double imbalance_of(const int64_t *loads, int ranks) {
    double sum = 0, most = 0;
    for (int rank = 0; rank < ranks; rank++) {
        sum += (double)loads[rank];
        if ((double)loads[rank] > most)
            most = (double)loads[rank];
    }
    return sum > 0 ? most * ranks / sum : 1;
}

/* Of an ellipsoid. */
static double imbalance(kind how, const int64_t dims[3], int ranks) {
    const snow_partition_grid grid = grid_of(dims, 2, 1);
    snow_context *context = support_context();
    static snow_box boxes[4096];
    static int64_t loads[4096];
    snow_block_counts block_counts = count(how, &grid, ranks, ellipsoid);
    cut(context, how, &block_counts, ranks, boxes);
    snow_partition_loads(&block_counts, boxes, ranks, loads);
    free(block_counts.counts);
    snow_context_free(context);
    return imbalance_of(loads, ranks);
}

/* Of a slab through the middle the area is 3/2 of the mean one; what is counted
 * is about equal. */
static void cuts_of_an_ellipsoid_are_as_equal_as_they_can_be(void **state) {
    (void)state;
    static const int64_t dims[][3] = {{200, 240, 1024}, {256, 256, 256}};
    static const struct {
        kind how;
        int ranks;
        double least, most;
    } rows[] = {{EQUAL, 32, 1.49, 1.51}, {EQUAL, 1024, 1.49, 1.51},
                {COUNTED, 2, 1, 1.002},  {COUNTED, 8, 1, 1.02},
                {COUNTED, 32, 1, 1.04},  {COUNTED, 128, 1, 1.13},
                {BRICKS, 8, 1, 1.05},    {BRICKS, 33, 1, 1.05},
                {BRICKS, 128, 1, 1.1},   {BRICKS, 1024, 1, 1.15},
                {BRICKS, 4096, 1, 1.25}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const double found =
            imbalance(rows[i].how, dims[rows[i].how == BRICKS], rows[i].ranks);
        if (!(found >= rows[i].least && found <= rows[i].most))
            fail_msg("cut %d by %d ranks: %.4f", (int)rows[i].how,
                     rows[i].ranks, found);
    }
}

/* All that is interesting lies in slice 500. */
static int64_t one_slice(const int64_t dims[3], const snow_box *block) {
    (void)dims;
    return block->first[2] <= 500 && 500 < block->first[2] + block->count[2]
               ? block->count[0] * block->count[1]
               : 0;
}

static void no_rank_stores_all_that_is_empty(void **state) {
    (void)state;
    const int64_t dims[3] = {64, 64, 1000};
    const snow_partition_grid grid = grid_of(dims, 2, 1);
    snow_context *context = support_context();
    snow_box boxes[100];
    for (kind how = COUNTED; how <= BRICKS; how++) {
        snow_block_counts block_counts = count(how, &grid, 100, one_slice);
        cut(context, how, &block_counts, 100, boxes);
        for (int rank = 0; rank < 100; rank++)
            assert_true(snow_box_voxels(&boxes[rank]) <=
                        (how == COUNTED ? SNOW_THICKEST : SNOW_EMPTINESS + 1) *
                            64 * 64 * 10);
        free(block_counts.counts);
    }
    snow_context_free(context);
}

static void a_grid_without_interesting_voxels_is_cut_equally(void **state) {
    (void)state;
    const int64_t dims[3] = {64, 64, 128};
    const snow_partition_grid grid = grid_of(dims, 2, 1);
    snow_context *context = support_context();
    snow_box boxes[32];
    for (kind how = COUNTED; how <= BRICKS; how++) {
        snow_block_counts block_counts = count(how, &grid, 32, NULL);
        cut(context, how, &block_counts, 32, boxes);
        for (int rank = 0; rank < 32; rank++)
            assert_int_equal(snow_box_voxels(&boxes[rank]), 64 * 64 * 4);
        int64_t loads[32];
        snow_partition_loads(&block_counts, boxes, 32, loads);
        assert_true(imbalance_of(loads, 32) == 1);
        free(block_counts.counts);
    }
    snow_context_free(context);
}

/* 10^15 voxels: no count of blocks depends on them. */
static void blocks_of_a_huge_grid_fit_the_memory(void **state) {
    (void)state;
    const int64_t borders[] = {0, 7, 50000, 100000};
    snow_partition_grid grid = {{100000, 100000, 100000}, 1, NULL, 0};
    for (int ranks = 1; ranks <= 4096; ranks *= 8)
        for (int grouped = 0; grouped < 2; grouped++) {
            grid.borders = grouped ? borders : NULL;
            grid.count = 3;
            snow_block_counts block_counts =
                snow_block_counts_for_bricks(&grid, ranks);
            assert_in_range(snow_block_counts_blocks(&block_counts), ranks,
                            1 << 22);
            for (int i = 0; i < 3; i++) {
                assert_int_equal(snow_block_counts_begin(&block_counts, i, 0),
                                 0);
                assert_int_equal(snow_block_counts_begin(
                                     &block_counts, i, block_counts.blocks[i]),
                                 100000);
                for (int64_t voxel = 0; voxel < 100000; voxel += 9) {
                    int64_t n = snow_block_counts_find(&block_counts, i, voxel);
                    assert_true(
                        snow_block_counts_begin(&block_counts, i, n) <= voxel &&
                        voxel <
                            snow_block_counts_begin(&block_counts, i, n + 1));
                }
            }
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_voxel_is_in_exactly_one_box),
        cmocka_unit_test(cuts_of_an_ellipsoid_are_as_equal_as_they_can_be),
        cmocka_unit_test(no_rank_stores_all_that_is_empty),
        cmocka_unit_test(a_grid_without_interesting_voxels_is_cut_equally),
        cmocka_unit_test(blocks_of_a_huge_grid_fit_the_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
