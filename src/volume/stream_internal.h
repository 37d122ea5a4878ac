/* volume/stream_internal.h - what opening a stream (stream.c) and walking over
 * its slabs (stream_slabs.c) share. */
#ifndef SNOW_VOLUME_STREAM_INTERNAL_H
#define SNOW_VOLUME_STREAM_INTERNAL_H

#include "volume/stream.h"

#define WARNINGS_MOST 64

/* What is needed to open a slab; the texts of the options follow behind. */
struct snow_stream {
    snow_open_fn *open;
    snow_volume_options options; /* with texts of its own */
    uint64_t slab_bytes;         /* of voxels of a slab, ghosts included */
    double seconds;              /* of reading */
    bool left;                   /* of the present visit: a slab has voxels
                                    that no mask or plane leaves out */
    double mask_range[2];        /* of it: the mask's values, NaN where it is
                                    not known */
    bool warned_empty;           /* that nothing is left */
    bool measured;               /* `range` is known */
    snow_volume_statistics range;
    char *path;
    int64_t print; /* of the file (base/fingerprint.h) */
    /* Warnings of reading, each of which is given once: a hash of each. */
    snow_warning_fn *warning;
    void *warning_user;
    uint64_t given[WARNINGS_MOST];
    int given_count;
};

/* Without a wish: small beside any memory, and long enough to be read fast. */
#define SNOW_SLAB_BYTES ((uint64_t)64 << 20)

/* Between them each warning is given once. */
void snow_stream_begin_warnings(snow_context *context, snow_stream *stream);
void snow_stream_end_warnings(snow_context *context, const snow_stream *stream);

/* The box of the file that the options ask for; `clipped`: with the values next
 * to clip planes.  Errors: those of snow_volume_open. */
snow_status snow_stream_open_slab(snow_context *context, snow_stream *stream,
                                  const snow_volume_options *options,
                                  bool clipped, snow_volume **out);

#endif
