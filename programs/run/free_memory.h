/* free_memory.h - how much memory this process could still take. */
#ifndef FREE_MEMORY_H
#define FREE_MEMORY_H

#include <stdint.h>

/* The bytes that the machine, the control groups (v2 and v1) and the address
 * limit (ulimit -v) leave, whichever leaves least; UINT64_MAX if nothing is
 * known. */
uint64_t free_memory(void);

#endif
