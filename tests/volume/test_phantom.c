/* tests/volume/test_phantom.c - the built-in volumes are what their page says:
 * sizes, the paper's shares, the same bytes everywhere, and no mirror symmetry
 * where that is promised. */
#include "support/support.h"

#include <math.h>

static snow_volume *make(snow_context *context, const char *name,
                         const int64_t dims[3], uint64_t seed) {
    snow_volume *volume = NULL;
    if (snow_volume_open_phantom(context, name, dims, seed, &volume) !=
        SNOW_STATUS_OK)
        fail_msg("%s: %s", name, snow_context_message(context));
    return volume;
}

/* Those of their own sizes take long to make: they are kept for all tests. */
static snow_context *shared;
static snow_volume *kept[6];

static const snow_volume *standard(const char *name) {
    for (size_t n = 0; n < sizeof kept / sizeof *kept; n++)
        if (strcmp(snow_phantom_name(n), name) == 0) {
            if (!kept[n])
                kept[n] = make(shared, name, NULL, 0);
            return kept[n];
        }
    fail_msg("there is no %s", name);
    return NULL;
}

static int open_shared(void **state) {
    (void)state;
    shared = support_context();
    return 0;
}

static int close_shared(void **state) {
    (void)state;
    for (size_t n = 0; n < sizeof kept / sizeof *kept; n++)
        snow_volume_close(kept[n]);
    bool clean = snow_context_bytes(shared) == 0;
    snow_context_free(shared);
    return clean ? 0 : 1;
}

static uint64_t byte_count(const snow_volume *volume) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    return (uint64_t)(info->dims[0] * info->dims[1] * info->dims[2]) *
           snow_type_size(info->type);
}

/* FNV-1a over the bytes; those of float32 in little-endian order. */
static uint64_t checksum(const snow_volume *volume) {
    const unsigned char *bytes = snow_volume_voxels(volume);
    size_t size = snow_type_size(snow_volume_get_info(volume)->type);
    const uint16_t probe = 1;
    bool little = *(const unsigned char *)&probe;
    uint64_t sum = UINT64_C(0xcbf29ce484222325), count = byte_count(volume);
    for (uint64_t i = 0; i < count; i++) {
        uint64_t at = little ? i : i - i % size + (size - 1 - i % size);
        sum = (sum ^ bytes[at]) * UINT64_C(0x100000001b3);
    }
    return sum;
}

/* Percent of the voxels with values up to `most`. */
static double share(const snow_volume *volume, int most) {
    const uint8_t *bytes = snow_volume_voxels(volume);
    uint64_t count = byte_count(volume), found = 0;
    for (uint64_t i = 0; i < count; i++)
        found += bytes[i] <= most;
    return 100.0 * (double)found / (double)count;
}

static void check_shares(const char *name, const double paper[3]) {
    static const int thresholds[3] = {0, 10, 30};
    const snow_volume *volume = standard(name);
    for (int i = 0; i < 3; i++) {
        double got = share(volume, thresholds[i]);
        if (fabs(got - paper[i]) > 1)
            fail_msg("%s: %.2f %% at %d, not %g", name, got, thresholds[i],
                     paper[i]);
    }
}

static void the_cube_is_as_empty_as_the_papers(void **state) {
    (void)state;
    check_shares("cube", (double[3]){98, 98, 98});
}

static void the_heads_shares_are_the_papers(void **state) {
    (void)state;
    check_shares("head", (double[3]){0, 47, 70});
}

static void the_engines_shares_are_the_real_ones(void **state) {
    (void)state;
    check_shares("engine", (double[3]){27.9, 77.5, 81.7});
}

static void the_papers_phantoms_use_all_of_8_bits(void **state) {
    (void)state;
    static const char *const names[] = {"cube", "head", "engine", "shells"};
    for (size_t i = 0; i < 4; i++) {
        snow_volume_statistics measures = {.size = sizeof measures};
        snow_volume_get_statistics(standard(names[i]), &measures);
        assert_true(measures.min == 0 && measures.max == 255);
    }
}

static void default_sizes_types_and_places_are_told(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int64_t dims[3];
        snow_type type;
        bool medical;
    } expected[] = {
        {"cube", {256, 256, 110}, SNOW_TYPE_UINT8, false},
        {"head", {256, 256, 113}, SNOW_TYPE_UINT8, true},
        {"engine", {256, 256, 110}, SNOW_TYPE_UINT8, false},
        {"shells", {128, 128, 128}, SNOW_TYPE_UINT8, false},
        {"marschner-lobb", {40, 40, 40}, SNOW_TYPE_FLOAT32, false},
        {"turbulence", {128, 128, 128}, SNOW_TYPE_FLOAT32, false},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const snow_volume *volume = standard(expected[i].name);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_string_equal(snow_phantom_name(i), expected[i].name);
        assert_non_null(snow_phantom_description(i));
        assert_string_equal(info->format, "phantom");
        assert_memory_equal(info->dims, expected[i].dims, sizeof info->dims);
        assert_int_equal(info->type, expected[i].type);
        assert_int_equal(info->medical, expected[i].medical);
        for (int a = 0; a < 3; a++) {
            /* The middle of the boxes is the origin. */
            double middle =
                info->matrix[a][3] +
                info->spacing[a] * 0.5 * (double)(info->dims[a] - 1);
            assert_true(fabs(middle) < 1e-9);
        }
    }
    assert_null(snow_phantom_name(6));
    assert_null(snow_phantom_description(6));
}

static void bytes_are_the_same_on_every_machine(void **state) {
    (void)state;
    static const struct {
        const char *name;
        uint64_t sum;
    } expected[] = {
        {"cube", UINT64_C(0x78dc3abdc77e66ad)},
        {"head", UINT64_C(0x5362e710e1107195)},
        {"engine", UINT64_C(0x64e1d69df6f67415)},
        {"shells", UINT64_C(0x0d80409e00eaaf46)},
        {"marschner-lobb", UINT64_C(0x9fb15d84083c946d)},
        {"turbulence", UINT64_C(0x758403cf827ecb71)},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        uint64_t sum = checksum(standard(expected[i].name));
        if (sum != expected[i].sum)
            fail_msg("%s: 0x%016llx", expected[i].name,
                     (unsigned long long)sum);
    }
}

static void a_seed_moves_the_noise_and_nothing_else(void **state) {
    (void)state;
    const int64_t dims[3] = {64, 64, 28};
    snow_context *context = support_context();
    snow_volume *a = make(context, "engine", dims, 0);
    snow_volume *b = make(context, "engine", dims, 1);
    snow_volume *again = make(context, "engine", dims, 1);
    const uint8_t *p = snow_volume_voxels(a), *q = snow_volume_voxels(b);
    int moved = 0, most = 0;
    for (uint64_t i = 0; i < byte_count(a); i++) {
        int by = abs(p[i] - q[i]);
        moved += by > 0;
        most = by > most ? by : most;
    }
    assert_true(moved > 1000);
    assert_true(most < 60); /* the soft metal is at 112 */
    assert_true(checksum(b) == checksum(again));
    snow_volume_close(a);
    snow_volume_close(b);
    snow_volume_close(again);
    snow_context_free(context);
}

static void any_size_shows_the_same_shape(void **state) {
    (void)state;
    static const int64_t sizes[][3] = {
        {1, 1, 1}, {1, 37, 5}, {300, 2, 1}, {64, 64, 64}};
    snow_context *context = support_context();
    for (size_t n = 0; snow_phantom_name(n); n++) {
        const snow_volume_info *a =
            snow_volume_get_info(standard(snow_phantom_name(n)));
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            snow_volume *volume =
                make(context, snow_phantom_name(n), sizes[i], 0);
            const snow_volume_info *b = snow_volume_get_info(volume);
            assert_memory_equal(b->dims, sizes[i], sizeof b->dims);
            for (int k = 0; k < 3; k++)
                assert_true(fabs(a->spacing[k] * (double)a->dims[k] -
                                 b->spacing[k] * (double)b->dims[k]) < 1e-9);
            snow_volume_close(volume);
        }
    }
    snow_context_free(context);
}

static void a_size_of_0_along_an_axis_is_the_default_there(void **state) {
    (void)state;
    const int64_t dims[3] = {0, 16, 0}, expected[3] = {128, 16, 128};
    snow_context *context = support_context();
    snow_volume *volume = make(context, "shells", dims, 0);
    assert_memory_equal(snow_volume_get_info(volume)->dims, expected,
                        sizeof expected);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Whether the volume differs from itself with axis a counted backwards. */
static bool differs_mirrored(const snow_volume *volume, int axis, int most) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    const uint8_t *bytes = snow_volume_voxels(volume);
    const int64_t *n = info->dims;
    for (int64_t k = 0; k < n[2]; k++)
        for (int64_t j = 0; j < n[1]; j++)
            for (int64_t i = 0; i < n[0]; i++) {
                int64_t x = axis == 0 ? n[0] - 1 - i : i;
                int64_t y = axis == 1 ? n[1] - 1 - j : j;
                int64_t z = axis == 2 ? n[2] - 1 - k : k;
                int a = bytes[(k * n[1] + j) * n[0] + i];
                int b = bytes[(z * n[1] + y) * n[0] + x];
                if (abs(a - b) > most)
                    return true;
            }
    return false;
}

static void shells_and_head_can_be_told_from_their_mirrors(void **state) {
    (void)state;
    const snow_volume *shells = standard("shells"), *head = standard("head");
    for (int axis = 0; axis < 3; axis++) {
        assert_true(differs_mirrored(shells, axis, 100));
        assert_true(differs_mirrored(head, axis, 100));
    }
}

static void the_nose_is_in_front_and_the_capsule_on_the_right(void **state) {
    (void)state;
    const snow_volume *head = standard("head");
    const snow_volume_info *info = snow_volume_get_info(head);
    const uint8_t *bytes = snow_volume_voxels(head);
    /* Along the two rays from the middle of the face, front and back. */
    int64_t i = 128, k = (int64_t)((-30 - info->matrix[2][3]) / 2);
    int64_t front = 0, back = 0;
    for (int64_t j = 0; j < 256; j++)
        if (bytes[(k * 256 + j) * 256 + i] > 40) {
            back = back ? back : j + 1;
            front = j;
        }
    assert_true(front > 240);
    assert_true(256 - front < back);
    /* The capsule: world (79, 9, 37). */
    k = (int64_t)((37 - info->matrix[2][3]) / 2);
    int64_t j = (int64_t)(9 - info->matrix[1][3]);
    int64_t right = (int64_t)(79 - info->matrix[0][3]);
    assert_true(bytes[(k * 256 + j) * 256 + right] > 200);
    assert_true(bytes[(k * 256 + j) * 256 + 255 - right] < 100);
}

/* The formula by the C library's functions, which may round otherwise. */
static double marschner_lobb(double x, double y, double z) {
    const double pi = 3.14159265358979323846;
    double ripple = cos(2 * pi * 6 * cos(pi * sqrt(x * x + y * y) / 2));
    return (1 - sin(pi * z / 2) + 0.25 * (1 + ripple)) / 2.5;
}

static void marschner_and_lobbs_signal_is_theirs(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume = make(context, "marschner-lobb", NULL, 0);
    const snow_volume_info *info = snow_volume_get_info(volume);
    const float *values = snow_volume_voxels(volume);
    for (int k = 0; k < 40; k++)
        for (int j = 0; j < 40; j++)
            for (int i = 0; i < 40; i++) {
                double wanted =
                    marschner_lobb(info->matrix[0][3] + i * info->spacing[0],
                                   info->matrix[1][3] + j * info->spacing[1],
                                   info->matrix[2][3] + k * info->spacing[2]);
                assert_true(fabs(values[(k * 40 + j) * 40 + i] - wanted) <
                            1e-6);
            }
    snow_volume_close(volume);
    snow_context_free(context);
}

static void unknown_names_and_sizes_are_refused(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    const int64_t negative[3] = {4, -1, 4};
    const int64_t huge[3] = {INT64_MAX / 2, INT64_MAX / 2, 2};
    assert_int_equal(
        snow_volume_open_phantom(context, "foot", NULL, 0, &volume),
        SNOW_STATUS_BAD_USAGE);
    const char *message = snow_context_message(context);
    for (size_t n = 0; snow_phantom_name(n); n++)
        assert_non_null(strstr(message, snow_phantom_name(n)));
    assert_int_equal(
        snow_volume_open_phantom(context, "head", negative, 0, &volume),
        SNOW_STATUS_BAD_USAGE);
    assert_int_equal(
        snow_volume_open_phantom(context, "head", huge, 0, &volume),
        SNOW_STATUS_BAD_USAGE);
    assert_null(volume);
    assert_true(snow_context_bytes(context) == 0);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cube_is_as_empty_as_the_papers),
        cmocka_unit_test(the_heads_shares_are_the_papers),
        cmocka_unit_test(the_engines_shares_are_the_real_ones),
        cmocka_unit_test(the_papers_phantoms_use_all_of_8_bits),
        cmocka_unit_test(default_sizes_types_and_places_are_told),
        cmocka_unit_test(bytes_are_the_same_on_every_machine),
        cmocka_unit_test(a_seed_moves_the_noise_and_nothing_else),
        cmocka_unit_test(any_size_shows_the_same_shape),
        cmocka_unit_test(a_size_of_0_along_an_axis_is_the_default_there),
        cmocka_unit_test(shells_and_head_can_be_told_from_their_mirrors),
        cmocka_unit_test(the_nose_is_in_front_and_the_capsule_on_the_right),
        cmocka_unit_test(marschner_and_lobbs_signal_is_theirs),
        cmocka_unit_test(unknown_names_and_sizes_are_refused),
    };
    return cmocka_run_group_tests(tests, open_shared, close_shared);
}
