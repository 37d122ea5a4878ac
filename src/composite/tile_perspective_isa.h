/* composite/tile_perspective_isa.h - the tile functions for one instruction
 * set, in perspective. Include simd/select.h first. */
#define RAY_CHANNELS 2
#define RAY_NAME(part) NAME(ray_tile2##part)
#include "composite/tile_perspective.tmpl.h"
#define RAY_CHANNELS 4
#define RAY_NAME(part) NAME(ray_tile4##part)
#include "composite/tile_perspective.tmpl.h"
