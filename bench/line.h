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

/* "k": 8x4, the radices of the rounds of an exchange; 1 where there are none.
 */
void bench_line_radices(bench_line *line, const int *radices, int rounds);

/* Seconds that no method can beat: one message's latency (`alpha`) for each
 * doubling of ranks, and `beta` for each byte of the larger of what each rank
 * must send once and what rank 0 must get, but for its own share. */
#define BENCH_ALPHA 1.5e-6
#define BENCH_BETA (1 / 12.125e9)
double bench_bound(int ranks, double local_bytes, double picture_bytes,
                   double alpha, double beta);

void bench_line_end(bench_line *line);

#endif
