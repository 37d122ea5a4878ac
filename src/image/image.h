/* image/image.h - the inside of a picture, and the picture formats. */
#ifndef SNOW_IMAGE_H
#define SNOW_IMAGE_H

#include "base/base.h"
#include "base/source.h"
#include "base/writer.h"

#include <snowglass/image.h>

struct snow_image {
    snow_context *context;
    int width, height, channels;
    float *pixels; /* [(y * width + x) * channels] */
};

#endif
