/* render/shear_warp/parts.c - a part of a volume draws what is its own of the
 * slabs between resampled slices, on the lattice of the whole.
 *
 *   eye -->   resampled slices     k-1        k         k+1        k+2
 *             slabs       |   k-1   |    k    |    k+1   |
 *             part A  ... *         *         o          o      * own
 *             part B            o   .    o    *          *      o ghosts
 *
 * A sample of a slab is the part's whose voxels the ray meets first: that of
 * the slice in front, and in its plane where the front resampled slice has the
 * sample. So no sample is cut, and those along a ray are as those of the whole;
 * the other resampled slice, and gradients, may need ghosts. */
#include "render/shear_warp/layers.h"

#include "render/picture.h"

static int64_t within(int64_t at, int64_t count) {
    return at < 0 ? 0 : at < count ? at : count - 1;
}

void snow_value_move_slices(snow_value_path *path,
                            const snow_value_params *params) {
    const snow_value_lattice *l = &path->lattice;
    const int64_t *stored = params->clip->stored, *size = params->clip->size;
    for (int n = 0; n < l->resampled_count; n++) {
        snow_resampled_slice *s = &path->resampled_slices[n];
        s->slice -= stored[2];
        s->before = within(s->before - stored[2], size[2]);
        s->after = within(s->after - stored[2], size[2]);
        for (int phase = 0; phase < l->phases && !l->perspective; phase++)
            for (int axis = 0; axis < 2; axis++)
                path->places[n * l->phases + phase].whole[axis] -=
                    (int32_t)stored[axis];
    }
}

void snow_value_own(const snow_value_params *params, snow_value_splat *splat) {
    const snow_clip *clip = params->clip;
    splat->parted = clip->cuts;
    for (int axis = 0; axis < 2; axis++) {
        splat->own[axis][0] = clip->low[axis];
        splat->own[axis][1] = clip->high[axis];
    }
}

snow_value_splat snow_value_splat_of(const snow_value_drawing *d,
                                     snow_slab slices) {
    const snow_value_lattice *l = &d->path->lattice;
    const snow_placement *p = d->params.placement;
    snow_value_splat splat = d->splat;
    int64_t first = slices.first, last = l->resampled_count - 1;
    if (!l->nearest_first)
        first = p->slices - first - slices.count;
    int64_t end = (first + slices.count) * l->per_slice;
    splat.slabs[0] = (int)(first * l->per_slice);
    splat.slabs[1] = (int)(end < last ? end : last);
    return splat;
}

/* --- groups of slices ----------------------------------------------------- */

/* Pixels of a tile. */
static size_t tile_pixels(const snow_value_drawing *d) {
    return (size_t)d->splat.phases * SNOW_VALUE_ROWS * SNOW_VALUE_COLUMNS;
}

size_t snow_value_node_floats(const snow_value_drawing *d) {
    return (SNOW_GROUP_RANKS + 1) * tile_pixels(d) * (size_t)d->splat.channels;
}

static bool draw_group(const snow_value_drawing *d, int group, int x, int y,
                       void *scratch, float *out) {
    const snow_slab slices =
        snow_group_slab(d->params.placement->slices, group);
    const snow_value_splat splat = snow_value_splat_of(d, slices);
    if (splat.slabs[0] >= splat.slabs[1] ||
        !(d->path->layer_count
              ? snow_value_draw_stack(d, &slices, false, x, y, scratch)
              : d->tile(&splat, x, y, scratch)))
        return false;
    /* The planes of a tile as pixels. */
    const int floats = SNOW_VALUE_COLUMNS * d->splat.channels;
    for (int phase = 0; phase < d->splat.phases; phase++)
        for (int row = 0; row < SNOW_VALUE_ROWS; row++, out += floats)
            d->path->op->read(&d->splat, scratch, phase, row, out);
    return true;
}

bool snow_value_node_tile(const snow_value_drawing *d, snow_group_node node,
                          int x, int y, void *scratch, float *out) {
    if (node.rank == 0)
        return draw_group(d, node.index, x, y, scratch, out);
    bool rises = snow_group_rises(d->params.placement, node);
    snow_group_node near = {node.rank - 1, 2 * node.index + !rises};
    snow_group_node far = {node.rank - 1, 2 * node.index + rises};
    if (!snow_value_node_tile(d, near, x, y, scratch, out))
        return snow_value_node_tile(d, far, x, y, scratch, out);
    float *back = out + tile_pixels(d) * (size_t)d->splat.channels;
    snow_composite_fn *composite = d->path->op->combine;
    if (!composite)
        composite = snow_over_of(d->splat.channels);
    if (snow_value_node_tile(d, far, x, y, scratch, back))
        composite(out, back, tile_pixels(d));
    return true;
}
