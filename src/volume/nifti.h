/* volume/nifti.h - a NIfTI header, whichever version and byte order it came
 * in.  Reference: nifti1.h (Cox et al. 2004) and nifti2.h (2011) of the NIfTI
 * working group; field names are theirs where they are good. */
#ifndef SNOW_NIFTI_H
#define SNOW_NIFTI_H

#include "volume/volume.h"

#define NIFTI1_BYTES 348 /* of the header, which its first field repeats */
#define NIFTI2_BYTES 540
/* Where the voxels of a single file start at the earliest: four bytes after
 * the header tell whether extensions follow. */
#define NIFTI_EXTENDER_BYTES 4

/* Begins the description of volumes that we write a matrix for though their
 * axes are no patient's, which the format cannot say. */
#define NIFTI_NO_PATIENT "no patient's axes"

typedef struct nifti_header {
    int version; /* 1 or 2 */
    bool big_endian;
    bool pair; /* the voxels are in a file of their own (.img) */
    int64_t dim[8];
    int datatype, bitpix;
    double pixdim[8]; /* [0] is qfac, the sign of the third axis */
    uint64_t vox_offset;
    double slope, intercept;
    int units; /* xyzt_units */
    int qform_code, sform_code;
    bool no_patient;   /* its description begins so */
    double quatern[3]; /* b, c, d */
    double qoffset[3];
    double srow[3][4];
} nifti_header;

/* Bytes of the header that starts with these bytes (at least 12 of them, or
 * as many as there are): NIFTI1_BYTES, NIFTI2_BYTES or 0 when it is none. */
size_t nifti_header_size(const unsigned char *bytes, size_t size);

/* Reads and checks the fields.  Errors: SNOW_BAD_INPUT. */
snow_status nifti_header_parse(snow_context *context,
                               const unsigned char *bytes, size_t size,
                               nifti_header *out);

/* The matrix, unit and `medical` of the header into info. */
void nifti_geometry(snow_context *context, const nifti_header *header,
                    snow_volume_info *info);

/* The format's code of a scalar type and back; 0 and SNOW_TYPE_NONE when there
 * is none.  The name of a code that is no scalar, NULL when unknown. */
int nifti_code(snow_type type);
snow_type nifti_type(int datatype);
const char *nifti_type_name(int datatype);

#endif
