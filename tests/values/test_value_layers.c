/* tests/values/test_value_layers.c - several volumes in one picture, beside the
 * float64 reference of the value model. */
#include "values/pictures.h"

#include <math.h>

static const snow_color_point names[] = {{0.5, 0, 0, 0},     {0.5, 1, 0.2, 0.1},
                                         {1.5, 1, 0.2, 0.1}, {1.5, 0.1, 0.9, 0},
                                         {2.5, 0.1, 0.9, 0}, {2.5, 0.2, 0.3, 1},
                                         {4, 0.2, 0.3, 1},   {4, 1, 1, 0.5}};
static const snow_color_point hot[] = {{0, 0.4, 0, 0}, {100, 1, 0.9, 0.2}};
static const snow_opacity_point clear[] = {{0.5, 0}, {0.5, 0.3}};
static const snow_opacity_point solid[] = {{2.5, 0}, {2.5, 1}};
static const snow_opacity_point few[] = {
    {0, 0}, {60, 0}, {75, 0.4}, {100, 0.8}};
static const snow_opacity_point faint[] = {{0, 0.0002}, {100, 0.0015}};

/* The voxels in the reverse order. */
static void turn_round(const reference_scene *s) {
    const int64_t *dims = s->info.dims;
    size_t size = snow_type_size(s->info.type);
    size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
    char *voxels = (char *)(uintptr_t)s->voxels;
    for (size_t n = 0; n < count / 2; n++) {
        char kept[8];
        memcpy(kept, voxels + n * size, size);
        memcpy(voxels + n * size, voxels + (count - 1 - n) * size, size);
        memcpy(voxels + (count - 1 - n) * size, kept, size);
    }
}

/* Labels, values, or fog in front of a scene. */
static value_scene front_of(int n, const value_scene *behind) {
    value_scene scene = {.base = value_picture_scene(n)};
    scene.base.view = behind->base.view;
    scene.labels = n % 5 != 2 && n % 2;
    turn_round(&scene.base);
    scene.base.colors = scene.labels ? names : hot;
    scene.base.color_count = scene.labels ? 8 : 2;
    scene.base.opacities = scene.labels ? (n % 4 == 1 ? clear : solid)
                           : n % 6 == 4 ? faint
                                        : few;
    scene.base.opacity_count = scene.labels || n % 6 == 4 ? 2 : 4;
    if (scene.labels)
        value_picture_name(&scene.base);
    return scene;
}

typedef void check_fn(const model_stage *stage, int n, const value_scene *s);

static void check_each(int first, int step, bool mixes, check_fn *check) {
    model_stage stage = model_open();
    for (int n = first; n < VALUE_PICTURES; n += step) {
        value_scene scene = {.base = value_picture_scene(n)};
        if (n / 8 % 2 == 1)
            scene.base.view.fov = 40;
        value_scene front = front_of(n, &scene);
        scene.front = &front;
        scene.mixes = mixes;
        check(&stage, n, &scene);
        value_picture_free(&scene.base);
        value_picture_free(&front.base);
    }
    model_close(&stage);
}

static void pictures_are_the_references(void **state) {
    (void)state;
    check_each((int)support_sweep(0, 7), 5 * (int)support_stride(9), false,
               value_picture_check);
}

static void channels_are_the_references(void **state) {
    (void)state;
    check_each((int)support_sweep(1, 7), 5 * (int)support_stride(9), true,
               value_picture_check);
}

static void bits_are_the_same(void **state) {
    (void)state;
    check_each(3, 23 * (int)support_stride(8), false, value_picture_check_bits);
    check_each(5, 31 * (int)support_stride(8), true, value_picture_check_bits);
}

/* A picture of a volume as channels, each with its part of the colours. */
static float *render_channels(const model_stage *stage,
                              const reference_scene *s, const int *order) {
    snow_color_point parts[3][8];
    reference_scene of[3] = {*s, *s, *s};
    snow_inlay channels[3];
    snow_image *image = NULL;
    for (int n = 0; n < 3; n++) {
        memcpy(parts[n], s->colors, s->color_count * sizeof **parts);
        of[n].colors = parts[n];
        for (size_t i = 0; i < s->color_count; i++) {
            parts[n][i].red *= order[n] == 0;
            parts[n][i].green *= order[n] == 1;
            parts[n][i].blue *= order[n] == 2;
        }
        snow_volume *volume = NULL;
        assert_int_equal(
            snow_volume_wrap(stage->context, &s->info, s->voxels, &volume),
            SNOW_STATUS_OK);
        channels[n] =
            (snow_inlay){volume, model_transfer(stage->context, &of[n]), true};
    }
    assert_int_equal(snow_frame_set_inlays(stage->frame, channels + 1, 2),
                     SNOW_STATUS_OK);
    if (snow_frame_render(stage->frame, channels[0].volume,
                          channels[0].transfer, &s->view, &s->settings,
                          &image) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(stage->context));
    snow_frame_set_inlays(stage->frame, NULL, 0);
    float *picture = model_spread(image);
    snow_image_free(image);
    for (int n = 0; n < 3; n++) {
        snow_transfer_free((snow_transfer *)(uintptr_t)channels[n].transfer);
        snow_volume_close((snow_volume *)(uintptr_t)channels[n].volume);
    }
    return picture;
}

/* Red, green and blue light add up to the colour, in any order. */
static void check_parts(const model_stage *stage, reference_scene s) {
    static const int orders[][3] = {{0, 1, 2}, {2, 0, 1}, {1, 0, 2}};
    size_t count = 4 * (size_t)(s.view.width * s.view.height);
    s.settings.specular = 0; /* it is not coloured */
    s.colors = hot;
    s.color_count = 2;
    s.opacities = few; /* of steep ones colours place the table's nodes */
    s.opacity_count = 4;
    float *whole = model_picture(stage, &s), most = 0;
    for (int n = 0; n < 3; n++) {
        float *picture = render_channels(stage, &s, orders[n]);
        for (size_t i = 0; i < count; i++)
            most = fmaxf(most, fabsf(picture[i] - whole[i]));
        free(picture);
    }
    if (!(most < 2e-3F)) /* each slab rounds to 15 bits */
        fail_msg("channels differ from the whole by %g: %s", (double)most,
                 model_words(&s));
    free(whole);
}

static void channels_add_up_in_any_order(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 0; n < VALUE_PICTURES; n += 13 * (int)support_stride(9)) {
        reference_scene scene = value_picture_scene(n);
        check_parts(&stage, scene);
        scene.settings.method = SNOW_METHOD_RAYCAST;
        check_parts(&stage, scene);
        value_picture_free(&scene);
    }
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(channels_are_the_references),
        cmocka_unit_test(channels_add_up_in_any_order),
        cmocka_unit_test(pictures_are_the_references),
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
