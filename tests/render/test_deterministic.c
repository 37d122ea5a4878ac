/* tests/render/test_deterministic.c - parts of a volume: what they need of
 * their neighbours, and in which order they are seen.  That their local images
 * make up the whole picture test_ranks shows. */
#include "reference/model.h"

#include "composite/over.h"
#include "decompose/order.h"
#include "render/ghosts.h"
#include "render/job.h"
#include "render/picture.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

#include <math.h>

/* --- boxes ---------------------------------------------------------------- */

static snow_volume *small_volume(snow_context *context) {
    static const unsigned char voxels[4 * 5 * 6];
    const snow_volume_info info = {
        .size = sizeof info,
        .dims = {4, 5, 6},
        .type = SNOW_TYPE_UINT8,
        .matrix = {{2, 0, 0, 10}, {0, 3, 0, 20}, {0, 0, 4, 30}, {0, 0, 0, 1}}};
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

static void a_volume_that_is_no_part_is_the_whole(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume = small_volume(context);
    snow_extent part = {.size = sizeof part};
    snow_volume_get_extent(volume, &part);
    const snow_extent whole = {
        sizeof whole, {4, 5, 6}, {0, 0, 0}, {0, 0, 0}, {4, 5, 6}};
    assert_memory_equal(&part, &whole, sizeof part);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_part_knows_its_place_in_the_whole(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume = small_volume(context);
    const snow_extent part = {
        sizeof part, {9, 5, 20}, {3, 0, 14}, {4, 0, 15}, {2, 5, 5}};
    snow_extent given = {.size = sizeof given};
    snow_volume_info whole = {.size = sizeof whole};
    assert_int_equal(snow_volume_set_extent(volume, &part), SNOW_STATUS_OK);
    snow_volume_get_extent(volume, &given);
    assert_memory_equal(&part, &given, sizeof part);
    snow_volume_whole(volume, &whole);
    assert_memory_equal(whole.dims, part.dims, sizeof whole.dims);
    assert_near(whole.matrix[0][3], 10 - 3 * 2, 1e-12);
    assert_near(whole.matrix[1][3], 20, 1e-12);
    assert_near(whole.matrix[2][3], 30 - 14 * 4, 1e-12);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void boxes_that_do_not_lie_in_one_another_are_refused(void **state) {
    (void)state;
    static const snow_extent bad[] = {
        {sizeof(snow_extent),
         {9, 5, 20},
         {6, 0, 14},
         {6, 0, 14},
         {2, 5, 5}}, /* beyond the grid */
        {sizeof(snow_extent),
         {9, 5, 20},
         {-1, 0, 14},
         {0, 0, 14},
         {2, 5, 5}}, /* before it */
        {sizeof(snow_extent),
         {9, 5, 20},
         {3, 0, 14},
         {2, 0, 14},
         {2, 5, 5}}, /* not stored */
        {sizeof(snow_extent), {9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {5, 5, 5}},
        {sizeof(snow_extent), {9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {-1, 5, 5}},
        {sizeof(snow_extent), {9, 0, 20}, {3, 0, 14}, {3, 0, 14}, {1, 5, 5}},
        {sizeof(snow_extent),
         {9, 5, 20},
         {3, 0, 14},
         {3, 0, 14},
         {INT64_MAX, 5, 5}},
        {sizeof(snow_extent),
         {9, 5, 20},
         {INT64_MAX, 0, 14},
         {INT64_MAX, 0, 14},
         {1, 5, 5}},
    };
    snow_context *context = support_context();
    snow_volume *volume = small_volume(context);
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        snow_extent part = {.size = sizeof part};
        assert_int_equal(snow_volume_set_extent(volume, &bad[n]),
                         SNOW_STATUS_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(context), "is not inside"));
        snow_volume_get_extent(volume, &part);
        assert_int_equal(part.dims[0], 4);
    }
    /* A part may own nothing. */
    const snow_extent none = {
        sizeof none, {9, 5, 20}, {3, 0, 14}, {0, 0, 0}, {0, 0, 0}};
    assert_int_equal(snow_volume_set_extent(volume, &none), SNOW_STATUS_OK);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* --- ghosts --------------------------------------------------------------- */

/* Asks for a whole of 100 x 80 x 60 voxels. */
static void ghosts(const snow_view *view, const snow_settings *settings,
                   bool any_turn, int64_t layers[3]) {
    snow_context *context = support_context();
    snow_volume_info whole = snow_volume_info_default("memory");
    whole.dims[0] = 100;
    whole.dims[1] = 80;
    whole.dims[2] = 60;
    whole.type = SNOW_TYPE_UINT8;
    if (snow_ghosts_needed(context, &whole, view, settings, false, any_turn,
                           layers) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    snow_context_free(context);
}

static void assert_layers(const int64_t layers[3], int x, int y, int z) {
    assert_int_equal(layers[0], x);
    assert_int_equal(layers[1], y);
    assert_int_equal(layers[2], z);
}

static void kernels_and_gradients_need_ghosts(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_settings settings;
    snow_view view = {.size = sizeof view};
    int64_t layers[3];
    snow_settings_init(&settings);
    assert_int_equal(snow_view_from_name(context, "+z", &view), SNOW_STATUS_OK);
    /* In the plane the voxel behind a sample, a gradient's and one for rays
     * that move aside; across slices the other sheet of a slab, and a
     * gradient's. */
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 3, 3, 2);
    settings.shade = SNOW_SHADE_NONE;
    for (int quality = 0; quality < 3; quality++) {
        settings.quality = (snow_quality)quality;
        ghosts(&view, &settings, false, layers);
        assert_layers(layers, 2, 2, 1);
    }
    settings.kernel = SNOW_KERNEL_BSPLINE; /* cubic: a voxel more */
    settings.footprint = 4;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 3, 3, 2);
    settings.kernel = SNOW_KERNEL_TENT;
    settings.footprint = 2;
    snow_view_from_name(context, "-x", &view);
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 1, 2, 2);
    /* Half-way between two axes slices are along y. */
    view.azimuth = 45;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 2, 1, 2);
    snow_context_free(context);
}

static void footprints_need_ghosts_of_their_own(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_settings settings;
    snow_view view = {.size = sizeof view};
    int64_t layers[3];
    snow_settings_init(&settings);
    settings.method = SNOW_METHOD_FOOTPRINT;
    assert_int_equal(snow_view_from_name(context, "+z", &view), SNOW_STATUS_OK);
    /* 142 voxels across 512 pixels: no kernel is widened.  The cubic B-spline
     * reaches 2 voxels from a sample half a voxel outside, a gradient one more,
     * slices none. */
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 3, 3, 1);
    settings.shade = SNOW_SHADE_NONE;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 2, 2, 0);
    settings.kernel = SNOW_KERNEL_TENT;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 1, 1, 0);
    snow_view_from_name(context, "-x", &view);
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 0, 1, 1);
    snow_context_free(context);
}

static void a_gradient_opacity_needs_those_of_shading(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume_info whole = snow_volume_info_default("memory");
    whole.dims[0] = whole.dims[1] = whole.dims[2] = 60;
    whole.type = SNOW_TYPE_UINT8;
    for (int n = 0; n < 12; n++) {
        snow_settings settings;
        snow_view view = {.size = sizeof view};
        int64_t shaded[3], faded[3], both[3];
        snow_settings_init(&settings);
        settings.quality = (snow_quality)(n % 3);
        assert_int_equal(
            snow_view_from_name(context, n % 2 ? "iso" : "-y", &view),
            SNOW_STATUS_OK);
        bool any_turn = n / 6;
        snow_ghosts_needed(context, &whole, &view, &settings, false, any_turn,
                           shaded);
        snow_ghosts_needed(context, &whole, &view, &settings, true, any_turn,
                           both);
        settings.shade = SNOW_SHADE_NONE;
        snow_ghosts_needed(context, &whole, &view, &settings, true, any_turn,
                           faded);
        assert_memory_equal(faded, shaded, sizeof faded);
        assert_memory_equal(both, shaded, sizeof both);
        assert_true(faded[0] > 0 && faded[1] > 0 && faded[2] > 0);
    }
    snow_context_free(context);
}

/* Of footprints, which they widen; values are read where rays are. */
static void wide_pixels_need_more_ghosts(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_settings settings;
    snow_view view = {.size = sizeof view};
    int64_t layers[3];
    snow_settings_init(&settings);
    settings.shade = SNOW_SHADE_NONE;
    snow_view_from_name(context, "+z", &view);
    /* 141.4 voxels across 10 pixels: w = sqrt(1 + (14.14^2 - 1) / 4) = 7.12, a
     * support of 28.5. */
    view.width = view.height = 10;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 2, 2, 1);
    settings.method = SNOW_METHOD_FOOTPRINT;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 14, 14, 0);
    /* As far as the grid goes. */
    view.width = view.height = 1;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 99, 79, 0);
    snow_context_free(context);
}

static void every_turn_needs_no_more_than_the_bound(void **state) {
    (void)state;
    snow_context *context = support_context();
    static const double turns[] = {-80, -45, -20, 0, 33, 45, 60, 90, 170};
    static const double fovs[] = {0, 0.5, 30, 60};
    for (int n = 0; n < 48; n++) {
        snow_settings settings;
        snow_view view = {.size = sizeof view};
        snow_settings_init(&settings);
        snow_view_from_name(context, "iso", &view);
        settings.quality = (snow_quality)(n % 3);
        settings.method =
            n < 24 ? SNOW_METHOD_SHEAR_WARP : SNOW_METHOD_FOOTPRINT;
        view.fov = fovs[n / 3 % 4];
        view.width = view.height = n / 12 % 2 ? 30 : 200;
        int64_t bound[3], layers[3];
        ghosts(&view, &settings, true, bound);
        for (size_t a = 0; a < 9; a++)
            for (size_t e = 0; e < 9; e++) {
                view.azimuth = turns[a];
                view.elevation = turns[e];
                ghosts(&view, &settings, false, layers);
                for (int axis = 0; axis < 3; axis++)
                    assert_true(layers[axis] <= bound[axis]);
            }
    }
    /* And the bound is of use: at about a voxel a pixel no more than without
     * widening. */
    snow_settings settings;
    snow_view view = {.size = sizeof view};
    int64_t bound[3];
    snow_settings_init(&settings);
    snow_view_from_name(context, "iso", &view);
    view.width = view.height = 150;
    /* Rays move aside by up to sqrt(2) voxels from slice to slice. */
    ghosts(&view, &settings, true, bound);
    assert_layers(bound, 4, 4, 4);
    settings.method = SNOW_METHOD_FOOTPRINT;
    ghosts(&view, &settings, true, bound);
    assert_layers(bound, 3, 3, 3);
    snow_context_free(context);
}

/* --- parts of pictures ---------------------------------------------------- */

#define MOST_PARTS 40

/* A scene, whole or in parts. */
typedef struct stage {
    snow_context *context;
    reference_scene scene;
    snow_transfer *transfer;
    snow_settings settings; /* resolved */
    snow_volume *whole;
    snow_volume *parts[MOST_PARTS];
    void *voxels[MOST_PARTS]; /* theirs */
    snow_box boxes[MOST_PARTS];
    int count;
} stage;

static void open_whole(stage *s) {
    const reference_scene *scene = &s->scene;
    s->context = support_context();
    assert_int_equal(
        snow_volume_wrap(s->context, &scene->info, scene->voxels, &s->whole),
        SNOW_STATUS_OK);
    s->transfer = model_transfer(s->context, scene);
    s->settings = scene->settings;
    assert_int_equal(
        snow_settings_resolve(s->context, &s->whole->info, &s->settings),
        SNOW_STATUS_OK);
}

/* A box of the scene's voxels with so many layers more, as a volume. */
static void open_part(stage *s, int n, const int64_t layers[3]) {
    const snow_box *box = &s->boxes[n];
    snow_volume_info info = s->whole->info;
    size_t size = snow_type_size(info.type);
    snow_extent part = {.size = sizeof part};
    for (int axis = 0; axis < 3; axis++) {
        int64_t low = box->first[axis] - layers[axis];
        int64_t high = box->first[axis] + box->count[axis] + layers[axis];
        part.dims[axis] = info.dims[axis];
        part.first[axis] = box->first[axis];
        part.count[axis] = box->count[axis];
        part.stored[axis] = low > 0 ? low : 0;
        high = high < info.dims[axis] ? high : info.dims[axis];
        info.dims[axis] = high - part.stored[axis];
    }
    for (int row = 0; row < 3; row++)
        for (int axis = 0; axis < 3; axis++)
            info.matrix[row][3] +=
                info.matrix[row][axis] * (double)part.stored[axis];
    size_t line = (size_t)info.dims[0] * size;
    char *to = s->voxels[n] =
        malloc(line * (size_t)(info.dims[1] * info.dims[2]));
    assert_non_null(to);
    for (int64_t z = 0; z < info.dims[2]; z++)
        for (int64_t y = 0; y < info.dims[1]; y++, to += line) {
            int64_t at =
                ((part.stored[2] + z) * part.dims[1] + part.stored[1] + y) *
                    part.dims[0] +
                part.stored[0];
            memcpy(to, (const char *)s->whole->voxels + (size_t)at * size,
                   line);
        }
    assert_int_equal(
        snow_volume_wrap(s->context, &info, s->voxels[n], &s->parts[n]),
        SNOW_STATUS_OK);
    assert_int_equal(snow_volume_set_extent(s->parts[n], &part),
                     SNOW_STATUS_OK);
}

static void open_parts(stage *s) {
    int64_t layers[3];
    if (snow_ghosts_needed(s->context, &s->whole->info, &s->scene.view,
                           &s->scene.settings, s->scene.gradient_count > 0,
                           false, layers) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(s->context));
    for (int n = 0; n < s->count; n++)
        open_part(s, n, layers);
}

static void close_parts(stage *s) {
    for (int n = 0; n < s->count; n++) {
        snow_volume_close(s->parts[n]);
        free(s->voxels[n]);
    }
    s->count = 0;
}

static void close_stage(stage *s) {
    close_parts(s);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->whole);
    snow_context_free(s->context);
}

/* A grid of boxes, borders at dims * n / cells. */
static void cut_grid(stage *s, int nx, int ny, int nz) {
    const int64_t *dims = s->whole->info.dims;
    const int cells[3] = {nx, ny, nz};
    s->count = nx * ny * nz;
    assert_true(s->count <= MOST_PARTS);
    for (int n = 0; n < s->count; n++) {
        const int at[3] = {n % nx, n / nx % ny, n / nx / ny};
        for (int axis = 0; axis < 3; axis++) {
            int64_t low = dims[axis] * at[axis] / cells[axis];
            int64_t high = dims[axis] * (at[axis] + 1) / cells[axis];
            s->boxes[n].first[axis] = low;
            s->boxes[n].count[axis] = high - low;
        }
    }
}

/* Five leaves of a k-d tree, that are no grid. */
static void cut_unevenly(stage *s) {
    const int64_t *d = s->whole->info.dims;
    const snow_box boxes[] = {
        {{0, 0, 0}, {4, d[1], d[2]}},
        {{4, 0, 0}, {d[0] - 4, 5, 3}},
        {{4, 0, 3}, {2, 5, d[2] - 3}},
        {{6, 0, 3}, {d[0] - 6, 5, d[2] - 3}},
        {{4, 5, 0}, {d[0] - 4, d[1] - 5, d[2]}},
    };
    s->count = 5;
    memcpy(s->boxes, boxes, sizeof boxes);
}

/* --- pictures of parts ---------------------------------------------------- */

typedef struct flat {
    int width, height, channels;
    float *pixels;
} flat;

static const double turns[][3] = {
    {0, 0, 0},       {180, 0, 0},  {90, 0, 0},   {-90, 0, 30},
    {0, 90, 0},      {0, -90, 0},  {30, 20, 10}, {45, 0, 0},
    {-130, -50, 70}, {0.01, 0, 0}, {70, 3, 0},
};
#define TURNS (int)(sizeof turns / sizeof *turns)

/* Scene number `n` of a sweep, of so many: everything varies. */
static reference_scene scene_of(int n, double fov) {
    static const double zooms[] = {1, 0.2, 4, 0.55, 1.5};
    static const snow_kernel kernels[] = {SNOW_KERNEL_BSPLINE,
                                          SNOW_KERNEL_BSPLINE, SNOW_KERNEL_TENT,
                                          SNOW_KERNEL_GAUSS, SNOW_KERNEL_BOX};
    reference_scene scene = model_scene(
        (int64_t[]){13, 10, 11}, n % 3 ? SNOW_TYPE_UINT8 : SNOW_TYPE_FLOAT32,
        n % 4 == 0, (model_matrix)(n % MODEL_MATRICES), (uint64_t)(n + 1));
    const double *turn = turns[n % TURNS];
    model_turn(&scene, turn[0], turn[1], turn[2], zooms[n % 5]);
    if (n / 6 % 2)
        model_fade(&scene);
    scene.view.fov = fov;
    scene.settings.method = SNOW_METHOD_SHEAR_WARP;
    scene.settings.quality = (snow_quality)(n / 2 % 3);
    scene.settings.shade = n / 3 % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    scene.settings.kernel = kernels[n / 5 % 5];
    scene.settings.encoding = (snow_encoding)(n % 4);
    scene.settings.threshold = n % 2 * 10;
    scene.settings.threads = 1 + n % 2;
    /* Half of them so thin that nothing is opaque. */
    if (n % 2)
        scene.settings.opacity_length = 12;
    return scene;
}

static flat shoot(const stage *s, const snow_volume *volume) {
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    assert_int_equal(snow_frame_new(s->context, &frame), SNOW_STATUS_OK);
    if (snow_frame_render(frame, volume, s->transfer, &s->scene.view,
                          &s->scene.settings, &image) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(s->context));
    flat out = {snow_image_width(image), snow_image_height(image),
                snow_image_channels(image), NULL};
    size_t floats = (size_t)(out.width * out.height * out.channels);
    out.pixels = malloc(floats * sizeof(float));
    assert_non_null(out.pixels);
    memcpy(out.pixels, snow_image_pixels(image), floats * sizeof(float));
    snow_image_free(image);
    snow_frame_free(frame);
    return out;
}

static void a_part_that_is_the_whole_gives_the_same_bits(void **state) {
    (void)state;
    for (int n = 0; n < 24; n++) {
        stage s = {.scene = scene_of(n, n % 2 ? 30 : 0)};
        open_whole(&s);
        flat whole = shoot(&s, s.whole);
        cut_grid(&s, 1, 1, 1);
        open_parts(&s);
        flat part = shoot(&s, s.parts[0]);
        assert_memory_equal(
            whole.pixels, part.pixels,
            (size_t)(whole.width * whole.height * whole.channels) *
                sizeof(float));
        free(whole.pixels);
        free(part.pixels);
        close_stage(&s);
        model_free(&s.scene);
    }
}

static void a_part_without_voxels_of_its_own_is_transparent(void **state) {
    (void)state;
    static const snow_method methods[] = {SNOW_METHOD_FOOTPRINT,
                                          SNOW_METHOD_SHEAR_WARP};
    for (int n = 0; n < 4; n++) {
        stage s = {.scene = scene_of(n, n / 2 ? 30 : 0)};
        s.scene.settings.method = methods[n % 2];
        open_whole(&s);
        cut_grid(&s, 1, 1, 1);
        open_parts(&s);
        const snow_extent none = {
            .size = sizeof none, .dims = {20, 20, 20}, .stored = {3, 4, 5}};
        assert_int_equal(snow_volume_set_extent(s.parts[0], &none),
                         SNOW_STATUS_OK);
        flat part = shoot(&s, s.parts[0]);
        for (int i = 0; i < part.width * part.height * part.channels; i++)
            assert_true(part.pixels[i] == 0);
        free(part.pixels);
        close_stage(&s);
        model_free(&s.scene);
    }
}

static void a_part_with_too_few_ghosts_is_refused(void **state) {
    (void)state;
    stage s = {.scene = scene_of(0, 0)};
    s.scene.settings.shade = SNOW_SHADE_PHONG;
    s.scene.settings.kernel = SNOW_KERNEL_TENT;
    open_whole(&s);
    cut_grid(&s, 2, 1, 1);
    open_part(&s, 0, (const int64_t[]){2, 0, 0});
    open_part(&s, 1, (const int64_t[]){3, 0, 0});
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    assert_int_equal(snow_frame_new(s.context, &frame), SNOW_STATUS_OK);
    assert_int_equal(snow_frame_render(frame, s.parts[0], s.transfer,
                                       &s.scene.view, &s.scene.settings,
                                       &image),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(s.context),
                           "needs 3 layers of ghost voxels along x"));
    assert_int_equal(snow_frame_render(frame, s.parts[1], s.transfer,
                                       &s.scene.view, &s.scene.settings,
                                       &image),
                     SNOW_STATUS_OK);
    snow_image_free(image);
    snow_frame_free(frame);
    close_stage(&s);
    model_free(&s.scene);
}

/* --- order ---------------------------------------------------------------- */

/* Whether no box in the order is before an earlier one, along any of many rays
 * that are walked voxel by voxel. */
static void check_order(const snow_box *boxes, const int *order, int count,
                        const snow_viewer *viewer, uint64_t *seed) {
    int place[MOST_PARTS];
    for (int n = 0; n < count; n++)
        place[order[n]] = n;
    for (int ray = 0; ray < 300; ray++) {
        double at[3], step[3];
        int last = -1;
        for (int axis = 0; axis < 3; axis++) {
            double target = support_uniform(seed) * 12 - 0.5;
            step[axis] = viewer->perspective
                             ? (target - viewer->eye[axis]) / 400
                             : viewer->along[axis] / 100;
            at[axis] = viewer->perspective ? viewer->eye[axis]
                                           : target - viewer->along[axis] * 20;
        }
        for (int n = 0; n < 4000; n++) {
            for (int axis = 0; axis < 3; axis++)
                at[axis] += step[axis];
            for (int b = 0; b < count; b++) {
                bool inside = true;
                for (int axis = 0; axis < 3; axis++) {
                    double low = (double)boxes[b].first[axis] - 0.5;
                    inside = inside && at[axis] >= low &&
                             at[axis] < low + (double)boxes[b].count[axis];
                }
                if (!inside)
                    continue;
                assert_true(place[b] >= last);
                last = place[b];
            }
        }
    }
}

static void boxes_are_ordered_from_front_to_back(void **state) {
    (void)state;
    uint64_t seed = 7;
    stage s = {.scene = scene_of(0, 0)};
    open_whole(&s);
    for (int n = 0; n < 27; n++) {
        int order[MOST_PARTS];
        snow_viewer viewer = {.perspective = n % 2};
        for (int axis = 0; axis < 3; axis++) {
            viewer.along[axis] =
                n % 5 == axis ? 0 : support_uniform(&seed) * 2 - 1;
            viewer.eye[axis] = support_uniform(&seed) * 60 - 30;
            if (n % 3 == axis) /* beside, or between the boxes */
                viewer.eye[axis] = support_uniform(&seed) * 12;
        }
        if (n % 3 == 2)
            cut_unevenly(&s);
        else
            cut_grid(&s, 2 + n % 3, 2 - n % 3, 2);
        assert_int_equal(
            snow_order_boxes(s.context, s.boxes, s.count, &viewer, order),
            SNOW_STATUS_OK);
        check_order(s.boxes, order, s.count, &viewer, &seed);
    }
    s.count = 0;
    close_stage(&s);
    model_free(&s.scene);
}

static void boxes_without_an_order_are_refused(void **state) {
    (void)state;
    snow_context *context = support_context();
    const snow_viewer viewer = {.along = {1, 1, 1}};
    int order[3] = {7, 7, 7};
    /* Three bars around a corner: each lies before the next. */
    const snow_box ring[] = {
        {{0, 0, 2}, {4, 2, 2}}, {{2, 0, 0}, {2, 4, 2}}, {{0, 2, 0}, {2, 2, 4}}};
    assert_int_equal(snow_order_boxes(context, ring, 3, &viewer, order),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "cycle"));
    const snow_box twice[] = {{{0, 0, 0}, {4, 2, 2}}, {{3, 1, 1}, {2, 4, 2}}};
    assert_int_equal(snow_order_boxes(context, twice, 2, &viewer, order),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "overlap"));
    assert_int_equal(order[0], 7);
    /* Empty ones are nowhere, and last. */
    const snow_box empty[] = {{{0, 0, 0}, {0, 2, 2}}, {{0, 0, 0}, {2, 4, 2}}};
    assert_int_equal(snow_order_boxes(context, empty, 2, &viewer, order),
                     SNOW_STATUS_OK);
    assert_int_equal(order[0], 1);
    assert_int_equal(order[1], 0);
    snow_context_free(context);
}

/* --- groups of slices ----------------------------------------------------- */

static void slabs_of_groups_are_made_of_whole_nodes(void **state) {
    (void)state;
    static const int64_t sizes[] = {1, 5, 31, 32, 33, 100, 513};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (int parts = 1; parts <= 40; parts++) {
            int64_t end = 0;
            for (int part = 0; part < parts; part++) {
                snow_slab slab = snow_slab_grouped(sizes[s], parts, part);
                snow_group_node nodes[SNOW_NODES_MOST];
                int count = snow_group_nodes(sizes[s], slab, nodes);
                if (slab.count == 0) {
                    assert_int_equal(count, 0);
                    continue;
                }
                assert_int_equal(slab.first, end);
                assert_true(count > 0 && count <= SNOW_NODES_MOST);
                int group = nodes[0].index << nodes[0].rank;
                assert_int_equal(snow_group_slab(sizes[s], group).first, end);
                for (int n = 0; n < count; n++) {
                    assert_int_equal(nodes[n].index << nodes[n].rank, group);
                    group += 1 << nodes[n].rank;
                }
                end = slab.first + slab.count;
            }
            assert_int_equal(end, sizes[s]);
        }
    snow_group_node nodes[SNOW_NODES_MOST];
    assert_int_equal(snow_group_nodes(100, (snow_slab){1, 4}, nodes), -1);
    assert_int_equal(snow_group_nodes(320, (snow_slab){0, 320}, nodes), 1);
    assert_int_equal(nodes[0].rank, SNOW_GROUP_RANKS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_volume_that_is_no_part_is_the_whole),
        cmocka_unit_test(a_part_knows_its_place_in_the_whole),
        cmocka_unit_test(boxes_that_do_not_lie_in_one_another_are_refused),
        cmocka_unit_test(kernels_and_gradients_need_ghosts),
        cmocka_unit_test(footprints_need_ghosts_of_their_own),
        cmocka_unit_test(a_gradient_opacity_needs_those_of_shading),
        cmocka_unit_test(wide_pixels_need_more_ghosts),
        cmocka_unit_test(every_turn_needs_no_more_than_the_bound),
        cmocka_unit_test(a_part_that_is_the_whole_gives_the_same_bits),
        cmocka_unit_test(a_part_without_voxels_of_its_own_is_transparent),
        cmocka_unit_test(a_part_with_too_few_ghosts_is_refused),
        cmocka_unit_test(boxes_are_ordered_from_front_to_back),
        cmocka_unit_test(boxes_without_an_order_are_refused),
        cmocka_unit_test(slabs_of_groups_are_made_of_whole_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
