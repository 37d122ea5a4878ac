/* formats/dicom/palette.c - palette colours (PS3.3, C.7.6.3.1.5 and .6): three
 * tables, of red, green and blue, one after another in the file, of bytes or of
 * words.
 *
 *   stored value   .. first  first + 1  ...  first + count - 1 ..
 *   entry          0  0      1               count - 1          count - 1
 *
 * Tables may be written in segments (C.7.9.2): entries, a straight line from
 * the entry before, or segments that stand earlier once more.
 *
 * The volume has three channels, as of RGB, of 0 to 255. */
#include "base/minmax.h"
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include <math.h>

#define DESCRIPTOR 0x00281101u /* of red; green and blue follow it */
#define TABLE 0x00281201u
#define SEGMENTED 0x00281221u

/* What the three descriptors say; they must agree. */
typedef struct palette_shape {
    int64_t first;
    size_t count;
    int bits; /* of an entry: 8 or 16 */
} palette_shape;

static uint16_t word_of(const dicom_reader *reader, const unsigned char *at) {
    return (uint16_t)snow_number_at(at, 2, reader->big_endian);
}

static snow_status fail_palette(dicom_reader *reader, const char *what) {
    return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                     "its values are palette colours, %s; convert it to RGB",
                     what);
}

static snow_status read_shape(dicom_reader *reader, const dicom_image *image,
                              uint32_t color, palette_shape *out) {
    unsigned char bytes[6];
    const dicom_place place = {0, 0, DESCRIPTOR + color};
    if (snow_dicom_value(reader, place, bytes, 6) < 6)
        return fail_palette(reader, "and the palette is missing");
    uint16_t count = word_of(reader, bytes), first = word_of(reader, bytes + 2);
    *out = (palette_shape){.first = image->is_signed ? (int16_t)first : first,
                           .count = count ? count : 65536,
                           .bits = word_of(reader, bytes + 4)};
    if (out->bits == 8 || out->bits == 16)
        return SNOW_STATUS_OK;
    return fail_palette(reader, "with entries of other than 8 or 16 bits");
}

/* Reads a table of entries.  Those of 8 bits are written as bytes or, by some
 * programs, as words. */
static snow_status read_entries(const dicom_reader *reader,
                                const palette_shape *shape,
                                const unsigned char *bytes, size_t got,
                                uint16_t *out) {
    const bool words = got >= 2 * shape->count;
    if (!words && (shape->bits == 16 || got < shape->count))
        return SNOW_STATUS_BAD_INPUT;
    for (size_t i = 0; i < shape->count; i++) {
        /* bytes that were written as words have their byte order */
        size_t at = reader->big_endian && !words ? i ^ 1 : i;
        out[i] =
            words ? word_of(reader, bytes + 2 * i) : bytes[at < got ? at : i];
    }
    return SNOW_STATUS_OK;
}

/* --- segments ------------------------------------------------------------- */

enum { DISCRETE, LINEAR, INDIRECT };

/* A table in segments, whose numbers have the size of its entries. */
typedef struct segments {
    const dicom_reader *reader;
    const unsigned char *bytes;
    size_t count; /* of numbers */
    size_t size;
    uint16_t *out;
    size_t done, room;
} segments;

static unsigned number_of(const segments *s, size_t at) {
    return s->size == 1 ? s->bytes[at] : word_of(s->reader, s->bytes + 2 * at);
}

static bool add_entries(segments *s, size_t at, size_t length) {
    if (length > s->count - at || length > s->room - s->done)
        return false;
    for (size_t n = 0; n < length; n++)
        s->out[s->done++] = (uint16_t)number_of(s, at + n);
    return true;
}

static bool add_line(segments *s, size_t at, size_t length) {
    if (s->done == 0 || at >= s->count || length > s->room - s->done)
        return false;
    const double from = s->out[s->done - 1], to = number_of(s, at);
    for (size_t n = 1; n <= length; n++)
        s->out[s->done++] =
            (uint16_t)rint(from + (to - from) * (double)n / (double)length);
    return true;
}

/* The place of the segments that an indirect one means: a number of bytes, in
 * two words, the lower first, or in four bytes. */
static size_t find_target(const segments *s, size_t at) {
    size_t bytes = 0;
    for (size_t n = 4 / s->size; n-- > 0;)
        bytes = bytes << 8 * s->size | number_of(s, at + n);
    return bytes / s->size;
}

/* Adds `most` segments from `at` on, or as many as there are.  A number that is
 * left over fills the last word. */
static bool expand(segments *s, size_t at, size_t most, bool inside) {
    for (; most > 0 && at + 1 < s->count; most--) {
        const unsigned kind = number_of(s, at);
        const size_t length = number_of(s, at + 1), words = 4 / s->size;
        at += 2;
        if (length == 0) /* a file of such segments would take hours */
            return false;
        if (kind == DISCRETE && add_entries(s, at, length))
            at += length;
        else if (kind == LINEAR && add_line(s, at, length))
            at++;
        else if (kind == INDIRECT && !inside && words <= s->count - at &&
                 expand(s, find_target(s, at), length, true))
            at += words;
        else
            return false;
    }
    return true;
}

static snow_status read_segments(const dicom_reader *reader,
                                 const palette_shape *shape,
                                 const unsigned char *bytes, size_t got,
                                 uint16_t *out) {
    const size_t size = (size_t)shape->bits / 8;
    segments s = {.reader = reader,
                  .bytes = bytes,
                  .count = got / size,
                  .size = size,
                  .out = out,
                  .room = shape->count};
    return expand(&s, 0, SIZE_MAX, false) && s.done == s.room
               ? SNOW_STATUS_OK
               : SNOW_STATUS_BAD_INPUT;
}

/* --- the palette ---------------------------------------------------------- */

/* An entry of its own takes three numbers. */
#define BYTES_OF_ENTRY 6

/* Reads a table, scaled to 0 to 255. */
static snow_status read_table(dicom_reader *reader, uint32_t color,
                              const palette_shape *shape, unsigned char *bytes,
                              uint16_t *entries, unsigned char *levels) {
    const dicom_place plain = {0, 0, TABLE + color},
                      packed = {0, 0, SEGMENTED + color};
    const size_t room = BYTES_OF_ENTRY * shape->count;
    const unsigned most = shape->bits == 16 ? 65535 : 255;
    size_t got = snow_dicom_value(reader, plain, bytes, room);
    const bool whole = got > 0;
    if (!whole)
        got = snow_dicom_value(reader, packed, bytes, room);
    if ((whole ? read_entries : read_segments)(reader, shape, bytes, got,
                                               entries) != SNOW_STATUS_OK)
        return fail_palette(reader, "of which some are missing");
    for (size_t i = 0; i < shape->count; i++) {
        unsigned entry = SNOW_MIN(entries[i], most);
        levels[i] = (unsigned char)((entry * 255 + most / 2) / most);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_dicom_palette_read(dicom_reader *reader,
                                    const dicom_image *image,
                                    dicom_palette *out) {
    palette_shape all[3];
    for (uint32_t color = 0; color < 3; color++)
        SNOW_TRY(read_shape(reader, image, color, &all[color]));
    for (int color = 1; color < 3; color++)
        if (all[color].first != all[0].first ||
            all[color].count != all[0].count || all[color].bits != all[0].bits)
            return fail_palette(reader, "whose tables differ in length");
    const size_t count = all[0].count;
    unsigned char *levels = snow_allocate_array(reader->context, count, 3);
    unsigned char *bytes =
        snow_allocate_array(reader->context, count, BYTES_OF_ENTRY);
    uint16_t *entries =
        snow_allocate_array(reader->context, count, sizeof *entries);
    snow_status status =
        levels && bytes && entries ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    for (uint32_t color = 0; color < 3 && status == SNOW_STATUS_OK; color++)
        status = read_table(reader, color, &all[0], bytes, entries,
                            levels + color * count);
    snow_release(reader->context, bytes);
    snow_release(reader->context, entries);
    if (status != SNOW_STATUS_OK) {
        snow_release(reader->context, levels);
        return status;
    }
    *out = (dicom_palette){all[0].first, count, levels};
    return SNOW_STATUS_OK;
}
