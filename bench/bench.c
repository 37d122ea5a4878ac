/* bench/bench.c - the verb `bench`: what is measured, with which options.
 *
 * It reads its own options, since they mean nothing to other verbs, and the
 * help of the tool shows its text as it stands. */
#include "bench.h"
#include "run/start.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Seconds: rank 0 makes a picture alone while the others wait. */
#define RANKS_TIMEOUT 3600

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
    "the same for footprints of 2x2 to 5x5 (table3).  256x256 grey pictures, "
    "one\n"
    "voxel per pixel, preset linear, no shading, one thread.\n"
    "\n"
    "figure11 and figure12 print speed-ups of original and sparse splatting "
    "on up\n"
    "to 32 nodes, over the original on one node and over themselves: the "
    "nodes'\n"
    "work is measured, the network between them is simulated.\n"
    "\n"
    "speed prints how fast pictures are made while the view turns: volumes, "
    "looks,\n"
    "colours, shading, sizes, methods, encodings and threads, against "
    "original\n"
    "splatting, the same by footprint tables (original-table), and tested "
    "splatting,\n"
    "with the same kernel.  It takes many minutes.\n"
    "\n"
    "Every row is verified before its times are printed.  Figures tell on "
    "stderr how\n"
    "far they are and how long they take yet.  all prints with --json one "
    "object that\n"
    "holds that of each by its name.\n"
    "\n"
    "  --data DIR       folder that holds "
    "classic/engine_256x256x110_u8.raw.gz\n"
    "                   and classic/CThead_256x256x113_u16be.raw.gz, for "
    "speed also\n"
    "                   classic/aneurism.vti and classic/bonsai.vti; without "
    "it\n"
    "                   phantoms are used\n"
    "  --json           print one JSON object\n"
    "  --runs N         alternated runs whose median is taken, 5 to 99 (7)\n"
    "  --help           this text\n"
    "\n"
    "tables:\n"
    "  --kernel NAME    gauss, tent, bspline or box (gauss)\n"
    "  --azimuth DEG    turn the camera from +z (0)\n"
    "  --elevation DEG  (0)\n"
    "\n"
    "speed:\n"
    "  --volumes LIST   of engine, head, aneurism, bonsai, cube, shells, "
    "cube512,\n"
    "                   engine512, head512 (all that are there, but for those "
    "of\n"
    "                   512x512x512)\n"
    "  --large          those, too: some minutes for each picture\n"
    "  --sizes LIST     sides of the square picture in pixels (512)\n"
    "  --threads LIST   (1 and all processors)\n"
    "  --only LIST      of translucent, opaque, grey, rgba, unshaded, phong,\n"
    "                   original, original-table, tested, footprint, "
    "shear-warp,\n"
    "                   raycast, auto, crs, bitmap, rle, draft, normal, high,\n"
    "                   bspline, tent: words of one kind add up, kinds "
    "restrict\n"
    "                   each other; raycast is measured only where it is "
    "named\n"
    "  --sweep NAME     instead: phantoms by sparse ratio (sparse) or by size "
    "(size)\n"
    "  --chart FILE     draw the sweep (sparse unless told) as SVG; of the "
    "figures,\n"
    "                   too\n"
    "  --quick          one run on a tiny phantom: a test, no measurement\n";

/* What is measured, by name: a new one is a file and a line here. */
static const struct bench_entry {
    const char *name;
    int (*run)(snow_context *context, const bench_options *options);
    const char *letters; /* its options beside those of all: none is ignored */
    bool needs_data;     /* all three volumes, when --data is given */
} entries[] = {
    {"table1", bench_table1, "kae", true},
    {"table2", bench_table2, "kae", true},
    {"table3", bench_table3, "kae", true},
    {"figure11", bench_figure11, "cq", true},
    {"figure12", bench_figure12, "cq", true},
    {"speed", bench_speed, "qlvocwst", false},
};

/* What runs on the ranks that there are, or on threads of its own; it reads its
 * own options. */
static const struct bench_ranks {
    const char *name;
    int (*run)(int argc, char **argv, snow_comm *comm);
} of_ranks[] = {{"ranks", bench_ranks}};

#define OF_ALL "djrh"

#define ENTRY_COUNT (sizeof entries / sizeof entries[0])
#define RANKS_COUNT (sizeof of_ranks / sizeof of_ranks[0])

/* The library's message is complete: what is wrong; what to try. */
int bench_fail(snow_context *context, snow_status status) {
    fprintf(stderr, "snowglass: bench: %s\n", snow_context_message(context));
    return (int)status;
}

static int usage_error(const char *what, const char *value) {
    fprintf(stderr, "snowglass: bench: %s '%s'; see snowglass bench --help\n",
            what, value);
    return SNOW_STATUS_BAD_USAGE;
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

/* Whole numbers with commas between them. */
static bool parse_list(const char *text, int low, int high, bench_list *out) {
    bench_list list = {0};
    for (const char *at = text;; at++) {
        char *end;
        long value = strtol(at, &end, 10);
        if (end == at || *at == ' ' || value < low || value > high ||
            list.count == BENCH_LIST_MOST)
            return false;
        list.values[list.count++] = (int)value;
        at = end;
        if (*at != ',')
            break;
    }
    if (text[strspn(text, "0123456789,")])
        return false;
    *out = list;
    return true;
}

/* The options of `speed` alone. */
static bool take_speed_option(int option, const char *value,
                              bench_options *out) {
    switch (option) {
    case 'q':
        return out->quick = true;
    case 'l':
        return out->large = true;
    case 'v':
        out->volumes = value;
        return true;
    case 'o':
        out->only = value;
        return true;
    case 'c':
        out->chart = value;
        return *value;
    case 'w':
        out->sweep = value;
        return strcmp(value, "sparse") == 0 || strcmp(value, "size") == 0;
    case 's':
        return parse_list(value, 1, 8192, &out->sides);
    default:
        return parse_list(value, 1, 256, &out->threads);
    }
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
        if ((kernel = snow_kernel_from_name(value)) < 0)
            return false;
        out->kernel = (snow_kernel)kernel;
        return true;
    case 'a':
        return parse_number(value, -1e6, 1e6, &out->azimuth);
    case 'e':
        return parse_number(value, -1e6, 1e6, &out->elevation);
    default:
        return take_speed_option(option, value, out);
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

#define OPTIONS_MOST 32

/* The words of a command line, as they were written. */
typedef struct bench_command {
    const char *name;
    int count;
    char letters[OPTIONS_MOST]; /* of the options, and their words */
    const char *words[OPTIONS_MOST];
} bench_command;

static bool is_all(const bench_command *command) {
    return strcmp(command->name, "all") == 0;
}

static const struct bench_entry *find_entry(const char *name) {
    for (size_t i = 0; i < ENTRY_COUNT; i++)
        if (strcmp(name, entries[i].name) == 0)
            return &entries[i];
    return NULL;
}

/* The names that there are, for a message. */
static void list_names(char *out, size_t size) {
    size_t used = (size_t)snprintf(out, size, "all");
    for (size_t i = 0; i < ENTRY_COUNT && used < size; i++)
        used +=
            (size_t)snprintf(out + used, size - used, " %s", entries[i].name);
    for (size_t i = 0; i < RANKS_COUNT && used < size; i++)
        used +=
            (size_t)snprintf(out + used, size - used, " %s", of_ranks[i].name);
}

/* `name` is NULL if there is none, or too many. */
static int name_error(const char *what, const char *name) {
    char names[256];
    list_names(names, sizeof names);
    fprintf(stderr, "snowglass: bench: %s%s%s%s; choose one of: %s\n", what,
            name ? " '" : "", name ? name : "", name ? "'" : "", names);
    return SNOW_STATUS_BAD_USAGE;
}

static int check_letters(const bench_command *command,
                         const struct bench_entry *entry) {
    for (int i = 0; i < command->count; i++)
        if (!strchr(entry->letters, command->letters[i]) &&
            !strchr(OF_ALL, command->letters[i])) {
            char what[64];
            snprintf(what, sizeof what,
                     "this is no option of bench %s:", entry->name);
            return usage_error(what, command->words[i]);
        }
    return -1;
}

static int check_quick(const bench_options *options) {
    if (options->quick && options->data)
        return usage_error("--quick has its own volumes; leave out",
                           options->data);
    return -1;
}

/* Sweeps and the quick run have volumes of their own. */
static int check_speed(const bench_options *options) {
    bool own = options->quick || options->sweep || options->chart;
    bool by_size = options->sweep && strcmp(options->sweep, "size") == 0;
    if ((options->chart || options->sweep) && options->large && !by_size)
        return usage_error("there are no large volumes in this sweep; leave "
                           "out",
                           "--large");
    if ((options->chart || options->sweep) && options->sides.count > 1)
        return usage_error("a sweep has one size; leave out all but one of",
                           "--sizes");
    if (options->quick && options->large)
        return usage_error("--quick has its own volumes; leave out", "--large");
    if (own && (options->volumes || options->data))
        return usage_error("--quick and sweeps have their own volumes; leave "
                           "out",
                           options->data ? "--data" : "--volumes");
    return -1;
}

static int check_command(const bench_command *command,
                         const bench_options *options) {
    static const struct bench_entry every = {"all", NULL, "q", true};
    const struct bench_entry *entry =
        is_all(command) ? &every : find_entry(command->name);
    if (!entry)
        return name_error("there is no benchmark", command->name);
    int code = check_letters(command, entry);
    if (code < 0 && entry->run == bench_speed)
        return check_speed(options);
    return code < 0 ? check_quick(options) : code;
}

/* Parses the command line into options and `*name`; an exit code, or -1 to go
 * on. */
static int parse(int argc, char **argv, bench_options *options,
                 bench_command *command) {
    static const struct option longs[] = {
        {"data", required_argument, NULL, 'd'},
        {"json", no_argument, NULL, 'j'},
        {"runs", required_argument, NULL, 'r'},
        {"kernel", required_argument, NULL, 'k'},
        {"azimuth", required_argument, NULL, 'a'},
        {"elevation", required_argument, NULL, 'e'},
        {"quick", no_argument, NULL, 'q'},
        {"large", no_argument, NULL, 'l'},
        {"volumes", required_argument, NULL, 'v'},
        {"only", required_argument, NULL, 'o'},
        {"chart", required_argument, NULL, 'c'},
        {"sweep", required_argument, NULL, 'w'},
        {"sizes", required_argument, NULL, 's'},
        {"threads", required_argument, NULL, 't'},
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
            return SNOW_STATUS_OK;
        }
        if (!take_option(option, optarg, options))
            return usage_error("this value is not possible:", optarg);
        if (command->count == OPTIONS_MOST)
            return usage_error("too many options:", option_word(argv));
        command->letters[command->count] = (char)option;
        command->words[command->count++] = option_word(argv);
    }
    /* getopt has moved the words that are no options behind the others. */
    if (optind + 1 != argc)
        return name_error(optind < argc ? "give one thing to measure, without"
                                        : "give one thing to measure",
                          optind < argc ? argv[optind + 1] : NULL);
    command->name = argv[optind];
    return check_command(command, options);
}

static const struct bench_ranks *find_of_ranks(int argc, char **argv) {
    for (size_t i = 0; argc > 1 && i < RANKS_COUNT; i++)
        if (strcmp(argv[1], of_ranks[i].name) == 0)
            return &of_ranks[i];
    return NULL;
}

bool bench_for_all(int argc, char **argv) {
    return find_of_ranks(argc, argv) != NULL;
}

static int run_entry(const struct bench_entry *entry,
                     const bench_options *options) {
    snow_context *context;
    if (entry->needs_data && !bench_data_found(options))
        return SNOW_STATUS_BAD_INPUT;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    int code = entry->run(context, options);
    snow_context_free(context);
    return code;
}

/* What stands before a benchmark's own lines, or its object. */
static void print_name(const bench_options *options, const char *name,
                       size_t number) {
    fprintf(stderr, "snowglass: bench all: %s, %zu of %zu\n", name, number + 1,
            ENTRY_COUNT);
    if (options->json)
        printf("%s\"%s\":\n", number ? ",\n" : "{\n", name);
    else
        printf("%s--- %s ---\n", number ? "\n" : "", name);
    fflush(stdout);
}

/* The first fault ends it.  What needs a file is left out. */
static int run_all(const bench_options *options) {
    int code =
        bench_data_found(options) ? SNOW_STATUS_OK : SNOW_STATUS_BAD_INPUT;
    for (size_t i = 0; i < ENTRY_COUNT && code == SNOW_STATUS_OK; i++) {
        print_name(options, entries[i].name, i);
        code = run_entry(&entries[i], options);
    }
    if (options->json && code == SNOW_STATUS_OK)
        puts("}");
    return code;
}

int bench_main(int argc, char **argv) {
    const struct bench_ranks *ranks = find_of_ranks(argc, argv);
    if (ranks) {
        if (process_comm())
            snow_comm_set_timeout(process_comm(), RANKS_TIMEOUT);
        return ranks->run(argc - 1, argv + 1, process_comm());
    }
    bench_options options = {.kernel = SNOW_KERNEL_GAUSS};
    bench_command command = {0};
    int code = parse(argc, argv, &options, &command);
    if (code >= 0)
        return code;
    if (!options.runs)
        options.runs = options.quick ? 1 : 7;
    return is_all(&command) ? run_all(&options)
                            : run_entry(find_entry(command.name), &options);
}
