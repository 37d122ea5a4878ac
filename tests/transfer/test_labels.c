/* tests/transfer/test_labels.c - which volumes are drawn as labels, and how. */
#include "support/files.h"
#include "support/looks.h"

#include "transfer/transfer.h"
#include "volume/volume.h"

#include <math.h>

#define SIDE 48
#define ALL (SIDE * SIDE * SIDE)

static const int32_t three[3] = {7, 1000, 4000000};

/* Three boxes in a background of 0; every `noise`-th voxel (0: none) has
 * another label, and so have `more` of them, one each. */
static void fill(int32_t *voxels, int noise, int more) {
    for (int at = 0; at < ALL; at++) {
        int i = at % SIDE, j = at / SIDE % SIDE, k = at / SIDE / SIDE;
        bool inside = i % 16 < 10 && j < 10 && k >= 20 && k < 30;
        voxels[at] = inside ? three[i / 16] : 0;
        if (noise && at % noise == 0)
            voxels[at] = three[at % 3];
        if (at < more * 9 && at % 9 == 0)
            voxels[at] = 11 + at;
    }
}

static snow_volume *wrapped(looks_fixture *f, snow_type type,
                            const void *voxels) {
    const snow_volume_info info = {.dims = {SIDE, SIDE, SIDE}, .type = type};
    return looks_volume(f, info, voxels);
}

static bool are_labels(looks_fixture *f, const snow_volume *volume) {
    snow_transfer *transfer = looks_of(f, volume, (snow_look){0});
    return snow_transfer_label(transfer, 0) != NULL;
}

static void regions_of_few_whole_numbers_are(void **state) {
    static int32_t voxels[ALL];
    static int16_t words[ALL];
    static float floats[ALL];
    looks_fixture *f = *state;
    fill(voxels, 0, 0);
    for (int n = 0; n < ALL; n++) {
        words[n] = (int16_t)(voxels[n] % 100);
        floats[n] = (float)voxels[n];
    }
    assert_true(are_labels(f, wrapped(f, SNOW_TYPE_INT32, voxels)));
    assert_true(are_labels(f, wrapped(f, SNOW_TYPE_INT16, words)));
    assert_false(are_labels(f, wrapped(f, SNOW_TYPE_FLOAT32, floats)));
    fill(voxels, 50, 0);
    assert_false(are_labels(f, wrapped(f, SNOW_TYPE_INT32, voxels)));
    fill(voxels, 0, 60);
    assert_true(are_labels(f, wrapped(f, SNOW_TYPE_INT32, voxels)));
    fill(voxels, 0, 61);
    assert_false(are_labels(f, wrapped(f, SNOW_TYPE_INT32, voxels)));
}

static void each_has_a_colour_of_its_own(void **state) {
    static int32_t voxels[ALL];
    looks_fixture *f = *state;
    fill(voxels, 0, 0);
    snow_volume *volume = wrapped(f, SNOW_TYPE_INT32, voxels);
    snow_transfer *transfer = looks_of(f, volume, (snow_look){0});
    double rgba[4], others[3][4];
    snow_transfer_evaluate(transfer, 0, rgba);
    assert_true(rgba[3] == 0);
    for (int n = 0; n < 3; n++) {
        const snow_label *label = snow_transfer_label(transfer, (size_t)n + 1);
        snow_transfer_evaluate(transfer, three[n], others[n]);
        assert_true(label->value == three[n] && others[n][3] == 1);
        for (int c = 0; c < 3; c++)
            assert_true(others[n][c] == label->color[c]);
        double apart = 0;
        for (int c = 0; n && c < 3; c++)
            apart += fabs(others[n][c] - others[n - 1][c]);
        assert_true(n == 0 || apart > 0.3);
    }
    assert_null(snow_transfer_label(transfer, 4));
}

/* What a file says goes before what is chosen, and what is asked before both.
 */
static void names_colours_and_opacities_are_taken(void **state) {
    static int32_t voxels[ALL];
    static const snow_label known[] = {{1000, {0.1, 0.2, 0.3, 0.5}, "liver"},
                                       {7, {-1, 0, 0, -1}, "spleen"}};
    static const snow_opacity_point asked[] = {{7, 0.25}, {1007, 1}};
    looks_fixture *f = *state;
    fill(voxels, 50, 0); /* only declared */
    snow_volume *volume = wrapped(f, SNOW_TYPE_INT32, voxels);
    assert_int_equal(snow_volume_set_labels(volume, known, 2), SNOW_STATUS_OK);
    snow_transfer *transfer = looks_of(
        f, volume, (snow_look){.opacities = asked, .opacity_count = 2});
    double rgba[4];
    snow_transfer_evaluate(transfer, 1000, rgba);
    assert_true(rgba[0] == 0.1 && rgba[2] == 0.3 &&
                fabs(rgba[3] - 0.99475) < 1e-12);
    snow_transfer_evaluate(transfer, 0, rgba);
    assert_true(rgba[3] == 0);
    snow_transfer_evaluate(transfer, 7, rgba);
    assert_true(rgba[3] == 0.25);
    snow_transfer_evaluate(transfer, 4000000, rgba);
    assert_true(rgba[3] == 1);
    assert_string_equal(snow_transfer_label(transfer, 1)->name, "spleen");
    assert_string_equal(snow_transfer_label(transfer, 2)->name, "liver");
}

static void a_list_has_colours_of_single_labels(void **state) {
    static int32_t voxels[ALL];
    const snow_look plain = {.preset = "labels"};
    const snow_look listed = {.preset = "labels",
                              .colormap = "8:#00ff00,1000:#ff0033"};
    const snow_look map = {.preset = "labels", .colormap = "hot"};
    looks_fixture *f = *state;
    fill(voxels, 0, 0);
    snow_volume *volume = wrapped(f, SNOW_TYPE_INT32, voxels);
    snow_transfer *before = looks_of(f, volume, plain);
    snow_transfer *after = looks_of(f, volume, listed);
    double a[4], b[4];
    for (int n = 0; n < 3; n++) {
        snow_transfer_evaluate(before, three[n], a);
        snow_transfer_evaluate(after, three[n], b);
        for (int c = 0; c < 4; c++)
            assert_true((a[c] == b[c]) == (n != 1 || c == 3));
    }
    snow_transfer_evaluate(after, 1000, b);
    assert_true(b[0] == 1 && b[1] == 0 && b[2] == 0.2);
    assert_true(snow_transfer_label(after, 2)->color[2] == 0.2);
    looks_refused(f, volume, map, "3:#ff8800");
}

static void the_preset_is_for_any_whole_numbers(void **state) {
    static int32_t voxels[ALL];
    static float floats[ALL];
    const snow_look look = {.preset = "labels"};
    const snow_look ranged = {.preset = "labels", .range = SNOW_RANGE_FULL};
    looks_fixture *f = *state;
    fill(voxels, 0, 500);
    snow_volume *volume = wrapped(f, SNOW_TYPE_INT32, voxels);
    snow_transfer *transfer = looks_of(f, volume, look);
    assert_non_null(snow_transfer_label(transfer, 503));
    assert_null(snow_transfer_label(transfer, 504));
    looks_refused(f, volume, ranged, "");
    volume = wrapped(f, SNOW_TYPE_FLOAT32, floats);
    looks_refused(f, volume, look, "");
    floats[5] = 0.5F;
    looks_refused(f, volume, look, "has fractions");
}

/* Programs keep labels as floats; they are some where the file says so, or
 * whoever draws them. */
static void labels_may_be_floats(void **state) {
    static int32_t voxels[ALL];
    static double doubles[ALL];
    const snow_look look = {.preset = "labels"};
    looks_fixture *f = *state;
    fill(voxels, 0, 0);
    for (int n = 0; n < ALL; n++)
        doubles[n] = voxels[n];
    snow_volume *volume = wrapped(f, SNOW_TYPE_FLOAT64, doubles);
    snow_transfer *transfer = looks_of(f, volume, look);
    assert_true(snow_transfer_label(transfer, 3)->value == three[2]);
    assert_true(snow_transfer_has_labels(transfer, &volume->info));
    snow_volume_set_labels(volume, NULL, 0);
    assert_true(are_labels(f, volume));
    doubles[7] = 0.5;
    volume = wrapped(f, SNOW_TYPE_FLOAT64, doubles);
    snow_volume_set_labels(volume, NULL, 0);
    assert_false(are_labels(f, volume));
}

/* In a volume without 0 the smallest value is the background. */
static void what_is_not_labelled_is_hidden(void **state) {
    static int32_t voxels[ALL];
    looks_fixture *f = *state;
    fill(voxels, 0, 0);
    for (int n = 0; n < ALL; n++)
        voxels[n] = voxels[n] ? voxels[n] : -1;
    snow_volume *volume = wrapped(f, SNOW_TYPE_INT32, voxels);
    snow_transfer *transfer = looks_of(f, volume, (snow_look){0});
    double rgba[4];
    snow_transfer_evaluate(transfer, -1, rgba);
    assert_true(rgba[3] == 0);
    snow_transfer_evaluate(transfer, 7, rgba);
    assert_true(rgba[3] == 1);
}

/* Single voxels in a background, and a coarse heap, are no regions; balls of
 * few voxels are, and so is all that has two values, unless it is measured. */
static void few_values_alone_are_not(void **state) {
    static int32_t single[ALL], heap[ALL], balls[ALL];
    looks_fixture *f = *state;
    for (int at = 0; at < ALL; at++) {
        int i = at % SIDE, j = at / SIDE % SIDE, k = at / SIDE / SIDE;
        double x = (i - 24) / 24.0, y = (j - 24) / 24.0, z = (k - 24) / 24.0;
        single[at] = at % 233 ? 0 : at / 233 % 39 + 1;
        heap[at] = (int32_t)rint(10 * exp(-3 * (x * x + y * y + z * z)));
        i = i % 12 - 6, j = j % 12 - 6, k = k % 12 - 6;
        bool inside = i * i + j * j + k * k < 17;
        balls[at] = inside ? 1 + at % SIDE / 12 + at / SIDE % SIDE / 12 * 4 : 0;
    }
    assert_false(are_labels(f, wrapped(f, SNOW_TYPE_INT32, single)));
    assert_false(are_labels(f, wrapped(f, SNOW_TYPE_INT32, heap)));
    assert_true(are_labels(f, wrapped(f, SNOW_TYPE_INT32, balls)));
    for (int at = 0; at < ALL; at++)
        single[at] = single[at] ? 9 : 0;
    snow_volume *mask = wrapped(f, SNOW_TYPE_INT32, single);
    assert_true(are_labels(f, mask));
    mask->info.estimate = true;
    assert_false(are_labels(f, mask));
    /* Hounsfield units are measured, whatever their regions. */
    for (int medical = 0; medical < 2; medical++) {
        for (int at = 0; at < ALL && !medical; at++)
            balls[at] = balls[at] ? 40 : -1000;
        snow_volume *volume = wrapped(f, SNOW_TYPE_INT32, balls);
        volume->info.medical = medical;
        assert_int_equal(are_labels(f, volume), !medical);
    }
}

/* Few greys of a single image are a drawing, labels only where asked. */
static void a_single_image_has_none(void **state) {
    static uint8_t voxels[SIDE * SIDE];
    looks_fixture *f = *state;
    for (int at = 0; at < SIDE * SIDE; at++)
        voxels[at] = at / 16 % 2 ? 255 : 0;
    const snow_volume_info info = {.dims = {SIDE, SIDE, 1},
                                   .type = SNOW_TYPE_UINT8};
    const snow_volume *image = looks_volume(f, info, voxels);
    assert_false(are_labels(f, image));
    snow_transfer *asked = looks_of(f, image, (snow_look){.preset = "labels"});
    assert_non_null(snow_transfer_label(asked, 0));
    assert_true(snow_transfer_is_unshaded(asked));
}

/* --- files ---------------------------------------------------------------- */

#define NRRD                                                        \
    "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 2 1\nencoding: " \
    "ascii\nSegment0_LabelValue:=4\nSegment0_Name:=Left kidney\n"   \
    "Segment0_Color:=0.5 0.25 1\nSegment1_LabelValue:=2\n"          \
    "Segment1_Name:=Liver\nSegment1_Extent:=0 1 0 1 0 1\n\n0 2 4 4 4 9\n"

static void segments_of_slicer_are_read(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = support_opened(
        &files, support_write_text(&files, "a.nrrd", NRRD), NULL);
    assert_true(volume->labelled);
    assert_int_equal(volume->label_count, 2);
    assert_true(volume->labels[0].value == 2 && volume->labels[1].value == 4);
    assert_true(volume->labels[0].color[0] < 0);
    assert_true(volume->labels[1].color[1] == 0.25);
    assert_string_equal(volume->labels[1].name, "Left kidney");
    snow_volume_close(volume);
    support_files_end(&files);
}

/* A number of a segment has digits alone, and a colour three shares. */
static void wrong_segments_are_not_read(void **state) {
    (void)state;
    static const char *const keys[] = {
        "Segment-1_Name:=x", "Segment+4294967295_Name:=x",
        "Segment0_Color:=5 -3 nan", "Segment0_LabelValue:=x"};
    support_files files;
    support_files_begin(&files);
    for (int n = 0; n < 4; n++) {
        char text[512];
        snow_volume *volume = NULL;
        snprintf(text, sizeof text, "%.62s\n%s%s", NRRD, keys[n],
                 strstr(NRRD, "\n\n"));
        snow_status status = snow_volume_open(
            files.context, support_write_text(&files, "a.nrrd", text), NULL,
            &volume);
        assert_int_equal(status,
                         n < 2 ? SNOW_STATUS_OK : SNOW_STATUS_BAD_INPUT);
        if (volume)
            assert_false(volume->labelled);
        else
            assert_non_null(strstr(snow_context_message(files.context),
                                   "a.nrrd: the header's line"));
        snow_volume_close(volume);
    }
    support_files_end(&files);
}

static void tables_are_read(void **state) {
    (void)state;
    static const char *const tables[] = {
        "# ITK-SNAP\n 0 0 0 0 0 0 0 \"Clear\"\n\n"
        "4   51 102 255   0.5 1 1   \"Left kidney\"\n"
        "9 0 0 0 1 0 1 \"hidden\"\n",
        "#No. Label Name: R G B A\n4 Left kidney 51 102 255 0\n",
        "4 Left-kidney 51 102 300 0\n", "4\n"};
    support_files files;
    support_files_begin(&files);
    char path[512], table[512];
    snprintf(path, sizeof path, "%s",
             support_write_text(&files, "a.nrrd", NRRD));
    for (int n = 0; n < 4; n++) {
        snprintf(table, sizeof table, "%s",
                 support_write_text(&files, "t.txt", tables[n]));
        const snow_volume_options options = {.size = sizeof options,
                                             .label_table = table};
        snow_volume *volume = NULL;
        if (n) { /* blanks in a name, a colour above 255, nothing */
            assert_int_equal(
                snow_volume_open(files.context, path, &options, &volume),
                SNOW_STATUS_BAD_INPUT);
            assert_non_null(strstr(snow_context_message(files.context),
                                   n == 1 ? "t.txt: line 2" : "t.txt: line 1"));
            continue;
        }
        volume = support_opened(&files, path, &options);
        assert_int_equal(volume->label_count, 3);
        assert_true(volume->labels[1].color[0] == 0.2);
        assert_true(volume->labels[1].color[3] == 0.5);
        assert_true(volume->labels[2].color[3] == 0);
        assert_string_equal(volume->labels[1].name, "Left kidney");
        snow_volume_close(volume);
    }
    support_files_end(&files);
}

static void labels_are_picked(void **state) {
    (void)state;
    static const uint8_t picked[] = {0, 2, 0, 0, 0, 9};
    support_files files;
    support_files_begin(&files);
    const char *path = support_write_text(&files, "a.nrrd", NRRD);
    snow_volume_options options = {.size = sizeof options, .labels = "2,5:9"};
    snow_volume *volume = support_opened(&files, path, &options);
    assert_memory_equal(snow_volume_voxels(volume), picked, sizeof picked);
    snow_volume_close(volume);
    options.clip[0][0] = 1; /* x > 1.5 is left out: still labels */
    options.clip[0][3] = 1.5;
    volume = support_opened(&files, path, &options);
    assert_true(volume->labelled && volume->info.whole);
    assert_int_equal(snow_volume_get_info(volume)->type, SNOW_TYPE_FLOAT32);
    const float *voxels = snow_volume_voxels(volume);
    assert_true(voxels[1] == 2 && isnan(voxels[2]));
    snow_volume_close(volume);
    support_files_end(&files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        LOOKS_TEST(regions_of_few_whole_numbers_are),
        LOOKS_TEST(each_has_a_colour_of_its_own),
        LOOKS_TEST(names_colours_and_opacities_are_taken),
        LOOKS_TEST(a_list_has_colours_of_single_labels),
        LOOKS_TEST(the_preset_is_for_any_whole_numbers),
        LOOKS_TEST(labels_may_be_floats),
        LOOKS_TEST(what_is_not_labelled_is_hidden),
        LOOKS_TEST(few_values_alone_are_not),
        LOOKS_TEST(a_single_image_has_none),
        cmocka_unit_test(segments_of_slicer_are_read),
        cmocka_unit_test(wrong_segments_are_not_read),
        cmocka_unit_test(tables_are_read),
        cmocka_unit_test(labels_are_picked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
