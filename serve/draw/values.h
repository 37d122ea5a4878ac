/* values.h - which values the volume has; on many ranks those of all parts,
 * with each voxel counted once. */
#ifndef VIEWER_VALUES_H
#define VIEWER_VALUES_H

#include "draw/drawing.h"

/* The least and the greatest value; NaN where there is none, or voxels stay in
 * their file. */
void values_ends(drawing *d, double ends[2]);

/* The values from black to white where nobody says otherwise. */
void values_window(drawing *d, double window[2]);

/* Not all is counted yet: pictures come between, and then the same call again.
 */
#define VALUES_MORE 1000

/* A histogram (snow_volume_histogram).  Returns CONTINUE or an exit code; where
 * voxels stay in their file SNOW_STATUS_BAD_USAGE, and says nothing.  What one
 * rank has counted is kept, in pieces of some milliseconds. */
int values_count(drawing *d, double low, double high,
                 uint64_t counts[VALUES_BINS]);

#endif
