/* test_api.c - what holds for the public interface as a whole: names that lead
 * back to their values, records that grow. */
#include "support/support.h"

#include <math.h>
#include <snowglass/extend.h>
#include <snowglass/recipe.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <string.h>

#define EACH_VALUE_HAS_A_NAME(word)                                          \
    for (int i = 0; snow_##word##_name((snow_##word)i); i++)                 \
        assert_int_equal(                                                    \
            snow_##word##_from_name(snow_##word##_name((snow_##word)i)), i); \
    assert_int_equal(snow_##word##_from_name("nothing"), -1)

static void a_name_leads_back_to_its_value(void **state) {
    (void)state;
    EACH_VALUE_HAS_A_NAME(method);
    EACH_VALUE_HAS_A_NAME(encoding);
    EACH_VALUE_HAS_A_NAME(kernel);
    EACH_VALUE_HAS_A_NAME(quality);
    EACH_VALUE_HAS_A_NAME(isa);
    EACH_VALUE_HAS_A_NAME(mode);
}

/* The picture of one call is that of the objects made one by one. */
static void a_file_is_rendered_in_one_call(void **state) {
    snow_context *context = support_context();
    snow_image *image = NULL, *other = NULL;
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_look look = {.size = sizeof look};
    snow_view view = {.size = sizeof view};
    (void)state;
    assert_int_equal(snow_volume_open(context, "phantom:head", NULL, &volume),
                     SNOW_STATUS_OK);
    snow_view_default(volume, &view);
    view.width = view.height = 64;
    assert_int_equal(
        snow_render_file(context, "phantom:head", &view, NULL, &image),
        SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &view, NULL, &other),
        SNOW_STATUS_OK);
    assert_int_equal(snow_image_width(image), 64);
    assert_memory_equal(snow_image_pixels(image), snow_image_pixels(other),
                        64 * 64 * sizeof(float) *
                            (size_t)snow_image_channels(image));
    snow_image_free(image);
    snow_image_free(other);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_file_that_is_missing_makes_no_image(void **state) {
    snow_context *context = support_context();
    snow_image *image = NULL;
    (void)state;
    assert_int_equal(
        snow_render_file(context, "missing.nrrd", NULL, NULL, &image),
        SNOW_STATUS_BAD_INPUT);
    assert_null(image);
    assert_non_null(strstr(snow_context_message(context), "missing.nrrd"));
    /* who goes on all the same is told so */
    assert_int_equal(snow_image_save(image, "no.png", NULL),
                     SNOW_STATUS_BAD_USAGE);
    assert_true(snow_volume_read_seconds(NULL) == 0);
    snow_context_free(context);
}

/* --- records -------------------------------------------------------------- */

#define EACH_VOLUME_RECORD(X) \
    X(snow_volume_info)       \
    X(snow_volume_options)    \
    X(snow_volume_statistics) \
    X(snow_extent)

#define EACH_RECORD(X)         \
    X(snow_view)               \
    X(snow_settings)           \
    X(snow_look)               \
    X(snow_stats)              \
    X(snow_ranks_stats)        \
    X(snow_image_options)      \
    X(snow_image_difference)   \
    X(snow_slice_place)        \
    X(snow_measure)            \
    X(snow_ranks_options)      \
    X(snow_ranks_needs)        \
    X(snow_comm_ops)           \
    X(snow_insitu_stats)       \
    X(snow_insitu_work)        \
    X(snow_insitu_limits)      \
    X(snow_insitu_settings)    \
    X(snow_insitu_annotations) \
    X(snow_recipe)             \
    EACH_VOLUME_RECORD(X)

/* A caller with a shorter record is not written beyond it, and one with a
 * longer record gets zeros there. */
#define CHECK_INITIALISER(record)                                     \
    {                                                                 \
        record known, shorter;                                        \
        struct {                                                      \
            record known;                                             \
            double beyond;                                            \
        } longer;                                                     \
        const unsigned char *bytes = (const unsigned char *)&shorter; \
        record##_init(&known);                                        \
        assert_int_equal(known.size, sizeof known);                   \
        memset(&shorter, 7, sizeof shorter);                          \
        record##_init_sized(&shorter, sizeof shorter - 4);            \
        assert_int_equal(shorter.size, sizeof shorter - 4);           \
        assert_int_equal(bytes[sizeof shorter - 4], 7);               \
        shorter.size = known.size;                                    \
        assert_memory_equal(&shorter, &known, sizeof known - 4);      \
        memset(&longer, 7, sizeof longer);                            \
        record##_init_sized(&longer.known, sizeof longer);            \
        assert_true(longer.beyond == 0);                              \
        longer.known.size = known.size;                               \
        assert_memory_equal(&longer.known, &known, sizeof known);     \
    }

static void initialisers_reach_as_far_as_the_callers_record(void **state) {
    (void)state;
    EACH_RECORD(CHECK_INITIALISER)
}

/* What the headers promise, and zeros elsewhere. */
static void initialisers_give_the_documented_defaults(void **state) {
    snow_view view, plus_z = {.size = sizeof plus_z};
    snow_settings settings;
    snow_recipe recipe;
    snow_context *context = support_context();
    (void)state;
    snow_view_init(&view);
    assert_int_equal(snow_view_from_name(context, "+z", &plus_z),
                     SNOW_STATUS_OK);
    assert_memory_equal(&view, &plus_z, sizeof view);
    assert_true(view.width == 512 && view.height == 512 && view.zoom == 1);
    snow_settings_init(&settings);
    assert_true(settings.ambient == 0.2 && settings.diffuse == 0.7 &&
                settings.specular == 0.2 && settings.shininess == 20);
    assert_true(!settings.deterministic && !settings.depth &&
                settings.threshold == 0 && settings.threads == 0 &&
                settings.method == SNOW_METHOD_AUTO && !settings.stop);
    snow_recipe_init(&recipe);
    assert_true(recipe.width == 512 && recipe.zoom == 1 &&
                isnan(recipe.target[0]) && recipe.settings.diffuse == 0.7);
    assert_int_equal(recipe.settings.size, sizeof settings);
    assert_int_equal(recipe.image.size, sizeof(snow_image_options));
    assert_int_equal(recipe.data.size, sizeof(snow_volume_options));
    snow_context_free(context);
}

/* Whether the last message names the record and its initialiser. */
static bool names_initialiser(const snow_context *context, const char *record) {
    const char *message = snow_context_message(context);
    char call[64];
    snprintf(call, sizeof call, "%s_init", record);
    return strstr(message, "size is 0") && strstr(message, call);
}

#define REFUSED(record, call)                      \
    assert_int_equal(call, SNOW_STATUS_BAD_USAGE); \
    assert_true(names_initialiser(context, record))

/* Every call, with a record that was never initialised. */
static void a_size_of_0_is_refused(void **state) {
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    const snow_view view = {.size = 0};
    const snow_settings settings = {.size = 0};
    const snow_volume_options options = {.size = 0};
    const snow_volume_info info = {.size = 0};
    const snow_image_options form = {.size = 0};
    const snow_look look = {.size = 0};
    const snow_extent part = {.size = 0};
    snow_volume_info out = {.size = 0};
    snow_volume_statistics statistics = {.size = 0};
    snow_extent extent = {.size = 0};
    snow_view made = {.size = 0}, good;
    (void)state;
    snow_view_init(&good);
    good.width = good.height = 16;
    const char *path = "phantom:cube";
    REFUSED("snow_volume_options",
            snow_volume_open(context, path, &options, &volume));
    REFUSED("snow_volume_info", snow_volume_inspect(context, path, NULL, &out));
    REFUSED("snow_volume_info", snow_volume_wrap(context, &info, "", &volume));
    assert_null(volume);
    assert_int_equal(snow_volume_open(context, path, NULL, &volume),
                     SNOW_STATUS_OK);
    REFUSED("snow_extent", snow_volume_set_extent(volume, &part));
    REFUSED("snow_extent", snow_volume_get_extent(volume, &extent));
    REFUSED("snow_volume_statistics",
            snow_volume_get_statistics(volume, &statistics));
    REFUSED("snow_view", snow_view_default(volume, &made));
    REFUSED("snow_view", snow_view_from_name(context, "+z", &made));
    REFUSED("snow_look",
            snow_transfer_new_for_volume(volume, &look, &transfer));
    assert_null(transfer);
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    REFUSED("snow_view",
            snow_frame_render(frame, volume, transfer, &view, NULL, &image));
    REFUSED("snow_settings", snow_frame_render(frame, volume, transfer, &good,
                                               &settings, &image));
    assert_null(image);
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &good, NULL, &image),
        SNOW_STATUS_OK);
    REFUSED("snow_image_options", snow_image_save(image, "no.png", &form));
    snow_image_free(image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* On ranks the record of one is an error of all. */
static snow_status render_with_one_bad_record(snow_comm *comm, void *user) {
    snow_context *context = snow_comm_context(comm);
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    snow_view view;
    snow_ranks_options how;
    snow_view_init(&view);
    snow_ranks_options_init(&how);
    view.width = view.height = 16;
    snow_status status = snow_ranks_open(comm, "phantom:cube", NULL, NULL,
                                         &view, NULL, &how, &volume, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(context, &frame);
    if (snow_comm_rank(comm) == 1)
        *(user ? &view.size : &how.size) = 0;
    if (status == SNOW_STATUS_OK &&
        snow_ranks_render(frame, comm, volume, transfer, &view, NULL, &how,
                          &image) != SNOW_STATUS_BAD_USAGE)
        status = SNOW_STATUS_FAILED;
    snow_image_free(image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static void a_size_of_0_on_one_rank_is_refused_by_all(void **state) {
    snow_context *context = support_context();
    int any = 1;
    (void)state;
    assert_int_equal(
        snow_comm_run_threads(context, 3, render_with_one_bad_record, NULL),
        SNOW_STATUS_OK);
    assert_int_equal(
        snow_comm_run_threads(context, 3, render_with_one_bad_record, &any),
        SNOW_STATUS_OK);
    snow_context_free(context);
}

/* A longer record of a newer header is read where what is unknown is 0. */
static void fields_that_are_unknown_are_refused_unless_0(void **state) {
    struct {
        snow_view known;
        double beyond;
    } view;
    snow_context *context = support_context();
    snow_image *image = NULL;
    (void)state;
    snow_view_init_sized(&view.known, sizeof view);
    view.known.width = view.known.height = 16;
    assert_int_equal(
        snow_render_file(context, "phantom:cube", &view.known, NULL, &image),
        SNOW_STATUS_OK);
    snow_image_free(image);
    image = NULL;
    view.beyond = 1;
    assert_int_equal(
        snow_render_file(context, "phantom:cube", &view.known, NULL, &image),
        SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "snow_view: size"));
    assert_null(image);
    snow_context_free(context);
}

/* A shorter record of an older header: what it lacks has its default, or is not
 * written. */
static void records_of_an_older_header_are_read_and_filled(void **state) {
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    snow_volume_options options;
    snow_volume_statistics statistics;
    (void)state;
    memset(&options, 7, sizeof options);
    snow_volume_options_init_sized(&options,
                                   offsetof(snow_volume_options, type));
    options.dims[0] = options.dims[1] = options.dims[2] = 5;
    assert_int_equal(
        snow_volume_open(context, "phantom:cube", &options, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 5);
    assert_int_equal(snow_volume_get_info(volume)->size,
                     sizeof(snow_volume_info));
    memset(&statistics, 7, sizeof statistics);
    snow_volume_statistics_init_sized(&statistics,
                                      offsetof(snow_volume_statistics, min));
    assert_int_equal(snow_volume_get_statistics(volume, &statistics),
                     SNOW_STATUS_OK);
    assert_int_equal(statistics.finite, 125);
    assert_int_equal(*(const unsigned char *)&statistics.min, 7);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Whatever the file is: readers take the number for an index. */
static void less_than_0_levels_are_refused(void **state) {
    static const int64_t wrong[] = {-1, -40, INT64_MIN};
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    (void)state;
    for (int n = 0; n < 3; n++) {
        snow_volume_options options;
        snow_volume_options_init(&options);
        options.levels = wrong[n];
        assert_int_equal(
            snow_volume_open(context, "phantom:cube", &options, &volume),
            SNOW_STATUS_BAD_USAGE);
        assert_null(volume);
        assert_non_null(strstr(snow_context_message(context),
                               "is not a number of levels; give at least 1"));
    }
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_name_leads_back_to_its_value),
        cmocka_unit_test(a_file_is_rendered_in_one_call),
        cmocka_unit_test(a_file_that_is_missing_makes_no_image),
        cmocka_unit_test(initialisers_reach_as_far_as_the_callers_record),
        cmocka_unit_test(initialisers_give_the_documented_defaults),
        cmocka_unit_test(a_size_of_0_is_refused),
        cmocka_unit_test(a_size_of_0_on_one_rank_is_refused_by_all),
        cmocka_unit_test(fields_that_are_unknown_are_refused_unless_0),
        cmocka_unit_test(records_of_an_older_header_are_read_and_filled),
        cmocka_unit_test(less_than_0_levels_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
