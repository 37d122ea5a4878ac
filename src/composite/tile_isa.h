/* composite/tile_isa.h - the tile functions for one instruction set. Include
 * simd/select.h first. */
#define TILE_CHANNELS 2
#define TILE_NAME(part) NAME(tile2##part)
#include "composite/tile.tmpl.h"
#define TILE_CHANNELS 4
#define TILE_NAME(part) NAME(tile4##part)
#include "composite/tile.tmpl.h"
