/* combine/active.c - masks of active pixels, and laying masked pixels over one
 * another without unpacking what is not active (see active.h).
 *
 * Over is that of composite/over.c, front += (1 - front.alpha) * back, with the
 * same operations on each float. */
#include "combine/active.h"

#include <string.h>

static int lowest(uint64_t bits) {
    return __builtin_ctzll(bits);
}

static int population(uint64_t bits) {
    return __builtin_popcountll(bits);
}

/* How many bits are set from `at` on, of which the lowest is. */
static int run_at(uint64_t bits, int at) {
    uint64_t rest = ~(bits >> at);
    return rest ? lowest(rest) : 64;
}

/* --- over ----------------------------------------------------------------- */

static void over_grey(float *restrict front, const float *restrict back,
                      int count) {
    for (int i = 0; i < count; i++) {
        float left = 1 - front[2 * i + 1];
        front[2 * i] += left * back[2 * i];
        front[2 * i + 1] += left * back[2 * i + 1];
    }
}

static void over_rgba(float *restrict front, const float *restrict back,
                      int count) {
    for (int i = 0; i < count; i++) {
        float left = 1 - front[4 * i + 3];
        for (int c = 0; c < 4; c++)
            front[4 * i + c] += left * back[4 * i + c];
    }
}

/* --- the local image ------------------------------------------------------ */

/* Whether a pixel has anything in it; -0 is nothing. */
static bool is_active(const float *pixel, int channels) {
    if (channels == 2)
        return pixel[0] != 0 || pixel[1] != 0;
    return pixel[0] != 0 || pixel[1] != 0 || pixel[2] != 0 || pixel[3] != 0;
}

/* The mask of `count` <= 64 pixels of line y from column x on, all drawn. */
static uint64_t look(const snow_exchange_order *order, int y, int x,
                     int count) {
    if (order->rehearsal)
        return order->rehearsal->active(order->rehearsal->user, y, x, count);
    const float *pixel = order->pixels + (size_t)y * order->stride +
                         (size_t)x * (size_t)order->channels;
    uint64_t bits = 0;
    for (int i = 0; i < count; i++, pixel += order->channels)
        bits |= (uint64_t)is_active(pixel, order->channels) << i;
    return bits;
}

/* Appends the pixels of line y from column x on whose bits are set. */
static float *pack(const snow_exchange_order *order, int y, int x,
                   uint64_t bits, float *out) {
    const size_t channels = (size_t)order->channels;
    const float *line =
        order->pixels + (size_t)y * order->stride + (size_t)x * channels;
    while (bits) {
        int at = lowest(bits), count = run_at(bits, at);
        memcpy(out, line + (size_t)at * channels,
               (size_t)count * channels * sizeof *out);
        out += (size_t)count * channels;
        bits &= at + count < 64 ? ~(uint64_t)0 << (at + count) : 0;
    }
    return out;
}

/* The drawn columns of line y among x0 .. x1 - 1; none where x0 >= x1. */
static void clip(const snow_exchange_order *order, int y, int *x0, int *x1) {
    const snow_rectangle *drawn = &order->drawn;
    if (y < drawn->y0 || y >= drawn->y1)
        *x1 = *x0;
    if (*x0 < drawn->x0)
        *x0 = drawn->x0;
    if (*x1 > drawn->x1)
        *x1 = drawn->x1;
}

/* Columns x0 .. x1 - 1 of line y, all drawn; column 0 is pixel `zero` of the
 * picture. */
static float *scan_line(const snow_exchange_order *order, int y, int64_t zero,
                        int x0, int x1, uint64_t *words, int64_t first_word,
                        float *out, int64_t *active) {
    for (int x = x0; x < x1;) {
        int64_t at = zero + x;
        int count = 64 - (int)(at % 64);
        if (count > x1 - x)
            count = x1 - x;
        uint64_t bits = look(order, y, x, count);
        words[at / 64 - first_word] |= bits << (at % 64);
        *active += population(bits);
        if (!order->rehearsal)
            out = pack(order, y, x, bits, out);
        x += count;
    }
    return out;
}

/* All of columns x0 .. x1 - 1 of line y, drawn or not. */
static float *copy_line(const snow_exchange_order *order, int y, int x0, int x1,
                        float *out) {
    const size_t channels = (size_t)order->channels;
    int from = x0, to = x1;
    clip(order, y, &from, &to);
    memset(out, 0, (size_t)(x1 - x0) * channels * sizeof *out);
    if (from < to)
        memcpy(out + (size_t)(from - x0) * channels,
               order->pixels + (size_t)y * order->stride +
                   (size_t)from * channels,
               (size_t)(to - from) * channels * sizeof *out);
    return out + (size_t)(x1 - x0) * channels;
}

int64_t snow_active_scan(const snow_exchange_order *order, const int *lines,
                         int64_t first, int64_t last, uint64_t *words,
                         float *out, int64_t *scanned) {
    const int64_t width = order->width;
    int64_t active = 0;
    if (order->whole && order->rehearsal)
        return last - first;
    if (!order->whole)
        memset(words, 0,
               (size_t)snow_active_words(first, last) * sizeof *words);
    for (int64_t at = first; at < last;) {
        const int64_t zero = at / width * width;
        const int y = lines ? lines[at / width] : (int)(at / width);
        int x0 = (int)(at - zero);
        int x1 = (int)(last - zero < width ? last - zero : width);
        at = zero + x1;
        if (order->whole) {
            out = copy_line(order, y, x0, x1, out);
            continue;
        }
        clip(order, y, &x0, &x1);
        if (x0 >= x1)
            continue;
        *scanned += x1 - x0;
        out =
            scan_line(order, y, zero, x0, x1, words, first / 64, out, &active);
    }
    return order->whole ? last - first : active;
}

int64_t snow_active_in_line(const snow_exchange_order *order, int y) {
    int x0 = 0, x1 = order->width;
    int64_t active = 0;
    clip(order, y, &x0, &x1);
    for (int x = x0; x < x1; x += 64)
        active += population(look(order, y, x, x1 - x < 64 ? x1 - x : 64));
    return active;
}

/* --- messages ------------------------------------------------------------- */

/* The end of a message. */
typedef struct tail {
    uint32_t first_word, words;
} tail;

size_t snow_active_room(int64_t count, size_t pixel_bytes) {
    return (size_t)count * pixel_bytes + (size_t)(count / 64 + 2) * 9 +
           sizeof(tail);
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
        for (uint64_t word = words[i]; word; word >>= 8)
            if (word & 255)
                *out++ = (unsigned char)(word & 255);
    for (int64_t i = begin; i < end; i++) {
        unsigned which = 0;
        for (int byte = 0; byte < 8; byte++)
            which |= (unsigned)((words[i] >> (8 * byte) & 255) != 0) << byte;
        *out++ = (unsigned char)which;
    }
    tail last_bytes = {(uint32_t)(first / 64 + begin), (uint32_t)(end - begin)};
    memcpy(out, &last_bytes, sizeof last_bytes);
    return (size_t)(out - message) + sizeof last_bytes;
}

/* Unpacks `count` words; their bytes, of which there are `bytes`, end before
 * `which`.  Returns how many pixels are active, -1 where bytes are missing. */
static int64_t unpack_words(const unsigned char *which, int64_t count,
                            size_t room, uint64_t *words) {
    size_t bytes = 0;
    int64_t active = 0;
    for (int64_t i = 0; i < count; i++)
        bytes += (size_t)population(which[i]);
    if (bytes > room)
        return -1;
    const unsigned char *from = which - bytes;
    for (int64_t i = 0; i < count; i++) {
        uint64_t word = 0;
        for (unsigned bits = which[i]; bits; bits &= bits - 1)
            word |= (uint64_t)*from++ << (8 * lowest(bits));
        words[i] = word;
        active += population(word);
    }
    return active;
}

/* Bytes of the packed mask. */
static size_t mask_bytes(const unsigned char *which, int64_t count) {
    size_t bytes = (size_t)count;
    for (int64_t i = 0; i < count; i++)
        bytes += (size_t)population(which[i]);
    return bytes;
}

bool snow_active_open(const unsigned char *message, size_t bytes, int64_t first,
                      int64_t last, size_t pixel_bytes, uint64_t *words,
                      snow_active *out) {
    const int64_t count = snow_active_words(first, last);
    tail end = {(uint32_t)(first / 64), 0};
    memset(words, 0, (size_t)count * sizeof *words);
    *out = (snow_active){.first = first, .last = last, .words = words};
    if (!bytes)
        return true;
    if (bytes < sizeof end)
        return false;
    bytes -= sizeof end;
    memcpy(&end, message + bytes, sizeof end);
    if (end.first_word < first / 64 || end.words > bytes ||
        end.first_word + (int64_t)end.words > first / 64 + count)
        return false;
    const unsigned char *which = message + bytes - end.words;
    int64_t active = unpack_words(which, end.words, bytes - end.words,
                                  words + (end.first_word - first / 64));
    size_t mask = mask_bytes(which, end.words);
    if (active < 0 || (size_t)active * pixel_bytes != bytes - mask)
        return false;
    out->pixels = out->next = (const float *)(const void *)message;
    return true;
}

/* --- layers --------------------------------------------------------------- */

/* A layer's bits among `range` of word `index`. */
static uint64_t bits_of(const snow_active *layer, int64_t index,
                        uint64_t range) {
    if (index < layer->first / 64 || index > (layer->last - 1) / 64)
        return 0;
    uint64_t own = layer->words
                       ? layer->words[index - layer->first / 64]
                       : snow_active_range(index, layer->first, layer->last);
    return own & range;
}

/* Lays the next pixels of a layer, those of `bits`, behind what `tile` holds;
 * its pixels are there where `seen`. */
static void lay_bits(snow_active *layer, uint64_t bits, uint64_t seen,
                     int channels, float *tile) {
    while (bits) {
        int at = lowest(bits), count = run_at(bits, at);
        bool behind = seen >> at & 1;
        int same = run_at(behind ? seen : ~seen, at);
        if (same < count)
            count = same;
        float *front = tile + at * channels;
        if (!behind)
            memcpy(front, layer->next,
                   (size_t)(count * channels) * sizeof *front);
        else if (channels == 2)
            over_grey(front, layer->next, count);
        else
            over_rgba(front, layer->next, count);
        layer->next += count * channels;
        bits &= at + count < 64 ? ~(uint64_t)0 << (at + count) : 0;
    }
}

/* All layers of a word; the mask of the result. */
static uint64_t lay_word(snow_active *layers, int count, int channels,
                         int64_t index, uint64_t range, float *tile,
                         int64_t *laid) {
    uint64_t seen = 0;
    for (int i = 0; i < count; i++) {
        uint64_t bits = bits_of(&layers[i], index, range);
        if (!bits)
            continue;
        if (!layers[i].own)
            *laid += population(bits);
        if (layers[i].pixels)
            lay_bits(&layers[i], bits, seen, channels, tile);
        seen |= bits;
    }
    return seen;
}

/* Appends the pixels of `bits`. */
static float *append(float *out, const float *tile, uint64_t bits,
                     int channels) {
    while (bits) {
        int at = lowest(bits), count = run_at(bits, at);
        memcpy(out, tile + at * channels,
               (size_t)(count * channels) * sizeof *out);
        out += count * channels;
        bits &= at + count < 64 ? ~(uint64_t)0 << (at + count) : 0;
    }
    return out;
}

int64_t snow_active_merge(snow_active *layers, int count, int channels,
                          int64_t first, int64_t last, uint64_t *words,
                          float *out, int64_t *laid) {
    float tile[64 * 4];
    int64_t active = 0;
    for (int64_t i = first / 64; i * 64 < last; i++) {
        uint64_t range = snow_active_range(i, first, last);
        uint64_t seen = lay_word(layers, count, channels, i, range, tile, laid);
        words[i - first / 64] = seen;
        active += population(seen);
        if (out)
            out = append(out, tile, seen, channels);
    }
    return active;
}

int64_t snow_active_lay(snow_active *layers, int count, int channels,
                        int64_t first, int64_t last, uint64_t *words,
                        float *out, int64_t *laid) {
    float tile[64 * 4];
    int64_t active = 0;
    for (int64_t i = first / 64; i * 64 < last; i++) {
        uint64_t range = snow_active_range(i, first, last);
        uint64_t seen = lay_word(layers, count, channels, i, range, tile, laid);
        words[i - first / 64] = seen;
        active += population(seen);
        while (out && seen) {
            int at = lowest(seen), run = run_at(seen, at);
            memcpy(out + (i * 64 + at - first) * channels, tile + at * channels,
                   (size_t)(run * channels) * sizeof *out);
            seen &= at + run < 64 ? ~(uint64_t)0 << (at + run) : 0;
        }
    }
    return active;
}
