/* snowglass/transfer.h - the transfer function: data value to colour and
 * opacity.
 *
 * Colour (straight, linear as stored) and opacity, of one reference length
 * (snow_settings), are piecewise linear between control points in data units,
 * constant beyond. A repeated value is a step, of the later point. */
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

/* From copied control points, of each kind one or more, values not falling. */
SNOW_API snow_status snow_transfer_new(snow_context *context,
    const snow_color_point *colors, size_t color_count,
    const snow_opacity_point *opacities, size_t opacity_count,
    snow_transfer **out);
SNOW_API void snow_transfer_free(snow_transfer *transfer);
/* Joins points, all above 0, by logarithms; 0 and below is transparent. */
SNOW_API snow_status snow_transfer_set_log(snow_transfer *transfer);
SNOW_API bool snow_transfer_is_log(const snow_transfer *transfer);

/* Factors by magnitudes of central differences, in data units per unit of the
 * world, of points (copied; 0: none). That of a magnitude (NaN: the last). */
SNOW_API snow_status snow_transfer_set_gradient_opacity(
    snow_transfer *transfer, const snow_opacity_point *points, size_t count);
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
/* What a transfer function is made of; by default all is chosen from the
 * histogram. Arrays and texts stay the caller's. Colours come from `colors`,
 * else `base`, else `preset`, whose opacities others alone (data) replace. */
typedef struct snow_look {
    size_t size;
    const char *name;             /* for people; NULL: none */
    const char *preset;           /* "linear", "ct-bone", ...; NULL: none */
    const char *colormap;         /* replaces the colours; NULL: keep them */
    const struct snow_look *base; /* as of snow_look_load; its name, points,
                                     domain, log, per_mm count; NULL: none */
    snow_range range;             /* over which points are spread */
    double low, high;             /* of VALUES and PERCENTILES; low < high */
    bool log;                     /* by logarithms; 0, below: transparent */
    snow_domain domain;           /* what the points' values mean */
    bool per_mm; /* opacities of a mm: set snow_settings.opacity_length */
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
/* For `look` (or NULL) on `volume`, the same on every machine. A preset in data
 * units (ct-*) is spread only where a range is given. Errors: BAD_USAGE
 * (unknown name, with the list; bad points), STOPPED. */
SNOW_API snow_status snow_transfer_new_for_volume(
    const snow_volume *volume, const snow_look *look, snow_transfer **out);

/* "grey 72..213; opacity 0 at 72, 0.4 at 213 (from the histogram)"; straight
 * colour and opacity of a data value, zeros for NaN; values of both ends; the
 * points in use, in data units, which stay the function's. */
SNOW_API const char *snow_transfer_description(const snow_transfer *transfer);
SNOW_API void snow_transfer_evaluate(
    const snow_transfer *transfer, double value, double rgba[4]);
SNOW_API void snow_transfer_domain(
    const snow_transfer *transfer, double *low, double *high);
SNOW_API snow_status snow_transfer_get_look(
    const snow_transfer *transfer, snow_look *out);

/* Label `index` (from 0), rising, of what is drawn as labels; else NULL. */
SNOW_API const snow_label *snow_transfer_label(const snow_transfer *, size_t);

/* Whether all colours are grey, and pictures have two channels; whether it was
 * chosen for a volume without surfaces, better drawn unshaded. */
SNOW_API bool snow_transfer_is_grey(const snow_transfer *transfer);
SNOW_API bool snow_transfer_is_unshaded(const snow_transfer *transfer);

/* Share of voxels, 0 to 1, of opacity a = 0, or 255 a <= T + 0.0001 for a
 * threshold T > 0: the paper's SR. */
SNOW_API snow_status snow_transfer_sparse_ratio(const snow_transfer *transfer,
    const snow_volume *volume, double threshold, double *ratio);

/* Preset and colour map `index` (from 0); NULL past the end. */
SNOW_API const char *snow_preset_name(size_t index);
SNOW_API const char *snow_preset_description(size_t index);
SNOW_API const snow_look *snow_preset_look(size_t index);
SNOW_API const char *snow_colormap_name(size_t index);

/* Points of a colour map, for values 0 to 1: how many; 0 past the end. */
#define SNOW_COLORMAP_POINTS_MAX 32
SNOW_API size_t snow_colormap_points(
    size_t index, snow_color_point *points, size_t room);

/* The index, or -1. Case, dashes and underscores do not matter ("CT_Bone"). */
SNOW_API int snow_preset_from_name(const char *name);
SNOW_API int snow_colormap_from_name(const char *name);

#endif
