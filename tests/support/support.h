/* tests/support/support.h - what every test program starts with. */
#ifndef SNOW_TEST_SUPPORT_H
#define SNOW_TEST_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/base.h"

#include <snowglass/snowglass.h>

/* A context over malloc; the test fails when there is none. */
snow_context *support_context(void);

/* The path of a file of the real data, or NULL when it is absent: the test
 * then calls skip().  The string lasts until the next call. */
const char *support_data(const char *relative);

/* A deterministic generator for test data (xorshift64*): the next 64 bits,
 * and a double in [0, 1). */
uint64_t support_random(uint64_t *state);
double support_uniform(uint64_t *state);

/* --- tiers ------------------------------------------------------------------
 *
 * The environment variable SNOW_TIER says how long sweeps over many scenes are:
 * short (also where it is not set), long or release.  One program serves all.
 */

/* The step of a loop over scenes: `stride` in the short tier, else 1.  It
 * should have no divisor in common with the cycles that the loop's number
 * drives, so that each of their values still comes up. */
size_t support_stride(size_t stride);

/* Where the inner loop of two begins, so that with a stride the passes of the
 * outer one see different scenes: `outer` modulo the stride of this tier. */
size_t support_start(size_t outer, size_t stride);

/* `full`, or `brief` in the short tier: a count of repetitions, or a size. */
int64_t support_sweep(int64_t full, int64_t brief);

/* Whether what takes hours in all is done too. */
bool support_is_release(void);

/* Added to the seeds of scenes: the environment variable SNOW_SEED, 0 where it
 * is not set.  The release tier runs sweeps with several. */
uint64_t support_seed(void);

#endif
