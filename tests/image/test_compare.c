/* tests/image/test_compare.c - differences of pictures, against their
 * definitions written out plainly. */
#include "support/image.h"

#include <math.h>

static snow_image *picture(image_fixture *f, int width, int height,
                           int channels) {
    return support_blank(f->context, width, height, channels);
}

static snow_image_difference compare(snow_image *a, snow_image *b) {
    snow_image_difference d = {.size = sizeof d, .x = -1};
    assert_int_equal(snow_image_compare(a, b, &d), SNOW_STATUS_OK);
    return d;
}

static void free_both(snow_image *a, snow_image *b) {
    snow_image_free(a);
    snow_image_free(b);
}

/* Whatever its samples are, also where they are not finite. */
static void a_picture_does_not_differ_from_itself(void **state) {
    image_fixture *f = *state;
    static const int sizes[][2] = {{1, 1}, {1, 30}, {30, 1},
                                   {7, 7}, {8, 8},  {33, 21}};
    static const float odd[] = {0, NAN, INFINITY, -INFINITY, 1, 2};
    for (int i = 0; i < 6; i++) {
        snow_image *a =
            support_picture(f->context, sizes[i][0], sizes[i][1], 4, 8);
        snow_image *b =
            support_picture(f->context, sizes[i][0], sizes[i][1], 4, 8);
        snow_image_pixels(a)[1] = snow_image_pixels(b)[1] = odd[i];
        snow_image_difference d = compare(a, b);
        assert_true(d.largest == 0 && d.mean == 0 && d.ssim == 1);
        assert_true(isinf(d.psnr) && d.psnr > 0);
        assert_true(d.x == 0 && d.y == 0);
        free_both(a, b);
    }
}

static void differences_are_absolute_and_over_all_channels(void **state) {
    image_fixture *f = *state;
    snow_image *a = picture(f, 5, 2, 4), *b = picture(f, 5, 2, 4);
    snow_image_pixels(a)[4 * 8 + 3] = 0.5f; /* alpha of pixel (3, 1) */
    snow_image_pixels(b)[4 * 2 + 1] = 0.25f;
    snow_image_difference d = compare(a, b);
    assert_true(d.largest == 0.5 && d.x == 3 && d.y == 1);
    assert_true(fabs(d.mean - 0.75 / 40) < 1e-15);
    double mse = (0.25 + 0.0625) / 40;
    assert_true(fabs(d.psnr - 10 * log10(1 / mse)) < 1e-9);
    free_both(a, b);
}

/* Every pair of neighbouring levels, stored as the loaders store them. */
static void levels_are_counted_exactly(void **state) {
    image_fixture *f = *state;
    static const int tops[] = {255, 65535};
    for (int t = 0; t < 2; t++) {
        const double top = tops[t];
        snow_image *a = picture(f, 1, 1, 2), *b = picture(f, 1, 1, 2);
        for (int level = 0; level < tops[t]; level++) {
            snow_image_pixels(a)[0] = (float)(level / top);
            snow_image_pixels(b)[0] = (float)((level + 1) / top);
            assert_true(compare(a, b).largest == 1 / top);
        }
        free_both(a, b);
    }
}

/* Beside a level, a sample of a float picture is no level. */
static void other_floats_are_not_rounded_to_levels(void **state) {
    image_fixture *f = *state;
    snow_image *a = picture(f, 1, 1, 2), *b = picture(f, 1, 1, 2);
    const float level = (float)(100 / 255.0), near = nextafterf(level, 1);
    snow_image_pixels(a)[0] = level;
    snow_image_pixels(b)[0] = near;
    assert_true(compare(a, b).largest == (double)near - (double)level);
    free_both(a, b);
}

static void the_first_of_equal_differences_is_told(void **state) {
    image_fixture *f = *state;
    snow_image *a = picture(f, 4, 4, 2), *b = picture(f, 4, 4, 2);
    snow_image_pixels(a)[2 * 6] = 1;
    snow_image_pixels(a)[2 * 13] = 1;
    snow_image_difference d = compare(a, b);
    assert_true(d.x == 2 && d.y == 1);
    free_both(a, b);
}

static void two_channels_count_as_grey(void **state) {
    image_fixture *f = *state;
    snow_image *a = picture(f, 1, 1, 2), *b = picture(f, 1, 1, 4);
    memcpy(snow_image_pixels(a), (float[]){0.5f, 1}, 8);
    memcpy(snow_image_pixels(b), ((float[]){0.5f, 0.5f, 0.5f, 1}), 16);
    assert_true(compare(a, b).largest == 0);
    snow_image_pixels(b)[2] = 0.75f;
    assert_true(compare(a, b).largest == 0.25);
    free_both(a, b);
}

static void pictures_of_two_sizes_differ(void **state) {
    image_fixture *f = *state;
    snow_image *a = picture(f, 3, 4, 4), *b = picture(f, 4, 3, 4);
    snow_image_difference d = {.size = sizeof d, .x = -1};
    assert_int_equal(snow_image_compare(a, b, &d), SNOW_STATUS_DIFFERENT);
    assert_int_equal(d.x, -1);
    assert_non_null(strstr(snow_context_message(f->context), "3 x 4"));
    assert_non_null(strstr(snow_context_message(f->context), "4 x 3"));
    free_both(a, b);
}

static void others_are_infinitely_far_apart(void **state) {
    image_fixture *f = *state;
    static const float odd[][2] = {{NAN, 0},
                                   {1, NAN},
                                   {NAN, INFINITY},
                                   {INFINITY, -INFINITY},
                                   {INFINITY, 3e38f}};
    for (int i = 0; i < 5; i++) {
        snow_image *a = support_picture(f->context, 12, 12, 4, 8);
        snow_image *b = support_picture(f->context, 12, 12, 4, 8);
        /* pixel (5, 4) lies in all windows, pixel (11, 11) in one of 25 */
        snow_image_pixels(a)[4 * 143] = odd[i][0];
        snow_image_pixels(b)[4 * 143] = odd[i][1];
        snow_image_difference d = compare(a, b);
        assert_true(isinf(d.largest) && isinf(d.mean));
        assert_true(isinf(d.psnr) && d.psnr < 0);
        assert_true(d.x == 11 && d.y == 11);
        assert_true(fabs(d.ssim - 24.0 / 25) < 1e-12);
        snow_image_pixels(a)[4 * 53] = odd[i][0];
        snow_image_pixels(b)[4 * 53] = odd[i][1];
        assert_true(compare(a, b).ssim == 0);
        free_both(a, b);
    }
}

static double luma(const snow_image *image, int x, int y) {
    float p[4];
    snow_image_rgba(image, (size_t)(y * image->width + x), p);
    return 0.2126 * (double)p[0] + 0.7152 * (double)p[1] +
           0.0722 * (double)p[2];
}

/* Structural similarity as its definition says, window by window. */
static double plain_ssim(const snow_image *a, const snow_image *b) {
    int wide = a->width < 8 ? a->width : 8,
        high = a->height < 8 ? a->height : 8;
    double total = 0, n = wide * high;
    int windows = 0;
    for (int y = 0; y + high <= a->height; y++)
        for (int x = 0; x + wide <= a->width; x++) {
            double ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
            for (int i = 0; i < wide * high; i++) {
                ma += luma(a, x + i % wide, y + i / wide) / n;
                mb += luma(b, x + i % wide, y + i / wide) / n;
            }
            for (int i = 0; i < wide * high; i++) {
                double p = luma(a, x + i % wide, y + i / wide) - ma;
                double q = luma(b, x + i % wide, y + i / wide) - mb;
                va += p * p / n, vb += q * q / n, cov += p * q / n;
            }
            total += (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) /
                     ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
            windows++;
        }
    return total / windows;
}

static void similarity_is_as_defined(void **state) {
    image_fixture *f = *state;
    static const int sizes[][2] = {{40, 30}, {8, 8},  {9, 8},
                                   {5, 40},  {40, 3}, {1, 1}};
    for (int i = 0; i < 6; i++)
        for (int channels = 2; channels <= 4; channels += 2) {
            snow_image *a = support_picture(f->context, sizes[i][0],
                                            sizes[i][1], channels, 8);
            snow_image *b =
                support_picture(f->context, sizes[i][0], sizes[i][1], 4, 99);
            double wanted = plain_ssim(a, b), got = compare(a, b).ssim;
            assert_true(fabs(got - wanted) < 1e-11);
            assert_true(compare(b, a).ssim == got);
            free_both(a, b);
        }
}

static void a_bright_spot_spoils_its_own_windows_only(void **state) {
    image_fixture *f = *state;
    snow_image *a = support_picture(f->context, 60, 60, 4, 8);
    snow_image *b = support_picture(f->context, 60, 60, 4, 8);
    snow_image_pixels(a)[0] = 1e15f;
    double ssim = compare(a, b).ssim;
    /* of 53 x 53 windows one holds it, and is worth nothing */
    assert_true(fabs(ssim - (1 - 1.0 / (53 * 53))) < 1e-9);
    free_both(a, b);
}

static void rounding_of_huge_values_makes_no_difference(void **state) {
    image_fixture *f = *state;
    uint64_t seed = 5;
    for (int round = 0; round < 500; round++) {
        snow_image *a = picture(f, 1, 35, 2);
        float value = (float)(support_uniform(&seed) * 1e16);
        for (int i = 0; i < 35; i++)
            snow_image_pixels(a)[2 * i] = value;
        assert_true(compare(a, a).ssim == 1);
        snow_image_free(a);
    }
}

static void opposite_pictures_have_a_negative_similarity(void **state) {
    image_fixture *f = *state;
    snow_image *a = picture(f, 16, 16, 2), *b = picture(f, 16, 16, 2);
    for (int i = 0; i < 256; i++) {
        snow_image_pixels(a)[2 * i] = (float)((i + i / 16) % 2);
        snow_image_pixels(b)[2 * i] = (float)((i + i / 16 + 1) % 2);
    }
    double ssim = compare(a, b).ssim;
    assert_true(ssim > -1 && ssim < -0.99);
    free_both(a, b);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(a_picture_does_not_differ_from_itself),
        TEST(differences_are_absolute_and_over_all_channels),
        TEST(levels_are_counted_exactly),
        TEST(other_floats_are_not_rounded_to_levels),
        TEST(the_first_of_equal_differences_is_told),
        TEST(two_channels_count_as_grey),
        TEST(pictures_of_two_sizes_differ),
        TEST(others_are_infinitely_far_apart),
        TEST(similarity_is_as_defined),
        TEST(a_bright_spot_spoils_its_own_windows_only),
        TEST(rounding_of_huge_values_makes_no_difference),
        TEST(opposite_pictures_have_a_negative_similarity),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
