/* tests/shear_warp/test_laws.c - pictures by method shear-warp obey the model's
 * laws: opacity in a uniform block, linear fields, planes, a sphere, and the
 * same data stored in another order. */
#include "shear_warp/formulas.h"

#include <math.h>

static double constant(const double at[3]) {
    (void)at;
    return 7;
}

static double linear(const double at[3]) {
    return 11 + 0.5 * at[0] - 0.8 * at[1] + 1.1 * at[2]; /* 3 to 22.7 */
}

static double ripples(const double at[3]) {
    double x = at[0] - 8.2, y = at[1] - 9.1, z = at[2] - 7.4;
    return 100 / (1 + exp(sqrt(x * x + 1.2 * y * y + 0.9 * z * z) - 5.5)) +
           6 * sin(0.5 * x + 0.3 * y) + 5 * cos(0.4 * z - 0.2 * y);
}

static double ball(const double at[3]) {
    double x = at[0] - 11.6, y = at[1] - 11.3, z = at[2] - 11.8;
    return 128 + 32 * (8 - sqrt(x * x + y * y + z * z));
}

/* --- along rays ----------------------------------------------------------- */

/* What a ray through the field has: its way in the world, and the values where
 * it enters and leaves. */
typedef struct passage {
    double length, ends[2];
} passage;

static passage pass(const reference_scene *s, double x, double y) {
    reference_camera camera;
    reference_camera_of(s, &camera);
    reference_ray ray = reference_ray_at(s, &camera, x, y);
    double t[2] = {-INFINITY, INFINITY};
    for (int c = 0; c < 3; c++) {
        bool single = s->info.dims[c] == 1;
        double low = single ? -0.5 : 0;
        double high = single ? 0.5 : (double)s->info.dims[c] - 1;
        double a = (low - ray.start[c]) / ray.step[c];
        double b = (high - ray.start[c]) / ray.step[c];
        bool aside = fabs(ray.step[c]) < 1e-12;
        bool within = ray.start[c] >= low && ray.start[c] <= high;
        t[0] = aside ? (within ? t[0] : INFINITY) : fmax(t[0], fmin(a, b));
        t[1] = aside ? t[1] : fmin(t[1], fmax(a, b));
    }
    passage out = {0};
    if (!(t[0] < t[1]))
        return out;
    out.length = t[1] - t[0];
    for (int n = 0; n < 2; n++) {
        double at[3];
        for (int c = 0; c < 3; c++)
            at[c] = ray.start[c] + t[n] * ray.step[c];
        out.ends[n] = linear(at);
    }
    return out;
}

/* What is expected of a ray. */
typedef double law_fn(const reference_scene *s, const passage *p);

/* What a law says about a pixel, and by how much it bends within three
 * samples of the lattice.  Where the sides of a block meet it bends by more
 * than it changes: there a pixel is a mean of both, and tells nothing. */
static bool expect(const reference_scene *s, law_fn *law, double x, double y,
                   double *expected, double *bend) {
    static const double cells[] = {[SNOW_QUALITY_DRAFT] = 1,
                                   [SNOW_QUALITY_NORMAL] = 2,
                                   [SNOW_QUALITY_HIGH] = 4};
    reference_camera camera;
    double change = 0, widest = 0;
    reference_camera_of(s, &camera);
    for (int c = 0; c < 3; c++)
        widest = fmax(widest, s->info.spacing[c]);
    const double step =
        1.5 * widest / camera.pitch / cells[s->settings.quality];
    passage here = pass(s, x, y);
    *expected = law(s, &here);
    *bend = 0;
    double near[9];
    for (int n = 0; n < 9; n++) {
        double at[2];
        for (int i = 0; i < 2; i++) {
            passage p = pass(s, x + (i + 1) * step * (n % 3 - 1),
                             y + (i + 1) * step * (n / 3 - 1));
            if (!(p.length > 0.3))
                return false;
            at[i] = law(s, &p);
        }
        near[n] = at[0];
        *bend = fmax(*bend, fabs(at[1] + *expected - 2 * at[0]));
        change = fmax(change, fabs(at[1] - *expected));
    }
    for (int n = 0; n < 4; n++) /* both sides of a kink in the pixel itself */
        *bend = fmax(*bend, fabs(near[n] + near[8 - n] - 2 * *expected));
    return *bend < 0.05 * change + 1e-9;
}

/* How many pixels obey a law; the test fails where one does not. */
static int check_law(const warp_scene *scene, law_fn *law, int channel,
                     double bound) {
    warp_scene large = *scene;
    const reference_scene *s = &large.base;
    const int width = large.base.view.width = 121;
    const int height = large.base.view.height = 101;
    model_stage stage = model_open();
    float *picture = warp_scene_render(&stage, &large);
    int seen = 0;
    for (int n = 0; n < width * height; n++) {
        double expected, bend, found = (double)picture[4 * n + channel];
        if (!expect(s, law, n % width + 0.5, n / width + 0.5, &expected, &bend))
            continue;
        seen++;
        if (!(fabs(found - expected) < bound + bend))
            fail_msg("pixel %d, %d: %g, not %g: %s", n % width, n / width,
                     found, expected, model_words(s));
    }
    free(picture);
    model_close(&stage);
    return seen;
}

#define BLOCK_OPACITY 0.07

static double opacity_of_chord(const reference_scene *s, const passage *p) {
    return 1 - pow(1 - BLOCK_OPACITY, p->length / reference_opacity_length(s));
}

static void a_uniform_block_has_the_opacity_of_its_chord(void **state) {
    (void)state;
    const int64_t sizes[][3] = {{19, 21, 18}, {1, 19, 17}, {22, 2, 1}};
    int seen = 0, scenes = 0;
    for (int n = 0; n < FORMULA_POSES; n += (int)support_stride(13), scenes++) {
        warp_scene scene =
            formula_scene(sizes[n % 7 / 3], constant, BLOCK_OPACITY);
        formula_scene_pose(&scene, n);
        seen += check_law(&scene, opacity_of_chord, 3, 1e-3);
        model_free(&scene.base);
    }
    print_message("             %d pixels of %d scenes\n", seen, scenes);
    assert_true(seen > 50 * scenes);
}

static double projection(const reference_scene *s, const passage *p) {
    double mean = (p->ends[0] + p->ends[1]) / 2;
    if (s->settings.mode == SNOW_MODE_MIP)
        return fmax(p->ends[0], p->ends[1]) / 24;
    if (s->settings.mode == SNOW_MODE_MINIP)
        return fmin(p->ends[0], p->ends[1]) / 24;
    return s->settings.mode == SNOW_MODE_MEAN
               ? mean
               : mean * p->length / reference_opacity_length(s);
}

static void projections_of_a_linear_field_are_exact(void **state) {
    (void)state;
    static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                      SNOW_MODE_MEAN, SNOW_MODE_SUM};
    static const snow_color_point grey[] = {{0, 0, 0, 0}, {24, 1, 1, 1}};
    int seen = 0, scenes = 0;
    for (int n = 0; n < FORMULA_POSES; n += (int)support_stride(13), scenes++) {
        warp_scene scene = formula_scene((int64_t[]){9, 11, 8}, linear, 1);
        formula_scene_pose(&scene, n);
        formula_scene_space(&scene, (double[]){1, 1, 1});
        scene.base.settings.mode = modes[n / 7 % 4];
        scene.base.colors = grey;
        scene.base.color_count = 2;
        seen += check_law(&scene, projection, 0,
                          scene.base.settings.mode == SNOW_MODE_SUM    ? 2e-2
                          : scene.base.settings.mode == SNOW_MODE_MEAN ? 3e-3
                                                                       : 3e-4);
        model_free(&scene.base);
    }
    print_message("             %d pixels of %d scenes\n", seen, scenes);
    assert_true(seen > 50 * scenes);
}

/* --- light ---------------------------------------------------------------- */

static double cosine_with(const double normal[3], const double x[3]) {
    double dot = 0, square = 0, length = 0;
    for (int i = 0; i < 3; i++) {
        dot += normal[i] * x[i];
        square += normal[i] * normal[i];
        length += x[i] * x[i];
    }
    return dot / sqrt(square * length);
}

/* What a grey plane shows; `e` is its normal's cosine with the eye. */
static double phong(const reference_camera *camera, const double normal[3],
                    double e, bool key) {
    double light[3], half[3], turn = acos(-1.0) / 180;
    double head = 0.5 * 0.7 * e + 0.2 * pow(e, 20);
    if (!key)
        return 0.5 * 0.2 + head;
    for (int i = 0; i < 3; i++) {
        light[i] = cos(35 * turn) * (cos(25 * turn) * camera->back[i] -
                                     sin(25 * turn) * camera->right[i]) +
                   sin(35 * turn) * camera->up[i];
        half[i] = light[i] + camera->back[i];
    }
    double k = fmax(0, cosine_with(normal, light));
    double h = k > 0 ? fmax(0, cosine_with(normal, half)) : 0;
    return 0.5 * 0.2 + 0.35 * head + 0.65 * (0.5 * 0.7 * k + 0.2 * pow(h, 20));
}

/* A plane of such a pose; also of other spacings, whose normal is that of the
 * world. */
static void check_plane(int n) {
    static const snow_color_point grey[] = {{0, 0.5, 0.5, 0.5}};
    warp_scene scene = formula_scene((int64_t[]){13, 14, 12}, linear, 1);
    snow_settings *settings = &scene.base.settings;
    formula_scene_pose(&scene, n);
    settings->shade = SNOW_SHADE_PHONG;
    settings->mode = n % 2 ? SNOW_MODE_ISO : SNOW_MODE_OVER;
    settings->iso = linear((double[]){6, 6.5, 5.5});
    /* A side between thick slices, and perspective beside one, are where the
     * model is weak. */
    if (n % 2 == 0 || scene.base.view.fov > 0)
        formula_scene_space(&scene, (double[]){1, 1, 1});
    settings->light = n / 2 % 2 ? SNOW_LIGHT_HEAD : SNOW_LIGHT_KEY;
    scene.base.colors = grey;
    reference_camera camera;
    reference_camera_of(&scene.base, &camera);
    double normal[3] = {0.5, -0.8, 1.1}, found[4];
    for (int c = 0; c < 3; c++)
        normal[c] /= scene.base.info.spacing[c];
    double cosine = cosine_with(normal, camera.back);
    for (int c = 0; c < 3 && cosine < 0; c++)
        normal[c] = -normal[c];
    cosine = fabs(cosine);
    double expected =
        phong(&camera, normal, cosine, settings->light == SNOW_LIGHT_KEY);
    formula_scene_middle(&scene, found);
    /* Seen from the edge the cosine bends at 0 within a lattice pixel. */
    if (cosine > 0.15 && !(fabs(found[0] - expected) < 2e-3))
        fail_msg("view %d: %g, not %g", n, found[0], expected);
    model_free(&scene.base);
}

static void a_plane_is_lit_as_phong_says(void **state) {
    (void)state;
    for (int n = 0; n < FORMULA_POSES; n += (int)support_stride(13))
        check_plane(n);
}

/* --- the same volume in another order ------------------------------------- */

/* The same world with index axes permuted and turned round: number 0 to 47. */
static warp_scene reordered(const warp_scene *from, int number) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int *order = orders[number % 6];
    const int64_t *n = from->base.info.dims;
    warp_scene to = *from;
    float *voxels = calloc((size_t)(n[0] * n[1] * n[2]), sizeof *voxels);
    assert_non_null(voxels);
    to.base.voxels = voxels;
    for (int c = 0; c < 3; c++) {
        bool turned = number / 6 >> c & 1;
        to.base.info.dims[c] = n[order[c]];
        to.base.info.spacing[c] = from->base.info.spacing[order[c]];
        for (int r = 0; r < 3; r++) {
            double step = from->base.info.matrix[r][order[c]];
            to.base.info.matrix[r][c] = turned ? -step : step;
            if (turned)
                to.base.info.matrix[r][3] += step * (double)(n[order[c]] - 1);
        }
    }
    const int64_t *m = to.base.info.dims;
    for (int64_t k = 0; k < m[2]; k++)
        for (int64_t j = 0; j < m[1]; j++)
            for (int64_t i = 0; i < m[0]; i++) {
                int64_t at[3], here[3] = {i, j, k};
                for (int c = 0; c < 3; c++)
                    at[order[c]] =
                        number / 6 >> c & 1 ? m[c] - 1 - here[c] : here[c];
                *voxels++ = model_voxels(
                    &from->base)[(at[2] * n[1] + at[1]) * n[0] + at[0]];
            }
    return to;
}

static void check_order(const model_stage *stage, int n) {
    static const snow_opacity_point hill[] = {{20, 0}, {60, 0.3}, {90, 0.8}};
    static const snow_color_point tints[] = {
        {20, 0.9, 0.2, 0.1}, {60, 0.2, 0.8, 0.4}, {90, 0.3, 0.4, 1}};
    warp_scene made = formula_scene((int64_t[]){15, 17, 14}, ripples, 0);
    warp_scene scene = made;
    scene.base.opacities = hill;
    scene.base.opacity_count = 3;
    scene.base.colors = tints;
    scene.base.color_count = 3;
    scene.base.settings.shade = SNOW_SHADE_PHONG;
    formula_scene_space(&scene, (double[]){1, 1.2, 1.4});
    formula_scene_look(&scene, n % 3, 24, 17, n / 48 % 2 ? 25 : 0);
    scene.base.settings.quality = qualities[n / 48];
    warp_scene other = reordered(&scene, n % 48);
    float *one = warp_scene_render(stage, &scene);
    float *two = warp_scene_render(stage, &other);
    const int floats = 4 * scene.base.view.width * scene.base.view.height;
    double largest = 0, sum = 0;
    for (int p = 0; p < floats; p++) {
        largest = fmax(largest, fabs((double)one[p] - (double)two[p]));
        sum += fabs((double)one[p] - (double)two[p]);
    }
    /* Weights are mirrored, so that rounding differs here and there. */
    if (largest > 6.0 / 255 || sum / floats > 3e-4)
        fail_msg("order %d: by %g, mean %g", n, largest, sum / floats);
    free(one);
    free(two);
    warp_scene_free(&other);
    model_free(&made.base);
}

static void data_turned_and_reordered_give_the_same_picture(void **state) {
    model_stage *stage = *state;
    for (int n = 1; n < 144; n += (int)support_stride(29))
        check_order(stage, n);
}

/* --- a sphere ------------------------------------------------------------- */

static void a_hard_sphere_has_its_radius(void **state) {
    static const snow_opacity_point edge[] = {{128, 0}, {128, 1}};
    model_stage *stage = *state;
    warp_scene made = formula_scene((int64_t[]){24, 24, 24}, ball, 0);
    for (int n = 0; n < QUALITIES; n++) {
        warp_scene scene = made;
        reference_camera camera;
        double area = 0;
        scene.base.opacities = edge;
        formula_scene_look(&scene, 2, 20, 25, 0);
        scene.base.settings.quality = qualities[n];
        scene.base.view.width = scene.base.view.height = 160;
        reference_camera_of(&scene.base, &camera);
        float *picture = warp_scene_render(stage, &scene);
        for (int p = 0; p < 160 * 160; p++)
            area += (double)picture[4 * p + 3];
        assert_near(sqrt(area / acos(-1.0)) * camera.pitch, 8, 0.02);
        free(picture);
    }
    model_free(&made.base);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_uniform_block_has_the_opacity_of_its_chord),
        cmocka_unit_test(projections_of_a_linear_field_are_exact),
        cmocka_unit_test(a_plane_is_lit_as_phong_says),
        MODEL_TEST(data_turned_and_reordered_give_the_same_picture),
        MODEL_TEST(a_hard_sphere_has_its_radius),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
