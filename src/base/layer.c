/* base/layer.c - buffering, and the two bottoms that bytes come from.
 *
 * Files are read by descriptor: the C library's streams would allocate behind
 * the context's back. */
#include "base/layer.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

/* Each kind of layer begins with the common record, so that a pointer to one
 * is a pointer to the other. */
typedef struct file_layer {
    snow_layer layer;
    int descriptor;
    off_t begin; /* where in the file the layer's first byte is */
} file_layer;

typedef struct memory_layer {
    snow_layer layer;
    const unsigned char *begin; /* the caller's, all of them */
    const unsigned char *bytes; /* what is still to come */
    size_t left;
} memory_layer;

/* Record and buffer are one block: a layer is made and freed in one step. The
 * buffer needs no clearing. */
void *snow_layer_allocate(snow_context *context, size_t bytes) {
    snow_layer *layer = snow_allocate(context, bytes + SNOW_LAYER_BYTES);
    if (!layer)
        return NULL;
    memset(layer, 0, bytes);
    layer->context = context;
    layer->horizon = UINT64_MAX;
    layer->buffer = (unsigned char *)layer + bytes;
    return layer;
}

/* From the top down: an upper layer may hold on to the buffer below. */
void snow_layer_close(snow_layer *layer) {
    while (layer) {
        snow_layer *below = layer->below;
        if (layer->fini)
            layer->fini(layer);
        snow_release(layer->context, layer);
        layer = below;
    }
}

/* How much to pull into the rest of the buffer: what is missing of `size`
 * bytes, and what lies before the horizon. */
static size_t room_ahead(const snow_layer *layer, size_t size) {
    size_t room = SNOW_LAYER_BYTES - layer->end, least = size - layer->end;
    uint64_t reach = snow_layer_reach(layer);
    uint64_t ahead = layer->horizon > reach ? layer->horizon - reach : 0;
    if (ahead < least)
        ahead = least;
    return ahead < room ? (size_t)ahead : room;
}

/* What is buffered moves to the front first, so that the room behind it is one
 * piece. Callers ask for little more than a header's line, so that little is
 * moved. */
snow_status snow_layer_fill(snow_layer *layer, size_t size) {
    if (layer->end - layer->begin >= size)
        return SNOW_OK;
    memmove(layer->buffer, layer->buffer + layer->begin,
            layer->end - layer->begin);
    layer->end -= layer->begin;
    layer->begin = 0;
    while (layer->end < size) {
        size_t got;
        SNOW_TRY(layer->pull(layer, layer->buffer + layer->end,
                             room_ahead(layer, size), &got));
        if (!got)
            break;
        layer->end += got;
    }
    return SNOW_OK;
}

void snow_layer_drop(snow_layer *layer, size_t count) {
    layer->begin += count;
    layer->taken += count;
}

snow_status snow_layer_read(snow_layer *layer, void *bytes, size_t size,
                            size_t *got) {
    unsigned char *to = bytes;
    size_t done = layer->end - layer->begin;
    if (done > size)
        done = size;
    if (done)
        memcpy(to, layer->buffer + layer->begin, done);
    snow_layer_drop(layer, done);
    /* What is large passes the buffer by. */
    while (done < size) {
        size_t more;
        if (size - done >= SNOW_LAYER_BYTES) {
            SNOW_TRY(layer->pull(layer, to + done, size - done, &more));
            layer->taken += more;
        } else {
            SNOW_TRY(snow_layer_fill(layer, 1));
            more = layer->end - layer->begin;
            if (more > size - done)
                more = size - done;
            if (more)
                memcpy(to + done, layer->buffer + layer->begin, more);
            snow_layer_drop(layer, more);
        }
        if (!more)
            break;
        done += more;
    }
    *got = done;
    return SNOW_OK;
}

/* A file that grew or shrank after it was opened counts by its first size. */
int64_t snow_layer_remaining(const snow_layer *layer) {
    if (layer->size < 0)
        return -1;
    uint64_t size = (uint64_t)layer->size;
    return layer->taken < size ? (int64_t)(size - layer->taken) : 0;
}

/* Seeking leaves the buffer alone; the caller has emptied it. */
static bool jump_in_file(snow_layer *layer, uint64_t count) {
    return lseek(((file_layer *)layer)->descriptor, (off_t)count, SEEK_CUR) >=
           0;
}

/* A read may bring less than was asked for, which is no end; 0 bytes are. */
static snow_status pull_file(snow_layer *layer, void *bytes, size_t size,
                             size_t *got) {
    ssize_t count;
    do
        count = read(((file_layer *)layer)->descriptor, bytes, size);
    while (count < 0 && errno == EINTR);
    if (count < 0) {
        char why[128] = "";
        strerror_r(errno, why, sizeof why);
        return snow_fail(layer->context, SNOW_BAD_INPUT,
                         "%s: cannot be read: %s; check the disk and the "
                         "permissions",
                         layer->name, why);
    }
    layer->context->bytes_read += (uint64_t)count;
    *got = (size_t)count;
    return SNOW_OK;
}

/* A read that fails brings nothing, as one behind the end: whoever looks for
 * bytes that must be there refuses both. */
static size_t look_in_file(snow_layer *layer, uint64_t from, void *bytes,
                           size_t size) {
    const file_layer *file = (file_layer *)layer;
    size_t done = 0;
    if (from > (uint64_t)layer->size)
        return 0;
    while (done < size) {
        ssize_t count = pread(file->descriptor, (unsigned char *)bytes + done,
                              size - done, file->begin + (off_t)(from + done));
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            break;
        done += (size_t)count;
    }
    layer->context->bytes_read += done;
    return done;
}

static void close_file(snow_layer *layer) {
    close(((file_layer *)layer)->descriptor);
}

snow_status snow_layer_open_file(snow_context *context, const char *name,
                                 int descriptor, int64_t size,
                                 snow_layer **out) {
    file_layer *file = snow_layer_allocate(context, sizeof *file);
    if (!file)
        return SNOW_NO_MEMORY;
    file->layer.name = name;
    file->layer.pull = pull_file;
    file->layer.jump = jump_in_file;
    file->layer.fini = close_file;
    file->layer.size = size;
    file->descriptor = descriptor;
    file->begin = size < 0 ? -1 : lseek(descriptor, 0, SEEK_CUR);
    if (file->begin >= 0)
        file->layer.look = look_in_file;
    *out = &file->layer;
    return SNOW_OK;
}

/* Copies as a file would, although the bytes are at hand: the readers above
 * see no difference, and what is large passes the buffer by. */
static snow_status pull_memory(snow_layer *layer, void *bytes, size_t size,
                               size_t *got) {
    memory_layer *memory = (memory_layer *)layer;
    if (size > memory->left)
        size = memory->left;
    if (size)
        memcpy(bytes, memory->bytes, size);
    memory->bytes += size;
    memory->left -= size;
    *got = size;
    return SNOW_OK;
}

static size_t look_in_memory(snow_layer *layer, uint64_t from, void *bytes,
                             size_t size) {
    const memory_layer *memory = (memory_layer *)layer;
    uint64_t all = (uint64_t)layer->size;
    if (from >= all)
        return 0;
    if (size > all - from)
        size = (size_t)(all - from);
    memcpy(bytes, memory->begin + from, size);
    return size;
}

snow_status snow_layer_open_memory(snow_context *context, const char *name,
                                   const void *bytes, size_t size,
                                   snow_layer **out) {
    static const unsigned char nothing[1];
    memory_layer *memory = snow_layer_allocate(context, sizeof *memory);
    if (!memory)
        return SNOW_NO_MEMORY;
    memory->layer.name = name;
    memory->layer.pull = pull_memory;
    memory->layer.size = (int64_t)size;
    memory->layer.look = look_in_memory;
    memory->begin = memory->bytes = size ? bytes : nothing;
    memory->left = size;
    *out = &memory->layer;
    return SNOW_OK;
}
