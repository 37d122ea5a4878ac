/* base/monitor.c - see monitor.h.
 *
 * Calls of the progress function are counted with a debt: one is due every
 * INTERVAL; the end of a stage, of which something was reported before, is
 * always reported, and puts the next one off by as much.  So there are at most
 * 20 in any second, and work done within an interval reports nothing. */
#include "base/monitor.h"

#include <math.h>

#define INTERVAL 0.053
#define ASK_INTERVAL 0.001

static snow_status stopped_status(snow_context *context) {
    return snow_fail(context, SNOW_STATUS_STOPPED,
                     "stopped, as the caller asked");
}

static void init(snow_context *context, snow_monitor *monitor,
                 snow_stop_fn *stop, void *user) {
    *monitor = (snow_monitor){.context = context,
                              .stop = stop,
                              .stop_user = user,
                              .last = SNOW_STAGE_ENCODE,
                              .reported = {-1, -1, -1, -1},
                              .share = 1};
    /* What is done at once reports nothing. */
    double soon = context->progress ? snow_seconds() + INTERVAL : 0;
    if (!context->monitor && context->progress_due < soon)
        context->progress_due = soon;
}

void snow_monitor_enter(snow_monitor *monitor) {
    monitor->outer = monitor->context->monitor;
    monitor->context->monitor = monitor;
    monitor->entered = true;
}

void snow_monitor_leave(snow_monitor *monitor) {
    if (monitor->entered)
        monitor->context->monitor = monitor->outer;
    monitor->entered = false;
}

void snow_monitor_begin(snow_context *context, snow_monitor *monitor,
                        snow_stop_fn *stop, void *user) {
    init(context, monitor, stop, user);
    if (stop || context->progress)
        snow_monitor_enter(monitor);
}

void snow_monitor_begin_reading(snow_context *context, snow_monitor *monitor) {
    init(context, monitor, NULL, NULL);
    monitor->reads = true;
    monitor->last = SNOW_STAGE_READ;
    if (context->progress && !context->monitor)
        snow_monitor_enter(monitor);
}

static void call_progress(snow_monitor *monitor, snow_stage stage,
                          double fraction, double due) {
    snow_context *context = monitor->context;
    monitor->reported[stage] = fraction;
    monitor->last = stage;
    context->progress_due = due;
    if (context->progress(context->progress_user, stage, fraction))
        atomic_store(&monitor->stopped, true);
}

void snow_monitor_done(snow_monitor *monitor) {
    for (int stage = 0; stage < SNOW_STAGES; stage++)
        if (monitor->context->progress && monitor->reported[stage] >= 0)
            call_progress(monitor, (snow_stage)stage, 1,
                          monitor->context->progress_due + INTERVAL);
}

snow_status snow_monitor_end(snow_monitor *monitor, snow_status status) {
    if (!monitor->entered)
        return status;
    if (status == SNOW_STATUS_OK)
        snow_monitor_done(monitor);
    snow_monitor_leave(monitor);
    if (status != SNOW_STATUS_OK && atomic_load(&monitor->stopped))
        return stopped_status(monitor->context);
    return status;
}

snow_status snow_monitor_status(const snow_monitor *monitor) {
    if (!monitor ||
        !atomic_load_explicit(&monitor->stopped, memory_order_relaxed))
        return SNOW_STATUS_OK;
    return stopped_status(monitor->context);
}

/* Asks, on the calling thread only. */
static void ask_progress(snow_monitor *monitor) {
    if (monitor && monitor->stop && !atomic_load(&monitor->stopped) &&
        monitor->stop(monitor->stop_user))
        atomic_store(&monitor->stopped, true);
}

void snow_monitor_report(snow_monitor *monitor, snow_stage stage, double done,
                         double all) {
    if (!monitor || !monitor->context->progress ||
        atomic_load_explicit(&monitor->stopped, memory_order_relaxed))
        return;
    double now = snow_seconds();
    monitor->last = stage;
    /* Just below 1, which is kept for the end, and never falling. */
    double part = all > 0 ? done / all : 0;
    double fraction = monitor->from + monitor->share * (part < 1 ? part : 1);
    if (fraction > 0.999)
        fraction = 0.999;
    monitor->reached = fraction > monitor->reported[stage]
                           ? fraction
                           : monitor->reported[stage];
    if (now >= monitor->context->progress_due)
        call_progress(monitor, stage, monitor->reached, now + INTERVAL);
}

/* Says how far the stage is, where nothing was reported for so long,
 * since the function may end the call. */
static void repeat(snow_monitor *monitor, double now) {
    if (monitor->context->progress &&
        now >= monitor->context->progress_due + INTERVAL / 2 &&
        !atomic_load(&monitor->stopped))
        call_progress(monitor, monitor->last,
                      fmax(monitor->reported[monitor->last], monitor->reached),
                      now + INTERVAL);
}

bool snow_monitor_item(snow_monitor *monitor, int worker, int64_t item,
                       int64_t items) {
    if (!monitor)
        return false;
    if (worker == 0) {
        ask_progress(monitor);
        if (monitor->batch)
            snow_monitor_report(monitor, monitor->stage,
                                monitor->begin +
                                    (monitor->end - monitor->begin) *
                                        (double)item / (double)items,
                                1);
        else if (monitor->context->progress)
            repeat(monitor, snow_seconds());
    }
    return atomic_load_explicit(&monitor->stopped, memory_order_relaxed);
}

bool snow_monitor_look(snow_monitor *monitor, int worker) {
    if (!monitor)
        return false;
    if (worker == 0 && (monitor->stop || monitor->context->progress)) {
        double now = snow_seconds();
        if (now - monitor->asked >= ASK_INTERVAL) {
            monitor->asked = now;
            ask_progress(monitor);
            repeat(monitor, now);
        }
    }
    return atomic_load_explicit(&monitor->stopped, memory_order_relaxed);
}

void snow_monitor_next(snow_monitor *monitor, snow_stage stage, double begin,
                       double end) {
    if (!monitor)
        return;
    monitor->stage = monitor->last = stage;
    monitor->reached = 0;
    monitor->begin = begin;
    monitor->end = end;
    monitor->armed = true;
}

snow_monitor_part snow_monitor_divide(snow_monitor *monitor, double n,
                                      double count) {
    snow_monitor_part before = {0, 1};
    if (!monitor)
        return before;
    before = (snow_monitor_part){monitor->from, monitor->share};
    monitor->from += monitor->share * n / count;
    monitor->share /= count;
    monitor->bytes = monitor->expected = 0;
    return before;
}

void snow_monitor_whole(snow_monitor *monitor, snow_monitor_part before) {
    if (!monitor)
        return;
    monitor->from = before.from;
    monitor->share = before.share;
    monitor->bytes = monitor->expected = 0;
}

/* Slabs of a picture are no stage of their own. */
snow_status snow_monitor_read(snow_context *context, uint64_t bytes) {
    snow_monitor *monitor = context->monitor;
    if (!monitor)
        return SNOW_STATUS_OK;
    monitor->bytes += bytes;
    if (monitor->reads)
        snow_monitor_report(monitor, SNOW_STAGE_READ, (double)monitor->bytes,
                            (double)monitor->expected);
    (void)snow_monitor_look(monitor, 0);
    return snow_monitor_status(monitor);
}

void snow_monitor_expect(snow_context *context, int64_t bytes) {
    if (context->monitor && bytes > 0)
        context->monitor->expected += (uint64_t)bytes;
}
