/* drawing.h - makes pictures of a recipe by the very functions of
 * `snowglass render`, so that the command of a recipe makes the same bytes.
 *
 * Of the volume, the look and the view only that is made anew which a recipe
 * changes. */
#ifndef DRAWING_H
#define DRAWING_H

#include "picture/render_state.h"

#include <jansson.h>

typedef struct drawing {
    options first; /* as of the command line */
    options opts;  /* of the present recipe */
    json_t *tree;
    render_state state;
    char *data_key, *look_key; /* what volume and look were made of */
    snow_volume *base; /* the volume without clip planes, while these move; or
                          NULL */
    char *base_key;    /* what it was made of */
    bool volume_is_new, look_is_new; /* since the caller last looked */
} drawing;

/* Opens the volume of the command line.  Returns CONTINUE or an exit code, as
 * all functions here do. */
int drawing_open(const options *first, json_t *recipe, drawing *out);
void drawing_close(drawing *d);

/* Makes what a recipe needs, whose tree stays the caller's. */
int drawing_apply(drawing *d, const json_t *recipe);

/* The middle of the volume, and from there to its farthest corner: what zoom 1
 * shows (snowglass/view.h). */
void drawing_middle(const drawing *d, double middle[3], double *radius);

/* Frames what the look shows, from the sides of a turn: keys that set the
 * camera's target and zoom, a new reference. */
json_t *drawing_fit(drawing *d);

/* Renders with a quality at a size of 1 / 2^shrink of the recipe's, unless
 * `stop` says so: SNOW_STATUS_STOPPED.  With values painted. */
int drawing_render(drawing *d, snow_quality quality, int shrink,
                   snow_stop_fn *stop, void *user, snow_image **image,
                   snow_overlay **overlay);

/* A small picture with a preset in place of the look, or with none, unless
 * `stop` says so: EXIT_INTERRUPTED. */
int drawing_thumbnail(drawing *d, const char *preset, int side,
                      snow_stop_fn *stop, void *user, snow_image **image);

/* The whole recipe of the picture at rest, for --config: with what only the
 * command line can set.  NULL: no memory. */
json_t *drawing_recipe(const drawing *d);

/* The command that makes the picture at rest, to be freed. */
char *drawing_command(const drawing *d);

#endif
