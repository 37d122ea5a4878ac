/* bench/hosts.h - on how many machines the ranks of a benchmark run. */
#ifndef SNOW_BENCH_HOSTS_H
#define SNOW_BENCH_HOSTS_H

#include <snowglass/comm.h>

typedef struct bench_hosts {
    int nodes;      /* that have ranks */
    int node_ranks; /* the most that one has */
} bench_hosts;

/* Collective.  Errors: those of the transport, and SNOW_STATUS_NO_MEMORY,
 * agreed on.
 */
snow_status bench_hosts_count(snow_comm *comm, bench_hosts *out);

#endif
