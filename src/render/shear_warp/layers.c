/* render/shear_warp/layers.c - several volumes on one grid in one picture.
 *
 * Each layer has an encoding, a table and light of its own, on the lattice of
 * the picture.  A tile is drawn slab by slab, and in each slab layer by layer,
 * the last one in front, into the same planes of floats:
 *
 *   slab      0      1      2      3      4
 *   layer 1          -- ->  -- ->                drawn together: 0 and 1 | 3, 4
 *   layer 0   -- ->  -- ->  -- ->  -- ->  -- ->  by turns: 1 and 2
 *
 * Layers of one group are mixed in each slab before that is composited, so that
 * their order does not matter. */
#include "render/shear_warp/layers.h"
#include "render/shear_warp/internal.h"
#include "transfer/transfer.h"

#include <math.h>
#include <string.h>

/* A layer of a tile: its slabs that have anything, and which is next. */
typedef struct layer_walk {
    snow_value_splat splat;
    snow_value_tile_fn *tile;
    int32_t *slabs;
    int count, next;
    int group; /* of those that are mixed */
} layer_walk;

static int next_slab(const layer_walk *w) {
    return w->next < w->count ? w->slabs[w->next] : INT32_MAX;
}

static void begin_walk(const snow_value_drawing *drawing,
                       const snow_slab *slices, const int tile[2],
                       int32_t *slabs, layer_walk *w) {
    *w = (layer_walk){
        .splat = drawing->splat, .tile = drawing->tile, .slabs = slabs};
    if (slices)
        w->splat = snow_value_splat_of(drawing, *slices);
    w->splat.resumes = true;
    w->count = snow_value_list(&w->splat, tile, slabs);
}

/* All slabs of a layer before `end`. */
static bool draw_slabs(layer_walk *w, int end, int x, int y, void *scratch) {
    if (next_slab(w) >= end)
        return false;
    w->splat.slabs[0] = next_slab(w);
    while (next_slab(w) < end)
        w->splat.slabs[1] = w->slabs[w->next++] + 1;
    return w->tile(&w->splat, x, y, scratch);
}

/* Returns whether a tile has pixels that something behind would show in. */
static bool is_open(const snow_value_splat *splat, const void *scratch) {
    const snow_value_faint_plane *planes =
        (const snow_value_faint_plane *)(uintptr_t)scratch;
    const float closed = (float)splat->closed / 32767;
    for (int phase = 0; phase < splat->phases; phase++)
        for (int row = 0; row < SNOW_VALUE_ROWS; row++)
            for (int n = 1; n <= SNOW_VALUE_COLUMNS; n++)
                if (planes[phase][3][row][n] < closed)
                    return true;
    return false;
}

#define PLANE (SNOW_VALUE_ROWS * 32) /* floats of a plane; 4 a phase */

/* Begins a layer's own planes, with nothing to draw where `kept` is closed. */
static void clear(float *planes, const float *kept, int phases, float closed) {
    memset(planes, 0, (size_t)phases * sizeof(snow_value_faint_plane));
    for (int phase = 0; phase < phases; phase++)
        for (size_t n = ((size_t)phase * 4 + 3) * PLANE, i = 0; i < PLANE; i++)
            planes[n + i] = kept[n + i] < closed ? 0 : 1.0F;
}

/* Colours add up, of opacities the largest counts. */
static void mix(float *mixed, const float *planes, int phases) {
    for (size_t n = 0; n < (size_t)phases * 4 * PLANE; n++)
        if (n / PLANE % 4 < 3)
            mixed[n] += planes[n];
        else
            mixed[n] = planes[n] > mixed[n] ? planes[n] : mixed[n];
}

/* Colours as bright as a white ground are clear. */
static void clear_white(float *mixed, int phases, double white) {
    for (int phase = 0; phase < phases; phase++)
        for (size_t i = 0; i < PLANE; i++) {
            float *at = mixed + (size_t)phase * 4 * PLANE + i;
            const float least =
                fminf(at[0], fminf(at[PLANE], at[(size_t)2 * PLANE]));
            const double share = snow_white_share(
                white, (double)least, (double)at[(size_t)3 * PLANE]);
            for (size_t c = 0; c < 4; c++)
                at[c * PLANE] *= (float)share;
        }
}

static void lay_behind(float *planes, const float *kept, const float *mixed,
                       int phases, float closed) {
    for (int phase = 0; phase < phases; phase++)
        for (size_t i = 0; i < PLANE; i++) {
            const size_t at = (size_t)phase * 4 * PLANE + i;
            const float before = kept[at + (size_t)3 * PLANE];
            const float through = before < closed ? 1 - before : 0;
            for (size_t c = 0; c < 4; c++)
                planes[at + c * PLANE] =
                    kept[at + c * PLANE] + through * mixed[at + c * PLANE];
        }
}

/* The slabs before `end` of layers in one place; of a single one as they are,
 * else each in planes of its own.  `room_of_two` holds two pictures of them. */
static bool draw_group(layer_walk *w, int count, int end, int x, int y,
                       double white, void *scratch, float *room_of_two) {
    const snow_value_splat *splat = &w->splat;
    const size_t bytes = snow_value_planes_bytes(splat);
    const float closed = (float)splat->closed / 32767;
    float *kept = room_of_two, *mixed = kept + bytes / sizeof *kept;
    bool drawn = false;
    int active = white > 0;
    for (int n = 0; n < count; n++)
        active += next_slab(&w[n]) < end;
    if (active > 1) {
        memcpy(kept, scratch, bytes);
        memset(mixed, 0, bytes);
    }
    for (int n = 0; n < count; n++) {
        if (next_slab(&w[n]) >= end)
            continue;
        if (active > 1)
            clear(scratch, kept, splat->phases, closed);
        drawn |= draw_slabs(&w[n], end, x, y, scratch);
        if (active > 1)
            mix(mixed, scratch, splat->phases);
    }
    if (active > 1 && white > 0)
        clear_white(mixed, splat->phases, white);
    if (active > 1)
        lay_behind(scratch, kept, mixed, splat->phases, closed);
    return drawn;
}

bool snow_value_draw_stack(const snow_value_drawing *job,
                           const snow_slab *slices, bool resumes, int x, int y,
                           void *scratch) {
    const snow_value_path *path = job->path;
    const size_t resampled_slices = (size_t)job->splat.resampled_count;
    int32_t *slabs = (int32_t *)(void *)((char *)scratch +
                                         snow_value_splat_bytes(&job->splat));
    float *room_of_two =
        (float *)(void *)(slabs +
                          resampled_slices * 2 * (size_t)path->layer_count);
    layer_walk walks[SNOW_LAYERS_MAX + 1];
    const int tile[2] = {x, y};
    int count = 0;
    bool drawn = false;
    for (int n = path->layer_count; n >= 0; n--) {
        const snow_value_path *layer = n ? path->layers[n - 1] : path;
        if (!snow_value_has_values(layer))
            continue;
        begin_walk(&layer->drawing, slices, tile,
                   slabs + resampled_slices * (size_t)count, &walks[count]);
        walks[count++].group = layer->group;
    }
    if (!resumes)
        memset(scratch, 0, snow_value_planes_bytes(&job->splat));
    for (int turn = 1;; turn++) {
        int first = INT32_MAX, alone = -1, end = INT32_MAX;
        for (int n = 0; n < count; n++)
            first = next_slab(&walks[n]) < first ? next_slab(&walks[n]) : first;
        if (first == INT32_MAX ||
            (turn % 8 == 0 && drawn && !is_open(&job->splat, scratch)))
            return drawn;
        for (int n = 0; n < count; n++)
            if (next_slab(&walks[n]) == first)
                alone = alone < 0 ? n : count;
        for (int n = 0; n < count; n++)
            if (n != alone && next_slab(&walks[n]) < end)
                end = next_slab(&walks[n]);
        if (alone == count)
            end = first + 1;
        for (int n = 0, next; n < count; n = next) {
            for (next = n + 1; next < count; next++)
                if (walks[next].group != walks[n].group)
                    break;
            drawn |= draw_group(&walks[n], next - n, end, x, y,
                                walks[n].group ? 0 : path->white, scratch,
                                room_of_two);
        }
    }
}
