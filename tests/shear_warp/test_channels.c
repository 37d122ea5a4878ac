/* tests/shear_warp/test_channels.c - red, green and blue light of one volume,
 * as three channels, add up to its colours in any order, by both methods. */
#include "shear_warp/scenes.h"

#include <math.h>

static const snow_color_point hot[] = {{0, 0.4, 0, 0}, {100, 1, 0.9, 0.2}};
static const snow_opacity_point few[] = {
    {0, 0}, {60, 0}, {75, 0.4}, {100, 0.8}};

/* A picture of a volume as channels, each with its part of the colours. */
static float *render_channels(const model_stage *stage,
                              const reference_scene *s, const int order[3]) {
    snow_color_point parts[3][2];
    snow_layer channels[3];
    snow_image *image = NULL;
    for (int n = 0; n < 3; n++) {
        reference_scene part = *s;
        snow_volume *volume = NULL;
        memcpy(parts[n], s->colors, sizeof parts[n]);
        part.colors = parts[n];
        for (int i = 0; i < 2; i++) {
            parts[n][i].red *= order[n] == 0;
            parts[n][i].green *= order[n] == 1;
            parts[n][i].blue *= order[n] == 2;
        }
        assert_int_equal(
            snow_volume_wrap(stage->context, &s->info, s->voxels, &volume),
            SNOW_STATUS_OK);
        channels[n] =
            (snow_layer){volume, model_transfer(stage->context, &part), true};
    }
    assert_int_equal(snow_frame_set_layers(stage->frame, channels + 1, 2),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_render(stage->frame, channels[0].volume,
                                       channels[0].transfer, &s->view,
                                       &s->settings, &image),
                     SNOW_STATUS_OK);
    snow_frame_set_layers(stage->frame, NULL, 0);
    float *picture = model_spread(image);
    snow_image_free(image);
    for (int n = 0; n < 3; n++) {
        snow_transfer_free((snow_transfer *)(uintptr_t)channels[n].transfer);
        snow_volume_close((snow_volume *)(uintptr_t)channels[n].volume);
    }
    return picture;
}

static void check_orders(const model_stage *stage, const reference_scene *s) {
    static const int orders[][3] = {{0, 1, 2}, {2, 0, 1}, {1, 0, 2}};
    const int floats = 4 * s->view.width * s->view.height;
    float *whole = model_picture(stage, s), most = 0;
    for (int n = 0; n < 3; n++) {
        float *picture = render_channels(stage, s, orders[n]);
        for (int i = 0; i < floats; i++)
            most = fmaxf(most, fabsf(picture[i] - whole[i]));
        free(picture);
    }
    if (!(most < 2e-3F)) /* each slab rounds to 15 bits */
        fail_msg("channels differ from the whole by %g: %s", (double)most,
                 model_words(s));
    free(whole);
}

static void channels_add_up_in_any_order(void **state) {
    model_stage *stage = *state;
    for (int n = 0; n < NOISY_SCENES; n += 13 * (int)support_stride(9)) {
        warp_scene scene = noisy_scene(n);
        reference_scene *s = &scene.base;
        s->settings.specular = 0; /* it is not coloured */
        s->colors = hot;
        s->color_count = 2;
        s->opacities = few; /* of steep ones colours place the table's nodes */
        s->opacity_count = 4;
        check_orders(stage, s);
        s->settings.method = SNOW_METHOD_RAYCAST;
        check_orders(stage, s);
        warp_scene_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(channels_add_up_in_any_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
