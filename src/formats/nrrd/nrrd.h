/* formats/nrrd/nrrd.h - the parts of the NRRD reader, private to this folder.
 *
 *   text.c    lines      -> nrrd_text    fields by name, still as text
 *   header.c  nrrd_text  -> nrrd_header  numbers and names parsed
 *   grid.c    axes       -> volume info  the spatial axes, the matrix
 *   nrrd.c    data file  -> snow_detached  the files with the voxels
 *
 * formats/detached/detached.c reads these.
 *
 * After "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html
 * (versions 1 to 5). */
#ifndef SNOW_FORMATS_NRRD_NRRD_H
#define SNOW_FORMATS_NRRD_NRRD_H

#include "formats/detached/detached.h"

#define NRRD_MOST_AXES 16

/* X(NAME, spelling, other spelling); the format ignores case.  Fields that do
 * not affect positions or values are known but unused.  The axes' ends ("axis
 * mins" and "axis maxs", with "centers") are used if neither spacings nor
 * directions are given, which have priority.  min and max describe the values,
 * which are measured instead. */
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

/* A segment of 3D Slicer; of overlapping ones each layer is a volume. */
typedef struct nrrd_segment {
    snow_label label; /* its value is NaN if not given */
    int64_t layer;    /* -1: not given */
} nrrd_segment;

/* The text of a header: each field's value as a string in `block`, followed by
 * the names of the data files if the header lists them. */
typedef struct nrrd_text {
    snow_context *context;
    char *block; /* NULL while it is empty */
    size_t used;
    size_t value[NRRD_FIELD_COUNT]; /* offset in block, 0: no such field */
    size_t list;                    /* offset of the listed names */
    uint64_t listed;                /* number of names; each is a string */
    nrrd_segment *segments;         /* NULL: none */
    size_t segment_count;
} nrrd_text;

/* What an axis of the array is. */
typedef enum nrrd_role {
    NRRD_AXIS_UNKNOWN, /* spatial, unless there are too many axes */
    NRRD_AXIS_SPACE,
    NRRD_AXIS_TIME,
    NRRD_AXIS_LIST,   /* of volumes */
    NRRD_AXIS_COLORS, /* red, green, blue and perhaps opacity */
    NRRD_AXIS_VECTOR,
    NRRD_AXIS_VALUES /* of a tensor, or of an unknown kind */
} nrrd_role;

typedef struct nrrd_axis {
    int64_t size;
    double spacing;      /* 1 if not given; below 0: reversed */
    double first;        /* position of sample 0 along it; 0 if not given */
    double direction[4]; /* world step; the 4th is time */
    bool directed;       /* has a direction */
    nrrd_role role;
    char unit[16]; /* of its spacing, as the file has it; or "" */
} nrrd_axis;

typedef struct nrrd_header {
    snow_context *context;
    snow_detached data;
    int dimension;
    nrrd_axis axes[NRRD_MOST_AXES];
    bool directions;  /* some axis has one */
    double origin[4]; /* 0 if not given */
    double turn[3];   /* 1 or -1: converts world axes to right-handed or RAS+ */
    bool medical;
    char space_units[4][16]; /* of the world's axes, as the file has them */
    int space_unit_count;    /* 0: not given */
} nrrd_header;

/* Reads up to the end of the header.  The block must be released whatever the
 * status. */
snow_status snow_nrrd_read_text(snow_source *source, nrrd_text *text);

/* A field's value, NULL if it is missing. */
const char *snow_nrrd_value(const nrrd_text *text, nrrd_field field);
const char *snow_nrrd_field_name(nrrd_field field);

snow_status snow_nrrd_parse_header(const nrrd_text *text, nrrd_header *out);

/* Sets dims, matrix, times and all else of the info; applies the time step of
 * the options.  Where the voxels of a volume do not follow one another,
 * values->all is not 0. */
snow_status snow_nrrd_lay_out(nrrd_header *header,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_array *values);

#endif
