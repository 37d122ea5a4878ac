/* bench/tables/figures.h - figures 11 and 12 of the paper: speed-ups on 1 to 32
 * nodes.
 */
#ifndef SNOW_BENCH_FIGURES_H
#define SNOW_BENCH_FIGURES_H

#include "bench.h"
#include "simulated_network.h"

#include <snowglass/comm.h>
#include <snowglass/ranks.h>

#define FIGURE_NODES 6    /* 1 2 4 8 16 32 */
#define FIGURE_VOLUMES 2  /* head, engine */
#define FIGURE_CLUSTERS 3 /* below */
#define FIGURE_WAYS 4     /* original and the three encodings */

/* A machine that the nodes are simulated as, and how it combines. */
typedef struct figure_cluster {
    const char *name, *text;
    snow_network network; /* slowness 0: from the paper's seconds */
    snow_partition cut;
    snow_combine combining;
} figure_cluster;

extern const figure_cluster figure_clusters[FIGURE_CLUSTERS];
extern const int figure_nodes[FIGURE_NODES];
extern const bench_way figure_ways[FIGURE_WAYS];
extern const char *const figure_way_names[FIGURE_WAYS];

/* Seconds of a picture; of them, those of the slowest node's local image and of
 * the mean one, encoding included. */
typedef struct figure_time {
    double seconds, slowest, mean;
} figure_time;

typedef struct figure_times {
    const char *source;
    double sparse_ratio;
    double slowness[FIGURE_CLUSTERS];
    /* Of a picture, encoding and combining included: the least. */
    figure_time taken[FIGURE_CLUSTERS][FIGURE_WAYS][FIGURE_NODES];
    double largest; /* difference from the picture of one node, all cases */
} figure_times;

/* Of the paper's Table 2, threshold 30. */
typedef struct figure_volume {
    bench_set set;
    const char *label;
    double threshold, paper_seconds; /* original splatting, one node */
} figure_volume;

extern const figure_volume figure_volumes[FIGURE_VOLUMES];

/* Speed-up: T_1 of the original (figure 11) or of the way itself (figure 12)
 * over T_n. */
double figure_speedup(const figure_times *times, int figure, int cluster,
                      int way, int nodes);

/* How far a figure is: runs by way. */
typedef struct figure_progress {
    int figure;
    double begin, told; /* seconds; told 0: nothing yet */
    int left[FIGURE_WAYS], done[FIGURE_WAYS];
    double seconds[FIGURE_WAYS]; /* of those that are done */
} figure_progress;

void figure_progress_begin(figure_progress *p, int figure, int runs);

/* Seconds of a clock. */
double figure_progress_clock(void);

/* A run has ended; says so at times, on stderr. */
void figure_progress_step(figure_progress *p, int way, double seconds,
                          const char *what, int nodes);
double figure_progress_left(const figure_progress *p);
void figure_progress_end(const figure_progress *p);

/* The table on stdout, or JSON; and the chart. */
void figure_print(const bench_options *options, int figure,
                  const figure_times *times);
int figure_print_json(const bench_options *options, int figure,
                      const figure_times *times);
snow_status figure_chart(const bench_options *options, int figure,
                         const figure_times *times);

#endif
