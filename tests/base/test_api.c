/* test_api.c - what holds for the public interface as a whole: names that lead
 * back to their values, records that grow. */
#include "support/support.h"

#include <math.h>
#include <snowglass/extend.h>
#include <snowglass/look_file.h>
#include <snowglass/recipe.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <string.h>

#define EACH_VALUE_HAS_A_NAME(word)                                          \
    for (int i = 0; snow_##word##_name((snow_##word)i); i++)                 \
        assert_int_equal(                                                    \
            snow_##word##_from_name(snow_##word##_name((snow_##word)i)), i); \
    assert_null(snow_##word##_name((snow_##word) - 1));                      \
    assert_null(snow_##word##_name((snow_##word)1000));                      \
    assert_int_equal(snow_##word##_from_name(NULL), -1);                     \
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

/* --- arguments ------------------------------------------------------------ */

static void a_text_that_is_null_is_none(void **state) {
    snow_label_range range;
    size_t count = 0;
    (void)state;
    assert_int_equal(snow_type_from_name(NULL), SNOW_TYPE_NONE);
    assert_int_equal(snow_preset_from_name(NULL), -1);
    assert_int_equal(snow_colormap_from_name(NULL), -1);
    assert_true(snow_unit_length(NULL, NULL) == 0);
    assert_false(snow_labels_parse(NULL, &range, 1, &count));
    assert_int_equal(snow_image_format_bits(NULL), -1);
    assert_false(snow_image_format_has_depth(NULL));
    assert_true(strlen(snow_context_message(NULL)) > 0);
}

#define NO_PATH(call)                              \
    assert_int_equal(call, SNOW_STATUS_BAD_USAGE); \
    assert_non_null(strstr(snow_context_message(context), "NULL"))

static void a_path_that_is_null_is_refused(void **state) {
    snow_context *context = support_context();
    snow_volume *volume = NULL, *cube = NULL;
    snow_image *image = NULL, *other = NULL;
    snow_look_file *look = NULL;
    snow_volume_info info = {.size = sizeof info};
    (void)state;
    NO_PATH(snow_volume_open(context, NULL, NULL, &volume));
    NO_PATH(snow_volume_inspect(context, NULL, NULL, &info));
    NO_PATH(snow_volume_open_streamed(context, NULL, NULL, 0, &volume));
    NO_PATH(snow_render_file(context, NULL, NULL, NULL, &image));
    NO_PATH(snow_image_load(context, NULL, &image));
    NO_PATH(snow_image_check(context, NULL, 1, 1, NULL));
    NO_PATH(snow_look_load(context, NULL, &look));
    assert_true(!volume && !image && !look);
    assert_int_equal(snow_image_new(context, 1, 1, 4, &other), SNOW_STATUS_OK);
    NO_PATH(snow_image_save(other, NULL, NULL));
    assert_int_equal(snow_volume_open(context, "phantom:cube", NULL, &cube),
                     SNOW_STATUS_OK);
    NO_PATH(snow_volume_save(cube, NULL, false));
    snow_volume_close(cube);
    snow_image_free(other);
    snow_context_free(context);
}

/* Wraps 2x2x2 voxels of a spacing; returns the status. */
static snow_status wrap_spacing(snow_context *context, double spacing) {
    static const uint8_t voxels[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const snow_volume_info info = {.size = sizeof info,
                                   .dims = {2, 2, 2},
                                   .type = SNOW_TYPE_UINT8,
                                   .spacing = {1, spacing, 0}};
    snow_volume *volume = NULL;
    snow_status status = snow_volume_wrap(context, &info, voxels, &volume);
    if (status == SNOW_STATUS_OK) {
        const snow_volume_info *known = snow_volume_get_info(volume);
        assert_true(known->spacing[1] == spacing && known->spacing[2] == 1 &&
                    known->matrix[1][1] == spacing);
    }
    assert_int_equal(!volume, status != SNOW_STATUS_OK);
    snow_volume_close(volume);
    return status;
}

static void wrapped_voxels_take_a_spacing_or_three_rows(void **state) {
    static const uint8_t voxels[8] = {0};
    static const double rows[3][4] = {{0, 2, 0, 5}, {3, 0, 0, 6}, {0, 0, 4, 7}};
    snow_context *context = support_context();
    snow_volume_info info = {
        .size = sizeof info, .dims = {2, 2, 2}, .type = SNOW_TYPE_UINT8};
    snow_volume *volume = NULL;
    (void)state;
    assert_int_equal(wrap_spacing(context, 2.5), SNOW_STATUS_OK);
    assert_int_equal(wrap_spacing(context, -1), SNOW_STATUS_BAD_USAGE);
    assert_int_equal(wrap_spacing(context, (double)NAN), SNOW_STATUS_BAD_USAGE);
    memcpy(info.matrix, rows, sizeof rows);
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    const snow_volume_info *known = snow_volume_get_info(volume);
    assert_true(known->matrix[3][3] == 1 && known->matrix[0][3] == 5);
    assert_true(known->spacing[0] == 3 && known->spacing[1] == 2);
    snow_volume_close(volume);
    info.matrix[3][3] = 2;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_BAD_USAGE);
    memset(info.matrix[2], 0, sizeof info.matrix[2]);
    info.matrix[3][3] = 1;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_BAD_USAGE);
    assert_null(strstr(snow_context_message(context), "header"));
    snow_context_free(context);
}

static void planes_without_a_normal_are_refused(void **state) {
    static const double planes[][4] = {{(double)NAN, 0, 0, 1},
                                       {1, 0, 0, (double)NAN},
                                       {1, 0, 0, (double)INFINITY},
                                       {0, 0, 0, 1}};
    static const double none[4] = {0};
    snow_context *context = support_context();
    snow_volume *volume = NULL, *made = NULL;
    (void)state;
    assert_int_equal(snow_volume_open(context, "phantom:cube", NULL, &volume),
                     SNOW_STATUS_OK);
    for (size_t n = 0; n < sizeof planes / sizeof *planes; n++) {
        snow_volume_options options = {.size = sizeof options};
        memcpy(options.clip[1], planes[n], sizeof planes[n]);
        assert_int_equal(snow_volume_clip(volume, planes[n], 1, &made),
                         SNOW_STATUS_BAD_USAGE);
        assert_int_equal(
            snow_volume_open(context, "phantom:cube", &options, &made),
            SNOW_STATUS_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(context), "clip plane"));
        assert_null(made);
    }
    assert_int_equal(snow_volume_clip(volume, none, 1, &made), SNOW_STATUS_OK);
    snow_volume_close(made);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_range_that_is_none_is_refused(void **state) {
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_look look = {.size = sizeof look, .range = (snow_range)99};
    (void)state;
    assert_int_equal(snow_volume_open(context, "phantom:cube", NULL, &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_BAD_USAGE);
    look.range = (snow_range)-1;
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_BAD_USAGE);
    assert_null(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Values are no colours, and a background is 0 to 1, as in files. */
static void levels_are_made_of_colours_alone(void **state) {
    const snow_image_options black = {.size = sizeof black, .flatten = true};
    const snow_image_options seven = {
        .size = sizeof seven, .flatten = true, .background = {7}};
    unsigned char rgb[3] = {9, 9, 9};
    snow_context *context = support_context();
    snow_image *values = NULL, *colors = NULL;
    (void)state;
    assert_int_equal(snow_image_new(context, 1, 1, 1, &values), SNOW_STATUS_OK);
    assert_int_equal(snow_image_new(context, 1, 1, 4, &colors), SNOW_STATUS_OK);
    assert_ptr_equal(snow_image_data(colors), snow_image_pixels(colors));
    snow_image_pixels(values)[0] = 1;
    assert_int_equal(snow_image_to_rgb8(values, &black, rgb),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_image_to_rgb8(values, NULL, rgb),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_image_to_rgb8(colors, &seven, rgb),
                     SNOW_STATUS_BAD_USAGE);
    assert_true(rgb[0] == 9 && rgb[2] == 9);
    assert_int_equal(snow_image_to_rgb8(colors, &black, rgb), SNOW_STATUS_OK);
    assert_true(rgb[0] == 0 && rgb[2] == 0);
    snow_image_free(values);
    snow_image_free(colors);
    snow_context_free(context);
}

static void shapes_without_a_place_are_refused(void **state) {
    const double nan = (double)NAN;
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_overlay *o = NULL;
    (void)state;
    assert_int_equal(snow_overlay_new(context, 200, 200, &o), SNOW_STATUS_OK);
    assert_int_equal(snow_overlay_text(o, nan, 9, 0, 0, 12, "A"),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_overlay_text(o, 9, 9, 0, 0, -12, "A"),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_overlay_text(o, 9, 9, 0, 0, nan, "A"),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_overlay_text(o, 9, 9, 0, 0, 12, "A"), SNOW_STATUS_OK);
    assert_int_equal(snow_volume_open(context, "phantom:cube", NULL, &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_overlay_color_bar(o, transfer, NULL, NULL, 3, 1),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_overlay_color_bar(o, transfer, NULL, NULL, -1, 1),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_overlay_color_bar(o, transfer, NULL, NULL, 0, 1),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_overlay_orientation(o, snow_volume_get_info(volume), NULL),
        SNOW_STATUS_OK);
    snow_overlay_free(o);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* What #if sees is what the library says of itself. */
static void the_number_of_the_version_has_its_parts(void **state) {
    char text[32];
    (void)state;
#if SNOWGLASS_VERSION_NUMBER < 1000
    fail();
#endif
    snprintf(text, sizeof text, "%d.%d.%d", SNOWGLASS_VERSION_NUMBER / 1000000,
             SNOWGLASS_VERSION_NUMBER / 1000 % 1000,
             SNOWGLASS_VERSION_NUMBER % 1000);
    assert_string_equal(text, snow_version());
}

/* The keys that a cleared recipe writes are those of a new one. */
static void a_cleared_recipe_is_a_new_one(void **state) {
    static const char text[] = "{\"input\": \"a.nrrd\", \"zoom\": 2}";
    snow_context *context = support_context();
    char cleared[4096], fresh[4096];
    size_t length = 0;
    snow_recipe recipe, other;
    (void)state;
    snow_recipe_init(&recipe);
    snow_recipe_init(&other);
    assert_int_equal(
        snow_recipe_parse(context, "text", text, sizeof text - 1, &recipe),
        SNOW_STATUS_OK);
    assert_string_equal(recipe.input, "a.nrrd");
    snow_recipe_clear(&recipe);
    assert_null(recipe.input);
    assert_int_equal(
        snow_recipe_write(context, &recipe, cleared, sizeof cleared, &length),
        SNOW_STATUS_OK);
    assert_int_equal(
        snow_recipe_write(context, &other, fresh, sizeof fresh, &length),
        SNOW_STATUS_OK);
    assert_string_equal(cleared, fresh);
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
        cmocka_unit_test(a_text_that_is_null_is_none),
        cmocka_unit_test(a_path_that_is_null_is_refused),
        cmocka_unit_test(wrapped_voxels_take_a_spacing_or_three_rows),
        cmocka_unit_test(planes_without_a_normal_are_refused),
        cmocka_unit_test(a_range_that_is_none_is_refused),
        cmocka_unit_test(levels_are_made_of_colours_alone),
        cmocka_unit_test(shapes_without_a_place_are_refused),
        cmocka_unit_test(the_number_of_the_version_has_its_parts),
        cmocka_unit_test(a_cleared_recipe_is_a_new_one),
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
