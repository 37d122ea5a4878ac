/* combine/active.h - runs of pixels of which only the active ones are stored.
 *
 * This is the paper's bit-map scheme (section 3.2.2) for images: a bit for each
 * pixel is set if it is active (any channel is not 0), and the active ones are
 * packed. A mask has a word for each 64 pixels, numbered from the picture's
 * first, so that the masks of all ranks are aligned wherever the picture is
 * divided.
 *
 * In a message the mask is itself a bit-map, of bytes that are not 0; empty
 * words at both ends are left out:
 *
 *   | active pixels | mask bytes, not 0 | a byte for each word: which | f | n |
 *
 * f: number of the first word, n: number of words. A message of no bytes has no
 * active pixel. So even short runs are cheap: random pixels, 3 of 10 active,
 * take 0.5 bytes each, 1 of 100 takes 2.4 bytes, long runs 0.15. */
#ifndef SNOW_ACTIVE_H
#define SNOW_ACTIVE_H

#include "combine/exchange.h"

/* Pixels first .. last - 1 of the combined image of one rank or one subset. */
typedef struct snow_active {
    int64_t first, last;
    const uint64_t *words; /* from that of `first` on */
    const float *pixels;   /* packed */
    const float *next;     /* first of the packed pixels from `at` on */
    bool own;              /* this rank's: not counted in *laid */
    int64_t at;            /* where merging goes on; at first `first` */
} snow_active;

/* Words of the mask of first .. last - 1. */
static inline int64_t snow_active_words(int64_t first, int64_t last) {
    return last > first ? (last - 1) / 64 - first / 64 + 1 : 0;
}

/* The bits of word `index` that belong to pixels first .. last - 1. */
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
    return layer->words[index - layer->first / 64] & range;
}

/* The most bytes of a message of `count` pixels, including those beyond it that
 * loops may access. */
size_t snow_active_capacity(int64_t count, size_t pixel_bytes);

/* Scans pixels first .. last - 1 of the local image: writes their mask to
 * `words` and the active ones to `out`; returns their number, and adds the
 * number of pixels examined to *scanned. */
int64_t snow_active_scan(const snow_pixel_loops *loops,
                         const snow_exchange_params *order, int64_t first,
                         int64_t last, uint64_t *words, float *out,
                         int64_t *scanned);

/* The number of active pixels in one line of the local image. */
int64_t snow_active_in_line(const snow_pixel_loops *loops,
                            const snow_exchange_params *order, int y);

/* The number of active pixels among from .. to - 1, by a mask whose first pixel
 * is `first`. */
int64_t snow_active_count(const uint64_t *words, int64_t first, int64_t from,
                          int64_t to);

/* Completes a message whose `count` pixels of pixel_bytes are already written;
 * returns its length. */
size_t snow_active_close(unsigned char *message, const uint64_t *words,
                         int64_t first, int64_t last, int64_t count,
                         size_t pixel_bytes);

/* The pixels of a message, with their mask unpacked into `words`. Returns false
 * if the message is invalid. */
bool snow_active_open(const unsigned char *message, size_t bytes, int64_t first,
                      int64_t last, size_t pixel_bytes, uint64_t *words,
                      snow_active *out);

/* Composites layers, ordered from front to back, in pixels first .. last - 1.
 * Call it for parts of the picture in rising order: layers keep their position.
 * Threads that merge different parts have copies of the layers. The result's
 * mask goes to `words`. With `packed`, its active pixels go to `out`; otherwise
 * all pixels do, number n to out[(n - first) * channels], 0 where no layer is.
 * Returns the number of pixels in `out`, and adds that of received layers to
 * *laid. */
int64_t snow_active_merge(const snow_pixel_loops *loops, snow_active *layers,
                          int count, int channels, int64_t first, int64_t last,
                          uint64_t *words, float *out, bool packed,
                          int64_t *laid);

#endif
