/* tests/volume/test_open_with.c - a volume whose bytes a function copies is the
 * one of the same bytes in memory, for each file of the fuzzers' corpora, and
 * no more is asked for than is needed. */
#include "support/files.h"

#include <string.h>
#include <time.h>

/* Bytes in memory behind a function, and what was asked of it. */
typedef struct store {
    const unsigned char *bytes;
    uint64_t size;
    uint64_t asked;    /* bytes so far */
    uint64_t fails_at; /* from this byte on; 0: never */
    bool outside;      /* more was asked for than there is */
    bool slow;         /* longer than between two reports of progress */
} store;

static size_t read_at(void *user, uint64_t at, void *bytes, size_t size) {
    store *s = user;
    s->asked += size;
    if (s->slow)
        nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    if (at > s->size || size > s->size - at) {
        s->outside = true;
        return 0;
    }
    if (s->fails_at && at + size > s->fails_at)
        size = at < s->fails_at ? (size_t)(s->fails_at - at) : 0;
    memcpy(bytes, s->bytes + at, size);
    return size;
}

static void same(const char *path, snow_context *a, snow_context *b,
                 const snow_volume *x, const snow_volume *y) {
    if (!x != !y ||
        strcmp(snow_context_message(a), snow_context_message(b)) != 0)
        fail_msg("%s: \"%s\", but in memory \"%s\"", path,
                 snow_context_message(b), snow_context_message(a));
    if (!x)
        return;
    const snow_volume_info *p = snow_volume_get_info(x),
                           *q = snow_volume_get_info(y);
    size_t bytes = snow_type_size(p->type) *
                   (size_t)(p->dims[0] * p->dims[1] * p->dims[2]);
    assert_memory_equal(p->dims, q->dims, sizeof p->dims);
    assert_memory_equal(p->matrix, q->matrix, sizeof p->matrix);
    assert_int_equal(p->type, q->type);
    if (memcmp(snow_volume_voxels(x), snow_volume_voxels(y), bytes) != 0)
        fail_msg("%s: other voxels than in memory", path);
}

static void check_file(const char *path, const char *name) {
    static unsigned char bytes[1 << 16];
    snow_context *a = support_context(), *b = support_context();
    snow_volume *x = NULL, *y = NULL;
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    store s = {.bytes = bytes, .size = fread(bytes, 1, sizeof bytes, file)};
    fclose(file);
    snow_context_set_memory_limit(a, 64 << 20);
    snow_context_set_memory_limit(b, 64 << 20);
    snow_volume_open_memory(a, name, bytes, (size_t)s.size, NULL, &x);
    snow_volume_open_with(b, name, read_at, &s, s.size, NULL, &y);
    same(path, a, b, x, y);
    assert_false(s.outside);
    snow_volume_close(x);
    snow_volume_close(y);
    assert_int_equal(snow_context_bytes(b), 0);
    snow_context_free(a);
    snow_context_free(b);
}

static void every_format_reads_it(void **state) {
    (void)state;
    static const char *const subjects[][2] = {
        {"npy_volume", "a.npy"}, {"mrc", "a.mrc"},       {"vtk", "a.vtk"},
        {"vti", "a.vti"},        {"tiff", "a.tif"},      {"png_slice", "a.png"},
        {"netcdf", "a.nc"},      {"nrrd", "a.nrrd"},     {"nifti", "a.nii"},
        {"hdf5", "a.h5"},        {"metaimage", "a.mha"}, {"den", "a.den"},
        {"jpeg", "a.jpg"},
    };
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++)
        support_each_of_corpus(subjects[i][0], subjects[i][1], check_file);
}

/* 8 GiB of voxels that lie nowhere: each is its index in the file. */
static size_t count_up(void *user, uint64_t at, void *bytes, size_t size) {
    *(uint64_t *)user += size;
    for (size_t i = 0; i < size; i++)
        ((unsigned char *)bytes)[i] =
            (unsigned char)((at + i) / 2 >> (8 * ((at + i) % 2)));
    return size;
}

static void only_what_a_crop_needs_is_asked_for(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    uint64_t asked = 0;
    const uint64_t size = 2 * UINT64_C(1) << 32;
    const snow_volume_options options = {
        .size = sizeof options,
        .dims = {2048, 2048, 1024},
        .type = SNOW_TYPE_UINT16,
        .crop = {{0, 2048}, {0, 2}, {1000, 1003}}};
    if (snow_volume_open_with(context, "a.raw", count_up, &asked, size,
                              &options, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int64_t z = 0; z < 3; z++)
        for (int64_t i = 0; i < 2 * 2048; i++)
            assert_int_equal(voxels[z * 2 * 2048 + i],
                             (((1000 + z) * 2048 * 2048) + i) & 0xffff);
    assert_true(asked < 1 << 20);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_function_that_fails_is_named(void **state) {
    (void)state;
    static unsigned char bytes[100000];
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    store s = {.bytes = bytes, .size = sizeof bytes, .fails_at = 70000};
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {100, 100, 10},
                                         .type = SNOW_TYPE_UINT8};
    assert_int_equal(snow_volume_open_with(context, "a.raw", read_at, &s,
                                           sizeof bytes, &options, &volume),
                     SNOW_STATUS_BAD_INPUT);
    assert_null(volume);
    assert_non_null(
        strstr(snow_context_message(context), "a.raw: cannot be read at byte"));
    assert_int_equal(snow_volume_open_with(context, "a.raw", read_at, &s,
                                           UINT64_MAX, &options, &volume),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "2^63 - 1"));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static bool stop_at_once(void *user, snow_stage stage, double fraction) {
    (void)fraction;
    *(int *)user += stage == SNOW_STAGE_READ;
    return true;
}

static void reading_is_reported_and_stops(void **state) {
    (void)state;
    static unsigned char bytes[4 << 20];
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    int heard = 0;
    store s = {.bytes = bytes, .size = sizeof bytes, .slow = true};
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {1024, 1024, 4},
                                         .type = SNOW_TYPE_UINT8};
    snow_context_set_progress(context, stop_at_once, &heard);
    assert_int_equal(snow_volume_open_with(context, "a.raw", read_at, &s,
                                           sizeof bytes, &options, &volume),
                     SNOW_STATUS_STOPPED);
    assert_int_equal(heard, 1);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_reads_it),
        cmocka_unit_test(only_what_a_crop_needs_is_asked_for),
        cmocka_unit_test(a_function_that_fails_is_named),
        cmocka_unit_test(reading_is_reported_and_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
