/* sheared_parts.h - what the sheared method keeps from picture to picture, for
 * its parallel (sheared.c) and its perspective half (sheared_seen.c). */
#ifndef SNOW_SHEARED_PARTS_H
#define SNOW_SHEARED_PARTS_H

#include "base/parallel.h"
#include "classify/sample.h"
#include "composite/tile.h"
#include "encode/windows.h"
#include "sheared.h"
#include "sheared_bands.h"
#include "sheared_reuse.h"
#include "warp/warp.h"

/* Whether something shines through any of a band's tiles. */
static inline bool snow_any_alive(const uint64_t *alive, int64_t tiles) {
    for (int64_t tile = 0; tile < tiles; tile++)
        if (alive[tile])
            return true;
    return false;
}

/* Rows that cells need: cell i needs rows i * stride to i * stride + reach - 1.
 */
static inline uint64_t snow_rows_of_cells(uint64_t cells, int stride,
                                          int reach) {
    uint64_t rows = 0, needed = ~UINT64_C(0) >> (64 - reach);
    if (stride == 1) {
        for (int m = 0; m < reach; m++)
            rows |= cells << m;
        return rows;
    }
    for (; cells; cells &= cells - 1)
        rows |= needed << __builtin_ctzll(cells) * stride;
    return rows;
}

/* Those of `cells` that need any of the rows. */
static inline uint64_t snow_cells_of_rows(uint64_t rows, uint64_t cells,
                                          int stride, int reach) {
    uint64_t any = 0, some = 0;
    for (int m = 0; m < reach; m++)
        any |= rows >> m;
    if (stride == 1)
        return cells & any;
    for (; cells; cells &= cells - 1) {
        int cell = __builtin_ctzll(cells);
        some |= (any >> cell * stride & 1) << cell;
    }
    return some;
}

/* How the image of a picture is warped. */
typedef struct snow_sheared_warping {
    snow_plane plane;
    bool perspective;
    snow_shear shear;   /* or */
    snow_scaled scaled; /* in perspective */
    snow_filter filter;
    snow_warp_fn *warp;
    snow_warp_places_fn *places; /* in perspective */
    int width, height;           /* of the picture */
} snow_sheared_warping;

/* An intermediate image, and how it is warped. */
typedef struct snow_canvas {
    float *plane;
    unsigned char *drawn;                  /* per band and tile */
    size_t plane_capacity, drawn_capacity; /* bytes */
    snow_sheared_warping warping;
} snow_canvas;

/* What the bands in memory were encoded from. */
typedef struct snow_encoded_key {
    uint64_t serial; /* of the volume; 0: nothing is encoded */
    int slice_axis;
    bool shaded, between, faded;
    bool numbers; /* of sums and largest values: no voxel more may be there */
    snow_encoding encoding; /* as asked for */
    double threshold;       /* where opacity depends on gradients, else 0: the
                               coder tells */
    snow_slab slab;
} snow_encoded_key;

struct snow_sheared {
    snow_context *context;
    snow_coder coder, next; /* of the last picture; room for the next one's */
    snow_bands bands;
    snow_reuse reuse; /* of the bands */
    snow_encoded_key key;
    uint64_t encodings; /* how often the bands were made */
    /* Bounds of the bands' rows (sheared_blocks.c), and of which. */
    uint16_t *blocks;       /* [slice][row][column of blocks] */
    size_t blocks_capacity; /* bytes */
    uint64_t blocks_of;     /* `encodings`; 0: of none */
    bool blocks_hull;       /* for cubic B-splines */
    snow_value_scale blocks_scale;
    snow_opacity_point *fade_key; /* of the bands: the curve of the gradient
                                     opacity, and with a threshold the opacity
                                     function behind it */
    snow_opacity_point *next_fade_key;
    size_t fade_points, fade_key_capacity, next_fade_key_capacity;
    snow_palette palette;
    snow_gloss *gloss;   /* an entry of zeros, and SNOW_NORMALS */
    snow_comb *combs;    /* of all slices, along u and v */
    snow_canvas *canvas; /* that is drawn on: one of these */
    snow_canvas canvases[2];
    char *scratch; /* of all workers */
    void *pass;    /* the picture in the making, of either half */
    /* Its bands (sheared_steps.c): how one is drawn, the first that is, and
     * which are finished. */
    snow_batch batch;
    snow_work_fn *draw;
    int64_t band_count, first_band;
    atomic_uchar *finished;
    size_t finished_capacity; /* bytes */
    size_t gloss_capacity, combs_capacity, scratch_capacity,
        pass_capacity; /* bytes */
    /* In perspective: all slices, how they are resampled along u, and how far
     * their kernels reach. */
    struct snow_seen_slice *seen;
    char *teeth;
    double *reach;
    size_t seen_capacity, teeth_capacity, reach_capacity; /* bytes */
};

/* Slices that are drawn of an order: with those between, but for the one behind
 * the volume's last. */
int64_t snow_sheared_slices(const snow_sheared_order *order);

/* Lines 04 to 06, unless the bands hold that already: colours, light and the
 * camera may change as they like as long as the slice axis stays, and what is
 * shown may become less (sheared_reuse.h). */
snow_status snow_sheared_encode(snow_sheared *sheared,
                                const snow_sheared_order *order,
                                snow_stats *stats);

/* What encoding works with of one volume, for as long as it works. */
typedef struct snow_band_tools {
    snow_placement stored; /* of the voxels that it has */
    snow_normal_maker maker;
    snow_fader fader;
} snow_band_tools;

/* How a volume, which is the order's or has a slab of it, is encoded: with all
 * of the slices that the key names.  Points into the tools. */
snow_status
snow_sheared_bands_order(snow_sheared *sheared, const snow_sheared_order *order,
                         const snow_encoded_key *key, const snow_volume *volume,
                         const snow_clip *clip, snow_band_tools *tools,
                         snow_bands_order *out);

/* The bands of a volume whose voxels stay in their file (sheared_stream.c).
 * Errors: SNOW_NO_MEMORY, with how many voxels are interesting; those of
 * snow_slabs_visit. */
snow_status snow_sheared_encode_stream(snow_sheared *sheared,
                                       const snow_sheared_order *order,
                                       const snow_encoded_key *key);

/* The palette of a picture whose rays all run `exponent` reference lengths; in
 * perspective, where they differ, -1.  Errors: SNOW_NO_MEMORY. */
snow_status snow_sheared_classify(snow_sheared *sheared,
                                  const snow_sheared_order *order,
                                  double exponent);

/* The table of shading for a view and light.  Errors: SNOW_NO_MEMORY. */
snow_status snow_sheared_shade(snow_sheared *sheared,
                               const snow_sheared_order *order);

/* Counts of the encoding. */
void snow_sheared_fill_figures(const snow_sheared *sheared, snow_stats *stats);

/* Makes room for layers of so many bands of `tiles` tiles, and tells of it. */
snow_status snow_sheared_make_layers(snow_sheared *sheared, int layers,
                                     int64_t bands, size_t lines,
                                     snow_sheared_image *image);

/* Begins to draw bands 0 .. bands - 1, more than none, of `sheared->pass` with
 * `draw`.  Errors: SNOW_NO_MEMORY. */
snow_status snow_sheared_begin_bands(snow_sheared *sheared,
                                     const snow_sheared_order *order,
                                     int64_t bands, snow_work_fn *draw);

/* The same method in perspective: sheared_seen.c. */
bool snow_sheared_seen_fits(const snow_placement *placement,
                            const snow_settings *settings);
snow_status snow_sheared_seen_begin(snow_sheared *sheared,
                                    const snow_sheared_order *order,
                                    snow_stats *stats, snow_sheared_image *out);

#endif
