/* formats/dicom/palette.c - the brightness of palette colours (PS3.3,
 * C.7.6.3.1.5 and .6): three tables, of red, green and blue, one after another
 * in the file, of bytes or of words.
 *
 *   stored value   .. first  first + 1  ...  first + count - 1 ..
 *   entry          0  0      1               count - 1          count - 1
 *
 * Colours are not used as such: a pixel gets the value 0.299 R + 0.587 G +
 * 0.114 B, from 0 to 255, like Y of YBR_FULL. */
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include <string.h>

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
                     "its values are palette colours, %s; convert it to grey",
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

/* Adds `share` of a table's entries, scaled to 0 to 1.  Tables of 8 bits are
 * written as bytes or, by some programs, as words. */
static snow_status add_table(dicom_reader *reader, uint32_t color,
                             const palette_shape *shape, double share,
                             unsigned char *bytes, float *levels) {
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
    double most = shape->bits == 16 ? 65535 : 255;
    for (size_t i = 0; i < count; i++) {
        /* bytes that were written as words have their byte order */
        size_t at = reader->big_endian && !words ? i ^ 1 : i;
        double entry =
            words ? word_of(reader, bytes + 2 * i) : bytes[at < got ? at : i];
        levels[i] += (float)(share * (entry < most ? entry : most) / most);
    }
    return SNOW_STATUS_OK;
}

static snow_status fill_levels(dicom_reader *reader, const palette_shape *shape,
                               unsigned char *bytes, float *levels) {
    static const double shares[3] = {0.299, 0.587, 0.114};
    memset(levels, 0, shape->count * sizeof *levels);
    for (uint32_t color = 0; color < 3; color++)
        SNOW_TRY(add_table(reader, color, shape, shares[color], bytes, levels));
    for (size_t i = 0; i < shape->count; i++)
        levels[i] = (float)(int)(levels[i] * 255 + 0.5F);
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
    float *levels =
        snow_allocate_array(reader->context, all[0].count, sizeof *levels);
    unsigned char *bytes =
        snow_allocate_array(reader->context, all[0].count, 2);
    snow_status status = levels && bytes
                             ? fill_levels(reader, &all[0], bytes, levels)
                             : SNOW_STATUS_NO_MEMORY;
    snow_release(reader->context, bytes);
    if (status != SNOW_STATUS_OK) {
        snow_release(reader->context, levels);
        return status;
    }
    *out = (dicom_palette){all[0].first, all[0].count, levels};
    return SNOW_STATUS_OK;
}
