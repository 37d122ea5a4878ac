/* annotate/length.h - the unit in which lengths of a picture are read best. */
#ifndef SNOW_ANNOTATE_LENGTH_H
#define SNOW_ANNOTATE_LENGTH_H

/* Returns the factor that takes a length into that unit of nm, um, mm, m and km
 * in which its number is from `least` to below `below`, and stays where it is
 * so already.  `*unit` becomes the name as it is written in a picture.  1 for a
 * unit of another family, or for 0. */
double snow_length_factor(double length, double least, double below,
                          const char **unit);

/* For numbers of at most four digits before the point. */
#define SNOW_LENGTH_LEAST 0.1
#define SNOW_LENGTH_BELOW 10000

#endif
