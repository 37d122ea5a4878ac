/* snowglass/volume.h - a regular grid of samples with its place in the world.
 *
 * Voxels have their native type, x fastest, in the machine's byte order. A data
 * value is slope * native + intercept. A 4x4 matrix takes the indices of a
 * voxel to the place of its centre in the world, in the unit `unit`; where that
 * is "" and the volume is medical it is millimetres. The world of medical data
 * is RAS+: x grows to the patient's right, y to the front, z to the head. That
 * of ITK and DICOM is LPS: negate the first two rows of a matrix to change from
 * one to the other. */
#ifndef SNOWGLASS_VOLUME_H
#define SNOWGLASS_VOLUME_H

#include <snowglass/context.h>

typedef struct snow_volume snow_volume;

/* X(NAME, C type, text) for each scalar type, in the order of the enum. */
#define SNOW_TYPE_MAP(X)          \
    X(INT8, int8_t, "int8")       \
    X(UINT8, uint8_t, "uint8")    \
    X(INT16, int16_t, "int16")    \
    X(UINT16, uint16_t, "uint16") \
    X(INT32, int32_t, "int32")    \
    X(UINT32, uint32_t, "uint32") \
    X(INT64, int64_t, "int64")    \
    X(UINT64, uint64_t, "uint64") \
    X(FLOAT32, float, "float32")  \
    X(FLOAT64, double, "float64")

typedef enum snow_type {
    SNOW_TYPE_NONE = 0, /* not given */
#define SNOW_TYPE_ENUM(name, type, text) SNOW_TYPE_##name,
    SNOW_TYPE_MAP(SNOW_TYPE_ENUM)
#undef SNOW_TYPE_ENUM
} snow_type;

/* Returns the bytes of a value, 0 of NONE. */
SNOW_API size_t snow_type_size(snow_type type);

/* Returns the name of a type, such as "uint8". */
SNOW_API const char *snow_type_name(snow_type type);

/* Returns the type of a name, also of "float" and "double"; NONE for others. */
SNOW_API snow_type snow_type_from_name(const char *name);

/* Returns the picometres in a unit of length, in any spelling ("mm",
 * "Millimeters"), or 0 where it is no length. `name` (or NULL) gets the unit's
 * usual name. */
SNOW_API double snow_unit_length(const char *unit, char name[16]);

/* What a file says of one of several values of a voxel. */
typedef struct snow_channel {
    double color[3];  /* red, green, blue, 0 to 1; below 0: not said */
    double window[2]; /* data values to show; zeros: not said */
    char name[40];
    bool shown; /* the file shows it */
    bool own;   /* it is red, green or blue of the voxels' own colours */
} snow_channel;
#define SNOW_CHANNELS_MAX 8

/* What is known of a volume. Texts that are not known are "". */
typedef struct snow_volume_info {
    size_t size;
    int64_t dims[3];         /* voxels along x, y, z; each at least 1 */
    snow_type type;          /* native scalar type */
    double spacing[3];       /* length of the matrix' columns; above 0 */
    double matrix[4][4];     /* index to world, row by row; last 0 0 0 1 */
    double slope, intercept; /* data value = slope * native + intercept */
    bool medical;       /* the world is a patient's right, anterior, superior */
    char unit[16];      /* of spacing and matrix: "mm", "um", ... or "" */
    const char *format; /* constant: "raw", "nrrd", ..., "phantom", "memory" */
    int64_t times;      /* steps in the file */
    int64_t time;       /* the step that was read, from 0 */
    char storage[160];  /* for people: level, axes, chunks, packing */
    char modality[17];  /* of DICOM: "CT", "MR", "PT", ... */
    char description[65]; /* of the DICOM series; a long name */
    double window[2];     /* data values that the file would show; 0s: none */
    int64_t components;   /* of a vector in the file; else 0 or 1 */
    bool hounsfield;      /* data values are Hounsfield units */
    bool magnitude;       /* data values are lengths of vectors */
    bool eight_bits;      /* values were bytes before a mask made them floats */
    double time_value;    /* of the step, in time_unit; NaN: unknown */
    char time_unit[64], calendar[24];  /* of time_value, by CF conventions */
    char quantity[64], value_unit[32]; /* what is measured, and its unit */
    bool whole;       /* values were whole numbers before they were masked */
    int64_t channels; /* of voxels with several values; else 0 or 1 */
    snow_channel channel[SNOW_CHANNELS_MAX]; /* the first of them */
    bool negative;         /* the file says: high values are dark */
    bool estimate;         /* the file says: the values are of statistics */
    uint64_t light;        /* bit n: channel n of several is of emitted light */
    double axis_scale[3];  /* world's length of a unit; below 0: down; 0: 1 */
    char axis_unit[3][16]; /* of the world's x, y, z; "": `unit`; "1": none */
    bool directions; /* the file says: three floats are a vector of space */
} snow_volume_info;
SNOW_RECORD(snow_volume_info);

typedef enum snow_endian {   /* byte order of raw data */
    SNOW_ENDIAN_DEFAULT = 0, /* little */
    SNOW_ENDIAN_LITTLE,
    SNOW_ENDIAN_BIG
} snow_endian;

/* Labels of a mask from first to last, both included. */
typedef struct snow_label_range {
    int64_t first, last;
} snow_label_range;
#define SNOW_LABELS_MAX 256 /* the most ranges */
#define SNOW_CLIPS_MAX 6    /* the most clip planes */

/* What a value names: red, green, blue and opacity; below 0: not said. */
typedef struct snow_label {
    double value, color[4];
    char name[64]; /* or "" */
} snow_label;

/* How to open a volume. The defaults (zeros) suit every format but raw. */
typedef struct snow_volume_options {
    size_t size;
    int64_t dims[3];     /* raw, phantoms: voxels along x, y, z */
    snow_type type;      /* raw */
    snow_endian endian;  /* raw */
    double spacing[3];   /* replaces the file's; raw: 0 for 1 mm */
    uint64_t offset;     /* raw: bytes to skip before the voxels */
    int64_t time;        /* step of a file with several, from 0; -1: the last */
    int64_t crop[3][2];  /* first voxel, one past the last or 0; zeros: all */
    int64_t channel;     /* of voxels with several values, from 0 */
    const char *dataset; /* path (HDF5, Zarr) or name (VTK, NetCDF); or NULL */
    const char *series;  /* DICOM: UID or number; NULL: the largest */
    const char *mask;   /* path, read with the same crop and spacing; or NULL */
    const char *labels; /* of the mask, else the volume; NULL: all but 0 */
    double clip[SNOW_CLIPS_MAX][4]; /* snow_volume_clip; zeros: none */
    bool each_time, channel_given;  /* no warning of other steps or channels */
    bool allow_gaps;       /* missing and cut slices are NaN, with a warning */
    const char *component; /* "x", "magnitude", ... or NULL (docs/formats.md) */
    const char *label_table; /* path: names and colours of labels; or NULL */
    bool each_channel, time_given; /* no warning of others: channels, steps */
    int64_t levels;  /* of refinement, so many of the coarsest; 0: all */
    const char *suv; /* PET: "bw", "lbm", "bsa", "none"; NULL: bw, if known */
    double z_scale;  /* of the world's z; 0: earth's grids by their size */
    const char *vertical; /* WRF: "levels", "height"; NULL: levels */
} snow_volume_options;
SNOW_RECORD(snow_volume_options);

/* Opens a file; docs/formats.md lists the formats. The first bytes decide on
 * the format, then the name; gzip is undone. "-" is standard input,
 * "phantom:NAME" a test volume. A file is raw data where options give `dims`
 * and `type`. Errors: BAD_INPUT (missing, damaged, unsupported), BAD_USAGE (an
 * option that the file does not have), STOPPED. */
SNOW_API snow_status snow_volume_open(snow_context *context, const char *path,
    const snow_volume_options *options, snow_volume **out);

/* Opens a file whose voxels stay there (docs/larger.md): slabs of at most
 * `slab_bytes` (0: 64 MiB) are read for each look and picture. The file must
 * not change. Calls that need all voxels refuse it with BAD_USAGE. Errors: as
 * snow_volume_open. */
SNOW_API snow_status snow_volume_open_streamed(snow_context *context,
    const char *path, const snow_volume_options *options, uint64_t slab_bytes,
    snow_volume **out);

/* Returns the seconds spent in reading slabs so far; 0 where none are read. */
SNOW_API double snow_volume_read_seconds(const snow_volume *volume);

/* Reads what the header of a file says, without its voxels. Errors: as
 * snow_volume_open. */
SNOW_API snow_status snow_volume_inspect(snow_context *context,
    const char *path, const snow_volume_options *options,
    snow_volume_info *out);

/* Opens the bytes of a file in memory, which are not needed after the call. The
 * suffix of `name` may decide on the format; messages begin with it. Errors: as
 * snow_volume_open. */
SNOW_API snow_status snow_volume_open_memory(snow_context *context,
    const char *name, const void *bytes, size_t size,
    const snow_volume_options *options, snow_volume **out);

/* Copies `count` bytes from place `at` on to `bytes`, and returns how many it
 * copied; fewer are a failure. */
typedef size_t snow_read_at_fn(
    void *user, uint64_t at, void *bytes, size_t count);

/* Opens a file of `size` bytes that a function reads, which is called by this
 * thread, and not after this call. Errors: as snow_volume_open. */
SNOW_API snow_status snow_volume_open_with(snow_context *context,
    const char *name, snow_read_at_fn *read_at, void *user, uint64_t size,
    const snow_volume_options *options, snow_volume **out);

/* Makes a volume over the caller's voxels, which are not copied and must stay
 * as long as the volume. Of `info` these fields count: dims, type, matrix (last
 * row 0 0 0 0 or 0 0 0 1; all zeros: by spacing), spacing (0: 1), slope (0: 1),
 * intercept, medical, unit, modality, window, quantity, value_unit,
 * description, hounsfield, eight_bits and whole. Where the matrix is given,
 * spacing is measured from it. Time and channels are not taken. */
SNOW_API snow_status snow_volume_wrap(snow_context *context,
    const snow_volume_info *info, const void *voxels, snow_volume **out);

/* Promises that the voxels of a wrapped volume do not change until this is
 * called again; so a frame keeps its encodings from picture to picture. */
SNOW_API void snow_volume_freeze(snow_volume *volume);

/* Makes a test volume (snow_phantom_name). `dims` NULL or zeros: its own size.
 * `seed` moves random parts. Errors: BAD_USAGE (no such name). */
SNOW_API snow_status snow_volume_open_phantom(snow_context *context,
    const char *name, const int64_t dims[3], uint64_t seed, snow_volume **out);

/* Closes a volume, and frees what it owns. */
SNOW_API void snow_volume_close(snow_volume *volume);

/* Voxels first .. first + count - 1 along x, y, z; a count of 0: empty. */
typedef struct snow_box {
    int64_t first[3], count[3];
} snow_box;

/* A rank's part of a volume: a box, with neighbours' voxels around it. */
typedef struct snow_extent {
    size_t size;
    int64_t dims[3];   /* of the whole grid */
    int64_t stored[3]; /* voxel of the whole that is the first one here */
    int64_t first[3], count[3]; /* of the whole: its own voxels; 0: none */
} snow_extent;
SNOW_RECORD(snow_extent);

/* Makes a volume a part of a whole; its dims and matrix are those of what it
 * stores. By default a volume is the whole. Errors: BAD_USAGE (the boxes do not
 * lie within one another). */
SNOW_API snow_status snow_volume_set_extent(
    snow_volume *volume, const snow_extent *part);

/* Fills *out with the part that a volume is. */
SNOW_API snow_status snow_volume_get_extent(
    const snow_volume *volume, snow_extent *out);

/* Returns what is known of a volume. */
SNOW_API const snow_volume_info *snow_volume_get_info(
    const snow_volume *volume);

/* Returns the patient's name in UTF-8, or "". It is never written. */
SNOW_API const char *snow_volume_patient(const snow_volume *volume);

/* Returns the voxels, dims[0] * dims[1] * dims[2] native values; NULL where
 * they stay in a file. */
SNOW_API const void *snow_volume_voxels(const snow_volume *volume);

/* Figures of the finite data values, in double precision and storage order. */
typedef struct snow_volume_statistics {
    size_t size;
    int64_t voxels, finite; /* all; finite ones */
    double min, max;        /* NaN when no voxel is finite */
    double sum;
    double wsum; /* a checksum: of value * (linear index mod 1009 + 1) */
} snow_volume_statistics;
SNOW_RECORD(snow_volume_statistics);

/* Measures a volume. Errors: STOPPED. */
SNOW_API snow_status snow_volume_get_statistics(
    const snow_volume *volume, snow_volume_statistics *out);

/* Returns whether a range of data values is that of Hounsfield units, where the
 * file does not name its unit. */
SNOW_API bool snow_are_hounsfield(
    const snow_volume_info *info, double low, double high);

/* Counts finite data values in `bins` bins of one width from lo to hi: v counts
 * in floor((v - lo) / (hi - lo) * bins), and hi in the last. Errors: BAD_USAGE
 * (unless lo < hi, both finite, and bins > 0; voxels in a file), STOPPED
 * (`counts` hold a part). */
SNOW_API snow_status snow_volume_histogram(const snow_volume *volume, double lo,
    double hi, size_t bins, uint64_t *counts);

/* Makes a volume of another type; NONE stands for the smallest that holds all
 * values. Values are rounded to integers. With `range` (or NULL), its data
 * values are spread over all that an integer of 8, 16 or 32 bits holds. Errors:
 * BAD_USAGE (values that do not fit the type, a range that is empty). */
SNOW_API snow_status snow_volume_convert(const snow_volume *volume,
    snow_type type, const double range[2], snow_volume **out);

/* Makes a volume of floats with NaN, which is invisible, where the mask has
 * none of `count` ranges of labels; where count is 0, where the mask is 0 or
 * NaN. A mask of another grid is resampled. Errors: BAD_INPUT (worlds that do
 * not compare, docs/formats.md), BAD_USAGE (voxels in a file), STOPPED. */
SNOW_API snow_status snow_volume_mask(const snow_volume *volume,
    const snow_volume *mask, const snow_label_range *labels, size_t count,
    snow_volume **out);

/* The same where a voxel's centre is beyond one of `count` planes, at most
 * SNOW_CLIPS_MAX. `planes` holds four numbers for each: a, b, c, d in the
 * world; beyond is a x + b y + c z > d. Four zeros are no plane. Errors:
 * BAD_USAGE (a number that is not finite, a normal of 0 0 0, too many planes,
 * voxels in a file), STOPPED. */
SNOW_API snow_status snow_volume_clip(const snow_volume *volume,
    const double *planes, size_t count, snow_volume **out);

/* Resamples *volume to the grid of another, by nearest voxels or linear. The
 * old volume is closed, and *volume replaced, unless it has that grid already.
 * A failure leaves both as they were. Errors: BAD_INPUT (worlds that do not
 * compare, docs/formats.md), STOPPED. */
SNOW_API snow_status snow_volume_regrid(
    snow_volume **volume, const snow_volume *grid, bool nearest);

/* Reads a list of labels, such as "1,4-7,-3", below 2^53 both ways, into at
 * most `room` ranges. Returns false for other text, or where room is short. */
SNOW_API bool snow_labels_parse(
    const char *text, snow_label_range *ranges, size_t room, size_t *count);

/* Writes .nrrd, .nii, .nii.gz, .mha, .npy, .raw or .raw.gz, whole or not at
 * all. Errors: BAD_OUTPUT (the file exists, without `overwrite`, or cannot be
 * written), BAD_USAGE (another suffix, what a format cannot hold), STOPPED. */
SNOW_API snow_status snow_volume_save(
    const snow_volume *volume, const char *path, bool overwrite);

/* Return entry `index` (from 0) of a list, NULL past the end: suffixes that
 * snow_volume_save takes, test volumes, and formats that are read. */
SNOW_API const char *snow_volume_format_suffix(size_t index);
SNOW_API const char *snow_phantom_name(size_t index);
SNOW_API const char *snow_phantom_description(size_t index);
SNOW_API const char *snow_format_name(size_t index);
SNOW_API const char *snow_format_description(size_t index);

/* Returns the name of optional library `index` (from 0), NULL past the end.
 * *version is NULL where this build lacks it; *formats names what needs it. */
SNOW_API const char *snow_library_name(
    size_t index, const char **version, const char **formats);

#endif
