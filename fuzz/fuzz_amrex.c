/* fuzz/fuzz_amrex.c - an input is a plotfile, a folder of files as records
 * (formats/zarr/zarr.h): all of it, and a box of another component. */
#include "formats/amr/amr.h"
#include "formats/zarr/zarr.h"
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static snow_status open_record(void *user, const char *name,
                               snow_source **out) {
    const zarr_store *store = user;
    zarr_file file;
    SNOW_TRY(snow_zarr_open(store, name, &file));
    if (!file.is_there)
        return snow_fail(store->context, SNOW_STATUS_BAD_INPUT,
                         "%.100s: is missing", name);
    return snow_source_open_memory(store->context, "fuzz", file.bytes,
                                   (size_t)file.size, out);
}

static void look_inside(const uint8_t *bytes, size_t size,
                        const snow_volume_options *options) {
    size_t held;
    snow_context *context = capped_context(&held);
    zarr_store store = {.context = context, .records = bytes, .size = size};
    snow_source *header;
    snow_volume *volume = NULL;
    snow_volume_info info = {.size = sizeof info};
    snow_status status = open_record(&store, "Header", &header);
    if (status == SNOW_STATUS_OK) {
        status = snow_plotfile_read(header, open_record, &store, options, &info,
                                    &volume);
        snow_source_close(header);
    }
    capped_finish(context, &held, status, volume);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options whole = {.size = sizeof whole};
    const snow_volume_options box = {
        .size = sizeof box, .component = "b", .crop = {{1, 3}, {0, 2}, {1, 0}}};
    look_inside(bytes, size, &whole);
    look_inside(bytes, size, &box);
    return 0;
}
