/* tests/render/test_shear_warp_slabs.c - method shear-warp by slabs of a file,
 * and of two files in one picture: the bits of what is in memory, which
 * test_truth.c holds against the truth. */
#include "support/files.h"
#include "support/scenario.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Where the second volume is resampled, also for few pixels, or a box of it is
 * taken: in memory the range of these values is known then, and that of the
 * file is somewhat more, so that their 14 bits and the nodes of their table are
 * others.  Labels have no such range. */
#define BOUND_RESAMPLED (6.0 / 255)

/* A scene, perhaps with a second volume in its picture. */
typedef struct pair {
    reference_scene base, front;
    bool layered;
    snow_transfer *transfer, *look;
    snow_volume_options options; /* of both but for the crop */
} pair;

static void save(const support_files *place, const reference_scene *s,
                 const char *name) {
    snow_volume *volume;
    assert_int_equal(
        snow_volume_wrap(place->context, &s->info, s->voxels, &volume),
        SNOW_STATUS_OK);
    if (snow_volume_save(volume, support_path(place, name), true) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    snow_volume_close(volume);
}

/* In memory (0), or in slabs of so many bytes. */
static snow_volume *open_by(support_files *place, const char *name,
                            const snow_volume_options *options,
                            uint64_t bytes) {
    const char *path = support_path(place, name);
    snow_volume *volume;
    if ((bytes ? snow_volume_open_streamed(place->context, path, options, bytes,
                                           &volume)
               : snow_volume_open(place->context, path, options, &volume)) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    return volume;
}

/* The second volume, in memory on the grid of the first. */
static snow_volume *open_front(support_files *place, const pair *p,
                               const snow_volume *base, uint64_t bytes) {
    snow_volume_options own = p->options;
    memset(own.crop, 0, sizeof own.crop);
    own.mask = NULL;
    if (bytes)
        return open_by(place, "front.mha", &own, bytes);
    snow_volume *front = open_by(place, "front.mha", NULL, 0), *cut;
    assert_int_equal(
        snow_volume_regrid(&front, base,
                           snow_transfer_has_labels(p->look, &front->info)),
        SNOW_STATUS_OK);
    if (own.clip[0][2] == 0)
        return front;
    assert_int_equal(snow_volume_clip(front, own.clip[0], 1, &cut),
                     SNOW_STATUS_OK);
    snow_volume_close(front);
    return cut;
}

/* By a frame that has made others. */
static snow_image *picture_of(support_files *place, snow_frame *frame,
                              const pair *p, uint64_t bytes) {
    snow_volume *base = open_by(place, "base.mha", &p->options, bytes);
    snow_volume *front = p->layered ? open_front(place, p, base, bytes) : NULL;
    const snow_layer layer = {.volume = front, .transfer = p->look};
    snow_image *image;
    assert_int_equal(snow_frame_set_layers(frame, &layer, p->layered),
                     SNOW_STATUS_OK);
    if (snow_frame_render(frame, base, p->transfer, &p->base.view,
                          &p->base.settings, &image) != SNOW_STATUS_OK)
        fail_msg("%s: %s", model_words(&p->base),
                 snow_context_message(place->context));
    assert_int_equal(snow_frame_stats(frame)->method, SNOW_METHOD_SHEAR_WARP);
    assert_int_equal(snow_frame_set_layers(frame, NULL, 0), SNOW_STATUS_OK);
    snow_volume_close(front);
    snow_volume_close(base);
    return image;
}

/* Bit by bit, but for sums, which are rounded slab by slab. */
static void compare_pictures(const pair *p, int n, snow_image *a,
                             snow_image *b) {
    const snow_mode mode = p->base.settings.mode;
    const bool sums = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
    const bool resampled = p->layered && ((n % 3 != 2 && n / 3 % 2 == 0) ||
                                          p->base.view.width < 10);
    assert_int_equal(snow_image_channels(a), snow_image_channels(b));
    const double gap =
        scenario_difference(snow_image_pixels(a), snow_image_pixels(b),
                            (size_t)(p->base.view.width * p->base.view.height) *
                                (size_t)snow_image_channels(a),
                            sums);
    if (!(gap <= (resampled ? BOUND_RESAMPLED : sums ? 2e-6 : 0)))
        fail_msg("scene %d: %g; %s", n, gap, model_words(&p->base));
}

/* Slabs of so many slices, ghosts included, twice: what the first picture has
 * read may serve the second. */
static void check_slabs(support_files *place, snow_frame *frame, const pair *p,
                        int n) {
    static const uint64_t slices[] = {1, 7, 12, 1000};
    const uint64_t bytes = slices[(size_t)(n + n / 4) % COUNT(slices)] * 25 *
                           22 * (uint64_t)snow_type_size(p->base.info.type);
    snow_image *a = picture_of(place, frame, p, 0);
    const snow_stats whole = *snow_frame_stats(frame);
    for (int again = 0; again <= p->layered; again++) {
        snow_image *b = picture_of(place, frame, p, bytes);
        const snow_stats *slabs = snow_frame_stats(frame);
        if (!p->layered &&
            (slabs->interesting != whole.interesting ||
             slabs->voxels != whole.voxels || slabs->encoded != whole.encoded))
            fail_msg("%lld of %lld voxels, and in slabs %lld of %lld: %s",
                     (long long)whole.interesting, (long long)whole.voxels,
                     (long long)slabs->interesting, (long long)slabs->voxels,
                     model_words(&p->base));
        compare_pictures(p, n, a, b);
        snow_image_free(b);
    }
    snow_image_free(a);
}

static pair pair_of(support_files *place, int n, bool layered) {
    static char mask[256];
    pair p = {.base = scenario_scene(n, 29), .layered = layered};
    p.options = (snow_volume_options){.size = sizeof p.options};
    p.transfer = model_transfer(place->context, &p.base);
    save(place, &p.base, "base.mha");
    if (n % 3 == 0) {
        const double plane[4] = {0.3, n % 5 - 2, 0.7, n % 5 ? 8 : 2};
        memcpy(p.options.clip[0], plane, sizeof plane);
        p.options.crop[1][0] = 2;
        p.options.crop[1][1] = 21;
        p.options.crop[2][0] = layered ? 0 : 3;
        p.options.crop[2][1] = 28;
        snprintf(mask, sizeof mask, "%s", support_path(place, "base.mha"));
        p.options.mask = p.base.masked ? mask : NULL;
    }
    if (layered) {
        p.front = scenario_front(&p.base, n);
        p.look = model_transfer(place->context, &p.front);
        save(place, &p.front, "front.mha");
    }
    return p;
}

static void check_pictures(support_files *place, bool projected, bool layered) {
    static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MEAN,
                                      SNOW_MODE_MINIP, SNOW_MODE_SUM,
                                      SNOW_MODE_ISO};
    snow_frame *frame;
    assert_int_equal(snow_frame_new(place->context, &frame), SNOW_STATUS_OK);
    for (int n = 0; n < 48; n++) {
        if (!support_takes((size_t)n, 13))
            continue;
        pair p = pair_of(place, n, layered);
        p.base.settings.iso = 30 + n * 17 % 50;
        if (projected)
            p.base.settings.mode = modes[(size_t)(n + n / 6) % COUNT(modes)];
        check_slabs(place, frame, &p, n);
        snow_transfer_free(p.transfer);
        snow_transfer_free(p.look);
        scenario_free_scene(&p.base);
        scenario_free_scene(&p.front);
    }
    snow_frame_free(frame);
}

static void slabs_of_a_file_make_the_same_bits(void **state) {
    check_pictures(*state, false, false);
}

static void slabs_of_a_file_are_projected_alike(void **state) {
    check_pictures(*state, true, false);
}

static void slabs_of_two_files_make_the_same_bits(void **state) {
    check_pictures(*state, false, true);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_files_setup, \
                                    support_files_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(slabs_of_a_file_make_the_same_bits),
        TEST(slabs_of_a_file_are_projected_alike),
        TEST(slabs_of_two_files_make_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
