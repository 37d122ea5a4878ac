/* render/parts.h - line 01 of figure 8: the parts of a volume, one after
 * another.
 *
 *   in memory            one, all of it
 *   in its file          slabs of slices, each read and dropped (volume/
 *                        stream.h), for the methods that take them
 *   of many ranks        one, this rank's own
 *
 * A slab has as many ghost layers as a part needs (ghosts.h), so that it makes
 * every sample of its own as the whole would, and no other (section 4 of the
 * paper).  Their local images lie over one another in the order in which they
 * come:
 *
 *        eye                 along z; the slab that the eye is level with comes
 *   5  4  3 | 0 | 1  2       first, then those on either side, away from it
 *
 * No ray meets slabs on both sides.  What methods keep of slabs spares the next
 * picture reading them; of others each picture reads the file. */
#ifndef SNOW_RENDER_PARTS_H
#define SNOW_RENDER_PARTS_H

#include "render/picture.h"

typedef struct snow_parts {
    snow_picture *picture;
    snow_job *whole;
    snow_job *part;             /* the present one; NULL before the first */
    bool many;                  /* slabs of a file */
    snow_monitor_part progress; /* of the picture outside of this pass */
    snow_slab_cut cut;
    snow_slabs slabs;
    snow_job slab; /* of the present one */
    snow_stats stats;
} snow_parts;

/* The parts of the picture's pass, or none where the status is a failure.
 * Errors: that; those of snow_ghosts_needed; SNOW_STATUS_NO_MEMORY where the
 * picture needs all voxels at once. */
snow_status snow_parts_open(snow_parts *parts, snow_picture *picture,
                            snow_status status);

/* The next part, or NULL after the last one.  A single part comes whatever
 * *status is, for other processes count on this one; slabs end at the first
 * failure. */
snow_job *snow_parts_next(snow_parts *parts, snow_status *status);

/* Returns the status, with a message that names the slabs' size where memory
 * was too small. */
snow_status snow_parts_close(snow_parts *parts, snow_status status);

#endif
