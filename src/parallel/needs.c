/* parallel/needs.c - what a picture by many ranks asks of the parts, for those
 * who cut them (snowglass/extend.h). */

#include "render/ghosts.h"
#include "render/job.h"
#include "transfer/look.h"

SNOW_RECORD_OF_ZEROS(snow_ranks_needs);

snow_status
snow_ranks_find_needs(snow_context *context, const snow_volume_info *whole,
                      const snow_view *view, const snow_settings *settings,
                      const snow_look *look, snow_ranks_needs *out) {
    snow_placement placement;
    snow_volume_info info;
    snow_view seen;
    snow_settings how;
    snow_look known;
    snow_ranks_needs needs;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, whole, &info));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &seen));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_settings, settings, &how));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_look, look, &known));
    SNOW_TRY(snow_settings_resolve(context, &info, &how));
    SNOW_TRY(snow_placement_make(context, &info, &seen, &placement));
    needs.slice_axis = placement.slice_axis;
    SNOW_TRY(snow_ghosts_needed(context, &info, &seen, &how,
                                snow_look_slopes(&known, &info), true,
                                needs.layers));
    return SNOW_RECORD_FILL(context, snow_ranks_needs, &needs, out);
}

snow_status snow_ranks_have_order(snow_context *context,
                                  const snow_volume_info *whole,
                                  const snow_view *view, const snow_box *boxes,
                                  int count, bool *out) {
    snow_viewer viewer;
    snow_placement placement;
    snow_volume_info info;
    snow_view seen;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, whole, &info));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &seen));
    SNOW_TRY(snow_placement_make(context, &info, &seen, &placement));
    int *order = NULL;
    SNOW_TRY(SNOW_RESERVE(context, order, 0, count));
    snow_clip_viewer(&placement, &viewer);
    snow_status status =
        snow_order_boxes(context, boxes, count, &viewer, order);
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
