/* tests/stages/test_splat_threads.c - the footprint methods by any number of
 * threads, and in memory that is there. */
#include "support/failing.h"
#include "support/scenario.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static uint64_t checksum(const model_stage *stage,
                         const reference_scene *scene) {
    snow_image *image = model_image(stage, scene);
    uint64_t sum = snow_image_checksum(image);
    snow_image_free(image);
    return sum;
}

/* Methods and encodings whose threads are tested. */
static const struct {
    snow_method method;
    snow_encoding encoding;
} ways[] = {
    {SNOW_METHOD_ORIGINAL, SNOW_ENCODING_AUTO},
    {SNOW_METHOD_TESTED, SNOW_ENCODING_AUTO},
    {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_CRS},
    {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_BITMAP},
    {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_RLE},
};

/* Fails unless all numbers of threads give the picture and figures of one. */
static void check_threads(const model_stage *stage, reference_scene *scene) {
    static const int threads[] = {2, 3, 7, 16};
    for (size_t w = 0; w < COUNT(ways); w++) {
        scene->settings.method = ways[w].method;
        scene->settings.encoding = ways[w].encoding;
        scene->settings.threads = 1;
        uint64_t expected = checksum(stage, scene);
        snow_stats alone = *snow_frame_stats(stage->frame);
        for (size_t t = 0; t < COUNT(threads); t++) {
            scene->settings.threads = threads[t];
            uint64_t sum = checksum(stage, scene);
            const snow_stats *stats = snow_frame_stats(stage->frame);
            if (sum != expected)
                fail_msg("%d threads: other bits: %s", threads[t],
                         model_words(scene));
            assert_int_equal(stats->threads, threads[t]);
            assert_int_equal(stats->interesting, alone.interesting);
            assert_int_equal(stats->ea_bytes, alone.ea_bytes);
            assert_int_equal(stats->ia_bytes, alone.ia_bytes);
            assert_int_equal(stats->pa_bytes, alone.pa_bytes);
        }
    }
}

static void any_number_of_threads_gives_the_same_bits(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 0; n < 48; n++) {
        static const double zooms[] = {1, 0.5, 3, 0.08, 1.7, 60, 8, 0.01};
        if (!support_takes((size_t)n, 5))
            continue;
        reference_scene scene = scenario_scene(n, 20);
        /* Until a voxel hides all, and until the volume is a dot. */
        scene.view.zoom = zooms[n % 8];
        scene.view.width = 1 + n * 29 % 70;
        scene.view.height = 1 + n * 37 % 50;
        scene.settings.kernel = (snow_kernel)(n / 2 % 4);
        scene.settings.footprint = 0;
        check_threads(&stage, &scene);
        scenario_free_scene(&scene);
    }
    model_close(&stage);
}

static void a_second_picture_takes_no_memory_but_its_own(void **state) {
    (void)state;
    support_failing memory = {.failing = -1};
    const snow_allocator functions = support_failing_allocator(&memory);
    for (int n = 0; n < 4 * (int)COUNT(ways); n++) {
        model_stage stage = {0};
        assert_int_equal(snow_context_new(&functions, &stage.context),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_frame_new(stage.context, &stage.frame),
                         SNOW_STATUS_OK);
        reference_scene scene = scenario_scene(n, 20);
        scene.settings.method = ways[n / 4].method;
        scene.settings.encoding = ways[n / 4].encoding;
        scene.settings.threads = n % 2 ? 1 : 3;
        scene.settings.kernel = SNOW_KERNEL_TENT;
        scene.settings.footprint = 0;
        scene.view.fov = 0;
        snow_volume *volume;
        snow_transfer *transfer = model_transfer(stage.context, &scene);
        snow_image *image;
        assert_int_equal(
            snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
            SNOW_STATUS_OK);
        long before[2];
        for (int i = 0; i < 2; i++) {
            before[i] = memory.allocations;
            assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                               &scene.view, &scene.settings,
                                               &image),
                             SNOW_STATUS_OK);
            snow_image_free(image);
        }
        /* The record of the image and its pixels. */
        if (memory.allocations - before[1] != 2)
            fail_msg("%ld allocations: %s", memory.allocations - before[1],
                     model_words(&scene));
        assert_true(before[1] - before[0] > 2);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        scenario_free_scene(&scene);
        model_close(&stage);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(a_second_picture_takes_no_memory_but_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
