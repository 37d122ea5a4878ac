/* formats/features.c - the optional libraries of this build. */
#include "base/module.h"
#include "formats/format.h"

static const struct {
    const char *name, *version, *formats;
    bool built;
    const char *module; /* the module with it (base/module.h); NULL: linked */
} features[] = {
    {"expat", SNOW_VERSION_EXPAT, "VTI", SNOW_HAVE_EXPAT, NULL},
    {"libtiff", SNOW_VERSION_TIFF, "TIFF volumes and pictures", SNOW_HAVE_TIFF,
     "tiff"},
    {"libhdf5", SNOW_VERSION_HDF5, "HDF5, NetCDF-4", SNOW_HAVE_HDF5, "hdf5"},
    {"gdcm", SNOW_VERSION_GDCM, "compressed DICOM", SNOW_HAVE_GDCM, "gdcm"},
    {"OpenEXR", SNOW_VERSION_EXR, "OpenEXR pictures", SNOW_HAVE_EXR, NULL},
    {"libwebp", SNOW_VERSION_WEBP, "WebP pictures and movies", SNOW_HAVE_WEBP,
     NULL},
    {"libjpeg", SNOW_VERSION_JPEG, "JPEG volumes and pictures", SNOW_HAVE_JPEG,
     NULL},
    {"blosc", SNOW_VERSION_BLOSC, "compressed Zarr", SNOW_HAVE_BLOSC, "blosc"},
    {"zstd", SNOW_VERSION_ZSTD, "compressed Zarr", SNOW_HAVE_ZSTD, NULL},
    {"lz4", SNOW_VERSION_LZ4, "compressed Zarr and VTI", SNOW_HAVE_LZ4, NULL},
    {"libbz2", SNOW_VERSION_BZIP2, "files packed by bzip2", SNOW_HAVE_BZIP2,
     NULL},
};

const char *snow_library_name(size_t index, const char **version,
                              const char **formats) {
    if (index >= sizeof features / sizeof *features)
        return NULL;
    /* Only looks for the module: loading it would take as long as all else. */
    const char *module = features[index].module;
    *version =
        (features[index].built && (!module || snow_module_is_there(module)))
            ? features[index].version
            : NULL;
    *formats = features[index].formats;
    return features[index].name;
}
