/* render/shear_warp/bands.c - see bands.h. */
#include "render/shear_warp/bands.h"

#include "base/base.h"
#include "composite/over.h"
#include "composite/tile.h"
#include "render/shear_warp/shear_warp.h"

#include <string.h>

/* --- cut tiles ------------------------------------------------------------ */

static size_t line_floats(const snow_cut_tile *tile) {
    return (size_t)tile->width * (size_t)tile->channels;
}

void snow_cut_keep(const snow_cut_tile *tile, uint64_t rows) {
    size_t floats = line_floats(tile);
    for (; rows; rows &= rows - 1) {
        size_t first = (size_t)(__builtin_ctzll(rows) * tile->lines);
        for (size_t line = first; line < first + (size_t)tile->lines; line++)
            memcpy(tile->kept + line * floats,
                   tile->pixels + line * tile->stride, floats * sizeof(float));
    }
}

/* Pixels `from` to `to` - 1 of a line. */
static void put_back(const snow_cut_tile *tile, int line, int from, int to) {
    if (from >= to)
        return;
    size_t channels = (size_t)tile->channels, at = (size_t)from * channels;
    memcpy(tile->pixels + (size_t)line * tile->stride + at,
           tile->kept + (size_t)line * line_floats(tile) + at,
           (size_t)(to - from) * channels * sizeof(float));
}

/* Whether nothing shines through a line any more. */
static bool is_opaque(const snow_cut_tile *tile, int line) {
    size_t channels = (size_t)tile->channels;
    const float *pixel =
        tile->pixels + (size_t)line * tile->stride + channels - 1;
    for (int x = 0; x < tile->width; x++, pixel += channels)
        if (*pixel < -SNOW_OPAQUE_ENOUGH)
            return false;
    return true;
}

uint64_t snow_cut_restore(const snow_cut_tile *tile, uint64_t rows,
                          uint64_t finished) {
    for (; rows; rows &= rows - 1) {
        int first = __builtin_ctzll(rows) * tile->lines;
        for (int line = first; line < first + tile->lines; line++) {
            bool inside = line >= tile->y0 && line < tile->y1;
            put_back(tile, line, 0, inside ? tile->x0 : tile->width);
            if (inside)
                put_back(tile, line, tile->x1, tile->width);
            if (!is_opaque(tile, line))
                finished &= ~(rows & -rows);
        }
    }
    return finished;
}

/* --- groups of slices ----------------------------------------------------- */

snow_status snow_grouping_make(snow_context *context, int64_t slices,
                               snow_slab slab, int step, int64_t drawn,
                               bool rising, bool on, snow_grouping *out) {
    snow_grouping grouping = {.on = on,
                              .node_count = 1,
                              .slices = slices,
                              .slab = slab,
                              .step = step,
                              .drawn = drawn,
                              .rising = rising};
    if (on)
        grouping.node_count = snow_group_nodes(slices, slab, grouping.nodes);
    if (grouping.node_count < 0)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "deterministic pictures need whole groups of slices, "
                         "and slices %lld to %lld are not; partition the "
                         "volume at multiples of %d groups",
                         (long long)slab.first,
                         (long long)(slab.first + slab.count - 1), SNOW_GROUPS);
    *out = grouping;
    return SNOW_STATUS_OK;
}

/* The slices that are drawn of a node. */
static snow_slab slices_of(const snow_grouping *g, snow_group_node node) {
    int first = node.index << node.rank, last = ((node.index + 1) << node.rank);
    int64_t low = snow_group_slab(g->slices, first).first;
    snow_slab end = snow_group_slab(g->slices, last - 1);
    low = (low - g->slab.first) * g->step;
    int64_t high = (end.first + end.count - g->slab.first) * g->step;
    if (high > g->drawn)
        high = g->drawn;
    return (snow_slab){low, high > low ? high - low : 0};
}

/* Lays a tile of `back` behind that of `front`. */
static void combine_tile(const snow_band_shape *shape, const snow_band *front,
                         const snow_band *back, int64_t tile) {
    size_t floats = (size_t)shape->width * (size_t)shape->channels;
    size_t at = (size_t)tile * floats;
    for (int line = 0; line < shape->lines; line++, at += shape->stride)
        if (front->drawn[tile])
            snow_over_row(front->pixels + at, back->pixels + at,
                          (size_t)shape->width, shape->channels);
        else
            memcpy(front->pixels + at, back->pixels + at,
                   floats * sizeof(float));
    front->drawn[tile] = 1;
}

/* A line of a tile. */
static float *line_of(const snow_band_shape *shape, const snow_band *band,
                      int64_t tile, int line) {
    return band->pixels + (size_t)line * shape->stride +
           (size_t)tile * (size_t)shape->width * (size_t)shape->channels;
}

void snow_band_clear_tile(const snow_band_shape *shape, const snow_band *band,
                          int64_t tile) {
    for (int line = 0; line < shape->lines; line++)
        snow_tile_clear(line_of(shape, band, tile, line), (size_t)shape->width,
                        shape->channels);
}

/* Makes finished pictures of the drawn tiles. */
static void finish_band(const snow_band_shape *shape, const snow_band *band) {
    for (int64_t tile = 0; tile < shape->tiles; tile++)
        for (int line = 0; band->drawn[tile] && line < shape->lines; line++)
            snow_tile_finish(line_of(shape, band, tile, line),
                             (size_t)shape->width, shape->channels);
}

/* Draws a node into a band. */
static void draw_node(const snow_grouping *g, snow_group_node node,
                      const snow_band_shape *shape, snow_draw_fn *draw,
                      void *stroke, const snow_band *band,
                      const snow_band *spare) {
    snow_slab slices = slices_of(g, node);
    memset(band->drawn, 0, (size_t)shape->tiles);
    if (slices.count == 0)
        return;
    if (node.rank == 0) {
        draw(stroke, slices.first, slices.count, band);
        finish_band(shape, band);
        return;
    }
    snow_group_node near = {node.rank - 1, 2 * node.index + !g->rising};
    snow_group_node far = {node.rank - 1, 2 * node.index + g->rising};
    const snow_band *back = &spare[node.rank - 1];
    draw_node(g, near, shape, draw, stroke, band, spare);
    draw_node(g, far, shape, draw, stroke, back, spare);
    for (int64_t tile = 0; tile < shape->tiles; tile++)
        if (back->drawn[tile])
            combine_tile(shape, band, back, tile);
}

void snow_grouping_lay_out(const snow_grouping *grouping, size_t floats,
                           int64_t tiles, char *base, size_t *at,
                           snow_band spare[SNOW_GROUP_RANKS]) {
    for (int n = 0; grouping->on && n < SNOW_GROUP_RANKS; n++) {
        spare[n].pixels = snow_lay_out(base, at, floats * sizeof(float));
        spare[n].drawn = snow_lay_out(base, at, (size_t)tiles);
    }
}

void snow_band_draw(const snow_grouping *grouping,
                    const snow_shear_warp_image *image, bool lazy,
                    const snow_band_shape *shape, snow_draw_fn *draw,
                    void *stroke, const snow_band *spare,
                    const snow_band *band) {
    size_t pixels =
        (size_t)shape->lines * shape->stride / (size_t)shape->channels;
    snow_band layer = *band;
    for (int n = 0; grouping->on && n < image->layers; n++) {
        draw_node(grouping, grouping->nodes[n], shape, draw, stroke, &layer,
                  spare);
        layer.pixels += image->layer_floats;
        layer.drawn += image->layer_tiles;
    }
    if (grouping->on)
        return;
    memset(band->drawn, 0, (size_t)shape->tiles);
    if (!lazy)
        snow_tile_clear(band->pixels, pixels, shape->channels);
    draw(stroke, 0, grouping->drawn, band);
    if (lazy)
        finish_band(shape, band);
    else
        snow_tile_finish(band->pixels, pixels, shape->channels);
}
