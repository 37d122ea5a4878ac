/* base/monitor.h - stop and progress of a call that takes long.
 *
 * A monitor belongs to one call, or to one picture: it holds the function that
 * the caller wants to be asked, whether that has asked for a stop, and how far
 * the work is.  Functions of the caller run only on the thread that called the
 * library, which is worker 0 of every batch; the other threads read a flag.
 *
 *   worker 0    item  ask  item  ask: stop!   the flag is set
 *   worker 1    item       item               item: skipped
 *
 * The flag stays set.  Work may therefore be left half done in the middle, as
 * long as the status is looked at before anybody uses its results:
 * snow_parallel returns it. */
#ifndef SNOW_BASE_MONITOR_H
#define SNOW_BASE_MONITOR_H

#include "base/base.h"

#include <stdatomic.h>

#define SNOW_STAGES 4

struct snow_monitor {
    snow_context *context;
    snow_monitor *outer; /* of the context before; while it is entered */
    snow_stop_fn *stop;
    void *stop_user;
    atomic_bool stopped;
    bool entered;
    double asked; /* when `stop` was asked last */
    /* Progress.  Of a stage: what was reported last, below 0: nothing. */
    double reported[SNOW_STAGES];
    snow_stage last;          /* the stage that is under way ... */
    double reached;           /* ... and how far it is */
    double from, share;       /* the part of each stage that is under way */
    double begin, end;        /* the part of `stage` that is made by the ... */
    snow_stage stage;         /* ... next batch; `armed` */
    bool armed, batch;        /* the next batch reports; the present one does */
    bool reads;               /* a file: bytes are reported */
    uint64_t bytes, expected; /* of reading: so far; of all files */
};

/* Begins a monitor and makes it the context's own, unless nothing is to be
 * watched.  Its first stage is that of encoding. */
void snow_monitor_begin(snow_context *context, snow_monitor *monitor,
                        snow_stop_fn *stop, void *user);

/* The same of a call that reads, makes or measures a volume, unless it is a
 * part of another one, say of a picture, which has a monitor of its own. */
void snow_monitor_begin_reading(snow_context *context, snow_monitor *monitor);

/* Ends it, reports the ends of its stages where the call has succeeded, and
 * returns the call's status: SNOW_STATUS_STOPPED with its message where a call
 * has failed after a stop was asked for. */
snow_status snow_monitor_end(snow_monitor *monitor, snow_status status);

/* For pictures that several calls work on: makes it the context's own for a
 * while. */
void snow_monitor_enter(snow_monitor *monitor);
void snow_monitor_leave(snow_monitor *monitor);

/* Reports the ends of the stages of what has succeeded. */
void snow_monitor_done(snow_monitor *monitor);

/* SNOW_STATUS_OK, or SNOW_STATUS_STOPPED and its message.  `monitor` may be
 * NULL, here and in all that follows. */
snow_status snow_monitor_status(const snow_monitor *monitor);

/* A batch begins, which reports if it was announced; or it ends. */
static inline void snow_monitor_batch(snow_monitor *monitor) {
    if (!monitor)
        return;
    monitor->batch = monitor->armed;
    monitor->armed = false;
}

/* Between two items of a batch of `items`: worker 0 asks and reports.  True: no
 * more work. */
bool snow_monitor_item(snow_monitor *monitor, int worker, int64_t item,
                       int64_t items);

/* Within a long item: the same, but asks no more than a thousand times a
 * second, and reports how far the work is where nothing else does. */
bool snow_monitor_look(snow_monitor *monitor, int worker);

/* The next batch is the part from `begin` to `end` (0 to 1) of a stage. */
void snow_monitor_next(snow_monitor *monitor, snow_stage stage, double begin,
                       double end);

/* `done` of `all` of a part that no batch counts; `all` 0: it is not known. */
void snow_monitor_report(snow_monitor *monitor, snow_stage stage, double done,
                         double all);

/* What follows is the part number `n` of `count` of each stage; *before is what
 * snow_monitor_whole takes to end it. */
typedef struct snow_monitor_part {
    double from, share;
} snow_monitor_part;
snow_monitor_part snow_monitor_divide(snow_monitor *monitor, double n,
                                      double count);
void snow_monitor_whole(snow_monitor *monitor, snow_monitor_part before);

/* Bytes that came from a file, and those of a file that was opened. */
snow_status snow_monitor_read(snow_context *context, uint64_t bytes);
void snow_monitor_expect(snow_context *context, int64_t bytes);

/* The most bytes to be read at once, so that a stop does not wait. */
#define SNOW_MONITOR_BYTES ((size_t)1 << 20)
static inline size_t snow_monitor_chunk(const snow_context *context,
                                        size_t bytes) {
    return context->monitor && bytes > SNOW_MONITOR_BYTES ? SNOW_MONITOR_BYTES
                                                          : bytes;
}

#endif
