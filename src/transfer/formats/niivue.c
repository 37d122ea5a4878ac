/* transfer/formats/niivue.c - colour maps of niivue: arrays "R", "G", "B", "A"
 * of 0 to 255 at the positions "I" of 0 to 255.  They span "min" to "max" if
 * the file has them, otherwise the range of the data.  A is used as the opacity
 * of a voxel. */
#include "transfer/formats/json.h"

static const char *const words[] = {"R", "G", "B", "A", "I"};

/* Reads the five numbers of an entry, as shares.  Without I the entries are
 * equally spaced; without A all but the first are opaque. */
static bool take_entry(const json_t *map, size_t n, size_t count,
                       double entry[5]) {
    for (int i = 0; i < 5; i++) {
        const json_t *list = json_object_get(map, words[i]);
        bool may_lack = i >= 3 && !list;
        if (may_lack)
            entry[i] = i == 4 ? 255 * (double)n / (double)(count - 1)
                              : 255 * (double)(n > 0);
        else if (!tf_json_number(list, n, &entry[i]) ||
                 json_array_size(list) != count)
            return false;
        if (!(entry[i] >= 0 && entry[i] <= 255))
            return false;
        entry[i] /= 255;
    }
    return true;
}

snow_status tf_take_niivue(const tf_input *in, snow_look_file *tf,
                           const json_t *map) {
    const json_t *min = json_object_get(map, "min");
    const json_t *max = json_object_get(map, "max");
    double low = json_number_value(min), high = json_number_value(max);
    bool data = json_is_number(min) && json_is_number(max) && low < high;
    size_t count = json_array_size(json_object_get(map, "R"));
    if (count < 2)
        return tf_fail(in, "\"R\" has %zu entries; at least 2 are needed",
                       count);
    for (size_t n = 0; n < count; n++) {
        double entry[5];
        if (!take_entry(map, n, count, entry))
            return tf_fail(in,
                           "entry %zu is incomplete: R, G, B, A and I need the "
                           "same number of values, from 0 to 255",
                           n + 1);
        double value = data ? low * (1 - entry[4]) + high * entry[4] : entry[4];
        TF_TRY(tf_add_color(in, tf, value, entry));
        TF_TRY(
            tf_add_opacity(in, tf, &tf->opacities, "opacity", value, entry[3]));
    }
    tf->look.domain = data ? SNOW_DOMAIN_DATA : SNOW_DOMAIN_RANGE;
    tf->format = "niivue";
    return SNOW_STATUS_OK;
}
