/* tests/values/cases.h - volumes and looks by which pictures are held
 * against the truth, and what "how far" means. */
#ifndef SNOW_TEST_VALUE_CASES_H
#define SNOW_TEST_VALUE_CASES_H

#include "support/support.h"
#include "values/value_model.h"

typedef enum value_case_volume {
    VALUE_CASE_ENGINE, /* real: 256x256x110, 8 bits */
    VALUE_CASE_HEAD,   /* real: CT, 256x256x113, 16 bits, 1x1x2 */
    VALUE_CASE_PHANTOM,
    VALUE_CASE_SPHERE, /* hard, radius 36 and a bit, 96x96x96 */
    VALUE_CASE_BALL,   /* soft, 96x96x48, 1x1x2 */
    VALUE_CASE_THICK   /* smaller, slices 8 apart, 96x96x12 */
} value_case_volume;

typedef struct value_case {
    const char *name;
    value_case_volume volume;
    const snow_color_point *colors;
    size_t color_count;
    const snow_opacity_point *opacities;
    size_t opacity_count;
    bool shaded;
    char side; /* the camera sits at +y or +z */
    double azimuth, elevation, zoom;
    double reached[3]; /* dB from the truth in draft, normal and high */
} value_case;

extern const value_case value_cases[];
extern const size_t value_case_count;

/* The scene of a case at 512x512 and its voxels, which live until the volume is
 * closed; false where the data are absent. */
typedef struct value_case_scene {
    value_scene scene;
    snow_volume *volume;
    void *voxels; /* where there is no volume */
} value_case_scene;

bool value_case_open(const value_case *what, snow_context *context,
                     value_case_scene *out);
void value_case_close(value_case_scene *open);

/* Squares of differences of premultiplied red, green and blue over the pixels
 * where either picture has an opacity. */
typedef struct value_distance {
    double squares, largest;
    int64_t pixels;
} value_distance;

void value_distance_add(value_distance *distance, const double picture[4],
                        const double truth[4]);
double value_distance_decibels(const value_distance *distance);

#endif
