/* state_recipe.c - the recipe of a state, which pages change; see state.h. */
#include "message.h"
#include "options/option_values.h"
#include "state_own.h"

#include <snowglass/recipe.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    s->changed_at = state_seconds();
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

void state_replace(viewer_state *s, json_t *recipe) {
    pthread_mutex_lock(&s->lock);
    if (json_object_get(s->recipe, "size"))
        json_object_set(recipe, "size", json_object_get(s->recipe, "size"));
    json_decref(s->recipe);
    kept_look_free(&s->look);
    s->recipe = recipe;
    s->look = (kept_look){.written = json_object()};
    state_note_files(s);
    s->touched = s->crop_is_alone = false;
    s->changed_at = state_seconds();
    s->revision++;
    pthread_cond_signal(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

json_t *state_recipe(viewer_state *s) {
    pthread_mutex_lock(&s->lock);
    json_t *copy = json_deep_copy(s->recipe);
    pthread_mutex_unlock(&s->lock);
    return copy;
}

outgoing *state_message(viewer_state *s, uint64_t client, uint64_t except) {
    const char *key;
    json_t *value, *set = json_object(), *computed = json_object();
    pthread_mutex_lock(&s->lock);
    json_object_foreach(s->recipe, key, value) if (message_may_set(key))
        json_object_set_new(
            json_object_get(s->look.written, key) ? computed : set, key,
            is_switch(key) ? json_true() : json_deep_copy(value));
    uint32_t revision = s->revision;
    const bool touched = s->touched;
    pthread_mutex_unlock(&s->lock);
    char *keys = json_dumps(set, JSON_COMPACT | JSON_REAL_PRECISION(17));
    char *others = json_dumps(computed, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(set);
    json_decref(computed);
    size_t most =
        (keys ? strlen(keys) : 0) + (others ? strlen(others) : 0) + 96;
    outgoing *made = keys && others ? outgoing_new(most) : NULL;
    if (made) {
        made->length = (size_t)snprintf(
            (char *)made->bytes, most,
            STATE_HEAD "%-10u,\"touched\":%s,\"keys\":%s,\"computed\":%s}", 0U,
            touched ? "true" : "false", keys, others);
        made->is_text = true;
        made->topic = MESSAGE_STATE;
        made->client = client;
        made->except = except;
        made->revision = revision;
    }
    free(keys);
    free(others);
    return made;
}
