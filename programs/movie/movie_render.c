/* movie_render.c - the renderer of a sequence.  It keeps a volume as long as
 * shots use it, one transfer function, and one frame whose buffers and encoding
 * are reused. */
#include "movie/movie_render.h"
#include "commands/commands.h"
#include "picture/warnings.h"
#include "run/log.h"
#include "run/start.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

int shots_open(const options *opts, shot_renderer *out) {
    *out = (shot_renderer){.count = 0};
    const int done = render_state_new(opts, &out->state);
    out->state.one_look = true;
    return done;
}

void shots_close(shot_renderer *shots) {
    render_state_free(&shots->state);
}

/* A volume elsewhere in the world would move the camera, and the movie would
 * jump. */
int shots_check(shot_renderer *shots, const char *path,
                const snow_volume_info *info) {
    const snow_volume_info *first = &shots->grid;
    if (shots->whole_files && info->times > 1) {
        say("%s: holds %" PRId64
            " time steps; give this file alone for a movie of them, or --time "
            "to pick one of each file",
            path, info->times);
        return SNOW_STATUS_BAD_INPUT;
    }
    if (first->dims[0] == 0) {
        shots->grid = *info;
        return CONTINUE;
    }
    if (memcmp(info->dims, first->dims, sizeof info->dims) != 0) {
        say("%s: has %" PRId64 "x%" PRId64 "x%" PRId64
            " voxels, but the first step %" PRId64 "x%" PRId64 "x%" PRId64
            "; all steps of a movie need the same grid",
            path, info->dims[0], info->dims[1], info->dims[2], first->dims[0],
            first->dims[1], first->dims[2]);
        return SNOW_STATUS_BAD_INPUT;
    }
    if (memcmp(info->matrix, first->matrix, sizeof info->matrix) == 0)
        return CONTINUE;
    say("%s: lies elsewhere in the world than the first step; all steps of a "
        "movie need the same grid",
        path);
    return SNOW_STATUS_BAD_INPUT;
}

int shots_volume(shot_renderer *shots, const movie_shot *shot) {
    render_state *s = &shots->state;
    if (s->volume && strcmp(s->path, shot->path) == 0 &&
        shots->time == shot->time)
        return CONTINUE;
    if (!shots->drawn)
        progress(s->opts, "reading");
    shots->time = shot->time;
    int done = render_state_open(s, shot->path, shot->time);
    return done == CONTINUE
               ? shots_check(shots, name_of_input(shot->path), &s->whole)
               : done;
}

static void annotations(void *self, picture_annotations *out) {
    const shot_renderer *shots = self;
    const render_state *s = &shots->state;
    *out = (picture_annotations){
        s->opts,
        s->drawn.whole,
        s->view,
        s->transfer,
        {shots->painted.range[0], shots->painted.range[1]},
        &s->channels,
        layers_legend(&s->layers, s->each_time && shots->count > 1)};
}

/* Frames are annotated elsewhere and silently: what one has no room for is said
 * here. */
static void report_legend(shot_renderer *shots, const snow_image *image) {
    const options *opts = shots->state.opts;
    snow_context *context = NULL;
    snow_overlay *overlay = NULL;
    picture_annotations made;
    const bool any = opts->legend.scale || opts->title || opts->annotate.text;
    if (!any || !image || open_context(opts, &context) != CONTINUE)
        return;
    annotations(shots, &made);
    (void)annotations_make(&made, 0, shots->state.steps ? 0 : -1, image,
                           context, &overlay);
    snow_overlay_free(overlay);
    snow_context_free(context);
}

/* Prints the settings that were chosen automatically, as render does, for all
 * frames. */
static void report_choices(shot_renderer *shots, snow_image *image) {
    const options *opts = shots->state.opts;
    char text[1024];
    render_state_choices(&shots->state, text, sizeof text);
    if (opts->verbosity >= 0)
        say("%s%s; %" PRId64 " frame%s of %lldx%lld to %s", text,
            shots->painted.words, shots->count, shots->count == 1 ? "" : "s",
            (long long)opts->size[0], (long long)opts->size[1], opts->output);
    /* An empty first step says nothing about later ones, so only a turntable
     * warns. */
    warn_picture(&shots->state, shots->state.turns ? image : NULL);
    annotations_report(opts);
    report_legend(shots, image);
    render_state_note(&shots->state, shots->painted.range);
}

static int begin(void *self, const movie_shot *shot) {
    shot_renderer *shots = self;
    int done = shots_volume(shots, shot);
    return done == CONTINUE ? render_state_begin(&shots->state, shot->azimuth)
                            : done;
}

static int finish_shot(void *self, snow_image **image) {
    shot_renderer *shots = self;
    int done = render_state_finish(&shots->state, image);
    if (done == CONTINUE)
        done =
            paint_values(shots->state.opts, shots->state.context,
                         shots->state.transfer, true, image, &shots->painted);
    if (done != CONTINUE)
        return done;
    if (!shots->drawn)
        report_choices(shots, *image);
    shots->drawn = true;
    return CONTINUE;
}

static const snow_image *depth(void *self) {
    const shot_renderer *shots = self;
    return shots->state.opts->depth ? snow_frame_depth(shots->state.frame)
                                    : NULL;
}

static void report_picture(void *self, render_report *out) {
    const shot_renderer *shots = self;
    *out = render_state_report(&shots->state);
}

static double time_of(void *self) {
    const shot_renderer *shots = self;
    return shots->state.drawn.whole.time_value;
}

static int share_word(void *self, int word) {
    (void)self;
    return process_share(word);
}

movie_renderer shots_renderer(shot_renderer *shots) {
    return (movie_renderer){.self = shots,
                            .begin = begin,
                            .finish = finish_shot,
                            .ahead = process_ranks() > 1,
                            .depth = depth,
                            .report = report_picture,
                            .annotations = annotations,
                            .time = time_of,
                            .share = share_word,
                            .writes = process_talks(),
                            .ranks = process_ranks()};
}
