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
static uint64_t sum_of(const dicom_reader *reader, snow_seekable *store) {
    uint64_t at = reader->inner_store ? 0 : reader->pixels_at;
    uint64_t end = snow_seekable_size(store), sum = 0xcbf29ce484222325u;
    unsigned char bytes[4096];
    if (!reader->packed && !reader->inner_store)
        end = at + reader->pixel_bytes;
    for (size_t size = 1; at < end && size; at += size) {
        const uint64_t left = end - at;
        size = snow_seekable_read(store, at, bytes,
                                  left < sizeof bytes ? left : sizeof bytes);
        for (size_t i = 0; i < size; i++)
            sum = (sum ^ bytes[i]) * 0x100000001b3u;
    }
    return sum ? sum : 1;
}

/* Reads an image's file once more, `given` if it has no path. */
static snow_status sum_pixels(snow_context *context, snow_seekable *given,
                              dicom_image *image) {
    snow_source *source = NULL;
    snow_seekable *store = image->path ? NULL : given;
    dicom_reader reader;
    snow_status status = SNOW_STATUS_OK;
    if (image->sum)
        return SNOW_STATUS_OK;
    if (image->path) {
        SNOW_TRY(snow_source_open(context, image->path, &source));
        status = snow_seekable_open(source, &store);
    }
    if (status == SNOW_STATUS_OK)
        status = snow_dicom_open(context, store, NULL, &reader);
    if (status == SNOW_STATUS_OK) {
        image->sum = sum_of(&reader, store);
        snow_dicom_close(&reader);
    }
    if (source) {
        snow_seekable_close(store);
        snow_source_close(source);
    }
    return status;
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
                               dicom_image *image, dicom_image *other,
                               const dicom_frame *known, bool *same) {
    dicom_frame frame;
    snow_dicom_read_frame(reader, image, 0, &frame);
    *same = are_alike(&frame, known);
    if (!*same || reader->cut || known->lost)
        return SNOW_STATUS_OK;
    SNOW_TRY(sum_pixels(reader->context, given, image));
    SNOW_TRY(sum_pixels(reader->context, given, other));
    *same = image->sum == other->sum;
    return SNOW_STATUS_OK;
}
