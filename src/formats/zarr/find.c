/* formats/zarr/find.c - selects the array of a store that is the volume.
 *
 * A path may name an array, an image of OME-Zarr (a group whose attributes have
 * "multiscales") or a group that contains one of these.  The finest existing
 * resolution level of an image is read.  An array that belongs to an image is
 * read with the image's metadata, whichever way it was named. */
#include "formats/zarr/zarr.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* The most nested groups, and folders, that a search visits. */
#define MOST_DEPTH 6
#define MOST_FOLDERS 10000

/* Size of the lists of names in messages. */
#define LIST_BYTES 700

/* --- images --------------------------------------------------------------- */

/* The entry of "multiscales" of attributes by its index, or NULL.  Since
 * version 0.5 all of OME's metadata are one attribute. */
static const json_t *image_at(const json_t *attributes, size_t index) {
    const json_t *own = json_object_get(attributes, "ome");
    const json_t *list = json_object_get(own ? own : attributes, "multiscales");
    const json_t *image = json_array_get(list, index);
    size_t levels = json_array_size(json_object_get(image, "datasets"));
    return levels && levels <= ZARR_MOST_LEVELS ? image : NULL;
}

/* Names within a group: none is empty or leads out of the group. */
static bool is_safe(const char *path) {
    for (const char *at = path; at;) {
        const char *end = strchr(at, '/');
        size_t letters = end ? (size_t)(end - at) : strlen(at);
        if (!letters || (letters <= 2 && !strncmp(at, "..", letters)))
            return false;
        at = end ? end + 1 : NULL;
    }
    return strlen(path) < ZARR_PATH_BYTES / 2;
}

const char *snow_zarr_level_path(const json_t *image, size_t index) {
    const json_t *level =
        json_array_get(json_object_get(image, "datasets"), index);
    const char *path = json_string_value(json_object_get(level, "path"));
    return path && is_safe(path) ? path : NULL;
}

static size_t level_count(const json_t *image) {
    return json_array_size(json_object_get(image, "datasets"));
}

static snow_status look_below(const zarr_store *store, const char *path,
                              const char *name, zarr_node *out) {
    char whole[ZARR_PATH_BYTES];
    SNOW_TRY(snow_zarr_join(store, path, name, whole));
    return snow_zarr_look(store, whole, out);
}

/* "name (5, 6, 7)", sizes in the order of the file. */
static void append_array(char list[LIST_BYTES], const char *name,
                         const json_t *meta) {
    char text[24 * ZARR_MOST_AXES] = "";
    const json_t *shape = json_object_get(meta, "shape");
    size_t axes = json_array_size(shape);
    int used = 0;
    for (size_t i = 0; i < axes && i < ZARR_MOST_AXES; i++)
        used += snow_text_print(text + used, sizeof text - (size_t)used,
                                "%s%.0f", i ? ", " : "",
                                json_number_value(json_array_get(shape, i)));
    snow_list_add(list, LIST_BYTES, "%.300s (%s)", name, text);
}

/* Lists the existing resolution levels of an image, and returns the first; -1
 * if there are none. */
static snow_status list_levels(const zarr_store *store, const char *group,
                               const json_t *image, char list[LIST_BYTES],
                               int *first) {
    *first = -1;
    for (size_t i = 0; i < level_count(image); i++) {
        const char *path = snow_zarr_level_path(image, i);
        zarr_node node;
        if (!path)
            return snow_zarr_fail(store, group,
                                  "has an invalid path for level %zu of its "
                                  "image; correct the attributes",
                                  i);
        SNOW_TRY(look_below(store, group, path, &node));
        if (node.kind == ZARR_ARRAY) {
            append_array(list, path, node.meta);
            if (*first < 0)
                *first = (int)i;
        }
        snow_zarr_forget(&node);
    }
    return SNOW_STATUS_OK;
}

/* --- selecting the array -------------------------------------------------- */

static snow_status take_array(const zarr_store *store, const char *path,
                              zarr_found *found) {
    zarr_node node;
    SNOW_TRY(snow_zarr_look(store, path, &node));
    snow_status status = snow_zarr_describe(store, path, &node, &found->array);
    found->attributes = json_incref(node.attributes);
    snow_zarr_forget(&node);
    return status;
}

/* Takes over the node of the image. */
static snow_status take_level(const zarr_store *store, const char *group,
                              zarr_node *node, const json_t *image, int index,
                              zarr_found *found) {
    char path[ZARR_PATH_BYTES];
    found->node = *node;
    *node = (zarr_node){ZARR_NOTHING, 0, NULL, NULL};
    found->image = image;
    found->index = index;
    found->levels = (int)level_count(image);
    found->level =
        json_array_get(json_object_get(image, "datasets"), (size_t)index);
    SNOW_TRY(snow_zarr_join(store, group,
                            snow_zarr_level_path(image, (size_t)index), path));
    return take_array(store, path, found);
}

static void set_level(const zarr_store *store, const json_t *image, int index,
                      const char *list, bool several) {
    if (level_count(image) > 1)
        snow_notify(store->context,
                    "level %d of %zu (%s) is used, the finest that exists; "
                    "--dataset selects another of %s",
                    index, level_count(image),
                    snow_zarr_level_path(image, (size_t)index), list);
    if (several)
        snow_notify(store->context,
                    "the first of several images of one group is used; "
                    "--dataset selects a level of another");
}

static snow_status take_finest(const zarr_store *store, const char *group,
                               zarr_node *node, zarr_found *found) {
    const json_t *image = image_at(node->attributes, 0);
    char list[LIST_BYTES] = "";
    int first;
    SNOW_TRY(list_levels(store, group, image, list, &first));
    if (first < 0)
        return snow_zarr_fail(store, group,
                              "has none of the %zu levels of its image (the "
                              "first is %.200s); copy it again",
                              level_count(image),
                              snow_zarr_level_path(image, 0));
    set_level(store, image, first, list, image_at(node->attributes, 1) != NULL);
    return take_level(store, group, node, image, first, found);
}

/* --- images above --------------------------------------------------------- */

/* The level of an image with this path or, if `by_number`, with this number;
 * NULL if there is none. */
static const json_t *level_named(const json_t *attributes, const char *path,
                                 bool by_number, int *index) {
    int64_t number = -1;
    const json_t *image;
    for (size_t i = 0; (image = image_at(attributes, i)); i++)
        for (size_t level = 0; level < level_count(image); level++) {
            const char *own = snow_zarr_level_path(image, level);
            *index = (int)level;
            if (own && !strcmp(own, path))
                return image;
        }
    image = image_at(attributes, 0);
    if (!by_number || !image || !isdigit((unsigned char)*path) ||
        !snow_parse_int64(path, &number) || number < 0 ||
        (size_t)number >= level_count(image))
        return NULL;
    *index = (int)number;
    return image;
}

/* Lists what exists beside an array that was named but is missing. */
static snow_status refuse_level(const zarr_store *store, const char *group,
                                const json_t *image, int index) {
    char list[LIST_BYTES] = "";
    int first;
    SNOW_TRY(list_levels(store, group, image, list, &first));
    return snow_fail(store->context, SNOW_STATUS_BAD_USAGE,
                     "level %d (%.200s) is missing; choose one that exists "
                     "with --dataset: %s",
                     index, snow_zarr_level_path(image, (size_t)index), list);
}

/* Searches the groups above for an image that has the path as a level; *taken
 * is the result.  With `is_array` the path is known to be an array. */
static snow_status take_from_above(const zarr_store *store, const char *path,
                                   bool is_array, zarr_found *found,
                                   bool *taken) {
    char group[ZARR_PATH_BYTES];
    memcpy(group, path, strlen(path) + 1);
    *taken = false;
    for (int depth = 0; *group && depth < MOST_DEPTH; depth++) {
        char *slash = strrchr(group, '/');
        const char *rest;
        zarr_node node, level;
        int index;
        *(slash ? slash : group) = 0;
        rest = path + strlen(group) + (*group ? 1 : 0);
        SNOW_TRY(snow_zarr_look(store, group, &node));
        const json_t *image =
            level_named(node.attributes, rest, !is_array, &index);
        snow_status status = SNOW_STATUS_OK;
        if (image) {
            *taken = true;
            status =
                look_below(store, group,
                           snow_zarr_level_path(image, (size_t)index), &level);
            bool is_there =
                status == SNOW_STATUS_OK && level.kind == ZARR_ARRAY;
            if (status == SNOW_STATUS_OK)
                snow_zarr_forget(&level);
            if (is_there)
                status = take_level(store, group, &node, image, index, found);
            else if (status == SNOW_STATUS_OK)
                status = refuse_level(store, group, image, index);
        }
        snow_zarr_forget(&node);
        if (*taken || status != SNOW_STATUS_OK)
            return status;
    }
    return SNOW_STATUS_OK;
}

/* --- groups --------------------------------------------------------------- */

/* A search below a group. */
typedef struct survey {
    const zarr_store *store;
    char at[ZARR_PATH_BYTES]; /* the current folder */
    const char *top;          /* the group, omitted from names */
    int axes;                 /* the fewest axes longer than 1 */
    int way; /* 0: gathers `aside`; to 3: leaves these out; then them alone */
    cf_aside aside;
    int depth;
    long folders, found;
    char path[ZARR_PATH_BYTES]; /* of the first match */
    char list[LIST_BYTES];
} survey;

static bool is_wanted(const survey *s, const json_t *meta) {
    const json_t *shape = json_object_get(meta, "shape");
    int axes = 0;
    for (size_t i = 0; i < json_array_size(shape); i++)
        axes += json_number_value(json_array_get(shape, i)) > 1;
    return axes >= s->axes;
}

static snow_status survey_below(survey *s);

static void gather_aside(survey *s, const zarr_node *node) {
    static const char *const attributes[] = {"bounds", "coordinates"};
    for (int i = 0; i < 2 && node->kind == ZARR_ARRAY; i++) {
        const json_t *names = json_object_get(node->attributes, attributes[i]);
        if (json_is_string(names))
            snow_cf_aside_add(attributes[i], json_string_value(names),
                              &s->aside);
    }
}

static snow_status survey_node(survey *s, const zarr_node *node) {
    bool image =
        node->kind == ZARR_GROUP && image_at(node->attributes, 0) != NULL;
    const char *name = s->at + strlen(s->top) + (*s->top ? 1 : 0);
    if (node->kind == ZARR_GROUP && !image)
        return survey_below(s);
    if (!s->way)
        gather_aside(s, node);
    if (!s->way || snow_cf_is_aside(&s->aside, name) != (s->way > 3))
        return SNOW_STATUS_OK;
    if (!image && !(node->kind == ZARR_ARRAY && is_wanted(s, node->meta)))
        return SNOW_STATUS_OK;
    if (!s->found++)
        memcpy(s->path, s->at, sizeof s->path);
    if (image)
        snow_list_add(s->list, LIST_BYTES, "%s", name);
    else
        append_array(s->list, name, node->meta);
    return SNOW_STATUS_OK;
}

static snow_status survey_child(void *user, const char *name) {
    survey *s = user;
    size_t length = strlen(s->at);
    zarr_node node;
    if (++s->folders > MOST_FOLDERS)
        return snow_zarr_fail(s->store, s->top,
                              "has more than %d folders; name an array with "
                              "--dataset",
                              MOST_FOLDERS);
    if (length + strlen(name) + 2 > sizeof s->at)
        return SNOW_STATUS_OK;
    snprintf(s->at + length, sizeof s->at - length, "%s%s", length ? "/" : "",
             name);
    snow_status status = snow_zarr_look(s->store, s->at, &node);
    if (status == SNOW_STATUS_OK) {
        status = survey_node(s, &node);
        snow_zarr_forget(&node);
    }
    s->at[length] = 0;
    return status;
}

static snow_status survey_below(survey *s) {
    if (s->depth == MOST_DEPTH)
        return SNOW_STATUS_OK;
    s->depth++;
    snow_status status = snow_zarr_visit(s->store, s->at, survey_child, s);
    s->depth--;
    return status;
}

static snow_status find_at(const zarr_store *store, const char *path,
                           zarr_found *out);

/* The only volume of a group; if there is none the only image, then the only
 * row; then of those that say where others lie. */
static snow_status take_from_group(const zarr_store *store, const char *group,
                                   zarr_found *out) {
    survey *s = snow_allocate(store->context, sizeof *s);
    if (!s)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = SNOW_STATUS_OK;
    *s = (survey){.store = store, .top = group};
    memcpy(s->at, group, strlen(group) + 1);
    for (; s->way < 7 && !s->found && status == SNOW_STATUS_OK; s->way++) {
        s->axes = 3 - (s->way + 2) % 3;
        s->depth = 0;
        s->folders = 0;
        status = survey_below(s);
    }
    if (status == SNOW_STATUS_OK && !s->found)
        status =
            snow_zarr_fail(store, group,
                           "is not a Zarr array, and contains none; name the "
                           "folder that has a .zarray, .zgroup or zarr.json");
    else if (status == SNOW_STATUS_OK && s->found > 1)
        status = snow_fail(store->context, SNOW_STATUS_BAD_USAGE,
                           "holds %ld volumes; choose one with --dataset: %s",
                           s->found, s->list);
    else if (status == SNOW_STATUS_OK)
        status = find_at(store, s->path, out);
    snow_release(store->context, s);
    return status;
}

/* --- a path --------------------------------------------------------------- */

/* The store itself may be a group without metadata. */
static snow_status find_at(const zarr_store *store, const char *path,
                           zarr_found *out) {
    zarr_node node;
    bool taken = false;
    SNOW_TRY(snow_zarr_look(store, path, &node));
    zarr_kind kind = node.kind;
    snow_status status = SNOW_STATUS_OK;
    if (kind == ZARR_GROUP && image_at(node.attributes, 0)) {
        status = take_finest(store, path, &node, out);
        taken = true;
    }
    snow_zarr_forget(&node);
    if (taken || status != SNOW_STATUS_OK)
        return status;
    if (kind == ZARR_GROUP || (kind == ZARR_NOTHING && !*path))
        return take_from_group(store, path, out);
    SNOW_TRY(take_from_above(store, path, kind == ZARR_ARRAY, out, &taken));
    if (taken)
        return SNOW_STATUS_OK;
    if (kind == ZARR_ARRAY)
        return take_array(store, path, out);
    return snow_fail(store->context, SNOW_STATUS_BAD_USAGE,
                     "has no array or group \"%.200s\"; leave out --dataset to "
                     "see what it has",
                     path);
}

snow_status snow_zarr_find(const zarr_store *store, const char *path,
                           zarr_found *out) {
    *out = (zarr_found){.index = 0};
    if (*path && !is_safe(path))
        return snow_fail(store->context, SNOW_STATUS_BAD_USAGE,
                         "\"%.200s\" is not a path within a Zarr group; name "
                         "an array as in \"scale0/image\"",
                         path);
    return find_at(store, path, out);
}

void snow_zarr_found_forget(zarr_found *found) {
    snow_zarr_forget(&found->node);
    json_decref(found->attributes);
}
