/* decompose/slab.h - slab decomposition (SD in figure 7, section 4): divides
 * the slices of a volume into runs, one a processor. Needs sizes only. */
#ifndef SNOW_SLAB_H
#define SNOW_SLAB_H

#include <stdint.h>

/* Slices first .. first + count - 1; count may be 0. */
typedef struct snow_slab {
    int64_t first, count;
} snow_slab;

/* Slab `part` (from 0) of `slices` slices divided into `parts` slabs as equal
 * as possible: their sizes differ by at most one, larger ones first. */
snow_slab snow_slab_equal(int64_t slices, int parts, int part);

#endif
