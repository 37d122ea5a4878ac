/* formats/table.c - the formats that are read, by their first bytes and by
 * their names. */
#include "formats/format.h"

/* DICOM comes before all: its 128 bytes without a meaning are TIFF in files
 * that are both, for programs that know slices only as that.  Raw, which
 * recognises nothing, is the last. */
static const snow_format *const formats[] = {
    &snow_format_dicom,     &snow_format_nrrd,   &snow_format_nifti,
    &snow_format_metaimage, &snow_format_npy,    &snow_format_vtk,
    &snow_format_vtr,       &snow_format_pvd,    &snow_format_pvti,
    &snow_format_vtm,       &snow_format_vth,    &snow_format_xdmf,
    &snow_format_amrex,     &snow_format_vti,    &snow_format_mrc,
    &snow_format_tiff,      &snow_format_png,    &snow_format_jpeg,
    &snow_format_hdf5,      &snow_format_netcdf, &snow_format_den,
    &snow_format_mgh,       &snow_format_gipl,   &snow_format_zarr,
    &snow_format_visit,     &snow_format_bov,    &snow_format_cube,
    &snow_format_vasp,      &snow_format_raw,
};
#define FORMAT_COUNT (sizeof formats / sizeof *formats)

const char *snow_format_name(size_t index) {
    return index < FORMAT_COUNT ? formats[index]->name : NULL;
}

const char *snow_format_description(size_t index) {
    return index < FORMAT_COUNT ? formats[index]->text : NULL;
}

/* The first in the order of the table that claims them. */
const snow_format *snow_format_of_bytes(const void *bytes, size_t size) {
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (formats[i]->probe && formats[i]->probe(bytes, size))
            return formats[i];
    return NULL;
}

/* For bytes that no probe knows: a damaged file is refused by the reader that
 * its name asks for, which says more than "unknown". */
const snow_format *snow_format_of_name(const char *name) {
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (snow_format_has_name(formats[i], name))
            return formats[i];
    return NULL;
}
