/* modes.c - from a job to a picture in a mode other than over: the ramp, a
 * local image of pairs by the picture's method, and what they mean. */
#include "modes.h"
#include "base/parallel.h"
#include "classify/transfer.h"
#include "composite/reduce.h"
#include "frame.h"
#include "image/image.h"
#include "volume/volume.h"

#include <math.h>

/* --- the ramp --------------------------------------------------------------
 */

void snow_ramp_fini(snow_ramp *ramp) {
    snow_transfer_free(ramp->transfer);
    *ramp = (snow_ramp){0};
}

/* The range of the finite values; 0 to 0 where there are none. */
static snow_status measure(snow_context *context, const snow_volume *volume,
                           snow_ramp *ramp) {
    snow_volume_measures figures;
    snow_volume_measure(volume, &figures);
    ramp->whole = figures.finite == figures.voxels;
    ramp->low = figures.finite ? figures.min : 0;
    ramp->high = figures.finite ? figures.max : 0;
    if (isfinite(ramp->high - ramp->low))
        return SNOW_OK;
    return snow_fail(context, SNOW_BAD_INPUT,
                     "values from %g to %g span more than a number holds; only "
                     "mode over shows them",
                     ramp->low, ramp->high);
}

static snow_status make_transfer(snow_context *context, snow_ramp *ramp) {
    double low = ramp->low, high = ramp->high, falls = ramp->falls;
    const snow_color_point colors[] = {{low, falls, falls, falls},
                                       {high, 1 - falls, 1 - falls, 1 - falls}};
    /* A step belongs to its own value: what ends at the highest ends just
     * beyond it.  Infinities are outside. */
    double beyond = nextafter(high, INFINITY);
    const snow_opacity_point finite[] = {
        {low, 0}, {low, 1}, {beyond, 1}, {beyond, 0}};
    const snow_opacity_point above[] = {{low, falls}, {high, 1 - falls}};
    return snow_transfer_new(context, colors, 2, ramp->sparse ? above : finite,
                             ramp->sparse ? 2 : 4, &ramp->transfer);
}

/* Makes the ramp of a picture, unless it is there already. */
static snow_status prepare_ramp(const snow_job *job, snow_ramp *ramp) {
    bool sheared = job->settings.method == SNOW_METHOD_SHEARED;
    snow_ramp made = {.serial = job->volume->serial,
                      .falls = job->settings.mode == SNOW_MODE_MINIP,
                      .sparse = sheared};
    bool measured = made.serial && ramp->serial == made.serial;
    if (measured && ramp->falls == made.falls && ramp->sparse == made.sparse)
        return SNOW_OK;
    if (measured) {
        made.whole = ramp->whole;
        made.low = ramp->low;
        made.high = ramp->high;
    } else {
        SNOW_TRY(measure(job->context, job->volume, &made));
    }
    SNOW_TRY(make_transfer(job->context, &made));
    snow_ramp_fini(ramp);
    *ramp = made;
    return SNOW_OK;
}

/* --- from pairs to a picture -----------------------------------------------
 */

typedef struct finish_job {
    const snow_job *job;
    const snow_ramp *ramp;
    const float *pairs;
    snow_image *image;
    double share; /* of a sum: of the weights in its unit */
    double least; /* weights of a ray that does not miss */
} finish_job;

/* (value of 0 to 1, hit) to a colour, opaque; where nothing was hit the picture
 * stays transparent. */
static void color_line(const finish_job *f, const float *pairs, int count,
                       float *pixels) {
    const snow_transfer *transfer = f->job->transfer;
    size_t channels = (size_t)f->image->channels;
    double from = f->ramp->falls ? f->ramp->high : f->ramp->low;
    double range = f->ramp->high - f->ramp->low;
    snow_transfer_hint hint = {0, 0};
    double step = f->ramp->falls ? -range : range;
    for (int x = 0; x < count; x++, pairs += 2, pixels += channels) {
        double rgba[4];
        if (!(pairs[1] >= SNOW_WEIGHT_ENOUGH))
            continue;
        snow_transfer_near(
            transfer, from + step * (double)(pairs[0] / pairs[1]), &hint, rgba);
        for (size_t c = 0; c + 1 < channels; c++)
            pixels[c] = (float)rgba[c];
        pixels[channels - 1] = 1;
    }
}

/* (sum of weighted values, of weights) to the mean or the sum in data units. */
static void value_line(const finish_job *f, const float *pairs, int count,
                       float *pixels) {
    double low = f->ramp->low, range = f->ramp->high - f->ramp->low;
    bool mean = f->job->settings.mode == SNOW_MODE_MEAN;
    for (int x = 0; x < count; x++, pairs += 2) {
        double weights = (double)pairs[1]; /* rounding may leave the range */
        double values = fmin(fmax((double)pairs[0], 0), weights);
        if (!(weights >= f->least))
            pixels[x] = NAN;
        else if (mean)
            pixels[x] = (float)(low + range * (values / weights));
        else
            pixels[x] = (float)(f->share * (low * weights + range * values));
    }
}

static void finish_line(void *of, int64_t y, int worker) {
    const finish_job *f = of;
    int width = f->image->width;
    size_t at = (size_t)y * (size_t)width;
    float *pixels = f->image->pixels + at * (size_t)f->image->channels;
    (void)worker;
    if (f->image->channels == 1)
        value_line(f, f->pairs + 2 * at, width, pixels);
    else
        color_line(f, f->pairs + 2 * at, width, pixels);
}

/* A ray misses where the weights of all its sheets add up to less than half of
 * one.  In perspective a sum's pairs hold lengths already, and half a sheet is
 * that of the ray to the target. */
static void finish(const snow_job *job, const snow_ramp *ramp,
                   const float *pairs, snow_image *image) {
    double path = job->placement.path / job->settings.opacity_length;
    bool weighed =
        job->settings.mode == SNOW_MODE_SUM && job->placement.perspective;
    finish_job f = {.job = job,
                    .ramp = ramp,
                    .pairs = pairs,
                    .image = image,
                    .share = weighed ? 1 : path,
                    .least = SNOW_WEIGHT_ENOUGH * (weighed ? path : 1)};
    snow_parallel(job->context, job->settings.threads, image->height,
                  finish_line, &f);
}

/* --- a picture -------------------------------------------------------------
 */

/* The same job with the ramp for a look. */
static snow_status render_pairs(snow_frame *frame, const snow_job *job,
                                snow_image **out) {
    snow_job pairs = *job;
    SNOW_TRY(snow_image_new(job->context, job->view->width, job->view->height,
                            2, out));
    pairs.transfer = frame->ramp.transfer;
    pairs.channels = 2;
    pairs.settings.shade = SNOW_SHADE_NONE;
    pairs.settings.threshold = 0;
    pairs.settings.deterministic = 0; /* of one part, by the scalar loops */
    pairs.lay = snow_reduce_of(job->settings.mode);
    pairs.pixels = snow_image_pixels(*out);
    SNOW_TRY(snow_job_render_exact(frame, &pairs));
    return snow_job_finish(frame, &pairs);
}

static snow_status check(const snow_job *job) {
    if (job->volume->is_part || !job->all)
        return snow_fail(job->context, SNOW_BAD_USAGE,
                         "mode %s of one part of many is not combined yet; "
                         "render it on one rank",
                         snow_mode_name(job->settings.mode));
    return SNOW_OK;
}

snow_status snow_modes_render(snow_frame *frame, snow_job *job,
                              snow_image **out) {
    snow_mode mode = job->settings.mode;
    bool values = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
    snow_image *pairs = NULL, *image = NULL;
    SNOW_TRY(check(job));
    if (job->settings.method == SNOW_METHOD_SHEARED)
        job->settings.method = SNOW_METHOD_FOOTPRINT;
    SNOW_TRY(prepare_ramp(job, &frame->ramp));
    snow_status status = render_pairs(frame, job, &pairs);
    if (status == SNOW_OK)
        status =
            snow_image_new(job->context, job->view->width, job->view->height,
                           values ? 1 : job->channels, &image);
    if (status == SNOW_OK) {
        finish(job, &frame->ramp, snow_image_pixels(pairs), image);
        *out = image;
    }
    snow_image_free(pairs);
    return status;
}

/* --- values as colours -----------------------------------------------------
 */

void snow_values_range(const snow_image *values, double *low, double *high) {
    size_t count = (size_t)values->width * (size_t)values->height;
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t n = 0; n < count; n++) {
        *low = fmin(*low, (double)values->pixels[n]);
        *high = fmax(*high, (double)values->pixels[n]);
    }
    if (!(*low <= *high)) {
        *low = 0;
        *high = 1;
    }
}

snow_status snow_values_paint(const snow_image *values,
                              const snow_transfer *transfer, double low,
                              double high, snow_image **out) {
    snow_image *image = NULL;
    snow_transfer_hint hint = {0, 0};
    double first, last;
    snow_transfer_span(transfer, &first, &last);
    size_t channels = transfer->grey ? 2 : 4;
    if (values->channels != 1 || !(low <= high))
        return snow_fail(values->context, SNOW_BAD_USAGE,
                         "%d channels cannot be painted from %g to %g; take a "
                         "picture of mode mean or sum and a range that rises",
                         values->channels, low, high);
    SNOW_TRY(snow_image_new(values->context, values->width, values->height,
                            (int)channels, &image));
    size_t count = (size_t)values->width * (size_t)values->height;
    for (size_t n = 0; n < count; n++) {
        double value = (double)values->pixels[n], rgba[4];
        if (isnan(value))
            continue;
        double part = high > low ? (value - low) / (high - low) : 0.5;
        snow_transfer_near(transfer,
                           first + fmin(fmax(part, 0), 1) * (last - first),
                           &hint, rgba);
        for (size_t c = 0; c + 1 < channels; c++)
            image->pixels[n * channels + c] = (float)rgba[c];
        image->pixels[n * channels + channels - 1] = 1;
    }
    *out = image;
    return SNOW_OK;
}
