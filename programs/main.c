/* main.c - the tool: finds the verb, runs it and returns its exit code.  The
 * main functions are in main_alone.c and mpi_main.c.
 *
 * The first word is a verb, or the call is a plain `render`.  The tool uses the
 * public headers only.  Its exit codes are the library's status values, 7
 * and 130 (options.h). */
#include "commands/commands.h"
#include "commands/first.h"
#include "series/series.h"
#include "options/config.h"
#include "picture/default_name.h"
#include "run/interrupt.h"
#include "run/launcher.h"
#include "run/log.h"
#include "run/sibling.h"
#include "run/start.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>

/* bench and serve are not in the list: they are programs of their own. */
static int run_verb(const verb_row *verb, const options *opts) {
    switch (verb->bit) {
    case VERB_RENDER:
        return cmd_render(opts);
    case VERB_TURNTABLE:
        return cmd_turntable(opts);
    case VERB_SLICE:
        return cmd_slice(opts);
    case VERB_MOVIE:
        return cmd_movie(opts);
    case VERB_INFO:
        return cmd_info(opts);
    case VERB_PHANTOM:
        return cmd_phantom(opts);
    case VERB_CONVERT:
        return cmd_convert(opts);
    case VERB_EXPORT:
        return cmd_export(opts);
    case VERB_COMPARE:
        return cmd_compare(opts);
    case VERB_TF:
        return cmd_tf(opts);
    case VERB_DOCTOR:
        return cmd_doctor(opts);
    case VERB_REPORT:
        return cmd_report(opts);
    default:
        /* `help` takes a word; other verbs take files. */
        if (opts->operand_count > 1)
            return fail_usage("%s: is one word too many; help takes one name",
                              opts->operands[1]);
        return help_print(opts->operand_count ? opts->operands[0] : NULL, NULL);
    }
}

/* Verbs that render run on all ranks.  Any other verb runs on one rank; the
 * others wait for its exit code, however long it takes. */
static bool is_for_all(const verb_row *verb) {
    return (verb->bit & (VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE)) != 0;
}

/* Without MPI each process of a parallel job makes the whole picture; a job
 * whose processes have different inputs may mean that. */
static void warn_launcher(const options *opts) {
    const char *launcher;
    long rank, ranks = launcher_ranks(&launcher, &rank);
    if (ranks > 1 && rank == 0 && !process_mpi() && opts->verbosity >= 0)
        say("this is one of %ld processes that were started by %s, and each of "
            "them makes the whole output; snowglass-mpi shares the work among "
            "them",
            ranks, launcher);
}

/* What the command line asks of this rank; not more where that is nothing. */
typedef struct command {
    const verb_row *verb;
    bool named; /* the verb was written; else render is assumed */
    options opts;
} command;

static int run_command(command *c) {
    options *opts = &c->opts;
    const verb_row *verb = c->verb;
    first_volume first = {.context = NULL};
    opts->first = verb->bit == VERB_RENDER ? &first : NULL;
    if (opts->verbosity < 0 && process_ranks() == 1) /* MPI's errors are kept */
        silence_others();
    if (process_ranks() > 1 && is_for_all(verb))
        snow_comm_set_timeout(process_comm(), opts->timeout);
    if (verb->bit == VERB_EXPORT)
        export_take(opts);
    int done = series_take(opts, verb);
    if (verb->bit == VERB_RENDER)
        done = process_agree(done == CONTINUE ? default_name(opts) : done);
    else if (verb->bit == VERB_SLICE && done == CONTINUE)
        done = default_name(opts);
    if (done == CONTINUE)
        done = config_check(opts);
    if (done == CONTINUE)
        done = settle_channels(opts, verb->bit & (VERB_RENDER | VERB_TURNTABLE |
                                                  VERB_MOVIE | VERB_SLICE));
    if (done == CONTINUE &&
        (verb->bit & (VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE)))
        first_settle(opts);
    if (done == CONTINUE)
        done = look_load(opts); /* on every rank: the file is small */
    if (is_for_all(verb))
        done = process_agree(done);
    if (done != CONTINUE) {
        look_unload(opts);
        first_volume_free(&first);
        return done;
    }
    if (is_for_all(verb))
        warn_launcher(opts);
    double begin = seconds_now();
    done = run_verb(verb, opts);
    if (done == SNOW_STATUS_OK || done == EXIT_EMPTY) {
        int saved = config_save(opts, verb);
        done = saved == SNOW_STATUS_OK ? done : saved;
    }
    look_unload(opts);
    first_volume_free(&first);
    if (opts->verbosity > 0 &&
        verb->bit != VERB_RENDER) /* render reports more itself */
        say("seconds: total %.3f", seconds_now() - begin);
    return done;
}

static int read_options(command *c, int argc, char **argv) {
    options_init(&c->opts);
    int done = options_parse(&c->opts, c->verb, argc, argv);
    if (done != CONTINUE)
        return done;
    if (c->opts.version) {
        if (process_talks())
            printf("snowglass %s\n", snow_version());
        return finish_stdout();
    }
    if (c->opts.help && !process_talks())
        return SNOW_STATUS_OK;
    if (c->opts.help)
        return help_print(c->opts.help_word,
                          c->named && c->verb->bit != VERB_HELP ? c->verb
                                                                : NULL);
    return CONTINUE;
}

/* Only the first word can be a verb: a file of that name is ./NAME.  Ranks but
 * the first read no options of verbs that are not theirs. */
static int read_command(int argc, char **argv, command *c) {
    if (argc < 2) {
        help_hint();
        return SNOW_STATUS_BAD_USAGE;
    }
    const verb_row *verb = c->verb = verb_named(argv[1]);
    c->named = verb != NULL;
    if (!verb) {
        c->verb = config_verb(argc, argv);
        return read_options(c, argc, argv);
    }
    if (verb->bit == VERB_BENCH) /* of MPI: mpi_main.c */
        return sibling_become("snowglass-bench", argv + 1);
    if (verb->bit == VERB_SERVE) /* the same */
        return sibling_become("snowglass-serve", argv + 1);
    if (!is_for_all(verb) && !process_talks())
        return CONTINUE;
    /* help --window means the option, but help --help is the overview. */
    if (verb->bit == VERB_HELP && argc == 3 && argv[2][0] == '-' &&
        strcmp(argv[2], "--help") != 0 && strcmp(argv[2], "-h") != 0)
        return help_print(argv[2], NULL);
    return read_options(c, argc - 1, argv + 1);
}

/* Mixes a text, which may be none, into a word (FNV-1a). */
static uint32_t mix(uint32_t word, const char *text) {
    for (; text && *text; text++)
        word = (word ^ (unsigned char)*text) * 16777619U;
    return (word ^ (text ? 1U : 2U)) * 16777619U;
}

/* A word for what all ranks must be given alike: not how a machine works and
 * what it says. */
static int word_of(const command *c) {
    static const char *const own[] = {"threads", "memory",   "isa",
                                      "verbose", "progress", "quiet"};
    uint32_t word = 2166136261U;
    if (!c->verb || !is_for_all(c->verb))
        return 0;
    for (int i = 0; option_table[i].name; i++) {
        bool alike = true;
        for (size_t n = 0; n < sizeof own / sizeof *own; n++)
            alike = alike && strcmp(option_table[i].name, own[n]) != 0;
        word = alike ? mix(word, c->opts.given[i]) : word;
    }
    for (int i = 0; i < c->opts.operand_count; i++)
        word = mix(word, c->opts.operands[i]);
    return (int)(word >> 1);
}

/* All ranks learn of a wrong command, or of another one, before any waits. */
static int dispatch(int argc, char **argv) {
    command c = {.verb = NULL};
    int done = read_command(argc, argv, &c);
    done = process_meet(done, c.verb ? (int)c.verb->bit : 0, word_of(&c));
    if (done != CONTINUE)
        return done;
    return is_for_all(c.verb) || process_talks() ? run_command(&c)
                                                 : SNOW_STATUS_OK;
}

int tool_run(int argc, char **argv, const process_start *how) {
    /* If a standard stream is closed, the next opened file would take its place
     * and receive output that was meant for the stream. */
    for (int handle = 0; handle <= 2; handle++) {
        if (fcntl(handle, F_GETFD) == -1)
            (void)!open("/dev/null", handle == 1 ? O_RDONLY : O_RDWR);
    }
    process_begin(how);
    interrupt_install();
    int done = process_agree(dispatch(argc, argv));
    if (process_ranks() >
        1) /* the launcher would end all ranks with the first failure */
        interrupt_mute();
    return done;
}
