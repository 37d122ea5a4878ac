/* tests/transfer/test_recipe.c - a render as JSON: read, refused, written and
 * read again. */
#include "support/support.h"

#include <math.h>
#include <snowglass/recipe.h>

/* Every key but window, none with its default. */
static const char all_keys[] =
    "{\"input\": \"a.raw\", \"output\": \"b_%04d.png\", \"overwrite\": true,"
    " \"depth\": \"d.npy\","
    " \"size\": [640, 480], \"background\": [1, 0.5, 0], \"bits\": 16,"
    " \"mode\": \"mip\", \"threshold\": 10.5, \"encoding\": \"rle\","
    " \"method\": \"footprint\", \"kernel\": \"gauss:5\","
    " \"preset\": \"ct-bone\", \"colormap\": \"viridis\","
    " \"opacity\": [[-10, 0], [0.25, 0.5], [90, 1]],"
    " \"gradient-opacity\": [[0, 0.125], [30, 1]],"
    " \"range\": [\"p1\", \"p99.5\"], \"opacity-unit\": \"mm\","
    " \"shade\": \"none\", \"light\": [30, -40.5], "
    " \"material\": [0.1, 0.3, 0.4, 7],"
    " \"quality\": \"high\", \"view\": \"iso\", \"azimuth\": 1,"
    " \"elevation\": -2, \"roll\": 3.25, \"zoom\": 1.5, \"perspective\": 40,"
    " \"target\": [1, 2.5, -3], \"up\": [0, 0, 1],"
    " \"no-labels\": true, \"legend\": \"T (K)\", \"annotate\": \"time=%g\", "
    "\"box\": \"axes\","
    " \"threads\": 3, \"deterministic\": true, \"isa\": \"scalar\","
    " \"dims\": [5, 6, 7], \"type\": \"int16\", \"spacing\": [1, 2, 0.1],"
    " \"endian\": \"big\", \"offset\": 352, \"time\": 2,"
    " \"channel\": 1, \"component\": \"y\","
    " \"dataset\": \"/a/b\", \"series\": \"1.2\","
    " \"mask\": \"m.nrrd\", \"labels\": \"1,4-7\","
    " \"clip\": [[1, 0, 0.5, -3], [0, -1, 0, 2]], \"crop\": "
    "[[1, 5], [0, 0], [3, "
    "0]]}";

static snow_status parse(snow_context *context, const char *text,
                         snow_recipe *out) {
    return snow_recipe_parse(context, "text", text, strlen(text), out);
}

/* The text of a recipe; the caller frees it. */
static char *write_text(snow_context *context, const snow_recipe *recipe) {
    size_t length, again;
    assert_int_equal(snow_recipe_write(context, recipe, NULL, 0, &length),
                     SNOW_STATUS_OK);
    char *text = malloc(length + 1);
    assert_int_equal(
        snow_recipe_write(context, recipe, text, length + 1, &again),
        SNOW_STATUS_OK);
    assert_int_equal(length, again);
    assert_int_equal(strlen(text), length);
    return text;
}

static void every_key_reaches_its_field(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_recipe r = {.size = sizeof r};
    assert_int_equal(parse(context, all_keys, &r), SNOW_STATUS_OK);
    assert_string_equal(r.input, "a.raw");
    assert_string_equal(r.output, "b_%04d.png");
    assert_string_equal(r.depth, "d.npy");
    assert_true(r.image.overwrite && r.image.flatten && r.image.bits == 16);
    assert_true(r.image.background[1] == 0.5);
    assert_true(r.width == 640 && r.height == 480);
    assert_true(r.settings.threshold == 10.5);
    assert_int_equal(r.settings.mode, SNOW_MODE_MIP);
    assert_int_equal(r.settings.encoding, SNOW_ENCODING_RLE);
    assert_int_equal(r.settings.method, SNOW_METHOD_FOOTPRINT);
    assert_int_equal(r.settings.kernel, SNOW_KERNEL_GAUSS);
    assert_int_equal(r.settings.footprint, 5);
    assert_string_equal(r.preset, "ct-bone");
    assert_string_equal(r.colormap, "viridis");
    assert_int_equal(r.opacity_count, 3);
    assert_true(r.opacities[1].value == 0.25 && r.opacities[1].opacity == 0.5);
    assert_int_equal(r.gradient_opacity_count, 2);
    assert_true(r.gradient_opacities[0].opacity == 0.125 &&
                r.gradient_opacities[1].value == 30);
    assert_int_equal(r.range, SNOW_RANGE_PERCENTILES);
    assert_true(r.low == 1 && r.high == 99.5);
    assert_true(r.opacity_per_mm);
    assert_int_equal(r.settings.shade, SNOW_SHADE_NONE);
    assert_int_equal(r.settings.light, SNOW_LIGHT_DIRECTION);
    assert_true(r.settings.light_azimuth == 30 &&
                r.settings.light_elevation == -40.5);
    assert_true(r.settings.ambient == 0.1 && r.settings.diffuse == 0.3 &&
                r.settings.specular == 0.4 && r.settings.shininess == 7);
    assert_int_equal(r.settings.quality, SNOW_QUALITY_HIGH);
    assert_string_equal(r.view, "iso");
    assert_true(r.no_labels && r.legend);
    assert_string_equal(r.legend_title, "T (K)");
    assert_string_equal(r.annotate, "time=%g");
    assert_string_equal(r.box, "axes");
    assert_true(isnan(r.position[0]) && r.target[1] == 2.5 && r.up[2] == 1);
    assert_true(r.azimuth == 1 && r.elevation == -2 && r.roll == 3.25);
    assert_true(r.zoom == 1.5 && r.fov == 40);
    assert_int_equal(r.settings.threads, 3);
    assert_true(r.settings.deterministic);
    assert_int_equal(r.settings.isa, SNOW_ISA_SCALAR);
    assert_true(r.data.dims[2] == 7 && r.data.type == SNOW_TYPE_INT16);
    assert_true(r.data.spacing[2] == 0.1);
    assert_int_equal(r.data.endian, SNOW_ENDIAN_BIG);
    assert_true(r.data.offset == 352 && r.data.time == 2);
    assert_true(r.data.channel == 1);
    assert_string_equal(r.data.dataset, "/a/b");
    assert_string_equal(r.data.series, "1.2");
    assert_string_equal(r.data.component, "y");
    assert_string_equal(r.data.mask, "m.nrrd");
    assert_string_equal(r.data.labels, "1,4-7");
    assert_true(r.data.clip[0][2] == 0.5 && r.data.clip[1][1] == -1);
    assert_true(r.data.crop[0][1] == 5 && r.data.crop[2][0] == 3);
    snow_recipe_clear(&r);
    snow_context_free(context);
}

static void what_is_written_reads_as_it_was(void **state) {
    (void)state;
    static const char *const texts[] = {all_keys,
                                        "{}",
                                        "{\"range\": \"full\"}",
                                        "{\"range\": [-1e-3, 0.1]}",
                                        "{\"window\": [0.2, 7]}",
                                        "{\"size\": 9, \"mode\": \"MIP\"}",
                                        "{\"view\": \"Axial\"}",
                                        "{\"light\": \"key\"}",
                                        "{\"light\": \"head\"}",
                                        "{\"light\": [0, 0]}",
                                        "{\"background\": \"#ff8000\"}"};
    snow_context *context = support_context();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        snow_recipe a = {.size = sizeof a}, b = {.size = sizeof b};
        assert_int_equal(parse(context, texts[i], &a), SNOW_STATUS_OK);
        char *text = write_text(context, &a);
        assert_int_equal(parse(context, text, &b), SNOW_STATUS_OK);
        char *again = write_text(context, &b);
        assert_string_equal(text, again);
        assert_int_equal(a.range, b.range);
        assert_true(a.low == b.low && a.high == b.high);
        assert_true(a.image.flatten == b.image.flatten);
        assert_memory_equal(&a.settings, &b.settings, sizeof a.settings);
        assert_int_equal(a.data.dataset == NULL, b.data.dataset == NULL);
        assert_int_equal(a.data.series == NULL, b.data.series == NULL);
        assert_int_equal(a.depth == NULL, b.depth == NULL);
        assert_int_equal(a.data.component == NULL, b.data.component == NULL);
        a.data.dataset = b.data.dataset = NULL;
        a.data.component = b.data.component = NULL;
        a.data.series = b.data.series = NULL;
        assert_int_equal(a.data.mask == NULL, b.data.mask == NULL);
        assert_int_equal(a.data.labels == NULL, b.data.labels == NULL);
        a.data.mask = b.data.mask = NULL;
        a.data.labels = b.data.labels = NULL;
        assert_memory_equal(&a.data, &b.data, sizeof a.data);
        free(again);
        free(text);
        snow_recipe_clear(&a);
        snow_recipe_clear(&b);
    }
    snow_context_free(context);
}

static void an_empty_recipe_is_the_defaults(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_recipe a = {.size = sizeof a}, b = {.size = sizeof b};
    snow_recipe_init(&a);
    assert_int_equal(parse(context, "{}", &b), SNOW_STATUS_OK);
    snow_recipe_clear(&b);
    assert_memory_equal(&a, &b, sizeof a);
    snow_context_free(context);
}

static void other_kinds_of_values_are_kept(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_recipe r = {.size = sizeof r};
    assert_int_equal(parse(context, "{\"overlay-look\": \"hot,0.5\"}", &r),
                     SNOW_STATUS_OK);
    assert_string_equal(r.overlay_look, "hot,0.5");
    char *text = write_text(context, &r);
    assert_non_null(strstr(text, "\"overlay-look\": \"hot,0.5\""));
    free(text);
    snow_recipe_clear(&r);
    assert_int_equal(parse(context, "{\"time\": \"2:8\"}", &r), SNOW_STATUS_OK);
    assert_string_equal(r.steps, "2:8");
    text = write_text(context, &r);
    assert_non_null(strstr(text, "\"time\": \"2:8\""));
    free(text);
    snow_recipe_clear(&r);
    snow_context_free(context);
}

static void a_wrong_recipe_is_refused_by_its_key(void **state) {
    (void)state;
    static const char *const wrong[][2] = {
        {"{\"colourmap\": \"hot\"}", "\"colourmap\" is not a key"},
        {"{\"colormap\": \"nothing\"}", "must be one of grey"},
        {"{\"size\": [640]}", "\"size\" must be [width, height]"},
        {"{\"size\": [640, 0]}", "\"size\" must be"},
        {"{\"target\": [1, 2]}", "\"target\" must be an array of 3"},
        {"{\"zoom\": 0}", "\"zoom\" must be a number from"},
        {"{\"kernel\": \"tent:10\"}", "from 2 to 9"},
        {"{\"azimuth\": \"30\"}", "\"azimuth\" must be a number"},
        {"{\"opacity\": [[0, 0], [-1, 1]]}", "values that do not decrease"},
        {"{\"opacity\": [[0, 1.5]]}", "opacities 0 to 1"},
        {"{\"gradient-opacity\": [[0, 2]]}", "\"gradient-opacity\" must be"},
        {"{\"opacity\": []}", "\"opacity\" must be"},
        {"{\"opacity\": 0.5}", "\"opacity\" must be"},
        {"{\"time\": 0.5}", "\"time\" must be a number, or a text"},
        {"{\"overlay-opacity\": 1}", "\"overlay-opacity\" is now"},
        {"{\"range\": [2, 1]}", "\"range\" must be"},
        {"{\"range\": [\"p1\", 3]}", "\"range\" must be"},
        {"{\"range\": [\"p1\", \"p101\"]}", "\"range\" must be"},
        {"{\"background\": \"#12345\"}", "\"background\" must be"},
        {"{\"background\": \"#1010-8\"}", "\"background\" must be"},
        {"{\"range\": [\"p 1\", \"p99\"]}", "\"range\" must be"},
        {"{\"window\": [1.7e308, 1.7e308]}", "\"window\" must be"},
        {"{\"window\": [1e-300, 1e308]}", "\"window\" must be"},
        {"{\"background\": [0, 0, 2]}", "\"background\" must be"},
        {"{\"window\": 3}", "\"window\" must be"},
        {"{\"window\": [3, 1, 1]}", "\"window\" must be"},
        {"{\"window\": [0, 1]}", "\"window\" must be"},
        {"{\"kernel\": \"gauss:1\"}", "\"kernel\" must be NAME:N"},
        {"{\"kernel\": \"gausss:3\"}", "\"kernel\" must be one of"},
        {"{\"footprint\": 3}", "\"footprint\" is now \"kernel\""},
        {"{\"scale\": \"symlog:0\"}", "\"scale\" must be"},
        {"{\"scale\": \"symlog:\"}", "\"scale\" must be"},
        {"{\"material\": [0.1, 0.2, 1.1, 2]}", "\"material\" must be"},
        {"{\"annotate\": \"date\"}", "\"annotate\" must be"},
        {"{\"legend\": 3}", "\"legend\" must be"},
        {"{\"box\": true}", "\"box\" must be one of"},
        {"{\"level\": 1}", "\"level\" is now \"window\": [width, centre]"},
        {"{\"size\": 0}", "\"size\" must be"},
        {"{\"window\": [3, 1], \"range\": [0, 1]}", "\"window\" must be"},
        {"{\"type\": \"int12\"}", "\"type\" must be one of"},
        {"{\"overwrite\": 1}", "true or false"},
        {"{\"mode\": \"most\"}", "\"mode\" must be one of"},
        {"{\"roll\": 1, \"roll\": 2}", "duplicate"},
        {"{\"labels\": \"1-\"}", "\"labels\" must be a text of whole numbers"},
        {"{\"labels\": 3}", "\"labels\" must be"},
        {"{\"clip\": [[0, 0, 0, 1]]}", "\"clip\" must be [[a, b, c, d], ...]"},
        {"{\"clip\": [1, 0, 0, 1]}", "\"clip\" must be"},
        {"{\"light\": \"sun\"}", "\"light\" must be \"key\", \"head\" or"},
        {"{\"light\": [1, 2, 3]}", "\"light\" must be"},
        {"{\"depth\": true}", "\"depth\" must be a text"},
        {"{\"mask\": 3}", "\"mask\" must be"},
        {"{\"crop\": [[1, 5], [3, 2], [0, 0]]}", "\"crop\" must be"},
        {"[1]", "one JSON object"},
        {"{\n\"roll\": }", "line 2"},
        {"", "not valid JSON"}};
    snow_context *context = support_context();
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snow_recipe r = {.size = sizeof r};
        assert_int_equal(parse(context, wrong[i][0], &r),
                         SNOW_STATUS_BAD_INPUT);
        if (!strstr(snow_context_message(context), wrong[i][1]))
            fail_msg("%s: %s", wrong[i][0], snow_context_message(context));
    }
    snow_recipe r = {.size = sizeof r};
    assert_int_equal(snow_recipe_load(context, "no/such/recipe.json", &r),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(context), "cannot be opened"));
    snow_context_free(context);
}

static void other_spellings_mean_the_same(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_recipe a = {.size = sizeof a}, b = {.size = sizeof b};
    assert_int_equal(parse(context,
                           "{\"size\": 40, \"window\": [300, 120],"
                           " \"mode\": \"MIP\", \"quality\": \"HIGH\","
                           " \"fit\": \"Volume\", \"type\": \"UINT8\","
                           " \"light\": \"Head\"}",
                           &a),
                     SNOW_STATUS_OK);
    assert_int_equal(parse(context,
                           "{\"size\": [40, 40], \"range\": [-30, 270],"
                           " \"mode\": \"mip\", \"quality\": \"high\","
                           " \"fit\": \"volume\", \"type\": \"uint8\","
                           " \"light\": \"head\"}",
                           &b),
                     SNOW_STATUS_OK);
    char *one = write_text(context, &a), *other = write_text(context, &b);
    assert_string_equal(one, other);
    free(one);
    free(other);
    snow_recipe_clear(&a);
    snow_recipe_clear(&b);
    snow_context_free(context);
}

static void a_view_without_a_name_is_the_usual_one_turned(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_recipe r = {.size = sizeof r};
    snow_view usual = {.size = sizeof usual}, named = {.size = sizeof named},
              view = {.size = sizeof view};
    assert_int_equal(snow_view_from_name(context, "left", &usual),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_view_from_name(context, "iso", &named),
                     SNOW_STATUS_OK);
    assert_int_equal(parse(context, "{\"azimuth\": 5, \"size\": [9, 8]}", &r),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_recipe_get_view(context, &r, &usual, &view),
                     SNOW_STATUS_OK);
    assert_memory_equal(view.back, usual.back, sizeof view.back);
    assert_true(view.azimuth == 5 && view.width == 9 && view.height == 8);
    assert_false(view.has_position || view.has_target || view.has_view_up);
    r.view = "iso";
    assert_int_equal(snow_recipe_get_view(context, &r, &usual, &view),
                     SNOW_STATUS_OK);
    assert_memory_equal(view.back, named.back, sizeof view.back);
    snow_recipe_clear(&r);
    assert_int_equal(
        parse(context, "{\"position\": [1, 2, -3.5], \"up\": [0, 1, 0]}", &r),
        SNOW_STATUS_OK);
    assert_int_equal(snow_recipe_get_view(context, &r, &usual, &view),
                     SNOW_STATUS_OK);
    assert_true(view.has_position && !view.has_target && view.has_view_up);
    assert_true(view.position[2] == -3.5 && view.view_up[1] == 1);
    r.view = "iso";
    assert_int_equal(snow_recipe_get_view(context, &r, &usual, &view),
                     SNOW_STATUS_BAD_USAGE);
    snow_recipe_clear(&r);
    snow_context_free(context);
}

static void opacities_per_millimetre_follow_the_unit(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_recipe r = {.size = sizeof r};
    snow_settings s;
    snow_settings_init(&s);
    snow_recipe_init(&r);
    assert_int_equal(snow_recipe_get_settings(context, &r, "furlong", &s),
                     SNOW_STATUS_OK);
    assert_true(s.opacity_length == 0);
    r.opacity_per_mm = true;
    assert_int_equal(snow_recipe_get_settings(context, &r, "um", &s),
                     SNOW_STATUS_OK);
    assert_true(s.opacity_length == 1000);
    assert_int_equal(snow_recipe_get_settings(context, &r, "furlong", &s),
                     SNOW_STATUS_BAD_USAGE);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_reaches_its_field),
        cmocka_unit_test(what_is_written_reads_as_it_was),
        cmocka_unit_test(an_empty_recipe_is_the_defaults),
        cmocka_unit_test(other_kinds_of_values_are_kept),
        cmocka_unit_test(a_wrong_recipe_is_refused_by_its_key),
        cmocka_unit_test(other_spellings_mean_the_same),
        cmocka_unit_test(a_view_without_a_name_is_the_usual_one_turned),
        cmocka_unit_test(opacities_per_millimetre_follow_the_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
