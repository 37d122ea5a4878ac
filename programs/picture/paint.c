/* paint.c - implements paint.h. */
#include "picture/paint.h"
#include "movie/movie_encoder.h"
#include "run/log.h"

#include <stdio.h>
#include <string.h>

#define DARK (20 / 255.0)

/* Whether a file of this name holds values, not colours. */
static bool keeps_values(const char *path) {
    return !movie_format_of(path) && snow_image_format_bits(path) == 0;
}

static bool range_is_given(const options *opts) {
    return options_range(opts).kind != SNOW_RANGE_AUTO;
}

int paint_check(const options *opts, bool movie) {
    if (!movie || strcmp(opts->mode, "sum") != 0 || range_is_given(opts) ||
        keeps_values(opts->output))
        return CONTINUE;
    return fail_usage("--mode sum: all frames of a movie need the same range; "
                      "give --range LO,HI, or write frames as .npy");
}

/* Around projections black is expected: it is the colour of their lowest value
 * in most maps.  The dark sides of a shaded object still stand out from a
 * background that is a little lighter.  Both are grey, so that a grey picture
 * stays a grey file. */
void paint_background(const options *opts, snow_image_options *form) {
    const color_value *color = &opts->background;
    bool shaded = !mode_is_projection(opts->mode);
    form->flatten =
        color->given || (color->automatic && !keeps_values(opts->output));
    for (int i = 0; i < 3; i++)
        form->background[i] = color->given                 ? color->rgb[i]
                              : color->automatic && shaded ? DARK
                                                           : 0;
}

int paint_copy(const options *opts, snow_context *context,
               const snow_transfer *transfer, bool movie,
               const snow_image *image, snow_image **out, paint_given *given) {
    double low, high;
    if (range_is_given(opts) || movie)
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

int paint_values(const options *opts, snow_context *context,
                 const snow_transfer *transfer, bool movie, snow_image **image,
                 paint_given *given) {
    snow_image *painted = NULL;
    *given = (paint_given){.words = ""};
    if (!*image || snow_image_channels(*image) != 1 ||
        keeps_values(opts->output))
        return CONTINUE;
    int done =
        paint_copy(opts, context, transfer, movie, *image, &painted, given);
    if (done != CONTINUE)
        return done;
    snow_image_free(*image);
    *image = painted;
    return CONTINUE;
}
