/* pieces.c - implements pieces.h. */
#include "pieces.h"

#include "commands/commands.h"
#include "render/picture.h"
#include "run/log.h"

#include <string.h>

#define PIECES 8

/* The picture that is begun, with what it was begun for. */
static struct {
    json_t *tree; /* NULL: none */
    int size[2];
    snow_image *whole; /* as far as it is drawn */
    int lines;         /* that are */
    uint64_t pictures; /* of the frame, after the last piece */
    double seconds;
} begun;

/* Pixels of some depend on other lines, or on slabs of a file. */
static bool has_pieces(const drawing *d) {
    const snow_settings *settings = &d->state.settings;
    return settings->quality == SNOW_QUALITY_HIGH && d->state.frame &&
           !d->state.plan.streams && settings->occlusion == 0 &&
           settings->depth_darkening == 0;
}

static void forget(void) {
    json_decref(begun.tree);
    snow_image_free(begun.whole);
    memset(&begun, 0, sizeof begun);
}

/* Unless it is begun already. */
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

/* Lines of a picture of the frame to the whole. */
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

static int draw_piece(drawing *d) {
    render_state *state = &d->state;
    snow_frame *frame = state->frame;
    snow_image *part = NULL;
    const int height = begun.size[1];
    const int end = begun.lines + (height + PIECES - 1) / PIECES;
    frame->lines[0] = begun.lines;
    frame->lines[1] = end < height ? end : height;
    frame->more = begun.lines > 0 && frame->pictures == begun.pictures;
    int done = render_state_draw(state, state->view.azimuth, &part);
    if (done == CONTINUE)
        done = keep_lines(d, part, frame->lines[1]);
    snow_image_free(part);
    if (state->frame != frame) /* there was no room for both */
        return done == CONTINUE ? SNOW_STATUS_NO_MEMORY : done;
    memset(frame->lines, 0, sizeof frame->lines);
    frame->more = false;
    begun.pictures = frame->pictures;
    return done;
}

/* As if stopped, until the last piece is drawn. */
static int draw(drawing *d, snow_image **image) {
    d->elsewhere = 0;
    if (!has_pieces(d)) {
        forget();
        return render_state_draw(&d->state, d->state.view.azimuth, image);
    }
    begin(d);
    const double start = seconds_now();
    int done = draw_piece(d);
    const double took = seconds_now() - start;
    if (done == CONTINUE && begun.lines < begun.size[1]) {
        begun.seconds += took;
        return EXIT_INTERRUPTED;
    }
    if (done == CONTINUE) {
        *image = begun.whole;
        begun.whole = NULL;
        d->elsewhere = begun.seconds;
    }
    forget();
    return done;
}

void pieces_begin(drawing *d) {
    d->draw = draw;
}
