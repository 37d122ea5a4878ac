/* formats/dicom/mosaic.c - Siemens mosaics: the slices of a volume are the
 * tiles of one frame, row by row, as many a side as they need.
 *
 *    0  1  2     NumberOfImagesInMosaic = 7, so three tiles a side;
 *    3  4  5     the frame's position is that of a slice as large as the
 *    6  .  .     frame, around the same centre
 *
 * Their number, and the direction from slice to slice, are in elements of
 * Siemens' own, of which the CSA header is a list of named texts:
 *
 *    "SV10" 4 bytes, only in its second version
 *    number of tags (4), 77 (4)
 *    tag: name (64), values (4), type (4), syngo's type (4), items (4), 77 (4)
 *    item: four numbers (16), one of which gives the length; text, up to a
 *          multiple of 4
 *
 * As in dcm2niix, nibabel (nicom) and SPM, which found this out. */
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include <math.h>
#include <string.h>

/* Real headers have a tenth of it. */
#define MOST_CSA ((size_t)1 << 20)

#define CSA_TAG 84
#define CSA_ITEM 16

typedef struct csa {
    unsigned char *bytes; /* of the context; NULL: none */
    size_t size;
} csa;

static uint32_t little(const unsigned char *at) {
    return (uint32_t)snow_number_at(at, 4, false);
}

/* Reads the numbers of a named tag; returns how many there are. */
static int csa_numbers(const csa *h, const char *name, double *out, int most) {
    const bool second = h->size >= 4 && !memcmp(h->bytes, "SV10", 4);
    size_t at = second ? 16 : 8;
    uint32_t before = 0; /* what lengths of the first version are too large */
    if (h->size < at)
        return 0;
    uint32_t tags = little(h->bytes + at - 8);
    for (uint32_t n = 0; n < tags && h->size - at >= CSA_TAG; n++) {
        const bool wanted = !strncmp((char *)h->bytes + at, name, 64);
        const uint32_t items = little(h->bytes + at + 76);
        int found = 0;
        before = n || second ? before : items;
        at += CSA_TAG;
        for (uint32_t i = 0; i < items && h->size - at >= CSA_ITEM; i++) {
            const unsigned char *head = h->bytes + at;
            const uint32_t length = little(head + (second ? 4 : 0)) - before;
            char text[64] = "";
            at += CSA_ITEM;
            if (length > h->size - at)
                break;
            memcpy(text, h->bytes + at,
                   length < sizeof text ? length : sizeof text - 1);
            if (wanted && found < most &&
                snow_parse_double(text, &out[found]) && isfinite(out[found]))
                found++;
            at += length;
            at += h->size - at < 3 ? 0 : (4 - length % 4) % 4;
        }
        if (wanted)
            return found;
    }
    return 0;
}

/* An element of Siemens' in the block that it has reserved; NULL: none. */
static const dicom_element *private_element(dicom_reader *reader,
                                            uint32_t group, const char *creator,
                                            uint32_t element) {
    const size_t length = strlen(creator);
    for (size_t i = 0; i < reader->count; i = reader->elements[i].next) {
        const uint32_t tag = reader->elements[i].tag;
        char text[65];
        if (tag >> 16 != group || (tag & 0xffff) < 0x10 ||
            (tag & 0xffff) > 0xff)
            continue;
        text[snow_dicom_bytes(reader, &reader->elements[i], text,
                              sizeof text - 1)] = 0;
        if (!strncmp(text, creator, length) &&
            !text[length + strspn(text + length, " ")])
            return snow_dicom_find(reader, 0, reader->count,
                                   group << 16 | (tag & 0xff) << 8 | element);
    }
    return NULL;
}

/* Takes what the CSA header says of the slices. */
static snow_status read_csa(dicom_reader *reader, double *number,
                            dicom_image *image) {
    const dicom_element *element =
        private_element(reader, 0x0029, "SIEMENS CSA HEADER", 0x10);
    if (!element || !element->length || element->length > MOST_CSA)
        return SNOW_STATUS_OK;
    csa h = {snow_allocate(reader->context, element->length), 0};
    if (!h.bytes)
        return SNOW_STATUS_NO_MEMORY;
    h.size = snow_dicom_bytes(reader, element, h.bytes, element->length);
    if (!(*number > 0))
        csa_numbers(&h, "NumberOfImagesInMosaic", number, 1);
    image->has_normal =
        csa_numbers(&h, "SliceNormalVector", image->normal, 3) == 3;
    csa_numbers(&h, "SpacingBetweenSlices", &image->apart, 1);
    snow_release(reader->context, h.bytes);
    return SNOW_STATUS_OK;
}

/* --- the image ------------------------------------------------------------ */

snow_status snow_dicom_read_mosaic(dicom_reader *reader, dicom_image *image) {
    char type[256];
    double number = 0;
    image->slices = image->frames;
    snow_dicom_text(reader, 0x00080008, type, sizeof type);
    snow_dicom_shorts(
        reader, private_element(reader, 0x0019, "SIEMENS MR HEADER", 0x0a),
        &number, 1);
    if (!strstr(type, "MOSAIC") && !(number > 1))
        return SNOW_STATUS_OK;
    SNOW_TRY(read_csa(reader, &number, image));
    if (number == 1)
        return SNOW_STATUS_OK;
    image->tiles = -1;
    if (!(number > 1 && number <= UINT16_MAX) || image->frames != 1)
        return SNOW_STATUS_OK;
    const int64_t side = (int64_t)ceil(sqrt(number));
    const bool whole = !(image->columns % side) && !(image->rows % side);
    image->tiles = (int)(whole ? side : -side);
    image->slices = whole ? (int64_t)number : 1;
    return SNOW_STATUS_OK;
}

snow_status snow_dicom_check_mosaic(snow_context *context,
                                    const dicom_frame *frame) {
    const dicom_image *image = frame->image;
    if (image->tiles == -1)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "%s is a Siemens mosaic (ImageType) without the number of its "
            "slices, which (0019,100A) or the CSA header (0029,1010) have; get "
            "it again with the private elements",
            snow_dicom_name(frame));
    if (image->tiles < 0)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "%s is a Siemens mosaic of %dx%d tiles, but its %lldx%lld pixels "
            "are not as many whole tiles; get the original file",
            snow_dicom_name(frame), -image->tiles, -image->tiles,
            (long long)image->columns, (long long)image->rows);
    if (image->tiles > 1 && frame->placed && !image->has_normal)
        snow_notify(context, "its mosaic does not say in which direction its "
                             "slices follow (SliceNormalVector); row x column "
                             "is taken, and they may be in the opposite order");
    return SNOW_STATUS_OK;
}

/* --- a slice -------------------------------------------------------------- */

void snow_dicom_place_tile(const dicom_image *image, dicom_frame *frame) {
    const double *r = frame->row, *c = frame->column;
    double n[3];
    snow_dicom_normal(frame, n);
    const bool back = image->has_normal && snow_dot(n, image->normal) < 0;
    if (image->tiles < 2)
        return;
    frame->depth = fabs(frame->depth);
    if (!(frame->depth > 0))
        frame->depth = image->apart;
    frame->guessed = !(frame->depth > 0);
    if (frame->guessed)
        frame->depth = frame->thickness > 0 ? frame->thickness : 1;
    const double across =
        (double)(image->columns - snow_dicom_columns(image)) / 2;
    const double down = (double)(image->rows - snow_dicom_rows(image)) / 2;
    const double up = (double)frame->number * frame->depth * (back ? -1 : 1);
    for (int i = 0; i < 3 && frame->placed; i++)
        frame->position[i] += across * frame->pixel[0] * r[i] +
                              down * frame->pixel[1] * c[i] + up * n[i];
}
