/* bench/combine/combine.c - `snowglass bench combine`: its options, and ranks
 * that are threads of one process.  The same options are read by the program of
 * simulated networks (mpi_combine.c). */
#include "combine.h"
#include "line.h"
#include "option_table.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: snowglass bench combine [options]\n"
    "\n"
    "Combines the local images of many ranks into one picture, and prints what "
    "it\n"
    "took as one line of key=value: milliseconds, exact counts of bytes and\n"
    "messages, and a bound.  Local images are slabs of a cube seen at an "
    "angle, "
    "with\n"
    "random pixels, or pictures in files.  Ranks are those of MPI, or threads "
    "of\n"
    "one process.\n"
    "\n"
    "  --ranks N        where they are threads (8)\n"
    "  --threads N      of each rank (1)\n"
    "  --size N         side of the square picture in pixels (512)\n"
    "  --pattern NAME   box: slabs of a cube; or pictures that are the local\n"
    "                   images, from front to back, such as slab_%02d.png for\n"
    "                   ranks 0, 1 ...; one without a number is every rank's "
    "(box)\n"
    "  --method NAME    auto, tree (the paper's), swap, direct or radix "
    "(auto)\n"
    "  --radix K        of the method radix (chosen)\n"
    "  --gather K       branches of the tree that brings pieces to rank 0 "
    "(chosen)\n"
    "  --pieces NAME    even, counted, interlaced or auto (auto)\n"
    "  --whole          all pixels travel, as in the paper\n"
    "  --grey           2 channels, not 4\n"
    "  --floats         floats are gathered, not 8 bits a channel\n"
    "  --check          compare with the picture of a chain; fail when they "
    "differ\n"
    "  --sizes-only     no pixels, but messages of the right length\n"
    "  --rates          only what the threads of one of --ranks (32) take for "
    "a\n"
    "                   pixel, and for copies of the same bytes\n"
    "  --runs N         of which the fastest counts (5)\n"
    "  --json           print a JSON object\n"
    "\n"
    "  --azimuth DEG    of the cube (30)\n"
    "  --elevation DEG  (20)\n"
    "  --cube X         its side, of the picture's (0.68)\n"
    "  --fill X         part of a 32nd's footprint that is active (0.3)\n"
    "  --grain N        pixels that are active together (1)\n"
    "\n"
    "  --profile FILE   of bench frame --profile, with a line for each rank: "
    "what\n"
    "                   simulated ranks work besides, so that total is of a "
    "whole\n"
    "                   picture\n"
    "  --alpha SECONDS  of the bound: a message's latency (1.5e-6)\n"
    "  --beta SECONDS   for a byte (1 / 12.125e9)\n"
    "  --scan SECONDS   what a simulated processor takes to look at a pixel\n"
    "                   (0.1e-9)\n"
    "  --blend SECONDS  to lay one over another (0.25e-9)\n"
    "  --round SECONDS  to round one to 8 bits (0.25e-9)\n"
    "  --move SECONDS   to move 16 bytes of the picture (0.1e-9)\n";

/* --- options -------------------------------------------------------------- */

static const char *const methods[] = {"auto",   "tree",  "swap",
                                      "direct", "radix", NULL};
static const char *const piece_names[] = {"auto", "even", "counted",
                                          "interlaced", NULL};

/* The first word that says something of the cube. */
static const char *word_of_box(int argc, char **argv) {
    static const char *const words[] = {"--size",  "--azimuth", "--elevation",
                                        "--cube",  "--fill",    "--grain",
                                        "--rates", NULL};
    for (int i = 1; i < argc; i++)
        for (int n = 0; words[n]; n++)
            if (strcmp(argv[i], words[n]) == 0)
                return argv[i];
    return NULL;
}

/* What does not go together; an exit code, or -1 to go on. */
static int check_options(const bench_option_table *table, int argc, char **argv,
                         const combine_options *options, FILE *said) {
    char path[COMBINE_NAME_BYTES];
    const char *word = word_of_box(argc, argv);
    if (options->check && options->sizes_only)
        return bench_option_table_fail(
            table, said, "there are no pixels to look at; leave out",
            "--check");
    if (!options->pattern)
        return -1;
    if (!combine_file_name(options->pattern, 0, path, sizeof path))
        return bench_option_table_fail(table, said,
                                       "one picture, or a number's place as in "
                                       "slab_%02d.png, is not what this names:",
                                       options->pattern);
    if (word)
        return bench_option_table_fail(
            table, said, "pictures in files make no use of", word);
    return -1;
}

int combine_parse(int argc, char **argv, combine_options *out, FILE *said) {
    int method = 0, regions = 0;
    bool grey = false, floats = false, helps = false;
    int size = 512;
    *out = (combine_options){.pattern = "box",
                             .threads = 1,
                             .runs = 5,
                             .azimuth = 30,
                             .elevation = 20,
                             .fill = 0.3,
                             .cube = 0.68,
                             .grain = 1,
                             .alpha = BENCH_ALPHA,
                             .beta = BENCH_BETA,
                             .scan = 0.1e-9,
                             .blend = 0.25e-9,
                             .round = 0.25e-9,
                             .move = 0.1e-9};
    const bench_option entries[] = {
        {"--ranks", BENCH_WHOLE, &out->ranks, 1, 4096, NULL},
        {"--threads", BENCH_WHOLE, &out->threads, 1, 64, NULL},
        {"--size", BENCH_WHOLE, &size, 1, 32768, NULL},
        {"--pattern", BENCH_TEXT, &out->pattern, 0, 0, NULL},
        {"--method", BENCH_CHOICE, &method, 0, 0, methods},
        {"--radix", BENCH_WHOLE, &out->radix, 2, 4096, NULL},
        {"--gather", BENCH_WHOLE, &out->gather, 2, 4096, NULL},
        {"--pieces", BENCH_CHOICE, &regions, 0, 0, piece_names},
        {"--whole", BENCH_FLAG, &out->whole, 0, 0, NULL},
        {"--grey", BENCH_FLAG, &grey, 0, 0, NULL},
        {"--floats", BENCH_FLAG, &floats, 0, 0, NULL},
        {"--check", BENCH_FLAG, &out->check, 0, 0, NULL},
        {"--sizes-only", BENCH_FLAG, &out->sizes_only, 0, 0, NULL},
        {"--rates", BENCH_FLAG, &out->rates, 0, 0, NULL},
        {"--runs", BENCH_WHOLE, &out->runs, 1, 1000, NULL},
        {"--json", BENCH_FLAG, &out->json, 0, 0, NULL},
        {"--azimuth", BENCH_NUMBER, &out->azimuth, -1e6, 1e6, NULL},
        {"--elevation", BENCH_NUMBER, &out->elevation, -1e6, 1e6, NULL},
        {"--cube", BENCH_NUMBER, &out->cube, 0, 4, NULL},
        {"--fill", BENCH_NUMBER, &out->fill, 0, 1, NULL},
        {"--grain", BENCH_WHOLE, &out->grain, 1, 32768, NULL},
        {"--alpha", BENCH_NUMBER, &out->alpha, 0, 1, NULL},
        {"--beta", BENCH_NUMBER, &out->beta, 0, 1, NULL},
        {"--scan", BENCH_NUMBER, &out->scan, 0, 1, NULL},
        {"--blend", BENCH_NUMBER, &out->blend, 0, 1, NULL},
        {"--round", BENCH_NUMBER, &out->round, 0, 1, NULL},
        {"--move", BENCH_NUMBER, &out->move, 0, 1, NULL},
        {"--profile", BENCH_TEXT, &out->profile, 0, 0, NULL},
        {"--help", BENCH_FLAG, &helps, 0, 0, NULL},
    };
    const bench_option_table table = {"combine", entries,
                                      sizeof entries / sizeof *entries, NULL};
    int code = bench_option_table_read(&table, argc, argv, said);
    if (code >= 0)
        return code;
    out->method = (snow_combine)method;
    out->regions = (snow_image_partition)regions;
    out->channels = grey ? 2 : 4;
    out->bits = floats ? 0 : 8;
    out->width = out->height = size;
    if (strcmp(out->pattern, "box") == 0)
        out->pattern = NULL;
    if (helps && said)
        fputs(help, stdout);
    return helps ? SNOW_STATUS_OK
                 : check_options(&table, argc, argv, out, said);
}

/* Ranks that are threads of this process. */
static snow_status run_threads(snow_context *context, combine_session *session,
                               int ranks) {
    snow_status status =
        snow_comm_run_threads(context, ranks, combine_body, session);
    if (status != SNOW_STATUS_OK)
        fprintf(stderr, "snowglass: bench combine: %s\n",
                snow_context_message(context));
    return status;
}

static int run_alone(combine_session *session, int ranks) {
    snow_context *context;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = run_threads(context, session, ranks);
    snow_context_free(context);
    return status == SNOW_STATUS_OK ? combine_print(session) : (int)status;
}

int combine_run(snow_comm *comm, combine_session *session) {
    const bool talks = snow_comm_rank(comm) == 0;
    snow_status status = combine_body(comm, session);
    if (status != SNOW_STATUS_OK && talks)
        fprintf(stderr, "snowglass: bench combine: %s\n",
                snow_context_message(snow_comm_context(comm)));
    if (status == SNOW_STATUS_OK && talks)
        status = (snow_status)combine_print(session);
    return (int)status;
}

int combine_main(int argc, char **argv, snow_comm *comm) {
    combine_options options;
    const bool talks = !comm || snow_comm_rank(comm) == 0;
    int code = combine_parse(argc, argv, &options, talks ? stderr : NULL);
    if (code >= 0)
        return code;
    if (comm && options.ranks) {
        if (talks)
            fprintf(stderr, "snowglass: bench combine: ranks are those of MPI; "
                            "leave out --ranks\n");
        return SNOW_STATUS_BAD_USAGE;
    }
    if (options.rates)
        return talks ? combine_rates(&options) : SNOW_STATUS_OK;
    combine_session session = {.options = &options};
    if (comm)
        return combine_run(comm, &session);
    return run_alone(&session, options.ranks ? options.ranks : 8);
}
