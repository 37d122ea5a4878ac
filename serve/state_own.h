/* state_own.h - the state as state.c and state_recipe.c have it. */
#ifndef STATE_OWN_H
#define STATE_OWN_H

#include "kept_look.h"
#include "state.h"

#include <snowglass/snowglass.h>

#include <pthread.h>
#include <stdatomic.h>

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

/* The files that pages switch are those of the recipe now. */
void state_note_files(viewer_state *s);

/* Of the monotonic clock. */
double state_seconds(void);

#endif
