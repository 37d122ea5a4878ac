/* bench/combine.c - `snowglass bench combine`: its options, and ranks that are
 * threads of one process.  The same options are read by the program of
 * simulated networks (mpi_combine.c). */
#include "combine.h"

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
    "random pixels.  Ranks are those of MPI, or threads of one process.\n"
    "\n"
    "  --ranks N        where they are threads (8)\n"
    "  --size N         side of the square picture in pixels (512)\n"
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
    "  --rates          only what one processor takes for a pixel\n"
    "  --runs N         of which the fastest counts (5)\n"
    "  --json           print a JSON object\n"
    "\n"
    "  --azimuth DEG    of the cube (30)\n"
    "  --elevation DEG  (20)\n"
    "  --cube X         its side, of the picture's (0.68)\n"
    "  --fill X         part of a 32nd's footprint that is active (0.3)\n"
    "  --grain N        pixels that are active together (1)\n"
    "\n"
    "  --alpha SECONDS  of the bound: a message's latency (1.5e-6)\n"
    "  --beta SECONDS   for a byte (1 / 12.125e9)\n"
    "  --scan SECONDS   what a simulated processor takes to look at a pixel\n"
    "                   (0.1e-9)\n"
    "  --blend SECONDS  to lay one over another (0.25e-9)\n";

/* --- options -------------------------------------------------------------- */

typedef enum kind { WORD, WHOLE_NUMBER, NUMBER, CHOICE } kind;

/* An option: where its value goes, and what values there are. */
typedef struct setting {
    const char *name;
    kind kind;
    void *value;
    double low, high;
    const char *const *choices; /* of a CHOICE, NULL at the end */
} setting;

static const char *const methods[] = {"auto",   "tree",  "swap",
                                      "direct", "radix", NULL};
static const char *const piece_names[] = {"auto", "even", "counted",
                                          "interlaced", NULL};

static bool parse_number(const char *text, double low, double high,
                         double *out) {
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high))
        return false;
    *out = value;
    return true;
}

/* Takes a value; false when it is none. */
static bool take(const setting *o, const char *text) {
    double number;
    if (o->kind == CHOICE) {
        for (int i = 0; o->choices[i]; i++)
            if (strcmp(text, o->choices[i]) == 0) {
                *(int *)o->value = i;
                return true;
            }
        return false;
    }
    if (!parse_number(text, o->low, o->high, &number))
        return false;
    if (o->kind == NUMBER) {
        *(double *)o->value = number;
        return true;
    }
    *(int *)o->value = (int)number;
    return (double)(int)number == number;
}

static int usage_error(FILE *said, const char *what, const char *word) {
    if (said)
        fprintf(said,
                "snowglass: bench combine: %s '%s'; see snowglass bench "
                "combine --help\n",
                what, word);
    return SNOW_BAD_USAGE;
}

int combine_parse(int argc, char **argv, combine_options *out, FILE *said) {
    int method = 0, pieces = 0;
    bool grey = false, floats = false, helps = false;
    *out = (combine_options){.size = 512,
                             .runs = 5,
                             .azimuth = 30,
                             .elevation = 20,
                             .fill = 0.3,
                             .cube = 0.68,
                             .grain = 1,
                             .alpha = 1.5e-6,
                             .beta = 1 / 12.125e9,
                             .scan = 0.1e-9,
                             .blend = 0.25e-9};
    const setting settings[] = {
        {"--ranks", WHOLE_NUMBER, &out->ranks, 1, 4096, NULL},
        {"--size", WHOLE_NUMBER, &out->size, 1, 32768, NULL},
        {"--method", CHOICE, &method, 0, 0, methods},
        {"--radix", WHOLE_NUMBER, &out->radix, 2, 4096, NULL},
        {"--gather", WHOLE_NUMBER, &out->gather, 2, 4096, NULL},
        {"--pieces", CHOICE, &pieces, 0, 0, piece_names},
        {"--whole", WORD, &out->whole, 0, 0, NULL},
        {"--grey", WORD, &grey, 0, 0, NULL},
        {"--floats", WORD, &floats, 0, 0, NULL},
        {"--check", WORD, &out->check, 0, 0, NULL},
        {"--sizes-only", WORD, &out->sizes_only, 0, 0, NULL},
        {"--rates", WORD, &out->rates, 0, 0, NULL},
        {"--runs", WHOLE_NUMBER, &out->runs, 1, 1000, NULL},
        {"--json", WORD, &out->json, 0, 0, NULL},
        {"--azimuth", NUMBER, &out->azimuth, -1e6, 1e6, NULL},
        {"--elevation", NUMBER, &out->elevation, -1e6, 1e6, NULL},
        {"--cube", NUMBER, &out->cube, 0, 4, NULL},
        {"--fill", NUMBER, &out->fill, 0, 1, NULL},
        {"--grain", WHOLE_NUMBER, &out->grain, 1, 32768, NULL},
        {"--alpha", NUMBER, &out->alpha, 0, 1, NULL},
        {"--beta", NUMBER, &out->beta, 0, 1, NULL},
        {"--scan", NUMBER, &out->scan, 0, 1, NULL},
        {"--blend", NUMBER, &out->blend, 0, 1, NULL},
        {"--help", WORD, &helps, 0, 0, NULL},
    };
    for (int i = 1; i < argc; i++) {
        const setting *o = NULL;
        for (size_t k = 0; k < sizeof settings / sizeof *settings; k++)
            if (strcmp(argv[i], settings[k].name) == 0)
                o = &settings[k];
        if (!o)
            return usage_error(said, "there is no option", argv[i]);
        if (o->kind == WORD)
            *(bool *)o->value = true;
        else if (i + 1 == argc)
            return usage_error(said, "a value is missing after", argv[i]);
        else if (!take(o, argv[++i]))
            return usage_error(said, "this value is not possible:", argv[i]);
    }
    out->method = (snow_combining)method;
    out->pieces = (snow_pieces)pieces;
    out->channels = grey ? 2 : 4;
    out->bits = floats ? 0 : 8;
    if (helps && said)
        fputs(help, stdout);
    if (helps)
        return SNOW_OK;
    if (out->check && out->sizes_only)
        return usage_error(said, "there are no pixels to look at; leave out",
                           "--check");
    return -1;
}

/* Ranks that are threads of this process. */
static snow_status run_threads(snow_context *context, combine_session *session,
                               int ranks) {
    snow_status status =
        snow_comm_threads(context, ranks, combine_body, session);
    if (status != SNOW_OK)
        fprintf(stderr, "snowglass: bench combine: %s\n",
                snow_context_message(context));
    return status;
}

static int run_alone(combine_session *session, int ranks) {
    snow_context *context;
    if (snow_context_new(NULL, &context) != SNOW_OK)
        return SNOW_NO_MEMORY;
    snow_status status = run_threads(context, session, ranks);
    snow_context_free(context);
    return status == SNOW_OK ? combine_print(session) : (int)status;
}

int combine_run(snow_comm *comm, combine_session *session) {
    const bool talks = snow_comm_rank(comm) == 0;
    snow_status status = combine_body(comm, session);
    if (status != SNOW_OK && talks)
        fprintf(stderr, "snowglass: bench combine: %s\n",
                snow_context_message(snow_comm_context(comm)));
    if (status == SNOW_OK && talks)
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
        return SNOW_BAD_USAGE;
    }
    if (options.rates)
        return talks ? combine_rates(&options) : SNOW_OK;
    combine_session session = {.options = &options};
    if (comm)
        return combine_run(comm, &session);
    return run_alone(&session, options.ranks ? options.ranks : 8);
}
