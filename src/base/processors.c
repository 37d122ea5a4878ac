/* base/processors.c - the number of processors this process may use: those of
 * its affinity, and at most the quotas of its control groups (cgroup v2 and
 * v1), rounded up. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "base/base.h"

#include <limits.h>
#include <sched.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define GROUPS "/sys/fs/cgroup"

/* Processors for a quota and its period in microseconds; 0: no limit. */
static int processors_of(long long quota, long long period) {
    if (quota <= 0 || period <= 0)
        return 0;
    long long whole = (quota + period - 1) / period;
    return whole < INT_MAX ? (int)whole : 0;
}

/* One number from a file; 0 if there is none. */
static long long number_in(const char *path) {
    long long number = 0;
    FILE *file = fopen(path, "r");
    if (!file)
        return 0;
    if (fscanf(file, "%lld", &number) != 1)
        number = 0;
    fclose(file);
    return number;
}

/* The quota of one v2 group: "150000 100000", or "max 100000". */
static int quota_of(const char *group) {
    char path[PATH_MAX];
    long long quota = 0, period = 0;
    snprintf(path, sizeof path, GROUPS "%s/cpu.max", group);
    FILE *file = fopen(path, "r");
    if (!file)
        return 0;
    int read = fscanf(file, "%lld %lld", &quota, &period);
    fclose(file);
    return read == 2 ? processors_of(quota, period) : 0;
}

static int lesser_limit(int a, int b) {
    return a == 0 || (b > 0 && b < a) ? b : a;
}

static int cgroup_limit(void) {
    char line[PATH_MAX + 8], own[PATH_MAX] = "";
    FILE *file = fopen("/proc/self/cgroup", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "0::/", 4) == 0) {
            line[strcspn(line, "\n")] = 0;
            snprintf(own, sizeof own, "%.*s", (int)sizeof own - 1, line + 3);
        }
    if (file)
        fclose(file);
    int old = processors_of(number_in(GROUPS "/cpu/cpu.cfs_quota_us"),
                            number_in(GROUPS "/cpu/cpu.cfs_period_us"));
    /* The limits of its parent groups apply to a group too. */
    int limit = quota_of("");
    while (*own) {
        limit = lesser_limit(limit, quota_of(own));
        char *end = strrchr(own, '/');
        *(end ? end : own) = 0;
    }
    return lesser_limit(limit, old);
}

/* The number of processors, if there are more than bits of a cpu_set_t. */
static int affinity(void) {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        return CPU_COUNT(&set);
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 0 && online < INT_MAX ? (int)online : 1;
}

int snow_processors(void) {
    int processors = affinity(), limit = cgroup_limit();
    return limit > 0 && limit < processors ? limit : processors;
}
