/* render/shear_warp/internal.h - what the sheared method keeps from picture to
 * picture, for its parallel (shear_warp.c) and its perspective half
 * (perspective.c). */
#ifndef SNOW_RENDER_SHEAR_WARP_INTERNAL_H
#define SNOW_RENDER_SHEAR_WARP_INTERNAL_H

#include "base/line_batch.h"
#include "classify/sample/sample.h"
#include "composite/tile.h"
#include "encode/decode.h"
#include "render/shear_warp/bands.h"
#include "render/shear_warp/encoding_cache.h"
#include "render/shear_warp/shear_warp.h"
#include "render/shear_warp/warping.h"

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

/* An intermediate image, and how it is warped. */
typedef struct snow_intermediate {
    float *plane;
    unsigned char *drawn;                  /* per band and tile */
    size_t plane_capacity, drawn_capacity; /* bytes */
    snow_shear_warp_warping warping;
} snow_intermediate;

/* What the bands in memory were encoded from. */
typedef struct snow_encoded_key {
    uint64_t generation; /* of the volume; 0: nothing is encoded */
    int slice_axis;
    bool shaded, between, with_gradient_opacity;
    bool numbers; /* of sums and largest values: no voxel more may be there */
    snow_encoding encoding; /* as asked for */
    double threshold;       /* where opacity depends on gradients, else 0: the
                               quantizer holds it */
    snow_slab slab;
} snow_encoded_key;

struct snow_shear_warp {
    snow_context *context;
    snow_quantizer quantizer,
        next; /* of the last picture; room for the next one's */
    snow_bands bands;
    snow_encoding_cache encoding_cache; /* of the bands */
    snow_encoded_key key;
    uint64_t encodings; /* how often the bands were made */
    /* Bounds of the bands' rows (render/modes/max_bounds.c), and of which. */
    uint16_t *blocks;       /* [slice][row][column of blocks] */
    size_t blocks_capacity; /* bytes */
    uint64_t blocks_of;     /* `encodings`; 0: of none */
    bool blocks_hull;       /* for cubic B-splines */
    snow_value_scale blocks_scale;
    snow_opacity_point *gradient_opacity_key; /* of the bands: the curve of the
                                     gradient opacity, and with a threshold the
                                     opacity function behind it */
    snow_opacity_point *next_gradient_opacity_key;
    size_t gradient_opacity_points, gradient_opacity_key_capacity,
        next_gradient_opacity_key_capacity;
    snow_palette palette;
    snow_gloss *gloss;               /* an entry of zeros, and SNOW_NORMALS */
    snow_comb *combs;                /* of all slices, along u and v */
    snow_intermediate *intermediate; /* that is drawn on: one of these */
    snow_intermediate intermediates[2];
    char *scratch;         /* of all workers */
    void *pass;            /* the picture in the making, of either half */
    snow_monitor *monitor; /* of the picture, or NULL */
    snow_line_batch batch; /* its bands */
    size_t gloss_capacity, combs_capacity, scratch_capacity,
        pass_capacity; /* bytes */
    /* In perspective: all slices, how they are resampled along u, and how far
     * their kernels reach. */
    struct perspective_slice *seen;
    char *teeth;
    double *reach;
    size_t seen_capacity, teeth_capacity, reach_capacity; /* bytes */
};

/* Slices that are drawn of an order: with those between, but for the one behind
 * the volume's last. */
int64_t snow_shear_warp_slices(const snow_shear_warp_params *params);

/* What encoding works with of one volume, for as long as it works. */
typedef struct snow_band_tools {
    snow_placement stored; /* of the voxels that it has */
    snow_normal_maker maker;
    snow_gradient_opacity gradient_opacity;
} snow_band_tools;

/* How a volume, which is the order's or has a slab of it, is encoded: with all
 * of the slices that the key names.  Points into the tools. */
snow_status snow_shear_warp_bands_params(
    snow_shear_warp *shear_warp, const snow_shear_warp_params *params,
    const snow_encoded_key *key, const snow_volume *volume,
    const snow_clip *clip, snow_band_tools *tools, snow_bands_params *out);

/* The bands of a volume whose voxels stay in their file (stream.c).
 * Errors: SNOW_STATUS_NO_MEMORY, with how many voxels are interesting; those of
 * snow_slabs_visit. */
snow_status snow_shear_warp_encode_stream(snow_shear_warp *shear_warp,
                                          const snow_shear_warp_params *params,
                                          const snow_encoded_key *key);

/* Lines 02 and 03: the table of shading for a view and light, and the palette
 * of a picture whose rays all run `exponent` reference lengths; in perspective,
 * where they differ, -1.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status
snow_shear_warp_classify_and_shade(snow_shear_warp *shear_warp,
                                   const snow_shear_warp_params *params,
                                   double exponent, snow_stats *stats);

/* Counts of the encoding. */
void snow_shear_warp_fill_figures(const snow_shear_warp *shear_warp,
                                  snow_stats *stats);

/* Makes room for what the workers need in all, and for an image's layers, of so
 * many bands; its shape is given. */
snow_status snow_shear_warp_make_room(snow_shear_warp *shear_warp,
                                      size_t scratch_bytes,
                                      const snow_grouping *grouping,
                                      int64_t bands,
                                      snow_shear_warp_image *image);

/* How a picture's image of so many channels will be warped, but for its plane
 * (snow_shear_warp_attach) and its shear. */
snow_shear_warp_warping *
snow_shear_warp_warping_of(snow_shear_warp *shear_warp,
                           const snow_shear_warp_params *params, int channels);

/* Lets the image be warped. */
void snow_shear_warp_attach(snow_shear_warp *shear_warp,
                            snow_shear_warp_image *image);

/* Begins to draw bands 0 .. bands - 1, more than none, of `sheared->pass` with
 * `draw`.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_shear_warp_begin_bands(snow_shear_warp *shear_warp,
                                        const snow_shear_warp_params *params,
                                        int64_t bands, snow_work_fn *draw);

/* The same method in perspective: perspective.c. */
bool snow_shear_warp_perspective_fits(const snow_placement *placement,
                                      const snow_settings *settings);
snow_status snow_shear_warp_perspective_begin(
    snow_shear_warp *shear_warp, const snow_shear_warp_params *params,
    snow_stats *stats, snow_shear_warp_image *out);

#endif
