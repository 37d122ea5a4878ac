/* slice_frames.c - a picture for each of many slices: files by a pattern, or a
 * movie.  Frames are kept, resumed and encoded as those of a turntable; all
 * have one look, that of all voxels. */
#include "commands/commands.h"
#include "movie/movie_render.h"
#include "options/config.h"
#include "run/log.h"
#include "run/start.h"
#include "slice/slice.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static int check_frames(const slice_work *w) {
    const options *opts = &w->opts;
    if (process_ranks() > 1)
        return fail_usage("slice: one process makes a series; run it without "
                          "MPI");
    if (opts->show)
        return fail_usage("--show: shows one picture; give --at N, or --grid");
    if (opts->resume && strcmp(w->path, "-") == 0)
        return fail_usage("--resume: standard input cannot be compared with "
                          "the earlier run's; name a file");
    return movie_check(opts);
}

static int make_shots(const slice_work *w, shot_list *out) {
    *out = (shot_list){.count = w->count, .steps = true, .slices = true};
    out->shots = calloc((size_t)w->count, sizeof *out->shots);
    for (int64_t n = 0; n < w->count && out->shots; n++)
        out->shots[n] = (movie_shot){.path = w->path,
                                     .time = w->opts.time,
                                     .slice = w->places[n].index,
                                     .axis = w->places[n].axis,
                                     .place = n,
                                     .step = -1};
    return out->shots ? CONTINUE
                      : fail_memory("out of memory for a list of %" PRId64
                                    " slices; make fewer",
                                    w->count);
}

static void report(const slice_work *w) {
    const options *opts = &w->opts;
    char volume[256], colors[1024], thick[64];
    describe_volume(&w->whole, volume, sizeof volume);
    slice_describe_slab(w, thick, sizeof thick);
    slice_describe_colors(w, colors, sizeof colors);
    config_note_slice(opts, w->channels.list.count ? NULL : w->transfer,
                      slice_axis_name(w), -1);
    if (w->channels.list.count)
        config_note_channels(opts, &w->channels.list, SNOW_SHADE_NONE, NULL);
    if (opts->verbosity >= 0)
        say("%s: %s; %s slices %" PRId64 " to %" PRId64 " of 0 to %" PRId64
            "%s; %s; %" PRId64 " frame%s of %dx%d to %s",
            name_of_input(w->path), volume, slice_axis_name(w),
            w->places[0].index, w->places[w->count - 1].index,
            w->whole.dims[w->axis] - 1, thick, colors, w->count,
            w->count == 1 ? "" : "s", w->size[0], w->size[1], opts->output);
    if (opts->verbosity >= 0)
        measures_report(w->measures);
}

static int draw_shot(void *user, const movie_shot *shot, snow_image **image) {
    slice_work *w = user;
    return check_volume(w->context, slice_draw_part(w, shot->place, image),
                        name_of_input(w->path));
}

/* What a movie asks of its renderer, which lends all from the slices. */
static void lend(slice_work *w, shot_renderer *shots) {
    render_state *s = &shots->state;
    *shots = (shot_renderer){
        .count = w->count, .draw = draw_shot, .user = w, .drawn = true};
    s->opts = &w->opts;
    s->context = w->context;
    s->whole = s->drawn.whole = w->whole;
    s->transfer = w->transfer;
    s->channels = w->channels;
    s->measures = w->measures;
    s->layers = w->layers;
    s->view = w->places[0].view;
    s->settings = w->settings;
    s->stats = (snow_stats){.size = sizeof s->stats,
                            .kernel = w->settings.kernel,
                            .threads = w->settings.threads};
    s->times = w->times;
}

int slice_run_frames(slice_work *w) {
    shot_list list = {.shots = NULL};
    shot_renderer shots;
    movie *s = NULL;
    int done = check_frames(w);
    if (done == CONTINUE)
        done = slice_inspect(w);
    if (done == CONTINUE)
        done = make_shots(w, &list);
    if (done == CONTINUE) {
        w->opts.size[0] = w->size[0];
        w->opts.size[1] = w->size[1];
        done = movie_open(&w->opts, &list, &s);
    }
    if (done == CONTINUE)
        done = slice_read(w);
    if (done == CONTINUE)
        done = slice_measure(w);
    if (done == CONTINUE) {
        report(w);
        lend(w, &shots);
        done = movie_run(s, &w->opts, &list, &shots, w->begin);
    }
    movie_close(s);
    free(list.shots);
    return done;
}
