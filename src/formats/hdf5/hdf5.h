/* formats/hdf5/hdf5.h - the parts of the HDF5 reader, private to this folder.
 *
 *   driver.c  bytes of a source -> an open file of libhdf5
 *   find.c    names -> the data set to read
 *   series.c  patterns of names -> the data set of a step
 *   stacks.c  microscopes' names -> the data set of a channel and a time
 *   text.c    texts of attributes
 *   grid.c    attributes -> geometry
 *   meaning.c attributes -> quantity, unit, time, conversion of values
 *   imaris.c  Imaris' own attributes -> sizes, geometry
 *   vtkhdf.c  VTK's own attributes -> geometry, time
 *   theta.c   modes around an axis -> x, y and z
 *   blocks.h  blocks of refinement -> one grid
 *   foreign.c files of codes that are not read -> what converts them
 *   storage.c whether its values can be read
 *   filters.c the stored bytes of a chunk -> its elements
 *   chunks.c  chunks, or what else is stored -> a box of elements
 *   hdf5.c    a box of the data set -> the volume */
#ifndef SNOW_FORMATS_HDF5_HDF5_H
#define SNOW_FORMATS_HDF5_HDF5_H

#include "formats/cf.h"
#include "io/seekable.h"

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

/* Closes what libhdf5 has opened, if it has. */
static inline void snow_hdf5_drop(hid_t id) {
    if (id >= 0)
        H5Idec_ref(id);
}

/* A numeric array of a file. */
typedef struct hdf5_set {
    hid_t id; /* the data set */
    char path[HDF5_NAME_BYTES];
    int axes;
    hsize_t sizes[HDF5_MOST_AXES]; /* the last one fastest */
    snow_type type;
    bool constant; /* openPMD: a group with a value and a shape; id is its */
    double value;
    bool no_sign; /* 16 bits that have none, whatever the type says */
    bool spatial; /* asked for behind "/./": no axis is of components */
} hdf5_set;

/* Opens a source as an HDF5 file.  libhdf5 prints nothing until it is closed,
 * and opens no other files.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_hdf5_open(snow_source *source, hdf5_file **out);
void snow_hdf5_close(hdf5_file *file); /* NULL is accepted */

hid_t snow_hdf5_id(const hdf5_file *file);
uint64_t snow_hdf5_size(const hdf5_file *file); /* bytes */

/* The file's bytes, and where its addresses count from; whether addresses and
 * lengths have eight bytes. */
snow_seekable *snow_hdf5_bytes(const hdf5_file *file, uint64_t *base);
bool snow_hdf5_is_usual(const hdf5_file *file);

/* Reads text `index` of an attribute, of fixed or variable length; "" if it is
 * missing or damaged.  Returns how many texts the attribute has. */
size_t snow_hdf5_text(const hdf5_file *file, hid_t object, const char *name,
                      size_t index, char *out, size_t capacity);

/* The text of an attribute of letters, or of one text. */
void snow_hdf5_letters(const hdf5_file *file, hid_t object, const char *name,
                       char out[64]);

/* "what (libhdf5: why); the file is damaged ..." */
snow_status snow_hdf5_fail(snow_context *context, const char *what);

/* Visits the objects of a file, at most as many and as deep as above, until
 * `look` returns another value than 0.  Errors: SNOW_STATUS_BAD_INPUT (groups
 * that cannot be listed, or that are nested more deeply). */
snow_status snow_hdf5_visit(snow_context *context, hid_t file,
                            H5O_iterate_t look, void *user);

/* Reads sizes and type of a data set; returns false if it is not a numeric
 * array. */
bool snow_hdf5_describe(hid_t id, hdf5_set *out);

/* Opens a data set, or a group that stands for one of a single value; false if
 * it is none, or not of numbers. */
bool snow_hdf5_open_values(hid_t file, const char *path, hdf5_set *out);

/* Opens the group `levels` above the data set; below 0: there is none. */
hid_t snow_hdf5_above(const hdf5_file *file, const hdf5_set *set, int levels);

/* Refuses data in other files and filters that are not installed; files of
 * codes whose grids are not read.  Errors: SNOW_STATUS_BAD_INPUT. */
snow_status snow_hdf5_check_storage(snow_context *context, hid_t set);
snow_status snow_hdf5_refuse_strangers(snow_context *context,
                                       const hdf5_file *file,
                                       const char *asked);

/* The path of the only data set, of two axes at least, that ends with `asked`
 * behind a slash: "rho" is "/data/400/fields/rho".  `asked` itself where it is
 * there, and where nothing ends so.  Errors: SNOW_STATUS_BAD_USAGE (several
 * do), SNOW_STATUS_BAD_INPUT. */
snow_status snow_hdf5_complete(snow_context *context, const hdf5_file *file,
                               const char *asked, char path[HDF5_NAME_BYTES]);

/* Opens the requested data set, or the only volume of the file.  The caller
 * closes the set's id.  Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_BAD_USAGE
 * (there are several; a wrong name). */
snow_status snow_hdf5_find(snow_context *context, const hdf5_file *file,
                           const char *asked, hdf5_set *out);

/* Reads a record of modes around an axis (openPMD, thetaMode), if the path
 * names one, a component of one, or its x or y.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
snow_status snow_hdf5_read_theta(snow_context *context, const hdf5_file *file,
                                 const char *path,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out,
                                 bool *found);

/* The steps that a pattern of names stands for: /step_%04d/rho,
 * /data/%T/fields/rho. */
typedef struct hdf5_series {
    bool given;     /* the name is a pattern */
    int64_t count;  /* of steps */
    int64_t step;   /* the one that is taken, from 0 */
    int64_t number; /* in its name */
    bool stack;     /* of channels of a microscope */
    bool no_sign;   /* values have none, whatever their type says */
    char path[HDF5_NAME_BYTES];
} hdf5_series;

/* Finds the step of the options.  Errors: SNOW_STATUS_BAD_USAGE (nothing fits;
 * no such step), SNOW_STATUS_NO_MEMORY. */
snow_status snow_hdf5_find_step(snow_context *context, hid_t file,
                                const snow_volume_options *options,
                                hdf5_series *out);

/* Files of Imaris and BigDataViewer, unless a data set is asked for: finds that
 * of the channel and time of the options, and what is said of the channels.
 * Errors: SNOW_STATUS_BAD_USAGE (no such channel or time). */
snow_status snow_hdf5_find_stack(snow_context *context, const hdf5_file *file,
                                 const snow_volume_options *options,
                                 snow_volume_info *said, hdf5_series *out);

/* Reads elements first .. first + count - 1 along each of `axes` axes of a data
 * set, at most HDF5_MOST_AXES, as values of a type of libhdf5 in memory, the
 * last axis fastest.  All data sets are read by this function, since libhdf5
 * does not notice a chunk that is too short.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED. */
snow_status snow_hdf5_read_box(snow_context *context, const hdf5_file *file,
                               hid_t set, hid_t type, int axes,
                               const hsize_t *first, const hsize_t *count,
                               void *out);

/* The axes of a data set, counted from the last one. */
typedef struct hdf5_axes {
    cf_axis scales[HDF5_MOST_AXES]; /* coordinates by dimension scales */
    char names[HDF5_MOST_AXES][32]; /* of the scales; "": none */
    snow_axes roles;
    bool colors; /* the components are red, green, blue and perhaps opacity */
    bool is_netcdf; /* some are dimensions of NetCDF-4 */
} hdf5_axes;

/* Finds the meaning of each axis; the caller releases the scales
 * (snow_cf_release) whatever the status.  Errors: SNOW_STATUS_BAD_INPUT (too
 * many axes of space), SNOW_STATUS_NO_MEMORY. */
snow_status snow_hdf5_read_axes(snow_context *context, const hdf5_file *file,
                                const hdf5_set *set, hdf5_axes *out);

/* Sets matrix and unit of info, and the grid of uneven axes. */
void snow_hdf5_place(snow_context *context, const hdf5_file *file,
                     const hdf5_set *set, const hdf5_axes *axes,
                     const snow_volume_options *options, snow_volume_info *info,
                     snow_uneven *grid);

/* Data of Imaris: leaves out what fills up chunks; sets the matrix, and is
 * false for other data. */
void snow_hdf5_trim_imaris(const hdf5_file *file, hdf5_set *set);
bool snow_hdf5_place_imaris(const hdf5_file *file, const hdf5_set *set,
                            snow_volume_info *info);

/* The one of several arrays that VTK's file says is active; false: none. */
bool snow_hdf5_active_image(const hdf5_file *file, char path[HDF5_NAME_BYTES]);

/* Image data that VTK wrote: the first sets the matrix, and is false for other
 * data; then the time; then which axes are time and components, if it has
 * steps. */
bool snow_hdf5_place_image(const hdf5_file *file, const hdf5_set *set,
                           snow_volume_info *info);
snow_status snow_hdf5_time_image(snow_context *context, const hdf5_file *file,
                                 const hdf5_set *set, snow_volume_info *info);
void snow_hdf5_hint_image(const hdf5_file *file, const hdf5_set *set,
                          snow_axis_hint hints[HDF5_MOST_AXES]);

/* Reads up to `most` numbers of an attribute; returns how many there are, 0 if
 * it is missing or has other values. */
int snow_hdf5_numbers(hid_t object, const char *name, int most, double *out);

/* Reads an attribute of text or numbers; false if there is none. */
bool snow_hdf5_attribute(const hdf5_file *file, hid_t object, const char *name,
                         cf_attribute *out);

/* Reads the attributes that the conventions have. */
void snow_hdf5_attributes(const hdf5_file *file, hid_t object,
                          cf_attributes *out);

/* How values are stored, if the conventions apply to the data set. */
cf_values snow_hdf5_values(snow_context *context, const hdf5_file *file,
                           const hdf5_set *set, const hdf5_axes *axes,
                           const cf_attributes *says);

/* The factor to SI (openPMD), 1 without one, and the unit then; the time of the
 * nearest group above. */
double snow_hdf5_unit(const hdf5_file *file, const hdf5_set *set,
                      snow_volume_info *info);
void snow_hdf5_time(const hdf5_file *file, const hdf5_set *set,
                    snow_volume_info *info);

/* Sets what the values are, and the time of the step; values that have a factor
 * to SI (openPMD) are scaled by it.  Errors: those of snow_hdf5_read_box. */
snow_status snow_hdf5_mean(snow_context *context, const hdf5_file *file,
                           const hdf5_set *set, const hdf5_axes *axes,
                           const cf_attributes *says, snow_volume_info *info,
                           cf_values *values);

#endif
#endif
