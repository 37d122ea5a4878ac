/* answers.c - implements answers.h. */
#include "answers/answers.h"

#include "draw/pick.h"
#include "draw/slices.h"
#include "draw/values.h"
#include "message.h"
#include "movies/command.h"
#include "movies/times.h"
#include "pack.h"
#include "recipe_file.h"
#include "run/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void answer_put(outbox *box, uint64_t client, message_topic about,
                json_t *tree) {
    char *text = json_dumps(tree, JSON_COMPACT | JSON_REAL_PRECISION(17));
    outbox_put_text(box, client, about, text);
    free(text);
    json_decref(tree);
}

void answer_said(outbox *box, uint64_t client, const char *line) {
    answer_put(box, client, MESSAGE_PLAIN,
               json_pack("{s:s, s:s}", "t", "said", "text", line));
}

/* --- what is asked
 * --------------------------------------------------------------- */

static int answer_histogram(drawing *d, outbox *box, uint64_t client,
                            const json_t *tree) {
    uint64_t counts[VALUES_BINS];
    double ends[2];
    const json_t *lo = json_object_get(tree, "lo"),
                 *hi = json_object_get(tree, "hi");
    if (!json_is_number(lo) || !json_is_number(hi))
        values_ends(d, ends);
    double low = json_is_number(lo) ? json_number_value(lo) : ends[0];
    double high = json_is_number(hi) ? json_number_value(hi) : ends[1];
    if (!(low < high) || !isfinite(high - low))
        return CONTINUE;
    int done = values_count(d, low, high, counts);
    if (done != CONTINUE)
        return done == VALUES_MORE ? done : CONTINUE;
    json_t *list = json_array();
    for (int i = 0; i < VALUES_BINS; i++)
        json_array_append_new(list, json_integer((json_int_t)counts[i]));
    answer_put(box, client, MESSAGE_PLAIN,
               json_pack("{s:s, s:f, s:f, s:o}", "t", "histogram", "lo", low,
                         "hi", high, "counts", list));
    return CONTINUE;
}

/* The state as a page shows it. */
static json_t *recipe_for(viewer_state *s, const viewer_question *question) {
    json_t *recipe = state_recipe(s);
    json_t *size = json_object_get(question->tree, "size");
    if (message_has_size(size))
        json_object_set(recipe, "size", size);
    return recipe;
}

static void put_command(outbox *box, uint64_t client, char *command) {
    if (command)
        answer_put(box, client, MESSAGE_PLAIN,
                   json_pack("{s:s, s:s}", "t", "command", "text", command));
    free(command);
}

static void answer_command(drawing *d, viewer_state *s, outbox *box,
                           const viewer_question *question) {
    json_t *recipe = recipe_for(s, question);
    if (drawing_apply(d, recipe) == CONTINUE)
        put_command(box, question->client, drawing_command(d));
    json_decref(recipe);
}

char *answer_movie(drawing *d, viewer_state *s, outbox *box,
                   const viewer_question *question, movie_order *order,
                   char name[100]) {
    json_t *recipe = state_recipe(s);
    char *command = NULL;
    if (!order_read(question->tree, d->state.whole.times, order))
        answer_said(box, question->client, order->fault);
    else if (drawing_apply(d, recipe) == CONTINUE)
        command = movie_command(d, order, name);
    json_decref(recipe);
    return command;
}

static void answer_movie_command(drawing *d, viewer_state *s, outbox *box,
                                 const viewer_question *question) {
    movie_order order;
    char name[100];
    put_command(box, question->client,
                answer_movie(d, s, box, question, &order, name));
}

/* {"what": "times"} */
static int answer_times(drawing *d, outbox *box, uint64_t client,
                        const json_t *tree) {
    json_t *texts;
    int done = times_read(d, &texts);
    (void)tree;
    if (done == CONTINUE)
        answer_put(box, client, MESSAGE_PLAIN,
                   json_pack("{s:s, s:O}", "t", "times", "texts", texts));
    return done;
}

/* As a text, which keeps the order and the digits of its keys. */
void answer_recipe_text(outbox *box, uint64_t client, const json_t *tree,
                        bool look) {
    char *text = tree ? json_dumps(tree, JSON_INDENT(2) | JSON_FORM) : NULL;
    if (text)
        answer_put(box, client, MESSAGE_PLAIN,
                   json_pack("{s:s, s:s}", "t", look ? "look-file" : "recipe",
                             "text", text));
    free(text);
}

static void answer_fit(drawing *d, viewer_state *s, outbox *box,
                       uint64_t client) {
    uint32_t revision;
    json_t *recipe = state_recipe(s);
    json_t *keys = drawing_apply(d, recipe) == CONTINUE ? drawing_fit(d) : NULL;
    if (json_object_size(keys))
        free(state_set(s, keys, &revision));
    else if (keys)
        answer_said(box, client,
                    d->state.view.has_position
                        ? "The camera stands at a position that was given: "
                          "choose a view to frame all."
                        : "Nothing is visible that could be framed.");
    outbox_put(box, state_message(s, 0, 0));
    json_decref(keys);
    json_decref(recipe);
}

static void put_no_slice(outbox *box, uint64_t client, json_int_t pane) {
    if (pane >= 1 && pane <= 3)
        answer_put(box, client, MESSAGE_PLAIN,
                   json_pack("{s:s, s:I}", "t", "slice", "pane", pane));
}

static bool read_slice(const json_t *tree, slice_asked *out) {
    const json_t *range = json_object_get(tree, "range");
    out->axis = json_string_value(json_object_get(tree, "axis"));
    out->index = json_integer_value(json_object_get(tree, "index"));
    out->low = json_number_value(json_array_get(range, 0));
    out->high = json_number_value(json_array_get(range, 1));
    out->colored = json_is_true(json_object_get(tree, "colored"));
    out->slab = json_string_value(json_object_get(tree, "slab"));
    return out->axis && out->low < out->high;
}

/* {"what": "slice", "axis": "axial", "index": 57, "range": [0, 80], "pane": 1,
 * "n": 8, "exact": true, "slab": "10mm:max"}: {"t": "slice", "pane": 1} where
 * there is none, as the page waits for it. */
static int answer_slice(drawing *d, outbox *box, uint64_t client,
                        const json_t *tree) {
    slice_asked asked;
    snow_image_options form;
    snow_image *image = NULL;
    json_int_t pane = json_integer_value(json_object_get(tree, "pane"));
    json_int_t n = json_integer_value(json_object_get(tree, "n"));
    bool exact = json_is_true(json_object_get(tree, "exact"));
    int done = CONTINUE;
    if (pane < 1 || pane > 3)
        return CONTINUE;
    if (read_slice(tree, &asked))
        done = slices_draw(d, &asked, &image, &form);
    outgoing *made =
        image ? pack_small(image, &form, exact, (int)pane, (uint32_t)n) : NULL;
    if (made)
        made->client = client;
    else if (done != SNOW_STATUS_NO_MEMORY)
        put_no_slice(box, client, pane);
    outbox_put(box, made);
    snow_image_free(image);
    return done;
}

static int answer_slice_command(drawing *d, outbox *box, uint64_t client,
                                const json_t *tree) {
    slice_asked asked;
    char *command = read_slice(tree, &asked) ? slices_command(d, &asked) : NULL;
    if (command)
        answer_put(box, client, MESSAGE_PLAIN,
                   json_pack("{s:s, s:s}", "t", "command", "text", command));
    free(command);
    return CONTINUE;
}

static void put_value(outbox *box, uint64_t client, const int64_t at[3],
                      double value) {
    answer_put(box, client, MESSAGE_PLAIN,
               json_pack("{s:s, s:o, s:o}", "t", "value", "at",
                         json_sizes(at, 3), "value", json_number(value)));
}

/* {"what": "value", "at": [12, 30, 57]} */
static int answer_value(drawing *d, outbox *box, uint64_t client,
                        const json_t *tree) {
    int64_t at[3];
    answer_read_voxel(tree, at);
    put_value(box, client, at, slices_value(d, at));
    return CONTINUE;
}

void answer_none(outbox *box, uint64_t client, const json_t *tree) {
    const char *what = json_string_value(json_object_get(tree, "what"));
    int64_t at[3];
    if (what && strcmp(what, "slice") == 0)
        put_no_slice(box, client,
                     json_integer_value(json_object_get(tree, "pane")));
    if (what && strcmp(what, "probe") == 0)
        answer_no_probe(box, client, tree);
    if (!what || strcmp(what, "value") != 0)
        return;
    answer_read_voxel(tree, at);
    put_value(box, client, at, NAN);
}

/* {"what": "depth", "x": 0.5, "y": 0.25, "size": [800, 600]}: of the state that
 * was drawn last, in a picture of that size.  The page knows the camera. */
static int answer_depth(drawing *d, outbox *box, uint64_t client,
                        const json_t *tree) {
    double x, y, depth, size[2] = {d->state.view.width, d->state.view.height};
    answer_read_size(tree, size);
    if (!answer_read_spot(tree, &x, &y) ||
        pick_depth(d, x, y, size, &depth) != CONTINUE)
        return CONTINUE;
    answer_put(box, client, MESSAGE_PLAIN,
               json_pack("{s:s, s:f, s:f, s:o}", "t", "depth", "x", x, "y", y,
                         "depth", json_number(depth)));
    return CONTINUE;
}

/* The recipe's file, or that of its look alone. */
static void answer_file(drawing *d, viewer_state *s, outbox *box,
                        const viewer_question *question, bool look) {
    json_t *newest = recipe_for(s, question), *tree = NULL;
    if (drawing_apply(d, newest) == CONTINUE)
        tree = look ? look_file_tree(d) : recipe_file_tree(d);
    answer_recipe_text(box, question->client, tree, look);
    json_decref(tree);
    json_decref(newest);
}

/* What needs the newest state, which may not be drawn yet. */
static bool answer_state(drawing *d, viewer_state *s, outbox *box,
                         const viewer_question *question, const char *what) {
    if (strcmp(what, "command") == 0)
        answer_command(d, s, box, question);
    else if (strcmp(what, "movie-command") == 0)
        answer_movie_command(d, s, box, question);
    else if (strcmp(what, "recipe") == 0)
        answer_file(d, s, box, question, false);
    else if (strcmp(what, "look-file") == 0)
        answer_file(d, s, box, question, true);
    else if (strcmp(what, "fit") == 0)
        answer_fit(d, s, box, question->client);
    else if (strcmp(what, "thumbnail") == 0)
        answer_thumbnail(d, s, box, question->client, question->tree);
    else
        return false;
    return true;
}

/* Makes what the newest state needs, once for each state; why it cannot be made
 * is said then, and a second try is only for one that was short of memory. */
static int follow(drawing *d, viewer_state *s) {
    uint32_t revision = state_revision(s); /* the recipe may be newer */
    if (d->followed == revision)
        return d->followed_done == CONTINUE ? CONTINUE : SNOW_STATUS_FAILED;
    json_t *recipe = state_recipe(s);
    d->followed_done = drawing_apply(d, recipe);
    d->followed = revision;
    json_decref(recipe);
    return d->followed_done;
}

/* What is answered of the volume: `newest` where that is the one of the newest
 * state, not of the last picture. */
typedef struct answer_row {
    const char *what;
    int (*answer)(drawing *, outbox *, uint64_t, const json_t *);
    bool newest;
} answer_row;

/* Why a state has no volume is said when it is made. */
static int answer_by(const answer_row *row, drawing *d, viewer_state *s,
                     outbox *box, const viewer_question *question) {
    int made = row->newest ? follow(d, s) : CONTINUE;
    if (made == CONTINUE && d->state.volume && d->state.transfer) {
        int done = row->answer(d, box, question->client, question->tree);
        if (done == VALUES_MORE)
            state_ask(s, question->client, json_incref(question->tree));
        return done;
    }
    if (made == SNOW_STATUS_NO_MEMORY)
        return made;
    answer_none(box, question->client, question->tree);
    if (made == CONTINUE)
        answer_said(
            box, question->client,
            "There is no volume: undo, or choose another time or crop.");
    return CONTINUE;
}

int answer_question(drawing *d, viewer_state *s, outbox *box,
                    const viewer_question *question) {
    static const answer_row rows[] = {
        {"histogram", answer_histogram, false},
        {"slice", answer_slice, true},
        {"slice-command", answer_slice_command, true},
        {"value", answer_value, true},
        {"measures", answer_measures, true},
        {"probe", answer_probe, true},
        {"times", answer_times, false},
        {"depth", answer_depth, false}};
    const char *what =
        json_string_value(json_object_get(question->tree, "what"));
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(what, rows[i].what) == 0)
            return answer_by(&rows[i], d, s, box, question);
    if (!answer_state(d, s, box, question, what))
        answer_said(box, question->client,
                    "ask: nothing is known of what is asked");
    return CONTINUE;
}
