/* bench/bench.c - the verb `bench`: which table, with what.
 *
 * It reads its own options, since they mean nothing to other verbs, and the
 * help of the tool shows its text as it stands. */
#include "bench.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: snowglass bench table1|table2|table3 [options]\n"
    "\n"
    "Prints the paper's table beside ours: sparse ratios (table1), original\n"
    "splatting against the three sparse encodings (table2), the same for\n"
    "footprints of 2x2 to 5x5 (table3).  256x256 grey pictures, one voxel per\n"
    "pixel, preset linear, no shading, one thread.  Every row is verified\n"
    "before its times are printed.\n"
    "\n"
    "  --data DIR       folder that holds "
    "classic/engine_256x256x110_u8.raw.gz\n"
    "                   and classic/CThead_256x256x113_u16be.raw.gz; without\n"
    "                   it the phantoms of these names are used\n"
    "  --json           print one JSON object\n"
    "  --runs N         alternated runs whose median is taken, 5 to 99 (7)\n"
    "  --kernel NAME    gauss, tent, bspline or box (gauss)\n"
    "  --azimuth DEG    turn the camera from +z (0)\n"
    "  --elevation DEG  (0)\n"
    "  --help           this text\n";

/* The tables by name: a new measurement is a file and a line here. */
static const struct bench_entry {
    const char *name;
    int (*run)(snow_context *context, const bench_options *options);
} entries[] = {
    {"table1", bench_table1},
    {"table2", bench_table2},
    {"table3", bench_table3},
};

#define ENTRY_COUNT (sizeof entries / sizeof entries[0])

/* The library's message is complete: what is wrong; what to try. */
int bench_fail(snow_context *context, snow_status status) {
    fprintf(stderr, "snowglass: bench: %s\n", snow_context_message(context));
    return (int)status;
}

static int usage_error(const char *what, const char *value) {
    fprintf(stderr, "snowglass: bench: %s '%s'; see snowglass bench --help\n",
            what, value);
    return SNOW_BAD_USAGE;
}

/* A finite number in range, the whole of the text.  NaN is in no range. */
static bool parse_number(const char *text, double low, double high,
                         double *out) {
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high))
        return false;
    *out = value;
    return true;
}

/* Takes one option; false when its value is bad.  Fewer than five runs give no
 * median that can be trusted; bench/measure.c has room for 99. */
static bool take_option(int option, const char *value, bench_options *out) {
    double number;
    int kernel;
    switch (option) {
    case 'd':
        out->data = value;
        return true;
    case 'j':
        out->json = true;
        return true;
    case 'r':
        if (!parse_number(value, 5, 99, &number))
            return false;
        out->runs = (int)number;
        return true;
    case 'k':
        if ((kernel = snow_kernel_named(value)) < 0)
            return false;
        out->kernel = (snow_kernel)kernel;
        return true;
    case 'a':
        return parse_number(value, -1e6, 1e6, &out->azimuth);
    default:
        return parse_number(value, -1e6, 1e6, &out->elevation);
    }
}

/* getopt_long takes any beginning of a name for the name; as in all verbs only
 * the name in full counts, so that a later option cannot change what a script
 * means. */
static bool in_full(const char *word, const char *name) {
    return strncmp(word, "--", 2) != 0 ||
           strcspn(word + 2, "=") == strlen(name);
}

/* The word of the option just read: its value may stand behind it. */
static const char *option_word(char **argv) {
    bool apart = optarg && optarg == argv[optind - 1];
    return argv[optind - (apart ? 2 : 1)];
}

/* Parses the command line into options and `*name`; an exit code, or -1 to go
 * on. */
static int parse(int argc, char **argv, bench_options *options,
                 const char **name) {
    static const struct option longs[] = {
        {"data", required_argument, NULL, 'd'},
        {"json", no_argument, NULL, 'j'},
        {"runs", required_argument, NULL, 'r'},
        {"kernel", required_argument, NULL, 'k'},
        {"azimuth", required_argument, NULL, 'a'},
        {"elevation", required_argument, NULL, 'e'},
        {"help", no_argument, NULL, 'h'},
        {NULL, 0, NULL, 0},
    };
    opterr = 0; /* we tell faults ourselves, in the tool's form */
    optind = 0; /* the tool's own parser may have run getopt before */
    for (int option, index = 0;
         (option = getopt_long(argc, argv, "h", longs, &index)) >= 0;) {
        bool known = option != '?' && option != ':';
        if (!known || !in_full(option_word(argv), longs[index].name))
            return usage_error("unknown option or missing value",
                               option_word(argv));
        if (option == 'h') {
            fputs(help, stdout);
            return SNOW_OK;
        }
        if (!take_option(option, optarg, options))
            return usage_error("this value is not possible:", optarg);
    }
    /* getopt has moved the words that are no options behind the others. */
    if (optind + 1 != argc)
        return usage_error("give one table to measure, not",
                           optind < argc ? argv[optind + 1] : "none");
    *name = argv[optind];
    return -1;
}

int bench_main(int argc, char **argv) {
    bench_options options = {.runs = 7, .kernel = SNOW_KERNEL_GAUSS};
    const char *name = NULL;
    int code = parse(argc, argv, &options, &name);
    if (code >= 0)
        return code;
    for (size_t i = 0; i < ENTRY_COUNT; i++) {
        if (strcmp(name, entries[i].name) != 0)
            continue;
        if (!bench_data_found(&options))
            return SNOW_BAD_INPUT;
        snow_context *context;
        if (snow_context_new(NULL, &context) != SNOW_OK)
            return SNOW_NO_MEMORY;
        code = entries[i].run(context, &options);
        snow_context_free(context);
        return code;
    }
    return usage_error("there is no benchmark", name);
}
