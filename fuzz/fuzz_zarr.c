/* fuzz/fuzz_zarr.c - an input is a folder of files as records
 * (tests/support/records.h): the first array or image in it, a level by its
 * number, and a box. */
#include "formats/zarr/zarr.h"
#include "support/capped.h"
#include "support/records.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void look_inside(const char *folder, const char *path,
                        const snow_volume_options *options) {
    size_t held;
    snow_context *context = capped_context(&held);
    zarr_store store = {.context = context};
    snow_volume *volume = NULL;
    snow_volume_info info = {.size = sizeof info};
    snprintf(store.folder, sizeof store.folder, "%s", folder);
    snow_status status =
        snow_zarr_read_store(&store, path, options, &info, &volume);
    capped_finish(context, &held, status, volume);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options whole = {.size = sizeof whole, .time = 0};
    const snow_volume_options box = {.size = sizeof box,
                                     .time = 1,
                                     .channel = 1,
                                     .crop = {{1, 3}, {0, 2}, {1, 0}}};
    char folder[32];
    records_unpack(bytes, size, folder);
    look_inside(folder, "", &whole);
    look_inside(folder, "1", &box);
    records_remove(folder);
    return 0;
}
