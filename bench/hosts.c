/* bench/hosts.c - machines are told apart by their names. */
#include "hosts.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct host_name {
    char text[64];
} host_name;

static void count(const host_name *names, int ranks, bench_hosts *out) {
    *out = (bench_hosts){0};
    for (int i = 0; i < ranks; i++) {
        int before = 0, here = 0;
        for (int other = 0; other < ranks; other++) {
            bool same = strcmp(names[other].text, names[i].text) == 0;
            before += same && other < i;
            here += same;
        }
        out->nodes += before == 0;
        out->node_ranks = here > out->node_ranks ? here : out->node_ranks;
    }
}

snow_status bench_hosts_count(snow_comm *comm, bench_hosts *out) {
    const int ranks = snow_comm_size(comm);
    host_name mine = {""};
    host_name *all = calloc((size_t)ranks, sizeof *all);
    gethostname(mine.text, sizeof mine.text - 1);
    snow_status status = snow_comm_agree_status(
        comm, all ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_allgather(comm, &mine, sizeof mine, all);
    if (status == SNOW_STATUS_OK)
        count(all, ranks, out);
    free(all);
    return status;
}
