/* base/parallel.c - threads by OpenMP, the calling one included; and how many
 * this process may use.
 *
 * OpenMP's library is not built for the thread sanitizer, which therefore does
 * not see that a parallel region begins after what stands before it and ends
 * before what follows.  `fork_point` and `join_point` tell it; what two items
 * do to each other it sees by itself. */
#include "base/parallel.h"

#include <snowglass/snowglass.h>
#include <stdio.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#if defined(__SANITIZE_THREAD__)
#define SNOW_TSAN 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define SNOW_TSAN 1
#endif
#endif

#ifdef SNOW_TSAN
void __tsan_acquire(void *address);
void __tsan_release(void *address);
#define RELEASE(address) __tsan_release(address)
#define ACQUIRE(address) __tsan_acquire(address)
/* What a region shares is handed over before it can acquire anything. */
#define HANDS_OVER __attribute__((no_sanitize("thread")))
#else
#define RELEASE(address) (void)(address)
#define ACQUIRE(address) (void)(address)
#define HANDS_OVER
#endif

#ifdef _OPENMP
/* One thread's share of the items. */
static __attribute__((noinline)) void work_off(int64_t items,
                                               snow_work_fn *work, void *job) {
    int worker = omp_get_thread_num();
#pragma omp for schedule(dynamic, 1)
    for (int64_t item = 0; item < items; item++)
        work(job, item, worker);
}

HANDS_OVER void snow_parallel(int threads, int64_t items, snow_work_fn *work,
                              void *job) {
    if (threads > items)
        threads = (int)items;
    if (threads < 2) {
        for (int64_t item = 0; item < items; item++)
            work(job, item, 0);
        return;
    }
    char fork_point, join_point;
    RELEASE(&fork_point);
#pragma omp parallel num_threads(threads)
    {
        ACQUIRE(&fork_point);
        work_off(items, work, job);
        RELEASE(&join_point);
    }
    ACQUIRE(&join_point);
}
#else
void snow_parallel(int threads, int64_t items, snow_work_fn *work, void *job) {
    (void)threads;
    for (int64_t item = 0; item < items; item++)
        work(job, item, 0);
}
#endif

/* A group's processor quota of cgroup v2 ("max 100000", "150000 100000"),
 * rounded up; 0 when there is none. */
static int cgroup_quota(void) {
    FILE *file = fopen("/sys/fs/cgroup/cpu.max", "r");
    long long quota = 0, period = 0;
    if (!file)
        return 0;
    int read = fscanf(file, "%lld %lld", &quota, &period);
    fclose(file);
    if (read != 2 || quota <= 0 || period <= 0)
        return 0;
    long long whole = (quota + period - 1) / period;
    return whole < SNOW_THREADS_MOST ? (int)whole : SNOW_THREADS_MOST;
}

int snow_processors(void) {
#ifdef _OPENMP
    int processors = omp_get_num_procs(); /* those that affinity leaves */
#else
    int processors = 1;
#endif
    int quota = cgroup_quota();
    return quota > 0 && quota < processors ? quota : processors;
}
