/* render/shear_warp/show.c - the image on the lattice to the picture.  Where
 * pixels are wider than the lattice's, they are means of several places. */
#include "render/shear_warp/internal.h"

#include <math.h>
#include <string.h>

/* Lines of the picture that are warped as one item of work. */
#define LINES 8

/* Empty pixels around an image that was made smaller. */
#define BORDER 3

typedef struct show_job {
    const snow_shear_warp_warping *warping;
    float *pixels, *lines;
    int first, end;          /* lines of the picture */
    size_t line_floats;      /* of the lines of one worker */
    const snow_bytes *bytes; /* instead of pixels */
    snow_bytes_fn *convert;
} show_job;

/* --- a smaller image ------------------------------------------------------ */

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
static void shrink(snow_shear_warp_warping *w, int axis, double low,
                   double side) {
    double *start = &w->shear.start[axis], *row = w->scaled.warp[axis];
    *start = (*start + low + 0.5) / side - 0.5 + BORDER;
    w->shear.along_x[axis] /= side;
    w->shear.along_y[axis] /= side;
    for (int n = 0; n < 3; n++)
        row[n] = (row[n] + (low + 0.5) * w->scaled.warp[2][n]) / side +
                 (BORDER - 0.5) * w->scaled.warp[2][n];
}

/* The first pixel of a block of the halved image, on the lattice. */
static int64_t first_block(const snow_value_lattice *l, int axis) {
    return (l->first[axis] * l->cells[axis]) & -(INT64_C(1) << l->halvings);
}

/* The image halved as often as the lattice says, in blocks that do not depend
 * on what of it is in view. */
static void halve(const snow_shear_warp_warping *w) {
    const snow_value_image *image = w->of;
    const snow_value_lattice *l = &image->lattice;
    const snow_intermediate_view *small = &image->shown.plane;
    const int64_t side = INT64_C(1) << l->halvings;
    const int64_t first[2] = {l->first[0] * l->cells[0],
                              l->first[1] * l->cells[1]};
    memset(image->halved, 0,
           small->stride * (size_t)small->height * sizeof *image->halved);
    for (int y = 0; y < w->plane.height; y++)
        add_line(
            &w->plane, y, first[0], side,
            image->halved +
                (size_t)((first[1] + y - first_block(l, 1)) / side + BORDER) *
                    small->stride);
}

/* Pixels of all parts to what is warped, and that made smaller. */
static void make_shown(const snow_shear_warp_warping *w) {
    const snow_value_image *image = w->of;
    const snow_value_operator *op = image->path->op;
    for (int y = 0; op->finish && y < w->plane.height; y++)
        op->finish(image->path, image->plane + (size_t)y * image->stride,
                   w->plane.width);
    if (image->lattice.halvings)
        halve(w);
}

/* Room for it, and its map. */
static snow_status place_halved(snow_context *context, snow_value_image *of) {
    static const unsigned char all = 1;
    const snow_value_lattice *l = &of->lattice;
    const int64_t side = INT64_C(1) << l->halvings;
    snow_intermediate_view *image = &of->shown.plane;
    int *const sizes[2] = {&image->width, &image->height};
    for (int axis = 0; axis < 2; axis++) {
        int64_t first = l->first[axis] * l->cells[axis];
        int64_t low = first_block(l, axis);
        *sizes[axis] =
            (int)((first + *sizes[axis] - 1 - low) / side) + 1 + 2 * BORDER;
        shrink(&of->shown, axis, (double)(first - low), (double)side);
    }
    image->stride = (size_t)image->width * (size_t)image->channels;
    SNOW_TRY(SNOW_RESERVE(context, of->halved, 0,
                          image->stride * (size_t)(image->height + 1)));
    image->pixels = of->halved;
    image->drawn = &all;
    image->block_width = image->width;
    image->block_height = image->height;
    image->blocks = 1;
    return SNOW_STATUS_OK;
}

/* --- lines ---------------------------------------------------------------- */

/* The map of places `across` to the right of a pixel's middle and `down` below
 * it. */
static snow_shear_warp_warping aside(const snow_shear_warp_warping *w,
                                     double across, double down) {
    snow_shear_warp_warping to = *w;
    for (int axis = 0; axis < 2; axis++)
        to.shear.start[axis] +=
            to.shear.along_x[axis] * across + to.shear.along_y[axis] * down;
    for (int i = 0; i < 3; i++)
        to.scaled.warp[i][0] +=
            to.scaled.warp[i][1] * across + to.scaled.warp[i][2] * down;
    return to;
}

/* Means of `means` x `means` places a pixel. */
static void show_means(const snow_shear_warp_warping *w, int y, int from,
                       int to, float *restrict one, float *restrict out) {
    const snow_value_image *image = w->of;
    const int n = image->lattice.means, channels = w->plane.channels;
    const float share = 1.0F / (float)(n * n);
    memset(out + from * channels, 0,
           (size_t)((to - from) * channels) * sizeof *out);
    for (int i = 0; i < n * n; i++) {
        const snow_shear_warp_warping places = aside(
            &image->shown, (i % n + 0.5) / n - 0.5, (i / n + 0.5) / n - 0.5);
        snow_shear_warp_warp(&places, y, from, to, NULL, one);
        for (int k = from * channels; k < to * channels; k++)
            out[k] += share * one[k];
    }
}

snow_status snow_value_place_show(snow_value_path *path,
                                  const snow_value_params *params,
                                  const snow_shear_warp_image *image) {
    snow_value_image *of = path->image;
    const snow_value_lattice *l = &of->lattice;
    const snow_isa isa = params->settings->isa;
    const bool colors = path->op->reduction == SNOW_VALUE_OVER;
    const snow_filter filter = colors ? l->filter : SNOW_BILINEAR;
    snow_shear_warp_warping *w = &of->warping;
    *w = (snow_shear_warp_warping){
        .plane = {image->pixels, image->stride, image->width, image->height,
                  image->channels, image->drawn, image->tile_width,
                  image->tile_height, image->tiles},
        .perspective = l->perspective,
        .shear = l->shear,
        .scaled = l->scaled,
        .filter = filter,
        .warp = snow_warp_of(isa, filter, image->channels),
        .places = snow_warp_places_of(isa, filter, image->channels),
        .width = params->view->width,
        .height = params->view->height,
        .before = SNOW_WARP_BEFORE,
        .behind = SNOW_WARP_BEHIND,
        .of = of};
    of->shown = *w;
    if (l->means > 1) {
        w->line = show_means;
        w->spare_floats = (size_t)(w->width * image->channels + 64);
        /* Lines that a mean takes before and behind its own: half a pixel's,
         * and what their samples read; all in perspective, where pixels
         * differ. */
        const double half =
            (fabs(l->shear.along_x[1]) + fabs(l->shear.along_y[1])) / 2;
        w->before = w->behind = l->perspective
                                    ? l->height
                                    : (int)ceil(half) + (2 << l->halvings) + 3;
    }
    of->path = path;
    if (l->halvings || path->op->finish)
        w->made = make_shown;
    return l->halvings ? place_halved(path->context, of) : SNOW_STATUS_OK;
}

static void show_lines(void *of, int64_t item, int worker) {
    const show_job *job = of;
    const snow_shear_warp_warping *w = job->warping;
    float *spare = job->lines + (size_t)worker * job->line_floats;
    int first = job->first + (int)item * LINES, end = first + LINES;
    const size_t floats = (size_t)(w->width * w->plane.channels);
    for (int y = first; y < end && y < job->end; y++) {
        float *out = job->bytes ? spare + w->spare_floats
                                : job->pixels + (size_t)y * floats;
        snow_shear_warp_warp(w, y, 0, w->width, spare, out);
        if (job->bytes)
            job->convert(out, w->width, w->plane.channels,
                         job->bytes->background, snow_bytes_row(job->bytes, y));
    }
}

snow_status snow_value_show(snow_value_path *path,
                            const snow_value_params *params, float *pixels) {
    const snow_shear_warp_warping *w = &path->image->warping;
    show_job job = {.warping = w,
                    .pixels = pixels,
                    .line_floats = w->spare_floats,
                    .first = params->lines[0],
                    .end = params->lines[1],
                    .bytes = params->bytes,
                    .convert = snow_bytes_of(params->settings->isa)};
    size_t threads = (size_t)params->settings->threads;
    if (w->made)
        w->made(w);
    if (job.bytes)
        job.line_floats += (size_t)(w->width * w->plane.channels);
    SNOW_TRY(
        SNOW_RESERVE(path->context, path->lines, 0, threads * job.line_floats));
    job.lines = path->lines;
    snow_monitor_next(path->context->monitor, SNOW_STAGE_RENDER, 0.9, 1);
    return snow_parallel(path->context, params->settings->threads,
                         (job.end - job.first + LINES - 1) / LINES, show_lines,
                         &job);
}
