/* base/size.c - sizes that cannot overflow unseen, and the clocks. */
#include "base/base.h"

#include <time.h>

bool snow_mul_u64(uint64_t a, uint64_t b, uint64_t *out) {
    if (b && a > UINT64_MAX / b)
        return false;
    *out = a * b;
    return true;
}

bool snow_add_u64(uint64_t a, uint64_t b, uint64_t *out) {
    if (a > UINT64_MAX - b)
        return false;
    *out = a + b;
    return true;
}

static double seconds_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double snow_seconds(void) {
    return seconds_of(CLOCK_MONOTONIC);
}

double snow_cpu_seconds(void) {
    return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

double snow_thread_seconds(void) {
    return seconds_of(CLOCK_THREAD_CPUTIME_ID);
}
