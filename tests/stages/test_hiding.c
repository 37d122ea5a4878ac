/* tests/stages/test_hiding.c - slabs that are cut for what their fronts hide,
 * beside rays that are followed one by one, in double precision. */
#include "support/support.h"

#include "classify/count_interesting.h"

#include <math.h>
#include <stdlib.h>

#define SIDE 96
#define MIDDLE ((SIDE - 1) / 2.0)
#define SPAN 24
#define CLEAR (0.5 / 255) /* behind less nothing is drawn */

/* Rays through lattice points far enough outside. */
#define LOW (-96)
#define HIGH (SIDE + 96)

static unsigned char voxels[SIDE * SIDE * SIDE];

/* Opacities of 255: a ball, opaque within three voxels, in a thin mist. */
static void fill(void) {
    uint64_t seed = 3;
    for (int64_t n = 0; n < SIDE * SIDE * SIDE; n++) {
        double square = 0;
        for (int64_t at = n, axis = 0; axis < 3; axis++, at /= SIDE)
            square += pow((double)(at % SIDE) - MIDDLE, 2);
        voxels[n] = square < 36 * 36 ? 240
                    : square < 46 * 46
                        ? (unsigned char)(support_random(&seed) % 8)
                        : 0;
    }
}

typedef struct scene {
    snow_viewer viewer;
    int axis, u, v; /* of slices, along a row, from row to row */
} scene;

static scene scene_of(int axis, const snow_viewer *viewer) {
    return (scene){*viewer, axis, axis == 0, axis == 2 ? 1 : 2};
}

/* Where a ray that meets the middle slice at a place meets another. */
static double place_of(const scene *s, int on, double middle, int64_t slice) {
    const double *eye = s->viewer.eye, *along = s->viewer.along;
    if (!s->viewer.perspective)
        return middle + along[on] / along[s->axis] * ((double)slice - MIDDLE);
    return eye[on] + (middle - eye[on]) * ((double)slice - eye[s->axis]) /
                         (MIDDLE - eye[s->axis]);
}

/* The opacity of the voxel next to a ray in a slice. */
static double sample(const scene *s, int u, int v, int64_t slice) {
    const int64_t strides[3] = {1, SIDE, SIDE * SIDE};
    const double x = floor(place_of(s, s->u, u, slice) + 0.5);
    const double y = floor(place_of(s, s->v, v, slice) + 0.5);
    if (x < 0 || x >= SIDE || y < 0 || y >= SIDE)
        return 0;
    return voxels[(int64_t)x * strides[s->u] + (int64_t)y * strides[s->v] +
                  slice * strides[s->axis]] /
           255.0;
}

/* What a slab costs: samples of rays that are still open, and spans of them. */
static double cost_of(const scene *s, const snow_box *slab) {
    static double clarity[HIGH - LOW][HIGH - LOW];
    const bool falls = s->viewer.along[s->axis] < 0;
    double cost = 0;
    for (int v = 0; v < HIGH - LOW; v++)
        for (int u = 0; u < HIGH - LOW; u++)
            clarity[v][u] = 1;
    for (int64_t n = 0; n < slab->count[s->axis]; n++) {
        const int64_t on = falls ? slab->count[s->axis] - 1 - n : n;
        const int64_t slice = slab->first[s->axis] + on;
        cost += 2 * SIDE * SIDE / 32;
        for (int v = LOW; v < HIGH; v++)
            for (int first = LOW; first < HIGH; first += 32) {
                int seen = 0;
                for (int u = first; u < first + 32; u++) {
                    const double opacity = sample(s, u, v, slice);
                    double *left = &clarity[v - LOW][u - LOW];
                    seen += opacity > 0 && *left > CLEAR;
                    *left *= 1 - opacity;
                }
                cost += seen ? SPAN - 2 + seen : 0;
            }
    }
    return cost;
}

static double unevenness(const scene *s, const snow_box *boxes, int ranks) {
    double sum = 0, most = 0;
    for (int rank = 0; rank < ranks; rank++) {
        const double cost = cost_of(s, &boxes[rank]);
        sum += cost;
        most = fmax(most, cost);
    }
    return most * ranks / sum;
}

/* The voxels and a look by which numbers are opacities. */
typedef struct material {
    snow_context *context;
    snow_volume *volume;
    snow_transfer *transfer;
} material;

static void open_material(material *m) {
    snow_volume_info info;
    const snow_opacity_point opacities[] = {{0, 0}, {255, 1}};
    const snow_color_point colors[] = {{0, 1, 1, 1}};
    const snow_look look = {.size = sizeof look,
                            .colors = colors,
                            .color_count = 1,
                            .opacities = opacities,
                            .opacity_count = 2};
    fill();
    m->context = support_context();
    snow_volume_info_init(&info);
    for (int axis = 0; axis < 3; axis++)
        info.dims[axis] = SIDE;
    info.type = SNOW_TYPE_UINT8;
    assert_int_equal(snow_volume_wrap(m->context, &info, voxels, &m->volume),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_transfer_new_for_volume(m->volume, &look, &m->transfer),
        SNOW_STATUS_OK);
}

static void close_material(material *m) {
    snow_transfer_free(m->transfer);
    snow_volume_close(m->volume);
    snow_context_free(m->context);
}

/* Cuts for a scene, or as if nothing were hidden. */
static void cut(const material *m, const scene *s, bool hides, int ranks,
                snow_box *boxes) {
    int64_t costs[SIDE] = {0};
    snow_hiding hiding;
    const snow_partition_grid grid = {.dims = {SIDE, SIDE, SIDE},
                                      .axis = s->axis};
    snow_block_counts counts = snow_block_counts_for_slabs(&grid);
    counts.counts = costs;
    counts.span = SPAN;
    counts.hiding = hides ? &hiding : NULL;
    assert_int_equal(
        snow_hiding_new(m->context, grid.dims, s->axis, &s->viewer, 1, &hiding),
        SNOW_STATUS_OK);
    assert_int_equal(snow_count_interesting_blocks(m->volume, m->transfer, 0,
                                                   SNOW_ISA_AUTO, &counts),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_partition_counted(m->context, &counts, ranks, boxes),
                     SNOW_STATUS_OK);
    snow_hiding_free(m->context, &hiding);
}

static void check_cover(const scene *s, const snow_box *boxes, int ranks) {
    int64_t at = 0;
    for (int rank = 0; rank < ranks; rank++) {
        assert_int_equal(boxes[rank].first[s->axis], at);
        assert_int_equal(boxes[rank].count[s->u], SIDE);
        assert_int_equal(boxes[rank].count[s->v], SIDE);
        at += boxes[rank].count[s->axis];
    }
    assert_int_equal(at, SIDE);
}

/* Four ranks: the front one of a ball has what is not hidden. */
static void check(const material *m, int axis, const snow_viewer *viewer) {
    enum { RANKS = 4 };
    snow_box boxes[RANKS];
    const scene s = scene_of(axis, viewer);
    cut(m, &s, false, RANKS, boxes);
    const double before = unevenness(&s, boxes, RANKS);
    cut(m, &s, true, RANKS, boxes);
    const double after = unevenness(&s, boxes, RANKS);
    print_message("axis %d, along %g %g %g%s: %.3f, with hiding %.3f\n", axis,
                  viewer->along[0], viewer->along[1], viewer->along[2],
                  viewer->perspective ? " from an eye" : "", before, after);
    check_cover(&s, boxes, RANKS);
    assert_true(before > 1.12);
    assert_true(after < 1.15);
    assert_true(after - 1 < 0.3 * (before - 1));
}

static void slabs_are_even_along_every_axis(void **state) {
    (void)state;
    material m;
    open_material(&m);
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            snow_viewer viewer = {0};
            viewer.along[axis] = sign;
            check(&m, axis, &viewer);
        }
    close_material(&m);
}

static void slabs_are_even_between_axes(void **state) {
    (void)state;
    material m;
    open_material(&m);
    const snow_viewer down = {.along = {0.5, -0.3, -1}};
    const snow_viewer right = {.along = {1, 0.4, 0.6}};
    const snow_viewer eye = {true, {30, 70, -110}, {0.1, -0.2, 1}};
    check(&m, 2, &down);
    check(&m, 0, &right);
    check(&m, 2, &eye);
    close_material(&m);
}

/* Ranks note those of their voxels, and all are summed up. */
static void samples_are_noted_once(void **state) {
    (void)state;
    material m;
    open_material(&m);
    const snow_viewer viewer = {.along = {0.3, -0.7, 1}};
    snow_hiding all, parts;
    for (int n = 0; n < 2; n++)
        assert_int_equal(snow_hiding_new(m.context,
                                         (int64_t[3]){SIDE, SIDE, SIDE}, 2,
                                         &viewer, 1, n ? &parts : &all),
                         SNOW_STATUS_OK);
    const size_t words = snow_hiding_words(&all);
    unsigned char *sums = calloc(4, words);
    assert_non_null(sums);
    int64_t ray[2], samples = 0;
    for (int64_t z = 0; z < SIDE; z++)
        for (int64_t y = 0; y < SIDE; y++)
            for (int64_t x = 0; x < SIDE; x++) {
                ray[0] = snow_hiding_ray(&all, 0, z, x);
                ray[1] = snow_hiding_ray(&all, 1, z, y);
                if (ray[0] < 0 || ray[1] < 0)
                    continue;
                samples++;
                snow_hiding_add(&all, ray, z, 0.5);
                snow_hiding_add(&parts, ray, z, 0.5);
                /* Each sample is noted once, so that a sum is an or. */
                const int64_t at =
                    (z * all.rays[1] + ray[1]) * all.rays[0] + ray[0];
                assert_true(parts.depths[at / 4] >> 16 * (at % 4) & 0xffff);
                parts.depths[at / 4] &= ~(INT64_C(0xffff) << 16 * (at % 4));
                sums[at] = (unsigned char)(sums[at] + 1);
                assert_int_equal(sums[at], 1);
            }
    for (size_t n = 0; n < words; n++)
        assert_int_equal(parts.depths[n], 0);
    assert_true(samples > SIDE * SIDE);
    free(sums);
    snow_hiding_free(m.context, &parts);
    snow_hiding_free(m.context, &all);
    close_material(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_are_even_along_every_axis),
        cmocka_unit_test(slabs_are_even_between_axes),
        cmocka_unit_test(samples_are_noted_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
