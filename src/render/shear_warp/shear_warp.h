/* render/shear_warp/shear_warp.h - the method shear-warp: figure 8 of the paper
 * with slices that are moved instead of footprints that are turned.  Resampled
 * slices of values are splatted, and slabs between them coloured. */
#ifndef SNOW_RENDER_SHEAR_WARP_SHEAR_WARP_H
#define SNOW_RENDER_SHEAR_WARP_SHEAR_WARP_H

#include "base/line_batch.h"
#include "composite/bytes.h"
#include "render/shear_warp/intermediate.h"
#include "render/shear_warp/lattice.h"
#include "transform/clip.h"
#include "volume/stream.h"

/* Data values as values of 0 to 1: (value - from) / step. */
typedef struct snow_value_scale {
    double from, step; /* step may be negative, not 0 */
} snow_value_scale;

/* Everything that is kept from picture to picture. */
typedef struct snow_value_path snow_value_path;

/* Unless *out is there already.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_path_new(snow_context *context, snow_value_path **out);
void snow_value_path_free(snow_value_path *path);

/* What a picture, or a part of it, is made of; settings are resolved. */
typedef struct snow_value_params {
    const snow_volume *volume;               /* may be a part, with ghosts */
    const snow_transfer *transfer, *counted; /* the latter: for statistics */
    const snow_view *view;
    const snow_settings *settings;
    const snow_placement *placement; /* of the whole */
    const snow_placement *stored;    /* of the voxels that the volume has */
    const snow_clip *clip; /* what of the whole it has and answers for */
    snow_slab slab; /* slices of the whole that are drawn, within these */
    int channels;   /* 2 or 4 */
    const snow_layer *layers; /* other volumes, of the same grid, or files */
    int layer_count;
    bool shared;  /* with other ranks: the image's size depends on the picture
                     alone, and a deterministic one has a layer for each node */
    bool aside;   /* the image of the picture before is still needed */
    bool resumes; /* draws behind the parts that were drawn before */
    double begin_at; /* 0 to below 1: the share of the image's lines before the
                        one that is drawn first */
    const snow_bytes *bytes; /* what is shown goes there; NULL: to floats */
    int lines[2]; /* of the picture that are drawn: the first, and an end */
    bool more;    /* of the same picture as the last ones */
} snow_value_params;

/* The finite values of a volume, or their logarithms, of which those in a file
 * are read, or of the part of one that it is; and its labels, if it has some.
 * Unless they are known.  Errors: as snow_slabs_visit; SNOW_STATUS_BAD_USAGE
 * (too many labels).  Modes other than over are of data values: `transfer` is
 * NULL. */
snow_status snow_value_measure(snow_value_path *path, const snow_volume *volume,
                               const snow_transfer *transfer, int threads,
                               snow_data_range *out);

/* Makes the range of the whole known, which the pictures' quantized values are
 * of. Labels are a part's own, in the same order as the whole's. */
void snow_value_set_range(snow_value_path *path, const snow_data_range *range);

/* The same of a layer; makes those of all layers known, none perhaps. */
snow_status snow_value_measure_layer(snow_value_path *path, int n,
                                     const snow_layer *given, int threads,
                                     snow_data_range *out);
snow_status snow_value_set_layers(snow_value_path *path,
                                  const snow_data_range *ranges, int count);

/* Begins a picture, whose parts follow: its lattice, the table of colours, and
 * room for its image.  Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY,
 * SNOW_STATUS_STOPPED. */
snow_status snow_value_begin(snow_value_path *path,
                             const snow_value_params *params,
                             snow_stats *stats);

/* Tables and encodings of a part's layers, and what is to be drawn of them,
 * before it is drawn.  Errors: as above. */
snow_status snow_value_encode_layers(snow_value_path *path,
                                     const snow_value_params *params);
snow_status snow_value_place_layers(snow_value_path *path,
                                    const snow_value_params *params);

/* Gives up the encoding, so that a part's has its memory. */
void snow_value_forget(snow_value_path *path);

/* The encoding of a part, unless it is there.  Errors: as above. */
snow_status snow_value_encode(snow_value_path *path,
                              const snow_value_params *params,
                              snow_stats *stats);

/* Slabs of a file whose encodings are kept while memory lasts, so that the next
 * pictures along the same axis read nothing.  Slabs are cut as these were;
 * those of other volumes or along another axis are dropped, and others until
 * there is room for what is read. */
void snow_value_cut_slabs(snow_value_path *path,
                          const snow_value_params *params, snow_slab_cut *cut);
void snow_value_forget_slabs(snow_value_path *path);

/* Returns whether memory was too small, and there is more: what was kept is
 * gone. */
bool snow_value_lacks_memory(snow_value_path *path, snow_status status);

/* Drops encodings until a limit leaves so many bytes, as for the exchange of
 * the image among ranks. */
void snow_value_leave_memory(snow_value_path *path, uint64_t bytes);
uint64_t snow_value_exchange_bytes(const snow_value_path *path);

/* What was kept of a part that stores so many slices, of the whole's params, if
 * that serves; else NULL. */
const snow_volume *snow_value_kept(snow_value_path *path,
                                   const snow_value_params *params,
                                   const snow_extent *part, int64_t slices);

/* Keeps the slab that was drawn, if there is room for the next beside it. */
void snow_value_keep(snow_value_path *path, const snow_value_params *params,
                     snow_slabs *slabs);

/* Then the part's image on the lattice of the whole.  A deterministic one has a
 * layer for each of some nodes of the tree of groups.  With `batch`, which is
 * NULL as yet, it is left to be drawn, unless nothing is in view; what params
 * point to stays until its end then, but for volume and transfer function.
 * Errors: as above. */
snow_status snow_value_draw(snow_value_path *path,
                            const snow_value_params *params, snow_stats *stats,
                            snow_shear_warp_image *out,
                            snow_line_batch **batch);

/* What the values from 0 to 1 of a projection's pixels stand for, when it is
 * begun. */
snow_value_scale snow_value_projected(const snow_value_path *path,
                                      snow_mode mode);

/* The image of one layer to all of the picture: width * height * channels
 * floats; of projections (value, 1) or (0, 0), or less where a pixel is not
 * wholly of one.  Errors: as above. */
snow_status snow_value_display(snow_value_path *path,
                               const snow_value_params *params,
                               const snow_shear_warp_image *image,
                               float *pixels, snow_stats *stats);

#endif
