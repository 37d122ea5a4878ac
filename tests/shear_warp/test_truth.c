/* tests/shear_warp/test_truth.c - how near method shear-warp is to the truth,
 * method raycast, which tests/render/test_raycast.c holds against a ray caster
 * in double.
 *
 * Smooth fields are drawn in scenes of each kind.  There are twenty scenes of a
 * kind, of which SNOW_SEED chooses one, so that any seed meets pictures that
 * were measured.  A bound is the worst of the twenty with 1 dB to spare; this
 * prints the worst of each kind:
 *
 *   for n in $(seq 20); do SNOW_TIER=long SNOW_SEED=$n test_truth; done
 *
 * Fields with edges are test_truth_edges.c's. */
#include "shear_warp/smooth.h"
#include "shear_warp/truth.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define SCENES 20

/* --- what kinds change ---------------------------------------------------- */

typedef void change_fn(warp_scene *scene, uint64_t *random);

static void look_along(warp_scene *scene, int axis, double way) {
    double back[3] = {0}, up[3] = {0};
    back[axis] = way;
    up[axis == 2 ? 1 : 2] = 1;
    model_look(&scene->base, back, up);
}

static void from_x(warp_scene *scene, uint64_t *random) {
    look_along(scene, 0, support_random(random) % 2 ? 1 : -1);
}

static void from_y(warp_scene *scene, uint64_t *random) {
    look_along(scene, 1, support_random(random) % 2 ? 1 : -1);
}

static void from_behind(warp_scene *scene, uint64_t *random) {
    (void)random;
    look_along(scene, 2, -1);
}

static void from_an_eye(warp_scene *scene, uint64_t *random) {
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.view.fov = 15 + 45 * support_uniform(random);
}

static void from_a_near_eye(warp_scene *scene, uint64_t *random) {
    (void)random;
    scene->base.view.fov = 75;
    scene->base.settings.light = SNOW_LIGHT_HEAD;
}

static void thicken(warp_scene *scene, uint64_t *random) {
    const int axis = (int)(support_random(random) % 3);
    for (int r = 0; r < 3; r++)
        scene->base.info.matrix[r][axis] *= 3;
    scene->base.info.spacing[axis] *= 3;
    look_along(scene, (int)(support_random(random) % 3), 1);
}

static void smoothen(warp_scene *scene, uint64_t *random) {
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.settings.kernel = SNOW_KERNEL_BSPLINE;
    scene->base.settings.footprint = 4;
}

/* Three decades, of which the field is smooth. */
static void take_logarithms(warp_scene *scene, uint64_t *random) {
    static const snow_opacity_point decades[] = {
        {1.5, 0}, {30, 0.03}, {200, 0.15}, {1000, 0.4}};
    static const snow_color_point colors[] = {
        {1, 0.9, 0.2, 0.1}, {50, 0.3, 0.8, 0.3}, {1000, 0.4, 0.5, 1}};
    const int64_t *n = scene->base.info.dims;
    float *voxels = model_voxels(&scene->base);
    (void)random;
    for (int64_t at = 0; at < n[0] * n[1] * n[2]; at++)
        voxels[at] = powf(10, 0.03F * voxels[at]);
    scene->base.log = true;
    scene->base.colors = colors;
    scene->base.color_count = COUNT(colors);
    scene->base.opacities = decades;
    scene->base.opacity_count = COUNT(decades);
}

static void take_signed_logarithms(warp_scene *scene, uint64_t *random) {
    const int64_t *n = scene->base.info.dims;
    float *voxels = model_voxels(&scene->base);
    (void)random;
    for (int64_t at = 0; at < n[0] * n[1] * n[2]; at++)
        voxels[at] = copysignf(expm1f(fabsf(voxels[at]) / 30), voxels[at]) * 3;
    scene->symlog = 3;
}

static void cut_once(warp_scene *scene, uint64_t *random) {
    (void)random;
    warp_scene_cut(scene, 1);
}

static void cut_twice_from_an_eye(warp_scene *scene, uint64_t *random) {
    from_an_eye(scene, random);
    warp_scene_cut(scene, 2);
}

static void project(warp_scene *scene, snow_mode mode, uint64_t *random) {
    static const snow_color_point grey[] = {{0, 0, 0, 0}, {100, 1, 1, 1}};
    scene->base.settings.mode = mode;
    scene->base.colors = grey;
    scene->base.color_count = COUNT(grey);
    scene->base.view.fov = support_random(random) % 2 ? 30 : 0;
}

static void take_largest(warp_scene *scene, uint64_t *random) {
    project(scene, SNOW_MODE_MIP, random);
}

static void take_smallest(warp_scene *scene, uint64_t *random) {
    project(scene, SNOW_MODE_MINIP, random);
}

static void take_mean(warp_scene *scene, uint64_t *random) {
    project(scene, SNOW_MODE_MEAN, random);
}

static void take_sum(warp_scene *scene, uint64_t *random) {
    project(scene, SNOW_MODE_SUM, random);
}

static void take_surface(warp_scene *scene, uint64_t *random) {
    scene->base.settings.mode = SNOW_MODE_ISO;
    scene->base.settings.iso = 45 + 10 * support_uniform(random);
    scene->base.view.fov = support_random(random) % 2 ? 30 : 0;
}

static void fade(warp_scene *scene, uint64_t *random) {
    static const snow_opacity_point curve[] = {{0, 0.1}, {12, 1}, {40, 0.5}};
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.gradients = curve;
    scene->base.gradient_count = COUNT(curve);
}

static void darken(warp_scene *scene, uint64_t *random) {
    scene->base.settings.shade = SNOW_SHADE_NONE;
    look_along(scene, (int)(support_random(random) % 3), 1);
}

static void light_from_the_side(warp_scene *scene, uint64_t *random) {
    bool key = support_random(random) % 2;
    scene->base.settings.light = key ? SNOW_LIGHT_KEY : SNOW_LIGHT_DIRECTION;
    scene->base.settings.light_azimuth = key ? 0 : 40;
    scene->base.settings.light_elevation = key ? 0 : -20;
}

static void thin_out(warp_scene *scene, uint64_t *random) {
    static const snow_opacity_point fog[] = {{5, 0}, {100, 0.003}};
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.opacities = fog;
    scene->base.opacity_count = COUNT(fog);
    scene->base.settings.shade = SNOW_SHADE_NONE;
}

/* Bands with nothing between them. */
static void show_bands(warp_scene *scene, uint64_t *random) {
    static const snow_opacity_point bands[] = {{15, 0}, {30, 0.3}, {45, 0},
                                               {60, 0}, {80, 0.6}, {99, 0}};
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.opacities = bands;
    scene->base.opacity_count = COUNT(bands);
}

static void grow_opaque(warp_scene *scene, uint64_t *random) {
    static const snow_opacity_point opaque[] = {{20, 0}, {100, 1}};
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.opacities = opaque;
    scene->base.opacity_count = COUNT(opaque);
}

static void come_near(warp_scene *scene, uint64_t *random) {
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.view.zoom = 4;
}

static void go_far(warp_scene *scene, uint64_t *random) {
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.view.zoom = 0.9;
    scene->base.view.width = scene->base.view.height = 28;
}

static void draw_normally(warp_scene *scene, uint64_t *random) {
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.settings.quality = SNOW_QUALITY_NORMAL;
}

static void draft(warp_scene *scene, uint64_t *random) {
    look_along(scene, (int)(support_random(random) % 3), 1);
    scene->base.settings.quality = SNOW_QUALITY_DRAFT;
}

/* --- kinds ---------------------------------------------------------------- */

typedef enum companion { ALONE, LAYER, CHANNEL } companion;

static const struct kind {
    const char *name;
    smooth_field field;
    snow_type type;
    model_matrix matrix;
    change_fn *change;
    companion companion;
    double decibels, worst; /* at least, at most */
} kinds[] = {
#define BUMPS(type, matrix) SMOOTH_BUMPS, SNOW_TYPE_##type, MODEL_##matrix
#define WAVES(type, matrix) SMOOTH_WAVES, SNOW_TYPE_##type, MODEL_##matrix
    {"bytes", BUMPS(UINT8, PLAIN), NULL, ALONE, 59.7, 0.0187},
    {"signed bytes", BUMPS(INT8, PLAIN), from_x, ALONE, 62.4, 0.0215},
    {"words", BUMPS(UINT16, PLAIN), from_y, ALONE, 58.0, 0.0260},
    {"signed words", BUMPS(INT16, PLAIN), NULL, ALONE, 62.4, 0.0231},
    {"long words", BUMPS(INT64, PLAIN), from_y, ALONE, 60.4, 0.0155},
    {"doubles", BUMPS(FLOAT64, PLAIN), from_x, ALONE, 62.3, 0.0136},
    {"along x", BUMPS(FLOAT32, PLAIN), from_x, ALONE, 59.4, 0.0285},
    {"along y", BUMPS(FLOAT32, PLAIN), from_y, ALONE, 60.0, 0.0268},
    {"along z", BUMPS(FLOAT32, PLAIN), NULL, ALONE, 61.7, 0.0112},
    {"from behind", BUMPS(UINT8, PLAIN), from_behind, ALONE, 62.8, 0.0183},
    {"anisotropic", BUMPS(FLOAT32, ANISOTROPIC), from_y, ALONE, 59.0, 0.0216},
    {"oblique", BUMPS(FLOAT32, OBLIQUE), NULL, ALONE, 58.5, 0.0235},
    {"sheared", SMOOTH_BUMPS, SNOW_TYPE_FLOAT32, MODEL_SHEARED, from_x, ALONE,
     66.8, 0.0071},
    {"mirrored", BUMPS(UINT16, MIRRORED), NULL, ALONE, 65.2, 0.0110},
    {"thick", BUMPS(FLOAT32, PLAIN), thicken, ALONE, 57.5, 0.0326},
    {"perspective", BUMPS(FLOAT32, PLAIN), from_an_eye, ALONE, 60.9, 0.0144},
    {"perspective, anisotropic", BUMPS(UINT16, ANISOTROPIC), from_an_eye, ALONE,
     56.6, 0.0274},
    {"wide perspective", BUMPS(UINT16, PLAIN), from_a_near_eye, ALONE, 59.0,
     0.0272},
    {"B-spline", BUMPS(FLOAT32, PLAIN), smoothen, ALONE, 55.3, 0.0171},
    {"logarithm", BUMPS(FLOAT32, PLAIN), take_logarithms, ALONE, 60.5, 0.0200},
    {"symmetric logarithm", SMOOTH_SIGNS, SNOW_TYPE_FLOAT32, MODEL_PLAIN,
     take_signed_logarithms, ALONE, 57.1, 0.0174},
    {"clip plane", BUMPS(UINT8, PLAIN), cut_once, ALONE, 61.0, 0.0177},
    {"clip planes, perspective", BUMPS(FLOAT32, PLAIN), cut_twice_from_an_eye,
     ALONE, 56.5, 0.0316},
    {"layer", BUMPS(FLOAT32, PLAIN), from_x, LAYER, 59.1, 0.0223},
    {"layer, perspective", BUMPS(UINT8, PLAIN), from_an_eye, LAYER, 59.6,
     0.0160},
    {"channels", BUMPS(UINT16, PLAIN), from_y, CHANNEL, 56.6, 0.0259},
    {"mip", WAVES(FLOAT32, PLAIN), take_largest, ALONE, 78.2, 0.0025},
    {"minip", WAVES(UINT16, PLAIN), take_smallest, ALONE, 65.2, 0.0117},
    {"mean", WAVES(FLOAT32, PLAIN), take_mean, ALONE, 72.0, 0.0059},
    {"sum", WAVES(UINT8, PLAIN), take_sum, ALONE, 73.4, 0.0075},
    {"isosurface", SMOOTH_HILLS, SNOW_TYPE_FLOAT32, MODEL_PLAIN, take_surface,
     ALONE, 60.8, 0.0057},
    {"gradient opacity", BUMPS(FLOAT32, PLAIN), fade, ALONE, 63.7, 0.0066},
    {"no light", BUMPS(FLOAT32, ANISOTROPIC), darken, ALONE, 62.6, 0.0044},
    {"light from the side", SMOOTH_HILLS, SNOW_TYPE_FLOAT32, MODEL_PLAIN,
     light_from_the_side, ALONE, 67.8, 0.0045},
    {"fog", BUMPS(FLOAT32, PLAIN), thin_out, ALONE, 70.9, 0.0027},
    {"bands", BUMPS(FLOAT32, PLAIN), show_bands, ALONE, 58.4, 0.0292},
    {"bands of bytes", BUMPS(UINT8, PLAIN), show_bands, ALONE, 59.4, 0.0336},
    {"opaque", BUMPS(FLOAT32, PLAIN), grow_opaque, ALONE, 59.9, 0.0155},
    {"near", BUMPS(FLOAT32, PLAIN), come_near, ALONE, 56.5, 0.0329},
    {"far", BUMPS(FLOAT32, PLAIN), go_far, ALONE, 60.5, 0.0087},
    {"normal quality", BUMPS(FLOAT32, PLAIN), draw_normally, ALONE, 48.9,
     0.0863},
    {"draft quality", BUMPS(FLOAT32, PLAIN), draft, ALONE, 43.9, 0.1360},
#undef BUMPS
#undef WAVES
};

static closeness measure_kind(const model_stage *stage, const struct kind *kind,
                              uint64_t seed) {
    uint64_t random = 1 + 2 * seed + 101 * (uint64_t)(kind - kinds);
    for (int n = 0; n < 8; n++)
        support_random(&random);
    warp_scene scene =
        smooth_scene(kind->field, kind->type, kind->matrix, &random);
    if (kind->change)
        kind->change(&scene, &random);
    warp_scene front = scene;
    if (kind->companion != ALONE) {
        front = smooth_scene_beside(&scene, &random);
        scene.front = &front;
        scene.mixes = kind->companion == CHANNEL;
    }
    closeness found = closeness_of(stage, &scene);
    if (scene.front)
        warp_scene_free(&front);
    warp_scene_free(&scene);
    return found;
}

static void smooth_fields_are_near_the_truth(void **state) {
    const uint64_t seed = support_seed() % SCENES;
    model_stage *stage = *state;
    for (size_t n = seed % support_stride(5); n < COUNT(kinds);
         n += support_stride(5)) {
        closeness found = measure_kind(stage, &kinds[n], seed);
        print_message("%-24s %5.1f dB, at most %.4f off\n", kinds[n].name,
                      found.decibels, found.worst);
        assert_true(found.pixels > 50);
        if (!(found.decibels >= kinds[n].decibels &&
              found.worst <= kinds[n].worst))
            fail_msg("%s, scene %d: %.2f dB, a pixel is off by %.4f",
                     kinds[n].name, (int)seed, found.decibels, found.worst);
    }
}

static void each_quality_is_nearer_than_the_one_below(void **state) {
    uint64_t random = 7 + 2 * (support_seed() % SCENES);
    double before = 0;
    model_stage *stage = *state;
    for (int n = 0; n < 8; n++)
        support_random(&random);
    warp_scene scene =
        smooth_scene(SMOOTH_BUMPS, SNOW_TYPE_FLOAT32, MODEL_PLAIN, &random);
    static const snow_quality rising[] = {
        SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};
    for (int n = 0; n < 3; n++) {
        scene.base.settings.quality = rising[n];
        closeness found = closeness_of(stage, &scene);
        assert_true(found.decibels > before);
        before = found.decibels;
    }
    warp_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(smooth_fields_are_near_the_truth),
        MODEL_TEST(each_quality_is_nearer_than_the_one_below),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
