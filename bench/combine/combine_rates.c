/* bench/combine/combine_rates.c - what the threads of one rank take to look at
 * a pixel of their local image and write it into a message, to read one of a
 * message and lay it over another, and to round one, beside copies of the same
 * bytes, and what one takes to move 16 bytes of regions that it has gathered to
 * the picture: what --scan, --blend, --round and --move should be for a
 * simulated machine of this kind.
 *
 * The local images are those of up to 32 neighbours of --ranks, and are scanned
 * whole, from memory, as the splat leaves them.  The region is that
 * of one rank, in the middle of the picture; it is composited again and again,
 * so that its messages are in the cache, as what has just been received is.
 * Each thread has a part. Seconds are processor time of the slowest thread over
 * the pixels of all, the least of all runs: other programs of the machine do
 * not count. */
#include "combine.h"

#include "base/thread_pool.h"
#include "combine/active.h"
#include "line.h"

#include <string.h>
#include <time.h>

#define LAYERS_MOST 32
#define THREADS_MOST 64
#define RANKS_USUAL 32
#define PIXELS_OF_THREAD 16384 /* as in src/combine/parts.c */
#define PIXELS_OF_RUN 262144   /* at least so many are timed together */

/* Seconds are of a pixel, of MOVE those of 16 bytes. */
typedef enum rates_step {
    SCAN,    /* of the picture, as all below of the region */
    COPY,    /* of the picture */
    BLEND,   /* messages to the region */
    MESSAGE, /* a copy of the messages */
    ROUNDED, /* to 8 bits */
    MOVE,    /* regions of all ranks, rounded, to the picture */
    STEPS
} rates_step;

/* Buffers: a picture, the region, and for each thread its mask, its messages
 * and what they hold. */
typedef struct bench_rates {
    const combine_options *options;
    snow_exchange_params order;
    const snow_pixel_loops *loops;
    float *picture, *out;
    unsigned char *whole, *messages[LAYERS_MOST];
    uint64_t *words[LAYERS_MOST], *mask;
    int *spans;
    size_t bytes[LAYERS_MOST][THREADS_MOST];
    rates_step step;
    int layers, layer, threads, repeats; /* of the step */
    int64_t first, last;                 /* its pixels */
    double took[THREADS_MOST];
    int64_t pixels[THREADS_MOST]; /* of the last step, for each thread */
    double seconds[STEPS];        /* a pixel, the least so far */
    int64_t scanned, active;
} bench_rates;

static double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int64_t picture_pixels(const bench_rates *rates) {
    return (int64_t)rates->options->width * rates->options->height;
}

static int ranks_of(const bench_rates *rates) {
    return rates->options->ranks ? rates->options->ranks : RANKS_USUAL;
}

/* What a step is about: the picture, or the region in its middle. A region of
 * less than a row is in the middle of its row, for slabs do not reach the row's
 * ends. */
static void choose_pixels(bench_rates *rates, rates_step step) {
    const int64_t pixels = picture_pixels(rates);
    const bool all = step == SCAN || step == COPY || step == MOVE;
    const int64_t some = all ? pixels : pixels / ranks_of(rates) / 64 * 64;
    const int64_t most = some / PIXELS_OF_THREAD;
    rates->step = step;
    const int64_t width = rates->options->width;
    const int64_t middle = some < width ? width / 2 : 0;
    rates->first = ((pixels - some) / 2 + middle) / 64 * 64;
    rates->last = rates->first + some;
    rates->threads = step == MOVE ? 1 : rates->options->threads;
    if (rates->threads > most)
        rates->threads = most > 1 ? (int)most : 1;
    rates->repeats =
        !all && some && some < PIXELS_OF_RUN ? (int)(PIXELS_OF_RUN / some) : 1;
}

/* Parts are whole words of the mask. */
static int64_t part_begin(const bench_rates *rates, int64_t item) {
    const int64_t pixels = rates->last - rates->first;
    return item < rates->threads
               ? rates->first + pixels * item / rates->threads / 64 * 64
               : rates->last;
}

/* Where the message of a part begins: behind what those before may need. */
static size_t message_at(const bench_rates *rates, int64_t item) {
    const size_t bytes = (size_t)rates->order.channels * sizeof(float);
    return snow_align(
        snow_active_room(part_begin(rates, item) - rates->first, bytes) +
        (size_t)item * snow_active_room(64, bytes));
}

static snow_status take_memory(snow_context *context, bench_rates *rates) {
    const size_t spare =
        THREADS_MOST * (snow_active_room(64, 16) + SNOW_ALIGNMENT);
    const size_t whole = snow_active_room(picture_pixels(rates), 16) + spare;
    choose_pixels(rates, BLEND);
    const size_t message =
        snow_active_room(rates->last - rates->first, 16) + spare;
    const uint64_t pixels = (uint64_t)picture_pixels(rates) + 64; /* slack */
    const size_t bytes = (size_t)rates->options->channels * sizeof(float);
    bool fine =
        (rates->spans = snow_allocate_array(
             context, 2 * (uint64_t)rates->options->height, sizeof(int))) &&
        (rates->picture = snow_allocate_clear(context, pixels * bytes)) &&
        (rates->out = snow_allocate_array(context, pixels, bytes)) &&
        (rates->mask =
             snow_allocate_array(context, pixels / 64 + 2, sizeof(uint64_t)));
    fine = fine && (rates->whole = snow_allocate(context, whole));
    for (int i = 0; i < rates->layers && fine; i++)
        fine = (rates->messages[i] = snow_allocate(context, message)) &&
               (rates->words[i] = snow_allocate_array(context, pixels / 64 + 2,
                                                      sizeof(uint64_t)));
    return fine ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

static void free_memory(snow_context *context, bench_rates *rates) {
    snow_release(context, rates->spans);
    snow_release(context, rates->picture);
    snow_release(context, rates->out);
    snow_release(context, rates->mask);
    snow_release(context, rates->whole);
    for (int i = 0; i < rates->layers; i++) {
        snow_release(context, rates->messages[i]);
        snow_release(context, rates->words[i]);
    }
}

/* --- steps of a thread ---------------------------------------------------- */

static void scan(bench_rates *rates, int64_t item, int64_t first,
                 int64_t last) {
    unsigned char *message =
        (rates->step == SCAN ? rates->whole : rates->messages[rates->layer]) +
        message_at(rates, item);
    uint64_t *words = rates->mask + first / 64;
    int64_t active =
        snow_active_scan(rates->loops, &rates->order, NULL, first, last, words,
                         (float *)(void *)message, &rates->pixels[item]);
    rates->bytes[rates->layer][item] =
        snow_active_close(message, words, first, last, active,
                          (size_t)rates->order.channels * sizeof(float));
}

static void blend(bench_rates *rates, int64_t item, int64_t first,
                  int64_t last) {
    snow_active layers[LAYERS_MOST];
    for (int i = 0; i < rates->layers; i++)
        snow_active_open(rates->messages[i] + message_at(rates, item),
                         rates->bytes[i][item], first, last,
                         (size_t)rates->order.channels * sizeof(float),
                         rates->words[i] + first / 64, &layers[i]);
    snow_active_merge(
        rates->loops, layers, rates->layers, rates->order.channels, first, last,
        rates->mask + first / 64, rates->out + first * rates->order.channels,
        false, &rates->pixels[item]);
}

static void copy_messages(bench_rates *rates, int64_t item, int64_t first,
                          int64_t last) {
    const size_t each = (size_t)rates->order.channels * sizeof(float);
    const size_t room = (size_t)(last - first) * each;
    unsigned char *out = (unsigned char *)rates->out + (size_t)first * each;
    for (int i = 0; i < rates->layers; i++) {
        size_t bytes = rates->bytes[i][item];
        bytes = bytes < room ? bytes : room;
        memcpy(out, rates->messages[i] + message_at(rates, item), bytes);
        rates->pixels[item] += (int64_t)(bytes / each);
    }
}

static void round_region(bench_rates *rates, int64_t item, int64_t first,
                         int64_t last) {
    combine_round_pixels(rates->out + first * rates->order.channels,
                         (last - first) * rates->order.channels,
                         rates->messages[0] + message_at(rates, item));
    rates->pixels[item] += last - first;
}

/* As the root of a gather does, row by row; floats stand for what it has
 * received. */
static void move_regions(bench_rates *rates, int64_t item, int64_t first,
                         int64_t last) {
    const int64_t region = picture_pixels(rates) / ranks_of(rates);
    const int64_t row = rates->options->width;
    const size_t each =
        (size_t)(region < row ? region : row) * (size_t)rates->order.channels;
    const size_t bytes = (size_t)(last - first) * (size_t)rates->order.channels;
    const unsigned char *in = (const unsigned char *)rates->picture;
    unsigned char *out = (unsigned char *)rates->out;
    for (size_t at = 0; each && at + each <= bytes; at += each)
        memcpy(out + at, in + at, each);
    rates->pixels[item] += (int64_t)(bytes / 16);
}

static void copy(bench_rates *rates, int64_t item, int64_t first,
                 int64_t last) {
    const size_t channels = (size_t)rates->order.channels;
    memcpy(rates->out + (size_t)first * channels,
           rates->picture + (size_t)first * channels,
           (size_t)(last - first) * channels * sizeof *rates->out);
    rates->pixels[item] += last - first;
}

static void do_step(void *of, int64_t item, int worker) {
    static void (*const steps[STEPS])(bench_rates *, int64_t, int64_t,
                                      int64_t) = {
        scan, copy, blend, copy_messages, round_region, move_regions};
    bench_rates *rates = of;
    const double start = cpu_seconds();
    (void)worker;
    for (int i = 0; i < rates->repeats; i++)
        steps[rates->step](rates, item, part_begin(rates, item),
                           part_begin(rates, item + 1));
    rates->took[item] = cpu_seconds() - start;
}

/* --- all threads ---------------------------------------------------------- */

/* The pixels of the step. */
static int64_t run_step(snow_context *context, bench_rates *rates,
                        rates_step step) {
    int64_t pixels = 0;
    double most = 0;
    choose_pixels(rates, step);
    const int threads = rates->threads;
    memset(rates->pixels, 0, sizeof rates->pixels);
    if (snow_parallel(context, threads, threads, do_step, rates) !=
        SNOW_STATUS_OK)
        return 0;
    for (int i = 0; i < threads; i++) {
        pixels += rates->pixels[i];
        most = rates->took[i] > most ? rates->took[i] : most;
    }
    double each = pixels ? most / (double)pixels : 0;
    if (rates->seconds[step] <= 0 || each < rates->seconds[step])
        rates->seconds[step] = each;
    return pixels;
}

/* Draws a slab's picture, and looks at it. */
static void scan_layer(snow_context *context, bench_rates *rates, int layer) {
    const combine_options *options = rates->options;
    const int ranks = ranks_of(rates);
    const int slab = (ranks - rates->layers) / 2 + layer;
    combine_pattern pattern;
    combine_pattern_make(options, slab, ranks, rates->spans, &pattern);
    const snow_rectangle drawn = pattern.drawn;
    for (int y = drawn.y0; y < drawn.y1; y++)
        for (int x = drawn.x0; x < drawn.x1; x++)
            combine_pattern_pixel(
                &pattern, x, y,
                rates->picture +
                    ((size_t)y * (size_t)options->width + (size_t)x) *
                        (size_t)options->channels);
    rates->order.drawn = drawn;
    rates->layer = layer;
    for (int run = 0; run <= options->runs; run++)
        rates->scanned = run_step(context, rates, SCAN);
    /* The messages of the region, whose parts are others'. */
    choose_pixels(rates, BLEND);
    for (int item = 0; item < rates->threads; item++)
        scan(rates, item, part_begin(rates, item), part_begin(rates, item + 1));
}

/* `laid`: pixels of all messages of a region. */
static void print_rates(const bench_rates *rates, double laid) {
    static const char *const names[STEPS] = {
        "scan_ns", "copy_ns", "blend_ns", "message_ns", "round_ns", "move_ns"};
    const combine_options *options = rates->options;
    const double *seconds = rates->seconds;
    const double scanned = (double)rates->scanned;
    /* So many neighbours send a rank their pixels of its region. */
    const double received = laid / rates->layers * (ranks_of(rates) - 1);
    bench_line out = {.json = options->json};
    bench_line_int(&out, "ranks", ranks_of(rates));
    bench_line_int(&out, "image", options->width);
    bench_line_int(&out, "pixel_bytes", options->channels * 4);
    bench_line_int(&out, "grain", options->grain);
    bench_line_int(&out, "threads", options->threads);
    for (int i = 0; i < STEPS; i++)
        bench_line_number(&out, names[i], seconds[i] * 1e9);
    /* Of a direct send: all that is read, and a copy of it. */
    bench_line_number(
        &out, "over_copy",
        (seconds[SCAN] * scanned + seconds[BLEND] * received) /
            (seconds[COPY] * scanned + seconds[MESSAGE] * received));
    bench_line_end(&out);
}

int combine_rates(const combine_options *options) {
    snow_context *context;
    bench_rates rates = {.options = options};
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    rates.order = (snow_exchange_params){.width = options->width,
                                         .height = options->height,
                                         .channels = options->channels,
                                         .stride = (size_t)options->width *
                                                   (size_t)options->channels};
    rates.loops =
        snow_pixels_pick(SNOW_ISA_AUTO, options->channels, SNOW_COMPOSITE_OVER);
    rates.layers =
        ranks_of(&rates) < LAYERS_MOST ? ranks_of(&rates) : LAYERS_MOST;
    snow_status status = take_memory(context, &rates);
    if (status == SNOW_STATUS_OK) {
        int64_t laid = 0;
        rates.order.pixels = rates.picture;
        for (int i = 0; i < rates.layers; i++)
            scan_layer(context, &rates, i);
        for (int run = 0; run <= options->runs; run++) {
            laid = run_step(context, &rates, BLEND);
            run_step(context, &rates, MESSAGE);
            run_step(context, &rates, COPY);
        }
        for (int run = 0; run <= options->runs; run++)
            run_step(context, &rates, ROUNDED);
        for (int run = 0; run <= options->runs; run++)
            run_step(context, &rates, MOVE);
        choose_pixels(&rates, BLEND);
        print_rates(&rates, (double)laid / rates.repeats);
    } else {
        fprintf(stderr, "snowglass: bench combine: %s\n",
                snow_context_message(context));
    }
    free_memory(context, &rates);
    snow_context_free(context);
    return (int)status;
}
