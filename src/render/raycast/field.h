/* render/raycast/field.h - the volume as a field: a value at every position
 * between its voxels, by interpolation.
 *
 *   voxels      0     1     2    ...   n-1
 *   defined     |------------------------|       [0, n - 1] along each axis
 *   gradients  -1                        n       look one voxel beyond
 *
 * Beyond an end the field goes on oddly: v[-k] = 2 v[0] - v[k], so that the
 * difference at the end is the one-sided one.  An axis with a single voxel is
 * one voxel wide, and constant.
 *
 * A hole is a voxel without a value: NaN, one that a mask leaves out, or one
 * that has no logarithm where the look has a logarithmic scale.  Where weights
 * of half a voxel and more are there, the value is the mean of what is there;
 * elsewhere there is none. */
#ifndef SNOW_RENDER_RAYCAST_FIELD_H
#define SNOW_RENDER_RAYCAST_FIELD_H

#include "transfer/transfer.h"
#include "volume/volume.h"

#include <snowglass/render.h>

/* Voxels along an axis that a value is made of, at most. */
#define SNOW_FIELD_TAPS 4

typedef struct snow_field {
    const snow_volume *volume;
    int64_t dims[3];        /* of the whole, which positions are those of */
    int64_t stored[3];      /* the first voxel that is in memory */
    int64_t steps[3];       /* from voxel to voxel */
    int taps;               /* 2: the tent, 4: the cubic B-spline */
    bool log;               /* values are binary logarithms */
    double linear;          /* above 0: they are places on such a scale */
    bool infinite_is_hole;  /* else infinities are the finite ends: */
    double least, most;     /* data values */
    double border;          /* that values fall off by at a mask's; 0: none */
    double low[3], high[3]; /* where it is defined */
} snow_field;

/* The voxels around a position, kept for the next one. */
typedef struct snow_field_window {
    bool filled;
    int64_t first[3];
    int count[3];
    double weights[3][SNOW_FIELD_TAPS];
    double values[SNOW_FIELD_TAPS * SNOW_FIELD_TAPS * SNOW_FIELD_TAPS];
    bool holes;         /* NaN is among the values */
    bool beyond;        /* the position is not within the ends */
    double least, most; /* of the values; least > most: all are holes */
} snow_field_window;

/* The field of a volume in memory, or of a part of one: positions are then
 * those that its voxels, and their neighbours, are enough for.  `modes`: of
 * data values that are finite, for modes other than over. */
snow_status snow_field_make(const snow_volume *volume,
                            const snow_transfer *transfer,
                            const snow_settings *settings, bool modes,
                            snow_field *out);

/* Finds voxels and weights of a position, at most a voxel beyond the ends. */
void snow_field_place(const snow_field *field, const double at[3],
                      snow_field_window *window);

/* The value at the position of a window; NaN in a hole. */
double snow_field_value(const snow_field_window *window);

/* Half the difference of the values one voxel to both sides, along each axis:
 * of the field, whose value here is `here`.  Where one side is a hole the
 * difference is that to the other.  `sides` are windows for six positions. */
void snow_field_gradient(const snow_field *field, const double at[3],
                         double here, snow_field_window sides[6],
                         double gradient[3]);

/* Adds to a gradient that of what is there, smoothly, times the field's range:
 * the border of holes is lit as if values fell off there. */
void snow_field_add_border(const snow_field *field, const double at[3],
                           double gradient[3]);

/* --- labels ----------------------------------------------------------------
 *
 * Numbers that name things are not interpolated.  How far a position belongs to
 * a label is: the sum of the weights of its voxels. */

/* The label that a position belongs to most, the larger of equals; `nearest`:
 * that of the nearest voxel.  NaN in a hole. */
double snow_field_label(const snow_field *field, const double at[3],
                        const snow_field_window *window, bool nearest);

/* The gradient of a smooth membership, of voxels this many along each axis. */
#define SNOW_LABEL_TAPS 6
void snow_field_label_gradient(const snow_field *field, const double at[3],
                               double label, double gradient[3]);

#endif
