/* engine.c - the viewer behind a page without a server: its state, its drawing
 * and its answers, by calls of the page's worker (worker.js).
 *
 * The worker hands in the texts that go to a server elsewhere (message.h),
 * calls engine_step while there is work, and takes out what goes to the page.
 */
#include "answers/answers.h"
#include "message.h"
#include "pack.h"
#include "pieces.h"
#include "render.h"

#include "commands/commands.h"
#include "options/config.h"
#include "run/log.h"

#include <emscripten.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A page has 2 GiB: what is larger stays in its file. */
#define MEMORY_MOST ((uint64_t)1400 << 20)

/* The one page. */
#define CLIENT 1

static struct {
    options opts;
    char *operands[2];
    drawing drawing;
    viewer_state *state;
    outbox *box;
    renderer *renderer;
    set_log sets;
    outgoing *waiting, *shown;
} e;

static void be_woken(void *user) {
    (void)user;
}

static void hear_line(void *user, const char *line) {
    (void)user;
    answer_said(e.box, CLIENT, line);
}

EMSCRIPTEN_KEEPALIVE void *engine_room(size_t bytes) {
    return malloc(bytes);
}

EMSCRIPTEN_KEEPALIVE void engine_leave(void *room) {
    free(room);
}

/* The recipe that the page begins with, which says how a raw file is read
 * too. */
static int open_drawing(const char *recipe) {
    json_t *tree = json_loads(recipe, JSON_REJECT_DUPLICATES, NULL);
    if (!json_is_object(tree))
        return fail_usage("the recipe of the page is damaged");
    int done = config_take_tree(&e.opts, verb_of(VERB_RENDER), tree);
    if (done == CONTINUE)
        done = look_load(&e.opts); /* the recipe may name a transfer function */
    e.state = state_new(json_deep_copy(tree));
    if (done == CONTINUE)
        done = e.state ? drawing_open(&e.opts, tree, &e.drawing)
                       : fail_memory("out of memory; close other pages");
    json_decref(tree);
    return done;
}

/* Opens a file of the page, or phantom:NAME.  False: a text that waits says
 * why.  Only once. */
EMSCRIPTEN_KEEPALIVE bool engine_open(const char *path, const char *recipe) {
    options_init(&e.opts);
    e.operands[0] = strdup(path);
    e.opts.operands = e.operands;
    e.opts.operand_count = 1;
    e.opts.memory = MEMORY_MOST;
    e.opts.progress = "never";
    e.box = outbox_new(be_woken, NULL);
    say_to(hear_line, NULL);
    if (!e.box || open_drawing(recipe) != CONTINUE)
        return false;
    pieces_begin(&e.drawing);
    renderer_begin(&e.drawing, e.state, e.box);
    e.renderer = renderer_new(&e.drawing, e.state, e.box, packer_new(e.box),
                              NULL, NULL, NULL);
    outbox_set_audience(e.box, 1, 0, 0);
    state_set_watchers(e.state, 1);
    outbox_put(e.box, state_message(e.state, 0, 0));
    return e.renderer;
}

static void set(const message *m) {
    uint32_t revision;
    char *fault = state_set(e.state, m->keys, &revision);
    set_log_note(&e.sets, m->n, revision);
    if (fault)
        answer_said(e.box, CLIENT, fault);
    if (fault || *m->left_out || state_wrote(e.state))
        outbox_put(e.box, state_message(e.state, 0, 0));
    free(fault);
}

static void take(message *m) {
    if (m->kind == MESSAGE_SET)
        set(m);
    if (m->kind == MESSAGE_MOVING)
        state_set_moving(e.state, m->on);
    if (m->kind == MESSAGE_ASK &&
        !state_ask(e.state, CLIENT, json_deep_copy(m->tree)))
        answer_none(e.box, CLIENT, m->tree);
}

EMSCRIPTEN_KEEPALIVE void engine_hear(const char *text, size_t length) {
    message m;
    const char *wrong = message_read(text, length, &m);
    if (wrong || *m.left_out)
        answer_said(e.box, CLIENT, wrong ? wrong : m.left_out);
    if (wrong)
        return;
    take(&m);
    message_free(&m);
}

/* Works for a while.  Returns the milliseconds after which there is more work;
 * 0: at once; -1: when the page says something. */
EMSCRIPTEN_KEEPALIVE double engine_step(void) {
    double due;
    if (renderer_step(e.renderer, &due) != WORK_NONE)
        return 0;
    return due > 0 ? 1000 * fmax(0, due - seconds_now()) : -1;
}

/* The next that goes to the page, until the one after it; NULL: none. */
EMSCRIPTEN_KEEPALIVE const unsigned char *engine_take(void) {
    if (e.shown)
        outgoing_release(e.box, e.shown);
    if (!e.waiting)
        e.waiting = outbox_take(e.box);
    outgoing *p = e.shown = e.waiting;
    if (!p)
        return NULL;
    e.waiting = p->next;
    uint32_t n = set_log_n(&e.sets, p->revision);
    if (p->topic == MESSAGE_PICTURE)
        frame_head_set_n(p->bytes, n);
    if (p->topic == MESSAGE_STATE)
        state_text_set_step(p->bytes, n);
    return p->bytes;
}

EMSCRIPTEN_KEEPALIVE size_t engine_length(void) {
    return e.shown->length;
}

EMSCRIPTEN_KEEPALIVE bool engine_is_text(void) {
    return e.shown->is_text;
}
