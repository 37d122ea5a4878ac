/* tests/render/test_shear_warp_lines.c - some lines of a picture have the bits
 * of the whole picture, and take some of its tiles. */
#include "reference/model.h"
#include "render/picture.h"
#include "render/shear_warp/internal.h"

static const snow_quality qualities[] = {
    SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};

/* Every quality, slice axis and mode; turned, tilted and rolled; near, far and
 * in perspective. */
static reference_scene scene_of(int n, bool large) {
    static const double zooms[] = {1.1, 2.4, 0.3, 0.05, 6};
    static const snow_mode modes[] = {
        SNOW_MODE_OVER, SNOW_MODE_OVER, SNOW_MODE_MIP, SNOW_MODE_MINIP,
        SNOW_MODE_MEAN, SNOW_MODE_SUM,  SNOW_MODE_ISO};
    static const double backs[][3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    static const double ups[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    static const snow_opacity_point look[] = {{0, 0}, {40, 0}, {90, 0.7}};
    const int64_t dims[] = {large ? 300 : 57, large ? 280 : 40, 34};
    reference_scene s =
        model_scene(dims, SNOW_TYPE_UINT8, n % 2,
                    n % 3 ? MODEL_PLAIN : MODEL_ANISOTROPIC, (uint64_t)n);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.threads = 1 + n % 2;
    s.settings.quality = qualities[n % 3];
    s.settings.mode = modes[n / 3 % 7];
    s.settings.iso = 60;
    s.settings.shade = n % 7 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    s.opacities = look;
    s.opacity_count = 3;
    model_look(&s, backs[n / 3 % 3], ups[n / 3 % 3]);
    model_turn(&s, n % 2 ? 25 : -33, n * 37 % 70 - 35, n % 4 ? 0 : 15 + n % 90,
               zooms[n % 5]);
    s.view.fov = n % 4 == 3 ? 40 : 0;
    s.view.width = 70;
    s.view.height = 64;
    return s;
}

/* Of a volume whose voxels may change between two pictures nothing is kept. */
static snow_volume *open_frozen(const model_stage *stage,
                                const reference_scene *s) {
    snow_volume *volume = model_volume(stage->context, s);
    snow_volume_freeze(volume);
    return volume;
}

static void check_lines(const model_stage *stage, int n,
                        const reference_scene *s, bool keeps) {
    static const int ends[] = {0, 5, 8, 31, 32, 64};
    snow_volume *volume = open_frozen(stage, s);
    snow_image *whole = model_image_of(stage, s, volume);
    const float *all = snow_image_pixels(whole);
    const size_t line =
        (size_t)(s->view.width * snow_image_channels(whole)) * sizeof *all;
    for (size_t i = 1; i < sizeof ends / sizeof *ends; i++) {
        const int first = ends[i - 1], end = ends[i];
        stage->frame->lines[0] = first;
        stage->frame->lines[1] = end;
        stage->frame->more = keeps && first > 0;
        snow_image *some = model_image_of(stage, s, volume);
        const size_t from =
            (size_t)(first * s->view.width * snow_image_channels(whole));
        if (memcmp(snow_image_pixels(some) + from, all + from,
                   (size_t)(end - first) * line) != 0)
            fail_msg("scene %d: lines %d to %d have other bits", n, first, end);
        snow_image_free(some);
    }
    stage->frame->lines[0] = stage->frame->lines[1] = 0;
    stage->frame->more = false;
    snow_image *again = model_image_of(stage, s, volume);
    if (memcmp(snow_image_pixels(again), all, (size_t)s->view.height * line) !=
        0)
        fail_msg("scene %d: after its lines the whole has other bits", n);
    snow_image_free(again);
    snow_image_free(whole);
    snow_volume_close(volume);
}

/* In a frame that has other pictures' tiles, and in a new one. */
static void lines_have_the_bits_of_the_whole(void **state) {
    (void)state;
    model_stage used = model_open();
    for (int n = 0; n < 210; n++) {
        if (!support_takes((size_t)n, 11))
            continue;
        reference_scene s = scene_of(n, false);
        model_stage fresh = model_open();
        check_lines(&used, n, &s, n % 2);
        check_lines(&fresh, n, &s, true);
        model_close(&fresh);
        model_free(&s);
    }
    model_close(&used);
}

/* A scene of another volume, which has the same voxels in the reverse order:
 * nothing else makes the frame forget the tiles of the first. */
static reference_scene reversed_scene_of(int n) {
    reference_scene s = scene_of(n, false);
    unsigned char *voxels = (unsigned char *)(uintptr_t)s.voxels;
    const int64_t *dims = s.info.dims;
    const int64_t count = dims[0] * dims[1] * dims[2];
    for (int64_t i = 0; i < count / 2; i++) {
        const unsigned char other = voxels[count - 1 - i];
        voxels[count - 1 - i] = voxels[i];
        voxels[i] = other;
    }
    return s;
}

static void check_turns(int n, bool frozen) {
    model_stage stage = model_open();
    reference_scene scenes[2] = {scene_of(n, false), reversed_scene_of(n)};
    snow_volume *volumes[2];
    snow_image *whole[2];
    for (int i = 0; i < 2; i++) {
        scenes[i].view.roll = 20;
        volumes[i] = frozen ? open_frozen(&stage, &scenes[i])
                            : model_volume(stage.context, &scenes[i]);
        whole[i] = model_image_of(&stage, &scenes[i], volumes[i]);
    }
    const size_t line = (size_t)(70 * snow_image_channels(whole[0]));
    assert_memory_not_equal(snow_image_pixels(whole[0]),
                            snow_image_pixels(whole[1]),
                            64 * line * sizeof(float));
    for (int first = 0; first < 64; first += 8)
        for (int i = 0; i < 2; i++) {
            const size_t from = (size_t)first * line;
            stage.frame->lines[0] = first;
            stage.frame->lines[1] = first + 8;
            stage.frame->more = first > 0;
            snow_image *some = model_image_of(&stage, &scenes[i], volumes[i]);
            if (memcmp(snow_image_pixels(some) + from,
                       snow_image_pixels(whole[i]) + from,
                       8 * line * sizeof(float)) != 0)
                fail_msg("scene %d: lines from %d of volume %d have other bits",
                         n, first, i);
            snow_image_free(some);
        }
    for (int i = 0; i < 2; i++) {
        snow_image_free(whole[i]);
        snow_volume_close(volumes[i]);
        model_free(&scenes[i]);
    }
    model_close(&stage);
}

static void lines_of_two_volumes_are_their_own(void **state) {
    (void)state;
    for (int frozen = 0; frozen < 2; frozen++) {
        check_turns(1, frozen); /* over */
        check_turns(6, frozen); /* mip, of which channels take turns */
    }
}

static int count_tiles(const model_stage *stage) {
    const snow_value_image *image = stage->frame->value_path->image;
    int count = 0;
    for (size_t i = 0; i < snow_value_tiles(image); i++)
        count += image->drawn[i] != 0;
    return count;
}

/* Whether the last picture made all that is drawn. */
static bool is_current(const model_stage *stage) {
    const snow_value_image *image = stage->frame->value_path->image;
    for (size_t i = 0; i < snow_value_tiles(image); i++)
        if (image->drawn[i] && !image->current[i])
            return false;
    return true;
}

/* Of a rolled picture, whose tiles lie across its lines.  One frame that draws
 * all lines in turn has made all tiles in the end. */
static void lines_take_their_tiles(void **state) {
    (void)state;
    for (int fov = 0; fov <= 40; fov += 40) {
        model_stage stage = model_open();
        reference_scene s = scene_of(1, true);
        s.settings.quality = SNOW_QUALITY_HIGH;
        s.settings.mode = SNOW_MODE_OVER;
        s.view.width = s.view.height = 400;
        s.view.zoom = 1;
        s.view.roll = 20;
        s.view.fov = fov;
        free(model_picture(&stage, &s));
        const int all = count_tiles(&stage);
        int together = 0;
        for (int quarter = 0; quarter < 4; quarter++) {
            model_stage one = model_open();
            one.frame->lines[0] = 100 * quarter;
            one.frame->lines[1] = 100 * (quarter + 1);
            free(model_picture(&one, &s));
            together += count_tiles(&one);
            model_close(&one);
        }
        snow_volume *volume = open_frozen(&stage, &s);
        print_message("             %d tiles, %d by quarters\n", all, together);
        for (int quarter = 0; quarter < 4; quarter++) {
            stage.frame->lines[0] = 100 * quarter;
            stage.frame->lines[1] = 100 * (quarter + 1);
            stage.frame->more = quarter > 0;
            snow_image_free(model_image_of(&stage, &s, volume));
        }
        snow_volume_close(volume);
        assert_true(is_current(&stage));
        assert_true(all > 40);
        assert_true(together >= all);
        assert_true(together < 2 * all);
        model_free(&s);
        model_close(&stage);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_have_the_bits_of_the_whole),
        cmocka_unit_test(lines_of_two_volumes_are_their_own),
        cmocka_unit_test(lines_take_their_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
