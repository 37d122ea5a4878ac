/* composite/tile.tmpl.h - the cells of a tile. Include simd/select.h first, and
 * define:
 *
 *   TILE_CHANNELS  floats of a pixel: 2 or 4
 *   TILE_NAME      names of the functions
 *
 * All are undefined at the end. The functions below take the numbers of taps
 * and phases as arguments, which are constants in the common cases
 * (TILE_NAME()), so that loops unroll and weights stay in registers. The order
 * of additions does not depend on the instruction set. */

/* Floats of a filtered row. */
#define TILE_ROW (2 * SNOW_TILE_COLUMNS * TILE_CHANNELS)

/* Number of vectors of floats that are summed in parallel. */
#define TILE_ABREAST(floats) ((floats) / LANES < 4 ? (floats) / LANES : 4)

/* Pixels of a vector. */
#define TILE_VECTOR (LANES / TILE_CHANNELS)

/* Returns a function of (tile, width, taps, phases, lead), with constants in
 * the common cases. */
#define TILE_CASE(call, t, width, taps, comb, lattice)  \
    if ((lattice)->phases == 1)                         \
        return call(t, width, taps, 1, 0);              \
    return (comb)->lead[1] ? call(t, width, taps, 2, 1) \
                           : call(t, width, taps, 2, 0)
#define TILE_CASES(call, t, width, taps, comb, lattice)                  \
    switch (taps) {                                                      \
    case 2:                                                              \
        TILE_CASE(call, t, width, 2, comb, lattice);                     \
    case 4:                                                              \
        TILE_CASE(call, t, width, 4, comb, lattice);                     \
    case 6:                                                              \
        TILE_CASE(call, t, width, 6, comb, lattice);                     \
    default:                                                             \
        return call(t, width, taps, (lattice)->phases, (comb)->lead[1]); \
    }

/* Along u, one pixel a lattice column: pixel n sums voxels n + m. Several
 * vectors are summed in parallel, since each tap of a sum depends on the one
 * before. */
TARGET static inline __attribute__((always_inline)) void
TILE_NAME(_single)(const float *samples, const V(vec) * weights, const int taps,
                   float *pixels) {
    const int abreast = TILE_ABREAST(SNOW_TILE_COLUMNS * TILE_CHANNELS);
    for (int at = 0; at < SNOW_TILE_COLUMNS * TILE_CHANNELS;
         at += abreast * LANES) {
        V(vec) sums[4];
        for (int n = 0; n < abreast; n++)
            sums[n] = V(mul)(weights[0], V(load)(samples + at + n * LANES));
        for (int m = 1; m < taps; m++)
            for (int n = 0; n < abreast; n++)
                sums[n] = V(fma)(
                    weights[m],
                    V(load)(samples + at + n * LANES + m * TILE_CHANNELS),
                    sums[n]);
        for (int n = 0; n < abreast; n++)
            V(store)(pixels + at + n * LANES, sums[n]);
    }
}

/* Along u, two pixels a column, each phase with its own weights; the odd one
 * begins `lead` voxels later. A vector of voxels is loaded once for both, since
 * loads limit the speed of the loop. */
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
        VC(interleave, TILE_CHANNELS)(a, b, pixels + 2 * at);
    }
}

/* Along u, two voxels a pixel: sums at every voxel, in whole vectors, of which
 * every other one is kept. */
TARGET static inline __attribute__((always_inline)) void
TILE_NAME(_halved)(const float *samples, const V(vec) * weights, const int taps,
                   float *pixels) {
    for (int n = 0; n < SNOW_TILE_COLUMNS; n += TILE_VECTOR) {
        const float *at = samples + 2 * n * TILE_CHANNELS;
        V(vec) a = V(mul)(weights[0], V(load)(at));
        V(vec) b = V(mul)(weights[0], V(load)(at + LANES));
        for (int m = 1; m < taps; m++) {
            at += TILE_CHANNELS;
            a = V(fma)(weights[m], V(load)(at), a);
            b = V(fma)(weights[m], V(load)(at + LANES), b);
        }
        V(store)
        (pixels + n * TILE_CHANNELS, VC(deinterleave, TILE_CHANNELS)(a, b));
    }
}

/* One line: rows are weighted, added up and composited behind the image.
 * Returns true while it is not opaque. */
TARGET static inline __attribute__((always_inline)) bool
TILE_NAME(_line)(float *line, const float *const *rows, const V(vec) * weights,
                 const int taps, const int width) {
    const int abreast = TILE_ABREAST(width);
    V(vec) least = V(set1)(0);
    for (int at = 0; at < width; at += abreast * LANES) {
        V(vec) sums[4];
        for (int n = 0; n < abreast; n++)
            sums[n] = V(mul)(weights[0], V(load)(rows[0] + at + n * LANES));
        for (int m = 1; m < taps; m++)
            for (int n = 0; n < abreast; n++)
                sums[n] = V(fma)(weights[m], V(load)(rows[m] + at + n * LANES),
                                 sums[n]);
        for (int n = 0; n < abreast; n++) {
            V(vec) front = V(load)(line + at + n * LANES);
            front = V(fnma)(VC(alpha, TILE_CHANNELS)(front), sums[n], front);
            V(store)(line + at + n * LANES, front);
            least = V(min)(least, front);
        }
    }
    /* Colours are never negative, so only alpha - 1 counts. */
    return V(any_less)(least, V(set1)(-SNOW_OPAQUE_ENOUGH));
}

/* Two lines of a cell at once, which share most of their rows; the second
 * begins `lead` rows later. */
TARGET static inline __attribute__((always_inline)) bool
TILE_NAME(_lines)(float *line, float *below, const float *const *rows,
                  const V(vec) * weights, const int taps, const int lead,
                  const int width) {
    const float *row[SNOW_TAPS_MOST + 1];
    V(vec) least = V(set1)(0);
    for (int m = 0; m < taps + lead; m++)
        row[m] = rows[m];
    for (int at = 0; at < width; at += LANES) {
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
        front = V(fnma)(VC(alpha, TILE_CHANNELS)(front), a, front);
        next = V(fnma)(VC(alpha, TILE_CHANNELS)(next), b, next);
        V(store)(line + at, front);
        V(store)(below + at, next);
        least = V(min)(least, V(min)(front, next));
    }
    return V(any_less)(least, V(set1)(-SNOW_OPAQUE_ENOUGH));
}

/* Weights in all lanes, phase after phase. */
TARGET static inline __attribute__((always_inline)) void
TILE_NAME(_weights)(const snow_comb *comb, int phases, const int taps,
                    V(vec) * weights) {
    for (int phase = 0; phase < phases; phase++)
        for (int m = 0; m < taps; m++)
            weights[phase * taps + m] = V(set1)(comb->weights[phase][m]);
}

/* Combs all rows along u. */
TARGET static inline __attribute__((always_inline)) uint64_t
TILE_NAME(_along_u)(const snow_tile *t, const int width, const int taps,
                    const int phases, const int lead) {
    V(vec) weights[2 * SNOW_TAPS_MOST];
    TILE_NAME(_weights)(t->u, phases, taps, weights);
    (void)width;
    for (uint64_t left = t->held; left; left &= left - 1) {
        int row = __builtin_ctzll(left), stride = t->lattice_u->stride;
        const float *samples = t->samples + (size_t)row * t->window;
        float *pixels = t->ring + row * TILE_ROW;
        if (phases == 2)
            TILE_NAME(_double)(samples, weights, taps, lead, pixels);
        else if (stride == 2)
            TILE_NAME(_halved)(samples, weights, taps, pixels);
        else
            TILE_NAME(_single)(samples, weights, taps, pixels);
    }
    return 0;
}

/* Composites the wanted cells behind the image; returns those that are
 * finished. */
TARGET static inline __attribute__((always_inline)) uint64_t
TILE_NAME(_along_v)(const snow_tile *t, const int width, const int taps,
                    const int phases, const int lead) {
    const int stride = t->lattice_v->stride;
    const float *rows[SNOW_TILE_ROWS];
    V(vec) weights[2 * SNOW_TAPS_MOST];
    uint64_t finished = 0;
    int row = 0;
    TILE_NAME(_weights)(t->v, phases, taps, weights);
    for (uint64_t left = t->wanted; left; left &= left - 1) {
        int cell = __builtin_ctzll(left), end = cell * stride + taps + lead;
        for (row = row > cell * stride ? row : cell * stride; row < end; row++)
            rows[row] = t->held >> row & 1 ? t->ring + row * TILE_ROW : t->zero;
        const float *const *first = rows + cell * stride;
        float *line = t->pixels + (size_t)(cell * phases) * t->line;
        bool seen = phases == 2
                        ? TILE_NAME(_lines)(line, line + t->line, first,
                                            weights, taps, lead, width)
                        : TILE_NAME(_line)(line, first, weights, taps, width);
        finished |= seen ? 0 : left & -left;
    }
    return finished;
}

TARGET static uint64_t TILE_NAME(_rows)(const snow_tile *t){
    TILE_CASES(TILE_NAME(_along_u), t, 0, t->taps_u, t->u, t->lattice_u)}

TARGET static uint64_t TILE_NAME(_cells)(const snow_tile *t){
    TILE_CASES(TILE_NAME(_along_v), t, TILE_ROW / 2, t->taps_v, t->v,
               t->lattice_v)}

TARGET static uint64_t TILE_NAME(_wide_cells)(const snow_tile *t){
    TILE_CASES(TILE_NAME(_along_v), t, TILE_ROW, t->taps_v, t->v, t->lattice_v)}

TARGET static uint64_t TILE_NAME()(const snow_tile *t) {
    TILE_NAME(_rows)(t);
    return t->lattice_u->phases == 2 ? TILE_NAME(_wide_cells)(t)
                                     : TILE_NAME(_cells)(t);
}

#undef TILE_ROW
#undef TILE_ABREAST
#undef TILE_VECTOR
#undef TILE_CASE
#undef TILE_CASES
#undef TILE_CHANNELS
#undef TILE_NAME
