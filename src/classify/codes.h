/* classify/codes.h - classification at splat time: what IA holds of a voxel in
 * the shear-warp method, and the tables that turn it into a sample.
 *
 * IA holds a code of 8 or 16 bits for each interesting voxel:
 *
 *   8- and 16-bit types   the native value less the smallest of its type: exact
 *   wider types           a position on the transfer function: the 65,536 codes
 *                         are divided evenly among the stretches between
 *                         neighbouring control points.  Colour and opacity,
 *                         linear within a stretch, are off by at most half a
 *                         step of n / 65,536 with n stretches, however steep
 *                         they are; steps between stretches are exact
 *
 * For shading it also holds a normal of 16 bits (classify/shading/normals.h). A
 * palette maps codes to samples for one view. New colours, light or camera need
 * a new palette only; the codes stay. */
#ifndef SNOW_CODES_H
#define SNOW_CODES_H

#include "transfer/transfer.h"
#include "volume/volume.h"

#define SNOW_KEPT_RUNS 16

/* Native values from first to last, both included. */
typedef struct snow_native_run {
    double first, last;
} snow_native_run;

/* Which voxels are interesting, and their codes, for one volume, opacity
 * function and threshold (model, point 3). */
typedef struct snow_quantizer {
    snow_type type;
    double slope, intercept; /* data value = slope * native + intercept */
    double threshold;
    int bytes;      /* of a code: 1 or 2 */
    size_t codes;   /* 256 or 65,536 */
    int32_t lowest; /* native value of code 0, for 8- and 16-bit types */
    /* 8- and 16-bit types: per code, 1 when it is interesting; also as runs of
     * codes, first to last, when there are at most SNOW_KEPT_RUNS of them
     * (run_count is -1 when there are more). */
    unsigned char *keep;
    int run_count;
    struct {
        uint16_t first, last;
    } runs[SNOW_KEPT_RUNS];
    /* All types: the interesting native values, as rising runs. */
    snow_native_run *native_runs;
    size_t native_run_count;
    /* Wider types: the distinct control values in data units, rising, and the
     * number of codes between two of them. Code 0 is below the first. */
    double *stops;
    size_t stop_count, stretch_codes;
    bool log;     /* codes are spaced by the logarithm */
    void *places; /* scratch memory for finding the runs */
    size_t keep_capacity, native_runs_capacity, places_capacity,
        stops_capacity; /* bytes */
} snow_quantizer;

/* Makes a quantizer, which begins as zeros or was made before; its memory is
 * reused. Errors: SNOW_STATUS_NO_MEMORY; the quantizer can then only be made
 * again or freed. Free with snow_quantizer_fini. */
snow_status snow_quantizer_make(snow_context *context,
                                const snow_volume *volume,
                                const snow_transfer *transfer, double threshold,
                                snow_quantizer *out);
void snow_quantizer_fini(snow_context *context, snow_quantizer *quantizer);

/* Whether two quantizers keep the same voxels of a volume and give each the
 * same code, so that an encoding made with one is valid for the other. */
bool snow_quantizer_same(const snow_quantizer *a, const snow_quantizer *b);

/* The code of a native value; returns true when it is interesting. */
bool snow_quantizer_code(const snow_quantizer *quantizer, double native,
                         uint16_t *code);

/* The data value that a code stands for. */
double snow_quantizer_value(const snow_quantizer *quantizer, size_t code);

/* --- palettes ------------------------------------------------------------- */

/* Samples of all codes: (grey, a) or (r, g, b, a) floats per code. With
 * premultiply colours are multiplied by the opacity. Buffers are reused from
 * one call to the next. The parts that do not depend on the view are kept too,
 * while the control points and the quantizer's codes equal their copy in `key`.
 */
typedef struct snow_palette {
    float *samples; /* from code 0 on; one sample of zeros lies before it */
    float *block;
    size_t capacity; /* bytes, like all capacities */
    int channels;
    float *looks; /* per code: colour, and opacity of the reference length */
    size_t looks_capacity;
    double *clarities; /* per code: log(1 - opacity) */
    size_t clarities_capacity;
    double *key, *next_key;
    size_t key_count, key_capacity, next_key_capacity;
} snow_palette;

/* Makes the palette of a view. Opacities are corrected for the path length: a'
 * = 1 - (1 - a)^exponent (model, point 6). Codes of 8- and 16-bit types that
 * are not interesting get zeros, for bands may hold more voxels than are shown.
 * `threads` as in base/thread_pool.h. Errors: SNOW_STATUS_NO_MEMORY; the
 * palette can then only be made again or freed. */
snow_status snow_palette_make(snow_context *context,
                              const snow_quantizer *quantizer,
                              const snow_transfer *transfer, double exponent,
                              bool premultiply, int threads, snow_palette *out);
void snow_palette_fini(snow_context *context, snow_palette *palette);

/* The palette for rays that differ from voxel to voxel
 * (classify/sample/opacity_correction.h): as above, but with straight colours,
 * and with log2(1 - a) in place of the opacity, or SNOW_OPAQUE where a is 1. */
#define SNOW_OPAQUE (-1e30f)
snow_status snow_palette_make_clear(snow_context *context,
                                    const snow_quantizer *quantizer,
                                    const snow_transfer *transfer, int threads,
                                    snow_palette *out);

#endif
