/* combine/active.c - masks of active pixels, and compositing of masked pixels
 * without unpacking the inactive ones (see active.h).
 *
 * Over is that of composite/over.c, front += (1 - front.alpha) * back, with the
 * same operations on each float. Where the front is empty the result is the
 * back, exactly. */
#include "combine/active.h"

#include "simd/vec_scalar.h"

#include <string.h>

static int population(uint64_t bits) {
    return snow_scalar_popcount(bits);
}

/* --- the local image ------------------------------------------------------ */

/* Clips columns x0 .. x1 - 1 of line y to the drawn ones; none if x0 >= x1. */
static void clip(const snow_exchange_params *order, int y, int *x0, int *x1) {
    const snow_rectangle *drawn = &order->drawn;
    if (y < drawn->y0 || y >= drawn->y1)
        *x1 = *x0;
    if (*x0 < drawn->x0)
        *x0 = drawn->x0;
    if (*x1 > drawn->x1)
        *x1 = drawn->x1;
}

int64_t snow_active_scan(const snow_pixel_loops *loops,
                         const snow_exchange_params *order, int64_t first,
                         int64_t last, uint64_t *words, float *out,
                         int64_t *scanned) {
    const int64_t width = order->width;
    float *const begin = out;
    memset(words, 0, (size_t)snow_active_words(first, last) * sizeof *words);
    for (int64_t at = first; at < last;) {
        const int64_t zero = at / width * width;
        const int y = (int)(at / width);
        int x0 = (int)(at - zero);
        int x1 = (int)(last - zero < width ? last - zero : width);
        at = zero + x1;
        clip(order, y, &x0, &x1);
        if (x0 >= x1)
            continue;
        *scanned += x1 - x0;
        out = loops->scan(order->pixels + (size_t)y * order->stride +
                              (size_t)x0 * (size_t)order->channels,
                          zero + x0, x1 - x0,
                          words + ((zero + x0) / 64 - first / 64), out);
    }
    return (out - begin) / order->channels;
}

int64_t snow_active_in_line(const snow_pixel_loops *loops,
                            const snow_exchange_params *order, int y) {
    int x0 = 0, x1 = order->width;
    int64_t active = 0;
    clip(order, y, &x0, &x1);
    const float *line = order->pixels + (size_t)y * order->stride;
    for (int x = x0; x < x1; x += 64)
        active +=
            population(loops->look(line + (size_t)x * (size_t)order->channels,
                                   x1 - x < 64 ? x1 - x : 64));
    return active;
}

int64_t snow_active_count(const uint64_t *words, int64_t first, int64_t from,
                          int64_t to) {
    int64_t active = 0;
    for (int64_t i = from / 64; i * 64 < to; i++)
        active +=
            population(words[i - first / 64] & snow_active_range(i, from, to));
    return active;
}

/* --- messages ------------------------------------------------------------- */

/* The tail of a message. */
typedef struct tail {
    uint32_t first_word, words;
} tail;

size_t snow_active_capacity(int64_t count, size_t pixel_bytes) {
    return (size_t)count * pixel_bytes + (size_t)(count / 64 + 2) * 9 +
           sizeof(tail) + SNOW_PIXELS_SLACK;
}

/* The bytes of a word that are not 0, without a branch for each; one more may
 * be written behind. */
static unsigned char *pack_word(unsigned char *out, uint64_t word) {
    for (; word; word >>= 8) {
        *out = (unsigned char)(word & 255);
        out += (word & 255) != 0;
    }
    return out;
}

size_t snow_active_close(unsigned char *message, const uint64_t *words,
                         int64_t first, int64_t last, int64_t count,
                         size_t pixel_bytes) {
    if (!count)
        return 0;
    int64_t begin = 0, end = snow_active_words(first, last);
    while (!words[begin])
        begin++;
    while (!words[end - 1])
        end--;
    unsigned char *out = message + (size_t)count * pixel_bytes;
    for (int64_t i = begin; i < end; i++)
        out = pack_word(out, words[i]);
    /* A bit for each byte of a word that is not 0: the highest bit of each such
     * byte is set, and all of them are moved into one byte. */
    const uint64_t low = 0x7f7f7f7f7f7f7f7f;
    for (int64_t i = begin; i < end; i++) {
        uint64_t high = (((words[i] & low) + low) | words[i]) & ~low;
        *out++ = (unsigned char)((high >> 7) * 0x0102040810204080 >> 56);
    }
    tail last_bytes = {(uint32_t)(first / 64 + begin), (uint32_t)(end - begin)};
    memcpy(out, &last_bytes, sizeof last_bytes);
    return (size_t)(out - message) + sizeof last_bytes;
}

/* Unpacks words, whose bytes begin at `from`; returns the number of active
 * pixels. */
static int64_t unpack_words(const unsigned char *which, int64_t count,
                            const unsigned char *from, uint64_t *words) {
    int64_t active = 0;
    for (int64_t i = 0; i < count; i++) {
        uint64_t word = 0;
        if (which[i] == 255) {
            for (int k = 0; k < 8; k++)
                word |= (uint64_t)from[k] << (8 * k);
            from += 8;
        } else {
            for (unsigned bits = which[i]; bits; bits &= bits - 1)
                word |= (uint64_t)*from++ << (8 * __builtin_ctzll(bits));
        }
        words[i] = word;
        active += population(word);
    }
    return active;
}

bool snow_active_open(const unsigned char *message, size_t bytes, int64_t first,
                      int64_t last, size_t pixel_bytes, uint64_t *words,
                      snow_active *out) {
    const int64_t count = snow_active_words(first, last);
    tail end = {(uint32_t)(first / 64), 0};
    memset(words, 0, (size_t)count * sizeof *words);
    *out = (snow_active){
        .first = first, .last = last, .words = words, .at = first};
    if (!bytes)
        return true;
    if (bytes < sizeof end)
        return false;
    bytes -= sizeof end;
    memcpy(&end, message + bytes, sizeof end);
    if (end.first_word < first / 64 || end.words > bytes ||
        end.first_word + (int64_t)end.words > first / 64 + count)
        return false;
    bytes -= end.words;
    const unsigned char *which = message + bytes;
    size_t mask = 0; /* bytes of the packed mask */
    for (int64_t i = 0; i < end.words; i++)
        mask += (size_t)population(which[i]);
    if (mask > bytes)
        return false;
    int64_t active = unpack_words(which, end.words, which - mask,
                                  words + (end.first_word - first / 64));
    if ((size_t)active * pixel_bytes != bytes - mask)
        return false;
    out->pixels = out->next = (const float *)(const void *)message;
    return true;
}

/* --- layers --------------------------------------------------------------- */

/* Passes over the pixels of a layer before `first` that another thread has
 * merged. */
static void pass_over(snow_active *layer, int channels, int64_t first) {
    const int64_t to = first < layer->last ? first : layer->last;
    if (to <= layer->at)
        return;
    int64_t active =
        snow_active_count(layer->words, layer->first, layer->at, to);
    if (active)
        layer->next += active * channels;
}

int64_t snow_active_merge(const snow_pixel_loops *loops, snow_active *layers,
                          int count, int channels, int64_t first, int64_t last,
                          uint64_t *words, float *out, bool packed,
                          int64_t *laid) {
    for (int i = 0; i < count; i++)
        pass_over(&layers[i], channels, first);
    float *end =
        loops->merge(layers, count, first, last, words, out, packed, laid);
    for (int i = 0; i < count; i++)
        layers[i].at = last > layers[i].at ? last : layers[i].at;
    return (end - out) / channels;
}
