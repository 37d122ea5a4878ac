/* transfer/formats/tf.c - reads transfer functions from files: finds the
 * format, calls its reader, and makes the points. */
#include "transfer/formats/tf.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* The file's own name without folders and what follows the first point. */
static void name_by_file(snow_look_file *tf, const char *path) {
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

/* Returns whether it has only numbers and blanks, and at least the six of the
 * light and three counts. */
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

static snow_status read_bytes(const tf_input *in, snow_look_file *tf) {
    const char *at = in->bytes;
    bool palette = in->size == 768 || in->size == 1024;
    if (in->size >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0)
        at += 3;
    at += strspn(at, " \t\r\n");
    const bool text = !memchr(in->bytes, 0, in->size); /* without zero bytes */
    if (palette && (ends_with(in->name, ".pal") || !text))
        return tf_read_pal(in, tf);
    if (ends_with(in->name, ".pal"))
        return tf_fail(
            in, "has %zu bytes; a palette has 768, or 1024 with opacities",
            in->size);
    if (!text)
        return tf_fail(
            in, "is neither text nor a palette; give a transfer function");
    if (*at == '{' || *at == '[')
        return tf_read_json(in, tf);
    if (*at == '<')
        return tf_read_xml(in, tf);
    if (ends_with(in->name, ".vp") || looks_like_vp(in))
        return tf_read_vp(in, tf);
    return tf_read_csv(in, tf);
}

/* Fills the public record with the lists. */
static snow_status fill_look(const tf_input *in, snow_look_file *tf) {
    snow_look *p = &tf->look;
    p->name = tf->name;
    p->colors = tf->colors.points;
    p->color_count = tf->colors.count;
    p->opacities = tf->opacities.points;
    p->opacity_count = tf->opacities.count;
    p->gradient_opacities = tf->gradients.points;
    p->gradient_opacity_count = tf->gradients.count;
    if (!p->color_count && !p->opacity_count)
        return tf_fail(
            in, "has neither colours nor opacities; give a transfer function");
    if (p->log && ((p->color_count && !(p->colors[0].value > 0)) ||
                   (p->opacity_count && !(p->opacities[0].value > 0))))
        return tf_fail(in, "interpolates by logarithms but has a value of 0 or "
                           "below; give values above 0");
    return SNOW_STATUS_OK;
}

snow_status snow_look_parse(snow_context *context, const char *name,
                            const void *bytes, size_t size, const char *wanted,
                            snow_look_file **out) {
    tf_input in = {context, name, bytes, size, wanted};
    if (size > SNOW_LOOK_BYTES_MAX)
        return tf_fail(
            &in, "has more than %d bytes; no transfer function is so long",
            SNOW_LOOK_BYTES_MAX);
    /* Readers of text may read one byte beyond its end. */
    char *copy = snow_context_allocate(context, size + 1);
    snow_look_file *tf =
        copy ? snow_context_allocate(context, sizeof *tf) : NULL;
    if (!tf) {
        snow_context_release(context, copy);
        return SNOW_STATUS_NO_MEMORY;
    }
    if (size)
        memcpy(copy, bytes, size);
    copy[size] = 0;
    in.bytes = copy;
    if (size >= 3 &&
        !memcmp(copy, "\xEF\xBB\xBF", 3)) { /* the byte order mark of UTF-8 */
        in.bytes += 3;
        in.size -= 3;
    }
    *tf = (snow_look_file){.context = context,
                           .format = "",
                           .colors = {.size = sizeof(snow_color_point)},
                           .opacities = {.size = sizeof(snow_opacity_point)},
                           .gradients = {.size = sizeof(snow_opacity_point)},
                           .look = {.size = sizeof(snow_look)}};
    name_by_file(tf, name);
    snow_status status = read_bytes(&in, tf);
    if (status == SNOW_STATUS_OK)
        status = fill_look(&in, tf);
    snow_context_release(context, copy);
    if (status != SNOW_STATUS_OK) {
        snow_look_file_free(tf);
        return status;
    }
    *out = tf;
    return SNOW_STATUS_OK;
}

void snow_look_file_free(snow_look_file *tf) {
    if (!tf)
        return;
    snow_context_release(tf->context, tf->colors.points);
    snow_context_release(tf->context, tf->opacities.points);
    snow_context_release(tf->context, tf->gradients.points);
    snow_context_release(tf->context, tf);
}

const snow_look *snow_look_file_look(const snow_look_file *tf) {
    return &tf->look;
}

const char *snow_look_file_format(const snow_look_file *tf) {
    return tf->format;
}

/* --- files ---------------------------------------------------------------- */

/* Reads a regular file as a whole, if it is not too large. */
static snow_status load(snow_context *context, const char *path,
                        const char *wanted, snow_look_file **out) {
    const tf_input in = {context, path, NULL, 0, wanted};
    struct stat about;
    FILE *file = NULL;
    if (stat(path, &about) == 0 && S_ISREG(about.st_mode) &&
        about.st_size <= SNOW_LOOK_BYTES_MAX)
        file = fopen(path, "rb");
    if (!file)
        return tf_fail(&in,
                       "cannot be opened; name a readable file of a transfer "
                       "function, of at most %d MiB",
                       SNOW_LOOK_BYTES_MAX >> 20);
    size_t size = (size_t)about.st_size;
    char *bytes = snow_context_allocate(context, size + 1);
    snow_status status = bytes ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    if (bytes && fread(bytes, 1, size, file) != size)
        status = tf_fail(&in, "cannot be read to the end; try again");
    fclose(file);
    if (status == SNOW_STATUS_OK)
        status = snow_look_parse(context, path, bytes, size, wanted, out);
    snow_context_release(context, bytes);
    return status;
}

snow_status snow_look_load(snow_context *context, const char *path,
                           snow_look_file **out) {
    char name[4096];
    struct stat about;
    if (!path)
        return snow_context_fail(context, SNOW_STATUS_BAD_USAGE,
                                 "the path is NULL; give one");
    const char *hash = strrchr(path, '#');
    size_t length = hash ? (size_t)(hash - path) : 0;
    /* What cannot be looked at is a file, whose opening says why. */
    if (!hash || !hash[1] || length >= sizeof name ||
        lstat(path, &about) == 0 || (errno != ENOENT && errno != ENOTDIR))
        return load(context, path, NULL, out);
    memcpy(name, path, length);
    name[length] = 0;
    return load(context, name, hash + 1, out);
}
