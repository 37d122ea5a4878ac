/* splat/shear_warp/color.tmpl.h - packed samples to colours.  Include
 * simd/select.h first. */

/* Vectors of 32 floats. */
#define GROUPS (32 / LANES)

/* --- light ---------------------------------------------------------------- */

TARGET VALUE_LEAF V(vec) NAME(dot)(const float by[3], V(vec) u, V(vec) v,
                                   V(vec) p) {
    V(vec) sum = V(mul)(V(set1)(by[0]), u);
    sum = V(add)(sum, V(mul)(V(set1)(by[1]), v));
    return V(add)(sum, V(mul)(V(set1)(by[2]), p));
}

#include "splat/shear_warp/ray.tmpl.h"

/* base^(power / 2^SNOW_VALUE_ROOTS) for 32 bases above 0. */
TARGET VALUE_LEAF void NAME(power_of)(const V(vec) base[GROUPS], uint32_t power,
                                      V(vec) result[GROUPS]) {
    V(vec) square[GROUPS], root[GROUPS];
    for (int k = 0; k < GROUPS; k++) {
        result[k] = V(set1)(1);
        square[k] = root[k] = base[k];
    }
    for (uint32_t whole = power >> SNOW_VALUE_ROOTS; whole; whole >>= 1)
        for (int k = 0; k < GROUPS; k++) {
            if (whole & 1)
                result[k] = V(mul)(result[k], square[k]);
            if (whole > 1) /* smaller ones may be denormal, which is slow */
                square[k] = V(mul)(square[k], square[k]);
        }
    uint32_t part = power & ((1U << SNOW_VALUE_ROOTS) - 1);
    for (int n = SNOW_VALUE_ROOTS - 1; part && n >= 0; n--)
        for (int k = 0; k < GROUPS; k++) {
            root[k] = V(sqrt)(root[k]);
            if (part >> n & 1)
                result[k] = V(mul)(result[k], root[k]);
        }
}

/* n . eye, light and half for LANES gradients, times their length. */
TARGET VALUE_LEAF void NAME(face)(const snow_value_light *l, V(vec) u, V(vec) v,
                                  V(vec) p, V(vec) out[3]) {
    out[0] = NAME(dot)(l->eye, u, v, p);
    if (!l->distant)
        return;
    out[1] = NAME(dot)(l->light, u, v, p);
    out[2] = NAME(dot)(l->half, u, v, p);
}

/* The largest shininess whose powers are taken of numbers of 15 bits.
 */
#define POWER_MOST 64

/* base^power of 32 bases of 15 bits; `power` is a whole number above 0. */
TARGET VALUE_LEAF V(row) NAME(row_power)(V(row) base, uint32_t power) {
    for (; !(power & 1); power >>= 1)
        base = V(row_mulhrs)(base, base);
    V(row) result = base;
    while (power >>= 1) {
        base = V(row_mulhrs)(base, base);
        if (power & 1)
            result = V(row_mulhrs)(result, base);
    }
    return result;
}

/* The shine of 32 samples, of 15 bits; `half` is n . h, times 32767. */
TARGET VALUE_LEAF V(row) NAME(shine)(const snow_value_light *l,
                                     const V(vec) half[GROUPS]) {
    const uint32_t power = l->power >> SNOW_VALUE_ROOTS;
    V(vec) base[GROUPS], result[GROUPS];
    if (power && power <= POWER_MOST && power << SNOW_VALUE_ROOTS == l->power)
        return NAME(row_power)(V(row_max)(V(row_narrow)(half), V(row_set1)(0)),
                               power);
    for (int k = 0; k < GROUPS; k++)
        base[k] = V(min)(
            V(max)(V(mul)(half[k], V(set1)(1 / 32767.0F)), V(set1)(l->least)),
            V(set1)(1));
    NAME(power_of)(base, l->power, result);
    for (int k = 0; k < GROUPS; k++)
        result[k] = V(mul)(result[k], V(set1)(32767));
    return V(row_narrow)(result);
}

/* Adds light `n`; `light` and `half` are n . l and n . h, turned to the eye,
 * times 32767. */
TARGET VALUE_LEAF void NAME(add_light)(const snow_value_light *l, int n,
                                       const V(vec) light[GROUPS],
                                       const V(vec) half[GROUPS], float unit,
                                       V(row) *color, V(row) *white) {
    const V(row) zero = V(row_set1)(0);
    const int16_t diffuse = (int16_t)(l->diffuse[n] * unit + 0.5F);
    const int16_t specular = (int16_t)(l->specular[n] * 32767 + 0.5F);
    V(row) to_light = V(row_max)(V(row_narrow)(light), zero);
    const V(row) lit = V(row_min)(to_light, V(row_set1)(1));
    V(row) shine = V(row_and)(NAME(shine)(l, half), V(row_subs)(zero, lit));
    *color = V(row_adds)(*color, V(row_mulhrs)(to_light, V(row_set1)(diffuse)));
    *white = V(row_adds)(*white, V(row_mulhrs)(shine, V(row_set1)(specular)));
}

/* The squares of the lengths of LANES gradients. */
TARGET VALUE_LEAF V(vec) NAME(square_length)(const snow_value_light *l,
                                             V(vec) u, V(vec) v, V(vec) p) {
    V(vec) length =
        NAME(dot)(l->metric, V(mul)(u, u), V(mul)(v, v), V(mul)(p, p));
    if (!l->square)
        length = V(add)(length, NAME(dot)(l->metric + 3, V(mul)(u, v),
                                          V(mul)(u, p), V(mul)(v, p)));
    return V(add)(length, V(set1)(1e-9F));
}

/* 32 gradients to factors of the colour and of white, of 15 bits; samples from
 * `n` of the queue on. */
TARGET VALUE_LEAF void NAME(light)(const snow_value_light *l,
                                   const snow_value_rays *rays,
                                   float slope[2][2], const value_queue *q,
                                   int n, const V(row) slopes[3], V(row) *color,
                                   V(row) *white, const bool eye) {
    const float unit = l->bright ? 16383.5F : 32767.0F;
    V(vec) g[3][GROUPS], ray[2][GROUPS], to[3][GROUPS];
    for (int axis = 0; axis < 3; axis++)
        V(row_widen)(slopes[axis], g[axis]);
    for (int axis = 0; eye && axis < 2; axis++)
        V(row_widen)(V(row_load)(q->ray[axis] + n), ray[axis]);
    for (int k = 0; k < GROUPS; k++) {
        V(vec) u = g[0][k], v = g[1][k], p = g[2][k], face[3];
        V(vec) inverse = V(mul)(V(row_rsqrt)(NAME(square_length)(l, u, v, p)),
                                V(set1)(32767));
        if (eye)
            NAME(face_eye)(l, rays, NAME(ways_of)(slope[0], ray[0][k]),
                           NAME(ways_of)(slope[1], ray[1][k]), u, v, p, face);
        else
            NAME(face)(l, u, v, p, face);
        for (int way = 0; way < (l->distant ? 3 : 1); way++)
            to[way][k] = V(mul)(V(row_turn)(face[way], face[0]), inverse);
    }
    *color = V(row_set1)((int16_t)(l->ambient * unit + 0.5F));
    *white = V(row_set1)(0);
    if (l->distant)
        NAME(add_light)(l, 0, to[1], to[2], unit, color, white);
    if (l->head)
        NAME(add_light)(l, 1, to[0], to[0], unit, color, white);
}

/* --- colours -------------------------------------------------------------- */

/* The place of the opacity, of 32768, from the top bits of the four words. */
TARGET VALUE_LEAF V(row) NAME(split)(V(row) color[4]) {
    V(row) place = V(row_set1)(0x400);
    for (int c = 0; c < 4; c++) {
        place =
            V(row_or)(place, V(row_and)(V(row_srl)(color[c], 4 - c),
                                        V(row_set1)((int16_t)(0x800 << c))));
        color[c] = V(row_and)(color[c], V(row_set1)(INT16_MAX));
    }
    return place;
}

/* The places of 32 samples in the table. */
TARGET VALUE_LEAF V(row) NAME(entries)(const snow_value_table *table,
                                       const int16_t *front,
                                       const int16_t *back) {
    if (table->nodes) {
        int16_t index[32];
        for (int n = 0; n < 32; n++)
            index[n] = (int16_t)(table->nodes[front[n] & SNOW_VALUE_MOST] << 8 |
                                 table->nodes[back[n] & SNOW_VALUE_MOST]);
        return V(row_load)(index);
    }
    V(row) scale = V(row_set1)(table->scale);
    V(row) row = V(row_mulhrs)(V(row_load)(front), scale);
    return V(row_or)(V(row_sll)(row, 8),
                     V(row_mulhrs)(V(row_load)(back), scale));
}

/* Twice the gradients of 32 samples along an axis of a slab's front or back. */
TARGET VALUE_LEAF V(row) NAME(slope_of)(const value_queue *q, int n, int side,
                                        int axis, const bool eye) {
    V(row) slope = V(row_load)(q->slopes[3 * side + axis] + n);
    if (eye && axis < 2)
        slope = V(row_adds)(
            slope, V(row_mulhrs)(slope, V(row_set1)(q->stretch[side][axis])));
    return slope;
}

/* Gradients of 32 samples from `n` on. */
TARGET VALUE_LEAF void NAME(slopes)(const value_queue *q, int n, V(row) place,
                                    V(row) slopes[3], const bool eye) {
    for (int axis = 0; axis < 3; axis++)
        slopes[axis] = NAME(mix)(NAME(slope_of)(q, n, 0, axis, eye),
                                 NAME(slope_of)(q, n, 1, axis, eye), place);
}

/* The places of the opacity in a slab, of which these are the places in what is
 * left of it; a whole one keeps its own. */
TARGET VALUE_LEAF V(row) NAME(place_within)(const value_queue *q, int n,
                                            V(row) place) {
    V(row) part = V(row_load)(q->part + n);
    V(row) within =
        V(row_add)(V(row_load)(q->from + n), V(row_mulhrs)(place, part));
    return V(row_choose)(V(row_gt)(part, V(row_set1)(INT16_MAX - 1)), place,
                         within);
}

/* Gradient opacity of 32 samples from `n` on; `within` is the place in what is
 * left of a slab. */
TARGET static void NAME(fade)(const snow_value_splat *p, value_queue *q, int n,
                              V(row) within, const V(row) slopes[3],
                              int channels) {
    int16_t places[32], gradients[3][32], colors[4][32] = {{0}};
    V(row_store)(places, within);
    for (int axis = 0; axis < 3; axis++)
        V(row_store)(gradients[axis], slopes[axis]);
    for (int c = 0; c < 4; c++)
        if (c < channels - 1 || c == 3)
            memcpy(colors[c], q->color[c] + n, sizeof colors[c]);
    snow_value_fade_colors(p->fade, p->table, gradients, q->front + n,
                           q->back + n, places, colors);
    for (int c = 0; c < 4; c++)
        if (c < channels - 1 || c == 3)
            memcpy(q->color[c] + n, colors[c], sizeof colors[c]);
}

/* --- stages -----------------------------------------------------------------
 *
 * Each goes over the whole queue, so that what one sample waits for is short.
 */

/* Colours, and places of the opacity in a slab, or in what is left of it. */
TARGET VALUE_STAGE void NAME(look_up)(const snow_value_splat *p, value_queue *q,
                                      int count, const int channels,
                                      const bool sloped) {
    for (int n = 0; n < count; n += 32) {
        V(row) color[4], place = V(row_set1)(0);
        if (p->surface)
            for (int c = 0; c < 4; c++)
                color[c] = V(row_set1)(p->surface->color[c]);
        else if (p->labels)
            for (int c = 0; c < 4; c++)
                color[c] = V(row_load)(q->color[c] + n);
        else
            V(row_gather)(p->table->entries,
                          NAME(entries)(p->table, q->front + n, q->back + n),
                          color);
        if (sloped && !p->surface && !p->labels)
            place = NAME(split)(color);
        if (sloped && !p->labels)
            V(row_store)(q->place + n, place);
        for (int c = 0; c < channels - 1; c++)
            V(row_store)(q->color[c] + n, color[c]);
        V(row_store)(q->color[3] + n, color[3]);
    }
}

/* Factors of light, of the colour and of white; gradient opacity. */
TARGET VALUE_STAGE void NAME(light_all)(const snow_value_splat *p,
                                        float slope[2][2], value_queue *q,
                                        int count, const int channels,
                                        bool cuts, const bool eye) {
    const snow_value_light none = {0}; /* copied: stores do not change it */
    const snow_value_light light = p->light ? *p->light : none;
    for (int n = 0; n < count; n += 32) {
        V(row) within = V(row_load)(q->place + n), place = within, slopes[3];
        if (p->surface) {
            int16_t places[32];
            snow_value_meet(p->surface, q, n, cuts, places);
            place = V(row_load)(places);
        } else if (cuts && !p->labels)
            place = NAME(place_within)(q, n, place);
        if (p->labels)
            for (int axis = 0; axis < 3; axis++)
                slopes[axis] = V(row_load)(q->slopes[axis] + n);
        else
            NAME(slopes)(q, n, place, slopes, eye);
        if (p->clip_count)
            V(row_store)(q->place + n, place);
        if (p->fade)
            NAME(fade)(p, q, n, within, slopes, channels);
        if (p->light) {
            V(row) color, white;
            for (int axis = 0; p->leans && axis < 3; axis++)
                slopes[axis] = V(row_adds)(
                    slopes[axis],
                    NAME(mix)(V(row_load)(q->border[axis] + n),
                              V(row_load)(q->border[3 + axis] + n), place));
            NAME(light)(&light, p->rays, slope, q, n, slopes, &color, &white,
                        eye);
            V(row_store)(q->light + n, color);
            V(row_store)(q->white + n, white);
        }
    }
}

/* Colours by these factors. */
TARGET VALUE_STAGE void NAME(shade)(const snow_value_light *l, value_queue *q,
                                    int count, const int channels) {
    for (int n = 0; n < count; n += 32) {
        V(row) light = V(row_load)(q->light + n);
        V(row) alpha = V(row_load)(q->color[3] + n);
        V(row) shine = V(row_mulhrs)(V(row_load)(q->white + n), alpha);
        for (int c = 0; c < channels - 1; c++) {
            V(row) lit = V(row_mulhrs)(V(row_load)(q->color[c] + n), light);
            if (l->bright)
                lit = V(row_adds)(lit, lit);
            V(row_store)(q->color[c] + n,
                         V(row_min)(V(row_adds)(lit, shine), alpha));
        }
    }
}

/* Colours of rays that are not as long as those of the table. */
TARGET static void NAME(lengthen_all)(const snow_value_splat *p,
                                      float slope[2][2], value_queue *q,
                                      int count, int channels, bool cuts) {
    for (int n = 0; n < count; n += 32) {
        V(row) color[4];
        float shares[32];
        for (int c = 0; c < 4; c++)
            color[c] = c < channels - 1 || c == 3 ? V(row_load)(q->color[c] + n)
                                                  : V(row_set1)(0);
        NAME(shares)(p->rays, slope, q, n, cuts, shares);
        NAME(lengthen)(p->table, shares, channels, color);
        for (int c = 0; c < channels - 1; c++)
            V(row_store)(q->color[c] + n, color[c]);
        V(row_store)(q->color[3] + n, color[3]);
    }
}

/* All samples of a queue, of some phases of a slab; its last 32 entries and
 * more are 0. */
TARGET VALUE_INLINE void NAME(color)(const snow_value_splat *p,
                                     float slope[2][2], const value_slab *slabs,
                                     int phases, value_queue *q, int count,
                                     const int channels, const bool sloped,
                                     bool cuts, const bool eye) {
    const bool by_table = !p->labels && !p->surface;
    NAME(look_up)(p, q, count, channels, sloped);
    if (sloped)
        NAME(light_all)(p, slope, q, count, channels, cuts, eye);
    if (sloped && p->light && p->clip_count)
        snow_value_flatten(p, slabs, phases, q);
    if (sloped && p->light)
        NAME(shade)(p->light, q, count, channels);
    if (eye && by_table)
        NAME(lengthen_all)(p, slope, q, count, channels, cuts);
    else if (cuts && by_table)
        snow_value_shorten(p->table, q, count, channels);
}
#undef GROUPS
