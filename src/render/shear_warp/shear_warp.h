/* render/shear_warp/shear_warp.h - the sheared method: figure 8 of the paper
 * with slices that are moved instead of footprints that are turned. */
#ifndef SNOW_RENDER_SHEAR_WARP_SHEAR_WARP_H
#define SNOW_RENDER_SHEAR_WARP_SHEAR_WARP_H

#include "base/line_batch.h"
#include "composite/over.h"
#include "decompose/deterministic.h"
#include "transform/clip.h"

#include <snowglass/render.h>

/* Everything that is kept from picture to picture. */
typedef struct snow_shear_warp snow_shear_warp;

/* Unless *out is there already.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_shear_warp_new(snow_context *context, snow_shear_warp **out);
void snow_shear_warp_free(snow_shear_warp *shear_warp);

/* Data values as numbers of 0 to 1: (value - from) / step. */
typedef struct snow_value_scale {
    double from, step; /* step may be negative, not 0 */
} snow_value_scale;

/* What a picture is made of; settings are resolved. */
typedef struct snow_shear_warp_params {
    const snow_volume *volume;
    const snow_transfer *transfer;
    const snow_view *view;
    const snow_settings *settings;
    const snow_placement *placement; /* of the whole */
    snow_clip clip;                  /* of the volume's part */
    snow_slab slab;  /* slices of the whole that are drawn, within the part */
    int channels;    /* 2 or 4 */
    double begin_at; /* 0 to below 1: the share of the image's lines before the
                        one that is drawn first */
    snow_composite_fn
        *composite; /* in perspective, in the place of over; NULL: over */
    float share;    /* of the image that it makes, so that sums, too, are of
                       0 to 1 */
} snow_shear_warp_params;

/* The intermediate image of a part.  Where a tile was not drawn on, its pixels
 * are anything until snow_shear_warp_clear.  A deterministic one has a layer
 * for each of some nodes of the tree of groups (decompose/deterministic.h). */
typedef struct snow_shear_warp_image {
    int width, height, channels; /* 0 x 0: nothing is in view */
    float *pixels;        /* of the frame's, until it draws there again */
    size_t stride;        /* floats from line to line */
    unsigned char *drawn; /* per tile, line of tiles by line of tiles */
    int tile_width, tile_height, tiles; /* pixels; tiles of a line */
    int layers;                         /* 1, or as many as nodes */
    snow_group_node nodes[SNOW_NODES_MOST];
    size_t layer_floats, layer_tiles; /* from layer to layer */
    const struct snow_shear_warp_warping *warping;
} snow_shear_warp_image;

/* Whether the method can make this picture.  Where a kernel, widened for
 * pixels that are many voxels wide, has more than SNOW_TAPS_MOST voxels in
 * reach, it is left to footprint splatting, which has few pixels to fill
 * then. */
bool snow_shear_warp_fits(const snow_placement *placement,
                          const snow_settings *settings);

/* Lines 04 to 06, unless the bands hold that already: colours, light and the
 * camera may change as they like as long as the slice axis stays, and what is
 * shown may become less (encoding_cache.h).  Errors: SNOW_STATUS_BAD_USAGE,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_shear_warp_encode(snow_shear_warp *shear_warp,
                                   const snow_shear_warp_params *params,
                                   snow_stats *stats);

/* Lines 07 to 13, of what is encoded: begins, and describes the image, whose
 * bands are then drawn as a batch (base/line_batch.h); it is there after its
 * end.  The order stays until then; its volume and transfer function need not.
 * One image of a context at a time is drawn; the one before it stays as it is
 * where `aside` asks for the other place of two.  All parts have images of one
 * size. */
snow_status snow_shear_warp_begin(snow_shear_warp *shear_warp,
                                  const snow_shear_warp_params *params,
                                  bool aside, snow_stats *stats,
                                  snow_shear_warp_image *out);
snow_line_batch *snow_shear_warp_batch(snow_shear_warp *shear_warp);

/* Clears what was not drawn on of tiles x0 .. x1 - 1 of tile lines y0 .. y1 - 1
 * of a layer. */
void snow_shear_warp_clear(const snow_shear_warp_image *image, int layer,
                           int x0, int y0, int x1, int y1);

/* Warps the image of a single layer to all of the picture; `pixels` are width *
 * height * channels floats, all of which are written. */
snow_status snow_shear_warp_show(const snow_shear_warp_image *image,
                                 const snow_shear_warp_params *params,
                                 float *pixels, snow_stats *stats);

/* Makes all of an image's first layer empty, for lines that others made: */
void snow_shear_warp_empty(const snow_shear_warp_image *image);

/* puts `count` packed lines from `first` on in their places. */
void snow_shear_warp_put_lines(const snow_shear_warp_image *image, int first,
                               int count, const float *pixels);

/* Pixels of a line of the picture whose place in the image is in its lines
 * first .. end - 1: x range[0] .. range[1] - 1.  Of lines that follow one
 * another each pixel is in one range. */
void snow_shear_warp_pixels_of(const snow_shear_warp_image *image, int y,
                               int first, int end, int range[2]);

/* The same of a kernel of 4 lines (warping.h). */
#define SNOW_WARP_BEFORE 2
#define SNOW_WARP_BEHIND 3

/* Warps the image, or what was put in its place, to pixels `from` to `to` - 1
 * of line y of the picture, whose pixel 0 is the first of `pixels`; or, of the
 * shear-warp method, to all of it.  `spare` has warping->spare_floats. */
void snow_shear_warp_warp(const snow_shear_warp_image *image, int y, int from,
                          int to, float *spare, float *pixels);
snow_status snow_shear_warp_warp_all(snow_context *context,
                                     const snow_shear_warp_image *image,
                                     int threads, float *pixels);

#endif
