/* snowglass/volume.h - a regular grid of samples with its place in the world.
 *
 * Voxels have their native type, x fastest, in the machine's byte order. A 4x4
 * matrix takes indices to the world: millimetres, RAS+ for medical data. */
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

/* Bytes of a value, 0 of NONE; its name; the type of a name ("float", too). */
SNOW_API size_t snow_type_size(snow_type type);
SNOW_API const char *snow_type_name(snow_type type);
SNOW_API snow_type snow_type_from_name(const char *name);
/* Picometres in a unit of length of any spelling, and its name; 0: no length.
 */
SNOW_API double snow_unit_length(const char *unit, char name[16]);

/* A channel: colour, below 0: not said; data values to show, 0s: not said. */
typedef struct snow_channel {
    double color[3], window[2];
    char name[40];
    bool shown, own; /* by the file; a part of the voxels' own colours */
} snow_channel;
#define SNOW_CHANNELS_MAX 8

typedef struct snow_volume_info {
    size_t size;
    int64_t dims[3];         /* voxels along x, y, z; each at least 1 */
    snow_type type;          /* native scalar type */
    double spacing[3];       /* length of the matrix' columns; above 0 */
    double matrix[4][4];     /* index -> world, row by row; last row 0 0 0 1 */
    double slope, intercept; /* data value = slope * native + intercept */
    bool medical;       /* the world is a patient's right, anterior, superior */
    char unit[16];      /* of spacing and matrix: "mm", "um", ... or "" */
    const char *format; /* constant: "raw", "nrrd", ..., "phantom", "memory" */
    int64_t times, time; /* steps in the file; the one read, from 0 */
    char storage[160];   /* for people: level, axes, chunks, packing; or "" */
    char modality[17], description[65]; /* DICOM; its series, a long name */
    double window[2];   /* data values that the file would show; 0s: none */
    int64_t components; /* of a vector in the file; else 0 or 1 */
    bool hounsfield, magnitude, eight_bits; /* HU; lengths; bytes, masked */
    double time_value; /* of the step, in time_unit; NaN: unknown */
    char time_unit[64], calendar[24], quantity[64], value_unit[32]; /* or "" */
    bool whole;       /* whole numbers, masked */
    int64_t channels; /* of voxels with several values; else 0 or 1 */
    snow_channel channel[SNOW_CHANNELS_MAX]; /* the first of them */
    bool negative, estimate; /* says the file: high is dark; statistics */
    uint64_t light;        /* bit n: channel n of several is of emitted light */
    double axis_scale[3];  /* world's length of a unit; below 0: down; 0: 1 */
    char axis_unit[3][16]; /* of the world's x, y, z; "": `unit`; "1": none */
    bool directions; /* says the file: three floats are a vector of space */
} snow_volume_info;
SNOW_RECORD(snow_volume_info);
typedef enum snow_endian {   /* byte order of raw data */
    SNOW_ENDIAN_DEFAULT = 0, /* little */
    SNOW_ENDIAN_LITTLE,
    SNOW_ENDIAN_BIG
} snow_endian;
/* Labels of a mask, both ends included; the most ranges, and clip planes. */
typedef struct snow_label_range {
    int64_t first, last;
} snow_label_range;
#define SNOW_LABELS_MAX 256
#define SNOW_CLIPS_MAX 6
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
    double clip[SNOW_CLIPS_MAX][4]; /* planes (snow_volume_clip) */
    bool each_time, channel_given;  /* no warning of other steps or channels */
    bool allow_gaps;       /* missing and cut slices are NaN, with a warning */
    const char *component; /* "x", "magnitude", ... or NULL (docs/formats.md) */
    const char *label_table; /* path: names and colours of labels; or NULL */
    bool each_channel, time_given; /* no warning of others: channels, steps */
    int64_t levels;  /* of refinement, so many of the coarsest; 0: all */
    const char *suv; /* PET: "bw", "lbm", "bsa", "none"; NULL: bw, if known */
    double
        z_scale; /* of the world's z; 0: of the earth's grids by their size */
    const char *vertical; /* WRF: "levels", "height"; NULL: levels */
} snow_volume_options;
SNOW_RECORD(snow_volume_options);
/* Opens a file (format by its first bytes, then its name; gzip is undone), "-"
 * for standard input, "phantom:NAME", or raw data where `dims` and `type` say
 * so. Errors: BAD_INPUT (missing, damaged, unsupported), BAD_USAGE, STOPPED. */
SNOW_API snow_status snow_volume_open(snow_context *context, const char *path,
    const snow_volume_options *options, snow_volume **out);
SNOW_API void snow_volume_close(snow_volume *volume);
/* Out of core (docs/larger.md): slabs of `slab_bytes` (0: 64 MiB) are read of a
 * file that must not change, for looks and pictures only. Seconds reading. */
SNOW_API snow_status snow_volume_open_streamed(snow_context *, const char *path,
    const snow_volume_options *options, uint64_t slab_bytes, snow_volume **out);
SNOW_API double snow_volume_read_seconds(const snow_volume *volume);
/* Without voxels, from the header; of bytes used in the call only, whose `name`
 * is for messages and its suffix; or copied by a function (fewer: failure). */
SNOW_API snow_status snow_volume_inspect(snow_context *, const char *path,
    const snow_volume_options *options, snow_volume_info *out);
SNOW_API snow_status snow_volume_open_memory(snow_context *, const char *name,
    const void *, size_t size, const snow_volume_options *, snow_volume **out);
typedef size_t snow_read_at_fn(void *user, uint64_t at, void *bytes, size_t);
SNOW_API snow_status snow_volume_open_with(snow_context *, const char *name,
    snow_read_at_fn *read_at, void *user, uint64_t size,
    const snow_volume_options *options, snow_volume **out);
/* Over the caller's voxels, not copied. Of `info` dims, type, matrix (0s: by
 * spacing, 0s: 1), slope (0: 1), intercept, medical, unit, modality, window,
 * value_unit, hounsfield, eight_bits and whole count. */
SNOW_API snow_status snow_volume_wrap(snow_context *context,
    const snow_volume_info *info, const void *voxels, snow_volume **out);
/* Promises that wrapped voxels stay, until called again: encodings are kept. */
SNOW_API void snow_volume_freeze(snow_volume *volume);
/* A test volume. `dims` NULL or 0s: its own size; `seed` moves random parts. */
SNOW_API snow_status snow_volume_open_phantom(snow_context *context,
    const char *name, const int64_t dims[3], uint64_t seed, snow_volume **out);

/* Voxels first .. first + count - 1 along x, y, z; 0: empty. */
typedef struct snow_box {
    int64_t first[3], count[3];
} snow_box;
/* A rank's part: a box, with neighbours' voxels around it. */
typedef struct snow_extent {
    size_t size;
    int64_t dims[3];   /* of the whole grid */
    int64_t stored[3]; /* voxel of the whole that is the first one here */
    int64_t first[3], count[3]; /* of the whole: its own voxels; 0: none */
} snow_extent;
SNOW_RECORD(snow_extent);
/* Makes a volume a part, whose dims and matrix are those of what it stores; by
 * default it is the whole. Errors: BAD_USAGE (boxes not within one another). */
SNOW_API snow_status snow_volume_set_extent(snow_volume *, const snow_extent *);
SNOW_API snow_status snow_volume_get_extent(const snow_volume *, snow_extent *);
/* The patient's name: UTF-8 or "", never written. Voxels: NULL in a file. */
SNOW_API const snow_volume_info *snow_volume_get_info(const snow_volume *);
SNOW_API const char *snow_volume_patient(const snow_volume *volume);
SNOW_API const void *snow_volume_voxels(const snow_volume *volume);
/* Over the finite data values, in double, in storage order. */
typedef struct snow_volume_statistics {
    size_t size;
    int64_t voxels, finite; /* all; finite ones */
    double min, max;        /* NaN when no voxel is finite */
    double sum, wsum;       /* wsum: of value * (linear index mod 1009 + 1) */
} snow_volume_statistics;
SNOW_RECORD(snow_volume_statistics);
SNOW_API snow_status snow_volume_get_statistics(
    const snow_volume *volume, snow_volume_statistics *out);
/* Whether a range of data values is a CT's, where no file names its unit. */
SNOW_API bool snow_are_hounsfield(const snow_volume_info *, double, double);
/* Finite v counts in bin floor((v - lo) / (hi - lo) * bins), hi in the last.
 * Errors: BAD_USAGE unless lo < hi, both finite, bins > 0. */
SNOW_API snow_status snow_volume_histogram(const snow_volume *volume, double lo,
    double hi, size_t bins, uint64_t *counts);
/* New volumes. In another type (NONE: the smallest), rounded for integers, or
 * with `range` spread over an integer of up to 32 bits. Errors: no fit. */
SNOW_API snow_status snow_volume_convert(const snow_volume *volume,
    snow_type type, const double range[2], snow_volume **out);

/* NaN, which is invisible, where the mask has none of the labels (without any:
 * 0 or NaN), in floats that hold the type. Another grid is resampled. */
SNOW_API snow_status snow_volume_mask(const snow_volume *volume,
    const snow_volume *mask, const snow_label_range *labels, size_t count,
    snow_volume **out);
/* The same where a x + b y + c z > d for any of up to SNOW_CLIPS_MAX planes. */
SNOW_API snow_status snow_volume_clip(const snow_volume *volume,
    const double *planes, size_t count, snow_volume **out);
/* Resamples *volume to a grid, unless it has it, by nearest voxels or linear.
 * Errors: BAD_INPUT (worlds that do not compare, docs/formats.md). */
SNOW_API snow_status snow_volume_regrid(
    snow_volume **volume, const snow_volume *grid, bool nearest);
/* Reads "1,4-7,-3" (below 2^53 both ways); false for other text, or no room. */
SNOW_API bool snow_labels_parse(
    const char *text, snow_label_range *ranges, size_t room, size_t *count);
/* Writes .nrrd, .nii, .nii.gz, .mha, .npy, .raw or .raw.gz, whole or not at
 * all. Errors: BAD_OUTPUT (an existing file, unless `overwrite`), suffix. */
SNOW_API snow_status snow_volume_save(
    const snow_volume *volume, const char *path, bool overwrite);

/* Entry `index` (from 0) of a list, NULL past the end. *version of an optional
 * library is NULL where it is missing; *formats need it. */
SNOW_API const char *snow_volume_format_suffix(size_t index);
SNOW_API const char *snow_phantom_name(size_t index);
SNOW_API const char *snow_phantom_description(size_t index);
SNOW_API const char *snow_format_name(size_t index);
SNOW_API const char *snow_format_description(size_t index);
SNOW_API const char *snow_library_name(
    size_t index, const char **version, const char **formats);

#endif
