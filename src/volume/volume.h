/* volume/volume.h - the inside of a volume, and what readers share.
 *
 * To add a format: write volume/NAME.c with one snow_format record, and name
 * the record in the table of volume/formats.c.  Nothing else. */
#ifndef SNOW_VOLUME_H
#define SNOW_VOLUME_H

#include "base/base.h"
#include "base/source.h"
#include "base/writer.h"
#include "volume/window.h"

#include <snowglass/volume.h>

typedef struct snow_stream snow_stream; /* volume/stream.h */

struct snow_volume {
    snow_context *context;
    snow_volume_info info;
    const void *voxels;  /* NULL where they stay in the file: */
    snow_stream *stream; /* how they are read; else NULL */
    void *owned; /* the block to free, NULL when the voxels are shared */
    /* A number that no other volume of the context ever had, by which a frame
     * knows that it has encoded this one; 0 while the voxels may change. */
    uint64_t serial;
    bool is_part;
    snow_part part; /* where is_part */
    bool knows_origin;
    double origin[3];  /* the last column of the whole's matrix, where known */
    char patient[256]; /* "" when not told */
    /* Of a level (levels.h): a step of the volume's that it was made of, in its
     * own; else 0. */
    double fine[3];
    bool emptied;         /* a mask or planes have left no voxel: */
    double mask_range[2]; /* the mask's values, NaN where there is none */
};

/* What is known of the whole that a volume is a part of: its dims and its
 * matrix, whose last column is computed back from that of the part, and so
 * differs by rounding from rank to rank, unless it was told. */
void snow_volume_whole(const snow_volume *volume, snow_volume_info *out);

/* Tells a part, which it has been made by now, the matrix of its whole. */
void snow_volume_set_whole(snow_volume *volume, const snow_volume_info *whole);

/* What a box of a whole is as a volume of its own. */
snow_volume_info snow_volume_info_of_box(const snow_volume_info *whole,
                                         const int64_t first[3],
                                         const int64_t count[3]);

/* A volume format.  `read` gets the source at its first byte (gzip undone) and
 * makes the volume; its messages need not name the file, and its options are
 * never NULL; `probe` says whether the first `size` bytes look like the
 * format; `write` may be NULL.
 *
 * A format that `crops` reads no more than the box of its options: it lays a
 * window (volume/window.h) before the volume, and where `out` is NULL it stops
 * there, with all but the voxels in *info.  Other formats read all, and are
 * cropped afterwards; they leave *info alone. */
typedef struct snow_format {
    const char *name;        /* "nrrd" */
    const char *text;        /* one line for people */
    const char *suffixes[8]; /* ".nrrd", ".nhdr", NULL */
    bool (*probe)(const unsigned char *bytes, size_t size);
    bool crops;
    bool slices;   /* a folder or a pattern of its files is a volume */
    bool sets;     /* heeds the option that chooses a data set */
    bool channels; /* heeds the option that chooses a channel */
    bool series;   /* heeds the option that chooses a series */
    snow_status (*read)(snow_source *source, const snow_volume_options *options,
                        snow_volume_info *info, snow_volume **out);
    snow_status (*write)(const snow_volume *volume, const char *path,
                         snow_writer *writer);
} snow_format;

extern const snow_format snow_format_raw;
extern const snow_format snow_format_nrrd;
extern const snow_format snow_format_nifti;
extern const snow_format snow_format_metaimage;
extern const snow_format snow_format_npy;
extern const snow_format snow_format_mrc;
extern const snow_format snow_format_vtk;
extern const snow_format snow_format_vti;
extern const snow_format snow_format_tiff;
extern const snow_format snow_format_png;
extern const snow_format snow_format_hdf5;
extern const snow_format snow_format_netcdf;
extern const snow_format snow_format_dicom;
extern const snow_format snow_format_den;
extern const snow_format snow_format_zarr;

/* An info with one voxel's defaults: identity matrix, slope 1, one time step,
 * unit "", and the given format name. */
snow_volume_info snow_volume_info_default(const char *format);

/* Fills spacing from the columns of the matrix. */
void snow_volume_info_measure(snow_volume_info *info);

/* The number of voxels and of bytes of a volume of these dims and type.
 * False when a dim is below 1, the type unknown, or a product overflows 63
 * bits. */
bool snow_volume_count(const int64_t dims[3], snow_type type, int64_t *voxels,
                       uint64_t *bytes);

/* Checks what a header said before anything is allocated: dims at least 1 and
 * their product below 2^63 bytes, a known type, a matrix that is finite and
 * can be inverted, slope and intercept finite and slope not 0.
 * Errors: SNOW_BAD_INPUT with the reason (not the file's name). */
snow_status snow_volume_info_check(snow_context *context,
                                   const snow_volume_info *info);

/* A volume with room for its voxels, uncleared; info is checked and its
 * spacing measured.  The writable voxels are (void *)volume->owned. */
snow_status snow_volume_new(snow_context *context, const snow_volume_info *info,
                            snow_volume **out);

/* The usual end of a binary reader whose time steps follow one another behind
 * `skip` bytes: lays the window, checks that the source can hold all, makes the
 * volume unless `out` is NULL, reads it, swaps bytes when `big_endian` differs
 * from the machine, finishes the source. */
snow_status snow_volume_read(snow_source *source,
                             const snow_volume_options *options,
                             bool big_endian, uint64_t skip,
                             snow_volume_info *info, snow_volume **out);

/* Swaps the bytes of the voxels as read when the file's order is not the
 * machine's. */
void snow_volume_order_bytes(snow_volume *volume, bool big_endian);

/* For a reader that has set info->times: takes the time step of the options
 * into info->time and tells the listener when there are several.  `what` the
 * format calls one: "time step", or "volume" where it need not be time.
 * Errors: SNOW_BAD_USAGE when there is no such step. */
snow_status snow_volume_pick_time(snow_context *context, const char *what,
                                  const snow_volume_options *options,
                                  snow_volume_info *info);

/* The format whose files begin like these bytes; the one of a file name; NULL
 * when there is none. */
const snow_format *snow_format_of_bytes(const void *bytes, size_t size);
const snow_format *snow_format_of_name(const char *name);

/* Puts "path: " before the message of a failure in a file, unless it begins
 * with that already, and passes its status on. */
snow_status snow_fail_in_file(snow_context *context, snow_status status,
                              const char *path);

/* True on machines that store the high byte first. */
bool snow_machine_big_endian(void);

/* Reverses the bytes of `count` values of `size` bytes in place. */
void snow_swap_bytes(void *values, uint64_t count, size_t size);

/* 3x3 helpers on the matrix' linear part.  Invert returns false when the
 * determinant is 0 or not finite relative to the columns' lengths. */
bool snow_matrix_invert3(const double m[4][4], double inverse[3][3]);

/* The native value at a linear index as a double (int64 values beyond 2^53
 * round); and `count` of them from index `first` on. */
double snow_volume_native(const snow_volume *volume, int64_t index);
void snow_volume_natives(const snow_volume *volume, int64_t first, size_t count,
                         double *out);

#endif
