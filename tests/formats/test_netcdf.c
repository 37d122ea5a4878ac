/* tests/formats/test_netcdf.c - classic NetCDF files by hand: headers that lie,
 * and where variables are.  What others write is compared in oracle_netcdf.py.
 */
#include "support/files.h"

typedef struct nc {
    unsigned char bytes[4096];
    size_t size;
} nc;

static void put(nc *f, uint64_t value, size_t size) {
    for (size_t i = 0; i < size; i++)
        f->bytes[f->size++] = (unsigned char)(value >> (8 * (size - 1 - i)));
}

static void put_name(nc *f, const char *name) {
    size_t length = strlen(name);
    put(f, length, 4);
    memcpy(f->bytes + f->size, name, length);
    f->size += (length + 3) / 4 * 4;
}

/* x = 3, y = 2, z of z_size (0: records); v(z, y, x) of int16. Returns where
 * v's place is told. */
static size_t begin(nc *f, uint32_t records, uint32_t z_size) {
    memset(f, 0, sizeof *f);
    memcpy(f->bytes, "CDF\1", 4);
    f->size = 4;
    put(f, records, 4);
    put(f, 10, 4); /* dimensions */
    put(f, 3, 4);
    put_name(f, "x");
    put(f, 3, 4);
    put_name(f, "y");
    put(f, 2, 4);
    put_name(f, "z");
    put(f, z_size, 4);
    put(f, 0, 8);  /* no attributes */
    put(f, 11, 4); /* variables */
    put(f, 1, 4);
    put_name(f, "v");
    put(f, 3, 4);
    put(f, 2, 4);
    put(f, 1, 4);
    put(f, 0, 4);
    put(f, 0, 8); /* no attributes */
    put(f, 3, 4); /* int16 */
    put(f, 12, 4);
    size_t place = f->size;
    put(f, place + 4, 4);
    return place;
}

static void put_voxels(nc *f, int count) {
    for (int i = 0; i < count; i++)
        put(f, (uint64_t)i, 2);
}

static const char *write_nc(support_files *files, const nc *f) {
    return support_write(files, "a.nc", f->bytes, f->size);
}

static void expect_counting(snow_volume *volume, int64_t slices) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    const int16_t *voxels = snow_volume_voxels(volume);
    assert_string_equal(info->format, "netcdf");
    assert_true(info->dims[0] == 3 && info->dims[1] == 2 &&
                info->dims[2] == slices);
    for (int i = 0; i < 6 * slices; i++)
        assert_int_equal(voxels[i], i);
    snow_volume_close(volume);
}

static void records_are_counted_or_found(void **state) {
    support_files *files = *state;
    nc f;
    begin(&f, 5, 0);
    put_voxels(&f, 30);
    expect_counting(support_opened(files, write_nc(files, &f), NULL), 5);
    begin(&f, UINT32_MAX, 0); /* to the end of the file */
    put_voxels(&f, 30);
    expect_counting(support_opened(files, write_nc(files, &f), NULL), 5);
}

static void headers_that_lie_are_refused(void **state) {
    support_files *files = *state;
    static const struct {
        size_t at; /* byte of a number of 4 */
        uint32_t value;
        const char *part;
    } cases[] = {
        {0, 0x43444603, "version 1, 2 or 5"},
        {8, 9, "header is invalid"},
        {12, 0x7fffffff, "more than the file can hold"},
        {12, 0x80000000, "below 0"},
        {16, 300, "256 letters"},
        {24, 0x7fffffff, "is truncated"},
        {24, 0, "records not as its first"},
        {24, 0x80000000, "below 0"},
        {76, 4000, "does not exist"},
        {80, 3, "does not exist"},
        {100, 12, "unknown type"},
        {100, 6, "truncated"},
        {100, 2, "no numeric variable"},
        {108, 0x7fffffff, "truncated"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nc f;
        begin(&f, 0, 4);
        put_voxels(&f, 24);
        size_t size = f.size;
        f.size = cases[i].at;
        put(&f, cases[i].value, 4);
        f.size = size;
        support_bad_file(files, write_nc(files, &f), cases[i].part);
    }
}

static void a_cut_file_is_refused(void **state) {
    support_files *files = *state;
    nc f;
    begin(&f, 0, 4);
    put_voxels(&f, 24);
    for (size_t size = 4; size < f.size; size++)
        support_bad_file(files, support_write(files, "b.nc", f.bytes, size),
                         ";");
    begin(&f, 0x7fffffff, 0);
    put_voxels(&f, 30);
    support_bad_file(files, write_nc(files, &f), "truncated");
}

static void a_wrong_name_lists_the_right_ones(void **state) {
    support_files *files = *state;
    nc f;
    begin(&f, 0, 4);
    put_voxels(&f, 24);
    const snow_volume_options wrong = {.size = sizeof wrong, .dataset = "w"},
                              right = {.size = sizeof right, .dataset = "v"};
    support_refused(files, write_nc(files, &f), &wrong, SNOW_STATUS_BAD_USAGE,
                    "v (3x2x4)", SUPPORT_MOST);
    expect_counting(support_opened(files, write_nc(files, &f), &right), 4);
    char path[600];
    snprintf(path, sizeof path, "%s:/v", write_nc(files, &f));
    expect_counting(support_opened(files, path, NULL), 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(records_are_counted_or_found),
        SUPPORT_TEST(headers_that_lie_are_refused),
        SUPPORT_TEST(a_cut_file_is_refused),
        SUPPORT_TEST(a_wrong_name_lists_the_right_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
