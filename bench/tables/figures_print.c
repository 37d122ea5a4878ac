/* bench/tables/figures_print.c - figures 11 and 12 as a table, as JSON and as a
 * chart.
 */
#include "chart.h"
#include "figures.h"
#include "machine.h"

#include <stdio.h>

static void print_head(int figure, const bench_options *options) {
    printf("Figure %d: speed-up relative to %s on one node\n"
           "256x256 grey, footprint %s, one thread a node; "
           "encoding, splatting and combining; the least of %d runs\n"
           "nodes are timed one after another on this machine, the network "
           "is simulated; the paper shows its figure as a picture without "
           "numbers\n",
           figure,
           figure == 11 ? "the original splatting" : "the same splatting",
           "2x2", options->runs);
}

static void print_way(int figure, const figure_times *times, int cluster,
                      int way) {
    printf("  %-9s", figure_way_names[way]);
    for (int n = 0; n < FIGURE_NODES; n++)
        printf(" %7.2f", figure_speedup(times, figure, cluster, way, n));
    const figure_time *taken = times->taken[cluster][way];
    const figure_time *all = &taken[FIGURE_NODES - 1];
    printf("  %9.3f ms, %3.0f %%; %9.3f, %.2f\n", 1e3 * all->seconds,
           100 * taken[0].seconds / all->seconds /
               figure_nodes[FIGURE_NODES - 1],
           1e3 * all->slowest, all->slowest / all->mean);
}

void figure_print(const bench_options *options, int figure,
                  const figure_times *times) {
    print_head(figure, options);
    for (int cluster = 0; cluster < FIGURE_CLUSTERS; cluster++) {
        printf("\n%s\n", figure_clusters[cluster].text);
        for (int v = 0; v < FIGURE_VOLUMES; v++) {
            printf("%-9s  ", figure_volumes[v].label);
            for (int n = 0; n < FIGURE_NODES; n++)
                printf(" %7d", figure_nodes[n]);
            printf("  nodes: %d take, efficiency; their slowest local image, "
                   "over the mean\n",
                   figure_nodes[FIGURE_NODES - 1]);
            for (int way = 0; way < FIGURE_WAYS; way++)
                print_way(figure, &times[v], cluster, way);
        }
    }
    for (int v = 0; v < FIGURE_VOLUMES; v++)
        printf("\n%s: %s, threshold %g, %.1f %% empty; largest difference "
               "from one node's picture %.2g",
               figure_volumes[v].label, times[v].source,
               figure_volumes[v].threshold, 100 * times[v].sparse_ratio,
               times[v].largest);
    printf("\nSP2: this machine %.0f to %.0f times slower, so that the "
           "original takes what it took there\n",
           times[0].slowness[0], times[FIGURE_VOLUMES - 1].slowness[0]);
}

static json_t *way_json(int figure, const figure_times *times, int cluster,
                        int way) {
    json_t *seconds = json_array(), *speedups = json_array();
    json_t *slowest = json_array(), *means = json_array();
    const figure_time *taken = times->taken[cluster][way];
    for (int n = 0; n < FIGURE_NODES; n++) {
        json_array_append_new(seconds, json_real(taken[n].seconds));
        json_array_append_new(slowest, json_real(taken[n].slowest));
        json_array_append_new(means, json_real(taken[n].mean));
        json_array_append_new(speedups, json_real(figure_speedup(
                                            times, figure, cluster, way, n)));
    }
    return json_pack("{s:o, s:o, s:o, s:o}", "seconds", seconds, "speedup",
                     speedups, "local_slowest", slowest, "local_mean", means);
}

static json_t *volume_json(int figure, int v, const figure_times *times) {
    json_t *clusters = json_object();
    for (int cluster = 0; cluster < FIGURE_CLUSTERS; cluster++) {
        json_t *ways = json_object();
        for (int way = 0; way < FIGURE_WAYS; way++)
            json_object_set_new(ways, figure_way_names[way],
                                way_json(figure, times, cluster, way));
        json_object_set_new(ways, "slowness",
                            json_real(times->slowness[cluster]));
        json_object_set_new(clusters, figure_clusters[cluster].name, ways);
    }
    return json_pack("{s:s, s:s, s:f, s:f, s:f, s:o}", "dataset",
                     figure_volumes[v].label, "source", times->source,
                     "threshold", figure_volumes[v].threshold, "sparse_percent",
                     100 * times->sparse_ratio, "largest_difference",
                     times->largest, "clusters", clusters);
}

int figure_print_json(const bench_options *options, int figure,
                      const figure_times *times) {
    json_t *rows = json_array(), *nodes = json_array();
    for (int n = 0; n < FIGURE_NODES; n++)
        json_array_append_new(nodes, json_integer(figure_nodes[n]));
    for (int v = 0; v < FIGURE_VOLUMES; v++)
        json_array_append_new(rows, volume_json(figure, v, &times[v]));
    return bench_print_json(json_pack(
        "{s:i, s:i, s:o, s:o, s:o}", "figure", figure, "runs", options->runs,
        "machine", bench_machine(), "nodes", nodes, "rows", rows));
}

snow_status figure_chart(const bench_options *options, int figure,
                         const figure_times *times) {
    static const char *const names[FIGURE_VOLUMES][FIGURE_WAYS] = {
        {"Head, original", "Head, CRS", "Head, bit-map", "Head, RLE"},
        {"Engine, original", "Engine, CRS", "Engine, bit-map", "Engine, RLE"}};
    chart_plot chart = {
        .title = figure == 11 ? "Speed-up over the original splatting on one "
                                "node (the paper's figure 11)"
                              : "Speed-up of each splatting over itself on "
                                "one node (the paper's figure 12)",
        .notes = {"256x256 grey, footprint 2x2; encoding, "
                  "splatting and combining; nodes timed, network simulated",
                  machine_processor()},
        .x_label = "nodes",
        .y_label = "speed-up",
        .x_log = true,
        .tick_count = FIGURE_NODES,
        .line_count = FIGURE_VOLUMES * FIGURE_WAYS,
        .panel_count = FIGURE_CLUSTERS};
    for (int n = 0; n < FIGURE_NODES; n++)
        chart.ticks[n] = figure_nodes[n];
    for (int line = 0; line < chart.line_count; line++) {
        int v = line / FIGURE_WAYS, way = line % FIGURE_WAYS;
        chart.names[line] = names[v][way];
        for (int c = 0; c < FIGURE_CLUSTERS; c++)
            for (int n = 0; n < FIGURE_NODES; n++) {
                chart_line *to = &chart.panels[c].lines[line];
                to->x[to->count] = figure_nodes[n];
                to->y[to->count++] =
                    figure_speedup(&times[v], figure, c, way, n);
            }
    }
    for (int c = 0; c < FIGURE_CLUSTERS; c++)
        snprintf(chart.panels[c].title, sizeof chart.panels[c].title, "%s",
                 figure_clusters[c].text);
    return chart_write(&chart, options->chart);
}
