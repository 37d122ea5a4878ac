/* formats/tiff/tags.c - what tags say beside the description: the missing value
 * of GDAL, planes of MetaMorph's .stk, colours and ranges of channels.
 *
 * ImageJ keeps these in a tag of bytes, in the order of the file.  A header
 * says how many blocks of each kind follow; another tag has their sizes:
 *
 *     "IJIJ"  ("rang" 1)  ("luts" 2) ...   tag 50838: size of this header,
 *     two doubles for each channel             and of each block
 *     256 reds, 256 greens, 256 blues      for each channel */
#include "formats/bytes/number.h"
#include "formats/tiff/tiff.h"

#include <math.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

#define TAG_UIC2 33629 /* MetaMorph: a value for each plane */
#define TAG_NODATA 42113
#define TAG_SIZES 50838
#define TAG_BLOCKS 50839
#define LUT_BYTES 768

/* The values of a tag that libtiff does not know; 0: it is not there, or has
 * others, as in a damaged file. */
static uint32_t values_of(TIFF *tiff, uint32_t tag, TIFFDataType type,
                          const void **out) {
    const TIFFField *field = TIFFFindField(tiff, tag, TIFF_ANY);
    uint32_t count = 0;
    return field && TIFFFieldDataType(field) == type &&
                   TIFFFieldPassCount(field) &&
                   TIFFFieldReadCount(field) == TIFF_VARIABLE2 &&
                   TIFFGetField(tiff, tag, &count, out) && *out
               ? count
               : 0;
}

typedef struct imagej_blocks {
    const unsigned char *bytes; /* of all */
    const uint32_t *sizes;      /* of the header, then of blocks */
    uint32_t count;             /* of sizes */
    uint64_t room;
    bool swapped;
} imagej_blocks;

static uint32_t word_at(const imagej_blocks *b, uint64_t at) {
    return (uint32_t)snow_number_at(b->bytes + at, 4, !b->swapped);
}

/* Ranges are of stored values, as are ours: slope is 1. */
static void take_ranges(const imagej_blocks *b, uint64_t at, uint64_t size,
                        tiff_shape *shape) {
    for (uint64_t n = 0; n < SNOW_CHANNELS_MAX && (n + 1) * 16 <= size; n++) {
        const double low = snow_double_at(b->bytes + at + 16 * n, !b->swapped);
        const double high =
            snow_double_at(b->bytes + at + 16 * n + 8, !b->swapped);
        if (isfinite(low) && isfinite(high) && low < high) {
            shape->channel[n].window[0] = low;
            shape->channel[n].window[1] = high;
        }
    }
}

/* Its colour is that of the largest value, unless that is black. */
static void take_table(const imagej_blocks *b, uint64_t at, uint64_t size,
                       snow_channel *out) {
    double color[3];
    if (size != LUT_BYTES)
        return;
    for (int c = 0; c < 3; c++)
        color[c] = b->bytes[at + 256 * (uint64_t)c + 255] / 255.0;
    if (color[0] + color[1] + color[2] > 0)
        memcpy(out->color, color, sizeof color);
}

/* Blocks follow one another, kind by kind. */
static void take_blocks(const imagej_blocks *b, tiff_shape *shape) {
    uint64_t at = b->sizes[0], block = 1;
    for (uint64_t entry = 4; entry + 8 <= b->sizes[0]; entry += 8) {
        const uint32_t kind = word_at(b, entry), times = word_at(b, entry + 4);
        for (uint32_t n = 0; n < times; n++, block++) {
            if (block >= b->count || b->sizes[block] > b->room - at)
                return;
            if (kind == 0x72616e67 && n == 0) /* "rang" */
                take_ranges(b, at, b->sizes[block], shape);
            if (kind == 0x6c757473 && n < SNOW_CHANNELS_MAX) /* "luts" */
                take_table(b, at, b->sizes[block], &shape->channel[n]);
            at += b->sizes[block];
        }
    }
}

static void take_imagej(TIFF *tiff, tiff_shape *shape) {
    const void *sizes = NULL, *bytes = NULL;
    imagej_blocks b = {.count = values_of(tiff, TAG_SIZES, TIFF_LONG, &sizes),
                       .room = values_of(tiff, TAG_BLOCKS, TIFF_BYTE, &bytes)};
    b.bytes = bytes;
    b.sizes = sizes;
    if (!b.count || !b.room || b.sizes[0] > b.room || b.sizes[0] < 4)
        return;
    b.swapped = memcmp(bytes, "JIJI", 4) == 0;
    if (b.swapped || memcmp(bytes, "IJIJ", 4) == 0)
        take_blocks(&b, shape);
}

void snow_tiff_read_channels(const snow_tiff *file, const tiff_page *page,
                             tiff_shape *shape) {
    uint16_t colors = 0, extra = 0, *kinds = NULL;
    if (shape->imagej && page->samples == 1)
        take_imagej(file->tiff, shape);
    TIFFGetField(file->tiff, TIFFTAG_PHOTOMETRIC, &colors);
    shape->colors = colors == PHOTOMETRIC_RGB && page->samples >= 3;
    if (TIFFGetField(file->tiff, TIFFTAG_EXTRASAMPLES, &extra, &kinds) &&
        extra > 0 && kinds)
        shape->opacity = kinds[extra - 1] != EXTRASAMPLE_UNSPECIFIED;
}

/* A value that the type does not have is in no voxel. */
static void take_nodata(TIFF *tiff, const tiff_page *page, tiff_shape *shape) {
    const void *values = NULL;
    char text[64] = "";
    const uint32_t count = values_of(tiff, TAG_NODATA, TIFF_ASCII, &values);
    double value;
    if (!count || count > sizeof text)
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
