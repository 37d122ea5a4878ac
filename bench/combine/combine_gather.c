/* bench/combine/combine_gather.c - gathers a rank's region at rank 0: its
 * active pixels as runs, rounded to bytes where the picture travels so. */
#include "combine.h"

#include "combine/combiner.h"

#include <string.h>

void combine_gather_free(snow_context *context, combine_gather *state) {
    snow_context_release(context, state->runs);
    snow_context_release(context, state->packed);
    *state = (combine_gather){0};
}

/* Allocates buffers for the region of any position, of the same size on all
 * ranks except those without a region in a tree; all ranks call it together. */
static snow_status allocate_packed(const snow_combiner *combiner,
                                   combine_gather *state, size_t pixel_bytes) {
    snow_context *context = combiner->comm->context;
    const int regions = combiner->rounds.tree ? 1 : combiner->comm->ranks;
    const int64_t capacity = snow_region_room(&combiner->bounds, regions);
    if (state->packed_capacity == capacity &&
        state->packed_bytes == pixel_bytes)
        return SNOW_STATUS_OK;
    combine_gather_free(context, state);
    state->packed_capacity = capacity;
    state->packed_bytes = pixel_bytes;
    /* Every second pixel may be a run, and every line's first. */
    uint64_t runs =
        (uint64_t)(capacity / 2 + capacity / combiner->shape.width + 3);
    bool fine =
        (combiner->rounds.tree && combiner->comm->rank) ||
        ((state->runs =
              snow_allocate_array(context, runs, sizeof *state->runs)) &&
         (state->packed =
              snow_allocate_array(context, (uint64_t)capacity, pixel_bytes)));
    snow_status status = snow_comm_agree_status(
        combiner->comm, fine ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY);
    if (status != SNOW_STATUS_OK)
        combine_gather_free(context, state);
    return status;
}

void combine_round_pixels(const float *pixels, int64_t floats,
                          unsigned char *out) {
    for (int64_t i = 0; i < floats; i++) {
        float value = pixels[i] * 255 + 0.5f;
        value = value > 0 ? value : 0;
        out[i] = (unsigned char)(value < 255 ? value : 255);
    }
}

/* Appends pixels first .. last - 1, of one line, to the packed ones. */
static void pack_run(const snow_combiner *combiner, combine_gather *state,
                     const snow_image_region *region, int64_t first,
                     int64_t last, size_t *run_count, int64_t *packed) {
    const int channels = combiner->shape.channels;
    const int width = combiner->shape.width;
    const int64_t count = last - first;
    unsigned char *out = state->packed + (size_t)*packed * state->packed_bytes;
    state->runs[(*run_count)++] = (snow_pixel_run){
        (int32_t)(first % width),
        snow_exchange_line(combiner, (int)(first / width)), (int32_t)count};
    if (region->pixels) {
        const float *from = region->pixels + (first - region->first) * channels;
        if (state->packed_bytes == (size_t)channels)
            combine_round_pixels(from, count * channels, out);
        else
            memcpy(out, from, (size_t)count * state->packed_bytes);
    }
    *packed += count;
}

/* The next pixel from `at` on whose activity is `active`; at most `end`. */
static int64_t next_pixel(const snow_image_region *region, int64_t at,
                          int64_t end, bool active) {
    while (at < end) {
        uint64_t word = region->active[at / 64 - region->first / 64];
        word = (active ? word : ~word) >> (at % 64);
        if (word) {
            at += __builtin_ctzll(word);
            break;
        }
        at = (at / 64 + 1) * 64;
    }
    return at < end ? at : end;
}

/* Packs the active pixels of a region, line by line; gaps shorter than the cost
 * of a run are filled. */
static size_t pack_region(const snow_combiner *combiner, combine_gather *state,
                          const snow_image_region *region, int64_t *packed) {
    const int64_t width = combiner->shape.width;
    const int64_t gap = SNOW_RUN_BYTES / (int64_t)state->packed_bytes;
    const int64_t last = region->first + region->count;
    size_t runs = 0;
    for (int64_t line = region->first; line < last;) {
        int64_t end = (line / width + 1) * width;
        end = end < last ? end : last;
        int64_t at = next_pixel(region, line, end, true);
        while (at < end) {
            int64_t stop = next_pixel(region, at, end, false);
            int64_t next = next_pixel(region, stop, end, true);
            while (next < end && next - stop <= gap) {
                stop = next_pixel(region, next, end, false);
                next = next_pixel(region, stop, end, true);
            }
            pack_run(combiner, state, region, at, stop, &runs, packed);
            at = next;
        }
        line = end;
    }
    return runs;
}

snow_status combine_gather_region(snow_combiner *combiner,
                                  combine_gather *state,
                                  const snow_image_region *region, int bits,
                                  double round_seconds, void *picture) {
    const snow_exchange_params *shape = &combiner->shape;
    const size_t pixel_bytes =
        (size_t)shape->channels * (bits == 8 ? 1 : sizeof(float));
    int64_t packed = 0;
    SNOW_TRY(allocate_packed(combiner, state, pixel_bytes));
    size_t runs = pack_region(combiner, state, region, &packed);
    snow_comm_work(combiner->comm, (double)packed * round_seconds);
    return snow_gather(combiner, shape->width, shape->height, state->runs, runs,
                       region->pixels ? state->packed : NULL, pixel_bytes,
                       picture);
}
