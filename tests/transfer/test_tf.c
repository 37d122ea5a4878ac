/* tests/transfer/test_tf.c - transfer functions of other programs, by what
 * those make of them, and our own to the last bit.  Numbers of VTK are those of
 * VTK 9.1. */
#include "support/files.h"

#include <math.h>
#include <snowglass/look_file.h>

static char remark[1024];

static void listen(void *user, const char *text) {
    (void)user;
    snprintf(remark, sizeof remark, "%s", text);
}

static snow_look_file *take(snow_context *context, const char *name,
                            const void *bytes, size_t size,
                            const char *wanted) {
    snow_look_file *tf = NULL;
    remark[0] = 0;
    snow_context_set_warning(context, listen, NULL);
    if (snow_look_parse(context, name, bytes, size, wanted, &tf) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return tf;
}

static snow_look_file *take_text(snow_context *context, const char *name,
                                 const char *text) {
    return take(context, name, text, strlen(text), NULL);
}

static void look_up(const snow_look_file *tf, double value, double rgba[4]) {
    static const snow_color_point white[] = {{0, 1, 1, 1}};
    static const snow_opacity_point solid[] = {{0, 1}};
    const snow_look *p = snow_look_file_look(tf);
    snow_context *context = support_context();
    snow_transfer *transfer = NULL;
    assert_int_equal(
        snow_transfer_new(context, p->color_count ? p->colors : white,
                          p->color_count ? p->color_count : 1,
                          p->opacity_count ? p->opacities : solid,
                          p->opacity_count ? p->opacity_count : 1, &transfer),
        SNOW_STATUS_OK);
    snow_transfer_evaluate(transfer, value, rgba);
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void expect(const snow_look_file *tf, double value, double r, double g,
                   double b, double a, double bound) {
    double rgba[4], wanted[4] = {r, g, b, a};
    look_up(tf, value, rgba);
    for (int i = 0; i < 4; i++)
        if (fabs(rgba[i] - wanted[i]) > bound)
            fail_msg("channel %d at %g is %g, not %g", i, value, rgba[i],
                     wanted[i]);
}

/* --- the formats ---------------------------------------------------------- */

static const char vp[] =
    "1\n1\n0.9\n0.1\n0.2\n10\n"
    "8 -3024 0 100 0 300 0.5 3071 0.8\n6 0 0.1 20 0.5 255 1\n"
    "12 -3024 0 0 0 200 0.9 0.5 0.25 3071 1 1 1\n";

static void a_volume_property_of_slicer(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_look_file *tf = take_text(context, "dir/My CT.vp", vp);
    const snow_look *p = snow_look_file_look(tf);
    assert_string_equal(snow_look_file_format(tf), "slicer-vp");
    assert_string_equal(p->name, "My CT");
    assert_int_equal(p->domain, SNOW_DOMAIN_DATA);
    assert_int_equal(p->color_count, 3);
    assert_int_equal(p->opacity_count, 4);
    assert_int_equal(p->gradient_opacity_count, 3);
    assert_true(p->gradient_opacities[1].value == 20 &&
                p->gradient_opacities[1].opacity == 0.5);
    expect(tf, 200, 0.9, 0.5, 0.25, 0.25, 1e-12);
    assert_non_null(strstr(remark, "--material 0.1,0.9,0.2,10 (ambient"));
    snow_look_file_free(tf);
    tf = take_text(context, "no suffix", vp);
    assert_string_equal(snow_look_file_format(tf), "slicer-vp");
    snow_look_file_free(tf);
    snow_context_free(context);
}

static const char presets[] =
    "<MRML>\n<VolumeProperty name=\"CT-Fat\" scalarOpacity=\"4 -200 0 100 0.5\""
    " gradientOpacity=\"4 0 1 255 1\" colorTransfer=\"4 0 1 0 0\"/>\n"
    "<VolumeProperty name=\"CT-Bone\" scalarOpacity=\"4 150 0 900 0.75\" "
    "colorTransfer=\"8 150 0 0 0 900 1 1 1\"/></MRML>";

static void a_preset_of_slicer_by_name(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_look_file *tf = NULL;
#if SNOW_HAVE_EXPAT
    tf = take(context, "presets.xml", presets, strlen(presets), "ct_bone");
    assert_string_equal(snow_look_file_look(tf)->name, "CT-Bone");
    assert_string_equal(snow_look_file_format(tf), "slicer-xml");
    expect(tf, 525, 0.5, 0.5, 0.5, 0.375, 1e-12);
    snow_look_file_free(tf);
    tf = take_text(context, "presets.xml", presets);
    assert_string_equal(snow_look_file_look(tf)->name, "CT-Fat");
    assert_non_null(strstr(remark, "2 presets"));
    snow_look_file_free(tf);
    tf = NULL;
    assert_int_equal(snow_look_parse(context, "p.xml", presets, strlen(presets),
                                     "CT-Skin", &tf),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(context), "'CT-Skin'"));
#else
    assert_int_equal(
        snow_look_parse(context, "p.xml", presets, strlen(presets), NULL, &tf),
        SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(context), "expat"));
#endif
    assert_null(tf);
    snow_context_free(context);
}

/* Where VTK has (r, g, b) at parts of the way between two colours. */
static void check_space(const char *space, const double expected[3][3]) {
    static const double parts[3] = {0.25, 0.5, 0.6};
    char text[512];
    snow_context *context = support_context();
    snprintf(text, sizeof text,
             "[{\"ColorSpace\": \"%s\", \"Name\": \"two\", \"RGBPoints\": "
             "[10, 0.23, 0.3, 0.75, 20, 0.7, 0.02, 0.15]}]",
             space);
    snow_look_file *tf = take_text(context, "a.json", text);
    assert_string_equal(snow_look_file_format(tf), "paraview");
    assert_string_equal(snow_look_file_look(tf)->name, "two");
    for (int i = 0; i < 3; i++)
        expect(tf, 10 + 10 * parts[i], expected[i][0], expected[i][1],
               expected[i][2], 1, 0.002);
    expect(tf, 10, 0.23, 0.3, 0.75, 1, 1e-12);
    expect(tf, 20, 0.7, 0.02, 0.15, 1, 1e-12);
    snow_look_file_free(tf);
    snow_context_free(context);
}

static void colour_spaces_of_paraview_are_those_of_vtk(void **state) {
    (void)state;
    check_space("Lab", (const double[3][3]){{0.46363, 0.25494, 0.59315},
                                            {0.57647, 0.20432, 0.44193},
                                            {0.60881, 0.18118, 0.38296}});
    check_space("Diverging", (const double[3][3]){{0.54472, 0.68863, 0.99177},
                                                  {0.8654, 0.86541, 0.8654},
                                                  {0.94457, 0.79448, 0.71431}});
    check_space("HSV", (const double[3][3]){{0.37251, 0.17489, 0.7375},
                                            {0.6267, 0.12152, 0.725},
                                            {0.72, 0.10066, 0.70052}});
    check_space("RGB", (const double[3][3]){{0.3475, 0.23, 0.6},
                                            {0.465, 0.16, 0.45},
                                            {0.512, 0.132, 0.39}});
    check_space("Step", (const double[3][3]){{0.7, 0.02, 0.15},
                                             {0.7, 0.02, 0.15},
                                             {0.7, 0.02, 0.15}});
}

static void midpoints_and_sharpness_are_those_of_vtk(void **state) {
    (void)state;
    static const double at[] = {0.1, 0.3, 0.6,    1.2,    1.4,
                                1.7, 2.3, 2.4999, 2.5001, 2.8};
    static const double expected[] = {0.16667, 0.5, 0.71429, 0.99918, 0.92876,
                                      0.20997, 0.2, 0.2,     0.9,     0.9};
    snow_context *context = support_context();
    snow_look_file *tf = take_text(context, "a.json",
                                   "{\"Points\": [0,0,0.3,0, 1,1,0.5,0.5, "
                                   "2,0.2,0.5,1, 3,0.9,0.5,0]}");
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        expect(tf, at[i], 1, 1, 1, expected[i], 0.003);
    snow_look_file_free(tf);
    snow_context_free(context);
}

static void a_map_of_niivue(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_look_file *tf =
        take_text(context, "ct_bones.json",
                  "{\"R\":[0,51,255],\"G\":[0,0,255],\"B\":[0,0,0],"
                  "\"A\":[0,51,102],\"I\":[0,51,255],"
                  "\"min\":100,\"max\":355}");
    assert_string_equal(snow_look_file_format(tf), "niivue");
    assert_string_equal(snow_look_file_look(tf)->name, "ct_bones");
    assert_int_equal(snow_look_file_look(tf)->domain, SNOW_DOMAIN_DATA);
    expect(tf, 151, 0.2, 0, 0, 0.2, 1e-12);
    expect(tf, 355, 1, 1, 0, 0.4, 1e-12);
    snow_look_file_free(tf);
    tf =
        take_text(context, "a.json", "{\"R\":[0,255],\"G\":[0,0],\"B\":[0,0]}");
    assert_int_equal(snow_look_file_look(tf)->domain, SNOW_DOMAIN_RANGE);
    expect(tf, 0.5, 0.5, 0, 0, 0.5, 1e-12);
    snow_look_file_free(tf);
    snow_context_free(context);
}

static void palettes_of_amrvis(void **state) {
    (void)state;
    unsigned char bytes[1024];
    for (int i = 0; i < 256; i++) {
        bytes[i] = (unsigned char)i;
        bytes[i + 256] = (unsigned char)(255 - i);
        bytes[i + 512] = 51;
        bytes[i + 768] = (unsigned char)(i * 100 / 255);
    }
    snow_context *context = support_context();
    snow_look_file *tf = take(context, "a.pal", bytes, 1024, NULL);
    assert_string_equal(snow_look_file_format(tf), "pal");
    assert_int_equal(snow_look_file_look(tf)->domain, SNOW_DOMAIN_RANGE);
    expect(tf, 0.2, 0.2, 0.8, 0.2, 0.2, 1e-12);
    expect(tf, 1, 1, 0, 0.2, 1, 1e-12);
    snow_look_file_free(tf);
    tf = take(context, "a", bytes, 768, NULL);
    assert_int_equal(snow_look_file_look(tf)->opacity_count, 0);
    assert_int_equal(snow_look_file_look(tf)->color_count, 256);
    snow_look_file_free(tf);
    snow_context_free(context);
}

static void tables_with_and_without_a_head(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_look_file *tf = take_text(context, "a.csv",
                                   "# mine\nvalue,red,green,blue,opacity\r\n"
                                   "0,0,0,0,0\r\n\n100,255,128,0,0.5\n");
    expect(tf, 50, 0.5, 64 / 255.0, 0, 0.25, 1e-12);
    snow_look_file_free(tf);
    tf = take_text(context, "a.csv", "-5; 0\n5.0; 1 # top");
    assert_int_equal(snow_look_file_look(tf)->color_count, 0);
    expect(tf, 0, 1, 1, 1, 0.5, 1e-12);
    snow_look_file_free(tf);
    tf = take_text(context, "a.txt", "0 0 0 0\n1 1 0.5 0\n");
    assert_int_equal(snow_look_file_look(tf)->opacity_count, 0);
    expect(tf, 0.5, 0.5, 0.25, 0, 1, 1e-12);
    snow_look_file_free(tf);
    snow_context_free(context);
}

/* --- our own -------------------------------------------------------------- */

static bool same_points(const snow_look *a, const snow_look *b) {
    return a->domain == b->domain && a->log == b->log &&
           a->per_mm == b->per_mm && a->color_count == b->color_count &&
           a->opacity_count == b->opacity_count &&
           a->gradient_opacity_count == b->gradient_opacity_count &&
           strcmp(a->name, b->name) == 0 &&
           (!a->color_count ||
            memcmp(a->colors, b->colors, a->color_count * sizeof *a->colors) ==
                0) &&
           (!a->opacity_count ||
            memcmp(a->opacities, b->opacities,
                   a->opacity_count * sizeof *a->opacities) == 0) &&
           (!a->gradient_opacity_count ||
            memcmp(a->gradient_opacities, b->gradient_opacities,
                   a->gradient_opacity_count * sizeof *a->gradient_opacities) ==
                0);
}

static void what_is_written_reads_as_the_same_bits(void **state) {
    (void)state;
    snow_context *context = support_context();
    uint64_t seed = 9;
    for (int n = 0; n < 60; n++) {
        snow_color_point colors[40];
        snow_opacity_point opacities[40], gradients[40];
        double value = n % 2 ? 1e-30 : -1e4 * support_uniform(&seed);
        for (int i = 0; i < 40; i++) {
            value += support_uniform(&seed) * (n % 3 ? 1e-5 : 1e7);
            colors[i] = (snow_color_point){value, support_uniform(&seed),
                                           support_uniform(&seed), i / 39.0};
            opacities[i] =
                (snow_opacity_point){value / 3, support_uniform(&seed)};
            gradients[i] = (snow_opacity_point){value / 7, 1 / (i + 1.0)};
        }
        const snow_look points = {.size = sizeof points,
                                  .name = "some name",
                                  .domain = (snow_domain)(n % 3),
                                  .log = n % 2 == 1,
                                  .per_mm = n % 5 == 0,
                                  .colors = colors,
                                  .color_count = 40,
                                  .opacities = opacities,
                                  .opacity_count = n % 7 ? 40 : 0,
                                  .gradient_opacities = gradients,
                                  .gradient_opacity_count = n % 4 ? 40 : 0};
        char text[16384], again[16384];
        size_t length, size;
        assert_int_equal(
            snow_look_write_json(context, &points, text, sizeof text, &length),
            SNOW_STATUS_OK);
        snow_look_file *tf = take(context, "x", text, length, NULL);
        assert_true(same_points(&points, snow_look_file_look(tf)));
        assert_int_equal(snow_look_write_json(context, snow_look_file_look(tf),
                                              again, sizeof again, &size),
                         SNOW_STATUS_OK);
        assert_string_equal(text, again);
        snow_look_file_free(tf);
    }
    snow_context_free(context);
}

static void presets_survive_our_json_and_tables(void **state) {
    (void)state;
    snow_context *context = support_context();
    char text[16384];
    for (size_t n = 0; snow_preset_name(n); n++) {
        const snow_look *preset = snow_preset_look(n);
        size_t length;
        if (!preset->color_count) /* made of a volume */
            continue;
        assert_int_equal(
            snow_look_write_json(context, preset, text, sizeof text, &length),
            SNOW_STATUS_OK);
        snow_look_file *tf = take(context, "x.json", text, length, NULL);
        assert_true(same_points(preset, snow_look_file_look(tf)));
        assert_int_equal(
            snow_look_write_csv(context, preset, text, sizeof text, &length),
            SNOW_STATUS_OK);
        assert_int_equal(length, strlen(text));
        snow_look_file *table = take(context, "x.csv", text, length, NULL);
        double low = preset->opacities[0].value;
        double high = preset->opacities[preset->opacity_count - 1].value;
        for (int i = -5; i < 105; i++) {
            double value = low + (high - low) * i / 100, rgba[4];
            look_up(tf, value, rgba);
            expect(table, value, rgba[0], rgba[1], rgba[2], rgba[3], 1e-12);
        }
        snow_look_file_free(table);
        snow_look_file_free(tf);
    }
    snow_context_free(context);
}

static void a_text_that_does_not_fit_is_not_written(void **state) {
    (void)state;
    char text[50] = "old";
    size_t length = 0;
    snow_context *context = support_context();
    assert_int_equal(snow_look_write_json(context, snow_preset_look(1), text,
                                          sizeof text, &length),
                     SNOW_STATUS_OK);
    assert_true(length > sizeof text && text[0] == 0);
    assert_int_equal(snow_look_write_csv(context, snow_preset_look(1), text,
                                         sizeof text, &length),
                     SNOW_STATUS_OK);
    assert_true(length > sizeof text && text[0] == 0);
    snow_context_free(context);
}

/* --- bad files ------------------------------------------------------------ */

static void bad_files_are_refused_in_one_line(void **state) {
    (void)state;
    static const struct {
        const char *name, *text, *says;
    } rows[] = {
        {"a.json", "{\"R\": [0,", "line 1 is not valid JSON"},
        {"a.json", "{\"x\": 1}", "not a transfer function"},
        {"a.json", "[]", "not a transfer function"},
        {"a.json", "{\"R\":[0,256],\"G\":[0,1],\"B\":[0,1]}", "entry 2"},
        {"a.json", "{\"R\":[0,2],\"G\":[0],\"B\":[0,1]}", "entry 1"},
        {"a.json", "{\"RGBPoints\":[0,1,1]}", "four numbers per point"},
        {"a.json", "{\"RGBPoints\":[5,1,1,1,4,0,0,0]}", "rising order"},
        {"a.json", "{\"RGBPoints\":[5,1,2,1]}", "from 0 to 1"},
        {"a.json", "{\"ColorSpace\":\"YUV\",\"RGBPoints\":[5,1,1,1]}", "YUV"},
        {"a.json", "{\"Points\":[5,1,2,1]}", "midpoint"},
        {"a.json", "{\"RGBPoints\":[]}", "neither colours"},
        {"a.json", "{\"RGBPoints\":[0,1,1,1],\"UseLogScale\":1}", "logarithms"},
        {"a.json", "{\"snowglass-tf\":2}", "is not 1"},
        {"a.json", "{\"snowglass-tf\":1,\"values\":\"px\"}", "\"values\""},
        {"a.json", "{\"snowglass-tf\":1,\"colors\":[[1,2]]}", "colour 1"},
        {"a.vp", "1 1 0.9 0.1", "number 5 of the light"},
        {"a.vp", "1 1 1 1 1 1 3 0 0 0", "needs 2 for each"},
        {"a.vp", "1 1 1 1 1 1 4 0 0 1", "ends early"},
        {"a.vp", "1 1 1 1 1 1 4 0 0 9 7", "opacities point 2"},
        {"a.vp", "1 1 1 1 1 1 1e30", "1e+30 numbers"},
        {"a.pal", "abc", "has 3 bytes"},
        {"a.csv", "1,2,3\n", "line 1 is not a row"},
        {"a.csv", "1,0\n2,0,0,0,1\n", "line 2 is not a row"},
        {"a.csv", "1,0\n2,x\n", "line 2 is not a row"},
        {"a.csv", "value,opacity\nthese,are\n", "line 2 is not a row"},
        {"a.csv", "0,0\n1,7\n", "0 to 1"},
        {"a.csv", "", "not a transfer function"},
        {"a.csv", "1,1e999\n", "line 1 is not a row"},
        {"a.xml", "<MRML>", ""},
        {"a.xml", "<!DOCTYPE a [<!ENTITY b \"c\">]><MRML/>", ""},
    };
    snow_context *context = support_context();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        snow_look_file *tf = NULL;
        assert_int_equal(snow_look_parse(context, rows[i].name, rows[i].text,
                                         strlen(rows[i].text), NULL, &tf),
                         SNOW_STATUS_BAD_INPUT);
        assert_null(tf);
        const char *message = snow_context_message(context);
        if (!strstr(message, rows[i].says) ||
            strncmp(message, rows[i].name, strlen(rows[i].name)) != 0 ||
            strchr(message, '\n'))
            fail_msg("row %zu: %s", i, message);
        assert_int_equal(snow_context_bytes(context), 0);
    }
    snow_look_file *tf = NULL;
    assert_int_equal(snow_look_parse(context, "a", "\1\0\2", 3, NULL, &tf),
                     SNOW_STATUS_BAD_INPUT);
    assert_int_equal(snow_look_load(context, "none.vp", &tf),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(
        strstr(snow_context_message(context), "none.vp: cannot be opened"));
    assert_int_equal(snow_look_load(context, ".", &tf), SNOW_STATUS_BAD_INPUT);
    snow_context_free(context);
}

static void no_memory_leaves_nothing_behind(void **state) {
    support_files *place = *state;
    static const char *const texts[] = {
        vp, "0,0\n1,1\n",
        "{\"ColorSpace\":\"Lab\",\"RGBPoints\":[0,1,0,0,1,0,0,1]}"};
    for (int n = 0; n < 3; n++) {
        snow_status status = SNOW_STATUS_NO_MEMORY;
        int64_t failures = 0;
        for (; status != SNOW_STATUS_OK; failures++) {
            snow_look_file *tf = NULL;
            place->allocations = 0;
            place->fail_at = failures + 1;
            status = snow_look_parse(place->context, "x", texts[n],
                                     strlen(texts[n]), NULL, &tf);
            place->fail_at = 0;
            assert_true(status == SNOW_STATUS_OK || !tf);
            assert_true(status == SNOW_STATUS_OK ||
                        status == SNOW_STATUS_NO_MEMORY);
            snow_look_file_free(tf);
            assert_int_equal(snow_context_bytes(place->context), 0);
        }
        assert_true(failures > 2);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_volume_property_of_slicer),
        cmocka_unit_test(a_preset_of_slicer_by_name),
        cmocka_unit_test(colour_spaces_of_paraview_are_those_of_vtk),
        cmocka_unit_test(midpoints_and_sharpness_are_those_of_vtk),
        cmocka_unit_test(a_map_of_niivue),
        cmocka_unit_test(palettes_of_amrvis),
        cmocka_unit_test(tables_with_and_without_a_head),
        cmocka_unit_test(what_is_written_reads_as_the_same_bits),
        cmocka_unit_test(presets_survive_our_json_and_tables),
        cmocka_unit_test(a_text_that_does_not_fit_is_not_written),
        cmocka_unit_test(bad_files_are_refused_in_one_line),
        cmocka_unit_test_setup_teardown(no_memory_leaves_nothing_behind,
                                        support_files_setup,
                                        support_files_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
