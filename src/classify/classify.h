/* classify/classify.h - classification and shading (C&S in figure 7): native
 * voxels of a slice become samples of colour and opacity.
 *
 * The unit of work is a row block: some rows of one slice, few enough to stay
 * in the second-level cache between the stages. Only voxels that are kept have
 * an entry, in order of row and column:
 *
 *   row j of the slice   . a b . . c        row_end  ... 3 ...
 *                                           columns  1 2 5
 *                                           samples  a b c */
#ifndef SNOW_CLASSIFY_H
#define SNOW_CLASSIFY_H

#include "classify/gradient_opacity.h"
#include "transform/clip.h"

typedef struct snow_row_block {
    int64_t slice, first_row, rows;
    size_t count;      /* voxels kept */
    size_t *row_end;   /* per row: number of entries up to its end */
    uint32_t *columns; /* per entry */
    float *samples;    /* per entry: (grey, a) or (r, g, b, a) */
    int64_t room_rows; /* rows of the buffers; set by snow_row_block_make */
} snow_row_block;

/* Allocates a row block for slices of this placement, or reuses its memory
 * where that suffices. The record begins as zeros. The buffers belong to the
 * context; free with snow_row_block_free. Errors: SNOW_STATUS_BAD_USAGE (a row
 * of 2^32 voxels or more), SNOW_STATUS_NO_MEMORY. */
snow_status snow_row_block_make(snow_context *context,
                                const snow_placement *placement, int channels,
                                snow_row_block *row_block);
void snow_row_block_free(snow_context *context, snow_row_block *row_block);

typedef struct snow_classifier snow_classifier;

/* Classifies one row: `voxels` is its first voxel, `stride` the step between
 * columns in values. Returns the number of voxels kept. */
typedef size_t snow_classify_row_fn(const snow_classifier *classifier,
                                    const void *voxels, int64_t stride,
                                    int64_t columns, uint32_t *kept,
                                    float *samples);

/* The transfer function prepared for one volume, threshold and path length. For
 * 8- and 16-bit voxels it is a table over all native values. */
struct snow_classifier {
    const snow_volume *volume;
    const snow_transfer *transfer;
    int channels;     /* 2 or 4 */
    bool keep_all;    /* also uninteresting voxels, as samples of 0 */
    bool only_counts; /* which are interesting, without their samples */
    bool no_colors;   /* samples are opacities behind a grey of 0 */
    bool premultiply; /* colours are multiplied by opacity here */
    double threshold; /* opacity 0 to 255 */
    double exponent;  /* path length / reference length */
    snow_classify_row_fn *classify_row;
    unsigned char *keep; /* per native value: is it kept? */
    float *table;        /* per native value: its sample */
    /* With a gradient opacity the table holds straight colours and opacities of
     * the reference length. These fields say what remains to be done. */
    bool gradient_factors;
    snow_gradient_opacity gradient_opacity;
    bool gradient_opacity_premultiply;
    double gradient_opacity_exponent;
};

/* Options of a classifier. */
typedef struct snow_classify_options {
    double threshold;
    double opacity_exponent; /* a' = 1 - (1 - a)^exponent (model, section 6) */
    bool keep_all, premultiply;
    bool only_counts; /* samples are 0, but with a gradient opacity */
    bool no_colors;   /* samples are opacities behind a grey of 0 */
    snow_isa isa;     /* resolved, or AUTO for the plain loops */
} snow_classify_options;

/* Makes a classifier. The record begins as zeros; a second call reuses the
 * memory of its tables. Errors: SNOW_STATUS_BAD_USAGE (a singular matrix, with
 * gradient opacity), SNOW_STATUS_NO_MEMORY. Free with snow_classifier_fini. */
snow_status snow_classifier_make(snow_context *context,
                                 const snow_volume *volume,
                                 const snow_transfer *transfer,
                                 const snow_classify_options *options,
                                 snow_classifier *classifier);
void snow_classifier_fini(snow_context *context, snow_classifier *classifier);

/* The sample of one native value, without a gradient opacity; returns true when
 * it is interesting. The sample of an uninteresting value is all zeros. */
bool snow_classify_value(const snow_classifier *classifier, double native,
                         float *sample);

/* Classifies rows [first, first + rows) of a slice into the row block. */
void snow_classify_row_block(const snow_classifier *classifier,
                             const snow_placement *placement, int64_t slice,
                             int64_t first, int64_t rows,
                             snow_row_block *row_block);

/* The first native voxel of a row of a slice, and the step between columns. */
const void *snow_row_voxels(const snow_volume *volume,
                            const snow_placement *placement, int64_t slice,
                            int64_t row, int64_t *stride);

/* --- gradients: classify/shading/gradient.c ------------------------------- */

/* A row of voxels along an axis; at[axis] is ignored. */
typedef struct snow_gradient_row {
    const snow_volume *volume;
    int axis;
    int64_t at[3];
} snow_gradient_row;

/* The gradients of native values at voxels of a row, in index space: x goes to
 * gradients[0 .. count - 1]; y and z begin `capacity`, 2 `capacity` later. */
void snow_gradients_of_row(const snow_gradient_row *row,
                           const uint32_t *columns, size_t count,
                           size_t capacity, double *gradients);

/* --- shading: classify/shading/shade.c ------------------------------------ */

/* The lights of a picture: a distant one, that is fixed to the camera, then a
 * head light, whose direction is that of the viewer; or one of the two. */
#define SNOW_LIGHTS_MOST 2
typedef struct snow_lights {
    int count;
    double share[SNOW_LIGHTS_MOST]; /* of the light; the sum is 1 */
    double to[SNOW_LIGHTS_MOST][3]; /* unit vectors of the world */
    bool head[SNOW_LIGHTS_MOST];    /* it goes with the viewer */
} snow_lights;

/* Phong's model prepared for one view. Its vectors are transformed to index
 * space, so that gradients need not be transformed to world space. */
typedef struct snow_shader {
    const snow_volume *volume;
    const snow_placement *placement;
    snow_viewer eye;
    double ambient, diffuse, specular, shininess;
    snow_isa isa; /* resolved; all instruction sets give the same bits */
    int whole;    /* shininess if it is a whole number up to 1024, else -1 */
    snow_lights lights;             /* in the world */
    double to[SNOW_LIGHTS_MOST][3]; /* W^T times the world vector */
    double half[SNOW_LIGHTS_MOST][3], viewer[3];
    double metric[3][3];  /* W^T W: |W g|^2 = g . metric g */
    double inverse[3][3]; /* W^T */
} snow_shader;

/* Settings as resolved. */
snow_lights snow_lights_of(const snow_placement *placement,
                           const snow_settings *settings);

/* The unit vector half-way between two, or zeros if they are opposite. */
void snow_half_way(const double light[3], const double viewer[3],
                   double half[3]);

/* W is the inverse transpose of the matrix' linear part; it transforms index
 * gradients to the world. Errors: SNOW_STATUS_BAD_USAGE (a singular matrix). */
snow_status snow_shader_init(snow_context *context, const snow_volume *volume,
                             const snow_placement *placement,
                             const snow_settings *settings, snow_shader *out);

/* Turns the shader to another viewer, whose direction is a unit vector of the
 * world: for rays of a perspective view, each of which has its own.  A head
 * light goes with the viewer, any other stays. */
void snow_shader_turn(snow_shader *shader, const double viewer[3]);

/* Shades the samples of a row block (straight colours) and multiplies colour by
 * opacity (model, section 4). Samples of opacity 0 stay 0. */
void snow_shade_row_block(const snow_shader *shader, int channels,
                          snow_row_block *row_block);

/* The same for `count` consecutive samples with given gradients in index space,
 * at most SNOW_SHADE_BLOCK. All of them must be numbers.  `flat`: how much of
 * the light of each is that of cut faces; NULL: none. */
#define SNOW_SHADE_BLOCK 128
void snow_shade_gradients(const snow_shader *shader,
                          const double gradients[3][SNOW_SHADE_BLOCK],
                          const float *flat, int count, int channels,
                          float *samples);

/* --- perspective: path_length.c ------------------------------------------- */

/* Corrects the opacities of a row block from the reference length to the path
 * lengths of the voxels' own rays. Colours are premultiplied. */
void snow_correct_opacity(const snow_placement *placement,
                          double opacity_length, int channels,
                          snow_row_block *row_block);

/* Multiplies the samples of a row block by the lengths of their rays within a
 * sheet, in reference lengths: for sums along rays. */
void snow_scale_by_path_length(const snow_placement *placement,
                               double opacity_length, int channels,
                               snow_row_block *row_block);

#endif
