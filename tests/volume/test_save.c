/* tests/volume/test_save.c - what is saved comes back: voxels, type, geometry.
 */
#include "support/files.h"
#include "volume/volume.h"

#include <math.h>
#include <unistd.h>

/* An oblique patient's matrix, of numbers that no float holds. */
static const double oblique[4][4] = {{-0.61, 0.33, 0.21, -101.3},
                                     {0.35, 0.72, -0.52, 17.77},
                                     {-0.11, -0.2, 1.9, 33.1},
                                     {0, 0, 0, 1}};

/* 5 x 3 x 4 voxels of random bits (no NaN matters: bits are compared). */
static snow_volume *make_volume(support_files *place, snow_type type,
                                bool medical, const double matrix[4][4]) {
    static unsigned char bits[60 * 8];
    uint64_t seed = 77;
    for (size_t i = 0; i < sizeof bits; i++)
        bits[i] = (unsigned char)support_random(&seed);
    snow_volume_info info = {
        .size = sizeof info, .dims = {5, 3, 4}, .type = type};
    memcpy(info.matrix, matrix, sizeof info.matrix);
    info.medical = medical;
    strcpy(info.unit, "mm");
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_wrap(place->context, &info, bits, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

static void save(support_files *place, const snow_volume *volume,
                 const char *path) {
    if (snow_volume_save(volume, path, true) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
}

static void every_format_keeps_every_type_and_the_matrix(void **state) {
    support_files *place = *state;
    static const struct {
        const char *name;
        double tolerance; /* NIfTI-1 keeps floats */
    } files[] = {
        {"a.nrrd", 1e-15},
        {"a.nii", 1e-5},
        {"a.nii.gz", 1e-5},
        {"a.mha", 1e-13},
    };
    for (size_t i = 0; i < 4; i++)
        for (int type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++) {
            const char *path = support_path(place, files[i].name);
            snow_volume *volume =
                make_volume(place, (snow_type)type, true, oblique);
            save(place, volume, path);
            snow_volume *back = support_opened(place, path, NULL);
            const snow_volume_info *info = snow_volume_get_info(back);
            support_same_voxels(volume, back);
            support_same_matrix(info->matrix, oblique, files[i].tolerance);
            assert_true(info->medical);
            assert_string_equal(info->unit, "mm");
            snow_volume_close(back);
            snow_volume_close(volume);
        }
    assert_string_equal(place->warnings, "");
}

static void raw_keeps_every_type_when_told_what_it_is(void **state) {
    support_files *place = *state;
    static const char *const names[] = {"a.raw", "a.raw.gz"};
    for (size_t i = 0; i < 2; i++)
        for (int type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++) {
            const char *path = support_path(place, names[i]);
            snow_volume *volume =
                make_volume(place, (snow_type)type, false, oblique);
            save(place, volume, path);
            const snow_volume_options options = {.size = sizeof options,
                                                 .dims = {5, 3, 4},
                                                 .type = (snow_type)type};
            snow_volume *back = NULL;
            assert_int_equal(
                snow_volume_open(place->context, path, &options, &back),
                SNOW_STATUS_OK);
            support_same_voxels(volume, back);
            snow_volume_close(back);
            snow_volume_close(volume);
            place->warnings[0] = 0;
        }
    snow_volume *volume = make_volume(place, SNOW_TYPE_UINT8, false, oblique);
    save(place, volume, support_path(place, "a.raw"));
    assert_non_null(strstr(place->warnings, "--dims 5x3x4 --type uint8"));
    snow_volume_close(volume);
}

static void what_is_no_patient_stays_none(void **state) {
    support_files *place = *state;
    static const double spaced[4][4] = {
        {1, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 0.5, 0}, {0, 0, 0, 1}};
    /* NIfTI would take the axes of any matrix for a patient's. */
    static const char *const names[] = {"a.nrrd", "a.nii", "a.mha"};
    for (size_t i = 0; i < 6; i++) {
        const char *path = support_path(place, names[i / 2]);
        const double(*matrix)[4] = i % 2 ? oblique : spaced;
        snow_volume *volume =
            make_volume(place, SNOW_TYPE_INT16, false, matrix);
        save(place, volume, path);
        snow_volume *back = support_opened(place, path, NULL);
        assert_false(snow_volume_get_info(back)->medical);
        support_same_matrix(snow_volume_get_info(back)->matrix, matrix,
                            i % 2 ? 1e-5 : 0);
        snow_volume_close(back);
        snow_volume_close(volume);
    }
}

/* MetaImage names um, mm and cm, NIfTI m, mm and um: lengths in others become
 * those. */
static void lengths_survive_in_formats_without_their_unit(void **state) {
    support_files *place = *state;
    static const double nine[4][4] = {
        {9, 0, 0, 0}, {0, 9, 0, 0}, {0, 0, 9, 0}, {0, 0, 0, 1}};
    static const struct {
        const char *unit;
        double mm;
    } units[] = {{"nm", 1e-6}, {"um", 1e-3}, {"cm", 10}, {"m", 1e3}};
    for (size_t i = 0; i < 8; i++) {
        const char *path = support_path(place, i % 2 ? "a.nii" : "a.mha");
        snow_volume *volume = make_volume(place, SNOW_TYPE_UINT8, false, nine);
        strcpy(volume->info.unit, units[i / 2].unit);
        save(place, volume, path);
        snow_volume *back = support_opened(place, path, NULL);
        const snow_volume_info *info = snow_volume_get_info(back);
        assert_string_equal(info->unit, "mm");
        assert_true(fabs(info->spacing[2] / (9 * units[i / 2].mm) - 1) < 1e-6);
        snow_volume_close(back);
        snow_volume_close(volume);
    }
}

static void scaling_survives_or_is_refused(void **state) {
    support_files *place = *state;
    static const struct {
        const char *name;
        snow_status status;
    } files[] = {{"a.nii", SNOW_STATUS_OK},
                 {"a.nii.gz", SNOW_STATUS_OK},
                 {"a.mha", SNOW_STATUS_OK},
                 {"a.nrrd", SNOW_STATUS_BAD_USAGE},
                 {"a.raw", SNOW_STATUS_BAD_USAGE}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *path = support_path(place, files[i].name);
        snow_volume *volume =
            make_volume(place, SNOW_TYPE_UINT8, true, oblique);
        volume->info.slope = 0.25;
        volume->info.intercept = -1024;
        assert_int_equal(snow_volume_save(volume, path, false),
                         files[i].status);
        if (files[i].status == SNOW_STATUS_OK) {
            snow_volume *back = support_opened(place, path, NULL);
            assert_true(snow_volume_get_info(back)->slope == 0.25);
            assert_true(snow_volume_get_info(back)->intercept == -1024);
            snow_volume_close(back);
        } else {
            assert_non_null(
                strstr(snow_context_message(place->context), "slope 0.25"));
            assert_int_not_equal(access(path, F_OK), 0);
        }
        snow_volume_close(volume);
    }
}

static void what_nifti_1_cannot_hold_becomes_nifti_2(void **state) {
    support_files *place = *state;
    static const unsigned char voxels[40000];
    snow_volume_info info = {
        .size = sizeof info, .dims = {40000, 1, 1}, .type = SNOW_TYPE_UINT8};
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_wrap(place->context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    const char *path = support_path(place, "a.nii");
    save(place, volume, path);
    snow_volume *back = support_opened(place, path, NULL);
    support_same_voxels(volume, back);
    snow_volume_close(back);
    snow_volume_close(volume);
    static const double tiny[4][4] = {{1e-42, 0, 0, 1e60},
                                      {0, 1e-42, 0, 0.1},
                                      {0, 0, 1e-42, 0.3},
                                      {0, 0, 0, 1}};
    volume = make_volume(place, SNOW_TYPE_UINT8, true, tiny);
    save(place, volume, path);
    back = support_opened(place, path, NULL);
    support_same_matrix(snow_volume_get_info(back)->matrix, tiny, 0);
    snow_volume_close(back);
    snow_volume_close(volume);
}

static void the_same_volume_gives_the_same_bytes(void **state) {
    support_files *place = *state;
    static const char *const pairs[][2] = {{"a.nii.gz", "b.nii.gz"},
                                           {"a.mha", "b.mha"}};
    snow_volume *volume = make_volume(place, SNOW_TYPE_INT32, true, oblique);
    for (size_t i = 0; i < 2; i++) {
        static char bytes[2][4096];
        size_t sizes[2];
        for (int k = 0; k < 2; k++) {
            const char *path = support_path(place, pairs[i][k]);
            save(place, volume, path);
            FILE *file = fopen(path, "rb");
            assert_non_null(file);
            sizes[k] = fread(bytes[k], 1, sizeof bytes[k], file);
            fclose(file);
        }
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    }
    snow_volume_close(volume);
}

static void existing_files_and_unknown_endings_are_refused(void **state) {
    support_files *place = *state;
    snow_volume *volume = make_volume(place, SNOW_TYPE_UINT8, true, oblique);
    const char *path = support_write(place, "a.nii", "old", 3);
    assert_int_equal(snow_volume_save(volume, path, false),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_non_null(strstr(snow_context_message(place->context), "exists"));
    path = support_path(place, "a.xyz");
    assert_int_equal(snow_volume_save(volume, path, false),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(place->context), ".nii.gz"));
    snow_volume_close(volume);
}

static void a_volume_of_many_buffers_is_packed_whole(void **state) {
    support_files *place = *state;
    size_t count = 700000;
    float *voxels = malloc(count * sizeof *voxels);
    assert_non_null(voxels);
    uint64_t seed = 9;
    for (size_t i = 0; i < count; i++)
        voxels[i] = (float)support_uniform(&seed);
    snow_volume_info info = {
        .size = sizeof info, .dims = {100, 100, 70}, .type = SNOW_TYPE_FLOAT32};
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_wrap(place->context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    const char *path = support_path(place, "a.nii.gz");
    save(place, volume, path);
    snow_volume *back = support_opened(place, path, NULL);
    support_same_voxels(volume, back);
    snow_volume_close(back);
    snow_volume_close(volume);
    free(voxels);
}

/* Makes each allocation of a save or an open fail, with all after it, until
 * one succeeds; returns how many allocations that took. */
static int64_t starve(support_files *place, const snow_volume *volume,
                      const char *path, bool saving) {
    const snow_volume_options raw = {
        .size = sizeof raw, .dims = {5, 3, 4}, .type = SNOW_TYPE_INT16};
    const snow_volume_options *options = strstr(path, ".raw") ? &raw : NULL;
    for (int64_t n = 1;; n++) {
        snow_volume *back = NULL;
        place->allocations = 0;
        place->fail_at = n;
        uint64_t held = snow_context_bytes(place->context);
        snow_status status =
            saving ? snow_volume_save(volume, path, false)
                   : snow_volume_open(place->context, path, options, &back);
        place->fail_at = 0;
        snow_volume_close(back);
        assert_int_equal(snow_context_bytes(place->context), held);
        if (status == SNOW_STATUS_OK)
            return n - 1;
        assert_int_equal(status, SNOW_STATUS_NO_MEMORY);
        assert_null(back);
        if (saving)
            assert_int_not_equal(access(path, F_OK), 0);
    }
}

static void every_failing_allocation_is_survived(void **state) {
    support_files *place = *state;
    static const char *const names[] = {"a.nrrd", "a.nii", "a.nii.gz",
                                        "a.mha",  "a.raw", "a.raw.gz"};
    snow_volume *volume = make_volume(place, SNOW_TYPE_INT16, true, oblique);
    for (size_t i = 0; i < 6; i++) {
        const char *path = support_path(place, names[i]);
        assert_true(starve(place, volume, path, true) > 1);
        assert_true(starve(place, volume, path, false) > 2);
    }
    snow_volume_close(volume);
}

#define UNIT(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_files_setup, \
                                    support_files_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        UNIT(every_format_keeps_every_type_and_the_matrix),
        UNIT(raw_keeps_every_type_when_told_what_it_is),
        UNIT(what_is_no_patient_stays_none),
        UNIT(lengths_survive_in_formats_without_their_unit),
        UNIT(scaling_survives_or_is_refused),
        UNIT(what_nifti_1_cannot_hold_becomes_nifti_2),
        UNIT(the_same_volume_gives_the_same_bytes),
        UNIT(existing_files_and_unknown_endings_are_refused),
        UNIT(every_failing_allocation_is_survived),
        UNIT(a_volume_of_many_buffers_is_packed_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
