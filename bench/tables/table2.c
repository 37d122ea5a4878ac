/* bench/tables/table2.c - Table 2 of the paper: original splatting against the
 * three sparse encodings, footprint 2x2 (it shares a line with Table 3). */
#include "bench.h"

int bench_table2(snow_context *context, const bench_options *options) {
    /* clang-format off */
    static const bench_paper_row rows[] = {
        /* T, K, SR %, seconds: original, -, CRS, bit-map, RLE; gains in % */
        {BENCH_CUBE, "Cube", 10, 2, 98,
         {4.081, 0, 1.100, 1.454, 1.275}, {0, 0, 73, 65, 68}},
        {BENCH_HEAD, "Head", 10, 2, 47,
         {7.644, 0, 5.460, 5.862, 5.958}, {0, 0, 29, 24, 23}},
        {BENCH_HEAD, "Head", 30, 2, 70,
         {7.102, 0, 3.467, 4.067, 4.296}, {0, 0, 51, 43, 40}},
        {BENCH_ENGINE, "Engine", 10, 2, 77,
         {6.490, 0, 2.891, 3.294, 3.530}, {0, 0, 55, 49, 46}},
        {BENCH_ENGINE, "Engine", 30, 2, 81,
         {5.518, 0, 2.503, 3.098, 3.365}, {0, 0, 54, 44, 40}},
    };
    /* clang-format on */
    return bench_print_rows(context, options, 2, rows,
                            sizeof rows / sizeof rows[0]);
}
