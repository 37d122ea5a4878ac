/* base/minmax.h - the smaller and the larger of two numbers. */
#ifndef SNOW_MINMAX_H
#define SNOW_MINMAX_H

/* Of numbers without side effects.  Unlike fmin and fmax they are never calls,
 * and of a NaN they take the second. */
#define SNOW_MIN(a, b) ((a) < (b) ? (a) : (b))
#define SNOW_MAX(a, b) ((a) > (b) ? (a) : (b))

#endif
