/* classify/keep_bytes.h - which voxels of 8 bits are kept, 64 at a time. */
#ifndef SNOW_KEEP_BYTES_H
#define SNOW_KEEP_BYTES_H

#include "classify/classify.h"

/* The loop of a level (resolved); NULL where it has none. */
snow_keep_bytes_fn *snow_keep_bytes_pick(snow_isa isa);

#endif
