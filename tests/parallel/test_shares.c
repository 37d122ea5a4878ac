/* tests/parallel/test_shares.c - the shares of a file cover it, and are of
 * whole blocks where it is packed in such. */
#include "support/support.h"

#include "parallel/shares.h"

/* A place along an axis of a box of a file, in blocks of that. */
static int64_t block_at(const snow_file_blocks *b, int axis, int64_t at) {
    return (at + b->cut[axis]) / b->size[axis];
}

/* Shares cover the grid one behind the other, empty ones last; returns how many
 * blocks more than one rank unpacks, and the voxels of the largest share. */
static int64_t check_shares(const int64_t dims[3], const snow_file_blocks *b,
                            int ranks, int64_t *largest) {
    int64_t voxels = 0, pieces = 0, blocks = 1;
    bool ended = false;
    *largest = 0;
    for (int i = 1; i < 3; i++)
        blocks *= block_at(b, i, dims[i] - 1) + 1;
    for (int rank = 0; rank < ranks; rank++) {
        const snow_box box = snow_share_of(dims, b, rank, ranks);
        int64_t here = box.count[0], touched = 1;
        for (int i = 1; i < 3; i++) {
            here *= box.count[i];
            assert_true(box.first[i] + box.count[i] <= dims[i]);
            touched *= block_at(b, i, box.first[i] + box.count[i] - 1) -
                       block_at(b, i, box.first[i]) + 1;
        }
        assert_false(here && ended);
        ended = !here;
        voxels += here;
        pieces += here ? touched : 0;
        *largest = here > *largest ? here : *largest;
    }
    assert_int_equal(voxels, dims[0] * dims[1] * dims[2]);
    return pieces - blocks;
}

/* Of a large volume, by ranks that are not many more than its blocks. */
static void shares_are_of_whole_blocks(void **state) {
    (void)state;
    const int64_t dims[3] = {50, 640, 500};
    const snow_file_blocks cubes = {{64, 64, 64}, {0, 0, 0}};
    const snow_file_blocks cut = {{64, 64, 64}, {0, 13, 63}};
    const snow_file_blocks slices = {{50, 640, 1}, {0, 0, 0}};
    for (int ranks = 1; ranks <= 48; ranks++) {
        const snow_file_blocks *all[] = {&cubes, &cut, &slices};
        for (int n = 0; n < 3; n++) {
            int64_t largest;
            assert_int_equal(check_shares(dims, all[n], ranks, &largest), 0);
            assert_true(largest <= SNOW_SHARE_MOST * 50 * 640 * 500 / ranks);
        }
    }
}

/* Shares of whole blocks would be too large: memory has precedence. */
static void few_blocks_are_shared(void **state) {
    (void)state;
    const int64_t dims[3] = {50, 64, 500};
    const snow_file_blocks thick = {{50, 64, 250}, {0, 0, 0}};
    int64_t largest;
    assert_int_equal(check_shares(dims, &thick, 2, &largest), 0);
    assert_true(check_shares(dims, &thick, 5, &largest) > 0);
    assert_int_equal(largest, 50 * 64 * 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_are_of_whole_blocks),
        cmocka_unit_test(few_blocks_are_shared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
