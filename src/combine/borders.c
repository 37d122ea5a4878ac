/* combine/borders.c - the partition of the picture into regions. */
#include "combine/borders.h"

/* Counted regions are measured up to this number, which takes a microsecond. A
 * larger number of regions is small anyway. */
#define REGIONS_MEASURED 64

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

/* Every pixel has a weight of at least 1 / (SNOW_IMAGE_REGION_MOST - 1) of the
 * mean count. All weights together are then at most SNOW_IMAGE_REGION_MOST
 * times the sum if all pixels had the least weight, so a counted region has at
 * most so many times the pixels of an even one. */
void snow_borders_count(snow_borders *borders, int64_t *counts) {
    const int64_t pixels = (int64_t)borders->width * borders->height;
    int64_t sum = 0, before = 0;
    for (int i = 0; i < borders->bins; i++)
        sum += counts[i];
    /* Weights are counted in sixteenths of a pixel, for sparse pictures. */
    int64_t lightest = 16 * sum / (pixels * (SNOW_IMAGE_REGION_MOST - 1)) + 1;
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

/* The first pixel with `weight` before it. */
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

int64_t snow_border(const snow_borders *borders, int region, int regions) {
    const int64_t pixels = (int64_t)borders->width * borders->height;
    if (region == regions)
        return pixels;
    if (!borders->counted)
        return pixels / borders->grain * region / regions * borders->grain;
    int64_t sum = borders->weights[borders->bins];
    /* In two parts, since sum * region may overflow. */
    int64_t weight = sum / regions * region + sum % regions * region / regions;
    return weighed(borders, weight) / borders->grain * borders->grain;
}

/* The pixels of the largest region. */
static int64_t largest(const snow_borders *borders, int regions) {
    int64_t most = 0, first = 0;
    for (int i = 1; i <= regions; i++) {
        int64_t end = snow_border(borders, i, regions);
        most = end - first > most ? end - first : most;
        first = end;
    }
    return most;
}

int64_t snow_border_room(const snow_borders *borders, int regions) {
    const int64_t pixels = (int64_t)borders->width * borders->height;
    int64_t even = pixels / regions + 1;
    if (!borders->counted)
        return least(pixels, even + borders->grain);
    if (regions <= REGIONS_MEASURED)
        return largest(borders, regions);
    return least(pixels, SNOW_IMAGE_REGION_MOST * even + 1 + borders->grain);
}

/* The lowest `bits` bits of `number`, reversed. */
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
