/* formats/dicom/copies.c - whether two files have the same image.
 *
 * A copy has the same SOP instance UID.  The reverse is not true: some programs
 * that remove names give all images of a series one UID.  So position, time and
 * the pixels as they are stored must agree, too; of these a sum is compared,
 * 64-bit FNV-1a (RFC 9923), which is computed only for equal UIDs. */
#include "formats/dicom/dicom.h"

#include <string.h>

/* Adds the bytes from the pixels to the end of the file, of a deflated file
 * all: more than the pixels do not differ in a copy. */
static uint64_t sum_of(const dicom_reader *reader) {
    uint64_t at = reader->inner_store ? 0 : reader->pixels_at;
    uint64_t end = snow_seekable_size(reader->file), sum = 0xcbf29ce484222325u;
    unsigned char bytes[4096];
    if (!reader->packed && !reader->inner_store)
        end = at + reader->pixel_bytes;
    for (size_t size = 1; at < end && size; at += size) {
        const uint64_t left = end - at;
        size = snow_seekable_read(reader->file, at, bytes,
                                  left < sizeof bytes ? left : sizeof bytes);
        for (size_t i = 0; i < size; i++)
            sum = (sum ^ bytes[i]) * 0x100000001b3u;
    }
    return sum ? sum : 1;
}

/* Frames of the same place and time. */
static bool are_alike(const dicom_frame *a, const dicom_frame *b) {
    bool alike = a->placed == b->placed &&
                 !strcmp(a->image->clock, b->image->clock) &&
                 a->image->frames == b->image->frames;
    for (int i = 0; i < 3; i++)
        alike = alike && a->position[i] == b->position[i];
    for (int i = 0; i < DICOM_KEY_INSTANCE; i++)
        alike = alike && a->keys[i] == b->keys[i];
    return alike;
}

snow_status snow_dicom_is_copy(dicom_reader *reader, snow_seekable *given,
                               dicom_image *image, const dicom_frame *frame,
                               dicom_image *other, const dicom_frame *known,
                               bool *same) {
    dicom_reader again;
    *same = are_alike(frame, known);
    if (!*same || reader->cut || known->lost)
        return SNOW_STATUS_OK;
    if (!other->sum) {
        SNOW_TRY(
            snow_dicom_open(reader->context, other->path, given, NULL, &again));
        other->sum = sum_of(&again);
        snow_dicom_close(&again);
    }
    image->sum = sum_of(reader);
    *same = image->sum == other->sum;
    return SNOW_STATUS_OK;
}
