/* formats/nifti/header.c - parses the bytes of a NIfTI-1 or NIfTI-2 header.
 *
 * A pure function on bytes.  The first field is the header's size, 348 or 540,
 * which gives version and byte order; the magic confirms it.  Offsets are those
 * of nifti1.h and nifti2.h. */
#include "formats/nifti/nifti.h"

#include <math.h>
#include <string.h>

/* X(code, scalar type): the types that a volume can have. */
#define TYPE_MAP(X) \
    X(2, UINT8)     \
    X(4, INT16)     \
    X(8, INT32)     \
    X(16, FLOAT32)  \
    X(64, FLOAT64)  \
    X(256, INT8)    \
    X(512, UINT16)  \
    X(768, UINT32)  \
    X(1024, INT64)  \
    X(1280, UINT64)

snow_type nifti_type(int datatype) {
    switch (datatype) {
    case 128:
    case 2304:
        return SNOW_TYPE_UINT8;
    case 32:
        return SNOW_TYPE_FLOAT32;
    case 1792:
        return SNOW_TYPE_FLOAT64;
#define TO_TYPE(code, name) \
    case code:              \
        return SNOW_TYPE_##name;
        TYPE_MAP(TO_TYPE)
#undef TO_TYPE
    default:
        return SNOW_TYPE_NONE;
    }
}

/* RGB24, RGBA32 and complex numbers. */
int nifti_samples(int datatype) {
    if (datatype == 32 || datatype == 1792)
        return 2;
    return datatype == 128 ? 3 : datatype == 2304 ? 4 : 1;
}

int nifti_code(snow_type type) {
#define TO_CODE(code, name)       \
    if (type == SNOW_TYPE_##name) \
        return code;
    TYPE_MAP(TO_CODE)
#undef TO_CODE
    return 0;
}

/* Codes of nifti1.h that are not supported; named in refusals. */
const char *nifti_type_name(int datatype) {
    switch (datatype) {
    case 1:
        return "single bits";
    case 1536:
        return "128-bit floats";
    case 2048:
        return "complex numbers (2 x 128 bits)";
    default:
        return NULL;
    }
}

/* The unsigned number of `size` bytes at `at`. */
static uint64_t number_at(const unsigned char *at, size_t size, bool big) {
    uint64_t value = 0;
    for (size_t i = 0; i < size; i++)
        value = value << 8 | at[big ? i : size - 1 - i];
    return value;
}

static int64_t int_at(const unsigned char *at, size_t size, bool big) {
    uint64_t value = number_at(at, size, big);
    uint64_t sign = UINT64_C(1) << (8 * size - 1);
    /* Two's complement of any width: the sign bit counts negative. */
    return value & sign ? -(int64_t)(sign - 1 - (value & (sign - 1))) - 1
                        : (int64_t)value;
}

static double float_at(const unsigned char *at, size_t size, bool big) {
    uint64_t bits = number_at(at, size, big);
    if (size == sizeof(double)) {
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    uint32_t half = (uint32_t)bits;
    float value;
    memcpy(&value, &half, sizeof value);
    return value;
}

/* True if the first field is this size in either byte order, which *big
 * gives. */
static bool has_size(const unsigned char *bytes, uint64_t size, bool *big) {
    *big = number_at(bytes, 4, true) == size;
    return *big || number_at(bytes, 4, false) == size;
}

/* The byte order in which dim[0] is a number of axes, for headers whose first
 * field is wrong.  Returns false if there is none. */
static bool order_of_dim(const unsigned char *bytes, bool *big) {
    for (int order = 0; order < 2; order++) {
        int64_t axes = int_at(bytes + 40, 2, order);
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

/* The offsets and widths of a version's fields. */
typedef struct nifti_layout {
    size_t float_bytes, dim_bytes, code_bytes;
    size_t datatype, bitpix, dim, pixdim, slope, intercept, units, units_bytes;
    size_t cal_max, cal_min, intent, descrip, qform_code, sform_code, quatern,
        qoffset, srow;
} nifti_layout;

/* In the order of the members above, from the comments of nifti1.h and
 * nifti2.h; version 2 widens most fields and moves all. */
static const nifti_layout layouts[] = {
    {4, 2,   2,   70, 72,  40,  76,  112, 116, 123,
     1, 124, 128, 68, 148, 252, 254, 256, 268, 280},
    {8, 8,   4,   12,  14,  16,  104, 176, 184, 500,
     4, 192, 200, 504, 240, 344, 348, 352, 376, 400},
};

static void read_floats(const unsigned char *at, size_t count,
                        const nifti_layout *layout, bool big, double *out) {
    for (size_t i = 0; i < count; i++)
        out[i] =
            float_at(at + i * layout->float_bytes, layout->float_bytes, big);
}

/* xyzt_units holds two units: bits 0 to 2 are that of length. */
static void read_fields(const unsigned char *bytes, nifti_header *header) {
    const nifti_layout *l = &layouts[header->version - 1];
    bool big = header->big_endian;
    for (size_t i = 0; i < 8; i++)
        header->dim[i] =
            int_at(bytes + l->dim + i * l->dim_bytes, l->dim_bytes, big);
    header->datatype = (int)int_at(bytes + l->datatype, 2, big);
    header->bitpix = (int)int_at(bytes + l->bitpix, 2, big);
    header->units = (int)(number_at(bytes + l->units, l->units_bytes, big) & 7);
    header->qform_code = (int)int_at(bytes + l->qform_code, l->code_bytes, big);
    header->sform_code = (int)int_at(bytes + l->sform_code, l->code_bytes, big);
    const int64_t intent = int_at(bytes + l->intent, l->code_bytes, big);
    header->labels = intent == INTENT_LABEL;
    header->estimate =
        intent == INTENT_ESTIMATE ||
        (intent >= INTENT_CORRELATION && intent <= INTENT_LOG10PVAL);
    header->vectors = intent == INTENT_DISPLACEMENT || intent == INTENT_VECTOR;
    header->colors = intent == INTENT_RGB || intent == INTENT_RGBA;
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
    double given = first ? float_at(bytes + 108, 4, header->big_endian)
                         : (double)int_at(bytes + 168, 8, header->big_endian);
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
              : (uint64_t)int_at(bytes + 168, 8, header->big_endian);
    if (!header->pair && header->vox_offset == 0)
        header->vox_offset = least + NIFTI_EXTENDER_BYTES;
    return SNOW_STATUS_OK;
}

/* Checks each axis; the products are checked where the bytes are counted. */
static snow_status check_dims(snow_context *context, nifti_header *header) {
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
static snow_status check_type(snow_context *context,
                              const nifti_header *header) {
    snow_type type = nifti_type(header->datatype);
    const char *name = nifti_type_name(header->datatype);
    if (type == SNOW_TYPE_NONE && name)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "voxels that are %s are not supported; convert them "
                         "to one number each",
                         name);
    if (type == SNOW_TYPE_NONE)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "data type %d is unknown; NIfTI's types are 2, 4, 8, "
            "16, 32, 64, 128, 256, 512, 768, 1024, 1280, 1792 and 2304",
            header->datatype);
    const int bits =
        8 * nifti_samples(header->datatype) * (int)snow_type_size(type);
    if (header->bitpix && header->bitpix != bits)
        snow_notify(context,
                    "claims %d bits per voxel (bitpix) but type %s (datatype); "
                    "the type is taken",
                    header->bitpix, snow_type_name(type));
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
