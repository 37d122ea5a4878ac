/* base/clock.c - a steady clock, and processor time. */
#include "base/base.h"

#include <time.h>

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
