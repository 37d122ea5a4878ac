/* snowglass/transfer.h - the transfer function: data value to colour and
 * opacity.
 *
 * Colour (straight, linear as stored) and opacity are each piecewise linear
 * between control points in data units, constant beyond the ends; where a
 * value repeats there is a step, and the value itself belongs to the later
 * point.  Opacity is that of one reference length (see snow_settings).
 *
 * It may be multiplied with a gradient opacity: a factor that depends on the
 * magnitude of the data's gradient, so that boundaries stand out and what is
 * even fades. */
#ifndef SNOWGLASS_TRANSFER_H
#define SNOWGLASS_TRANSFER_H

#include <snowglass/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct snow_transfer snow_transfer;

typedef struct snow_color_point {
    double value; /* data value */
    double red;   /* 0 to 1 */
    double green; /* 0 to 1 */
    double blue;  /* 0 to 1 */
} snow_color_point;

typedef struct snow_opacity_point {
    double value;   /* data value */
    double opacity; /* 0 to 1 */
} snow_opacity_point;

/* A transfer function from its control points, which are copied.  Values must
 * be finite and not fall; at least one point of each kind.
 * Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY.  Free with
 * snow_transfer_free. */
SNOW_API snow_status snow_transfer_new(snow_context *context,
                                       const snow_color_point *colors,
                                       size_t color_count,
                                       const snow_opacity_point *opacities,
                                       size_t opacity_count,
                                       snow_transfer **out);

SNOW_API void snow_transfer_free(snow_transfer *transfer);

/* From now on points are joined linearly in the logarithm of the value; values
 * of 0 and below are transparent.  Errors: SNOW_STATUS_BAD_USAGE (a point that
 * is not above 0). */
SNOW_API snow_status snow_transfer_set_log(snow_transfer *transfer);
SNOW_API bool snow_transfer_is_log(const snow_transfer *transfer);

/* Gives a transfer function a gradient opacity: the opacity of a voxel is then
 * that of its value times the factor that `points` give for the magnitude of
 * its gradient.  Their values are magnitudes, in data units per unit of the
 * volume's world (a millimetre, as a rule), of central differences; their
 * opacities are the factors, 0 to 1.  Between points they are linear, beyond
 * the ends constant.  The points are copied; a count of 0, or points that are
 * all 1, take away what was given before.  snow_transfer_description tells of
 * it. Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY; then all stays as
 * it was. */
SNOW_API snow_status snow_transfer_set_gradient_opacity(
    snow_transfer *transfer, const snow_opacity_point *points, size_t count);

/* The factor for a magnitude; 1 without a gradient opacity.  NaN, which has no
 * place in the curve, counts as a magnitude beyond its end. */
SNOW_API double snow_transfer_evaluate_gradient(const snow_transfer *transfer,
                                                double magnitude);

/* Over which data values a look is spread. */
typedef enum snow_range {
    SNOW_RANGE_AUTO = 0,   /* chosen from the histogram */
    SNOW_RANGE_FULL,       /* smallest to largest finite value */
    SNOW_RANGE_VALUES,     /* low to high, data values */
    SNOW_RANGE_PERCENTILES /* low to high, percent of the finite voxels */
} snow_range;

/* What the values of control points mean. */
typedef enum snow_domain {
    SNOW_DOMAIN_DATA = 0, /* data values */
    SNOW_DOMAIN_RANGE,    /* shares, 0 to 1, from the smallest value to the
                             largest */
    SNOW_DOMAIN_OBJECT    /* shares from the background's end to the brightest,
                             both read from the histogram */
} snow_domain;

/* A look: what a transfer function is made of, before there is a volume. By
 * default all of it is chosen from the histogram. Points are as in
 * snow_transfer_new; arrays and texts stay the caller's.
 *
 * Colours come from `colors`, else from `base`, else from `preset`. A look with
 * colours, or with a domain other than data, stands for a preset itself, and
 * takes what it lacks from the histogram; one with opacities alone replaces
 * those of its base or preset by opacities at data values. */
typedef struct snow_look {
    size_t size;
    const char *name;             /* for people; NULL: none */
    const char *preset;           /* "linear", "ct-bone", ...; NULL: none */
    const char *colormap;         /* "grey", "viridis", ...: replaces the
                                     colours; NULL: keep them */
    const struct snow_look *base; /* a look that stands for a preset, as of
                                     snow_look_load; only its name, points,
                                     domain, log and per_mm count; NULL: none */
    snow_range range;             /* over which points are spread */
    double low, high;             /* of VALUES and PERCENTILES; low < high */
    bool log;                     /* points are joined, and values spread, by
                                     logarithms; 0 and below is transparent */
    snow_domain domain;           /* what the points' values mean */
    bool per_mm;                  /* opacities are of a millimetre; false: of
                                     a voxel.  For the caller, who sets
                                     snow_settings.opacity_length by it */
    const snow_color_point *colors;
    size_t color_count;
    const snow_opacity_point *opacities;
    size_t opacity_count;
    const snow_opacity_point *gradient_opacities; /* as in
                                        snow_transfer_set_gradient_opacity */
    size_t gradient_opacity_count;
} snow_look;
SNOW_RECORD(snow_look);

/* The transfer function that `look` asks for on `volume`.  A preset in data
 * units (ct-*) keeps its values unless a range is given, over which it is then
 * spread, and its gradient opacity with it.  The result depends on the volume's
 * values only, and is the same on every machine.  Errors: SNOW_STATUS_BAD_USAGE
 * (unknown name, bad points; the message lists the names),
 * SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_transfer_new_for_volume(const snow_volume *volume,
                                                  const snow_look *look,
                                                  snow_transfer **out);

/* One line that says what was chosen: "grey 72..213; opacity 0 at 72, 0.4 at
 * 213 (from the histogram)".  Owned by the transfer function. */
SNOW_API const char *snow_transfer_description(const snow_transfer *transfer);

/* Colour and opacity at a data value, straight, without the gradient opacity;
 * NaN gives zeros. */
SNOW_API void snow_transfer_evaluate(const snow_transfer *transfer,
                                     double value, double rgba[4]);

/* The data values of the first and the last colour. */
SNOW_API void snow_transfer_domain(const snow_transfer *transfer, double *low,
                                   double *high);

/* True when every colour is grey, so that pictures need two channels. */
SNOW_API bool snow_transfer_is_grey(const snow_transfer *transfer);

/* True when it was chosen by itself for a volume that has no surfaces to shade
 * (one that its object fills, or of one slice): pictures of it are better
 * without shading, which is the caller's to choose. */
SNOW_API bool snow_transfer_is_unshaded(const snow_transfer *transfer);

/* Share of uninteresting voxels, 0 to 1 (the paper's sparse ratio SR, section
 * 5.2): those with opacity 0 or, for threshold T > 0, 255 a <= T + 0.0001.  The
 * opacity a is that with the gradient opacity.
 * Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_transfer_sparse_ratio(const snow_transfer *transfer,
                                                const snow_volume *volume,
                                                double threshold,
                                                double *ratio);

/* Name and description of preset and colour map `index` (from 0); NULL past
 * the end. */
SNOW_API const char *snow_preset_name(size_t index);
SNOW_API const char *snow_preset_description(size_t index);
SNOW_API const char *snow_colormap_name(size_t index);

/* A preset as a look, which lives as long as the program; NULL past the end. */
SNOW_API const snow_look *snow_preset_look(size_t index);

/* The control points of a colour map, for values of 0 to 1: into `room` points,
 * SNOW_COLORMAP_POINTS_MAX suffice.  How many there are; 0 past the end. */
#define SNOW_COLORMAP_POINTS_MAX 32
SNOW_API size_t snow_colormap_points(size_t index, snow_color_point *points,
                                     size_t room);

/* The index of a name, -1 when there is none, to be asked before a volume is
 * read.  Wherever a look is named, letters may be of either case, and dashes
 * and underscores be missing ("CT_Bone" is "ct-bone"); "gray" is "grey". */
SNOW_API int snow_preset_from_name(const char *name);
SNOW_API int snow_colormap_from_name(const char *name);

#ifdef __cplusplus
}
#endif
#endif
