/* formats/hdf5/hdf5.h - the parts of the HDF5 reader, private to this folder.
 *
 *   driver.c  bytes of a source -> an open file of libhdf5
 *   find.c    names -> the data set to read
 *   grid.c    attributes -> geometry and value conversion
 *   hdf5.c    a box of the data set -> the volume */
#ifndef SNOW_FORMATS_HDF5_HDF5_H
#define SNOW_FORMATS_HDF5_HDF5_H

#include "formats/cf.h"

#if SNOW_HAVE_HDF5

#include <hdf5.h>

#define HDF5_MOST_AXES 5
#define HDF5_NAME_BYTES 512

/* The most objects of a file that a search visits, and groups within groups.
 * libhdf5 recognises a group that it has seen by a count in the file; if that
 * is wrong, a link back to the root leads on without end. */
#define HDF5_MOST_OBJECTS 100000
#define HDF5_MOST_DEPTH 64

typedef struct hdf5_file hdf5_file;

/* A numeric array of a file. */
typedef struct hdf5_set {
    hid_t id; /* the data set */
    char path[HDF5_NAME_BYTES];
    int axes;
    hsize_t sizes[HDF5_MOST_AXES]; /* the last one fastest */
    snow_type type;
} hdf5_set;

/* Opens a source as an HDF5 file.  libhdf5 prints nothing until it is closed,
 * and opens no other files.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_hdf5_open(snow_source *source, hdf5_file **out);
void snow_hdf5_close(hdf5_file *file); /* NULL is accepted */

hid_t snow_hdf5_id(const hdf5_file *file);
uint64_t snow_hdf5_size(const hdf5_file *file); /* bytes */

/* "what (libhdf5: why); the file is damaged ..." */
snow_status snow_hdf5_fail(snow_context *context, const char *what);

/* Visits the objects of a file, at most as many and as deep as above, until
 * `look` returns another value than 0.  Errors: SNOW_STATUS_BAD_INPUT (groups
 * that cannot be listed, or that are nested more deeply). */
snow_status snow_hdf5_visit(snow_context *context, hid_t file,
                            H5O_iterate_t look, void *user);

/* Opens the requested data set, or the only volume of the file.  The caller
 * closes the set's id.  Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_BAD_USAGE
 * (there are several; a wrong name). */
snow_status snow_hdf5_find(snow_context *context, hid_t file, const char *asked,
                           hdf5_set *out);

/* The axes of a data set, counted from the last one. */
typedef struct hdf5_axes {
    cf_axis scales[HDF5_MOST_AXES]; /* coordinates by dimension scales */
    snow_axes roles;
} hdf5_axes;

/* Finds the meaning of each axis.  Errors: SNOW_STATUS_BAD_INPUT (too many
 * axes of space), SNOW_STATUS_NO_MEMORY. */
snow_status snow_hdf5_read_axes(snow_context *context, hid_t file,
                                const hdf5_set *set, hdf5_axes *out);

/* Sets matrix and unit of info, and how values are stored. */
void snow_hdf5_place(snow_context *context, hid_t file, const hdf5_set *set,
                     const hdf5_axes *axes, const snow_volume_options *options,
                     snow_volume_info *info, cf_values *values);

#endif
#endif
