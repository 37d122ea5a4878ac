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
    char units[64], standard_name[64], axis_name[64], long_name[65];
    char calendar[24], positive[8];
    bool is_unsigned; /* set by an attribute, whatever the type */
    cf_values values;
} netcdf_variable;

typedef struct netcdf_header {
    snow_context *context;
    int version;
    int64_t records; /* -1: to the end of the file */
    uint64_t record_bytes;
    int64_t dimension_count, variable_count;
    netcdf_dimension *dimensions;
    netcdf_variable *variables;
    bool minc;
} netcdf_header;

/* Reads the header; must be freed whatever the status.  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_netcdf_read_header(snow_context *context, snow_seekable *bytes,
                                    netcdf_header *out);
void snow_netcdf_free_header(netcdf_header *header);

#endif
