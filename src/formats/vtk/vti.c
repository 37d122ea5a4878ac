/* formats/vtk/vti.c - image data and rectilinear grids of VTK's XML files: .vti
 * and .vtr. */
#include "formats/vtk/vti.h"
#include "io/filters/filters.h"

#include <math.h>
#include <string.h>

snow_status snow_vti_read_values(snow_source *source, vti_header *header,
                                 const vti_small *small,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    int64_t channel;
    SNOW_TRY(snow_vti_read_header(source, options, header));
    if (header->in_pieces)
        return SNOW_STATUS_OK;
    memcpy(header->grid.coordinates, small->coordinates,
           sizeof small->coordinates);
    SNOW_TRY(snow_vtk_describe(context, &header->grid, &header->array, options,
                               info));
    info->directions = header->array.vectors;
    SNOW_TRY(snow_volume_pick_component(
        context, options, header->array.channels, info, &channel));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    info->time_value = small->time;
    snow_volume *volume = NULL;
    SNOW_TRY(snow_vti_read_data(source, header, options, channel, info,
                                out ? &volume : NULL));
    snow_status status = out ? snow_source_verify(source) : SNOW_STATUS_OK;
    return snow_volume_give(status, volume, out);
}

/* The same from the bytes, if they are held and the source is read. */
static snow_status read_beside(snow_source *source, snow_seekable *bytes,
                               vti_header *header, const vti_small *small,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_source *held = NULL;
    if (!bytes || !snow_seekable_held(bytes))
        return snow_vti_read_values(source, header, small, options, info, out);
    SNOW_TRY(snow_source_open_memory(
        snow_source_context(source), snow_source_name(source),
        snow_seekable_held(bytes), (size_t)snow_seekable_size(bytes), &held));
    snow_status status =
        snow_vti_read_values(held, header, small, options, info, out);
    snow_source_close(held);
    return status;
}

/* A packed file of image data is not held for its time alone. */
static snow_status read_xml(snow_source *source, bool rectilinear,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    vti_header header = {.grid = {.rectilinear = rectilinear}};
    vti_small small = {.time = NAN};
    snow_seekable *bytes = NULL;
    snow_volume *volume = NULL;
    snow_status status = SNOW_STATUS_OK;
    *info = snow_volume_info_default(rectilinear ? "vtr" : "vti");
    if (rectilinear || snow_source_remaining(source) >= 0) {
        SNOW_TRY(snow_seekable_open(source, &bytes));
        status = snow_vti_survey(source, bytes, rectilinear, &small);
    }
    if (status == SNOW_STATUS_OK)
        status = read_beside(source, bytes, &header, &small, options, info,
                             out ? &volume : NULL);
    if (status == SNOW_STATUS_OK && header.in_pieces)
        status = snow_vti_read_pieces(source, bytes, &header, &small, options,
                                      info, out ? &volume : NULL);
    else if (status == SNOW_STATUS_OK && bytes && out)
        status = snow_vti_check_tail(source, bytes, &header);
    status = snow_volume_give(status, volume, out);
    memcpy(header.grid.coordinates, small.coordinates,
           sizeof small.coordinates);
    snow_vtk_release(context, &header.grid);
    snow_seekable_close(bytes);
    return status;
}

static snow_status read_vti(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    return read_xml(source, false, options, info, out);
}

static snow_status read_vtr(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    return read_xml(source, true, options, info, out);
}

static bool probe_vtr(const unsigned char *bytes, size_t size) {
    return snow_vtk_probe_xml(bytes, size, "RectilinearGrid");
}

/* Files of other types are taken too: the reader reports what a .vtp is. */
static bool probe_vti(const unsigned char *bytes, size_t size) {
    return snow_vtk_probe_xml(bytes, size, NULL);
}

const snow_format snow_format_vti = {
    .name = "vti",
    .text = "VTK image data in XML (.vti)",
    .suffixes = {".vti", ".vti.gz"},
    .probe = probe_vti,
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_vti,
};

const snow_format snow_format_vtr = {
    .name = "vtr",
    .text = "VTK rectilinear grids in XML (.vtr)",
    .suffixes = {".vtr", ".vtr.gz"},
    .probe = probe_vtr,
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_vtr,
};
