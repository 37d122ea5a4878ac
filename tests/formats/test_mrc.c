/* tests/formats/test_mrc.c - MRC maps: where their voxels lie, and what is
 * refused.  Modes, byte orders and extended headers are compared with mrcfile
 * in oracle_mrc.py. */
#include "support/files.h"

#include <math.h>

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

/* Words of the header replaced, whole or real: their numbers, each with its
 * value, up to a number of 0; and where the voxels are then. */
typedef struct changed {
    int wholes[17];
    float reals[7];
    bool is_old, warns, notes; /* and the place is none, or is that */
    double rows[12];
} changed;

static void the_cell_gives_the_place_in_angstrom(void **state) {
    support_files *files = *state;
    static const changed cases[] = {
        {.rows = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0}},
        /* Columns, rows and sections lead along Z, X and Y, in a cell of
           X 8/2, Y 6/4, Z 4/6; they start at 10 and -5. */
        {.wholes = {17, 3, 18, 1, 19, 2, 8, 2, 9, 4, 10, 6, 5, 10, 6, -5},
         .rows = {0, 4, 0, -20, 0, 0, 1.5, 0, 4 / 6.0, 0, 0, 40 / 6.0}},
        /* An origin comes before starts. */
        {.wholes = {5, 10},
         .reals = {50, 7, 52, -3},
         .rows = {2, 0, 0, 7, 0, 2, 0, 0, 0, 0, 2, -3}},
        /* A slanted cell slants the volume. */
        {.reals = {16, 60},
         .rows = {2, 1, 0, 0, 0, 1.7320508075688772, 0, 0, 0, 0, 2, 0}},
        /* Old files are known by name; word 50 was something else then. */
        {.reals = {50, 7},
         .is_old = true,
         .rows = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0}},
        /* Rows from the top, as IMOD has them: the volume stays in its box. */
        {.wholes = {18, -2}, .rows = {2, 0, 0, 0, 0, -2, 0, 4, 0, 0, 2, 0}},
        {.wholes = {17, -3, 18, 1, 19, -2, 8, 2, 9, 4, 10, 6, 5, 10, 6, -5},
         .rows = {0, 4, 0, -20, 0, 0, -1.5, 1.5, -4 / 6.0, 0, 0, 52 / 6.0}},
        /* No order of axes; no number of intervals, but those of the voxels,
           as IMOD's are; no distance of images. */
        {.wholes = {17, 2},
         .rows = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0},
         .notes = true},
        {.wholes = {17, 1 << 20, 18, INT32_MIN, 19, 7},
         .rows = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0},
         .notes = true},
        {.wholes = {8, -1, 9, 0, 10, 0},
         .rows = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0},
         .notes = true},
        {.wholes = {17, 3, 18, 1, 19, 2, 8, 0, 9, 0, 10, 0},
         .rows = {0, 8 / 3.0, 0, 0, 0, 0, 3, 0, 1, 0, 0, 0},
         .notes = true},
        {.reals = {13, 0},
         .rows = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0},
         .notes = true},
        /* Cells without sense; no three axes have such angles. */
        {.reals = {12, 0}, .warns = true},
        {.reals = {12, -1}, .warns = true},
        {.reals = {12, NAN}, .warns = true},
        {.reals = {12, INFINITY}, .warns = true},
        {.wholes = {8, -1, 9, 1 << 20, 10, 0}, .reals = {11, 0}, .warns = true},
        {.reals = {14, 170, 15, 10, 16, 10}, .warns = true},
    };
    static const double plainly[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const changed *c = &cases[n];
        map m = plain();
        for (const int *word = c->wholes; *word; word += 2)
            put_whole(&m, word[0], word[1]);
        for (const float *word = c->reals; *word > 0; word += 2)
            put_real(&m, (int)word[0], word[1]);
        if (c->is_old)
            memset(m.bytes + 208, 0, 8);
        *files->warnings = 0;
        snow_volume *volume = support_opened(files, write_map(files, &m), NULL);
        const int16_t *voxels = snow_volume_voxels(volume);
        support_expect_matrix(volume, c->warns ? plainly : c->rows);
        for (int i = 0; i < VOXELS; i++)
            assert_int_equal(voxels[i], i);
        assert_int_equal(support_warned(files), c->warns || c->notes);
        snow_volume_close(volume);
    }
}

static void headers_that_lie_are_refused(void **state) {
    support_files *files = *state;
    static const struct {
        int number;
        int32_t value;
        const char *part;
    } cases[] = {
        {4, 4, "mode 4"},
        {4, 101, "mode 101"},
        {4, 7, "mode 7"},
        {24, -4, "NSYMBT"},
        {1, 2000000000, "truncated"},
        {3, 3, "truncated"},
        {1, 0, "not an MRC file"},
        {2, -3, "not an MRC file"},
        {4, -2, "not an MRC file"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        map m = plain();
        put_whole(&m, cases[i].number, cases[i].value);
        support_bad_file(files, write_map(files, &m), cases[i].part);
    }
    map m = plain();
    put_whole(&m, 24, 1 << 30); /* bytes that nothing is left of */
    snow_volume_close(support_opened(files, write_map(files, &m), NULL));
    assert_non_null(strstr(files->warnings, "extended header is missing"));
    put_whole(&m, 3, 1);
    support_bad_file(files, write_map(files, &m), "too early");
    m = plain();
    support_bad_file(files, support_write(files, "s.mrc", m.bytes, 1000),
                     "too early");
    for (int i = 0; i < 3; i++)
        put_whole(&m, 1 + i, INT32_MAX);
    support_bad_file(files, write_map(files, &m), "larger than any file");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(the_cell_gives_the_place_in_angstrom),
        SUPPORT_TEST(headers_that_lie_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
