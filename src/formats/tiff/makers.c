/* formats/tiff/makers.c - private tags: the missing value of GDAL, planes of
 * MetaMorph's .stk. */
#include "formats/array.h"
#include "formats/tiff/tiff.h"

#include <math.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

#define TAG_UIC2 33629 /* MetaMorph: a value for each plane */
#define TAG_NODATA 42113

/* The values of a tag that libtiff does not know; 0: it is not there, or has
 * others. */
static uint32_t values_of(TIFF *tiff, uint32_t tag, TIFFDataType type,
                          const void **out) {
    const TIFFField *field = TIFFFindField(tiff, tag, TIFF_ANY);
    uint32_t count = 0;
    return field && TIFFFieldDataType(field) == type &&
                   TIFFFieldPassCount(field) &&
                   TIFFFieldReadCount(field) == TIFF_VARIABLE2 &&
                   TIFFGetField(tiff, tag, &count, out)
               ? count
               : 0;
}

/* A value that the type does not have is in no voxel. */
static void take_nodata(TIFF *tiff, const tiff_page *page, tiff_shape *shape) {
    const void *values = NULL;
    char text[64] = "";
    const uint32_t count = values_of(tiff, TAG_NODATA, TIFF_ASCII, &values);
    double value;
    if (!count || !values || count > sizeof text)
        return;
    memcpy(text, values, count - 1);
    text[strcspn(text, " ")] = 0;
    const bool floats = page->type >= SNOW_TYPE_FLOAT32;
    const double most = ldexp(1, page->bits - page->is_signed);
    if (!snow_parse_double(text, &value) || !isfinite(value))
        return;
    if (page->type == SNOW_TYPE_FLOAT32)
        value = (double)(float)value;
    if (page->flip)
        value = page->is_signed ? -1 - value : most - 1 - value;
    if (floats || (value == floor(value) && value < most &&
                   value >= (page->is_signed ? -most : 0)))
        shape->nodata = value;
}

/* All planes lie behind the first. */
static void take_stk(TIFF *tiff, tiff_shape *shape) {
    const void *values = NULL;
    const uint32_t planes = values_of(tiff, TAG_UIC2, TIFF_RATIONAL, &values);
    if (planes < 2)
        return;
    shape->metamorph = true;
    shape->slices = shape->images = planes;
}

void snow_tiff_read_tags(const snow_tiff *file, const tiff_page *page,
                         tiff_shape *shape) {
    take_nodata(file->tiff, page, shape);
    take_stk(file->tiff, shape);
}

#endif
