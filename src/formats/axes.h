/* formats/axes.h - which axis of an array with names, or without, is which.
 *
 * Axes are counted from the fastest one, which is 0. */
#ifndef SNOW_FORMATS_AXES_H
#define SNOW_FORMATS_AXES_H

#include <stdbool.h>
#include <stdint.h>

#define SNOW_MOST_AXES 5

/* What a file says of an axis. */
typedef struct snow_axis_hint {
    bool time;       /* it is time, wherever it stands */
    bool duration;   /* it has a unit of time, as the slowest axis may */
    bool space;      /* it is an axis of space */
    bool components; /* it counts the components of a voxel */
} snow_axis_hint;

typedef struct snow_axes {
    int space[3];      /* x, y, z; -1: there is none */
    int time, channel; /* -1: there is none */
    bool interleaved;  /* channels are the components of a voxel */
} snow_axes;

/* Assigns the axes.  One counts components if a hint says so, or it is the
 * fastest, has 1 to 4 entries, fewer than the next one, and is one more than
 * space has; of three axes a hint counts up to 9 entries.  Of others that are
 * too many for space the slowest is time, and the next one channels.  Returns
 * false if any is left. */
bool snow_axes_assign(int rank, const int64_t sizes[SNOW_MOST_AXES],
                      const snow_axis_hint hints[SNOW_MOST_AXES],
                      snow_axes *out);

#endif
