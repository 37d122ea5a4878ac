/* formats/nrrd/nrrd.c - the NRRD format; its parts are listed in
 * formats/nrrd/nrrd.h. */
#include "formats/nrrd/nrrd.h"
#include "formats/write.h"

#include <stdio.h>
#include <string.h>

/* Accepts any version, so that a newer one is refused as such and not read as
 * raw data. */
static bool looks_nrrd(const unsigned char *bytes, size_t size) {
    return size >= 6 && !memcmp(bytes, "NRRD00", 6);
}

/* The whole header is checked before a data file is opened or the voxels are
 * allocated, so false sizes cost nothing. */
static snow_status read_parsed(snow_source *source, const nrrd_text *text,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    nrrd_header header;
    nrrd_files files;
    snow_region region;
    snow_array values;
    *info = snow_volume_info_default("nrrd");
    SNOW_TRY(snow_nrrd_parse_header(context, text, &header));
    SNOW_TRY(
        snow_nrrd_lay_out(context, &header, options, info, &region, &values));
    const char *unit = snow_nrrd_value(text, NRRD_SAMPLE_UNITS);
    if (unit && sscanf(unit + (*unit == '"'), "%31[^\"]", info->value_unit) < 1)
        *info->value_unit = 0;
    SNOW_TRY(snow_nrrd_find_files(context, text, &header, &files));
    if (values.all)
        return snow_nrrd_read_values(source, &header, &files, options, &values,
                                     info, out);
    if (!out)
        return snow_nrrd_check_data(source, &header, &files, &region);
    SNOW_TRY(snow_nrrd_read_data(source, &header, &files, info, &region, out));
    return text->labels
               ? snow_volume_set_labels(*out, text->labels, text->label_count)
               : SNOW_STATUS_OK;
}

/* Owns the text, so that the early returns below leak nothing. */
static snow_status read_nrrd(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    nrrd_text text;
    snow_status status = snow_nrrd_read_text(source, &text);
    if (status == SNOW_STATUS_OK)
        status = read_parsed(source, &text, options, info, out);
    snow_release(snow_source_context(source), text.block);
    snow_release(snow_source_context(source), text.labels);
    return status;
}

const snow_format snow_format_nrrd = {
    .name = "nrrd",
    .text = "NRRD, attached or detached; raw, gzip, ascii (.nrrd, .nhdr)",
    .suffixes = {".nrrd", ".nhdr", ".nrrd.gz"},
    .probe = looks_nrrd,
    .crops = true,
    .channels = true,
    .read = read_nrrd,
    .write = snow_nrrd_write,
};
