/* render/modes/modes.c - from a job to a picture in a mode other than over: the
 * identity transfer function, a local image of (value, weight) by the picture's
 * method, and what they mean. */
#include "render/modes/modes.h"
#include "render/job.h"
#include "transfer/scale.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* --- the identity transfer function --------------------------------------- */

void snow_identity_transfer_fini(snow_identity_transfer *identity) {
    snow_transfer_free(identity->transfer);
    *identity = (snow_identity_transfer){0};
}

snow_status snow_identity_transfer_widen(snow_context *context,
                                         snow_identity_transfer *identity,
                                         double low, double high, bool whole) {
    if (identity->low != low || identity->high != high) {
        snow_transfer_free(identity->transfer);
        identity->transfer = NULL;
    }
    identity->low = low;
    identity->high = high;
    identity->whole = whole;
    identity->empty = false;
    if (isfinite(high - low))
        return SNOW_STATUS_OK;
    return snow_fail(
        context, SNOW_STATUS_BAD_INPUT,
        "values from %g to %g exceed the range of float; use mode over", low,
        high);
}

/* The range of the finite values; 0 to 0 where there are none. */
static snow_status measure(snow_context *context, const snow_volume *volume,
                           snow_identity_transfer *identity) {
    snow_volume_statistics figures;
    SNOW_TRY(snow_volume_range(volume, &figures));
    const bool any = figures.finite > 0;
    SNOW_TRY(snow_identity_transfer_widen(
        context, identity, any ? figures.min : 0, any ? figures.max : 0,
        figures.finite == figures.voxels));
    identity->empty = !any;
    return SNOW_STATUS_OK;
}

static snow_status make_transfer(snow_context *context,
                                 snow_identity_transfer *identity) {
    double low = identity->low, high = identity->high,
           inverted = identity->kind.inverted;
    const snow_color_point colors[] = {
        {low, inverted, inverted, inverted},
        {high, 1 - inverted, 1 - inverted, 1 - inverted}};
    /* A step belongs to its own value: what ends at the highest ends just
     * beyond it.  Infinities are outside. */
    double beyond = nextafter(high, INFINITY);
    double from = identity->kind.steps
                      ? fmin(fmax(identity->kind.least, low), beyond)
                      : low;
    const snow_opacity_point finite[] = {
        {from, 0}, {from, 1}, {beyond, 1}, {beyond, 0}};
    return snow_transfer_new(context, colors, 2, finite, 4,
                             &identity->transfer);
}

snow_status snow_identity_transfer_measure(snow_job *job,
                                           snow_identity_transfer *identity) {
    snow_identity_transfer made = {.generation = job->volume->generation};
    if (made.generation && identity->generation == made.generation)
        return SNOW_STATUS_OK;
    SNOW_TRY(measure(job->context, job->volume, &made));
    snow_identity_transfer_fini(identity);
    *identity = made;
    return SNOW_STATUS_OK;
}

/* Makes an identity transfer function whose range is measured, unless it is
 * there already. */
static snow_status
prepare_identity_transfer(const snow_job *job,
                          const struct snow_identity_kind *wanted,
                          snow_identity_transfer *identity) {
    const struct snow_identity_kind *kind = &identity->kind;
    snow_identity_transfer made = *identity;
    if (identity->transfer && identity->generation &&
        kind->inverted == wanted->inverted && kind->steps == wanted->steps &&
        kind->least == wanted->least)
        return SNOW_STATUS_OK;
    made.kind = *wanted;
    SNOW_TRY(make_transfer(job->context, &made));
    snow_transfer_free(identity->transfer);
    *identity = made;
    return SNOW_STATUS_OK;
}

/* A little below, as the pictures of iso (raycast/modes.c). */
snow_status snow_identity_transfer_above(snow_job *job,
                                         snow_identity_transfer *identity) {
    double margin = 2e-6 * (identity->high - identity->low) +
                    2e-9 * fabs(job->settings.iso);
    const struct snow_identity_kind wanted = {
        .steps = true, .least = job->settings.iso - margin};
    return prepare_identity_transfer(job, &wanted, identity);
}

/* --- from pairs to a picture ---------------------------------------------- */

typedef struct finish_job {
    const snow_job *job;
    const snow_identity_transfer *identity;
    const snow_value_path *value_path; /* of method shear-warp; else NULL */
    const snow_mode_colors *colors;
    float *pairs;
    snow_image *image;
    double share; /* of a sum: of the weights in its unit */
    double least; /* weights of a ray that does not miss */
} finish_job;

/* Colours of numbers 0 to 1 at equal steps.  Between two of them colours are
 * linear but where a control point lies. */
static void fill_colors(const snow_job *job, const snow_value_scale *scale,
                        snow_mode_colors *colors) {
    const snow_transfer *transfer = job->transfer;
    colors->from = scale->from;
    colors->range = scale->step;
    memset(colors->nonlinear, 0, sizeof colors->nonlinear);
    for (int n = 0; n <= SNOW_MODE_COLORS; n++) {
        double part = (double)n / SNOW_MODE_COLORS, rgb[3];
        snow_transfer_color(transfer, colors->from + part * colors->range, rgb);
        for (int c = 0; c < 3; c++)
            colors->rgb[n][c] = (float)rgb[c];
    }
    for (size_t n = 0; n < transfer->color_count; n++) {
        double part =
            (transfer->colors[n].value - colors->from) / colors->range;
        double cell = floor(part * SNOW_MODE_COLORS);
        bool steps =
            (n > 0 &&
             transfer->colors[n - 1].value == transfer->colors[n].value) ||
            (n + 1 < transfer->color_count &&
             transfer->colors[n + 1].value == transfer->colors[n].value);
        if (!steps && (part == 0 || part == 1)) /* just where numbers end */
            continue;
        if (!(cell >= -1 && cell <= SNOW_MODE_COLORS)) /* or no range */
            continue;
        for (double near = cell - 1; near <= cell + 1; near++)
            if (near >= 0 && near < SNOW_MODE_COLORS)
                colors->nonlinear[(int)near] = true;
    }
}

/* The first `count` parts of the colour of a number 0 to 1; 1, the end of the
 * last cell, is as common as 0. */
static inline void find_color(const snow_transfer *transfer,
                              const snow_mode_colors *colors, float number,
                              int count, float *rgb) {
    float place = number * SNOW_MODE_COLORS;
    int cell =
        (int)place < SNOW_MODE_COLORS ? (int)place : SNOW_MODE_COLORS - 1;
    if (!colors->nonlinear[cell]) {
        const float *a = colors->rgb[cell], *b = colors->rgb[cell + 1];
        float part = place - (float)cell;
        for (int c = 0; c < count; c++)
            rgb[c] = part < 1 ? a[c] + part * (b[c] - a[c]) : b[c];
        return;
    }
    double exact[3];
    snow_transfer_color(transfer, colors->from + (double)number * colors->range,
                        exact);
    for (int c = 0; c < count; c++)
        rgb[c] = (float)exact[c];
}

/* (value of 0 to 1, hit) to a colour, opaque; where nothing was hit the picture
 * stays transparent. */
static inline void color_pixels(const finish_job *f, const float *pairs,
                                int count, int channels, float *pixels) {
    for (int x = 0; x < count; x++, pairs += 2, pixels += channels) {
        if (!(pairs[1] >= SNOW_WEIGHT_ENOUGH))
            continue;
        find_color(f->job->transfer, f->colors, pairs[0] / pairs[1],
                   channels - 1, pixels);
        pixels[channels - 1] = 1;
    }
}

/* (sum of weighted values, of weights) to the mean or the sum in data units. */
static void value_line(const finish_job *f, const float *pairs, int count,
                       float *pixels) {
    double low = f->identity->low, range = f->identity->high - f->identity->low;
    bool mean = f->job->settings.mode == SNOW_MODE_MEAN;
    for (int x = 0; x < count; x++, pairs += 2) {
        double weights = (double)pairs[1]; /* rounding may leave the range */
        double values = (double)pairs[0] > 0 ? (double)pairs[0] : 0;
        values = values < weights ? values : weights;
        if (!(weights >= f->least))
            pixels[x] = NAN;
        else if (mean)
            pixels[x] = (float)(low + range * (values / weights));
        else
            pixels[x] = (float)(f->share * (low * weights + range * values));
    }
}

/* (number, 1) of method shear-warp to data units. */
static void number_line(const finish_job *f, const float *pairs, int count,
                        float *pixels) {
    const snow_value_scale scale =
        snow_value_projected(f->value_path, f->job->settings.mode);
    for (int x = 0; x < count; x++, pairs += 2) {
        bool known = pairs[1] >= SNOW_WEIGHT_ENOUGH;
        double number = known ? (double)pairs[0] / (double)pairs[1] : NAN;
        pixels[x] = (float)(scale.from + scale.step * number);
    }
}

static void finish_line(void *of, int64_t y, int worker) {
    const finish_job *f = of;
    int width = f->image->width;
    size_t at = (size_t)y * (size_t)width;
    float *pixels = f->image->pixels + at * (size_t)f->image->channels;
    const float *pairs = f->pairs + 2 * at;
    (void)worker;
    if (f->image->channels == 1 && f->value_path)
        number_line(f, pairs, width, pixels);
    else if (f->image->channels == 1)
        value_line(f, pairs, width, pixels);
    else {
        if (f->image->channels == 2)
            color_pixels(f, pairs, width, 2, pixels);
        else
            color_pixels(f, pairs, width, 4, pixels);
    }
}

/* What 0 to 1 stands for. */
static snow_value_scale scale_of(const snow_frame *frame, const snow_job *job) {
    const snow_identity_transfer *identity = &frame->identity;
    double range = identity->high - identity->low;
    if (job->settings.method == SNOW_METHOD_SHEAR_WARP)
        return snow_value_projected(frame->value_path, job->settings.mode);
    return identity->kind.inverted ? (snow_value_scale){identity->high, -range}
                                   : (snow_value_scale){identity->low, range};
}

/* A ray misses where the weights of all its sheets add up to less than half of
 * one.  In perspective a sum's pairs hold lengths already, and half a sheet is
 * that of the ray to the target. */
static snow_status paint_lines(snow_frame *frame, const snow_job *job,
                               float *pairs, snow_image *image) {
    double path = job->placement.path / job->settings.opacity_length;
    /* Pairs of raycast hold lengths of rays, however short these are. */
    bool raycast = job->settings.method == SNOW_METHOD_RAYCAST;
    bool weighed =
        job->settings.mode == SNOW_MODE_SUM && job->placement.perspective;
    const snow_value_scale scale = scale_of(frame, job);
    bool values = job->settings.method == SNOW_METHOD_SHEAR_WARP;
    if (image->channels > 1)
        fill_colors(job, &scale, &frame->mode_colors);
    finish_job f = {.job = job,
                    .identity = &frame->identity,
                    .value_path = values ? frame->value_path : NULL,
                    .colors = &frame->mode_colors,
                    .pairs = pairs,
                    .image = image,
                    .share = raycast || weighed ? 1 : path,
                    .least = raycast
                                 ? (double)FLT_MIN
                                 : SNOW_WEIGHT_ENOUGH * (weighed ? path : 1)};
    return snow_parallel(job->context, job->settings.threads, image->height,
                         finish_line, &f);
}

snow_status snow_modes_paint(snow_frame *frame, const snow_job *job,
                             float *pairs, snow_image **out) {
    snow_mode mode = job->settings.mode;
    bool values = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
    snow_image *image = NULL;
    SNOW_TRY(snow_image_new(job->context, job->view->width, job->view->height,
                            values ? 1 : job->channels, &image));
    snow_status status = paint_lines(frame, job, pairs, image);
    if (status == SNOW_STATUS_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

/* --- a picture ------------------------------------------------------------ */

snow_status snow_modes_value_weight(snow_frame *frame, snow_job *job,
                                    snow_job *pairs) {
    const struct snow_identity_kind kind = {.inverted = job->settings.mode ==
                                                        SNOW_MODE_MINIP};
    SNOW_TRY(prepare_identity_transfer(job, &kind, &frame->identity));
    *pairs = *job;
    pairs->transfer = frame->identity.transfer;
    pairs->channels = 2;
    pairs->settings.shade = SNOW_SHADE_NONE;
    pairs->settings.threshold = 0;
    if (job->settings.method != SNOW_METHOD_SHEAR_WARP &&
        pairs->settings.quality == SNOW_QUALITY_HIGH)
        pairs->settings.quality = SNOW_QUALITY_NORMAL;
    pairs->composite = snow_projection_op_of(job->settings.mode);
    return SNOW_STATUS_OK;
}

/* --- values as colours ---------------------------------------------------- */

void snow_image_value_range(const snow_image *values, double *low,
                            double *high) {
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

/* The value of the look that has the share of its range which a value has of
 * another, both on the look's scale: colours are those of a look over that
 * other range. */
static double spread(const snow_transfer *transfer, double low, double high,
                     double value) {
    snow_scale scale = {transfer->log, transfer->linear};
    double first, last, part = 0.5;
    snow_transfer_domain(transfer, &first, &last);
    if (scale.log && !(low > 0))
        scale = (snow_scale){.log = false};
    if (high > low)
        part =
            scale.log || scale.linear > 0
                ? snow_share_on(scale, low, high, fmin(fmax(value, low), high))
                : (value - low) / (high - low);
    return snow_between_on(scale, first, last, fmin(fmax(part, 0), 1));
}

snow_status snow_image_apply_colormap(const snow_image *values,
                                      const snow_transfer *transfer, double low,
                                      double high, snow_image **out) {
    snow_image *image = NULL;
    snow_transfer_hint hint = {0, 0};
    size_t channels = transfer->grey ? 2 : 4;
    if (values->channels != 1 || !(low <= high))
        return snow_fail(
            values->context, SNOW_STATUS_BAD_USAGE,
            "cannot apply colours to %d channels from %g to %g: the picture "
            "must be of mode mean or sum, and the range must rise",
            values->channels, low, high);
    SNOW_TRY(snow_image_new(values->context, values->width, values->height,
                            (int)channels, &image));
    size_t count = (size_t)values->width * (size_t)values->height;
    for (size_t n = 0; n < count; n++) {
        double value = (double)values->pixels[n], rgba[4];
        if (isnan(value))
            continue;
        snow_transfer_near(transfer, spread(transfer, low, high, value), &hint,
                           rgba);
        for (size_t c = 0; c + 1 < channels; c++)
            image->pixels[n * channels + c] = (float)rgba[c];
        image->pixels[n * channels + channels - 1] = 1;
    }
    *out = image;
    return SNOW_STATUS_OK;
}
