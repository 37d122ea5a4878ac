/* snowglass/volume.h - a regular grid of samples with its place in the world.
 *
 * A volume keeps its voxels in their native scalar type, x fastest, in the
 * machine's byte order, without padding.  One 4x4 matrix takes voxel indices
 * (samples sit at integers) to world coordinates: millimetres, RAS+ for
 * medical data. */
#ifndef SNOWGLASS_VOLUME_H
#define SNOWGLASS_VOLUME_H

#include <snowglass/context.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

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
    SNOW_TYPE_NONE = 0, /* not told */
#define SNOW_TYPE_ENUM(name, type, text) SNOW_TYPE_##name,
    SNOW_TYPE_MAP(SNOW_TYPE_ENUM)
#undef SNOW_TYPE_ENUM
} snow_type;

/* Bytes of one value (0 for SNOW_TYPE_NONE); the type's name ("none"); the
 * type of a name, SNOW_TYPE_NONE when unknown.  "float" and "double" are
 * understood as float32 and float64. */
SNOW_API size_t snow_type_size(snow_type type);
SNOW_API const char *snow_type_name(snow_type type);
SNOW_API snow_type snow_type_from_name(const char *name);

/* What is known of a volume beside its voxels. */
typedef struct snow_volume_info {
    size_t size;
    int64_t dims[3];     /* voxels along x, y, z; each at least 1 */
    snow_type type;      /* native scalar type */
    double spacing[3];   /* length of the matrix' columns; above 0 */
    double matrix[4][4]; /* index -> world, row by row; last row 0 0 0 1 */
    double slope;        /* data value = slope * native + intercept; */
    double intercept;    /*   1 and 0 when the file says nothing */
    bool medical;        /* world axes are a patient's right, anterior,
                            superior */
    char unit[16];       /* of spacing and matrix: "mm", "um", ... or "" */
    const char *format;  /* constant: "raw", "nrrd", "nifti", "metaimage",
                            "npy", "mrc", "vtk", "vti", "tiff", "png",
                            "hdf5", "netcdf", "dicom", "den", "zarr",
                            "phantom", "memory" */
    int64_t times;       /* time steps in the file, at least 1 */
    int64_t time;        /* the one that was read, from 0 */
    char storage[160];   /* how the file keeps the voxels, for people: level,
                            axes, chunks, packing; "" when the reader tells
                            nothing of it */
} snow_volume_info;
SNOW_RECORD(snow_volume_info);

/* Byte order of raw data. */
typedef enum snow_endian {
    SNOW_ENDIAN_DEFAULT = 0, /* little */
    SNOW_ENDIAN_LITTLE,
    SNOW_ENDIAN_BIG
} snow_endian;

/* Labels of a mask from `first` to `last`, both included. */
typedef struct snow_label_range {
    int64_t first, last;
} snow_label_range;

/* Ranges that one list of labels may have. */
#define SNOW_LABELS_MAX 256

/* Planes that one volume may be clipped by. */
#define SNOW_CLIPS_MAX 6

/* How to open a volume.  Zero everywhere is right for every format but raw. */
typedef struct snow_volume_options {
    size_t size;
    int64_t dims[3];     /* raw only: voxels along x, y, z; 0: not told */
    snow_type type;      /* raw only: scalar type */
    snow_endian endian;  /* raw only: byte order */
    double spacing[3];   /* raw: voxel size in mm, 0 for 1; other formats:
                            replaces the file's spacing, 0 keeps it */
    uint64_t offset;     /* raw only: bytes to skip before the voxels */
    int64_t time;        /* time step of a file with several, from 0 */
    int64_t crop[3][2];  /* along x, y, z: the first voxel and one past the last
                            one, 0 for the end; all 0: the whole volume */
    int64_t channel;     /* of voxels with several values, from 0 */
    const char *dataset; /* of a file with several data sets, the one to read:
                            a path in HDF5 and Zarr, a name in VTK, VTI and
                            NetCDF; NULL: the only one, or the file's own choice
                          */
    const char *series;  /* of DICOM images of several series, the one to read:
                            its UID, or its number in the remark that lists
                            them; NULL: the largest */
    const char *mask;    /* a volume on the same grid: voxels outside it have no
                            value (snow_volume_mask); NULL: none.  It is read
                            with the same crop and spacing; one with a single
                            time step is that of all */
    const char *labels;  /* of the mask, those inside (snow_labels_parse); NULL:
                            all but 0 */
    /* Planes a, b, c, d of the world: voxels where a x + b y + c z > d have no
     * value (snow_volume_clip); one whose a, b, c are 0 is none. */
    double clip[SNOW_CLIPS_MAX][4];
    bool each_time; /* all time steps are opened in turn: no remark tells that
                       this is one of several */
} snow_volume_options;
SNOW_RECORD(snow_volume_options);

/* Opens a volume file.  The format is found from the first bytes, then from
 * the name; gzip around any single file is undone.  A file that no reader
 * knows is raw and needs `dims` and `type`.  "phantom:NAME" makes a built-in
 * volume (options->dims then gives its size; 0 for the default).  `options`
 * may be NULL.  Of a volume that is cropped little more than the box is read
 * and kept; it is a volume of its own, whose matrix puts it where it was.  A
 * mask and planes are applied to what was read.
 * Errors: SNOW_STATUS_BAD_INPUT (missing, damaged, contradictory, unsupported;
 * nothing is kept), SNOW_STATUS_BAD_USAGE (options that do not fit the format),
 * SNOW_STATUS_NO_MEMORY.  Close with snow_volume_close. */
SNOW_API snow_status snow_volume_open(snow_context *context, const char *path,
                                      const snow_volume_options *options,
                                      snow_volume **out);

/* Opens a volume that is larger than the memory there is for it: its voxels
 * stay in the file.  What needs them reads them again, in slabs along z of up
 * to `slab_bytes` bytes (0: 64 MiB; a slab of more where fewer slices do not
 * serve: pictures with slices along x and y take 32 of z, and neighbours), and
 * drops them.  The volume goes where others go, and pictures and looks are the
 * same bit for bit as of snow_volume_open (but drafts of few pixels, which are
 * made of all voxels here, and not of a level of fewer):
 *
 *   snow_transfer_new_for_volume   reads it once, and types of more than 16
 * bits a few times snow_frame_render    reads it where a volume in memory is
 * encoded, and keeps the interesting voxels: for the first picture, another
 * opacity function or threshold, and another slice axis; encoding AUTO is the
 * bit-map.  And for each depth, and each picture of mode iso or by another
 * method than sheared, asked for or left to footprint: depths and the latter
 * may differ by rounding, their slabs are sized by the context's limit, and
 * deterministic ones are SNOW_STATUS_NO_MEMORY
 *
 * All else that looks at voxels refuses it (SNOW_STATUS_BAD_USAGE),
 * snow_volume_voxels is NULL, and snow_volume_get_statistics finds no finite
 * value. Path and options are copied; the file must stay as it is and where it
 * is. Errors: as snow_volume_inspect; SNOW_STATUS_BAD_USAGE (standard input, a
 * pipe); of later readings those of snow_volume_open. */
SNOW_API snow_status snow_volume_open_streamed(
    snow_context *context, const char *path, const snow_volume_options *options,
    uint64_t slab_bytes, snow_volume **out);

/* Seconds that reading its slabs has taken so far; 0 of other volumes, and not
 * part of the figures of looks and pictures. */
SNOW_API double snow_volume_read_seconds(const snow_volume *volume);

/* What snow_volume_open would make, without its voxels: of the file's little
 * more than the header is read, and what is behind it is not verified.
 * Standard input is used up.  Errors: as snow_volume_open. */
SNOW_API snow_status snow_volume_inspect(snow_context *context,
                                         const char *path,
                                         const snow_volume_options *options,
                                         snow_volume_info *out);

/* The same on a file's bytes in memory; `name` serves messages and the choice
 * by suffix.  Files beside it (detached data) are refused.  `bytes` is read
 * during the call only. */
SNOW_API snow_status snow_volume_open_memory(snow_context *context,
                                             const char *name,
                                             const void *bytes, size_t size,
                                             const snow_volume_options *options,
                                             snow_volume **out);

/* A volume over the caller's own voxels, which are shared, not copied, and
 * must outlive it.  Of `info` the fields dims, type, matrix, slope, intercept,
 * medical and unit count; a matrix of zeros means the identity, slope 0 means
 * 1.  Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_volume_wrap(snow_context *context,
                                      const snow_volume_info *info,
                                      const void *voxels, snow_volume **out);

/* Voxels first .. first + count - 1 along x, y, z; empty where a count is 0. */
typedef struct snow_box {
    int64_t first[3], count[3];
} snow_box;

/* A processor's part of a volume that many share: a box of voxels, with as many
 * more around it as kernels and gradients reach. */
typedef struct snow_extent {
    size_t size;
    int64_t dims[3];   /* of the whole grid */
    int64_t stored[3]; /* voxel of the whole that is the first one here */
    int64_t first[3]; /* voxels of the whole that this processor answers for; */
    int64_t count[3]; /*   the others here are its neighbours'.  0: none */
} snow_extent;
SNOW_RECORD(snow_extent);

/* Says that a volume is a part of a larger one: its dims are those of the
 * voxels that it stores, its matrix takes their indices to the world.  A
 * picture of it is the part's share of the whole picture, in its place there.
 * Errors: SNOW_STATUS_BAD_USAGE (boxes that do not lie in one another). */
SNOW_API snow_status snow_volume_set_extent(snow_volume *volume,
                                            const snow_extent *part);

/* Where it lies in the whole; a volume that is no part is the whole. */
SNOW_API snow_status snow_volume_get_extent(const snow_volume *volume,
                                            snow_extent *out);

/* Promises that shared voxels stay as they are now, until it is called again:
 * frames may keep what they encoded of them from picture to picture.  Without
 * it shared voxels are encoded anew for every picture, as they may change.
 * Volumes that own their voxels are frozen from the start. */
SNOW_API void snow_volume_freeze(snow_volume *volume);

/* A built-in test volume: "cube", "head", "engine", "shells" or
 * "marschner-lobb".  `dims` NULL or 0s: its default size; `seed` moves what
 * is random in it.  The same arguments give the same bytes on every machine.
 * Errors: SNOW_STATUS_BAD_USAGE (unknown name; sizes below 1),
 * SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_volume_open_phantom(snow_context *context,
                                              const char *name,
                                              const int64_t dims[3],
                                              uint64_t seed, snow_volume **out);

/* Name and one-line description of phantom `index` (from 0); NULL past the
 * end. */
SNOW_API const char *snow_phantom_name(size_t index);
SNOW_API const char *snow_phantom_description(size_t index);

/* Name and description of input format `index` (from 0); NULL past the end. */
SNOW_API const char *snow_format_name(size_t index);
SNOW_API const char *snow_format_description(size_t index);

/* Name of optional library `index` (from 0) that formats of volumes and
 * pictures need; NULL past the end.  *version is that of the build, NULL where
 * it was built without, or where the module that uses it is not beside the
 * library; *formats names the formats that need it. */
SNOW_API const char *snow_library_name(size_t index, const char **version,
                                       const char **formats);

/* Closes a volume and frees its voxels unless they are shared; NULL is
 * accepted. */
SNOW_API void snow_volume_close(snow_volume *volume);

/* What is known of it; owned by the volume. */
SNOW_API const snow_volume_info *snow_volume_get_info(const snow_volume *);

/* The patient's name in UTF-8, where the file tells one: "" where not.  It is
 * in nothing else that the library writes or says.  Owned by the volume. */
SNOW_API const char *snow_volume_patient(const snow_volume *volume);

/* Its voxels: dims[0]*dims[1]*dims[2] values of the native type, x fastest;
 * owned by the volume.  NULL where they stay in the file. */
SNOW_API const void *snow_volume_voxels(const snow_volume *volume);

/* Figures over the finite data values, after slope and intercept, summed in
 * double in storage order.  64-bit integers beyond 2^53 are rounded to double
 * first, here and wherever values are looked at.  min and max are NaN when no
 * voxel is finite. */
typedef struct snow_volume_statistics {
    size_t size;
    int64_t voxels; /* all */
    int64_t finite; /* finite ones */
    double min, max;
    double sum;  /* of values */
    double wsum; /* of value * (linear index mod 1009 + 1) */
} snow_volume_statistics;
SNOW_RECORD(snow_volume_statistics);

SNOW_API snow_status snow_volume_get_statistics(const snow_volume *volume,
                                                snow_volume_statistics *out);

/* Counts the finite data values in `bins` equal bins from lo to hi; value v
 * falls into bin floor((v - lo) / (hi - lo) * bins), hi itself into the last;
 * values outside are not counted.  `counts` has `bins` entries.
 * Errors: SNOW_STATUS_BAD_USAGE unless lo < hi, both finite, and bins > 0. */
SNOW_API snow_status snow_volume_histogram(const snow_volume *volume, double lo,
                                           double hi, size_t bins,
                                           uint64_t *counts);

/* The same grid with its data values, slope and intercept applied, in another
 * scalar type; SNOW_TYPE_NONE: the least one that holds them all as they are.
 * `range` NULL keeps the values: to integers they are rounded, a remark says
 * how many, and one that does not fit is an error.  Otherwise range[0] to
 * range[1] are spread over all that an integer type of up to 32 bits holds, and
 * values beyond are the ends.  The volume may be closed before the new one.
 * Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY.
 */
SNOW_API snow_status snow_volume_convert(const snow_volume *volume,
                                         snow_type type, const double range[2],
                                         snow_volume **out);

/* Reads "1,4-7,-3": whole numbers and ranges of them, below 2^53 both ways,
 * into `ranges`, which has `room` entries.  False, and nothing changed, for any
 * other text and for more ranges than there is room for. */
SNOW_API bool snow_labels_parse(const char *text, snow_label_range *ranges,
                                size_t room, size_t *count);

/* The same volume where the mask is, and no values (NaN) elsewhere, which no
 * look, mode or encoding shows.  Inside is where the mask's data value is one
 * of the labels; of no labels (`count` 0), where it is neither 0 nor NaN.  The
 * type is float32, or float64 for native integers of 32 and 64 bits and for
 * float64; slope, intercept and all else stay.  The mask must have the same
 * sizes and, where both tell a place in the same world, lie there to a tenth of
 * a voxel.  Both may be closed before the new one.
 * Errors: SNOW_STATUS_BAD_INPUT (another grid), SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_volume_mask(const snow_volume *volume,
                                      const snow_volume *mask,
                                      const snow_label_range *labels,
                                      size_t count, snow_volume **out);

/* The same volume on one side of `count` planes of the world, four numbers a,
 * b, c, d each, and no values where a x + b y + c z > d of any of them; a voxel
 * in a plane stays.  A plane whose a, b, c are 0 is none.  Type and all else as
 * of a mask. Errors: SNOW_STATUS_BAD_USAGE (more than SNOW_CLIPS_MAX planes),
 * SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_volume_clip(const snow_volume *volume,
                                      const double *planes, size_t count,
                                      snow_volume **out);

/* Writes a volume with its geometry, in the format of the path's suffix:
 * .nrrd, .nii, .nii.gz, .mha, .npy, .raw, .raw.gz.  The file is written aside
 * and renamed, so that it is whole or absent; an existing one is kept, and an
 * error, unless `overwrite`.  .nii keeps geometry in single precision where
 * that holds it; .npy and .raw keep none, and a remark tells how to open them
 * again.  Errors: SNOW_STATUS_BAD_OUTPUT, SNOW_STATUS_BAD_USAGE (unknown
 * suffix; slope and intercept, which .nrrd, .npy and .raw cannot say),
 * SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_volume_save(const snow_volume *volume,
                                      const char *path, bool overwrite);

/* Suffix `index` (from 0) that snow_volume_save knows; NULL past the end. */
SNOW_API const char *snow_volume_format_suffix(size_t index);

/* A core that was built without formats (-DSNOW_FORMATS=OFF) has volumes in
 * memory, their pictures, on one rank or many, and pictures as PNG, NPY and
 * PFM. It lacks what reads and writes files of volumes: snow_volume_open,
 * _inspect, _open_memory, _stream, _save and _suffix, snow_format_name and
 * _text, snow_library_name, snow_ranks_open; and snowglass/recipe.h and tf.h.
 */

#ifdef __cplusplus
}
#endif
#endif
