/* volume/netcdf.h - the header of a classic NetCDF file; for netcdf*.c alone.
 *
 * After "NetCDF Classic Format Specifications" (Unidata), versions CDF-1, 2
 * and 5: big-endian throughout, counts of 4 bytes, in CDF-5 of 8.
 *
 *     "CDF" version, number of records
 *     dimensions: name, length (0: that of the records)
 *     attributes of the file
 *     variables: name, dimensions, attributes, type, size, place
 *
 * Variables over the records' dimension lie in each record one behind the
 * other, the others each in one piece. */
#ifndef SNOW_NETCDF_H
#define SNOW_NETCDF_H

#include "base/random.h"
#include "volume/cf.h"

#define NETCDF_NAME_BYTES 257
#define NETCDF_MOST_AXES 5

typedef struct netcdf_dimension {
    char name[NETCDF_NAME_BYTES];
    int64_t size; /* the number of records where it is theirs */
    bool records;
} netcdf_dimension;

typedef struct netcdf_variable {
    char name[NETCDF_NAME_BYTES];
    int64_t axes; /* may be more than NETCDF_MOST_AXES: then none is kept */
    int64_t axis[NETCDF_MOST_AXES]; /* dimensions, the last one fastest */
    snow_type type;                 /* NONE for text */
    bool records;                   /* its first axis is the records' */
    uint64_t bytes;                 /* of it, or of its part of a record */
    uint64_t begin;
    char units[64];
    bool is_unsigned; /* whatever its type says */
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

/* Reads it; to be freed whatever the status.
 * Errors: SNOW_BAD_INPUT, SNOW_NO_MEMORY. */
snow_status snow_netcdf_read_header(snow_context *context, snow_random *bytes,
                                    netcdf_header *out);
void snow_netcdf_free_header(netcdf_header *header);

#endif
