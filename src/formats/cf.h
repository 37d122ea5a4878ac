/* formats/cf.h - the Climate and Forecast conventions (cfconventions.org,
 * sections 2.5, 4 and 8), as far as they give the positions and values of
 * voxels; for NetCDF and HDF5. */
#ifndef SNOW_FORMATS_CF_H
#define SNOW_FORMATS_CF_H

#include "formats/axes.h"
#include "formats/format.h"

/* More coordinates than any drawable axis has: all are held at once. */
#define CF_MOST_COORDINATES ((int64_t)1 << 20)

/* The coordinates along an axis. */
typedef struct cf_axis {
    bool given;
    bool even; /* neighbours are equally spaced */
    double first, step;
    char unit[64];
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
 * ...", or the name "time".  Texts may be "". */
typedef struct cf_words {
    const char *name, *units, *axis, *standard_name;
} cf_words;
snow_axis_hint snow_cf_hint(const cf_words *words);

/* Measures an axis of `count` coordinates, which may fall; `given` stays false
 * if they are not finite or all equal. */
void snow_cf_measure(const double *coordinates, int64_t count,
                     const char *units, cf_axis *out);

/* Sets spacing, origin and unit from the coordinates of x, y and z.  Axes in
 * another unit than x (time, or height beside degrees) get x's spacing, with a
 * warning unless the options give it. */
void snow_cf_place(snow_context *context, const cf_axis axes[3],
                   const snow_volume_options *options, snow_volume_info *info);

/* Sets the type that holds a type's values and NaN (floats for integers of at
 * most 32 bits), slope and intercept. */
void snow_cf_apply(const cf_values *values, snow_volume_info *info);

/* Replaces voxels equal to a fill value by NaN; integers become the floats of
 * snow_cf_apply.  On failure the volume is closed. */
snow_status snow_cf_blank(const cf_values *values, snow_volume **volume);

#endif
