/* movie.c - the loop over the frames, and what becomes of each.
 *
 * The thread that renders puts pictures into a queue; its workers make a file
 * of each, and the bytes for ffmpeg.  A frame's way:
 *
 *   render -> copy -> compress aside, sync | record, rename, bytes to ffmpeg
 *                     several at once      | one after another
 *
 * Frames that an earlier run has left whole go the second half only, and only
 * where there is an ffmpeg to feed. */
#include "movie/movie.h"
#include "commands/commands.h"
#include "movie/frames.h"
#include "movie/movie_encoder.h"
#include "movie/movie_place.h"
#include "movie/movie_record.h"
#include "movie/movie_report.h"
#include "movie/movie_webp.h"
#include "picture/outputs.h"
#include "picture/paint.h"
#include "picture/warnings.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* What slots may hold together: a few huge pictures rather than many. */
#define QUEUE_BYTES (INT64_C(1) << 30)
#define PIXEL_BYTES 24 /* floats of four channels, depth, bytes of three */

/* Words that ranks exchange, besides exit codes and CONTINUE. */
#define PASS (-2) /* the frame is kept, not rendered */

struct movie {
    const options *opts;
    const shot_list *list;
    movie_place place;
    frame_record record;
    snow_context *context;
    frame_queue *queue;
    movie_encoder encoder;
    bool encoding; /* ffmpeg runs and takes the frames */
    bool claimed;  /* the record belongs to this run */
    bool begun;    /* and has been written */
    bool made_folder;
    snow_image_options form;         /* the form of the frames' files */
    picture_annotations annotations; /* annotations of the frames, known from
                                the first picture on */
    bool has_annotations;
    double *times; /* physical ones of the frames, as their pictures come */
};

int movie_check(const options *opts) {
    if (!opts->output)
        return fail_usage("no output given; add -o OUT.mp4 or -o f_%%04d.png");
    bool is_movie = movie_format_of(opts->output) != NULL;
    if (is_movie && opts->bits)
        return fail_usage("%s: --bits works only for PNG; remove it",
                          opts->output);
    if (!is_movie && snow_image_format_bits(opts->output) == 0 &&
        (opts->background.given || opts->bits))
        return fail_usage("%s: --background and --bits work only for PNG, WebP "
                          "and movies; remove them or name a .png",
                          opts->output);
    if (opts->stats && (strcmp(opts->stats, opts->output) == 0 ||
                        same_place(opts->stats, opts->output)))
        return fail_usage(
            "--stats: is the same file as --output; name two files");
    if (opts->depth && (is_movie || strcmp(opts->depth, opts->output) != 0 ||
                        !snow_image_format_has_depth(opts->output)))
        return fail_usage(
            "--depth: frames hold depths in their own files, as channel Z; "
            "give --output and --depth the same pattern, such as f_%%04d.exr");
    int done = check_depth_mode(opts);
    if (done == CONTINUE)
        done = paint_check(opts, true);
    return done == CONTINUE ? check_settings(opts) : done;
}

/* --- one frame, by the workers -------------------------------------------- */

static bool needs_encoder(const movie *s) {
    return s->place.format && s->place.format->arguments;
}

static snow_status fault(frame_slot *slot, const char *path, int number) {
    snprintf(slot->fault, sizeof slot->fault,
             "%s: %s; make space or choose another place, then continue with "
             "--resume",
             path, strerror(number));
    return SNOW_STATUS_BAD_OUTPUT;
}

/* Loads a frame that was kept, for ffmpeg. */
static snow_status load_frame(const movie *s, frame_slot *slot,
                              const char *path) {
    snow_status status = snow_image_load(slot->context, path, &slot->image);
    if (status != SNOW_STATUS_OK)
        return status;
    if (snow_image_width(slot->image) == (int)s->opts->size[0] &&
        snow_image_height(slot->image) == (int)s->opts->size[1])
        return SNOW_STATUS_OK;
    snprintf(slot->fault, sizeof slot->fault,
             "%s: has another size than the movie; remove it and continue with "
             "--resume",
             path);
    return SNOW_STATUS_BAD_INPUT;
}

static snow_status fill_bytes(const movie *s, frame_slot *slot,
                              const snow_image_options *form) {
    if (!slot->work) /* once: all frames have one size */
        slot->work =
            malloc((size_t)s->opts->size[0] * (size_t)s->opts->size[1] * 3);
    if (!slot->work) {
        snprintf(
            slot->fault, sizeof slot->fault,
            "out of memory for the bytes of a frame; use a smaller --size");
        return SNOW_STATUS_NO_MEMORY;
    }
    snow_image_to_rgb8_with(slot->image, form, slot->work);
    return SNOW_STATUS_OK;
}

/* Makes a new frame: its unfinished file and its bytes. */
static snow_status make_frame(const movie *s, frame_slot *slot) {
    const movie_shot *shot = &s->list->shots[slot->index];
    snow_overlay *overlay = NULL;
    snow_image_options form = s->form;
    picture_annotations annotations = s->annotations;
    char path[PATH_MAX];
    annotations.info.time_value = s->times[slot->index];
    snow_status status =
        annotations_make(&annotations, shot->azimuth, shot->step, slot->image,
                         slot->context, &overlay);
    form.overlay = overlay;
    form.depth = slot->depth;
    place_aside(&s->place, slot->index, path, sizeof path);
    if (status == SNOW_STATUS_OK)
        status = snow_image_save(slot->image, path, &form);
    if (status == SNOW_STATUS_OK && s->encoding)
        status = fill_bytes(s, slot, &form);
    snow_overlay_free(overlay);
    return status;
}

static snow_status prepare_frame(void *user, frame_slot *slot) {
    const movie *s = user;
    char path[PATH_MAX];
    if (!s->record.kept[slot->index])
        return make_frame(s, slot);
    place_frame(&s->place, slot->index, path, sizeof path);
    snow_status status = load_frame(s, slot, path);
    return status == SNOW_STATUS_OK && s->encoding
               ? fill_bytes(s, slot, &s->form)
               : status;
}

/* Gives a frame its final name, under which the record lists it already: a run
 * that is killed between the two leaves no frame that nobody knows.  A file of
 * this name that was there before is another program's, and stays, unless a
 * record shows that it may be replaced. */
static snow_status name_frame(movie *s, frame_slot *slot) {
    char aside[PATH_MAX], path[PATH_MAX];
    struct stat what;
    place_aside(&s->place, slot->index, aside, sizeof aside);
    place_frame(&s->place, slot->index, path, sizeof path);
    if (!s->record.replaces && lstat(path, &what) == 0)
        return fault(slot, path, EEXIST);
    int64_t bytes = stat(aside, &what) == 0 ? (int64_t)what.st_size : 0;
    int number = record_add(&s->record, &s->place, s->list, slot->index, bytes);
    s->begun = s->begun || number == 0;
    if (number != 0)
        return fault(slot, s->place.record, number);
    number = name_output(aside, path, s->record.replaces);
    return number == 0 ? SNOW_STATUS_OK : fault(slot, path, number);
}

static snow_status commit(void *user, frame_slot *slot) {
    movie *s = user;
    snow_status status = SNOW_STATUS_OK;
    if (!s->record.kept[slot->index])
        status = name_frame(s, slot);
    if (status != SNOW_STATUS_OK || !s->encoding)
        return status;
    size_t size = (size_t)s->opts->size[0] * (size_t)s->opts->size[1] * 3;
    int number = encoder_write(&s->encoder, slot->work, size);
    return number == 0 ? SNOW_STATUS_OK : fault(slot, "ffmpeg", number);
}

static void release(void *user, frame_slot *slot) {
    (void)user;
    free(slot->work);
    slot->work = NULL;
}

/* --- the beginning -------------------------------------------------------- */

/* A movie by ffmpeg has no transparency: without a background it is black.  Its
 * frames are kept as the encoder gets them. */
static void set_form(movie *s) {
    snow_image_options_init(&s->form);
    paint_background(s->opts, &s->form);
    s->form.flatten |= needs_encoder(s);
    s->form.bits = options_bits(s->opts);
    s->form.overwrite = true; /* of unfinished files */
}

static int open_parts(movie *s, shot_list *list) {
    int done = place_read(s->opts->output, &s->place);
    if (done == CONTINUE)
        done = open_context(s->opts, &s->context);
    if (done == CONTINUE)
        done = place_check(s->context, &s->place, s->opts);
    if (done == CONTINUE && s->opts->stats)
        done = check_stats_path(s->opts->stats, s->opts->overwrite);
    if (done == CONTINUE)
        done = record_open(s->opts, list, &s->place, &s->record);
    if (done == CONTINUE)
        set_form(s);
    return done;
}

int movie_open(const options *opts, shot_list *list, movie **out) {
    movie *s = calloc(1, sizeof *s);
    double *times = calloc((size_t)list->count, sizeof *times);
    if (!s || !times) {
        free(s);
        free(times);
        return fail_memory("out of memory at the start; close other programs");
    }
    s->times = times;
    s->opts = opts;
    s->list = list;
    s->encoder.pipe = -1;
    s->record.file = -1;
    int done = open_parts(s, list);
    if (done != CONTINUE) {
        movie_close(s);
        return done;
    }
    *out = s;
    return CONTINUE;
}

void movie_close(movie *s) {
    if (!s)
        return;
    frames_free(s->queue);
    encoder_stop(&s->encoder);
    record_close(&s->record);
    snow_context_free(s->context);
    free(s->times);
    free(s);
}

static int64_t count_threads(const options *opts) {
    return opts->threads ? opts->threads : process_processors();
}

/* Half of the processors compress, at most FRAME_WORKERS_MOST; fewer if
 * pictures are huge. */
static int count_workers(const options *opts) {
    int64_t threads = count_threads(opts);
    int64_t frame = opts->size[0] * opts->size[1] * PIXEL_BYTES;
    int64_t workers = threads / 2;
    if (workers > QUEUE_BYTES / frame - 2)
        workers = QUEUE_BYTES / frame - 2;
    if (workers > FRAME_WORKERS_MOST)
        workers = FRAME_WORKERS_MOST;
    return workers < 1 ? 1 : (int)workers;
}

/* A movie of few time steps would be over in a moment. */
static double movie_rate(const options *opts, const shot_list *list) {
    const double shortest = 4; /* seconds */
    double rate = (double)list->count / shortest;
    if (options_given(opts, "fps") || !list->steps || rate >= opts->fps)
        return opts->fps;
    return rate < 2 ? 2 : rate;
}

static int start_encoder(movie *s) {
    encoder_job job = {.format = s->place.format,
                       .width = (int)s->opts->size[0],
                       .height = (int)s->opts->size[1],
                       .rate = movie_rate(s->opts, s->list),
                       .threads = (int)count_threads(s->opts),
                       .path = s->place.movie,
                       .log = s->place.log};
    int number = encoder_start(&job, &s->encoder);
    s->encoding = number == 0;
    return number == 0
               ? CONTINUE
               : fail_output("%s: cannot start ffmpeg: %s; correct the PATH",
                             s->place.output, strerror(number));
}

/* Claims the output for this run. */
static int claim_output(movie *s) {
    int number = record_claim(&s->record, &s->place);
    struct stat what;
    s->claimed = number == 0;
    if (number == EEXIST && stat(s->place.record, &what) != 0)
        number = errno; /* a dangling link */
    if (number == EEXIST || number == EAGAIN)
        return fail_output("%s: another run has begun these frames; wait for "
                           "it, or choose another name",
                           s->place.output);
    return number == 0 ? CONTINUE
                       : fail_output("%s: %s; choose a place that can be "
                                     "written",
                                     s->place.record, strerror(number));
}

/* Prepares the frames' folder, the record, ffmpeg and the queue; removes
 * leftovers. */
static int begin_parts(movie *s) {
    const frame_sink sink = {s, prepare_frame, commit, release};
    struct stat what;
    s->made_folder = s->place.format && stat(s->place.folder, &what) != 0;
    int done = place_make_folder(&s->place);
    if (done == CONTINUE)
        done = claim_output(s);
    if (done != CONTINUE)
        return done;
    place_sweep(&s->place);
    s->begun = !s->record.anew;
    if (needs_encoder(s) && encoder_is_there())
        done = start_encoder(s);
    else if (needs_encoder(s) && s->opts->verbosity >= 0)
        say("note: %s: ffmpeg was not found on the PATH; only frames are made, "
            "in %s",
            s->place.output, s->place.folder);
    if (done != CONTINUE)
        return done;
    if (frames_new(&sink, count_workers(s->opts), &s->queue) == SNOW_STATUS_OK)
        return CONTINUE;
    return fail_memory("out of memory for the queue of frames; use a smaller "
                       "--size");
}

/* --- the loop ------------------------------------------------------------- */

/* The state of the loop. */
typedef struct run {
    movie *s; /* NULL on ranks that do not write */
    const options *opts;
    const shot_list *list;
    const movie_renderer *renderer;
    movie_progress progress;
    movie_figures figures;
    snow_image *last; /* the last picture, for its checksum */
    int64_t begun[2]; /* frames in flight, the oldest first */
    int in_flight;
    bool shown; /* something is visible in a frame */
} run;

static int share_word(const run *r, int word) {
    return r->renderer->share ? r->renderer->share(r->renderer->self, word)
                              : word;
}

/* Decides what to do with a frame, on the rank that writes.  A failed write
 * shows here one or some frames later; it is reported when the queue is
 * idle. */
static int next_word(const run *r, int64_t index) {
    if (!r->s)
        return CONTINUE;
    if (interrupt_seen())
        return EXIT_INTERRUPTED;
    snow_status status = frames_status(r->s->queue);
    if (status != SNOW_STATUS_OK)
        return (int)status;
    return r->s->record.kept[index] ? PASS : CONTINUE;
}

/* Only ffmpeg needs a frame that exists already. */
static void pass_kept_frame(run *r, int64_t index) {
    if (!r->s)
        return;
    if (r->s->encoding)
        (void)frames_put(r->s->queue, index, NULL, NULL);
    r->figures.kept++;
    movie_progress_step(&r->progress, index, false);
}

/* An error of the queue shows in the next word, so that all ranks learn of
 * it. */
static void hand_over(run *r, int64_t index, snow_image *image) {
    if (!r->s) {
        snow_image_free(image);
        return;
    }
    render_report report = {0};
    r->renderer->report(r->renderer->self, &report);
    movie_figures_add(&r->figures, &report);
    if (!r->s->has_annotations) /* the queue's lock makes them visible to the
                                 * workers
                                 */
        r->renderer->annotations(r->renderer->self, &r->s->annotations);
    r->s->has_annotations = true;
    r->s->times[index] = r->renderer->time(r->renderer->self);
    (void)frames_put(r->s->queue, index, image,
                     r->renderer->depth(r->renderer->self));
    snow_image_free(r->last);
    r->last = image;
    r->shown = r->shown || !picture_is_empty(image);
    movie_progress_step(&r->progress, index, true);
}

/* Finishes frames, the oldest first, until at most `most` are in flight. */
static int finish_frames(run *r, int most) {
    while (r->in_flight > most) {
        snow_image *image = NULL;
        int64_t index = r->begun[0];
        r->begun[0] = r->begun[1];
        r->in_flight--;
        int word = r->renderer->finish(r->renderer->self, &image);
        if (word != CONTINUE)
            return word;
        hand_over(r, index, image);
    }
    return CONTINUE;
}

static int begin_frame(run *r, int64_t index) {
    int word = r->renderer->begin(r->renderer->self, &r->list->shots[index]);
    if (word == CONTINUE)
        r->begun[r->in_flight++] = index;
    return word;
}

/* An error ends the loop, but frames that were begun before it are finished. */
static int render_frames(run *r) {
    int word = CONTINUE;
    for (int64_t i = 0; i < r->list->count && word == CONTINUE; i++) {
        word = share_word(r, next_word(r, i));
        if (word == PASS) {
            word = finish_frames(r, 0);
            if (word == CONTINUE)
                pass_kept_frame(r, i);
            continue;
        }
        if (word == CONTINUE)
            word = begin_frame(r, i);
        if (word == CONTINUE)
            word = finish_frames(r, r->renderer->ahead);
    }
    int last = finish_frames(r, 0);
    return word == CONTINUE ? last : word;
}

/* --- the end -------------------------------------------------------------- */

static int report_encoder(movie *s, const char *text) {
    return fail_output("%s: ffmpeg failed: %s; the frames are in %s: correct "
                       "this and repeat the command with --resume",
                       s->place.output, text, s->place.folder);
}

/* Gives the movie its name when it is complete. */
static int name_movie(movie *s) {
    int number =
        place_output(s->place.movie, s->place.output, s->opts->overwrite);
    if (number == 0) {
        record_close(&s->record);
        place_remove_folder(&s->place);
        return CONTINUE;
    }
    return fail_output("%s: %s; the frames are in %s: choose another place, or "
                       "make space and continue with --resume",
                       s->place.output, strerror(number), s->place.folder);
}

static int finish_encoder(movie *s) {
    char text[600];
    if (encoder_finish(&s->encoder, text, sizeof text))
        return name_movie(s);
    unlink(s->place.movie);
    return report_encoder(s, text);
}

/* Makes an animated WebP when all frames exist. */
static int join_movie(movie *s) {
    const webp_job job = {.count = s->list->count,
                          .width = (int)s->opts->size[0],
                          .height = (int)s->opts->size[1],
                          .rate = movie_rate(s->opts, s->list),
                          .alpha = !s->form.flatten};
    int number = webp_join(&job, &s->place);
    if (number == 0)
        return name_movie(s);
    unlink(s->place.movie);
    return fail_output("%s: %s; the frames are in %s: correct this and repeat "
                       "the command with --resume",
                       s->place.output, strerror(number), s->place.folder);
}

/* Reports the first error of the queue.  If the pipe broke, ffmpeg's message
 * gives the reason. */
static int report_queue(movie *s, snow_status status) {
    char text[600];
    if (s->encoding && status == SNOW_STATUS_BAD_OUTPUT &&
        strncmp(frames_message(s->queue), "ffmpeg:", 7) == 0 &&
        !encoder_finish(&s->encoder, text, sizeof text))
        return report_encoder(s, text);
    const char *message = frames_message(s->queue);
    say("%s", *message ? message : snow_status_description(status));
    return (int)status;
}

/* An interrupted run leaves complete frames and their record, or nothing. */
static void clean_up(movie *s) {
    encoder_stop(&s->encoder);
    if (!s->claimed) {
        if (s->made_folder) /* unless another program put a file there */
            rmdir(s->place.folder);
        return;
    }
    place_sweep(&s->place);
    if (s->place.format)
        unlink(s->place.log);
    if (place_first(&s->place, 0) >= 0)
        return;
    unlink(s->place.record);
    if (s->made_folder || s->begun)
        place_remove_folder(&s->place);
}

/* The workers are idle only now: complete files get their names, others are
 * removed. */
static int finish_movie(movie *s, int done) {
    if (s->queue && done == EXIT_INTERRUPTED)
        frames_stop(s->queue);
    snow_status status = s->queue ? frames_drain(s->queue) : SNOW_STATUS_OK;
    if (status != SNOW_STATUS_OK && status != SNOW_STATUS_STOPPED)
        done = report_queue(s, status);
    if (done == CONTINUE && s->encoding)
        done = finish_encoder(s);
    else if (done == CONTINUE && s->place.format && !needs_encoder(s))
        done = join_movie(s);
    else if (done == CONTINUE && s->place.format)
        done = fail_output(
            "%s: ffmpeg was not found on the PATH; the frames are in %s: "
            "install ffmpeg and repeat the command with --resume",
            s->place.output, s->place.folder);
    if (done != CONTINUE)
        clean_up(s);
    return done;
}

/* Comes after the frames are written. */
static int report_figures(run *r, double begin) {
    render_report report = {0};
    render_times times = {0};
    r->renderer->report(r->renderer->self, &report);
    if (report.times)
        times = *report.times;
    times.write = frames_seconds(r->s->queue);
    times.total = seconds_now() - begin;
    report.times = &times;
    report.image = r->last;
    if (r->opts->verbosity > 0)
        movie_report(&r->figures, &times);
    if (!r->opts->stats)
        return SNOW_STATUS_OK;
    return write_json(
        movie_stats_json(&r->figures, &report, r->renderer->ranks),
        r->opts->stats, r->opts->overwrite);
}

/* The rank that writes decides; the others follow its words. */
static int run_writer(run *r, double begin) {
    interrupt_hold_movie();
    int done = movie_figures_begin(&r->figures, r->list->count)
                   ? begin_parts(r->s)
                   : SNOW_STATUS_NO_MEMORY;
    movie_progress_begin(&r->progress, r->opts, r->list->count);
    done = share_word(r, done);
    if (done == CONTINUE)
        done = render_frames(r);
    movie_progress_end(&r->progress);
    done = share_word(r, finish_movie(r->s, done));
    if (done == CONTINUE)
        done = report_figures(r, begin);
    /* what frames of an earlier run show is not known */
    if (done == SNOW_STATUS_OK && !r->shown && !r->figures.kept)
        done = EXIT_EMPTY;
    snow_image_free(r->last);
    movie_figures_end(&r->figures);
    return done;
}

int movie_run(movie *s, const options *opts, const shot_list *list,
              const movie_renderer *renderer, double begin) {
    run r = {.s = renderer->writes ? s : NULL,
             .opts = opts,
             .list = list,
             .renderer = renderer};
    if (r.s)
        return run_writer(&r, begin);
    interrupt_hold_movie(); /* the rank that writes polls for signals and
                               reports them */
    int done = share_word(&r, CONTINUE);
    if (done == CONTINUE)
        done = render_frames(&r);
    done = share_word(&r, done);
    return done == CONTINUE ? SNOW_STATUS_OK : done;
}
