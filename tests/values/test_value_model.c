/* tests/values/test_value_model.c - the value model's reference obeys the
 * model's laws.
 *
 * What the fast path will be held against is held against closed forms: the law
 * of opacity in a uniform block, linear fields, planes, spheres, and the same
 * data stored in another order. */
#include "values/scenes.h"

#include <math.h>

static double constant(const double at[3]) {
    (void)at;
    return 7;
}

static double linear(const double at[3]) {
    return 3 + 0.5 * at[0] - 0.8 * at[1] + 1.1 * at[2];
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

/* Views that see every pair of axis and projection, at no special angle. */
static void pose(value_scene *scene, int number) {
    static const double angles[][2] = {
        {0, 0}, {17, 23}, {-38, 12}, {31, -35}, {-8, -41}};
    static const double spacings[][3] = {
        {1, 1, 1}, {0.7, 1.1, 1.3}, {1, 1, 2}, {2.6, 1, 0.9}};
    const double *angle = angles[number % 5];
    const double *spacing = spacings[number % 4];
    value_scene_space(scene, spacing[0], spacing[1], spacing[2]);
    value_scene_look(scene, number % 3, angle[0], angle[1],
                     number / 3 % 2 ? 25 : 0);
    scene->base.settings.quality = value_qualities[number / 6 % 3];
}

#define POSES 60

/* Lattice samples of a model, some of all. */
static size_t walk(value_model *model, size_t stride,
                   void (*visit)(value_model *, const value_ray *, int64_t,
                                 int64_t)) {
    size_t count = (size_t)(model->size[0] * model->size[1]), seen = 0;
    for (size_t n = stride / 2; n < count; n += stride, seen++) {
        int64_t a = model->first[0] + (int64_t)n % model->size[0];
        int64_t b = model->first[1] + (int64_t)n / model->size[0];
        double front[2];
        value_lattice_front(&model->plan, (double)a, (double)b, front);
        value_ray ray = value_ray_of(&model->plan, front[0], front[1]);
        visit(model, &ray, a, b);
    }
    return seen;
}

/* --- integers ------------------------------------------------------------- */

static void integers_round_halves_up_and_saturate(void **state) {
    (void)state;
    assert_int_equal(value_scale(1, 16384), 1);
    assert_int_equal(value_scale(-1, 16384), 0);
    assert_int_equal(value_scale(-3, 16384), -1);
    assert_int_equal(value_scale(100, 32768), 100);
    assert_int_equal(value_between(-16383, 32766, 16384), 16384 - 16383);
    assert_int_equal(value_weight(0.99999), 32767);
    assert_int_equal(value_weight(0.5), 16384);
}

/* --- opacity -------------------------------------------------------------- */

#define BLOCK_OPACITY 0.07

static void block_sample(value_model *model, const value_ray *ray, int64_t a,
                         int64_t b) {
    double sample[4], chord = value_scene_chord(&model->plan, ray);
    double length = reference_opacity_length(&model->plan.scene->base);
    value_model_sample(model, a, b, sample);
    double expected = 1 - pow(1 - BLOCK_OPACITY, chord / length);
    if (fabs(sample[3] - expected) > 5e-4)
        fail_msg("alpha %g, not %g, for %g", sample[3], expected, chord);
}

static void a_uniform_block_has_the_opacity_of_its_chord(void **state) {
    (void)state;
    const int64_t sizes[][3] = {{9, 11, 8}, {1, 9, 7}, {12, 2, 1}};
    for (int n = 0; n < POSES; n += (int)support_stride(13)) {
        value_scene scene =
            value_scene_of(sizes[n % 7 / 3], constant, BLOCK_OPACITY);
        pose(&scene, n);
        value_plan plan = value_scene_plan(&scene);
        value_model *model = value_model_new(&plan);
        assert_true(walk(model, 1, block_sample) > 20);
        value_model_free(model);
        value_scene_free(&scene);
    }
}

static void the_middle_of_a_block_has_it_too(void **state) {
    (void)state;
    for (int n = 0; n < POSES; n += (int)support_stride(23)) {
        /* Sizes so that no view's middle ray leaves through an edge. */
        value_scene scene =
            value_scene_of((int64_t[]){21, 22, 23}, constant, 0.04);
        pose(&scene, n);
        scene.base.view.width = scene.base.view.height = 1;
        scene.base.view.zoom = 40;
        double *picture = value_model_render(&scene), expected[4];
        value_truth *truth = value_truth_new(&scene, 1);
        value_truth_pixel(truth, 0.5, 0.5, expected);
        if (fabs(picture[3] - expected[3]) > 6e-3)
            fail_msg("view %d: %g, not %g", n, picture[3], expected[3]);
        value_truth_free(truth);
        free(picture);
        value_scene_free(&scene);
    }
}

static void an_entry_of_one_value_is_a_slab_of_it(void **state) {
    (void)state;
    value_scene made = value_scene_of((int64_t[]){4, 4, 4}, linear, 0);
    value_scene scene = made;
    scene.base.view.zoom = 0.5; /* a slab is a whole slice */
    const snow_opacity_point points[] = {{0, 0.3}, {6, 0.3}, {6, 1}};
    const snow_color_point colors[] = {{6, 1, 0, 0}, {6, 0, 1, 0}};
    scene.base.opacities = points;
    scene.base.opacity_count = 3;
    scene.base.colors = colors;
    scene.base.color_count = 2;
    value_table table;
    value_plan plan = value_scene_plan(&scene);
    value_table_make(&plan, &table);
    const value_entry *low = &table.entries[0];
    assert_int_equal(low->alpha, (int)rint(32767 * 0.3));
    assert_int_equal(low->color[0], low->alpha);
    assert_int_equal(low->color[1], 0);
    /* From the first value to the last: opaque from 6 on. */
    const value_entry *across = &table.entries[128];
    double place = (6 - plan.low) / (plan.high - plan.low);
    assert_int_equal(across->alpha, 32767);
    double front = 1 - pow(0.7, floor(16 * place + 0.5) / 16);
    assert_true(fabs(across->color[0] / 32767.0 - front) < 1e-3);
    assert_int_equal(across->color[0] + across->color[1], 32767);
    value_table_free(&table);
    value_scene_free(&made);
}

/* --- linear fields -------------------------------------------------------- */

/* Inside the box, or beyond one of its sides by up to a voxel: there the field
 * is continued linearly. */
static bool odd_once(const value_plan *plan, const double at[3]) {
    double out[2];
    for (int n = 0; n < 2; n++)
        out[n] = fmax(-at[n], at[n] - (double)plan->dims[n] + 1);
    return fmax(out[0], out[1]) <= 1 && fmin(out[0], out[1]) <= 0;
}

/* All that a slab's gradient reads is inside, or in the voxel beyond one side.
 * In perspective differences reach further than a voxel where the lattice is
 * wider. */
static bool away_from_sides(const value_plan *plan, const value_ray *ray,
                            int slab) {
    double reach = plan->perspective ? 1.6 : 0.6;
    for (int end = 0; end < 2; end++) {
        double at[3];
        value_ray_at(plan, ray, slab + end, at);
        for (int n = 0; n < 2; n++)
            if (at[n] < reach || at[n] > (double)plan->dims[n] - 1 - reach)
                return false;
    }
    return true;
}

static void linear_sample(value_model *model, const value_ray *ray, int64_t a,
                          int64_t b) {
    (void)a;
    (void)b;
    const value_plan *plan = &model->plan;
    const double rise[3] = {0.5, -0.8, 1.1};
    double unit = (plan->high - plan->low) / VALUE_MOST;
    for (int slab = 0; slab + 1 < plan->sheets; slab++) {
        double at[3], index[3], gradient[3];
        int part[2];
        if (!value_cut(plan, ray, slab, part))
            continue;
        value_ray_at(plan, ray, slab, at);
        for (int n = 0; n < 3; n++)
            index[plan->axis[n]] = at[n];
        int v = value_sheet(&model->field, slab, at[0], at[1]);
        if (odd_once(plan, at) &&
            fabs(v * unit + plan->low - linear(index)) > 2.5 * unit)
            fail_msg("value %g, not %g", v * unit + plan->low, linear(index));
        value_gradient(&model->field, ray, slab, 16384, gradient);
        for (int n = 0; n < 3 && away_from_sides(plan, ray, slab); n++)
            if (fabs(gradient[n] / 2 * unit - rise[plan->axis[n]]) > 6 * unit)
                fail_msg("slope %d is %g, not %g", n, gradient[n] / 2 * unit,
                         rise[plan->axis[n]]);
    }
}

static void a_linear_field_is_exact_with_its_gradient(void **state) {
    (void)state;
    for (int n = 0; n < POSES; n += (int)support_stride(13)) {
        value_scene scene =
            value_scene_of((int64_t[]){9, 11, 8}, linear, BLOCK_OPACITY);
        pose(&scene, n);
        value_plan plan = value_scene_plan(&scene);
        value_model *model = value_model_new(&plan);
        assert_true(walk(model, 3, linear_sample) > 20);
        value_model_free(model);
        value_scene_free(&scene);
    }
}

/* Whether a ray meets a sheet of a slab beyond two sides, where voxels are
 * reflected along one axis only. */
static bool meets_corner(const value_plan *plan, const value_ray *ray,
                         int slab) {
    bool corner = false;
    for (int end = 0; end < 2; end++) {
        double at[3];
        value_ray_at(plan, ray, slab + end, at);
        corner |= (at[0] < 0 || at[0] > (double)plan->dims[0] - 1) &&
                  (at[1] < 0 || at[1] > (double)plan->dims[1] - 1);
    }
    return corner;
}

static void projection_sample(value_model *model, const value_ray *ray,
                              int64_t a, int64_t b) {
    const value_plan *plan = &model->plan;
    double chord = value_scene_chord(plan, ray), sample[4], ends[2], at[3];
    value_model_sample(model, a, b, sample);
    if (chord < 0.1) /* a corner: too short a way to ask for much */
        return;
    /* Where the ray enters and leaves, by the slabs' kept parts. */
    bool any = false;
    for (int slab = 0; slab + 1 < plan->sheets; slab++) {
        int part[2];
        if (!value_cut(plan, ray, slab, part))
            continue;
        if (meets_corner(plan, ray, slab))
            return;
        for (int end = any; end < 2; end++) {
            double index[3];
            value_ray_at(plan, ray, slab + part[end] / 32768.0, at);
            for (int n = 0; n < 3; n++)
                index[plan->axis[n]] = at[n];
            ends[end] = linear(index);
        }
        any = true;
    }
    double length = reference_opacity_length(&plan->scene->base);
    snow_mode mode = plan->scene->base.settings.mode;
    double mean = (ends[0] + ends[1]) / 2;
    double expected = mode == SNOW_MODE_MIP     ? fmax(ends[0], ends[1])
                      : mode == SNOW_MODE_MINIP ? fmin(ends[0], ends[1])
                      : mode == SNOW_MODE_MEAN  ? mean
                                                : mean * chord / length;
    /* Numbers are rounded: voxels, both ways of their means, and cuts. */
    double unit = (plan->high - plan->low) / VALUE_MOST;
    if (mode == SNOW_MODE_SUM)
        unit *= fmax(chord / length, 1);
    assert_true(any && sample[1] == 1);
    if (fabs(sample[0] - expected) > 2 * unit)
        fail_msg("mode %d: %g, not %g", mode, sample[0], expected);
}

static void projections_of_a_linear_field_are_exact(void **state) {
    (void)state;
    static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                      SNOW_MODE_MEAN, SNOW_MODE_SUM};
    for (int n = 0; n < POSES; n += (int)support_stride(13)) {
        value_scene scene = value_scene_of((int64_t[]){9, 11, 8}, linear, 1);
        pose(&scene, n);
        /* Not beyond one voxel outside, where the field is not linear. */
        value_scene_space(&scene, 1, 1, 1);
        scene.base.settings.mode = modes[n / 7 % 4];
        value_plan plan = value_scene_plan(&scene);
        value_model *model = value_model_new(&plan);
        assert_true(walk(model, 3, projection_sample) > 20);
        value_model_free(model);
        value_scene_free(&scene);
    }
}

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

static void a_plane_is_lit_as_phong_says(void **state) {
    (void)state;
    for (int n = 0; n < POSES; n += (int)support_stride(13)) {
        value_scene scene = value_scene_of((int64_t[]){13, 14, 12}, linear, 1);
        pose(&scene, n);
        value_scene_space(&scene, 1, 1, 1);
        scene.base.settings.shade = SNOW_SHADE_PHONG;
        scene.base.settings.mode = n % 2 ? SNOW_MODE_ISO : SNOW_MODE_OVER;
        scene.base.settings.iso = linear((double[]){6, 6.5, 5.5});
        scene.base.view.width = scene.base.view.height = 1;
        scene.base.view.zoom = 100;
        const snow_color_point half[] = {{0, 0.5, 0.5, 0.5}};
        scene.base.colors = half;
        scene.base.settings.light =
            n / 2 % 2 ? SNOW_LIGHT_HEAD : SNOW_LIGHT_KEY;
        double *picture = value_model_render(&scene);
        reference_camera camera;
        reference_camera_of(&scene.base, &camera);
        double normal[3] = {0.5, -0.8, 1.1};
        double cosine = cosine_with(normal, camera.back);
        for (int i = 0; i < 3 && cosine < 0; i++)
            normal[i] = -normal[i];
        cosine = fabs(cosine);
        double expected = phong(&camera, normal, cosine,
                                scene.base.settings.light == SNOW_LIGHT_KEY);
        /* Seen from the edge the cosine bends at 0 within a lattice pixel. */
        bool edge = cosine < 0.15;
        if (!edge && fabs(picture[0] - expected) > 2e-3)
            fail_msg("view %d: %g, not %g", n, picture[0], expected);
        free(picture);
        value_scene_free(&scene);
    }
}

/* --- the same volume in another order ------------------------------------- */

static const snow_opacity_point hill[] = {{20, 0}, {60, 0.3}, {90, 0.8}};
static const snow_color_point tints[] = {
    {20, 0.9, 0.2, 0.1}, {60, 0.2, 0.8, 0.4}, {90, 0.3, 0.4, 1}};

static void show_hill(value_scene *scene) {
    free((void *)(uintptr_t)scene->base.opacities);
    scene->base.opacities = hill;
    scene->base.opacity_count = 3;
    scene->base.colors = tints;
    scene->base.color_count = 3;
    scene->base.settings.shade = SNOW_SHADE_PHONG;
}

/* The same world with index axes permuted and turned round: number 0 to 47. */
static value_scene reordered(const value_scene *from, int number) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int *order = orders[number % 6];
    const int64_t *n = from->base.info.dims;
    value_scene to = *from;
    double *voxels = calloc((size_t)(n[0] * n[1] * n[2]), sizeof *voxels);
    to.base.voxels = voxels;
    for (int c = 0; c < 3; c++) {
        bool turned = number / 6 >> c & 1;
        to.base.info.dims[c] = n[order[c]];
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
                *voxels++ = value_scene_voxels(
                    from)[(at[2] * n[1] + at[1]) * n[0] + at[0]];
            }
    return to;
}

static void data_turned_and_reordered_give_the_same_picture(void **state) {
    (void)state;
    for (int n = 1; n < 144; n += (int)support_stride(29)) {
        value_scene scene = value_scene_of((int64_t[]){15, 17, 14}, ripples, 0);
        show_hill(&scene);
        value_scene_space(&scene, 1, 1.2, 1.4);
        value_scene_look(&scene, n % 3, 24, 17, n / 48 % 2 ? 25 : 0);
        scene.base.settings.quality = value_qualities[n / 48];
        value_scene other = reordered(&scene, n % 48);
        double *one = value_model_render(&scene), largest = 0, sum = 0;
        double *two = value_model_render(&other);
        for (int p = 0; p < 48 * 40 * 4; p++) {
            largest = fmax(largest, fabs(one[p] - two[p]));
            sum += fabs(one[p] - two[p]);
        }
        /* Weights are mirrored, so that values differ by one unit of V here and
         * there, and a sample takes the node beside. */
        if (largest > 6.0 / 255 || sum / (48 * 40 * 4) > 3e-4)
            fail_msg("order %d: by %g, mean %g", n, largest,
                     sum / (48 * 40 * 4));
        free(one);
        free(two);
        free((void *)(uintptr_t)other.base.voxels);
        value_scene_free(&scene);
    }
}

/* --- a sphere ------------------------------------------------------------- */

static void a_hard_sphere_has_its_radius(void **state) {
    (void)state;
    static const snow_opacity_point edge[] = {{128, 0}, {128, 1}};
    double sizes[VALUE_QUALITIES];
    for (int n = 0; n < VALUE_QUALITIES; n++) {
        value_scene scene = value_scene_of((int64_t[]){24, 24, 24}, ball, 0);
        free((void *)(uintptr_t)scene.base.opacities);
        scene.base.opacities = edge;
        scene.base.opacity_count = 2;
        value_scene_look(&scene, 2, 20, 25, 0);
        scene.base.settings.quality = value_qualities[n];
        scene.base.view.width = scene.base.view.height = 160;
        reference_camera camera;
        reference_camera_of(&scene.base, &camera);
        double *picture = value_model_render(&scene), area = 0;
        for (int p = 0; p < 160 * 160; p++)
            area += picture[4 * p + 3];
        sizes[n] = sqrt(area / acos(-1.0)) * camera.pitch;
        free(picture);
        value_scene_free(&scene);
    }
    print_message("             a sphere of radius 8 has %.3f, %.3f, %.3f\n",
                  sizes[0], sizes[1], sizes[2]);
    for (int n = 0; n < VALUE_QUALITIES; n++)
        assert_true(fabs(sizes[n] - 8) < 0.02);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integers_round_halves_up_and_saturate),
        cmocka_unit_test(a_uniform_block_has_the_opacity_of_its_chord),
        cmocka_unit_test(the_middle_of_a_block_has_it_too),
        cmocka_unit_test(an_entry_of_one_value_is_a_slab_of_it),
        cmocka_unit_test(a_linear_field_is_exact_with_its_gradient),
        cmocka_unit_test(projections_of_a_linear_field_are_exact),
        cmocka_unit_test(a_plane_is_lit_as_phong_says),
        cmocka_unit_test(data_turned_and_reordered_give_the_same_picture),
        cmocka_unit_test(a_hard_sphere_has_its_radius),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
