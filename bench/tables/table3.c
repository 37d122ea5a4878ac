/* bench/tables/table3.c - Table 3 of the paper: the gain grows with the
 * footprint. The table prints Head at threshold 30; its text speaks of Head and
 * Engine, for which it gives no figures; Engine's 2x2 line is that of Table 2.
 */
#include "bench.h"

int bench_table3(snow_context *context, const bench_options *options) {
    /* clang-format off */
    static const bench_paper_row rows[] = {
        /* T, K, SR %, seconds: original, -, CRS, bit-map, RLE; gains in % */
        {BENCH_HEAD, "Head", 30, 2, 70,
         {7.102, 0, 3.467, 4.067, 4.296}, {0, 0, 51, 43, 40}},
        {BENCH_HEAD, "Head", 30, 3, 70,
         {12.81, 0, 5.086, 5.651, 5.740}, {0, 0, 60, 56, 55}},
        {BENCH_HEAD, "Head", 30, 4, 70,
         {20.47, 0, 7.287, 8.035, 7.971}, {0, 0, 64, 61, 60}},
        {BENCH_HEAD, "Head", 30, 5, 70,
         {31.52, 0, 9.197, 10.65, 10.06}, {0, 0, 71, 67, 68}},
        {BENCH_ENGINE, "Engine", 30, 2, 81,
         {5.518, 0, 2.503, 3.098, 3.365}, {0, 0, 54, 44, 40}},
        {BENCH_ENGINE, "Engine", 30, 3, 81, {0}, {0}},
        {BENCH_ENGINE, "Engine", 30, 4, 81, {0}, {0}},
        {BENCH_ENGINE, "Engine", 30, 5, 81, {0}, {0}},
    };
    /* clang-format on */
    return bench_print_rows(context, options, 3, rows,
                            sizeof rows / sizeof rows[0]);
}
