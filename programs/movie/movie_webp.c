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
#include "picture/outputs.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILE_MOST 4294967294u /* bytes; sizes have 32 bits and are even */
#define FRAME_BYTES 16        /* of the header in ANMF */

static void put_number(unsigned char *out, int bytes, uint64_t value) {
    for (int i = 0; i < bytes; i++)
        out[i] = (unsigned char)(value >> 8 * i & 255);
}

/* Writes everything before the frames; the total size is filled in at the
 * end. */
static int write_header(int out, const webp_job *job) {
    unsigned char bytes[12 + 18 + 14] = {0};
    memcpy(bytes, "RIFF\0\0\0\0WEBPVP8X", 16);
    put_number(bytes + 16, 4, 10);
    bytes[20] = (unsigned char)(0x02 | (job->alpha ? 0x10 : 0));
    put_number(bytes + 24, 3, (uint64_t)job->width - 1);
    put_number(bytes + 27, 3, (uint64_t)job->height - 1);
    memcpy(bytes + 30, "ANIM", 4);
    put_number(bytes + 34, 4, 6);
    return write_bytes(out, bytes, sizeof bytes);
}

/* Reads all of an open file; returns 0 or an error number. */
static int read_bytes(int file, unsigned char *bytes, size_t size) {
    for (size_t done = 0; done < size;) {
        ssize_t got = read(file, bytes + done, size - done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return got < 0 ? errno : EIO;
        done += (size_t)got;
    }
    return 0;
}

/* Reads a frame's file into memory; returns 0 or an error number.  Free with
 * free(). */
static int read_file(const char *path, unsigned char **out, size_t *size) {
    struct stat about;
    int number = 0, file = open_bytes(path, O_RDONLY);
    if (file < 0)
        return errno;
    if (fstat(file, &about) != 0)
        number = errno;
    else if (about.st_size < 12)
        number = EIO;
    unsigned char *bytes = number ? NULL : malloc((size_t)about.st_size);
    if (!number)
        number =
            bytes ? read_bytes(file, bytes, (size_t)about.st_size) : ENOMEM;
    close(file);
    if (number) {
        free(bytes);
        return number;
    }
    *out = bytes;
    *size = (size_t)about.st_size;
    return 0;
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

static int write_frame(int out, const webp_job *job, int64_t index,
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
    int number = write_bytes(out, head, sizeof head);
    return number ? number : write_bytes(out, file + at, rest);
}

/* Chunk sizes are even, and so are the sizes of the files that they come
 * from. */
static int write_frames(int out, const webp_job *job, const movie_place *place,
                        uint64_t *total) {
    char path[PATH_MAX];
    int number = 0;
    for (int64_t i = 0; i < job->count && number == 0; i++) {
        size_t size = 0;
        unsigned char *file = NULL;
        number = place_frame(place, i, path, sizeof path)
                     ? read_file(path, &file, &size)
                     : ENAMETOOLONG;
        if (number)
            return number;
        *total += 8 + FRAME_BYTES + size - skip_header(file, size);
        number =
            *total <= FILE_MOST ? write_frame(out, job, i, file, size) : EFBIG;
        free(file);
    }
    return number;
}

int webp_join(const webp_job *job, const movie_place *place) {
    unsigned char size[4];
    uint64_t total = 12 + 18 + 14;
    int out = open_bytes(place->movie, O_WRONLY | O_CREAT | O_TRUNC);
    if (out < 0)
        return errno;
    int number = write_header(out, job);
    if (number == 0)
        number = write_frames(out, job, place, &total);
    put_number(size, 4, total - 8);
    if (number == 0)
        number = write_bytes_at(out, size, sizeof size, 4);
    int closing = close_bytes(out);
    return number ? number : closing;
}
