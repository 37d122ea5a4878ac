/* snowglass/transfer.h - the transfer function: data value to colour and
 * opacity.
 *
 * Colour (straight, linear as stored) and opacity are piecewise linear between
 * control points in data units, and constant beyond them. A value that is
 * repeated is a step, where the later point counts. An opacity is that of one
 * unit distance, snow_settings.opacity_length (VTK: ScalarOpacityUnitDistance).
 */
#ifndef SNOWGLASS_TRANSFER_H
#define SNOWGLASS_TRANSFER_H

#include <snowglass/volume.h>

typedef struct snow_transfer snow_transfer;

typedef struct snow_color_point {
    double value;            /* data value */
    double red, green, blue; /* 0 to 1 */
} snow_color_point;

typedef struct snow_opacity_point {
    double value, opacity; /* data value or gradient magnitude; 0 to 1 */
} snow_opacity_point;

/* Makes a transfer function of control points, which are copied: one or more of
 * each kind, whose values do not fall. Errors: BAD_USAGE (bad points). */
SNOW_API snow_status snow_transfer_new(snow_context *context,
    const snow_color_point *colors, size_t color_count,
    const snow_opacity_point *opacities, size_t opacity_count,
    snow_transfer **out);
SNOW_API void snow_transfer_free(snow_transfer *transfer);

/* Joins the points by logarithms of their values. Values of 0 and below are
 * transparent. Errors: BAD_USAGE (a point at 0 or below). */
SNOW_API snow_status snow_transfer_set_log(snow_transfer *transfer);

/* Sets a factor of the opacity by the gradient's magnitude, that of central
 * differences in data units per unit of the world. `points` are copied; a count
 * of 0 removes the factor. A frame that keeps its encoding goes on to report
 * the interesting voxels of that one (snow_stats.interesting). */
SNOW_API snow_status snow_transfer_set_gradient_opacity(
    snow_transfer *transfer, const snow_opacity_point *points, size_t count);

/* Returns the factor of a magnitude; that of the last point for NaN. */
SNOW_API double snow_transfer_evaluate_gradient(
    const snow_transfer *transfer, double magnitude);

typedef enum snow_range {
    SNOW_RANGE_AUTO = 0,    /* chosen from the histogram */
    SNOW_RANGE_FULL,        /* smallest to largest finite value */
    SNOW_RANGE_VALUES,      /* low to high, data values */
    SNOW_RANGE_PERCENTILES, /* low to high, percent of the finite voxels */
    SNOW_RANGE_ROBUST,      /* the file's window, else FULL but far outliers */
    SNOW_RANGE_SLICES,      /* the same of one slice, or of several for all */
    SNOW_RANGE_LEAST,       /* for smallest values: of CT air, else ROBUST */
    SNOW_RANGE_SIGNAL       /* the file's window, else above the noise */
} snow_range;

typedef enum snow_domain { /* what the values of control points mean */
    SNOW_DOMAIN_DATA = 0,  /* data values */
    SNOW_DOMAIN_RANGE,     /* shares 0 to 1, of smallest to largest value */
    SNOW_DOMAIN_OBJECT,   /* shares, of the background's end to the brightest */
    SNOW_DOMAIN_SYMMETRIC /* shares, of as far below 0 as above; 0.5 is 0 */
} snow_domain;

/* A look: what a transfer function is made of, before its volume is known. By
 * default all is chosen from the histogram. Arrays and texts stay the caller's,
 * and are needed in the call only. Points come from `colors`, else from `base`,
 * else from `preset`; giving two of them is BAD_USAGE. `opacities` without
 * `colors` replace those of the base or preset, with data values. */
typedef struct snow_look {
    size_t size;
    const char *name;             /* for people; NULL: none */
    const char *preset;           /* "linear", "ct-bone", ...; NULL: none */
    const char *colormap;         /* replaces them; "reversed"; NULL: keep */
    const struct snow_look *base; /* as of snow_look_load; its name, points,
                                     domain, log, per_mm count; NULL: none */
    snow_range range;             /* over which points are spread */
    double low, high;             /* low < high; read only where `range` is
                                     VALUES or PERCENTILES */
    bool log;                     /* by logarithms; 0, below: transparent */
    snow_domain domain;           /* what the points' values mean */
    bool per_mm; /* opacities are those of a millimetre. Only the tool and
                    recipes read it: set snow_settings.opacity_length to the
                    length of a millimetre in the volume's unit */
    const snow_color_point *colors;
    size_t color_count;
    const snow_opacity_point *opacities;
    size_t opacity_count;
    const snow_opacity_point *gradient_opacities;
    size_t gradient_opacity_count;
    double symlog; /* linear up to it, logarithms beyond; -1: chosen */
    bool overlay;  /* of a second volume in a first's picture (docs/looks.md) */
    double white;  /* mixed colours this bright are clear: 0 to 1; 0: none */
} snow_look;
SNOW_RECORD(snow_look);

/* Makes the transfer function of a look (or NULL) for a volume, the same on
 * every machine. A preset in data units (ct-*) is spread only where a range is
 * given. Errors: BAD_USAGE (an unknown name, with the list of those that there
 * are; bad points; no range), STOPPED. */
SNOW_API snow_status snow_transfer_new_for_volume(
    const snow_volume *volume, const snow_look *look, snow_transfer **out);

/* Returns a line for people, such as "grey 72..213; opacity 0 at 72, 0.4 at 213
 * (from the histogram)". */
SNOW_API const char *snow_transfer_description(const snow_transfer *transfer);

/* Fills `rgba` with the straight colour and the opacity of a data value; zeros
 * for NaN. */
SNOW_API void snow_transfer_evaluate(
    const snow_transfer *transfer, double value, double rgba[4]);

/* Gives the smallest and the largest data value of the control points. */
SNOW_API void snow_transfer_domain(
    const snow_transfer *transfer, double *low, double *high);

/* Fills *out with the points in use, in data units, which stay the transfer
 * function's, and whether logarithms join them. */
SNOW_API snow_status snow_transfer_get_look(
    const snow_transfer *transfer, snow_look *out);

/* Returns label `index` (from 0), in rising order, of a volume that is drawn as
 * labels; NULL past the end, and of others. */
SNOW_API const snow_label *snow_transfer_label(
    const snow_transfer *transfer, size_t index);

/* Returns whether all colours are grey. Then pictures have two channels. */
SNOW_API bool snow_transfer_is_grey(const snow_transfer *transfer);

/* Returns whether it was chosen for a volume without surfaces, which is better
 * drawn unshaded (snow_settings.shade). */
SNOW_API bool snow_transfer_is_unshaded(const snow_transfer *transfer);

/* Measures the share of voxels, 0 to 1, that are not interesting: their opacity
 * a is 0, or 255 a is at most T + 0.0001 for a threshold T > 0. It is the
 * sparse ratio SR of the paper's section 5.2. */
SNOW_API snow_status snow_transfer_sparse_ratio(const snow_transfer *transfer,
    const snow_volume *volume, double threshold, double *ratio);

/* Return preset or colour map `index` (from 0), NULL past the end. */
SNOW_API const char *snow_preset_name(size_t index);
SNOW_API const char *snow_preset_description(size_t index);
SNOW_API const snow_look *snow_preset_look(size_t index);
SNOW_API const char *snow_colormap_name(size_t index);

#define SNOW_COLORMAP_POINTS_MAX 32

/* Fills at most `room` points of colour map `index`, over values 0 to 1, and
 * returns how many it has filled; 0 past the end. */
SNOW_API size_t snow_colormap_points(
    size_t index, snow_color_point *points, size_t room);

/* Return the index of a name, or -1. Case, dashes and underscores do not matter
 * ("CT_Bone"). */
SNOW_API int snow_preset_from_name(const char *name);
SNOW_API int snow_colormap_from_name(const char *name);

#endif
