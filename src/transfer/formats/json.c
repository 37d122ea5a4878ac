/* transfer/formats/json.c - finds out which of the JSON formats a text has. */
#include "transfer/formats/json.h"

/* ParaView writes a list of maps, most often of one. */
static const json_t *first_of(const tf_input *in, const json_t *tree) {
    if (!json_is_array(tree))
        return tree;
    for (size_t i = 0; i < json_array_size(tree) && in->wanted; i++) {
        const json_t *map = json_array_get(tree, i);
        const char *name = json_string_value(json_object_get(map, "Name"));
        if (name && tf_is_wanted(in, name))
            return map;
    }
    return in->wanted ? NULL : json_array_get(tree, 0);
}

static snow_status take_tree(const tf_input *in, snow_look_file *tf,
                             const json_t *tree) {
    const json_t *map = first_of(in, tree);
    if (!map && in->wanted)
        return tf_fail(in, "has no map '%.64s'; its names are in the file",
                       in->wanted);
    if (json_object_get(map, "snowglass-tf"))
        return tf_take_own(in, tf, map);
    if (json_object_get(map, "RGBPoints") || json_object_get(map, "Points"))
        return tf_take_paraview(in, tf, map);
    if (json_object_get(map, "R") && json_object_get(map, "G"))
        return tf_take_niivue(in, tf, map);
    return tf_fail(
        in, "is JSON but not a transfer function: \"snowglass-tf\", ParaView's "
            "\"RGBPoints\" and niivue's \"R\" and \"G\" are all missing");
}

snow_status tf_read_json(const tf_input *in, snow_look_file *tf) {
    json_error_t error;
    json_t *tree = json_loadb(in->bytes, in->size, 0, &error);
    if (!tree)
        return tf_fail(in, "line %d is not valid JSON: %s; correct it",
                       error.line, error.text);
    snow_status status = take_tree(in, tf, tree);
    json_decref(tree);
    return status;
}
