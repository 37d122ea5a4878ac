/* base/clear.h - large blocks: sets them to zeros (memory.c), and where their
 * memory comes from (context.c). */
#ifndef SNOW_BASE_CLEAR_H
#define SNOW_BASE_CLEAR_H

#include "base/base.h"

/* By the thread that called the library, which may end it: where memory is new,
 * the system gives it page by page, which takes long.  Errors:
 * SNOW_STATUS_STOPPED, with a part of it set. */
snow_status snow_clear(snow_context *context, void *block, size_t bytes);

/* Of a block that nothing was written to: the system gives its memory little by
 * little, where it is written to first. */
void snow_memory_by_pages(const snow_context *context, void *block,
                          size_t bytes);

#endif
