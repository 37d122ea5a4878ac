/* tests/shear_warp/test_same_bits.c - what must not change a bit of a picture
 * by method shear-warp: threads, encodings and instruction sets, in scenes of
 * each kind with noise, whose pictures show every voxel. */
#include "shear_warp/scenes.h"

#include "simd/isa.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The image on the lattice has the same bits; its warp in plain C rounds
 * products and sums apart.  Less than a unit of its 15 bits. */
#define WARP_BOUND 2e-6

/* --- kinds of scenes ------------------------------------------------------ */

static warp_scene smoothed(int n) {
    warp_scene scene = noisy_scene(n);
    scene.base.settings.kernel = SNOW_KERNEL_BSPLINE;
    scene.base.settings.footprint = 4;
    scene.base.view.fov = n / 8 % 2 ? 45 : 0;
    return scene;
}

/* Quantized values of scenes of floats. */
static int of_floats(int n) {
    return (n - n % 5 + 2) % NOISY_SCENES;
}

static warp_scene punched(int n) {
    warp_scene scene = noisy_scene(of_floats(n));
    noisy_scene_punch(&scene.base, n);
    return scene;
}

static warp_scene punched_and_cut(int n) {
    warp_scene scene = punched(n);
    warp_scene_cut(&scene, 1);
    return scene;
}

static warp_scene punched_from_an_eye(int n) {
    warp_scene scene = noisy_scene_from_an_eye(of_floats(n));
    noisy_scene_punch(&scene.base, n);
    return scene;
}

static warp_scene cut(int n) {
    warp_scene scene = noisy_scene(n);
    warp_scene_cut(&scene, n % 2 ? 2 : 1);
    return scene;
}

static warp_scene cut_from_an_eye(int n) {
    warp_scene scene = noisy_scene_from_an_eye(n);
    warp_scene_cut(&scene, n % 2 ? 1 : 2);
    return scene;
}

static warp_scene logarithmic(int n) {
    static const snow_opacity_point decades[] = {
        {1, 0}, {4, 0.02}, {20, 0.3}, {20, 0.1}, {90, 0.8}};
    warp_scene scene = noisy_scene(n);
    scene.base.log = true;
    scene.base.opacities = decades;
    scene.base.opacity_count = COUNT(decades);
    return scene;
}

static warp_scene faded(int n) {
    static const snow_opacity_point curve[] = {{0, 0}, {1, 0.05}, {15, 0.9}};
    warp_scene scene = n % 2 ? noisy_scene(n) : cut(n);
    scene.base.gradients = curve;
    scene.base.gradient_count = COUNT(curve);
    return scene;
}

static warp_scene faint(int n) {
    static const snow_opacity_point fog[] = {{0, 0}, {100, 0.002}};
    static const snow_opacity_point thin[] = {{0, 3e-7}, {50, 1e-6}, {90, 0}};
    warp_scene scene = n % 2 ? noisy_scene_from_an_eye(n) : cut(n);
    scene.base.settings.threshold = 0;
    scene.base.opacities = n % 3 ? fog : thin;
    scene.base.opacity_count = n % 3 ? COUNT(fog) : COUNT(thin);
    return scene;
}

static const snow_color_point names[] = {{0.5, 0, 0, 0},     {0.5, 1, 0.2, 0.1},
                                         {1.5, 1, 0.2, 0.1}, {1.5, 0.1, 0.9, 0},
                                         {2.5, 0.1, 0.9, 0}, {2.5, 0.2, 0.3, 1},
                                         {4, 0.2, 0.3, 1},   {4, 1, 1, 0.5}};

static warp_scene labelled(int n) {
    static const snow_opacity_point clear[] = {{0.5, 0}, {0.5, 0.1}, {1.5, 0.1},
                                               {1.5, 0}, {2.5, 0},   {2.5, 1}};
    static const snow_opacity_point curve[] = {{0, 0.2}, {0.2, 1}};
    warp_scene scene = noisy_scene(n % 5 == 2 ? n + 1 : n); /* no floats */
    noisy_scene_name(&scene.base);
    scene.base.colors = names;
    scene.base.color_count = COUNT(names);
    scene.base.opacities = clear;
    scene.base.opacity_count = COUNT(clear);
    scene.base.view.fov = n / 8 % 2 ? 45 : 0;
    scene.base.gradients = curve;
    scene.base.gradient_count = n % 7 == 3 ? COUNT(curve) : 0;
    return scene;
}

static warp_scene projected(int n) {
    static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                      SNOW_MODE_MEAN, SNOW_MODE_SUM};
    static const double fovs[] = {0, 45, 0, 20, 0, 70};
    warp_scene scene = n % 11 == 4 ? smoothed(n)
                       : n % 3     ? noisy_scene(n)
                                   : punched(n);
    scene.base.settings.mode = modes[(size_t)(n + n / 7) % COUNT(modes)];
    scene.base.view.fov = fovs[(size_t)n / 3 % COUNT(fovs)];
    return scene;
}

static warp_scene surface(int n) {
    warp_scene scene = projected(n);
    scene.base.settings.mode = SNOW_MODE_ISO;
    scene.base.settings.iso = 30 + n * 17 % 50;
    return scene;
}

/* --- several volumes ------------------------------------------------------ */

/* Labels, values, or fog in front of a scene. */
static warp_scene front_of(int n, const warp_scene *behind) {
    static const snow_opacity_point few[] = {
        {0, 0}, {60, 0}, {75, 0.4}, {100, 0.8}};
    static const snow_opacity_point fog[] = {{0, 0.0002}, {100, 0.0015}};
    static const snow_color_point hot[] = {{0, 0.4, 0, 0}, {100, 1, 0.9, 0.2}};
    const bool labels = n % 5 != 2 && n % 2;
    warp_scene scene = labels ? labelled(n) : noisy_scene(n);
    scene.base.gradient_count = 0;
    scene.base.view = behind->base.view;
    if (labels)
        return scene;
    scene.base.colors = hot;
    scene.base.color_count = COUNT(hot);
    scene.base.opacities = n % 6 == 4 ? fog : few;
    scene.base.opacity_count = n % 6 == 4 ? COUNT(fog) : COUNT(few);
    return scene;
}

static warp_scene beside(int n, bool mixes) {
    warp_scene scene = noisy_scene(n), *front = calloc(1, sizeof *front);
    assert_non_null(front);
    scene.base.view.fov = n / 8 % 2 ? 40 : 0;
    *front = front_of(n, &scene);
    scene.front = front;
    scene.mixes = mixes;
    return scene;
}

static warp_scene layered(int n) {
    return beside(n, false);
}

static warp_scene mixed(int n) {
    return beside(n, true);
}

static void free_scene(warp_scene *scene) {
    warp_scene *front = (warp_scene *)(uintptr_t)scene->front;
    if (front)
        warp_scene_free(front);
    free(front);
    warp_scene_free(scene);
}

/* --- bits ----------------------------------------------------------------- */

/* The second picture is freed. */
static void same_bits(const char *what, int n, const warp_scene *scene,
                      const float *first, float *other) {
    const snow_view *view = &scene->base.view;
    if (memcmp(first, other,
               4 * (size_t)(view->width * view->height) * sizeof *first) != 0)
        fail_msg("%s, scene %d: other bits", what, n);
    free(other);
}

/* By a frame of its own, since one keeps the table of colours that another
 * level has made. */
static float *render_anew(const model_stage *stage, const warp_scene *scene) {
    model_stage own = *stage;
    assert_int_equal(snow_frame_new(stage->context, &own.frame),
                     SNOW_STATUS_OK);
    float *picture = warp_scene_render(&own, scene);
    snow_frame_free(own.frame);
    return picture;
}

static void check_levels(const model_stage *stage, const char *what, int n,
                         warp_scene scene) {
    size_t count = 4 * (size_t)(scene.base.view.width * scene.base.view.height);
    scene.base.settings.isa = SNOW_ISA_SCALAR;
    float *plain = render_anew(stage, &scene), *first = NULL;
    for (snow_isa isa = SNOW_ISA_AVX2; isa <= SNOW_ISA_AVX512; isa++) {
        if (!snow_isa_runs(isa))
            continue;
        scene.base.settings.isa = isa;
        float *other = render_anew(stage, &scene);
        for (size_t i = 0; i < count; i++)
            if (!(fabs((double)other[i] - (double)plain[i]) <=
                  WARP_BOUND * fmax(1, fabs((double)plain[i]))))
                fail_msg("%s, scene %d: other bits of %s", what, n,
                         snow_isa_name(isa));
        if (first)
            same_bits(what, n, &scene, first, other);
        else
            first = other;
    }
    free(plain);
    free(first);
}

static void check(const model_stage *stage, const char *what, int n,
                  const warp_scene *scene) {
    warp_scene other = *scene;
    snow_settings *settings = &other.base.settings;
    settings->threads = 1;
    settings->encoding = SNOW_ENCODING_BITMAP;
    float *first = warp_scene_render(stage, &other);
    settings->threads = 5;
    same_bits(what, n, &other, first, warp_scene_render(stage, &other));
    settings->encoding = SNOW_ENCODING_CRS;
    same_bits(what, n, &other, first, warp_scene_render(stage, &other));
    settings->encoding = SNOW_ENCODING_RLE;
    same_bits(what, n, &other, first, warp_scene_render(stage, &other));
    free(first);
    check_levels(stage, what, n, other);
}

/* A few scenes of each kind, and in the short tier one; another one by each
 * seed. */
static void nothing_changes_a_bit(void **state) {
    static const struct {
        const char *name;
        warp_scene (*make)(int n);
        int count;
    } kinds[] = {
        {"plain", noisy_scene, 20},
        {"perspective", noisy_scene_from_an_eye, 16},
        {"B-spline", smoothed, 8},
        {"holes", punched, 8},
        {"holes and a plane", punched_and_cut, 8},
        {"holes from an eye", punched_from_an_eye, 8},
        {"planes", cut, 8},
        {"planes from an eye", cut_from_an_eye, 8},
        {"logarithm", logarithmic, 8},
        {"gradient opacity", faded, 8},
        {"faint", faint, 8},
        {"labels", labelled, 12},
        {"projections", projected, 24},
        {"surfaces", surface, 12},
        {"layers", layered, 10},
        {"channels", mixed, 10},
    };
    model_stage *stage = *state;
    for (size_t k = 0; k < COUNT(kinds); k++) {
        const int count = (int)support_sweep(kinds[k].count, 1);
        for (int i = 0; i < count; i++) {
            int n = (int)((support_seed() * 7 + k * 11 + (uint64_t)i * 37) %
                          NOISY_SCENES);
            warp_scene scene = kinds[k].make(n);
            check(stage, kinds[k].name, n, &scene);
            free_scene(&scene);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(nothing_changes_a_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
