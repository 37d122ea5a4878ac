/* base/line_batch.c - see line_batch.h. */
#include "base/line_batch.h"

/* Draws item `item` from the first line on, after the last the first of the
 * image. */
static void draw_item(void *of, int64_t item, int worker) {
    snow_line_batch *b = of;
    const int64_t width = b->order.width, count = b->order.lines * width;
    const int64_t place = (b->first * width + item) % count;
    if (!snow_monitor_item(b->monitor, worker, item, count))
        b->order.draw(b->order.job, place, worker);
    atomic_fetch_add_explicit(&b->finished[place / width], 1,
                              memory_order_release);
}

snow_status snow_line_batch_begin(snow_context *context, snow_line_batch *b,
                                  const snow_line_batch_params *params) {
    const int64_t lines = params->lines;
    SNOW_TRY(SNOW_RESERVE(context, b->finished, 0, lines));
    for (int64_t line = 0; line < lines; line++)
        atomic_init(&b->finished[line], 0);
    b->context = context;
    b->monitor = context->monitor;
    b->order = *params;
    b->first = (int64_t)(params->begin_at * (double)lines) % lines;
    snow_monitor_batch(b->monitor);
    snow_parallel_begin(context, params->threads, lines * params->width,
                        draw_item, b, &b->batch);
    return SNOW_STATUS_OK;
}

bool snow_line_batch_step(snow_line_batch *b) {
    return snow_parallel_step(&b->batch);
}

bool snow_line_batch_drawn(const snow_line_batch *b, int first, int end) {
    if (b->order.whole)
        return false;
    for (int line = first; line < end; line++)
        if (atomic_load_explicit(&b->finished[line], memory_order_acquire) <
            b->order.width)
            return false;
    return true;
}

void snow_line_batch_end(snow_line_batch *b) {
    if (!b->batch.items)
        return;
    snow_parallel_end(b->context, &b->batch);
    snow_monitor_batch(b->monitor);
    b->monitor = NULL;
    if (b->order.made)
        b->order.made(b->order.job);
    b->batch.items = 0;
}

void snow_line_batch_fini(snow_line_batch *b) {
    if (b->context)
        snow_release(b->context, b->finished);
}
