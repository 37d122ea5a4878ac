/* main.c - the program snowglass-serve, which `snowglass serve` starts: shows a
 * volume in browsers that need no WebGL.
 *
 * Three threads: this one serves sockets (net/listen.c), one draws (render.c),
 * one packs pictures (pack.c).  Between them are the newest state (state.c) and
 * what waits for the pages (outbox.c).  The program is one of its own since
 * libwebsockets brings many libraries with it. */
#include "answers.h"
#include "message.h"
#include "net/listen.h"
#include "render.h"

#include "commands/commands.h"
#include "options/config.h"
#include "run/log.h"
#include "run/start.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    drawing drawing;
} viewer;

/* A signal ends the serving in order. */
static listener *stopped_by_signal;

static void hear_signal(int number) {
    (void)number;
    listener_stop(stopped_by_signal);
}

static void hear_signals(listener *l) {
    struct sigaction action = {.sa_handler = hear_signal};
    sigemptyset(&action.sa_mask);
    stopped_by_signal = l;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    signal(SIGPIPE, SIG_IGN);
}

/* From here on pages hear what the library says. */
static void hear_line(void *user, const char *line) {
    answer_said(user, 0, line);
}

static int read_options(options *opts, int argc, char **argv) {
    static char *operands[] = {engine, NULL};
    const verb_row *verb = verb_of(VERB_SERVE);
    options_init(opts);
    int done = options_parse(opts, verb, argc, argv);
    if (done != CONTINUE)
        return done;
    if (opts->version) {
        printf("snowglass %s\n", snow_version());
        return finish_stdout();
    }
    if (opts->help)
        return help_print(opts->help_word, verb);
    if (opts->operand_count > 1)
        return fail_usage("%s: is one file too many; serve shows one volume",
                          opts->operands[1]);
    if (opts->operand_count == 0)
        opts->operands = operands;
    opts->operand_count = 1;
    if (strcmp(opts->operands[0], "-") == 0)
        return fail_usage("-: standard input can be read only once; give serve "
                          "a file");
    return check_settings(opts);
}

/* The recipe that the page begins with. */
static json_t *first_recipe(const options *opts) {
    json_t *tree = config_tree(opts, verb_of(VERB_RENDER));
    static const char *const unwanted[] = {"input",     "output",  "depth",
                                           "verb",      "version", "quality",
                                           "overwrite", "bits"};
    for (size_t i = 0; i < sizeof unwanted / sizeof *unwanted; i++)
        json_object_del(tree, unwanted[i]);
    return tree;
}

static int fail_start(void) {
    return fail_memory("out of memory at the start; close other programs");
}

/* Opens sockets before the volume, which may take long. */
static int open_all(viewer *v) {
    options *opts = &v->opts;
    int done = secret_make(opts, &v->guard);
    if (done == CONTINUE)
        done = look_load(opts);
    if (done == CONTINUE)
        done = check_input(opts);
    if (done == CONTINUE)
        done = sockets_open(opts, &v->guard, &v->sockets);
    if (done != CONTINUE)
        return done;
    json_t *recipe = first_recipe(opts);
    v->state = recipe ? state_new(json_deep_copy(recipe)) : NULL;
    v->listener = listener_new(&v->sockets, &v->guard, opts->idle);
    v->box = v->listener ? outbox_new(listener_wake, v->listener) : NULL;
    if (!v->state || !v->box) {
        json_decref(recipe);
        return fail_start();
    }
    progress_begin(opts, "reading");
    done = drawing_open(opts, recipe, &v->drawing);
    progress_end(opts);
    json_decref(recipe);
    return done;
}

/* The one line that a script reads. */
static int print_url(const viewer *v) {
    printf("http://%s/#token=%s\n", v->sockets.host, v->guard.token);
    return finish_stdout();
}

static int serve(viewer *v) {
    hear_signals(v->listener);
    renderer_begin(&v->drawing, v->state, v->box);
    int done = print_url(v);
    if (done != SNOW_STATUS_OK)
        return done;
    v->pack = packer_new(v->box);
    say_to(hear_line, v->box);
    if (v->pack)
        v->renderer = renderer_new(&v->drawing, v->state, v->box, v->pack);
    if (!v->renderer) {
        say_to(NULL, NULL);
        return fail_start();
    }
    listener_run(v->listener, v->state, v->box);
    return SNOW_STATUS_OK;
}

static void close_all(viewer *v) {
    if (v->state)
        state_end(v->state);
    if (v->pack && !v->renderer)
        packer_end(v->pack);
    renderer_free(v->renderer);
    say_to(NULL, NULL);
    packer_free(v->pack);
    listener_free(v->listener);
    outbox_free(v->box);
    state_free(v->state);
    drawing_close(&v->drawing);
    look_unload(&v->opts);
    sockets_close(&v->sockets);
}

int main(int argc, char **argv) {
    static const process_start alone = {.comm = NULL};
    static viewer v;
    process_begin(&alone);
    int done = read_options(&v.opts, argc, argv);
    if (done != CONTINUE)
        return done;
    done = open_all(&v);
    if (done == CONTINUE)
        done = serve(&v);
    close_all(&v);
    return done;
}
