/* slices.h - slices of the volume, as `snowglass slice` makes them, without
 * letters: the page draws these.
 *
 * They show what clip planes take away, and have a range of values of their
 * own. */
#ifndef SLICES_H
#define SLICES_H

#include "draw/drawing.h"

typedef struct slice_asked {
    const char *axis; /* a name of snow_slice_view */
    int64_t index;
    double low, high; /* the range of values that the colours span */
    bool colored;     /* by the look; else grey */
    const char *slab; /* as of --slab, or NULL */
} slice_asked;

/* Of each of three slices: {"axis": "axial", "along": 2, "right": [0, -1],
 * "down": [1, -1], "width": 256, "height": 256}, where [0, -1] is against x of
 * the grid. */
json_t *slices_info(drawing *d);

/* The picture belongs to the caller.  Returns CONTINUE or an exit code. */
int slices_draw(drawing *d, const slice_asked *asked, snow_image **image,
                snow_image_options *form);

/* Of another volume. */
void slices_forget(drawing *d);

/* The command that makes the same picture, to be freed; NULL: none. */
char *slices_command(drawing *d, const slice_asked *asked);

/* The data value of a voxel; NaN where there is none. */
double slices_value(drawing *d, const int64_t at[3]);

#endif
