/* render/value/internal.h - what the value path keeps from picture to picture.
 */
#ifndef SNOW_RENDER_VALUE_INTERNAL_H
#define SNOW_RENDER_VALUE_INTERNAL_H

#include "render/value/value.h"

/* What the encoding is of. */
typedef struct snow_value_key {
    uint64_t generation; /* of the volume; 0: of none */
    int slice_axis;
    snow_value_scale14 scale;
    snow_encoding encoding; /* as asked for */
} snow_value_key;

/* How tiles lie in the plane.  As long as that stays, only the tiles that were
 * drawn have to be cleared. */
typedef struct snow_value_grid {
    int cells[2], tiles[2]; /* the latter may be more than a picture has */
    int channels;
    bool quincunx;
} snow_value_grid;

struct snow_value_path {
    snow_context *context;
    snow_value_lattice lattice; /* of the picture */
    snow_data_range range;
    uint64_t range_of; /* generation of its volume; 0: of none */
    snow_value_coder coder;
    snow_value_table table;
    snow_value_store store;
    snow_value_key key; /* of the store */
    int64_t interesting;
    snow_value_light light;
    snow_value_fade fade;
    snow_value_sheet *sheets;
    snow_value_place *places;
    snow_value_rays rays; /* perspective: instead of places */
    snow_value_spread *spreads;
    snow_value_lanes *lanes[2];
    float *plane;          /* the image on the lattice */
    snow_value_grid grid;  /* of it; no tiles: anything is there */
    unsigned char *drawn;  /* its tiles */
    unsigned char *blocks; /* its blocks, of a quincunx */
    float *halved, *lines; /* the image made smaller; lines of the warp */
    double (*clips)[4];    /* clip planes by u, v and slice */
    char *scratch;
    size_t sheets_capacity, places_capacity, spreads_capacity,
        lanes_capacity[2], plane_capacity, drawn_capacity, blocks_capacity,
        halved_capacity, lines_capacity, clips_capacity,
        scratch_capacity; /* bytes */
};

/* In perspective: the rays of the sheets, which are there.  Errors:
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED. */
snow_status snow_value_place_rays(snow_value_path *path,
                                  const snow_value_params *params);

/* The image to all of the picture.  Errors: SNOW_STATUS_NO_MEMORY,
 * SNOW_STATUS_STOPPED. */
snow_status snow_value_show(snow_value_path *path,
                            const snow_value_params *params,
                            const snow_intermediate_view *image, float *pixels);

#endif
