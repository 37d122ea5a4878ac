/* parallel/region.c - a rank's piece of the combined image to its pixels of the
 * picture.
 *
 * A piece of an intermediate image is a run of lines.  A pixel of the picture
 * is warped by the rank that has the line it falls on; the warp reads a few
 * lines before and behind, which come from the pieces next to it:
 *
 *   lines   ...  7   8 | 9   10   11   12 | 13   14   15  ...
 *                 piece of rank 3, and 7, 8, 13 to 15 from others
 *
 * Pixels are the same as if one processor had warped them all. */
#include "parallel/internal.h"

#include <string.h>

/* Transparent pixels that a run goes on over: a new one costs as much as a few
 * pixels. */
#define GAP_MOST 4

/* Lines of the picture that are warped as one item of work. */
#define WARP_LINES 16

/* --- lines around a piece ------------------------------------------------- */

/* The lines of a rank's piece. */
static snow_slab region_lines(const snow_ranks *r, int rank, int width) {
    return (snow_slab){r->firsts[rank] / width, r->counts[rank] / width};
}

/* The lines of `from` that the warp of `piece` reads: before it, or behind. */
static snow_slab wanted_lines(const snow_shear_warp_image *image,
                              snow_slab region, snow_slab from, bool behind) {
    const snow_shear_warp_warping *w = image->warping;
    int64_t end = region.first + region.count;
    int64_t low = behind ? end : region.first - w->before;
    int64_t high = behind ? end + w->behind : region.first;
    if (low < from.first)
        low = from.first;
    if (high > from.first + from.count)
        high = from.first + from.count;
    bool any = region.count && from.count && low < high;
    return any ? (snow_slab){low, high - low} : (snow_slab){0, 0};
}

snow_status snow_lines_prepare(snow_ranks *r,
                               const snow_shear_warp_image *image) {
    int lines = image->warping->before + image->warping->behind;
    lines = lines < image->height ? lines : image->height;
    return SNOW_RESERVE(r->context, r->lines, 0,
                        (size_t)lines * (size_t)image->width *
                            (size_t)image->channels);
}

/* Sends and receives lines with one other rank. */
typedef struct traffic {
    int count; /* of messages */
    float *at; /* where the next ones come */
} traffic;

static snow_status begin_receives(snow_ranks *r,
                                  const snow_shear_warp_image *image, int rank,
                                  size_t line, traffic *t) {
    const int width = image->width;
    snow_slab mine = region_lines(r, r->rank, width);
    for (int behind = 0; behind < 2; behind++) {
        snow_slab lines =
            wanted_lines(image, mine, region_lines(r, rank, width), behind);
        if (!lines.count)
            continue;
        size_t floats = (size_t)lines.count * line;
        SNOW_TRY(snow_comm_receive(r->comm, t->at, floats * sizeof(float), rank,
                                   SNOW_TAG_LINES, &r->messages[t->count++]));
        t->at += floats;
    }
    return SNOW_STATUS_OK;
}

static snow_status begin_sends(snow_ranks *r,
                               const snow_shear_warp_image *image, int rank,
                               size_t line, const snow_image_region *region,
                               traffic *t) {
    const int width = image->width;
    snow_slab mine = region_lines(r, r->rank, width);
    for (int behind = 0; behind < 2; behind++) {
        snow_slab lines =
            wanted_lines(image, region_lines(r, rank, width), mine, behind);
        if (lines.count)
            SNOW_TRY(snow_comm_send(
                r->comm,
                region->pixels + (size_t)(lines.first - mine.first) * line,
                (size_t)lines.count * line * sizeof(float), rank,
                SNOW_TAG_LINES, &r->messages[t->count++]));
    }
    return SNOW_STATUS_OK;
}

/* What came, in the order in which it was received. */
static void put_lines(const snow_ranks *r, const snow_shear_warp_image *image,
                      size_t line) {
    snow_slab mine = region_lines(r, r->rank, image->width);
    const float *at = r->lines;
    for (int rank = 0; rank < r->ranks; rank++)
        for (int behind = 0; rank != r->rank && behind < 2; behind++) {
            snow_slab lines = wanted_lines(
                image, mine, region_lines(r, rank, image->width), behind);
            snow_shear_warp_put_lines(image, (int)lines.first, (int)lines.count,
                                      at);
            at += (size_t)lines.count * line;
        }
}

snow_status snow_lines_exchange(snow_ranks *r,
                                const snow_shear_warp_image *image,
                                const snow_image_region *region) {
    size_t line = (size_t)image->width * (size_t)image->channels;
    traffic t = {0, r->lines};
    for (int rank = 0; rank < r->ranks; rank++)
        if (rank != r->rank)
            SNOW_TRY(begin_receives(r, image, rank, line, &t));
    for (int rank = 0; rank < r->ranks; rank++)
        if (rank != r->rank)
            SNOW_TRY(begin_sends(r, image, rank, line, region, &t));
    SNOW_TRY(snow_comm_wait_all(r->comm, r->messages, t.count));
    snow_slab mine = region_lines(r, r->rank, image->width);
    memset(image->drawn, 0, image->layer_tiles);
    snow_shear_warp_put_lines(image, (int)mine.first, (int)mine.count,
                              region->pixels);
    put_lines(r, image, line);
    if (image->warping->made)
        image->warping->made(image->warping);
    return SNOW_STATUS_OK;
}

/* --- runs of pixels ------------------------------------------------------- */

static bool is_clear(const float *pixel, int channels) {
    for (int c = 0; c < channels; c++)
        if (pixel[c] != 0)
            return false;
    return true;
}

/* Appends pixels to the packed ones, as they are or as bytes; they may overlap
 * what is packed already only where they lie behind it. */
static void pack(const float *pixels, size_t floats, int pixel_bits,
                 unsigned char **at) {
    if (pixel_bits != 8) {
        memmove(*at, pixels, floats * sizeof *pixels);
        *at += floats * sizeof *pixels;
        return;
    }
    for (size_t n = 0; n < floats; n++)
        *(*at)++ = (unsigned char)(pixels[n] * 255 + 0.5f);
}

/* The runs of one stretch of a line that are not transparent. */
static void append_runs(snow_ranks *r, int x, int y, int count,
                        const float *pixels, int channels, int pixel_bits,
                        unsigned char **at) {
    size_t pixel = (size_t)channels;
    for (int n = 0; n < count;) {
        int end = n, last = n;
        if (is_clear(pixels + (size_t)n * pixel, channels)) {
            n++;
            continue;
        }
        for (; end < count && end - last <= GAP_MOST; end++)
            if (!is_clear(pixels + (size_t)end * pixel, channels))
                last = end;
        r->runs[r->run_count++] = (snow_pixel_run){x + n, y, last + 1 - n};
        pack(pixels + (size_t)n * pixel, (size_t)(last + 1 - n) * pixel,
             pixel_bits, at);
        n = last + 1;
    }
}

/* Room for all runs on their way. */
static snow_status reserve_way(snow_ranks *r, const snow_job *job,
                               int pixel_bits) {
    int64_t pixels = 0;
    for (size_t n = 0; n < r->run_count; n++)
        pixels += r->runs[n].count;
    return snow_gather_reserve(
        r->combiner, job->view->width, job->view->height, r->run_count, pixels,
        (size_t)job->channels * (pixel_bits == 8 ? 1 : sizeof(float)));
}

/* --- pixels of the picture ------------------------------------------------ */

/* A rank's pixels of each line of the picture. */
typedef struct warp_job {
    snow_ranks *ranks;
    const snow_shear_warp_image *image;
    int first, end; /* lines of the intermediate image */
    int width, height, channels;
    float *pixels;  /* of all lines, packed */
    size_t *places; /* of each line, pixels */
} warp_job;

static void warp_lines(void *of, int64_t item, int worker) {
    const warp_job *job = of;
    size_t channels = (size_t)job->channels;
    size_t floats = (size_t)job->width * channels;
    float *row = job->ranks->rows +
                 (size_t)worker * (floats + job->image->warping->spare_floats);
    int first = (int)item * WARP_LINES, last = first + WARP_LINES;
    for (int y = first; y < last && y < job->height; y++) {
        int range[2];
        snow_shear_warp_pixels_of(job->image, y, job->first, job->end, range);
        if (range[0] >= range[1])
            continue;
        snow_shear_warp_warp(job->image->warping, y, range[0], range[1],
                             row + floats, row);
        memcpy(job->pixels + job->places[y] * channels,
               row + (size_t)range[0] * channels,
               (size_t)(range[1] - range[0]) * channels * sizeof *row);
    }
}

/* Returns where each line's pixels go; their sum. */
static size_t place_pixels(const warp_job *job) {
    size_t pixels = 0;
    for (int y = 0; y < job->height; y++) {
        int range[2];
        snow_shear_warp_pixels_of(job->image, y, job->first, job->end, range);
        job->places[y] = pixels;
        pixels += (size_t)(range[1] - range[0]);
    }
    return pixels;
}

/* Room for what is warped (and then packed in the same place), its runs, and
 * the threads' rows. */
static snow_status reserve_pixels(snow_ranks *r, size_t pixels, size_t lines,
                                  int channels, size_t row_floats) {
    size_t bytes = (size_t)channels * sizeof(float);
    SNOW_TRY(snow_reserve(r->context, &r->packed, 0, pixels, bytes));
    /* How many runs there may be in so many pixels of so many lines: each is
     * followed by a gap, or by the end of its line. */
    const size_t most_runs = pixels / (GAP_MOST + 1) + lines + 1;
    SNOW_TRY(SNOW_RESERVE(r->context, r->runs, 0, most_runs));
    return SNOW_RESERVE(r->context, r->rows, 0, row_floats);
}

static void pack_lines(const warp_job *job, int pixel_bits) {
    snow_ranks *r = job->ranks;
    unsigned char *at = r->packed;
    for (int y = 0; y < job->height; y++) {
        int range[2];
        snow_shear_warp_pixels_of(job->image, y, job->first, job->end, range);
        append_runs(r, range[0], y, range[1] - range[0],
                    job->pixels + job->places[y] * (size_t)job->channels,
                    job->channels, pixel_bits, &at);
    }
}

snow_status snow_pixels_warp(snow_ranks *r, const snow_shear_warp_image *image,
                             const snow_job *job,
                             const snow_image_region *region, int pixel_bits) {
    const snow_view *view = job->view;
    size_t height = (size_t)view->height, width = (size_t)view->width;
    warp_job warp = {.ranks = r,
                     .image = image,
                     .first = (int)(region->first / image->width),
                     .end =
                         (int)((region->first + region->count) / image->width),
                     .width = view->width,
                     .height = view->height,
                     .channels = job->channels};
    r->run_count = 0;
    if (!region->count)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(job->context, warp.places, 0, height));
    size_t pixels = place_pixels(&warp);
    size_t row = width * (size_t)job->channels + image->warping->spare_floats;
    snow_status status = reserve_pixels(r, pixels, height, job->channels,
                                        (size_t)job->settings.threads * row);
    if (status == SNOW_STATUS_OK) {
        warp.pixels = (float *)(void *)r->packed;
        status = snow_parallel(job->context, job->settings.threads,
                               (view->height + WARP_LINES - 1) / WARP_LINES,
                               warp_lines, &warp);
    }
    if (status == SNOW_STATUS_OK) {
        pack_lines(&warp, pixel_bits);
        status = reserve_way(r, job, pixel_bits);
    }
    snow_release(job->context, warp.places);
    return status;
}

snow_status snow_pixels_copy(snow_ranks *r, const snow_job *job,
                             const snow_image_region *region, int pixel_bits) {
    int64_t width = job->view->width, end = region->first + region->count;
    size_t lines = (size_t)(region->count / width) + 2;
    unsigned char *at;
    r->run_count = 0;
    SNOW_TRY(reserve_pixels(r, (size_t)region->count, lines, job->channels, 0));
    at = r->packed;
    for (int64_t n = region->first; n < end;) {
        int64_t left = width - n % width,
                count = end - n < left ? end - n : left;
        append_runs(r, (int)(n % width), (int)(n / width), (int)count,
                    region->pixels +
                        (size_t)(n - region->first) * (size_t)job->channels,
                    job->channels, pixel_bits, &at);
        n += count;
    }
    return reserve_way(r, job, pixel_bits);
}

snow_status snow_pixels_gather(snow_in_flight *f, const snow_job *job,
                               int pixel_bits, snow_image *image) {
    snow_ranks *r = f->ranks;
    const snow_view *view = job->view;
    bool bytes = pixel_bits == 8;
    size_t floats =
        (size_t)view->width * (size_t)view->height * (size_t)job->channels;
    float *pixels = image ? image->pixels : NULL;
    void *picture = bytes ? (void *)f->bytes : (void *)pixels;
    double mark = snow_ranks_clock(r);
    SNOW_TRY(snow_gather(r->combiner, view->width, view->height, r->runs,
                         r->run_count, r->packed,
                         (size_t)job->channels * (bytes ? 1 : sizeof(float)),
                         picture));
    for (size_t n = 0; pixels && bytes && n < floats; n++)
        pixels[n] = (float)f->bytes[n] / 255;
    f->picture.ranks_stats.seconds_gather += snow_ranks_clock(r) - mark;
    return SNOW_STATUS_OK;
}
