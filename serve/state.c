/* state.c - implements state.h: a monitor. */
#include "state.h"
#include "kept_look.h"
#include "message.h"
#include "options/option_values.h"

#include <snowglass/recipe.h>

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct viewer_state {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    json_t *recipe;
    json_t *files; /* mask and overlay that the recipe began with */
    kept_look look;
    atomic_uint revision;
    atomic_bool ended;
    struct rest_size {
        page_size of;
        uint32_t rested; /* the revision of its picture at rest */
    } sizes[STATE_SIZES_MOST];
    int size_count;
    bool moving;
    bool crop_is_alone;
    bool touched; /* a page has changed something */
    int watchers;
    double changed_at;
    viewer_question questions[STATE_QUESTIONS_MOST]; /* a ring */
    int first, count;
    atomic_int urgent;     /* those of them that do not wait for pictures */
    bool answered;         /* the last work was an answer: pictures are next */
    snow_context *checker; /* of the thread that sets */
};

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

viewer_state *state_new(json_t *recipe) {
    pthread_condattr_t monotonic;
    viewer_state *s = calloc(1, sizeof *s);
    if (!s || snow_context_new(NULL, &s->checker) != SNOW_STATUS_OK) {
        free(s);
        return NULL;
    }
    pthread_mutex_init(&s->lock, NULL);
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&s->changed, &monotonic);
    pthread_condattr_destroy(&monotonic);
    s->recipe = recipe;
    s->files = json_object();
    s->look.written = json_object();
    for (size_t i = 0; message_switches(i); i++)
        json_object_set(s->files, message_switches(i),
                        json_object_get(recipe, message_switches(i)));
    atomic_init(&s->revision, 1);
    return s;
}

void state_free(viewer_state *s) {
    if (!s)
        return;
    for (int i = 0; i < s->count; i++)
        json_decref(s->questions[(s->first + i) % STATE_QUESTIONS_MOST].tree);
    json_decref(s->recipe);
    json_decref(s->files);
    kept_look_free(&s->look);
    snow_context_free(s->checker);
    pthread_cond_destroy(&s->changed);
    pthread_mutex_destroy(&s->lock);
    free(s);
}

/* Pages know of mask and overlay only whether they are used. */
static bool is_switch(const char *key) {
    for (size_t i = 0; message_switches(i); i++)
        if (strcmp(key, message_switches(i)) == 0)
            return true;
    return false;
}

/* What a recipe may have, and a page cannot show; or NULL. */
static const char *beyond_pages(const snow_recipe *recipe) {
    if (recipe->steps && strcmp(recipe->steps, "last") != 0)
        return "the page: \"time\" must be one step, as a range or a moment "
               "is of the command line; give its number";
    overlay_look_value look;
    const char *text = recipe->overlay_look;
    if (text && !value_overlay_look(text, &look))
        return "the page: \"overlay-look\" is not a look; give \"hot,2,12\", "
               "or "
               "opacities at values too, such as \"hot,2,12,2:0,12:0.5\"";
    if (text && points_are_factor(&look.opacity))
        return "the page: \"overlay-look\" has a factor, which is for "
               "pictures; "
               "give opacities at values, such as \"hot,10:0,30:0.5\"";
    return NULL;
}

/* What is against a recipe, or NULL. */
static char *fault_of(viewer_state *s, const json_t *recipe) {
    snow_recipe record = {.size = sizeof record};
    char *text = json_dumps(recipe, JSON_COMPACT);
    if (!text)
        return strdup("out of memory for a recipe; close other programs");
    snow_status status =
        snow_recipe_parse(s->checker, "the page", text, strlen(text), &record);
    free(text);
    if (status != SNOW_STATUS_OK)
        return strdup(snow_context_message(s->checker));
    const char *beyond = beyond_pages(&record);
    snow_recipe_clear(&record);
    return beyond ? strdup(beyond) : NULL;
}

/* A recipe with a change. */
static void change(viewer_state *s, json_t *recipe, const char *key,
                   json_t *value) {
    json_t *file = json_object_get(s->files, key);
    if (json_is_null(value) || (is_switch(key) && !file))
        json_object_del(recipe, key);
    else if (is_switch(key))
        json_object_set(recipe, key, file);
    else
        json_object_set_new(recipe, key, json_deep_copy(value));
}

/* Takes what is wrong out of changes, one by one: those that take a key out
 * come first, as they may make room for others.  Returns what is against the
 * first. */
static char *sift(viewer_state *s, json_t *changes) {
    char *first = NULL;
    json_t *recipe = json_deep_copy(s->recipe), *kept = json_object(), *value;
    const char *key;
    for (int taken = 1; taken >= 0; taken--)
        json_object_foreach(changes, key, value) {
            if (json_is_null(value) != taken)
                continue;
            json_t *tried = json_copy(recipe);
            change(s, tried, key, value);
            char *fault = fault_of(s, tried);
            if (!fault) {
                json_object_set(kept, key, value);
                change(s, recipe, key, value);
            }
            json_decref(tried);
            if (first)
                free(fault);
            else
                first = fault;
        }
    json_object_clear(changes);
    json_object_update(changes, kept);
    json_decref(kept);
    json_decref(recipe);
    return first;
}

/* The recipe that comes of changes, with its look. */
static json_t *changed_recipe(viewer_state *s, const json_t *changes,
                              kept_look *look) {
    const char *key;
    json_t *value, *recipe = json_deep_copy(s->recipe);
    *look = kept_look_copy(&s->look);
    look->changed = false;
    json_object_foreach((json_t *)changes, key, value)
        change(s, recipe, key, value);
    kept_look_follow(look, changes, recipe);
    return recipe;
}

static void take(viewer_state *s, json_t *recipe, const kept_look *look,
                 const json_t *changes) {
    json_decref(s->recipe);
    kept_look_free(&s->look);
    s->recipe = recipe;
    s->look = *look;
    s->changed_at = seconds();
    /* A step back, a link: crop and camera come together, and fit. */
    if (json_object_get(changes, "crop"))
        s->crop_is_alone = !json_object_get(changes, "zoom") &&
                           !json_object_get(changes, "target");
    s->revision++;
    pthread_cond_signal(&s->changed);
}

void state_touch(viewer_state *s) {
    pthread_mutex_lock(&s->lock);
    s->touched = true;
    pthread_mutex_unlock(&s->lock);
}

char *state_set(viewer_state *s, const json_t *changes, uint32_t *revision) {
    kept_look look;
    char *left_out = NULL;
    json_t *good = json_copy((json_t *)changes);
    pthread_mutex_lock(&s->lock);
    json_t *recipe = changed_recipe(s, good, &look);
    char *fault = fault_of(s, recipe);
    if (fault) {
        left_out = sift(s, good);
        kept_look_free(&look);
        json_decref(recipe);
        recipe = changed_recipe(s, good, &look);
        if (!left_out || !json_object_size(good)) {
            kept_look_free(&look);
            json_decref(recipe);
            recipe = NULL;
        }
    }
    if (recipe)
        take(s, recipe, &look, good);
    *revision = s->revision;
    pthread_mutex_unlock(&s->lock);
    json_decref(good);
    if (left_out)
        free(fault);
    return left_out ? left_out : fault;
}

bool state_wrote(viewer_state *s) {
    pthread_mutex_lock(&s->lock);
    bool wrote = s->look.changed;
    pthread_mutex_unlock(&s->lock);
    return wrote;
}

void state_note_look(viewer_state *s, uint32_t revision, json_t *computed) {
    pthread_mutex_lock(&s->lock);
    if (s->revision == revision)
        kept_look_note(&s->look, s->recipe, computed);
    else
        json_decref(computed);
    pthread_mutex_unlock(&s->lock);
}

bool state_crop_is_alone(viewer_state *s) {
    pthread_mutex_lock(&s->lock);
    bool alone = s->crop_is_alone;
    pthread_mutex_unlock(&s->lock);
    return alone;
}

bool state_take_back(viewer_state *s, uint32_t revision, const json_t *drawn) {
    json_t *recipe = json_deep_copy(drawn);
    pthread_mutex_lock(&s->lock);
    json_object_set(recipe, "size", json_object_get(s->recipe, "size"));
    bool other = s->revision == revision && !json_equal(recipe, s->recipe);
    if (other) {
        json_decref(s->recipe);
        s->recipe = json_incref(recipe);
        s->revision++;
    }
    pthread_mutex_unlock(&s->lock);
    json_decref(recipe);
    return other;
}

json_t *state_recipe(viewer_state *s) {
    pthread_mutex_lock(&s->lock);
    json_t *copy = json_deep_copy(s->recipe);
    pthread_mutex_unlock(&s->lock);
    return copy;
}

outgoing *state_message(viewer_state *s, uint64_t client, uint64_t except) {
    const char *key;
    json_t *value, *shown = json_object();
    pthread_mutex_lock(&s->lock);
    json_object_foreach(s->recipe, key, value) if (message_may_set(key))
        json_object_set_new(
            shown, key, is_switch(key) ? json_true() : json_deep_copy(value));
    uint32_t revision = s->revision;
    const bool touched = s->touched;
    json_t *computed = json_array();
    json_object_foreach(s->look.written, key, value)
        json_array_append_new(computed, json_string(key));
    pthread_mutex_unlock(&s->lock);
    char *text = json_dumps(shown, JSON_COMPACT | JSON_REAL_PRECISION(17));
    char *written = json_dumps(computed, JSON_COMPACT);
    json_decref(shown);
    json_decref(computed);
    size_t most =
        (text ? strlen(text) : 0) + (written ? strlen(written) : 0) + 96;
    outgoing *made = text && written ? outgoing_new(most) : NULL;
    if (made) {
        made->length = (size_t)snprintf(
            (char *)made->bytes, most,
            STATE_HEAD "%-10u,\"touched\":%s,\"computed\":%s,\"recipe\":%s}",
            0U, touched ? "true" : "false", written, text);
        made->is_text = true;
        made->topic = MESSAGE_STATE;
        made->client = client;
        made->except = except;
        made->revision = revision;
    }
    free(text);
    free(written);
    return made;
}

static void read_size(const json_t *recipe, int64_t size[2]) {
    const json_t *list = json_object_get(recipe, "size");
    for (size_t i = 0; i < 2; i++)
        size[i] = json_integer_value(json_array_get(list, i));
}

void state_set_sizes(viewer_state *s, const page_size *sizes, int count) {
    struct rest_size now[STATE_SIZES_MOST];
    pthread_mutex_lock(&s->lock);
    for (int i = 0; i < count; i++) {
        now[i] = (struct rest_size){sizes[i], 0};
        for (int k = 0; k < s->size_count; k++)
            if (s->sizes[k].of.width == sizes[i].width &&
                s->sizes[k].of.height == sizes[i].height)
                now[i].rested = s->sizes[k].rested;
    }
    memcpy(s->sizes, now, (size_t)count * sizeof *now);
    s->size_count = count;
    pthread_cond_signal(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

void state_note_rest(viewer_state *s, const json_t *recipe, uint32_t revision) {
    int64_t size[2];
    read_size(recipe, size);
    pthread_mutex_lock(&s->lock);
    for (int i = 0; i < s->size_count; i++)
        if (s->sizes[i].of.width == size[0] && s->sizes[i].of.height == size[1])
            s->sizes[i].rested = revision;
    pthread_cond_signal(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

void state_set_moving(viewer_state *s, bool moving) {
    pthread_mutex_lock(&s->lock);
    s->moving = moving;
    s->changed_at = seconds();
    pthread_cond_signal(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

void state_set_watchers(viewer_state *s, int count) {
    pthread_mutex_lock(&s->lock);
    s->watchers = count;
    if (!count)
        s->moving = false;
    pthread_cond_signal(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

bool state_ask(viewer_state *s, uint64_t client, json_t *tree) {
    const char *what = json_string_value(json_object_get(tree, "what"));
    bool waits = what && strcmp(what, "thumbnail") == 0;
    bool slow = what && strcmp(what, "histogram") == 0;
    pthread_mutex_lock(&s->lock);
    const json_t *pane = json_object_get(tree, "pane");
    viewer_question *same = NULL; /* a thumbnail of the same pane */
    int own = 0;
    for (int i = 0; i < s->count; i++) {
        viewer_question *q =
            &s->questions[(s->first + i) % STATE_QUESTIONS_MOST];
        own += q->client == client;
        if (waits && !same && q->waits && q->client == client &&
            json_equal(json_object_get(q->tree, "pane"), pane))
            same = q;
    }
    bool capacity = same || (s->count < STATE_QUESTIONS_MOST &&
                             own < STATE_QUESTIONS_OF_PAGE);
    if (same) {
        /* The newer one of two thumbnails of a pane is made; one that is asked
         * again is the older. */
        bool older = json_is_true(json_object_get(tree, "again"));
        json_decref(older ? tree : same->tree);
        if (!older)
            same->tree = tree;
    } else if (capacity)
        s->questions[(s->first + s->count++) % STATE_QUESTIONS_MOST] =
            (viewer_question){client, tree, waits, slow};
    s->urgent += capacity && !waits && !slow;
    pthread_cond_signal(&s->changed);
    pthread_mutex_unlock(&s->lock);
    if (!capacity)
        json_decref(tree);
    return capacity;
}

void state_end(viewer_state *s) {
    s->ended = true;
    pthread_mutex_lock(&s->lock);
    pthread_cond_signal(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

/* The next picture, and when it is due; WORK_NONE: none. */
/* Another page's size that has no picture at rest yet; or NULL. */
static const struct rest_size *next_size(const viewer_state *s) {
    for (int i = 0; i < s->size_count; i++)
        if (s->sizes[i].rested != s->revision)
            return &s->sizes[i];
    return NULL;
}

static viewer_work next_picture(const viewer_state *s, uint32_t drawn,
                                int level, double *due) {
    *due = 0;
    if (!s->watchers)
        return WORK_NONE;
    if (level < 0 || drawn != s->revision)
        return WORK_DRAFT;
    if (s->moving || level > 2 || (level == 2 && !next_size(s)))
        return WORK_NONE;
    *due = s->changed_at + (level ? STATE_HIGH_SECONDS : STATE_NORMAL_SECONDS);
    return level ? WORK_HIGH : WORK_NORMAL;
}

/* The place of the next question, from the first, or -1.  Thumbnails come after
 * all others. */
static int next_question(const viewer_state *s, bool rests) {
    for (int i = 0; i < s->count; i++)
        if (!s->questions[(s->first + i) % STATE_QUESTIONS_MOST].waits)
            return i;
    return rests && s->count ? 0 : -1;
}

/* Those before it move up. */
static viewer_question take_question(viewer_state *s, int place) {
    viewer_question taken =
        s->questions[(s->first + place) % STATE_QUESTIONS_MOST];
    for (; place > 0; place--)
        s->questions[(s->first + place) % STATE_QUESTIONS_MOST] =
            s->questions[(s->first + place - 1) % STATE_QUESTIONS_MOST];
    s->first = (s->first + 1) % STATE_QUESTIONS_MOST;
    s->count--;
    s->urgent -= !taken.waits && !taken.slow;
    return taken;
}

/* Under the lock: what can be done now; WORK_NONE: nothing before *due or,
 * where that is 0, before something changes.  Answers and drafts take turns, so
 * that neither waits for all of the other; so do slow answers and all pictures.
 */
static viewer_work choose(viewer_state *s, uint32_t drawn, int level,
                          int *place, double *due) {
    viewer_work picture = next_picture(s, drawn, level, due);
    bool ready = picture != WORK_NONE && *due <= seconds();
    *place = next_question(s, picture == WORK_NONE && !s->moving);
    if (s->ended)
        return WORK_END;
    const bool slow =
        *place >= 0 &&
        s->questions[(s->first + *place) % STATE_QUESTIONS_MOST].slow;
    const bool turn = ready && s->answered && (slow || picture == WORK_DRAFT);
    if (*place >= 0 && !turn)
        return WORK_ANSWER;
    return ready ? picture : WORK_NONE;
}

static void wait_for_change(viewer_state *s, double due) {
    if (due > 0) {
        struct timespec at = {.tv_sec = (time_t)due};
        at.tv_nsec = (long)((due - (double)at.tv_sec) * 1e9);
        pthread_cond_timedwait(&s->changed, &s->lock, &at);
    } else
        pthread_cond_wait(&s->changed, &s->lock);
}

viewer_work state_next(viewer_state *s, uint32_t drawn, int level, double *due,
                       viewer_question *question, json_t **recipe,
                       uint32_t *revision) {
    pthread_mutex_lock(&s->lock);
    int place;
    double at;
    viewer_work work;
    while ((work = choose(s, drawn, level, &place, &at)) == WORK_NONE && !due)
        wait_for_change(s, at);
    s->answered = work == WORK_ANSWER || (work == WORK_NONE && s->answered);
    if (due)
        *due = at;
    if (work == WORK_ANSWER) {
        *question = take_question(s, place);
    } else if (work >= WORK_DRAFT) {
        const struct rest_size *size =
            level == 2 && drawn == s->revision ? next_size(s) : NULL;
        *recipe = json_deep_copy(s->recipe);
        *revision = s->revision;
        if (size)
            json_object_set_new(*recipe, "size",
                                json_pack("[I,I]", (json_int_t)size->of.width,
                                          (json_int_t)size->of.height));
    }
    pthread_mutex_unlock(&s->lock);
    return work;
}

bool state_is_stale(const viewer_state *s, uint32_t revision) {
    return s->ended || s->revision != revision;
}

bool state_is_asked(const viewer_state *s) {
    return s->urgent > 0;
}

uint32_t state_revision(const viewer_state *s) {
    return s->revision;
}

bool state_has_ended(const viewer_state *s) {
    return s->ended;
}
