/* combine/active.h - runs of pixels of which only the active ones are there.
 *
 * The paper's bit-map scheme (section 3.2.2) once more, for pictures: a bit for
 * each pixel tells whether it is active (any channel is not 0), and the active
 * ones lie packed.  A mask is a word for each 64 pixels, numbered from the
 * picture's first, so that the masks of all ranks fit together wherever the
 * picture is cut.
 *
 * As a message, the mask is a bit-map in its turn, of bytes that are not 0;
 * empty words at both ends are left out:
 *
 *   | active pixels | bytes of the mask, not 0 | a byte for each word: which |
 * f | n |
 *
 * f: the first word's number, n: how many words.  A message of no bytes has no
 * active pixel.  So a run costs little however short: random pixels, 3 of 10
 * active, take 0.5 bytes each, 1 of 100 takes 2.4 bytes, long runs 0.15. */
#ifndef SNOW_ACTIVE_H
#define SNOW_ACTIVE_H

#include "combine/exchange.h"
#include "combine/pixels.h"

/* Pixels first .. last - 1 of the picture, all those of one rank's, or one
 * subset's, combined image. */
typedef struct snow_active {
    int64_t first, last;
    const uint64_t *words; /* the first is that of pixel `first`; NULL: all
                              pixels are active */
    const float *pixels;   /* packed; NULL: there are none (a rehearsal) */
    const float *next;     /* of pixels: the first that is not merged yet */
    bool own;              /* this rank's: not counted as laid */
} snow_active;

/* Words of the mask of first .. last - 1. */
static inline int64_t snow_active_words(int64_t first, int64_t last) {
    return last > first ? (last - 1) / 64 - first / 64 + 1 : 0;
}

/* The bits of word `index` that are pixels first .. last - 1. */
static inline uint64_t snow_active_range(int64_t index, int64_t first,
                                         int64_t last) {
    uint64_t bits = ~(uint64_t)0;
    if (first > index * 64)
        bits &= ~(uint64_t)0 << (first - index * 64);
    if (last < index * 64 + 64)
        bits &= ~(uint64_t)0 >> (index * 64 + 64 - last);
    return bits;
}

/* A layer's bits among `range` of word `index`. */
static inline uint64_t snow_active_bits(const snow_active *layer, int64_t index,
                                        uint64_t range) {
    if (index < layer->first / 64 || index > (layer->last - 1) / 64)
        return 0;
    uint64_t own = layer->words
                       ? layer->words[index - layer->first / 64]
                       : snow_active_range(index, layer->first, layer->last);
    return own & range;
}

/* Bytes that a message of `count` pixels may take, and what loops may touch
 * beyond them. */
size_t snow_active_room(int64_t count, size_t pixel_bytes);

/* Looks at pixels first .. last - 1 of the local image: their mask into
 * `words`, the active ones to `out` (not in a rehearsal); returns how many
 * there are, and adds to *scanned how many were looked at.  `lines` is the
 * order of lines, NULL for that of the picture.  When all pixels travel, all
 * are active and `words` is not written. */
int64_t snow_active_scan(const snow_pixel_loops *loops,
                         const snow_exchange_order *order, const int *lines,
                         int64_t first, int64_t last, uint64_t *words,
                         float *out, int64_t *scanned);

/* How many pixels of one line of the local image are active. */
int64_t snow_active_in_line(const snow_pixel_loops *loops,
                            const snow_exchange_order *order, int y);

/* How many of pixels from .. to - 1 are active by a mask whose first pixel is
 * `first`. */
int64_t snow_active_count(const uint64_t *words, int64_t first, int64_t from,
                          int64_t to);

/* Completes a message that begins with `count` pixels of pixel_bytes, which
 * are there already; returns its length. */
size_t snow_active_close(unsigned char *message, const uint64_t *words,
                         int64_t first, int64_t last, int64_t count,
                         size_t pixel_bytes);

/* The pixels of a message, with their mask unpacked into `words`.  False for
 * what is no such message. */
bool snow_active_open(const unsigned char *message, size_t bytes, int64_t first,
                      int64_t last, size_t pixel_bytes, uint64_t *words,
                      snow_active *out);

/* Lays layers over one another, ordered from front to back, in pixels first ..
 * last - 1.  Parts of the picture are asked for in rising order: layers
 * remember where they are.  Each layer lies inside what is asked for in all.
 * The result's mask goes to `words`.  With `packed`, its active pixels go to
 * `out`; else all pixels do, number n to out[(n - first) * channels], 0 where
 * no layer is.  In a rehearsal `out` is NULL.  Returns how many pixels
 * there are in `out`, or would be; adds to *laid how many pixels of layers that
 * came there were. */
int64_t snow_active_merge(const snow_pixel_loops *loops, snow_active *layers,
                          int count, int channels, int64_t first, int64_t last,
                          uint64_t *words, float *out, bool packed,
                          int64_t *laid);

#endif
