/* paint.c - the rules of paint.h. */
#include "paint.h"
#include "report.h"
#include "sequence_encoder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Whether a file of this name holds numbers instead of colours. */
static bool keeps_values(const char *path) {
    return !movie_format_of(path) && snow_image_bits(path) == 0;
}

static bool range_is_told(const options *asked) {
    return asked->range.kind != SNOW_RANGE_AUTO || !isnan(asked->window);
}

int paint_check(const options *asked, bool movie) {
    if (!movie || strcmp(asked->mode, "sum") != 0 || range_is_told(asked) ||
        keeps_values(asked->output))
        return GO_ON;
    return fail_usage("--mode sum: frames of a movie share one range of sums; "
                      "give --range LO,HI, or name frames .npy");
}

int paint_values(const options *asked, snow_context *context,
                 const snow_transfer *transfer, bool movie, snow_image **image,
                 paint_told *told) {
    double low, high;
    snow_image *painted = NULL;
    *told = (paint_told){.words = ""};
    if (!*image || snow_image_channels(*image) != 1 ||
        keeps_values(asked->output))
        return GO_ON;
    if (range_is_told(asked) || movie)
        snow_transfer_span(transfer, &low, &high);
    else
        snow_values_range(*image, &low, &high);
    snow_status status =
        snow_values_paint(*image, transfer, low, high, &painted);
    if (status != SNOW_OK)
        return fail_status(context, status);
    snow_image_free(*image);
    *image = painted;
    told->range[0] = low;
    told->range[1] = high;
    snprintf(told->words, sizeof told->words,
             "; %ss of %g..%g in the look's colours", asked->mode, low, high);
    return GO_ON;
}
