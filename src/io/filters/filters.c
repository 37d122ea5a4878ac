/* io/filters/filters.c - adds the stages of filter_base64.c and filter_blocks.c
 * to a source; the end of data that are followed by others. */
#include "io/filters/filters.h"
#include "io/source_internal.h"

snow_status snow_source_unpack_base64(snow_source *source) {
    return snow_filter_stage_open_base64(source->top, &source->top);
}

snow_status snow_source_unpack_blocks(snow_source *source,
                                      const snow_blocks *blocks) {
    return snow_filter_stage_open_blocks(source->top, blocks, &source->top);
}

snow_status snow_source_unpack_by(snow_source *source,
                                  snow_open_stage_fn *open) {
    return open(source->top, &source->top);
}

/* Only for base64 text, whose end is not verified: a file has a definite end,
 * and a packed stream is read to its check sum. */
snow_status snow_source_promise(snow_source *source, uint64_t size,
                                const char *what) {
    snow_filter_stage *top = source->top;
    SNOW_TRY(snow_source_expect(source, size, what));
    uint64_t end;
    if (top->size < 0 && top->limit && snow_add_u64(top->taken, size, &end) &&
        end <= (uint64_t)INT64_MAX)
        top->size = (int64_t)end;
    return SNOW_STATUS_OK;
}

/* From the top down: an upper stage consumes what it needs of the one below. */
snow_status snow_source_verify(snow_source *source) {
    for (snow_filter_stage *filter = source->top; filter;
         filter = filter->below)
        while (filter->size < 0) {
            SNOW_TRY(snow_filter_stage_fill(filter, 1));
            if (filter->begin == filter->end)
                break;
            snow_filter_stage_drop(filter, filter->end - filter->begin);
        }
    return SNOW_STATUS_OK;
}
