/* composite/tile.c - the tile functions for all instruction sets. */
#include "composite/tile.h"

#include <string.h>

#define TEMPLATE "composite/tile_isa.h"
#include "simd/each_isa.h"

snow_tile_fn *snow_tile_of(snow_isa isa, int channels) {
    return channels == 2 ? SNOW_OF_ISA(isa, tile2) : SNOW_OF_ISA(isa, tile4);
}

void snow_tile_clear(float *pixels, size_t count, int channels) {
    size_t step = (size_t)channels;
    memset(pixels, 0, count * step * sizeof *pixels);
    for (size_t i = 0; i < count; i++)
        pixels[i * step + step - 1] = -1;
}

void snow_tile_finish(float *pixels, size_t count, int channels) {
    size_t step = (size_t)channels;
    for (size_t i = 0; i < count; i++)
        pixels[i * step + step - 1] += 1;
}
