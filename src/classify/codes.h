/* classify/codes.h - classification at splat time: what IA holds of a voxel in
 * the sheared method, and the tables that turn it into a sample.
 *
 * IA holds a code of 8 or 16 bits for each interesting voxel:
 *
 *   8- and 16-bit types   the native value less the smallest of its type: exact
 *   wider types           a place on the transfer function: the 65,536 codes
 *                         are dealt out evenly to the stretches between
 *                         neighbouring control points, so that colour and
 *                         opacity, linear within a stretch, are off by at most
 *                         half a step of n / 65,536 with n stretches, however
 *                         steep they are; steps between stretches are exact
 *
 * and, for shading, a normal of 16 bits (classify/normals.h).  A palette maps
 * codes to samples for one view; colours, light and view change it, and the
 * codes stay. */
#ifndef SNOW_CODES_H
#define SNOW_CODES_H

#include "classify/transfer.h"
#include "volume/volume.h"

#define SNOW_KEPT_RUNS 16

/* Native values from first to last, both included. */
typedef struct snow_native_run {
    double first, last;
} snow_native_run;

/* Which voxels are interesting, and their codes, for one volume, opacity
 * function and threshold (model, point 3). */
typedef struct snow_coder {
    snow_type type;
    double slope, intercept; /* data value = slope * native + intercept */
    double threshold;
    int bytes;      /* of a code: 1 or 2 */
    size_t codes;   /* 256 or 65,536 */
    int32_t lowest; /* native value of code 0, for 8- and 16-bit types */
    /* 8- and 16-bit types: per code, 1 when it is interesting; and the same as
     * runs of codes, first to last, when there are at most SNOW_KEPT_RUNS of
     * them (run_count is -1 when there are more). */
    unsigned char *keep;
    int run_count;
    struct {
        uint16_t first, last;
    } runs[SNOW_KEPT_RUNS];
    /* All types: the interesting native values, as rising runs. */
    snow_native_run *native_runs;
    size_t native_run_count;
    /* Wider types: the control values in data units, rising, each once, and
     * how many codes lie between two of them.  Code 0 is below the first. */
    double *stops;
    size_t stop_count, stretch_codes;
    bool log;     /* codes are dealt out by the logarithm */
    void *places; /* where runs were looked for */
    size_t keep_capacity, native_runs_capacity, places_capacity,
        stops_capacity; /* bytes */
} snow_coder;

/* Makes a coder, which was all zeros or made before; its memory is kept.
 * Errors: SNOW_NO_MEMORY; then it is good for making and freeing only.  Free
 * with snow_coder_fini. */
snow_status snow_coder_make(snow_context *context, const snow_volume *volume,
                            const snow_transfer *transfer, double threshold,
                            snow_coder *out);
void snow_coder_fini(snow_context *context, snow_coder *coder);

/* Whether two coders give every voxel of one volume the same code and keep the
 * same voxels, so that what was encoded with one serves the other. */
bool snow_coder_same(const snow_coder *a, const snow_coder *b);

/* The code of a native value; true when it is interesting. */
bool snow_coder_code(const snow_coder *coder, double native, uint16_t *code);

/* The data value that a code stands for. */
double snow_coder_value(const snow_coder *coder, size_t code);

/* --- palettes ------------------------------------------------------------- */

/* Samples of all codes: (grey, a) or (r, g, b, a) floats per code.  With
 * premultiply colours are multiplied by the opacity.  The buffers are kept from
 * one making to the next; the parts that do not depend on the view too, for as
 * long as the control points and the coder's codes, of which `key` is a copy,
 * stay the same. */
typedef struct snow_palette {
    float *samples; /* of code 0; before it lies a sample of zeros */
    float *block;
    size_t capacity; /* bytes, as all capacities */
    int channels;
    float *looks; /* per code: colour, and opacity of the reference length */
    size_t looks_capacity;
    double *clarities; /* per code: log(1 - opacity) */
    size_t clarities_capacity;
    double *key, *next_key;
    size_t key_count, key_capacity, next_key_capacity;
} snow_palette;

/* Makes the palette of a view: opacities are corrected for the path length as
 * a' = 1 - (1 - a)^exponent (model, point 6).  Codes of 8- and 16-bit types
 * that are not interesting get zeros, for bands may hold more than is shown.
 * `threads` as in base/parallel.h.  Errors: SNOW_NO_MEMORY; the palette is then
 * good for nothing but another making. */
snow_status snow_palette_make(snow_context *context, const snow_coder *coder,
                              const snow_transfer *transfer, double exponent,
                              bool premultiply, int threads, snow_palette *out);
void snow_palette_fini(snow_context *context, snow_palette *palette);

/* The palette for rays that differ from voxel to voxel (classify/rays.h): as
 * above, with straight colours and, in the place of opacities, log2(1 - a); of
 * opacity 1 SNOW_OPAQUE. */
#define SNOW_OPAQUE (-1e30f)
snow_status snow_palette_make_clear(snow_context *context,
                                    const snow_coder *coder,
                                    const snow_transfer *transfer, int threads,
                                    snow_palette *out);

#endif
