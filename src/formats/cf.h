/* formats/cf.h - the Climate and Forecast conventions (cfconventions.org,
 * sections 2.5, 4 and 8), as far as they give the positions and values of
 * voxels; for NetCDF and HDF5. */
#ifndef SNOW_FORMATS_CF_H
#define SNOW_FORMATS_CF_H

#include "formats/axes.h"
#include "formats/uneven/uneven.h"

/* More coordinates than any drawable axis has: all are held at once. */
#define CF_MOST_COORDINATES ((int64_t)1 << 20)

/* The coordinates along an axis. */
typedef struct cf_axis {
    bool given;
    bool even;   /* neighbours are equally spaced */
    bool uneven; /* they are not, but rise or fall throughout */
    bool down;   /* they grow downward, as depths and pressures do */
    double first, step;
    double *coordinates; /* all of them; NULL: none */
    char unit[64], calendar[24];
} cf_axis;

/* The conversion of stored values to data: scale * stored + offset; a fill
 * value means a missing value. */
typedef struct cf_values {
    double scale, offset;
    double fill[2];
    int fills;
} cf_values;

cf_values snow_cf_values_default(void);

/* What a dimension is by its name, and by attributes of its coordinates
 * (sections 4 and 4.4): time by axis "T", standard_name "time", units "...
 * since
 * ...", or the name "time"; components by the name "component".  Texts may be
 * "". */
typedef struct cf_words {
    const char *name, *units, *axis, *standard_name;
} cf_words;
snow_axis_hint snow_cf_hint(const cf_words *words);

/* Measures an axis of `count` coordinates, which may fall; `given` stays false
 * if they are not finite or all equal.  Keeps their block. */
void snow_cf_measure(double *coordinates, int64_t count, const char *units,
                     cf_axis *out);

/* Returns whether coordinates grow downward (section 4.3): by their attribute
 * positive, or where that is "", by a unit of pressure. */
bool snow_cf_is_down(const char *positive, const char *units);

/* Releases the coordinates of axes. */
void snow_cf_release(snow_context *context, cf_axis *axes, int count);

/* Sets the time of the step that info names, from the axis of time. */
void snow_cf_time(const cf_axis *axis, snow_volume_info *info);

/* Sets what the values are: the name of a variable, and its attributes units,
 * long_name and standard_name, which may be "". */
void snow_cf_name(const char *name, const char *units, const char *long_name,
                  const char *standard_name, snow_volume_info *info);

/* Sets spacing, origin and unit from the coordinates of x, y and z.  Axes in
 * another length than x are converted to x's unit; those in another unit (time,
 * or height beside degrees), or in none, get x's spacing, with a warning unless
 * the options give it.  The world's z grows upward: coordinates
 * that grow downward get the other sign.  Plans the grid of uneven axes, whose
 * sizes info->dims become. */
void snow_cf_place(snow_context *context, const cf_axis axes[3],
                   const snow_volume_options *options, snow_volume_info *info,
                   snow_uneven *grid);

/* Sets the type that holds a type's values and NaN (floats for integers of at
 * most 32 bits), slope and intercept. */
void snow_cf_apply(const cf_values *values, snow_volume_info *info);

/* Replaces voxels equal to a fill value by NaN; integers become the floats of
 * snow_cf_apply.  On failure the volume is closed. */
snow_status snow_cf_blank(const cf_values *values, snow_volume **volume);

#endif
