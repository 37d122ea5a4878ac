/* tests/formats/test_vtk.c - legacy files of VTK in the spellings that people
 * write by hand, and what is refused.  What VTK writes is compared in
 * oracle_vtk.py. */
#include "support/files.h"

#define HEAD "# vtk DataFile Version 3.0\nby hand\nASCII\n"
#define GRID HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 1\n"
#define SPACED GRID "ORIGIN 1 2 3\nSPACING 0.5 1 2\n"
#define SCALARS "POINT_DATA 6\nSCALARS s short 1\nLOOKUP_TABLE default\n"
#define NUMBERS "0 1 2\n3 4 5\n"

static snow_volume *opened(support_files *files, const char *text,
                           const snow_volume_options *options) {
    return support_opened(files, support_write_text(files, "a.vtk", text),
                          options);
}

static void expect_counting(snow_volume *volume) {
    for (int i = 0; i < 6; i++)
        assert_int_equal(((const int16_t *)snow_volume_voxels(volume))[i], i);
    snow_volume_close(volume);
}

static void words_may_be_written_in_many_ways(void **state) {
    support_files *files = *state;
    static const char *const texts[] = {
        SPACED SCALARS NUMBERS,
        GRID "SPACING 0.5 1 2\nORIGIN 1 2 3\n" SCALARS "0 1 2 3 4 5",
        "# vtk DataFile Version 1.0\n\nascii\ndataset structured_points\n"
        "aspect_ratio 0.5 1 2\ndimensions 3 2 1\norigin 1 2 3\n\n"
        "point_data 6\nscalars s short\nlookup_table default\n"
        "0\n1\n2\n3\n4\n5\n",
        SPACED "FIELD FieldData 1\nTIME 1 1 double\n7\n" SCALARS NUMBERS
               "VECTORS v float\n" NUMBERS,
        SPACED "POINT_DATA 6\nLOOKUP_TABLE t 1\n1 1 1 1\nFIELD f 1\n"
               "s 1 6 short\n" NUMBERS,
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        snow_volume *volume = opened(files, texts[i], NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_true(info->dims[0] == 3 && info->dims[1] == 2);
        assert_true(info->matrix[0][0] == 0.5 && info->matrix[2][2] == 2);
        assert_true(info->matrix[0][3] == 1 && info->matrix[2][3] == 3);
        assert_false(info->medical);
        expect_counting(volume);
    }
    assert_string_equal(files->warnings, "");
}

static void values_of_cells_lie_between_points(void **state) {
    support_files *files = *state;
    snow_volume *volume = opened(files,
                                 SPACED "CELL_DATA 2\nSCALARS c int\n"
                                        "LOOKUP_TABLE default\n7 8\n",
                                 NULL);
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_true(info->dims[0] == 2 && info->dims[1] == 1);
    assert_true(info->matrix[0][3] == 1.25 && info->matrix[1][3] == 2.5);
    assert_true(info->matrix[2][3] == 3); /* an axis of one point */
    snow_volume_close(volume);
}

static void an_array_is_chosen_by_name_and_channel(void **state) {
    support_files *files = *state;
    static const char text[] = SPACED
        "POINT_DATA 6\nSCALARS s float 1\nLOOKUP_TABLE default\n9 9 9 9 9 9\n"
        "FIELD f 1\nthe%20one 2 6 short\n0 0 0 1 0 2 0 3 0 4 0 5\n";
    const snow_volume_options options = {
        .size = sizeof options, .dataset = "the one", .channel = 1};
    expect_counting(opened(files, text, &options));
    assert_string_equal(files->warnings, ""); /* the channel was given */
    const snow_volume_options wrong = {.size = sizeof wrong,
                                       .dataset = "other"};
    support_refused(files, support_write_text(files, "b.vtk", text), &wrong,
                    SNOW_STATUS_BAD_USAGE, "s, the one", SUPPORT_MOST);
}

static void shares_of_colours_are_bytes(void **state) {
    support_files *files = *state;
    snow_volume *volume = opened(files,
                                 SPACED "POINT_DATA 6\nCOLOR_SCALARS s 1\n"
                                        "0 1 0.5 0.00392157 -1 2\n",
                                 NULL);
    static const uint8_t wanted[] = {0, 255, 128, 1, 0, 255};
    assert_int_equal(snow_volume_get_info(volume)->type, SNOW_TYPE_UINT8);
    assert_memory_equal(snow_volume_voxels(volume), wanted, 6);
    snow_volume_close(volume);
}

static void what_is_no_image_is_refused(void **state) {
    support_files *files = *state;
    static const char *const cases[][2] = {
        {HEAD "DATASET POLYDATA\n", "POLYDATA"},
        {HEAD "DATASET STRUCTURED_GRID\n", "resample"},
        {HEAD "DIMENSIONS 3 2 1\n", "is not valid in this place"},
        {"# vtk DataFile Version 3.0\nx\nHEX\n", "is not valid in this place"},
        {"# vtk DataFile Version 3.0\n", "end of file"},
        {GRID, "no array"},
        {SPACED "POINT_DATA 6\n", "no array"},
        {SPACED "POINT_DATA 5\nSCALARS s short\nLOOKUP_TABLE default\n"
                "0 1 2 3 4",
         "5 values but the grid has 6"},
        {SPACED SCALARS "0 1 2 3 4", "truncated"},
        {SPACED SCALARS "0 1 2 3 4 x", "not a valid int16"},
        {SPACED "POINT_DATA 6\nSCALARS s bit\nLOOKUP_TABLE default\n" NUMBERS,
         "is not valid in this place"},
        {SPACED "POINT_DATA 6\nSCALARS s short 0\nLOOKUP_TABLE d\n" NUMBERS,
         "is not valid in this place"},
        {SPACED "POINT_DATA 6\nSCALARS s short\n" NUMBERS,
         "is not valid in this place"},
        {GRID "SPACING 0 1 1\n" SCALARS NUMBERS, "spacing"},
        {GRID "SPACING nan 1 1\n" SCALARS NUMBERS, "spacing"},
        {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 0 2 1\n" SCALARS NUMBERS,
         "empty"},
        {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2000000 2000000 2000000\n"
              "POINT_DATA 8000000000000000000\nSCALARS s double\n"
              "LOOKUP_TABLE d\n0",
         "too large for any file"},
        {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 100000 100000 10\n"
              "POINT_DATA 100000000000\nSCALARS s double\nLOOKUP_TABLE d\n0",
         "is truncated"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        support_bad_file(files, support_write_text(files, "a.vtk", cases[i][0]),
                         cases[i][1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(words_may_be_written_in_many_ways),
        SUPPORT_TEST(values_of_cells_lie_between_points),
        SUPPORT_TEST(an_array_is_chosen_by_name_and_channel),
        SUPPORT_TEST(shares_of_colours_are_bytes),
        SUPPORT_TEST(what_is_no_image_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
