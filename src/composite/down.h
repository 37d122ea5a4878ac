/* composite/down.h - the second half of the sheared method's splatting, and
 * composition, in one pass (R and Cp in figure 7): rows that were filtered
 * along u are weighted and added up along v to one line of a sheet, which is
 * laid behind the intermediate image's line while it is still in registers. */
#ifndef SNOW_DOWN_H
#define SNOW_DOWN_H

#include "splat/across.h"

/* What may still shine through a pixel where a chunk is given up: half a step
 * of an 8-bit picture.  All that lies behind changes it by less. */
#define SNOW_OPAQUE_ENOUGH (0.5f / 255)

/* One line: rows[m] weighted by weights[m], m = 0 .. taps - 1.  Of each chunk
 * in the mask all rows are valid.  A chunk all of whose pixels are opaque
 * enough loses its bit in `alive`, and is not touched again; true when one did.
 */
typedef bool snow_down_fn(float *line, const float *const *rows,
                          const float *weights, int taps, const uint64_t *mask,
                          size_t words, uint64_t *alive);

/* The function of a level, for 2 or 4 channels. */
snow_down_fn *snow_down_of(snow_isa isa, int channels);

#endif
