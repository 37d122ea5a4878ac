/* tests/render/test_shear_warp_axes.c - encodings along other slice axes: a
 * view that turns finds them whole, and no picture is another one for it. */
#include "support/support.h"

#include "base/base.h"
#include "image/image.h"
#include "volume/volume.h"

/* What is turned before a camera. */
typedef struct scene {
    const char *name;
    snow_type type;
    snow_settings settings;
    double fov;
    double first, step; /* degrees, and from picture to picture */
    double thick;       /* how much farther apart slices are */
} scene;

typedef struct stage {
    snow_context *context;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    const scene *scene;
} stage;

static void open_volume(stage *s, const char *name) {
    const int64_t dims[3] = {40, 36, 44};
    snow_volume *volume = NULL;
    assert_int_equal(
        snow_volume_open_phantom(s->context, name, dims, 0, &volume),
        SNOW_STATUS_OK);
    s->volume = volume;
    for (int row = 0; row < 3; row++)
        volume->info.matrix[row][2] *= s->scene->thick;
    snow_volume_info_measure(&volume->info);
    if (s->scene->type == SNOW_TYPE_UINT8)
        return;
    assert_int_equal(
        snow_volume_convert(volume, s->scene->type, NULL, &s->volume),
        SNOW_STATUS_OK);
    snow_volume_close(volume);
}

static void stage_begin(const scene *what, stage *s) {
    *s = (stage){.context = support_context(), .scene = what};
    open_volume(s, what->name);
    assert_int_equal(
        snow_transfer_new_for_volume(s->volume, NULL, &s->transfer),
        SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(s->context, &s->frame), SNOW_STATUS_OK);
}

static void stage_end(stage *s) {
    snow_frame_free(s->frame);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    assert_int_equal(snow_context_bytes(s->context), 0);
    snow_context_free(s->context);
}

static snow_image *draw(const stage *s, snow_frame *frame, double azimuth) {
    snow_image *image = NULL;
    snow_view view;
    snow_view_init(&view);
    view.width = view.height = 48;
    view.azimuth = azimuth;
    view.elevation = 12;
    view.fov = s->scene->fov;
    assert_int_equal(snow_frame_render(frame, s->volume, s->transfer, &view,
                                       &s->scene->settings, &image),
                     SNOW_STATUS_OK);
    return image;
}

/* The picture is that of a frame which has drawn no other. */
static const snow_stats *check(const stage *s, double azimuth) {
    snow_frame *other = NULL;
    assert_int_equal(snow_frame_new(s->context, &other), SNOW_STATUS_OK);
    snow_image *given = draw(s, s->frame, azimuth);
    snow_image *alone = draw(s, other, azimuth);
    const snow_stats *stats = snow_frame_stats(s->frame);
    assert_memory_equal(snow_image_pixels(given), snow_image_pixels(alone),
                        48 * 48 * (size_t)snow_image_channels(alone) *
                            sizeof(float));
    assert_int_equal(stats->slice_axis, snow_frame_stats(other)->slice_axis);
    assert_int_equal(stats->interesting, snow_frame_stats(other)->interesting);
    assert_true(stats->kept_bytes <= stats->kept_most);
    snow_image_free(given);
    snow_image_free(alone);
    snow_frame_free(other);
    return stats;
}

static scene scene_of(const char *name, snow_type type, double step) {
    scene s = {.name = name, .type = type, .step = step, .thick = 1};
    snow_settings_init(&s.settings);
    s.settings.quality = SNOW_QUALITY_DRAFT;
    s.settings.threads = 2;
    return s;
}

/* A whole turn encodes for the first picture only: the other axis is prepared
 * before the view gets there, and kept. */
static void turn(const scene *what) {
    stage s;
    int encoded = 0, changes = 0, axis = -1;
    stage_begin(what, &s);
    for (double azimuth = what->first; azimuth < what->first + 360;
         azimuth += what->step) {
        const snow_stats *stats = check(&s, azimuth);
        encoded += stats->encoded;
        changes += axis >= 0 && stats->slice_axis != axis;
        axis = stats->slice_axis;
    }
    assert_int_equal(changes, 4);
    assert_int_equal(encoded, what->fov > 0 ? 2 : 1);
    assert_true(snow_frame_stats(s.frame)->kept_bytes > 0);
    stage_end(&s);
}

static void a_turn_encodes_for_its_first_picture_only(void **state) {
    (void)state;
    scene scenes[] = {
        scene_of("engine", SNOW_TYPE_UINT8, 7),
        scene_of("engine", SNOW_TYPE_UINT16, 9),
        scene_of("shells", SNOW_TYPE_FLOAT32, 11),
        scene_of("head", SNOW_TYPE_UINT8, 5),
        scene_of("engine", SNOW_TYPE_UINT8, 8),
        scene_of("engine", SNOW_TYPE_UINT8, 6),
        scene_of("shells", SNOW_TYPE_UINT16, 7),
    };
    scenes[1].settings.shade = SNOW_SHADE_NONE;
    scenes[3].settings.encoding = SNOW_ENCODING_CRS;
    scenes[4].fov = 30;
    for (int n = 5; n < 7; n++) { /* sheets are more along z than along x */
        scenes[n].first = 90;
        scenes[n].thick = n == 5 ? 9 : 40;
        scenes[n].settings.quality = SNOW_QUALITY_NORMAL;
    }
    for (size_t n = 0; n < 7; n++)
        if (support_takes(n, 3))
            turn(&scenes[n]);
}

/* A jump to another axis encodes, but not the way back. */
static void what_was_drawn_is_kept(void **state) {
    (void)state;
    const scene what = scene_of("engine", SNOW_TYPE_UINT8, 90);
    stage s;
    stage_begin(&what, &s);
    assert_true(check(&s, 0)->encoded);
    assert_int_equal(snow_frame_stats(s.frame)->kept_bytes, 0);
    assert_true(check(&s, 90)->encoded);
    assert_true(snow_frame_stats(s.frame)->kept_bytes > 0);
    assert_false(check(&s, 180)->encoded);
    assert_false(check(&s, 90)->encoded);
    stage_end(&s);
}

/* A look that shows more, and another volume, in the midst of the turn. */
static void another_look_and_another_volume(void **state) {
    (void)state;
    const scene what = scene_of("engine", SNOW_TYPE_UINT8, 6);
    const snow_opacity_point more[] = {{5, 0}, {20, 0.4}, {255, 0.4}};
    const snow_look look = {
        .size = sizeof look, .opacities = more, .opacity_count = 3};
    stage s;
    stage_begin(&what, &s);
    for (int n = 0; n < 5; n++)
        check(&s, 6 * n);
    snow_transfer_free(s.transfer);
    assert_int_equal(snow_transfer_new_for_volume(s.volume, &look, &s.transfer),
                     SNOW_STATUS_OK);
    for (int n = 5; n < 7; n++)
        check(&s, 6 * n);
    snow_volume_close(s.volume);
    open_volume(&s, "head");
    for (int n = 7; n < 12; n++)
        check(&s, 6 * n);
    stage_end(&s);
}

/* Under a limit nothing is kept that another volume of the same size would
 * need, and no picture fails that did not fail before. */
static void a_limit_is_heeded(void **state) {
    (void)state;
    const scene what = scene_of("engine", SNOW_TYPE_UINT8, 10);
    uint64_t needed = 0, kept = 0, spared = 0;
    for (int extra = 0; extra < 24; extra++) {
        stage s;
        stage_begin(&what, &s);
        if (!extra) {
            for (int n = 0; n < 36;
                 n++) /* one by one, in a frame of their own */
                check(&s, 90 * (n % 2));
            needed = snow_context_peak_bytes(s.context);
        }
        snow_context_set_memory_limit(s.context,
                                      needed + 8192 * (uint64_t)extra);
        for (int n = 0; n < 12; n++) {
            snow_image *image = draw(&s, s.frame, 10 * n);
            snow_image_free(image);
            const snow_stats *stats = snow_frame_stats(s.frame);
            kept += stats->kept_bytes > 0;
            spared += stats->kept_bytes == 0;
        }
        stage_end(&s);
    }
    assert_true(kept > 0 && spared > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_turn_encodes_for_its_first_picture_only),
        cmocka_unit_test(what_was_drawn_is_kept),
        cmocka_unit_test(another_look_and_another_volume),
        cmocka_unit_test(a_limit_is_heeded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
