/* tests/shear_warp/truth.h - how near a picture is to the truth, which is
 * method raycast in quality high. */
#ifndef SNOW_TEST_SHEAR_WARP_TRUTH_H
#define SNOW_TEST_SHEAR_WARP_TRUTH_H

#include "shear_warp/scenes.h"

/* Decibels of colours of peak 1 where either picture shows anything, and the
 * largest difference of any channel. */
typedef struct closeness {
    double decibels, worst;
    int pixels;
} closeness;

closeness closeness_of(const model_stage *stage, const warp_scene *scene);

#endif
