/* volume/volume.h - the inside of a volume.  Nothing here reads files: that is
 * the work of formats/, which makes volumes with these functions. */
#ifndef SNOW_VOLUME_H
#define SNOW_VOLUME_H

#include "base/monitor.h"
#include "volume/region.h"

typedef struct snow_stream snow_stream;           /* stream.h */
typedef struct snow_clip_planes snow_clip_planes; /* clip_planes.h */

/* What a part lacks, since the look that it was opened for shows nothing of it
 * (parallel/trim.c); the same on all ranks but for the box. */
typedef struct snow_left_out {
    bool any;
    double low, high; /* stored values of the voxels are between these; */
    double fill;      /* one of them has this */
    double spare;     /* in data values: the look shows none that is nearer */
    int64_t ring[3];  /* layers that are there around all other voxels */
    snow_box box;     /* what the rank answers for, with them */
} snow_left_out;

struct snow_volume {
    snow_context *context;
    snow_volume_info info;
    const void *voxels; /* NULL where they stay in the file: */
    int64_t pitch[2]; /* values from row to row and slice to slice, where there
                         are gaps; 0: dense */
    snow_stream *stream;    /* how slabs are read, one block; else NULL */
    const char *path;       /* of that file, within the block; else NULL */
    snow_clip_planes *clip; /* planes that have cut it, and values next to them;
                      NULL: none */
    bool lost_clip;         /* there were some, but its voxels have moved */
    void *owned; /* the block to free, NULL when the voxels are shared */
    int holders; /* beside its owner: each closes it, too */
    /* A number that no other volume of the context ever had, by which a frame
     * knows that it has encoded this one; 0 while the voxels may change. */
    uint64_t generation;
    bool is_part;
    snow_extent part; /* where is_part */
    snow_left_out left_out;
    bool knows_origin;
    double origin[3];  /* the last column of the whole's matrix, where known */
    char patient[256]; /* "" when unknown */
    bool labelled;     /* values are labels, say the file or the options; */
    snow_label
        *labels; /* what they say of them, values rising; NULL: nothing */
    size_t label_count;
    bool masked;          /* a mask has left out voxels: their border is lit */
    bool had_negative;    /* data values, before a mask or planes */
    bool emptied;         /* a mask or planes have left no voxel: */
    double mask_range[2]; /* the mask's values, NaN where there is none */
};

/* What is known of the whole that a volume is a part of: its dims and its
 * matrix, whose last column is computed back from that of the part, and so
 * differs by rounding from rank to rank, unless it was given. */
void snow_volume_whole(const snow_volume *volume, snow_volume_info *out);

/* Values from a voxel to the next one along each axis. */
void snow_volume_steps(const snow_volume *volume, int64_t out[3]);

/* The place in memory of the voxel of a linear index, and of how many of
 * `count` that follow it there is no gap. */
int64_t snow_volume_run(const snow_volume *volume, int64_t first,
                        uint64_t *count);

/* What a box of a whole is as a volume of its own. */
snow_volume_info snow_volume_info_of_box(const snow_volume_info *whole,
                                         const int64_t first[3],
                                         const int64_t count[3]);

/* Whether a volume is MR or CT of a patient.  Whole numbers of a file that
 * names no modality may be labels. */
bool snow_volume_is_scan(const snow_volume_info *info);

/* The axis along which a volume is thinner than a quarter of the next wider
 * side, or a scan has few thick slices, and so is seen from its face; -1: none.
 */
int snow_volume_thin_axis(const snow_volume_info *info);

/* An info with one voxel's defaults: identity matrix, slope 1, one time step,
 * unit "", and the given format name. */
snow_volume_info snow_volume_info_default(const char *format);

/* The integers of so many bytes, NONE if there are none; whether a type is that
 * of integers with a sign. */
snow_type snow_type_of_integer(size_t bytes, bool is_signed);
bool snow_type_is_signed(snow_type type);

/* Stores values that the type holds; integers are whole. */
void snow_type_store(snow_type type, const double *values, size_t count,
                     void *to);

/* The least and the most value of a type. */
const double *snow_type_limits(snow_type type);

/* Writes a stored value into all voxels, which the volume owns. */
void snow_volume_fill(snow_volume *volume, double value);

/* Fills spacing from the columns of the matrix. */
void snow_volume_info_measure(snow_volume_info *info);

/* Stretches the world along its z. */
void snow_volume_stretch(snow_volume_info *info, double times);

/* Gives each axis its own coordinates, as they are in the file. */
void snow_volume_unstretch(snow_volume_info *info);

/* The number of voxels and of bytes of a volume of these dims and type.
 * False when a dim is below 1, the type unknown, or a product overflows 63
 * bits. */
bool snow_volume_count(const int64_t dims[3], snow_type type, int64_t *voxels,
                       uint64_t *bytes);

/* Checks what a header said before anything is allocated: dims at least 1 and
 * their product below 2^63 bytes, a known type, a matrix that is finite and
 * can be inverted, slope and intercept finite and slope not 0.
 * Errors: SNOW_STATUS_BAD_INPUT with the reason (not the file's name). */
snow_status snow_volume_info_check(snow_context *context,
                                   const snow_volume_info *info);

/* A volume with room for its voxels, uncleared; info is checked and its
 * spacing measured.  The writable voxels are (void *)volume->owned. */
snow_status snow_volume_new(snow_context *context, const snow_volume_info *info,
                            snow_volume **out);

/* A volume over voxels that are not its own; info is already checked. */
snow_status snow_volume_over(snow_context *context,
                             const snow_volume_info *info, const void *voxels,
                             snow_volume **out);

/* Makes values labels, of which copies of these are known, if any. */
snow_status snow_volume_set_labels(snow_volume *volume,
                                   const snow_label *labels, size_t count);

/* Whether two volumes have the same voxels.  Errors: SNOW_STATUS_BAD_INPUT
 * (they have not, nor do their worlds tell where). */
snow_status snow_grids_compare(snow_context *context,
                               const snow_volume_info *volume,
                               const snow_volume_info *other, const char *what,
                               bool *same);

/* The same on the grid of another volume, `what` it is for; with a note where
 * that is no other order of its axes.  *out is NULL where it has the grid.
 * Of masks and labels the nearest voxels are taken.  Errors: as above. */
snow_status snow_volume_resample(const snow_volume *volume,
                                 const snow_volume *grid, bool nearest,
                                 const char *what, snow_volume **out);

/* The voxels of a volume that this reads for a box of the grid (as of options:
 * ends of 0 are its last); false where the two do not meet. */
bool snow_volume_box_of(const snow_volume_info *volume,
                        const snow_volume_info *grid, const int64_t crop[3][2],
                        int64_t box[3][2]);

/* Reads what a volume in its file has for a part of a grid, `count` voxels from
 * part->stored on: that part, on the grid, cut by the file's planes.  Errors:
 * of snow_volume_resample and of reading. */
snow_status snow_volume_take_box(const snow_volume *volume,
                                 const snow_volume_info *whole,
                                 const snow_extent *part,
                                 const int64_t count[3], bool nearest,
                                 snow_volume **out);

/* For what needs all voxels at once.  Errors: SNOW_STATUS_BAD_USAGE (these stay
 * in their file). */
snow_status snow_volume_need_voxels(const snow_volume *volume);

/* A volume stays until its holder, too, has closed it. */
snow_volume *snow_volume_hold(const snow_volume *volume);

/* snow_volume_get_extent of the library itself. */
void snow_volume_find_extent(const snow_volume *volume, snow_extent *out);

/* True on machines that store the high byte first. */
bool snow_machine_big_endian(void);

/* Reverses the bytes of `count` values of `size` bytes in place. */
void snow_swap_bytes(void *values, uint64_t count, size_t size);

/* 3x3 helpers on the matrix' linear part.  Invert returns false when the
 * determinant is 0 or not finite relative to the columns' lengths. */
bool snow_matrix_invert3(const double m[4][4], double inverse[3][3]);

/* Whether the caller wants a pass over the voxels to end, which is at `first`,
 * and reports that where it is a call of its own. */
bool snow_pass_is_stopped(const snow_volume *volume, snow_monitor *own,
                          int64_t first);

/* The native value at a linear index as a double (int64 values beyond 2^53
 * round); and `count` of them from index `first` on. */
double snow_volume_native(const snow_volume *volume, int64_t index);
void snow_volume_stored(const snow_volume *volume, int64_t first, size_t count,
                        double *out);

/* The smallest value of a type of 8 or 16 bits. */
int32_t snow_type_lowest(snow_type type);

/* The extremes of native values of 8 or 16 bits; false of other types. */
bool snow_volume_extremes(const snow_volume *volume, int64_t first,
                          size_t count, int32_t *low, int32_t *high);

/* Those are no Hounsfield units. */
static inline bool snow_has_8_bits(const snow_volume_info *info) {
    return info->eight_bits || snow_type_size(info->type) == 1;
}

#endif
