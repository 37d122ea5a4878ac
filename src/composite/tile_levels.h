/* composite/tile_levels.h - the tile functions of one level; simd/select.h's
 * words are in force. */
#define TILE_CHANNELS 2
#define TILE_WEAVE V(weave2)
#define TILE_EVENS V(evens2)
#define TILE_ALPHA V(alpha2)
#define TILE_NAME(part) NAME(tile2##part)
#include "composite/tile.tmpl.h"
#define TILE_CHANNELS 4
#define TILE_WEAVE V(weave4)
#define TILE_EVENS V(evens4)
#define TILE_ALPHA V(alpha4)
#define TILE_NAME(part) NAME(tile4##part)
#include "composite/tile.tmpl.h"
