/* tf/json.h - the readers of JSON, which share one parser. */
#ifndef SNOW_TF_JSON_H
#define SNOW_TF_JSON_H

#include "tf/tf.h"

#include <jansson.h>

snow_status tf_take_own(const tf_input *in, snow_tf *tf, const json_t *tree);
snow_status tf_take_paraview(const tf_input *in, snow_tf *tf,
                             const json_t *tree);
snow_status tf_take_niivue(const tf_input *in, snow_tf *tf, const json_t *tree);

/* Number `index` of an array; false where it is none. */
bool tf_json_number(const json_t *array, size_t index, double *out);

#endif
