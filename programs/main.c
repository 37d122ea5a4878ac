/* main.c - the tool: which verb is meant, and what it answers; its main
 * functions are in main_alone.c and mpi_main.c.
 *
 * The first word is a verb, or the call is a bare `render`.  The tool stands on
 * the public headers only; its exit codes are the library's status values and
 * 130. */
#include "bench.h"
#include "commands.h"
#include "config.h"
#include "interrupt.h"
#include "launch.h"
#include "report.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* With a standard stream closed, the next file that is opened would take its
 * place and get what was meant for it. */
static void fill_standard_streams(void) {
    for (int handle = 0; handle <= 2; handle++) {
        if (fcntl(handle, F_GETFD) == -1)
            (void)!open("/dev/null", handle == 1 ? O_RDONLY : O_RDWR);
    }
}

static int print_version(void) {
    if (launch_talks())
        printf("snowglass %s\n", snow_version());
    return finish_stdout();
}

/* `help` takes a word where other verbs take files. */
static int run_help(const options *asked) {
    if (asked->operand_count > 1)
        return fail_usage("%s: one word too many for help; give one topic",
                          asked->operands[1]);
    return help_print(asked->operand_count ? asked->operands[0] : NULL, NULL);
}

/* bench is not among them: it reads its own arguments. */
static int run_verb(const verb_row *verb, const options *asked) {
    switch (verb->bit) {
    case VERB_RENDER:
        return cmd_render(asked);
    case VERB_TURNTABLE:
        return cmd_turntable(asked);
    case VERB_MOVIE:
        return cmd_movie(asked);
    case VERB_INFO:
        return cmd_info(asked);
    case VERB_PHANTOM:
        return cmd_phantom(asked);
    case VERB_CONVERT:
        return cmd_convert(asked);
    case VERB_COMPARE:
        return cmd_compare(asked);
    case VERB_DOCTOR:
        return cmd_doctor(asked);
    default:
        return run_help(asked);
    }
}

/* Verbs that render are for all ranks; any other is for one, and the others
 * learn its exit code, and wait for it as long as it takes. */
static bool is_for_all(const verb_row *verb) {
    return (verb->bit & (VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE)) != 0;
}

/* `named` tells a verb that was written from the one that is understood. */
static int run(const verb_row *verb, bool named, int argc, char **argv) {
    options asked;
    options_init(&asked);
    int done = options_parse(&asked, verb, argc, argv);
    if (done != GO_ON)
        return done;
    if (asked.version)
        return print_version();
    if (asked.help && !launch_talks())
        return SNOW_OK;
    if (asked.help)
        return help_print(asked.help_word,
                          named && verb->bit != VERB_HELP ? verb : NULL);
    if (launch_ranks() > 1 && is_for_all(verb))
        snow_comm_set_timeout(launch_comm(), asked.timeout);
    done = config_check(&asked);
    if (done != GO_ON)
        return done;
    double begin = seconds_now();
    done = run_verb(verb, &asked);
    if (done == SNOW_OK)
        done = config_save(&asked);
    if (asked.verbosity > 0 && verb->bit != VERB_RENDER) /* it tells more */
        say("seconds: total %.3f", seconds_now() - begin);
    return done;
}

static int run_bench(int argc, char **argv) {
    int done = bench_main(argc, argv);
    return done == SNOW_OK ? finish_stdout() : done;
}

/* Only the first word can be a verb: a file of that name is ./NAME. */
static int dispatch(int argc, char **argv) {
    if (argc < 2) {
        help_hint();
        return SNOW_BAD_USAGE;
    }
    const verb_row *verb = verb_named(argv[1]);
    if (!verb)
        return run(verb_of(VERB_RENDER), false, argc, argv);
    if (!verb->bit)
        return fail_usage("%s is not built yet; %s", verb->name, verb->text);
    bool all = is_for_all(verb) ||
               (verb->bit == VERB_BENCH && bench_for_all(argc - 1, argv + 1));
    if (!all && !launch_talks())
        return SNOW_OK;
    if (verb->bit == VERB_BENCH)
        return run_bench(argc - 1, argv + 1);
    return run(verb, true, argc - 1, argv + 1);
}

int tool_run(int argc, char **argv, const launch *how) {
    fill_standard_streams();
    launch_begin(how);
    interrupt_install();
    int done = launch_agree(dispatch(argc, argv));
    if (launch_ranks() > 1) /* whose launcher ends all with the first to fail */
        interrupt_mute();
    return done;
}
