/* volume/stream.h - a volume whose voxels stay in their file: slabs of slices
 * along z, which lie behind one another in nearly every file, are read, used
 * and dropped, as often as they are wanted.
 *
 *   z   0 .... a ..... b ..... c
 *       | slab 0 |g|               g: ghost layers (volume.h, snow_extent), for
 *              |g| slab 1 |g|         what is computed of neighbours
 *                       |g| slab 2
 *
 * A volume in memory is one slab: itself.  What is written over slabs serves
 * both. */
#ifndef SNOW_STREAM_H
#define SNOW_STREAM_H

#include "volume/volume.h"

/* Opens a file with options: reads the volume, or where `out` is NULL its
 * header alone. */
typedef snow_status snow_open_fn(snow_context *context, const char *path,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out);

/* Does what snow_volume_open_streamed does; slabs are boxes of what `open`
 * reads. */
snow_status snow_stream_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             uint64_t slab_bytes, snow_open_fn *open,
                             snow_volume **out);

/* Makes a volume in its file that of a box of the same file, which is a part of
 * the whole: its slabs are parts of that.  Errors: of snow_stream_open. */
snow_status snow_stream_open_part(const snow_volume *volume,
                                  const snow_extent *part,
                                  const int64_t stored[3], snow_volume **out);

/* What was kept of a slab (snow_slabs_keep), which stores so many slices with
 * its ghosts: the record that is handed out again, without its voxels; NULL:
 * the slab is read. */
typedef const snow_volume *
snow_slab_kept_fn(void *user, const snow_extent *part, int64_t slices);

/* How a volume is to be cut. */
typedef struct snow_slab_cut {
    int64_t ghosts; /* layers on either side, but beyond the grid */
    int64_t made;   /* so many times a slab's bytes are taken by what is made of
                       it; 0: few */
    int64_t from;   /* a slice: its slab comes first, then those above it,
                       rising, then those below it, falling */
    bool clipped;   /* with the values next to clip planes (clip_planes.h) */
    int64_t slices; /* of a slab, without ghosts; 0: as many as fit */
    snow_slab_kept_fn *kept; /* NULL: all slabs are read */
    void *user;              /* of kept */
} snow_slab_cut;

/* A walk over all slabs. */
typedef struct snow_slabs {
    const snow_volume *volume;
    snow_slab_cut cut;
    int64_t slices;         /* of all slabs */
    int64_t count, nearest; /* slices of a slab; the first that is read */
    int64_t next;           /* the next slab's first slice */
    bool begun, falls;
    int64_t number;          /* of slabs so far */
    snow_monitor_part whole; /* the progress outside of the present slab */
    snow_volume *slab;       /* the present one; NULL: the volume in memory, or
                                a slab that was kept */
    bool keep;               /* the present one is the caller's */
} snow_slabs;

void snow_slabs_open(const snow_volume *volume, const snow_slab_cut *cut,
                     snow_slabs *slabs);

/* The next slab, which is a part of the volume (or the volume itself), and gone
 * when the next is asked for; NULL after the last one.  Errors: those of
 * snow_volume_open; SNOW_STATUS_BAD_INPUT (the file is another one by now). */
snow_status snow_slabs_next(snow_slabs *slabs, const snow_volume **slab);

/* The record of the present slab becomes the caller's, who closes it; its
 * voxels go when the next is asked for.  NULL: it is the caller's already. */
snow_volume *snow_slabs_keep(snow_slabs *slabs);

void snow_slabs_close(snow_slabs *slabs);

/* Hands all of them to a function.  Errors: those of snow_slabs_next, and of
 * the function, which ends it. */
typedef snow_status snow_slab_fn(const snow_volume *slab, void *user);
snow_status snow_slabs_visit(const snow_volume *volume,
                             const snow_slab_cut *cut, snow_slab_fn *visit,
                             void *user);

/* The most bytes that one of them has, ghosts included. */
uint64_t snow_slab_bytes(const snow_volume *volume, const snow_slab_cut *cut);

/* " under the limit of 300.0 MiB", where there is one. */
void snow_print_limit(const snow_context *context, char text[64]);

/* All of snow_volume_get_statistics but the sums.  Of a volume in its file
 * slabs are read, unless the range is known; of a part it is that of the part.
 * Errors: as snow_slabs_visit. */
snow_status snow_volume_range(const snow_volume *volume,
                              snow_volume_statistics *out);

/* Makes known the range of a volume in its file, as snow_volume_range does. */
void snow_stream_note_range(const snow_volume *volume,
                            const snow_volume_statistics *range);

#endif
