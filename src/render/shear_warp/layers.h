/* render/shear_warp/layers.h - volumes besides the picture's own, on its
 * grid (snow_frame_set_layers); stack.c takes their
 * steps. */
#ifndef SNOW_RENDER_SHEAR_WARP_LAYERS_H
#define SNOW_RENDER_SHEAR_WARP_LAYERS_H

#include "render/shear_warp/internal.h"

/* A tile with all layers, as a tile function, of some slices (NULL: of the
 * drawing's); behind the memory of the splat there is that of lists of slabs
 * and of two pictures of planes, of so many bytes. */
bool snow_value_draw_stack(const snow_value_drawing *job,
                           const snow_slab *slices, bool resumes, int x, int y,
                           void *scratch);
static inline size_t snow_value_stack_bytes(const snow_value_path *path,
                                            const snow_value_splat *splat) {
    return (size_t)(path->layer_count * path->lattice.resampled_count) * 2 *
               sizeof(int32_t) +
           (path->layer_count ? 2 * snow_value_planes_bytes(splat) : 0);
}

/* --- for these ---

 * A picture without its image (shear_warp.c); resampled slices and light
 * (draw.c); whether it has finite values. */
snow_status snow_value_begin_values(snow_value_path *path,
                                    const snow_value_params *params);
snow_status snow_value_place_drawing(snow_value_path *path,
                                     const snow_value_params *params);
static inline bool snow_value_has_values(const snow_value_path *path) {
    return path->range.low <= path->range.high;
}

#endif
