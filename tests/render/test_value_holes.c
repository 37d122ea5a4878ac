/* tests/render/test_value_holes.c - method value where voxels have no value or
 * are cut off, beside the float64 reference of the value model. */
#include <math.h>

#include "values/pictures.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Scenes of floats are every fifth. */
#define FLOATS(k) (5 * (k) + 2)
#define SCENES 36

/* Makes holes of voxels here and there, or of all beyond a surface. */
static void punch(reference_scene *s, int n) {
    const int64_t *dims = s->info.dims;
    float *voxel = (float *)(uintptr_t)s->voxels;
    uint64_t state = (uint64_t)n * 2 + 1;
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, voxel++) {
                double noise = support_uniform(&state);
                double at = (double)i / (double)dims[0] +
                            0.7 * (double)j / (double)dims[1] -
                            0.8 * (double)k / (double)dims[2];
                bool hole = n % 3 == 0   ? noise < 0.15
                            : n % 3 == 1 ? at > 0.5
                                         : at > 0.6 || noise < 0.02;
                if (hole)
                    *voxel = NAN;
            }
}

static void holes_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int k = 0; k < SCENES; k += (int)support_stride(17)) {
        int n = FLOATS(k);
        value_scene scene = {.base = value_picture_scene(n)};
        punch(&scene.base, k);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

/* How far a voxel is beyond the farthest of two planes. */
static double height_of(const snow_volume_info *info, double planes[2][4],
                        size_t voxel) {
    const size_t columns = (size_t)info->dims[0], rows = (size_t)info->dims[1];
    const double at[3] = {(double)(voxel % columns),
                          (double)(voxel / columns % rows),
                          (double)(voxel / columns / rows)};
    double most = -INFINITY;
    for (int plane = 0; plane < 2; plane++) {
        double height = -planes[plane][3];
        for (int r = 0; r < 3; r++)
            height += planes[plane][r] *
                      (info->matrix[r][0] * at[0] + info->matrix[r][1] * at[1] +
                       info->matrix[r][2] * at[2] + info->matrix[r][3]);
        most = fmax(most, height);
    }
    return most;
}

/* Moves the largest and the smallest voxel to where planes leave them: the
 * model's numbers are of the whole volume, the method's of what is left. */
static void keep_range(const reference_scene *s, double planes[2][4]) {
    const int64_t *dims = s->info.dims;
    size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
    size_t size = snow_type_size(s->info.type), ends[2] = {0}, inner[2] = {0};
    char *voxels = (char *)(uintptr_t)s->voxels;
    for (int side = 0; side < 2; side++) {
        inner[side] = side && inner[0] == 0;
        for (size_t n = 0; n < count; n++) {
            double a = reference_native(s, (int64_t)n % dims[0],
                                        (int64_t)n / dims[0] % dims[1],
                                        (int64_t)n / dims[0] / dims[1]);
            size_t e = ends[side];
            double b = reference_native(s, (int64_t)e % dims[0],
                                        (int64_t)e / dims[0] % dims[1],
                                        (int64_t)e / dims[0] / dims[1]);
            if (side ? a > b : a < b)
                ends[side] = n;
            if (!(side && n == inner[0]) &&
                height_of(&s->info, planes, n) <
                    height_of(&s->info, planes, inner[side]))
                inner[side] = n;
        }
    }
    char both[2][8];
    for (int side = 0; side < 2; side++)
        memcpy(both[side], voxels + ends[side] * size, size);
    for (int side = 0; side < 2; side++)
        memcpy(voxels + inner[side] * size, both[side], size);
}

/* Two planes through the volume. */
static void place_planes(const snow_volume_info *info, double planes[2][4]) {
    const double normals[2][3] = {{0.6, 0.3, -0.5}, {-0.2, 0.9, 0.4}};
    for (int plane = 0; plane < 2; plane++) {
        planes[plane][3] = 0;
        for (int r = 0; r < 3; r++) {
            double middle = info->matrix[r][3];
            for (int c = 0; c < 3; c++)
                middle += info->matrix[r][c] * (double)(info->dims[c] - 1) *
                          (plane ? 0.8 : 0.6);
            planes[plane][r] = normals[plane][r];
            planes[plane][3] += normals[plane][r] * middle;
        }
    }
}

static void clip_planes_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 1; n < VALUE_PICTURES; n += 7 * (int)support_stride(9)) {
        value_scene scene = {.base = value_picture_scene(n)};
        double planes[2][4];
        place_planes(&scene.base.info, planes);
        keep_range(&scene.base, planes);
        scene.clips = (const double(*)[4])planes;
        scene.clip_count = n % 2 ? 2 : 1;
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void logarithmic_looks_are_the_references(void **state) {
    (void)state;
    static const snow_opacity_point decades[] = {
        {1, 0}, {4, 0.02}, {20, 0.3}, {20, 0.1}, {90, 0.8}};
    static const snow_opacity_point everything[] = {{1, 0.1}, {100, 0.5}};
    model_stage stage = model_open();
    for (int n = 0; n < VALUE_PICTURES; n += 11 * (int)support_stride(9)) {
        value_scene scene = {.base = value_picture_scene(n)};
        scene.base.log = true;
        scene.base.opacities = n % 3 ? decades : everything;
        scene.base.opacity_count = n % 3 ? COUNT(decades) : COUNT(everything);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void bits_are_the_same(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int k = 0; k < SCENES; k += 2 * (int)support_stride(9)) {
        int n = FLOATS(k);
        value_scene scene = {.base = value_picture_scene(n)};
        const double plane[1][4] = {{0.3, 0.5, 0.2, 12}};
        punch(&scene.base, k);
        scene.clips = plane;
        scene.clip_count = 1;
        value_picture_check_bits(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(holes_are_the_references),
        cmocka_unit_test(clip_planes_are_the_references),
        cmocka_unit_test(logarithmic_looks_are_the_references),
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
