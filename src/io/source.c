/* io/source.c - reading from a source: bytes, lines, and the remaining data.
 *
 * All of it uses the topmost filter stage; see io/filter.h. */
#include "io/source.h"
#include "io/source_internal.h"

#include <assert.h>
#include <string.h>

/* Data after the wanted ones are unpacked to verify the check sum at their end,
 * but at most this much: a few packed megabytes can unpack to terabytes. */
#define MOST_LEFT_OVER ((uint64_t)2 << 30)

static_assert(SNOW_PEEK_BYTES <= SNOW_FILTER_BYTES,
              "a peek must fit the buffer");

void snow_source_close(snow_source *source) {
    if (source) {
        snow_filter_stage_close(source->top);
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

/* On failure the source keeps its stages and is closed as usual. */
snow_status snow_source_unpack(snow_source *source) {
    return snow_filter_stage_open_inflate(source->top, &source->top);
}

snow_status snow_source_peek(snow_source *source, void *bytes, size_t size,
                             size_t *got) {
    snow_filter_stage *top = source->top;
    assert(size <= SNOW_PEEK_BYTES);
    SNOW_TRY(snow_filter_stage_fill(top, size));
    size_t count = top->end - top->begin;
    if (count > size)
        count = size;
    memcpy(bytes, top->buffer + top->begin, count);
    *got = count;
    return SNOW_STATUS_OK;
}

snow_status snow_source_read(snow_source *source, void *bytes, size_t size,
                             size_t *got) {
    return snow_filter_stage_read(source->top, bytes, size, got);
}

/* States how much is missing, which distinguishes a wrong type (half the bytes)
 * from an incomplete transfer. */
static snow_status fail_short(const snow_source *source, const char *what,
                              uint64_t missing) {
    return snow_fail(source->context, SNOW_STATUS_BAD_INPUT,
                     "%s: ends %llu bytes too early in %s; the file is "
                     "truncated, or its sizes or type are wrong",
                     source->name, (unsigned long long)missing, what);
}

snow_status snow_source_read_all(snow_source *source, void *bytes, size_t size,
                                 const char *what) {
    size_t got;
    SNOW_TRY(snow_source_read(source, bytes, size, &got));
    return got == size ? SNOW_STATUS_OK : fail_short(source, what, size - got);
}

/* Skips what is not buffered, without reading, if possible. */
static bool pass_by(snow_filter_stage *filter, uint64_t size) {
    int64_t remaining = snow_filter_stage_remaining(filter);
    if (!filter->jump || remaining < 0 || (uint64_t)remaining < size ||
        !filter->jump(filter, size))
        return false;
    filter->taken += size;
    return true;
}

snow_status snow_source_skip(snow_source *source, uint64_t size,
                             const char *what) {
    snow_filter_stage *top = source->top;
    for (;;) {
        uint64_t count = top->end - top->begin;
        if (count > size)
            count = size;
        snow_filter_stage_drop(top, (size_t)count);
        size -= count;
        /* Reading what is skipped, with what follows it, may cost more than a
         * jump: it is beyond the horizon, or fills a buffer. */
        const bool jumps = size >= SNOW_FILTER_BYTES ||
                           top->taken >= top->horizon ||
                           size >= top->horizon - top->taken;
        if (!size || (jumps && pass_by(top, size)))
            return SNOW_STATUS_OK;
        SNOW_TRY(snow_filter_stage_fill(top, 1));
        if (top->begin == top->end)
            return fail_short(source, what, size);
    }
}

/* A stream that does not support jumps is read with full buffers regardless. */
void snow_source_plan(snow_source *source, uint64_t bytes) {
    snow_filter_stage *top = source->top;
    if (!top->jump || !snow_add_u64(top->taken, bytes, &top->horizon))
        top->horizon = UINT64_MAX;
}

/* Moves `count` buffered bytes of a line to its end at `*used`. */
static snow_status append_to_line(snow_source *source, char *line, size_t size,
                                  size_t *used, size_t count) {
    snow_filter_stage *top = source->top;
    const unsigned char *from = top->buffer + top->begin;
    if (memchr(from, 0, count))
        return snow_fail(source->context, SNOW_STATUS_BAD_INPUT,
                         "%s: has a NUL byte in its text; the header is "
                         "damaged or of another format",
                         source->name);
    /* One byte is for the NUL. */
    if (count >= size - *used)
        return snow_fail(source->context, SNOW_STATUS_BAD_INPUT,
                         "%s: has a line of more than %zu bytes in its header; "
                         "it is damaged or of another format",
                         source->name, size - 1);
    memcpy(line + *used, from, count);
    *used += count;
    snow_filter_stage_drop(top, count);
    return SNOW_STATUS_OK;
}

/* The line's end may be in any later buffer; each buffer's part is moved before
 * the next is filled. A CR is dropped at the line's end only. */
snow_status snow_source_read_line(snow_source *source, char *line, size_t size,
                                  bool *got) {
    snow_filter_stage *top = source->top;
    size_t used = 0;
    bool ended = false, some = false;
    while (!ended) {
        SNOW_TRY(snow_filter_stage_fill(top, 1));
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
            snow_filter_stage_drop(top, 1);
    }
    if (used && line[used - 1] == '\r')
        used--;
    line[used] = 0;
    *got = some;
    return SNOW_STATUS_OK;
}

int64_t snow_source_remaining(const snow_source *source) {
    return snow_filter_stage_remaining(source->top);
}

snow_status snow_source_expect(const snow_source *source, uint64_t size,
                               const char *what) {
    uint64_t limit = snow_filter_stage_limit(source->top);
    if (size <= limit)
        return SNOW_STATUS_OK;
    return snow_fail(source->context, SNOW_STATUS_BAD_INPUT,
                     "%s: has %s%llu bytes left where %s need%s %llu; the file "
                     "is truncated, or its sizes or type are wrong",
                     source->name, source->top->below ? "at most " : "",
                     (unsigned long long)limit, what,
                     what[strlen(what) - 1] == 's' ? "" : "s",
                     (unsigned long long)size);
}

/* Consumes the rest of a stage whose size is not known. An inflating stage
 * verifies its check sum at its end, which is the only purpose of this. */
static snow_status drain(snow_filter_stage *filter, uint64_t *count) {
    for (*count = 0;;) {
        SNOW_TRY(snow_filter_stage_fill(filter, 1));
        size_t some = filter->end - filter->begin;
        if (!some)
            return SNOW_STATUS_OK;
        snow_filter_stage_drop(filter, some);
        *count += some;
        if (*count > MOST_LEFT_OVER)
            return snow_fail(filter->context, SNOW_STATUS_BAD_INPUT,
                             "%s: has more than 2 GiB after its data; check "
                             "the sizes and the type",
                             filter->name);
    }
}

snow_status snow_source_finish(snow_source *source) {
    uint64_t left = snow_source_remaining(source) > 0
                        ? (uint64_t)snow_source_remaining(source)
                        : 0;
    /* Only the rest of the top stage is data; below are packed bytes, which the
     * unpacking stage has handled. */
    for (snow_filter_stage *filter = source->top; filter;
         filter = filter->below) {
        uint64_t count = 0;
        if (filter->size < 0)
            SNOW_TRY(drain(filter, &count));
        if (filter == source->top)
            left += count;
    }
    if (left)
        snow_notify(source->context,
                    "%s: %llu byte%s after the data ignored; check the sizes "
                    "and the type",
                    source->name, (unsigned long long)left,
                    left == 1 ? "" : "s");
    return SNOW_STATUS_OK;
}
