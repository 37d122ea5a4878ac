/* bench/frame/frame.c - `snowglass bench frame`: its options, and who its ranks
 * are.
 */
#include "frame.h"
#include "option_table.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: snowglass bench frame INPUT [options]\n"
    "\n"
    "Makes one picture of a volume by many ranks, and prints what it took as "
    "one\n"
    "line of key=value: milliseconds of each stage, of the slowest rank and "
    "in\n"
    "the mean, and exact counts of messages and voxels.  The ranks are threads "
    "of\n"
    "one process, or under mpirun those of snowglass-mpi; each works on one\n"
    "thread.  Up to 64 ranks, the picture is compared with that of one rank, "
    "and\n"
    "a wrong one is a failure (exit code 1).\n"
    "\n"
    "  --ranks N        of threads (8)\n"
    "  --dims XxYxZ     of a raw file, or a phantom\n"
    "  --type NAME      of a raw file, such as uint8\n"
    "  --size WxH       of the picture in pixels, or one number (512)\n"
    "  --threshold X    opacity 0 to 255 (0)\n"
    "  --azimuth DEG    (0)\n"
    "  --elevation DEG  (0)\n"
    "  --cut NAME       auto, equal, counted, bricks or measured (auto)\n"
    "  --combine NAME   auto, tree, swap, direct or radix (auto)\n"
    "  --radix K        of radix (chosen)\n"
    "  --check          compare also where there are more than 64 ranks\n"
    "  --no-check       never compare\n"
    "  --network LATENCY,BANDWIDTH,OVERHEAD\n"
    "                   model it: seconds of a message, bytes a second, "
    "seconds\n"
    "                   of the processor for a message, at both ends.  Ranks "
    "work\n"
    "                   one at a time, as if each had a machine of its own\n"
    "  --runs N         further pictures, of which the fastest counts (3)\n"
    "  --turn N         also N pictures of the volume, turned by a degree "
    "each:\n"
    "                   one after another, then each splatted while the one "
    "before\n"
    "                   it is combined; the fastest of --runs times counts\n"
    "  --alpha SECONDS  of the bound: a message's latency (1.5e-6, or that "
    "of\n"
    "                   --network)\n"
    "  --beta SECONDS   for a byte (1 / 12.125e9, or that of --network)\n"
    "  --profile FILE   write what each rank works, for bench combine\n"
    "  --json           print a JSON object\n"
    "\n"
    "voxels are the interesting ones of a rank's own part; their sum is "
    "that of\n"
    "the volume.\n"
    "\n"
    "read is of the volume; encode, first and first_cpu are of the first "
    "picture,\n"
    "all else of a later one, whose encoding is there.  total is until the "
    "last\n"
    "rank is done.  All are also told in processor time of the ranks (_cpu), "
    "which\n"
    "is what counts where ranks share processors; that of encode is what the "
    "first\n"
    "picture took more than a later one, and of splat what else it is to make "
    "a\n"
    "local image.  bytes_early_sum of bytes_sent_sum went before that was "
    "done.\n"
    "rank_per_node is the most that a machine has.  bound is "
    "what "
    "no\n"
    "method of exchange and gather can beat, ratio what these took over it.\n"
    "projected_ms is\n"
    "what the simulated machine takes for a picture, t1_ms what one rank "
    "takes\n"
    "(processor time), efficiency t1_ms over ranks and projected_ms.  turn_ms "
    "and\n"
    "turn_overlap_ms are of one picture of a turning volume, without and with\n"
    "overlap; hidden_ms of the latter was splatted where a rank else had "
    "waited.\n"
    "work_cpu is all processor time of a picture but the transport's, which "
    "asks\n"
    "while it waits.\n"
    "splat_least and work_least are of each rank the fastest of --runs, and "
    "splat_uneven the\n"
    "slowest rank's over the mean; with --cut measured after the last of the\n"
    "cuts_by_time, which are made in the first two thirds of --runs.\n"
    "Where these pictures differ in a bit, the exit code is 1.\n";

static const char *const cuts[] = {"auto",   "equal",    "counted",
                                   "bricks", "measured", NULL};
static const char *const combinings[] = {"auto",   "tree",  "swap",
                                         "direct", "radix", NULL};

/* Options that are words to be read further. */
typedef struct texts {
    const char *dims, *type, *size, *network;
} texts;

/* --- options -------------------------------------------------------------- */

/* Up to `count` whole numbers of 1 to `most` with an x between; how many there
 * are, 0 where the text is none. */
static int read_sizes(const char *text, int64_t most, int64_t *out, int count) {
    int64_t sizes[3];
    for (int i = 0; i < count; i++) {
        char *end;
        if (*text < '0' || *text > '9')
            return 0;
        sizes[i] = strtoll(text, &end, 10);
        if (sizes[i] < 1 || sizes[i] > most || (*end && *end != 'x'))
            return 0;
        if (!*end) {
            memcpy(out, sizes, sizeof *out * (size_t)(i + 1));
            return i + 1;
        }
        text = end + 1;
    }
    return 0;
}

static bool read_picture_size(const char *text, frame_options *out) {
    int64_t sizes[2];
    int count = read_sizes(text, 32768, sizes, 2);
    if (!count)
        return false;
    out->width = (int)sizes[0];
    out->height = (int)sizes[count - 1];
    return true;
}

static bool read_network(const char *text, snow_network *out) {
    double numbers[3];
    for (int i = 0; i < 3; i++) {
        char *end;
        numbers[i] = strtod(text, &end);
        bool good = end != text && *end == (i < 2 ? ',' : '\0') &&
                    numbers[i] >= 0 && numbers[i] <= 1e18;
        if (!good)
            return false;
        text = end + 1;
    }
    *out = (snow_network){.latency = numbers[0],
                          .bandwidth = numbers[1],
                          .overhead = numbers[2],
                          .slowness = 1};
    return out->bandwidth > 0;
}

/* The text that cannot be read; NULL: all were. */
static const char *read_texts(const texts *t, frame_options *out) {
    snow_volume_options_init(&out->data);
    if (t->dims && read_sizes(t->dims, INT64_MAX, out->data.dims, 3) != 3)
        return t->dims;
    if (t->type && !(out->data.type = snow_type_from_name(t->type)))
        return t->type;
    if (t->size && !read_picture_size(t->size, out))
        return t->size;
    if (t->network && !read_network(t->network, &out->network))
        return t->network;
    out->simulated = t->network != NULL;
    return NULL;
}

/* What does not go together. */
static int check(const bench_option_table *table, const frame_options *options,
                 const snow_comm *comm, FILE *said) {
    if (!options->path)
        return bench_option_table_fail(table, said,
                                       "there is no INPUT; name a file", "");
    if (options->check && options->no_check)
        return bench_option_table_fail(table, said, "leave out --check or",
                                       "--no-check");
    if (options->radix && options->combining != SNOW_COMBINE_RADIX)
        return bench_option_table_fail(
            table, said, "only --combine radix has a radix; leave out",
            "--radix");
    if (comm && options->ranks)
        return bench_option_table_fail(
            table, said, "mpirun tells how many ranks; leave out", "--ranks");
    if (comm && options->simulated)
        return bench_option_table_fail(
            table, said, "MPI's network is not simulated; leave out",
            "--network");
    return -1;
}

static int parse(int argc, char **argv, const snow_comm *comm, FILE *said,
                 frame_options *out) {
    int cut = 0, combining = 0;
    bool helps = false;
    texts t = {0};
    const bench_option entries[] = {
        {"--ranks", BENCH_WHOLE, &out->ranks, 1, 4096, NULL},
        {"--dims", BENCH_TEXT, &t.dims, 0, 0, NULL},
        {"--type", BENCH_TEXT, &t.type, 0, 0, NULL},
        {"--size", BENCH_TEXT, &t.size, 0, 0, NULL},
        {"--threshold", BENCH_NUMBER, &out->threshold, 0, 255, NULL},
        {"--azimuth", BENCH_NUMBER, &out->azimuth, -1e6, 1e6, NULL},
        {"--elevation", BENCH_NUMBER, &out->elevation, -1e6, 1e6, NULL},
        {"--cut", BENCH_CHOICE, &cut, 0, 0, cuts},
        {"--combine", BENCH_CHOICE, &combining, 0, 0, combinings},
        {"--radix", BENCH_WHOLE, &out->radix, 2, 64, NULL},
        {"--check", BENCH_FLAG, &out->check, 0, 0, NULL},
        {"--no-check", BENCH_FLAG, &out->no_check, 0, 0, NULL},
        {"--network", BENCH_TEXT, &t.network, 0, 0, NULL},
        {"--runs", BENCH_WHOLE, &out->runs, 1, 1000, NULL},
        {"--alpha", BENCH_NUMBER, &out->alpha, 0, 1, NULL},
        {"--beta", BENCH_NUMBER, &out->beta, 0, 1, NULL},
        {"--turn", BENCH_WHOLE, &out->turn, 2, 10000, NULL},
        {"--json", BENCH_FLAG, &out->json, 0, 0, NULL},
        {"--profile", BENCH_TEXT, &out->profile, 0, 0, NULL},
        {"--help", BENCH_FLAG, &helps, 0, 0, NULL},
    };
    const bench_option_table table = {
        "frame", entries, sizeof entries / sizeof *entries, &out->path};
    int code = bench_option_table_read(&table, argc, argv, said);
    if (code >= 0)
        return code;
    if (helps && said)
        fputs(help, stdout);
    if (helps)
        return SNOW_STATUS_OK;
    const char *bad = read_texts(&t, out);
    if (bad)
        return bench_option_table_fail(&table, said,
                                       "this value is not possible:", bad);
    out->cut = (snow_partition)cut;
    out->combining = (snow_combine)combining;
    return check(&table, out, comm, said);
}

/* --- ranks ---------------------------------------------------------------- */

static int report(snow_context *context, snow_status status,
                  const frame_session *session, bool talks) {
    if (!talks)
        return (int)status;
    if (status == SNOW_STATUS_OK)
        return frame_print(session->options, &session->result);
    fprintf(stderr, "snowglass: bench frame: %s\n",
            snow_context_message(context));
    return (int)status;
}

static int run_threads(frame_session *session) {
    const frame_options *options = session->options;
    snow_context *context;
    snow_status status;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    if (options->simulated)
        status = snow_comm_run_simulated(
            context, options->ranks, &options->network, frame_body, session);
    else
        status =
            snow_comm_run_threads(context, options->ranks, frame_body, session);
    int code = report(context, status, session, true);
    snow_context_free(context);
    return code;
}

int frame_main(int argc, char **argv, snow_comm *comm) {
    frame_options options = {
        .width = 512, .height = 512, .runs = 3, .alpha = -1, .beta = -1};
    frame_session session = {.options = &options, .threads = !comm};
    bool talks = !comm || snow_comm_rank(comm) == 0;
    int code = parse(argc, argv, comm, talks ? stderr : NULL, &options);
    if (code >= 0)
        return code;
    if (!options.ranks)
        options.ranks = 8;
    if (!comm)
        return run_threads(&session);
    return report(snow_comm_context(comm), frame_body(comm, &session), &session,
                  talks);
}
