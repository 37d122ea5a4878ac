/* tests/volume/test_needs.c - of a volume's values no more is looked at than a
 * look needs, and that is what counting all of them finds. */
#include "support/folder.h"
#include "support/looks.h"

#include "transfer/look.h"

#include <math.h>

/* The smallest and the largest value without counting all. */
static void a_range_is_that_of_the_counts(void **state) {
    (void)state;
    enum { N = 70001 };
    static uint16_t bits[N];
    uint64_t random = 17;
    const snow_type types[] = {SNOW_TYPE_INT8, SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                               SNOW_TYPE_UINT16};
    const double scales[][2] = {{1, 0},   {-0.3, 7},  {0, 4},
                                {2, 1e5}, {1e305, 0}, {1, -300}};
    for (int i = 0; i < N; i++)
        bits[i] = (uint16_t)(support_random(&random) >> 40);
    snow_context *context = support_context();
    for (size_t n = 0; n < 4 * 6 * 2; n++) {
        snow_volume_info info = {.size = sizeof info,
                                 .type = types[n % 4],
                                 .dims = {N, 1, 1},
                                 .slope = scales[n / 4 % 6][0],
                                 .intercept = scales[n / 4 % 6][1]};
        bool log = n >= 24;
        snow_volume *volume;
        snow_histogram all, range, sign;
        assert_int_equal(snow_volume_wrap(context, &info, bits, &volume),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_histogram_new(volume, NULL, (snow_scale){log, 0},
                                            SNOW_NEED_COUNTS, &all),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_histogram_new(volume, NULL, (snow_scale){log, 0},
                                            SNOW_NEED_RANGE, &range),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_histogram_new(volume, NULL, (snow_scale){log, 0},
                                            SNOW_NEED_SIGN, &sign),
                         SNOW_STATUS_OK);
        assert_int_equal(all.finite > 0, range.finite > 0);
        if (all.finite) {
            assert_true(all.min == range.min && all.max == range.max);
            assert_int_equal(all.min >= 0, sign.min >= 0);
            if (all.min >= 0)
                assert_true(all.min == sign.min);
        }
        snow_histogram_free(&all);
        snow_histogram_free(&range);
        snow_histogram_free(&sign);
        snow_volume_close(volume);
    }
    snow_context_free(context);
}

/* Whether making a look reads a volume that stays in its file. */
static bool reads(const snow_volume *volume, snow_context *context,
                  snow_look look) {
    uint64_t before = snow_context_bytes_read(context);
    snow_transfer_free(support_look(volume, look));
    return snow_context_bytes_read(context) > before;
}

static void what_is_given_is_not_looked_for(void **state) {
    (void)state;
    const snow_opacity_point opacities[] = {{10, 0}, {90, 0.5}};
    const snow_color_point colors[] = {{10, 0, 0, 0}, {90, 1, 1, 1}};
    const snow_look points = {.size = sizeof points,
                              .name = "own",
                              .colors = colors,
                              .color_count = 2,
                              .opacities = opacities,
                              .opacity_count = 2};
    snow_look given = {.size = sizeof given,
                       .colormap = "viridis",
                       .range = SNOW_RANGE_VALUES,
                       .low = 5,
                       .high = 95,
                       .opacities = opacities,
                       .opacity_count = 2};
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    const char *path = support_folder_path(folder, "v.nrrd");
    snow_context *context = support_context();
    snow_volume *volume;
    assert_int_equal(snow_volume_open_phantom(context, "head",
                                              (const int64_t[3]){9, 8, 7}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    assert_int_equal(snow_volume_open_streamed(context, path, NULL, 0, &volume),
                     SNOW_STATUS_OK);
    assert_false(reads(volume, context, given));
    assert_false(
        reads(volume, context,
              (snow_look){.size = sizeof(snow_look), .base = &points}));
    assert_false(reads(volume, context,
                       (snow_look){.size = sizeof(snow_look),
                                   .preset = "ct-bone",
                                   .range = SNOW_RANGE_VALUES,
                                   .low = 0,
                                   .high = 200}));
    given.range = SNOW_RANGE_FULL;
    assert_true(reads(volume, context, given));
    given.range = SNOW_RANGE_VALUES;
    given.colormap = NULL; /* how dark grey begins is guessed */
    assert_true(reads(volume, context, given));
    given.colormap = "viridis";
    given.opacities = NULL;
    assert_true(reads(volume, context, given));
    assert_true(
        reads(volume, context,
              (snow_look){.size = sizeof(snow_look), .preset = "linear"}));
    snow_volume_close(volume);
    snow_context_free(context);
    support_folder_remove(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_range_is_that_of_the_counts),
        cmocka_unit_test(what_is_given_is_not_looked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
