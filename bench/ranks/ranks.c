/* bench/ranks/ranks.c - `snowglass bench ranks`: its options, and who its ranks
 * are.
 */
#include "ranks.h"
#include "option_table.h"

#include <stdio.h>
#include <stdlib.h>

static const char help[] =
    "usage: snowglass bench ranks FILE [options]\n"
    "\n"
    "Draws FILE, which may be phantom:NAME, by 1, 2, 4 and 8 ranks, and "
    "prints\n"
    "for each number the milliseconds of the local image (splat) and of the\n"
    "exchange, of the slowest rank and in the mean, those of the whole "
    "picture,\n"
    "the bytes that all ranks send, the slowest splat over the mean "
    "(imbalance),\n"
    "and the time of one rank over that of N times N (efficiency).  Every "
    "picture\n"
    "is compared with that of one rank before a time is printed; a wrong one "
    "ends\n"
    "it with exit code 1.\n"
    "\n"
    "Ranks are threads of this process, or under mpirun those of "
    "snowglass-mpi;\n"
    "each works on one thread.  Of the pictures the fastest counts; the volume "
    "is\n"
    "encoded already.  Splats are in processor time, the rest is by the "
    "clock,\n"
    "which says little where there are more ranks than processors: then give\n"
    "--network, with which ranks work one at a time, as if each had a machine "
    "of\n"
    "its own, and messages take the time of that network.\n"
    "\n"
    "  --ranks LIST     numbers of ranks (1,2,4,8)\n"
    "  --network LATENCY,BANDWIDTH,OVERHEAD\n"
    "                   seconds of a message, bytes a second, and seconds of "
    "the\n"
    "                   processor for a message, at both ends\n"
    "  --runs N         pictures of each number of ranks (5)\n"
    "  --size N         side of the picture in pixels (512)\n"
    "  --threshold X    opacity 0 to 255 (0)\n"
    "  --azimuth DEG    (0)\n"
    "  --elevation DEG  (0)\n"
    "  --cut NAME       auto, equal, counted or bricks (auto)\n"
    "  --combine NAME   auto, tree, swap, direct or radix (auto)\n"
    "  --dims XxYxZ     of a raw file, or a phantom\n"
    "  --type NAME      of a raw file, such as uint8\n"
    "  --json           print one JSON object\n"
    "  --help           this text\n";

static const char *const cuts[] = {"auto", "equal", "counted", "bricks", NULL};
static const char *const combinings[] = {"auto",   "tree",  "swap",
                                         "direct", "radix", NULL};

/* Three numbers with something between them; false where the text is others. */
static bool read_three(const char *text, char between, double out[3]) {
    for (int i = 0; i < 3; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text || *end != (i < 2 ? between : '\0') ||
            !(out[i] >= 0 && out[i] <= 1e18))
            return false;
        text = end + 1;
    }
    return true;
}

static bool read_dims(const char *text, ranks_options *out) {
    double dims[3];
    if (!read_three(text, 'x', dims))
        return false;
    for (int i = 0; i < 3; i++) {
        out->data.dims[i] = (int64_t)dims[i];
        if (dims[i] < 1 || (double)out->data.dims[i] != dims[i])
            return false;
    }
    return true;
}

static bool read_network(const char *text, ranks_options *out) {
    double numbers[3];
    if (!read_three(text, ',', numbers) || !(numbers[1] > 0))
        return false;
    out->simulated = true;
    out->network = (snow_network){.latency = numbers[0],
                                  .bandwidth = numbers[1],
                                  .overhead = numbers[2],
                                  .slowness = 1};
    return true;
}

/* What does not go together. */
static int check(const bench_option_table *table, const ranks_options *options,
                 const snow_comm *comm, FILE *said) {
    if (!options->path)
        return bench_option_table_fail(table, said,
                                       "there is no FILE; name one", "");
    if (comm && options->counts.count)
        return bench_option_table_fail(
            table, said, "mpirun sets the number of ranks; leave out",
            "--ranks");
    if (comm && options->simulated)
        return bench_option_table_fail(
            table, said, "MPI's network is not simulated; leave out",
            "--network");
    return -1;
}

/* Reads the options after the verb's name; an exit code, or -1 to go on. */
static int parse(int argc, char **argv, const snow_comm *comm, FILE *said,
                 ranks_options *out) {
    int cut = 0, combining = 0;
    bool helps = false;
    const char *dims = NULL, *type = NULL, *network = NULL;
    const bench_option entries[] = {
        {"--ranks", BENCH_LIST, &out->counts, 1, 4096, NULL},
        {"--network", BENCH_TEXT, &network, 0, 0, NULL},
        {"--runs", BENCH_WHOLE, &out->runs, 1, 1000, NULL},
        {"--size", BENCH_WHOLE, &out->side, 1, 32768, NULL},
        {"--threshold", BENCH_NUMBER, &out->threshold, 0, 255, NULL},
        {"--azimuth", BENCH_NUMBER, &out->azimuth, -1e6, 1e6, NULL},
        {"--elevation", BENCH_NUMBER, &out->elevation, -1e6, 1e6, NULL},
        {"--cut", BENCH_CHOICE, &cut, 0, 0, cuts},
        {"--combine", BENCH_CHOICE, &combining, 0, 0, combinings},
        {"--dims", BENCH_TEXT, &dims, 0, 0, NULL},
        {"--type", BENCH_TEXT, &type, 0, 0, NULL},
        {"--json", BENCH_FLAG, &out->json, 0, 0, NULL},
        {"--help", BENCH_FLAG, &helps, 0, 0, NULL},
    };
    const bench_option_table table = {
        "ranks", entries, sizeof entries / sizeof *entries, &out->path};
    snow_volume_options_init(&out->data);
    int code = bench_option_table_read(&table, argc, argv, said);
    if (code >= 0)
        return code;
    if (helps && said)
        fputs(help, stdout);
    if (helps)
        return SNOW_STATUS_OK;
    out->cut = (snow_partition)cut;
    out->combining = (snow_combine)combining;
    const char *bad = dims && !read_dims(dims, out)            ? dims
                      : network && !read_network(network, out) ? network
                      : type && !(out->data.type = snow_type_from_name(type))
                          ? type
                          : NULL;
    if (bad)
        return bench_option_table_fail(&table, said,
                                       "this value is not possible:", bad);
    return check(&table, out, comm, said);
}

/* An error of the library, or of a picture; the exit code. */
static int fail(snow_context *context, snow_status status, bool talks) {
    if (talks)
        fprintf(stderr, "snowglass: bench ranks: %s\n",
                snow_context_message(context));
    return (int)status;
}

/* Ranks that are threads: one number of them after another. */
static int run_threads(snow_context *context, const ranks_options *options) {
    ranks_alone alone = {0};
    ranks_row rows[BENCH_LIST_MOST];
    snow_status status = ranks_draw_alone(context, options, &alone);
    for (int i = 0; i < options->counts.count && status == SNOW_STATUS_OK;
         i++) {
        ranks_session session = {.options = options, .alone = &alone};
        const int ranks = options->counts.values[i];
        status =
            options->simulated
                ? snow_comm_run_simulated(context, ranks, &options->network,
                                          ranks_body, &session)
                : snow_comm_run_threads(context, ranks, ranks_body, &session);
        rows[i] = session.row;
    }
    snow_image_free(alone.image);
    if (status != SNOW_STATUS_OK)
        return fail(context, status, true);
    return ranks_print(options, options->simulated ? "simulated" : "threads",
                       alone.seconds, rows, options->counts.count);
}

/* The ranks of MPI: the first makes its own picture while the others wait. */
static int run_mpi(snow_comm *comm, const ranks_options *options) {
    snow_context *context = snow_comm_context(comm);
    const bool first = snow_comm_rank(comm) == 0;
    ranks_alone alone = {0};
    ranks_session session = {.options = options, .alone = &alone};
    snow_status status = SNOW_STATUS_OK;
    if (first)
        status = ranks_draw_alone(context, options, &alone);
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK)
        status = ranks_body(comm, &session);
    snow_image_free(alone.image);
    if (status != SNOW_STATUS_OK)
        return fail(context, status, first);
    return first ? ranks_print(options, "mpi", alone.seconds, &session.row, 1)
                 : SNOW_STATUS_OK;
}

int bench_ranks(int argc, char **argv, snow_comm *comm) {
    ranks_options options = {.side = 512, .runs = 5};
    const bool talks = !comm || snow_comm_rank(comm) == 0;
    snow_context *context;
    int code = parse(argc, argv, comm, talks ? stderr : NULL, &options);
    if (code >= 0)
        return code;
    if (comm)
        return run_mpi(comm, &options);
    if (!options.counts.count)
        options.counts = (bench_list){4, {1, 2, 4, 8}};
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    code = run_threads(context, &options);
    snow_context_free(context);
    return code;
}
