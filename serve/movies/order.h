/* order.h - the movie that a page orders: a turn around the volume, or its time
 * steps.
 *
 *   {"t": "ask", "what": "movie", "kind": "turntable", "frames": 120,
 *    "fps": 25, "size": [1280, 720], "format": "mp4", "tag": "k3f9",
 *    "overwrite": true}
 *   {"t": "ask", "what": "movie", "kind": "movie", "first": 0, "last": 9}
 *
 * `kind` is the verb of the tool.  What is left out is as the tool has it, and
 * the size that of the page; so nothing takes the place of a movie that is
 * there without "overwrite".  Nothing here touches a socket or a file. */
#ifndef MOVIES_ORDER_H
#define MOVIES_ORDER_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

/* A server that many use writes no longer or larger ones: of all frames
 * together so many pixels, 2,000 of 1920 x 1080. */
#define ORDER_FRAMES_MOST 3600
#define ORDER_FRAMES_USUAL 120
#define ORDER_PIXELS_MOST (INT64_C(1) << 32)
#define ORDER_TAG_BYTES 40

typedef struct movie_order {
    bool steps;          /* time steps, else a turn */
    int64_t frames;      /* of all */
    int64_t first, last; /* steps; last -1: none given */
    double fps;          /* 0: not given */
    int64_t width, height;
    bool overwrite;
    const char *format;        /* "mp4" */
    char tag[ORDER_TAG_BYTES]; /* by which the page knows its own */
    char fault[160];
} movie_order;

/* The formats, "mp4" first; NULL: no more. */
const char *order_format(size_t index);

/* Reads an order for a file of so many time steps.  False, and `fault` says
 * why, where a key is not known or a value is wrong. */
bool order_read(const json_t *tree, int64_t times, movie_order *out);

#endif
