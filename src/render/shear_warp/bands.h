/* render/shear_warp/bands.h - what both halves of the sheared method do with
 * the pixels of a band beside drawing on them: cut tiles, and groups of slices.
 */
#ifndef SNOW_RENDER_SHEAR_WARP_BANDS_H
#define SNOW_RENDER_SHEAR_WARP_BANDS_H

#include "decompose/deterministic.h"
#include "transform/clip.h"

/* --- cut tiles ------------------------------------------------------------
 *
 * Where the border of a part (transform/clip.h) crosses a tile, the tile is
 * drawn as any other, and pixels beyond the border get back what they held. */

/* A tile of `width` pixels, whose rows of `lines` lines are drawn or not. */
typedef struct snow_cut_tile {
    float *pixels;
    size_t stride; /* floats from line to line */
    int width, lines, channels;
    int x0, x1, y0, y1; /* what may be drawn, within the tile */
    float *kept;        /* room for all of the tile */
} snow_cut_tile;

/* Keeps the lines of some rows; afterwards puts back what is beyond the border,
 * and leaves out of the `finished` rows those where something shines through
 * again. */
void snow_cut_keep(const snow_cut_tile *tile, uint64_t rows);
uint64_t snow_cut_restore(const snow_cut_tile *tile, uint64_t rows,
                          uint64_t finished);

/* --- groups of slices ----------------------------------------------------- */

/* The pixels of one band of an intermediate image.  Where a tile was not drawn
 * on they are anything while groups are combined, and 0 in the end. */
typedef struct snow_band {
    float *pixels;
    unsigned char *drawn; /* per tile */
} snow_band;

/* Its shape. */
typedef struct snow_band_shape {
    int64_t tiles;
    int width; /* of a tile, pixels */
    int lines, channels;
    size_t stride; /* floats from line to line */
} snow_band_shape;

/* How slices of a picture are grouped (decompose/deterministic.h). */
typedef struct snow_grouping {
    bool on;
    snow_group_node nodes[SNOW_NODES_MOST];
    int node_count; /* 1 where off */
    int64_t slices; /* of the whole */
    snow_slab slab; /* that is drawn */
    int step;       /* slices drawn for one of these: 1, or 2 */
    int64_t drawn;  /* slices that are drawn in all */
    bool rising;    /* slice 0 is the nearest */
} snow_grouping;

/* Off, or as the slab asks.  Errors: SNOW_STATUS_BAD_USAGE (a slab that is not
 * of whole groups). */
snow_status snow_grouping_make(snow_context *context, int64_t slices,
                               snow_slab slab, int step, int64_t drawn,
                               bool rising, bool on, snow_grouping *out);

/* Draws slices first .. first + count - 1 of those that are drawn into a band,
 * where the lowest is number 0, marking tiles. */
typedef void snow_draw_fn(void *stroke, int64_t first, int64_t count,
                          const snow_band *band);

/* Lays the bands that groups are combined in, of so many floats and tiles, out
 * in a block (snow_lay_out), where the grouping is on. */
void snow_grouping_lay_out(const snow_grouping *grouping, size_t floats,
                           int64_t tiles, char *base, size_t *at,
                           snow_band spare[SNOW_GROUP_RANKS]);

/* Draws all slices into a band of an image, or where the grouping is on each
 * node into its layer.  `lazy`: the drawing clears each tile before it lays
 * anything on it. */
struct snow_shear_warp_image;
void snow_band_draw(const snow_grouping *grouping,
                    const struct snow_shear_warp_image *image, bool lazy,
                    const snow_band_shape *shape, snow_draw_fn *draw,
                    void *stroke, const snow_band *spare,
                    const snow_band *band);

/* Clears a tile that nothing was laid on yet (composite/tile.h). */
void snow_band_clear_tile(const snow_band_shape *shape, const snow_band *band,
                          int64_t tile);

#endif
