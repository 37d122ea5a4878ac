/* tf/tf.c - transfer functions from files: which format, its reader, and the
 * points that it makes. */
#include "tf/tf.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

snow_status tf_fail(const tf_input *in, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *at = text; *at; at++) /* of a name that a file gave */
        *at = (unsigned char)*at < ' ' ? '?' : *at;
    return snow_context_fail(in->context, SNOW_BAD_INPUT, "%s: %s", in->name,
                             text);
}

/* --- points ---------------------------------------------------------------
 */

static snow_status append(const tf_input *in, tf_list *list,
                          const void *point) {
    if (list->count == SNOW_TF_POINTS)
        return tf_fail(in, "has more than %d points; take fewer",
                       SNOW_TF_POINTS);
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 64;
        void *points = snow_context_allocate(in->context, room * list->size);
        if (!points)
            return SNOW_NO_MEMORY;
        if (list->count)
            memcpy(points, list->points, list->count * list->size);
        snow_context_release(in->context, list->points);
        list->points = points;
        list->room = room;
    }
    memcpy((char *)list->points + list->count++ * list->size, point,
           list->size);
    return SNOW_OK;
}

static snow_status check_value(const tf_input *in, const tf_list *list,
                               const char *what, double value) {
    double last = -INFINITY;
    if (list->count)
        memcpy(&last, (char *)list->points + (list->count - 1) * list->size,
               sizeof last);
    if (isfinite(value) && value >= last)
        return SNOW_OK;
    return tf_fail(in,
                   "%s point %zu at %g comes after %g; give finite values "
                   "in rising order",
                   what, list->count + 1, value, last);
}

/* Beyond 0 to 1 by rounding only. */
static bool cut(double *part) {
    if (!(*part >= -1e-6 && *part <= 1 + 1e-6))
        return false;
    *part = *part < 0 ? 0 : *part > 1 ? 1 : *part;
    return true;
}

snow_status tf_add_color(const tf_input *in, snow_tf *tf, double value,
                         const double rgb[3]) {
    snow_color_point point = {value, rgb[0], rgb[1], rgb[2]};
    TF_TRY(check_value(in, &tf->colors, "colour", value));
    if (!cut(&point.red) || !cut(&point.green) || !cut(&point.blue))
        return tf_fail(in,
                       "colour point %zu is (%g, %g, %g); red, green and "
                       "blue go from 0 to 1",
                       tf->colors.count + 1, rgb[0], rgb[1], rgb[2]);
    return append(in, &tf->colors, &point);
}

snow_status tf_add_opacity(const tf_input *in, snow_tf *tf, tf_list *list,
                           const char *what, double value, double opacity) {
    snow_opacity_point point = {value, opacity};
    (void)tf;
    TF_TRY(check_value(in, list, what, value));
    if (!cut(&point.opacity))
        return tf_fail(in, "%s point %zu is %g; it goes from 0 to 1", what,
                       list->count + 1, opacity);
    return append(in, list, &point);
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
void tf_set_name(snow_tf *tf, const char *name) {
    snprintf(tf->name, sizeof tf->name, "%s", name);
    for (char *at = tf->name; *at; at++)
        *at = (unsigned char)*at < ' ' || (unsigned char)*at > '~' ? '?' : *at;
}

/* The file's own name without folders and what follows the first point. */
static void name_by_file(snow_tf *tf, const char *path) {
    const char *slash = strrchr(path, '/');
    char name[TF_NAME_BYTES];
    snprintf(name, sizeof name, "%s", slash ? slash + 1 : path);
    name[strcspn(name, ".")] = 0;
    tf_set_name(tf, *name ? name : "file");
}

/* --- formats -------------------------------------------------------------- */

static bool ends_with(const char *text, const char *suffix) {
    size_t a = strlen(text), b = strlen(suffix);
    return a >= b && strcmp(text + a - b, suffix) == 0;
}

/* Text has no zero bytes. */
static bool is_text(const tf_input *in) {
    return !memchr(in->bytes, 0, in->size);
}

/* Numbers and blanks alone, and at least the light's six and three counts. */
static bool looks_like_vp(const tf_input *in) {
    const char *at = in->bytes, *end = at + in->size;
    double number;
    int count = 0;
    while (tf_take_number(&at, end, &number))
        count++;
    const char *first = memchr(in->bytes, '\n', in->size);
    long line = first ? first - in->bytes : 0;
    return at == end && count >= 9 && line > 0 && line < 4;
}

static snow_status read_bytes(const tf_input *in, snow_tf *tf) {
    const char *at = in->bytes;
    bool palette = in->size == 768 || in->size == 1024;
    if (in->size >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0)
        at += 3;
    at += strspn(at, " \t\r\n");
    if (palette && (ends_with(in->name, ".pal") || !is_text(in)))
        return tf_read_pal(in, tf);
    if (ends_with(in->name, ".pal"))
        return tf_fail(in,
                       "has %zu bytes; a palette has 768, or 1024 with "
                       "opacities",
                       in->size);
    if (!is_text(in))
        return tf_fail(in, "is no text and no palette; give a transfer "
                           "function");
    if (*at == '{' || *at == '[')
        return tf_read_json(in, tf);
    if (*at == '<')
        return tf_read_xml(in, tf);
    if (ends_with(in->name, ".vp") || looks_like_vp(in))
        return tf_read_vp(in, tf);
    return tf_read_csv(in, tf);
}

/* The record that users see, over the lists. */
static snow_status finish(const tf_input *in, snow_tf *tf) {
    snow_points *p = &tf->points;
    p->name = tf->name;
    p->colors = tf->colors.points;
    p->color_count = tf->colors.count;
    p->opacities = tf->opacities.points;
    p->opacity_count = tf->opacities.count;
    p->gradients = tf->gradients.points;
    p->gradient_count = tf->gradients.count;
    if (!p->color_count && !p->opacity_count)
        return tf_fail(in, "has neither colours nor opacities; give a transfer "
                           "function");
    if (p->log && ((p->color_count && !(p->colors[0].value > 0)) ||
                   (p->opacity_count && !(p->opacities[0].value > 0))))
        return tf_fail(in, "joins values by logarithms and has one of 0 or "
                           "below; give values above 0");
    return SNOW_OK;
}

snow_status snow_tf_parse(snow_context *context, const char *name,
                          const void *bytes, size_t size, const char *wanted,
                          snow_tf **out) {
    tf_input in = {context, name, bytes, size, wanted};
    if (size > SNOW_TF_BYTES)
        return tf_fail(&in,
                       "has more than %d bytes; no transfer function is "
                       "so long",
                       SNOW_TF_BYTES);
    /* Readers of text may look one byte beyond its end. */
    char *copy = snow_context_allocate(context, size + 1);
    snow_tf *tf = copy ? snow_context_allocate(context, sizeof *tf) : NULL;
    if (!tf) {
        snow_context_release(context, copy);
        return SNOW_NO_MEMORY;
    }
    if (size)
        memcpy(copy, bytes, size);
    copy[size] = 0;
    in.bytes = copy;
    if (size >= 3 && !memcmp(copy, "\xEF\xBB\xBF", 3)) { /* Unicode's mark */
        in.bytes += 3;
        in.size -= 3;
    }
    *tf = (snow_tf){.context = context,
                    .format = "",
                    .colors = {.size = sizeof(snow_color_point)},
                    .opacities = {.size = sizeof(snow_opacity_point)},
                    .gradients = {.size = sizeof(snow_opacity_point)}};
    name_by_file(tf, name);
    snow_status status = read_bytes(&in, tf);
    if (status == SNOW_OK)
        status = finish(&in, tf);
    snow_context_release(context, copy);
    if (status != SNOW_OK) {
        snow_tf_free(tf);
        return status;
    }
    *out = tf;
    return SNOW_OK;
}

void snow_tf_free(snow_tf *tf) {
    if (!tf)
        return;
    snow_context_release(tf->context, tf->colors.points);
    snow_context_release(tf->context, tf->opacities.points);
    snow_context_release(tf->context, tf->gradients.points);
    snow_context_release(tf->context, tf);
}

const snow_points *snow_tf_points(const snow_tf *tf) {
    return &tf->points;
}

const char *snow_tf_format(const snow_tf *tf) {
    return tf->format;
}

/* --- files ---------------------------------------------------------------- */

/* A whole regular file, which is not too large. */
static snow_status load(snow_context *context, const char *path,
                        const char *wanted, snow_tf **out) {
    const tf_input in = {context, path, NULL, 0, wanted};
    struct stat about;
    FILE *file = NULL;
    if (stat(path, &about) == 0 && S_ISREG(about.st_mode) &&
        about.st_size <= SNOW_TF_BYTES)
        file = fopen(path, "rb");
    if (!file)
        return tf_fail(&in,
                       "cannot be opened; name a file of a transfer "
                       "function that can be read, of at most %d MiB",
                       SNOW_TF_BYTES >> 20);
    size_t size = (size_t)about.st_size;
    char *bytes = snow_context_allocate(context, size + 1);
    snow_status status = bytes ? SNOW_OK : SNOW_NO_MEMORY;
    if (bytes && fread(bytes, 1, size, file) != size)
        status = tf_fail(&in, "cannot be read to its end; try again");
    fclose(file);
    if (status == SNOW_OK)
        status = snow_tf_parse(context, path, bytes, size, wanted, out);
    snow_context_release(context, bytes);
    return status;
}

snow_status snow_tf_load(snow_context *context, const char *path,
                         snow_tf **out) {
    char name[4096];
    struct stat about;
    const char *hash = strrchr(path, '#');
    size_t length = hash ? (size_t)(hash - path) : 0;
    if (!hash || !hash[1] || length >= sizeof name || stat(path, &about) == 0)
        return load(context, path, NULL, out);
    memcpy(name, path, length);
    name[length] = 0;
    return load(context, name, hash + 1, out);
}
