/* formats/nrrd/nrrd.c - the NRRD format; its parts are listed in
 * formats/nrrd/nrrd.h. */
#include "formats/nrrd/nrrd.h"
#include "formats/write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Accepts any version, so that a newer one is refused as such and not read as
 * raw data. */
static bool looks_nrrd(const unsigned char *bytes, size_t size) {
    return size >= 6 && !memcmp(bytes, "NRRD00", 6);
}

/* Where no segment has a layer, as 3D Slicer wrote before 2020, each of several
 * volumes holds one segment, as 1. */
static snow_status set_labels(snow_context *context, const nrrd_text *text,
                              const snow_volume_info *info,
                              snow_volume *volume) {
    const size_t count = text->segment_count;
    int64_t last = -1;
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        if (text->segments[i].layer > last)
            last = text->segments[i].layer;
    const bool old = last < 0 && info->times == (int64_t)count && count > 1;
    snow_label *labels = snow_allocate_array(context, count, sizeof *labels);
    if (!labels)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const nrrd_segment *segment = &text->segments[i];
        if ((last > 0 && segment->layer != info->time && info->times > 1) ||
            (old && (int64_t)i != info->time))
            continue;
        labels[used] = segment->label;
        if (isnan(labels[used].value))
            labels[used].value = old ? 1 : (double)i + 1;
        used++;
    }
    snow_status status = snow_volume_set_labels(volume, labels, used);
    snow_release(context, labels);
    return status;
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
    if (!out && !values.all)
        return snow_nrrd_check_data(source, &header, &files, &region);
    snow_volume *volume = NULL;
    snow_volume **made = out ? &volume : NULL;
    SNOW_TRY(values.all ? snow_nrrd_read_values(source, &header, &files,
                                                options, &values, info, made)
                        : snow_nrrd_read_data(source, &header, &files, info,
                                              &region, made));
    snow_status status = text->segments && out
                             ? set_labels(context, text, info, volume)
                             : SNOW_STATUS_OK;
    if (status != SNOW_STATUS_OK)
        snow_volume_close(volume);
    else if (out)
        *out = volume;
    return status;
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
    snow_release(snow_source_context(source), text.segments);
    return status;
}

const snow_format snow_format_nrrd = {
    .name = "nrrd",
    .text = "NRRD, attached or detached, in all encodings (.nrrd, .nhdr)",
    .suffixes = {".nrrd", ".nhdr", ".nrrd.gz"},
    .probe = looks_nrrd,
    .crops = true,
    .channels = true,
    .read = read_nrrd,
    .write = snow_nrrd_write,
};
