/* memory.h - how much memory a picture needs, the limit of --memory and of the
 * machine, and the decision: the volume is held in memory, stays in its file,
 * or is refused. */
#ifndef MEMORY_H
#define MEMORY_H

#include "options/options.h"

/* Bytes of a picture made by one process. */
typedef struct memory_need {
    uint64_t least; /* voxels and picture */
    uint64_t most;  /* the same if all voxels are interesting, approximately */
} memory_need;

memory_need memory_needed(const options *opts, const snow_volume_info *info);

/* Whether the limit has room for slabs of `count` volumes of a file at once;
 * else `why` says what they need. */
bool memory_holds(const options *opts, const snow_volume_info *info, int count,
                  char *why, size_t size);

/* Whether the files of a folder are so small that their voxels certainly fit:
 * inspecting all of them twice would take time. */
bool memory_is_small_folder(const char *path);

/* How a volume is to be opened. */
typedef struct memory_plan {
    bool streams; /* the voxels stay in the file (snow_volume_open_streamed) */
    bool may_stream; /* the requested kind of picture can be made that way */
    uint64_t slab_bytes; /* if it streams */
    bool packed;         /* the file is unpacked again for each slab */
    uint64_t limit;      /* memory limit of the context; 0: none */
} memory_plan;

/* Plans how to open `count` volumes of a file (0: one) together; reports the
 * need if `report` is set.  A volume over the limit stays in its file.  One
 * that does not fit even so is refused, before anything large is allocated.
 * Without --memory the limit is what the machine has free.  The size of the
 * interesting voxels is known only after encoding; the context keeps it within
 * the limit.  Nothing is known about standard input.  Returns CONTINUE or an
 * exit code. */
int memory_plan_for(const options *opts, const char *path,
                    const snow_volume_options *data, int count, bool report,
                    memory_plan *out);

/* The same where all voxels are needed at once: refused is what is over
 * --memory as a whole. */
int memory_check(const options *opts, const char *path,
                 const snow_volume_options *data);

#endif
