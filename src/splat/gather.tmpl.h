/* splat/gather.tmpl.h - the inner loops of splatting in gather form, for one
 * instruction set. Include simd/select.h first, and define:
 *
 *   GATHER_CHANNELS  floats of a sample and of a pixel: 2 or 4
 *   LOCAL(word)      the name of a function; LOCAL(row) is the public one
 *   B(word)          the block of voxels (splat/gather_vec.h) that is gathered
 *                    at once: 4 voxels, or 2 of four channels
 *   BLOCK_VOXELS     those 4 or 2
 *
 * GATHER_CHANNELS, LOCAL, B and BLOCK_VOXELS are undefined at the end.
 *
 * Pixels are processed in chunks of 16 for every instruction set, counted from
 * the image's edge: a chunk's position is a double, and the offsets of its
 * lanes are small. First the windows and phases of all pixels of the row are
 * found, then the weights of the reached ones, up to 16 at a time, and then
 * they are gathered:
 *
 *   acc = sum over rows j of v_j * block(row j)      whole blocks
 *   pixel = fold(u * acc)                            weights u spread out
 *
 * Weights go through memory, because a load spreads them at no cost. */

/* Weights of four voxels at a phase, for all `padded` voxels of a row. */
static inline __attribute__((always_inline)) TARGET void
LOCAL(weights)(const float *table, int padded, float rest, float *weights) {
    __m128 part = _mm_set1_ps(rest);
    for (int n = 0; n < padded; n += 4) {
        __m128 here = _mm_loadu_ps(table + n);
        __m128 next = _mm_loadu_ps(table + padded + n);
        _mm_storeu_ps(weights + n,
                      _mm_fmadd_ps(part, _mm_sub_ps(next, here), here));
    }
}

/* Sums one pixel, except for the horizontal sum; `taps` rows, `blocks` blocks a
 * row. */
static inline __attribute__((always_inline)) TARGET B(block)
    LOCAL(sum)(const float *window, size_t stride, const float *u,
               const float *v, int taps, int blocks) {
    B(block) sum = B(zero)();
    for (int n = 0; n < blocks; n++, window += BLOCK_VOXELS * GATHER_CHANNELS) {
        B(block) acc = B(scale)(v[0], B(load)(window));
        for (int j = 1; j < taps; j++)
            acc = B(more)(v[j], B(load)(window + (size_t)j * stride), acc);
#if GATHER_CHANNELS == 2
        B(block) w = B(pairs)(u + n * BLOCK_VOXELS);
#else
        B(block) w = B(fours)(u + n * BLOCK_VOXELS);
#endif
        sum = B(fma)(w, acc, sum);
    }
    return sum;
}

static inline __attribute__((always_inline)) TARGET void
LOCAL(pixel)(const float *window, size_t stride, const float *u, const float *v,
             int taps, int blocks, float *pixel) {
    __m128 folded = B(fold)(LOCAL(sum)(window, stride, u, v, taps, blocks));
#if GATHER_CHANNELS == 2
    folded = _mm_add_ps(folded, _mm_movehl_ps(folded, folded));
    _mm_storel_pi((__m64 *)(void *)pixel, folded);
#else
    _mm_storeu_ps(pixel, folded);
#endif
}

/* Pixels first .. end - 1 of a row, at most 16, with weights of the tables. */
static inline __attribute__((always_inline)) TARGET void
LOCAL(tabled)(const snow_gatherer *g, const snow_dense *d, const snow_places *p,
              int first, int end, int taps, int blocks, int padded_u,
              int padded_v, float *pixels) {
    float u[CHUNK * SNOW_PHASE_TAPS_MOST], v[CHUNK * SNOW_PHASE_TAPS_MOST];
    for (int n = 0; n < end - first; n++) {
        LOCAL(weights)
        (g->phases_u.weights + p->row_u[first + n], padded_u,
         p->rest_u[first + n], u + n * padded_u);
        LOCAL(weights)
        (g->phases_v.weights + p->row_v[first + n], padded_v,
         p->rest_v[first + n], v + n * padded_v);
    }
    THROUGH_MEMORY;
    for (int n = 0; n < end - first; n++)
        LOCAL(pixel)
    (d->samples + p->window[first + n], d->stride, u + n * padded_u,
     v + n * padded_v, taps, blocks,
     pixels + (size_t)(first + n) * GATHER_CHANNELS);
}

/* The same for a run of any length, with weights computed already. */
static inline __attribute__((always_inline)) TARGET void
LOCAL(cubic)(const snow_dense *d, const snow_places *p, snow_run run, int taps,
             int blocks, float *pixels) {
    const float *samples = d->samples;
    const size_t stride = d->stride;
    int n = run.first;
#if GATHER_CHANNELS == 4
    for (; n + 4 <= run.end; n += 4) {
        B(block) sum[4];
        for (int i = 0; i < 4; i++) {
            size_t at = (size_t)(n + i);
            sum[i] = LOCAL(sum)(samples + p->window[at], stride, p->u + 4 * at,
                                p->v + 4 * at, taps, blocks);
        }
        B(fold_four)(sum, pixels + 4 * (size_t)n);
    }
#endif
    for (; n < run.end; n++)
        LOCAL(pixel)
    (samples + p->window[n], stride, p->u + 4 * (size_t)n, p->v + 4 * (size_t)n,
     taps, blocks, pixels + (size_t)n * GATHER_CHANNELS);
}

/* A run of pixels; the usual numbers of taps are constants. */
static TARGET void LOCAL(run)(const snow_gatherer *g, const snow_dense *d,
                              const snow_places *p, snow_run run,
                              float *pixels) {
    int taps = g->phases_v.taps;
    int blocks = (g->phases_u.taps + BLOCK_VOXELS - 1) / BLOCK_VOXELS;
    if (g->cubic && blocks == 1 && taps == 4) {
        LOCAL(cubic)(d, p, run, 4, 1, pixels);
        return;
    }
    if (g->cubic && blocks == 1 && taps == 2) {
        LOCAL(cubic)(d, p, run, 2, 1, pixels);
        return;
    }
    if (g->cubic) {
        LOCAL(cubic)(d, p, run, taps, blocks, pixels);
        return;
    }
    for (int first = run.first; first < run.end; first += CHUNK) {
        int end = first + CHUNK < run.end ? first + CHUNK : run.end;
        if (taps == 4 && blocks == 1)
            LOCAL(tabled)(g, d, p, first, end, 4, 1, 4, 4, pixels);
        else
            LOCAL(tabled)
        (g, d, p, first, end, taps, blocks, g->phases_u.padded,
         g->phases_v.padded, pixels);
    }
}

/* Four weights for each of a vector's phases. */
static inline __attribute__((always_inline)) TARGET void
LOCAL(cubics)(const float (*cubics)[4], V(vec) phase, float *weights) {
    V(vec) dealt = V(deal)(phase), w[4];
    for (int n = 0; n < 4; n++) {
        const float *c = cubics[n];
        w[n] = V(fma)(V(set1)(c[3]), dealt, V(set1)(c[2]));
        w[n] = V(fma)(w[n], dealt, V(set1)(c[1]));
        w[n] = V(fma)(w[n], dealt, V(set1)(c[0]));
    }
    V(store_fours)(weights, w[0], w[1], w[2], w[3]);
}

/* Locates the pixels of a chunk that begins at pixel x; returns the mask of
 * those that are reached, the first one lowest. */
static inline __attribute__((always_inline)) TARGET unsigned
LOCAL(locate)(const snow_gatherer *g, const snow_dense *d,
              const snow_line *line, int x, const snow_places *p, bool cubic) {
    double u = line->u + x * line->du, v = line->v + x * line->dv;
    double whole_u = floor(u), whole_v = floor(v);
    V(vec) start_u = V(set1)((float)(u - whole_u));
    V(vec) start_v = V(set1)((float)(v - whole_v));
    V(vec) du = V(set1)((float)line->du), dv = V(set1)((float)line->dv);
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
        /* Windows outside of the slice become those at its ends, which are
         * empty. */
        i = V(clamp)(i, 0, last_u);
        j = V(clamp)(j, 0, last_v);
        unsigned bits = V(bits)(d->reached, (int)d->words, i, j);
        if (!bits)
            continue;
        reached |= bits << n;
        V(store_ints)
        (p->window + x + n, V(place)(i, GATHER_CHANNELS, j, (int)d->stride));
        V(vec) phase_u = V(sub)(at_u, floor_u), phase_v = V(sub)(at_v, floor_v);
        if (cubic) {
            LOCAL(cubics)(g->phases_u.cubics, phase_u, p->u + 4 * (x + n));
            LOCAL(cubics)(g->phases_v.cubics, phase_v, p->v + 4 * (x + n));
            continue;
        }
        phase_u = V(mul)(phase_u, V(set1)((float)g->phases_u.cells));
        phase_v = V(mul)(phase_v, V(set1)((float)g->phases_v.cells));
        V(ints) cell_u = V(to_ints)(phase_u), cell_v = V(to_ints)(phase_v);
        V(store_ints)(p->row_u + x + n, V(times)(cell_u, g->phases_u.padded));
        V(store_ints)(p->row_v + x + n, V(times)(cell_v, g->phases_v.padded));
        V(store)(p->rest_u + x + n, V(sub)(phase_u, V(to_floats)(cell_u)));
        V(store)(p->rest_v + x + n, V(sub)(phase_v, V(to_floats)(cell_v)));
    }
    return reached;
}

/* The same for the pixels whose bits in `open` are set. */
static inline __attribute__((always_inline)) TARGET uint16_t
LOCAL(wanted)(const snow_gatherer *g, const snow_dense *d,
              const snow_line *line, int x, const snow_places *p, bool cubic) {
    unsigned open = line->open[x / CHUNK];
    if (open)
        open &= LOCAL(locate)(g, d, line, x, p, cubic);
    return (uint16_t)open;
}

static TARGET int LOCAL(row)(const snow_gatherer *g, const snow_dense *d,
                             const snow_line *line, const snow_places *p,
                             float *pixels, snow_run *runs) {
    int begin = line->first & -CHUNK;
    if (g->cubic)
        for (int x = begin; x < line->end; x += CHUNK)
            p->reached[x / CHUNK] = LOCAL(wanted)(g, d, line, x, p, true);
    else
        for (int x = begin; x < line->end; x += CHUNK)
            p->reached[x / CHUNK] = LOCAL(wanted)(g, d, line, x, p, false);
    int count =
        find_runs(p->reached, begin, line->end, g->placement->width, runs);
    for (int n = 0; n < count; n++)
        LOCAL(run)(g, d, p, runs[n], pixels);
    return count;
}

#undef GATHER_CHANNELS
#undef B
#undef BLOCK_VOXELS
#undef LOCAL
