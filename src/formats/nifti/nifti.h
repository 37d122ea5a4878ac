/* formats/nifti/nifti.h - the parsed header of a NIfTI file of either version
 * and byte order.  Sources: nifti1.h (Cox et al. 2004) and nifti2.h (2011) of
 * the NIfTI working group; field names are theirs where possible. */
#ifndef SNOW_FORMATS_NIFTI_NIFTI_H
#define SNOW_FORMATS_NIFTI_NIFTI_H

#include "formats/format.h"

#define NIFTI1_BYTES                                         \
    348 /* size of the header, which its first field repeats \
         */
#define NIFTI2_BYTES 540
/* The smallest offset of the voxels in a single file: four bytes after the
 * header say whether extensions follow. */
#define NIFTI_EXTENDER_BYTES 4

/* Begins the description of volumes with a matrix but without a medical
 * orientation, which the format cannot express. */
#define NIFTI_NO_PATIENT "no patient's axes"

typedef struct nifti_header {
    int version; /* 1 or 2 */
    bool big_endian;
    bool pair; /* the voxels are in a file of their own (.img) */
    int64_t dim[8];
    int datatype, bitpix;
    bool labels, vectors, estimate; /* intent_code says that values are */
    bool colors;                    /* of single channels: red, green, blue */
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

/* Sets matrix, unit and `medical` of info from the header. */
void nifti_geometry(snow_context *context, const nifti_header *header,
                    const snow_volume_options *options, snow_volume_info *info);

/* The format's code of a scalar type and the inverse; 0 and SNOW_TYPE_NONE if
 * there is none.  The name of a code that is not a scalar, NULL if unknown. */
int nifti_code(snow_type type);
snow_type nifti_type(int datatype);
int nifti_samples(int datatype); /* of a voxel: 3 and 4 of colours, else 1 */
const char *nifti_type_name(int datatype);

#endif
