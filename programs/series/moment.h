/* moment.h - the step whose time is nearest to one that is wanted, for the tool
 * and the Python package. */
#ifndef MOMENT_H
#define MOMENT_H

#include <snowglass/snowglass.h>

/* A time: a number, or a date. */
typedef struct moment {
    double value;     /* NaN: none is wanted */
    char unit[16];    /* "" for the input's, or as s, ms, h */
    const char *date; /* in place of both, as "2005-08-28 06:00"; or NULL */
} moment;

/* Reads a date, or a number with a unit or a point in it: "0.3", "0.3s", "6 h".
 * Returns false for other text. A date is kept as it stands. */
bool moment_read(const char *text, moment *out);

/* Fills *out with what the header of a step says. */
typedef snow_status moment_step_fn(void *user, int64_t step,
                                   snow_volume_info *out);

/* Finds the nearest of `count` steps, of which *at is the header. Errors: those
 * of `read`; BAD_USAGE (the input has no such times). */
snow_status moment_find(snow_context *context, const moment *wanted,
                        int64_t count, moment_step_fn *read, void *user,
                        int64_t *step, snow_volume_info *at);

/* Returns whether people read the same time of a step and of what is wanted. */
bool moment_is_at(const moment *wanted, const snow_volume_info *at);

#endif
