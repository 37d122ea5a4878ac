/* tests/formats/test_corpus.c - every file of the fuzzers' corpora of volumes
 * is opened with each allocation made to fail, once and from there on: an error
 * with a message, nothing held, no crash. */
#include "formats/format.h"
#include "support/failing.h"
#include "support/files.h"

/* Opens the file; returns the allocations made. */
static long open_failing(const char *path, const char *name, const void *bytes,
                         size_t size, long failing, bool for_good,
                         bool *failed) {
    support_failing allocator = {
        .failing = failing, .for_good = for_good, .largest = (size_t)64 << 20};
    const snow_allocator functions = support_failing_allocator(&allocator);
    snow_context *context;
    snow_volume *volume = NULL;
    if (snow_context_new(&functions, &context) != SNOW_STATUS_OK) {
        *failed = true;
        return allocator.allocations;
    }
    snow_status status =
        snow_volume_open_memory(context, name, bytes, size, NULL, &volume);
    *failed = status != SNOW_STATUS_OK;
    if (*failed && (volume || !*snow_context_message(context)))
        fail_msg("%s, allocation %ld: no message", path, failing);
    snow_volume_close(volume);
    snow_context_free(context);
    if (allocator.held)
        fail_msg("%s, allocation %ld: %ld blocks stay", path, failing,
                 allocator.held);
    return allocator.allocations;
}

static void check_file(const char *path, const char *name) {
    static unsigned char bytes[1 << 16];
    bool failed;
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    long count = open_failing(path, name, bytes, size, -1, false, &failed);
    for (long i = 0; i < count; i++) {
        bool again;
        open_failing(path, name, bytes, size, i, false, &failed);
        open_failing(path, name, bytes, size, i, true, &again);
        if (!failed || !again)
            fail_msg("%s: opens without its allocation %ld", path, i);
    }
}

static void no_reader_is_lost_without_memory(void **state) {
    (void)state;
    static const char *const subjects[][2] = {
        {"vtr", "a.vtr"},       {"pvd", "a.pvd"},        {"pvti", "a.pvti"},
        {"vtm", "a.vtm"},       {"xdmf", "a.xmf"},       {"visit", "a.visit"},
        {"bov", "a.bov"},       {"npy_volume", "a.npy"}, {"mrc", "a.mrc"},
        {"vtk", "a.vtk"},       {"vti", "a.vti"},        {"tiff", "a.tif"},
        {"png_slice", "a.png"}, {"hdf5", "a.h5"},        {"netcdf", "a.nc"},
        {"nrrd", "a.nrrd"},     {"nifti", "a.nii"},      {"metaimage", "a.mha"},
        {"den", "a.den"},       {"vth", "a.vth"},        {"jpeg", "a.jpg"},
        {"mgh", "a.mgh"},       {"gipl", "a.gipl"},      {"cube", "a.cube"},
        {"vasp", "CHGCAR"},
    };
    const size_t count = sizeof subjects / sizeof *subjects;
    for (size_t i = 0; i < count; i++)
        support_each_of_corpus(subjects[i][0], subjects[i][1], check_file);
    /* Those, and four that no single file without options shows: DICOM (its
     * library allocates for itself), Zarr and AMReX (folders) and raw. */
    if (snow_format_name(count + 4 - 1) == NULL ||
        snow_format_name(count + 4) != NULL)
        fail_msg("a format has no line above: it needs its corpus there");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_reader_is_lost_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
