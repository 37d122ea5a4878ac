/* world.h - units of the world's axes, which of grids of the earth are not all
 * the same: longitude and latitude in degrees, beside a pressure in hPa.  Their
 * world is one in which the grid can be seen; what is printed are coordinates
 * of the file. */
#ifndef WORLD_H
#define WORLD_H

#include <snowglass/snowglass.h>

/* The unit along an axis; "" where there is none. */
const char *world_unit(const snow_volume_info *info, int axis);

/* All of them in a text with a blank in front: " mm", " degrees, degrees, hPa",
 * or "". */
void world_units(const snow_volume_info *info, char *out, size_t size);

/* The world's length of one unit; below 0 where they grow downward. */
double world_length(const snow_volume_info *info, int axis);

/* How many of the axis' units one of another is, where it has one of its own;
 * 0: they do not compare. */
double world_ratio(const snow_volume_info *info, int axis, const char *unit);

/* Matrix and spacing in the units of the axes. */
snow_volume_info world_in_units(const snow_volume_info *info);

#endif
