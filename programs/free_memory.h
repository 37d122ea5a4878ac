/* free_memory.h - how much memory this process could still take. */
#ifndef FREE_MEMORY_H
#define FREE_MEMORY_H

#include <stdint.h>

/* Bytes that the machine, the control groups (v2 and v1) and the limit of
 * addresses (ulimit -v) leave, whichever leaves least; UINT64_MAX where nothing
 * is known. */
uint64_t free_memory(void);

#endif
