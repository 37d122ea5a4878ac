/* tests/render/test_raycast.c - method raycast against a ray caster in double
 * that was written from the model alone (tests/reference/raycast.h), against
 * what can be computed by hand, and what it refuses. */
#include "reference/model.h"
#include "reference/raycast.h"
#include "volume/volume.h"

#include "render/picture.h"

#include <math.h>
#include <snowglass/ranks.h>

/* What remains of an 8-bit step: samples are floats, and rays end where less
 * than a millionth is left to be seen. */
#define BOUND 4e-6
#define WIDTH 30
#define HEIGHT 22

/* --- pictures by the library ---------------------------------------------- */

static const double none[1][4];

/* A scene's volume, cut by planes. */
static snow_volume *open_cut(snow_context *context,
                             const reference_cast *cast) {
    snow_volume *volume = model_volume(context, cast->scene), *made = NULL;
    volume->masked = cast->scene->masked;
    if (!cast->plane_count)
        return volume;
    assert_int_equal(snow_volume_clip(volume, cast->planes[0],
                                      (size_t)cast->plane_count, &made),
                     SNOW_STATUS_OK);
    snow_volume_close(volume);
    return made;
}

static snow_image *render(const model_stage *stage,
                          const reference_cast *cast) {
    const reference_scene *scene = cast->scene;
    snow_volume *volume = open_cut(stage->context, cast);
    snow_transfer *transfer = model_transfer(stage->context, scene);
    snow_image *image = NULL;
    snow_volume *volumes[SNOW_LAYERS_MAX];
    snow_transfer *looks[SNOW_LAYERS_MAX];
    snow_layer channels[SNOW_LAYERS_MAX];
    int count = 0;
    for (const reference_cast *c = cast->next; c; c = c->next, count++) {
        volumes[count] = open_cut(stage->context, c);
        looks[count] = model_transfer(stage->context, c->scene);
        channels[count] = (snow_layer){volumes[count], looks[count], true};
    }
    assert_int_equal(snow_frame_set_layers(stage->frame, channels, count),
                     SNOW_STATUS_OK);
    snow_status status = snow_frame_render(
        stage->frame, volume, transfer, &scene->view, &scene->settings, &image);
    snow_frame_set_layers(stage->frame, NULL, 0);
    for (int n = 0; n < count; n++) {
        snow_transfer_free(looks[n]);
        snow_volume_close(volumes[n]);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    if (status != SNOW_STATUS_OK)
        fail_msg("%s: %s", model_words(scene),
                 snow_context_message(stage->context));
    return image;
}

/* The largest difference of numbers, which are NaN in the same places. */
static double distance(const float *is, int step, const double *should,
                       size_t count) {
    double most = 0;
    for (size_t n = 0; n < count; n++) {
        double here = (double)is[n * (size_t)step];
        if (isnan(here) != isnan(should[n]))
            return INFINITY;
        if (!isnan(here))
            most = fmax(most, fabs(here - should[n]));
    }
    return most;
}

/* Of a picture whose channels are one, two or four. */
static double picture_distance(snow_image *image, const double *should) {
    int channels = snow_image_channels(image);
    size_t count =
        (size_t)snow_image_width(image) * (size_t)snow_image_height(image);
    double most = 0;
    if (channels == 1)
        return distance(snow_image_pixels(image), 1, should, count);
    for (size_t n = 0; n < count; n++)
        for (int c = 0; c < 4; c++) {
            int from = channels == 4 ? c : c == 3;
            float here =
                snow_image_pixels(image)[n * (size_t)channels + (size_t)from];
            most = fmax(most, fabs((double)here - should[4 * n + (size_t)c]));
        }
    return most;
}

static double strongest(const reference_scene *scene, const double *picture) {
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height;
    double most = 0;
    for (size_t n = 0; n < count; n++)
        most = fmax(most, picture[4 * n + 3]);
    return most;
}

/* Renders both ways; depths too where they are asked for. */
static void check_cast(const model_stage *stage, const reference_cast *cast,
                       double bound) {
    const reference_scene *scene = cast->scene;
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height;
    double *depth = scene->settings.depth ? calloc(count, sizeof *depth) : NULL;
    double *should = reference_cast_rays(cast, depth);
    snow_image *image = render(stage, cast);
    double differs = picture_distance(image, should);
    if (!(differs < bound))
        fail_msg("differs by %g: %s", differs, model_words(scene));
    if (snow_image_channels(image) > 1 && !(strongest(scene, should) > 0.1))
        fail_msg("shows next to nothing: %s", model_words(scene));
    if (depth) {
        differs = distance(
            snow_image_pixels(
                (snow_image *)(uintptr_t)snow_frame_depth(stage->frame)),
            1, depth, count);
        if (!(differs < 1e-3))
            fail_msg("depths differ by %g: %s", differs, model_words(scene));
    }
    snow_image_free(image);
    free(should);
    free(depth);
}

/* A small scene by raycast, seen aslant. */
static reference_scene scene_of(snow_type type, bool grey,
                                model_matrix matrix) {
    reference_scene scene =
        model_scene((int64_t[]){14, 11, 9}, type, grey, matrix, 3);
    scene.settings.method = SNOW_METHOD_RAYCAST;
    scene.settings.kernel = SNOW_KERNEL_TENT;
    scene.view.width = WIDTH;
    scene.view.height = HEIGHT;
    model_turn(&scene, 25, 35, 10, 1.2);
    return scene;
}

static void take_splines(reference_scene *scene, bool cubic) {
    scene->settings.kernel = cubic ? SNOW_KERNEL_BSPLINE : SNOW_KERNEL_TENT;
    scene->settings.footprint = cubic ? 4 : 0;
}

/* --- against the reference ------------------------------------------------ */

static reference_scene types(int n, reference_cast *cast) {
    (void)cast;
    return scene_of(model_type((size_t)n), n % 2, MODEL_OBLIQUE);
}

static reference_scene placements_and_views(int n, reference_cast *cast) {
    static const double backs[][3] = {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
    const int side = n / 2 % 3;
    (void)cast;
    reference_scene scene =
        scene_of(SNOW_TYPE_UINT8, false, (model_matrix)(n / 6));
    model_look(&scene, backs[side],
               side ? (double[]){0, 0, 1} : (double[]){0, 1, 0});
    scene.settings.depth = 1;
    scene.view.fov = n % 2 == 0 ? 0 : side == 1 ? 70 : 30;
    return scene;
}

static reference_scene qualities_and_kernels(int n, reference_cast *cast) {
    (void)cast;
    reference_scene scene = scene_of(SNOW_TYPE_INT16, false, MODEL_ANISOTROPIC);
    scene.settings.quality = (snow_quality)(n % 3);
    take_splines(&scene, n >= 3);
    return scene;
}

static reference_scene lights(int n, reference_cast *cast) {
    (void)cast;
    reference_scene scene = scene_of(SNOW_TYPE_UINT16, n & 1, MODEL_SHEARED);
    scene.settings.shade = n == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    scene.settings.light = n == 1 ? SNOW_LIGHT_HEAD : SNOW_LIGHT_AUTO;
    scene.settings.light_azimuth = n > 3 ? -60 : 0;
    scene.settings.light_elevation = n > 4 ? 35 : 0;
    scene.settings.specular = 0.6;
    scene.settings.shininess = n > 4 ? 7.5 : 20;
    scene.view.fov = n & 2 ? 50 : 0;
    return scene;
}

static reference_scene thresholds_gradients_logarithms(int n,
                                                       reference_cast *cast) {
    (void)cast;
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_ANISOTROPIC);
    scene.settings.threshold = n & 1 ? 30 : 0;
    if (n & 2)
        model_fade(&scene);
    scene.log = n & 4;
    return scene;
}

static reference_scene modes(int n, reference_cast *cast) {
    (void)cast;
    reference_scene scene = scene_of(
        n & 1 ? SNOW_TYPE_FLOAT32 : SNOW_TYPE_UINT8, n % 4 == 2, MODEL_OBLIQUE);
    scene.settings.mode = (snow_mode)(SNOW_MODE_MIP + n / 4);
    scene.settings.iso = 71;
    scene.settings.depth = scene.settings.mode == SNOW_MODE_ISO;
    scene.settings.quality =
        n % 4 == 3 ? SNOW_QUALITY_HIGH : SNOW_QUALITY_NORMAL;
    scene.view.fov = n & 2 ? 40 : 0;
    return scene;
}

/* Holes have no value; of a mask they have borders that are lit. */
static reference_scene holes(int n, reference_cast *cast) {
    (void)cast;
    reference_scene scene =
        scene_of(SNOW_TYPE_FLOAT32, false, MODEL_ANISOTROPIC);
    uint64_t seed = 7;
    scene.masked = n > SNOW_MODE_ISO;
    for (int i = 0; i < 14 * 11 * 9; i++)
        if (support_uniform(&seed) < 0.1)
            model_voxels(&scene)[i] = NAN;
    scene.settings.mode = (snow_mode)(n % (SNOW_MODE_ISO + 1));
    scene.settings.iso = 65;
    return scene;
}

/* The largest and smallest of the others, and in projections holes. */
static reference_scene infinities(int n, reference_cast *cast) {
    (void)cast;
    reference_scene scene = scene_of(SNOW_TYPE_FLOAT64, false, MODEL_PLAIN);
    double *voxels = (double *)(uintptr_t)scene.voxels;
    for (int i = 0; i < 14 * 11 * 9; i += 17)
        voxels[i] = i % 2 ? INFINITY : -INFINITY;
    scene.settings.mode = n ? SNOW_MODE_MIP : SNOW_MODE_OVER;
    return scene;
}

static reference_scene axes_of_one_and_two_voxels(int n, reference_cast *cast) {
    static const int64_t dims[][3] = {{14, 11, 1}, {1, 11, 9}, {14, 1, 1},
                                      {2, 11, 9},  {3, 2, 2},  {1, 1, 1}};
    const int64_t *d = dims[n / 2];
    (void)cast;
    reference_scene scene =
        model_scene(d, SNOW_TYPE_FLOAT32, false, MODEL_ANISOTROPIC, 5);
    for (int64_t i = 0; i < d[0] * d[1] * d[2]; i++)
        model_voxels(&scene)[i] = 65 + (float)(i * 7 % 30);
    scene.settings.method = SNOW_METHOD_RAYCAST;
    take_splines(&scene, n % 2);
    scene.view.width = scene.view.height = 24;
    model_turn(&scene, 25, 35, 10, 1.2);
    return scene;
}

/* Most of a volume is not seen, and is skipped: that must not show. */
static reference_scene empty_space(int n, reference_cast *cast) {
    static const snow_opacity_point step[] = {{55, 0}, {55, 0.3}};
    const int cubic = n % 2, mode = n / 2;
    (void)cast;
    reference_scene scene =
        scene_of(SNOW_TYPE_FLOAT32, false, MODEL_ANISOTROPIC);
    for (int i = 0; i < 14 * 11 * 9; i++)
        model_voxels(&scene)[i] = i % 37 ? 20 : 90;
    scene.opacities = step;
    scene.opacity_count = 2;
    take_splines(&scene, cubic);
    scene.settings.mode = (snow_mode)mode;
    scene.settings.iso = cubic ? 30 : 55;
    scene.settings.quality = cubic && mode == SNOW_MODE_OVER
                                 ? SNOW_QUALITY_NORMAL
                                 : SNOW_QUALITY_HIGH;
    if (cubic)
        model_voxels(&scene)[700] = 300;
    return scene;
}

static const double planes[][4] = {
    {0.3, 0.5, -0.8, -40}, {1, 0.2, 0.1, 12.25}, {0, 0, 0, 0}};

static reference_scene planes_between_voxels(int n, reference_cast *cast) {
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_ANISOTROPIC);
    cast->planes = planes;
    cast->plane_count = n < 4 ? 1 : 2;
    take_splines(&scene, n & 1);
    scene.settings.mode = n == 2 ? SNOW_MODE_ISO : SNOW_MODE_OVER;
    scene.settings.iso = 71;
    scene.view.fov = n == 3 ? 30 : 0;
    return scene;
}

static reference_scene draft_of_few_pixels(int n, reference_cast *cast) {
    (void)n;
    (void)cast;
    reference_scene scene = model_scene((int64_t[]){40, 40, 40},
                                        SNOW_TYPE_UINT8, false, MODEL_PLAIN, 2);
    scene.settings.method = SNOW_METHOD_RAYCAST;
    scene.settings.kernel = SNOW_KERNEL_TENT;
    scene.settings.quality = SNOW_QUALITY_DRAFT;
    scene.view.width = scene.view.height = 8;
    return scene;
}

static const snow_color_point names[] = {{0, 1, 0, 0}, {2, 1, 0, 0},
                                         {2, 0, 1, 0}, {4, 0, 1, 0},
                                         {4, 0, 0, 1}, {9, 0, 0, 1}};
static const snow_opacity_point opaque[] = {{0, 0.9}};

/* In each quality; and a single label, whose surface at the volume's sides has
 * no direction, so that none comes from rounding. */
static reference_scene labels(int n, reference_cast *cast) {
    static const snow_opacity_point some[] = {
        {0, 0}, {0.5, 0}, {0.5, 0.6}, {2.5, 0.6}, {2.5, 0}, {3.5, 0}, {3.5, 1}};
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_PLAIN);
    unsigned char *voxels = (unsigned char *)(uintptr_t)scene.voxels;
    const bool single = n == 3;
    cast->labels = true;
    for (int i = 0; i < 14 * 11 * 9; i++)
        voxels[i] = single ? 1 : (unsigned char)(voxels[i] / 25);
    scene.info.slope = 1;
    scene.colors = names;
    scene.color_count = sizeof names / sizeof *names;
    scene.opacities = single ? opaque : some;
    scene.opacity_count = single ? 1 : sizeof some / sizeof *some;
    scene.settings.quality = single ? SNOW_QUALITY_NORMAL : (snow_quality)n;
    scene.view.width = 20;
    scene.view.height = 16;
    return scene;
}

/* Half-way between voxels of two labels the larger one is shown, from whichever
 * side it is looked at. */
static reference_scene equal_shares_of_labels(int n, reference_cast *cast) {
    reference_scene scene = model_scene((int64_t[]){8, 8, 8}, SNOW_TYPE_UINT8,
                                        false, MODEL_PLAIN, 1);
    unsigned char *voxels = (unsigned char *)(uintptr_t)scene.voxels;
    cast->labels = true;
    for (int i = 0; i < 512; i++)
        voxels[i] = (unsigned char)(1 + (i + i / 8 + i / 64) % 2 * 2);
    scene.info.slope = 1;
    scene.colors = names;
    scene.color_count = 4;
    scene.opacities = opaque;
    scene.opacity_count = 1;
    scene.settings.method = SNOW_METHOD_RAYCAST;
    scene.settings.kernel = SNOW_KERNEL_TENT;
    scene.settings.shade = SNOW_SHADE_NONE;
    scene.view.width = scene.view.height = 9; /* a pixel is a voxel wide */
    model_turn(&scene, n * 180, 0, 0, 2 * 4 * sqrt(3) / 9);
    return scene;
}

static void pictures_equal_the_references(void **state) {
    static const struct {
        const char *name;
        reference_scene (*make)(int n, reference_cast *cast);
        int count;
        size_t one_of; /* support_takes */
        double bound;
    } sweeps[] = {
        {"types", types, MODEL_TYPES, 3, BOUND},
        {"placements", placements_and_views, 6 * MODEL_MATRICES, 7, BOUND},
        {"qualities", qualities_and_kernels, 6, 1, BOUND},
        {"lights", lights, 8, 3, BOUND},
        {"thresholds", thresholds_gradients_logarithms, 8, 3, BOUND},
        {"modes", modes, 20, 3, 2e-5},
        {"holes", holes, 2 * (SNOW_MODE_ISO + 1), 5, 2e-5},
        {"infinities", infinities, 2, 1, BOUND},
        {"thin", axes_of_one_and_two_voxels, 12, 5, BOUND},
        {"empty space", empty_space, 2 * (SNOW_MODE_ISO + 1), 5, 2e-5},
        {"planes", planes_between_voxels, 6, 1, 2e-5},
        {"a draft", draft_of_few_pixels, 1, 1, BOUND},
        {"labels", labels, 4, 1, BOUND},
        {"equal labels", equal_shares_of_labels, 2, 1, BOUND},
    };
    model_stage *stage = *state;
    for (size_t s = 0; s < sizeof sweeps / sizeof *sweeps; s++)
        for (int n = 0; n < sweeps[s].count; n++) {
            if (!support_takes((size_t)n, sweeps[s].one_of))
                continue;
            reference_cast cast = {.planes = none};
            reference_scene scene = sweeps[s].make(n, &cast);
            bool values = scene.settings.mode == SNOW_MODE_MEAN ||
                          scene.settings.mode == SNOW_MODE_SUM;
            cast.scene = &scene;
            /* Values up to some 1000, in float. */
            check_cast(stage, &cast, values ? 2e-3 : sweeps[s].bound);
            model_free(&scene);
        }
}

/* Moves a scene's voxels on, so that it has other values in each place. */
static void turn_values(reference_scene *scene, int by) {
    const int64_t *dims = scene->info.dims;
    size_t size = snow_type_size(scene->info.type);
    size_t bytes = (size_t)(dims[0] * dims[1] * dims[2]) * size;
    size_t first = (size_t)by * size;
    char *from = malloc(bytes), *to = (char *)(uintptr_t)scene->voxels;
    assert_non_null(from);
    memcpy(from, to, bytes);
    memcpy(to, from + first, bytes - first);
    memcpy(to + bytes - first, from, first);
    free(from);
}

/* Up to four, each with data and colours of its own. */
static void channels_are_mixed(void **state) {
    static const snow_color_point colors[][2] = {{{0, 0, 0, 0}, {100, 1, 0, 1}},
                                                 {{0, 0, 0, 0}, {100, 0, 1, 0}},
                                                 {{0, 0, 0, 0}, {100, 1, 1, 1}},
                                                 {{0, 0, 0, 0}, {90, 0, 1, 1}}};
    static const snow_opacity_point opacities[][2] = {
        {{20, 0}, {100, 0.7}}, {{50, 0}, {80, 1}}, {{0, 0.1}, {90, 0.4}}};
    model_stage *stage = *state;
    for (int n = 0; n < 12; n++) {
        reference_scene scenes[4];
        reference_cast casts[4];
        for (int i = 3; i >= 0; i--) {
            scenes[i] = scene_of(i % 2 ? SNOW_TYPE_INT16 : SNOW_TYPE_FLOAT32,
                                 false, n % 2 ? MODEL_OBLIQUE : MODEL_PLAIN);
            turn_values(&scenes[i], 7 * i + n);
            scenes[i].view.fov = n % 3 == 1 ? 40 : 0;
            scenes[i].settings.shade =
                n % 4 < 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
            scenes[i].colors = colors[i];
            scenes[i].color_count = 2;
            scenes[i].opacities = opacities[(i + n) % 3];
            scenes[i].opacity_count = 2;
            casts[i] =
                (reference_cast){.scene = &scenes[i],
                                 .planes = none,
                                 .next = i < 1 + n % 3 ? &casts[i + 1] : NULL};
        }
        check_cast(stage, &casts[0], BOUND);
        for (int i = 0; i < 4; i++)
            model_free(&scenes[i]);
    }
}

/* --- planes --------------------------------------------------------------- */

/* A volume that was cut by one plane and then by another is cut by both. */
static void planes_after_planes(void **state) {
    model_stage *stage = *state;
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_ANISOTROPIC);
    const reference_cast first = {
        .scene = &scene, .planes = planes, .plane_count = 1};
    const reference_cast both = {
        .scene = &scene, .planes = planes, .plane_count = 2};
    snow_volume *once = open_cut(stage->context, &first), *twice = NULL;
    assert_int_equal(snow_volume_clip(once, planes[1], 1, &twice),
                     SNOW_STATUS_OK);
    snow_transfer *transfer = model_transfer(stage->context, &scene);
    snow_image *image = NULL, *should = render(stage, &both);
    assert_int_equal(snow_frame_render(stage->frame, twice, transfer,
                                       &scene.view, &scene.settings, &image),
                     SNOW_STATUS_OK);
    assert_memory_equal(snow_image_pixels(image), snow_image_pixels(should),
                        WIDTH * HEIGHT * 4 * sizeof(float));
    snow_image_free(image);
    snow_image_free(should);
    snow_transfer_free(transfer);
    snow_volume_close(once);
    snow_volume_close(twice);
    model_free(&scene);
}

/* --- what can be computed by hand ----------------------------------------- */

/* The opacity in the middle of a block of one opacity. */
static double block_alpha(const model_stage *stage, reference_scene *scene,
                          double azimuth) {
    int middle =
        scene->view.height / 2 * scene->view.width + scene->view.width / 2;
    model_turn(scene, azimuth, 0, 0, 1);
    float *picture = model_picture(stage, scene);
    double alpha = (double)picture[4 * middle + 3];
    free(picture);
    return alpha;
}

/* 1 - (1 - a)^(length / reference length), of any step and at any angle. */
static void opacity_is_that_of_the_length(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){15, 15, 9}, 0.2);
    for (int n = 0; n < 15 * 15 * 9; n++)
        model_voxels(&scene)[n] = 1;
    scene.settings.method = SNOW_METHOD_RAYCAST;
    for (int quality = 0; quality < 3; quality++) {
        scene.settings.quality = (snow_quality)quality;
        for (int degrees = 0; degrees <= 30; degrees += 10)
            assert_near(block_alpha(stage, &scene, degrees),
                        1 - pow(0.8, 8 / cos(degrees * acos(-1.0) / 180)),
                        1e-6);
    }
    scene.settings.opacity_length = 4;
    assert_near(block_alpha(stage, &scene, 0), 1 - pow(0.8, 2), 1e-6);
    model_free(&scene);
}

/* Values that are linear in x: mean, sum, largest and surface are known. */
static void a_ramp_is_a_ramp(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){17, 9, 9}, 1);
    const snow_color_point colors[] = {{0, 0, 0, 0}, {16, 1, 1, 1}};
    scene.colors = colors;
    scene.color_count = 2;
    for (int n = 0; n < 17 * 9 * 9; n++)
        model_voxels(&scene)[n] = (float)(n % 17);
    scene.settings.method = SNOW_METHOD_RAYCAST;
    scene.settings.depth = 0;
    model_look(&scene, (double[]){1, 0, 0}, (double[]){0, 0, 1});
    scene.view.width = scene.view.height = 3;
    scene.view.zoom = 8;
    static const double known[][2] = {{SNOW_MODE_MIP, 1},
                                      {SNOW_MODE_MINIP, 0},
                                      {SNOW_MODE_MEAN, 8},
                                      {SNOW_MODE_SUM, 16 * 8}};
    for (size_t n = 0; n < 4; n++) {
        scene.settings.mode = (snow_mode)known[n][0];
        snow_image *image = model_image(stage, &scene);
        int channels = snow_image_channels(image);
        assert_near((double)snow_image_pixels(image)[4 * channels], known[n][1],
                    1e-5);
        snow_image_free(image);
    }
    scene.settings.mode = SNOW_MODE_ISO;
    scene.settings.iso = 11.3;
    scene.settings.depth = 1;
    snow_image_free(model_image(stage, &scene));
    /* The value falls from the camera's side; all that is seen is the end. */
    assert_near((double)snow_image_pixels(
                    (snow_image *)(uintptr_t)snow_frame_depth(stage->frame))[4],
                8 - 16, 1e-5);
    model_look(&scene, (double[]){-1, 0, 0}, (double[]){0, 0, 1});
    snow_image_free(model_image(stage, &scene));
    assert_near((double)snow_image_pixels(
                    (snow_image *)(uintptr_t)snow_frame_depth(stage->frame))[4],
                11.3 - 8, 1e-5);
    model_free(&scene);
}

/* A ball of a value that falls off linearly, and a look that is a step: its
 * outline is a circle, and its depths are a sphere's. */
static void a_hard_sphere_is_round(void **state) {
    model_stage *stage = *state;
    const double center[3] = {23.5, 23.8, 23.3}, radius = 17;
    reference_scene scene = model_blank((int64_t[]){48, 48, 48}, 1);
    for (int n = 0; n < 48 * 48 * 48; n++)
        model_voxels(&scene)[n] =
            (float)(radius + 0.5 -
                    hypot(hypot(n % 48 - center[0], n / 48 % 48 - center[1]),
                          n / 48 / 48 - center[2]));
    scene.settings.method = SNOW_METHOD_RAYCAST;
    scene.settings.quality = SNOW_QUALITY_HIGH;
    scene.settings.depth = 1;
    scene.view.width = scene.view.height = 96;
    model_turn(&scene, 20, 25, 0, 1.6);
    float *picture = model_picture(stage, &scene);
    const float *depth = snow_image_pixels(
        (snow_image *)(uintptr_t)snow_frame_depth(stage->frame));
    reference_camera camera;
    reference_camera_of(&scene, &camera);
    double at[2], behind = 0, area = 0, far = 0;
    reference_project(&scene, &camera, center, at);
    for (int n = 0; n < 3; n++)
        behind -= (center[n] - 23.5) * camera.back[n];
    for (int n = 0; n < 96 * 96; n++) {
        double across =
            camera.pitch * hypot(n % 96 + 0.5 - at[0], n / 96 + 0.5 - at[1]);
        area += (double)picture[4 * n + 3] * camera.pitch * camera.pitch;
        if (across < 0.8 * radius)
            far = fmax(far, fabs((double)depth[n] - behind +
                                 sqrt(radius * radius - across * across)));
    }
    print_message("             radius %.3f of %g, depths within %.3f\n",
                  sqrt(area / acos(-1.0)), radius, far);
    assert_near(sqrt(area / acos(-1.0)), radius, 0.05);
    assert_true(far < 0.06);
    free(picture);
    model_free(&scene);
}

/* The value of voxel (x, y, z) goes to (y, -x, z): the data turns by 90 degrees
 * about z, as the camera does. */
static void turned_data_look_like_a_turned_camera(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_scene((int64_t[]){13, 13, 13},
                                        SNOW_TYPE_UINT8, false, MODEL_PLAIN, 9);
    unsigned char *voxels = (unsigned char *)(uintptr_t)scene.voxels;
    unsigned char turned[13 * 13 * 13];
    scene.settings.method = SNOW_METHOD_RAYCAST;
    model_look(&scene, (double[]){1, 0, 0}, (double[]){0, 0, 1});
    model_turn(&scene, 27, 18, 0, 1.1);
    float *first = model_picture(stage, &scene);
    for (int n = 0; n < 13 * 13 * 13; n++) {
        int x = n % 13, y = n / 13 % 13, z = n / 169;
        turned[z * 169 + x * 13 + (12 - y)] = voxels[n];
    }
    memcpy(voxels, turned, sizeof turned);
    model_look(&scene, (double[]){0, 1, 0}, (double[]){0, 0, 1});
    float *second = model_picture(stage, &scene);
    double most = 0;
    for (int n = 0; n < 64 * 48 * 4; n++)
        most = fmax(most, fabs((double)(first[n] - second[n])));
    assert_true(most < 1e-6);
    free(first);
    free(second);
    model_free(&scene);
}

/* What the picture of another quality is to the finest one. */
static void finer_steps_converge(void **state) {
    model_stage *stage = *state;
    double off[3];
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_PLAIN);
    scene.settings.quality = SNOW_QUALITY_HIGH;
    float *finest = model_picture(stage, &scene);
    for (int quality = 0; quality < 3; quality++) {
        scene.settings.quality = (snow_quality)quality;
        float *picture = model_picture(stage, &scene);
        off[quality] = 0;
        for (int n = 0; n < WIDTH * HEIGHT * 4; n++)
            off[quality] += fabs((double)(picture[n] - finest[n]));
        free(picture);
    }
    assert_true(off[SNOW_QUALITY_NORMAL] < 0.7 * off[SNOW_QUALITY_DRAFT]);
    assert_true(off[SNOW_QUALITY_NORMAL] / (WIDTH * HEIGHT * 4) < 0.01);
    free(finest);
    model_free(&scene);
}

/* --- the same bits -------------------------------------------------------- */

static void threads_and_instruction_sets_change_nothing(void **state) {
    static const int threads[] = {1, 2, 3, 7};
    model_stage *stage = *state;
    for (int mode = SNOW_MODE_OVER; mode <= SNOW_MODE_ISO; mode++) {
        reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_OBLIQUE);
        snow_image *first = NULL;
        scene.settings.mode = (snow_mode)mode;
        scene.settings.iso = 71;
        for (size_t n = 0; n < 5; n++) {
            scene.settings.threads = threads[n % 4];
            scene.settings.isa = n == 4 ? SNOW_ISA_SCALAR : SNOW_ISA_AUTO;
            scene.settings.deterministic = n == 3;
            snow_image *image = model_image(stage, &scene);
            size_t bytes = WIDTH * HEIGHT * sizeof(float) *
                           (size_t)snow_image_channels(image);
            if (!first)
                first = image;
            assert_memory_equal(snow_image_pixels(image),
                                snow_image_pixels(first), bytes);
            if (image != first)
                snow_image_free(image);
        }
        assert_int_equal(snow_frame_stats(stage->frame)->method,
                         SNOW_METHOD_RAYCAST);
        snow_image_free(first);
        model_free(&scene);
    }
}

/* --- ranks, and refusals -------------------------------------------------- */

static void other_kernels_are_refused(void **state) {
    static const struct {
        snow_kernel kernel;
        int footprint;
    } wrong[] = {{SNOW_KERNEL_GAUSS, 0},
                 {SNOW_KERNEL_BOX, 0},
                 {SNOW_KERNEL_TENT, 3},
                 {SNOW_KERNEL_BSPLINE, 3}};
    model_stage *stage = *state;
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_PLAIN);
    for (size_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
        scene.settings.kernel = wrong[n].kernel;
        scene.settings.footprint = wrong[n].footprint;
        model_refused(stage, &scene, "for method raycast");
    }
    model_free(&scene);
}

/* One rank is one process. */
static void one_rank_makes_the_same_picture(void **state) {
    model_stage *stage = *state;
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_PLAIN);
    snow_volume *volume = model_volume(stage->context, &scene);
    snow_transfer *transfer = model_transfer(stage->context, &scene);
    snow_comm *comm = NULL;
    assert_int_equal(snow_comm_new_self(stage->context, &comm), SNOW_STATUS_OK);
    for (int mode = SNOW_MODE_OVER; mode <= SNOW_MODE_ISO; mode++) {
        scene.settings.mode = (snow_mode)mode;
        snow_image *image = NULL, *should = model_image(stage, &scene);
        assert_int_equal(snow_ranks_render(stage->frame, comm, volume, transfer,
                                           &scene.view, &scene.settings, NULL,
                                           &image),
                         SNOW_STATUS_OK);
        assert_memory_equal(snow_image_pixels(image), snow_image_pixels(should),
                            WIDTH * HEIGHT * sizeof(float) *
                                (size_t)snow_image_channels(image));
        snow_image_free(image);
        snow_image_free(should);
    }
    snow_frame_free(stage->frame);
    stage->frame = NULL;
    snow_comm_free(comm);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    model_free(&scene);
}

/* What a rank does: its half of the slices. */
static snow_status render_half(snow_comm *comm, void *user) {
    const reference_scene *scene = user;
    snow_context *context = snow_comm_context(comm);
    int64_t first = snow_comm_rank(comm) ? 5 : 0;
    const snow_extent part = {sizeof part,
                              {14, 11, 9},
                              {0, 0, 0},
                              {0, 0, first},
                              {14, 11, snow_comm_rank(comm) ? 4 : 5}};
    snow_volume *volume = model_volume(context, scene);
    snow_transfer *transfer = model_transfer(context, scene);
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    snow_status status = snow_volume_set_extent(volume, &part);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(context, &frame);
    if (status == SNOW_STATUS_OK)
        status = snow_ranks_render(frame, comm, volume, transfer, &scene->view,
                                   &scene->settings, NULL, &image);
    snow_image_free(image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static void a_part_of_a_volume_is_refused(void **state) {
    model_stage *stage = *state;
    reference_scene scene = scene_of(SNOW_TYPE_UINT8, false, MODEL_PLAIN);
    for (int mode = SNOW_MODE_OVER; mode < SNOW_MODE_ISO; mode++) {
        scene.settings.mode = (snow_mode)mode;
        assert_int_equal(
            snow_comm_run_threads(stage->context, 2, render_half, &scene),
            SNOW_STATUS_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(stage->context),
                               "method raycast needs the whole volume in one"));
    }
    model_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(pictures_equal_the_references),
        MODEL_TEST(channels_are_mixed),
        MODEL_TEST(planes_after_planes),
        MODEL_TEST(opacity_is_that_of_the_length),
        MODEL_TEST(a_ramp_is_a_ramp),
        MODEL_TEST(a_hard_sphere_is_round),
        MODEL_TEST(turned_data_look_like_a_turned_camera),
        MODEL_TEST(finer_steps_converge),
        MODEL_TEST(threads_and_instruction_sets_change_nothing),
        MODEL_TEST(other_kernels_are_refused),
        MODEL_TEST(one_rank_makes_the_same_picture),
        MODEL_TEST(a_part_of_a_volume_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
