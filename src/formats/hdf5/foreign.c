/* formats/hdf5/foreign.c - files of codes whose grids are not read, and what
 * makes a volume of them.  They would pass for arrays that are none. */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <string.h>

static const struct {
    const char *link; /* that such files have in the root */
    const char *also; /* NULL, or another one */
    const char *advice;
} strangers[] = {
    {"Parameters and Global Attributes", NULL,
     "is a file of Cactus (Carpet), whose components overlap on levels, which "
     "is not supported; resample it to an even grid with kuibit "
     "(UniformGrid) and save it as .npy"},
    {"Chombo_global", "level_0",
     "is a file of Chombo (also of PLUTO), whose boxes on levels are not "
     "supported; make one grid with yt (covering_grid), and save it as .npy"},
    {"Grid00000001", NULL,
     "is a file of Enzo, whose grids on levels are not supported; make one "
     "grid with yt (covering_grid), and save it as .npy"},
    {"PartType0", "Header",
     "has particles (Gadget, Arepo, Swift), which are no volume; deposit them "
     "on a grid, such as with yt (arbitrary_grid), and save it as .npy"},
    {"PartType1", "Header",
     "has particles (Gadget, Arepo, Swift), which are no volume; deposit them "
     "on a grid, such as with yt (arbitrary_grid), and save it as .npy"},
    {"CGNSLibraryVersion", NULL,
     "is a CGNS file; resample it to image data with ParaView (Resample To "
     "Image) and write .vti"},
    {".silo", NULL,
     "is a Silo file; resample it to an even grid with VisIt, and write .vtk "
     "or "
     ".vti"},
    {"coordx", "eb_status",
     "is an Exodus file, of an unstructured grid; resample it to image data "
     "with ParaView (Resample To Image) and write .vti"},
    {"coord", "eb_status",
     "is an Exodus file, of an unstructured grid; resample it to image data "
     "with ParaView (Resample To Image) and write .vti"},
};

static const char *find_stranger(hid_t file) {
    for (size_t i = 0; i < sizeof strangers / sizeof *strangers; i++)
        if (H5Lexists(file, strangers[i].link, H5P_DEFAULT) > 0 &&
            (!strangers[i].also ||
             H5Lexists(file, strangers[i].also, H5P_DEFAULT) > 0))
            return strangers[i].advice;
    return NULL;
}

/* VTKHDF has more kinds of data than grids. */
static snow_status refuse_vtk(snow_context *context, const hdf5_file *file) {
    char type[40] = "";
    const hid_t root = H5Lexists(snow_hdf5_id(file), "VTKHDF", H5P_DEFAULT) > 0
                           ? H5Gopen2(snow_hdf5_id(file), "VTKHDF", H5P_DEFAULT)
                           : -1;
    if (root >= 0)
        snow_hdf5_text(file, root, "Type", 0, type, sizeof type);
    snow_hdf5_drop(root);
    if (!*type || !strcmp(type, "ImageData") || !strcmp(type, "OverlappingAMR"))
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "is a VTKHDF file of type %s, which is no grid of "
                     "voxels; resample it with ParaView (Resample To Image) "
                     "and write .vti",
                     type);
}

snow_status snow_hdf5_refuse_strangers(snow_context *context,
                                       const hdf5_file *file,
                                       const char *asked) {
    if (asked) /* a data set is what its axes say */
        return SNOW_STATUS_OK;
    const char *advice = find_stranger(snow_hdf5_id(file));
    if (advice)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT, "%s", advice);
    return refuse_vtk(context, file);
}

#endif
