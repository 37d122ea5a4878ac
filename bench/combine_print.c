/* bench/combine_print.c - what was measured as one line of key=value, or one
 * JSON object with the same keys. */
#include "combine.h"

#include <string.h>

/* A line under way. */
typedef struct line {
    bool json, begun;
} line;

static void begin_pair(line *out, const char *key) {
    if (out->json)
        printf("%s\"%s\": ", out->begun ? ", " : "{", key);
    else
        printf("%s%s=", out->begun ? " " : "", key);
    out->begun = true;
}

static void put_text(line *out, const char *key, const char *text) {
    begin_pair(out, key);
    printf(out->json ? "\"%s\"" : "%s", text);
}

static void put_int(line *out, const char *key, int64_t number) {
    begin_pair(out, key);
    printf("%lld", (long long)number);
}

static void put_ms(line *out, const char *key, double seconds) {
    begin_pair(out, key);
    printf("%.6f", seconds * 1e3);
}

static void put_number(line *out, const char *key, double number) {
    begin_pair(out, key);
    printf("%.6g", number);
}

static const char *method_name(snow_combining method) {
    static const char *const names[] = {"auto", "tree", "swap", "direct",
                                        "radix"};
    return names[method];
}

static void put_radices(line *out, const snow_exchange_figures *told) {
    char text[SNOW_ROUNDS_MOST * 6 + 1] = "";
    for (int i = 0; i < told->rounds; i++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%d", i ? "x" : "",
                 told->radices[i]);
    }
    put_text(out, "k", told->rounds ? text : "1");
}

/* What no method can beat: one message's latency for each doubling of ranks,
 * and the larger of what each rank must send once and what rank 0 must get. */
static double bound_of(const combine_options *options,
                       const combine_result *result) {
    double doublings = 0, ranks = result->ranks;
    while ((double)((int64_t)1 << (int)doublings) < ranks)
        doublings++;
    double pixel = options->channels * 4.0;
    double share = (double)result->most.active * pixel * (ranks - 1) / ranks;
    double gathered = (double)result->sum.shown * options->channels *
                      (options->bits == 8 ? 1 : 4) * (ranks - 1) / ranks;
    double bytes = share > gathered ? share : gathered;
    return doublings * options->alpha + bytes * options->beta;
}

static void put_setting(line *out, const combine_options *options,
                        const combine_result *result) {
    static const char *const pieces[] = {"auto", "even", "counted",
                                         "interlaced"};
    const int bytes = options->channels * (options->bits == 8 ? 1 : 4);
    put_int(out, "ranks", result->ranks);
    put_int(out, "sim", options->simulated);
    put_text(out, "method", method_name(result->told.method));
    put_int(out, "rounds", result->told.rounds);
    put_radices(out, &result->told);
    put_int(out, "image", options->size);
    put_int(out, "pixel_bytes", options->channels * 4);
    put_int(out, "gather_bytes", bytes);
    put_text(out, "pixels", options->whole ? "whole" : "active");
    put_text(out, "pieces",
             result->told.counted ? "counted" : pieces[options->pieces]);
}

static void put_counters(line *out, const combine_result *result) {
    const combine_figures *most = &result->most, *sum = &result->sum;
    put_int(out, "bytes_sent_max", most->bytes_sent);
    put_int(out, "bytes_sent_sum", sum->bytes_sent);
    put_int(out, "msgs_max", most->messages);
    put_int(out, "exchange_bytes_max", most->exchange_bytes);
    put_int(out, "exchange_msgs_max", most->exchange_messages);
    put_int(out, "active_px_max", most->active);
    put_int(out, "laid_px_max", most->laid);
    put_int(out, "shown_px", sum->shown);
    put_number(
        out, "imbalance",
        sum->laid ? (double)most->laid * result->ranks / (double)sum->laid : 1);
}

static void put_times(line *out, const combine_options *options,
                      const combine_result *result) {
    const combine_figures *most = &result->most, *sum = &result->sum;
    const double ranks = result->ranks;
    put_ms(out, "exchange_ms", most->exchange);
    put_ms(out, "exchange_mean_ms", sum->exchange / ranks);
    put_ms(out, "gather_ms", most->gather);
    put_ms(out, "total_ms", most->total);
    if (!options->simulated) {
        put_ms(out, "exchange_cpu_ms", most->exchange_cpu);
        put_ms(out, "exchange_cpu_mean_ms", sum->exchange_cpu / ranks);
        put_ms(out, "gather_cpu_ms", most->gather_cpu);
        put_ms(out, "gather_cpu_mean_ms", sum->gather_cpu / ranks);
    }
    double bound = bound_of(options, result);
    put_ms(out, "bound_ms", bound);
    put_number(out, "ratio", bound > 0 ? most->total / bound : 0);
}

int combine_print(const combine_session *session) {
    const combine_options *options = session->options;
    const combine_result *result = &session->result;
    line out = {.json = options->json};
    const double difference = result->most.difference;
    /* A channel of 8 bits is off by half a step from rounding alone; floats by
     * what tests/test_combine.c derives. */
    const double allowed =
        options->bits == 8 ? 1.0 / 255 : 12.0 * result->ranks / (1 << 25);
    const bool good = difference >= 0 && difference <= allowed;
    put_setting(&out, options, result);
    put_text(&out, "check", !options->check ? "none" : good ? "ok" : "wrong");
    if (options->check)
        put_number(&out, "max_abs_diff", difference);
    put_counters(&out, result);
    put_times(&out, options, result);
    printf(out.json ? "}\n" : "\n");
    return options->check && !good ? SNOW_FAILED : SNOW_OK;
}
