/* kept_look.c - implements kept_look.h. */
#include "kept_look.h"

#include <stddef.h>

/* The four parts, each with the keys that say it. */
#define PART_KEYS 3
static const char *const parts[][PART_KEYS] = {
    {"colormap", "preset", "tf"}, {"opacity"}, {"range", "window"}, {"shade"}};
#define PARTS (sizeof parts / sizeof *parts)

/* Keys by which another look is chosen, or made of other values. */
static const char *const others[] = {"preset", "channel", "component", "mode",
                                     "scale",  "time",    "crop",      "clip",
                                     "mask",   "labels"};

kept_look kept_look_copy(const kept_look *k) {
    return (kept_look){json_incref(k->computed), json_incref(k->base),
                       json_copy(k->written), k->changed};
}

void kept_look_free(kept_look *k) {
    json_decref(k->computed);
    json_decref(k->base);
    json_decref(k->written);
}

static const json_t *found(const json_t *keys, const char *key) {
    const json_t *value = key ? json_object_get(keys, key) : NULL;
    return json_is_null(value) ? NULL : value;
}

static bool has(const json_t *keys, size_t part) {
    for (size_t i = 0; i < PART_KEYS; i++)
        if (found(keys, parts[part][i]))
            return true;
    return false;
}

static bool names(const json_t *changes, size_t part) {
    for (size_t i = 0; i < PART_KEYS; i++)
        if (parts[part][i] && json_object_get(changes, parts[part][i]))
            return true;
    return false;
}

static void replace(json_t **at, json_t *by) {
    json_decref(*at);
    *at = by;
}

/* Whether a page, or the command line, has set a part; a preset is a look, of
 * which nothing is changed. */
static bool is_touched(const kept_look *k, const json_t *recipe) {
    static const char *const keys[] = {"colormap", "opacity", "range", "window",
                                       "shade"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (found(recipe, keys[i]) && !json_object_get(k->written, keys[i]))
            return true;
    return false;
}

void kept_look_note(kept_look *k, const json_t *recipe, json_t *computed) {
    replace(&k->computed, computed);
    if (!is_touched(k, recipe))
        replace(&k->base, json_incref(computed));
}

/* Points of the opacity go with a range of two numbers, as the library spreads
 * those of a preset; NULL: it has to do so. */
static json_t *spread(const json_t *points, const json_t *from,
                      const json_t *to) {
    const double low = json_number_value(json_array_get(from, 0));
    const double wide = json_number_value(json_array_get(from, 1)) - low;
    const json_t *first = json_array_get(to, 0), *last = json_array_get(to, 1);
    if (!json_is_number(first) || !json_is_number(last) || !(wide > 0))
        return NULL;
    const double a = json_number_value(first), b = json_number_value(last);
    json_t *list = json_array();
    for (size_t i = 0; i < json_array_size(points); i++) {
        const json_t *point = json_array_get(points, i);
        const double at = json_number_value(json_array_get(point, 0));
        const double share = (at - low) / wide;
        const bool same =
            !(a < low) && !(low < a) && !(b < low + wide) && !(low + wide < b);
        json_array_append_new(list, json_pack("[f,O]",
                                              same ? at : a + share * (b - a),
                                              json_array_get(point, 1)));
    }
    return list;
}

static void write_key(kept_look *k, json_t *recipe, const char *key,
                      json_t *value) {
    if (!value)
        return;
    json_object_set_new(recipe, key, value);
    json_object_set_new(k->written, key, json_true());
    k->changed = true;
}

/* Points of a look, where a recipe has its range. */
static json_t *opacity_of(const json_t *look, const json_t *recipe) {
    json_t *points = json_object_get(look, "opacity");
    if (!has(recipe, 2))
        return json_incref(points);
    return points && !found(recipe, "scale")
               ? spread(points, json_object_get(look, "range"),
                        json_object_get(recipe, "range"))
               : NULL;
}

static void write_part(kept_look *k, const json_t *look, json_t *recipe,
                       size_t part) {
    for (size_t i = 0; i < PART_KEYS && parts[part][i]; i++)
        write_key(k, recipe, parts[part][i],
                  part == 1
                      ? opacity_of(look, recipe)
                      : json_incref(json_object_get(look, parts[part][i])));
}

/* What was written goes, and the look is the one without changes. */
static void drop_written(kept_look *k, json_t *recipe) {
    const char *key;
    json_t *value;
    json_object_foreach(k->written, key, value) {
        json_object_del(recipe, key);
        k->changed = true;
    }
    json_object_clear(k->written);
    replace(&k->computed, json_incref(k->base));
}

void kept_look_follow(kept_look *k, const json_t *changes, json_t *recipe) {
    bool other = false, touched = false, taken = false;
    for (size_t i = 0; i < PARTS; i++) {
        touched |= has(changes, i);
        taken |= names(changes, i) && !has(changes, i);
        for (size_t j = 0; j < PART_KEYS; j++)
            if (parts[i][j] && json_object_get(changes, parts[i][j]))
                json_object_del(k->written, parts[i][j]);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        other |= json_object_get(changes, others[i]) != NULL;
    if (json_object_get(changes, "preset") ||
        json_object_get(changes, "channel"))
        drop_written(k, recipe);
    if (other) {
        replace(&k->computed, NULL);
        replace(&k->base, NULL);
    }
    if (!is_touched(k, recipe)) {
        drop_written(k, recipe);
        return;
    }
    if (k->computed && names(changes, 2) &&
        json_object_get(k->written, "opacity"))
        write_part(k, k->computed, recipe, 1);
    for (size_t i = 0; (touched || taken) && i < PARTS; i++) {
        const json_t *look = names(changes, i) ? k->base : k->computed;
        if (look && !has(recipe, i))
            write_part(k, look, recipe, i);
    }
}
