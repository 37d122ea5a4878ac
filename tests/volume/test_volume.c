/* tests/volume/test_volume.c - what every volume promises, whatever its format.
 */
#include "support/failing.h"
#include "support/files.h"

#include "volume/volume.h"

#include <math.h>

static snow_volume_info info_of(int64_t x, int64_t y, int64_t z,
                                snow_type type) {
    snow_volume_info info = snow_volume_info_default("memory");
    info.dims[0] = x;
    info.dims[1] = y;
    info.dims[2] = z;
    info.type = type;
    return info;
}

static snow_volume *shared(snow_context *context, const snow_volume_info *info,
                           const void *voxels) {
    snow_volume *volume = NULL;
    if (snow_volume_wrap(context, info, voxels, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return volume;
}

static snow_volume *row_of(snow_context *context, snow_type type,
                           const void *values, int64_t count) {
    const snow_volume_info info = info_of(count, 1, 1, type);
    return shared(context, &info, values);
}

static void types_know_their_names_and_sizes(void **state) {
    (void)state;
#define CHECK_TYPE(name, c_type, text)                                  \
    assert_int_equal(snow_type_size(SNOW_TYPE_##name), sizeof(c_type)); \
    assert_string_equal(snow_type_name(SNOW_TYPE_##name), text);        \
    assert_int_equal(snow_type_from_name(text), SNOW_TYPE_##name);
    SNOW_TYPE_MAP(CHECK_TYPE)
#undef CHECK_TYPE
    assert_int_equal(snow_type_from_name("float"), SNOW_TYPE_FLOAT32);
    assert_int_equal(snow_type_from_name("double"), SNOW_TYPE_FLOAT64);
    assert_int_equal(snow_type_from_name("uint9"), SNOW_TYPE_NONE);
    assert_int_equal(snow_type_size(SNOW_TYPE_NONE), 0);
    assert_string_equal(snow_type_name(SNOW_TYPE_NONE), "none");
}

static void bytes_swap_in_every_width(void **state) {
    (void)state;
    unsigned char bytes[16];
    for (size_t size = 1; size <= 8; size *= 2) {
        for (int i = 0; i < 16; i++)
            bytes[i] = (unsigned char)i;
        snow_swap_bytes(bytes, 16 / size, size);
        for (size_t i = 0; i < 16; i++)
            assert_int_equal(bytes[i], i / size * size + size - 1 - i % size);
    }
}

static void sizes_that_overflow_are_no_count(void **state) {
    (void)state;
    static const int64_t bad[][3] = {
        {0, 1, 1},
        {1, -1, 1},
        {-1, -1, 1},
        {3037000500, 3037000500, 1}, /* just over 2^63 */
        {INT64_MAX, INT64_MAX, INT64_MAX},
        {(int64_t)1 << 32, (int64_t)1 << 32, 1}, /* 0 in 64 bits */
    };
    int64_t voxels;
    uint64_t bytes;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(
            snow_volume_count(bad[i], SNOW_TYPE_UINT8, &voxels, &bytes));
    const int64_t good[3] = {INT64_MAX, 1, 1};
    assert_true(snow_volume_count(good, SNOW_TYPE_UINT8, &voxels, &bytes));
    assert_false(snow_volume_count(good, SNOW_TYPE_UINT16, &voxels, &bytes));
    assert_false(snow_volume_count(good, SNOW_TYPE_NONE, &voxels, &bytes));
}

static void impossible_headers_are_refused_before_any_allocation(void **state) {
    support_files *files = *state;
    snow_volume_info infos[8];
    for (int i = 0; i < 8; i++)
        infos[i] = info_of(100, 100, 100, SNOW_TYPE_FLOAT64);
    infos[0].dims[1] = 0;
    infos[1].dims[2] = INT64_MAX;
    infos[2].type = SNOW_TYPE_NONE;
    infos[3].matrix[0][0] = NAN;
    infos[4].matrix[1][1] = 0;
    infos[5].matrix[2][2] = INFINITY;
    infos[6].slope = 0;
    infos[7].intercept = NAN;
    files->largest = 0;
    for (int i = 0; i < 8; i++) {
        snow_volume *volume = NULL;
        assert_int_equal(snow_volume_new(files->context, &infos[i], &volume),
                         SNOW_STATUS_BAD_INPUT);
        assert_null(volume);
    }
    assert_int_equal(files->largest, 0);
}

static void a_matrix_of_flat_axes_has_no_inverse(void **state) {
    (void)state;
    double inverse[3][3];
    static const double flat[4][4] = {{1, 2, 0}, {2, 4, 1}, {3, 6, 0}};
    assert_false(snow_matrix_invert3(flat, inverse));
    static const double good[4][4] = {
        {0, -2e-200, 0, 5}, {3e100, 0, 0, 6}, {0, 0, 4, 7}, {0, 0, 0, 1}};
    assert_true(snow_matrix_invert3(good, inverse));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += inverse[i][k] * good[k][j];
            assert_true(fabs(sum - (i == j)) < 1e-12);
        }
}

static void a_shared_volume_gets_its_defaults(void **state) {
    const support_files *files = *state;
    static const uint8_t voxels[24] = {0};
    snow_volume_info info = {
        .size = sizeof info, .dims = {4, 3, 2}, .type = SNOW_TYPE_UINT8};
    snow_volume *volume = shared(files->context, &info, voxels);
    const snow_volume_info *known = snow_volume_get_info(volume);
    assert_ptr_equal(snow_volume_voxels(volume), voxels);
    assert_string_equal(known->format, "memory");
    assert_true(known->slope == 1 && known->matrix[2][2] == 1);
    assert_true(known->spacing[1] == 1 && known->times == 1);
    snow_volume_close(volume);
    info.dims[0] = 0;
    assert_int_equal(snow_volume_wrap(files->context, &info, voxels, &volume),
                     SNOW_STATUS_BAD_USAGE);
}

static void spacing_is_the_length_of_the_columns(void **state) {
    const support_files *files = *state;
    static const uint8_t voxel = 0;
    snow_volume_info info = info_of(1, 1, 1, SNOW_TYPE_UINT8);
    static const double matrix[4][4] = {
        {3, 0, 0, 9}, {4, 0, -2, 9}, {0, 0.5, 0, 9}, {0, 0, 0, 1}};
    memcpy(info.matrix, matrix, sizeof matrix);
    snow_volume *volume = shared(files->context, &info, &voxel);
    const double *spacing = snow_volume_get_info(volume)->spacing;
    assert_true(spacing[0] == 5 && spacing[1] == 0.5 && spacing[2] == 2);
    snow_volume_close(volume);
}

/* Each type's largest value survives; sums follow the formula. */
static void figures_are_right_for_every_type(void **state) {
    const support_files *files = *state;
#define CHECK_FIGURES(name, c_type, text)                              \
    do {                                                               \
        c_type voxels[2018];                                           \
        double sum = 0, wsum = 0;                                      \
        for (int i = 0; i < 2018; i++) {                               \
            voxels[i] = (c_type)(i * 7 % 100);                         \
            sum += (double)voxels[i] * 2 + 3;                          \
            wsum += ((double)voxels[i] * 2 + 3) * (i % 1009 + 1);      \
        }                                                              \
        snow_volume_info info = info_of(2018, 1, 1, SNOW_TYPE_##name); \
        info.slope = 2;                                                \
        info.intercept = 3;                                            \
        snow_volume *volume = shared(files->context, &info, voxels);   \
        snow_volume_statistics m = {.size = sizeof m};                 \
        snow_volume_get_statistics(volume, &m);                        \
        assert_true(m.voxels == 2018 && m.finite == 2018);             \
        assert_true(m.min == 3 && m.max == 201);                       \
        assert_true(m.sum == sum && m.wsum == wsum);                   \
        assert_true(snow_volume_native(volume, 5) == 35);              \
        snow_volume_close(volume);                                     \
    } while (0);
    SNOW_TYPE_MAP(CHECK_FIGURES)
#undef CHECK_FIGURES
}

static void only_finite_values_are_measured(void **state) {
    static const double voxels[6] = {NAN, 2, INFINITY, -4, -INFINITY, NAN};
    const support_files *files = *state;
    snow_volume_statistics m = {.size = sizeof m};
    snow_volume *volume = row_of(files->context, SNOW_TYPE_FLOAT64, voxels, 6);
    snow_volume_get_statistics(volume, &m);
    assert_true(m.voxels == 6 && m.finite == 2);
    assert_true(m.min == -4 && m.max == 2 && m.sum == -2);
    assert_true(m.wsum == 2 * 2 - 4 * 4);
    snow_volume_close(volume);
    volume = row_of(files->context, SNOW_TYPE_FLOAT64, voxels, 1); /* none */
    snow_volume_get_statistics(volume, &m);
    assert_true(m.finite == 0 && isnan(m.min) && isnan(m.max) && m.sum == 0);
    snow_volume_close(volume);
}

static void a_histogram_counts_both_ends(void **state) {
    static const double voxels[8] = {0, 0.99, 1, 2.5, 4, 4.01, -0.01, NAN};
    static const double wide[3] = {-1.7e308, 1, 1.7e308};
    static const uint64_t wanted[4] = {2, 1, 1, 1}, ones[3] = {1, 1, 1};
    const support_files *files = *state;
    uint64_t counts[4];
    snow_volume *volume = row_of(files->context, SNOW_TYPE_FLOAT64, voxels, 8);
    assert_int_equal(snow_volume_histogram(volume, 0, 4, 4, counts),
                     SNOW_STATUS_OK);
    assert_memory_equal(counts, wanted, sizeof wanted);
    assert_int_equal(snow_volume_histogram(volume, 4, 4, 4, counts),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_volume_histogram(volume, 0, INFINITY, 4, counts),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_volume_histogram(volume, 0, 1, 0, counts),
                     SNOW_STATUS_BAD_USAGE);
    snow_volume_close(volume);
    volume = row_of(files->context, SNOW_TYPE_FLOAT64, wide, 3);
    assert_int_equal(
        snow_volume_histogram(volume, -1.7e308, 1.7e308, 3, counts),
        SNOW_STATUS_OK);
    assert_memory_equal(counts, ones, sizeof ones);
    snow_volume_close(volume);
}

static void formats_are_listed(void **state) {
    (void)state;
    bool nrrd = false;
    size_t i = 0;
    for (; snow_format_name(i); i++) {
        assert_non_null(snow_format_description(i));
        nrrd |= !strcmp(snow_format_name(i), "nrrd");
    }
    assert_true(nrrd);
    assert_null(snow_format_description(i));
}

static void an_empty_file_is_refused_by_name(void **state) {
    support_files *files = *state;
    static const char *const names[] = {"a.nrrd", "a.nhdr", "a.raw",
                                        "a.nii",  "a.mha",  "a"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        support_refused(files, support_write(files, names[i], "", 0), NULL,
                        SNOW_STATUS_BAD_INPUT, "empty", 70000);
}

static void a_missing_file_is_refused_by_name(void **state) {
    support_files *files = *state;
    support_refused(files, support_path(files, "nothing.nrrd"), NULL,
                    SNOW_STATUS_BAD_INPUT, "cannot be opened", 1000);
}

static void a_phantom_has_its_own_type(void **state) {
    const support_files *files = *state;
    snow_volume *volume = NULL;
    const snow_volume_options options = {.size = sizeof options,
                                         .type = SNOW_TYPE_UINT8};
    assert_int_equal(
        snow_volume_open(files->context, "phantom:cube", &options, &volume),
        SNOW_STATUS_BAD_USAGE);
    assert_int_equal(
        snow_volume_open(files->context, "phantom:nobody", NULL, &volume),
        SNOW_STATUS_BAD_USAGE);
    assert_null(volume);
}

static void a_spacing_that_makes_no_space_is_refused(void **state) {
    const support_files *files = *state;
    snow_volume *volume = NULL;
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {1, 1, 1},
                                         .type = SNOW_TYPE_UINT8,
                                         .spacing = {1, 1, 1e-320}};
    assert_int_equal(
        snow_volume_open_memory(files->context, "a", "x", 1, &options, &volume),
        SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(files->context), "--spacing"));
    assert_null(volume);
}

/* Opens with the n-th allocation failing, for all n until it succeeds; returns
 * how many there are. */
static long fail_each_allocation(const char *path, bool once) {
    for (long n = 1;; n++) {
        support_failing failing = {.failing = n, .for_good = !once};
        snow_allocator allocator = support_failing_allocator(&failing);
        snow_context *context = NULL;
        snow_volume *volume = NULL;
        assert_int_equal(snow_context_new(&allocator, &context),
                         SNOW_STATUS_OK);
        snow_status status = snow_volume_open(context, path, NULL, &volume);
        if (status == SNOW_STATUS_OK) {
            snow_volume_close(volume);
        } else {
            assert_int_equal(status, SNOW_STATUS_NO_MEMORY);
            assert_null(volume);
            assert_non_null(
                strstr(snow_context_message(context), "out of memory"));
        }
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_free(context);
        if (status == SNOW_STATUS_OK)
            return n - 1;
    }
}

static void each_allocation_may_fail(void **state) {
    support_files *files = *state;
    static const char voxels[48] = "some voxels";
    unsigned char packed[300];
    size_t size = support_gzip(voxels, 48, packed, sizeof packed);
    support_write(files, "s1", packed, size);
    const char *paths[] = {
        support_write(files, "a_4x3x2_u16.raw.gz", packed, size),
        support_write_text(files, "a.nhdr",
                           "NRRD0005\ntype: double\ndimension: 4\n"
                           "sizes: 1 1 3 2\nendian: big\nencoding: gzip\n"
                           "kinds: space space space time\nbyte skip: -1\n"
                           "data file: LIST 4\ns1"),
        support_write_text(files, "b.nhdr",
                           "NRRD0005\ntype: float\ndimension: 1\n"
                           "sizes: 12\nendian: big\nencoding: gzip\n"
                           "data file: s1"),
    };
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
        for (int once = 0; once < 2; once++)
            assert_true(fail_each_allocation(paths[i], once) >= 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(types_know_their_names_and_sizes),
        cmocka_unit_test(bytes_swap_in_every_width),
        cmocka_unit_test(sizes_that_overflow_are_no_count),
        SUPPORT_TEST(impossible_headers_are_refused_before_any_allocation),
        cmocka_unit_test(a_matrix_of_flat_axes_has_no_inverse),
        SUPPORT_TEST(a_shared_volume_gets_its_defaults),
        SUPPORT_TEST(spacing_is_the_length_of_the_columns),
        SUPPORT_TEST(figures_are_right_for_every_type),
        SUPPORT_TEST(only_finite_values_are_measured),
        SUPPORT_TEST(a_histogram_counts_both_ends),
        cmocka_unit_test(formats_are_listed),
        SUPPORT_TEST(an_empty_file_is_refused_by_name),
        SUPPORT_TEST(a_missing_file_is_refused_by_name),
        SUPPORT_TEST(a_phantom_has_its_own_type),
        SUPPORT_TEST(a_spacing_that_makes_no_space_is_refused),
        SUPPORT_TEST(each_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
