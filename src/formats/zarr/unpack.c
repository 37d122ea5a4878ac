/* formats/zarr/unpack.c - decompresses the bytes of a chunk to its values.
 *
 * The size that the compressed bytes claim is first compared with that of a
 * chunk: a file with a false size is refused before memory is allocated.
 * Libraries are then called for exactly that many bytes. */
#include "formats/bytes/number.h"
#include "formats/bytes/packed.h"
#include "formats/features.h"
#include "formats/zarr/zarr.h"

#include <limits.h>
#include <string.h>

#if SNOW_HAVE_ZSTD
#include <zstd.h>
#endif

#define SUM_BYTES 4

/* Zstandard needs four bytes for the longest run, 128 KiB; no other compressor
 * here exceeds that ratio. */
#define MOST_RATIO 32768

/* Every byte adds eight steps of division by the polynomial, from the low bit
 * on. */
uint32_t snow_zarr_sum(const unsigned char *bytes, size_t count) {
    uint32_t table[256], sum = UINT32_MAX;
    for (uint32_t i = 0; i < 256; i++) {
        table[i] = i;
        for (int bit = 0; bit < 8; bit++)
            table[i] = table[i] >> 1 ^ (table[i] & 1 ? 0x82F63B78U : 0);
    }
    for (size_t i = 0; i < count; i++)
        sum = sum >> 8 ^ table[(sum ^ bytes[i]) & 255];
    return ~sum;
}

/* Verifies and removes the checksums at the end of *size bytes. */
static snow_status check_sums(snow_context *context, const char *name,
                              const unsigned char *bytes, size_t *size,
                              int sums) {
    for (; sums; sums--) {
        if (*size < SUM_BYTES)
            return snow_zarr_fail_damaged(context, name,
                                          "is shorter than its checksum");
        *size -= SUM_BYTES;
        if (snow_zarr_sum(bytes, *size) !=
            snow_number_at(bytes + *size, SUM_BYTES, false))
            return snow_zarr_fail_damaged(context, name,
                                          "does not match its checksum");
    }
    return SNOW_STATUS_OK;
}

uint64_t snow_zarr_capacity(const zarr_coding *coding, uint64_t bytes) {
    return bytes + (uint64_t)coding->inner_sums * SUM_BYTES;
}

/* --- zlib ----------------------------------------------------------------- */

/* A source decompresses both formats, and verifies their checksums. */
static snow_status inflate_chunk(snow_context *context, const char *name,
                                 const unsigned char *packed, size_t size,
                                 unsigned char *out, uint64_t bytes) {
    snow_source *source;
    unsigned char more;
    size_t got = 0;
    SNOW_TRY(snow_source_open_memory(context, name, packed, size, &source));
    snow_status status = SNOW_STATUS_OK;
    if (snow_source_remaining(source) >= 0) /* not gzip */
        status = snow_source_unpack(source);
    if (status == SNOW_STATUS_OK)
        status = snow_source_read_all(source, out, (size_t)bytes, "the voxels");
    if (status == SNOW_STATUS_OK)
        status = snow_source_read(source, &more, 1, &got);
    snow_source_close(source);
    return status == SNOW_STATUS_OK && got
               ? snow_zarr_fail_size(context, name, bytes + 1, bytes)
               : status;
}

/* --- Zstandard ------------------------------------------------------------ */

static snow_status expect_zstd(snow_context *context, const char *name,
                               const unsigned char *packed, size_t size,
                               uint64_t bytes) {
#if SNOW_HAVE_ZSTD
    unsigned long long given = ZSTD_getFrameContentSize(packed, size);
    if (given == ZSTD_CONTENTSIZE_ERROR)
        return snow_zarr_fail_damaged(context, name,
                                      "is not compressed by zstd");
    return given == ZSTD_CONTENTSIZE_UNKNOWN || given == bytes
               ? SNOW_STATUS_OK
               : snow_zarr_fail_size(context, name, given, bytes);
#else
    (void)name, (void)packed, (void)size, (void)bytes;
    return snow_fail_unbuilt(context, "Zstandard", "libzstd-dev");
#endif
}

static snow_status unpack_zstd(snow_context *context, const char *name,
                               const unsigned char *packed, size_t size,
                               unsigned char *out, uint64_t bytes) {
#if SNOW_HAVE_ZSTD
    size_t got = ZSTD_decompress(out, (size_t)bytes, packed, size);
    if (got == bytes)
        return SNOW_STATUS_OK;
#else
    (void)packed, (void)size, (void)out, (void)bytes;
#endif
    return snow_zarr_fail_damaged(context, name,
                                  "cannot be decompressed by zstd");
}

/* --- LZ4 ------------------------------------------------------------------ */

/* numcodecs writes the size before the block, the low byte first. */
static snow_status expect_lz4(snow_context *context, const char *name,
                              const unsigned char *packed, size_t size,
                              uint64_t bytes) {
    SNOW_TRY(snow_lz4_need(context));
    if (size < 4 || size > INT_MAX)
        return snow_zarr_fail_damaged(context, name,
                                      "is not compressed by lz4");
    const uint64_t given = snow_number_at(packed, 4, false);
    return given == bytes && bytes <= INT_MAX
               ? SNOW_STATUS_OK
               : snow_zarr_fail_size(context, name, given, bytes);
}

static snow_status unpack_lz4(snow_context *context, const char *name,
                              const unsigned char *packed, size_t size,
                              unsigned char *out, uint64_t bytes) {
    return snow_lz4_unpack(packed + 4, size - 4, out, (size_t)bytes)
               ? SNOW_STATUS_OK
               : snow_zarr_fail_damaged(context, name,
                                        "cannot be decompressed by lz4");
}

/* --- any ------------------------------------------------------------------ */

snow_status snow_zarr_expect(snow_context *context, const char *name,
                             const zarr_coding *coding,
                             const unsigned char *packed, size_t size,
                             uint64_t bytes) {
    uint64_t inner = snow_zarr_capacity(coding, bytes);
    /* The size without the checksums after the compressed bytes; they are
     * verified at decompression. */
    size_t sums = (size_t)coding->outer_sums * SUM_BYTES;
    size = size > sums ? size - sums : 0;
    if (coding->packer == ZARR_PLAIN)
        return size == inner ? SNOW_STATUS_OK
                             : snow_zarr_fail_size(context, name, size, inner);
    if (inner / MOST_RATIO > size)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%s: has %zu bytes, too few for the %llu of a chunk; "
                         "it is truncated or damaged",
                         name, size, (unsigned long long)inner);
    switch (coding->packer) {
    case ZARR_ZSTD:
        return expect_zstd(context, name, packed, size, inner);
    case ZARR_LZ4:
        return expect_lz4(context, name, packed, size, inner);
    case ZARR_BLOSC:
        return snow_zarr_blosc_expect(context, name, packed, size, inner);
    default:
        return SNOW_STATUS_OK;
    }
}

static snow_status unpack(snow_context *context, const char *name,
                          const zarr_coding *coding,
                          const unsigned char *packed, size_t size,
                          unsigned char *out, uint64_t bytes) {
    switch (coding->packer) {
    case ZARR_INFLATE:
        return inflate_chunk(context, name, packed, size, out, bytes);
    case ZARR_ZSTD:
        return unpack_zstd(context, name, packed, size, out, bytes);
    case ZARR_LZ4:
        return unpack_lz4(context, name, packed, size, out, bytes);
    case ZARR_BLOSC:
        return snow_zarr_blosc_unpack(context, name, packed, out, bytes);
    case ZARR_PLAIN:
        break;
    }
    memcpy(out, packed, size);
    return SNOW_STATUS_OK;
}

/* --- filters -------------------------------------------------------------- */

/* The first bytes of all values, then the second ones; an incomplete value at
 * the end stays. */
static snow_status undo_shuffle(snow_context *context, size_t width,
                                unsigned char *values, uint64_t bytes) {
    uint64_t count = bytes / width;
    unsigned char *copy = snow_allocate_array(context, bytes, 1);
    if (!copy)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(copy, values, (size_t)bytes);
    for (size_t k = 0; k < width; k++)
        for (uint64_t i = 0; i < count; i++)
            values[i * width + k] = copy[k * count + i];
    snow_release(context, copy);
    return SNOW_STATUS_OK;
}

/* Each value but the first is stored as the difference to the one before it,
 * modulo the range of the type. */
static void undo_delta(size_t width, bool big, unsigned char *values,
                       uint64_t bytes) {
    uint64_t sum = 0;
    for (uint64_t i = 0; i + width <= bytes; i += width) {
        for (size_t k = 0; k < width; k++)
            sum += (uint64_t)values[i + (big ? width - 1 - k : k)] << (8 * k);
        for (size_t k = 0; k < width; k++)
            values[i + (big ? width - 1 - k : k)] =
                (unsigned char)(sum >> (8 * k));
    }
}

snow_status snow_zarr_unpack(snow_context *context, const char *name,
                             const zarr_array *array,
                             const unsigned char *packed, size_t size,
                             unsigned char *out, uint64_t bytes) {
    const zarr_coding *coding = &array->coding;
    uint64_t inner = snow_zarr_capacity(coding, bytes);
    size_t left = (size_t)inner;
    SNOW_TRY(check_sums(context, name, packed, &size, coding->outer_sums));
    SNOW_TRY(unpack(context, name, coding, packed, size, out, inner));
    SNOW_TRY(check_sums(context, name, out, &left, coding->inner_sums));
    for (int i = coding->filter_count - 1; i >= 0; i--) {
        const zarr_filter *filter = &coding->filters[i];
        if (filter->kind == ZARR_DELTA)
            undo_delta(filter->width, array->big_endian, out, bytes);
        else
            SNOW_TRY(undo_shuffle(context, filter->width, out, bytes));
    }
    return SNOW_STATUS_OK;
}
