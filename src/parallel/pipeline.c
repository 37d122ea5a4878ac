/* parallel/pipeline.c - pictures by many processors that are under way at the
 * same time: while one is combined, the next is drawn.  One that no other
 * follows is still drawn when its turn comes, and sent meanwhile (render.c).
 *
 *   begin 0   draw 0
 *   begin 1             draw 1, where it waits | the rest of it
 *   finish 0  combine 0 .......................
 *   begin 2                                           draw 2, where it waits
 *   finish 1                                   combine 1 ...
 *
 * Combining is what it is for one picture, call by call, on the thread that
 * sends all messages.  Where it waits for some it draws a band of the other
 * picture (snow_comm_occupy), which needs no messages; other threads draw bands
 * all the time.  So no rank waits while it has anything to draw, and a rank
 * that is late holds the others up only when they are a picture ahead.  Which
 * rank does what when changes no bit: bands share nothing, and messages are the
 * same in the same order. */
#include "parallel/internal.h"

#include <string.h>

static bool draw_meanwhile(void *of) {
    snow_ranks *r = of;
    bool any = snow_ranks_draw(r);
    r->drawn->picture.ranks_stats.seconds_hidden += snow_ranks_pause(r);
    return any;
}

/* --- pictures ------------------------------------------------------------- */

static void keep_status(snow_in_flight *f, snow_status status) {
    f->status = status;
    if (status != SNOW_STATUS_OK)
        memcpy(f->message, f->ranks->context->message, sizeof f->message);
}

static void begin_call(snow_in_flight *f) {
    f->mark = snow_ranks_clock(f->ranks);
    f->mark_cpu = snow_cpu_seconds();
}

bool snow_ranks_busy(const snow_ranks *r) {
    for (int n = 0; n < r->in_flight; n++)
        if (!snow_in_flight_at(r, n)->done)
            return true;
    return false;
}

static snow_status fail_in_flight(snow_context *context, const char *what) {
    return snow_fail(context, SNOW_STATUS_BAD_USAGE, "%s", what);
}

snow_status snow_pipeline_open(snow_frame *frame, snow_comm *comm,
                               const snow_settings *settings,
                               const snow_ranks_options *how,
                               snow_picture **picture) {
    snow_ranks *r = frame->ranks;
    if (r && r->in_flight && r->comm != comm)
        return fail_in_flight(frame->context,
                              "pictures of another communicator are in flight; "
                              "finish them first");
    if (r && r->in_flight == SNOW_PICTURES_MOST)
        return fail_in_flight(
            frame->context,
            "two pictures are in flight; call snow_ranks_finish first");
    SNOW_TRY(snow_ranks_of(frame, comm));
    r = frame->ranks;
    snow_in_flight *f = snow_in_flight_at(r, r->in_flight);
    *f = (snow_in_flight){
        .picture = {.frame = frame,
                    .combiner = r->ranks == 1 ? &snow_combine_alone
                                              : &snow_combine_ranks,
                    .aside = snow_pipeline_waiting(frame) != NULL},
        .ranks = r};
    f->picture.refused =
        SNOW_RECORD_READ(frame->context, snow_ranks_options, how, &f->how);
    snow_ranks_drain(r);
    begin_call(f);
    f->drawn_cpu = snow_thread_seconds();
    snow_picture_watch(&f->picture, settings);
    if (!f->picture.monitor.entered)
        snow_monitor_enter(&f->picture.monitor);
    *picture = &f->picture;
    return SNOW_STATUS_OK;
}

void snow_pipeline_begun(snow_picture *p, snow_status status) {
    snow_in_flight *f = snow_in_flight_of(p);
    snow_ranks *r = f->ranks;
    r->in_flight++;
    snow_monitor_leave(&p->monitor);
    if (p->ahead && status == SNOW_STATUS_OK) {
        p->ranks_stats.cpu_splat += snow_in_flight_cpu(f) - f->drawn_cpu;
        /* Now, while there is a volume, which may go after this. */
        status = snow_method_figures(p->pass->method, p, &p->pass->job);
    }
    keep_status(f, status);
    p->stats.seconds_frame = snow_ranks_clock(r) - f->mark;
    p->stats.cpu_frame = snow_cpu_seconds() - f->mark_cpu;
    if (!p->ahead)
        return;
    if (p->drawing)
        f->held = snow_volume_hold(p->job.volume);
    p->job.volume = p->pass->job.volume = NULL;
    p->job.transfer = p->pass->job.transfer = NULL;
    if (p->drawing) {
        r->drawn = f;
        snow_comm_occupy(r->comm, draw_meanwhile, r);
    }
}

snow_picture *snow_pipeline_waiting(const snow_frame *frame) {
    const snow_ranks *r = frame->ranks;
    for (int n = 0; n < r->in_flight; n++)
        if (!snow_in_flight_at(r, n)->done)
            return &snow_in_flight_at(r, n)->picture;
    return NULL;
}

snow_picture *snow_pipeline_oldest(const snow_frame *frame) {
    const snow_ranks *r = frame->ranks;
    bool any = r && r->in_flight && !snow_in_flight_at(r, 0)->done;
    return any ? &snow_in_flight_at(r, 0)->picture : NULL;
}

snow_status snow_pipeline_resume(snow_picture *p) {
    snow_in_flight *f = snow_in_flight_of(p);
    begin_call(f);
    snow_monitor_enter(&p->monitor);
    if (f->status != SNOW_STATUS_OK) /* others may have failed since */
        return snow_fail(f->ranks->context, f->status, "%s", f->message);
    return snow_monitor_status(&p->monitor);
}

/* Time and processor time are of the calls for this picture. */
static void count_time(snow_in_flight *f) {
    snow_stats *stats = &f->picture.stats;
    stats->seconds_splat += f->overlapped;
    stats->seconds_frame +=
        snow_ranks_clock(f->ranks) - f->mark + f->overlapped;
    stats->cpu_frame += snow_cpu_seconds() - f->mark_cpu;
}

/* A group of one: its local image is the picture. */
static void end_alone(snow_in_flight *f, snow_status status) {
    snow_picture *p = &f->picture;
    if (status == SNOW_STATUS_OK && f->how.pixel_bits == 8 &&
        p->image->channels > 1)
        snow_round_pixels(p->image);
    p->ranks_stats.cpu_splat = p->stats.threads == 1
                                   ? snow_thread_seconds() - f->drawn_cpu
                                   : p->stats.cpu_frame;
}

void snow_pipeline_done(snow_picture *p, snow_status status) {
    snow_in_flight *f = snow_in_flight_of(p);
    if (status == SNOW_STATUS_STOPPED) /* by any rank */
        atomic_store(&p->monitor.stopped, true);
    if (f->ranks->drawn == f) /* where it failed */
        snow_ranks_drain(f->ranks);
    if (status == SNOW_STATUS_OK)
        snow_monitor_done(&p->monitor);
    snow_monitor_leave(&p->monitor);
    if (f->ranks->ranks == 1)
        end_alone(f, status);
    else
        count_time(f);
    f->done = true;
    keep_status(f, status);
}

snow_status snow_pipeline_take(snow_frame *frame, snow_image **image) {
    snow_ranks *r = frame->ranks;
    if (!r || !r->in_flight)
        return fail_in_flight(
            frame->context,
            "no picture is in flight; call snow_ranks_begin first");
    snow_in_flight *f = snow_in_flight_at(r, 0);
    r->first = (r->first + 1) % SNOW_PICTURES_MOST;
    r->in_flight--;
    snow_in_flight_end(f);
    return snow_picture_end(&f->picture, f->status, image) == SNOW_STATUS_OK
               ? SNOW_STATUS_OK
               : snow_fail(frame->context, f->status, "%s", f->message);
}
