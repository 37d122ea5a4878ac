/* formats/netcdf/netcdf.h - the header of a classic NetCDF file, private to
 * this folder.
 *
 * After "NetCDF Classic Format Specifications" (Unidata), versions CDF-1, 2
 * and 5: big-endian throughout, counts of 4 bytes, in CDF-5 of 8.
 *
 *     "CDF" version, number of records
 *     dimensions: name, length (0: that of the records)
 *     attributes of the file
 *     variables: name, dimensions, attributes, type, size, offset
 *
 * Variables with the records' dimension are interleaved, record by record; the
 * others are contiguous. */
#ifndef SNOW_FORMATS_NETCDF_NETCDF_H
#define SNOW_FORMATS_NETCDF_NETCDF_H

#include "formats/cf.h"
#include "io/seekable.h"

#define NETCDF_NAME_BYTES 257
#define NETCDF_MOST_AXES 5

typedef struct netcdf_dimension {
    char name[NETCDF_NAME_BYTES];
    int64_t size; /* for the record dimension, the number of records */
    bool records;
} netcdf_dimension;

typedef struct netcdf_variable {
    char name[NETCDF_NAME_BYTES];
    int64_t axes; /* may exceed NETCDF_MOST_AXES: then none is kept */
    int64_t axis[NETCDF_MOST_AXES]; /* dimensions, the last one fastest */
    snow_type type;                 /* NONE for text */
    bool records;                   /* its first axis counts records */
    uint64_t bytes; /* of the variable, or of its part of a record */
    uint64_t begin;
    uint64_t kind;       /* NetCDF's number of the type */
    uint64_t attributes; /* where they begin */
} netcdf_variable;

typedef struct netcdf_header {
    snow_context *context;
    int version;
    int64_t records; /* -1: to the end of the file */
    uint64_t record_bytes;
    uint64_t attributes; /* of the file: where they begin */
    int64_t dimension_count, variable_count;
    netcdf_dimension *dimensions;
    netcdf_variable *variables;
} netcdf_header;

/* Reads the header; must be freed whatever the status.  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_netcdf_read_header(snow_context *context, snow_seekable *bytes,
                                    netcdf_header *out);
void snow_netcdf_free_header(netcdf_header *header);

/* Size of a variable's axis, counted from the end: 0 is x. */
int64_t snow_netcdf_size_of(const netcdf_header *header,
                            const netcdf_variable *v, int64_t axis);

/* The variable of a name; NULL if there is none. */
const netcdf_variable *snow_netcdf_variable(const netcdf_header *header,
                                            const char *name);

/* The variable that is asked for or, where that is NULL, the only volume.
 * Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_BAD_USAGE. */
snow_status snow_netcdf_find(const netcdf_header *header, snow_seekable *bytes,
                             const char *asked, const netcdf_variable **out);

/* Reads the values of a variable with one axis; returns false if they are
 * truncated. */
bool snow_netcdf_values(const netcdf_header *header, snow_seekable *bytes,
                        const netcdf_variable *v, int64_t count, double *out);

/* Gives each attribute of a variable, or where that is NULL of the file, to
 * `take`. */
typedef void netcdf_take_fn(void *user, const char *name,
                            const cf_attribute *attribute);
void snow_netcdf_attributes(const netcdf_header *header, snow_seekable *bytes,
                            const netcdf_variable *v, netcdf_take_fn *take,
                            void *user);

#endif
