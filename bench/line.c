/* bench/line.c - one line of key=value, or one JSON object with the same keys.
 * Texts are names of ours and numbers: nothing in them is special to JSON. */
#include "line.h"

#include <stdio.h>
#include <string.h>

static void begin_pair(bench_line *line, const char *key) {
    if (line->json)
        printf("%s\"%s\": ", line->begun ? ", " : "{", key);
    else
        printf("%s%s=", line->begun ? " " : "", key);
    line->begun = true;
}

void bench_line_text(bench_line *line, const char *key, const char *text) {
    begin_pair(line, key);
    printf(line->json ? "\"%s\"" : "%s", text);
}

void bench_line_int(bench_line *line, const char *key, int64_t number) {
    begin_pair(line, key);
    printf("%lld", (long long)number);
}

void bench_line_ms(bench_line *line, const char *key, double seconds) {
    begin_pair(line, key);
    printf("%.6f", seconds * 1e3);
}

void bench_line_number(bench_line *line, const char *key, double number) {
    begin_pair(line, key);
    printf("%.6g", number);
}

void bench_line_radices(bench_line *line, const int *radices, int rounds) {
    char text[256] = "";
    for (int i = 0; i < rounds; i++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%d", i ? "x" : "",
                 radices[i]);
    }
    bench_line_text(line, "k", rounds ? text : "1");
}

double bench_bound(int ranks, double local_bytes, double picture_bytes,
                   double alpha, double beta) {
    int doublings = 0;
    while (((int64_t)1 << doublings) < ranks)
        doublings++;
    double most = local_bytes > picture_bytes ? local_bytes : picture_bytes;
    return doublings * alpha + most * (ranks - 1) / ranks * beta;
}

void bench_line_end(bench_line *line) {
    printf(line->json ? "}\n" : "\n");
}
