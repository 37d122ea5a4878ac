/* transfer/scale.h - scales on which values are placed: linear, logarithmic, or
 * symmetric and logarithmic on both sides of a linear part around 0. */
#ifndef SNOW_TRANSFER_SCALE_H
#define SNOW_TRANSFER_SCALE_H

#include <stdbool.h>

/* Zeros: linear.  With `linear` above 0 a value v is at v / linear up to there,
 * and beyond it at 1 + ln(v / linear), which goes on without a bend; negative
 * values are placed alike. */
typedef struct snow_scale {
    bool log;
    double linear;
} snow_scale;

/* low + share * (high - low) on the scale, for any finite ends (a logarithmic
 * one: 0 < low < high): exactly high from share 1 on, and never decreasing as
 * share grows, whatever the rounding.  The inverse: the share at which a value
 * lies. */
double snow_between_on(snow_scale scale, double low, double high, double share);
double snow_share_on(snow_scale scale, double low, double high, double value);

/* The place of a value on a scale that is not linear; the value there. */
double snow_scale_place(snow_scale scale, double value);
double snow_scale_value(snow_scale scale, double place);

/* The largest number of the form 1, 2 or 5 times a power of ten that is not
 * above a length. */
double snow_round_below(double length);

#endif
