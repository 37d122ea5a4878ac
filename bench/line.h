/* bench/line.h - one line of key=value, or one JSON object with the same keys.
 */
#ifndef SNOW_BENCH_LINE_H
#define SNOW_BENCH_LINE_H

#include <stdbool.h>
#include <stdint.h>

/* A line under way, on standard output. */
typedef struct bench_line {
    bool json, begun;
} bench_line;

void bench_line_text(bench_line *line, const char *key, const char *text);
void bench_line_int(bench_line *line, const char *key, int64_t number);
void bench_line_number(bench_line *line, const char *key, double number);

/* Seconds, printed as milliseconds. */
void bench_line_ms(bench_line *line, const char *key, double seconds);

void bench_line_end(bench_line *line);

#endif
