/* combine/borders.c - cuts of the picture into pieces. */
#include "combine/borders.h"

/* Counted pieces are measured up to so many; that takes a microsecond.  More of
 * them are small anyway. */
#define PIECES_MEASURED 64

static int64_t least(int64_t a, int64_t b) {
    return a < b ? a : b;
}

void snow_borders_even(snow_borders *borders, int width, int height,
                       int grain) {
    borders->width = width;
    borders->height = height;
    borders->grain = grain;
    borders->counted = false;
    borders->bins = height < SNOW_BINS_MOST ? height : SNOW_BINS_MOST;
}

int snow_borders_line(const snow_borders *borders, int bin) {
    return (int)((int64_t)borders->height * bin / borders->bins);
}

/* Every pixel weighs at least 1 / (SNOW_PIECE_MOST - 1) of the mean count.  All
 * weights together are then at most SNOW_PIECE_MOST times what they were if all
 * pixels had the least, and so are a piece's pixels against an even piece's. */
void snow_borders_count(snow_borders *borders, int64_t *counts) {
    const int64_t pixels = (int64_t)borders->width * borders->height;
    int64_t sum = 0, before = 0;
    for (int i = 0; i < borders->bins; i++)
        sum += counts[i];
    /* Weights are counted in sixteenths of a pixel, for sparse pictures. */
    int64_t lightest = 16 * sum / (pixels * (SNOW_PIECE_MOST - 1)) + 1;
    for (int i = 0; i < borders->bins; i++) {
        int64_t lines =
            snow_borders_line(borders, i + 1) - snow_borders_line(borders, i);
        int64_t floor = lightest * lines * borders->width;
        borders->weights[i] = before;
        before += 16 * counts[i] > floor ? 16 * counts[i] : floor;
    }
    borders->weights[borders->bins] = before;
    borders->counted = true;
}

/* The pixel that has so much weight before it. */
static int64_t weighed(const snow_borders *borders, int64_t weight) {
    int low = 0, high = borders->bins; /* weights[low] <= weight */
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (borders->weights[middle] <= weight)
            low = middle;
        else
            high = middle;
    }
    int64_t first = (int64_t)snow_borders_line(borders, low) * borders->width;
    int64_t end = (int64_t)snow_borders_line(borders, low + 1) * borders->width;
    int64_t own = borders->weights[low + 1] - borders->weights[low];
    double part = (double)(weight - borders->weights[low]) / (double)own;
    return first + (int64_t)(part * (double)(end - first));
}

int64_t snow_border(const snow_borders *borders, int piece, int pieces) {
    const int64_t pixels = (int64_t)borders->width * borders->height;
    if (piece == pieces)
        return pixels;
    if (!borders->counted)
        return pixels / borders->grain * piece / pieces * borders->grain;
    int64_t sum = borders->weights[borders->bins];
    /* In two parts, as sum * piece may not fit. */
    int64_t weight = sum / pieces * piece + sum % pieces * piece / pieces;
    return weighed(borders, weight) / borders->grain * borders->grain;
}

/* The pixels of the largest piece. */
static int64_t largest(const snow_borders *borders, int pieces) {
    int64_t most = 0, first = 0;
    for (int i = 1; i <= pieces; i++) {
        int64_t end = snow_border(borders, i, pieces);
        most = end - first > most ? end - first : most;
        first = end;
    }
    return most;
}

int64_t snow_border_room(const snow_borders *borders, int pieces) {
    const int64_t pixels = (int64_t)borders->width * borders->height;
    int64_t even = pixels / pieces + 1;
    if (!borders->counted)
        return least(pixels, even + borders->grain);
    if (pieces <= PIECES_MEASURED)
        return largest(borders, pieces);
    return least(pixels, SNOW_PIECE_MOST * even + 1 + borders->grain);
}

/* `number` of `bits` bits read backwards. */
static int64_t backwards(int64_t number, int bits) {
    int64_t out = 0;
    for (int i = 0; i < bits; i++)
        out |= (number >> i & 1) << (bits - 1 - i);
    return out;
}

void snow_order_lines(int *order, int height) {
    int bits = 0, place = 0;
    while (((int64_t)1 << bits) < height)
        bits++;
    for (int64_t i = 0; i < (int64_t)1 << bits; i++) {
        int64_t line = backwards(i, bits);
        if (line < height)
            order[place++] = (int)line;
    }
}
