/* recipe/kinds.h - the kinds of values that keys have. */
#ifndef SNOW_RECIPE_KINDS_H
#define SNOW_RECIPE_KINDS_H

#include "recipe/keys.h"

/* Numbers. Those that may be 0 in the record are omitted then, but for reals:
 * "int" and "long" of scalars.c, "given_reals" of arrays.c. */
extern const recipe_kind recipe_real, recipe_given_real, recipe_int,
    recipe_long, recipe_flag, recipe_scale;

/* Arrays of `count` numbers; a point is NaN if it is not given. A size is width
 * and height, which follow each other in the record. */
extern const recipe_kind recipe_reals, recipe_given_reals, recipe_point,
    recipe_longs, recipe_crop, recipe_clip, recipe_size;

/* Texts: any, a path or a list of paths (the first is kept), labels of a mask,
 * a known name. Names of values: always written, and omitted if they are 0. */
extern const recipe_kind recipe_text, recipe_input, recipe_labels, recipe_known,
    recipe_name, recipe_given_name;

extern const recipe_kind recipe_kernel, recipe_legend, recipe_annotate,
    recipe_measure, recipe_unit, recipe_iso, recipe_range, recipe_points,
    recipe_color, recipe_bits, recipe_light, recipe_material, recipe_channel,
    recipe_time;

/* --- for other kinds ------------------------------------------------------ */

/* Writes "must be TEXT"; returns false. */
bool recipe_refuse(char wrong[WRONG_BYTES], const char *text);

/* A whole number within the key's limits. */
bool recipe_read_whole(const recipe_key *key, const json_t *value, int64_t *out,
                       char wrong[WRONG_BYTES]);

key_read recipe_read_real, recipe_read_int, recipe_read_reals;
key_write recipe_write_real, recipe_write_given_int, recipe_write_reals;

#endif
