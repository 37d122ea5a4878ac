/* splat/gather.tmpl.h - the inner loops of splatting in gather form, for one
 * level.  Define before including, after a level was selected:
 *
 *   GATHER_CHANNELS  floats of a sample and of a pixel: 2 or 4
 *   LOCAL(word)      the name of a function; LOCAL(row) is the one of use
 *   B(word)          the block of voxels (splat/words.h) that is gathered at
 *                    once: 4 voxels, or 2 of four channels
 *   BLOCK_VOXELS     those 4 or 2
 *
 * GATHER_CHANNELS, LOCAL, B and BLOCK_VOXELS are undefined at the end.
 *
 * Pixels go in chunks of 16 whatever the level, counted from the image's edge:
 * a chunk's place is a double, and what its lanes add to it is small.  First
 * all lanes find their windows and phases, then the reached ones gather:
 *
 *   acc = sum over rows j of v_j * block(row j)      whole blocks
 *   pixel = fold(u * acc)                            weights u spread out */

#define CHUNK 16

/* Windows and phases of a chunk's pixels. */
typedef struct LOCAL(chunk) {
    int32_t window[CHUNK];         /* its first float */
    int32_t cell_u[CHUNK], cell_v[CHUNK];
    float rest_u[CHUNK], rest_v[CHUNK]; /* from that cell to the next, 0 to 1 */
} LOCAL(chunk);

/* The weights of four voxels at a phase. */
static inline __attribute__((always_inline)) TARGET __m128 LOCAL(weights)(
    const float *row, int padded, float rest) {
    __m128 here = _mm_loadu_ps(row), next = _mm_loadu_ps(row + padded);
    return _mm_fmadd_ps(_mm_set1_ps(rest), _mm_sub_ps(next, here), here);
}

/* Sums one pixel; `taps` rows, `blocks` blocks a row. */
static inline __attribute__((always_inline)) TARGET void LOCAL(pixel)(
    const snow_gatherer *g, const float *window, size_t stride,
    const float *row_u, float rest_u, const float *row_v, float rest_v,
    int taps, int blocks, float *pixel) {
    float v[SNOW_TAPS_MOST];
    for (int j = 0; j < taps; j += 4)
        _mm_storeu_ps(v + j, LOCAL(weights)(row_v + j, g->phases_v.padded,
                                            rest_v));
    B(block) sum = B(zero)();
    for (int n = 0; n < blocks; n++, window += BLOCK_VOXELS * GATHER_CHANNELS) {
        B(block) acc = B(scale)(v[0], B(load)(window));
        for (int j = 1; j < taps; j++)
            acc = B(more)(v[j], B(load)(window + (size_t)j * stride), acc);
        __m128 w = LOCAL(weights)(row_u + n * BLOCK_VOXELS,
                                  g->phases_u.padded, rest_u);
#if GATHER_CHANNELS == 2
        B(block) u = B(pairs)(w);
#else
        B(block) u = B(fours)(w);
#endif
        sum = B(fma)(u, acc, sum);
    }
    __m128 folded = B(fold)(sum);
#if GATHER_CHANNELS == 2
    folded = _mm_add_ps(folded, _mm_movehl_ps(folded, folded));
    _mm_storel_pi((__m64 *)(void *)pixel, folded);
#else
    _mm_storeu_ps(pixel, folded);
#endif
}

/* Pixels first .. end - 1 of a chunk. */
static inline __attribute__((always_inline)) TARGET void LOCAL(pixels)(
    const snow_gatherer *g, const snow_dense *d, const LOCAL(chunk) *c,
    int first, int end, int taps, int blocks, float *pixels) {
    size_t padded_u = (size_t)g->phases_u.padded;
    size_t padded_v = (size_t)g->phases_v.padded;
    for (int n = first; n < end; n++)
        LOCAL(pixel)(g, d->samples + c->window[n], d->stride,
                     g->phases_u.weights + (size_t)c->cell_u[n] * padded_u,
                     c->rest_u[n],
                     g->phases_v.weights + (size_t)c->cell_v[n] * padded_v,
                     c->rest_v[n], taps, blocks,
                     pixels + (size_t)n * GATHER_CHANNELS);
}

/* The same with the usual numbers of taps as constants. */
static TARGET void LOCAL(run)(const snow_gatherer *g, const snow_dense *d,
                              const LOCAL(chunk) *c, int first, int end,
                              float *pixels) {
    int taps = g->phases_v.taps;
    int blocks = (g->phases_u.taps + BLOCK_VOXELS - 1) / BLOCK_VOXELS;
    if (taps == 4 && blocks == 1)
        LOCAL(pixels)(g, d, c, first, end, 4, 1, pixels);
    else if (taps == 2 && blocks == 1)
        LOCAL(pixels)(g, d, c, first, end, 2, 1, pixels);
    else
        LOCAL(pixels)(g, d, c, first, end, taps, blocks, pixels);
}

/* Finds the windows and phases of a chunk that begins at pixel x; returns
 * which of its pixels are reached, the first one lowest. */
static inline __attribute__((always_inline)) TARGET unsigned LOCAL(locate)(
    const snow_gatherer *g, const snow_dense *d, const snow_line *line, int x,
    LOCAL(chunk) *c) {
    double u = line->u + x * line->du, v = line->v + x * line->dv;
    double whole_u = floor(u), whole_v = floor(v);
    V(vec) start_u = V(set1)((float)(u - whole_u));
    V(vec) start_v = V(set1)((float)(v - whole_v));
    V(vec) du = V(set1)((float)line->du), dv = V(set1)((float)line->dv);
    V(vec) cells_u = V(set1)((float)g->phases_u.cells);
    V(vec) cells_v = V(set1)((float)g->phases_v.cells);
    const int last_u = (int)d->shape.columns + d->shape.taps_u;
    const int last_v = (int)d->shape.rows + d->shape.taps_v;
    unsigned reached = 0;
    for (int n = 0; n < CHUNK; n += LANES) {
        V(vec) lanes = V(add)(V(lanes)(), V(set1)((float)n));
        V(vec) at_u = V(fma)(lanes, du, start_u);
        V(vec) at_v = V(fma)(lanes, dv, start_v);
        V(vec) floor_u = V(floor)(at_u), floor_v = V(floor)(at_v);
        V(ints) i = V(add_int)(V(to_ints)(floor_u), (int)whole_u);
        V(ints) j = V(add_int)(V(to_ints)(floor_v), (int)whole_v);
        /* Windows out of the slice become those at its ends: empty ones. */
        i = V(clamp)(i, 0, last_u);
        j = V(clamp)(j, 0, last_v);
        reached |= V(bits)(d->reached, (int)d->words, i, j) << n;
        V(vec) phase_u = V(mul)(V(sub)(at_u, floor_u), cells_u);
        V(vec) phase_v = V(mul)(V(sub)(at_v, floor_v), cells_v);
        V(ints) cell_u = V(to_ints)(phase_u), cell_v = V(to_ints)(phase_v);
        V(store_ints)(c->window + n,
                      V(place)(i, GATHER_CHANNELS, j, (int)d->stride));
        V(store_ints)(c->cell_u + n, cell_u);
        V(store_ints)(c->cell_v + n, cell_v);
        V(store)(c->rest_u + n, V(sub)(phase_u, V(to_floats)(cell_u)));
        V(store)(c->rest_v + n, V(sub)(phase_v, V(to_floats)(cell_v)));
    }
    return reached;
}

static TARGET int LOCAL(row)(const snow_gatherer *g,
                                    const snow_dense *d, const snow_line *line,
                                    float *pixels, snow_run *runs) {
    int count = 0;
    LOCAL(chunk) chunk;
    for (int x = line->first & -CHUNK; x < line->end; x += CHUNK) {
        unsigned reached = LOCAL(locate)(g, d, line, x, &chunk);
        if (x + CHUNK > g->placement->width)
            reached &= (1u << (g->placement->width - x)) - 1;
        while (reached) {
            int first = __builtin_ctz(reached);
            int end = first + __builtin_ctz(~(reached >> first));
            LOCAL(run)(g, d, &chunk, first, end,
                       pixels + (size_t)x * GATHER_CHANNELS);
            count = add_run(runs, count, x + first, x + end);
            reached &= ~0u << end;
        }
    }
    return count;
}

#undef GATHER_CHANNELS
#undef B
#undef BLOCK_VOXELS
#undef CHUNK
#undef LOCAL
