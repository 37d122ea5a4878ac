/* tests/stages/test_hull.c - the corners of voxels bound all of them in every
 * direction, and are few. */
#include "support/support.h"

#include "transform/hull.h"

#include <math.h>

#define SIDE 24

/* Whether a voxel is in a ball, a random cloud, a plane, a line, alone. */
static bool is_in(int kind, const int at[3], uint64_t *state) {
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += (at[i] - 11.7) * (at[i] - 11.7);
    const bool kinds[] = {square < 121,
                          support_random(state) % 1000 < 3,
                          at[0] + 2 * at[1] == at[2] + 9,
                          at[1] == 5 && at[2] == 7,
                          at[0] == 3 && at[1] == 4 && at[2] == 5,
                          false};
    return kinds[kind];
}

/* The farthest point along a direction. */
static double reach(double (*points)[3], size_t count, const double way[3]) {
    double most = -INFINITY;
    for (size_t n = 0; n < count; n++)
        most = fmax(most, way[0] * points[n][0] + way[1] * points[n][1] +
                              way[2] * points[n][2]);
    return most;
}

/* Two parts, the second of which lies behind the first one. */
static void corners_reach_as_far_as_all_voxels(void **state) {
    snow_context *context = support_context();
    (void)state;
    static double all[SIDE * SIDE * SIDE][3];
    static uint32_t rows[SIDE * SIDE / 2][2];
    uint64_t chance = 7;
    for (int kind = 0; kind < 6; kind++) {
        snow_hull hull = {.context = context};
        size_t count = 0;
        for (int part = 0; part < 2; part++) {
            const snow_extent extent = {.first = {0, 0, part * SIDE / 2},
                                        .count = {SIDE, SIDE, SIDE / 2}};
            for (int n = 0; n < SIDE * SIDE / 2; n++) {
                rows[n][0] = 1;
                rows[n][1] = 0;
                for (int x = 0; x < SIDE; x++) {
                    const int at[3] = {x, n % SIDE, n / SIDE + part * SIDE / 2};
                    if (!is_in(kind, at, &chance))
                        continue;
                    if (rows[n][0] > rows[n][1])
                        rows[n][0] = (uint32_t)x;
                    rows[n][1] = (uint32_t)x;
                    for (int i = 0; i < 3; i++)
                        all[count][i] = at[i];
                    count++;
                }
            }
            assert_int_equal(snow_hull_add(&hull, &extent, rows), 0);
        }
        assert_int_equal(snow_hull_end(&hull), 0);
        for (int n = 0; n < 500; n++) {
            double way[3];
            for (int i = 0; i < 3; i++) /* many along axes and diagonals */
                way[i] = (double)(support_random(&chance) % 7) - 3;
            assert_true(reach(hull.points, hull.count, way) ==
                        reach(all, count, way));
        }
        assert_true(kind != 0 || hull.count < count / 8);
        snow_hull_free(&hull);
    }
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_reach_as_far_as_all_voxels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
