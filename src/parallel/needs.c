/* parallel/needs.c - what a picture by many ranks asks of the parts, for those
 * who cut them (snowglass/extend.h). */
#include "decompose/deterministic.h"
#include "render/ghosts.h"
#include "render/settings_resolve.h"
#include "transfer/look.h"
#include "transform/clip.h"

snow_status
snow_ranks_find_needs(snow_context *context, const snow_volume_info *whole,
                      const snow_view *view, const snow_settings *settings,
                      const snow_look *look, snow_ranks_needs *out) {
    snow_placement placement;
    snow_settings known = snow_settings_known(settings);
    SNOW_TRY(snow_settings_resolve(context, whole, &known));
    SNOW_TRY(snow_placement_make(context, whole, view, &placement));
    out->slice_axis = placement.slice_axis;
    return snow_ghosts_needed(context, whole, view, &known,
                              snow_look_has_gradient_opacity(look), true,
                              out->layers);
}

snow_status snow_ranks_have_order(snow_context *context,
                                  const snow_volume_info *whole,
                                  const snow_view *view, const snow_box *boxes,
                                  int count, bool *out) {
    snow_viewer sight;
    snow_placement placement;
    SNOW_TRY(snow_placement_make(context, whole, view, &placement));
    int *order = snow_allocate_array(context, (uint64_t)count, sizeof *order);
    if (!order)
        return SNOW_STATUS_NO_MEMORY;
    snow_clip_viewer(&placement, &sight);
    snow_status status = snow_order_boxes(context, boxes, count, &sight, order);
    snow_release(context, order);
    if (status == SNOW_STATUS_NO_MEMORY)
        return status;
    *out = status == SNOW_STATUS_OK;
    return SNOW_STATUS_OK;
}

void snow_ranks_slab(int64_t slices, int ranks, int rank, int64_t *first,
                     int64_t *count) {
    snow_slab slab = snow_slab_grouped(slices, ranks, rank);
    *first = slab.first;
    *count = slab.count;
}
