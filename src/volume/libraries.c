/* volume/libraries.c - which optional libraries this build has. */
#include "base/module.h"
#include "volume/volume.h"

static const struct {
    const char *name, *version, *formats;
    bool built;
    const char *module; /* that has it (base/module.h); NULL: linked */
} libraries[] = {
    {"expat", SNOW_VERSION_EXPAT, "vti", SNOW_HAVE_EXPAT, NULL},
    {"libtiff", SNOW_VERSION_TIFF, "tiff, and tiff pictures", SNOW_HAVE_TIFF,
     "tiff"},
    {"libhdf5", SNOW_VERSION_HDF5, "hdf5, NetCDF-4", SNOW_HAVE_HDF5, "hdf5"},
    {"gdcm", SNOW_VERSION_GDCM, "packed dicom", SNOW_HAVE_GDCM, "gdcm"},
    {"OpenEXR", SNOW_VERSION_EXR, "exr pictures", SNOW_HAVE_EXR, NULL},
    {"libwebp", SNOW_VERSION_WEBP, "webp pictures and movies", SNOW_HAVE_WEBP,
     NULL},
    {"blosc", SNOW_VERSION_BLOSC, "zarr packed by it", SNOW_HAVE_BLOSC,
     "blosc"},
    {"zstd", SNOW_VERSION_ZSTD, "zarr packed by it", SNOW_HAVE_ZSTD, NULL},
    {"lz4", SNOW_VERSION_LZ4, "zarr packed by it", SNOW_HAVE_LZ4, NULL},
};

/* A module is not loaded for that, which would take as long as all else. */
static bool is_there(size_t index) {
    const char *module = libraries[index].module;
    return libraries[index].built && (!module || snow_module_is_there(module));
}

const char *snow_library_name(size_t index, const char **version,
                              const char **formats) {
    if (index >= sizeof libraries / sizeof *libraries)
        return NULL;
    *version = is_there(index) ? libraries[index].version : NULL;
    *formats = libraries[index].formats;
    return libraries[index].name;
}
