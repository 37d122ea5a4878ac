/* formats/tiff/text.c - parses descriptions: of ImageJ,
 *
 *     ImageJ=1.53f
 *     images=82
 *     channels=2
 *     slices=41
 *     unit=micron
 *     spacing=0.125
 *
 * and the shape of the array that tifffile has written:
 *
 *     {"shape": [2, 5, 64, 48, 3], "axes": "TZYXS"}     or, long ago,
 *     shape=(2, 5, 64, 48, 3)
 *
 * The last lengths are those of a page; those before share out the pages.  An
 * array without names of axes is taken to be (time, z, y, x). */
#include "formats/array.h"
#include "formats/tiff/tiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define VALUE_BYTES 64

/* Finds the value of "name=" at the front of a line. */
static bool line_value(const char *text, const char *name,
                       char out[VALUE_BYTES]) {
    const size_t length = strlen(name);
    const char *at = text;
    while (strncmp(at, name, length) != 0 || at[length] != '=') {
        at = strchr(at, '\n');
        if (!at++)
            return false;
    }
    at += length + 1;
    const size_t size = strcspn(at, "\r\n");
    if (size < VALUE_BYTES)
        snprintf(out, VALUE_BYTES, "%.*s", (int)size, at);
    return size < VALUE_BYTES;
}

static int64_t count_of(const char *value) {
    int64_t count;
    return snow_parse_int64(value, &count) && count > 0 ? count : 1;
}

static double length_of(const char *value) {
    double length;
    return snow_parse_double(value, &length) && length > 0 && isfinite(length)
               ? length
               : 0;
}

/* Values of a straight line (cf=0), as ij.measure.Calibration has them. */
static void take_calibration(const char *text, tiff_shape *out) {
    char value[VALUE_BYTES];
    double line[2];
    if (!line_value(text, "cf", value) || !strcmp(value, "20"))
        return;
    out->bent = strcmp(value, "0") != 0 || !line_value(text, "c0", value) ||
                !snow_parse_double(value, &line[0]) ||
                !line_value(text, "c1", value) ||
                !snow_parse_double(value, &line[1]) || !isfinite(line[0]) ||
                !isfinite(line[1]) || line[1] == 0;
    if (out->bent)
        return;
    memcpy(out->scale, line, sizeof line);
    if (line_value(text, "vunit", value) && strcmp(value, "Gray Value") != 0)
        snow_copy_name(value, out->value_unit, sizeof out->value_unit);
}

static void read_imagej(const char *text, tiff_shape *out) {
    char value[VALUE_BYTES];
    out->imagej = true;
    memcpy(out->order, "XYCZT", sizeof out->order);
    if (line_value(text, "images", value))
        out->images = count_of(value);
    if (line_value(text, "channels", value))
        out->channels = count_of(value);
    if (line_value(text, "slices", value))
        out->slices = count_of(value);
    if (line_value(text, "frames", value))
        out->frames = count_of(value);
    /* A stack that was reversed has a spacing below 0. */
    if (line_value(text, "spacing", value))
        out->spacing[2] = length_of(value + (*value == '-'));
    /* y and z have a unit only where it is not that of x. */
    static const char *const units[] = {"unit", "yunit", "zunit"};
    for (int i = 0; i < 3; i++) {
        if (!line_value(text, units[i], value))
            snprintf(value, sizeof value, "%s", out->units[0]);
        if (strcmp(value, "pixel") != 0 && strcmp(value, "pixels") != 0)
            snprintf(out->units[i], sizeof out->units[i], "%.15s", value);
    }
    take_calibration(text, out);
}

void snow_tiff_read_text(const char *text, tiff_shape *out) {
    *out = (tiff_shape){.channels = 1,
                        .slices = 1,
                        .frames = 1,
                        .scale = {0, 1},
                        .nodata = NAN};
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++)
        out->channel[n].color[0] = -1;
    if (text && !strncmp(text, "ImageJ=", 7))
        read_imagej(text, out);
}

/* --- tifffile ------------------------------------------------------------- */

#if SNOW_HAVE_TIFF && !SNOW_LOADS

#define MOST_AXES 8

typedef struct shape {
    int64_t sizes[MOST_AXES];
    int rank;
    char axes[MOST_AXES + 1]; /* a letter each, or "" */
} shape;

/* Reads "2, 5, 64" up to a bracket. */
static bool read_sizes(const char *text, shape *out) {
    for (int used; out->rank < MOST_AXES; text += used + 1) {
        long long size;
        char end;
        if (sscanf(text, " %18lld %c%n", &size, &end, &used) != 2 || size < 1)
            return false;
        out->sizes[out->rank++] = size;
        used--;
        if (end == ']' || end == ')')
            return true;
    }
    return false;
}

static bool read_shape(const char *text, shape *out) {
    const char *at = strncmp(text, "shape=(", 7) == 0 ? text + 7 : NULL;
    const char *axes = strstr(text, "\"axes\": \"");
    if (*text == '{' && (at = strstr(text, "\"shape\": [")))
        at += 10;
    if (!at || !read_sizes(at, out))
        return false;
    if (axes && strcspn(axes + 9, "\"") == (size_t)out->rank)
        memcpy(out->axes, axes + 9, (size_t)out->rank);
    return true;
}

/* How many of the axes are those of a page; 0 if they are another's. */
static int axes_of_page(const shape *s, const tiff_page *page) {
    const int64_t *end = s->sizes + s->rank;
    const bool flat =
        s->rank > 1 && end[-1] == page->width && end[-2] == page->height;
    if (page->samples == 1)
        return flat ? 2 : 0;
    if (page->separate)
        return flat && s->rank > 2 && end[-3] == page->samples ? 3 : 0;
    return s->rank > 2 && end[-1] == page->samples && end[-2] == page->width &&
                   end[-3] == page->height
               ? 3
               : 0;
}

/* Whether the axes of a page are named y and x, if they are named. */
static bool are_flat(const shape *s, int own) {
    const char *axes = s->axes + s->rank - own;
    axes += own == 3 && axes[2] == 'X';
    return !*s->axes || !strncmp(axes, "YX", 2);
}

/* Without a Z the last axis that is no C or T is z; others are times. */
static snow_status share_out(snow_context *context, const shape *s, int count,
                             tiff_shape *out) {
    char order[] = "XY\0\0\0";
    bool has_z = strchr(s->axes, 'Z') != NULL;
    int used = 2;
    for (int i = count - 1; i >= 0; i--) {
        char role = *s->axes ? s->axes[i] : 'Q';
        if (role != 'C' && role != 'Z')
            role = role == 'T' || has_z ? 'T' : 'Z';
        has_z |= role == 'Z';
        if (s->sizes[i] > 1 && order[used - 1] != role) {
            if (strchr(order, role))
                return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                                 "its axes, %s, are no time steps of volumes; "
                                 "write it again in the order TCZYX",
                                 s->axes);
            order[used++] = role;
        }
        *(role == 'C'   ? &out->channels
          : role == 'Z' ? &out->slices
                        : &out->frames) *= s->sizes[i];
    }
    for (const char *at = "CZT"; *at; at++)
        if (!strchr(order, *at))
            order[used++] = *at;
    memcpy(out->order, order, sizeof order);
    return SNOW_STATUS_OK;
}

snow_status snow_tiff_read_shape(snow_context *context, const char *text,
                                 const tiff_page *page, tiff_shape *out) {
    shape s = {.rank = 0};
    if (!text || !read_shape(text, &s))
        return SNOW_STATUS_OK;
    const int own = axes_of_page(&s, page);
    double all = 1;
    for (int i = 0; i < s.rank - own && own; i++)
        all *= (double)s.sizes[i];
    if (all < 2 || all > 0x1p40) /* each page is an array of its own */
        return SNOW_STATUS_OK;
    if (!are_flat(&s, own) && s.rank - own > 1)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its axes are %s, so that its pages are no slices; "
                         "write it again in the order TCZYX",
                         s.axes);
    SNOW_TRY(share_out(context, &s, s.rank - own, out));
    out->images = (int64_t)all;
    if (!*s.axes && out->frames > 1)
        snow_notify(context,
                    "its array of %d axes has no names for them; it is taken "
                    "for %lld time steps of %lld slices",
                    s.rank, (long long)out->frames, (long long)out->slices);
    return SNOW_STATUS_OK;
}

#endif
