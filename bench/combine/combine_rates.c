/* bench/combine/combine_rates.c - what one processor of this machine takes to
 * look at a pixel of its local image, and to lay one over another: what --scan
 * and
 * --blend should be for a simulated machine of this kind.
 *
 * The local image is that of the middle slab of 32; eight slabs are laid over
 * one another.  Seconds are of the thread, the least of all runs. */
#include "combine.h"

#include "combine/active.h"

#include <string.h>
#include <time.h>

#define LAYERS 8

static double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Buffers: a picture, its mask, and the packed pixels of all layers. */
typedef struct bench_rates {
    const combine_options *options;
    float *picture, *packed[LAYERS], *out;
    uint64_t *words[LAYERS], *mask;
    int *spans;
    snow_active layers[LAYERS];
    double scan, blend;      /* seconds a pixel, the least so far */
    int64_t scanned, active; /* pixels of a run */
} bench_rates;

static snow_status take_memory(snow_context *context, bench_rates *rates) {
    const uint64_t size = (uint64_t)rates->options->height;
    const uint64_t pixels =
        size * (uint64_t)rates->options->width + 64; /* and slack */
    const size_t bytes = (size_t)rates->options->channels * sizeof(float);
    bool fine =
        (rates->spans = snow_allocate_array(context, 2 * size, sizeof(int))) &&
        (rates->picture = snow_allocate_array(context, pixels, bytes)) &&
        (rates->out = snow_allocate_array(context, pixels, bytes)) &&
        (rates->mask =
             snow_allocate_array(context, pixels / 64 + 2, sizeof(uint64_t)));
    for (int i = 0; i < LAYERS && fine; i++)
        fine =
            (rates->packed[i] = snow_allocate_array(context, pixels, bytes)) &&
            (rates->words[i] = snow_allocate_array(context, pixels / 64 + 2,
                                                   sizeof(uint64_t)));
    return fine ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

static void free_memory(snow_context *context, bench_rates *rates) {
    snow_release(context, rates->spans);
    snow_release(context, rates->picture);
    snow_release(context, rates->out);
    snow_release(context, rates->mask);
    for (int i = 0; i < LAYERS; i++) {
        snow_release(context, rates->packed[i]);
        snow_release(context, rates->words[i]);
    }
}

static void keep_least(double *least, double seconds, int64_t pixels) {
    double each = pixels ? seconds / (double)pixels : 0;
    if (*least <= 0 || each < *least)
        *least = each;
}

/* Draws a slab's picture, and looks at it. */
static void scan_layer(bench_rates *rates, int layer) {
    const combine_options *options = rates->options;
    const int64_t pixels = (int64_t)options->width * options->height;
    const size_t channels = (size_t)options->channels;
    combine_pattern pattern;
    combine_pattern_make(options, 12 + layer, 32, rates->spans, &pattern);
    const snow_rectangle drawn = pattern.drawn;
    for (int y = drawn.y0; y < drawn.y1; y++)
        for (int x = drawn.x0; x < drawn.x1; x++)
            combine_pattern_pixel(
                &pattern, x, y,
                rates->picture +
                    ((size_t)y * (size_t)options->width + (size_t)x) *
                        channels);
    const snow_exchange_params order = {.width = options->width,
                                        .height = options->height,
                                        .channels = options->channels,
                                        .pixels = rates->picture,
                                        .stride =
                                            (size_t)options->width * channels,
                                        .drawn = drawn};
    for (int run = 0; run <= options->runs; run++) {
        int64_t scanned = 0;
        double start = cpu_seconds();
        rates->active =
            snow_active_scan(snow_pixels_pick(SNOW_ISA_AUTO, options->channels,
                                              SNOW_COMPOSITE_OVER),
                             &order, NULL, 0, pixels, rates->words[layer],
                             rates->packed[layer], &scanned);
        keep_least(&rates->scan, cpu_seconds() - start, scanned);
        rates->scanned = scanned;
    }
    rates->layers[layer] = (snow_active){.last = pixels,
                                         .words = rates->words[layer],
                                         .pixels = rates->packed[layer]};
}

static void blend_layers(bench_rates *rates) {
    const int64_t pixels =
        (int64_t)rates->options->width * rates->options->height;
    for (int run = 0; run <= rates->options->runs; run++) {
        int64_t laid = 0;
        for (int i = 0; i < LAYERS; i++)
            rates->layers[i].next = rates->layers[i].pixels;
        double start = cpu_seconds();
        snow_active_merge(snow_pixels_pick(SNOW_ISA_AUTO,
                                           rates->options->channels,
                                           SNOW_COMPOSITE_OVER),
                          rates->layers, LAYERS, rates->options->channels, 0,
                          pixels, rates->mask, rates->out, true, &laid);
        keep_least(&rates->blend, cpu_seconds() - start, laid);
    }
}

int combine_rates(const combine_options *options) {
    snow_context *context;
    bench_rates rates = {.options = options};
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = take_memory(context, &rates);
    if (status == SNOW_STATUS_OK) {
        for (int i = 0; i < LAYERS; i++)
            scan_layer(&rates, i);
        blend_layers(&rates);
        printf("image=%d pixel_bytes=%d grain=%d active=%.3f scan_ns=%.3f "
               "blend_ns=%.3f\n",
               options->width, options->channels * 4, options->grain,
               (double)rates.active / (double)rates.scanned, rates.scan * 1e9,
               rates.blend * 1e9);
    } else {
        fprintf(stderr, "snowglass: bench combine: %s\n",
                snow_context_message(context));
    }
    free_memory(context, &rates);
    snow_context_free(context);
    return (int)status;
}
