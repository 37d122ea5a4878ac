/* formats/nifti/nifti.h - the parsed header of a NIfTI file of either version
 * and byte order.  Sources: nifti1.h (Cox et al. 2004) and nifti2.h (2011) of
 * the NIfTI working group; field names are theirs where possible. */
#ifndef SNOW_FORMATS_NIFTI_NIFTI_H
#define SNOW_FORMATS_NIFTI_NIFTI_H

#include "formats/format.h"

/* Sizes of the headers, which their first fields repeat. */
#define NIFTI1_BYTES 348
#define NIFTI2_BYTES 540
/* The smallest offset of the voxels in a single file: four bytes after the
 * header say whether extensions follow. */
#define NIFTI_EXTENDER_BYTES 4

/* Begins the description of volumes with a matrix but without a medical
 * orientation, which the format cannot express. */
#define NIFTI_NO_PATIENT "no patient's axes"

/* A data type of the format. */
typedef struct nifti_type {
    int code;
    snow_type type;   /* SNOW_TYPE_NONE: not supported; */
    int samples;      /* of a voxel: 3 and 4 of colours, 2 of complex numbers */
    const char *name; /* of those that are not supported; NULL: unknown */
} nifti_type;

const nifti_type *nifti_type_of_code(int code);

/* The format's code of a scalar type. */
int nifti_code(snow_type type);

/* The offsets and widths of a version's fields. */
typedef struct nifti_layout {
    int float_bytes, dim_bytes, code_bytes;
    int datatype, bitpix, dim, pixdim, slope, intercept, units, units_bytes;
    int cal_max, cal_min, intent, descrip, qform_code, sform_code, quatern,
        qoffset, srow;
} nifti_layout;

extern const nifti_layout nifti_layouts[2];

typedef struct nifti_header {
    int version; /* 1 or 2 */
    bool big_endian;
    bool pair; /* the voxels are in a file of their own (.img) */
    int64_t dim[8];
    int datatype, bitpix;
    const nifti_type *type;
    bool labels, vectors, estimate; /* intent_code says that values are */
    bool colors;                    /* of single channels: red, green, blue */
    bool surfaces;                  /* values of no volume: CIFTI */
    double pixdim[8]; /* [0] is qfac, the sign of the third axis */
    uint64_t vox_offset;
    double slope, intercept;
    double cal_min, cal_max; /* data values; equal: none */
    int units;               /* xyzt_units */
    int qform_code, sform_code;
    bool no_patient;   /* its description begins with the text above */
    double quatern[3]; /* b, c, d */
    double qoffset[3];
    double srow[3][4];
} nifti_header;

/* The size of the header that begins with these bytes (at least 12 of them, or
 * as many as there are): NIFTI1_BYTES, NIFTI2_BYTES, or 0 for none. */
size_t nifti_header_size(const unsigned char *bytes, size_t size);

/* Parses and checks the fields.  Errors: SNOW_STATUS_BAD_INPUT. */
snow_status nifti_header_parse(snow_context *context,
                               const unsigned char *bytes, size_t size,
                               nifti_header *out);

/* Writes as a snow_format does. */
snow_status snow_nifti_write(const snow_volume *volume, const char *path,
                             snow_writer *writer);

#endif
