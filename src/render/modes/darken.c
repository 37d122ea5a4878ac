/* render/modes/darken.c - an unsharp mask of the depths (Luft, Colditz and
 * Deussen 2006, Image Enhancement by Unsharp Masking the Depth Buffer), at two
 * radii. */
#include "base/clear.h"
#include "base/monitor.h"
#include "render/modes/depth.h"

#include <math.h>

/* Deviations of the two blurs, and the distance behind what is beside that
 * counts 1, all as shares of the picture's short side. */
static const double deviations[] = {1.0 / 128, 1.0 / 43};
#define UNIT (1.0 / 21)
#define MOST 3.0     /* more does not count */
#define SHARE 0.9    /* of the light that a count of 1 takes away */
#define DARKEST 0.35 /* of the light that remains */

typedef struct blur {
    int width, height;
    float *mean, *line, *dark; /* planes */
} blur;

static float at_line(const float *in, int n, int count, size_t step) {
    return in[(size_t)(n < 0 ? 0 : n < count ? n : count - 1) * step];
}

/* Means of 2 reach + 1 numbers; those at the ends go on beyond them. */
static void mean_line(const float *in, float *out, int count, size_t step,
                      int reach) {
    double sum = 0;
    for (int n = -reach; n < reach; n++)
        sum += (double)at_line(in, n, count, step);
    for (int n = 0; n < count; n++) {
        sum += (double)at_line(in, n + reach, count, step);
        out[(size_t)n * step] = (float)(sum / (2 * reach + 1));
        sum -= (double)at_line(in, n - reach, count, step);
    }
}

/* Three boxes are close to a Gaussian of their deviation. */
snow_status snow_blur_plane(snow_context *context, float *plane, float *spare,
                            int width, int height, double deviation) {
    snow_monitor *monitor = context->monitor;
    int reach = (int)lround((sqrt(4 * deviation * deviation + 1) - 1) / 2);
    const int lines = reach > 0 ? height + width : 0; /* of a pass */
    for (int n = 0; n < 3 * lines && !snow_monitor_look(monitor, 0); n++) {
        const int x = n % lines - height;
        const size_t row = (size_t)(n % lines) * (size_t)width;
        if (x < 0)
            mean_line(plane + row, spare + row, width, 1, reach);
        else
            mean_line(spare + x, plane + x, height, (size_t)width, reach);
    }
    return snow_monitor_status(monitor);
}

/* Where nothing is, it is as far as the farthest that is there: outlines stay
 * as they are. */
static void fill_behind(size_t count, const float *depth, float *filled) {
    float far = -INFINITY;
    for (size_t n = 0; n < count; n++)
        far = fmaxf(far, depth[n]);
    for (size_t n = 0; n < count; n++)
        filled[n] = isnan(depth[n]) ? far : depth[n];
}

/* Adds how far each pixel lies behind the mean of what is beside it. */
static snow_status add_behind(snow_context *context, const blur *b,
                              const float *depth, double deviation,
                              double unit) {
    size_t count = (size_t)b->width * (size_t)b->height;
    fill_behind(count, depth, b->mean);
    SNOW_TRY(snow_blur_plane(context, b->mean, b->line, b->width, b->height,
                             deviation));
    for (size_t n = 0; n < count; n++)
        if (!isnan(depth[n])) {
            double behind = ((double)depth[n] - (double)b->mean[n]) / unit;
            b->dark[n] += (float)fmin(fmax(behind, 0), MOST);
        }
    return SNOW_STATUS_OK;
}

static void darken(const blur *b, double strength, snow_image *image) {
    size_t count = (size_t)b->width * (size_t)b->height;
    int channels = image->channels;
    for (size_t n = 0; n < count; n++) {
        double left = fmax(1 - SHARE * (double)b->dark[n], DARKEST);
        float factor = (float)(1 - strength * (1 - left));
        for (int c = 0; c + 1 < channels; c++)
            image->pixels[n * (size_t)channels + (size_t)c] *= factor;
    }
}

snow_status snow_depth_darken(const snow_job *job, const snow_image *depth,
                              snow_image *image) {
    snow_context *context = job->context;
    blur b = {.width = depth->width, .height = depth->height};
    size_t count = (size_t)b.width * (size_t)b.height;
    int side = b.width < b.height ? b.width : b.height;
    b.mean = snow_allocate(context, 3 * count * sizeof *b.mean);
    if (!b.mean)
        return SNOW_STATUS_NO_MEMORY;
    b.line = b.mean + count;
    b.dark = b.line + count;
    snow_status status = snow_clear(context, b.dark, count * sizeof *b.dark);
    for (int n = 0; n < 2 && status == SNOW_STATUS_OK; n++)
        status = add_behind(context, &b, depth->pixels, deviations[n] * side,
                            UNIT * side * job->placement.pitch);
    if (status == SNOW_STATUS_OK)
        darken(&b, job->settings.depth_darkening, image);
    snow_release(context, b.mean);
    return status;
}
