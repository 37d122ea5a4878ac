/* formats/nifti/write.c - writes NIfTI files with header and voxels in one.
 *
 * Writes NIfTI-1, which every program reads; it stores the geometry in single
 * precision.  Volumes that do not fit, with more than 32767 voxels along an
 * axis or numbers beyond a float's range, become NIfTI-2.  The matrix goes into
 * sform. A matrix that is not medical gets code 2, "aligned to something else",
 * unless spacings alone express it. */
#include "formats/write.h"
#include "formats/nifti/nifti.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A header under construction. */
typedef struct header {
    unsigned char bytes[NIFTI2_BYTES + NIFTI_EXTENDER_BYTES];
    const nifti_layout *layout;
} header;

/* Low byte first, as formats/write.h promises for all formats. */
static void put_int(header *h, int at, int size, uint64_t value) {
    for (int i = 0; i < size; i++)
        h->bytes[at + i] = (unsigned char)(value >> (8 * i));
}

/* In the width of the version: 4 bytes in NIfTI-1, 8 in NIfTI-2. */
static void put_float(header *h, int at, double value) {
    uint64_t bits;
    if (h->layout->float_bytes == 8) {
        memcpy(&bits, &value, sizeof bits);
    } else {
        float narrow = (float)value;
        uint32_t half;
        memcpy(&half, &narrow, sizeof half);
        bits = half;
    }
    put_int(h, at, h->layout->float_bytes, bits);
}

/* True if single precision can represent the number with its usual accuracy. */
static bool fits_float(double value) {
    return value == 0 || (fabs(value) <= FLT_MAX && fabs(value) >= FLT_MIN);
}

/* dim has 16 signed bits there, and all other numbers are floats. */
static bool fits_version1(const snow_volume_info *info) {
    bool fits = fits_float(info->slope) && fits_float(info->intercept);
    for (int i = 0; i < 3; i++)
        fits =
            fits && info->dims[i] <= INT16_MAX && fits_float(info->spacing[i]);
    for (int i = 0; i < 12; i++)
        fits = fits && fits_float(info->matrix[i / 4][i % 4]);
    return fits;
}

/* True if the matrix is diagonal with the spacings. */
static bool is_spacing_only(const snow_volume_info *info) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (info->matrix[i][j] != (i == j ? info->spacing[i] : 0))
                return false;
    return true;
}

/* NIfTI's code of a unit of length; 0 if it has none. */
static unsigned unit_code(const char *unit) {
    return !strcmp(unit, "m")    ? 1
           : !strcmp(unit, "mm") ? 2
           : !strcmp(unit, "um") ? 3
                                 : 0;
}

/* Offsets of pixdim and dim count from entry 0, which is qfac and the number of
 * axes. */
static void put_fields(header *h, const snow_volume_info *info) {
    const nifti_layout *p = h->layout;
    put_int(h, p->dim, p->dim_bytes, 3);
    put_float(h, p->pixdim, 1); /* qfac */
    for (int i = 0; i < 7; i++) {
        put_int(h, p->dim + (i + 1) * p->dim_bytes, p->dim_bytes,
                i < 3 ? (uint64_t)info->dims[i] : 1);
        put_float(h, p->pixdim + (i + 1) * p->float_bytes,
                  i < 3 ? info->spacing[i] : 1);
    }
    put_int(h, p->datatype, 2, (uint64_t)nifti_code(info->type));
    put_int(h, p->datatype + 2, 2, 8 * snow_type_size(info->type));
    put_float(h, p->slope, info->slope);
    put_float(h, p->intercept, info->intercept);
    put_int(h, p->units, 1, unit_code(info->unit));
    /* A file with a matrix is read as a patient's. */
    uint64_t code = info->medical ? 1 : is_spacing_only(info) ? 0 : 2;
    if (code == 2)
        memcpy(h->bytes + p->descrip, NIFTI_NO_PATIENT,
               sizeof NIFTI_NO_PATIENT);
    put_int(h, p->sform_code, p->code_bytes, code);
    for (int i = 0; i < 12 && code; i++)
        put_float(h, p->srow + i * p->float_bytes, info->matrix[i / 4][i % 4]);
}

/* Fills the header; returns its size, including the extender. */
static size_t fill_version1(header *h, const snow_volume_info *info) {
    h->layout = &nifti_layouts[0];
    put_int(h, 0, 4, NIFTI1_BYTES);
    put_int(h, 38, 1, 'r'); /* "regular", for readers of Analyze's time */
    put_fields(h, info);
    put_float(h, 108, NIFTI1_BYTES + NIFTI_EXTENDER_BYTES);
    memcpy(h->bytes + 344, "n+1", 4);
    return NIFTI1_BYTES + NIFTI_EXTENDER_BYTES;
}

static size_t fill_version2(header *h, const snow_volume_info *info) {
    h->layout = &nifti_layouts[1];
    put_int(h, 0, 4, NIFTI2_BYTES);
    memcpy(h->bytes + 4, "n+2\0\r\n\032\n", 8);
    put_fields(h, info);
    put_int(h, 168, 8, NIFTI2_BYTES + NIFTI_EXTENDER_BYTES);
    return NIFTI2_BYTES + NIFTI_EXTENDER_BYTES;
}

snow_status snow_nifti_write(const snow_volume *volume, const char *path,
                             snow_writer *writer) {
    (void)path;
    static const char *const units[] = {"m", "mm", "um", NULL};
    const snow_volume_info info = snow_write_in_units(&volume->info, units);
    header h = {0};
    size_t size = fits_version1(&info) ? fill_version1(&h, &info)
                                       : fill_version2(&h, &info);
    SNOW_TRY(snow_writer_write(writer, h.bytes, size));
    return snow_write_voxels(volume, writer);
}
