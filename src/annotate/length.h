/* annotate/length.h - the unit in which lengths of a picture are read best. */
#ifndef SNOW_ANNOTATE_LENGTH_H
#define SNOW_ANNOTATE_LENGTH_H

/* Returns the factor that takes a length of a unit into the next larger or
 * smaller unit, up or down so often that the number is from 1 to below `below`:
 * of nm, um, mm, m and km.  `*unit` becomes that one's name as it is written in
 * a picture.  1 for a unit of another family, or for 0. */
double snow_length_factor(double length, double below, const char **unit);

#endif
