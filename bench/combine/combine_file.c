/* bench/combine/combine_file.c - local images that are pictures in files: what
 * real volumes look like, in the place of a cube's slabs.
 *
 * `--pattern slab_%02d.png` names one picture for each rank, 0 nearest to the
 * eye; a name without a number is every rank's.  Where sizes alone are asked
 * for, a picture is kept as a bit for each pixel: a thousand of them are in the
 * memory of one process that simulates. */
#include "combine.h"

#include <snowglass/extend.h>
#include <snowglass/image.h>

#include <string.h>

/* --- names ---------------------------------------------------------------- */

/* The number's place in a name: where "%", digits and "d" begin and end; false
 * where something else follows a "%". */
static bool find_number(const char *name, const char **begin, const char **end,
                        int *digits) {
    *begin = strchr(name, '%');
    *digits = 0;
    if (!*begin)
        return true;
    *end = *begin + 1;
    for (; **end >= '0' && **end <= '9' && *digits < 100; ++*end)
        *digits = *digits * 10 + (**end - '0');
    return *(*end)++ == 'd' && *digits < 10 && !strchr(*end, '%');
}

bool combine_file_name(const char *name, int slab, char *out, size_t room) {
    const char *begin, *end;
    int digits, length;
    if (!find_number(name, &begin, &end, &digits))
        return false;
    if (begin)
        length = snprintf(out, room, "%.*s%0*d%s", (int)(begin - name), name,
                          digits, slab, end);
    else
        length = snprintf(out, room, "%s", name);
    return length >= 0 && (size_t)length < room;
}

/* --- pictures ------------------------------------------------------------- */

static bool is_active(const float *pixel, int channels) {
    return pixel[0] != 0 || pixel[3] != 0 ||
           (channels == 4 && (pixel[1] != 0 || pixel[2] != 0));
}

/* Bits of active pixels, whole words for each line, and what is drawn. */
static void make_mask(combine_pattern *pattern, const float *pixels) {
    snow_rectangle *drawn = &pattern->drawn;
    for (int y = 0; y < pattern->height; y++) {
        uint64_t *line = pattern->mask + (size_t)y * pattern->line_words;
        int span[2] = {pattern->width, 0};
        for (int x = 0; x < pattern->width; x++, pixels += 4) {
            if (!is_active(pixels, pattern->channels))
                continue;
            line[x / 64] |= (uint64_t)1 << (x % 64);
            span[0] = x < span[0] ? x : span[0];
            span[1] = x + 1;
        }
        if (span[0] >= span[1])
            continue;
        if (drawn->x0 >= drawn->x1)
            *drawn = (snow_rectangle){span[0], y, span[1], y + 1};
        drawn->x0 = span[0] < drawn->x0 ? span[0] : drawn->x0;
        drawn->x1 = span[1] > drawn->x1 ? span[1] : drawn->x1;
        drawn->y1 = y + 1;
    }
}

snow_status combine_file_open(snow_context *context,
                              const combine_options *options, int slab,
                              combine_pattern *out) {
    char path[COMBINE_NAME_BYTES];
    snow_image *image;
    if (!combine_file_name(options->pattern, slab, path, sizeof path))
        return SNOW_STATUS_BAD_USAGE;
    snow_status status = snow_image_load(context, path, &image);
    if (status != SNOW_STATUS_OK)
        return status;
    combine_pattern made = {.width = snow_image_width(image),
                            .height = snow_image_height(image),
                            .channels = options->channels,
                            .image = image};
    made.line_words = (size_t)(made.width + 63) / 64 + 1;
    made.mask = snow_context_allocate(
        context, (size_t)made.height * made.line_words * sizeof *made.mask);
    if (!made.mask) {
        snow_image_free(image);
        return SNOW_STATUS_NO_MEMORY;
    }
    memset(made.mask, 0,
           (size_t)made.height * made.line_words * sizeof *made.mask);
    make_mask(&made, snow_image_pixels(image));
    if (options->sizes_only) {
        snow_image_free(image);
        made.image = NULL;
    }
    *out = made;
    return SNOW_STATUS_OK;
}

void combine_file_close(snow_context *context, combine_pattern *pattern) {
    snow_image_free(pattern->image);
    snow_context_release(context, pattern->mask);
    pattern->image = NULL;
    pattern->mask = NULL;
}

/* --- pixels --------------------------------------------------------------- */

uint64_t combine_file_active(const combine_pattern *pattern, int y, int x,
                             int count) {
    const uint64_t *word =
        pattern->mask + (size_t)y * pattern->line_words + x / 64;
    uint64_t bits = word[0] >> (x % 64);
    if (x % 64)
        bits |= word[1] << (64 - x % 64);
    return bits & ~(uint64_t)0 >> (64 - count);
}

void combine_file_pixel(const combine_pattern *pattern, int x, int y,
                        float *out) {
    const float *pixel = snow_image_pixels(pattern->image) +
                         ((size_t)y * (size_t)pattern->width + (size_t)x) * 4;
    out[0] = pixel[0];
    out[1] = pattern->channels == 2 ? pixel[3] : pixel[1];
    if (pattern->channels == 4)
        memcpy(out + 2, pixel + 2, 2 * sizeof *out);
}
