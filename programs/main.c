/* main.c - the tool: finds the verb, runs it and returns its exit code.  The
 * main functions are in main_alone.c and mpi_main.c.
 *
 * The first word is a verb, or the call is a plain `render`.  The tool uses the
 * public headers only.  Its exit codes are the library's status values and
 * 130. */
#include "commands/commands.h"
#include "options/config.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/sibling.h"
#include "run/start.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* If a standard stream is closed, the next opened file would take its place and
 * receive output that was meant for the stream. */
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

/* `help` takes a word; other verbs take files. */
static int run_help(const options *asked) {
    if (asked->operand_count > 1)
        return fail_usage(
            "%s: is one word too many; help takes one topic or verb",
            asked->operands[1]);
    return help_print(asked->operand_count ? asked->operands[0] : NULL, NULL);
}

/* bench is not in the list: it reads its own arguments. */
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
    case VERB_TF:
        return cmd_tf(asked);
    case VERB_DOCTOR:
        return cmd_doctor(asked);
    default:
        return run_help(asked);
    }
}

/* Verbs that render run on all ranks.  Any other verb runs on one rank; the
 * others wait for its exit code, however long it takes. */
static bool is_for_all(const verb_row *verb) {
    return (verb->bit & (VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE)) != 0;
}

/* `named` is false if the verb was not written and render is assumed. */
static int run_command(const verb_row *verb, bool named, int argc,
                       char **argv) {
    options asked;
    options_init(&asked);
    int done = options_parse(&asked, verb, argc, argv);
    if (done != CONTINUE)
        return done;
    if (asked.version)
        return print_version();
    if (asked.help && !launch_talks())
        return SNOW_STATUS_OK;
    if (asked.help)
        return help_print(asked.help_word,
                          named && verb->bit != VERB_HELP ? verb : NULL);
    if (launch_ranks() > 1 && is_for_all(verb))
        snow_comm_set_timeout(launch_comm(), asked.timeout);
    done = config_check(&asked);
    if (done == CONTINUE)
        done = look_load(&asked); /* on every rank: the file is small */
    if (is_for_all(verb))
        done = launch_agree(done);
    if (done != CONTINUE) {
        look_unload(&asked);
        return done;
    }
    double begin = seconds_now();
    done = run_verb(verb, &asked);
    if (done == SNOW_STATUS_OK)
        done = config_save(&asked);
    look_unload(&asked);
    if (asked.verbosity > 0 &&
        verb->bit != VERB_RENDER) /* render reports more itself */
        say("seconds: total %.3f", seconds_now() - begin);
    return done;
}

/* Only the first word can be a verb: a file of that name is ./NAME. */
static int dispatch(int argc, char **argv) {
    if (argc < 2) {
        help_hint();
        return SNOW_STATUS_BAD_USAGE;
    }
    const verb_row *verb = verb_named(argv[1]);
    if (!verb)
        return run_command(verb_of(VERB_RENDER), false, argc, argv);
    if (!verb->bit)
        return fail_usage("%s is not built yet; %s", verb->name, verb->text);
    if (verb->bit == VERB_BENCH) /* of MPI: mpi_main.c */
        return sibling_become("snowglass-bench", argv + 1);
    if (!is_for_all(verb) && !launch_talks())
        return SNOW_STATUS_OK;
    return run_command(verb, true, argc - 1, argv + 1);
}

int tool_run(int argc, char **argv, const launch *how) {
    fill_standard_streams();
    launch_begin(how);
    interrupt_install();
    int done = launch_agree(dispatch(argc, argv));
    if (launch_ranks() >
        1) /* the launcher would end all ranks with the first failure */
        interrupt_mute();
    return done;
}
