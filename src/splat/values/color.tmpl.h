/* splat/values/color.tmpl.h - packed samples to colours.  Include simd/select.h
 * first. */

/* --- light ------------------------------------------------------------------
 */

TARGET VALUE_INLINE V(vec)
    NAME(dot)(const float by[3], V(vec) u, V(vec) v, V(vec) p) {
    V(vec) sum = V(mul)(V(set1)(by[0]), u);
    sum = V(add)(sum, V(mul)(V(set1)(by[1]), v));
    return V(add)(sum, V(mul)(V(set1)(by[2]), p));
}

#include "splat/values/ray.tmpl.h"

/* base^(power / 2^SNOW_VALUE_ROOTS) for a base above 0. */
TARGET VALUE_INLINE V(vec) NAME(power_of)(V(vec) base, uint32_t power) {
    V(vec) result = V(set1)(1), square = base, root = base;
    for (uint32_t whole = power >> SNOW_VALUE_ROOTS; whole; whole >>= 1) {
        if (whole & 1)
            result = V(mul)(result, square);
        square = V(mul)(square, square);
    }
    uint32_t part = power & ((1U << SNOW_VALUE_ROOTS) - 1);
    for (int n = SNOW_VALUE_ROOTS - 1; part && n >= 0; n--) {
        root = V(sqrt)(root);
        if (part >> n & 1)
            result = V(mul)(result, root);
    }
    return result;
}

/* n . eye, light and half for LANES gradients, times their length. */
TARGET VALUE_INLINE void NAME(face)(const snow_value_light *l, V(vec) u,
                                    V(vec) v, V(vec) p, V(vec) out[3]) {
    out[0] = NAME(dot)(l->eye, u, v, p);
    if (!l->distant)
        return;
    out[1] = NAME(dot)(l->light, u, v, p);
    out[2] = NAME(dot)(l->half, u, v, p);
}

/* Adds light `n`; `light` and `half` are n . l and n . h, turned to the eye. */
TARGET VALUE_INLINE void NAME(add_light)(const snow_value_light *l, int n,
                                         V(vec) light, V(vec) half, float unit,
                                         V(vec) * color, V(vec) * white) {
    const V(vec) zero = V(set1)(0), one = V(set1)(1);
    light = V(min)(V(max)(light, zero), one);
    half = V(min)(V(max)(half, V(set1)(l->least)), one);
    V(vec)
    shine = V(mul)(NAME(power_of)(half, l->power), V(row_positive)(light));
    *color = V(add)(*color, V(mul)(light, V(set1)(l->diffuse[n] * unit)));
    *white = V(add)(*white, V(mul)(shine, V(set1)(l->specular[n] * 32767)));
}

/* LANES gradients to factors of the colour and of white, of 15 bits; samples
 * from `n` of the queue on. */
TARGET VALUE_INLINE void
NAME(light)(const snow_value_splat *s, float slope[2][2], const value_queue *q,
            int n, const int16_t *gu, const int16_t *gv, const int16_t *gp,
            int16_t *color, int16_t *white, const bool eye) {
    const snow_value_light *l = s->light;
    const float unit = l->bright ? 16383.5F : 32767.0F;
    V(vec) u = V(row_floats)(gu), v = V(row_floats)(gv), p = V(row_floats)(gp);
    V(vec)
    length = NAME(dot)(l->metric, V(mul)(u, u), V(mul)(v, v), V(mul)(p, p));
    if (!l->square)
        length = V(add)(length, NAME(dot)(l->metric + 3, V(mul)(u, v),
                                          V(mul)(u, p), V(mul)(v, p)));
    V(vec) inverse = V(row_rsqrt)(V(add)(length, V(set1)(1e-9F)));
    V(vec) to[3];
    if (eye)
        NAME(face_eye)
    (l, s->rays, NAME(ways_of)(slope[0], q->ray[0] + n),
     NAME(ways_of)(slope[1], q->ray[1] + n), u, v, p, to);
    else NAME(face)(l, u, v, p, to);
    V(vec) light = V(set1)(l->ambient * unit), shine = V(set1)(0);
    if (l->distant)
        NAME(add_light)
    (l, 0, V(mul)(V(row_turn)(to[1], to[0]), inverse),
     V(mul)(V(row_turn)(to[2], to[0]), inverse), unit, &light, &shine);
    if (l->head) {
        V(vec) facing = V(mul)(V(row_turn)(to[0], to[0]), inverse);
        NAME(add_light)(l, 1, facing, facing, unit, &light, &shine);
    }
    V(row_round)(color, light);
    V(row_round)(white, shine);
}

/* --- colours ----------------------------------------------------------------
 */

/* The place of the opacity, of 32768, from the top bits of the four words. */
TARGET VALUE_INLINE V(row) NAME(split)(V(row) color[4]) {
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
TARGET VALUE_INLINE V(row)
    NAME(entries)(const snow_value_table *table, const int16_t *front,
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
TARGET VALUE_INLINE V(row) NAME(slope_of)(const value_queue *q, int n, int side,
                                          int axis, const bool eye) {
    V(row) slope = V(row_load)(q->slopes[3 * side + axis] + n);
    if (eye && axis < 2)
        slope = V(row_adds)(
            slope, V(row_mulhrs)(slope, V(row_set1)(q->stretch[side][axis])));
    return slope;
}

/* Gradients of 32 samples from `n` on. */
TARGET VALUE_INLINE void NAME(slopes)(const value_queue *q, int n, V(row) place,
                                      int16_t slopes[3][32], const bool eye) {
    for (int axis = 0; axis < 3; axis++)
        V(row_store)
    (slopes[axis], NAME(mix)(NAME(slope_of)(q, n, 0, axis, eye),
                             NAME(slope_of)(q, n, 1, axis, eye), place));
}

/* Gradient opacity of 32 samples from `n` on; `within` is the place in what is
 * left of a slab. */
TARGET static void NAME(fade)(const snow_value_splat *p, const value_queue *q,
                              int n, V(row) within, int16_t slopes[3][32],
                              V(row) color[4]) {
    int16_t places[32], colors[4][32];
    V(row_store)(places, within);
    for (int c = 0; c < 4; c++)
        V(row_store)(colors[c], color[c]);
    snow_value_fade_colors(p->fade, p->table, slopes, q->front + n, q->back + n,
                           places, colors);
    for (int c = 0; c < 4; c++)
        color[c] = V(row_load)(colors[c]);
}

/* Lights 32 samples from `n` on. */
TARGET VALUE_INLINE void NAME(shade)(const snow_value_splat *p,
                                     float slope[2][2], const value_queue *q,
                                     int n, int16_t slopes[3][32],
                                     const int channels, V(row) color[4],
                                     const bool eye) {
    int16_t diffuse[32], white[32];
    for (int at = 0; at < 32; at += LANES)
        NAME(light)
    (p, slope, q, n + at, slopes[0] + at, slopes[1] + at, slopes[2] + at,
     diffuse + at, white + at, eye);
    V(row) light = V(row_load)(diffuse), alpha = color[3];
    V(row) shine = V(row_mulhrs)(V(row_load)(white), alpha);
    for (int c = 0; c < channels - 1; c++) {
        V(row) lit = V(row_mulhrs)(color[c], light);
        if (p->light->bright)
            lit = V(row_adds)(lit, lit);
        color[c] = V(row_min)(V(row_adds)(lit, shine), alpha);
    }
}

/* All samples of a queue, whose last 32 numbers and more are 0. */
TARGET VALUE_INLINE void NAME(color)(const snow_value_splat *p,
                                     float slope[2][2], value_queue *q,
                                     int count, const int channels,
                                     const bool sloped, bool cuts,
                                     const bool eye) {
    for (int n = 0; n < count; n += 32) {
        V(row) color[4];
        if (p->surface)
            for (int c = 0; c < 4; c++)
                color[c] = V(row_set1)(p->surface->color[c]);
        else if (p->labels)
            for (int c = 0; c < 4; c++)
                color[c] = V(row_load)(q->color[c] + n);
        else
            V(row_gather)
        (p->table->entries, NAME(entries)(p->table, q->front + n, q->back + n),
         color);
        if (sloped) {
            V(row) within = p->surface ? V(row_set1)(0) : NAME(split)(color);
            V(row) place = within;
            int16_t slopes[3][32], places[32];
            if (p->surface) {
                snow_value_meet(p->surface, q, n, cuts, places);
                place = V(row_load)(places);
            } else if (cuts && !p->labels)
                place =
                    V(row_add)(V(row_load)(q->from + n),
                               V(row_mulhrs)(place, V(row_load)(q->part + n)));
            if (p->labels)
                for (int axis = 0; axis < 3; axis++)
                    memcpy(slopes[axis], q->slopes[axis] + n,
                           sizeof slopes[axis]);
            else
                NAME(slopes)(q, n, place, slopes, eye);
            if (p->fade)
                NAME(fade)(p, q, n, within, slopes, color);
            if (p->light)
                NAME(shade)(p, slope, q, n, slopes, channels, color, eye);
        }
        if (eye && !p->labels && !p->surface) {
            float shares[32];
            NAME(shares)(p->rays, slope, q, n, cuts, shares);
            NAME(lengthen)(p->table, shares, channels, color);
        }
        for (int c = 0; c < channels - 1; c++)
            V(row_store)(q->color[c] + n, color[c]);
        V(row_store)(q->color[3] + n, color[3]);
    }
    if (cuts && !eye && !p->labels && !p->surface)
        snow_value_shorten(p->table, q, count, channels);
}
