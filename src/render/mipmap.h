/* render/mipmap.h - a volume at lower resolution for small pictures.
 *
 * A level of a volume is the same box in fewer voxels (volume/downsample.h). It
 * is a volume like any other, with longer steps; so path lengths, gradients and
 * the camera are right by themselves.  Levels are made when they are first
 * needed, each of the one before it, and kept as long as their volume is drawn.
 *
 * The rule: an axis is halved where a pixel of the picture is at least two of
 * its voxels wide and it has SNOW_DOWNSAMPLE_LEAST of them.  It is halved again
 * as long as a pixel is at least four of the level's and the level has more
 * than SNOW_LEVEL_MANY in all: each level is farther from the exact picture,
 * and small ones cost little.  In perspective that is a pixel where the volume
 * could come nearest to the eye.  How the camera is turned does not matter, so
 * that nothing jumps while it turns.
 *
 * Of a part of a volume the part of the whole's level is made, of the ghost
 * voxels too that lie across its borders: the rule is one of the whole, so that
 * all ranks take the same level, and its voxels are those of one process to the
 * bit.  ghosts.h has the number of ghosts that it needs. */
#ifndef SNOW_RENDER_MIPMAP_H
#define SNOW_RENDER_MIPMAP_H

#include "volume/volume.h"

#include <snowglass/render.h>

#define SNOW_LEVEL_MANY (1 << 21)

/* The levels of one frame. */
typedef struct snow_mipmap snow_mipmap;

/* NULL is accepted. */
void snow_mipmap_free(snow_mipmap *levels);

/* How often each axis of the volume would be halved for a view.  Errors: those
 * of snow_camera_make. */
snow_status snow_mipmap_wanted(snow_context *context,
                               const snow_volume_info *info,
                               const snow_view *view, int halvings[3]);

/* Whether pictures by such settings, which are resolved, may be of a level. */
bool snow_mipmap_serve(const snow_settings *settings);

/* What a level is like.  Layers of it become layers of the volume, on either
 * side of a part: as many as the level's part has then. */
snow_volume_info snow_mipmap_info(const snow_volume_info *info,
                                  const int halvings[3]);
void snow_mipmap_layers(const snow_volume_info *info, const int halvings[3],
                        int64_t layers[3]);

/* The level for a picture: *level is the volume itself where full resolution
 * is needed; else it belongs to *levels, which is made
 * when it is NULL, until the next call.  `settings` are resolved.  Errors:
 * those of snow_camera_make, SNOW_STATUS_NO_MEMORY, SNOW_STATUS_BAD_USAGE (a
 * part has too few ghosts). */
snow_status snow_mipmap_select(snow_mipmap **levels, const snow_volume *volume,
                               const snow_transfer *transfer,
                               const snow_view *view,
                               const snow_settings *settings,
                               const snow_volume **level, int halvings[3]);

#endif
