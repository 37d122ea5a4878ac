/* bench/machine.h - what this machine can do, and whether it was ours alone. */
#ifndef SNOW_BENCH_MACHINE_H
#define SNOW_BENCH_MACHINE_H

#include <stdbool.h>
#include <stddef.h>

/* The bounds that a frame's time is set against. */
typedef struct machine_power {
    int threads;
    double read_bytes; /* read from memory, bytes a second */
    double flops;      /* fp32, a second; a multiply-add is two */
} machine_power;

/* Measures with that many threads, over `bytes` of memory; about half a second
 * for 512 MB.  False when memory or threads are refused. */
bool machine_measure(int threads, size_t bytes, machine_power *out);

/* What the measured FMA rate was measured with: "avx512", "avx2 fma", ... */
const char *machine_vectors(void);

/* The processor's name ("unknown" without /proc), to be copied at once. */
const char *machine_processor(void);

/* "gcc 12.2.0", "clang ...": what this program was compiled with. */
const char *machine_compiler(void);

/* The load average of the last minute, -1 when it cannot be told.  Our own
 * work counts in it. */
double machine_load(void);

/* A mark in time, to tell later what the rest of the machine did. */
typedef struct machine_mark {
    double wall, own, busy; /* seconds; busy: of all processors, all programs */
} machine_mark;

machine_mark machine_mark_now(void);

/* Processor seconds that other programs took since the mark, for each second
 * that passed: 1 is one processor.  -1 when it cannot be told. */
double machine_others(const machine_mark *since);

#endif
