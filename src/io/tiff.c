/* io/tiff.c - connects libtiff to our sources and memory files. */
#include "io/tiff.h"

#if SNOW_HAVE_TIFF

#include "io/zlib_memory.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>

/* The most that libtiff may allocate at once, for tables of strips and the
 * like, in addition to the size of the file. */
#define LIBRARY_BYTES ((uint64_t)64 << 20)

static toff_t set_size(thandle_t handle) {
    const snow_tiff *file = (const snow_tiff *)handle;
    return file->bytes ? snow_seekable_size(file->bytes) : file->store.size;
}

static tmsize_t read_bytes(thandle_t handle, void *bytes, tmsize_t size) {
    snow_tiff *file = (snow_tiff *)handle;
    size_t got = 0;
    if (file->bytes)
        got = snow_seekable_read(file->bytes, file->at, bytes, (size_t)size);
    /* The place of the next page, of 4 bytes or 8, is read alone: libtiff takes
     * one that is cut for the mark of the last page. */
    file->cut |= got < (size_t)size && (size == 4 || size == 8) &&
                 file->at <= set_size(handle);
    file->at += got;
    return (tmsize_t)got;
}

static tmsize_t write_bytes(thandle_t handle, void *bytes, tmsize_t size) {
    snow_tiff *file = (snow_tiff *)handle;
    if (file->bytes)
        return 0;
    file->status =
        snow_memory_file_put(&file->store, file->at, bytes, (size_t)size);
    if (file->status != SNOW_STATUS_OK)
        return 0;
    file->at += (uint64_t)size;
    return size;
}

static toff_t seek_byte(thandle_t handle, toff_t offset, int whence) {
    snow_tiff *file = (snow_tiff *)handle;
    if (whence == SEEK_CUR)
        offset += file->at;
    else if (whence == SEEK_END)
        offset += set_size(handle);
    file->at = offset;
    return offset;
}

static int close_nothing(thandle_t handle) {
    (void)handle;
    return 0;
}

static int keep_error(TIFF *tiff, void *user, const char *module,
                      const char *format, va_list arguments) {
    snow_tiff *file = user;
    (void)tiff;
    (void)module;
    if (!*file->complaint)
        vsnprintf(file->complaint, sizeof file->complaint, format, arguments);
    return 1;
}

/* What libtiff says of whole samples that were written in old ways. */
static bool is_harmless(const char *warning) {
    static const char *const known[] = {"Old-style LZW codes",
                                        "exceeds expected dimensions",
                                        "troublesome old-style JPEG"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strstr(warning, known[i]))
            return true;
    return false;
}

/* Those of directories are about unknown tags, also of valid files. */
static int keep_warning(TIFF *tiff, void *user, const char *module,
                        const char *format, va_list arguments) {
    const snow_tiff *file = user;
    if (!file->decoding || is_harmless(format))
        return 1;
    return keep_error(tiff, user, module, format, arguments);
}

/* In `mode`, m means not mapped. */
static snow_status open_client(snow_tiff *file, const char *name,
                               const char *mode) {
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return snow_fail(file->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory for TIFF");
    uint64_t most = set_size((thandle_t)file) + LIBRARY_BYTES;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, (tmsize_t)most);
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, file);
    TIFFOpenOptionsSetWarningHandlerExtR(options, keep_warning, file);
    file->tiff = TIFFClientOpenExt(name, mode, (thandle_t)file, read_bytes,
                                   write_bytes, seek_byte, close_nothing,
                                   set_size, NULL, NULL, options);
    TIFFOpenOptionsFree(options);
    return SNOW_STATUS_OK;
}

snow_status snow_tiff_open(snow_source *source, snow_tiff *file) {
    *file = (snow_tiff){.context = snow_source_context(source)};
    SNOW_TRY(snow_seekable_open(source, &file->bytes));
    SNOW_TRY(open_client(file, snow_source_name(source), "rm"));
    return file->tiff && !file->cut ? SNOW_STATUS_OK : snow_tiff_fail(file);
}

snow_status snow_tiff_next(snow_tiff *file, bool *got) {
    *file->complaint = 0;
    *got = TIFFReadDirectory(file->tiff) != 0;
    /* The result does not distinguish an end from a damaged page; libtiff's
     * error does. */
    return (!*got && *file->complaint) || file->cut ? snow_tiff_fail(file)
                                                    : SNOW_STATUS_OK;
}

/* Reads a part as it is stored, before `beside` bytes of the caller's own. */
static snow_status read_packed(snow_tiff *file, uint32_t part, uint64_t beside,
                               unsigned char **out, tmsize_t *count) {
    uint64_t packed = TIFFGetStrileByteCount(file->tiff, part), all;
    if (packed > snow_seekable_size(file->bytes) ||
        !snow_add_u64(packed, beside, &all))
        return snow_tiff_fail(file);
    *out = snow_allocate_array(file->context, all, 1);
    if (!*out)
        return SNOW_STATUS_NO_MEMORY;
    *count = (tmsize_t)packed;
    if ((TIFFIsTiled(file->tiff) ? TIFFReadRawTile : TIFFReadRawStrip)(
            file->tiff, part, *out, *count) == *count)
        return SNOW_STATUS_OK;
    snow_release(file->context, *out);
    return snow_tiff_fail(file);
}

/* Where Group 4 data end early, libtiff leaves the rows that are missing as
 * they were in memory, and says nothing.  So a part is decoded again with one
 * more row: that row is written only if all before it were there. */
static snow_status check_rows(snow_tiff *file, uint32_t part, uint64_t size,
                              uint64_t row_bytes) {
    unsigned char *in;
    tmsize_t count;
    uint64_t more;
    bool whole = false;
    if (!snow_add_u64(size, row_bytes, &more))
        return snow_tiff_fail(file);
    SNOW_TRY(read_packed(file, part, more, &in, &count));
    unsigned char *out = in + count;
    /* A row that is written differs from one of the two. */
    for (int fill = 0xff; fill >= 0 && !whole; fill -= 0xff) {
        memset(out + size, fill, (size_t)row_bytes);
        TIFFReadFromUserBuffer(file->tiff, part, in, count, out,
                               (tmsize_t)more);
        whole = out[size] != fill;
    }
    snow_release(file->context, in);
    return whole ? SNOW_STATUS_OK : snow_tiff_fail(file);
}

static snow_status inflate_again(snow_tiff *file, unsigned char *in,
                                 tmsize_t count, uint64_t size) {
    unsigned char out[16384];
    z_stream stream = {.next_in = in, .avail_in = (uInt)count};
    snow_zlib_use(&stream, file->context);
    int result = count > INT_MAX ? Z_DATA_ERROR : inflateInit(&stream);
    while (result == Z_OK) {
        stream.next_out = out;
        stream.avail_out = sizeof out;
        result = inflate(&stream, Z_NO_FLUSH);
    }
    inflateEnd(&stream);
    if (result == Z_MEM_ERROR)
        return SNOW_STATUS_NO_MEMORY;
    return result == Z_STREAM_END && stream.total_out >= size
               ? SNOW_STATUS_OK
               : snow_tiff_fail(file);
}

/* Differences of words that are `step` apart in a row, as they were packed with
 * predictor 2. */
#define SUBTRACT(type)                                 \
    for (size_t i = 0; i < bytes / sizeof(type); i++)  \
    ((type *)out)[i] = (type)(((const type *)row)[i] - \
                              (i < step ? 0 : ((const type *)row)[i - step]))

static void subtract(const void *row, size_t bytes, int bits, size_t step,
                     void *out) {
    if (bits == 8) {
        SUBTRACT(uint8_t);
    } else if (bits == 16) {
        SUBTRACT(uint16_t);
    } else {
        SUBTRACT(uint32_t);
    }
}

/* Computes the check sum of the packed data from what libtiff made of them; 0,
 * which is none, if that is not known. */
static snow_status sum_up(snow_tiff *file, const unsigned char *out,
                          uint64_t size, uint64_t row_bytes, uLong *sum) {
    uint16_t predictor = PREDICTOR_NONE, bits = 0, samples = 1, planes = 1;
    TIFFGetField(file->tiff, TIFFTAG_PREDICTOR, &predictor);
    TIFFGetFieldDefaulted(file->tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(file->tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
    TIFFGetFieldDefaulted(file->tiff, TIFFTAG_PLANARCONFIG, &planes);
    const bool differs = predictor == PREDICTOR_HORIZONTAL &&
                         (bits == 8 || bits == 16 || bits == 32);
    const bool known = !TIFFIsByteSwapped(file->tiff) &&
                       (predictor == PREDICTOR_NONE || differs);
    *sum = known;
    if (known && !differs)
        *sum = adler32_z(1, out, (size_t)size);
    if (!known || !differs)
        return SNOW_STATUS_OK;
    unsigned char *row = snow_allocate_array(file->context, row_bytes, 1);
    if (!row)
        return SNOW_STATUS_NO_MEMORY;
    for (uint64_t at = 0; at + row_bytes <= size; at += row_bytes) {
        subtract(out + at, (size_t)row_bytes, bits,
                 planes == PLANARCONFIG_SEPARATE ? 1 : samples, row);
        *sum = adler32_z(*sum, row, (size_t)row_bytes);
    }
    snow_release(file->context, row);
    return SNOW_STATUS_OK;
}

/* libtiff does not look at the check sum behind data that fill the part, and
 * with libdeflate it leaves their last bytes as they were in memory if the
 * codes are damaged.  Data whose sum is not known or differs are inflated
 * again. */
static snow_status check_sum(snow_tiff *file, uint32_t part,
                             const unsigned char *out, uint64_t size,
                             uint64_t row_bytes) {
    const uint64_t end = TIFFGetStrileOffset(file->tiff, part) +
                         TIFFGetStrileByteCount(file->tiff, part);
    uint16_t order = FILLORDER_MSB2LSB;
    unsigned char stored[4], *in;
    tmsize_t count;
    uLong sum;
    TIFFGetFieldDefaulted(file->tiff, TIFFTAG_FILLORDER, &order);
    if (order != FILLORDER_MSB2LSB)
        return SNOW_STATUS_OK;
    SNOW_TRY(sum_up(file, out, size, row_bytes, &sum));
    if (sum && end >= 4 &&
        snow_seekable_read(file->bytes, end - 4, stored, 4) == 4 &&
        sum == ((uLong)stored[0] << 24 | (uLong)stored[1] << 16 |
                (uLong)stored[2] << 8 | stored[3]))
        return SNOW_STATUS_OK;
    SNOW_TRY(read_packed(file, part, 0, &in, &count));
    snow_status status = inflate_again(file, in, count, size);
    snow_release(file->context, in);
    return status;
}

snow_status snow_tiff_decode(snow_tiff *file, uint32_t part, void *out,
                             uint64_t size, uint64_t row_bytes) {
    uint16_t compression = 0;
    tmsize_t wanted = (tmsize_t)size;
    *file->complaint = 0;
    file->decoding = true;
    tmsize_t got = (TIFFIsTiled(file->tiff)
                        ? TIFFReadEncodedTile
                        : TIFFReadEncodedStrip)(file->tiff, part, out, wanted);
    file->decoding = false;
    if (got != wanted || *file->complaint)
        return snow_tiff_fail(file);
    TIFFGetFieldDefaulted(file->tiff, TIFFTAG_COMPRESSION, &compression);
    switch (compression) {
    case COMPRESSION_CCITTFAX4:
        return check_rows(file, part, size, row_bytes);
    case COMPRESSION_DEFLATE:
    case COMPRESSION_ADOBE_DEFLATE:
        return check_sum(file, part, out, size, row_bytes);
    default:
        return SNOW_STATUS_OK;
    }
}

snow_status snow_tiff_create(snow_context *context, snow_tiff *file) {
    *file = (snow_tiff){.context = context, .store = {.context = context}};
    SNOW_TRY(open_client(file, "picture.tif", "w"));
    if (file->tiff)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_NO_MEMORY, "out of memory for TIFF");
}

void snow_tiff_end(snow_tiff *file) {
    if (file->tiff)
        TIFFClose(file->tiff);
    file->tiff = NULL;
}

void snow_tiff_close(snow_tiff *file) {
    snow_tiff_end(file);
    snow_seekable_close(file->bytes);
    snow_release(file->context, file->store.bytes);
}

snow_status snow_tiff_fail(const snow_tiff *file) {
    return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                     "is a damaged or truncated TIFF file (libtiff: %s); fetch "
                     "or write it again",
                     *file->complaint ? file->complaint : "no more bytes");
}

#endif
