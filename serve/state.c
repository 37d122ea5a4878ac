/* state.c - implements state.h: a monitor. */
#include "message.h"
#include "state_own.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

double state_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void state_note_files(viewer_state *s) {
    json_object_clear(s->files);
    for (size_t i = 0; message_switches(i); i++)
        json_object_set(s->files, message_switches(i),
                        json_object_get(s->recipe, message_switches(i)));
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
    state_note_files(s);
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
    s->changed_at = state_seconds();
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
    bool slow =
        what && (strcmp(what, "histogram") == 0 || strcmp(what, "times") == 0);
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
    bool ready = picture != WORK_NONE && *due <= state_seconds();
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
