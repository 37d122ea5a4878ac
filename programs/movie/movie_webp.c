/* movie_webp.c - writes animated WebP: a container around the frames' own bytes
 * (Google, "WebP Container Specification").
 *
 *   RIFF size WEBP
 *     VP8X  flags: animation, alpha; width and height
 *     ANIM  no background; repeat for ever
 *     ANMF  of each frame: position, size, milliseconds, and the chunks of its
 *           file
 *
 * Frames are whole pictures that replace each other, compressed when they were
 * rendered.  So writing the movie is a copy and takes little memory. */
#include "movie/movie_webp.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILE_MOST 4294967294u /* bytes; sizes have 32 bits and are even */
#define FRAME_BYTES 16        /* of the header in ANMF */

static void put_number(unsigned char *out, int bytes, uint64_t value) {
    for (int i = 0; i < bytes; i++)
        out[i] = (unsigned char)(value >> 8 * i & 255);
}

static bool write_all(FILE *out, const void *bytes, size_t size) {
    return fwrite(bytes, 1, size, out) == size;
}

/* Writes everything before the frames; the total size is filled in at the
 * end. */
static bool write_header(FILE *out, const webp_job *job) {
    unsigned char bytes[12 + 18 + 14] = {0};
    memcpy(bytes, "RIFF\0\0\0\0WEBPVP8X", 16);
    put_number(bytes + 16, 4, 10);
    bytes[20] = (unsigned char)(0x02 | (job->alpha ? 0x10 : 0));
    put_number(bytes + 24, 3, (uint64_t)job->width - 1);
    put_number(bytes + 27, 3, (uint64_t)job->height - 1);
    memcpy(bytes + 30, "ANIM", 4);
    put_number(bytes + 34, 4, 6);
    return write_all(out, bytes, sizeof bytes);
}

/* Reads a frame's file into memory; NULL with errno.  Free with free(). */
static unsigned char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    if (!file)
        return NULL;
    long end = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    rewind(file);
    if (end >= 12 && (bytes = malloc((size_t)end)) &&
        fread(bytes, 1, (size_t)end, file) != (size_t)end) {
        free(bytes);
        bytes = NULL;
        errno = EIO;
    }
    if (end < 12)
        errno = EIO;
    *size = (size_t)end;
    fclose(file);
    return bytes;
}

/* The offset of a picture's own chunks: after RIFF, and VP8X if there is
 * one. */
static size_t skip_header(const unsigned char *bytes, size_t size) {
    size_t at = 12;
    if (size >= at + 18 && memcmp(bytes + at, "VP8X", 4) == 0)
        at += 8 + ((uint32_t)bytes[16] | (uint32_t)bytes[17] << 8 |
                   (uint32_t)bytes[18] << 16 | (uint32_t)bytes[19] << 24);
    return at < size ? at : size;
}

static bool write_frame(FILE *out, const webp_job *job, int64_t index,
                        const unsigned char *file, size_t size) {
    unsigned char head[8 + FRAME_BYTES] = {0};
    size_t at = skip_header(file, size), rest = size - at;
    memcpy(head, "ANMF", 4);
    put_number(head + 4, 4, FRAME_BYTES + rest);
    put_number(head + 14, 3, (uint64_t)job->width - 1);
    put_number(head + 17, 3, (uint64_t)job->height - 1);
    /* Durations are whole milliseconds and add up to the frame rate. */
    double from = (double)index * 1000 / job->rate;
    double to = (double)(index + 1) * 1000 / job->rate;
    double length = (double)((int64_t)(to + 0.5) - (int64_t)(from + 0.5));
    put_number(head + 20, 3,
               length < 1          ? 1
               : length > 0xFFFFFF ? 0xFFFFFF
                                   : (uint64_t)length);
    head[23] = 0x02; /* replaces the previous frame */
    return write_all(out, head, sizeof head) && write_all(out, file + at, rest);
}

/* Chunk sizes are even, and so are the sizes of the files that they come
 * from. */
static int write_frames(FILE *out, const webp_job *job,
                        const movie_place *place, uint64_t *total) {
    char path[PATH_MAX];
    for (int64_t i = 0; i < job->count; i++) {
        size_t size = 0;
        unsigned char *file = NULL;
        errno = ENAMETOOLONG;
        if (place_frame(place, i, path, sizeof path))
            file = read_file(path, &size);
        if (!file)
            return errno ? errno : EIO;
        *total += 8 + FRAME_BYTES + size - skip_header(file, size);
        bool good = *total <= FILE_MOST;
        errno = EFBIG;
        good = good && write_frame(out, job, i, file, size);
        int number = errno;
        free(file);
        if (!good)
            return number ? number : EIO;
    }
    return 0;
}

int webp_join(const webp_job *job, const movie_place *place) {
    unsigned char size[4];
    uint64_t total = 12 + 18 + 14;
    FILE *out = fopen(place->movie, "wb");
    if (!out)
        return errno;
    errno = 0;
    int number = write_header(out, job) ? 0 : errno ? errno : EIO;
    if (number == 0)
        number = write_frames(out, job, place, &total);
    put_number(size, 4, total - 8);
    errno = 0;
    if (number == 0 &&
        (fseek(out, 4, SEEK_SET) != 0 || !write_all(out, size, sizeof size)))
        number = errno ? errno : EIO;
    errno = 0;
    if (fclose(out) != 0 && number == 0)
        number = errno ? errno : EIO;
    return number;
}
