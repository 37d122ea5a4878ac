/* tests/render/test_bytes.c - pictures as bytes are the levels of their PNG of
 * 8 bits, whatever the method, mode and instruction set, and nothing beside the
 * rows is written. */
#include "support/support.h"

#include <math.h>

#include "composite/bytes.h"
#include "simd/isa.h"

#define WIDTH 135
#define HEIGHT 61
#define STRIDE (4 * WIDTH + 5)
#define UNTOUCHED 0xA7

typedef struct scene {
    const char *name;
    bool color;
    snow_settings settings;
    double fov, zoom;
    int background; /* of those below */
} scene;

static const double backgrounds[][3] = {{0, 0, 0}, {1, 1, 1}, {0.2, 0.5, 0.9}};

static const double *background_of(const scene *s) {
    return s->background < 0 ? NULL : backgrounds[s->background];
}

/* What a PNG writer is given, as four bytes a pixel. */
static void check_row(const scene *s, const unsigned char *levels, int samples,
                      int y, const unsigned char *row) {
    for (int x = 0; x < WIDTH; x++)
        for (int c = 0; c < 4; c++) {
            const int grey = samples <= 2;
            int expected = c < 3         ? levels[x * samples + (grey ? 0 : c)]
                           : samples % 2 ? 255
                                         : levels[x * samples + samples - 1];
            if (row[4 * x + c] != expected)
                fail_msg("%s: byte %d of pixel (%d, %d) is %d, not %d", s->name,
                         c, x, y, row[4 * x + c], expected);
        }
    for (int n = 4 * WIDTH; n < STRIDE; n++)
        assert_int_equal(row[n], UNTOUCHED);
}

static void check_bytes(const scene *s, const snow_image *image,
                        const unsigned char *bytes) {
    snow_image_options options;
    snow_levels levels;
    snow_image_options_init(&options);
    if (s->background >= 0) {
        options.flatten = true;
        memcpy(options.background, background_of(s), sizeof options.background);
    }
    assert_int_equal(snow_levels_begin(image, &options, false, &levels),
                     SNOW_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++)
        check_row(s, snow_levels_row(&levels, y), levels.samples, y,
                  bytes + y * STRIDE);
    snow_levels_end(&levels);
}

static void check_scene(scene s, snow_isa isa) {
    static unsigned char bytes[HEIGHT * STRIDE];
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    snow_view view;
    snow_view_init(&view);
    view.width = WIDTH;
    view.height = HEIGHT;
    view.azimuth = 30;
    view.elevation = 20;
    view.fov = s.fov;
    view.zoom = s.zoom > 0 ? s.zoom : 1;
    s.settings.isa = isa;
    snow_volume_options options;
    snow_volume_options_init(&options);
    for (int axis = 0; axis < 3; axis++)
        options.dims[axis] = 48;
    const snow_color_point colors[] = {
        {0, 0.9, s.color ? 0.2 : 0.9, s.color ? 0.5 : 0.9}, {255, 1, 1, 1}};
    const snow_opacity_point opacities[] = {{30, 0}, {255, 0.3}};
    assert_int_equal(
        snow_volume_open(context, "phantom:engine", &options, &volume), 0);
    assert_int_equal(
        snow_transfer_new(context, colors, 2, opacities, 2, &transfer), 0);
    assert_int_equal(snow_frame_new(context, &frame), 0);
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &view, &s.settings, &image),
        SNOW_STATUS_OK);
    memset(bytes, UNTOUCHED, sizeof bytes);
    assert_int_equal(snow_frame_render_bytes(frame, volume, transfer, &view,
                                             &s.settings, background_of(&s),
                                             bytes, STRIDE),
                     SNOW_STATUS_OK);
    check_bytes(&s, image, bytes);
    snow_image_free(image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void bytes_are_those_of_the_png(void **state) {
    (void)state;
    const scene scenes[] = {
        {.name = "over", .settings = {.quality = SNOW_QUALITY_NORMAL}},
        {.name = "draft", .settings = {.quality = SNOW_QUALITY_DRAFT}},
        {.name = "means", .zoom = 0.3},
        {.name = "perspective", .fov = 30},
        {.name = "iso", .settings = {.mode = SNOW_MODE_ISO, .iso = 100}},
        {.name = "mip", .settings = {.mode = SNOW_MODE_MIP}},
        {.name = "raycast", .settings = {.method = SNOW_METHOD_RAYCAST}},
        {.name = "footprint", .settings = {.method = SNOW_METHOD_FOOTPRINT}},
        {.name = "darkened", .settings = {.depth_darkening = 0.7}},
        {.name = "occlusion", .settings = {.occlusion = 0.7}},
    };
    for (size_t n = 0; n < sizeof scenes / sizeof *scenes; n++)
        for (size_t look = 0; look < 8; look++) {
            if (!support_takes(look + n, 7))
                continue;
            scene s = scenes[n];
            s.settings.size = sizeof s.settings;
            s.background = (int)(look % 4) - 1;
            s.color = look >= 4;
            for (snow_isa isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++)
                if (snow_isa_runs(isa))
                    check_scene(s, isa);
        }
}

/* Floats where the level changes, and those around them; in some rows NaN. */
static void levels_change_where_they_do(void **state) {
    (void)state;
    static unsigned char bytes[HEIGHT * STRIDE];
    snow_context *context = support_context();
    for (int channels = 2; channels <= 4; channels += 2)
        for (snow_isa isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++)
            for (int background = -1; background < 3; background++) {
                const scene s = {.name = "levels", .background = background};
                const snow_bytes to = {bytes, STRIDE, background_of(&s)};
                snow_image *image = NULL;
                if (!snow_isa_runs(isa))
                    continue;
                assert_int_equal(
                    snow_image_new(context, WIDTH, HEIGHT, channels, &image),
                    SNOW_STATUS_OK);
                for (int n = 0; n < WIDTH * HEIGHT * channels; n++) {
                    float at = (float)((n / 9 % 256 - 0.5) / 255);
                    for (int ulp = n % 9; ulp < 4; ulp++)
                        at = nextafterf(at, -1);
                    for (int ulp = n % 9; ulp > 4; ulp--)
                        at = nextafterf(at, 2);
                    image->pixels[n] = n % 3001 == 3000 ? NAN : at;
                    if (n % channels == channels - 1 && n % 7 != 0)
                        image->pixels[n] = 1;
                }
                memset(bytes, UNTOUCHED, sizeof bytes);
                snow_bytes_image(image, isa, &to);
                check_bytes(&s, image, bytes);
                snow_image_free(image);
            }
    snow_context_free(context);
}

static void requests_are_checked(void **state) {
    (void)state;
    static unsigned char bytes[HEIGHT * STRIDE];
    const double bright[3] = {0, 2, 0};
    snow_context *context = support_context();
    snow_frame *frame = NULL;
    snow_settings settings;
    snow_view view;
    snow_view_init(&view);
    snow_settings_init(&settings);
    view.width = WIDTH;
    view.height = HEIGHT;
    assert_int_equal(snow_frame_new(context, &frame), 0);
    assert_int_equal(snow_frame_render_bytes(frame, NULL, NULL, &view,
                                             &settings, NULL, bytes,
                                             4 * WIDTH - 1),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_frame_render_bytes(frame, NULL, NULL, &view,
                                             &settings, bright, bytes, STRIDE),
                     SNOW_STATUS_BAD_USAGE);
    settings.mode = SNOW_MODE_SUM;
    assert_int_equal(snow_frame_render_bytes(frame, NULL, NULL, &view,
                                             &settings, NULL, bytes, STRIDE),
                     SNOW_STATUS_BAD_USAGE);
    snow_frame_free(frame);
    snow_context_free(context);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_are_those_of_the_png),
        cmocka_unit_test(levels_change_where_they_do),
        cmocka_unit_test(requests_are_checked),
    };
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
