/* measures.h - what --measure asks for, measured: lengths, angles, and the
 * values in ellipses on slices. */
#ifndef MEASURES_H
#define MEASURES_H

#include "options/options.h"

#include <jansson.h>

typedef struct measures {
    int count;
    snow_measure each[SNOW_MEASURES_MAX];
    snow_volume_info whole; /* in whose world they are */
    char unit[32];          /* of values, or "" */
} measures;

/* Measures in the world of `whole`: in `volume`, which may be a part of it, or
 * NULL; slices that it has not are read of the file.  Nothing is found where
 * nothing is asked, *out NULL.  Points may lie outside if `everywhere`.
 * Returns CONTINUE or an exit code. */
int measures_find(const options *opts, snow_context *context, const char *path,
                  const snow_volume_info *whole, const snow_volume *volume,
                  bool everywhere, measures **out);

/* Draws them into a picture from (x, y) on: of a volume, or of slice `index`
 * across an axis of the grid those that lie in it; `index` -1: no slice. */
snow_status measures_draw(const measures *m, const snow_volume_info *info,
                          const snow_view *view, double x, double y, int axis,
                          int64_t index, snow_overlay *overlay);

/* A list for --stats and pages. */
json_t *measures_json(const measures *m);

/* Prints a line for each. */
void measures_report(const measures *m);

#endif
