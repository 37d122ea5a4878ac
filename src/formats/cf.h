/* formats/cf.h - the Climate and Forecast conventions (cfconventions.org,
 * sections 2.5, 4 and 8), as far as they give the positions and values of
 * voxels; for NetCDF, HDF5 and Zarr.
 *
 * A reader gives every attribute of a variable to snow_cf_take; what they mean
 * is decided here alone, so that a data set is the same in all three. */
#ifndef SNOW_FORMATS_CF_H
#define SNOW_FORMATS_CF_H

#include "formats/axes.h"
#include "formats/uneven/uneven.h"

/* More coordinates than any drawable axis has: all are held at once. */
#define CF_MOST_COORDINATES ((int64_t)1 << 20)

/* The coordinates along an axis. */
typedef struct cf_axis {
    bool given;
    bool even;   /* neighbours are equally spaced, as nearly as matters */
    bool uneven; /* they are not, but rise or fall throughout */
    bool down;   /* they grow downward, as depths and pressures do */
    double first, step;
    double departs;      /* of an even axis: at most so much of a step */
    double *coordinates; /* all of them; NULL: none */
    double *moved; /* in the same block: where they are at this step, on the
                      grid that `coordinates` make; NULL: there */
    char unit[64], calendar[24];
} cf_axis;

/* A number; of integers also all of its 64 bits. */
typedef struct cf_number {
    double value;
    uint64_t whole; /* two's complement */
} cf_number;

/* The most numbers of an attribute that are kept. */
#define CF_MOST_NUMBERS 64

/* An attribute as a file has it. */
typedef struct cf_attribute {
    char text[256]; /* UTF-8, cut; "" for numbers */
    cf_number numbers[CF_MOST_NUMBERS];
    int64_t count; /* of numbers, which may be more than are kept */
} cf_attribute;

/* What the attributes of a variable say. */
typedef struct cf_attributes {
    char units[64], long_name[65], standard_name[64], axis[16];
    char calendar[24], positive[8], coordinates[256];
    bool codes; /* flag_values, flag_masks */
    int sign;   /* _Unsigned: 1 is true, -1 false, 0 not given */
    double scale, offset;
    /* _FillValue, missing_value, valid_range, valid_min, valid_max */
    cf_attribute limits[5];
    bool any; /* some that make the conventions apply */
} cf_attributes;

/* The attributes that snow_cf_take heeds; NULL ends them. */
extern const char *const snow_cf_names[];

void snow_cf_attributes_begin(cf_attributes *out);
void snow_cf_take(const char *name, const cf_attribute *given,
                  cf_attributes *out);

/* Variables that say where others lie, which are volumes only where they are
 * asked for by name; zeroed, it has no names. */
typedef struct cf_aside {
    char names[4096]; /* " nav_lon  nav_lat " */
} cf_aside;

/* Adds what an attribute of any variable names, if it is "bounds" or
 * "coordinates"; whether the last part of a path is among the names. */
void snow_cf_aside_add(const char *attribute, const char *names,
                       cf_aside *aside);
bool snow_cf_is_aside(const cf_aside *aside, const char *path);

/* A number whose 64 bits are not known. */
cf_number snow_cf_number(double value);

/* The conversion of stored values to data: scale * stored + offset, except for
 * those that are missing. */
typedef struct cf_values {
    snow_type type; /* of stored values, by _Unsigned */
    double scale, offset;
    cf_number fill[2 * CF_MOST_NUMBERS]; /* of two attributes */
    int fills;
    cf_number least, most; /* valid values, if they are limited */
    bool limited;
    bool codes; /* values that are not between each other: flags, and integers
                   without a scale */
    bool rare;  /* the only fill value is one that few integers have, and nobody
                   gave it: they stay integers unless they have it */
} cf_values;

cf_values snow_cf_values_default(snow_type type);

/* What the attributes mean for stored values of a type; `is_netcdf`: of a file
 * whose library fills what is not written.  Notes what the type cannot hold. */
cf_values snow_cf_settle(snow_context *context, const cf_attributes *from,
                         snow_type type, bool is_netcdf);

/* Turns stored coordinates into data, and measures their axis. */
void snow_cf_take_axis(snow_context *context, const cf_attributes *says,
                       snow_type type, bool is_netcdf, int64_t count,
                       double *values, cf_axis *out);

/* What a dimension is by its name, and by attributes of its coordinates
 * (sections 4 and 4.4; NULL: it has none): time by axis "T", standard_name
 * "time", units "... since ...", or the name "time"; components by the name
 * "component". */
snow_axis_hint snow_cf_hint(const char *name, const cf_attributes *says);

/* Measures an axis of `count` coordinates, which may fall; `given` stays false
 * if they are not finite or all equal.  Longitudes that wrap rise or fall
 * throughout.  Keeps their block. */
void snow_cf_measure(double *coordinates, int64_t count,
                     const cf_attributes *says, cf_axis *out);

/* Releases the coordinates of axes. */
void snow_cf_release(snow_context *context, cf_axis *axes, int count);

/* Sets the time of the step that info names, from the axis of time. */
void snow_cf_time(const cf_axis *axis, snow_volume_info *info);

/* Sets what the values are: the name of a variable, and its attributes. */
void snow_cf_name(const char *name, const cf_attributes *says,
                  snow_volume_info *info);

/* Sets spacing, origin and unit from the coordinates of x, y and z, if there
 * are any.  Axes in another length than x are converted to x's unit; those in
 * another unit (time, or height beside degrees), or in none, get x's spacing,
 * with a warning unless the options give it.  The world's z grows upward:
 * coordinates that grow downward get the other sign.  Plans the grid of uneven
 * axes, whose sizes info->dims become. */
void snow_cf_place(snow_context *context, const cf_axis axes[3],
                   const snow_volume_options *options, snow_volume_info *info,
                   snow_uneven *grid);

/* Reads stored voxels of info->type, of a box of the options; where `out` is
 * NULL only the sizes are checked. */
typedef snow_uneven_fn cf_read_fn;

/* Reads them as data on the even grid: missing ones are NaN, for which integers
 * become floats; sets type, slope and intercept.  `model` (cf/model.h) may be
 * NULL. */
struct cf_model;
snow_status snow_cf_read(snow_context *context, const struct cf_model *model,
                         const snow_uneven *grid, cf_values *values,
                         cf_read_fn *read, void *user,
                         const snow_volume_options *options,
                         snow_volume_info *info, snow_volume **out);

#endif
