/* classify/classify.h - classification and shading (C&S in figure 7): native
 * voxels of a slice become samples of colour and opacity.
 *
 * The unit of work is a strip: some rows of one slice, few enough to stay in
 * the second-level cache between the stages.  Only voxels that are kept have
 * an entry, in order of row and column:
 *
 *   row j of the slice   . a b . . c        row_end  ... 3 ...
 *                                           columns  1 2 5
 *                                           samples  a b c
 */
#ifndef SNOW_CLASSIFY_H
#define SNOW_CLASSIFY_H

#include "classify/fade.h"
#include "classify/transfer.h"
#include "transform/transform.h"
#include "volume/volume.h"

#include <snowglass/render.h>

typedef struct snow_strip {
    int64_t slice, first_row, rows;
    size_t count;      /* voxels kept */
    size_t *row_end;   /* per row: the entries up to its end */
    uint32_t *columns; /* per entry */
    float *samples;    /* per entry: (grey, a) or (r, g, b, a) */
    int64_t room_rows; /* that the buffers hold, set by snow_strip_make */
    size_t row_end_capacity, columns_capacity, samples_capacity; /* bytes */
} snow_strip;

/* Makes room for strips of slices placed so, in the memory that is there where
 * it suffices; the record begins as zeros.  The strip's buffers belong to the
 * context; free with snow_strip_free.  Errors: SNOW_BAD_USAGE (a row of 2^32
 * voxels or more), SNOW_NO_MEMORY. */
snow_status snow_strip_make(snow_context *context,
                            const snow_placement *placement, int channels,
                            snow_strip *strip);
void snow_strip_free(snow_context *context, snow_strip *strip);

typedef struct snow_classifier snow_classifier;

/* Classifies one row: `voxels` is its first voxel, `stride` the step between
 * columns in values.  Returns how many voxels are kept. */
typedef size_t snow_classify_row_fn(const snow_classifier *classifier,
                                    const void *voxels, int64_t stride,
                                    int64_t columns, uint32_t *kept,
                                    float *samples);

/* The places of the voxels of 8 bits in a row that are kept: `keep` says so per
 * value less `lowest`.  Returns their number. */
typedef size_t snow_keep_bytes_fn(const unsigned char *keep, const void *voxels,
                                  unsigned char lowest, int64_t columns,
                                  uint32_t *kept);

/* The transfer function made ready for one volume, threshold and path length.
 * For 8- and 16-bit voxels it is a table over all native values. */
struct snow_classifier {
    const snow_volume *volume;
    const snow_transfer *transfer;
    int channels;     /* 2 or 4 */
    bool keep_all;    /* uninteresting voxels too, as samples of 0 */
    bool premultiply; /* colour times opacity already here */
    double threshold; /* opacity 0 to 255 */
    double exponent;  /* path length / reference length */
    snow_classify_row_fn *classify_row;
    snow_keep_bytes_fn *keep_bytes; /* NULL: the plain loop */
    unsigned char *keep;            /* per native value: is it kept? */
    float *table;                   /* per native value: its sample */
    /* With a gradient opacity the table holds straight colours and opacities of
     * the reference length; what is left to be done to them is told here. */
    bool fades;
    snow_fader fader;
    bool fade_premultiply;
    double fade_exponent;
    size_t keep_capacity, table_capacity; /* bytes */
};

/* What a classifier is asked to be. */
typedef struct snow_classify_options {
    double threshold;
    double opacity_exponent; /* a' = 1 - (1 - a)^exponent (model, point 6) */
    bool keep_all, premultiply;
    snow_isa isa; /* resolved, or AUTO for the plain loops */
} snow_classify_options;

/* Readies a classifier; the record begins as zeros, and keeps the memory of its
 * tables.  Errors: SNOW_BAD_USAGE (a singular matrix, with a gradient opacity),
 * SNOW_NO_MEMORY.  Free with snow_classifier_fini. */
snow_status snow_classifier_make(snow_context *context,
                                 const snow_volume *volume,
                                 const snow_transfer *transfer,
                                 const snow_classify_options *options,
                                 snow_classifier *classifier);
void snow_classifier_fini(snow_context *context, snow_classifier *classifier);

/* The sample of one native value, without a gradient opacity; true when it is
 * interesting.  An uninteresting one has a sample of zeros. */
bool snow_classify_value(const snow_classifier *classifier, double native,
                         float *sample);

/* Classifies rows [first, first + rows) of a slice into the strip. */
void snow_classify_strip(const snow_classifier *classifier,
                         const snow_placement *placement, int64_t slice,
                         int64_t first, int64_t rows, snow_strip *strip);

/* The native voxel at the beginning of a row of a slice, and the step between
 * columns. */
const void *snow_row_voxels(const snow_volume *volume,
                            const snow_placement *placement, int64_t slice,
                            int64_t row, int64_t *stride);

/* --- gradients: classify/gradient.c ----------------------------------------
 */

/* The gradient of native values at a voxel, in index space. */
typedef void snow_gradient_fn(const void *voxels, const int64_t dims[3],
                              const int64_t at[3], double gradient[3]);

snow_gradient_fn *snow_gradient_of(snow_type type);

/* A row of voxels along an axis; at[axis] is of no matter. */
typedef struct snow_gradient_row {
    const snow_volume *volume;
    int axis;
    int64_t at[3];
} snow_gradient_row;

/* The same for voxels of a row, x to gradients[0 .. count - 1], y and z `room`
 * and 2 `room` further on. */
void snow_gradients_of_row(const snow_gradient_row *row,
                           const uint32_t *columns, size_t count, size_t room,
                           double *gradients);

/* --- shading: classify/shade.c ---------------------------------------------
 */

/* Phong's model made ready for one view: its vectors carried to index space,
 * so that a gradient need not be carried to the world. */
typedef struct snow_shader {
    const snow_volume *volume;
    const snow_placement *placement;
    double ambient, diffuse, specular, shininess;
    snow_isa isa; /* resolved; all give the same bits */
    int whole;    /* shininess when it is a whole number up to 1024, else -1 */
    double light[3], half[3], viewer[3]; /* W^T times the world vector */
    double metric[3][3];                 /* W^T W: |W g|^2 = g . metric g */
} snow_shader;

/* The unit vectors to the light and half-way between it and the viewer; false
 * when the light is straight behind the volume and there is no half-way. */
bool snow_light_of(const snow_placement *placement,
                   const snow_settings *settings, double light[3],
                   double half[3]);

/* A shininess as a whole number when it is one up to 1024, else -1. */
int snow_whole_shininess(double shininess);

/* W is the inverse transpose of the matrix' linear part, which carries index
 * gradients to the world.  Errors: SNOW_BAD_USAGE (a singular matrix). */
snow_status snow_shader_init(snow_context *context, const snow_volume *volume,
                             const snow_placement *placement,
                             const snow_settings *settings, snow_shader *out);

/* Shades the samples of a strip (straight colours) and multiplies colour by
 * opacity (model, point 4).  Samples of opacity 0 stay 0. */
void snow_shade_strip(const snow_shader *shader, int channels,
                      snow_strip *strip);

/* The same for `count` samples one after another whose gradients, in index
 * space, are given; up to SNOW_SHADE_BLOCK, of which all must be numbers. */
#define SNOW_SHADE_BLOCK 128
void snow_shade_gradients(const snow_shader *shader,
                          const double gradients[3][SNOW_SHADE_BLOCK],
                          int count, int channels, float *samples);

/* --- perspective: classify/paths.c -----------------------------------------
 */

/* Corrects the samples of a strip, whose opacities are those of the reference
 * length, for the rays of the voxels; colours are premultiplied. */
void snow_lengthen_strip(const snow_placement *placement, double opacity_length,
                         int channels, snow_strip *strip);

/* Multiplies the samples of a strip by the lengths of their voxels' rays within
 * a sheet, in reference lengths: for sums along rays. */
void snow_weigh_strip(const snow_placement *placement, double opacity_length,
                      int channels, snow_strip *strip);

#endif
