/* formats/hdf5/filters.c - undoes the filters of a chunk, the last one first.
 *
 * Those that HDF5 files usually have are undone here, and what they yield is
 * measured: deflate, shuffle, fletcher32 and LZF.  A chunk is refused if it is
 * shorter than its data set needs. */
#include "formats/hdf5/filters.h"

#if SNOW_HAVE_HDF5

#include "formats/array.h"
#include "formats/bytes/number.h"
#include "io/zlib_memory.h"

#include <string.h>

/* Registered numbers (H5Zpublic.h; the HDF Group's list). */
enum {
    FILTER_LZF = 32000,
    FILTER_BLOSC = 32001,
    FILTER_LZ4 = 32004,
    FILTER_BITSHUFFLE = 32008
};

#define SUM_BYTES 4

/* What a chunk may have beyond its size before filters that need all of it
 * are undone. */
#define LARGER_BYTES ((uint64_t)64 << 10)

bool snow_hdf5_undoes(int id) {
    return id == H5Z_FILTER_DEFLATE || id == H5Z_FILTER_SHUFFLE ||
           id == H5Z_FILTER_FLETCHER32 || id == FILTER_LZF;
}

bool snow_hdf5_read_filters(hid_t plan, hdf5_filters *out) {
    out->foreign = false;
    out->count = H5Pget_nfilters(plan);
    if (out->count < 0 || out->count > HDF5_MOST_FILTERS)
        return false;
    for (int i = 0; i < out->count; i++) {
        unsigned flags, config;
        out->all[i].settings_count = HDF5_MOST_SETTINGS;
        out->all[i].id = H5Pget_filter2(plan, (unsigned)i, &flags,
                                        &out->all[i].settings_count,
                                        out->all[i].settings, 0, NULL, &config);
        if (out->all[i].id < 0)
            return false;
        if (out->all[i].settings_count > HDF5_MOST_SETTINGS)
            out->all[i].settings_count = HDF5_MOST_SETTINGS;
        out->foreign |= !snow_hdf5_undoes(out->all[i].id);
    }
    return true;
}

/* --- fletcher32 ----------------------------------------------------------- */

/* The sum of words of 16 bits, the high byte first, and the sum of these sums,
 * both modulo 65,535. */
static uint32_t fletcher_sum(const unsigned char *bytes, uint64_t size) {
    uint64_t low = 0, high = 0;
    for (uint64_t i = 0; i < size;) {
        /* So many words that 64 bits do not overflow. */
        uint64_t end = i + 65536 < size ? i + 65536 : size;
        for (; i + 1 < end; i += 2) {
            low += (uint32_t)bytes[i] << 8 | bytes[i + 1];
            high += low;
        }
        if (i + 1 == size) {
            low += (uint32_t)bytes[i++] << 8;
            high += low;
        }
        low %= 65535;
        high %= 65535;
    }
    return (uint32_t)(high << 16 | low);
}

/* Both are 0 modulo 65,535, though libhdf5 writes 65,535 for one of them. */
static bool is_same_sum(uint32_t a, uint32_t b) {
    return a % 65536 % 65535 == b % 65536 % 65535 &&
           (a >> 16) % 65535 == (b >> 16) % 65535;
}

static const char *undo_fletcher(hdf5_packed *packed) {
    if (packed->size < SUM_BYTES)
        return "is shorter than its checksum";
    packed->size -= SUM_BYTES;
    const unsigned char *at = packed->bytes + packed->size;
    const uint32_t stored = (uint32_t)snow_number_at(at, 4, false);
    /* HDF5 before 1.6.3 swapped the bytes of both halves on some machines. */
    const uint32_t swapped =
        (stored & 0x00ff00ff) << 8 | (stored & 0xff00ff00) >> 8;
    const uint32_t sum = fletcher_sum(packed->bytes, packed->size);
    return is_same_sum(sum, stored) || is_same_sum(sum, swapped)
               ? NULL
               : "does not match its checksum";
}

/* --- compressors: bytes -> scratch, at most `most` of them ---------------- */

/* The result is a fault, or NULL; *out is what came, `more` whether something
 * was left. */
static const char *inflate_all(snow_context *context, hdf5_packed *packed,
                               uint64_t most, uint64_t *out, bool *more) {
    z_stream stream = {0};
    snow_zlib_use(&stream, context);
    if (inflateInit(&stream) != Z_OK) {
        packed->status = SNOW_STATUS_NO_MEMORY;
        return NULL;
    }
    stream.next_in = packed->bytes;
    stream.avail_in = (uInt)packed->size;
    stream.next_out = packed->scratch;
    stream.avail_out = (uInt)most;
    int result = inflate(&stream, Z_FINISH);
    *out = most - stream.avail_out;
    /* Is it full, or at its end, of which the sum is still to be read? */
    if (result == Z_BUF_ERROR && !stream.avail_out) {
        unsigned char next;
        stream.next_out = &next;
        stream.avail_out = 1;
        result = inflate(&stream, Z_FINISH);
        *more = !stream.avail_out;
    }
    inflateEnd(&stream);
    if (result == Z_MEM_ERROR)
        packed->status = SNOW_STATUS_NO_MEMORY;
    if (*more || result == Z_STREAM_END)
        return NULL;
    return result == Z_BUF_ERROR ? "ends before its deflate stream does"
                                 : "is not a valid deflate stream";
}

/* Runs of literals (a byte below 32: so many and one more), and copies of what
 * came before: length, if it is 7 in the first three bits in a byte of its own,
 * and distance in 13 bits. */
static const char *unpack_lzf(hdf5_packed *packed, uint64_t most, uint64_t *out,
                              bool *more) {
    const unsigned char *from = packed->bytes;
    const unsigned char *const end = from + packed->size;
    unsigned char *to = packed->scratch;
    uint64_t left = most;
    while (from < end && !*more) {
        const unsigned code = *from++;
        uint64_t length = code + 1, back = 0;
        if (code >= 32) {
            length = code >> 5;
            if (length == 7 && from < end)
                length += *from++;
            if (from == end)
                return "ends before its LZF stream does";
            back = ((uint64_t)(code & 31) << 8 | *from++) + 1;
            length += 2;
            if (back > most - left)
                return "is not a valid LZF stream";
        } else if (length > (uint64_t)(end - from))
            return "ends before its LZF stream does";
        *more = length > left;
        if (*more)
            length = left;
        for (uint64_t i = 0; i < length; i++)
            to[i] = back ? to[i - back] : from[i];
        to += length;
        from += back ? 0 : length;
        left -= length;
    }
    *out = most - left;
    return NULL;
}

/* Unpacks to the scratch, which then changes places with the bytes. */
static void undo_compressor(snow_context *context, int id, uint64_t most,
                            uint64_t larger, hdf5_packed *packed) {
    uint64_t got = 0;
    bool more = false;
    if (larger > UINT32_MAX) /* libhdf5 has no larger chunks */
        larger = UINT32_MAX;
    packed->status = SNOW_RESERVE(context, packed->scratch, 0, most);
    if (packed->status != SNOW_STATUS_OK)
        return;
    packed->fault = id == FILTER_LZF
                        ? unpack_lzf(packed, most, &got, &more)
                        : inflate_all(context, packed, most, &got, &more);
    if (packed->fault || packed->status != SNOW_STATUS_OK)
        return;
    if (more && larger > most) {
        undo_compressor(context, id, larger, larger, packed);
        return;
    }
    if (more && larger)
        packed->fault = "unpacks to more than twice its size";
    unsigned char *unpacked = packed->scratch;
    packed->scratch = packed->bytes;
    packed->bytes = unpacked;
    packed->size = got;
}

/* --- shuffle -------------------------------------------------------------- */

/* The first bytes of all elements, then the second ones; an incomplete element
 * at the end stays. */
static void undo_shuffle(snow_context *context, uint64_t width,
                         hdf5_packed *packed) {
    const uint64_t count = width ? packed->size / width : 0;
    if (!width)
        packed->fault = "is shuffled in elements of no bytes";
    if (width < 2 || count < 2)
        return;
    packed->status = SNOW_RESERVE(context, packed->scratch, 0, packed->size);
    if (packed->status != SNOW_STATUS_OK)
        return;
    for (uint64_t k = 0; k < width; k++)
        for (uint64_t i = 0; i < count; i++)
            packed->scratch[i * width + k] = packed->bytes[k * count + i];
    memcpy(packed->scratch + count * width, packed->bytes + count * width,
           (size_t)(packed->size - count * width));
    unsigned char *values = packed->scratch;
    packed->scratch = packed->bytes;
    packed->bytes = values;
}

/* --- filters of libhdf5 and of plugins ------------------------------------ */

/* Whether a chunk has as many bytes as the filter's header says, and that
 * `bytes` come of it.  A filter that is not known makes what its plugin
 * makes. */
static const char *check_foreign(int id, const unsigned *settings, size_t count,
                                 uint64_t bytes, const hdf5_packed *packed) {
    const unsigned char *at = packed->bytes;
    const uint64_t size = packed->size;
    uint64_t head = 0, made = bytes, needed = 0;
    switch (id) {
    case H5Z_FILTER_SZIP: /* the unpacked size, and the coded blocks */
        head = 5;
        if (size >= head)
            made = snow_number_at(at, 4, false);
        break;
    case H5Z_FILTER_SCALEOFFSET: /* bits of a value, and the least value */
        head = 21;
        if (size < head || count < 5)
            break;
        if (snow_number_at(at, 4, false) > 8 * (uint64_t)settings[4])
            return "has more bits for a value than its type";
        needed = head +
                 ((uint64_t)settings[2] * snow_number_at(at, 4, false) + 7) / 8;
        break;
    case H5Z_FILTER_NBIT: /* the precision of an atomic type, in the settings */
        if (count > 6 && settings[3] == 1)
            needed = settings[1]
                         ? bytes
                         : ((uint64_t)settings[2] * settings[6] + 7) / 8;
        else
            return "is packed bit by bit with types in types";
        break;
    case FILTER_BLOSC:
        head = 16;
        if (size >= head) {
            made = snow_number_at(at + 4, 4, false);
            needed = snow_number_at(at + 12, 4, false);
        }
        break;
    case FILTER_LZ4:
    case FILTER_BITSHUFFLE:
        head = id == FILTER_LZ4 || (count > 4 && settings[4]) ? 12 : 0;
        if (head && size >= head)
            made = snow_number_at(at, 8, true);
        else if (!head)
            needed = bytes;
        break;
    default:
        return NULL;
    }
    if (size < head || size < needed)
        return "is shorter than its filter's header says";
    return made < bytes ? "unpacks to fewer bytes than it should" : NULL;
}

/* --- all of them ---------------------------------------------------------- */

void snow_hdf5_unpack(snow_context *context, const hdf5_filters *filters,
                      uint64_t bytes, hdf5_packed *packed) {
    packed->status = SNOW_STATUS_OK;
    packed->fault = NULL;
    for (int i = filters->count - 1; i >= 0; i--) {
        const int id = filters->all[i].id;
        const unsigned *settings = filters->all[i].settings;
        const size_t count = filters->all[i].settings_count;
        if (packed->mask >> i & 1)
            continue;
        /* What is left to undo needs all bytes of a chunk that is larger. */
        uint64_t sums = 0;
        bool needs_all = false;
        for (int k = 0; k < i; k++)
            if (!(packed->mask >> k & 1)) {
                needs_all = true;
                sums += filters->all[k].id == H5Z_FILTER_FLETCHER32;
            }
        if (!snow_hdf5_undoes(id)) {
            packed->fault = check_foreign(id, settings, count, bytes, packed);
            return;
        }
        if (id == H5Z_FILTER_FLETCHER32)
            packed->fault = undo_fletcher(packed);
        else if (id == H5Z_FILTER_SHUFFLE)
            undo_shuffle(context, count ? settings[0] : 0, packed);
        else if (bytes / SNOW_DEFLATE_RATIO > packed->size)
            packed->fault = "unpacks to fewer bytes than it should";
        else
            undo_compressor(context, id, bytes + sums * SUM_BYTES,
                            needs_all ? 2 * bytes + LARGER_BYTES : 0, packed);
        if (packed->fault || packed->status != SNOW_STATUS_OK)
            return;
    }
    if (packed->size < bytes)
        packed->fault = "unpacks to fewer bytes than it should";
}

#endif
