/* formats/tiff/shaped.c - the shape of the array that tifffile has written:
 *
 *     {"shape": [2, 5, 64, 48, 3], "axes": "TZYXS"}     or, long ago,
 *     shape=(2, 5, 64, 48, 3)
 *
 * The last lengths are those of a page; those before share out the pages.  An
 * array without names of axes is taken to be (time, z, y, x). */
#include "formats/tiff/tiff.h"

#include <stdio.h>
#include <string.h>

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
    out->channels = out->slices = out->frames = 1;
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
