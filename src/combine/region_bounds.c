/* combine/region_bounds.c - the partition of the picture into regions. */
#include "combine/region_bounds.h"
#include "base/minmax.h"

/* Counted regions are measured up to this number, which takes a microsecond. A
 * larger number of regions is small anyway. */
#define REGIONS_MEASURED 64

void snow_region_bounds_even(snow_region_bounds *bounds, int width, int height,
                             int grain) {
    bounds->width = width;
    bounds->height = height;
    bounds->grain = grain;
    bounds->counted = false;
    bounds->bins = height < SNOW_BINS_MOST ? height : SNOW_BINS_MOST;
}

int snow_region_bounds_line(const snow_region_bounds *bounds, int bin) {
    return (int)((int64_t)bounds->height * bin / bounds->bins);
}

/* Every pixel has a weight of at least 1 / (SNOW_IMAGE_REGION_MOST - 1) of the
 * mean count. All weights together are then at most SNOW_IMAGE_REGION_MOST
 * times the sum if all pixels had the least weight, so a counted region has at
 * most so many times the pixels of an even one. */
void snow_region_bounds_count(snow_region_bounds *bounds, int64_t *counts) {
    const int64_t pixels = (int64_t)bounds->width * bounds->height;
    int64_t sum = 0, before = 0;
    for (int i = 0; i < bounds->bins; i++)
        sum += counts[i];
    /* Weights are counted in sixteenths of a pixel, for sparse pictures. */
    int64_t lightest = 16 * sum / (pixels * (SNOW_IMAGE_REGION_MOST - 1)) + 1;
    for (int i = 0; i < bounds->bins; i++) {
        int64_t lines = snow_region_bounds_line(bounds, i + 1) -
                        snow_region_bounds_line(bounds, i);
        int64_t floor = lightest * lines * bounds->width;
        bounds->weights[i] = before;
        before += 16 * counts[i] > floor ? 16 * counts[i] : floor;
    }
    bounds->weights[bounds->bins] = before;
    bounds->counted = true;
}

/* The first pixel with `weight` before it. */
static int64_t weighed(const snow_region_bounds *bounds, int64_t weight) {
    int low =
        (int)snow_last_up_to(bounds->weights, 0, bounds->bins - 1, weight);
    int64_t first =
        (int64_t)snow_region_bounds_line(bounds, low) * bounds->width;
    int64_t end =
        (int64_t)snow_region_bounds_line(bounds, low + 1) * bounds->width;
    int64_t own = bounds->weights[low + 1] - bounds->weights[low];
    double part = (double)(weight - bounds->weights[low]) / (double)own;
    return first + (int64_t)(part * (double)(end - first));
}

int64_t snow_region_begin(const snow_region_bounds *bounds, int region,
                          int regions) {
    const int64_t pixels = (int64_t)bounds->width * bounds->height;
    if (region == regions)
        return pixels;
    if (!bounds->counted)
        return pixels / bounds->grain * region / regions * bounds->grain;
    int64_t sum = bounds->weights[bounds->bins];
    /* In two parts, since sum * region may overflow. */
    int64_t weight = sum / regions * region + sum % regions * region / regions;
    return weighed(bounds, weight) / bounds->grain * bounds->grain;
}

int64_t snow_region_capacity(const snow_region_bounds *bounds, int regions) {
    const int64_t pixels = (int64_t)bounds->width * bounds->height;
    int64_t even = pixels / regions + 1;
    if (!bounds->counted)
        return SNOW_MIN(pixels, even + bounds->grain);
    if (regions <= REGIONS_MEASURED) {
        int64_t most = 0, first = 0;
        for (int i = 1; i <= regions; i++) {
            int64_t end = snow_region_begin(bounds, i, regions);
            most = end - first > most ? end - first : most;
            first = end;
        }
        return most;
    }
    return SNOW_MIN(pixels, SNOW_IMAGE_REGION_MOST * even + 1 + bounds->grain);
}
