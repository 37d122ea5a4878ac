/* classify/palette.c - the samples of all codes for one view.
 *
 * The look of a code is made once for a transfer function: its colour, its
 * opacity a, and log(1 - a). A view then costs one exponential for each code
 * (model, point 6), by base/exp_log.h, in loops that the compiler vectorizes. A
 * key, a copy of all numbers that determine the looks, shows whether they are
 * still valid. */
#include "base/exp_log.h"
#include "base/thread_pool.h"
#include "classify/codes.h"
#include "simd/isa.h"

#include <string.h>

/* Codes of one work item: few enough to stay in the first-level cache, and 256
 * codes are one item. */
#define BLOCK 1024

/* The loops of one instruction set, in classify/palette.tmpl.h. */
typedef struct palette_kernels {
    void (*clear)(const double *opacities, size_t count, double *clarities);
    void (*correct)(const double *clarities, size_t count, double exponent,
                    float *opacities);
} palette_kernels;

#define TEMPLATE "classify/palette.tmpl.h"
#include "simd/each_isa.h"

static const palette_kernels *best_kernels(void) {
    return SNOW_OF_ISA(snow_isa_resolve(SNOW_ISA_AUTO), &kernels);
}

/* What the threads need to make looks or samples. */
typedef struct palette_job {
    const snow_quantizer *quantizer;
    const snow_transfer *transfer;
    snow_palette *palette;
    double exponent;
    bool premultiply;
    const palette_kernels *kernels;
    bool clear; /* store logarithms in place of opacities */
} palette_job;

static size_t block_end(const palette_job *job, size_t first) {
    size_t end = first + BLOCK;
    return end < job->quantizer->codes ? end : job->quantizer->codes;
}

/* --- looks ---------------------------------------------------------------- */

static void make_looks(void *user, int64_t item, int worker) {
    (void)worker;
    const palette_job *job = user;
    const snow_palette *palette = job->palette;
    size_t channels = (size_t)palette->channels, first = (size_t)item * BLOCK;
    size_t count = block_end(job, first) - first;
    snow_transfer_hint hint = {0, 0};
    double opacities[BLOCK];
    for (size_t n = 0; n < count; n++) {
        double value = snow_quantizer_value(job->quantizer, first + n), rgba[4];
        float *look = palette->looks + (first + n) * channels;
        snow_transfer_near(job->transfer, value, &hint, rgba);
        for (size_t i = 0; i + 1 < channels; i++)
            look[i] = (float)rgba[i];
        look[channels - 1] = (float)rgba[3];
        opacities[n] = rgba[3];
    }
    job->kernels->clear(opacities, count, palette->clarities + first);
}

/* Appends numbers to a key. */
static size_t add_numbers(double *key, size_t count, const void *numbers,
                          size_t bytes) {
    memcpy(key + count, numbers, bytes);
    return count + bytes / sizeof *key;
}

/* Writes all numbers that looks depend on into the palette's key; *changed is
 * set to whether it differs from the old key. */
static snow_status take_key(snow_context *context,
                            const snow_quantizer *quantizer,
                            const snow_transfer *transfer,
                            snow_palette *palette, bool *changed) {
    const double head[] = {
        (double)quantizer->type,       quantizer->slope,
        quantizer->intercept,          (double)transfer->log,
        (double)transfer->color_count, (double)transfer->opacity_count};
    size_t stops = quantizer->stop_count * sizeof *quantizer->stops;
    size_t colors = transfer->color_count * sizeof *transfer->colors;
    size_t opacities = transfer->opacity_count * sizeof *transfer->opacities;
    size_t bytes = sizeof head + stops + colors + opacities;
    /* Both buffers at once, so that a second picture allocates nothing. */
    SNOW_TRY(snow_reserve(context, &palette->key, &palette->key_capacity,
                          palette->key_count * sizeof *palette->key, bytes));
    SNOW_TRY(snow_reserve(context, &palette->next_key,
                          &palette->next_key_capacity, 0, bytes));
    double *key = palette->next_key;
    size_t count = add_numbers(key, 0, head, sizeof head);
    if (stops)
        count = add_numbers(key, count, quantizer->stops, stops);
    count = add_numbers(key, count, transfer->colors, colors);
    count = add_numbers(key, count, transfer->opacities, opacities);
    *changed = count != palette->key_count ||
               memcmp(palette->key, key, count * sizeof *key) != 0;
    size_t capacity = palette->next_key_capacity;
    palette->next_key_capacity = palette->key_capacity;
    palette->next_key = palette->key;
    palette->key_capacity = capacity;
    palette->key = key;
    palette->key_count = count;
    return SNOW_STATUS_OK;
}

/* --- samples -------------------------------------------------------------- */

/* The opacities of a block for the exponent; with exponent 1 those of the looks
 * are used unchanged. */
static void opacities_of(const palette_job *job, size_t first, size_t count,
                         float *opacities) {
    const snow_palette *palette = job->palette;
    const double *clarities = palette->clarities + first;
    size_t channels = (size_t)palette->channels;
    double exponent = snow_exponent_within(job->exponent);
    if (job->clear)
        for (size_t i = 0; i < count; i++)
            opacities[i] = clarities[i] > (double)SNOW_OPAQUE
                               ? (float)(clarities[i] * (1 / SNOW_LN2))
                               : SNOW_OPAQUE;
    else if (job->exponent == 1)
        for (size_t i = 0; i < count; i++)
            opacities[i] = palette->looks[(first + i + 1) * channels - 1];
    else
        job->kernels->correct(clarities, count, exponent, opacities);
}

static void fill_grey(const float *looks, const float *opacities, size_t count,
                      bool premultiply, float *samples) {
    for (size_t i = 0; i < count; i++) {
        float weight = premultiply ? opacities[i] : 1;
        samples[2 * i] = looks[2 * i] * weight;
        samples[2 * i + 1] = opacities[i];
    }
}

static void fill_color(const float *looks, const float *opacities, size_t count,
                       bool premultiply, float *samples) {
    for (size_t i = 0; i < count; i++) {
        float weight = premultiply ? opacities[i] : 1;
        samples[4 * i] = looks[4 * i] * weight;
        samples[4 * i + 1] = looks[4 * i + 1] * weight;
        samples[4 * i + 2] = looks[4 * i + 2] * weight;
        samples[4 * i + 3] = opacities[i];
    }
}

/* Bands may hold voxels whose codes are no longer interesting. */
static void clear_dull(const palette_job *job, size_t first, size_t count) {
    const snow_quantizer *quantizer = job->quantizer;
    size_t channels = (size_t)job->palette->channels;
    float *samples = job->palette->samples + first * channels;
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < channels; c++)
            samples[i * channels + c] =
                quantizer->keep[first + i] ? samples[i * channels + c] : 0;
}

static void make_samples(void *user, int64_t item, int worker) {
    (void)worker;
    const palette_job *job = user;
    const snow_palette *palette = job->palette;
    size_t first = (size_t)item * BLOCK;
    size_t count = block_end(job, first) - first;
    size_t place = first * (size_t)palette->channels;
    float opacities[BLOCK];
    opacities_of(job, first, count, opacities);
    if (palette->channels == 2)
        fill_grey(palette->looks + place, opacities, count, job->premultiply,
                  palette->samples + place);
    else
        fill_color(palette->looks + place, opacities, count, job->premultiply,
                   palette->samples + place);
    if (snow_type_size(job->quantizer->type) <= 2)
        clear_dull(job, first, count);
}

static snow_status make_room(snow_context *context, size_t codes,
                             snow_palette *palette) {
    size_t entry = (size_t)palette->channels;
    size_t bytes = codes * entry * sizeof(float);
    SNOW_TRY(snow_reserve(context, &palette->block, &palette->capacity, 0,
                          bytes + entry * sizeof(float)));
    memset(palette->block, 0, entry * sizeof(float));
    palette->samples = palette->block + entry;
    SNOW_TRY(snow_reserve(context, &palette->looks, &palette->looks_capacity, 0,
                          bytes));
    return snow_reserve(context, &palette->clarities,
                        &palette->clarities_capacity, 0,
                        codes * sizeof *palette->clarities);
}

/* Makes the looks if they are out of date, then the samples. */
static snow_status make_palette(snow_context *context, palette_job *job,
                                int threads) {
    const snow_quantizer *quantizer = job->quantizer;
    const snow_transfer *transfer = job->transfer;
    snow_palette *palette = job->palette;
    int64_t items = (int64_t)((quantizer->codes + BLOCK - 1) / BLOCK);
    bool changed;
    SNOW_TRY(take_key(context, quantizer, transfer, palette, &changed));
    if (changed) {
        size_t count = palette->key_count;
        palette->key_count = 0; /* invalid until the looks are made */
        palette->channels = transfer->grey ? 2 : 4;
        SNOW_TRY(make_room(context, quantizer->codes, palette));
        SNOW_TRY(snow_parallel(context, threads, items, make_looks, job));
        palette->key_count = count;
    }
    return snow_parallel(context, threads, items, make_samples, job);
}

snow_status snow_palette_make(snow_context *context,
                              const snow_quantizer *quantizer,
                              const snow_transfer *transfer, double exponent,
                              bool premultiply, int threads,
                              snow_palette *palette) {
    palette_job job = {quantizer,   transfer,       palette, exponent,
                       premultiply, best_kernels(), false};
    return make_palette(context, &job, threads);
}

snow_status snow_palette_make_clear(snow_context *context,
                                    const snow_quantizer *quantizer,
                                    const snow_transfer *transfer, int threads,
                                    snow_palette *palette) {
    palette_job job = {quantizer, transfer,       palette, 1,
                       false,     best_kernels(), true};
    return make_palette(context, &job, threads);
}

void snow_palette_fini(snow_context *context, snow_palette *palette) {
    snow_release(context, palette->block);
    snow_release(context, palette->looks);
    snow_release(context, palette->clarities);
    snow_release(context, palette->key);
    snow_release(context, palette->next_key);
    *palette = (snow_palette){0};
}
