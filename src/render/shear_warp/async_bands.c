/* render/shear_warp/async_bands.c - the bands of an intermediate image, drawn
 * one by one, by threads of the context and by the caller.
 *
 * Bands share nothing, so their order is free.  Where several processors draw,
 * each begins elsewhere, so that what one draws last is not what all draw last:
 * whoever a part of all images is for gets one of them at a time.
 *
 * After a stop (base/monitor.h) bands are finished without being drawn, so that
 * nobody waits for them. */
#include "render/shear_warp/internal.h"

/* Draws band number `item` from the first one on, after the last the first of
 * the image. */
static void draw_band(void *job, int64_t item, int worker) {
    snow_shear_warp *s = job;
    int64_t band = (s->first_band + item) % s->band_count;
    if (!snow_monitor_item(s->monitor, worker, item, s->band_count))
        s->draw(s->pass, band, worker);
    atomic_store_explicit(&s->finished[band], 1, memory_order_release);
}

snow_status snow_shear_warp_begin_bands(snow_shear_warp *s,
                                        const snow_shear_warp_params *params,
                                        int64_t bands, snow_work_fn *draw) {
    SNOW_TRY(snow_reserve(s->context, &s->finished, &s->finished_capacity, 0,
                          (size_t)bands * sizeof *s->finished));
    for (int64_t band = 0; band < bands; band++)
        atomic_init(&s->finished[band], 0);
    s->draw = draw;
    s->monitor = s->context->monitor;
    snow_monitor_next(s->monitor, SNOW_STAGE_RENDER, 0, 0.9);
    snow_monitor_batch(s->monitor);
    s->band_count = bands;
    s->first_band = (int64_t)(params->begin_at * (double)bands) % bands;
    snow_parallel_begin(s->context, params->settings->threads, bands, draw_band,
                        s, &s->batch);
    return SNOW_STATUS_OK;
}

bool snow_shear_warp_step(snow_shear_warp *s) {
    return snow_parallel_step(&s->batch);
}

bool snow_shear_warp_drawn(const snow_shear_warp *s, int first, int end) {
    for (int band = first; band < end; band++)
        if (!atomic_load_explicit(&s->finished[band], memory_order_acquire))
            return false;
    return true;
}

void snow_shear_warp_end(snow_shear_warp *s) {
    snow_parallel_end(s->context, &s->batch);
    snow_monitor_batch(s->monitor);
}
