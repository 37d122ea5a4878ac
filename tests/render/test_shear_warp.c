/* tests/render/test_shear_warp.c - pictures of the sheared method equal the
 * float64 sheared model.
 *
 * Small volumes through every kernel, footprint, view, zoom, size, scalar type,
 * matrix, threshold, quality and slab.  Where all combinations would be too
 * many, one factor runs through all its values while the others are drawn.  The
 * bounds are those of support_shear_warp.h. */
#include <math.h>

#include "reference/shear_warp.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const model_stand stands[] = {
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 0},
    {{0, 0, -1}, {0, 1, 0}, 0, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, 0, 0, 0},
    {{0, -1, 0}, {0, 0, 1}, 0, 0, 180},
    {{1, 0, 0}, {0, 0, 1}, 0, 0, 0},
    {{-1, 0, 0}, {0, 0, 1}, 0, 0, -90},
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 37},
    {{0, 0, 1}, {0, 1, 0}, 45, 0, 0},
    {{0, 0, 1}, {0, 1, 0}, 0, -45, 45},
    {{0, 0, 1}, {0, 1, 0}, 1e-9, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, -1e-9, 1e-7, 1e-9},
    {{1, 0, 0}, {0, 0, 1}, 1e-5, -1e-4, 0},
    {{0, 0, 1}, {0, 1, 0}, 30, 20, 0},
    {{0, 0, 1}, {0, 1, 0}, 10, 80, 0},
    {{0, 1, 0}, {0, 0, 1}, -120, -35, 25},
    {{1, 0, 0}, {0, 0, 1}, 90, 45, 0},
    {{-1, 0, 0}, {0, 0, 1}, 20, -15, 200},
    {MODEL_ISO, 0, 0, 0},
};

static const snow_type types[] = {
    SNOW_TYPE_INT8,    SNOW_TYPE_UINT8,   SNOW_TYPE_INT16, SNOW_TYPE_UINT16,
    SNOW_TYPE_INT32,   SNOW_TYPE_UINT32,  SNOW_TYPE_INT64, SNOW_TYPE_UINT64,
    SNOW_TYPE_FLOAT32, SNOW_TYPE_FLOAT64,
};
static const snow_kernel kernels[] = {SNOW_KERNEL_BSPLINE, SNOW_KERNEL_TENT,
                                      SNOW_KERNEL_GAUSS, SNOW_KERNEL_BOX};
static const double zooms[] = {0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.7, 4, 30};
static const double thresholds[] = {0, 10, 30};
static const int64_t dims[3] = {13, 10, 15};

/* As the model's ramp, but next to nothing gets opaque. */
static const snow_opacity_point faint[] = {
    {40, 0}, {60, 0.06}, {60, 0.15}, {85, 0.03}, {99, 0.2}};

static size_t draw(uint64_t *state, size_t count) {
    return (size_t)(support_random(state) >> 33) % count;
}

static void stand_at(reference_scene *scene, size_t n, double zoom) {
    model_stand_at(scene, &stands[n % COUNT(stands)], zoom);
}

/* Translucent and unshaded, by any encoding and number of threads. */
static void make_plain(reference_scene *scene, uint64_t *random) {
    scene->opacities = faint;
    scene->opacity_count = COUNT(faint);
    scene->settings.shade = SNOW_SHADE_NONE;
    scene->settings.method = SNOW_METHOD_SHEAR_WARP;
    scene->settings.encoding = (snow_encoding)draw(random, 4);
    scene->settings.threads = 1 + (int)draw(random, 3);
    scene->settings.threshold = thresholds[draw(random, COUNT(thresholds))];
}

/* A scene that is drawn but for what the caller sets afterwards. */
static reference_scene drawn_scene(const int64_t voxels[3], uint64_t *random) {
    reference_scene scene = model_scene(
        voxels, types[draw(random, COUNT(types))], draw(random, 2) == 0,
        (model_matrix)draw(random, MODEL_MATRICES), draw(random, 99));
    make_plain(&scene, random);
    scene.view.width = 24;
    scene.view.height = 18;
    stand_at(&scene, draw(random, COUNT(stands)),
             zooms[3 + draw(random, COUNT(zooms) - 3)]);
    return scene;
}

static void free_voxels(reference_scene *scene) {
    free((void *)(uintptr_t)scene->voxels);
}

static void every_kernel_and_footprint_from_every_side(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 1;
    sheared_tally tally = {0};
    for (size_t k = 0; k < COUNT(kernels); k++)
        for (int footprint = 2; footprint <= 9; footprint++)
            for (size_t n = support_start(k + (size_t)footprint, 7);
                 n < COUNT(stands); n += support_stride(7)) {
                reference_scene scene = drawn_scene(dims, &random);
                scene.settings.kernel = kernels[k];
                scene.settings.footprint = footprint;
                if (draw(&random, 4) == 0)
                    scene.settings.quality = SNOW_QUALITY_DRAFT;
                stand_at(&scene, n, zooms[3 + draw(&random, COUNT(zooms) - 3)]);
                sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
                free_voxels(&scene);
            }
    sheared_report("kernels and footprints", &tally);
    model_close(&stage);
}

static void every_zoom_in_normal_and_draft_quality(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 2;
    sheared_tally tally = {0};
    int combinations[2][2] = {{0}};
    for (size_t z = 0; z < COUNT(zooms); z++)
        for (size_t n = support_start(z, 7); n < 4 * COUNT(stands);
             n += support_stride(7)) {
            reference_scene scene = drawn_scene(dims, &random);
            scene.settings.kernel = kernels[n % 4 == 3 ? draw(&random, 4) : 0];
            stand_at(&scene, n, zooms[z] * (1 + support_uniform(&random) / 2));
            if (n / COUNT(stands) % 2) {
                scene.settings.quality = SNOW_QUALITY_DRAFT;
                scene.settings.kernel = SNOW_KERNEL_TENT;
            }
            sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
            if (sheared_fits(&scene, NULL) && n < COUNT(stands)) {
                sheared_facts facts;
                free(sheared_render(&scene, &(sheared_options){0}, &facts));
                combinations[facts.phases[0] == 2][facts.stride[0] == 2]++;
            }
            free_voxels(&scene);
        }
    sheared_report("zooms", &tally);
    /* Two pixels a voxel, one, and one in two voxels have all been there. */
    assert_true(combinations[1][0] > 0 && combinations[0][0] > 0 &&
                combinations[0][1] > 0);
    assert_true(tally.footprints > 0);
    model_close(&stage);
}

static void every_size_of_picture(void **state) {
    (void)state;
    static const int sizes[][2] = {{1, 1},  {7, 5},    {64, 48}, {48, 64},
                                   {1, 30}, {30, 1},   {2, 2},   {17, 33},
                                   {96, 3}, {200, 150}};
    model_stage stage = model_open();
    uint64_t random = 3;
    sheared_tally tally = {0};
    for (size_t s = 0; s < COUNT(sizes); s++)
        for (size_t n = support_start(s, 5); n < COUNT(stands);
             n += support_stride(5)) {
            reference_scene scene = drawn_scene(dims, &random);
            scene.view.width = sizes[s][0];
            scene.view.height = sizes[s][1];
            sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
            free_voxels(&scene);
        }
    sheared_report("sizes", &tally);
    model_close(&stage);
}

static void every_type_matrix_and_threshold(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 4;
    sheared_tally tally = {0};
    for (size_t n = 0; n < COUNT(types) * MODEL_MATRICES * 6;
         n += support_stride(7)) {
        size_t rest = n / COUNT(types) / MODEL_MATRICES;
        reference_scene scene =
            model_scene(dims, types[n % COUNT(types)], rest % 2 == 0,
                        (model_matrix)(n / COUNT(types) % MODEL_MATRICES), n);
        make_plain(&scene, &random);
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, draw(&random, COUNT(stands)),
                 zooms[4 + draw(&random, 4)]);
        scene.settings.threshold = thresholds[rest / 2];
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("types, matrices, thresholds", &tally);
    model_close(&stage);
}

/* Codes put a value of a stretch off by half of 1 / 65,536 of all stretches (6
 * here), 5e-5 of the rise of an opacity; pictures by a few times that. */
static void codes_of_wide_types_are_close_to_their_values(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 5;
    sheared_tally tally = {0};
    const sheared_options exact = {.exact_values = true};
    for (size_t n = 0; n < 6 * COUNT(stands); n++) {
        reference_scene scene = drawn_scene(dims, &random);
        reference_scene wide =
            model_scene(dims, types[4 + n % 6], n % 2,
                        (model_matrix)draw(&random, MODEL_MATRICES), n);
        make_plain(&wide, &random);
        wide.view = scene.view;
        sheared_check(&stage, &wide, &exact, SHEARED_BOUND, &tally);
        free_voxels(&scene);
        free_voxels(&wide);
    }
    sheared_report("wide types, exact values", &tally);
    model_close(&stage);
}

/* Steps, teeth and single points; opaque voxels among them. */
static void transfer_functions_of_any_shape(void **state) {
    (void)state;
    static const snow_opacity_point one[] = {{50, 0.4}};
    static const snow_opacity_point teeth[] = {{10, 0}, {20, 1}, {20, 0},
                                               {50, 1}, {50, 0}, {50, 0.3},
                                               {90, 0}, {90, 1}};
    static const snow_color_point red[] = {{1e9, 1, 0, 0}};
    static const snow_color_point steps[] = {
        {30, 1, 0, 0}, {30, 0, 1, 0}, {60, 0, 0, 1}, {60, 1, 1, 1}};
    model_stage stage = model_open();
    uint64_t random = 6;
    sheared_tally tally = {0};
    for (size_t n = 0; n < 8 * COUNT(types); n++) {
        reference_scene scene = model_scene(
            dims, types[n / 8], false, (model_matrix)(n % MODEL_MATRICES), n);
        make_plain(&scene, &random);
        scene.opacities = n % 2 == 0 ? one : teeth;
        scene.opacity_count = n % 2 == 0 ? COUNT(one) : COUNT(teeth);
        scene.colors = n / 2 % 2 == 0 ? red : steps;
        scene.color_count = n / 2 % 2 == 0 ? COUNT(red) : COUNT(steps);
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n, 1);
        scene.settings.opacity_length = n % 3 == 0 ? 3 : 0;
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("transfer functions", &tally);
    model_close(&stage);
}

static void logarithmic_scales(void **state) {
    (void)state;
    static const snow_opacity_point points[] = {
        {0.5, 0.1}, {4, 0}, {40, 0.3}, {40, 0}, {95, 0.8}};
    static const snow_color_point colors[] = {
        {1, 1, 0, 0}, {10, 0, 1, 0.5}, {100, 0, 0.3, 1}};
    model_stage stage = model_open();
    uint64_t random = 8;
    sheared_tally tally = {0};
    for (size_t n = 0; n < 4 * COUNT(types); n++) {
        reference_scene scene = model_scene(
            dims, types[n / 4], false, (model_matrix)(n % MODEL_MATRICES), n);
        make_plain(&scene, &random);
        scene.log = true;
        scene.opacities = points;
        scene.opacity_count = COUNT(points);
        scene.colors = colors;
        scene.color_count = COUNT(colors);
        scene.info.intercept -= n % 4 == 2 ? 30 : 0;
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n, 1);
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("logarithmic scales", &tally);
    model_close(&stage);
}

static void volumes_thin_along_some_axes(void **state) {
    (void)state;
    static const int64_t thin[][3] = {{1, 1, 1}, {9, 1, 1}, {1, 9, 1},
                                      {1, 1, 9}, {7, 5, 1}, {7, 1, 5},
                                      {1, 7, 5}, {2, 2, 2}};
    static const snow_opacity_point solid[] = {{0, 0.01}, {100, 0.9}};
    model_stage stage = model_open();
    uint64_t random = 7;
    sheared_tally tally = {0};
    for (size_t t = 0; t < COUNT(thin); t++)
        for (size_t n = 0; n < COUNT(stands); n++) {
            reference_scene scene = drawn_scene(thin[t], &random);
            scene.opacities = solid;
            scene.opacity_count = COUNT(solid);
            scene.settings.kernel = kernels[draw(&random, COUNT(kernels))];
            stand_at(&scene, n, zooms[3 + draw(&random, COUNT(zooms) - 3)]);
            sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
            free_voxels(&scene);
        }
    sheared_report("thin volumes", &tally);
    model_close(&stage);
}

/* Runs of voxels across the borders of words, bands and tiles, and single
 * voxels beside them. */
static void fill_runs(reference_scene *scene, uint64_t *random) {
    const int64_t *d = scene->info.dims;
    float *voxels = model_voxels(scene);
    int64_t count = d[0] * d[1] * d[2], at = 0;
    while (at < count) {
        int64_t gap = (int64_t)draw(random, draw(random, 3) ? 9 : 150);
        int64_t run = 1 + (int64_t)draw(random, draw(random, 3) ? 5 : 200);
        at += gap;
        for (int64_t end = at + run; at < end && at < count; at++)
            voxels[at] = (float)(0.5 + support_uniform(random));
    }
}

static void rows_longer_than_words_bands_and_tiles(void **state) {
    (void)state;
    static const int64_t large[][3] = {
        {65, 40, 3},  {130, 33, 4}, {64, 64, 2}, {63, 3, 70},  {3, 129, 66},
        {2, 67, 192}, {300, 9, 2},  {5, 280, 2}, {128, 65, 3}, {127, 2, 97}};
    model_stage stage = model_open();
    uint64_t random = 8;
    sheared_tally tally = {0};
    for (size_t n = 0; n < 4 * COUNT(large); n++) {
        const int64_t *d = large[n % COUNT(large)];
        reference_scene scene = model_blank(d, 0.3);
        fill_runs(&scene, &random);
        snow_settings settings = scene.settings;
        const snow_opacity_point *own = scene.opacities;
        make_plain(&scene, &random);
        settings.method = SNOW_METHOD_SHEAR_WARP;
        settings.encoding = scene.settings.encoding;
        settings.threads = scene.settings.threads;
        scene.settings = settings;
        scene.opacities = own;
        scene.opacity_count = 2;
        scene.view.width = 60;
        scene.view.height = 50;
        /* Mostly from along the shortest side. */
        int side = d[0] <= d[1] && d[0] <= d[2] ? 4 : d[1] <= d[2] ? 2 : 0;
        stand_at(&scene, (size_t)side, 1);
        model_turn(&scene, 30 * support_uniform(&random) - 15,
                   n < COUNT(large) ? 0 : 50 * support_uniform(&random) - 25,
                   360 * support_uniform(&random),
                   1 + 3 * support_uniform(&random));
        if (n % 3 == 0)
            scene.settings.kernel = kernels[draw(&random, 4)];
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        model_free(&scene);
    }
    sheared_report("long rows", &tally);
    model_close(&stage);
}

static void slabs_alone_equal_theirs(void **state) {
    (void)state;
    static const int parts[] = {2, 3, 7, 15, 20};
    model_stage stage = model_open();
    uint64_t random = 9;
    sheared_tally tally = {0};
    for (size_t p = 0; p < COUNT(parts); p++)
        for (size_t n = 0; n < COUNT(stands); n++) {
            reference_scene scene = drawn_scene(dims, &random);
            static const snow_opacity_point dense[] = {{30, 0}, {60, 0.8}};
            scene.opacities = dense;
            scene.opacity_count = COUNT(dense);
            scene.view.zoom = 0.7 + support_uniform(&random);
            sheared_options slab = {.parts = parts[p]};
            slab.part = (int)draw(
                &random, (size_t)parts[p] < 10 ? (size_t)parts[p] : 10);
            scene.settings.quality = (snow_quality)(n % 3);
            if (n % 3 == 1)
                scene.settings.footprint = 3;
            stand_at(&scene, n, scene.view.zoom);
            sheared_check(&stage, &scene, &slab, SHEARED_BOUND, &tally);
            free_voxels(&scene);
        }
    sheared_report("slabs", &tally);
    model_close(&stage);
}

/* Slices between slices; from every side, with a blend of two or three axes
 * where they are nearly as good. */
static void high_quality_has_slices_between(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 10;
    sheared_tally tally = {0};
    int axes[4] = {0};
    for (size_t n = 0; n < COUNT(types) * COUNT(stands) * 2;
         n += support_stride(7)) {
        reference_scene scene =
            model_scene(dims, types[n % COUNT(types)], n % 2,
                        (model_matrix)(n / 7 % MODEL_MATRICES), n);
        make_plain(&scene, &random);
        scene.settings.quality = SNOW_QUALITY_HIGH;
        scene.settings.kernel = kernels[n % 5 == 4 ? draw(&random, 4) : 0];
        scene.settings.shade = n / 3 % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
        scene.view.width = 26;
        scene.view.height = 31;
        stand_at(&scene, n / COUNT(types), 0.2 + 2 * support_uniform(&random));
        if (n % 4 == 3)
            scene.view.azimuth += 6 * support_uniform(&random) - 3;
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        if (sheared_fits(&scene, NULL) && n % (4 / support_stride(4)) == 0) {
            sheared_facts facts;
            free(sheared_render(&scene, &(sheared_options){0}, &facts));
            axes[facts.axes]++;
        }
        free_voxels(&scene);
    }
    sheared_report("high quality", &tally);
    assert_true(axes[1] && axes[2] && axes[3]);
    model_close(&stage);
}

/* Voxels are thin along x, and slices along x are a little better than those
 * along z: the picture is blended of both, unless the second has too many
 * voxels in reach of a pixel; then the first stands alone. */
static void blends_that_do_not_fit_along_one_axis(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 18;
    sheared_tally tally = {0};
    for (int n = 0; n < 90; n += (int)support_stride(3)) {
        reference_scene scene =
            model_scene((int64_t[]){40, 12, 11}, SNOW_TYPE_UINT8, n % 2,
                        MODEL_PLAIN, (uint64_t)n);
        make_plain(&scene, &random);
        scene.settings.threshold = 0;
        scene.settings.quality = SNOW_QUALITY_HIGH;
        scene.info.matrix[0][0] = scene.info.spacing[0] = 0.2;
        scene.view.width = 26;
        scene.view.height = 31;
        stand_at(&scene, 0, 0.02 * pow(200, support_uniform(&random)));
        scene.view.azimuth = 46 + support_uniform(&random);
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("blends of thin voxels", &tally);
    assert_true(tally.footprints > support_sweep(10, 1) &&
                tally.clear > support_sweep(10, 5));
    model_close(&stage);
}

/* Unless a footprint or another kernel is named. */
static void drafts_use_the_tent_of_two_voxels(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 17;
    sheared_tally tally = {0};
    for (size_t n = 0; n < 4 * COUNT(stands); n++) {
        reference_scene scene = drawn_scene(dims, &random);
        scene.settings.quality = SNOW_QUALITY_DRAFT;
        scene.settings.footprint = n % 3 == 0 ? 3 : 0;
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("drafts", &tally);
    model_close(&stage);
}

/* Voxels that let nothing through end the work on what lies behind them. */
static void opaque_voxels_hide_what_lies_behind(void **state) {
    (void)state;
    static const snow_opacity_point step[] = {{45, 0}, {45, 1}};
    static const snow_opacity_point steep[] = {{40, 0}, {60, 0.95}};
    model_stage stage = model_open();
    uint64_t random = 11;
    sheared_tally tally = {0};
    for (size_t n = 0; n < 12 * COUNT(stands); n += support_stride(13)) {
        reference_scene scene = drawn_scene((int64_t[]){40, 37, 45}, &random);
        scene.opacities = n % 2 ? step : steep;
        scene.opacity_count = 2;
        scene.view.width = 64;
        scene.view.height = 48;
        stand_at(&scene, n, 0.7 + 3 * support_uniform(&random));
        if (n % 3 == 1)
            scene.settings.kernel = kernels[draw(&random, 4)];
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("opaque", &tally);
    assert_true(tally.opaque > tally.clear);
    model_close(&stage);
}

/* --- shaded --------------------------------------------------------------- */

static void shaded_pictures_by_stored_normals(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 12;
    sheared_tally tally = {0};
    for (size_t n = 0; n < COUNT(types) * MODEL_MATRICES * 4;
         n += support_stride(7)) {
        reference_scene scene =
            model_scene(dims, types[n % COUNT(types)], n % 7 < 3,
                        (model_matrix)(n / COUNT(types) % MODEL_MATRICES), n);
        make_plain(&scene, &random);
        scene.settings.shade = SNOW_SHADE_PHONG;
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, draw(&random, COUNT(stands)),
                 zooms[4 + draw(&random, 4)]);
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("shaded", &tally);
    model_close(&stage);
}

/* Light from the side, from behind, and every coefficient.  The voxels are real
 * numbers with noise, and no view is along an axis: no normal is square to the
 * line of sight, so that rounding does not decide which way it is turned. */
static void lights_from_all_sides(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 13;
    sheared_tally tally = {0};
    for (size_t n = 0; n < 120; n += support_stride(7)) {
        reference_scene scene =
            model_scene(dims, SNOW_TYPE_FLOAT32, n % 2,
                        (model_matrix)(n % MODEL_MATRICES), n);
        snow_settings *settings = &scene.settings;
        make_plain(&scene, &random);
        settings->shade = SNOW_SHADE_PHONG;
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n % 3, 1);
        model_turn(&scene, 90 * support_uniform(&random) - 45,
                   90 * support_uniform(&random) - 45, 7, 1);
        settings->light_azimuth = 360 * support_uniform(&random) - 180;
        settings->light_elevation = 180 * support_uniform(&random) - 90;
        settings->ambient = support_uniform(&random);
        settings->diffuse = support_uniform(&random);
        settings->specular = support_uniform(&random);
        settings->shininess = n % 5 == 0 ? 0 : 100 * support_uniform(&random);
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("lights", &tally);
    model_close(&stage);
}

/* Normals of 16 bits are off by half a degree at most, by a quarter in the
 * mean; with noise all through the volume pictures are by a few steps. */
static void stored_normals_are_close_to_exact_ones(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 14;
    sheared_tally tally = {0};
    const sheared_options exact = {.exact_normals = true};
    for (size_t n = 0; n < 4 * COUNT(stands); n++) {
        reference_scene scene = drawn_scene(dims, &random);
        scene.settings.shade = SNOW_SHADE_PHONG;
        stand_at(&scene, n, 1);
        sheared_check(&stage, &scene, &exact, 0.75 / 255, &tally);
        free_voxels(&scene);
    }
    sheared_report("exact normals", &tally);
    model_close(&stage);
}

static void voxels_that_are_no_numbers_or_infinite(void **state) {
    (void)state;
    static const float odd[] = {(float)NAN, (float)INFINITY, -(float)INFINITY};
    model_stage stage = model_open();
    uint64_t random = 15;
    sheared_tally tally = {0};
    for (size_t n = 0; n < 2 * COUNT(stands); n++) {
        reference_scene scene =
            model_scene(dims, SNOW_TYPE_FLOAT32, n % 3 == 0, MODEL_OBLIQUE, n);
        make_plain(&scene, &random);
        for (int i = 0; i < 13 * 10 * 15 / 6; i++)
            model_voxels(&scene)[draw(&random, 13 * 10 * 15)] =
                odd[draw(&random, 3)];
        if (n >= COUNT(stands))
            scene.settings.shade = SNOW_SHADE_PHONG;
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n, 1);
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        free_voxels(&scene);
    }
    sheared_report("not finite", &tally);
    model_close(&stage);
}

/* Nothing is interesting, nothing is in view: a picture of zeros. */
static void pictures_of_nothing_are_empty(void **state) {
    (void)state;
    static const snow_opacity_point none[] = {{0, 0}};
    model_stage stage = model_open();
    uint64_t random = 16;
    for (int n = 0; n < 20; n++) {
        reference_scene scene = drawn_scene(dims, &random);
        scene.opacities = none;
        scene.opacity_count = 1;
        scene.settings.shade = n % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
        float *picture = model_picture(&stage, &scene);
        for (int i = 0; i < 24 * 18 * 4; i++)
            assert_true(picture[i] == 0);
        assert_int_equal(snow_frame_stats(stage.frame)->interesting, 0);
        free(picture);
        free_voxels(&scene);
    }
    model_close(&stage);
}

/* With an argument: the tests of that name, which may hold a *. */
int main(int argc, char **argv) {
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kernel_and_footprint_from_every_side),
        cmocka_unit_test(every_zoom_in_normal_and_draft_quality),
        cmocka_unit_test(every_size_of_picture),
        cmocka_unit_test(every_type_matrix_and_threshold),
        cmocka_unit_test(codes_of_wide_types_are_close_to_their_values),
        cmocka_unit_test(transfer_functions_of_any_shape),
        cmocka_unit_test(logarithmic_scales),
        cmocka_unit_test(volumes_thin_along_some_axes),
        cmocka_unit_test(rows_longer_than_words_bands_and_tiles),
        cmocka_unit_test(slabs_alone_equal_theirs),
        cmocka_unit_test(high_quality_has_slices_between),
        cmocka_unit_test(blends_that_do_not_fit_along_one_axis),
        cmocka_unit_test(drafts_use_the_tent_of_two_voxels),
        cmocka_unit_test(opaque_voxels_hide_what_lies_behind),
        cmocka_unit_test(shaded_pictures_by_stored_normals),
        cmocka_unit_test(lights_from_all_sides),
        cmocka_unit_test(stored_normals_are_close_to_exact_ones),
        cmocka_unit_test(voxels_that_are_no_numbers_or_infinite),
        cmocka_unit_test(pictures_of_nothing_are_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
