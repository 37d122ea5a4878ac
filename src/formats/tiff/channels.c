/* formats/tiff/channels.c - colours and ranges of channels: of samples that are
 * colours, and those of ImageJ.
 *
 * ImageJ keeps them in a tag of bytes, in the order of the file.  A header says
 * how many blocks of each kind follow; another tag has their sizes:
 *
 *     "IJIJ"  ("rang" 1)  ("luts" 2) ...   tag 50838: size of this header,
 *     two doubles for each channel             and of each block
 *     256 reds, 256 greens, 256 blues      for each channel */
#include "formats/tiff/tiff.h"

#include <math.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

#define TAG_SIZES 50838
#define TAG_BLOCKS 50839
#define LUT_BYTES 768

typedef struct imagej_blocks {
    const unsigned char *bytes; /* of all */
    const uint32_t *sizes;      /* of the header, then of blocks */
    uint32_t count;             /* of sizes */
    uint64_t room;
    bool swapped;
} imagej_blocks;

static uint32_t word_at(const imagej_blocks *b, uint64_t at) {
    const unsigned char *p = b->bytes + at;
    return b->swapped ? (uint32_t)p[3] << 24 | (uint32_t)p[2] << 16 |
                            (uint32_t)p[1] << 8 | p[0]
                      : (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 |
                            (uint32_t)p[2] << 8 | p[3];
}

static double double_at(const imagej_blocks *b, uint64_t at) {
    const uint64_t high = word_at(b, at + (b->swapped ? 4 : 0));
    const uint64_t bits = high << 32 | word_at(b, at + (b->swapped ? 0 : 4));
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Ranges are of stored values, as are ours: slope is 1. */
static void take_ranges(const imagej_blocks *b, uint64_t at, uint64_t size,
                        tiff_shape *shape) {
    for (uint64_t n = 0; n < SNOW_CHANNELS_MAX && (n + 1) * 16 <= size; n++) {
        const double low = double_at(b, at + 16 * n);
        const double high = double_at(b, at + 16 * n + 8);
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

/* A damaged file may have other types there. */
static bool is_of(TIFF *tiff, uint32_t tag, TIFFDataType type) {
    const TIFFField *field = TIFFFindField(tiff, tag, TIFF_ANY);
    return field && TIFFFieldDataType(field) == type &&
           TIFFFieldPassCount(field) &&
           TIFFFieldReadCount(field) == TIFF_VARIABLE2;
}

static void take_imagej(const snow_tiff *file, tiff_shape *shape) {
    imagej_blocks b = {.count = 0};
    uint32_t *sizes = NULL, room = 0;
    unsigned char *bytes = NULL;
    if (!is_of(file->tiff, TAG_SIZES, TIFF_LONG) ||
        !is_of(file->tiff, TAG_BLOCKS, TIFF_BYTE) ||
        !TIFFGetField(file->tiff, TAG_SIZES, &b.count, &sizes) ||
        !TIFFGetField(file->tiff, TAG_BLOCKS, &room, &bytes) || !b.count ||
        !sizes || !bytes || sizes[0] > room || sizes[0] < 4)
        return;
    b.bytes = bytes;
    b.sizes = sizes;
    b.room = room;
    b.swapped = memcmp(bytes, "JIJI", 4) == 0;
    if (b.swapped || memcmp(bytes, "IJIJ", 4) == 0)
        take_blocks(&b, shape);
}

void snow_tiff_read_channels(const snow_tiff *file, const tiff_page *page,
                             tiff_shape *shape) {
    uint16_t colors = 0, extra = 0, *kinds = NULL;
    if (shape->imagej && page->samples == 1)
        take_imagej(file, shape);
    TIFFGetField(file->tiff, TIFFTAG_PHOTOMETRIC, &colors);
    shape->colors = colors == PHOTOMETRIC_RGB && page->samples >= 3;
    if (TIFFGetField(file->tiff, TIFFTAG_EXTRASAMPLES, &extra, &kinds) &&
        extra > 0 && kinds)
        shape->opacity = kinds[extra - 1] != EXTRASAMPLE_UNSPECIFIED;
}

#endif
