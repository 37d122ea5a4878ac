/* bench/bench.c - the verb `bench`: what is measured, by name. */
#include "bench.h"
#include "run/start.h"

#include <stdio.h>
#include <string.h>

/* Seconds: rank 0 makes a picture alone while the others wait. */
#define RANKS_TIMEOUT 3600

/* What is measured, by name: a new one is a file and a line here. */
static const bench_entry entries[] = {
    {"table1", bench_table1, BENCH_OF_TABLES, true},
    {"table2", bench_table2, BENCH_OF_TABLES, true},
    {"table3", bench_table3, BENCH_OF_TABLES, true},
    {"figure11", bench_figure11, BENCH_OF_FIGURES, true},
    {"figure12", bench_figure12, BENCH_OF_FIGURES, true},
    {"speed", bench_speed, BENCH_OF_SPEED, false},
};
static const bench_entry every = {"all", NULL, BENCH_OF_ALL, true};

#define ENTRY_COUNT (sizeof entries / sizeof entries[0])

const char *bench_method_name(snow_method method) {
    return method == SNOW_METHOD_TESTED ? "tested" : snow_method_name(method);
}

/* The library's message is complete: what is wrong; what to try. */
int bench_fail(snow_context *context, snow_status status) {
    fprintf(stderr, "snowglass: bench: %s\n", snow_context_message(context));
    return (int)status;
}

static const bench_entry *find_entry(const char *name) {
    if (strcmp(name, every.name) == 0)
        return &every;
    for (size_t i = 0; i < ENTRY_COUNT; i++)
        if (strcmp(name, entries[i].name) == 0)
            return &entries[i];
    return NULL;
}

static int name_error(const char *what, const char *name) {
    fprintf(stderr, "snowglass: bench: %s%s%s%s; choose one of: all", what,
            *name ? " '" : "", name, *name ? "'" : "");
    for (size_t i = 0; i < ENTRY_COUNT; i++)
        fprintf(stderr, " %s", entries[i].name);
    fprintf(stderr, " ranks\n");
    return SNOW_STATUS_BAD_USAGE;
}

static bool is_ranks(int argc, char **argv) {
    return argc > 1 && strcmp(argv[1], "ranks") == 0;
}

bool bench_for_all(int argc, char **argv) {
    return is_ranks(argc, argv);
}

static int run_entry(const bench_entry *entry, const bench_options *options) {
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
static void print_name(const bench_options *options, size_t number) {
    const char *name = entries[number].name;
    fprintf(stderr, "snowglass: bench all: %s, %zu of %zu\n", name, number + 1,
            ENTRY_COUNT);
    if (options->json)
        printf("%s\"%s\":\n", number ? ",\n" : "{\n", name);
    else
        printf("%s--- %s ---\n", number ? "\n" : "", name);
    fflush(stdout);
}

/* The first fault ends it.  `ranks` needs a file. */
static int run_all(const bench_options *options) {
    int code =
        bench_data_found(options) ? SNOW_STATUS_OK : SNOW_STATUS_BAD_INPUT;
    for (size_t i = 0; i < ENTRY_COUNT && code == SNOW_STATUS_OK; i++) {
        print_name(options, i);
        code = run_entry(&entries[i], options);
    }
    if (options->json && code == SNOW_STATUS_OK)
        puts("}");
    return code;
}

int bench_main(int argc, char **argv) {
    bench_options options = {.kernel = SNOW_KERNEL_GAUSS};
    if (is_ranks(argc, argv)) {
        if (process_comm())
            snow_comm_set_timeout(process_comm(), RANKS_TIMEOUT);
        return bench_ranks(argc - 1, argv + 1, process_comm());
    }
    if (argc < 2)
        return name_error("give one thing to measure", "");
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)
        return bench_print_help();
    const bench_entry *entry = find_entry(argv[1]);
    if (!entry)
        return name_error("there is no benchmark", argv[1]);
    int code = bench_options_read(entry, argc - 1, argv + 1, &options);
    if (code >= 0)
        return code;
    return entry == &every ? run_all(&options) : run_entry(entry, &options);
}
