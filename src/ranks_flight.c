/* ranks_flight.c - pictures by many processors that are under way at the same
 * time: while one is combined, the next is drawn.  One that no other follows is
 * still drawn when its turn comes, and sent meanwhile (ranks_render.c).
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
#include "ranks_cut.h"
#include "ranks_parts.h"

#include "image/image.h"

#include <string.h>

/* --- what a frame keeps ---------------------------------------------------
 */

static void end_picture(snow_picture *p) {
    snow_context *context = p->ranks->context;
    if (p->drawing)
        snow_sheared_end(p->work.sheared);
    p->drawing = false;
    snow_release(context, p->bytes);
    p->bytes = NULL;
}

/* Pictures that nobody has asked for end here. */
static void end_pictures(snow_ranks *r) {
    for (; r->under_way; r->under_way--) {
        snow_picture *p = &r->pictures[r->first];
        end_picture(p);
        snow_image_free(p->image);
        snow_image_free(p->depth);
        r->first = (r->first + 1) % SNOW_PICTURES_MOST;
    }
    if (r->drawn)
        snow_comm_occupy(r->comm, NULL, NULL);
}

void snow_ranks_free(snow_ranks *r) {
    if (!r)
        return;
    snow_context *context = r->context;
    end_pictures(r);
    void *const blocks[] = {r->parts,    r->boxes,   r->order, r->firsts,
                            r->counts,   r->offsets, r->sent,  r->came,
                            r->messages, r->piece,   r->lines, r->images,
                            r->runs,     r->packed,  r->rows,  r->pictures};
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++)
        snow_release(context, blocks[n]);
    snow_combiner_free(r->combiner);
    snow_release(context, r);
}

static snow_status take_arrays(snow_ranks *r) {
    snow_context *context = r->context;
    uint64_t count = (uint64_t)r->ranks;
    bool fine =
        (r->parts = snow_allocate_array(context, count, sizeof *r->parts)) &&
        (r->boxes = snow_allocate_array(context, count, sizeof *r->boxes)) &&
        (r->order = snow_allocate_array(context, count, sizeof *r->order)) &&
        (r->firsts = snow_allocate_array(context, count, sizeof *r->firsts)) &&
        (r->counts = snow_allocate_array(context, count, sizeof *r->counts)) &&
        (r->offsets =
             snow_allocate_array(context, count, sizeof *r->offsets)) &&
        (r->messages = snow_allocate_array(context, 4 * count + 16,
                                           sizeof *r->messages)) &&
        (r->pictures = snow_allocate_array(context, SNOW_PICTURES_MOST,
                                           sizeof *r->pictures));
    return fine ? snow_combiner_new(r->comm, &r->combiner) : SNOW_NO_MEMORY;
}

static snow_status new_ranks(snow_frame *frame, snow_comm *comm) {
    snow_ranks *r = snow_allocate_clear(frame->context, sizeof *r);
    if (!r)
        return SNOW_NO_MEMORY;
    r->context = frame->context;
    r->comm = comm;
    r->rank = snow_comm_rank(comm);
    r->ranks = snow_comm_ranks(comm);
    r->begin_at = (double)(r->rank + 1) / r->ranks;
    frame->ranks = r;
    return take_arrays(r);
}

/* Collective.  The frame's record for a communicator. */
static snow_status open_ranks(snow_frame *frame, snow_comm *comm) {
    if (frame->ranks && frame->ranks->comm == comm)
        return SNOW_OK;
    snow_ranks_free(frame->ranks);
    frame->ranks = NULL;
    snow_status status = snow_comm_agree(comm, new_ranks(frame, comm));
    if (status != SNOW_OK) {
        snow_ranks_free(frame->ranks);
        frame->ranks = NULL;
    }
    return status;
}

/* --- drawing where others would wait --------------------------------------
 */

double snow_ranks_clock(const snow_ranks *r) {
    return snow_comm_seconds(r->comm) - r->apart;
}

static double processor_time(const snow_picture *p) {
    return p->job.settings.threads == 1 ? snow_thread_seconds()
                                        : snow_cpu_seconds();
}

double snow_picture_cpu(const snow_picture *p) {
    return processor_time(p) - p->ranks->apart_cpu;
}

/* Bands that follow one another are timed together: to look at a clock takes
 * time too. */
static void stop_clock(snow_ranks *r) {
    if (r->standing)
        return;
    r->standing = true;
    r->since = snow_comm_seconds(r->comm);
    r->since_cpu = processor_time(r->drawn);
}

double snow_ranks_pause(snow_ranks *r) {
    if (!r->standing)
        return 0;
    double took = snow_comm_seconds(r->comm) - r->since;
    double cpu = processor_time(r->drawn) - r->since_cpu;
    r->standing = false;
    r->apart += took;
    r->apart_cpu += cpu;
    r->drawn->apart += took;
    r->drawn->stats.cpu_splat += cpu;
    return took;
}

bool snow_ranks_draw(snow_ranks *r) {
    stop_clock(r);
    return snow_sheared_step(r->drawn->work.sheared);
}

static bool draw_meanwhile(void *of) {
    snow_ranks *r = of;
    bool any = snow_ranks_draw(r);
    r->drawn->stats.seconds_hidden += snow_ranks_pause(r);
    return any;
}

void snow_ranks_settle(snow_ranks *r) {
    if (!r->drawn)
        return;
    snow_comm_occupy(r->comm, NULL, NULL);
    stop_clock(r);
    snow_sheared_end(r->drawn->work.sheared);
    snow_ranks_pause(r);
    r->drawn->drawing = false;
    r->drawn = NULL;
}

/* --- pictures -------------------------------------------------------------
 */

/* As bytes would have travelled. */
static void round_pixels(snow_image *image) {
    size_t count =
        (size_t)image->width * (size_t)image->height * (size_t)image->channels;
    for (size_t n = 0; n < count; n++)
        image->pixels[n] =
            (float)(unsigned char)(image->pixels[n] * 255 + 0.5f) / 255;
}

/* A group of one: its local image is the picture. */
static void render_alone(snow_picture *p, const snow_volume *volume,
                         const snow_transfer *transfer,
                         const snow_settings *settings) {
    snow_stats last = p->frame->stats;
    double cpu = snow_thread_seconds();
    snow_status status = snow_frame_render(p->frame, volume, transfer, &p->view,
                                           settings, &p->image);
    if (status == SNOW_OK && p->how.pixel_bits == 8 && p->image->channels > 1)
        round_pixels(p->image);
    p->depth = p->frame->depth;
    p->frame->depth = NULL;
    p->stats = p->frame->stats;
    p->stats.cpu_splat = p->stats.threads == 1 ? snow_thread_seconds() - cpu
                                               : p->stats.cpu_frame;
    p->frame->stats = last;
    p->done = true;
    snow_picture_fail(p, status);
}

/* Collective.  Time and processor time are of the calls for this picture. */
static void complete(snow_picture *p) {
    snow_ranks *r = p->ranks;
    if (p->done)
        return;
    double mark = snow_ranks_clock(r), cpu = snow_cpu_seconds();
    snow_status status = snow_picture_combine(p);
    if (r->drawn == p) /* where it failed */
        snow_ranks_settle(r);
    p->stats.seconds_splat += p->apart;
    p->stats.seconds_frame += snow_ranks_clock(r) - mark + p->apart;
    p->stats.cpu_frame += snow_cpu_seconds() - cpu;
    p->done = true;
    snow_picture_fail(p, status);
}

/* The picture that was begun before, while its local image is needed. */
static snow_picture *picture_before(snow_ranks *r) {
    snow_picture *p = r->under_way ? &r->pictures[r->first] : NULL;
    return p && !p->done ? p : NULL;
}

/* Collective where its local image cannot be drawn ahead: it is made at once,
 * after the one before it. */
static void begin_together(snow_picture *p, const snow_volume *volume,
                           const snow_transfer *transfer,
                           const snow_settings *settings) {
    snow_ranks *r = p->ranks;
    snow_picture *before = picture_before(r);
    snow_ranks_settle(r);
    double mark = snow_ranks_clock(r), cpu = snow_cpu_seconds();
    snow_picture_begin(p, volume, transfer, settings, before != NULL);
    double seconds = snow_ranks_clock(r) - mark;
    p->stats.cpu_frame = snow_cpu_seconds() - cpu;
    p->stats.seconds_frame = seconds;
    if (!p->ahead) {
        if (before)
            complete(before);
        complete(p);
        return;
    }
    p->job.volume = p->work.order.volume = NULL; /* which may go now */
    p->job.transfer = p->work.order.transfer = NULL;
    if (p->drawing) {
        r->drawn = p;
        snow_comm_occupy(r->comm, draw_meanwhile, r);
    }
}

bool snow_ranks_busy(const snow_ranks *r) {
    for (int n = 0; n < r->under_way; n++)
        if (!r->pictures[(r->first + n) % SNOW_PICTURES_MOST].done)
            return true;
    return false;
}

static snow_status fail_flight(snow_context *context, const char *what) {
    return snow_fail(context, SNOW_BAD_USAGE, "%s", what);
}

snow_status
snow_ranks_begin(snow_frame *frame, snow_comm *comm, const snow_volume *volume,
                 const snow_transfer *transfer, const snow_view *view,
                 const snow_settings *settings, const snow_ranks_options *how) {
    snow_ranks *r = frame->ranks;
    if (r && r->under_way && r->comm != comm)
        return fail_flight(frame->context,
                           "pictures by another communicator are under way; "
                           "finish them first");
    if (r && r->under_way == SNOW_PICTURES_MOST)
        return fail_flight(frame->context,
                           "two pictures are under way; finish the first of "
                           "them");
    SNOW_TRY(open_ranks(frame, comm));
    r = frame->ranks;
    snow_picture *p =
        &r->pictures[(r->first + r->under_way) % SNOW_PICTURES_MOST];
    memset(p, 0, sizeof *p);
    p->frame = frame;
    p->ranks = r;
    p->view = *view;
    p->how = snow_ranks_options_known(how);
    if (r->ranks == 1)
        render_alone(p, volume, transfer, settings);
    else
        begin_together(p, volume, transfer, settings);
    r->under_way++;
    return SNOW_OK;
}

snow_status snow_ranks_finish(snow_frame *frame, snow_image **image) {
    snow_ranks *r = frame->ranks;
    if (!r || !r->under_way)
        return fail_flight(frame->context,
                           "no picture is under way; begin one");
    snow_picture *p = &r->pictures[r->first];
    complete(p);
    frame->stats = p->stats;
    r->first = (r->first + 1) % SNOW_PICTURES_MOST;
    r->under_way--;
    end_picture(p);
    snow_image_free(frame->depth);
    frame->depth = p->depth;
    if (p->status == SNOW_OK) {
        *image = p->image;
        return SNOW_OK;
    }
    snow_image_free(p->image);
    return snow_fail(frame->context, p->status, "%s", p->message);
}

snow_status
snow_ranks_render(snow_frame *frame, snow_comm *comm, const snow_volume *volume,
                  const snow_transfer *transfer, const snow_view *view,
                  const snow_settings *settings, const snow_ranks_options *how,
                  snow_image **image) {
    if (frame->ranks && frame->ranks->under_way)
        return fail_flight(frame->context,
                           "a picture is under way; finish it first");
    SNOW_TRY(
        snow_ranks_begin(frame, comm, volume, transfer, view, settings, how));
    return snow_ranks_finish(frame, image);
}
