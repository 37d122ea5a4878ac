/* transfer/formats/json.h - the readers of JSON, which share one parser. */
#ifndef SNOW_TRANSFER_FORMATS_JSON_H
#define SNOW_TRANSFER_FORMATS_JSON_H

#include "transfer/formats/tf.h"

#include <jansson.h>

snow_status tf_take_own(const tf_input *in, snow_look_file *tf,
                        const json_t *tree);
snow_status tf_take_paraview(const tf_input *in, snow_look_file *tf,
                             const json_t *tree);
snow_status tf_take_niivue(const tf_input *in, snow_look_file *tf,
                           const json_t *tree);

/* Number `index` of an array; false where it is none. */
static inline bool tf_json_number(const json_t *array, size_t index,
                                  double *out) {
    const json_t *item = json_array_get(array, index);
    if (!json_is_number(item))
        return false;
    *out = json_number_value(item);
    return true;
}

#endif
