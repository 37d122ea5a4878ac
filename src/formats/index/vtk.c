/* formats/index/vtk.c - VTK's XML files that name others:
 *
 *     .pvd    <Collection> <DataSet timestep="0.5" part="0" file="a_0.vti"/>
 *     .pvti   <PImageData> <Piece Extent="0 9 0 19 0 19" Source="a_0.vti"/>
 *     .vtm    <vtkMultiBlockDataSet> <Block> <DataSet file="a/a_0.vti"/>
 *
 * Files of one time are parts of one grid. */
#include "formats/vtk/vtk.h"
#include "formats/index/index.h"

#include <math.h>
#include <string.h>

typedef struct vtk_index {
    index_list list;
    bool file;
} vtk_index;

static snow_status begin_element(void *user, const char *name,
                                 const char **attributes) {
    vtk_index *index = user;
    const char *file = NULL;
    double time = NAN;
    if (!strcmp(name, "DataSet")) {
        const char *step = snow_index_attribute(attributes, "timestep");
        file = snow_index_attribute(attributes, "file");
        if (step && !snow_parse_double(step, &time))
            return snow_fail(
                index->list.context, SNOW_STATUS_BAD_INPUT,
                "its timestep \"%.60s\" is not a number; correct it", step);
    }
    if (!strcmp(name, "Piece"))
        file = snow_index_attribute(attributes, "Source");
    return file ? snow_index_add(&index->list, file, 0, time) : SNOW_STATUS_OK;
}

/* Surfaces and meshes, which have no voxels. */
static bool is_mesh(const char *name) {
    static const char *const suffixes[] = {".vtp",  ".vtu",  ".vts",
                                           ".pvtp", ".pvtu", ".pvts"};
    const char *dot = strrchr(name, '.');
    bool found = false;
    for (size_t i = 0; dot && i < sizeof suffixes / sizeof *suffixes; i++)
        found = found || snow_same_name(dot, suffixes[i]);
    return found;
}

/* Leaves them out where there is something else. */
static void leave_meshes_out(index_list *list) {
    const char *mesh = NULL;
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++)
        if (is_mesh(snow_index_name(list, i)))
            mesh = snow_index_name(list, i);
        else
            list->entries[kept++] = list->entries[i];
    if (kept && mesh)
        snow_notify(list->context,
                    "%zu of %zu files are surfaces or meshes, which have no "
                    "voxels (%.100s); they are left out",
                    list->count - kept, list->count, mesh);
    list->count = kept ? kept : list->count;
}

/* Data sets without a time are parts of one step. */
static snow_status read_index(snow_source *source, const char *format,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    const index_xml handlers = {.begin = begin_element};
    vtk_index index = {.list = {.context = snow_source_context(source)}};
    snow_status status = snow_index_parse(source, &handlers, &index);
    if (status == SNOW_STATUS_OK) {
        leave_meshes_out(&index.list);
        snow_index_sort(&index.list);
        status =
            snow_index_read(source, &index.list, format, options, info, out);
    }
    snow_index_free(&index.list);
    return status;
}

static snow_status read_pvd(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    return read_index(source, "pvd", options, info, out);
}

static snow_status read_pvti(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    return read_index(source, "pvti", options, info, out);
}

static snow_status read_vtm(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    return read_index(source, "vtm", options, info, out);
}

static bool probe_pvd(const unsigned char *bytes, size_t size) {
    return snow_vtk_probe_xml(bytes, size, "Collection");
}

static bool probe_pvti(const unsigned char *bytes, size_t size) {
    return snow_vtk_probe_xml(bytes, size, "PImageData");
}

static bool probe_vtm(const unsigned char *bytes, size_t size) {
    return snow_vtk_probe_xml(bytes, size, "vtkMultiBlockDataSet");
}

const snow_format snow_format_pvd = {
    .name = "pvd",
    .text = "series of VTK files in time (.pvd)",
    .suffixes = {".pvd"},
    .probe = probe_pvd,
    .crops = true,
    .sets = true,
    .channels = true,
    .levels = true,
    .read = read_pvd,
};

const snow_format snow_format_pvti = {
    .name = "pvti",
    .text = "VTK image data in several files (.pvti)",
    .suffixes = {".pvti"},
    .probe = probe_pvti,
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_pvti,
};

const snow_format snow_format_vtm = {
    .name = "vtm",
    .text = "blocks of VTK image data (.vtm)",
    .suffixes = {".vtm"},
    .probe = probe_vtm,
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_vtm,
};
