/* bench/bench_options.c - options of the tables, the figures and `speed`, and
 * the help. */
#include "bench.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "usage: snowglass bench NAME [options]\n"
    "\n"
    "  all                    all of these but ranks, one after another\n"
    "  table1 table2 table3   the paper's tables\n"
    "  figure11 figure12      the paper's speed-ups on 1 to 32 nodes\n"
    "  speed                  how fast pictures are made\n"
    "  ranks                  a picture by many ranks (bench ranks --help)\n"
    "\n"
    "table1 to table3 print the paper's tables beside ours: sparse ratios\n"
    "(table1), original splatting against the three sparse encodings "
    "(table2),\n"
    "the same for footprints of 2x2 to 5x5 (table3).  256x256 grey pictures,\n"
    "one voxel per pixel, preset linear, no shading, one thread.\n"
    "\n"
    "figure11 and figure12 print speed-ups of original and sparse splatting "
    "on\n"
    "up to 32 nodes, over the original on one node and over themselves: the\n"
    "nodes' work is measured, the network between them is simulated.\n"
    "\n"
    "speed prints how fast pictures are made while the view turns: volumes,\n"
    "looks, colours, shading, sizes, methods, encodings and threads, against\n"
    "original splatting, the same by footprint tables (original-table), and\n"
    "tested splatting, with the same kernel.  It takes many minutes.\n"
    "\n"
    "Every row is verified before its times are printed.  Figures print on\n"
    "stderr how far they are, and the time that is left.  all prints with\n"
    "--json one object that holds that of each by its name.\n"
    "\n"
    "  --data DIR       folder that holds "
    "classic/engine_256x256x110_u8.raw.gz\n"
    "                   and classic/CThead_256x256x113_u16be.raw.gz, for "
    "speed\n"
    "                   also classic/aneurism.vti and classic/bonsai.vti;\n"
    "                   without it phantoms are used\n"
    "  --json           print one JSON object\n"
    "  --runs N         alternated runs whose median is taken, 5 to 99 (7)\n"
    "  --quick          one run on tiny phantoms: a test, no measurement\n"
    "  --help           this text\n"
    "\n"
    "tables:\n"
    "  --kernel NAME    gauss, tent, bspline or box (gauss)\n"
    "  --azimuth DEG    turn the camera from +z (0)\n"
    "  --elevation DEG  (0)\n"
    "\n"
    "speed, and those that say so:\n"
    "  --volumes LIST   of engine, head, aneurism, bonsai, cube, shells,\n"
    "                   cube512, engine512, head512 (all that are there, but\n"
    "                   for those of 512x512x512)\n"
    "  --large          those, too: some minutes for each picture\n"
    "  --sizes LIST     sides of the square picture in pixels (512)\n"
    "  --threads LIST   (1 and all processors)\n"
    "  --only LIST      of translucent, opaque, grey, rgba, unshaded, phong,\n"
    "                   original, original-table, tested, footprint,\n"
    "                   shear-warp, raycast, auto, crs, bitmap, rle, draft,\n"
    "                   normal, high, bspline, tent: words of one kind add "
    "up,\n"
    "                   kinds restrict each other; raycast is measured only\n"
    "                   where it is named\n"
    "  --sweep NAME     instead: phantoms by sparse ratio (sparse) or by size\n"
    "                   (size)\n"
    "  --chart FILE     draw the sweep (sparse unless told) as SVG; of the\n"
    "                   figures, too\n";

int bench_print_help(void) {
    fputs(help, stdout);
    return SNOW_STATUS_OK;
}

static int usage_error(const char *what, const char *value) {
    fprintf(stderr, "snowglass: bench: %s '%s'; see snowglass bench --help\n",
            what, value);
    return SNOW_STATUS_BAD_USAGE;
}

/* So have sweeps. */
static int check_speed(const bench_options *options) {
    bool sweeps = options->sweep || options->chart;
    bool by_size = options->sweep && strcmp(options->sweep, "size") == 0;
    if (options->sweep && !by_size && strcmp(options->sweep, "sparse") != 0)
        return usage_error("this value is not possible:", options->sweep);
    if (sweeps && options->large && !by_size)
        return usage_error("there are no large volumes in this sweep; leave "
                           "out",
                           "--large");
    if (sweeps && options->sides.count > 1)
        return usage_error("a sweep has one size; leave out all but one of",
                           "--sizes");
    if (options->quick && options->large)
        return usage_error("--quick has its own volumes; leave out", "--large");
    if ((sweeps || options->quick) && (options->volumes || options->data))
        return usage_error("--quick and sweeps have their own volumes; leave "
                           "out",
                           options->data ? "--data" : "--volumes");
    return -1;
}

static int check(const bench_entry *entry, const char *kernel,
                 bench_options *out) {
    int found = kernel ? snow_kernel_from_name(kernel) : (int)out->kernel;
    if (found < 0)
        return usage_error("this value is not possible:", kernel);
    out->kernel = (snow_kernel)found;
    if (!out->runs)
        out->runs = out->quick ? 1 : 7;
    if (entry->of == BENCH_OF_SPEED)
        return check_speed(out);
    if (out->quick && out->data) /* it has volumes of its own */
        return usage_error("--quick has its own volumes; leave out", out->data);
    return -1;
}

/* An option, and the benchmarks that have it. */
typedef struct entry_option {
    unsigned of;
    bench_option option;
} entry_option;

#define OF_EVERY (~0u)
#define OF_CHARTS (BENCH_OF_FIGURES | BENCH_OF_SPEED)
#define OPTIONS_MOST 20

/* Fewer than five runs give no median that can be trusted; tables/measure.c has
 * room for 99. */
int bench_options_read(const bench_entry *entry, int argc, char **argv,
                       bench_options *out) {
    const char *kernel = NULL;
    bool helps = false;
    const entry_option all[] = {
        {OF_EVERY, {"--data", BENCH_TEXT, &out->data, 0, 0, NULL}},
        {OF_EVERY, {"--json", BENCH_FLAG, &out->json, 0, 0, NULL}},
        {OF_EVERY, {"--quick", BENCH_FLAG, &out->quick, 0, 0, NULL}},
        {OF_EVERY, {"--runs", BENCH_WHOLE, &out->runs, 5, 99, NULL}},
        {OF_EVERY, {"--help", BENCH_FLAG, &helps, 0, 0, NULL}},
        {OF_EVERY, {"-h", BENCH_FLAG, &helps, 0, 0, NULL}},
        {BENCH_OF_TABLES, {"--kernel", BENCH_TEXT, &kernel, 0, 0, NULL}},
        {BENCH_OF_TABLES,
         {"--azimuth", BENCH_NUMBER, &out->azimuth, -1e6, 1e6, NULL}},
        {BENCH_OF_TABLES,
         {"--elevation", BENCH_NUMBER, &out->elevation, -1e6, 1e6, NULL}},
        {OF_CHARTS, {"--chart", BENCH_TEXT, &out->chart, 0, 0, NULL}},
        {BENCH_OF_SPEED, {"--large", BENCH_FLAG, &out->large, 0, 0, NULL}},
        {BENCH_OF_SPEED, {"--volumes", BENCH_TEXT, &out->volumes, 0, 0, NULL}},
        {BENCH_OF_SPEED, {"--only", BENCH_TEXT, &out->only, 0, 0, NULL}},
        {BENCH_OF_SPEED, {"--sweep", BENCH_TEXT, &out->sweep, 0, 0, NULL}},
        {BENCH_OF_SPEED, {"--sizes", BENCH_LIST, &out->sides, 1, 8192, NULL}},
        {BENCH_OF_SPEED,
         {"--threads", BENCH_LIST, &out->threads, 1, 256, NULL}},
    };
    bench_option own[OPTIONS_MOST];
    bench_option_table table = {entry->name, own, 0, NULL};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i].of & entry->of)
            own[table.count++] = all[i].option;
    int code = bench_option_table_read(&table, argc, argv, stderr);
    if (code >= 0)
        return code;
    return helps ? bench_print_help() : check(entry, kernel, out);
}
