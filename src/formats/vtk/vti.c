/* formats/vtk/vti.c - image data of VTK's XML files: .vti. */
#include "formats/vtk/vti.h"
#include "io/filters/filters.h"

#include <string.h>

static snow_status read_vti(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    vti_header header;
    int64_t channel;
    *info = snow_volume_info_default("vti");
    SNOW_TRY(snow_vti_read_header(source, options, &header));
    SNOW_TRY(snow_vtk_describe(context, &header.grid, &header.array, info));
    SNOW_TRY(snow_volume_pick_component(context, options, header.array.channels,
                                        info, &channel));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    snow_volume *volume = NULL;
    SNOW_TRY(snow_vti_read_data(source, &header, options, channel, info,
                                out ? &volume : NULL));
    if (!out)
        return SNOW_STATUS_OK;
    snow_status status = snow_source_verify(source);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_STATUS_OK;
}

/* Looks for the element that all XML files of VTK have near their front,
 * whatever their type: the reader reports what a .vtp is. */
static bool probe_vti(const unsigned char *bytes, size_t size) {
    static const char tag[] = "<VTKFile";
    size_t near = size < 1024 ? size : 1024;
    if (!size || (*bytes != '<' && *bytes != 0xef && *bytes > ' '))
        return false;
    for (size_t i = 0; i + sizeof tag - 1 <= near; i++)
        if (!memcmp(bytes + i, tag, sizeof tag - 1))
            return true;
    return false;
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
