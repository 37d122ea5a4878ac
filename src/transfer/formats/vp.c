/* transfer/formats/vp.c - 3D Slicer's volume properties (.vp).
 *
 * Numbers in text: interpolation, shade flag, diffuse, ambient, specular,
 * specular power, and three lists, each "count v v v ...": scalar opacity
 * (value, opacity), gradient opacity (magnitude, factor) and colour (value,
 * red, green, blue), values in data units. */
#include "transfer/formats/tf.h"

#include <string.h>

/* Reads the count of a list, and checks that it is a multiple of a point's. */
static snow_status take_count(const tf_input *in, const char *what, int each,
                              const char **at, const char *end, long *out) {
    double count;
    if (!tf_take_number(at, end, &count))
        return tf_fail(in,
                       "the list of %s is missing; the file is truncated, or "
                       "not a volume property",
                       what);
    if (!(count >= 0 && count <= 4.0 * SNOW_LOOK_POINTS_MAX) ||
        count != (double)(long)count || (long)count % each)
        return tf_fail(
            in, "the list of %s has %g numbers; it needs %d for each point",
            what, count, each);
    *out = (long)count / each;
    return SNOW_STATUS_OK;
}

static snow_status take_numbers(const tf_input *in, const char *what, int each,
                                const char **at, const char *end,
                                double numbers[4]) {
    for (int i = 0; i < each; i++)
        if (!tf_take_number(at, end, &numbers[i]))
            return tf_fail(
                in,
                "the list of %s ends early, or has something that is not a "
                "number; it needs as many numbers as its count",
                what);
    return SNOW_STATUS_OK;
}

static snow_status take_pairs(const tf_input *in, snow_look_file *tf,
                              tf_list *list, const char *what, const char **at,
                              const char *end) {
    long count = 0;
    double pair[4];
    TF_TRY(take_count(in, what, 2, at, end, &count));
    for (; count > 0; count--) {
        TF_TRY(take_numbers(in, what, 2, at, end, pair));
        TF_TRY(tf_add_opacity(in, tf, list, what, pair[0], pair[1]));
    }
    return SNOW_STATUS_OK;
}

static snow_status take_colors(const tf_input *in, snow_look_file *tf,
                               const char **at, const char *end) {
    long count = 0;
    double point[4];
    TF_TRY(take_count(in, "colours", 4, at, end, &count));
    for (; count > 0; count--) {
        TF_TRY(take_numbers(in, "colours", 4, at, end, point));
        TF_TRY(tf_add_color(in, tf, point[0], point + 1));
    }
    return SNOW_STATUS_OK;
}

/* Texts that are NULL count as empty lists. */
snow_status tf_read_slicer_lists(const tf_input *in, snow_look_file *tf,
                                 const char *opacities, const char *gradients,
                                 const char *colors) {
    if (opacities)
        TF_TRY(take_pairs(in, tf, &tf->opacities, "opacities", &opacities,
                          opacities + strlen(opacities)));
    if (gradients)
        TF_TRY(take_pairs(in, tf, &tf->gradients, "gradient opacities",
                          &gradients, gradients + strlen(gradients)));
    if (colors)
        TF_TRY(take_colors(in, tf, &colors, colors + strlen(colors)));
    return SNOW_STATUS_OK;
}

snow_status tf_read_vp(const tf_input *in, snow_look_file *tf) {
    const char *at = in->bytes, *end = in->bytes + in->size;
    double light[6];
    for (int i = 0; i < 6; i++)
        if (!tf_take_number(&at, end, &light[i]))
            return tf_fail(in,
                           "number %d of the light is missing; the file is "
                           "truncated, or not a volume property",
                           i + 1);
    TF_TRY(take_pairs(in, tf, &tf->opacities, "opacities", &at, end));
    TF_TRY(take_pairs(in, tf, &tf->gradients, "gradient opacities", &at, end));
    TF_TRY(take_colors(in, tf, &at, end));
    tf->format = "slicer-vp";
    snow_context_warn(in->context,
                      "%s: its light is ignored; --material %g,%g,%g,%g "
                      "(ambient, diffuse, specular, shininess) has it",
                      in->name, light[3], light[2], light[4], light[5]);
    return SNOW_STATUS_OK;
}
