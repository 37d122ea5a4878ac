/* formats/dicom/sizes.c - whether a header and its pixels agree: their bytes,
 * the frames, and elements that are there twice. */
#include "formats/dicom/dicom.h"

#include <string.h>

/* Bytes before a compressed frame. */
#define FRAGMENT_HEAD 8

/* Bytes of the pixels as the header describes them; false if no file has as
 * many.  Subsampled colours have fewer samples than declared. */
static bool count_bytes(const dicom_image *image, uint64_t *out) {
    bool halved = strstr(image->photometric, "_42") != NULL;
    uint64_t samples = halved ? 1 : (uint64_t)image->samples;
    if (!snow_mul_u64((uint64_t)image->rows * (uint64_t)image->columns,
                      (uint64_t)image->frames, out) ||
        !snow_mul_u64(*out, samples * (uint64_t)image->allocated, out))
        return false;
    *out = *out / 8 + (*out % 8 > 0);
    return true;
}

/* Returns whether the file can hold the pixels. Plain ones are counted in
 * their element; each compressed frame has at least the header of a fragment.
 * The decompressed size is checked again with the frames' own headers. */
static bool can_hold(const dicom_reader *reader, const dicom_image *image) {
    uint64_t frames = (uint64_t)image->frames, bytes, most;
    uint64_t size = snow_seekable_size(reader->store);
    if (!count_bytes(image, &bytes))
        return false;
    if (!reader->packed)
        return bytes <= reader->pixel_bytes;
    return frames <= size / FRAGMENT_HEAD &&
           snow_mul_u64(size, 8 * SNOW_DEFLATE_RATIO, &most) &&
           bytes <= most + ((uint64_t)1 << 31);
}

uint64_t snow_dicom_count_more(const dicom_reader *reader,
                               const dicom_image *image) {
    const uint64_t row = (uint64_t)image->columns * (uint64_t)image->samples *
                         (uint64_t)image->allocated / 8;
    uint64_t bytes = 0;
    if (reader->packed || strstr(image->photometric, "_42") ||
        !count_bytes(image, &bytes) ||
        reader->pixel_bytes <= bytes + (row > 1 ? row - 1 : 1) ||
        (row > 2 && (reader->pixel_bytes - bytes) % row > 1))
        return 0;
    return reader->pixel_bytes - bytes;
}

/* Elements that lay out the pixels must not contradict one another. */
static snow_status check_twice(snow_context *context,
                               const dicom_reader *reader) {
    static const uint32_t tags[] = {
        0x00280002, 0x00280004, 0x00280006, 0x00280008, 0x00280010,
        0x00280011, 0x00280100, 0x00280101, 0x00280102, 0x00280103};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++) {
        const dicom_element *first =
            snow_dicom_find(reader, 0, reader->count, tags[i]);
        if (first &&
            snow_dicom_find(reader, first->next, reader->count, tags[i]))
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "has element (%04x,%04x) twice; it is damaged",
                             tags[i] >> 16, tags[i] & 0xffff);
    }
    return SNOW_STATUS_OK;
}

/* The frames that functional groups describe; 0: there are none. */
static int64_t count_groups(const dicom_reader *reader) {
    const dicom_element *all = reader->frames;
    int64_t count = 0;
    for (size_t i = all ? (size_t)(all - reader->elements) + 1 : 0;
         all && i < all->next; i = reader->elements[i].next)
        count++;
    return count;
}

snow_status snow_dicom_check_sizes(snow_context *context,
                                   const dicom_reader *reader,
                                   const dicom_image *image) {
    if (image->frames < 1)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "claims %lld frames; it is damaged",
                         (long long)image->frames);
    if (!can_hold(reader, image))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "claims %lld frame%s of %lldx%lld pixels, which its "
                         "%llu bytes cannot hold; it is truncated or damaged",
                         (long long)image->frames,
                         image->frames == 1 ? "" : "s",
                         (long long)image->columns, (long long)image->rows,
                         (unsigned long long)snow_seekable_size(reader->store));
    if (image->more >= snow_dicom_frame_bytes(image) ||
        (image->more && image->allocated == 1))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "has %lu bytes of pixels, more than %lld frame%s of "
                         "%lldx%lld pixels; it is damaged",
                         (unsigned long)reader->pixel_bytes,
                         (long long)image->frames,
                         image->frames == 1 ? "" : "s",
                         (long long)image->columns, (long long)image->rows);
    const int64_t groups = count_groups(reader);
    if (groups && groups != image->frames)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "describes %lld frames but claims %lld; it is damaged",
                         (long long)groups, (long long)image->frames);
    return check_twice(context, reader);
}
