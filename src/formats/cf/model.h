/* formats/cf/model.h - the grids of models of the atmosphere and the ocean,
 * whose files do not say by the conventions where a voxel is.
 *
 *     x   U o T o T o T      WRF: T is on mass points, U between them
 * (west_east and west_east_stag); levels follow the ground y   nav_lon (y, x)
 * NEMO, ROMS, POP: curvilinear coordinates */
#ifndef SNOW_FORMATS_CF_MODEL_H
#define SNOW_FORMATS_CF_MODEL_H

#include "formats/cf.h"

/* How a reader gives other parts of its file. */
typedef struct cf_file {
    snow_context *context;
    void *user;
    char axis[4][32]; /* the variable's dimensions x, y, z, time; "": none */
    /* An attribute of the file. */
    bool (*attribute)(void *user, const char *name, cf_attribute *out);
    /* How many axes a variable has; 0: there is none of numbers. */
    int64_t (*axes_of)(void *user, const char *name);
    /* The first letters of a row of a variable of letters. */
    bool (*letters)(void *user, const char *name, int64_t row, char out[20]);
    /* A box of a variable at the step of the options, as data; `out` is not
     * NULL. */
    snow_status (*read)(void *user, const char *name,
                        const snow_volume_options *options,
                        snow_volume_info *info, snow_volume **out);
} cf_file;

/* A variable on the grid of a model; all zeros is one of no model. */
typedef struct cf_model {
    const cf_file *file;
    bool staggered[3]; /* it lies between the mass points: means are taken */
    int64_t levels;    /* above 0: columns are read at even heights */
    double low, step;  /* of these */
} cf_model;

/* Finds what is known of the grid, and takes what the conventions do not say:
 * sizes of mass points into info->dims, their places into axes x, y, z, and the
 * time.  `says` of the variable.  Errors: those of reading heights. */
snow_status snow_model_take(const cf_file *file, const char *variable,
                            const cf_attributes *says,
                            const snow_volume_options *options,
                            snow_volume_info *info, cf_axis axes[4],
                            cf_model *out);

/* A box of the file's own voxels, read by another function. */
typedef struct cf_reading {
    snow_context *context;
    const cf_model *model;
    cf_read_fn *read;
    void *user;
} cf_reading;

/* These are cf_read_fn of a cf_reading: means of neighbours, where the model
 * says so; then columns at even heights. */
snow_status snow_model_means(void *user, const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out);
snow_status snow_model_columns(void *user, const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out);

#endif
