/* memory.h - how much memory a picture needs, the limit of --memory and of the
 * machine, and what follows: the volume in memory, in its file, or not at all.
 */
#ifndef MEMORY_H
#define MEMORY_H

#include "options.h"

/* Bytes of a picture of one process. */
typedef struct memory_need {
    uint64_t least; /* voxels and picture */
    uint64_t most;  /* with all voxels interesting, about */
} memory_need;

memory_need memory_needed(const options *asked, const snow_volume_info *info);

/* How a volume is to be opened. */
typedef struct memory_plan {
    bool streams;        /* its voxels stay in the file (snow_volume_stream) */
    bool may_stream;     /* pictures like those that are asked for can be made
                            of it in that way */
    uint64_t slab_bytes; /* then */
    bool packed;         /* and all of the file is read for each slab */
    uint64_t limit;      /* of the context; 0: none */
} memory_plan;

/* Plans for a volume, and tells the need where `tell`.  What is over the limit
 * as a whole stays in its file; what is so even then is refused, before
 * anything large is allocated.  Without --memory the limit is what the machine
 * has free.  What the interesting voxels take is known only when they are
 * encoded; the context keeps that within the limit.  Nothing is known of
 * standard input.  Answers GO_ON or an exit code. */
int memory_plan_for(const options *asked, const char *path,
                    const snow_volume_options *data, bool tell,
                    memory_plan *out);

/* The same where all voxels are needed at once: refused is what is over
 * --memory as a whole. */
int memory_check(const options *asked, const char *path,
                 const snow_volume_options *data);

#endif
