/* composite/ray_tile_levels.h - the tile functions of one level in perspective;
 * simd/select.h's words are in force. */
#define RAY_CHANNELS 2
#define RAY_GATHER V(gather2)
#define RAY_ALPHA V(alpha2)
#define RAY_NAME(part) NAME(ray_tile2##part)
#include "composite/ray_tile.tmpl.h"
#define RAY_CHANNELS 4
#define RAY_GATHER V(gather4)
#define RAY_ALPHA V(alpha4)
#define RAY_NAME(part) NAME(ray_tile4##part)
#include "composite/ray_tile.tmpl.h"
