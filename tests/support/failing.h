/* tests/support/failing.h - an allocator that fails when it is told to. */
#ifndef SNOW_TEST_SUPPORT_FAILING_H
#define SNOW_TEST_SUPPORT_FAILING_H

#include "support/support.h"

/* Fails allocation number `failing` (from 0; below 0: none), or all from it
 * on, and blocks larger than `largest` where that is not 0. */
typedef struct support_failing {
    long failing;
    bool for_good;
    size_t largest;                    /* bytes */
    long allocations, held, most_held; /* so far */
} support_failing;

/* Functions over it, which has to outlive them. */
snow_allocator support_failing_allocator(support_failing *failing);

#endif
