/* render/shear_warp/stack.c - the steps of a picture, of the layers that are
 * drawn with it. */
#include "render/shear_warp/layers.h"

/* --- values --------------------------------------------------------------- */

snow_status snow_value_measure_layer(snow_value_path *path, int n,
                                     const snow_layer *given, int threads,
                                     snow_data_range *out) {
    SNOW_TRY(snow_value_path_new(path->context, &path->layers[n]));
    SNOW_TRY(snow_value_measure(path->layers[n], given->volume, given->transfer,
                                threads, out));
    if (!given->volume->stream)
        return SNOW_STATUS_OK;
    /* Whatever a file has, places beside it have no value, or label 0. */
    out->holes = true;
    return snow_transfer_has_labels(given->transfer, &given->volume->info)
               ? snow_value_labels_name(path->layers[n]->context,
                                        &path->layers[n]->labels, 0)
               : SNOW_STATUS_OK;
}

snow_status snow_value_set_layers(snow_value_path *path,
                                  const snow_data_range *ranges, int count) {
    for (int n = 0; n < count; n++) {
        SNOW_TRY(snow_value_path_new(path->context, &path->layers[n]));
        snow_value_set_range(path->layers[n], &ranges[n]);
    }
    path->layer_count = count;
    return SNOW_STATUS_OK;
}

/* --- a part --------------------------------------------------------------- */

/* A layer has ghost voxels of its own (render/layers.c). */
static snow_value_params params_of(const snow_value_path *path,
                                   const snow_value_params *params, int n) {
    snow_value_params own = *params;
    snow_value_path *layer = path->layers[n];
    own.volume = params->layers[n].volume;
    own.transfer = own.counted = params->layers[n].transfer;
    own.layer_count = 0;
    snow_clip_make(own.volume, params->placement, &layer->clip);
    snow_clip_placement(&layer->clip, params->placement, &layer->stored);
    own.clip = &layer->clip;
    own.stored = &layer->stored;
    return own;
}

snow_status snow_value_encode_layers(snow_value_path *path,
                                     const snow_value_params *params) {
    path->white = params->transfer->white;
    for (int n = 0; n < path->layer_count; n++) {
        const snow_value_params own = params_of(path, params, n);
        snow_stats unused = {.size = sizeof unused};
        path->layers[n]->group =
            (n ? path->layers[n - 1]->group : 0) + !params->layers[n].mixes;
        SNOW_TRY(snow_value_begin_values(path->layers[n], &own));
        snow_status status = snow_value_encode(path->layers[n], &own, &unused);
        if (snow_value_lacks_memory(path, status))
            status = snow_value_encode(path->layers[n], &own, &unused);
        SNOW_TRY(status);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_value_place_layers(snow_value_path *path,
                                    const snow_value_params *params) {
    for (int n = 0; n < path->layer_count; n++) {
        const snow_value_params own = params_of(path, params, n);
        if (snow_value_has_values(path->layers[n]))
            SNOW_TRY(snow_value_place_drawing(path->layers[n], &own));
        path->layers[n]->drawing.splat.floats = true;
    }
    return SNOW_STATUS_OK;
}
