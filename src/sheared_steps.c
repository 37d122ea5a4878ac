/* sheared_steps.c - the bands of an intermediate image, drawn one by one, by
 * threads of the context and by the caller.
 *
 * Bands share nothing, so their order is free.  Where several processors draw,
 * each begins elsewhere, so that what one draws last is not what all draw last:
 * whoever a part of all images is for gets one of them at a time. */
#include "sheared_parts.h"

/* Draws band number `item` from the first one on, after the last the first of
 * the image. */
static void draw_band(void *job, int64_t item, int worker) {
    snow_sheared *s = job;
    int64_t band = (s->first_band + item) % s->band_count;
    s->draw(s->pass, band, worker);
    atomic_store_explicit(&s->finished[band], 1, memory_order_release);
}

snow_status snow_sheared_begin_bands(snow_sheared *s,
                                     const snow_sheared_order *order,
                                     int64_t bands, snow_work_fn *draw) {
    SNOW_TRY(snow_reserve(s->context, &s->finished, &s->finished_capacity, 0,
                          (size_t)bands * sizeof *s->finished));
    for (int64_t band = 0; band < bands; band++)
        atomic_init(&s->finished[band], 0);
    s->draw = draw;
    s->band_count = bands;
    s->first_band = (int64_t)(order->begin_at * (double)bands) % bands;
    snow_parallel_begin(s->context, order->settings->threads, bands, draw_band,
                        s, &s->batch);
    return SNOW_OK;
}

bool snow_sheared_step(snow_sheared *s) {
    return snow_parallel_step(&s->batch);
}

bool snow_sheared_drawn(const snow_sheared *s, int first, int end) {
    for (int band = first; band < end; band++)
        if (!atomic_load_explicit(&s->finished[band], memory_order_acquire))
            return false;
    return true;
}

void snow_sheared_end(snow_sheared *s) {
    snow_parallel_end(s->context, &s->batch);
}
