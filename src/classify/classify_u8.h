/* classify/classify_u8.h - finds the 8-bit voxels that are kept, 64 at a time.
 */
#ifndef SNOW_CLASSIFY_CLASSIFY_U8_H
#define SNOW_CLASSIFY_CLASSIFY_U8_H

#include "classify/classify.h"

/* The loop of an instruction set (resolved); NULL if it has none. */
snow_classify_u8_fn *snow_classify_u8_pick(snow_isa isa);

#endif
