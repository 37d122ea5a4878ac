/* volume/stream.h - a volume whose voxels stay in their file: slabs of slices
 * along z, which lie behind one another in nearly every file, are read, used
 * and dropped, as often as they are wanted.
 *
 *   z   0 .... a ..... b ..... c
 *       | slab 0 |g|               g: ghost layers (volume.h, snow_part), for
 *              |g| slab 1 |g|         what is computed of neighbours
 *                       |g| slab 2
 *
 * A volume in memory is one slab: itself.  What is written over slabs serves
 * both. */
#ifndef SNOW_STREAM_H
#define SNOW_STREAM_H

#include "volume/volume.h"

/* How a volume is to be cut. */
typedef struct snow_slab_cut {
    int64_t step;   /* slices of a slab are a multiple of it, but for the last
                       ones; at least 1 */
    int64_t ghosts; /* layers on either side, but beyond the grid */
    int64_t made;   /* so many times a slab's bytes are taken by what is made of
                       it; 0: few */
    int64_t from;   /* a slice: its slab comes first, then those above it,
                       rising, then those below it, falling */
} snow_slab_cut;

/* Is handed a slab, which is a part of the volume (or the volume itself), and
 * gone after the call. */
typedef snow_status snow_slab_fn(const snow_volume *slab, void *user);

/* Hands out all slabs.  Errors: of the function, which ends it; of
 * snow_volume_open; SNOW_BAD_INPUT (the file is another one by now). */
snow_status snow_slabs_visit(const snow_volume *volume,
                             const snow_slab_cut *cut, snow_slab_fn *visit,
                             void *user);

/* The most bytes that one of them has, ghosts included. */
uint64_t snow_slab_bytes(const snow_volume *volume, const snow_slab_cut *cut);

/* " under the limit of 300.0 MiB", where there is one. */
void snow_print_limit(const snow_context *context, char text[64]);

/* All of snow_volume_measure but the sums.  Of a volume in its file slabs are
 * read, unless the range is known; of a part it is that of the part.  Errors:
 * as snow_slabs_visit. */
snow_status snow_volume_range(const snow_volume *volume,
                              snow_volume_measures *out);

/* Makes known the range of a volume in its file, as snow_volume_range finds it.
 */
void snow_stream_note_range(const snow_volume *volume,
                            const snow_volume_measures *range);

/* For what needs all voxels at once.  Errors: SNOW_BAD_USAGE (these stay in
 * their file). */
snow_status snow_volume_need_voxels(const snow_volume *volume);

/* Of a volume that stays in its file. */
const char *snow_stream_path(const snow_volume *volume);

/* NULL is accepted. */
void snow_stream_free(snow_context *context, snow_stream *stream);

#endif
