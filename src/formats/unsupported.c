/* formats/unsupported.c - recognises files that are not supported, and says how
 * to convert them.
 *
 * Magic numbers are those of file(1), and of the codes that write the files. */
#include "formats/opening.h"
#include "io/folder.h"

#include <stdio.h>
#include <string.h>

#define MESH                                                            \
    "of an unstructured grid; resample it to image data with ParaView " \
    "(Resample"                                                         \
    " To Image) and write .vti"
#define CHECKPOINT                                                           \
    "is a checkpoint of AMReX, which only its code reads; give a plotfile, " \
    "such as plt00000"

#define AFNI                                                        \
    "is a header of AFNI, which is not supported; convert it with " \
    "3dAFNItoNIFTI"

static const struct {
    size_t offset;
    const char *magic;
    size_t length;
    const char *advice;
} unsupported_formats[] = {
    {257, "ustar", 5,
     "is a tar archive; unpack it and open the file or the folder in it"},
    {0, "PK\3\4", 4, "is a zip archive; unpack it and open what is in it"},
    {0, "BZh", 3, "is compressed by bzip2; decompress it with bunzip2"},
    {0,
     "\xFD"
     "7zXZ",
     5, "is compressed by xz; decompress it with unxz"},
    {0, "\x28\xB5\x2F\xFD", 4,
     "is compressed by zstd; decompress it with unzstd"},
    {0, "11111\n", 6,
     "is an SLC volume of VolVis, which is not supported; convert it to .vti "
     "with VTK's vtkSLCReader"},
    {0, "MATLAB 5.0", 10,
     "is a MATLAB file of version 5, which is not supported; save it with "
     "-v7.3, as HDF5"},
    {0, "RIFF", 4,
     "is a RIFF file (WebP, sound or film) and not a volume; use PNG or TIFF "
     "slices"},
    {0, "%PDF", 4, "is a PDF document and not a volume"},
    {0, "GRIB", 4,
     "is a GRIB file; convert it with cdo -f nc4 -t ecmwf "
     "setgridtype,regular IN.grib OUT.nc"},
    {0, "CheckPointVersion", 17, CHECKPOINT},
    {0, "Checkpoint version", 18, CHECKPOINT},
    {0, "Checkpoint file for", 19, CHECKPOINT},
    {0, "InitialCycleNumber", 18,
     "is a file of parameters of Enzo, whose grids on levels are not "
     "supported; make one grid with yt (covering_grid), and save it as .npy"},
    {0, "\nGrid = 1\n", 10,
     "is a file of the hierarchy of Enzo, whose grids on levels are not "
     "supported; make one grid with yt (covering_grid), and save it as .npy"},
    {0, "mrtrix image\n", 13,
     "is an image of MRtrix, which is not supported; convert it with mrconvert "
     "IN.mif OUT.nii.gz"},
    {0, "\ntype ", 6, AFNI},
    {0, "type ", 5, AFNI},
    {0, "$MeshFormat", 11, "is a mesh of Gmsh, " MESH},
    {0, "#!TDV", 5, "is a file of Tecplot, mostly " MESH},
    {0, "FoamFile", 8, "is a file of OpenFOAM, " MESH},
};

const char *snow_stranger(const unsigned char *bytes, size_t size) {
    for (size_t i = 0;
         i < sizeof unsupported_formats / sizeof *unsupported_formats; i++)
        if (size >=
                unsupported_formats[i].offset + unsupported_formats[i].length &&
            !memcmp(bytes + unsupported_formats[i].offset,
                    unsupported_formats[i].magic,
                    unsupported_formats[i].length))
            return unsupported_formats[i].advice;
    return NULL;
}

/* Names of dimensions stand in the first bytes. */
const char *snow_mesh_in_netcdf(const unsigned char *bytes, size_t size) {
    static const char *const names[] = {"num_nodes", "num_el_blk"};
    if (size < 4 || memcmp(bytes, "CDF", 3) != 0)
        return NULL;
    for (int n = 0; n < 2; n++) {
        const size_t letters = strlen(names[n]);
        bool found = false;
        for (size_t i = 4; i + letters <= size && !found; i++)
            found = !memcmp(bytes + i, names[n], letters);
        if (!found)
            return NULL;
    }
    return "is an Exodus file, " MESH;
}

snow_status snow_refuse_folder(snow_context *context, const char *path) {
    char name[4096];
    if (snprintf(name, sizeof name, "%s/md.idx", path) >= (int)sizeof name ||
        !snow_is_there(context, name, strlen(name)))
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "is a file of ADIOS2 (.bp); convert it to HDF5 with "
                     "openpmd-pipe --infile IN.bp --outfile OUT.h5, or with "
                     "adios2_reorganize");
}
