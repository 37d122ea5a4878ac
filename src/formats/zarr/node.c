/* formats/zarr/node.c - the files of metadata of a folder: whether it is an
 * array or a group, and its attributes. */
#include "formats/zarr/zarr.h"

#include <stdarg.h>
#include <string.h>

/* More than any metadata have; parsed JSON takes many times the size of its
 * text. */
#define MOST_JSON_BYTES ((uint64_t)4 << 20)

snow_status snow_zarr_fail(const zarr_store *store, const char *path,
                           const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    snow_text_vprint(text, sizeof text, format, arguments);
    va_end(arguments);
    return snow_fail(store->context, SNOW_STATUS_BAD_INPUT, "%s%s%s%s%s",
                     store->folder, *store->folder && *path ? "/" : "", path,
                     *store->folder || *path ? ": " : "", text);
}

/* Makes texts of NaN, Infinity and -Infinity, which JSON lacks and Python
 * writes: "" and blanks. */
static void blank_specials(char *text, size_t size) {
    static const char *const words[] = {"NaN", "-Infinity", "Infinity"};
    bool inside = false;
    for (size_t i = 0; i < size; i++) {
        for (int n = 0; n < 3 && !inside; n++) {
            const size_t letters = strlen(words[n]);
            if (size - i >= letters && !memcmp(text + i, words[n], letters)) {
                memset(text + i, ' ', letters);
                text[i] = text[i + 1] = '"';
                i += letters - 1;
            }
        }
        if (text[i] == '\\')
            i++;
        else if (text[i] == '"')
            inside = !inside;
    }
}

static snow_status parse_file(const zarr_store *store, const zarr_file *file,
                              json_t **out) {
    if (file->size > MOST_JSON_BYTES)
        return snow_fail(store->context, SNOW_STATUS_BAD_INPUT,
                         "%s: has %llu bytes, too many for the metadata of an "
                         "array; check what it is",
                         file->name, (unsigned long long)file->size);
    char *text = snow_allocate(store->context, (size_t)file->size);
    if (!text)
        return SNOW_STATUS_NO_MEMORY;
    json_error_t error;
    snow_status status =
        snow_zarr_read(file, 0, (unsigned char *)text, (size_t)file->size);
    json_t *tree = NULL;
    if (status == SNOW_STATUS_OK)
        tree = json_loadb(text, (size_t)file->size, 0, &error);
    /* jansson reads integers above INT64_MAX, for example fill values of
     * uint64, only as real numbers, and only on request. */
    if (status == SNOW_STATUS_OK && !tree &&
        json_error_code(&error) == json_error_numeric_overflow)
        tree = json_loadb(text, (size_t)file->size, JSON_DECODE_INT_AS_REAL,
                          &error);
    if (status == SNOW_STATUS_OK && !tree) {
        blank_specials(text, (size_t)file->size);
        tree = json_loadb(text, (size_t)file->size, 0, NULL);
    }
    snow_release(store->context, text);
    if (status == SNOW_STATUS_OK && !json_is_object(tree)) {
        status = snow_fail(store->context, SNOW_STATUS_BAD_INPUT,
                           "%s: line %d is not valid JSON: %.100s; correct it",
                           file->name, tree ? 1 : error.line,
                           tree ? "an object in braces expected" : error.text);
        json_decref(tree);
    }
    if (status == SNOW_STATUS_OK)
        *out = tree;
    return status;
}

/* *out stays NULL if there is no file. */
static snow_status load_json(const zarr_store *store, const char *path,
                             const char *name, json_t **out) {
    char whole[ZARR_PATH_BYTES];
    zarr_file file;
    SNOW_TRY(snow_zarr_join(store, path, name, whole));
    SNOW_TRY(snow_zarr_open(store, whole, &file));
    snow_status status =
        file.is_there ? parse_file(store, &file, out) : SNOW_STATUS_OK;
    snow_zarr_close(&file);
    return status;
}

/* Version 3 has all metadata in one file. */
static snow_status look_at_version_3(const zarr_store *store, const char *path,
                                     zarr_node *node) {
    const char *type =
        json_string_value(json_object_get(node->meta, "node_type"));
    bool is_array = type && !strcmp(type, "array");
    if (!is_array && !(type && !strcmp(type, "group")))
        return snow_zarr_fail(store, path,
                              "zarr.json has no node_type \"array\" or "
                              "\"group\"; correct it");
    node->version = 3;
    node->kind = is_array ? ZARR_ARRAY : ZARR_GROUP;
    node->attributes = json_incref(json_object_get(node->meta, "attributes"));
    return SNOW_STATUS_OK;
}

/* Attributes of an array are optional, so errors in them (perhaps NaN without
 * quotes) do not prevent reading it.  Those of a group say what it is. */
static snow_status look_at_version_2(const zarr_store *store, const char *path,
                                     zarr_node *node) {
    json_t *group = NULL;
    SNOW_TRY(load_json(store, path, ".zarray", &node->meta));
    node->version = 2;
    node->kind = node->meta ? ZARR_ARRAY : ZARR_NOTHING;
    snow_status status = load_json(store, path, ".zattrs", &node->attributes);
    if (node->kind == ZARR_ARRAY && status == SNOW_STATUS_BAD_INPUT) {
        snow_notify(store->context, "its attributes are ignored: %s",
                    store->context->message);
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(status);
    if (node->kind == ZARR_ARRAY)
        return SNOW_STATUS_OK;
    SNOW_TRY(load_json(store, path, ".zgroup", &group));
    if (group || node->attributes)
        node->kind = ZARR_GROUP;
    json_decref(group);
    return SNOW_STATUS_OK;
}

snow_status snow_zarr_look(const zarr_store *store, const char *path,
                           zarr_node *out) {
    zarr_node node = {ZARR_NOTHING, 0, NULL, NULL};
    snow_status status = load_json(store, path, "zarr.json", &node.meta);
    if (status == SNOW_STATUS_OK)
        status = node.meta ? look_at_version_3(store, path, &node)
                           : look_at_version_2(store, path, &node);
    if (status != SNOW_STATUS_OK)
        snow_zarr_forget(&node);
    else
        *out = node;
    return status;
}

void snow_zarr_forget(zarr_node *node) {
    json_decref(node->meta);
    json_decref(node->attributes);
    *node = (zarr_node){ZARR_NOTHING, 0, NULL, NULL};
}
