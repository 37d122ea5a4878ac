/* bench/combine/combine_pattern.c - local images without a volume: a cube is
 * cut into slabs, each seen as the parallel projection of its box.
 *
 * Not all of a slab is interesting: pixels of its footprint are active at
 * random, each with probability 1 - (1 - fill)^(32 / slabs), so that of a slab
 * of a 32nd of the cube `fill` of the footprint is, and of a thinner one
 * accordingly less.  Random pixels are the hardest case for masks; --grain
 * makes runs of them. */
#include "combine.h"

#include <math.h>

static uint64_t mix(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/* --- the footprint -------------------------------------------------------- */

typedef struct corner {
    double x, y; /* in pixels */
} corner;

/* The eight corners of the slab, turned about the vertical axis and then
 * towards the eye. */
static void project(const combine_options *options, int slab, int slabs,
                    corner corners[8]) {
    const double turn = options->azimuth * acos(-1) / 180;
    const double tilt = options->elevation * acos(-1) / 180;
    const double side = options->cube * options->width;
    for (int i = 0; i < 8; i++) {
        double x = (i & 1) - 0.5, y = (i >> 1 & 1) - 0.5;
        double z = (double)(slab + (i >> 2)) / slabs - 0.5;
        double across = x * cos(turn) + z * sin(turn);
        double depth = z * cos(turn) - x * sin(turn);
        double up = y * cos(tilt) - depth * sin(tilt);
        corners[i] = (corner){0.5 * options->width + side * across,
                              0.5 * options->width - side * up};
    }
}

/* The columns whose middles lie in the hull, at the height of a line's middle:
 * the hull's edges are among the lines between any two corners. */
static void span_of(const corner corners[8], int y, int size, int out[2]) {
    double low = size, high = 0, at = y + 0.5;
    for (int a = 0; a < 8; a++)
        for (int b = 0; b < a; b++) {
            double from = corners[a].y, to = corners[b].y;
            if ((from > at) == (to > at))
                continue;
            double x = corners[a].x + (corners[b].x - corners[a].x) *
                                          (at - from) / (to - from);
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
    out[0] = (int)ceil(low - 0.5);
    out[1] = (int)ceil(high - 0.5);
    out[0] = out[0] > 0 ? out[0] : 0;
    out[1] = out[1] < size ? out[1] : size;
    if (out[1] < out[0])
        out[1] = out[0];
}

static void widen(snow_rectangle *drawn, int y, const int span[2]) {
    if (span[0] >= span[1])
        return;
    if (drawn->x0 >= drawn->x1)
        *drawn = (snow_rectangle){span[0], y, span[1], y + 1};
    drawn->x0 = span[0] < drawn->x0 ? span[0] : drawn->x0;
    drawn->x1 = span[1] > drawn->x1 ? span[1] : drawn->x1;
    drawn->y1 = y + 1;
}

void combine_pattern_make(const combine_options *options, int slab, int slabs,
                          int *spans, combine_pattern *out) {
    corner corners[8];
    double active = 1 - pow(1 - options->fill, 32.0 / slabs);
    *out = (combine_pattern){.width = options->width,
                             .height = options->height,
                             .channels = options->channels,
                             .slab = slab,
                             .slabs = slabs,
                             .grain = options->grain,
                             .threshold = (uint32_t)(65536 * active + 0.5),
                             .spans = spans};
    project(options, slab, slabs, corners);
    for (int y = 0; y < options->height; y++) {
        span_of(corners, y, options->width, spans + 2 * y);
        widen(&out->drawn, y, spans + 2 * y);
    }
}

/* --- pixels --------------------------------------------------------------- */

/* What all random numbers of a line have in common. */
static uint64_t line_of(const combine_pattern *pattern, int y) {
    return mix((uint64_t)pattern->slab * 0x9e3779b97f4a7c15u + (uint64_t)y);
}

/* The four bits of grains 4 * four .. 4 * four + 3, which share a number. */
static uint64_t four_bits(uint64_t line, int four, uint32_t threshold) {
    uint64_t number = mix(line + (uint64_t)four), bits = 0;
    for (int i = 0; i < 4; i++)
        bits |= (uint64_t)((number >> (16 * i) & 65535) < threshold) << i;
    return bits;
}

uint64_t combine_pattern_active(void *user, int y, int x, int count) {
    const combine_pattern *pattern = user;
    if (pattern->mask)
        return combine_file_active(pattern, y, x, count);
    const int *span = pattern->spans + 2 * y, grain = pattern->grain;
    const int from = x > span[0] ? x : span[0];
    const int to = x + count < span[1] ? x + count : span[1];
    const uint64_t line = line_of(pattern, y);
    uint64_t bits = 0;
    for (int at = from; at < to;) {
        int four = at / grain / 4;
        uint64_t some = four_bits(line, four, pattern->threshold);
        for (int end = (four + 1) * 4 * grain; at < end && at < to; at++)
            bits |= (some >> (at / grain % 4) & 1) << (at - x);
    }
    return bits;
}

void combine_pattern_pixel(const combine_pattern *pattern, int x, int y,
                           float *out) {
    const int last = pattern->channels - 1;
    if (pattern->mask) {
        combine_file_pixel(pattern, x, y, out);
        return;
    }
    for (int c = 0; c <= last; c++)
        out[c] = 0;
    /* The function has another's type, and changes nothing. */
    combine_pattern copy = *pattern;
    if (!combine_pattern_active(&copy, y, x, 1))
        return;
    uint64_t number = mix(line_of(pattern, y) ^ (uint64_t)x << 32);
    out[last] = 0.05f + 0.5f * (float)(number & 1023) / 1024;
    for (int c = 0; c < last; c++)
        out[c] = out[last] * (float)(number >> (10 + 10 * c) & 1023) / 1024;
}
