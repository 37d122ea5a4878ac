/* tests/render/test_model_encodings.c - however the places of interesting
 * voxels are written, the picture has the same bits.  That runs of any length
 * are read as they were written is test_encode's.
 *
 * With the scalar loops original splatting, tested splatting and the three
 * encodings walk the same voxels in the same order with the same arithmetic, so
 * nothing is left to rounding.  The vector loops of footprint sum in another
 * order: there the encodings share their bits, and are near the others. */
#include "reference/model.h"

#include <math.h>

/* A way of making one picture. */
typedef struct way {
    snow_method method;
    snow_encoding encoding;
} way;

static const way ways[] = {
    {SNOW_METHOD_TESTED, SNOW_ENCODING_AUTO},
    {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_CRS},
    {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_BITMAP},
    {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_RLE},
    {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_AUTO},
};

#define WAYS (sizeof ways / sizeof *ways)

static size_t voxel_count(const reference_scene *scene) {
    const int64_t *dims = scene->info.dims;
    return (size_t)(dims[0] * dims[1] * dims[2]);
}

static float *picture_by(const model_stage *stage, reference_scene *scene,
                         way how) {
    scene->settings.method = how.method;
    scene->settings.encoding = how.encoding;
    return model_picture(stage, scene);
}

/* The most that the vector loops may be off from the scalar ones: both are
 * within 4e-4 of the model, where kernels have jumps or kinks in a table. */
#define NEAR 8e-4

static size_t floats_of(const reference_scene *scene) {
    return (size_t)scene->view.width * (size_t)scene->view.height * 4;
}

static bool same_bits(const float *a, const float *b, size_t floats) {
    return memcmp(a, b, floats * sizeof *a) == 0;
}

static bool all_near(const float *a, const float *b, size_t floats) {
    for (size_t n = 0; n < floats; n++)
        if (!(fabsf(a[n] - b[n]) <= (float)NEAR))
            return false;
    return true;
}

/* Fails unless all ways from `from` on give the bits of `expected`. */
static void check_bits(const model_stage *stage, reference_scene *scene,
                       size_t from, const float *expected) {
    for (size_t w = from; w < WAYS; w++) {
        float *picture = picture_by(stage, scene, ways[w]);
        if (!same_bits(picture, expected, floats_of(scene)))
            fail_msg("other bits: %s", model_words(scene));
        free(picture);
    }
}

/* Fails unless all ways give the bits of the first with the scalar loops; at
 * threshold 0 original splatting is one of them.  Then all encodings, with the
 * loops of this machine, which may differ from the former by rounding.  Returns
 * whether anything was seen. */
static bool check_ways(const model_stage *stage, reference_scene *scene) {
    way first = ways[0];
    if (scene->settings.threshold == 0)
        first = (way){SNOW_METHOD_ORIGINAL, SNOW_ENCODING_AUTO};
    scene->settings.isa = SNOW_ISA_SCALAR;
    float *expected = picture_by(stage, scene, first);
    check_bits(stage, scene, 0, expected);
    scene->settings.isa = SNOW_ISA_AUTO;
    float *fast = picture_by(stage, scene, ways[1]);
    if (!all_near(fast, expected, floats_of(scene)))
        fail_msg("not near the scalar loops: %s", model_words(scene));
    check_bits(stage, scene, 1, fast);
    bool seen = false;
    for (size_t n = 0; n < floats_of(scene); n++)
        seen = seen || expected[n] > 0;
    free(expected);
    free(fast);
    return seen;
}

static const struct {
    double back[3], up[3];
} sides[] = {
    {{0, 0, 1}, {0, 1, 0}},
    {{0, -1, 0}, {0, 0, 1}},
    {{1, 0, 0}, {0, 0, 1}},
};

/* A blank scene whose pictures are small, however long the volume is. */
static reference_scene small_scene(const int64_t dims[3], bool colored) {
    static const snow_color_point rainbow[] = {{0.5, 1, 0.2, 0},
                                               {2, 0.1, 0.3, 1}};
    reference_scene scene = model_blank(dims, 0.4);
    if (colored) {
        scene.colors = rainbow;
        scene.color_count = 2;
    }
    scene.view.width = 40;
    scene.view.height = 12;
    return scene;
}

/* Looks from the sides along which rows run along x, along x, and along y,
 * and once obliquely. */
static bool check_sides(const model_stage *stage, reference_scene *scene) {
    bool seen = false;
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
        model_look(scene, sides[s].back, sides[s].up);
        model_turn(scene, 0, 0, 0, 1);
        seen = check_ways(stage, scene) || seen;
    }
    model_turn(scene, 33, 18, 0, 2);
    return check_ways(stage, scene) || seen;
}

static void random_voxels_of_every_density_and_width(void **state) {
    static const double densities[] = {0, 1e-4, 0.01, 0.1, 0.5, 0.99, 1};
    static const int64_t widths[] = {1,  7,   8,   9,   63, 64,
                                     65, 255, 256, 257, 300};
    model_stage *stage = *state;
    for (size_t d = 0; d < sizeof densities / sizeof *densities; d++)
        for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
            if (!support_takes(w + d, 4))
                continue;
            uint64_t random = support_scene_random(21, w + d);
            reference_scene scene =
                small_scene(d % 2 == 0 ? (int64_t[]){widths[w], 5, 3}
                                       : (int64_t[]){3, widths[w], 4},
                            w % 3 == 0);
            for (size_t n = 0; n < voxel_count(&scene); n++)
                if (support_uniform(&random) < densities[d])
                    model_voxels(&scene)[n] =
                        (float)(0.5 + 1.5 * support_uniform(&random));
            bool seen = check_sides(stage, &scene);
            if (densities[d] == 0)
                assert_false(seen);
            if (densities[d] == 1)
                assert_true(seen);
            model_free(&scene);
        }
}

static void slices_larger_than_what_is_classified_at_once(void **state) {
    static const int64_t large[][3] = {{210, 150, 3}, {17000, 3, 2}};
    model_stage *stage = *state;
    uint64_t random = 24;
    for (int n = 0; n < 2; n++) {
        reference_scene scene = small_scene(large[n], n == 0);
        scene.settings.kernel = SNOW_KERNEL_BOX;
        for (size_t at = 0; at < voxel_count(&scene); at++)
            model_voxels(&scene)[at] = support_uniform(&random) < 0.2;
        assert_true(check_sides(stage, &scene));
        model_free(&scene);
    }
}

static void every_kernel_footprint_threshold_and_view(void **state) {
    model_stage *stage = *state;
    for (int n = 0; n < 4 * 8 * 6; n++) {
        if (!support_takes((size_t)n, 13))
            continue;
        uint64_t random = support_scene_random(22, (size_t)n);
        reference_scene scene =
            model_scene((int64_t[]){17, 12, 14},
                        n % 2 ? SNOW_TYPE_INT16 : SNOW_TYPE_FLOAT32, n % 3 == 0,
                        (model_matrix)(n % MODEL_MATRICES), (uint64_t)n);
        scene.view.width = 30;
        scene.view.height = 25;
        scene.settings.kernel = (snow_kernel)(n % 4);
        scene.settings.footprint = 2 + n / 4 % 8;
        scene.settings.threshold = n / 32 % 3 * 15;
        scene.settings.shade = n % 5 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
        bool straight = n / 32 % 2 == 0;
        double turn = straight ? 0 : 90 * support_uniform(&random);
        model_look(&scene, sides[n % 3].back, sides[n % 3].up);
        model_turn(&scene, turn, -turn / 3, turn / 2, 1 + turn / 45);
        assert_true(check_ways(stage, &scene));
        model_free(&scene);
    }
}

static void a_frame_gives_the_same_bits_again_and_a_new_one_too(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_scene(
        (int64_t[]){17, 12, 14}, SNOW_TYPE_UINT8, false, MODEL_OBLIQUE, 5);
    reference_scene other = model_scene(
        (int64_t[]){30, 22, 9}, SNOW_TYPE_FLOAT64, true, MODEL_SHEARED, 6);
    model_turn(&scene, 40, 10, 5, 1);
    float *first = model_picture(stage, &scene);
    free(model_picture(stage, &other));
    float *again = model_picture(stage, &scene);
    model_stage fresh = model_open();
    float *anew = model_picture(&fresh, &scene);
    assert_memory_equal(first, again, 64 * 48 * 4 * sizeof *first);
    assert_memory_equal(first, anew, 64 * 48 * 4 * sizeof *first);
    free(first);
    free(again);
    free(anew);
    model_free(&scene);
    model_free(&other);
    model_close(&fresh);
}

static void figures_count_the_interesting_voxels(void **state) {
    model_stage *stage = *state;
    reference_scene scene = small_scene((int64_t[]){19, 11, 7}, false);
    uint64_t random = 23;
    int64_t interesting = 0;
    for (size_t n = 0; n < voxel_count(&scene); n++)
        if (support_uniform(&random) < 0.3) {
            model_voxels(&scene)[n] = 1;
            interesting++;
        }
    for (size_t w = 0; w < WAYS; w++) {
        free(picture_by(stage, &scene, ways[w]));
        const snow_stats *stats = snow_frame_stats(stage->frame);
        assert_int_equal(stats->voxels, 19 * 11 * 7);
        assert_int_equal(stats->interesting, interesting);
        assert_near(stats->sparse_ratio,
                    1 - (double)interesting / (19 * 11 * 7), 1e-12);
        assert_int_equal(stats->method, ways[w].method);
        if (ways[w].encoding != SNOW_ENCODING_AUTO) {
            assert_int_equal(stats->encoding, ways[w].encoding);
            assert_int_equal(stats->pa_bytes, (7 + 1) * 16);
            assert_true(stats->ia_bytes >= (uint64_t)interesting * 8);
        }
    }
    model_free(&scene);
}

/* The baseline of Tables 2 and 3 works on every voxel: were it to skip those
 * below the threshold it would be the tested method. */
static void original_splatting_knows_no_threshold(void **state) {
    model_stage *stage = *state;
    reference_scene scene = small_scene((int64_t[]){6, 5, 4}, false);
    size_t floats = (size_t)scene.view.width * (size_t)scene.view.height * 4;
    for (size_t n = 0; n < voxel_count(&scene); n++)
        model_voxels(&scene)[n] = 1; /* opacity 0.4, 102 of 255 */
    const way original = {SNOW_METHOD_ORIGINAL, SNOW_ENCODING_AUTO};
    const way tested = {SNOW_METHOD_TESTED, SNOW_ENCODING_AUTO};
    float *expected = picture_by(stage, &scene, original);
    scene.settings.threshold = 150;
    float *whole = picture_by(stage, &scene, original);
    float *empty = picture_by(stage, &scene, tested);
    assert_memory_equal(whole, expected, floats * sizeof *whole);
    for (size_t n = 0; n < floats; n++)
        assert_true(empty[n] == 0);
    free(expected);
    free(whole);
    free(empty);
    model_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(original_splatting_knows_no_threshold),
        MODEL_TEST(random_voxels_of_every_density_and_width),
        MODEL_TEST(slices_larger_than_what_is_classified_at_once),
        MODEL_TEST(every_kernel_footprint_threshold_and_view),
        MODEL_TEST(a_frame_gives_the_same_bits_again_and_a_new_one_too),
        MODEL_TEST(figures_count_the_interesting_voxels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
