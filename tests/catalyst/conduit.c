/* tests/catalyst/conduit.c - a tree of named nodes, as much of Conduit as the
 * tests of the Catalyst implementation need. */
#include "catalyst.h"

#include <stdlib.h>
#include <string.h>

#define CHILDREN_MOST 64

enum kind {
    KIND_OBJECT,
    KIND_TEXT,
    KIND_INT32,
    KIND_INT64,
    KIND_UINT8,
    KIND_FLOAT64
};

typedef struct node {
    char name[64];
    struct node *children[CHILDREN_MOST];
    int64_t child_count;
    enum kind kind;
    char *data;
    int external;
    int64_t count, stride, bytes;
} node;

conduit_node *conduit_node_create(void) {
    return calloc(1, sizeof(node));
}

static void clear(node *n) {
    if (!n->external)
        free(n->data);
    n->data = NULL;
    n->external = 0;
}

void conduit_node_destroy(conduit_node *any) {
    node *n = any;
    for (int64_t i = 0; i < n->child_count; i++)
        conduit_node_destroy(n->children[i]);
    clear(n);
    free(n);
}

/* The child whose name is the path's first part; made where `make`. */
static node *child_of(node *n, const char *path, size_t length, int make) {
    for (int64_t i = 0; i < n->child_count; i++)
        if (strlen(n->children[i]->name) == length &&
            strncmp(n->children[i]->name, path, length) == 0)
            return n->children[i];
    if (!make || n->child_count == CHILDREN_MOST || length >= 64)
        return NULL;
    node *child = conduit_node_create();
    memcpy(child->name, path, length);
    n->children[n->child_count++] = child;
    return child;
}

static node *walk(node *n, const char *path, int make) {
    while (n && *path) {
        size_t length = strcspn(path, "/");
        n = child_of(n, path, length, make);
        path += length + (path[length] == '/');
    }
    return n;
}

int conduit_node_has_path(const conduit_node *n, const char *path) {
    return walk((node *)n, path, 0) != NULL;
}

conduit_node *conduit_node_fetch(conduit_node *n, const char *path) {
    return walk(n, path, 1);
}

conduit_index_t conduit_node_number_of_children(conduit_node *n) {
    return ((node *)n)->child_count;
}

conduit_node *conduit_node_child(conduit_node *n, conduit_index_t index) {
    return ((node *)n)->children[index];
}

const conduit_datatype *conduit_node_dtype(const conduit_node *n) {
    return n;
}

void *conduit_node_element_ptr(conduit_node *any, conduit_index_t index) {
    node *n = any;
    return n->data + index * n->stride;
}

char *conduit_node_as_char8_str(conduit_node *n) {
    return ((node *)n)->data;
}

/* --- values --------------------------------------------------------------- */

static node *set(conduit_node *root, const char *path, enum kind kind,
                 int64_t bytes, int64_t count) {
    node *n = walk(root, path, 1);
    clear(n);
    n->kind = kind;
    n->bytes = n->stride = bytes;
    n->count = count;
    return n;
}

static void set_copy(conduit_node *root, const char *path, enum kind kind,
                     const void *value, int64_t bytes) {
    node *n = set(root, path, kind, bytes, 1);
    n->data = malloc((size_t)bytes);
    memcpy(n->data, value, (size_t)bytes);
}

void conduit_node_set_path_char8_str(conduit_node *n, const char *path,
                                     const char *value) {
    set_copy(n, path, KIND_TEXT, value, (int64_t)strlen(value) + 1);
}

void conduit_node_set_path_int32(conduit_node *n, const char *path,
                                 int32_t value) {
    set_copy(n, path, KIND_INT32, &value, sizeof value);
}

void conduit_node_set_path_int64(conduit_node *n, const char *path,
                                 int64_t value) {
    set_copy(n, path, KIND_INT64, &value, sizeof value);
}

void conduit_node_set_path_float64(conduit_node *n, const char *path,
                                   double value) {
    set_copy(n, path, KIND_FLOAT64, &value, sizeof value);
}

void conduit_node_set_path_external_float64_ptr_detailed(
    conduit_node *root, const char *path, double *data, conduit_index_t count,
    conduit_index_t offset, conduit_index_t stride,
    conduit_index_t element_bytes, conduit_index_t endianness) {
    (void)endianness;
    node *n = set(root, path, KIND_FLOAT64, element_bytes, count);
    n->external = 1;
    n->data = (char *)data + offset;
    n->stride = stride;
}

void conduit_node_set_path_external_uint8_ptr(conduit_node *root,
                                              const char *path, uint8_t *data,
                                              conduit_index_t count) {
    node *n = set(root, path, KIND_UINT8, 1, count);
    n->external = 1;
    n->data = (char *)data;
}

/* --- types ---------------------------------------------------------------- */

conduit_index_t conduit_datatype_number_of_elements(const conduit_datatype *t) {
    return ((const node *)t)->count;
}

conduit_index_t conduit_datatype_stride(const conduit_datatype *t) {
    return ((const node *)t)->stride;
}

conduit_index_t conduit_datatype_element_bytes(const conduit_datatype *t) {
    return ((const node *)t)->bytes;
}

#define IS(word, kind_word)                                     \
    int conduit_datatype_is_##word(const conduit_datatype *t) { \
        return ((const node *)t)->kind == KIND_##kind_word;     \
    }
#define IS_NEVER(word)                                          \
    int conduit_datatype_is_##word(const conduit_datatype *t) { \
        (void)t;                                                \
        return 0;                                               \
    }
IS(object, OBJECT)
IS(char8_str, TEXT)
IS(int32, INT32)
IS(int64, INT64)
IS(uint8, UINT8)
IS(float64, FLOAT64)
IS_NEVER(int8)
IS_NEVER(int16)
IS_NEVER(uint16)
IS_NEVER(uint32)
IS_NEVER(uint64)
IS_NEVER(float32)
