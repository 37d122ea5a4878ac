/* formats/dicom/palette.c - palette colours (PS3.3, C.7.6.3.1.5 and .6): three
 * tables, of red, green and blue, one after another in the file, of bytes or of
 * words.
 *
 *   stored value   .. first  first + 1  ...  first + count - 1 ..
 *   entry          0  0      1               count - 1          count - 1
 *
 * The volume has three channels, as of RGB, of 0 to 255. */
#include "base/minmax.h"
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

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

/* Reads a table, scaled to 0 to 255.  Tables of 8 bits are written as bytes or,
 * by some programs, as words. */
static snow_status read_table(dicom_reader *reader, uint32_t color,
                              const palette_shape *shape, unsigned char *bytes,
                              unsigned char *levels) {
    const dicom_place place = {0, 0, TABLE + color};
    size_t count = shape->count;
    size_t got = snow_dicom_value(reader, place, bytes, 2 * count);
    bool words = got >= 2 * count;
    unsigned char packed[4];
    const dicom_place segments = {0, 0, SEGMENTED + color};
    if (got == 0 && snow_dicom_value(reader, segments, packed, 4))
        return fail_palette(reader,
                            "stored in segments, which are not supported");
    if (!words && (shape->bits == 16 || got < count))
        return fail_palette(reader, "of which some are missing");
    const unsigned most = shape->bits == 16 ? 65535 : 255;
    for (size_t i = 0; i < count; i++) {
        /* bytes that were written as words have their byte order */
        size_t at = reader->big_endian && !words ? i ^ 1 : i;
        unsigned entry =
            words ? word_of(reader, bytes + 2 * i) : bytes[at < got ? at : i];
        entry = SNOW_MIN(entry, most);
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
    unsigned char *bytes = snow_allocate_array(reader->context, count, 2);
    snow_status status =
        levels && bytes ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    for (uint32_t color = 0; color < 3 && status == SNOW_STATUS_OK; color++)
        status =
            read_table(reader, color, &all[0], bytes, levels + color * count);
    snow_release(reader->context, bytes);
    if (status != SNOW_STATUS_OK) {
        snow_release(reader->context, levels);
        return status;
    }
    *out = (dicom_palette){all[0].first, count, levels};
    return SNOW_STATUS_OK;
}
