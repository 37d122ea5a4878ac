/* main.c - the program snowglass-serve, which `snowglass serve` starts: shows a
 * volume in browsers that need no WebGL.
 *
 * Four threads: this one draws (render.c), one serves sockets (net/listen.c),
 * two pack pictures (pack.c).  Between them are the newest state (state.c) and
 * what waits for the pages (outbox.c).  The program is one of its own since
 * libwebsockets brings many libraries with it.  Of many ranks
 * (snowglass-serve-mpi) the first has these threads, and the others draw with
 * it (ranks.c). */
#include "answers/answers.h"
#include "draw/ranks.h"
#include "folder/folder.h"
#include "live.h"
#include "message.h"
#include "movies/job.h"
#include "net/listen.h"
#include "recipe_file.h"
#include "render.h"

#include "commands/commands.h"
#include "commands/first.h"
#include "series/series.h"
#include "run/log.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Without a page the program ends after this time. */
#define IDLE_SECONDS 3600

/* What is shown without a file. */
static char engine[] = "phantom:engine";

typedef struct viewer {
    options opts;
    guard guard;
    sockets sockets;
    listener *listener;
    outbox *box;
    viewer_state *state;
    packer *pack;
    renderer *renderer;
    pthread_t thread; /* of the listener */
    drawing drawing;
    bool lists;     /* a folder, of which a page chooses a volume */
    live *live;     /* in its place; or NULL */
    folder *folder; /* of which pages choose a volume; or NULL */
    movie_job *job; /* or NULL */
} viewer;

/* A signal ends the serving in order. */
static listener *stopped_by_signal;

static void note_signal(int number) {
    (void)number;
    listener_stop(stopped_by_signal);
}

static void watch_signals(listener *l) {
    struct sigaction action = {.sa_handler = note_signal};
    sigemptyset(&action.sa_mask);
    stopped_by_signal = l;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    signal(SIGPIPE, SIG_IGN);
}

/* From here on pages are sent what the library says. */
static void show_line(void *user, const char *line) {
    answer_said(user, 0, line);
}

/* A simulation draws by its recipe alone. */
static int check_live(const options *opts) {
    if (opts->operand_count || process_ranks() > 1)
        return fail_usage("--live: %s; give it alone, to one process",
                          opts->operand_count
                              ? "shows a simulation, and no file"
                              : "needs no ranks, as the simulation draws");
    for (size_t i = 0; option_table[i].name; i++)
        if (opts->given[i] && option_table[i].verbs & VERB_RENDER &&
            !(option_table[i].verbs & VERB_HELP))
            return fail_usage("--%s: cannot be given with --live: the "
                              "simulation draws by %s; leave it out, or change "
                              "that recipe",
                              option_table[i].name, opts->live);
    return CONTINUE;
}

static int read_options(options *opts, int argc, char **argv) {
    static char *operands[] = {engine, NULL};
    const verb_row *verb = verb_of(VERB_SERVE);
    options_init(opts);
    int done = options_parse(opts, verb, argc, argv);
    if (done != CONTINUE)
        return done;
    if ((opts->version || opts->help) && !process_talks())
        return SNOW_STATUS_OK;
    if (opts->version) {
        printf("snowglass %s\n", snow_version());
        return finish_stdout();
    }
    if (opts->help)
        return help_print(opts->help_word, verb);
    if (opts->operand_count > 1)
        return fail_usage("%s: is one file too many; serve shows one volume",
                          opts->operands[1]);
    done = opts->live ? check_live(opts) : CONTINUE;
    if (done != CONTINUE)
        return done;
    if (opts->operand_count == 0)
        opts->operands = operands;
    opts->operand_count = 1;
    if (strcmp(opts->operands[0], "-") == 0)
        return fail_usage("-: standard input can be read only once; give serve "
                          "a file");
    if (points_are_factor(&opts->overlay_look.opacity))
        return fail_usage("--overlay-look: a factor is for pictures; give "
                          "serve opacities at values, such as 10:0,30:0.5");
    done = layers_check(opts);
    return done == CONTINUE ? check_settings(opts) : done;
}

/* By an error number; others than these come from what did work. */
static int fail_start(int number) {
    if (number != EAGAIN && number != EMFILE && number != ENFILE)
        return fail_memory("out of memory at the start; close other programs");
    say("serve: cannot be started: %s; end other programs, or allow more "
        "threads and files (ulimit -u, -n)",
        strerror(number));
    return SNOW_STATUS_FAILED;
}

/* Of the first rank: what serves, and its state, before the volume, which may
 * take long. */
static int open_door(viewer *v, const json_t *recipe) {
    options *opts = &v->opts;
    int done = secret_make(opts, &v->guard);
    if (done == CONTINUE && !opts->live && !v->lists)
        done = check_input(opts);
    if (done == CONTINUE)
        done = sockets_open(opts, &v->guard, &v->sockets);
    if (done != CONTINUE)
        return done;
    errno = 0;
    json_t *copy = json_deep_copy(recipe);
    v->state = copy ? state_new(copy) : NULL;
    v->listener = listener_new(&v->sockets, &v->guard, IDLE_SECONDS);
    v->box = v->listener ? outbox_new(listener_wake, v->listener) : NULL;
    return v->state && v->box ? CONTINUE : fail_start(errno);
}

static int open_live(viewer *v) {
    int done = live_new(&v->opts, &v->live);
    json_t *recipe = done == CONTINUE ? live_recipe(v->live) : NULL;
    if (done == CONTINUE)
        done = open_door(v, recipe);
    json_decref(recipe);
    return done;
}

/* What the list has is looked at when pages can connect. */
static int open_list(viewer *v) {
    options *opts = &v->opts;
    int done = folder_check(opts);
    if (done == CONTINUE)
        done = look_load(opts);
    json_t *recipe = done == CONTINUE ? recipe_first(opts) : NULL;
    if (done == CONTINUE)
        done = open_door(v, recipe);
    json_decref(recipe);
    if (done == CONTINUE)
        done = drawing_wait(opts, &v->drawing);
    errno = 0;
    if (done == CONTINUE)
        v->folder = folder_new(opts, v->box);
    return done == CONTINUE && !v->folder ? fail_start(errno) : done;
}

static int open_all(viewer *v) {
    options *opts = &v->opts;
    snow_comm *comm = process_ranks() > 1 ? process_comm() : NULL;
    if (comm)
        snow_comm_set_timeout(comm, opts->timeout);
    int done = series_take(opts, verb_of(VERB_SERVE));
    if (done == CONTINUE)
        done = settle_channels(opts, true);
    if (done == CONTINUE)
        first_settle(opts);
    if (done == CONTINUE)
        done = look_load(opts); /* on every rank: the file is small */
    json_t *recipe = done == CONTINUE ? recipe_first(opts) : NULL;
    if (done == CONTINUE && process_talks())
        done = open_door(v, recipe);
    done = process_agree(done);
    if (done == CONTINUE) {
        progress_begin(opts, "reading");
        done = drawing_open(opts, recipe, &v->drawing);
        progress_end(opts);
    }
    json_decref(recipe);
    return done;
}

/* Who came by SSH has the browser on another machine. */
static void say_tunnel(const viewer *v) {
    const options *opts = &v->opts;
    const char *came = getenv("SSH_CONNECTION"); /* client port server port */
    const char *port = strchr(v->sockets.host, ':');
    char server[64];
    if (came && port && opts->verbosity >= 0 && !opts->listen.path &&
        strncmp(v->sockets.host, "127.0.0.1:", 10) == 0 &&
        sscanf(came, "%*s %*s %63s", server) == 1)
        say("note: on the machine of your browser run ssh -L %s:%s %s, then "
            "open the URL",
            port + 1, v->sockets.host, server);
}

/* What a page orders: of a file that is still the one that is shown. */
static void write_movie(void *user, drawing *d, viewer_state *s,
                        const viewer_question *question) {
    viewer *v = user;
    movie_order order;
    char name[100], now[IDENTITY_BYTES];
    const char *fault = NULL;
    identity_of(d->opts.operands[0], now);
    if (strcmp(now, d->identity) != 0)
        fault = "movie: the file was replaced since it was opened; open the "
                "new one first";
    char *command =
        fault ? NULL : answer_movie(d, s, v->box, question, &order, name);
    if (command)
        fault = job_begin(v->job, command, name, &order);
    if (fault)
        answer_said(v->box, question->client, fault);
}

/* Many ranks write movies by the command alone. */
static bool offer_movies(viewer *v) {
    if (process_ranks() > 1)
        return true;
    v->job = job_new(v->box);
    v->drawing.offer = v->job ? job_offer() : NULL;
    return v->job != NULL;
}

/* The one line that a script reads. */
static int print_url(const viewer *v) {
    say_tunnel(v);
    printf("http://%s/#token=%s\n", v->sockets.host, v->guard.token);
    return finish_stdout();
}

/* Questions that no picture is waited for. */
static bool hear(void *user, uint64_t client, const json_t *question) {
    viewer *v = user;
    const char *what = json_string_value(json_object_get(question, "what"));
    const bool cancels = v->job && strcmp(what, "movie-cancel") == 0;
    if (cancels)
        job_cancel(v->job);
    return cancels || (v->folder && folder_hear(v->folder, client, question));
}

/* Ends the drawing when it ends itself. */
static void *listen_to_pages(void *user) {
    viewer *v = user;
    listener_run(v->listener, v->state, v->box, hear, v, v->job);
    state_end(v->state);
    return NULL;
}

/* Signals are for the thread that serves sockets; what draws is this one, the
 * only one that may speak to other ranks. */
static bool start_listening(viewer *v) {
    sigset_t all;
    errno = pthread_create(&v->thread, NULL, listen_to_pages, v);
    if (errno != 0)
        return false;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, NULL);
    return true;
}

/* Where ranks are lost nothing can be drawn any more.  A page has heard why;
 * so does who started the job. */
static int draw_all(viewer *v) {
    while (!process_broken() && renderer_step(v->renderer, NULL) != WORK_END) {
    }
    listener_stop(v->listener);
    pthread_join(v->thread, NULL);
    say_to(NULL, NULL);
    if (!process_broken())
        return SNOW_STATUS_OK;
    say("%s", snow_context_message(v->drawing.state.context));
    return SNOW_STATUS_FAILED;
}

static int serve(viewer *v) {
    watch_signals(v->listener);
    if (!offer_movies(v))
        return fail_start(ENOMEM);
    if (!v->folder)
        renderer_begin(&v->drawing, v->state, v->box);
    int done = print_url(v);
    if (done != SNOW_STATUS_OK)
        return done;
    const renderer_opener opener = {folder_choose, folder_opened, v->folder};
    errno = 0;
    v->pack = packer_new(v->box, v->state);
    if (v->pack)
        v->renderer = renderer_new(&v->drawing, v->state, v->box, v->pack,
                                   v->folder ? &opener : NULL,
                                   v->job ? write_movie : NULL, v);
    say_to(show_line, v->box);
    if (v->renderer && (!v->folder || folder_start(v->folder)) &&
        start_listening(v))
        return draw_all(v);
    int number = errno;
    say_to(NULL, NULL);
    return fail_start(number);
}

static int serve_live(viewer *v) {
    watch_signals(v->listener);
    int done = print_url(v);
    if (done != SNOW_STATUS_OK)
        return done;
    say_to(show_line, v->box);
    if (!start_listening(v)) {
        int number = errno;
        say_to(NULL, NULL);
        return fail_start(number);
    }
    live_run(v->live, v->state, v->box);
    pthread_join(v->thread, NULL);
    say_to(NULL, NULL);
    return SNOW_STATUS_OK;
}

/* A rank that only draws ends when the first one says so; the signals of a
 * terminal reach them all. */
static int follow(viewer *v) {
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    int done = ranks_follow(&v->drawing);
    return done == CONTINUE ? SNOW_STATUS_OK : done;
}

static void close_all(viewer *v) {
    if (v->pack && !v->renderer)
        packer_end(v->pack);
    renderer_free(v->renderer);
    packer_free(v->pack);
    drawing_close(&v->drawing);
    folder_free(v->folder);
    job_end(
        v->job); /* wakes the listener, which tells it of pages that close */
    listener_free(v->listener);
    job_free(v->job);
    json_decref(v->drawing.offer);
    outbox_free(v->box);
    state_free(v->state);
    live_free(v->live);
    look_unload(&v->opts);
    sockets_close(&v->sockets);
}

int tool_run(int argc, char **argv, const process_start *how) {
    static viewer v;
    process_begin(how);
    int done = process_meet(read_options(&v.opts, argc, argv), VERB_SERVE, 0);
    if (done != CONTINUE)
        return done;
    v.lists = folder_is_meant(&v.opts);
    done = v.opts.live ? open_live(&v)
           : v.lists   ? process_agree(open_list(&v))
                       : open_all(&v);
    if (done == CONTINUE && v.live) {
        done = serve_live(&v);
    } else if (done == CONTINUE && !process_talks()) {
        done = follow(&v);
    } else if (done == CONTINUE) {
        done = serve(&v);
        ranks_tell(&v.drawing, RANKS_END, NULL);
    }
    close_all(&v);
    return done;
}
