/* live.c - implements live.h. */
#include "live.h"
#include "answers/answers.h"
#include "live_file.h"
#include "message.h"

#include "commands/commands.h"
#include "options/config.h"
#include "picture/outputs.h"
#include "run/log.h"

#include <snowglass/recipe.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Pictures of a simulation have one quality, and one size. */
#define LEVEL_ONE 3

/* Between two looks at the folder and at what pages want. */
#define REST_SECONDS 0.05

/* In a picture's text, at most so many points of the opacity; and counts. */
#define POINTS_MOST 64
#define COUNTS 256

struct live {
    char *path; /* of the recipe */
    json_t *recipe;
    char *output; /* that it began with, by which pages name the pictures */
    live_files files;
    drawing drawing;       /* of the grid and the look in the pictures' text */
    json_t *reported;      /* the text of the last picture */
    uint32_t reported_for; /* the state whose look pages know */
};

/* --- the recipe ----------------------------------------------------------- */

static int check_recipe(const char *path, const json_t *recipe) {
    snow_context *context = NULL;
    snow_recipe read = {.size = sizeof read};
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return fail_memory("out of memory at the start; close other programs");
    snow_status status = snow_recipe_load(context, path, &read);
    int done = check_status(context, status);
    if (done == CONTINUE && !json_is_true(json_object_get(recipe, "reread")))
        done = fail_usage("%s: needs \"reread\": true, by which the simulation "
                          "reads it again; add that, and start the simulation",
                          path);
    if (status == SNOW_STATUS_OK)
        snow_recipe_clear(&read);
    snow_context_free(context);
    return done;
}

int live_new(const options *opts, live **out) {
    live *l = *out = calloc(1, sizeof *l);
    if (l)
        l->path = strdup(opts->live);
    if (!l || !l->path)
        return fail_memory("out of memory at the start; close other programs");
    l->recipe = json_load_file(l->path, 0, NULL);
    int done = check_recipe(l->path, l->recipe);
    if (done != CONTINUE)
        return done;
    const char *output =
        json_string_value(json_object_get(l->recipe, "output"));
    if (!output || !live_files_open(&l->files, output))
        return fail_usage("%s: needs an output such as \"u_%%04d.png\", which "
                          "the simulation writes and a page can show",
                          l->path);
    static char *operands[] = {NULL, NULL};
    operands[0] = l->output = strdup(output);
    if (!l->output)
        return fail_memory("out of memory at the start; close other programs");
    l->drawing.first = *opts;
    l->drawing.first.operands = operands;
    l->drawing.live = true;
    return open_context(opts, &l->drawing.state.context);
}

void live_free(live *l) {
    if (!l)
        return;
    snow_transfer_free(l->drawing.state.transfer);
    snow_volume_close(l->drawing.state.volume);
    snow_context_free(l->drawing.state.context);
    live_files_close(&l->files);
    json_decref(l->reported);
    json_decref(l->recipe);
    free(l->output);
    free(l->path);
    free(l);
}

json_t *live_recipe(const live *l) {
    return json_deep_copy(l->recipe);
}

/* A movie's pictures have one size, whatever the windows of pages have. */
static void save_recipe(live *l, json_t *recipe) {
    json_t *size = json_object_get(l->recipe, "size");
    if (size)
        json_object_set(recipe, "size", size);
    else
        json_object_del(recipe, "size");
    if (!json_equal(recipe, l->recipe) &&
        write_json(json_incref(recipe), l->path, true) == SNOW_STATUS_OK) {
        json_decref(l->recipe);
        l->recipe = json_incref(recipe);
    }
    json_decref(recipe);
}

/* --- what pages are sent -------------------------------------------------- */

static bool read_numbers(const json_t *list, double *out, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const json_t *number = json_array_get(list, i);
        out[i] = json_number_value(number);
        if (!json_is_number(number))
            return false;
    }
    return json_array_size(list) == count;
}

/* The grid of the simulation; false where the picture has none. */
static bool read_grid(const json_t *reported, snow_volume_info *out) {
    double dims[3], matrix[12];
    if (!read_numbers(json_object_get(reported, "dims"), dims, 3) ||
        !read_numbers(json_object_get(reported, "matrix"), matrix, 12))
        return false;
    snow_volume_info_init(out);
    for (int i = 0; i < 3; i++) {
        if (!(dims[i] >= 1 && dims[i] < 1e15))
            return false;
        out->dims[i] = (int64_t)dims[i];
        memcpy(out->matrix[i], &matrix[4 * i], sizeof out->matrix[i]);
        out->spacing[i] =
            sqrt(matrix[i] * matrix[i] + matrix[4 + i] * matrix[4 + i] +
                 matrix[8 + i] * matrix[8 + i]);
    }
    out->type = SNOW_TYPE_FLOAT64;
    out->times = 1;
    return true;
}

/* In place of the voxels, which stay where they are, two that have the ends of
 * the range. */
static snow_status make_ends(live *l, double ends[2]) {
    static double voxels[8]; /* one viewer, one simulation */
    drawing *d = &l->drawing;
    snow_volume_info info;
    snow_volume_info_init(&info);
    for (int i = 0; i < 8; i++)
        voxels[i] = ends[i & 1];
    info.type = SNOW_TYPE_FLOAT64;
    info.dims[0] = info.dims[1] = info.dims[2] = 2;
    snow_volume_close(d->state.volume);
    d->state.volume = NULL;
    return snow_volume_wrap(d->state.context, &info, voxels, &d->state.volume);
}

/* The colours of the recipe, over the range and with the opacity of the
 * picture. */
static snow_status make_look(live *l, double ends[2]) {
    static options opts; /* large; one thread is live */
    static const char *const others[] = {"input",  "output", "reread", "verb",
                                         "frames", "fps",    "tf"};
    snow_opacity_point points[POINTS_MOST];
    drawing *d = &l->drawing;
    const json_t *list = json_object_get(l->reported, "opacity");
    json_t *tree = json_copy(l->recipe);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        json_object_del(tree, others[i]);
    options_init(&opts);
    int done = config_take_tree(&opts, verb_of(VERB_RENDER), tree);
    json_decref(tree);
    snow_look look = {.size = sizeof look};
    if (done == CONTINUE)
        look = look_options(&opts);
    look.range = SNOW_RANGE_VALUES;
    look.low = ends[0];
    look.high = ends[1];
    for (size_t i = 0; i < json_array_size(list) && i < POINTS_MOST; i++) {
        double pair[2] = {0, 0};
        (void)read_numbers(json_array_get(list, i), pair, 2);
        points[i] = (snow_opacity_point){pair[0], pair[1]};
        look.opacities = points;
        look.opacity_count = i + 1;
    }
    snow_transfer_free(d->state.transfer);
    d->state.transfer = NULL;
    return snow_transfer_new_for_volume(d->state.volume, &look,
                                        &d->state.transfer);
}

/* How often values of the simulation occur, where a picture says so. */
static void put_counts(const live *l, outbox *box, uint64_t client) {
    double ends[2], counts[COUNTS];
    json_t *list = json_object_get(l->reported, "counts");
    json_t *pair = json_object_get(l->reported, "ends");
    if (!read_numbers(pair, ends, 2) || !(ends[0] < ends[1]) ||
        !read_numbers(list, counts, COUNTS))
        return;
    json_t *tree = json_pack("{s:s, s:f, s:f, s:O}", "t", "histogram", "lo",
                             ends[0], "hi", ends[1], "counts", list);
    char *text = json_dumps(tree, JSON_COMPACT | JSON_FORM);
    outbox_put_text(box, client, MESSAGE_COUNTS, text);
    free(text);
    json_decref(tree);
}

static bool same(const json_t *a, const json_t *b, const char *key) {
    return json_equal(json_object_get(a, key), json_object_get(b, key));
}

/* What is new in a picture's comment. */
static void tell(live *l, json_t *reported, uint32_t revision, outbox *box) {
    double ends[2];
    snow_volume_info grid;
    json_t *before = l->reported;
    if (!read_grid(reported, &grid) ||
        !read_numbers(json_object_get(reported, "range"), ends, 2)) {
        json_decref(reported);
        return;
    }
    l->drawing.state.whole = grid;
    l->reported = reported;
    bool looks_alike = before && l->reported_for == revision &&
                       same(reported, before, "range") &&
                       same(reported, before, "opacity");
    bool alike = before && same(reported, before, "dims") &&
                 same(reported, before, "matrix") &&
                 same(reported, before, "range");
    l->reported_for = revision;
    snow_status status = looks_alike ? SNOW_STATUS_OK : make_ends(l, ends);
    if (!looks_alike && status == SNOW_STATUS_OK)
        status = make_look(l, ends);
    if (status != SNOW_STATUS_OK) {
        (void)fail_status(l->drawing.state.context, status);
    } else if (!looks_alike) {
        if (!alike)
            answer_info(&l->drawing, box);
        answer_look(&l->drawing, box);
    }
    put_counts(l, box, 0);
    answer_step(box, json_integer_value(json_object_get(reported, "step")));
    json_decref(before);
}

/* --- pictures and questions ----------------------------------------------- */

static void show(live *l, viewer_state *s, outbox *box) {
    size_t length = 0;
    uint32_t size[2], revision = state_revision(s);
    json_t *reported = NULL;
    unsigned char *bytes = live_files_next(&l->files, &length);
    outgoing *p = NULL;
    if (bytes && live_file_read(bytes, length, size, &reported))
        p = outgoing_new(FRAME_HEAD_BYTES + length);
    if (p) {
        const frame_head head = {
            .level = 2, .kind = FRAME_PNG, .width = size[0], .height = size[1]};
        frame_head_write(&head, p->bytes);
        memcpy(p->bytes + FRAME_HEAD_BYTES, bytes, length);
        p->topic = MESSAGE_PICTURE;
        p->revision = revision;
        tell(l, reported, revision, box);
        outbox_put(box, p);
    } else {
        json_decref(reported);
    }
    free(bytes);
}

static void frame_all(viewer_state *s, outbox *box) {
    uint32_t revision;
    json_t *keys = json_pack("{s:n, s:n}", "zoom", "target");
    free(state_set(s, keys, &revision));
    json_decref(keys);
    outbox_put(box, state_message(s, 0, 0));
}

static void answer(const live *l, viewer_state *s, outbox *box,
                   viewer_question *question) {
    const char *what =
        json_string_value(json_object_get(question->tree, "what"));
    char line[512];
    if (strcmp(what, "fit") == 0) {
        frame_all(s, box);
    } else if (strcmp(what, "histogram") == 0) {
        put_counts(l, box, question->client);
    } else if (strcmp(what, "recipe") == 0) {
        answer_recipe_text(box, question->client, l->recipe, false);
    } else if (strstr(what, "command") || strcmp(what, "depth") == 0) {
        snprintf(line, sizeof line,
                 "The simulation draws by its recipe, %.300s, which this page "
                 "changes; there is nothing else to ask.",
                 l->path);
        answer_said(box, question->client, line);
    } else {
        answer_none(box, question->client, question->tree);
    }
    json_decref(question->tree);
}

void live_run(live *l, viewer_state *s, outbox *box) {
    viewer_work work = WORK_NONE;
    uint32_t saved = state_revision(s);
    while (work != WORK_END) {
        viewer_question question;
        json_t *recipe = NULL;
        uint32_t revision = saved;
        double due;
        work = state_next(s, saved, LEVEL_ONE, &due, &question, &recipe,
                          &revision);
        if (work == WORK_ANSWER)
            answer(l, s, box, &question);
        else if (work >= WORK_DRAFT)
            save_recipe(l, recipe);
        if (work >= WORK_DRAFT)
            saved = revision;
        if (work == WORK_END || work == WORK_ANSWER)
            continue;
        show(l, s, box);
        const struct timespec some = {.tv_nsec = (long)(1e9 * REST_SECONDS)};
        nanosleep(&some, NULL);
    }
}
