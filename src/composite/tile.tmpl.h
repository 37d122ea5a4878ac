/* composite/tile.tmpl.h - the cells of a tile.  Define before including, with
 * simd/select.h's words in force:
 *
 *   TILE_CHANNELS  floats of a pixel: 2 or 4
 *   TILE_WEAVE     V(weave2) or V(weave4)
 *   TILE_ALPHA     V(alpha2) or V(alpha4)
 *   TILE_NAME      names of the functions
 *
 * All are undefined at the end.  The functions below take the numbers of taps
 * and phases as arguments that are constants where it matters (TILE_NAME()), so
 * that loops unroll and weights stay in registers.  The order of additions does
 * not depend on the level. */

/* Along u, one pixel a lattice column: pixel n sums voxels n + m. */
TARGET static inline __attribute__((always_inline)) void
TILE_NAME(_single)(const float *samples, const V(vec) * weights, const int taps,
                   float *pixels) {
    for (int at = 0; at < SNOW_TILE_COLUMNS * TILE_CHANNELS; at += LANES) {
        V(vec) sum = V(mul)(weights[0], V(load)(samples + at));
        for (int m = 1; m < taps; m++)
            sum = V(fma)(weights[m], V(load)(samples + at + m * TILE_CHANNELS),
                         sum);
        V(store)(pixels + at, sum);
    }
}

/* Along u, two pixels a column, each phase with its own weights; the odd one
 * begins `lead` voxels later.  A vector of voxels is loaded once for both:
 * loads are what the loop waits for. */
TARGET static inline __attribute__((always_inline)) void
TILE_NAME(_double)(const float *samples, const V(vec) * weights, const int taps,
                   const int lead, float *pixels) {
    for (int at = 0; at < SNOW_TILE_COLUMNS * TILE_CHANNELS; at += LANES) {
        V(vec) a = V(set1)(0), b = a;
        for (int m = 0; m < taps + lead; m++) {
            V(vec) voxels = V(load)(samples + at + m * TILE_CHANNELS);
            if (m == 0)
                a = V(mul)(weights[0], voxels);
            else if (m < taps)
                a = V(fma)(weights[m], voxels, a);
            if (m == lead)
                b = V(mul)(weights[taps], voxels);
            else if (m > lead)
                b = V(fma)(weights[taps + m - lead], voxels, b);
        }
        TILE_WEAVE(a, b, pixels + 2 * at);
    }
}

/* Along u, several voxels a pixel. */
TARGET static void TILE_NAME(_strided)(const float *samples, const snow_comb *u,
                                       int taps, int stride, float *pixels) {
    for (int n = 0; n < SNOW_TILE_COLUMNS; n++)
        for (int c = 0; c < TILE_CHANNELS; c++) {
            const float *sample = samples + n * stride * TILE_CHANNELS + c;
            float sum = u->weights[0][0] * *sample;
            for (int m = 1; m < taps; m++)
                sum += u->weights[0][m] * sample[m * TILE_CHANNELS];
            pixels[n * TILE_CHANNELS + c] = sum;
        }
}

/* One line: rows weighted and added up, behind the image.  True while something
 * still shines through. */
TARGET static inline __attribute__((always_inline)) bool
TILE_NAME(_line)(float *line, const float *const *rows, const V(vec) * weights,
                 const int taps, const int phases) {
    const float *row[SNOW_TAPS_MOST];
    V(vec) least = V(set1)(0);
    for (int m = 0; m < taps; m++)
        row[m] = rows[m];
    for (int at = 0; at < phases * SNOW_TILE_COLUMNS * TILE_CHANNELS;
         at += LANES) {
        V(vec) front = V(load)(line + at);
        V(vec) sum = V(mul)(weights[0], V(load)(row[0] + at));
        for (int m = 1; m < taps; m++)
            sum = V(fma)(weights[m], V(load)(row[m] + at), sum);
        front = V(fnma)(TILE_ALPHA(front), sum, front);
        V(store)(line + at, front);
        least = V(min)(least, front);
    }
    /* Colours are never below 0, so that only alpha - 1 counts. */
    return V(any_less)(least, V(set1)(-SNOW_OPAQUE_ENOUGH));
}

/* Two lines of a cell at once, which share most of their rows; the second
 * begins `lead` rows later. */
TARGET static inline __attribute__((always_inline)) bool
TILE_NAME(_lines)(float *line, float *below, const float *const *rows,
                  const V(vec) * weights, const int taps, const int lead,
                  const int phases) {
    const float *row[SNOW_TAPS_MOST + 1];
    V(vec) least = V(set1)(0);
    for (int m = 0; m < taps + lead; m++)
        row[m] = rows[m];
    for (int at = 0; at < phases * SNOW_TILE_COLUMNS * TILE_CHANNELS;
         at += LANES) {
        V(vec) front = V(load)(line + at), next = V(load)(below + at);
        V(vec) a = V(set1)(0), b = a;
        for (int m = 0; m < taps + lead; m++) {
            V(vec) pixels = V(load)(row[m] + at);
            if (m == 0)
                a = V(mul)(weights[0], pixels);
            else if (m < taps)
                a = V(fma)(weights[m], pixels, a);
            if (m == lead)
                b = V(mul)(weights[taps], pixels);
            else if (m > lead)
                b = V(fma)(weights[taps + m - lead], pixels, b);
        }
        front = V(fnma)(TILE_ALPHA(front), a, front);
        next = V(fnma)(TILE_ALPHA(next), b, next);
        V(store)(line + at, front);
        V(store)(below + at, next);
        least = V(min)(least, V(min)(front, next));
    }
    return V(any_less)(least, V(set1)(-SNOW_OPAQUE_ENOUGH));
}

TARGET static inline __attribute__((always_inline)) void
TILE_NAME(_filter)(const snow_tile *t, int row, const V(vec) * weights,
                   const int taps, const int phases, const int lead,
                   float *pixels) {
    const float *samples = t->samples + (size_t)row * t->window;
    if (phases == 2)
        TILE_NAME(_double)(samples, weights, taps, lead, pixels);
    else if (t->lattice_u->stride == 1)
        TILE_NAME(_single)(samples, weights, taps, pixels);
    else
        TILE_NAME(_strided)(samples, t->u, taps, t->lattice_u->stride, pixels);
}

/* Weights in all lanes, phase after phase. */
TARGET static inline __attribute__((always_inline)) void
TILE_NAME(_weights)(const snow_comb *comb, int phases, const int taps,
                    V(vec) * weights) {
    for (int phase = 0; phase < phases; phase++)
        for (int m = 0; m < taps; m++)
            weights[phase * taps + m] = V(set1)(comb->weights[phase][m]);
}

TARGET static inline __attribute__((always_inline)) uint64_t
TILE_NAME(_cells)(const snow_tile *t, const int taps_u, const int taps_v,
                  const int phases_u, const int phases_v, const int lead_u,
                  const int lead_v) {
    const int stride = t->lattice_v->stride, reach = taps_v + lead_v;
    const float *rows[SNOW_TILE_ROWS];
    V(vec) along_u[2 * SNOW_TAPS_MOST], along_v[2 * SNOW_TAPS_MOST];
    uint64_t finished = 0;
    int next = 0;
    TILE_NAME(_weights)(t->u, phases_u, taps_u, along_u);
    TILE_NAME(_weights)(t->v, phases_v, taps_v, along_v);
    for (uint64_t cells = t->wanted; cells; cells &= cells - 1) {
        int cell = __builtin_ctzll(cells), first = cell * stride;
        for (next = next > first ? next : first; next < first + reach; next++) {
            float *filtered =
                t->ring + next * 2 * SNOW_TILE_COLUMNS * TILE_CHANNELS;
            rows[next] = t->zero;
            if (t->held >> next & 1) {
                TILE_NAME(_filter)
                (t, next, along_u, taps_u, phases_u, lead_u, filtered);
                rows[next] = filtered;
            }
        }
        float *line = t->pixels + (size_t)(cell * phases_v) * t->line;
        bool seen = phases_v == 2
                        ? TILE_NAME(_lines)(line, line + t->line, rows + first,
                                            along_v, taps_v, lead_v, phases_u)
                        : TILE_NAME(_line)(line, rows + first, along_v, taps_v,
                                           phases_u);
        if (!seen)
            finished |= cells & -cells;
    }
    return finished;
}

/* Two phases on both axes: leads are constants, so that each case unrolls. */
TARGET static inline __attribute__((always_inline)) uint64_t
TILE_NAME(_fine)(const snow_tile *t, const int taps) {
    const int u = t->u->lead[1], v = t->v->lead[1];
    if (u)
        return v ? TILE_NAME(_cells)(t, taps, taps, 2, 2, 1, 1)
                 : TILE_NAME(_cells)(t, taps, taps, 2, 2, 1, 0);
    return v ? TILE_NAME(_cells)(t, taps, taps, 2, 2, 0, 1)
             : TILE_NAME(_cells)(t, taps, taps, 2, 2, 0, 0);
}

/* The cases that pictures are made of, unrolled; and any other. */
TARGET static uint64_t TILE_NAME()(const snow_tile *t) {
    const int taps = t->taps_u == t->taps_v ? t->taps_u : 0;
    const int pu = t->lattice_u->phases, pv = t->lattice_v->phases;
    if (pu == 2 && pv == 2 && taps == 4)
        return TILE_NAME(_fine)(t, 4);
    if (pu == 2 && pv == 2 && taps == 6)
        return TILE_NAME(_fine)(t, 6);
    if (pu == 1 && pv == 1 && taps == 2)
        return TILE_NAME(_cells)(t, 2, 2, 1, 1, 0, 0);
    if (pu == 1 && pv == 1 && taps == 4)
        return TILE_NAME(_cells)(t, 4, 4, 1, 1, 0, 0);
    if (pu == 1 && pv == 1 && taps == 6)
        return TILE_NAME(_cells)(t, 6, 6, 1, 1, 0, 0);
    return TILE_NAME(_cells)(t, t->taps_u, t->taps_v, pu, pv, t->u->lead[1],
                             t->v->lead[1]);
}

#undef TILE_CHANNELS
#undef TILE_WEAVE
#undef TILE_ALPHA
#undef TILE_NAME
