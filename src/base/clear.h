/* base/clear.h - sets large blocks to zeros (memory.c). */
#ifndef SNOW_BASE_CLEAR_H
#define SNOW_BASE_CLEAR_H

#include "base/base.h"

/* By the thread that called the library, which may end it: where memory is new,
 * the system gives it page by page, which takes long.  Errors:
 * SNOW_STATUS_STOPPED, with a part of it set. */
snow_status snow_clear(snow_context *context, void *block, size_t bytes);

#endif
