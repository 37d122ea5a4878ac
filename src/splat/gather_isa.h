/* splat/gather_isa.h - the loops of splatting in gather form of one instruction
 * set.  Include simd/select.h first, and define WHOLE(word), the block of 16
 * floats; it is undefined at the end. */
#define GATHER_CHANNELS 2
#define LOCAL(word) NAME(grey_##word)
#define B(word) snow_b8_##word
#define BLOCK_VOXELS 4
#include "splat/gather.tmpl.h"
#define GATHER_CHANNELS 4
#define LOCAL(word) NAME(small_##word)
#define B(word) snow_b8_##word
#define BLOCK_VOXELS 2
#include "splat/gather.tmpl.h"
#define GATHER_CHANNELS 4
#define LOCAL(word) NAME(rgba_##word)
#define B(word) WHOLE(word)
#define BLOCK_VOXELS 4
#include "splat/gather.tmpl.h"
#undef WHOLE

static const gather_level NAME(level) = {NAME(grey_row), NAME(small_row),
                                         NAME(rgba_row)};
