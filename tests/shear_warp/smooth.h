/* tests/shear_warp/smooth.h - scenes without frequencies near the sampling
 * rate: there method raycast is a sharp truth, and what is left of the
 * difference to it is what shear-warp approximates. */
#ifndef SNOW_TEST_SHEAR_WARP_SMOOTH_H
#define SNOW_TEST_SHEAR_WARP_SMOOTH_H

#include "shear_warp/scenes.h"

/* What a field is made of. */
typedef enum smooth_field {
    SMOOTH_BUMPS, /* Gaussians, nearly 0 at the sides */
    SMOOTH_WAVES, /* low sinusoids, on a rise along z; seen within it */
    SMOOTH_HILLS, /* the same with a rise that nothing turns round */
    SMOOTH_SIGNS  /* bumps above and below 0 */
} smooth_field;

/* A scene by method shear-warp in quality high with a head light, of 72x64
 * pixels, whose sizes, field and angles the random quantized values give;
 * values of 0 to 100, or -100 to 100.  The opacity rises over all of them. */
warp_scene smooth_scene(smooth_field field, snow_type type, model_matrix matrix,
                        uint64_t *random);

/* Another volume on its grid. */
warp_scene smooth_scene_beside(const warp_scene *scene, uint64_t *random);

#endif
