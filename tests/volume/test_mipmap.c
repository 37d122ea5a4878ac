/* tests/volume/test_mipmap.c - levels of a volume for small pictures: their
 * voxels against means in float64, their pictures against the sheared model of
 * those voxels, and when one is taken. */
#include <math.h>

#include "reference/shear_warp.h"

#include "render/mipmap.h"
#include "volume/downsample.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* --- voxels --------------------------------------------------------------- */

/* What of voxel `at` of `from` the voxel `to` of `count` covers, 0 to 1. */
static double overlap(int64_t at, int64_t from, int64_t to, int64_t count) {
    double wide = (double)from / (double)count;
    double low = fmax((double)at, (double)to * wide);
    double high = fmin((double)at + 1, (double)(to + 1) * wide);
    return high - low > 1e-9 ? high - low : 0;
}

/* The value of one voxel of a level, unrounded: NaN where there is none. */
static double expected(const reference_scene *scene,
                       const snow_volume_info *level, const int64_t to[3],
                       int lean) {
    const int64_t *n = scene->info.dims;
    double sum = 0, total = 0, extreme = NAN;
    int64_t first[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
        double wide = (double)n[axis] / (double)level->dims[axis];
        first[axis] = (int64_t)((double)to[axis] * wide);
        last[axis] = (int64_t)fmin(ceil((double)(to[axis] + 1) * wide),
                                   (double)(n[axis] - 1));
    }
    for (int64_t k = first[2]; k <= last[2]; k++)
        for (int64_t j = first[1]; j <= last[1]; j++)
            for (int64_t i = first[0]; i <= last[0]; i++) {
                double weight = overlap(i, n[0], to[0], level->dims[0]) *
                                overlap(j, n[1], to[1], level->dims[1]) *
                                overlap(k, n[2], to[2], level->dims[2]);
                double value = reference_native(scene, i, j, k);
                if (!(weight > 0) || isnan(value))
                    continue;
                sum += weight * value;
                total += weight;
                extreme =
                    lean > 0 ? fmax(extreme, value) : fmin(extreme, value);
            }
    double mean = sum / total;
    return lean ? mean + 0.25 * (extreme - mean) : mean;
}

/* Of integers a tie may go either way where weights are not halves. */
static void check_voxels(const reference_scene *scene,
                         const reference_scene *level, bool even, int lean) {
    const int64_t *n = level->info.dims;
    bool real = level->info.type == SNOW_TYPE_FLOAT32 ||
                level->info.type == SNOW_TYPE_FLOAT64;
    for (int64_t k = 0; k < n[2]; k++)
        for (int64_t j = 0; j < n[1]; j++)
            for (int64_t i = 0; i < n[0]; i++) {
                const int64_t at[3] = {i, j, k};
                double want = expected(scene, &level->info, at, lean);
                double found = reference_native(level, i, j, k);
                double bound = 1e-6 * fmax(1, fabs(want));
                if (isnan(want) && isnan(found))
                    continue;
                if (!real && even && found == floor(want + 0.5))
                    continue;
                if (!real && !even && fabs(found - want) <= 0.5 + bound)
                    continue;
                if (!real || !(fabs(found - want) <= bound))
                    fail_msg("(%d, %d, %d) is %.9g, not %.9g", (int)i, (int)j,
                             (int)k, found, want);
            }
}

/* The scene at half the resolution; `axes` as in snow_downsampled_info.  The
 * library's voxels, which are right.  Close the volume. */
static reference_scene half_of(snow_context *context,
                               const reference_scene *scene, bool axes[3],
                               int lean, int threads, snow_volume **half) {
    snow_volume *volume = NULL;
    snow_downsample_buffers room = {0};
    reference_scene level = *scene;
    assert_int_equal(
        snow_volume_wrap(context, &scene->info, scene->voxels, &volume),
        SNOW_STATUS_OK);
    level.info = snow_downsampled_info(snow_volume_get_info(volume), axes);
    assert_int_equal(snow_volume_new(context, &level.info, half),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_volume_downsample(volume, axes, lean, threads, &room, *half),
        SNOW_STATUS_OK);
    level.voxels = snow_volume_voxels(*half);
    bool even = true;
    for (int axis = 0; axis < 3; axis++)
        even = even && (!axes[axis] || scene->info.dims[axis] % 2 == 0);
    check_voxels(scene, &level, even, lean);
    snow_release(context, room.block);
    snow_volume_close(volume);
    return level;
}

static const int64_t sizes[][3] = {{8, 6, 4},   {7, 6, 4},  {8, 5, 4},
                                   {6, 8, 9},   {5, 7, 11}, {33, 34, 21},
                                   {1, 40, 17}, {64, 3, 1}, {130, 5, 6}};

static void voxels_are_means_that_lean(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++)
        for (size_t n = 0; n < COUNT(sizes); n++)
            for (int asked = 1; asked < 8; asked++) {
                bool axes[3] = {asked & 1, asked & 2, asked & 4};
                snow_volume *half = NULL;
                reference_scene scene = model_scene(sizes[n], (snow_type)type,
                                                    false, MODEL_PLAIN, 7 + n);
                half_of(stage.context, &scene, axes, asked % 3 - 1,
                        1 + asked % 4, &half);
                snow_volume_close(half);
                model_free(&scene);
            }
    model_close(&stage);
}

/* A part of a volume, as snow_volume_set_extent has it: the voxels of `box` and
 * so many layers more.  Its voxels are to be freed. */
static snow_volume *part_of(snow_context *context, const snow_volume *whole,
                            const snow_extent *box, const int64_t layers[3],
                            void **voxels) {
    snow_extent part = *box;
    size_t size = snow_type_size(whole->info.type);
    int64_t count[3], at = 0;
    for (int axis = 0; axis < 3; axis++) {
        int64_t low = box->first[axis] - layers[axis];
        int64_t end = box->first[axis] + box->count[axis] + layers[axis];
        part.stored[axis] = low > 0 ? low : 0;
        end = end < part.dims[axis] ? end : part.dims[axis];
        count[axis] = end - part.stored[axis];
    }
    snow_volume_info info =
        snow_volume_info_of_box(&whole->info, part.stored, count);
    *voxels = malloc((size_t)(count[0] * count[1] * count[2]) * size);
    assert_non_null(*voxels);
    for (int64_t k = 0; k < count[2]; k++)
        for (int64_t j = 0; j < count[1]; j++, at += count[0])
            memcpy((char *)*voxels + (size_t)at * size,
                   (const char *)whole->voxels +
                       (size_t)(((part.stored[2] + k) * part.dims[1] +
                                 part.stored[1] + j) *
                                    part.dims[0] +
                                part.stored[0]) *
                           size,
                   (size_t)count[0] * size);
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_wrap(context, &info, *voxels, &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_volume_set_extent(volume, &part), SNOW_STATUS_OK);
    return volume;
}

/* The part of `half` that is made of a part, whose own voxels it counts: to the
 * bit, and with as many ghosts as were asked for. */
static int64_t check_part_of(snow_context *context, const snow_volume *volume,
                             const snow_volume *half, const bool axes[3],
                             const int64_t ghosts[3], int lean) {
    snow_extent part = {.size = sizeof part};
    int64_t stored[3];
    snow_volume *made = NULL;
    snow_downsample_buffers room = {0};
    size_t size = snow_type_size(half->info.type);
    if (!snow_downsampled_part(volume, half->info.dims, &part, stored)) {
        assert_int_equal(stored[0] * stored[1] * stored[2], 1);
        return 0;
    }
    for (int axis = 0; axis < 3; axis++) {
        int64_t below = part.first[axis] - part.stored[axis];
        int64_t above = stored[axis] - below - part.count[axis];
        bool end = part.stored[axis] + stored[axis] == part.dims[axis];
        assert_true(below >= ghosts[axis] || part.stored[axis] == 0);
        assert_true(above >= ghosts[axis] || end);
    }
    snow_volume_info info =
        snow_volume_info_of_box(&half->info, part.stored, stored);
    assert_int_equal(snow_volume_new(context, &info, &made), SNOW_STATUS_OK);
    assert_int_equal(snow_volume_set_extent(made, &part), SNOW_STATUS_OK);
    assert_int_equal(snow_volume_downsample(volume, axes, lean, 2, &room, made),
                     SNOW_STATUS_OK);
    for (int64_t k = 0; k < stored[2]; k++)
        for (int64_t j = 0; j < stored[1]; j++) {
            int64_t at =
                ((part.stored[2] + k) * part.dims[1] + part.stored[1] + j) *
                    part.dims[0] +
                part.stored[0];
            assert_memory_equal((const char *)made->voxels +
                                    (size_t)((k * stored[1] + j) * stored[0]) *
                                        size,
                                (const char *)half->voxels + (size_t)at * size,
                                (size_t)stored[0] * size);
        }
    snow_release(context, room.block);
    snow_volume_close(made);
    return part.count[0] * part.count[1] * part.count[2];
}

/* Borders at random, so many along each axis. */
static void cut_at_random(int64_t dims, int parts, uint64_t *random,
                          int64_t borders[4]) {
    borders[0] = 0;
    for (int n = 1; n < parts; n++) {
        int64_t left = dims - borders[n - 1];
        borders[n] = borders[n - 1] +
                     (int64_t)(support_random(random) % (uint64_t)(left + 1));
    }
    borders[parts] = dims;
}

static void parts_have_the_voxels_of_the_whole_level(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 3;
    for (int n = 0; n < 120; n += (int)support_stride(7)) {
        const int64_t *dims = sizes[(size_t)n % COUNT(sizes)];
        snow_type type = (snow_type)(SNOW_TYPE_INT8 + n % 10);
        int lean = n % 3 - 1, parts = 1 + n % 3;
        bool axes[3] = {(n + 1) % 8 & 1, (n + 1) % 8 & 2, (n + 1) % 8 & 4};
        snow_volume *half = NULL, *whole = NULL;
        reference_scene scene = model_scene(
            dims, type, false, (model_matrix)(n % MODEL_MATRICES), (uint64_t)n);
        half_of(stage.context, &scene, axes, lean, 1, &half);
        assert_int_equal(
            snow_volume_wrap(stage.context, &scene.info, scene.voxels, &whole),
            SNOW_STATUS_OK);
        int64_t borders[3][4], ghosts[3], layers[3], owned = 0;
        for (int axis = 0; axis < 3; axis++) {
            cut_at_random(dims[axis], parts, &random, borders[axis]);
            ghosts[axis] = n / 3 % 3;
            layers[axis] =
                axes[axis] ? snow_downsampled_layers(dims[axis], ghosts[axis])
                           : ghosts[axis];
        }
        for (int id = 0; id < parts * parts * parts; id++) {
            const int at[3] = {id % parts, id / parts % parts,
                               id / parts / parts};
            snow_extent part = {.size = sizeof part,
                                .dims = {dims[0], dims[1], dims[2]}};
            bool none = false;
            for (int axis = 0; axis < 3; axis++) {
                part.first[axis] = borders[axis][at[axis]];
                part.count[axis] =
                    borders[axis][at[axis] + 1] - part.first[axis];
                none = none || part.count[axis] == 0;
            }
            if (none)
                continue;
            void *voxels = NULL;
            snow_volume *volume =
                part_of(stage.context, whole, &part, layers, &voxels);
            owned +=
                check_part_of(stage.context, volume, half, axes, ghosts, lean);
            snow_volume_close(volume);
            free(voxels);
        }
        const int64_t *all = half->info.dims;
        assert_int_equal(owned, all[0] * all[1] * all[2]);
        snow_volume_close(half);
        snow_volume_close(whole);
        model_free(&scene);
    }
    model_close(&stage);
}

/* Sums must not overflow, and negative halves are rounded up. */
static void extreme_values_are_kept(void **state) {
    (void)state;
    model_stage stage = model_open();
    static const snow_type types[] = {SNOW_TYPE_INT8, SNOW_TYPE_UINT8,
                                      SNOW_TYPE_INT16, SNOW_TYPE_UINT16};
    for (size_t n = 0; n < COUNT(types); n++)
        for (int kind = 0; kind < 3; kind++)
            for (int lean = -1; lean < 2; lean++) {
                const int64_t dims[3] = {32, 6, 4};
                bool axes[3] = {true, true, true};
                snow_volume *half = NULL;
                uint8_t bytes[2 * 32 * 6 * 4];
                uint64_t random = 5;
                reference_scene scene =
                    model_scene(dims, types[n], false, MODEL_PLAIN, 1);
                for (size_t i = 0; i < sizeof bytes; i++)
                    bytes[i] = kind == 0   ? 0xff
                               : kind == 1 ? (i % 2 || n < 2 ? 0x80 : 0)
                                           : (uint8_t)support_random(&random);
                const void *own = scene.voxels;
                scene.voxels = bytes;
                half_of(stage.context, &scene, axes, lean, 2, &half);
                snow_volume_close(half);
                scene.voxels = own;
                model_free(&scene);
            }
    model_close(&stage);
}

static void what_is_no_number_has_no_weight(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (size_t n = 0; n < COUNT(sizes); n++)
        for (int lean = -1; lean < 2; lean++) {
            bool axes[3] = {true, true, true};
            uint64_t random = 3 + n;
            int64_t count = sizes[n][0] * sizes[n][1] * sizes[n][2];
            snow_volume *half = NULL;
            reference_scene scene =
                model_scene(sizes[n], SNOW_TYPE_FLOAT32, false, MODEL_PLAIN, 2);
            float *voxels = malloc((size_t)count * sizeof *voxels);
            assert_non_null(voxels);
            for (int64_t i = 0; i < count; i++)
                voxels[i] = support_uniform(&random) < 0.7
                                ? NAN
                                : ((const float *)scene.voxels)[i];
            const void *own = scene.voxels;
            scene.voxels = voxels;
            half_of(stage.context, &scene, axes, lean, 1, &half);
            snow_volume_close(half);
            free(voxels);
            scene.voxels = own;
            model_free(&scene);
        }
    model_close(&stage);
}

/* The box of all voxels: corners in the world. */
static void corner(const snow_volume_info *info, int which, double out[3]) {
    for (int row = 0; row < 3; row++) {
        out[row] = info->matrix[row][3];
        for (int axis = 0; axis < 3; axis++) {
            double at =
                which >> axis & 1 ? (double)info->dims[axis] - 0.5 : -0.5;
            out[row] += info->matrix[row][axis] * at;
        }
    }
}

static void a_level_fills_the_box_of_its_volume(void **state) {
    (void)state;
    for (size_t n = 0; n < COUNT(sizes); n++)
        for (int matrix = 0; matrix < MODEL_MATRICES; matrix++) {
            reference_scene scene = model_scene(sizes[n], SNOW_TYPE_UINT8,
                                                false, (model_matrix)matrix, 1);
            bool axes[3] = {true, true, true};
            snow_volume_info level = snow_downsampled_info(&scene.info, axes);
            for (int which = 0; which < 8; which++) {
                double a[3], b[3];
                corner(&scene.info, which, a);
                corner(&level, which, b);
                for (int row = 0; row < 3; row++)
                    assert_near(a[row], b[row], 1e-9);
            }
            for (int axis = 0; axis < 3; axis++) {
                int64_t count = sizes[n][axis];
                assert_int_equal(axes[axis], count >= 4);
                assert_int_equal(level.dims[axis],
                                 count >= 4 ? (count + 1) / 2 : count);
            }
            model_free(&scene);
        }
}

/* --- pictures ------------------------------------------------------------- */

static const snow_color_point smooth[] = {
    {0, 0.9, 0.3, 0.1}, {50, 0.2, 0.8, 0.5}, {100, 1, 0.9, 0.4}};
static const snow_opacity_point rising[] = {{20, 0}, {90, 0.3}};
static const snow_opacity_point falling[] = {{20, 0.3}, {80, 0}};
static const snow_opacity_point peak[] = {{20, 0}, {50, 0.4}, {80, 0}};

static const struct {
    const snow_opacity_point *points;
    size_t count;
} looks[] = {
    {rising, COUNT(rising)}, {falling, COUNT(falling)}, {peak, COUNT(peak)}};

/* How often each axis is halved, by the rule. */
static void rule(const reference_scene *scene, int halvings[3]) {
    reference_camera camera;
    reference_camera_of(scene, &camera);
    int64_t n[3];
    double wide[3], near = 1;
    if (camera.distance > 0)
        near -= camera.radius / camera.distance;
    for (int axis = 0; axis < 3; axis++) {
        double square = 0;
        for (int row = 0; row < 3; row++)
            square += pow(scene->info.matrix[row][axis], 2);
        wide[axis] = camera.pitch * near / sqrt(square) * (1 + 1e-9);
        n[axis] = scene->info.dims[axis];
        halvings[axis] = 0;
        if (wide[axis] >= 2 && n[axis] >= 4) {
            halvings[axis] = 1;
            wide[axis] /= 2;
            n[axis] = (n[axis] + 1) / 2;
        }
    }
    for (bool again = true; again;) {
        bool many = n[0] * n[1] * n[2] > 128 * 128 * 128;
        again = false;
        for (int axis = 0; axis < 3; axis++)
            if (many && wide[axis] >= 4 && n[axis] >= 4) {
                halvings[axis]++;
                wide[axis] /= 2;
                n[axis] = (n[axis] + 1) / 2;
                again = true;
            }
    }
}

/* The level of the rule, its own options filled; close all volumes. */
static reference_scene level_of(snow_context *context,
                                const reference_scene *scene,
                                sheared_options *options,
                                snow_volume *made[8]) {
    reference_scene level = *scene;
    int halvings[3], most = 0;
    rule(scene, halvings);
    for (int axis = 0; axis < 3; axis++)
        most = halvings[axis] > most ? halvings[axis] : most;
    level.settings.opacity_length = reference_opacity_length(scene);
    for (int n = 0; n < most; n++) {
        bool axes[3];
        for (int axis = 0; axis < 3; axis++)
            axes[axis] = halvings[axis] >= most - n;
        level =
            half_of(context, &level, axes, sheared_lean(scene), 1, &made[n]);
    }
    for (int axis = 0; axis < 3; axis++)
        options->fine[axis] = most ? (double)level.info.dims[axis] /
                                         (double)scene->info.dims[axis]
                                   : 0;
    return level;
}

static double farthest(const reference_scene *scene, const float *picture,
                       const double *reference, double *strongest) {
    int count = scene->view.width * scene->view.height;
    double most = 0;
    for (int n = 0; n < 4 * count; n++) {
        double gap = fabs((double)picture[n] - reference[n]);
        most = gap <= most ? most : gap;
        if (n % 4 == 3)
            *strongest = fmax(*strongest, reference[n]);
    }
    return most;
}

/* Against the sheared model of the level, with the camera of the volume. */
static double check_picture(const model_stage *stage,
                            const reference_scene *scene, double *strongest) {
    sheared_options options = {0};
    sheared_facts facts;
    snow_volume *made[8] = {NULL};
    int halvings[3];
    rule(scene, halvings);
    reference_scene level = level_of(stage->context, scene, &options, made);
    double *reference = sheared_render(&level, &options, &facts);
    float *picture = model_picture(stage, scene);
    const snow_stats *stats = snow_frame_stats(stage->frame);
    assert_memory_equal(stats->halvings, halvings, sizeof halvings);
    assert_int_equal(stats->method, SNOW_METHOD_SHEAR_WARP);
    assert_int_equal(stats->voxels, level.info.dims[0] * level.info.dims[1] *
                                        level.info.dims[2]);
    double most = farthest(scene, picture, reference, strongest);
    bool opaque = facts.strongest > 1 - 0.5 / 255 - 1e-4;
    if (!(most <= (opaque ? SHEARED_BOUND_OPAQUE : SHEARED_BOUND)))
        fail_msg("differs by %g, halved %d %d %d, strongest %g: %s", most,
                 halvings[0], halvings[1], halvings[2], facts.strongest,
                 model_words(scene));
    for (int n = 0; n < 8; n++)
        snow_volume_close(made[n]);
    free(reference);
    free(picture);
    return most;
}

static void pictures_are_those_of_the_level(void **state) {
    (void)state;
    static const int64_t dims[][3] = {
        {24, 22, 20}, {25, 23, 19}, {40, 21, 3}, {1, 30, 26}, {48, 40, 44}};
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_UINT16, SNOW_TYPE_FLOAT32};
    model_stage stage = model_open();
    uint64_t random = 11;
    double most = 0, strongest = 0;
    int halved = 0, pictures = 0;
    for (size_t n = 0; n < 240; n += support_stride(7)) {
        size_t look = n % COUNT(looks);
        snow_type type = types[n / 3 % COUNT(types)];
        int side = 6 + (int)(support_random(&random) % 14);
        reference_scene scene =
            model_scene(dims[n % COUNT(dims)], type, false,
                        (model_matrix)(n / 5 % MODEL_MATRICES), n);
        const snow_opacity_point *own = scene.opacities;
        scene.colors = smooth;
        scene.color_count = COUNT(smooth);
        scene.opacities = looks[look].points;
        scene.opacity_count = looks[look].count;
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.settings.quality = SNOW_QUALITY_DRAFT;
        scene.settings.shade = n % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
        scene.settings.threads = 1 + (int)(n % 3);
        scene.view.width = side;
        scene.view.height = side + 3;
        model_turn(&scene, 360 * support_uniform(&random),
                   80 * support_uniform(&random) - 40, 30, 1);
        int halvings[3];
        rule(&scene, halvings);
        halved += halvings[0] + halvings[1] + halvings[2] > 0;
        double strong = 0;
        double gap = check_picture(&stage, &scene, &strong);
        most = fmax(most, gap);
        strongest += strong;
        pictures++;
        scene.opacities = own;
        model_free(&scene);
    }
    print_message("             %d pictures, %d of levels, differ by up to "
                  "%.2g; strongest opacity %.2f in the mean\n",
                  pictures, halved, most, strongest / pictures);
    assert_true(halved * 8 > pictures * 5);
    assert_true(strongest / pictures > 0.3);
    model_close(&stage);
}

/* A level of a level, where the first one has many voxels still. */
static void large_volumes_are_halved_again(void **state) {
    (void)state;
    static const int64_t dims[3] = {601, 298, 105};
    model_stage stage = model_open();
    reference_scene scene =
        model_scene(dims, SNOW_TYPE_UINT8, false, MODEL_PLAIN, 3);
    const snow_opacity_point *own = scene.opacities;
    double strongest = 0;
    scene.colors = smooth;
    scene.color_count = COUNT(smooth);
    scene.opacities = rising;
    scene.opacity_count = COUNT(rising);
    scene.settings.quality = SNOW_QUALITY_DRAFT;
    scene.settings.method = SNOW_METHOD_SHEAR_WARP;
    scene.view.width = 70;
    scene.view.height = 60;
    model_turn(&scene, 200, 25, 10, 1);
    double gap = check_picture(&stage, &scene, &strongest);
    const int *halvings = snow_frame_stats(stage.frame)->halvings;
    print_message("             halved %d %d %d: differs by up to %.2g\n",
                  halvings[0], halvings[1], halvings[2], gap);
    assert_int_equal(halvings[0], 2);
    assert_true(strongest > 0.5);
    scene.opacities = own;
    model_free(&scene);
    model_close(&stage);
}

/* --- when one is taken ---------------------------------------------------- */

/* A phantom as a scene that levels are made for. */
static reference_scene phantom_scene(snow_context *context, const char *name,
                                     const int64_t dims[3], int side,
                                     snow_volume **volume) {
    reference_scene scene = model_phantom(context, name, dims, volume);
    scene.colors = smooth;
    scene.color_count = COUNT(smooth);
    scene.opacities = rising;
    scene.opacity_count = COUNT(rising);
    scene.view.width = scene.view.height = side;
    scene.settings.quality = SNOW_QUALITY_DRAFT;
    return scene;
}

static void given(const model_stage *stage, const reference_scene *scene,
                  int halvings[3]) {
    snow_image_free(model_image(stage, scene));
    memcpy(halvings, snow_frame_stats(stage->frame)->halvings,
           3 * sizeof *halvings);
}

static void the_level_depends_on_the_scale_alone(void **state) {
    (void)state;
    static const int64_t dims[3] = {30, 26, 41};
    static const double zooms[] = {0.4, 0.7, 1, 1.5, 2.5, 4};
    model_stage stage = model_open();
    snow_volume *volume = NULL;
    reference_scene scene =
        phantom_scene(stage.context, "shells", dims, 24, &volume);
    int kinds = 0, last = -1;
    for (int perspective = 0; perspective < 2; perspective++)
        for (size_t z = 0; z < COUNT(zooms); z++) {
            int first[3] = {0};
            for (int turn = 0; turn < 24; turn++) {
                int halvings[3], by_rule[3];
                scene.view.fov = perspective ? 30 : 0;
                model_turn(&scene, 15 * turn, 7 * (turn % 9) - 30, turn,
                           zooms[z]);
                given(&stage, &scene, halvings);
                rule(&scene, by_rule);
                if (turn == 0)
                    memcpy(first, halvings, sizeof first);
                assert_memory_equal(halvings, first, sizeof first);
                assert_memory_equal(halvings, by_rule, sizeof first);
            }
            kinds += first[0] != last;
            last = first[0];
        }
    assert_true(kinds >= 4);
    snow_volume_close(volume);
    model_close(&stage);
}

static void no_level(const model_stage *stage, const reference_scene *scene) {
    int halvings[3] = {1, 1, 1};
    const int none[3] = {0};
    given(stage, scene, halvings);
    assert_memory_equal(halvings, none, sizeof none);
}

static void others_are_made_of_the_volume_itself(void **state) {
    (void)state;
    static const int64_t dims[3] = {40, 40, 40};
    static const snow_color_point labels[] = {
        {0, 1, 0, 0}, {50, 1, 0, 0}, {50, 0, 1, 0}, {100, 0, 1, 0}};
    model_stage stage = model_open();
    snow_volume *volume = NULL;
    int halvings[3];
    const reference_scene scene =
        phantom_scene(stage.context, "shells", dims, 20, &volume);
    given(&stage, &scene, halvings);
    assert_int_equal(halvings[0], 1);
    reference_scene other = scene;
    other.settings.quality = SNOW_QUALITY_NORMAL;
    no_level(&stage, &other);
    other.settings.quality = SNOW_QUALITY_HIGH;
    no_level(&stage, &other);
    other = scene;
    other.settings.method = SNOW_METHOD_FOOTPRINT;
    no_level(&stage, &other);
    other = scene;
    other.settings.mode = SNOW_MODE_MIP;
    no_level(&stage, &other);
    other = scene;
    other.settings.deterministic = 1;
    no_level(&stage, &other);
    other = scene;
    other.colors = labels;
    other.color_count = COUNT(labels);
    no_level(&stage, &other);
    snow_volume_close(volume);
    model_close(&stage);
}

/* --- kept ----------------------------------------------------------------- */

/* A picture of the volume itself, which a frame may know from before. */
static snow_image *image_of(const model_stage *stage, snow_frame *frame,
                            const snow_volume *volume,
                            const reference_scene *scene) {
    snow_transfer *transfer = model_transfer(stage->context, scene);
    snow_image *image = NULL;
    assert_int_equal(snow_frame_render(frame, volume, transfer, &scene->view,
                                       &scene->settings, &image),
                     SNOW_STATUS_OK);
    snow_transfer_free(transfer);
    return image;
}

/* Pictures of volumes, looks and scales in turns are those of a fresh frame. */
static void a_level_is_that_of_its_volume(void **state) {
    (void)state;
    static const int64_t dims[3] = {40, 38, 36};
    static const char *const names[] = {"shells", "head", "engine"};
    model_stage stage = model_open();
    snow_volume *volumes[COUNT(names)];
    reference_scene scenes[COUNT(names)];
    for (size_t n = 0; n < COUNT(names); n++)
        scenes[n] =
            phantom_scene(stage.context, names[n], dims, 8, &volumes[n]);
    for (size_t n = 0; n < 54; n++) {
        size_t which = n / 3 % COUNT(names), look = n / 2 % 3;
        reference_scene scene = scenes[which];
        snow_frame *fresh = NULL;
        scene.view.width = scene.view.height = 8 + 5 * (int)(n / 9 % 3);
        scene.opacities = looks[look].points;
        scene.opacity_count = looks[look].count;
        assert_int_equal(snow_frame_new(stage.context, &fresh), SNOW_STATUS_OK);
        snow_image *kept =
            image_of(&stage, stage.frame, volumes[which], &scene);
        snow_image *new = image_of(&stage, fresh, volumes[which], &scene);
        assert_memory_equal(snow_image_pixels(kept), snow_image_pixels(new),
                            (size_t)(scene.view.width * scene.view.height *
                                     snow_image_channels(new)) *
                                sizeof(float));
        snow_image_free(kept);
        snow_image_free(new);
        snow_frame_free(fresh);
    }
    for (size_t n = 0; n < COUNT(names); n++)
        snow_volume_close(volumes[n]);
    model_close(&stage);
}

typedef struct counting_allocator {
    long allocations;
    long failing; /* number of the one that fails; 0: none */
} counting_allocator;

static void *allocate_counted(void *user, size_t bytes) {
    counting_allocator *counts = user;
    counts->allocations++;
    return counts->allocations == counts->failing ? NULL : malloc(bytes);
}

static void release_counted(void *user, void *block) {
    (void)user;
    free(block);
}

/* Frozen or not: where voxels may change, levels are made again in the same
 * memory. */
static void a_second_picture_takes_no_memory(void **state) {
    (void)state;
    static const int64_t dims[3] = {40, 38, 36};
    for (int frozen = 0; frozen < 2; frozen++) {
        counting_allocator counts = {0};
        const snow_allocator allocator = {allocate_counted, release_counted,
                                          &counts};
        model_stage stage = {NULL, NULL};
        snow_volume *phantom = NULL, *volume = NULL;
        snow_transfer *transfer = NULL;
        long taken[3];
        assert_int_equal(snow_context_new(&allocator, &stage.context),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_frame_new(stage.context, &stage.frame),
                         SNOW_STATUS_OK);
        reference_scene scene =
            phantom_scene(stage.context, "shells", dims, 9, &phantom);
        scene.settings.threads = 2;
        assert_int_equal(
            snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
            SNOW_STATUS_OK);
        if (frozen)
            snow_volume_freeze(volume);
        transfer = model_transfer(stage.context, &scene);
        for (int n = 0; n < 3; n++) {
            snow_image *image = NULL;
            long before = counts.allocations;
            model_turn(&scene, 2 * n, 0, 0, 1);
            assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                               &scene.view, &scene.settings,
                                               &image),
                             SNOW_STATUS_OK);
            taken[n] = counts.allocations - before;
            assert_int_equal(snow_frame_stats(stage.frame)->halvings[0], 1);
            snow_image_free(image);
        }
        assert_true(taken[0] > taken[1]);
        assert_in_range(taken[1], 1, 2); /* the image and its pixels */
        assert_int_equal(taken[2], taken[1]);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        snow_volume_close(phantom);
        snow_frame_free(stage.frame);
        assert_int_equal(snow_context_bytes(stage.context), 0);
        snow_context_free(stage.context);
    }
}

/* Wherever memory runs out, the next picture is made as if nothing was. */
static void pictures_survive_a_lack_of_memory(void **state) {
    (void)state;
    static const int64_t dims[3] = {40, 38, 36};
    int failures = 0;
    for (long number = 1;; number++) {
        counting_allocator counts = {0};
        const snow_allocator allocator = {allocate_counted, release_counted,
                                          &counts};
        model_stage stage = {NULL, NULL};
        snow_volume *volume = NULL;
        snow_image *image = NULL;
        assert_int_equal(snow_context_new(&allocator, &stage.context),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_frame_new(stage.context, &stage.frame),
                         SNOW_STATUS_OK);
        reference_scene scene =
            phantom_scene(stage.context, "shells", dims, 9, &volume);
        snow_transfer *transfer = model_transfer(stage.context, &scene);
        counts.failing = counts.allocations + number;
        snow_status status =
            snow_frame_render(stage.frame, volume, transfer, &scene.view,
                              &scene.settings, &image);
        bool failed = status != SNOW_STATUS_OK;
        bool reached = counts.allocations >= counts.failing;
        counts.failing = 0;
        if (failed) {
            assert_int_equal(status, SNOW_STATUS_NO_MEMORY);
            assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                               &scene.view, &scene.settings,
                                               &image),
                             SNOW_STATUS_OK);
        }
        snow_image *again = image_of(&stage, stage.frame, volume, &scene);
        assert_int_equal(snow_image_checksum(image),
                         snow_image_checksum(again));
        snow_image_free(again);
        snow_image_free(image);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        snow_frame_free(stage.frame);
        assert_int_equal(snow_context_bytes(stage.context), 0);
        snow_context_free(stage.context);
        failures += failed;
        if (!reached)
            break;
    }
    assert_true(failures > 5);
}

/* --- how near ------------------------------------------------------------- */

/* Drafts against normal pictures of the same size. */
static void drafts_are_near_to_normal_pictures(void **state) {
    (void)state;
    static const int64_t dims[3] = {96, 96, 96};
    static const char *const names[] = {"shells", "head", "engine"};
    model_stage stage = model_open();
    for (size_t n = 0; n < 4 * COUNT(names); n++) {
        static const int sides[] = {72, 56, 32, 48};
        int side = sides[n % 4];
        snow_volume *volume = NULL;
        reference_scene scene =
            phantom_scene(stage.context, names[n / 4], dims, side, &volume);
        scene.view.fov = n % 4 == 3 ? 30 : 0;
        model_turn(&scene, 25, 20, 5, 1);
        float *draft = model_picture(&stage, &scene);
        assert_true(snow_frame_stats(stage.frame)->halvings[2] >= 1);
        scene.settings.quality = SNOW_QUALITY_NORMAL;
        float *normal = model_picture(&stage, &scene);
        double sum = 0;
        int count = 4 * side * side;
        for (int i = 0; i < count; i++)
            sum += pow((double)draft[i] - (double)normal[i], 2);
        double figure = 10 * log10(count / sum);
        print_message("             %s, %d pixels a side%s: %.1f dB\n",
                      names[n / 4], side, n % 4 == 3 ? ", in perspective" : "",
                      figure);
        assert_true(figure >= 30);
        free(draft);
        free(normal);
        snow_volume_close(volume);
    }
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(voxels_are_means_that_lean),
        cmocka_unit_test(parts_have_the_voxels_of_the_whole_level),
        cmocka_unit_test(extreme_values_are_kept),
        cmocka_unit_test(what_is_no_number_has_no_weight),
        cmocka_unit_test(a_level_fills_the_box_of_its_volume),
        cmocka_unit_test(pictures_are_those_of_the_level),
        cmocka_unit_test(large_volumes_are_halved_again),
        cmocka_unit_test(the_level_depends_on_the_scale_alone),
        cmocka_unit_test(others_are_made_of_the_volume_itself),
        cmocka_unit_test(a_level_is_that_of_its_volume),
        cmocka_unit_test(a_second_picture_takes_no_memory),
        cmocka_unit_test(pictures_survive_a_lack_of_memory),
        cmocka_unit_test(drafts_are_near_to_normal_pictures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
