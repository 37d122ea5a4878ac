/* decompose/slab.h - slab decomposition (SD in figure 7, section 4): the
 * slices of a volume dealt out in runs, one run to each processor.  Knows only
 * sizes. */
#ifndef SNOW_SLAB_H
#define SNOW_SLAB_H

#include <stdint.h>

/* Slices first .. first + count - 1; count may be 0. */
typedef struct snow_slab {
    int64_t first, count;
} snow_slab;

/* Slab `part` (from 0) of `slices` slices cut into `parts` slabs that are as
 * equal as can be: their sizes differ by one at most, larger ones first. */
snow_slab snow_slab_equal(int64_t slices, int parts, int part);

#endif
