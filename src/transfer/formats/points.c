/* transfer/formats/points.c - the points and the name that readers make, and
 * their messages. */
#include "transfer/formats/tf.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

snow_status tf_fail(const tf_input *in, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    snow_text_vprint(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *at = text; *at; at++) /* of a name that a file gave */
        *at = (unsigned char)*at < ' ' ? '?' : *at;
    return snow_context_fail(in->context, SNOW_STATUS_BAD_INPUT, "%s: %s",
                             in->name, text);
}

/* --- points --------------------------------------------------------------- */

static snow_status append_point(const tf_input *in, tf_list *list,
                                const void *point) {
    if (list->count == SNOW_LOOK_POINTS_MAX)
        return tf_fail(in, "has more than %d points; take fewer",
                       SNOW_LOOK_POINTS_MAX);
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 64;
        void *points = snow_context_allocate(in->context, room * list->size);
        if (!points)
            return SNOW_STATUS_NO_MEMORY;
        if (list->count)
            memcpy(points, list->points, list->count * list->size);
        snow_context_release(in->context, list->points);
        list->points = points;
        list->room = room;
    }
    memcpy((char *)list->points + list->count++ * list->size, point,
           list->size);
    return SNOW_STATUS_OK;
}

static snow_status check_value(const tf_input *in, const tf_list *list,
                               const char *what, double value) {
    double last = -INFINITY;
    if (list->count)
        memcpy(&last, (char *)list->points + (list->count - 1) * list->size,
               sizeof last);
    if (isfinite(value) && value >= last)
        return SNOW_STATUS_OK;
    return tf_fail(in,
                   "%s point %zu at %g comes after %g; give finite values "
                   "in rising order",
                   what, list->count + 1, value, last);
}

/* Beyond 0 to 1 by rounding only. */
static bool clamp_share(double *part) {
    if (!(*part >= -1e-6 && *part <= 1 + 1e-6))
        return false;
    *part = *part < 0 ? 0 : *part > 1 ? 1 : *part;
    return true;
}

snow_status tf_add_color(const tf_input *in, snow_look_file *tf, double value,
                         const double rgb[3]) {
    snow_color_point point = {value, rgb[0], rgb[1], rgb[2]};
    TF_TRY(check_value(in, &tf->colors, "colour", value));
    if (!clamp_share(&point.red) || !clamp_share(&point.green) ||
        !clamp_share(&point.blue))
        return tf_fail(in,
                       "colour point %zu is (%g, %g, %g); red, green and "
                       "blue go from 0 to 1",
                       tf->colors.count + 1, rgb[0], rgb[1], rgb[2]);
    return append_point(in, &tf->colors, &point);
}

snow_status tf_add_opacity(const tf_input *in, snow_look_file *tf,
                           tf_list *list, const char *what, double value,
                           double opacity) {
    snow_opacity_point point = {value, opacity};
    (void)tf;
    TF_TRY(check_value(in, list, what, value));
    if (!clamp_share(&point.opacity))
        return tf_fail(in, "%s point %zu is %g; it goes from 0 to 1", what,
                       list->count + 1, opacity);
    return append_point(in, list, &point);
}

/* --- names ---------------------------------------------------------------- */

static char next_letter(const char **at) {
    while (**at == '-' || **at == '_' || **at == ' ')
        (*at)++;
    char c = **at;
    *at += c != 0;
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

bool tf_is_wanted(const tf_input *in, const char *name) {
    const char *wanted = in->wanted;
    for (;;) {
        char a = next_letter(&name), b = next_letter(&wanted);
        if (a != b)
            return false;
        if (!a)
            return true;
    }
}

/* Names are printed: what is no letter of ASCII becomes one. */
void tf_set_name(snow_look_file *tf, const char *name) {
    snprintf(tf->name, sizeof tf->name, "%s", name);
    for (char *at = tf->name; *at; at++)
        *at = (unsigned char)*at < ' ' || (unsigned char)*at > '~' ? '?' : *at;
}
