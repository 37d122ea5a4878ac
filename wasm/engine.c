/* engine.c - the viewer behind a page without a server: its state, its drawing
 * and its answers, by calls of the page's worker (worker.js).
 *
 * The worker hands in the texts that go to a server elsewhere (message.h),
 * calls engine_step while there is work, and takes out what goes to the page.
 */
#include "answers/answers.h"
#include "levels.h"
#include "message.h"
#include "pack.h"
#include "pieces.h"
#include "render.h"

#include "commands/commands.h"
#include "options/config.h"
#include "run/log.h"

#include <emscripten.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A page has 2 GiB: what is larger stays in its file. */
#define MEMORY_MOST ((uint64_t)1400 << 20)

/* What is larger is not fetched from a server. */
#define FETCHED_MOST ((double)(1 << 30))

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
    bool opened;
    char noted[4096];
} e;

static void be_woken(void *user) {
    (void)user;
}

/* The page shows one line: while it is opened, all that was noted. */
static void hear_line(void *user, const char *line) {
    (void)user;
    const size_t used = strlen(e.noted);
    if (e.opened)
        answer_said(e.box, CLIENT, line);
    else
        snprintf(e.noted + used, sizeof e.noted - used, "%s%s",
                 used ? "\n" : "", line);
}

static void tell_noted(bool last) {
    e.opened = true;
    const char *end = last ? strrchr(e.noted, '\n') : NULL;
    if (*e.noted)
        answer_said(e.box, CLIENT, end ? end + 1 : e.noted);
}

EMSCRIPTEN_KEEPALIVE void *engine_room(size_t bytes) {
    return malloc(bytes);
}

EMSCRIPTEN_KEEPALIVE void engine_leave(void *room) {
    free(room);
}

static int refuse_size(const char *path, double bytes) {
    return fail_memory(
        "%s: has %.0f MiB of voxels, and a page fetches at most %.0f; name a "
        "coarser level behind the address, or get the file and open it",
        path, bytes / 0x1p20, FETCHED_MOST / 0x1p20);
}

/* Of a server: the level that is fetched, unless the address names one. */
static int settle_level(const char *path, double most, json_t *tree) {
    snow_context *context;
    snow_volume_info info = {.size = sizeof info};
    if (e.opts.dataset)
        return CONTINUE;
    level_choice choice = level_choose(path, most);
    if (choice.left > FETCHED_MOST)
        return refuse_size(path, choice.left);
    if (*choice.dataset) {
        json_object_set_new(tree, "dataset", json_string(choice.dataset));
        say("level %d of %d (%s) is shown, since the finest has %.0f MiB of "
            "voxels; the path of another behind the address shows that",
            choice.level, choice.levels, choice.dataset,
            choice.bytes / 0x1p20);
    } else if (snow_context_new(NULL, &context) == SNOW_STATUS_OK) {
        snow_volume_options data = data_options(&e.opts);
        double bytes = 0;
        if (snow_volume_inspect(context, path, &data, &info) == SNOW_STATUS_OK)
            bytes = (double)info.dims[0] * (double)info.dims[1] *
                    (double)info.dims[2] * (double)snow_type_size(info.type);
        snow_context_free(context);
        if (bytes > FETCHED_MOST)
            return refuse_size(path, bytes);
    }
    return CONTINUE;
}

/* The recipe that the page begins with, which says how a raw file is read
 * too. */
static int open_drawing(const char *recipe, double most) {
    json_t *tree = json_loads(recipe, JSON_REJECT_DUPLICATES, NULL);
    if (!json_is_object(tree))
        return fail_usage("the recipe of the page is damaged");
    int done = config_take_tree(&e.opts, verb_of(VERB_RENDER), tree);
    if (done == CONTINUE && most > 0)
        done = settle_level(e.opts.operands[0], most, tree);
    if (done == CONTINUE)
        done = look_load(&e.opts); /* the recipe may name a transfer function */
    e.state = state_new(json_deep_copy(tree));
    if (done == CONTINUE)
        done = e.state ? drawing_open(&e.opts, tree, &e.drawing)
                       : fail_memory("out of memory; close other pages");
    json_decref(tree);
    return done;
}

/* Opens a file of the page, or phantom:NAME.  Of an image on a server the finest
 * level with at most `most` bytes of voxels is taken; 0: it is on none.  False:
 * a text that waits says why.  Only once. */
EMSCRIPTEN_KEEPALIVE bool engine_open(const char *path, const char *recipe,
                                      double most) {
    options_init(&e.opts);
    e.operands[0] = strdup(path);
    e.opts.operands = e.operands;
    e.opts.operand_count = 1;
    e.opts.memory = MEMORY_MOST;
    e.opts.progress = "never";
    e.box = outbox_new(be_woken, NULL);
    say_to(hear_line, NULL);
    if (!e.box)
        return false;
    if (open_drawing(recipe, most) != CONTINUE) {
        tell_noted(true);
        return false;
    }
    tell_noted(false);
    pieces_begin(&e.drawing);
    renderer_begin(&e.drawing, e.state, e.box);
    e.renderer = renderer_new(&e.drawing, e.state, e.box,
                              packer_new(e.box, e.state), NULL, NULL, NULL);
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
