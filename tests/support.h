/* tests/support.h - what every test program starts with. */
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

#endif
