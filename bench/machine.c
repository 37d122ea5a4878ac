/* bench/machine.c - the bounds of this machine: how fast memory is read and how
 * many multiply-adds it does, by one thread and by several; and whether other
 * programs were at work.
 *
 * Reading: every thread sums up its own part of one block of memory, all at
 * once, several passes; the best pass counts.  The block is far larger than
 * most caches; where it is not, the figure is that of the cache, as it is for a
 * volume of that size.  Multiply-adds: 12 independent chains of the widest
 * vectors, more than latency times ports asks for on any processor so far. */
#include "machine.h"

#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <immintrin.h>
#define WITH(level) __attribute__((target(level)))
#endif

#define PASSES 4       /* over the memory; the best counts */
#define CHAINS 12      /* of multiply-adds */
#define ROUNDS 2000000 /* of all chains, some milliseconds */
#define THREADS_MOST 256

static double seconds_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* --- the kernels ---------------------------------------------------------- */

/* Results go here, so that no compiler can leave out what makes them. */
static volatile uint64_t sink;
static volatile float float_sink;

/* Four sums hide the latency of an addition; compilers make vectors of it. */
#define READ_BODY                                 \
    uint64_t a = 0, b = 0, c = 0, d = 0;          \
    for (size_t i = 0; i + 32 <= count; i += 32)  \
        for (size_t k = i; k < i + 32; k += 4) {  \
            a += words[k], b += words[k + 1];     \
            c += words[k + 2], d += words[k + 3]; \
        }                                         \
    sink = a + b + c + d;

/* The values stay near 1: denormals and infinities would cost extra time. */
#define FMA_BODY(vector, set, fma, first)                  \
    vector sums[CHAINS], x = set(0.999f), y = set(0.001f); \
    for (int k = 0; k < CHAINS; k++)                       \
        sums[k] = set(1.0f + 0.01f * (float)k);            \
    for (int i = 0; i < ROUNDS; i++)                       \
        for (int k = 0; k < CHAINS; k++)                   \
            sums[k] = fma(sums[k], x, y);                  \
    float total = 0;                                       \
    for (int k = 0; k < CHAINS; k++)                       \
        total += first(sums[k]);                           \
    float_sink = total;

static void read_plain(const uint64_t *words, size_t count) {
    READ_BODY
}

typedef float plain4 __attribute__((vector_size(16)));

static plain4 plain_set(float value) {
    return (plain4){value, value, value, value};
}

static plain4 plain_fma(plain4 a, plain4 b, plain4 c) {
    return a * b + c;
}

static float plain_first(plain4 a) {
    return a[0];
}

static void fma_plain(void){FMA_BODY(plain4, plain_set, plain_fma, plain_first)}

#if defined(__x86_64__)
WITH("avx2") static void read_avx2(const uint64_t *words,
                                   size_t count){READ_BODY}

WITH("avx512f") static void read_avx512(const uint64_t *words,
                                        size_t count){READ_BODY}

WITH("avx2,fma") static void fma_avx2(void){
    FMA_BODY(__m256, _mm256_set1_ps, _mm256_fmadd_ps, _mm256_cvtss_f32)}

WITH("avx512f") static void fma_avx512(void) {
    FMA_BODY(__m512, _mm512_set1_ps, _mm512_fmadd_ps, _mm512_cvtss_f32)
}
#endif

typedef struct kernels {
    const char *name;
    int lanes;
    void (*read)(const uint64_t *words, size_t count);
    void (*fma)(void);
} kernels;

static kernels best_kernels(void) {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f"))
        return (kernels){"avx512", 16, read_avx512, fma_avx512};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return (kernels){"avx2 fma", 8, read_avx2, fma_avx2};
#endif
    return (kernels){"4 floats, multiply and add", 4, read_plain, fma_plain};
}

const char *machine_vectors(void) {
    return best_kernels().name;
}

/* --- threads -------------------------------------------------------------- */

/* All threads meet before each pass and after it, so that the time between,
 * which the first one takes, is that of the slowest. */
typedef struct thread_meeting {
    pthread_mutex_t start; /* held until it is known whether all came */
    bool all;
    pthread_barrier_t barrier;
} thread_meeting;

typedef struct part {
    pthread_t thread;
    thread_meeting *meeting;
    uint64_t *words;
    size_t count;
    double *read_seconds, *fma_seconds; /* NULL but for the first */
    kernels with;
} part;

static void *work(void *argument) {
    part *mine = argument;
    pthread_mutex_lock(&mine->meeting->start);
    bool all = mine->meeting->all;
    pthread_mutex_unlock(&mine->meeting->start);
    if (!all) /* the barrier would hold us for ever */
        return NULL;
    memset(mine->words, 1, mine->count * sizeof *mine->words);
    for (int pass = 0; pass < 2 * PASSES; pass++) {
        pthread_barrier_wait(&mine->meeting->barrier);
        double start = seconds_of(CLOCK_MONOTONIC);
        if (pass < PASSES)
            mine->with.read(mine->words, mine->count);
        else
            mine->with.fma();
        pthread_barrier_wait(&mine->meeting->barrier);
        double took = seconds_of(CLOCK_MONOTONIC) - start;
        double *best = pass < PASSES ? mine->read_seconds : mine->fma_seconds;
        if (best && took < *best)
            *best = took;
    }
    return NULL;
}

/* Runs the parts; the first one is the calling thread's. */
static bool run_parts(thread_meeting *meeting, part *parts, int threads) {
    int made = 1;
    pthread_mutex_lock(&meeting->start);
    while (made < threads &&
           pthread_create(&parts[made].thread, NULL, work, &parts[made]) == 0)
        made++;
    meeting->all = made == threads;
    pthread_mutex_unlock(&meeting->start);
    work(&parts[0]);
    for (int i = 1; i < made; i++)
        pthread_join(parts[i].thread, NULL);
    return meeting->all;
}

bool machine_measure(int threads, size_t bytes, machine_power *out) {
    part parts[THREADS_MOST];
    if (threads > THREADS_MOST)
        threads = THREADS_MOST;
    size_t count = bytes / sizeof(uint64_t) / (size_t)threads / 32 * 32;
    uint64_t *words = aligned_alloc(64, (size_t)threads * count * 8);
    thread_meeting meeting = {.start = PTHREAD_MUTEX_INITIALIZER};
    double read_seconds = 1e9, fma_seconds = 1e9;
    if (!words ||
        pthread_barrier_init(&meeting.barrier, NULL, (unsigned)threads)) {
        free(words);
        return false;
    }
    for (int i = 0; i < threads; i++)
        parts[i] = (part){.meeting = &meeting,
                          .words = words + (size_t)i * count,
                          .count = count,
                          .with = best_kernels()};
    parts[0].read_seconds = &read_seconds;
    parts[0].fma_seconds = &fma_seconds;
    bool done = run_parts(&meeting, parts, threads);
    pthread_barrier_destroy(&meeting.barrier);
    free(words);
    if (done)
        *out = (machine_power){
            threads, (double)threads * (double)count * 8 / read_seconds,
            2.0 * CHAINS * ROUNDS * parts[0].with.lanes * threads /
                fma_seconds};
    return done;
}

/* --- names and load ------------------------------------------------------- */

const char *machine_processor(void) {
    static char name[256];
    char line[256];
    snprintf(name, sizeof name, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "model name : %255[^\n]", name) == 1)
            break;
    if (file)
        fclose(file);
    return name;
}

const char *machine_compiler(void) {
#if defined(__clang__)
    return __VERSION__; /* says "Clang" itself */
#else
    return "gcc " __VERSION__;
#endif
}

double machine_load(void) {
    double load = -1;
    FILE *file = fopen("/proc/loadavg", "r");
    if (file && fscanf(file, "%lf", &load) != 1)
        load = -1;
    if (file)
        fclose(file);
    return load;
}

/* Of /proc/stat's first line: user, nice, system, (idle, iowait,) irq, softirq,
 * steal, in ticks. */
static double busy_seconds(void) {
    double t[8];
    FILE *file = fopen("/proc/stat", "r");
    int got = file ? fscanf(file, "cpu %lf %lf %lf %lf %lf %lf %lf %lf", t,
                            t + 1, t + 2, t + 3, t + 4, t + 5, t + 6, t + 7)
                   : 0;
    if (file)
        fclose(file);
    if (got != 8)
        return -1;
    return (t[0] + t[1] + t[2] + t[5] + t[6] + t[7]) /
           (double)sysconf(_SC_CLK_TCK);
}

machine_mark machine_mark_now(void) {
    return (machine_mark){seconds_of(CLOCK_MONOTONIC),
                          seconds_of(CLOCK_PROCESS_CPUTIME_ID), busy_seconds()};
}

double machine_others(const machine_mark *since) {
    machine_mark now = machine_mark_now();
    double wall = now.wall - since->wall;
    if (since->busy < 0 || now.busy < 0 || !(wall > 0))
        return -1;
    double others = (now.busy - since->busy) - (now.own - since->own);
    return others > 0 ? others / wall : 0; /* ticks are coarse */
}
