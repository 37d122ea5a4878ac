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

/* Whether scene number `scene` of a sweep is drawn: of each `one_of` in a row
 * the short tier takes one, the long tier two, the release tier all.  Which
 * ones is said by the seed (support_seed), so that as many seeds meet every
 * scene. `one_of` should have no divisor in common with the cycles that the
 * number drives: then each of their values comes up with each seed. */
bool support_takes(size_t scene, size_t one_of);

/* Whether sanitizers look on: a third of these scenes is drawn, of which it is
 * not asked that they show something. */
bool support_is_sanitized(void);

/* The same for a number of ranks: the first four and `most` are always taken.
 */
bool support_takes_ranks(int ranks, int most);

/* The state of a generator for scene number `scene` of sweep number `sweep`, so
 * that a scene is the same whichever others are drawn. */
uint64_t support_scene_random(uint64_t sweep, size_t scene);

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

/* The environment variable SNOW_SEED, 0 where it is not set: it chooses the
 * scenes of sweeps.  The release tier draws all of them, and there it is added
 * to the seeds of voxels, for which it is 0 elsewhere: so the scenes of all
 * seeds are few enough to be drawn once before a sweep lands. */
uint64_t support_seed(void);
uint64_t support_voxel_seed(void);

#endif
