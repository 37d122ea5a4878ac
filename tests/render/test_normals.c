/* tests/render/test_normals.c - 16-bit normals and the shading table, against
 * plain computations in double and against classify/shading/shade.c. */
#include "reference/model.h"

#include "base/vec3.h"
#include "classify/shading/normals.h"

#include <math.h>

#define DEGREES 57.29577951308232

/* The angle between two lines, in degrees. */
static double angle(const double a[3], const double b[3]) {
    double cross[3];
    snow_cross(a, b, cross);
    return DEGREES * atan2(snow_length(cross), fabs(snow_dot(a, b)));
}

static void random_direction(uint64_t *seed, double n[3]) {
    do
        for (int i = 0; i < 3; i++)
            n[i] = 2 * support_uniform(seed) - 1;
    while (!(snow_length(n) <= 1 && snow_length(n) > 0.01));
    snow_normalize(n);
}

/* --- one normal ----------------------------------------------------------- */

static void no_normal_is_off_by_more_than_stated(void **state) {
    (void)state;
    uint64_t seed = 1;
    double most = 0, sum = 0;
    for (int n = 0; n < 1000000; n++) {
        double direction[3], found[3];
        random_direction(&seed, direction);
        snow_normal_of(snow_normal_code(direction), found);
        double error = angle(direction, found);
        most = fmax(most, error);
        sum += error;
    }
    print_message(
        "             off by %.4f degrees at most, %.4f in the mean\n", most,
        sum / 1e6);
    assert_true(most <= SNOW_NORMAL_ERROR);
    assert_true(most > 0.9 * SNOW_NORMAL_ERROR);
}

static void each_code_is_that_of_its_normal(void **state) {
    (void)state;
    for (int code = 1; code <= 255 * 255; code++) {
        double normal[3];
        snow_normal_of((uint16_t)code, normal);
        assert_near(snow_length(normal), 1, 1e-15);
        assert_true(normal[2] >= 0);
        assert_int_equal(snow_normal_code(normal), code);
    }
}

static void opposite_normals_and_lengths_share_a_normal(void **state) {
    (void)state;
    const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    uint64_t seed = 2;
    double found[3], back[3];
    for (int n = 0; n < 3; n++) {
        snow_normal_of(snow_normal_code(axes[n]), found);
        assert_true(angle(found, axes[n]) == 0);
    }
    for (int n = 0; n < 1000; n++) {
        double a[3], b[3];
        random_direction(&seed, a);
        for (int i = 0; i < 3; i++)
            b[i] = -1e200 * a[i];
        snow_normal_of(snow_normal_code(a), found);
        snow_normal_of(snow_normal_code(b), back);
        assert_true(angle(found, back) < 1e-6);
    }
}

/* --- gradients ------------------------------------------------------------ */

/* The rule of the model, written once more: in index space. */
static double slope_along(const snow_volume *volume, const int64_t at[3],
                          int axis) {
    const int64_t *dims = volume->info.dims;
    int64_t stride = axis == 0 ? 1 : axis == 1 ? dims[0] : dims[0] * dims[1];
    int64_t here = at[0] + dims[0] * (at[1] + dims[1] * at[2]);
    double low = NAN, high = NAN, middle = snow_volume_native(volume, here);
    if (at[axis] > 0)
        low = snow_volume_native(volume, here - stride);
    if (at[axis] + 1 < dims[axis])
        high = snow_volume_native(volume, here + stride);
    if (isfinite(low) && isfinite(high))
        return (high - low) / 2;
    if (!isfinite(middle))
        return 0;
    return isfinite(high) ? high - middle : isfinite(low) ? middle - low : 0;
}

/* The normal in the world; false where there is none. */
static bool normal_at(const snow_volume *volume, const int64_t at[3],
                      double normal[3]) {
    double inverse[3][3], g[3], most = 0;
    assert_true(snow_matrix_invert3(volume->info.matrix, inverse));
    for (int i = 0; i < 3; i++) {
        g[i] = slope_along(volume, at, i);
        most = fmax(most, fabs(g[i]));
    }
    if (most == 0 || !isfinite(most))
        return false;
    for (int j = 0; j < 3; j++) {
        normal[j] = 0;
        for (int i = 0; i < 3; i++)
            normal[j] += inverse[i][j] * (g[i] / most);
    }
    snow_normalize(normal);
    return true;
}

static snow_placement placement_along(const snow_volume *volume, int axis) {
    snow_placement p = {.slice_axis = axis,
                        .u_axis = axis == 0 ? 1 : 0,
                        .v_axis = axis == 2 ? 1 : 2};
    p.columns = volume->info.dims[p.u_axis];
    p.rows = volume->info.dims[p.v_axis];
    p.slices = volume->info.dims[axis];
    return p;
}

typedef struct gradient_tally {
    int voxels, without, between;
    double most;
} gradient_tally;

/* The normal half-way between a voxel and the next along `axis`; false where
 * there is none, or so little of it that rounding has its say. */
static bool normal_between(const snow_volume *volume, const int64_t at[3],
                           int axis, double normal[3]) {
    double inverse[3][3], a[3], b[3], g[3], most = 0, parts = 0;
    int64_t next[3] = {at[0], at[1], at[2]};
    next[axis]++;
    assert_true(snow_matrix_invert3(volume->info.matrix, inverse));
    for (int i = 0; i < 3; i++) {
        a[i] = slope_along(volume, at, i);
        b[i] = slope_along(volume, next, i);
        parts = fmax(parts, fmax(fabs(a[i]), fabs(b[i])));
    }
    double scale = parts > 1e300 ? 0.25 : 1;
    for (int i = 0; i < 3; i++) {
        g[i] = a[i] * scale + b[i] * scale;
        most = fmax(most, fabs(g[i]));
    }
    if (!(most > 2e-3 * parts) || !isfinite(most))
        return false;
    for (int j = 0; j < 3; j++)
        normal[j] = (inverse[0][j] * g[0] + inverse[1][j] * g[1] +
                     inverse[2][j] * g[2]) /
                    most;
    snow_normalize(normal);
    return true;
}

/* The row half-way to the next slice. */
static void check_between(const snow_normal_maker *known,
                          const snow_placement *p, int64_t slice, int64_t row,
                          const uint32_t *columns, size_t count,
                          gradient_tally *tally) {
    uint16_t codes[256], others[256];
    snow_normal_maker maker = *known;
    maker.isa = SNOW_ISA_SCALAR;
    snow_normals_of_row(&maker, p, slice, row, true, columns, count, codes);
    for (int isa = SNOW_ISA_AVX2; isa <= SNOW_ISA_AVX512; isa++)
        if (snow_isa_runs(maker.isa = (snow_isa)isa)) {
            snow_normals_of_row(&maker, p, slice, row, true, columns, count,
                                others);
            assert_memory_equal(codes, others, count * sizeof *codes);
        }
    for (size_t n = 0; n < count; n++) {
        int64_t at[3];
        double expected[3], found[3];
        at[p->slice_axis] = slice;
        at[p->v_axis] = row;
        at[p->u_axis] = columns[n];
        if (!normal_between(known->volume, at, p->slice_axis, expected))
            continue;
        assert_in_range(codes[n], 1, 255 * 255);
        snow_normal_of(codes[n], found);
        tally->most = fmax(tally->most, angle(found, expected));
        tally->between++;
    }
}

/* One row at every level, with only some of its columns. */
static void check_row(const snow_normal_maker *known, const snow_placement *p,
                      int64_t slice, int64_t row, double density,
                      uint64_t *seed, gradient_tally *tally) {
    uint32_t columns[256];
    uint16_t codes[256], others[256];
    snow_normal_maker maker = *known;
    size_t count = 0;
    for (int64_t u = 0; u < p->columns; u++)
        if (support_uniform(seed) < density)
            columns[count++] = (uint32_t)u;
    maker.isa = SNOW_ISA_SCALAR;
    snow_normals_of_row(&maker, p, slice, row, false, columns, count, codes);
    for (int isa = SNOW_ISA_AVX2; isa <= SNOW_ISA_AVX512; isa++)
        if (snow_isa_runs(maker.isa = (snow_isa)isa)) {
            snow_normals_of_row(&maker, p, slice, row, false, columns, count,
                                others);
            assert_memory_equal(codes, others, count * sizeof *codes);
        }
    for (size_t n = 0; n < count; n++) {
        int64_t at[3];
        double expected[3], found[3];
        at[p->slice_axis] = slice;
        at[p->v_axis] = row;
        at[p->u_axis] = columns[n];
        tally->voxels++;
        if (!normal_at(known->volume, at, expected)) {
            assert_int_equal(codes[n], SNOW_NO_NORMAL);
            tally->without++;
            continue;
        }
        assert_int_not_equal(codes[n], SNOW_NO_NORMAL);
        assert_in_range(codes[n], 1, 255 * 255);
        snow_normal_of(codes[n], found);
        tally->most = fmax(tally->most, angle(found, expected));
    }
    if (slice + 1 < p->slices)
        check_between(known, p, slice, row, columns, count, tally);
}

static gradient_tally check_volume(const snow_volume *volume) {
    snow_normal_maker maker;
    gradient_tally tally = {0};
    uint64_t seed = 9;
    assert_int_equal(snow_normal_maker_init(volume->context, volume, &maker),
                     SNOW_STATUS_OK);
    for (int axis = 0; axis < 3; axis++) {
        snow_placement p = placement_along(volume, axis);
        for (int64_t slice = 0; slice < p.slices; slice++)
            for (int64_t row = 0; row < p.rows; row++) {
                const double densities[] = {1, 0.02, 0.5};
                check_row(&maker, &p, slice, row, densities[(slice + row) % 3],
                          &seed, &tally);
            }
    }
    assert_true(tally.most <= SNOW_NORMAL_ERROR + 0.002);
    assert_true(tally.voxels > 0);
    return tally;
}

static void gradients_of_every_type_and_matrix(void **state) {
    (void)state;
    const int64_t sizes[3][3] = {{150, 7, 5}, {3, 70, 4}, {40, 33, 1}};
    snow_context *context = support_context();
    for (snow_type type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++)
        for (int matrix = 0; matrix < MODEL_MATRICES; matrix++)
            for (int size = 0; size < 3; size++) {
                reference_scene scene =
                    model_scene(sizes[size], type, true, (model_matrix)matrix,
                                (uint64_t)type + 3);
                snow_volume *volume;
                assert_int_equal(snow_volume_wrap(context, &scene.info,
                                                  scene.voxels, &volume),
                                 SNOW_STATUS_OK);
                gradient_tally tally = check_volume(volume);
                assert_true(tally.most > 0.2);
                assert_true(tally.between > tally.voxels / 2);
                snow_volume_close(volume);
                model_free(&scene);
            }
    snow_context_free(context);
}

static void volumes_of_one_voxel_or_line_have_borders_only(void **state) {
    (void)state;
    const int64_t sizes[4][3] = {{1, 1, 1}, {2, 1, 1}, {1, 90, 1}, {2, 2, 2}};
    snow_context *context = support_context();
    for (int size = 0; size < 4; size++) {
        reference_scene scene =
            model_scene(sizes[size], SNOW_TYPE_UINT8, true, MODEL_OBLIQUE, 4);
        snow_volume *volume;
        assert_int_equal(
            snow_volume_wrap(context, &scene.info, scene.voxels, &volume),
            SNOW_STATUS_OK);
        gradient_tally tally = check_volume(volume);
        assert_true(size != 0 || tally.without == tally.voxels);
        snow_volume_close(volume);
        model_free(&scene);
    }
    snow_context_free(context);
}

/* A volume of floating numbers from `make`, at a given size of voxels. */
static void check_floats(snow_type type, double size,
                         double make(uint64_t *seed)) {
    enum { COUNT = 70 * 6 * 5 };
    static float singles[COUNT];
    static double doubles[COUNT];
    snow_context *context = support_context();
    snow_volume_info info = {
        .size = sizeof info, .dims = {70, 6, 5}, .type = type};
    uint64_t seed = 21;
    snow_volume *volume;
    for (int i = 0; i < 4; i++)
        info.matrix[i][i] = i == 3 ? 1 : size;
    for (int n = 0; n < COUNT; n++) {
        doubles[n] = make(&seed);
        singles[n] = (float)doubles[n];
    }
    const void *voxels = doubles;
    if (type == SNOW_TYPE_FLOAT32)
        voxels = singles;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    gradient_tally tally = check_volume(volume);
    assert_true(tally.without < tally.voxels);
    snow_volume_close(volume);
    snow_context_free(context);
}

static double with_holes(uint64_t *seed) {
    double x = support_uniform(seed);
    double numbers[] = {NAN, INFINITY, -INFINITY};
    return x < 0.2 ? numbers[(int)(x * 15)] : x;
}

static double tiny(uint64_t *seed) {
    return support_uniform(seed) * 1e-37;
}

static double subnormal(uint64_t *seed) {
    return ldexp(floor(20 * support_uniform(seed)), -1074);
}

static double single_subnormal(uint64_t *seed) {
    return ldexp(floor(20 * support_uniform(seed)), -149);
}

static double huge(uint64_t *seed) {
    return (support_uniform(seed) - 0.5) * 6e38;
}

static double huger(uint64_t *seed) {
    return (support_uniform(seed) - 0.5) * 1.5e308 * 2;
}

static double mixed(uint64_t *seed) {
    int exponent = (int)(600 * support_uniform(seed)) - 300;
    return ldexp(support_uniform(seed), exponent);
}

static double plateaus(uint64_t *seed) {
    return floor(1.3 * support_uniform(seed));
}

static void numbers_of_any_size_and_none_make_normals(void **state) {
    (void)state;
    for (int size = -1; size <= 1; size++) {
        double voxel = pow(10, 15 * size);
        check_floats(SNOW_TYPE_FLOAT32, voxel, with_holes);
        check_floats(SNOW_TYPE_FLOAT32, voxel, tiny);
        check_floats(SNOW_TYPE_FLOAT32, voxel, single_subnormal);
        check_floats(SNOW_TYPE_FLOAT32, voxel, huge);
        check_floats(SNOW_TYPE_FLOAT32, voxel, plateaus);
        check_floats(SNOW_TYPE_FLOAT64, voxel, with_holes);
        check_floats(SNOW_TYPE_FLOAT64, voxel, tiny);
        check_floats(SNOW_TYPE_FLOAT64, voxel, subnormal);
        check_floats(SNOW_TYPE_FLOAT64, voxel, huger);
        check_floats(SNOW_TYPE_FLOAT64, voxel, mixed);
        check_floats(SNOW_TYPE_FLOAT64, voxel, plateaus);
    }
}

static void flat_and_skewed_voxels_are_carried(void **state) {
    (void)state;
    snow_context *context = support_context();
    const int64_t dims[3] = {80, 5, 4};
    const double skews[] = {0, 0.9, 0.999999};
    for (int n = 0; n < 3; n++)
        for (int flat = 0; flat < 2; flat++) {
            reference_scene scene =
                model_scene(dims, SNOW_TYPE_INT16, true, MODEL_PLAIN, 8);
            scene.info.matrix[0][1] = skews[n];
            scene.info.matrix[1][1] = sqrt(1 - skews[n] * skews[n]);
            scene.info.matrix[2][2] = flat ? 1e-5 : 1;
            snow_volume *volume;
            assert_int_equal(
                snow_volume_wrap(context, &scene.info, scene.voxels, &volume),
                SNOW_STATUS_OK);
            check_volume(volume);
            snow_volume_close(volume);
            model_free(&scene);
        }
    snow_context_free(context);
}

/* --- the shading table ---------------------------------------------------- */

/* Factor and white that classify/shading/shade.c gives a direction: two greys
 * are shaded by it in the middle of 3 x 3 x 3 voxels with that gradient. */
static void shade_of(snow_context *context, const snow_settings *settings,
                     const snow_placement *placement, const double n[3],
                     double *factor, double *white) {
    double voxels[27] = {0};
    const int strides[3] = {1, 3, 9};
    for (int i = 0; i < 3; i++) {
        voxels[13 - strides[i]] = -n[i];
        voxels[13 + strides[i]] = n[i];
    }
    snow_volume_info info = {
        .size = sizeof info, .dims = {3, 3, 3}, .type = SNOW_TYPE_FLOAT64};
    snow_volume *volume;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    snow_shader shader;
    assert_int_equal(
        snow_shader_init(context, volume, placement, settings, &shader),
        SNOW_STATUS_OK);
    uint32_t column = 1;
    float samples[4] = {0, 1, 0.25F, 1};
    for (int grey = 0; grey < 2; grey++) {
        size_t end = 1;
        snow_row_block strip = {.slice = 1,
                                .first_row = 1,
                                .rows = 1,
                                .count = 1,
                                .row_end = &end,
                                .columns = &column,
                                .samples = samples + 2 * grey};
        snow_shade_row_block(&shader, 2, &strip);
    }
    *white = (double)samples[0];
    *factor = ((double)samples[2] - *white) / 0.25;
    snow_volume_close(volume);
}

static snow_placement placement_of(double azimuth, double elevation,
                                   double roll) {
    snow_placement p = {.slice_axis = 2,
                        .u_axis = 0,
                        .v_axis = 1,
                        .columns = 3,
                        .rows = 3,
                        .slices = 3,
                        .right = {1, 0, 0},
                        .up = {0, 1, 0},
                        .back = {0, 0, 1}};
    snow_frame_turn(p.right, p.up, p.back, azimuth, elevation, roll);
    return p;
}

static void check_gloss(snow_context *context, const snow_settings *settings,
                        const snow_placement *p, int threads) {
    snow_gloss *table = malloc(SNOW_NORMALS * sizeof *table);
    uint64_t seed = 77;
    const double one = (double)SNOW_GLOSS_ONE, half = 0.5000001 / one;
    snow_gloss_table(context, settings, p, threads, table);
    for (int code = 0; code < SNOW_NORMALS; code++)
        if (code == SNOW_NO_NORMAL || code > 255 * 255) {
            assert_near((table[code] & 0xFFFF) / one, settings->ambient, half);
            assert_true(table[code] >> 16 == 0);
        }
    /* Directions that stand in the table: no error of the codes. */
    for (int n = 0; n < 3000; n++) {
        uint16_t code = (uint16_t)(1 + 255 * 255 * support_uniform(&seed));
        double normal[3], factor, white;
        snow_normal_of(code, normal);
        if (fabs(snow_dot(normal, p->back)) < 1e-6)
            continue; /* either side may be the viewer's */
        shade_of(context, settings, p, normal, &factor, &white);
        assert_near((table[code] & 0xFFFF) / one, factor, half + 2e-6);
        assert_near((table[code] >> 16) / one, white,
                    half + 1e-6 + 1e-7 * settings->shininess);
    }
    free(table);
}

static void the_table_shades_as_the_shader_does(void **state) {
    (void)state;
    snow_context *context = support_context();
    const double shininess[] = {20, 0, 1, 7, 2.5, 0.3, 1024, 3000, 33.3};
    const double lights[][2] = {{0, 0},   {40, 25}, {-100, 10},
                                {179, 3}, {180, 0}, {90, 0}};
    for (int n = 0; n < 54; n++) {
        snow_settings settings;
        snow_settings_init(&settings);
        settings.shininess = shininess[n % 9];
        settings.light_azimuth = lights[n / 9][0];
        settings.light_elevation = lights[n / 9][1];
        settings.ambient = 0.1;
        settings.diffuse = n % 4 ? 0.6 : 1;
        settings.specular = n % 5 ? 0.3 : 0;
        snow_placement p = placement_of(17 * n, 31 * n, 5 * n);
        check_gloss(context, &settings, &p, n % 3 + 1);
    }
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_normal_is_off_by_more_than_stated),
        cmocka_unit_test(each_code_is_that_of_its_normal),
        cmocka_unit_test(opposite_normals_and_lengths_share_a_normal),
        cmocka_unit_test(gradients_of_every_type_and_matrix),
        cmocka_unit_test(volumes_of_one_voxel_or_line_have_borders_only),
        cmocka_unit_test(numbers_of_any_size_and_none_make_normals),
        cmocka_unit_test(flat_and_skewed_voxels_are_carried),
        cmocka_unit_test(the_table_shades_as_the_shader_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
