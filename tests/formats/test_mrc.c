/* tests/formats/test_mrc.c - MRC maps: where their voxels lie, and what is
 * refused. Modes and byte orders are compared with mrcfile in oracle_mrc.py. */
#include "support/files.h"

#include <math.h>

/* The most memory that a refusal may ask for at once. */
#define MOST ((size_t)100 * 1024)

#define VOXELS 24 /* 4 x 3 x 2 */

typedef struct map {
    unsigned char bytes[1024 + 4 * VOXELS];
} map;

/* A word by its number in the format's description. */
static void put_whole(map *m, int number, int32_t value) {
    for (int i = 0; i < 4; i++)
        m->bytes[4 * (number - 1) + i] =
            (unsigned char)((uint32_t)value >> (8 * i));
}

static void put_real(map *m, int number, float value) {
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_whole(m, number, bits);
}

/* 4 x 3 x 2 int16 voxels, a cell of 2 x 2 x 2 angstrom each. */
static map plain(void) {
    map m = {{0}};
    static const int32_t sizes[] = {4, 3, 2, 1};
    for (int i = 0; i < 4; i++)
        put_whole(&m, 1 + i, sizes[i]);
    for (int i = 0; i < 3; i++) {
        put_whole(&m, 8 + i, sizes[i]);
        put_real(&m, 11 + i, 2 * (float)sizes[i]);
        put_real(&m, 14 + i, 90);
        put_whole(&m, 17 + i, i + 1);
    }
    memcpy(m.bytes + 208, "MAP DD", 6);
    for (int i = 0; i < VOXELS; i++)
        m.bytes[1024 + 2 * i] = (unsigned char)i;
    return m;
}

static const char *write_map(support_files *files, const map *m) {
    return support_write(files, "a.mrc", m->bytes, 1024 + 2 * VOXELS);
}

static void expect_matrix(const snow_volume_info *info,
                          const double wanted[3][4]) {
    for (int i = 0; i < 12; i++)
        if (!(fabs(info->matrix[i / 4][i % 4] - wanted[i / 4][i % 4]) < 1e-6))
            fail_msg("matrix[%d][%d] is %g, not %g", i / 4, i % 4,
                     info->matrix[i / 4][i % 4], wanted[i / 4][i % 4]);
}

/* Opens the map and compares its matrix and the warnings heard. */
static void expect_place(const map *m, const double wanted[3][4],
                         int warnings) {
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = support_opened(&files, write_map(&files, m), NULL);
    const int16_t *voxels = snow_volume_voxels(volume);
    expect_matrix(snow_volume_get_info(volume), wanted);
    for (int i = 0; i < VOXELS; i++)
        assert_int_equal(voxels[i], i);
    assert_int_equal(files.warnings, warnings);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void the_cell_gives_spacing_in_angstrom(void **state) {
    (void)state;
    const map m = plain();
    static const double wanted[3][4] = {
        {2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}};
    expect_place(&m, wanted, 0);
}

static void columns_rows_and_sections_lead_where_they_say(void **state) {
    (void)state;
    map m = plain();
    static const int32_t order[] = {3, 1, 2};
    for (int i = 0; i < 3; i++) {
        put_whole(&m, 17 + i, order[i]);
        put_whole(&m, 8 + i, 2 * (i + 1)); /* X 8/2, Y 6/4, Z 4/6 */
    }
    put_whole(&m, 5, 10);
    put_whole(&m, 6, -5);
    static const double wanted[3][4] = {
        {0, 4, 0, -20}, {0, 0, 1.5, 0}, {4 / 6.0, 0, 0, 40 / 6.0}};
    expect_place(&m, wanted, 0);
}

static void an_origin_comes_before_starts(void **state) {
    (void)state;
    map m = plain();
    put_whole(&m, 5, 10);
    put_real(&m, 50, 7);
    put_real(&m, 52, -3);
    static const double wanted[3][4] = {
        {2, 0, 0, 7}, {0, 2, 0, 0}, {0, 0, 2, -3}};
    expect_place(&m, wanted, 0);
}

static void a_slanted_cell_slants_the_volume(void **state) {
    (void)state;
    map m = plain();
    put_real(&m, 16, 60);
    static const double wanted[3][4] = {
        {2, 1, 0, 0}, {0, 1.7320508075688772, 0, 0}, {0, 0, 2, 0}};
    expect_place(&m, wanted, 0);
}

static void a_cell_without_sense_is_told(void **state) {
    (void)state;
    static const double wanted[3][4] = {
        {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    static const float lengths[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        map m = plain();
        put_real(&m, 12, lengths[i]);
        expect_place(&m, wanted, 1);
    }
    map m = plain();
    put_whole(&m, 9, 0);
    expect_place(&m, wanted, 1);
    m = plain();
    put_real(&m, 14, 170); /* no three axes have such angles */
    put_real(&m, 15, 10);
    put_real(&m, 16, 10);
    expect_place(&m, wanted, 1);
}

static void an_extended_header_is_passed_by(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    unsigned char bytes[1024 + 80 + 2 * VOXELS] = {0};
    map m = plain();
    put_whole(&m, 24, 80);
    memcpy(bytes, m.bytes, 1024);
    memcpy(bytes + 1104, m.bytes + 1024, 2 * VOXELS);
    snow_volume *volume = support_opened(
        &files, support_write(&files, "e.map", bytes, sizeof bytes), NULL);
    const int16_t *voxels = snow_volume_voxels(volume);
    assert_int_equal(voxels[VOXELS - 1], VOXELS - 1);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void old_files_are_known_by_name(void **state) {
    (void)state;
    map m = plain();
    memset(m.bytes + 208, 0, 8);
    put_real(&m, 50, 7); /* belonged to something else then */
    static const double wanted[3][4] = {
        {2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}};
    expect_place(&m, wanted, 0);
}

static void headers_that_lie_are_refused(void **state) {
    (void)state;
    static const struct {
        int number;
        int32_t value;
        const char *part;
    } cases[] = {
        {4, 4, "mode 4"},
        {4, 101, "mode 101"},
        {4, 7, "mode 7"},
        {17, 2, "MAPC"},
        {24, -4, "NSYMBT"},
        {24, 1 << 30, "truncated"},
        {1, 2000000000, "truncated"},
        {3, 3, "truncated"},
        {1, 0, "is invalid"},
        {2, -3, "is invalid"},
        {4, -2, "is invalid"},
    };
    support_files files;
    support_files_begin(&files);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        map m = plain();
        put_whole(&m, cases[i].number, cases[i].value);
        const char *part = !strcmp(cases[i].part, "is invalid")
                               ? "not an MRC file"
                           : cases[i].value == 1 << 30 ? "too early"
                                                       : cases[i].part;
        support_refused(&files, write_map(&files, &m), NULL,
                        SNOW_STATUS_BAD_INPUT, part, MOST);
    }
    map m = plain();
    support_refused(&files, support_write(&files, "s.mrc", m.bytes, 1000), NULL,
                    SNOW_STATUS_BAD_INPUT, "too early", MOST);
    for (int i = 0; i < 3; i++)
        put_whole(&m, 1 + i, INT32_MAX);
    support_refused(&files, write_map(&files, &m), NULL, SNOW_STATUS_BAD_INPUT,
                    "too large for any file", MOST);
    support_files_end(&files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cell_gives_spacing_in_angstrom),
        cmocka_unit_test(columns_rows_and_sections_lead_where_they_say),
        cmocka_unit_test(an_origin_comes_before_starts),
        cmocka_unit_test(a_slanted_cell_slants_the_volume),
        cmocka_unit_test(a_cell_without_sense_is_told),
        cmocka_unit_test(an_extended_header_is_passed_by),
        cmocka_unit_test(old_files_are_known_by_name),
        cmocka_unit_test(headers_that_lie_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
