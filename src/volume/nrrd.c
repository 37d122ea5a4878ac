/* volume/nrrd.c - the NRRD format, as its parts in volume/nrrd.h read it. */
#include "volume/nrrd.h"
#include "volume/write.h"

#include <string.h>

/* Any version, so that a newer one is refused as such and not taken for raw
 * data. */
static bool looks_nrrd(const unsigned char *bytes, size_t size) {
    return size >= 6 && !memcmp(bytes, "NRRD00", 6);
}

/* All of the header is understood and checked before a data file is opened or
 * the voxels get their memory: a header costs nothing that it does not back. */
static snow_status read_parsed(snow_source *source, const nrrd_text *text,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    nrrd_header header;
    nrrd_files files;
    snow_window window;
    *info = snow_volume_info_default("nrrd");
    SNOW_TRY(snow_nrrd_parse_header(context, text, &header));
    SNOW_TRY(snow_nrrd_lay_out(context, &header, options, info, &window));
    SNOW_TRY(snow_nrrd_find_files(context, text, &header, &files));
    if (!out)
        return snow_nrrd_check_data(source, &header, &files, &window);
    return snow_nrrd_read_data(source, &header, &files, info, &window, out);
}

/* Owns the text, so that each early return below leaves nothing behind. */
static snow_status read_nrrd(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    nrrd_text text;
    snow_status status = snow_nrrd_read_text(source, &text);
    if (status == SNOW_OK)
        status = read_parsed(source, &text, options, info, out);
    snow_release(snow_source_context(source), text.block);
    return status;
}

const snow_format snow_format_nrrd = {
    .name = "nrrd",
    .text = "NRRD, attached or detached; raw, gzip, ascii (.nrrd, .nhdr)",
    .suffixes = {".nrrd", ".nhdr", ".nrrd.gz"},
    .probe = looks_nrrd,
    .crops = true,
    .read = read_nrrd,
    .write = snow_nrrd_write,
};
