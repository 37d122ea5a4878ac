/* bench/frame/frame_print.c - what was measured as one line. */
#include "frame.h"
#include "line.h"

#include <stdio.h>

/* One step of 8 bits, and the rounding of floats that hold such steps. */
static const double allowed = 1.0 / 255 + 1e-6;

static void put_setting(bench_line *out, const frame_options *options,
                        const frame_result *result) {
    static const char *const cuts[] = {"auto", "equal", "counted", "bricks",
                                       "measured"};
    static const char *const combinings[] = {"auto", "tree", "swap", "direct",
                                             "radix"};
    char size[32];
    snprintf(size, sizeof size, "%dx%d", options->width, options->height);
    bench_line_int(out, "ranks", result->ranks);
    bench_line_int(out, "nodes", result->nodes);
    bench_line_int(out, "rank_per_node", result->node_ranks);
    bench_line_int(out, "threads", 1);
    bench_line_int(out, "simulated", options->simulated);
    bench_line_text(out, "method", snow_method_name(result->method));
    bench_line_text(out, "cut", cuts[options->cut]);
    bench_line_text(out, "combine", combinings[options->combining]);
    bench_line_int(out, "rounds", result->rounds);
    bench_line_radices(out, result->radices, result->rounds);
    bench_line_text(out, "image", size);
    bench_line_int(out, "pixel_bytes", result->channels * 4);
    bench_line_int(out, "gather_bytes", result->channels);
}

static void put_counters(bench_line *out, const frame_result *result) {
    const double mean = (double)result->voxels_sum / result->ranks;
    bench_line_int(out, "bytes_sent_max", (int64_t)result->bytes_most);
    bench_line_int(out, "bytes_sent_sum", (int64_t)result->bytes_sum);
    bench_line_int(out, "bytes_early_sum", (int64_t)result->early_sum);
    bench_line_int(out, "msgs_max", (int64_t)result->messages_most);
    bench_line_int(out, "active_px_max", result->active_most);
    bench_line_int(out, "voxels_max", result->voxels_most);
    bench_line_int(out, "voxels_sum", result->voxels_sum);
    bench_line_number(out, "voxels_mean", mean);
    if (result->checked)
        bench_line_int(out, "voxels_whole", result->voxels_whole);
    bench_line_number(out, "imbalance",
                      mean > 0 ? (double)result->voxels_most / mean : 1);
    bench_line_int(out, "slices_min", result->slices_least);
    bench_line_int(out, "cuts_by_time", result->cuts);
    bench_line_number(
        out, "splat_uneven",
        result->splat_mean > 0 ? result->splat_most / result->splat_mean : 1);
    bench_line_ms(out, "splat_least_ms", result->splat_most);
    bench_line_ms(out, "splat_least_mean_ms", result->splat_mean);
    bench_line_ms(out, "work_least_ms", result->work_most);
    bench_line_ms(out, "work_least_mean_ms", result->work_mean);
}

static void put_times(bench_line *out, const frame_result *result) {
    static const char *const names[FRAME_STAGES] = {
        [FRAME_READ] = "read",           [FRAME_ENCODE] = "encode",
        [FRAME_SPLAT] = "splat",         [FRAME_EXCHANGE] = "exchange",
        [FRAME_WARP] = "warp",           [FRAME_GATHER] = "gather",
        [FRAME_TOTAL] = "total",         [FRAME_FIRST] = "first",
        [FRAME_READ_CPU] = "read_cpu",   [FRAME_ENCODE_CPU] = "encode_cpu",
        [FRAME_SPLAT_CPU] = "splat_cpu", [FRAME_EXCHANGE_CPU] = "exchange_cpu",
        [FRAME_WARP_CPU] = "warp_cpu",   [FRAME_GATHER_CPU] = "gather_cpu",
        [FRAME_TOTAL_CPU] = "total_cpu", [FRAME_FIRST_CPU] = "first_cpu",
        [FRAME_WORK_CPU] = "work_cpu",
    };
    for (int i = 0; i < FRAME_STAGES; i++) {
        char key[32];
        snprintf(key, sizeof key, "%s_ms", names[i]);
        bench_line_ms(out, key, result->most[i]);
        snprintf(key, sizeof key, "%s_mean_ms", names[i]);
        bench_line_ms(out, key, result->mean[i]);
    }
}

/* Of exchange and gather together. */
static void put_bound(bench_line *out, const frame_options *options,
                      const frame_result *result) {
    const bool simulated = options->simulated;
    const double alpha = options->alpha >= 0 ? options->alpha
                         : simulated         ? options->network.latency
                                             : BENCH_ALPHA;
    const double beta = options->beta >= 0 ? options->beta
                        : simulated        ? 1 / options->network.bandwidth
                                           : BENCH_BETA;
    const double bound = bench_bound(
        result->ranks, (double)result->active_most * result->channels * 4,
        (double)result->shown * result->channels, alpha, beta);
    const double took =
        result->most[FRAME_EXCHANGE] + result->most[FRAME_GATHER];
    bench_line_ms(out, "bound_ms", bound);
    bench_line_number(out, "ratio", bound > 0 ? took / bound : 0);
}

/* Time of the simulated machine is the picture's: its ranks' processor time and
 * its messages. */
static void put_projection(bench_line *out, const frame_options *options,
                           const frame_result *result) {
    const double projected = result->most[FRAME_TOTAL];
    if (result->checked) {
        bench_line_ms(out, "t1_ms", result->alone);
        bench_line_ms(out, "t1_first_ms", result->alone_first);
    }
    if (options->simulated)
        bench_line_ms(out, "projected_ms", projected);
    if (options->simulated && result->checked && projected > 0)
        bench_line_number(out, "efficiency",
                          result->alone / (result->ranks * projected));
}

bool frame_write_profile(const char *path, const frame_figures *all,
                         int ranks) {
    FILE *out = fopen(path, "w");
    if (!out)
        return false;
    for (int i = 0; i < ranks; i++) {
        const double *s = all[i].seconds;
        const double early = s[FRAME_TOTAL_CPU] - s[FRAME_EXCHANGE_CPU] -
                             s[FRAME_WARP_CPU] - s[FRAME_GATHER_CPU];
        fprintf(out, "%.9f %.9f %.9f\n", early, s[FRAME_WARP_CPU],
                s[FRAME_GATHER_CPU]);
    }
    bool good = !ferror(out);
    return fclose(out) == 0 && good;
}

static void put_turn(bench_line *out, const frame_result *result) {
    bench_line_ms(out, "turn_ms", result->apart);
    bench_line_ms(out, "turn_overlap_ms", result->overlapped);
    bench_line_ms(out, "hidden_ms", result->hidden);
    bench_line_text(out, "turn_check", result->same ? "ok" : "wrong");
}

int frame_print(const frame_options *options, const frame_result *result) {
    bench_line out = {.json = options->json};
    const bool good = result->difference <= allowed; /* NaN is not */
    put_setting(&out, options, result);
    bench_line_text(&out, "check",
                    !result->checked ? "none"
                    : good           ? "ok"
                                     : "wrong");
    if (result->checked)
        bench_line_number(&out, "max_abs_diff", result->difference);
    put_counters(&out, result);
    put_times(&out, result);
    put_bound(&out, options, result);
    put_projection(&out, options, result);
    if (options->turn)
        put_turn(&out, result);
    bench_line_end(&out);
    bool wrong = (result->checked && !good) || (options->turn && !result->same);
    return wrong ? SNOW_STATUS_FAILED : SNOW_STATUS_OK;
}
