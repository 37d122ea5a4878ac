/* fuzz/support/picture.h - what the fuzz targets of the picture readers share:
 * one look at an input, with 64 MB of memory. */
#ifndef SNOW_FUZZ_PICTURE_H
#define SNOW_FUZZ_PICTURE_H

#include "support/capped.h"

#include <string.h>

/* What must hold of a picture that was read. */
static void check_picture(snow_image *image) {
    int width = snow_image_width(image), height = snow_image_height(image);
    snow_image_difference difference = {.size = sizeof difference};
    if (width < 1 || height < 1 || snow_image_channels(image) != 4)
        abort();
    snow_image_checksum(image); /* touches every pixel */
    if (snow_image_compare(image, image, &difference) == SNOW_STATUS_OK &&
        (difference.largest != 0 || difference.ssim != 1))
        abort();
}

/* Loads the bytes as a picture.  Stops the program when a failure comes
 * without a message of one line, or memory stays behind. */
static void look_at_picture(const uint8_t *bytes, size_t size) {
    size_t held;
    snow_context *context = capped_context(&held);
    snow_image *image = NULL;
    snow_status status =
        snow_image_load_memory(context, "input", bytes, size, &image);
    if (status == SNOW_STATUS_OK)
        check_picture(image);
    else if (image || !*snow_context_message(context) ||
             strchr(snow_context_message(context), '\n') ||
             (status != SNOW_STATUS_BAD_INPUT &&
              status != SNOW_STATUS_NO_MEMORY))
        abort();
    snow_image_free(image);
    capped_end(context, &held);
}

#endif
