/* tests/support/looks.h - looks of values in memory. */
#ifndef SNOW_TEST_SUPPORT_LOOKS_H
#define SNOW_TEST_SUPPORT_LOOKS_H

#include "support/support.h"

#include "transfer/look.h"

/* A volume over n values, along x, which have to outlive it. */
snow_volume *support_row(snow_context *context, snow_type type,
                         const void *values, int64_t n);

/* What a look makes of a volume; the test fails when it makes nothing. */
snow_transfer *support_look(const snow_volume *volume, snow_look look);

#endif
