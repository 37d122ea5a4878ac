/* formats/dicom/codec.c - checks the headers of compressed frames, and decodes
 * run lengths, which need no library.
 *
 * A codec makes as many words as its own header says; GDCM then copies as many
 * as the image has.  So the headers of JPEG and JPEG-LS (ITU T.81, B.2.2; T.87,
 * C.2.2) and of JPEG 2000 (T.800, A.5.1) must agree with the image's before
 * GDCM sees them. */
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include <string.h>

/* What a codec's header says. */
typedef struct packed_head {
    uint32_t columns, rows, samples;
    int bits;
    bool known;  /* the sizes are */
    bool intact; /* so is all before the values */
    bool unlike; /* components differ in size or depth */
} packed_head;

static uint32_t big(const unsigned char *at, int bytes) {
    return (uint32_t)snow_number_at(at, bytes, true);
}

/* Starts of a frame in JPEG: SOF0 to SOF15 except for tables (C4, C8, CC), and
 * SOF55 of JPEG-LS. */
static bool is_frame(int marker) {
    return (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 &&
            marker != 0xc8 && marker != 0xcc) ||
           marker == 0xf7;
}

/* Walks the segments up to the start of the scan, which must be intact:
 * otherwise GDCM ends the process, and so it does after what libjpeg warns of:
 * a version of JFIF that is not 1, and an unknown transform of Adobe's, which
 * is used of three components without JFIF, which defines them.  JPEG-LS (`ls`)
 * does not use libjpeg. */
static void read_jpeg(const unsigned char *bytes, size_t size, bool ls,
                      packed_head *out) {
    bool jfif = false, version = false, transform = false;
    if (size < 4 || bytes[0] != 0xff || bytes[1] != 0xd8)
        return;
    for (size_t at = 2; at + 4 <= size && bytes[at] == 0xff;) {
        const int marker = bytes[at + 1];
        if (marker == 0xff) { /* padding */
            at++;
            continue;
        }
        const size_t length = big(bytes + at + 2, 2);
        const bool bare = marker <= 0x01 || (marker >= 0xd0 && marker <= 0xd9);
        if (bare || length < 2 || length > size - at - 2)
            return;
        const unsigned char *data = bytes + at + 4;
        if (is_frame(marker) && length >= 8 && !out->known)
            *out = (packed_head){.known = true,
                                 .bits = data[0],
                                 .rows = big(data + 1, 2),
                                 .columns = big(data + 3, 2),
                                 .samples = data[5]};
        if (marker == 0xe0 && length >= 16 && !memcmp(data, "JFIF", 5)) {
            jfif = true;
            version |= data[5] != 1;
        } else if (marker == 0xee && length >= 14 && !memcmp(data, "Adobe", 5))
            transform = data[11] > 1;
        if (marker == 0xf7 && !ls)
            return;
        if (marker == 0xda) {
            out->intact =
                ls || !(version || (transform && !jfif && out->samples == 3));
            return;
        }
        at += 2 + length;
    }
}

/* Returns whether components have one depth and are not subsampled, as the
 * caller expects. `siz` is the marker's segment at its length; `room` counts
 * from there. */
static bool are_alike(const unsigned char *siz, size_t capacity,
                      uint32_t samples) {
    if (samples > (capacity - 38) / 3)
        return false;
    for (uint32_t n = 0; n < samples; n++) {
        const unsigned char *of = siz + 38 + 3 * (size_t)n;
        if (of[0] != siz[38] || of[1] != 1 || of[2] != 1)
            return false;
    }
    return true;
}

/* A bare code stream, or one in the boxes of a file, which are skipped: SIZ
 * follows its start. */
static void read_jpeg2000(const unsigned char **bytes, size_t *size,
                          packed_head *out) {
    static const unsigned char start[4] = {0xff, 0x4f, 0xff, 0x51};
    for (size_t at = 0; at + 45 <= *size && at < 4096; at++)
        if (!memcmp(*bytes + at, start, 4)) {
            const unsigned char *siz = *bytes + at + 4;
            uint32_t x1 = big(siz + 4, 4), y1 = big(siz + 8, 4);
            uint32_t x0 = big(siz + 12, 4), y0 = big(siz + 16, 4);
            *out = (packed_head){.columns = x1 - x0,
                                 .rows = y1 - y0,
                                 .samples = big(siz + 36, 2),
                                 .bits = (siz[38] & 0x7f) + 1,
                                 .known = x1 > x0 && y1 > y0,
                                 .intact = true};
            *bytes += at;
            *size -= at;
            out->unlike = !are_alike(siz, *size - 4, out->samples);
            return;
        }
}

static bool is_jpeg2000(const char *syntax) {
    return !strncmp(syntax, "1.2.840.10008.1.2.4.9", 21);
}

static bool is_jpeg_ls(const char *syntax) {
    return !strncmp(syntax, "1.2.840.10008.1.2.4.8", 21);
}

snow_status snow_dicom_fail_unpack(snow_context *context, const char *syntax) {
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "its pixels cannot be decompressed (transfer syntax %s); "
                     "it is truncated or damaged",
                     syntax);
}

/* CharLS finds by itself what else is missing in JPEG-LS. */
static snow_status check_whole(snow_context *context, const char *syntax,
                               const unsigned char *bytes, size_t size) {
    bool whole = true;
    if (is_jpeg2000(syntax))
        SNOW_TRY(snow_dicom_walk_jpeg2000(context, bytes, size, &whole));
    else
        whole = (is_jpeg_ls(syntax) ? snow_dicom_jpeg_ls_has_end
                                    : snow_dicom_jpeg_is_whole)(bytes, size);
    return whole ? SNOW_STATUS_OK : snow_dicom_fail_unpack(context, syntax);
}

snow_status snow_dicom_check_packed(snow_context *context, const char *syntax,
                                    const dicom_image *image,
                                    const unsigned char **bytes, size_t *size,
                                    int *bits) {
    packed_head head = {0};
    if (is_jpeg2000(syntax))
        read_jpeg2000(bytes, size, &head);
    else
        read_jpeg(*bytes, *size, is_jpeg_ls(syntax), &head);
    bool same = head.known && head.columns == (uint32_t)image->columns &&
                head.rows == (uint32_t)image->rows &&
                head.samples == (uint32_t)image->samples &&
                head.bits <= image->allocated &&
                (head.bits > 8) == (image->allocated > 8);
    *bits = same ? head.bits : 0;
    if (same && head.unlike)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "its compressed colours differ in size or depth, which is not "
            "supported; decompress it, for example with gdcmconv --raw");
    if (same && head.intact)
        return check_whole(context, syntax, *bytes, *size);
    if (head.known && !same)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "its compressed pixels are %lux%lu of %lu values with %d bits but "
            "its header says %lldx%lld of %d with %d; it is damaged",
            (unsigned long)head.columns, (unsigned long)head.rows,
            (unsigned long)head.samples, head.bits, (long long)image->columns,
            (long long)image->rows, image->samples, image->allocated);
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "its compressed pixels do not begin like those of the "
                     "transfer syntax %s; it is damaged",
                     syntax);
}

/* Decodes one segment: a byte n from 0 to 127 stands before n + 1 others, one
 * from 129 on before a byte that is repeated 257 - n times. */
static bool unpack_segment(const unsigned char *in, size_t size,
                           unsigned char *out, size_t step, size_t count) {
    size_t at = 0, made = 0;
    while (made < count) {
        if (at >= size)
            return false;
        int n = in[at++];
        size_t run = n < 128 ? (size_t)n + 1 : (size_t)(257 - n);
        size_t taken = n < 128 ? run : 1;
        if (n == 128)
            continue;
        if (taken > size - at)
            return false;
        run = run < count - made ? run : count - made;
        for (size_t i = 0; i < run; i++)
            out[step * (made + i)] = in[n < 128 ? at + i : at];
        at += taken;
        made += run;
    }
    return true;
}

/* Sixteen numbers come first: the number of segments, and the offset of each.
 * The high byte of a sample comes before the low one. */
bool snow_dicom_unpack_runs(const dicom_image *image,
                            const unsigned char *bytes, size_t size,
                            unsigned char *out) {
    size_t word = (size_t)image->allocated / 8;
    size_t segments = word * (size_t)image->samples;
    size_t area = (size_t)(image->columns * image->rows);
    uint32_t begin[17];
    if (size < 64 || segments > 15)
        return false;
    for (size_t i = 0; i < 16; i++)
        begin[i] = (uint32_t)snow_number_at(bytes + 4 * i, 4, false);
    if (begin[0] != segments)
        return false;
    begin[segments + 1] = (uint32_t)size;
    for (size_t i = 0; i < segments; i++) {
        size_t from = begin[i + 1], end = begin[i + 2];
        size_t sample = i / word, byte = i % word;
        if (snow_machine_big_endian() == false)
            byte = word - 1 - byte;
        if (from < 64 || from > end || end > size ||
            !unpack_segment(bytes + from, end - from,
                            out + sample * area * word + byte, word, area))
            return false;
    }
    return true;
}
