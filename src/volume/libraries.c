/* volume/libraries.c - which optional libraries this build has. */
#include "volume/volume.h"

static const struct {
    const char *name, *version, *formats;
    bool built;
} libraries[] = {
    {"expat", SNOW_VERSION_EXPAT, "vti", SNOW_HAVE_EXPAT},
    {"libtiff", SNOW_VERSION_TIFF, "tiff, and tiff pictures", SNOW_HAVE_TIFF},
    {"libhdf5", SNOW_VERSION_HDF5, "hdf5, NetCDF-4", SNOW_HAVE_HDF5},
    {"gdcm", SNOW_VERSION_GDCM, "packed dicom", SNOW_HAVE_GDCM},
    {"OpenEXR", SNOW_VERSION_EXR, "exr pictures", SNOW_HAVE_EXR},
    {"blosc", SNOW_VERSION_BLOSC, "zarr packed by it", SNOW_HAVE_BLOSC},
    {"zstd", SNOW_VERSION_ZSTD, "zarr packed by it", SNOW_HAVE_ZSTD},
    {"lz4", SNOW_VERSION_LZ4, "zarr packed by it", SNOW_HAVE_LZ4},
    {"libwebp", SNOW_VERSION_WEBP, "webp pictures and movies", SNOW_HAVE_WEBP},
};

const char *snow_library_name(size_t index, const char **version,
                              const char **formats) {
    if (index >= sizeof libraries / sizeof *libraries)
        return NULL;
    *version = libraries[index].built ? libraries[index].version : NULL;
    *formats = libraries[index].formats;
    return libraries[index].name;
}
