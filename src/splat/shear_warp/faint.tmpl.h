/* splat/shear_warp/faint.tmpl.h - composites slabs of which each shows little,
 * in floats.  Included by tile.tmpl.h. */

/* LANES pixels of a plane: what shines through, times the colour. */
TARGET VALUE_INLINE void NAME(add_faint)(float *plane, const int16_t *color,
                                         V(vec) through) {
    V(store)(plane,
             V(add)(V(load)(plane), V(mul)(through, V(row_floats)(color))));
}

/* As NAME(blend). */
TARGET static int NAME(blend_faint)(const snow_value_splat *p,
                                    snow_value_faint_plane *plane,
                                    value_phase *state, const value_slab *slab,
                                    const value_queue *q, int count,
                                    const int channels) {
    const V(vec) one = V(set1)(1), unit = V(set1)(p->table->unit);
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        int row = __builtin_ctz(rows);
        uint32_t mask = slab->active[row];
        int16_t color[4][32], alphas[32];
        if (!mask)
            continue;
        for (int c = 0; c < 4; c++)
            V(row_store)(color[c], V(row_expand)(q->color[c] + count, mask));
        for (int n = 0; n < 32; n += LANES) {
            float *alpha = (*plane)[3][row] + n;
            V(vec) through = V(mul)(V(sub)(one, V(load)(alpha)), unit);
            for (int c = 0; c < channels - 1; c++)
                NAME(add_faint)((*plane)[c][row] + n, color[c] + n, through);
            NAME(add_faint)(alpha, color[3] + n, through);
            V(row_round)(alphas + n,
                         V(mul)(V(load)(alpha), V(set1)(INT16_MAX)));
        }
        count += __builtin_popcount(mask);
        state->open[row] &=
            V(row_gt)(V(row_set1)(p->closed), V(row_load)(alphas));
        if (!state->open[row])
            state->alive &= ~(UINT32_C(1) << row);
    }
    return count;
}
