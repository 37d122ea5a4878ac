/* order.c - implements order.h. */
#include "movies/order.h"
#include "message.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *order_format(size_t index) {
    static const char *const names[] = {"mp4", "webm", "gif", "webp", NULL};
    return names[index];
}

__attribute__((format(printf, 2, 3))) static bool
refuse(movie_order *out, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(out->fault, sizeof out->fault, format, arguments);
    va_end(arguments);
    return false;
}

static bool is_key(const char *key) {
    static const char *const all[] = {"t",     "what",   "kind",     "frames",
                                      "first", "last",   "fps",      "size",
                                      "tag",   "format", "overwrite"};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strcmp(all[i], key) == 0)
            return true;
    return false;
}

static bool read_verb(const json_t *tree, movie_order *out) {
    const json_t *kind = json_object_get(tree, "kind");
    const char *name = kind ? json_string_value(kind) : "turntable";
    out->steps = name && strcmp(name, "movie") == 0;
    return out->steps || (name && strcmp(name, "turntable") == 0) ||
           refuse(out, "movie: a kind must be turntable or movie");
}

static bool read_format(const json_t *tree, movie_order *out) {
    const json_t *format = json_object_get(tree, "format");
    const char *name = format ? json_string_value(format) : order_format(0);
    for (size_t i = 0; name && (out->format = order_format(i)); i++)
        if (strcmp(out->format, name) == 0)
            return true;
    return refuse(out, "movie: a format must be mp4, webm, gif or webp");
}

/* An integer from `least` to `most`; as it is where the key is absent. */
static bool read_count(const json_t *tree, const char *key, int64_t least,
                       int64_t most, movie_order *out, int64_t *count) {
    const json_t *value = json_object_get(tree, key);
    if (!value)
        return true;
    *count = json_integer_value(value);
    return (json_is_integer(value) && *count >= least && *count <= most) ||
           refuse(out,
                  "movie: %s must be a whole number from %" PRId64
                  " to %" PRId64,
                  key, least, most);
}

static bool read_steps(const json_t *tree, int64_t times, movie_order *out) {
    int64_t last = times - 1;
    if (times < 2)
        return refuse(out, "movie: there is one time step; order a turntable");
    if (json_object_get(tree, "frames"))
        return refuse(out, "movie: frames are of a turntable; give the first "
                           "and the last step");
    if (!read_count(tree, "first", 0, last, out, &out->first) ||
        !read_count(tree, "last", 0, last, out, &last))
        return false;
    if (out->first > last)
        return refuse(out, "movie: the first step must not be behind the last");
    out->last = last;
    out->frames = last - out->first + 1;
    return out->frames <= ORDER_FRAMES_MOST ||
           refuse(out,
                  "movie: %" PRId64 " steps are more than %d; choose fewer",
                  out->frames, ORDER_FRAMES_MOST);
}

static bool read_turn(const json_t *tree, movie_order *out) {
    if (json_object_get(tree, "first") || json_object_get(tree, "last"))
        return refuse(out, "movie: first and last are time steps, of a movie; "
                           "a turntable has frames");
    out->frames = ORDER_FRAMES_USUAL;
    return read_count(tree, "frames", 1, ORDER_FRAMES_MOST, out, &out->frames);
}

static bool read_rate(const json_t *tree, movie_order *out) {
    const json_t *fps = json_object_get(tree, "fps");
    if (!fps)
        return true;
    out->fps = json_number_value(fps);
    return (json_is_number(fps) && out->fps >= 0.1 && out->fps <= 120) ||
           refuse(out, "movie: fps must be a number from 0.1 to 120");
}

static bool read_size(const json_t *tree, movie_order *out) {
    const json_t *size = json_object_get(tree, "size");
    if (!message_has_size(size))
        return refuse(out, "movie: a size must be two sides of 1 to %d pixels",
                      MESSAGE_SIDE);
    out->width = json_integer_value(json_array_get(size, 0));
    out->height = json_integer_value(json_array_get(size, 1));
    return out->frames * out->width * out->height <= ORDER_PIXELS_MOST ||
           refuse(out,
                  "movie: %" PRId64 " frames of %" PRId64 " x %" PRId64
                  " pixels are too many: make it smaller or shorter, or run "
                  "its command",
                  out->frames, out->width, out->height);
}

static bool read_tag(const json_t *tree, movie_order *out) {
    const json_t *tag = json_object_get(tree, "tag");
    if (!tag)
        return true;
    if (!json_is_string(tag) || json_string_length(tag) >= sizeof out->tag)
        return refuse(out, "movie: a tag must be a text of at most %d bytes",
                      ORDER_TAG_BYTES - 1);
    snprintf(out->tag, sizeof out->tag, "%s", json_string_value(tag));
    return true;
}

static bool read_overwrite(const json_t *tree, movie_order *out) {
    const json_t *overwrite = json_object_get(tree, "overwrite");
    out->overwrite = json_is_true(overwrite);
    return !overwrite || json_is_boolean(overwrite) ||
           refuse(out, "movie: overwrite must be true or false");
}

bool order_read(const json_t *tree, int64_t times, movie_order *out) {
    const char *key;
    json_t *value;
    *out = (movie_order){.last = -1};
    json_object_foreach((json_t *)tree, key, value) {
        if (!is_key(key))
            return refuse(out, "movie: %.40s is not known", key);
    }
    return read_verb(tree, out) && read_format(tree, out) &&
           (out->steps ? read_steps(tree, times, out) : read_turn(tree, out)) &&
           read_rate(tree, out) && read_size(tree, out) &&
           read_tag(tree, out) && read_overwrite(tree, out);
}
