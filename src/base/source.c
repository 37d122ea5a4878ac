/* base/source.c - reading from a source: bytes, lines, and what is left.
 *
 * All of it works on the topmost layer; see base/layer.h. */
#include "base/source.h"
#include "base/source_parts.h"

#include <assert.h>
#include <string.h>

/* Data that follow the wanted ones are unpacked to verify the check sum at
 * their end, but no more than this: a few packed megabytes can unpack to
 * terabytes. */
#define MOST_LEFT_OVER ((uint64_t)2 << 30)

static_assert(SNOW_PEEK_BYTES <= SNOW_LAYER_BYTES, "a peek fits the buffer");

void snow_source_close(snow_source *source) {
    if (source) {
        snow_layer_close(source->top);
        snow_release(source->context, source);
    }
}

snow_context *snow_source_context(const snow_source *source) {
    return source->context;
}

const char *snow_source_name(const snow_source *source) {
    return source->name;
}

bool snow_source_has_siblings(const snow_source *source) {
    return source->siblings;
}

/* On failure the source keeps its layers and is closed as usual. */
snow_status snow_source_unpack(snow_source *source) {
    return snow_layer_open_inflate(source->top, &source->top);
}

snow_status snow_source_peek(snow_source *source, void *bytes, size_t size,
                             size_t *got) {
    snow_layer *top = source->top;
    assert(size <= SNOW_PEEK_BYTES);
    SNOW_TRY(snow_layer_fill(top, size));
    size_t count = top->end - top->begin;
    if (count > size)
        count = size;
    memcpy(bytes, top->buffer + top->begin, count);
    *got = count;
    return SNOW_OK;
}

snow_status snow_source_read(snow_source *source, void *bytes, size_t size,
                             size_t *got) {
    return snow_layer_read(source->top, bytes, size, got);
}

/* Says how much is missing, which tells a wrong type (half the bytes) from a
 * cut transfer. */
static snow_status fail_short(const snow_source *source, const char *what,
                              uint64_t missing) {
    return snow_fail(source->context, SNOW_BAD_INPUT,
                     "%s: ends %llu bytes too early in %s; the file is cut, or "
                     "its sizes or type are wrong",
                     source->name, (unsigned long long)missing, what);
}

snow_status snow_source_read_all(snow_source *source, void *bytes, size_t size,
                                 const char *what) {
    size_t got;
    SNOW_TRY(snow_source_read(source, bytes, size, &got));
    return got == size ? SNOW_OK : fail_short(source, what, size - got);
}

/* Passes by what is not buffered, without reading, where that is possible. */
static bool pass_by(snow_layer *layer, uint64_t size) {
    int64_t remaining = snow_layer_remaining(layer);
    if (!layer->jump || remaining < 0 || (uint64_t)remaining < size ||
        !layer->jump(layer, size))
        return false;
    layer->taken += size;
    return true;
}

/* Whether to read what is skipped, with what follows it, costs more than to
 * jump: it lies beyond the horizon, or fills a buffer. */
static bool worth_a_jump(const snow_layer *layer, uint64_t size) {
    return size >= SNOW_LAYER_BYTES || layer->taken >= layer->horizon ||
           size >= layer->horizon - layer->taken;
}

snow_status snow_source_skip(snow_source *source, uint64_t size,
                             const char *what) {
    snow_layer *top = source->top;
    for (;;) {
        uint64_t count = top->end - top->begin;
        if (count > size)
            count = size;
        snow_layer_drop(top, (size_t)count);
        size -= count;
        if (!size || (worth_a_jump(top, size) && pass_by(top, size)))
            return SNOW_OK;
        SNOW_TRY(snow_layer_fill(top, 1));
        if (top->begin == top->end)
            return fail_short(source, what, size);
    }
}

/* A stream that cannot be jumped in is read with full buffers all the same. */
void snow_source_plan(snow_source *source, uint64_t bytes) {
    snow_layer *top = source->top;
    if (!top->jump || !snow_add_u64(top->taken, bytes, &top->horizon))
        top->horizon = UINT64_MAX;
}

/* Takes `count` buffered bytes that belong to a line to its end at `*used`. */
static snow_status append_to_line(snow_source *source, char *line, size_t size,
                                  size_t *used, size_t count) {
    snow_layer *top = source->top;
    const unsigned char *from = top->buffer + top->begin;
    if (memchr(from, 0, count))
        return snow_fail(source->context, SNOW_BAD_INPUT,
                         "%s: has a NUL byte in its text; the header is "
                         "damaged or of another format",
                         source->name);
    /* One byte is for the string's end. */
    if (count >= size - *used)
        return snow_fail(source->context, SNOW_BAD_INPUT,
                         "%s: has a line of more than %zu bytes in its header; "
                         "it is damaged or of another format",
                         source->name, size - 1);
    memcpy(line + *used, from, count);
    *used += count;
    snow_layer_drop(top, count);
    return SNOW_OK;
}

/* The line's end may lie in any later buffer; each buffer's part is taken
 * before the next is filled. A CR is dropped at the line's end only. */
snow_status snow_source_read_line(snow_source *source, char *line, size_t size,
                                  bool *got) {
    snow_layer *top = source->top;
    size_t used = 0;
    bool ended = false, some = false;
    while (!ended) {
        SNOW_TRY(snow_layer_fill(top, 1));
        size_t count = top->end - top->begin;
        if (!count)
            break;
        some = true;
        const unsigned char *from = top->buffer + top->begin;
        const unsigned char *end = memchr(from, '\n', count);
        if (end)
            count = (size_t)(end - from);
        SNOW_TRY(append_to_line(source, line, size, &used, count));
        ended = end != NULL;
        if (ended)
            snow_layer_drop(top, 1);
    }
    if (used && line[used - 1] == '\r')
        used--;
    line[used] = 0;
    *got = some;
    return SNOW_OK;
}

int64_t snow_source_remaining(const snow_source *source) {
    return snow_layer_remaining(source->top);
}

snow_status snow_source_expect(const snow_source *source, uint64_t size,
                               const char *what) {
    uint64_t limit = snow_layer_limit(source->top);
    if (size <= limit)
        return SNOW_OK;
    return snow_fail(source->context, SNOW_BAD_INPUT,
                     "%s: has %s%llu bytes left where %s need%s %llu; the file "
                     "is cut, or its sizes or type are wrong",
                     source->name, source->top->below ? "at most " : "",
                     (unsigned long long)limit, what,
                     what[strlen(what) - 1] == 's' ? "" : "s",
                     (unsigned long long)size);
}

/* Takes all that is left of a layer whose size is not known.  An inflating
 * layer verifies its check sum when it comes to its end, which is
 * all that this reading is for. */
static snow_status drain(snow_layer *layer, uint64_t *count) {
    for (*count = 0;;) {
        SNOW_TRY(snow_layer_fill(layer, 1));
        size_t some = layer->end - layer->begin;
        if (!some)
            return SNOW_OK;
        snow_layer_drop(layer, some);
        *count += some;
        if (*count > MOST_LEFT_OVER)
            return snow_fail(layer->context, SNOW_BAD_INPUT,
                             "%s: has more than 2 GiB after its data; check "
                             "the sizes and the type",
                             layer->name);
    }
}

snow_status snow_source_finish(snow_source *source) {
    uint64_t left = snow_source_remaining(source) > 0
                        ? (uint64_t)snow_source_remaining(source)
                        : 0;
    /* Only what is left on top is data; below lie packed bytes, of which the
     * unpacking layer has spoken. */
    for (snow_layer *layer = source->top; layer; layer = layer->below) {
        uint64_t count = 0;
        if (layer->size < 0)
            SNOW_TRY(drain(layer, &count));
        if (layer == source->top)
            left += count;
    }
    if (left)
        snow_notify(source->context,
                    "%s: %llu byte%s after the data ignored; check the sizes "
                    "and the type",
                    source->name, (unsigned long long)left,
                    left == 1 ? "" : "s");
    return SNOW_OK;
}
