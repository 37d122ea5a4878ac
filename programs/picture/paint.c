/* paint.c - implements paint.h. */
#include "picture/paint.h"
#include "movie/movie_encoder.h"
#include "run/log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Parts of a colour have at least so much room above and below, so that no
 * rounding makes a clear pixel opaque. */
#define ROOM (1 / 16.0F)

/* Whether a file of this name holds values, not colours. */
static bool keeps_values(const char *path) {
    return !movie_format_of(path) && snow_image_format_bits(path) == 0;
}

/* A list of colours has values of its own. */
static bool range_is_given(const options *opts) {
    return options_range(opts).kind != SNOW_RANGE_AUTO ||
           options_place_colors(opts);
}

/* Means have the unit of the values, so that the window of their file suits
 * them; the description of the look says whether it has been taken. */
static bool has_window(const options *opts, const snow_transfer *transfer) {
    return strcmp(opts->mode, "mean") == 0 &&
           strstr(snow_transfer_description(transfer), "the file's own window");
}

int paint_check(const options *opts, bool movie) {
    if (!movie || strcmp(opts->mode, "sum") != 0 || range_is_given(opts) ||
        keeps_values(opts->output))
        return CONTINUE;
    return fail_usage("--mode sum: all frames of a movie need the same range; "
                      "give --range LO,HI, or write frames as .npy");
}

void paint_background(const options *opts, const snow_transfer *transfer,
                      snow_image_options *form) {
    const color_value *color = &opts->background;
    const int mode = snow_mode_from_name(opts->mode); /* a slice has none */
    form->flatten =
        color->given || (color->automatic && !keeps_values(opts->output));
    memset(form->background, 0, sizeof form->background);
    if (color->given)
        memcpy(form->background, color->rgb, sizeof form->background);
    else if (color->automatic && mode >= 0)
        snow_mode_background((snow_mode)mode, transfer, form->background);
}

int paint_copy(const options *opts, snow_context *context,
               const snow_transfer *transfer, bool movie,
               const snow_image *image, snow_image **out, paint_given *given) {
    double low, high;
    if (range_is_given(opts) || movie || has_window(opts, transfer))
        snow_transfer_domain(transfer, &low, &high);
    else
        snow_image_value_range(image, &low, &high);
    snow_status status =
        snow_image_apply_colormap(image, transfer, low, high, out);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    given->range[0] = low;
    given->range[1] = high;
    snprintf(given->words, sizeof given->words,
             "; %ss of %g..%g in the look's colours", opts->mode, low, high);
    return CONTINUE;
}

/* Takes the lowest colour out of a premultiplied pixel: over that colour it is
 * what it was.  The opacity is the least with which it can be laid over it. */
static void clear_pixel(float *pixel, int parts, const double low[3]) {
    const float cover = pixel[parts];
    float opacity = 0;
    for (int c = 0; c < parts && cover > 0; c++) {
        const float color = pixel[c] / cover, lowest = (float)low[c];
        const float room = color > lowest ? 1 - lowest : lowest;
        opacity =
            fmaxf(opacity, fminf(fabsf(color - lowest) / fmaxf(room, ROOM), 1));
    }
    pixel[parts] = opacity * cover;
    for (int c = 0; c < parts; c++) {
        float left = pixel[c] - (cover - pixel[parts]) * (float)low[c];
        pixel[c] = fminf(fmaxf(left, 0), pixel[parts]);
    }
}

/* A projection hits something everywhere in the volume's box: without a
 * background its lowest value is clear, and the box is not seen. */
static void clear_lowest(const snow_transfer *transfer, snow_image *image) {
    const int channels = snow_image_channels(image);
    const size_t count =
        (size_t)snow_image_width(image) * (size_t)snow_image_height(image);
    float *at = snow_image_pixels(image);
    double ends[2], low[4];
    snow_transfer_domain(transfer, &ends[0], &ends[1]);
    snow_transfer_evaluate(transfer, ends[0], low);
    for (size_t n = 0; n < count; n++, at += channels)
        clear_pixel(at, channels - 1, low);
}

static int paint(const options *opts, snow_context *context,
                 const snow_transfer *transfer, bool movie, snow_image **image,
                 paint_given *given) {
    snow_image *painted = NULL;
    int done =
        paint_copy(opts, context, transfer, movie, *image, &painted, given);
    if (done != CONTINUE)
        return done;
    snow_image_free(*image);
    *image = painted;
    return CONTINUE;
}

int paint_values(const options *opts, snow_context *context,
                 const snow_transfer *transfer, bool movie, snow_image **image,
                 paint_given *given) {
    int done = CONTINUE;
    *given = (paint_given){.words = ""};
    if (!*image || keeps_values(opts->output))
        return CONTINUE;
    if (snow_image_channels(*image) == 1)
        done = paint(opts, context, transfer, movie, image, given);
    if (done == CONTINUE && mode_is_projection(opts->mode) &&
        !opts->background.given && !opts->background.automatic)
        clear_lowest(transfer, *image);
    return done;
}
