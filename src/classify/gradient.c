/* classify/gradient.c - gradients of native values in index space (model, point
 * 4), for each scalar type. */
#include "classify/classify.h"

#include <math.h>

/* The difference at `here` from neighbours that count only when finite. */
static double difference(double here, double below, double above) {
    bool has_below = isfinite(below), has_above = isfinite(above);
    if (has_below && has_above)
        return (above - below) / 2;
    if (has_above && isfinite(here))
        return above - here;
    if (has_below && isfinite(here))
        return here - below;
    return 0;
}

#define GRADIENT_TYPE int8_t
#define GRADIENT_NAME gradient_int8
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE uint8_t
#define GRADIENT_NAME gradient_uint8
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE int16_t
#define GRADIENT_NAME gradient_int16
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE uint16_t
#define GRADIENT_NAME gradient_uint16
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE int32_t
#define GRADIENT_NAME gradient_int32
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE uint32_t
#define GRADIENT_NAME gradient_uint32
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE int64_t
#define GRADIENT_NAME gradient_int64
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE uint64_t
#define GRADIENT_NAME gradient_uint64
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE float
#define GRADIENT_NAME gradient_float32
#include "classify/gradient.tmpl.h"
#define GRADIENT_TYPE double
#define GRADIENT_NAME gradient_float64
#include "classify/gradient.tmpl.h"

static snow_gradient_fn *const type_gradients[] = {
    [SNOW_INT8] = gradient_int8,       [SNOW_UINT8] = gradient_uint8,
    [SNOW_INT16] = gradient_int16,     [SNOW_UINT16] = gradient_uint16,
    [SNOW_INT32] = gradient_int32,     [SNOW_UINT32] = gradient_uint32,
    [SNOW_INT64] = gradient_int64,     [SNOW_UINT64] = gradient_uint64,
    [SNOW_FLOAT32] = gradient_float32, [SNOW_FLOAT64] = gradient_float64,
};

snow_gradient_fn *snow_gradient_of(snow_type type) {
    return type_gradients[type];
}
