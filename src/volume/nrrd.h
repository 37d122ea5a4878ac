/* volume/nrrd.h - the parts of the NRRD reader; for nrrd*.c alone.
 *
 *   nrrd_text.c    lines      -> nrrd_text    fields by name, still as text
 *   nrrd_header.c  nrrd_text  -> nrrd_header  numbers and names understood
 *   nrrd_grid.c    axes       -> volume info  which axes are space, the matrix
 *   nrrd_files.c   data file  -> nrrd_files   which files hold the voxels
 *   nrrd_data.c    files      -> voxels       through the encoding
 *
 * numbers.c beside them reads the encoding "ascii".
 *
 * After "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html
 * (versions 1 to 5). */
#ifndef SNOW_NRRD_H
#define SNOW_NRRD_H

#include "volume/volume.h"

#define NRRD_MOST_AXES 16

/* X(NAME, spelling, other spelling); the format ignores case.  Fields that say
 * nothing about where a voxel lies or what it is worth are known but unused.
 * The axes' ends ("axis mins" and "axis maxs", with "centers") are heeded where
 * neither spacings nor directions are told, which come before them; min and max
 * are of the values, which are measured, not believed. */
#define NRRD_FIELD_MAP(X)                         \
    X(TYPE, "type", "")                           \
    X(DIMENSION, "dimension", "")                 \
    X(SIZES, "sizes", "")                         \
    X(ENCODING, "encoding", "")                   \
    X(ENDIAN, "endian", "")                       \
    X(SPACINGS, "spacings", "")                   \
    X(DIRECTIONS, "space directions", "")         \
    X(SPACE, "space", "")                         \
    X(ORIGIN, "space origin", "")                 \
    X(SPACE_DIMENSION, "space dimension", "")     \
    X(SPACE_UNITS, "space units", "")             \
    X(UNITS, "units", "")                         \
    X(KINDS, "kinds", "")                         \
    X(LINE_SKIP, "line skip", "lineskip")         \
    X(BYTE_SKIP, "byte skip", "byteskip")         \
    X(DATA_FILE, "data file", "datafile")         \
    X(BLOCK_SIZE, "block size", "blocksize")      \
    X(MEASUREMENT_FRAME, "measurement frame", "") \
    X(CENTERS, "centers", "centerings")           \
    X(THICKNESSES, "thicknesses", "")             \
    X(AXIS_MINS, "axis mins", "axismins")         \
    X(AXIS_MAXS, "axis maxs", "axismaxs")         \
    X(LABELS, "labels", "")                       \
    X(CONTENT, "content", "")                     \
    X(NUMBER, "number", "")                       \
    X(MIN, "min", "")                             \
    X(MAX, "max", "")                             \
    X(OLD_MIN, "old min", "oldmin")               \
    X(OLD_MAX, "old max", "oldmax")               \
    X(SAMPLE_UNITS, "sample units", "sampleunits")

typedef enum nrrd_field {
#define NRRD_FIELD_ENUM(name, text, other) NRRD_##name,
    NRRD_FIELD_MAP(NRRD_FIELD_ENUM)
#undef NRRD_FIELD_ENUM
        NRRD_FIELD_COUNT
} nrrd_field;

/* A header's text: each field's value as a string in `block`, and after them
 * the names of the data files where the header lists them. */
typedef struct nrrd_text {
    char *block; /* NULL until something is in it */
    size_t used, capacity;
    size_t value[NRRD_FIELD_COUNT]; /* offset in block, 0: no such field */
    size_t list;                    /* offset of the listed names */
    uint64_t listed;                /* how many; each a string */
} nrrd_text;

typedef enum nrrd_encoding { NRRD_RAW, NRRD_GZIP, NRRD_ASCII } nrrd_encoding;

/* What an axis of the array runs over. */
typedef enum nrrd_role {
    NRRD_AXIS_UNTOLD, /* space, unless there are too many axes */
    NRRD_AXIS_SPACE,
    NRRD_AXIS_TIME,  /* or a list of volumes */
    NRRD_AXIS_VALUES /* components of a colour, a vector, a tensor */
} nrrd_role;

typedef struct nrrd_axis {
    int64_t size;
    double spacing;      /* 1 when not told; below 0: runs backwards */
    double first;        /* where sample 0 lies along it; 0 when not told */
    double direction[4]; /* world step; the 4th is time */
    bool directed;       /* has a direction */
    nrrd_role role;
} nrrd_axis;

typedef struct nrrd_header {
    snow_type type;
    nrrd_encoding encoding;
    bool big_endian;
    int dimension;
    nrrd_axis axes[NRRD_MOST_AXES];
    bool directions;  /* the field is there */
    double origin[4]; /* 0 when not told */
    double turn[3];   /* 1 or -1: takes world axes to right-handed or RAS+ */
    bool medical;
    char unit[16];
    uint64_t line_skip;
    int64_t byte_skip; /* -1: the data are the last bytes */
} nrrd_header;

typedef enum nrrd_place {
    NRRD_ATTACHED, /* behind the header */
    NRRD_SINGLE,
    NRRD_LIST,
    NRRD_PATTERN
} nrrd_place;

/* The files with the data, each with the same number of bytes. */
typedef struct nrrd_files {
    nrrd_place place;
    uint64_t count;   /* at least 1 */
    const char *name; /* file name, first name of a list, pattern */
    size_t name_bytes;
    int64_t first, step; /* of a pattern's numbers */
} nrrd_files;

/* Reads up to the end of the header.  The block is to be released whatever the
 * status. */
snow_status snow_nrrd_read_text(snow_source *source, nrrd_text *text);

/* A field's value, NULL when it is not there. */
const char *snow_nrrd_value(const nrrd_text *text, nrrd_field field);
const char *snow_nrrd_field_name(nrrd_field field);

snow_status snow_nrrd_parse_header(snow_context *context, const nrrd_text *text,
                                   nrrd_header *out);

/* Fills dims, matrix, times and what else the info holds; takes the time step
 * and the box of the options, and tells their place in the array. */
snow_status snow_nrrd_lay_out(snow_context *context, const nrrd_header *header,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_window *window);

snow_status snow_nrrd_find_files(snow_context *context, const nrrd_text *text,
                                 const nrrd_header *header, nrrd_files *out);

/* Writes the name of file `index` as a string into `name`; `*at`, NULL before
 * the first call, remembers the place in a list, whose files are asked for in
 * order. */
snow_status snow_nrrd_file_name(snow_context *context, const nrrd_files *files,
                                uint64_t index, const char **at, char *name,
                                size_t size);

/* Whether data behind the header can be all there; `source` stands there.  Of
 * files beside it nothing is looked at. */
snow_status snow_nrrd_check_data(snow_source *source, const nrrd_header *header,
                                 const nrrd_files *files,
                                 const snow_window *window);

/* Makes the volume; `source` stands behind the header. */
snow_status snow_nrrd_read_data(snow_source *source, const nrrd_header *header,
                                const nrrd_files *files,
                                const snow_volume_info *info,
                                const snow_window *window, snow_volume **out);

#endif
