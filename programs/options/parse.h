/* parse.h - the functions that parse one option's argument into its field; see
 * option_read in options.h.  Each comment gives the type of the field. */
#ifndef READERS_H
#define READERS_H

#include "options/options.h"

option_read read_text;      /* const char * */
option_read read_flag;      /* bool: true */
option_read read_constant;  /* int: the row's lower limit */
option_read read_choice;    /* const char *: one of the row's choices */
option_read read_kernel;    /* const char *, and options.footprint */
option_read read_combine;   /* const char *, and options.radix */
option_read read_real;      /* double within low..high */
option_read read_fov;       /* double; the default for an empty text */
option_read read_strength;  /* double; 1 for an empty text */
option_read read_z_scale;   /* double; 0 for auto */
option_read read_tolerance; /* double; quotients are allowed */
option_read read_time;
option_read read_integer;         /* int64_t within low..high */
option_read read_count;           /* uint64_t */
option_read read_bytes;           /* uint64_t; units as in 4G or 4GiB */
option_read read_window;          /* double[2]: width, centre */
option_read read_size;            /* int64_t[2] */
option_read read_dims;            /* int64_t[3] */
option_read read_component;       /* const char * */
option_read read_channels;        /* channel_list */
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
option_read read_overlay_look;    /* overlay_look */
option_read read_gradient_points; /* point_list */
option_read read_light;           /* light_value */
option_read read_legend;          /* legend_value */
option_read read_annotate;        /* annotate_value */
option_read read_measure;         /* const char * */
option_read read_material;        /* double[4] */
option_read read_scale;           /* scale_value */
option_read read_place;           /* place_value */
option_read read_listen;          /* listen_value */

/* Checks the number of operands; `named`: the verb was written. Returns
 * CONTINUE or an exit code. */
int operands_check(const options *out, const verb_row *verb, bool named);

/* What readers share: each writes the end of an error message and returns
 * false, but for the test. */
bool parse_refuse(char wrong[WRONG_BYTES], const char *text);
bool parse_refuse_number(const option_row *row, const char *kind,
                         char wrong[WRONG_BYTES]);
bool parse_refuse_name(const option_row *row, const char *text,
                       const char *(*name)(size_t), char wrong[WRONG_BYTES]);
bool parse_within(const option_row *row, double value);

/* Writes " (did you mean a?)" for a word that is near one of a|b|c, else "". */
void parse_near(const char *choices, const char *text, char *out, size_t size);

#endif
