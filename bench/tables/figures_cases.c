/* bench/tables/figures_cases.c - what figures 11 and 12 are made of: numbers of
 * nodes, ways to splat, volumes and clusters. */
#include "figures.h"

const int figure_nodes[FIGURE_NODES] = {1, 2, 4, 8, 16, 32};
const bench_way figure_ways[FIGURE_WAYS] = {BENCH_ORIGINAL, BENCH_CRS,
                                            BENCH_BITMAP, BENCH_RLE};
const char *const figure_way_names[FIGURE_WAYS] = {"original", "crs", "bitmap",
                                                   "rle"};
const figure_volume figure_volumes[FIGURE_VOLUMES] = {
    {BENCH_HEAD, "Head", 30, 7.102},
    {BENCH_ENGINE, "Engine", 30, 5.518},
};
const figure_cluster figure_clusters[FIGURE_CLUSTERS] = {
    {"sp2-paper",
     "SP2, equal slabs, the paper's tree",
     {40e-6, 35e6, 10e-6, 0},
     SNOW_PARTITION_EQUAL,
     SNOW_COMBINE_TREE},
    {"sp2",
     "SP2, slabs by count, auto",
     {40e-6, 35e6, 10e-6, 0},
     SNOW_PARTITION_COUNTED,
     SNOW_COMBINE_AUTO},
    {"today",
     "100 Gb/s, slabs by count, auto",
     {1e-6, 12.5e9, 0.3e-6, 1},
     SNOW_PARTITION_COUNTED,
     SNOW_COMBINE_AUTO},
};

double figure_speedup(const figure_times *times, int figure, int cluster,
                      int way, int nodes) {
    double one = times->taken[cluster][figure == 11 ? 0 : way][0].seconds;
    return one / times->taken[cluster][way][nodes].seconds;
}
