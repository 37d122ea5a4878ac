/* volume/cf.h - the part of the Climate and Forecast conventions
 * (cfconventions.org, sections 2.5, 4 and 8) that says where voxels lie and
 * what they are worth; for NetCDF and HDF5. */
#ifndef SNOW_CF_H
#define SNOW_CF_H

#include "volume/volume.h"

/* More coordinates than any axis that is drawn: they are held at once. */
#define CF_MOST_COORDINATES ((int64_t)1 << 20)

/* The coordinates along an axis. */
typedef struct cf_axis {
    bool told;
    bool even; /* neighbours lie equally far apart */
    double first, step;
    char unit[64];
} cf_axis;

/* How stored values become data: scale * stored + offset; those equal to a
 * fill stand for none. */
typedef struct cf_values {
    double scale, offset;
    double fill[2];
    int fills;
} cf_values;

cf_values snow_cf_values_default(void);

/* An axis of `count` coordinates, which need not rise; not told when they are
 * not finite or all the same. */
void snow_cf_measure(const double *coordinates, int64_t count,
                     const char *units, cf_axis *out);

/* Spacing, origin and unit from the coordinates of x, y and z.  Those in
 * another unit than x, time or height beside degrees say, get x's spacing, and
 * the listener is told. */
void snow_cf_place(snow_context *context, const cf_axis axes[3],
                   snow_volume_info *info);

/* The type that holds a type's values and "none": floats for whole numbers of
 * at most 32 bits; and slope and intercept into the info. */
void snow_cf_apply(const cf_values *values, snow_volume_info *info);

/* Makes voxels equal to a fill NaN; whole numbers become the floats of
 * snow_cf_apply.  On failure the volume is closed. */
snow_status snow_cf_blank(const cf_values *values, snow_volume **volume);

#endif
