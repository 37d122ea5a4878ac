/* small.h - small pictures beside the large one, each with a frame of its own:
 * that of the large one keeps its encoding. */
#ifndef SMALL_H
#define SMALL_H

#include "draw/drawing.h"

/* Renders, by all ranks where there are many, which then have neighbours'
 * voxels enough.  The frame, which has the depths, and the picture are the
 * caller's; the picture is NULL on all ranks but the first. */
snow_status small_render(drawing *d, const snow_transfer *transfer,
                         const snow_view *view, const snow_settings *settings,
                         snow_frame **frame, snow_image **image);

/* What is shown in place of the look. */
typedef struct thumbnail {
    const char *preset;   /* "": none */
    const char *colormap; /* in place of its colours; NULL: these */
    bool mip;             /* as a maximum projection */
    double ground[3];     /* is set: what suits the colours behind it */
} thumbnail;

/* A picture, unless `stop` says so: EXIT_INTERRUPTED. */
int small_thumbnail(drawing *d, thumbnail *of, int side, snow_stop_fn *stop,
                    void *user, snow_image **image);

#endif
