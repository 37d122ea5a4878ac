/* io/jpeg.h - JPEG files with libjpeg, for volumes and pictures: how they
 * begin, and libjpeg's errors.
 *
 * libjpeg allocates its own memory, which no context counts, and ends by a jump
 * when it fails. */
#ifndef SNOW_IO_JPEG_H
#define SNOW_IO_JPEG_H

#include "base/base.h"

#include <string.h>

/* Start of image, and the first byte of the next marker. */
static inline bool snow_jpeg_probe(const unsigned char *bytes, size_t size) {
    return size >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0;
}

#if SNOW_HAVE_JPEG

#include <setjmp.h>
#include <stdio.h>

#include <jpeglib.h>

/* A small progressive file may need all its coefficients in memory. */
#define SNOW_JPEG_COEFFICIENT_BYTES (1L << 30)

/* What libjpeg's callbacks need; `base` is first, so that they find it. */
typedef struct snow_jpeg_fault {
    struct jpeg_error_mgr base;
    jmp_buf out;
    char text[JMSG_LENGTH_MAX];
} snow_jpeg_fault;

static void snow_jpeg_leave(j_common_ptr info) {
    snow_jpeg_fault *fault = (snow_jpeg_fault *)info->err;
    info->err->format_message(info, fault->text);
    longjmp(fault->out, 1);
}

/* Warnings of damage count as errors, since half a picture is none. */
static void snow_jpeg_emit_message(j_common_ptr info, int level) {
    if (level < 0)
        snow_jpeg_leave(info);
}

static inline struct jpeg_error_mgr *
snow_jpeg_begin_faults(snow_jpeg_fault *fault) {
    jpeg_std_error(&fault->base);
    fault->base.error_exit = snow_jpeg_leave;
    fault->base.emit_message = snow_jpeg_emit_message;
    fault->text[0] = '\0';
    return &fault->base;
}

#endif
#endif
