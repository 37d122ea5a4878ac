/* io/filters/filter.c - buffering, and the two bottom stages, which read a file
 * or memory.
 *
 * Files are read by descriptor: the C library's streams would allocate outside
 * of the context. */
#include "io/filters/filter.h"

#include "base/monitor.h"
#include "io/lookup.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

/* Each kind of stage begins with the common record, so that a pointer to one is
 * a pointer to the other. */
typedef struct file_filter {
    snow_filter_stage filter;
    int descriptor;
    off_t begin; /* position of the stage's first byte in the file */
} file_filter;

typedef struct memory_filter {
    snow_filter_stage filter;
    const unsigned char *begin; /* all of the caller's bytes */
    const unsigned char *bytes; /* what remains */
    size_t left;
} memory_filter;

/* Record and buffer are one block: a stage is allocated and freed in one step.
 * The buffer is not cleared. */
void *snow_filter_stage_allocate(snow_context *context, size_t bytes) {
    snow_filter_stage *filter =
        snow_allocate(context, bytes + SNOW_FILTER_BYTES);
    if (!filter)
        return NULL;
    memset(filter, 0, bytes);
    filter->context = context;
    filter->horizon = UINT64_MAX;
    filter->buffer = (unsigned char *)filter + bytes;
    return filter;
}

void *snow_filter_stage_over(snow_filter_stage *below, size_t bytes) {
    snow_filter_stage *filter =
        snow_filter_stage_allocate(below->context, bytes);
    if (!filter)
        return NULL;
    filter->name = below->name;
    filter->below = below;
    filter->size = -1;
    return filter;
}

/* From the top down: an upper stage may use the buffer below. */
void snow_filter_stage_close(snow_filter_stage *filter) {
    while (filter) {
        snow_filter_stage *below = filter->below;
        if (filter->fini)
            filter->fini(filter);
        snow_release(filter->context, filter);
        filter = below;
    }
}

/* How much to read into the rest of the buffer: what is missing of `size`
 * bytes, and what lies before the horizon. */
static size_t room_ahead(const snow_filter_stage *filter, size_t size) {
    size_t free_bytes = SNOW_FILTER_BYTES - filter->end,
           least = size - filter->end;
    uint64_t reach = filter->taken + (filter->end - filter->begin);
    uint64_t ahead = filter->horizon > reach ? filter->horizon - reach : 0;
    if (ahead < least)
        ahead = least;
    return ahead < free_bytes ? (size_t)ahead : free_bytes;
}

/* Buffered bytes are first moved to the front, so that the free space behind
 * them is contiguous. Callers need little more than a header's line, so little
 * is moved. */
snow_status snow_filter_stage_fill(snow_filter_stage *filter, size_t size) {
    if (filter->end - filter->begin >= size)
        return SNOW_STATUS_OK;
    memmove(filter->buffer, filter->buffer + filter->begin,
            filter->end - filter->begin);
    filter->end -= filter->begin;
    filter->begin = 0;
    while (filter->end < size) {
        size_t got;
        SNOW_TRY(filter->pull(filter, filter->buffer + filter->end,
                              room_ahead(filter, size), &got));
        if (!got)
            break;
        filter->end += got;
    }
    return SNOW_STATUS_OK;
}

void snow_filter_stage_drop(snow_filter_stage *filter, size_t count) {
    filter->begin += count;
    filter->taken += count;
}

snow_status snow_filter_stage_read(snow_filter_stage *filter, void *bytes,
                                   size_t size, size_t *got) {
    unsigned char *to = bytes;
    size_t done = filter->end - filter->begin;
    if (done > size)
        done = size;
    if (done)
        memcpy(to, filter->buffer + filter->begin, done);
    snow_filter_stage_drop(filter, done);
    /* Large reads bypass the buffer. */
    while (done < size) {
        size_t more;
        if (size - done >= SNOW_FILTER_BYTES) {
            SNOW_TRY(filter->pull(filter, to + done, size - done, &more));
            filter->taken += more;
        } else {
            SNOW_TRY(snow_filter_stage_fill(filter, 1));
            more = filter->end - filter->begin;
            if (more > size - done)
                more = size - done;
            if (more)
                memcpy(to + done, filter->buffer + filter->begin, more);
            snow_filter_stage_drop(filter, more);
        }
        if (!more)
            break;
        done += more;
    }
    *got = done;
    return SNOW_STATUS_OK;
}

/* If a file grew or shrank after it was opened, its first size counts. */
int64_t snow_filter_stage_remaining(const snow_filter_stage *filter) {
    if (filter->size < 0)
        return -1;
    uint64_t size = (uint64_t)filter->size;
    return filter->taken < size ? (int64_t)(size - filter->taken) : 0;
}

/* Seeking does not change the buffer; the caller has emptied it. */
static bool jump_in_file(snow_filter_stage *filter, uint64_t count) {
    return lseek(((file_filter *)filter)->descriptor, (off_t)count, SEEK_CUR) >=
           0;
}

/* A read may return less than requested before the end; 0 bytes mean the end.
 */
static snow_status pull_file(snow_filter_stage *filter, void *bytes,
                             size_t size, size_t *got) {
    ssize_t count;
    size = snow_monitor_chunk(filter->context, size);
    do
        count = read(((file_filter *)filter)->descriptor, bytes, size);
    while (count < 0 && errno == EINTR);
    if (count < 0)
        return snow_lookup_fail(filter->context, filter->name, "read");
    filter->context->bytes_read += (uint64_t)count;
    *got = (size_t)count;
    return snow_monitor_read(filter->context, (uint64_t)count);
}

/* A read that fails returns nothing, like one behind the end; the failure is
 * kept (io/lookup.h). */
static size_t look_in_file(snow_filter_stage *filter, uint64_t from,
                           void *bytes, size_t size) {
    const file_filter *file = (file_filter *)filter;
    size_t done = 0;
    if (from >= (uint64_t)filter->size)
        return 0;
    if (size > (uint64_t)filter->size - from)
        size = (size_t)((uint64_t)filter->size - from);
    while (done < size) {
        ssize_t count = pread(file->descriptor, (unsigned char *)bytes + done,
                              snow_monitor_chunk(filter->context, size - done),
                              file->begin + (off_t)(from + done));
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            (void)snow_lookup_fail(filter->context, filter->name, "read");
        else if (count == 0) /* callers ask for no byte behind the end */
            (void)snow_lookup_keep(
                filter->context,
                snow_fail(filter->context, SNOW_STATUS_BAD_INPUT,
                          "%s: has become shorter while it was read; wait "
                          "until it is written",
                          filter->name));
        if (count <= 0)
            break;
        done += (size_t)count;
        if (snow_monitor_read(filter->context, (uint64_t)count) !=
            SNOW_STATUS_OK)
            break; /* as a read that fails */
    }
    filter->context->bytes_read += done;
    return done;
}

static void close_file(snow_filter_stage *filter) {
    close(((file_filter *)filter)->descriptor);
}

snow_status snow_filter_stage_open_file(snow_context *context, const char *name,
                                        int descriptor, int64_t size,
                                        snow_filter_stage **out) {
    file_filter *file = snow_filter_stage_allocate(context, sizeof *file);
    if (!file)
        return SNOW_STATUS_NO_MEMORY;
    file->filter.name = name;
    file->filter.pull = pull_file;
    file->filter.jump = jump_in_file;
    file->filter.fini = close_file;
    file->filter.size = size;
    snow_monitor_expect(context, size);
    file->descriptor = descriptor;
    file->begin = size < 0 ? -1 : lseek(descriptor, 0, SEEK_CUR);
    if (file->begin >= 0)
        file->filter.look = look_in_file;
    *out = &file->filter;
    return SNOW_STATUS_OK;
}

/* Copies like a file, although the bytes are in memory: the readers above see
 * no difference, and large reads bypass the buffer. */
static snow_status pull_memory(snow_filter_stage *filter, void *bytes,
                               size_t size, size_t *got) {
    memory_filter *memory = (memory_filter *)filter;
    if (size > memory->left)
        size = memory->left;
    if (size)
        memcpy(bytes, memory->bytes, size);
    memory->bytes += size;
    memory->left -= size;
    *got = size;
    return SNOW_STATUS_OK;
}

static size_t look_in_memory(snow_filter_stage *filter, uint64_t from,
                             void *bytes, size_t size) {
    const memory_filter *memory = (memory_filter *)filter;
    uint64_t all = (uint64_t)filter->size;
    if (from >= all)
        return 0;
    if (size > all - from)
        size = (size_t)(all - from);
    memcpy(bytes, memory->begin + from, size);
    return size;
}

snow_status snow_filter_stage_open_memory(snow_context *context,
                                          const char *name, const void *bytes,
                                          size_t size,
                                          snow_filter_stage **out) {
    static const unsigned char nothing[1];
    memory_filter *memory = snow_filter_stage_allocate(context, sizeof *memory);
    if (!memory)
        return SNOW_STATUS_NO_MEMORY;
    memory->filter.name = name;
    memory->filter.pull = pull_memory;
    memory->filter.size = (int64_t)size;
    memory->filter.look = look_in_memory;
    memory->begin = memory->bytes = size ? bytes : nothing;
    memory->left = size;
    *out = &memory->filter;
    return SNOW_STATUS_OK;
}

uint64_t snow_filter_stage_limit(const snow_filter_stage *filter) {
    return filter->size >= 0 ? (uint64_t)snow_filter_stage_remaining(filter)
           : filter->limit   ? filter->limit(filter)
                             : UINT64_MAX;
}
