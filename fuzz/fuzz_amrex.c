/* fuzz/fuzz_amrex.c - an input is a plotfile, a folder of files as records
 * (tests/support/records.h): all of it, and a box of another component. */
#include "formats/amr/amr.h"
#include "support/capped.h"
#include "support/records.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

typedef struct plotfile {
    snow_context *context;
    const uint8_t *bytes;
    size_t size;
} plotfile;

static snow_status open_record(void *user, const char *name,
                               snow_source **out) {
    const plotfile *in = user;
    records_file file;
    for (size_t at = 0; records_next(in->bytes, in->size, &at, &file);)
        if (!strcmp(file.name, name))
            return snow_source_open_memory(in->context, "fuzz", file.bytes,
                                           file.size, out);
    return snow_fail(in->context, SNOW_STATUS_BAD_INPUT, "%.100s: is missing",
                     name);
}

static void look_inside(const uint8_t *bytes, size_t size,
                        const snow_volume_options *options) {
    size_t held;
    snow_context *context = capped_context(&held);
    plotfile in = {context, bytes, size};
    snow_source *header;
    snow_volume *volume = NULL;
    snow_volume_info info = {.size = sizeof info};
    snow_status status = open_record(&in, "Header", &header);
    if (status == SNOW_STATUS_OK) {
        status = snow_plotfile_read(header, open_record, &in, options, &info,
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
