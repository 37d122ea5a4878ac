/* composite/tile_perspective.c - the tile functions for all instruction sets,
 * in perspective. */
#include "composite/tile_perspective.h"

#define TEMPLATE "composite/tile_perspective_isa.h"
#include "simd/each_isa.h"

snow_perspective_tile_fn *snow_perspective_tile_of(snow_isa isa, int channels) {
    return channels == 2 ? SNOW_OF_ISA(isa, ray_tile2)
                         : SNOW_OF_ISA(isa, ray_tile4);
}
