/* formats/tiff/page.c - reads a page of a TIFF file, by libtiff.  The buffers
 * for voxels are ours, and compared with what the file can hold before they are
 * allocated. */
#include "formats/tiff/tiff.h"

#if SNOW_HAVE_TIFF

#include "formats/array.h"
#include "formats/bytes/number.h"

#include <string.h>

/* --- the layout of a page ------------------------------------------------- */

static bool parse_type(uint16_t bits, uint16_t format, tiff_page *page) {
    page->coding = TIFF_PLAIN;
    page->type = SNOW_TYPE_NONE;
    if (format == SAMPLEFORMAT_IEEEFP) {
        if (bits == 16)
            page->coding = TIFF_HALF;
        if (bits % 8 == 0)
            page->type = snow_type_of_kind('f', bits == 16 ? 4 : bits / 8U);
    } else if (bits &&
               (format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_INT ||
                format == SAMPLEFORMAT_VOID || bits == 1)) {
        if (bits == 24)
            page->coding = TIFF_TRIPLE;
        else if (bits % 8)
            page->coding = TIFF_PACKED;
        page->is_signed = format == SAMPLEFORMAT_INT && bits > 1;
        page->type = snow_type_of_kind(page->is_signed ? 'i' : 'u',
                                       bits <= 8    ? 1
                                       : bits <= 16 ? 2
                                       : bits <= 32 ? 4
                                                    : bits / 8U);
    }
    return page->type != SNOW_TYPE_NONE;
}

/* A palette from white to black is a look, as ImageJ's of 8 bits. */
static bool is_falling(TIFF *tiff, const tiff_page *page, uint16_t colors) {
    uint16_t *map[3] = {NULL};
    bool falls =
        colors == PHOTOMETRIC_PALETTE && page->bits == 8 &&
        TIFFGetField(tiff, TIFFTAG_COLORMAP, &map[0], &map[1], &map[2]);
    for (int c = 0; c < 3 && falls; c++)
        falls =
            map[c][0] >= 0xff00 && !map[c][255] && map[c][128] == map[0][128];
    return falls;
}

/* Inverted, v is 2^n - 1 - v of n bits, or -1 - v with a sign: all bits are
 * others.  Values of ImageJ and floats are kept. */
static uint64_t flip_of(TIFF *tiff, const tiff_page *page, uint16_t colors) {
    char *text = NULL;
    TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text);
    if (colors != PHOTOMETRIC_MINISWHITE || page->type >= SNOW_TYPE_FLOAT32 ||
        (text && !strncmp(text, "ImageJ=", 7)))
        return 0;
    return page->is_signed ? UINT64_MAX : UINT64_MAX >> (64 - page->bits);
}

static uint16_t short_field(TIFF *tiff, uint32_t tag) {
    uint16_t value = 0;
    return TIFFGetFieldDefaulted(tiff, tag, &value) ? value : 0;
}

snow_status snow_tiff_describe(snow_tiff *file, tiff_page *out) {
    TIFF *tiff = file->tiff;
    uint32_t width = 0, height = 0, depth = 1;
    tiff_page page = {0};
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    TIFFGetField(tiff, TIFFTAG_IMAGEDEPTH, &depth);
    page.width = width;
    page.height = height;
    page.samples = short_field(tiff, TIFFTAG_SAMPLESPERPIXEL);
    page.bits = short_field(tiff, TIFFTAG_BITSPERSAMPLE);
    page.compression = short_field(tiff, TIFFTAG_COMPRESSION);
    page.separate =
        page.samples > 1 &&
        short_field(tiff, TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE;
    uint16_t format = short_field(tiff, TIFFTAG_SAMPLEFORMAT);
    if (!parse_type(page.bits, format, &page))
        return snow_fail(
            file->context, SNOW_STATUS_BAD_INPUT,
            "has values of %u bits in format %u, which is not "
            "supported; write integers of 1 to 32 or 64 bits, or floats",
            page.bits, format);
    if (width < 1 || height < 1 || depth > 1 || page.samples < 1)
        return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                         "its pages have no valid size or depth for slices; "
                         "write it again with one slice per page");
    /* Subsampled or logarithmic colours are not the values of a volume.  JPEG
     * colours are converted to RGB. */
    const uint16_t colors = short_field(tiff, TIFFTAG_PHOTOMETRIC);
    bool good = colors != PHOTOMETRIC_YCBCR && colors != PHOTOMETRIC_LOGL &&
                colors != PHOTOMETRIC_LOGLUV;
    if (colors == PHOTOMETRIC_YCBCR && page.compression == COMPRESSION_JPEG)
        good = TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    if (!good)
        return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                         "its colours are stored as luminance and chrominance; "
                         "write it again as grey or RGB");
    page.turn = short_field(tiff, TIFFTAG_ORIENTATION);
    page.white =
        colors == PHOTOMETRIC_MINISWHITE || is_falling(tiff, &page, colors);
    page.flip = flip_of(tiff, &page, colors);
    *out = page;
    return SNOW_STATUS_OK;
}

/* Most codecs have a longest run for their shortest code; for others only an
 * implausible ratio is refused. */
uint64_t snow_tiff_least(const tiff_page *page, uint64_t bytes) {
    switch (page->compression) {
    case COMPRESSION_NONE:
        return bytes;
    case COMPRESSION_PACKBITS:
        return bytes / 64;
    case COMPRESSION_LZW:
        return bytes / 4096;
    case COMPRESSION_DEFLATE:
    case COMPRESSION_ADOBE_DEFLATE:
        return bytes / SNOW_DEFLATE_RATIO;
    default:
        return bytes >> 16;
    }
}

/* --- voxels --------------------------------------------------------------- */

/* A rectangle of decoded pixels with `samples` values each, whose first is the
 * page's pixel (x, y). */
typedef struct tiff_block {
    const unsigned char *bytes;
    int64_t x, y, width, height;
    int64_t samples;
    uint64_t row_bytes;
} tiff_block;

/* Stores an integer of fewer bits than its type has, sign extended. */
static void put_integer(const tiff_page *page, uint64_t value,
                        unsigned char *out) {
    if (page->is_signed && value >> (page->bits - 1))
        value |= UINT64_MAX << page->bits;
    snow_put_low(value, snow_type_size(page->type), out);
}

/* Values of whole bytes are in the machine's byte order, as from libtiff. */
static void put_value(const tiff_page *page, const unsigned char *at,
                      unsigned char *out) {
    uint16_t half;
    float wide;
    switch (page->coding) {
    case TIFF_HALF:
        memcpy(&half, at, sizeof half);
        wide = snow_half_to_float(half);
        memcpy(out, &wide, sizeof wide);
        break;
    case TIFF_TRIPLE:
        put_integer(page, snow_number_at(at, 3, snow_machine_big_endian()),
                    out);
        break;
    default:
        memcpy(out, at, page->bits / 8);
    }
}

/* Bits from the high one of each byte on; rows begin at bytes. */
static void put_packed(const tiff_page *page, const unsigned char *row,
                       uint64_t at, unsigned char *out) {
    uint64_t value = 0;
    for (uint64_t bit = at * page->bits; bit < (at + 1) * page->bits; bit++)
        value = value << 1 | (row[bit / 8] >> (7 - bit % 8) & 1);
    put_integer(page, value, out);
}

static void flip(const tiff_page *page, int64_t count, unsigned char *out) {
    const size_t size = snow_type_size(page->type);
    for (size_t i = 0; i < (size_t)count * size; i++) {
        const size_t byte =
            snow_machine_big_endian() ? size - 1 - i % size : i % size;
        out[i] ^= (unsigned char)(page->flip >> (8 * byte));
    }
}

/* Copies one sample of a row's pixels from `first` on. */
static void put_row(const tiff_page *page, const tiff_block *block,
                    const unsigned char *row, int64_t first, int64_t sample,
                    int64_t count, unsigned char *out) {
    const size_t size = page->bits / 8, wide = snow_type_size(page->type);
    const uint64_t at = (uint64_t)(first * block->samples + sample);
    if (page->coding == TIFF_PLAIN && block->samples == 1)
        memcpy(out, row + at * size, (size_t)count * size);
    else
        for (int64_t i = 0; i < count; i++) {
            const uint64_t from = at + (uint64_t)(i * block->samples);
            if (page->coding == TIFF_PACKED)
                put_packed(page, row, from, out + (size_t)i * wide);
            else
                put_value(page, row + from * size, out + (size_t)i * wide);
        }
    if (page->flip && !sample)
        flip(page, count, out);
}

/* Copies the part of a block that is in the box. */
static void put_block(const tiff_page *page, const tiff_block *block,
                      int64_t sample, const snow_region *w,
                      unsigned char *slice) {
    size_t wide = snow_type_size(page->type);
    int64_t left = block->x > w->first[0] ? block->x : w->first[0];
    int64_t right = w->first[0] + w->count[0];
    if (right > block->x + block->width)
        right = block->x + block->width;
    for (int64_t y = block->y; y < block->y + block->height; y++) {
        int64_t row = y - w->first[1];
        if (row < 0 || row >= w->count[1] || left >= right)
            continue;
        put_row(page, block,
                block->bytes + (uint64_t)(y - block->y) * block->row_bytes,
                left - block->x, sample, right - left,
                slice +
                    (size_t)(row * w->count[0] + left - w->first[0]) * wide);
    }
}

/* Allocates memory for a strip or tile, if the file can hold one. */
static snow_status make_buffer(const snow_tiff *file, const tiff_page *page,
                               uint64_t size, unsigned char **out) {
    if (!size || snow_tiff_least(page, size) > snow_seekable_size(file->bytes))
        return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                         "has strips or tiles of %llu bytes, more than the "
                         "file can hold; it is damaged",
                         (unsigned long long)size);
    *out = snow_allocate_array(file->context, size, 1);
    return *out ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* Tiles, or strips, which are as wide as the page, and of which the last may be
 * lower. */
static snow_status read_blocks(snow_tiff *file, const tiff_page *page,
                               int64_t sample, const snow_region *w,
                               unsigned char *buffer, unsigned char *slice) {
    TIFF *tiff = file->tiff;
    const bool tiled = TIFFIsTiled(tiff);
    const uint16_t plane = page->separate ? (uint16_t)sample : 0;
    const uint64_t row_bytes =
        tiled ? TIFFTileRowSize64(tiff) : TIFFScanlineSize64(tiff);
    uint32_t wide = tiled ? 0 : (uint32_t)page->width, high = 0;
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &wide);
    TIFFGetFieldDefaulted(
        tiff, tiled ? TIFFTAG_TILELENGTH : TIFFTAG_ROWSPERSTRIP, &high);
    if (!tiled && (high < 1 || high > page->height))
        high = (uint32_t)page->height;
    if (wide < 1 || high < 1)
        return snow_tiff_fail(file);
    for (int64_t y = w->first[1] / high * high; y < w->first[1] + w->count[1];
         y += high)
        for (int64_t x = w->first[0] / wide * wide;
             x < w->first[0] + w->count[0]; x += wide) {
            const bool low = !tiled && page->height - y < high;
            const int64_t height = low ? page->height - y : high;
            SNOW_TRY(snow_tiff_decode(
                file,
                tiled
                    ? TIFFComputeTile(tiff, (uint32_t)x, (uint32_t)y, 0, plane)
                    : TIFFComputeStrip(tiff, (uint32_t)y, plane),
                buffer,
                tiled ? TIFFTileSize64(tiff) : (uint64_t)height * row_bytes,
                row_bytes));
            const tiff_block block = {
                buffer,   x,      y,
                wide,     height, page->separate ? 1 : page->samples,
                row_bytes};
            put_block(page, &block, page->separate ? 0 : sample, w, slice);
        }
    return SNOW_STATUS_OK;
}

snow_status snow_tiff_read_page(snow_tiff *file, const tiff_page *page,
                                int64_t sample, const snow_region *region,
                                unsigned char *slice) {
    unsigned char *buffer;
    SNOW_TRY(make_buffer(file, page,
                         TIFFIsTiled(file->tiff) ? TIFFTileSize64(file->tiff)
                                                 : TIFFStripSize64(file->tiff),
                         &buffer));
    snow_status status = read_blocks(file, page, sample, region, buffer, slice);
    snow_release(file->context, buffer);
    return status;
}

/* Reads rows directly from the bytes, which have the file's byte order. */
snow_status snow_tiff_read_raw(snow_tiff *file, const tiff_page *page,
                               int64_t index, int64_t sample,
                               const snow_region *region,
                               unsigned char *slice) {
    uint64_t *offsets = NULL;
    uint64_t row_bytes = TIFFScanlineSize64(file->tiff);
    unsigned char *buffer;
    if (!TIFFGetField(file->tiff, TIFFTAG_STRIPOFFSETS, &offsets) || !offsets)
        return snow_tiff_fail(file);
    SNOW_TRY(make_buffer(file, page, row_bytes, &buffer));
    snow_status status = SNOW_STATUS_OK;
    for (int64_t y = region->first[1];
         y < region->first[1] + region->count[1] && status == SNOW_STATUS_OK;
         y++) {
        uint64_t at =
            *offsets + (uint64_t)(index * page->height + y) * row_bytes;
        if (snow_seekable_read(file->bytes, at, buffer, (size_t)row_bytes) <
            row_bytes)
            status = snow_tiff_fail(file);
        else if (TIFFIsByteSwapped(file->tiff))
            snow_swap_bytes(buffer, (uint64_t)(page->width * page->samples),
                            page->bits / 8);
        const tiff_block block = {buffer,        0,        y, page->width, 1,
                                  page->samples, row_bytes};
        if (status == SNOW_STATUS_OK)
            put_block(page, &block, sample, region, slice);
    }
    snow_release(file->context, buffer);
    return status;
}

#endif
