/* formats/nrrd/nrrd.h - the parts of the NRRD reader, private to this folder.
 *
 *   text.c    lines      -> nrrd_text    fields by name, still as text
 *   header.c  nrrd_text  -> nrrd_header  numbers and names parsed
 *   grid.c    axes       -> volume info  the spatial axes, the matrix
 *   files.c   data file  -> nrrd_files   the files with the voxels
 *   data.c    files      -> voxels
 *   unpack.c  the encodings of binary data
 *
 * formats/ascii.c reads the encoding "ascii".
 *
 * After "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html
 * (versions 1 to 5). */
#ifndef SNOW_FORMATS_NRRD_NRRD_H
#define SNOW_FORMATS_NRRD_NRRD_H

#include "formats/array.h"

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
    char *block; /* NULL while it is empty */
    size_t used;
    size_t value[NRRD_FIELD_COUNT]; /* offset in block, 0: no such field */
    size_t list;                    /* offset of the listed names */
    uint64_t listed;                /* number of names; each is a string */
    nrrd_segment *segments;         /* NULL: none */
    size_t segment_count;
} nrrd_text;

typedef enum nrrd_encoding {
    NRRD_RAW,
    NRRD_GZIP,
    NRRD_BZIP2,
    NRRD_HEX,
    NRRD_ASCII
} nrrd_encoding;

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
    snow_type type;
    nrrd_encoding encoding;
    bool big_endian;
    int dimension;
    nrrd_axis axes[NRRD_MOST_AXES];
    bool directions;  /* some axis has one */
    double origin[4]; /* 0 if not given */
    double turn[3];   /* 1 or -1: converts world axes to right-handed or RAS+ */
    bool medical;
    char space_units[4][16]; /* of the world's axes, as the file has them */
    int space_unit_count;    /* 0: not given */
    uint64_t line_skip;
    int64_t byte_skip; /* -1: the data are the last bytes */
} nrrd_header;

typedef enum nrrd_place {
    NRRD_ATTACHED, /* after the header */
    NRRD_SINGLE,
    NRRD_LIST,
    NRRD_PATTERN
} nrrd_place;

/* The data files, each with the same number of bytes. */
typedef struct nrrd_files {
    nrrd_place place;
    uint64_t count;   /* at least 1 */
    const char *name; /* file name, first name of a list, pattern */
    size_t name_bytes;
    int64_t first, step; /* of the numbers in a pattern */
} nrrd_files;

/* Reads up to the end of the header.  The block must be released whatever the
 * status. */
snow_status snow_nrrd_read_text(snow_source *source, nrrd_text *text);

/* A field's value, NULL if it is missing. */
const char *snow_nrrd_value(const nrrd_text *text, nrrd_field field);
const char *snow_nrrd_field_name(nrrd_field field);

snow_status snow_nrrd_parse_header(snow_context *context, const nrrd_text *text,
                                   nrrd_header *out);

/* Sets dims, matrix, times and all else of the info; applies the time step and
 * the box of the options, and finds their place in the array.  Where the voxels
 * of a volume do not follow one another, values->all is not 0, and the box is
 * left to snow_nrrd_read_values. */
snow_status snow_nrrd_lay_out(snow_context *context, nrrd_header *header,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_region *region,
                              snow_array *values);

snow_status snow_nrrd_find_files(snow_context *context, const nrrd_text *text,
                                 const nrrd_header *header, nrrd_files *out);

/* Declares that the bytes from here on are in the encoding; ascii is left to
 * those who read numbers. */
snow_status snow_nrrd_unpack(snow_source *source, nrrd_encoding encoding);

/* Writes the name of file `index` as a string into `name`; `*at`, NULL before
 * the first call, keeps the position in a list, whose files are requested in
 * order. */
snow_status snow_nrrd_file_name(snow_context *context, const nrrd_files *files,
                                uint64_t index, const char **at, char *name,
                                size_t size);

/* Checks that data after the header can be complete; `source` is positioned
 * there.  Data in other files are not checked. */
snow_status snow_nrrd_check_data(snow_source *source, const nrrd_header *header,
                                 const nrrd_files *files,
                                 const snow_region *region);

/* Makes the volume of values that lie apart, or of the header alone its
 * info. */
snow_status snow_nrrd_read_values(snow_source *source,
                                  const nrrd_header *header,
                                  const nrrd_files *files,
                                  const snow_volume_options *options,
                                  const snow_array *values,
                                  snow_volume_info *info, snow_volume **out);

/* Makes the volume; `source` is positioned after the header. */
snow_status snow_nrrd_read_data(snow_source *source, const nrrd_header *header,
                                const nrrd_files *files,
                                const snow_volume_info *info,
                                const snow_region *region, snow_volume **out);

#endif
