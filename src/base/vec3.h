/* base/vec3.h - vectors of three doubles. */
#ifndef SNOW_VEC3_H
#define SNOW_VEC3_H

#include <math.h>

static inline double snow_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double snow_length(const double a[3]) {
    return sqrt(snow_dot(a, a));
}

/* out must not be a or b. */
static inline void snow_cross(const double a[3], const double b[3],
                              double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Normalizes a vector that is not 0. */
static inline void snow_normalize(double a[3]) {
    double length = snow_length(a);
    for (int i = 0; i < 3; i++)
        a[i] /= length;
}

#endif
