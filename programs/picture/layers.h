/* layers.h - the volume of --overlay and its look. */
#ifndef PICTURE_LAYERS_H
#define PICTURE_LAYERS_H

#include "picture/channels.h"

#include <snowglass/snowglass.h>

typedef struct layers {
    snow_volume *volume; /* or NULL */
    snow_transfer *transfer;
    uint64_t slab_bytes;  /* of a file; 0: as usual */
    bool quiet;           /* says nothing of a memory that is too small */
    bool keeps;           /* for many looks and grids: reads its file once */
    bool alone;           /* the volume is all here, whatever ranks there are */
    bool placed, nearest; /* on the volume's grid, and how */
    const snow_volume_info *whole; /* before a crop; NULL: the file says it */
    snow_volume *own;              /* then: on its own grid; or NULL */
} layers;

/* Refuses what cannot be drawn together; opens the overlay of the options on
 * the grid of a volume, in place of an earlier one: in memory, or in its file
 * where ranks or slabs share the volume.  Both return CONTINUE or an exit code.
 */
int layers_check(const options *opts);
int layers_check_file(const char *path); /* that it can be read twice */
int layers_open(const options *opts, snow_context *context,
                const snow_volume *base, layers *l);

/* Pictures of a frame have it, in front of the channels, which are mixed. */
snow_status layers_set(const layers *l, const channel_set *c,
                       snow_frame *frame);
void layers_close(layers *l);

/* What a legend shows beside the look of the volume; NULL: nothing, or labels
 * that are others at the next one of the `steps` that are drawn. */
const snow_transfer *layers_legend(const layers *l, bool steps);

/* Takes an overlay out of the options, with its look and its labels. */
void layers_leave_out(options *opts);

/* Before it is opened again: for another grid or other planes; with another
 * look. */
void layers_drop_volume(layers *l);
void layers_drop_look(layers *l);

/* Lays its slice over the picture of a slice of the volume, which is replaced:
 * with the opacities of --overlay-look, else with those by its values, of
 * which the largest becomes 1/2, or the factor of --overlay-look. */
snow_status layers_lay_slice(const options *opts, const layers *l,
                             int64_t index, const snow_view *view,
                             const snow_settings *settings,
                             snow_context *context, snow_image **image);

#endif
