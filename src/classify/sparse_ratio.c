/* classify/sparse_ratio.c - how empty a volume is (Table 1 of the paper). */
#include "classify/classify.h"

/* Counts the voxels that the classifier keeps, strip by strip. */
static int64_t count_kept(const snow_classifier *classifier,
                          const snow_placement *placement, snow_strip *strip) {
    int64_t kept = 0;
    for (int64_t slice = 0; slice < placement->slices; slice++)
        for (int64_t row = 0; row < placement->rows; row += strip->room_rows) {
            int64_t rows = placement->rows - row;
            if (rows > strip->room_rows)
                rows = strip->room_rows;
            snow_classify_strip(classifier, placement, slice, row, rows, strip);
            kept += (int64_t)strip->count;
        }
    return kept;
}

snow_status snow_transfer_sparse_ratio(const snow_transfer *transfer,
                                       const snow_volume *volume,
                                       double threshold, double *ratio) {
    const int64_t *dims = volume->info.dims;
    snow_context *context = transfer->context;
    /* Slices as they lie in memory; no camera is needed to count. */
    snow_placement placement = {.slice_axis = 2,
                                .u_axis = 0,
                                .v_axis = 1,
                                .columns = dims[0],
                                .rows = dims[1],
                                .slices = dims[2]};
    snow_classify_options options = {.threshold = threshold,
                                     .opacity_exponent = 1};
    snow_classifier classifier = {0};
    snow_strip strip = {0};
    snow_status status =
        snow_classifier_make(context, volume, transfer, &options, &classifier);
    if (status == SNOW_OK)
        status =
            snow_strip_make(context, &placement, classifier.channels, &strip);
    if (status == SNOW_OK) {
        double voxels = (double)dims[0] * (double)dims[1] * (double)dims[2];
        double kept = (double)count_kept(&classifier, &placement, &strip);
        *ratio = 1 - kept / voxels;
    }
    snow_strip_free(context, &strip);
    snow_classifier_fini(context, &classifier);
    return status;
}
