/* movie.c - the loop over the frames: what begins before it, and ends after. */
#include "commands/commands.h"
#include "movie/movie_frame.h"
#include "movie/movie_render.h"
#include "movie/movie_report.h"
#include "movie/movie_webp.h"
#include "picture/outputs.h"
#include "picture/paint.h"
#include "picture/warnings.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/paths.h"
#include "run/start.h"

#include <errno.h>
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

int movie_check(const options *opts) {
    if (!opts->output)
        return fail_usage("no output given; add -o OUT.mp4 or -o f_%%04d.png");
    const bool streams = strcmp(opts->output, "-") == 0;
    if (streams != (opts->as == AS_RGB24) || (streams && opts->resume))
        return fail_usage(
            "%s: frames on standard output need -o - --as rgb24, files "
            "neither; --resume needs files",
            opts->output);
    if (streams && isatty(STDOUT_FILENO))
        return fail_usage("--output: standard output is a terminal; send it to "
                          "a pipe or a file");
    bool is_movie = streams || movie_format_of(opts->output);
    if (is_movie && opts->bits)
        return fail_usage("%s: --bits works only for PNG; remove it",
                          opts->output);
    if (!is_movie && snow_image_format_bits(opts->output) == 0 &&
        (opts->background.given || opts->bits))
        return fail_usage("%s: --background and --bits work only for PNG, WebP "
                          "and movies; remove them or name a .png",
                          opts->output);
    if (opts->depth && (is_movie || strcmp(opts->depth, opts->output) != 0 ||
                        !snow_image_format_has_depth(opts->output)))
        return fail_usage(
            "--depth: frames hold depths in their own files, as channel Z; "
            "give --output and --depth the same pattern, such as f_%%04d.exr");
    int done = check_depth_mode(opts);
    if (done == CONTINUE)
        done = paint_check(opts, true);
    if (done == CONTINUE)
        done = check_stats_apart(opts);
    return done == CONTINUE ? check_settings(opts) : done;
}

/* --- the beginning -------------------------------------------------------- */

int movie_open(const options *opts, shot_list *list, movie **out) {
    movie *s = calloc(1, sizeof *s);
    frame_time *times = calloc((size_t)list->count, sizeof *times);
    measures **measured = calloc((size_t)list->count, sizeof(measures *));
    if (!s || !times || !measured) {
        free(s);
        free(times);
        free(measured);
        return fail_memory("out of memory at the start; close other programs");
    }
    s->times = times;
    s->measured = measured;
    s->opts = opts;
    s->list = list;
    s->encoder.pipe = -1;
    s->record.file = -1;
    int done = place_read(opts->output, &s->place);
    if (done == CONTINUE)
        done = open_context(opts, &s->context);
    if (done == CONTINUE)
        done = place_check(s->context, &s->place, opts);
    if (done == CONTINUE && opts->stats)
        done = check_stats_path(opts->stats, opts->overwrite);
    if (done == CONTINUE)
        done = record_open(opts, list, &s->place, &s->record);
    if (done != CONTINUE) {
        movie_close(s);
        return done;
    }
    /* A movie by ffmpeg, or for it, has no transparency: without a background
     * it is black. Its frames are kept as the encoder gets them. */
    snow_image_options_init(&s->form);
    paint_background(opts, NULL, &s->form);
    s->form.flatten |= place_needs_encoder(&s->place);
    s->form.bits = options_bits(opts);
    s->form.overwrite = true; /* of unfinished files */
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
    for (int64_t i = 0; i < s->list->count; i++)
        free(s->measured[i]);
    free(s->measured);
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

/* What a user can do about ffmpeg that cannot be started. */
static const char *remedy(int number) {
    switch (number) {
    case EAGAIN:
        return "end other programs, or allow more (ulimit -u)";
    case ENOMEM:
        return "close other programs";
    case EMFILE:
    case ENFILE:
        return "close other files, or allow more of them (ulimit -n)";
    default:
        return "correct the PATH";
    }
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
               : fail_output("%s: cannot start ffmpeg: %s; %s", s->place.output,
                             strerror(number), remedy(number));
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
                       : fail_output("%s: %s; %s", s->place.record,
                                     strerror(number), place_remedy(number));
}

/* Prepares the frames' folder and the record; removes leftovers. */
static int begin_files(movie *s) {
    s->made_folder = s->place.format && !is_there(s->place.folder);
    int done = place_make_folder(&s->place);
    if (done == CONTINUE)
        done = claim_output(s);
    if (done != CONTINUE)
        return done;
    place_sweep(&s->place);
    s->begun = !s->record.anew;
    return CONTINUE;
}

/* The same, then ffmpeg and the queue. */
static int begin_parts(movie *s) {
    const frame_sink sink = {s, movie_frame_prepare, movie_frame_commit,
                             movie_frame_release};
    int done = CONTINUE;
    if (s->place.streams) {
        s->encoder.pipe = dup(STDOUT_FILENO);
        s->encoding = s->encoder.pipe >= 0;
        if (!s->encoding)
            return fail_output("standard output: %s", strerror(errno));
    } else
        done = begin_files(s);
    if (done != CONTINUE)
        return done;
    if (!s->encoding && place_needs_encoder(&s->place) && encoder_is_there())
        done = start_encoder(s);
    else if (!s->encoding && place_needs_encoder(&s->place) &&
             s->opts->verbosity >= 0)
        say("note: %s: ffmpeg was not found on the PATH; only frames are made, "
            "in %s",
            s->place.output, s->place.folder);
    if (done != CONTINUE)
        return done;
    snow_status status = frames_new(&sink, count_workers(s->opts), &s->queue);
    if (status == SNOW_STATUS_NO_MEMORY)
        return fail_memory("out of memory for the queue of frames; use a "
                           "smaller --size");
    if (status != SNOW_STATUS_OK) {
        say("%s: the system gives no thread to write frames; end other "
            "programs, or allow more (ulimit -u)",
            s->place.output);
        return (int)status;
    }
    return CONTINUE;
}

/* --- the loop ------------------------------------------------------------- */

/* The state of the loop. */
typedef struct run {
    movie *s; /* NULL on ranks that do not write */
    const options *opts;
    const shot_list *list;
    shot_renderer *shots;
    movie_progress progress;
    movie_figures figures;
    snow_image *last; /* the last picture, for its checksum */
    int64_t begun[2]; /* frames in flight, the oldest first */
    int in_flight;
    bool shown; /* something is visible in a frame */
} run;

/* Decides what to do with a frame, on the rank that writes.  A failed write
 * shows here one or some frames later; it is reported when the queue is
 * idle. */
static int next_word(const run *r, int64_t index) {
    if (!r->s)
        return CONTINUE;
    if (interrupt_asked(NULL))
        return EXIT_INTERRUPTED;
    snow_status status = frames_status(r->s->queue);
    if (status != SNOW_STATUS_OK)
        return (int)status;
    return r->s->record.kept[index] ? PASS : CONTINUE;
}

/* An error of the queue shows in the next word, so that all ranks learn of
 * it. */
static void hand_over(run *r, int64_t index, snow_image *image) {
    if (!r->s) {
        snow_image_free(image);
        return;
    }
    const render_state *state = &r->shots->state;
    const render_report report = render_state_report(state);
    movie_figures_add(&r->figures, &report);
    if (!r->s->has_annotations) { /* the queue's lock shows them to workers */
        const bool flat = r->s->form.flatten;
        r->s->annotations = shots_annotations(r->shots);
        paint_background(r->opts, render_state_ground(state), &r->s->form);
        r->s->form.flatten = flat;
    }
    r->s->has_annotations = true;
    movie_take_time(r->s, index, &state->drawn.whole);
    r->s->measured[index] = r->shots->measured; /* NULL: as all frames */
    r->shots->measured = NULL;
    (void)frames_put(r->s->queue, index, image,
                     r->opts->depth ? snow_frame_depth(state->frame) : NULL);
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
        int word = shots_finish(r->shots, &image);
        if (word != CONTINUE)
            return word;
        hand_over(r, index, image);
    }
    return CONTINUE;
}

/* An error ends the loop, but frames that were begun before it are finished. */
static int render_frames(run *r) {
    int word = CONTINUE;
    for (int64_t i = 0; i < r->list->count && word == CONTINUE; i++) {
        word = process_share(next_word(r, i));
        if (word == PASS) {
            word = finish_frames(r, 0);
            if (word != CONTINUE || !r->s)
                continue;
            if (r->s->encoding) /* ffmpeg needs it too */
                (void)frames_put(r->s->queue, i, NULL, NULL);
            r->figures.kept++;
            movie_progress_step(&r->progress, i, false);
            continue;
        }
        if (word == CONTINUE)
            word = shots_begin(r->shots, &r->list->shots[i]);
        if (word == CONTINUE) {
            r->begun[r->in_flight++] = i;
            word = finish_frames(r, process_ranks() > 1);
        }
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
    if (done == CONTINUE && s->encoding && !s->place.streams)
        done = finish_encoder(s);
    else if (done == CONTINUE && s->place.format &&
             !place_needs_encoder(&s->place))
        done = join_movie(s);
    else if (done == CONTINUE && s->place.format)
        done = fail_output(
            "%s: ffmpeg was not found on the PATH; the frames are in %s: "
            "install ffmpeg (apt install ffmpeg) and repeat the command with "
            "--resume",
            s->place.output, s->place.folder);
    if (done != CONTINUE)
        clean_up(s);
    return done;
}

/* Comes after the frames are written. */
static int report_figures(run *r, double begin) {
    render_report report = render_state_report(&r->shots->state);
    render_times times = *report.times;
    times.write = frames_seconds(r->s->queue);
    times.total = seconds_now() - begin;
    report.times = &times;
    report.image = r->last;
    if (r->opts->verbosity > 0)
        movie_report(&r->figures, &times);
    if (!r->opts->stats)
        return SNOW_STATUS_OK;
    return write_json(movie_stats_json(&r->figures, &report, process_ranks()),
                      r->opts->stats, r->opts->overwrite);
}

/* The rank that writes decides; the others follow its words. */
static int run_writer(run *r, double begin) {
    interrupt_hold_movie();
    int done = movie_figures_begin(&r->figures, r->list->count)
                   ? begin_parts(r->s)
                   : SNOW_STATUS_NO_MEMORY;
    movie_progress_begin(&r->progress, r->opts, r->list->count);
    done = process_share(done);
    if (done == CONTINUE)
        done = render_frames(r);
    movie_progress_end(&r->progress);
    done = process_share(finish_movie(r->s, done));
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
              shot_renderer *shots, double begin) {
    run r = {.s = process_talks() ? s : NULL,
             .opts = opts,
             .list = list,
             .shots = shots};
    if (r.s)
        return run_writer(&r, begin);
    interrupt_hold_movie(); /* the rank that writes polls for signals and
                               reports them */
    int done = process_share(CONTINUE);
    if (done == CONTINUE)
        done = render_frames(&r);
    done = process_share(done);
    return done == CONTINUE ? SNOW_STATUS_OK : done;
}
