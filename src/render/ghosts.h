/* render/ghosts.h - how far a processor's voxels must reach beyond those that
 * it answers for. */
#ifndef SNOW_RENDER_GHOSTS_H
#define SNOW_RENDER_GHOSTS_H

#include "base/base.h"

#include <snowglass/render.h>

/* Layers of ghost voxels that a part of the volume `whole` must have on either
 * side along each axis, but beyond the grid, for a picture by these settings,
 * which need not be resolved; no more than dims - 1.
 *
 * `slopes` (transfer.h) says whether opacity depends on gradients, which then
 * are wanted unshaded too, and whether these are of labels.  With `any_turn`
 * for every direction that the camera may look in, at the zoom, field of view
 * and image size of the view: an upper bound. Errors: SNOW_STATUS_BAD_USAGE
 * (view, settings), SNOW_STATUS_BAD_INPUT (a geometry that no float can hold).
 */
snow_status snow_ghosts_needed(snow_context *context,
                               const snow_volume_info *whole,
                               const snow_view *view,
                               const snow_settings *settings, int slopes,
                               bool any_turn, int64_t layers[3]);

/* Whether a part has as many as a view needs, settings being resolved.  Errors:
 * SNOW_STATUS_BAD_USAGE (it has not). */
snow_status snow_ghosts_check(snow_context *context, const snow_volume *volume,
                              const snow_view *view,
                              const snow_settings *settings, int slopes);

#endif
