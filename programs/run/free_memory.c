/* free_memory.c - reads the free memory from Linux: /proc/meminfo, the files of
 * control groups (Documentation/admin-guide/cgroup-v2.rst), and the limit of
 * the process.
 *
 * Files in the cache count as free, since the system drops them when memory is
 * needed.  On other systems nothing is known. */
#include "run/free_memory.h"

#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define GROUPS "/sys/fs/cgroup"

static uint64_t lesser(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

/* Reads the number after a key at the beginning of a line, or the only number
 * of the file if the key is "".  Returns false if there is none, as for
 * "max". */
static bool number_of(const char *path, const char *key, uint64_t *out) {
    char line[256];
    bool found = false;
    unsigned long long number;
    size_t length = strlen(key);
    FILE *file = fopen(path, "r");
    if (!file)
        return false;
    while (!found && fgets(line, sizeof line, file))
        found = strncmp(line, key, length) == 0 &&
                sscanf(line + length, "%llu", &number) == 1;
    fclose(file);
    if (found)
        *out = number;
    return found;
}

/* What the limit of a group leaves, from the group's files of these names. */
static uint64_t free_of_group(const char *folder, const char *group,
                              const char *limit_name, const char *used_name,
                              const char *cached_key) {
    char path[PATH_MAX];
    uint64_t limit, used = 0, cached = 0;
    snprintf(path, sizeof path, "%s%s/%s", folder, group, limit_name);
    if (!number_of(path, "", &limit))
        return UINT64_MAX;
    snprintf(path, sizeof path, "%s%s/%s", folder, group, used_name);
    number_of(path, "", &used);
    snprintf(path, sizeof path, "%s%s/memory.stat", folder, group);
    number_of(path, cached_key, &cached);
    used -= lesser(cached, used);
    return limit - lesser(used, limit);
}

static uint64_t free_of_either(const char *group) {
    return lesser(
        free_of_group(GROUPS, group, "memory.max", "memory.current",
                      "inactive_file"),
        free_of_group(GROUPS "/memory", group, "memory.limit_in_bytes",
                      "memory.usage_in_bytes", "total_inactive_file"));
}

/* The limits of all parent groups apply too. */
static uint64_t free_along(char *group) {
    uint64_t most = free_of_either("");
    group[strcspn(group, "\n")] = 0;
    while (*group) {
        most = lesser(most, free_of_either(group));
        char *end = strrchr(group, '/');
        *(end ? end : group) = 0;
    }
    return most;
}

/* Lines such as "0::/user.slice" and "9:memory:/docker/4f2a". */
static uint64_t free_of_groups(void) {
    char line[PATH_MAX];
    uint64_t most = free_of_either("");
    FILE *file = fopen("/proc/self/cgroup", "r");
    if (!file)
        return most;
    while (fgets(line, sizeof line, file)) {
        char *kind = strchr(line, ':');
        char *group = kind ? strchr(kind + 1, ':') : NULL;
        if (!group)
            continue;
        *group++ = 0;
        if (kind[1] == 0 || strstr(kind, "memory"))
            most = lesser(most, free_along(group));
    }
    fclose(file);
    return most;
}

static uint64_t free_addresses(void) {
    struct rlimit limit;
    uint64_t pages;
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return UINT64_MAX;
    if (!number_of("/proc/self/statm", "", &pages))
        pages = 0;
    uint64_t used = pages * (uint64_t)sysconf(_SC_PAGESIZE);
    return limit.rlim_cur - lesser(used, limit.rlim_cur);
}

uint64_t free_memory(void) {
    uint64_t kilobytes;
    return lesser(lesser(number_of("/proc/meminfo", "MemAvailable:", &kilobytes)
                             ? kilobytes * 1024
                             : UINT64_MAX,
                         free_of_groups()),
                  free_addresses());
}
