/* formats/nifti/header.c - parses the bytes of a NIfTI-1 or NIfTI-2 header.
 *
 * A pure function on bytes.  The first field is the header's size, 348 or 540,
 * which gives version and byte order; the magic confirms it.  Offsets are those
 * of nifti1.h and nifti2.h. */
#include "formats/bytes/number.h"
#include "formats/nifti/nifti.h"

#include <math.h>
#include <string.h>

/* The names are those of refusals. */
static const nifti_type types[] = {
    {2, SNOW_TYPE_UINT8, 1, NULL},
    {4, SNOW_TYPE_INT16, 1, NULL},
    {8, SNOW_TYPE_INT32, 1, NULL},
    {16, SNOW_TYPE_FLOAT32, 1, NULL},
    {64, SNOW_TYPE_FLOAT64, 1, NULL},
    {256, SNOW_TYPE_INT8, 1, NULL},
    {512, SNOW_TYPE_UINT16, 1, NULL},
    {768, SNOW_TYPE_UINT32, 1, NULL},
    {1024, SNOW_TYPE_INT64, 1, NULL},
    {1280, SNOW_TYPE_UINT64, 1, NULL},
    {32, SNOW_TYPE_FLOAT32, 2, NULL},
    {1792, SNOW_TYPE_FLOAT64, 2, NULL},
    {128, SNOW_TYPE_UINT8, 3, NULL},
    {2304, SNOW_TYPE_UINT8, 4, NULL},
    {1, SNOW_TYPE_NONE, 1, "single bits"},
    {1536, SNOW_TYPE_NONE, 1, "128-bit floats"},
    {2048, SNOW_TYPE_NONE, 2, "complex numbers (2 x 128 bits)"},
    {0, SNOW_TYPE_NONE, 0, NULL},
};

const nifti_type *nifti_type_of_code(int code) {
    const nifti_type *at = types;
    while (at->samples && at->code != code)
        at++;
    return at;
}

/* The first of a type has one sample. */
int nifti_code(snow_type type) {
    const nifti_type *at = types;
    while (at->type != type)
        at++;
    return at->code;
}

/* True if the first field is this size in either byte order, which *big
 * gives. */
static bool has_size(const unsigned char *bytes, uint64_t size, bool *big) {
    *big = snow_number_at(bytes, 4, true) == size;
    return *big || snow_number_at(bytes, 4, false) == size;
}

/* The byte order in which dim[0] is a number of axes, for headers whose first
 * field is wrong.  Returns false if there is none. */
static bool order_of_dim(const unsigned char *bytes, bool *big) {
    for (int order = 0; order < 2; order++) {
        int64_t axes = snow_integer_at(bytes + 40, 2, order);
        if (axes >= 1 && axes <= 7) {
            *big = order;
            return true;
        }
    }
    return false;
}

/* Version 2 is tested first: its magic is at the front.  A wrong size field is
 * accepted only in version 1, where magic and dim[0] still identify it. */
size_t nifti_header_size(const unsigned char *bytes, size_t size) {
    bool big;
    if (size >= 12 && has_size(bytes, NIFTI2_BYTES, &big) &&
        (memcmp(bytes + 4, "n+2", 4) == 0 || memcmp(bytes + 4, "ni2", 4) == 0))
        return NIFTI2_BYTES;
    /* Version 1 has its magic at the header's end, with its NUL; Analyze has
     * none. */
    const bool magic1 =
        size >= NIFTI1_BYTES && (memcmp(bytes + 344, "n+1", 4) == 0 ||
                                 memcmp(bytes + 344, "ni1", 4) == 0);
    /* The size of version 2 is no mistake of a program: one of both is wrong.
     */
    if (magic1 && !has_size(bytes, NIFTI2_BYTES, &big) &&
        (has_size(bytes, NIFTI1_BYTES, &big) || order_of_dim(bytes, &big)))
        return NIFTI1_BYTES;
    return 0;
}

#define INTENT_CORRELATION 2 /* the first of statistics, */
#define INTENT_LOG10PVAL 24  /* and the last */
#define INTENT_ESTIMATE 1001
#define INTENT_LABEL 1002
#define INTENT_DISPLACEMENT 1006
#define INTENT_VECTOR 1007
#define INTENT_RGB 2003
#define INTENT_RGBA 2004
#define INTENT_FNIRT 2006 /* displacements, of FSL */
#define INTENT_CIFTI 3000 /* the first of CIFTI's, */
#define INTENT_LAST 3099  /* and the last */

/* In the order of the members above, from the comments of nifti1.h and
 * nifti2.h; version 2 widens most fields and moves all. */
const nifti_layout nifti_layouts[2] = {
    {4, 2,   2,   70, 72,  40,  76,  112, 116, 123,
     1, 124, 128, 68, 148, 252, 254, 256, 268, 280},
    {8, 8,   4,   12,  14,  16,  104, 176, 184, 500,
     4, 192, 200, 504, 240, 344, 348, 352, 376, 400},
};

static void read_floats(const unsigned char *at, int count,
                        const nifti_layout *layout, bool big, double *out) {
    for (int i = 0; i < count; i++)
        out[i] = snow_real_at(at + i * layout->float_bytes, layout->float_bytes,
                              big);
}

/* xyzt_units holds two units: bits 0 to 2 are that of length. */
static void read_fields(const unsigned char *bytes, nifti_header *header) {
    const nifti_layout *l = &nifti_layouts[header->version - 1];
    bool big = header->big_endian;
    for (int i = 0; i < 8; i++)
        header->dim[i] = snow_integer_at(bytes + l->dim + i * l->dim_bytes,
                                         l->dim_bytes, big);
    header->datatype = (int)snow_integer_at(bytes + l->datatype, 2, big);
    header->bitpix = (int)snow_integer_at(bytes + l->bitpix, 2, big);
    header->units =
        (int)(snow_number_at(bytes + l->units, l->units_bytes, big) & 7);
    header->qform_code =
        (int)snow_integer_at(bytes + l->qform_code, l->code_bytes, big);
    header->sform_code =
        (int)snow_integer_at(bytes + l->sform_code, l->code_bytes, big);
    const int64_t intent =
        snow_integer_at(bytes + l->intent, l->code_bytes, big);
    header->labels = intent == INTENT_LABEL;
    header->estimate =
        intent == INTENT_ESTIMATE ||
        (intent >= INTENT_CORRELATION && intent <= INTENT_LOG10PVAL);
    /* FSL calls directions colours, since they are shown as such. */
    const bool floats = header->datatype == 16 || header->datatype == 64;
    header->vectors = intent == INTENT_DISPLACEMENT ||
                      intent == INTENT_VECTOR || intent == INTENT_FNIRT ||
                      (intent == INTENT_RGB && floats);
    header->colors = (intent == INTENT_RGB && !floats) || intent == INTENT_RGBA;
    header->surfaces = intent >= INTENT_CIFTI && intent <= INTENT_LAST;
    /* FSL keeps components where time is. */
    if ((header->vectors || header->colors) && header->dim[0] == 4 &&
        header->dim[4] == (intent == INTENT_RGBA ? 4 : 3)) {
        header->dim[0] = 5;
        header->dim[5] = header->dim[4];
        header->dim[4] = 1;
    }
    header->no_patient = !memcmp(bytes + l->descrip, NIFTI_NO_PATIENT,
                                 sizeof NIFTI_NO_PATIENT - 1);
    read_floats(bytes + l->pixdim, 8, l, big, header->pixdim);
    read_floats(bytes + l->slope, 1, l, big, &header->slope);
    read_floats(bytes + l->intercept, 1, l, big, &header->intercept);
    read_floats(bytes + l->cal_max, 1, l, big, &header->cal_max);
    read_floats(bytes + l->cal_min, 1, l, big, &header->cal_min);
    read_floats(bytes + l->quatern, 3, l, big, header->quatern);
    read_floats(bytes + l->qoffset, 3, l, big, header->qoffset);
    read_floats(bytes + l->srow, 12, l, big, header->srow[0]);
}

/* Reads the offset of the voxels.  In single files 0 means directly after the
 * header and its extender; NIfTI-1 stores the number as a float. */
static snow_status read_offset(snow_context *context,
                               const unsigned char *bytes,
                               nifti_header *header) {
    bool first = header->version == 1;
    uint64_t least = first ? NIFTI1_BYTES : NIFTI2_BYTES;
    double given =
        first ? snow_float_at(bytes + 108, header->big_endian)
              : (double)snow_integer_at(bytes + 168, 8, header->big_endian);
    /* In a single file with an offset the voxels follow the extender, or
     * directly the header if a writer omitted the extender.  An offset inside
     * the extender would shift them by a few bytes, unnoticed. */
    bool inside = given > 0 && given < (double)(least + NIFTI_EXTENDER_BYTES) &&
                  given != (double)least;
    if (!(given >= 0 && given < 0x1p62) || given != floor(given) ||
        (!header->pair && inside))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the voxels cannot start at byte %g (vox_offset); "
                         "write the file again",
                         given);
    header->vox_offset =
        first ? (uint64_t)given
              : (uint64_t)snow_integer_at(bytes + 168, 8, header->big_endian);
    if (!header->pair && header->vox_offset == 0)
        header->vox_offset = least + NIFTI_EXTENDER_BYTES;
    return SNOW_STATUS_OK;
}

/* Checks each axis; the products are checked where the bytes are counted. */
static snow_status check_dims(snow_context *context, nifti_header *header) {
    if (header->surfaces)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is a CIFTI file: values of a surface's points; "
                         "write those of its volume, if it has one, with "
                         "wb_command -cifti-separate IN COLUMN -volume-all "
                         "OUT.nii.gz");
    if (header->dim[0] < 1 || header->dim[0] > 7)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%lld axes are not possible (dim[0]); NIfTI has 1 "
                         "to 7",
                         (long long)header->dim[0]);
    for (int i = 1; i < 8; i++) {
        if (i > header->dim[0])
            header->dim[i] = 1; /* unused entries may have any value */
        if (header->dim[i] < 1)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "axis %d has %lld voxels (dim); every axis needs "
                             "at least 1",
                             i, (long long)header->dim[i]);
    }
    return SNOW_STATUS_OK;
}

/* bitpix repeats the type, which counts, as in nibabel and ITK; some programs
 * leave 0 or the bits of another type there. */
static snow_status check_type(snow_context *context, nifti_header *header) {
    const nifti_type *type = nifti_type_of_code(header->datatype);
    if (type->name)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "voxels that are %s are not supported; convert them "
                         "to one number each",
                         type->name);
    if (!type->type)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "data type %d is unknown; NIfTI's types are 2, 4, 8, "
            "16, 32, 64, 128, 256, 512, 768, 1024, 1280, 1792 and 2304",
            header->datatype);
    const int bits = 8 * type->samples * (int)snow_type_size(type->type);
    header->type = type;
    if (header->bitpix && header->bitpix != bits)
        snow_notify(context,
                    "claims %d bits per voxel (bitpix) but type %s (datatype); "
                    "the type is taken",
                    header->bitpix, snow_type_name(type->type));
    return SNOW_STATUS_OK;
}

/* Version 2 ends its magic like PNG, with bytes that a transfer as text
 * changes. */
static snow_status check_transfer(snow_context *context,
                                  const unsigned char *bytes) {
    if (memcmp(bytes + 8, "\r\n\032\n", 4) == 0)
        return SNOW_STATUS_OK;
    return snow_fail(
        context, SNOW_STATUS_BAD_INPUT,
        "was damaged by a transfer as text; get it again in binary mode");
}

/* A pure function on bytes: a fuzzer needs no file.  The checks follow the
 * dependence of the fields; a header that fails one is discarded. */
snow_status nifti_header_parse(snow_context *context,
                               const unsigned char *bytes, size_t size,
                               nifti_header *out) {
    nifti_header header = {0};
    size_t whole = nifti_header_size(bytes, size);
    if (size < NIFTI1_BYTES || (whole && size < whole))
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "%zu byte%s too few for a NIfTI header; get the file again", size,
            size == 1 ? " is" : "s are");
    if (size >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is compressed with gzip twice; decompress it once, "
                         "for example with gunzip");
    if (!whole)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the first %zu bytes are not a NIfTI header; check "
                         "the file, convert Analyze files to NIfTI",
                         size);
    header.version = whole == NIFTI1_BYTES ? 1 : 2;
    if (!has_size(bytes, whole, &header.big_endian))
        order_of_dim(bytes, &header.big_endian);
    header.pair = bytes[(header.version == 1 ? 344 : 4) + 1] == 'i';
    if (header.version == 2)
        SNOW_TRY(check_transfer(context, bytes));
    read_fields(bytes, &header);
    SNOW_TRY(check_dims(context, &header));
    SNOW_TRY(check_type(context, &header));
    /* A slope that is 0, infinite or NaN means no scaling. */
    if (header.slope == 0 || !isfinite(header.slope)) {
        header.slope = 1;
        header.intercept = 0;
    }
    if (!isfinite(header.intercept))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the intercept is %g (scl_inter); correct the header",
                         header.intercept);
    SNOW_TRY(read_offset(context, bytes, &header));
    *out = header;
    return SNOW_STATUS_OK;
}
