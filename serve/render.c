/* render.c - implements render.h. */
#include "render.h"
#include "answers/answers.h"
#include "draw/draft.h"
#include "draw/share.h"
#include "draw/shortage.h"

#include "commands/commands.h"
#include "picture/warnings.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct renderer {
    drawing *drawing;
    viewer_state *state;
    outbox *box;
    packer *pack;
    uint32_t drawn; /* the last picture's revision */
    int level;      /* and quality; -1: none yet */
    int shrink;
    draft_times times;
    uint32_t revision; /* of the picture under way */
    json_t *good;      /* the last recipe that was drawn, or opened with */
    json_t *vain;      /* what had no room in an emptied drawing; NULL: none */
    bool reported_empty;
    char replaced[IDENTITY_BYTES]; /* the file by which it was, as was said */
    bool reopened;
    renderer_opener opener; /* of another volume; NULLs: there is none */
    double radius;          /* of the volume that was read last */
    order_fn *order;        /* writes movies; NULL: nobody does */
    void *order_user;
};

static bool asks_for_end(void *user) {
    const renderer *r = user;
    return state_has_ended(r->state);
}

/* A picture at rest, which may take long, begins again after an answer. */
static bool is_stale(void *user) {
    const renderer *r = user;
    return state_is_stale(r->state, r->revision) || state_is_asked(r->state);
}

static void free_pictures(picture *made) {
    while (made) {
        picture *next = made->next;
        snow_overlay_free(made->overlay);
        snow_image_free(made->image);
        free(made);
        made = next;
    }
}

static void tell_state(renderer *r) {
    outbox_put(r->box, state_message(r->state, 0, 0));
}

/* A new range or preset that shows nothing is reported once, until something is
 * seen again. */
static void tell_empty(renderer *r, snow_image *image) {
    bool empty = picture_is_empty(image);
    if (empty && !r->reported_empty)
        outbox_put_text(r->box, 0, MESSAGE_PLAIN,
                        "{\"t\":\"said\",\"text\":\"Nothing is visible: change "
                        "the range, the opacity or the clip planes.\"}");
    r->reported_empty = empty;
}

static void hand_over(renderer *r, snow_image *image, snow_overlay *overlay,
                      int level, double took) {
    picture *made = malloc(sizeof *made);
    if (!made) {
        snow_overlay_free(overlay);
        snow_image_free(image);
        return;
    }
    *made =
        (picture){.image = image,
                  .overlay = overlay,
                  .form = picture_form(&r->drawing->opts,
                                       render_state_ground(&r->drawing->state)),
                  .revision = r->revision,
                  .level = level,
                  .render_us = (uint32_t)(took * 1e6)};
    free_pictures(packer_put(r->pack, made));
}

static int draw(renderer *r, int level) {
    static const snow_quality qualities[] = {
        SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};
    snow_image *image;
    snow_overlay *overlay;
    if (level > 0)
        free_pictures(packer_wait(r->pack));
    double begin = seconds_now();
    int done =
        drawing_render(r->drawing, qualities[level], level ? 0 : r->shrink,
                       level ? is_stale : asks_for_end, r, &image, &overlay);
    if (done != CONTINUE)
        return done;
    double took = seconds_now() - begin + r->drawing->earlier_seconds;
    double packed = packer_pixel_seconds(r->pack) * snow_image_width(image) *
                    snow_image_height(image);
    r->shrink =
        draft_follow(&r->times, r->shrink, level, took + packed,
                     snow_frame_stats(r->drawing->state.frame)->encoded);
    if (level > 0)
        tell_empty(r, image);
    hand_over(r, image, overlay, level, took);
    double hidden = share_hidden(r->drawing, level == 2);
    if (level > 0)
        answer_figures(r->drawing, hidden, r->box);
    return CONTINUE;
}

/* Another crop has another middle and size, which zoom goes by: it is changed
 * so that the object stays as large, unless a page set both.  Whether the state
 * is a new one. */
static bool keep_scale(renderer *r) {
    double middle[3], radius, before = r->radius;
    uint32_t revision;
    if (!r->drawing->volume_is_new)
        return false;
    r->drawing->volume_is_new = false;
    drawing_middle(r->drawing, middle, &radius);
    r->radius = radius;
    if (r->reopened) {
        answer_info(r->drawing, r->box);
        r->reopened = false;
        return false;
    }
    if (!(fabs(radius - before) > 1e-9 * before))
        return false;
    answer_info(r->drawing, r->box);
    if (!r->drawing->opts.target.given || !state_crop_is_alone(r->state))
        return false;
    json_t *keys =
        json_pack("{s:f}", "zoom", r->drawing->opts.zoom * radius / before);
    free(state_set(r->state, keys, &revision));
    json_decref(keys);
    tell_state(r);
    return true;
}

/* What comes of a state: drawn, or CONTINUE where another one comes first. */
typedef struct outcome {
    int done;
    bool applied, rescaled;
} outcome;

static outcome try_state(renderer *r, int level, const json_t *recipe,
                         bool anew) {
    outcome o = {.done = anew ? drawing_apply(r->drawing, recipe) : CONTINUE};
    o.applied = o.done == CONTINUE;
    o.rescaled = o.applied && keep_scale(r);
    if (o.applied && !o.rescaled)
        o.done = draw(r, level);
    return o;
}

/* Where memory is short, pictures and volumes before go first: then there is
 * as much as the command of the state has. */
static void make_room(renderer *r) {
    free_pictures(packer_wait(r->pack));
    drawing_empty(r->drawing);
}

static outcome draw_emptied(renderer *r, int level, const json_t *recipe) {
    make_room(r);
    say_later();
    outcome o = try_state(r, level, recipe, true);
    say_now(o.done == SNOW_STATUS_NO_MEMORY);
    json_decref(r->vain);
    r->vain =
        o.done == SNOW_STATUS_NO_MEMORY ? shortage_need(recipe, level) : NULL;
    return o;
}

/* Where memory is short, a second time in an emptied drawing: unless that is
 * known to be in vain. */
static outcome draw_state(renderer *r, int level, const json_t *recipe,
                          bool anew) {
    const bool one = process_ranks() == 1;
    if (one)
        say_later();
    outcome o = try_state(r, level, recipe, anew);
    bool is_short = one && o.done == SNOW_STATUS_NO_MEMORY;
    say_now(is_short);
    if (is_short) {
        json_t *need = shortage_need(recipe, level);
        const bool in_vain = r->vain && json_equal(need, r->vain);
        json_decref(need);
        if (!in_vain)
            o = draw_emptied(r, level, recipe);
    }
    if (one && o.done == SNOW_STATUS_NO_MEMORY)
        shortage_say(&r->drawing->opts, level);
    return o;
}

static bool reopens(renderer *r, const char *what) {
    if (strcmp(what, "reopen") != 0 || process_ranks() > 1 || r->drawing->waits)
        return false;
    make_room(r);
    identity_of(r->drawing->opts.operands[0], r->drawing->identity);
    memcpy(r->replaced, r->drawing->identity, sizeof r->replaced);
    r->reopened = true;
    r->level = -1;
    return true;
}

/* Takes over the recipe. */
static void take_volume(renderer *r, json_t *recipe) {
    double middle[3];
    drawing *d = r->drawing;
    d->waits = false;
    d->opened++;
    state_replace(r->state, recipe);
    renderer_begin(d, r->state, r->box);
    tell_state(r);
    json_decref(r->good);
    json_decref(r->vain);
    r->good = state_recipe(r->state);
    r->vain = NULL;
    r->reported_empty = false;
    r->replaced[0] = 0;
    drawing_middle(d, middle, &r->radius);
}

/* Another volume in the place of the one before, which comes back where the
 * other cannot be opened. */
static bool switch_volume(renderer *r, const json_t *question) {
    static options before; /* large; one thread draws */
    const options *first;
    const json_t *recipe;
    drawing *d = r->drawing;
    if (r->opener.choose(r->opener.user, question, &first, &recipe) != CONTINUE)
        return false;
    before = d->first;
    make_room(r);
    const bool good = drawing_switch(d, first, recipe) == CONTINUE;
    if (!good) {
        make_room(r);
        d->first = before;
    }
    json_t *begun = good ? json_deep_copy(recipe) : NULL;
    r->opener.opened(r->opener.user, good);
    if (good)
        take_volume(r, begun);
    else if (!d->waits) {
        say_later();
        (void)drawing_switch(d, &before, r->good);
        say_now(true);
    }
    r->level = -1;
    return good;
}

/* A page that has come back asks for the volume that it showed, unless another
 * page was "first": all have heard what that opened. */
static bool opens(renderer *r, const viewer_question *question) {
    const char *what =
        json_string_value(json_object_get(question->tree, "what"));
    const json_t *first = json_object_get(question->tree, "first");
    if (strcmp(what, "open") != 0 || !r->opener.choose)
        return false;
    const bool late = json_is_true(first) && !r->drawing->waits;
    const bool good = late || switch_volume(r, question->tree);
    answer_put(r->box, question->client, MESSAGE_PLAIN,
               json_pack("{s:s, s:b}", "t", "opened", "good", (int)good));
    return true;
}

static void serve_answer(renderer *r, const viewer_question *question) {
    const char *what =
        json_string_value(json_object_get(question->tree, "what"));
    if (reopens(r, what) || opens(r, question)) {
        json_decref(question->tree);
        return;
    }
    const bool orders = r->order && strcmp(what, "movie") == 0;
    if (orders && !r->drawing->waits)
        r->order(r->order_user, r->drawing, r->state, question);
    if (r->drawing->waits) {
        answer_none(r->box, question->client, question->tree);
        answer_said(r->box, question->client,
                    "Nothing is open yet: choose a volume.");
    }
    if (orders || r->drawing->waits) {
        json_decref(question->tree);
        return;
    }
    const bool again = process_ranks() == 1;
    if (again)
        say_later();
    bool answered = answer_question(r->drawing, r->state, r->box, question) !=
                    SNOW_STATUS_NO_MEMORY;
    say_now(again && !answered);
    if (again && !answered) {
        make_room(r);
        answered = answer_question(r->drawing, r->state, r->box, question) !=
                   SNOW_STATUS_NO_MEMORY;
        if (!r->drawing->state.volume)
            r->level = -1; /* a picture opens it again, or says why not */
    }
    if (!answered)
        answer_none(r->box, question->client, question->tree);
    json_decref(question->tree);
}

/* The volume and the look of the last good recipe.  What is noted of them was
 * said when they were opened first, and would hide why they come back. */
static void restore(renderer *r) {
    say_later();
    drawing_apply(r->drawing, r->good);
    say_now(true);
}

/* What a page asked for and the volume has not stays in no recipe: the state
 * before comes back.  What has no room stays; answers are of the volume before.
 */
static void note_recipe(renderer *r, const outcome *o, json_t *recipe) {
    const bool wrong =
        o->done == SNOW_STATUS_BAD_USAGE || o->done == SNOW_STATUS_BAD_INPUT;
    if (!o->rescaled && (o->done == CONTINUE || o->done == EXIT_INTERRUPTED)) {
        json_decref(r->good);
        r->good = json_incref(recipe);
    } else if (wrong && state_take_back(r->state, r->revision, r->good)) {
        restore(r);
        tell_state(r);
    } else if (o->done == SNOW_STATUS_NO_MEMORY && !r->drawing->state.volume) {
        restore(r);
    }
}

/* A state that cannot be drawn is not tried again. */
static void serve_state(renderer *r, int level, json_t *recipe,
                        uint32_t revision) {
    if (r->drawing->waits) {
        state_note_rest(r->state, recipe, revision);
        json_decref(recipe);
        r->drawn = revision;
        r->level = 2;
        return;
    }
    const bool anew = r->drawn != revision || r->level < 0;
    const bool beside = !anew && r->level == 2; /* another page's size */
    r->revision = revision;
    outcome o = draw_state(r, level, recipe, anew || beside);
    note_recipe(r, &o, recipe);
    if (level > 0)
        answer_replaced(r->drawing, r->replaced, r->box);
    if (level == 2 && o.done != EXIT_INTERRUPTED)
        state_note_rest(r->state, recipe, revision);
    json_decref(recipe);
    if (beside)
        return;
    if (o.rescaled)
        return;
    if (r->drawing->look_is_new && o.applied)
        answer_look(r->drawing, r->box);
    if (o.applied)
        answer_kept(r->drawing, r->state, revision);
    r->drawing->look_is_new = false;
    bool stopped = o.done == EXIT_INTERRUPTED;
    r->drawn = revision;
    /* The same level is drawn again where it was stopped. */
    r->level = o.done == CONTINUE ? level : stopped ? level - 1 : 2;
}

void renderer_begin(drawing *d, viewer_state *s, outbox *box) {
    uint32_t revision;
    json_t *keys = d->opts.target.given ? json_object() : drawing_fit(d);
    if (json_object_size(keys))
        free(state_set(s, keys, &revision));
    json_decref(keys);
    d->volume_is_new = false;
    answer_info(d, box);
    answer_look(d, box);
    answer_kept(d, s, state_revision(s));
}

viewer_work renderer_step(renderer *r, double *due) {
    viewer_question question;
    json_t *recipe = NULL;
    uint32_t revision = 0;
    packer_wait_for_draft(r->pack);
    viewer_work work = state_next(r->state, r->drawn, r->level, due, &question,
                                  &recipe, &revision);
    if (work == WORK_ANSWER)
        serve_answer(r, &question);
    else if (work >= WORK_DRAFT)
        serve_state(r, (int)work - WORK_DRAFT, recipe, revision);
    return work;
}

/* Reading again, and encoding, may take long: pages see how far it is.  A
 * picture is soon there, or was not waited for. */
static bool show_progress(void *user, snow_stage stage, double fraction) {
    renderer *r = user;
    static const char *const names[] = {
        [SNOW_STAGE_READ] = "reading", [SNOW_STAGE_ENCODE] = "encoding"};
    if (stage > SNOW_STAGE_ENCODE)
        return state_has_ended(r->state);
    json_t *tree = json_pack("{s:s, s:s, s:f}", "t", "progress", "stage",
                             names[stage], "part", fraction);
    char *text = json_dumps(tree, JSON_COMPACT);
    outbox_put_text(r->box, 0, MESSAGE_PROGRESS, text);
    free(text);
    json_decref(tree);
    return state_has_ended(r->state);
}

renderer *renderer_new(drawing *d, viewer_state *s, outbox *box, packer *pack,
                       const renderer_opener *opener, order_fn *order,
                       void *order_user) {
    double middle[3];
    renderer *r = malloc(sizeof *r);
    if (!r)
        return NULL;
    *r = (renderer){.drawing = d,
                    .state = s,
                    .box = box,
                    .pack = pack,
                    .level = -1,
                    .order = order,
                    .order_user = order_user};
    if (opener)
        r->opener = *opener;
    r->good = state_recipe(s);
    drawing_middle(d, middle, &r->radius);
    snow_context_set_progress(d->state.context, show_progress, r);
    return r;
}

void renderer_free(renderer *r) {
    if (!r)
        return;
    free_pictures(packer_end(r->pack));
    snow_context_set_progress(r->drawing->state.context, NULL, NULL);
    json_decref(r->good);
    json_decref(r->vain);
    free(r);
}
