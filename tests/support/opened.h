/* tests/support/opened.h - a file that many ranks open, and what each of them
 * draws with. */
#ifndef SNOW_TEST_SUPPORT_OPENED_H
#define SNOW_TEST_SUPPORT_OPENED_H

#include "support/comm.h"

#include <snowglass/ranks.h>

/* What all ranks ask for. */
typedef struct opened_request {
    const char *path;
    snow_volume_options options;
    snow_look look; /* its size 0: automatic */
    snow_view view; /* of the first picture */
    snow_settings settings;
    snow_ranks_options how;
} opened_request;

/* Of one rank. */
typedef struct opened {
    snow_comm *comm;
    const opened_request *request;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
} opened;

/* Nothing is left where it fails. */
snow_status opened_enter(snow_comm *comm, const opened_request *r, opened *out);
void opened_leave(opened *o);

/* A picture from another view, for which parts are cut anew where they must be;
 * *image is NULL on other ranks than 0. */
snow_status opened_cut(opened *o, const snow_view *view);
snow_status opened_draw(opened *o, const snow_view *view, snow_image **image);

#endif
