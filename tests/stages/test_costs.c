/* tests/stages/test_costs.c - what drawing costs, by blocks of a volume, beside
 * a count of every span. */
#include "support/support.h"

#include "classify/count_interesting.h"

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

static bool is_seen(const unsigned char *voxels, int64_t x, int64_t y,
                    int64_t z) {
    return z >= 0 && y >= 0 && x >= 0 && x < dims[0] && y < dims[1] &&
           voxels[(z * dims[1] + y) * dims[0] + x];
}

/* Whether a span of row `row` of slice z, or of the row or the slice before,
 * has an interesting voxel. */
static bool is_drawn(const unsigned char *voxels, bool along_y, int64_t span,
                     int64_t row, int64_t z) {
    for (int64_t n = 0; n < 2; n++)
        for (int64_t lane = 0; lane < SNOW_COST_SPAN; lane++) {
            int64_t along = span * SNOW_COST_SPAN + lane, at = row - n;
            if (is_seen(voxels, along_y ? at : along, along_y ? along : at, z))
                return true;
        }
    return false;
}

static int64_t all_costs(const unsigned char *voxels, int axis) {
    const bool along_y = axis == 0;
    int64_t sum = 0;
    for (int64_t n = 0; n < dims[0] * dims[1] * dims[2]; n++)
        sum += voxels[n];
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t row = 0; row < dims[!along_y]; row++)
            for (int64_t span = 0; span * SNOW_COST_SPAN < dims[along_y];
                 span++)
                sum += is_drawn(voxels, along_y, span, row, z) ? COST : 0;
    return sum;
}

static void costs_are_those_of_voxels_and_spans(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume_info info;
    const snow_opacity_point opacities[] = {{0, 0}, {1, 1}};
    const snow_color_point colors[] = {{0, 1, 1, 1}};
    const snow_look look = {.size = sizeof look,
                            .colors = colors,
                            .color_count = 1,
                            .opacities = opacities,
                            .opacity_count = 2};
    static unsigned char voxels[75 * 41 * 9];
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    fill(voxels);
    snow_volume_info_init(&info);
    memcpy(info.dims, dims, sizeof dims);
    info.type = SNOW_TYPE_UINT8;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_OK);
    for (int axis = 0; axis < 3; axis++) {
        const snow_partition_grid grid = {.dims = {dims[0], dims[1], dims[2]},
                                          .axis = axis};
        int64_t costs[3][75] = {{0}}, sum = 0;
        for (int threads = 1; threads <= 3; threads++) {
            snow_block_counts counts = snow_block_counts_for_slabs(&grid);
            counts.counts = costs[threads - 1];
            counts.span = COST;
            assert_int_equal(snow_count_interesting_blocks(volume, transfer, 0,
                                                           SNOW_ISA_AUTO,
                                                           threads, &counts),
                             SNOW_STATUS_OK);
            assert_memory_equal(costs[threads - 1], costs[0], sizeof costs[0]);
        }
        for (int64_t n = 0; n < dims[axis]; n++)
            sum += costs[0][n];
        assert_int_equal(sum, all_costs(voxels, axis));
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(costs_are_those_of_voxels_and_spans),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
