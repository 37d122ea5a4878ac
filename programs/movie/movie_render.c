/* movie_render.c - the renderer of a sequence.  It keeps a volume as long as
 * shots use it, one transfer function, and one frame whose buffers and encoding
 * are reused. */
#include "movie/movie_render.h"
#include "commands/commands.h"
#include "picture/warnings.h"
#include "run/log.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

int shots_open(const options *opts, shot_renderer *out) {
    *out = (shot_renderer){.count = 0};
    const int done = render_state_new(opts, &out->state);
    out->state.one_look = true;
    return done;
}

void shots_close(shot_renderer *shots) {
    free(shots->begun[0]);
    free(shots->begun[1]);
    free(shots->measured);
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
    if (done == CONTINUE && s->turns)
        done = render_state_measure(s, false);
    return done == CONTINUE
               ? shots_check(shots, name_of_input(shot->path), &s->whole)
               : done;
}

picture_annotations shots_annotations(const shot_renderer *shots) {
    const render_state *s = &shots->state;
    return (picture_annotations){
        s->opts,
        s->drawn.whole,
        s->view,
        s->transfer,
        {shots->painted.range[0], shots->painted.range[1]},
        &s->channels,
        layers_legend(&s->layers, s->each_time && shots->count > 1),
        .measures = s->steps ? shots->measured : s->measures};
}

/* Frames are annotated elsewhere and silently: what one has no room for is said
 * here. */
static void report_legend(shot_renderer *shots, const snow_image *image) {
    const options *opts = shots->state.opts;
    snow_context *context = NULL;
    snow_overlay *overlay = NULL;
    const bool any = opts->legend.scale || opts->title || opts->annotate.text;
    if (!any || !image || open_context(opts, &context) != CONTINUE)
        return;
    const picture_annotations made = shots_annotations(shots);
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

int shots_begin(shot_renderer *shots, const movie_shot *shot) {
    if (shots->draw)
        return shots->draw(shots->user, shot, &shots->made);
    render_state *s = &shots->state;
    int done = shots_volume(shots, shot);
    if (done == CONTINUE && s->steps)
        done = render_state_measure(s, false);
    if (done == CONTINUE)
        done = render_state_begin(s, shot->azimuth);
    if (done != CONTINUE || !s->steps)
        return done;
    shots->begun[shots->in_flight++] = s->measures;
    s->measures = NULL;
    return CONTINUE;
}

/* Those of the frame that was begun first. */
static void take_measures(shot_renderer *shots) {
    if (!shots->in_flight)
        return;
    free(shots->measured);
    shots->measured = shots->begun[0];
    shots->begun[0] = shots->begun[1];
    shots->begun[1] = NULL;
    shots->in_flight--;
}

int shots_finish(shot_renderer *shots, snow_image **image) {
    if (shots->draw) {
        *image = shots->made;
        shots->made = NULL;
        return CONTINUE;
    }
    int done = render_state_finish(&shots->state, image);
    take_measures(shots);
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
