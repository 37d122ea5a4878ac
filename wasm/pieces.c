/* pieces.c - implements pieces.h. */
#include "pieces.h"

#include "commands/commands.h"
#include "render/picture.h"
#include "run/log.h"

#include <string.h>

#define PIECES 8

/* The picture that is begun, with what it was begun for. */
static struct {
    json_t *tree; /* NULL: no picture is begun */
    int size[2];
    snow_image *whole; /* its first `lines` lines are drawn */
    int lines;
    uint64_t pictures; /* of the frame, after the last piece */
    double seconds;
} begun;

/* Returns whether a picture can be drawn in pieces.  Some have pixels that
 * depend on other lines, or on slabs of a file.  A deterministic picture draws
 * all its tiles each time, and a projection of channels is a sum of several
 * pictures.
 */
static bool has_pieces(const drawing *d) {
    const snow_settings *settings = &d->state.settings;
    return settings->quality == SNOW_QUALITY_HIGH && d->state.frame &&
           !d->state.plan.streams && settings->occlusion == 0 &&
           settings->depth_darkening == 0 && !settings->deterministic &&
           !(d->state.channels.list.count &&
             mode_is_projection(d->state.opts->mode));
}

/* Frees what is begun. */
static void forget(void) {
    json_decref(begun.tree);
    snow_image_free(begun.whole);
    memset(&begun, 0, sizeof begun);
}

/* Begins the picture of the drawing, unless it is begun already. */
static void begin(const drawing *d) {
    const snow_view *view = &d->state.view;
    if (begun.tree && begun.size[0] == view->width &&
        begun.size[1] == view->height && json_equal(begun.tree, d->tree))
        return;
    forget();
    begun.tree = json_incref(d->tree);
    begun.size[0] = view->width;
    begun.size[1] = view->height;
}

/* Copies the lines that `part` has up to `end` to the whole picture. */
static int keep_lines(drawing *d, snow_image *part, int end) {
    const int channels = snow_image_channels(part);
    const size_t line = (size_t)begun.size[0] * (size_t)channels;
    const size_t from = (size_t)begun.lines * line;
    if (!begun.whole &&
        snow_image_new(d->state.context, begun.size[0], begun.size[1], channels,
                       &begun.whole) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(snow_image_pixels(begun.whole) + from,
           snow_image_pixels(part) + from,
           (size_t)(end - begun.lines) * line * sizeof(float));
    begun.lines = end;
    return CONTINUE;
}

/* Draws the next piece.  Where memory was too short for what the frame held,
 * its successor, which knows no pieces, has drawn all lines: these are *image.
 */
static int draw_piece(drawing *d, snow_image **image) {
    render_state *state = &d->state;
    snow_frame *frame = state->frame;
    snow_image *part = NULL;
    const int height = begun.size[1];
    const int next = begun.lines + (height + PIECES - 1) / PIECES;
    const int end = next < height ? next : height;
    const uint64_t dropped = state->frames_dropped;
    frame->lines[0] = begun.lines;
    frame->lines[1] = end;
    frame->more = begun.lines > 0 && frame->pictures == begun.pictures;
    int done = render_state_draw(state, state->view.azimuth, &part);
    if (state->frames_dropped != dropped) {
        *image = part;
        return done;
    }
    if (done == CONTINUE)
        done = keep_lines(d, part, end);
    snow_image_free(part);
    memset(frame->lines, 0, sizeof frame->lines);
    frame->more = false;
    begun.pictures = frame->pictures;
    return done;
}

/* Draws one piece, and returns as if it was stopped until the last is drawn. */
static int draw(drawing *d, snow_image **image) {
    d->earlier_seconds = 0;
    *image = NULL;
    if (!has_pieces(d)) {
        forget();
        return render_state_draw(&d->state, d->state.view.azimuth, image);
    }
    begin(d);
    const double start = seconds_now();
    int done = draw_piece(d, image);
    const double took = seconds_now() - start;
    if (done == CONTINUE && !*image && begun.lines < begun.size[1]) {
        begun.seconds += took;
        return EXIT_INTERRUPTED;
    }
    if (done == CONTINUE && !*image) {
        *image = begun.whole;
        begun.whole = NULL;
    }
    d->earlier_seconds = done == CONTINUE ? begun.seconds : 0;
    forget();
    return done;
}

void pieces_begin(drawing *d) {
    d->draw = draw;
}
