/* io/filters/filter_with.c - the bottom stage over a caller's function that
 * copies bytes from any place on: a browser's file, a range of a request. */
#include "base/monitor.h"
#include "io/filters/filter.h"
#include "io/lookup.h"

typedef struct with_filter {
    snow_filter_stage filter; /* first: it is the record's address */
    snow_bytes_behind bytes;
    uint64_t at; /* of the next pull */
} with_filter;

/* Copies in pieces, so that a stop is noticed in between; what was copied
 * is counted as read. */
static snow_status copy(with_filter *with, uint64_t from, void *bytes,
                        size_t size, size_t *done) {
    snow_context *context = with->filter.context;
    for (*done = 0; *done < size;) {
        size_t piece = snow_monitor_chunk(context, size - *done);
        size_t got = with->bytes.read_at(with->bytes.user, from + *done,
                                         (unsigned char *)bytes + *done, piece);
        if (got < piece)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "%s: cannot be read at byte %llu: the program's "
                             "function gave %zu bytes of %zu; check where the "
                             "bytes come from",
                             with->filter.name,
                             (unsigned long long)(from + *done), got, piece);
        *done += piece;
        context->bytes_read += piece;
        SNOW_TRY(snow_monitor_read(context, piece));
    }
    return SNOW_STATUS_OK;
}

static size_t lesser(size_t size, uint64_t left) {
    return size < left ? size : (size_t)left;
}

static snow_status pull(snow_filter_stage *filter, void *bytes, size_t size,
                        size_t *got) {
    with_filter *with = (with_filter *)filter;
    SNOW_TRY(copy(with, with->at, bytes,
                  lesser(size, with->bytes.size - with->at), got));
    with->at += *got;
    return SNOW_STATUS_OK;
}

static bool jump(snow_filter_stage *filter, uint64_t count) {
    ((with_filter *)filter)->at += count;
    return true;
}

/* A read that fails returns what came before, as at the end; the failure is
 * kept (io/lookup.h). */
static size_t look(snow_filter_stage *filter, uint64_t from, void *bytes,
                   size_t size) {
    with_filter *with = (with_filter *)filter;
    size_t done = 0;
    if (from < with->bytes.size)
        (void)snow_lookup_keep(filter->context,
                               copy(with, from, bytes,
                                    lesser(size, with->bytes.size - from),
                                    &done));
    return done;
}

snow_status snow_filter_stage_open_with(snow_context *context, const char *name,
                                        const snow_bytes_behind *bytes,
                                        snow_filter_stage **out) {
    if (bytes->size > INT64_MAX)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s: has %llu bytes, more than 2^63 - 1; check the "
                         "size",
                         name, (unsigned long long)bytes->size);
    with_filter *with = snow_filter_stage_allocate(context, sizeof *with);
    if (!with)
        return SNOW_STATUS_NO_MEMORY;
    with->filter.name = name;
    with->filter.pull = pull;
    with->filter.jump = jump;
    with->filter.look = look;
    with->filter.size = (int64_t)bytes->size;
    with->bytes = *bytes;
    snow_monitor_expect(context, with->filter.size);
    *out = &with->filter;
    return SNOW_STATUS_OK;
}
