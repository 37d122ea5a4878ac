/* memory.h - how much memory a picture needs, and the limit of --memory. */
#ifndef MEMORY_H
#define MEMORY_H

#include "options.h"

/* Bytes of a picture of one process. */
typedef struct memory_need {
    uint64_t least; /* voxels and picture */
    uint64_t most;  /* with all voxels interesting, about */
} memory_need;

memory_need memory_needed(const options *asked, const snow_volume_info *info);

/* Tells what the picture of a volume needs where `tell`, and refuses
 * it where it is over the limit for certain: before anything large is
 * allocated.  What the interesting voxels take is known only when they are
 * encoded; the context keeps that within the limit.  Nothing is known of
 * standard input.  Answers GO_ON or an exit code. */
int memory_check(snow_context *context, const options *asked, const char *path,
                 const snow_volume_options *data, bool tell);

#endif
