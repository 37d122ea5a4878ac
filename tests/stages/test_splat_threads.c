/* tests/stages/test_splat_threads.c - the footprint methods by any number of
 * threads, on random runs of random samples, and in memory that is there. */
#include "reference/model.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Random spans of random samples: values 0.5 to 2 where something is, of which
 * the colours, but not the opacity, are a function. */
static reference_scene random_scene(uint64_t *random, bool grey) {
    static const snow_color_point rainbow[] = {
        {0.5, 1, 0.2, 0}, {1.2, 0.1, 0.9, 0.4}, {2, 0.1, 0.3, 1}};
    static const snow_color_point ramp[] = {{0.5, 0.1, 0.1, 0.1}, {2, 1, 1, 1}};
    int64_t dims[3];
    for (int n = 0; n < 3; n++)
        dims[n] = 1 + (int64_t)(support_uniform(random) * 22);
    /* Every other one is opaque behind a few slices. */
    reference_scene scene =
        model_blank(dims, support_uniform(random) < 0.5 ? 0.35 : 0.97);
    scene.colors = grey ? ramp : rainbow;
    scene.color_count = grey ? COUNT(ramp) : COUNT(rainbow);
    scene.settings.method = SNOW_METHOD_FOOTPRINT;
    scene.settings.threads = 1;
    double density = support_uniform(random), change = support_uniform(random);
    bool inside = false;
    for (int64_t n = 0; n < dims[0] * dims[1] * dims[2]; n++) {
        if (support_uniform(random) < change)
            inside = support_uniform(random) < density;
        if (inside)
            model_voxels(&scene)[n] =
                (float)(0.5 + 1.5 * support_uniform(random));
    }
    return scene;
}

/* Aligned, nearly aligned and oblique; whole, magnified until a voxel is wider
 * than the picture, and until the volume is a dot. */
static void random_view(uint64_t *random, int n, reference_scene *scene) {
    static const double zooms[] = {1, 0.5, 3, 0.08, 1.7, 60, 8, 0.01};
    static const double turns[] = {0, 90, 1e-5, 45};
    double turn = n % 3 ? 180 * support_uniform(random) - 90
                        : turns[n / 3 % (int)COUNT(turns)];
    double roll = n % 4 ? 0 : 30 * support_uniform(random);
    model_turn(scene, turn, n % 3 == 1 ? turn / 3 : 0, roll, zooms[n % 8]);
    scene->view.width = 1 + (int)(support_uniform(random) * 70);
    scene->view.height = 1 + (int)(support_uniform(random) * 50);
}

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
    uint64_t random = 33;
    for (int n = 0; n < 48; n++) {
        reference_scene scene = random_scene(&random, n % 2 == 0);
        random_view(&random, n, &scene);
        scene.settings.kernel = (snow_kernel)(n / 2 % 4);
        scene.settings.shade = n % 3 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
        check_threads(&stage, &scene);
        model_free(&scene);
    }
    model_close(&stage);
}

/* Counts what is asked of it. */
static void *allocate_counted(void *user, size_t bytes) {
    ++*(long *)user;
    return malloc(bytes);
}

static void release(void *user, void *block) {
    (void)user;
    free(block);
}

static void a_second_picture_takes_no_memory_but_its_own(void **state) {
    (void)state;
    long count = 0;
    snow_allocator functions = {allocate_counted, release, &count};
    uint64_t random = 34;
    for (int n = 0; n < 4 * (int)COUNT(ways); n++) {
        model_stage stage = {0};
        assert_int_equal(snow_context_new(&functions, &stage.context),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_frame_new(stage.context, &stage.frame),
                         SNOW_STATUS_OK);
        reference_scene scene = random_scene(&random, n % 2 == 0);
        model_turn(&scene, n % 3 * 30, n % 3 * 20, 0, 1);
        scene.settings.method = ways[n / 4].method;
        scene.settings.encoding = ways[n / 4].encoding;
        scene.settings.threads = n % 2 ? 1 : 3;
        snow_volume *volume;
        snow_transfer *transfer;
        snow_image *image;
        assert_int_equal(
            snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
            SNOW_STATUS_OK);
        assert_int_equal(snow_transfer_new(stage.context, scene.colors,
                                           scene.color_count, scene.opacities,
                                           scene.opacity_count, &transfer),
                         SNOW_STATUS_OK);
        long before[2];
        for (int i = 0; i < 2; i++) {
            before[i] = count;
            assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                               &scene.view, &scene.settings,
                                               &image),
                             SNOW_STATUS_OK);
            snow_image_free(image);
        }
        /* The record of the image and its pixels. */
        if (count - before[1] != 2)
            fail_msg("%ld allocations: %s", count - before[1],
                     model_words(&scene));
        assert_true(before[1] - before[0] > 2);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        model_free(&scene);
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
