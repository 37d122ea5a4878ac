/* readers.h - the functions that read one option's argument into its field;
 * see option_read in options.h.  The comment names the type of the field. */
#ifndef READERS_H
#define READERS_H

#include "options.h"

option_read read_text;            /* const char * */
option_read read_flag;            /* bool: true */
option_read read_constant;        /* int: the row's low */
option_read read_choice;          /* const char *: one of the row's argument */
option_read read_real;            /* double within low..high */
option_read read_fov;             /* double; an empty text is the usual one */
option_read read_tolerance;       /* double, also as a quotient */
option_read read_integer;         /* int64_t within low..high */
option_read read_count;           /* uint64_t */
option_read read_bytes;           /* uint64_t, also as 4G or 4GiB */
option_read read_size;            /* int64_t[2] */
option_read read_dims;            /* int64_t[3] */
option_read read_labels;          /* const char * */
option_read read_clip;            /* double[6][4] */
option_read read_crop;            /* int64_t[3][2] */
option_read read_spacing;         /* double[3] */
option_read read_type;            /* snow_type */
option_read read_preset;          /* const char * */
option_read read_colormap;        /* const char * */
option_read read_view;            /* const char * */
option_read read_color;           /* color_value */
option_read read_range;           /* range_value */
option_read read_points;          /* point_list */
option_read read_gradient_points; /* point_list */
option_read read_directions;      /* double[2] */
option_read read_place;           /* place_value */

#endif
