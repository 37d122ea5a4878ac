/* volume/gdcm_bridge.h - what the C side sees of GDCM: a file's values by
 * their tags, and its decoded pixels.
 *
 * Nothing here knows what a value means; the DICOM reader's C files do.  No
 * exception leaves these functions, and nothing is printed. */
#ifndef SNOW_GDCM_BRIDGE_H
#define SNOW_GDCM_BRIDGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A file's bytes in any order; `read` copies up to `size` from `from` on and
 * returns how many there were.  Outlives what is opened with it. */
typedef struct gdcm_bytes {
    size_t (*read)(void *user, uint64_t from, void *bytes, size_t size);
    void *user;
    uint64_t size;
} gdcm_bytes;

typedef struct gdcm_file gdcm_file;

/* Parses a file: up to its pixels, or with them.  NULL when it cannot be, and
 * where memory ends.  Close with snow_gdcm_close. */
gdcm_file *snow_gdcm_open(const gdcm_bytes *bytes, bool pixels);
void snow_gdcm_close(gdcm_file *file);

/* Where a value is: a tag (group << 16 | element), of the file itself, or of
 * the first item of a sequence.  A sequence is looked for among the functional
 * groups of a frame (from 0), then among those that all frames share, then in
 * the file itself. */
typedef struct gdcm_place {
    int64_t frame;
    uint32_t sequence; /* 0: none */
    uint32_t tag;
} gdcm_place;

/* Copies up to `room` bytes of a value, numbers in the machine's byte order,
 * into `out`; returns how many, 0 where there is no such value. */
size_t snow_gdcm_value(gdcm_file *file, gdcm_place place, void *out,
                       size_t room);

/* What the pixels are like once decoded. */
typedef struct gdcm_pixels {
    int64_t columns, rows, frames;
    int samples; /* values of a pixel */
    bool planes; /* one plane for each of them, not side by side */
    int allocated, stored, high; /* bits; the highest one stored, from 0 */
    bool is_signed;
    char photometric[17];
    uint64_t bytes; /* of all frames; in the machine's byte order */
} gdcm_pixels;

/* Of a file that was opened with its pixels; false when it has none that can
 * be read. */
bool snow_gdcm_describe(gdcm_file *file, gdcm_pixels *out);

/* Decodes all frames into `out`, which has room for the bytes described.  False
 * when the codec fails, or fewer bytes are there. */
bool snow_gdcm_decode(gdcm_file *file, void *out);

#ifdef __cplusplus
}
#endif
#endif
