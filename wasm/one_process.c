/* one_process.c - in the place of what many ranks do together (comm/, combine/,
 * parallel/, render/slice_groups.c).  A page has one process, which never comes
 * here, and the compiler leaves out what would. */
#include "combine/exchange.h"
#include "comm/comm.h"
#include "draw/identity.h"
#include "movie/movie_files.h"
#include "parallel/internal.h"
#include "render/picture.h"

#include <snowglass/comm.h>
#include <snowglass/extend.h>

#define NEVER(type, ...)  \
    type __VA_ARGS__ {    \
        __builtin_trap(); \
    }

#pragma GCC diagnostic ignored "-Wunused-parameter"

NEVER(int, snow_comm_rank(const snow_comm *comm))

NEVER(snow_status, snow_comm_agree_status(snow_comm *comm, snow_status status))

NEVER(snow_status,
      snow_comm_broadcast(snow_comm *comm, void *bytes, size_t count, int root))

NEVER(snow_status, snow_comm_reduce_ints(snow_comm *comm, int64_t *values,
                                         size_t count, snow_reduce by))

NEVER(snow_status, snow_comm_reduce_doubles(snow_comm *comm, double *values,
                                            size_t count, snow_reduce by))

NEVER(void, snow_comm_occupy(snow_comm *comm, snow_idle_fn *work, void *user))

NEVER(bool, snow_ranks_busy(const snow_ranks *ranks))

NEVER(bool,
      snow_group_rises(const snow_placement *placement, snow_group_node node))

/* Of no combiner. */
void snow_combiner_free(snow_combiner *combiner) {
    (void)combiner;
}

/* A page has one file, and no pattern of several. */
bool files_are_meant(const char *path) {
    (void)path;
    return false;
}

NEVER(int, steps_find(const options *opts, step_files *out))

void steps_free(step_files *files) {
    (void)files;
}

/* Files of the page are what they were when they were chosen. */
void identity_of(const char *path, char out[IDENTITY_BYTES]) {
    (void)path;
    *out = 0;
}

const char *identity_isa(void) {
    return "scalar";
}

const char *identity_of_program(void) {
    return "";
}
