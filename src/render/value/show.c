/* render/value/show.c - the image on the lattice to the picture.  Where pixels
 * are wider than the lattice's, they are means of several places. */
#include "base/thread_pool.h"
#include "render/value/internal.h"

#include <math.h>
#include <string.h>

/* Lines of the picture that are warped as one item of work. */
#define LINES 8

/* Empty pixels around an image that was made smaller. */
#define BORDER 3

typedef struct show_job {
    const snow_value_lattice *lattice;
    snow_intermediate_view image;
    snow_shear shear;
    snow_perspective_shear scaled; /* in perspective */
    snow_warp_fn *warp;
    snow_warp_places_fn *places;
    int width, height; /* of the picture */
    float *pixels, *lines;
    size_t line_floats; /* of the lines of one worker */
} show_job;

/* --- a smaller image -------------------------------------------------------
 */

/* Adds a line of the image to the sums of one that is `side` times smaller;
 * *first is the number of its first pixel on the lattice. */
static void add_line(const snow_intermediate_view *image, int y, int64_t first,
                     int64_t side, float *sums) {
    const float *from = image->pixels + (size_t)y * image->stride;
    const unsigned char *drawn =
        image->drawn + y / image->block_height * image->blocks;
    float share = 1.0F / (float)(side * side);
    int64_t low = first & -side;
    for (int x = 0; x < image->width; x++) {
        float *sum =
            sums + ((first + x - low) / side + BORDER) * image->channels;
        if (!drawn[x / image->block_width])
            continue;
        for (int c = 0; c < image->channels; c++)
            sum[c] += share * from[x * image->channels + c];
    }
}

/* The place of a pixel along an axis, after the image was made `side` times
 * smaller from `low` pixels before its first on. */
static void shrink(show_job *job, int axis, double low, double side) {
    double *start = &job->shear.start[axis], *row = job->scaled.warp[axis];
    *start = (*start + low + 0.5) / side - 0.5 + BORDER;
    job->shear.along_x[axis] /= side;
    job->shear.along_y[axis] /= side;
    for (int n = 0; n < 3; n++)
        row[n] = (row[n] + (low + 0.5) * job->scaled.warp[2][n]) / side +
                 (BORDER - 0.5) * job->scaled.warp[2][n];
}

/* The image halved as often as the lattice says, in blocks that do not depend
 * on what of it is in view. */
static snow_status halve(snow_value_path *path, show_job *job) {
    static const unsigned char all = 1;
    const snow_value_lattice *l = job->lattice;
    const snow_intermediate_view *image = &job->image;
    const int64_t side = INT64_C(1) << l->halvings;
    const int64_t first[2] = {l->first[0] * l->cells[0],
                              l->first[1] * l->cells[1]};
    int size[2] = {image->width, image->height};
    for (int axis = 0; axis < 2; axis++) {
        int64_t low = first[axis] & -side;
        size[axis] =
            (int)((first[axis] + size[axis] - 1 - low) / side) + 1 + 2 * BORDER;
        shrink(job, axis, (double)(first[axis] - low), (double)side);
    }
    size_t stride = (size_t)size[0] * (size_t)image->channels;
    size_t bytes = stride * (size_t)(size[1] + 1) * sizeof(float);
    SNOW_TRY(snow_reserve(path->context, &path->halved, &path->halved_capacity,
                          0, bytes));
    memset(path->halved, 0, bytes);
    for (int y = 0; y < image->height; y++)
        add_line(
            image, y, first[0], side,
            path->halved +
                (size_t)((first[1] + y - (first[1] & -side)) / side + BORDER) *
                    stride);
    job->image = (snow_intermediate_view){.pixels = path->halved,
                                          .stride = stride,
                                          .width = size[0],
                                          .height = size[1],
                                          .channels = image->channels,
                                          .drawn = &all,
                                          .block_width = size[0],
                                          .block_height = size[1],
                                          .blocks = 1};
    return SNOW_STATUS_OK;
}

/* --- lines ------------------------------------------------------------------
 */

/* Pixels of line y of the picture, or of places denser by `job`'s maps. */
static void show_row(const show_job *job, int y, int width, float *out) {
    const snow_value_lattice *l = job->lattice;
    if (l->perspective)
        snow_warp_row_perspective(&job->image, &job->scaled, l->filter,
                                  job->places, y, 0, width, out);
    else
        snow_warp_row(&job->image, &job->shear, l->filter, job->warp, y, 0,
                      width, out);
}

/* The map of places i / n - 1/2 + 1 / 2n across and `down` lower than a
 * pixel's middle. */
static show_job denser(const show_job *job, int n, double down) {
    show_job fine = *job;
    for (int axis = 0; axis < 2; axis++) {
        fine.shear.start[axis] += fine.shear.along_x[axis] * (0.5 / n - 0.5) +
                                  fine.shear.along_y[axis] * down;
        fine.shear.along_x[axis] /= n;
    }
    for (int i = 0; i < 3; i++) {
        fine.scaled.warp[i][0] += down * fine.scaled.warp[i][2];
        fine.scaled.warp[i][1] /= n;
    }
    return fine;
}

/* A line of means of `means` x `means` places a pixel. */
static void show_means(const show_job *job, int y, float *fine, float *out) {
    int n = job->lattice->means, channels = job->image.channels;
    size_t floats = (size_t)(job->width * channels);
    float share = 1.0F / (float)(n * n);
    memset(out, 0, floats * sizeof *out);
    for (int j = 0; j < n; j++) {
        const show_job places = denser(job, n, (j + 0.5) / n - 0.5);
        show_row(&places, y, n * job->width, fine);
        for (int x = 0; x < n * job->width; x++)
            for (int c = 0; c < channels; c++)
                out[x / n * channels + c] += share * fine[x * channels + c];
    }
}

static void show_lines(void *of, int64_t item, int worker) {
    const show_job *job = of;
    float *fine = job->lines + (size_t)worker * job->line_floats;
    int first = (int)item * LINES, end = first + LINES;
    for (int y = first; y < end && y < job->height; y++) {
        float *out = job->pixels +
                     (size_t)y * (size_t)(job->width * job->image.channels);
        if (job->lattice->means > 1)
            show_means(job, y, fine, out);
        else
            show_row(job, y, job->width, out);
    }
}

snow_status snow_value_show(snow_value_path *path,
                            const snow_value_params *params,
                            const snow_intermediate_view *image,
                            float *pixels) {
    const snow_value_lattice *l = &path->lattice;
    const snow_settings *settings = params->settings;
    show_job job = {
        .lattice = l,
        .image = *image,
        .shear = l->shear,
        .scaled = l->scaled,
        .warp = snow_warp_of(settings->isa, l->filter, image->channels),
        .places =
            snow_warp_places_of(settings->isa, l->filter, image->channels),
        .width = params->view->width,
        .height = params->view->height,
        .pixels = pixels};
    if (l->halvings)
        SNOW_TRY(halve(path, &job));
    if (l->means > 1) {
        job.line_floats = (size_t)(l->means * job.width * image->channels + 64);
        SNOW_TRY(snow_reserve(
            path->context, &path->lines, &path->lines_capacity, 0,
            (size_t)settings->threads * job.line_floats * sizeof(float)));
        job.lines = path->lines;
    }
    snow_monitor_next(path->context->monitor, SNOW_STAGE_RENDER, 0.9, 1);
    return snow_parallel(path->context, settings->threads,
                         (job.height + LINES - 1) / LINES, show_lines, &job);
}
