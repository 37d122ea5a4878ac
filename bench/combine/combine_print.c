/* bench/combine/combine_print.c - what was measured as one line of key=value,
 * or one JSON object with the same keys. */
#include "combine.h"
#include "line.h"

static const char *method_name(snow_combine method) {
    static const char *const names[] = {"auto", "tree", "swap", "direct",
                                        "radix"};
    return names[method];
}

static double bound_of(const combine_options *options,
                       const combine_result *result) {
    const int channels = options->channels;
    return bench_bound(
        result->ranks, (double)result->most.active * channels * 4,
        (double)result->sum.shown * channels * (options->bits == 8 ? 1 : 4),
        options->alpha, options->beta);
}

static void put_setting(bench_line *out, const combine_options *options,
                        const combine_result *result) {
    static const char *const regions[] = {"auto", "even", "counted",
                                          "interlaced"};
    const int bytes = options->channels * (options->bits == 8 ? 1 : 4);
    bench_line_int(out, "ranks", result->ranks);
    bench_line_int(out, "nodes", result->hosts.nodes);
    bench_line_int(out, "rank_per_node", result->hosts.node_ranks);
    bench_line_int(out, "threads", options->threads);
    bench_line_int(out, "sim", options->simulated);
    bench_line_text(out, "method", method_name(result->given.method));
    bench_line_int(out, "rounds", result->given.rounds);
    bench_line_radices(out, result->given.radices, result->given.rounds);
    if (result->width == result->height) {
        bench_line_int(out, "image", result->width);
    } else {
        char size[32];
        snprintf(size, sizeof size, "%dx%d", result->width, result->height);
        bench_line_text(out, "image", size);
    }
    bench_line_text(out, "pattern",
                    options->pattern ? options->pattern : "box");
    bench_line_int(out, "pixel_bytes", options->channels * 4);
    bench_line_int(out, "gather_bytes", bytes);
    bench_line_text(out, "pixels", options->whole ? "whole" : "active");
    bench_line_text(out, "pieces",
                    result->given.counted ? "counted"
                                          : regions[options->regions]);
}

static void put_counters(bench_line *out, const combine_result *result) {
    const combine_figures *most = &result->most, *sum = &result->sum;
    bench_line_int(out, "bytes_sent_max", most->bytes_sent);
    bench_line_int(out, "bytes_sent_sum", sum->bytes_sent);
    bench_line_int(out, "bytes_lent_sum", sum->bytes_lent);
    bench_line_int(out, "msgs_max", most->messages);
    bench_line_int(out, "exchange_bytes_max", most->exchange_bytes);
    bench_line_int(out, "exchange_msgs_max", most->exchange_messages);
    bench_line_int(out, "active_px_max", most->active);
    bench_line_int(out, "laid_px_max", most->laid);
    bench_line_int(out, "shown_px", sum->shown);
    bench_line_number(
        out, "imbalance",
        sum->laid ? (double)most->laid * result->ranks / (double)sum->laid : 1);
}

static void put_times(bench_line *out, const combine_options *options,
                      const combine_result *result) {
    const combine_figures *most = &result->most, *sum = &result->sum;
    const double ranks = result->ranks;
    bench_line_ms(out, "exchange_ms", most->exchange);
    bench_line_ms(out, "exchange_mean_ms", sum->exchange / ranks);
    bench_line_ms(out, "gather_ms", most->gather);
    bench_line_ms(out, "total_ms", most->total);
    if (!options->simulated) {
        bench_line_ms(out, "exchange_cpu_ms", most->exchange_cpu);
        bench_line_ms(out, "exchange_cpu_mean_ms", sum->exchange_cpu / ranks);
        bench_line_ms(out, "gather_cpu_ms", most->gather_cpu);
        bench_line_ms(out, "gather_cpu_mean_ms", sum->gather_cpu / ranks);
    }
    double bound = bound_of(options, result);
    bench_line_ms(out, "bound_ms", bound);
    bench_line_number(out, "ratio", bound > 0 ? most->total / bound : 0);
}

int combine_print(const combine_session *session) {
    const combine_options *options = session->options;
    const combine_result *result = &session->result;
    bench_line out = {.json = options->json};
    const double difference = result->most.difference;
    /* A channel of 8 bits is off by half a step from rounding alone; floats by
     * what tests/stages/test_combine.c derives. */
    const double allowed =
        options->bits == 8 ? 1.0 / 255 : 12.0 * result->ranks / (1 << 25);
    const bool good = difference >= 0 && difference <= allowed;
    put_setting(&out, options, result);
    bench_line_text(&out, "check",
                    !options->check ? "none"
                    : good          ? "ok"
                                    : "wrong");
    if (options->check)
        bench_line_number(&out, "max_abs_diff", difference);
    put_counters(&out, result);
    put_times(&out, options, result);
    bench_line_end(&out);
    return options->check && !good ? SNOW_STATUS_FAILED : SNOW_STATUS_OK;
}
