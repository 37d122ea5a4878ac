/* splat/separable/rows.tmpl.h - the loops of splat/separable/rows.h for one
 * instruction set. Include simd/select.h first; nothing else needs to be
 * defined. */

/* --- decompressing -------------------------------------------------------- */

#define SPREAD(bits_of_code, type)                                          \
    TARGET static void NAME(spread##bits_of_code)(                          \
        const uint64_t *bits, size_t step, size_t words,                    \
        const unsigned char *codes, float scale, float start, float *row) { \
        const type *code = (const type *)(const void *)codes;               \
        for (size_t word = 0; word < words; word++, row += 64) {            \
            uint64_t left = bits[word * step];                              \
            for (int at = 0; at < 64; at += 16, left >>= 16) {              \
                V(numbers##bits_of_code)                                    \
                (code, (uint32_t)(left & 0xFFFF), scale, start, row + at);  \
                code += V(popcount)(left & 0xFFFF);                         \
            }                                                               \
        }                                                                   \
    }
SPREAD(8, uint8_t)
SPREAD(16, uint16_t)
#undef SPREAD

/* --- adding up -------------------------------------------------------------
 *
 * ONE(name)(line, sum) computes a new vector of the line. */

/* Compilers assume that stores may change pointers and weights, so these are
 * copied to locals whose address is not taken. */
typedef struct NAME(sums) {
    const float *rows[SNOW_TAPS_MOST + 1];
    V(vec) weights[2][SNOW_TAPS_MOST];
} NAME(sums);

static inline __attribute__((always_inline)) TARGET void
NAME(copy_inputs)(const snow_rows_job *job, int taps, int lead, int phases,
                  NAME(sums) * s) {
    for (int m = 0; m < taps + lead; m++)
        s->rows[m] = job->rows[m];
    for (int phase = 0; phase < phases; phase++)
        for (int m = 0; m < taps; m++)
            s->weights[phase][m] = V(set1)(job->weights[phase][m]);
}

static inline __attribute__((always_inline)) TARGET V(vec)
    NAME(sum_at)(const NAME(sums) * s, int phase, int lead, int taps, int n) {
    const float *const *rows = s->rows + lead;
    V(vec) sum = V(mul)(s->weights[phase][0], V(load)(rows[0] + n));
    for (int m = 1; m < taps; m++)
        sum = V(fma)(s->weights[phase][m], V(load)(rows[m] + n), sum);
    return sum;
}

#define SET(at, sum) V(store)(at, sum)
#define ADD(at, sum) V(store)(at, V(add)(V(load)(at), sum))

#define RUN(name, action)                                                \
    static inline __attribute__((always_inline)) TARGET void NAME(name)( \
        const snow_rows_job *job, int taps, int lead, int phases) {      \
        NAME(sums) s;                                                    \
        float *line = job->lines[0], *next = job->lines[1];              \
        NAME(copy_inputs)(job, taps, lead, phases, &s);                  \
        for (int n = job->first; n < job->end; n += LANES) {             \
            V(vec) sum = NAME(sum_at)(&s, 0, 0, taps, n);                \
            action(line + n, sum);                                       \
            if (phases == 2) {                                           \
                V(vec) other = NAME(sum_at)(&s, 1, lead, taps, n);       \
                action(next + n, other);                                 \
            }                                                            \
        }                                                                \
    }
RUN(set_run, SET)
RUN(add_run, ADD)
#undef RUN
#undef SET
#undef ADD

/* The usual numbers of taps are constants. */
#define ROWS(name)                                            \
    TARGET static void NAME(name)(const snow_rows_job *job) { \
        if (!job->lines[1] && job->taps == 4)                 \
            NAME(name##_run)(job, 4, 0, 1);                   \
        else if (!job->lines[1])                              \
            NAME(name##_run)(job, job->taps, 0, 1);           \
        else                                                  \
            NAME(name##_run)(job, job->taps, job->lead, 2);   \
    }
ROWS(set)
ROWS(add)
#undef ROWS

/* --- maximum values ------------------------------------------------------- */

/* The coefficients of a segment of the spline as a Bezier curve, which stays
 * within their hull (Farin, Curves and Surfaces for CAGD). */
TARGET static void NAME(hull)(const float *const *rows, int64_t count,
                              float *restrict highest) {
    const float *restrict a = rows[0], *restrict b = rows[1];
    const float *restrict c = rows[2], *restrict d = rows[3];
    for (int64_t n = 0; n < count; n++) {
        float first = a[n] + 4 * b[n] + c[n], last = b[n] + 4 * c[n] + d[n];
        float high = b[n] > c[n] ? b[n] : c[n], low = b[n] > c[n] ? c[n] : b[n];
        float inner = 4 * high + 2 * low, end = first > last ? first : last;
        highest[n] = (inner > end ? inner : end) * (1.0f / 6);
    }
}

TARGET static void NAME(fours)(const float *restrict numbers, int64_t count,
                               float *restrict largest) {
    for (int64_t n = 0; n < count; n++) {
        const float *at = numbers + 4 * n;
        float a = at[0] > at[1] ? at[0] : at[1];
        float b = at[2] > at[3] ? at[2] : at[3];
        largest[n] = a > b ? a : b;
    }
}

/* Weights add up to 1, and factors compensate for missing ones, except for
 * rounding, by which a sheet may exceed all of its voxels. */
#define MOST_MARGIN 1.000004f

/* Adding it removes fractions: numbers are rounded as by V(least4). */
#define MOST_WHOLE 12582912.0f /* 1.5 * 2^23 */

TARGET static void NAME(blocks)(const float *restrict numbers, int64_t count,
                                uint16_t *restrict blocks) {
    for (int64_t n = 0; n < count; n++) {
        float step = numbers[n] * MOST_MARGIN * SNOW_MAXIMUM_STEPS +
                     MOST_WHOLE - MOST_WHOLE;
        blocks[n] =
            (uint16_t)(int)(step < SNOW_MAXIMUM_STEPS ? step
                                                      : SNOW_MAXIMUM_STEPS);
    }
}
#undef MOST_MARGIN

/* The maximum of the blocks of 32 patches, for `rows` rows of them. */
static inline __attribute__((always_inline)) TARGET void
NAME(along)(const uint16_t *restrict blocks, int64_t columns, int rows,
            int step, int across, uint16_t (*restrict most)[32]) {
    for (int row = 0; row < rows; row++, blocks += columns) {
        uint16_t here[32];
        for (int n = 0; n < 32; n++)
            here[n] = blocks[n * step];
        for (int a = 1; a < across; a++)
            for (int n = 0; n < 32; n++) {
                uint16_t next = blocks[n * step + a];
                here[n] = next > here[n] ? next : here[n];
            }
        memcpy(most[row], here, sizeof here);
    }
}

/* Each row becomes the maximum of itself and the row `apart` further. */
static inline __attribute__((always_inline)) TARGET void
NAME(pair)(uint16_t (*most)[32], int rows, int apart) {
    for (int row = 0; row + apart < rows; row++) {
        uint16_t here[32];
        for (int n = 0; n < 32; n++)
            here[n] = most[row][n] > most[row + apart][n]
                          ? most[row][n]
                          : most[row + apart][n];
        memcpy(most[row], here, sizeof here);
    }
}

/* Eight fours of patches from patch `first` on: a byte for each cell. */
TARGET static void NAME(look_at)(const snow_maximum_look *look, int first,
                                 uint8_t *found) {
    uint16_t most[SNOW_MAXIMUM_ROWS + SNOW_TAPS_MOST][32];
    int begin = __builtin_ctzll(look->cells);
    int last = 63 - __builtin_clzll(look->cells), step = look->step;
    int rows = (last - begin) * look->stride + look->reach, done = 1;
    const uint16_t *blocks =
        look->blocks + ((look->row + begin * look->stride) * look->columns +
                        look->column + first * step);
    if (step == 1 && look->across == 1)
        NAME(along)(blocks, look->columns, rows, 1, 1, most);
    else if (step == 1 && look->across == 2)
        NAME(along)(blocks, look->columns, rows, 1, 2, most);
    else if (step == 1)
        NAME(along)(blocks, look->columns, rows, 1, look->across, most);
    else
        NAME(along)(blocks, look->columns, rows, step, look->across, most);
    for (; done * 2 <= look->reach; done *= 2)
        NAME(pair)(most, rows, done);
    if (done < look->reach)
        NAME(pair)(most, rows, look->reach - done);
    const uint16_t *least = look->least + (size_t)begin * look->patches + first;
    for (int cell = begin; cell <= last; cell++, least += look->patches)
        found[cell] =
            (uint8_t)V(above32)(most[(cell - begin) * look->stride], least);
}

TARGET static void NAME(look)(const snow_maximum_look *look) {
    int fours = look->fours, tiles = 8 / fours;
    for (int tile = look->first; tile < look->end; tile += tiles) {
        uint8_t found[64] = {0};
        uint64_t cells[8];
        NAME(look_at)(look, tile * 4 * fours, found);
        V(transpose64)(found, cells);
        for (int n = 0; n < tiles; n++)
            look->found[tile + n] =
                (cells[n * fours] | cells[n * fours + fours - 1]) & look->cells;
    }
}

/* Decompresses windows to floats. */
#define WINDOWS(bits_of_code, type)                                            \
    TARGET static void NAME(windows##bits_of_code)(                            \
        const snow_maximum_tile *t) {                                          \
        const float scale = t->scale, start = t->start;                        \
        const int window = t->window;                                          \
        for (uint64_t held = t->held; held; held &= held - 1) {                \
            int row = __builtin_ctzll(held);                                   \
            const type *code =                                                 \
                (const type *)(const void *)t->codes[row] + t->before[row];    \
            float *samples = t->samples + row * SNOW_MAXIMUM_WINDOW;           \
            uint64_t left = t->bits[row];                                      \
            for (int at = 0; at < window; at += 16, left >>= 16) {             \
                V(numbers##bits_of_code)                                       \
                (code, (uint32_t)(left & 0xFFFF), scale, start, samples + at); \
                code += V(popcount)(left & 0xFFFF);                            \
            }                                                                  \
        }                                                                      \
    }
WINDOWS(8, uint8_t)
WINDOWS(16, uint16_t)
#undef WINDOWS

static inline __attribute__((always_inline)) TARGET void
NAME(take_weights)(const snow_maximum_tile *t, int axis, int taps, int phases,
                   V(vec) (*weights)[SNOW_TAPS_MOST]) {
    for (int phase = 0; phase < phases; phase++) {
        weights[phase][0] = V(set1)(t->weights[axis][phase][0]);
        for (int m = 1; m < taps; m++)
            weights[phase][m] = V(set1)(t->weights[axis][phase][m]);
    }
}

static inline __attribute__((always_inline)) TARGET void
NAME(comb_rows)(const snow_maximum_tile *t, int taps, int lead, int phases,
                int columns) {
    V(vec) weights[2][SNOW_TAPS_MOST];
    NAME(take_weights)(t, 0, taps, phases, weights);
    for (uint64_t held = t->held; held; held &= held - 1) {
        int row = __builtin_ctzll(held);
        const float *samples = t->samples + row * SNOW_MAXIMUM_WINDOW;
        float *pixels = t->ring + row * SNOW_MAXIMUM_LINE;
        for (int at = 0; at < columns; at += LANES)
            for (int phase = 0; phase < phases; phase++) {
                const float *first = samples + at + phase * lead;
                V(vec) sum = V(mul)(weights[phase][0], V(load)(first));
                for (int m = 1; m < taps; m++)
                    sum = V(fma)(weights[phase][m], V(load)(first + m), sum);
                V(store)(pixels + phase * columns + at, sum);
            }
    }
}

/* For several voxels a pixel. */
TARGET static void NAME(comb_strided)(const snow_maximum_tile *t) {
    for (uint64_t held = t->held; held; held &= held - 1) {
        int row = __builtin_ctzll(held);
        const float *sample = t->samples + row * SNOW_MAXIMUM_WINDOW;
        float *pixels = t->ring + row * SNOW_MAXIMUM_LINE;
        for (int n = 0; n < t->columns; n++, sample += t->stride[0]) {
            float sum = t->weights[0][0][0] * sample[0];
            for (int m = 1; m < t->taps[0]; m++)
                sum += t->weights[0][0][m] * sample[m];
            pixels[n] = sum;
        }
    }
}

#if LANES == 16
/* The same for rows whose window fits into two vectors, to which its reads are
 * limited. */
#define TAP(m)                     \
    (m) == 0   ? a                 \
    : (m) == 1 ? V(slide)(a, b, 1) \
    : (m) == 2 ? V(slide)(a, b, 2) \
    : (m) == 3 ? V(slide)(a, b, 3) \
    : (m) == 4 ? V(slide)(a, b, 4) \
    : (m) == 5 ? V(slide)(a, b, 5) \
               : V(slide)(a, b, 6)

static inline __attribute__((always_inline)) TARGET void
NAME(comb_windows)(const snow_maximum_tile *t, int bytes, int taps, int lead) {
    V(vec) weights[2][SNOW_TAPS_MOST];
    NAME(take_weights)(t, 0, taps, 2, weights);
    const float scale = t->scale, start = t->start;
    for (uint64_t held = t->held; held; held &= held - 1) {
        int row = __builtin_ctzll(held);
        const unsigned char *code =
            t->codes[row] + (size_t)t->before[row] * (size_t)bytes;
        float *pixels = t->ring + row * SNOW_MAXIMUM_LINE;
        V(vec) a, b, sums[2];
        if (bytes == 1)
            V(window8)(code, (uint32_t)t->bits[row], scale, start, &a, &b);
        else
            V(window16)
        ((const uint16_t *)(const void *)code, (uint32_t)t->bits[row], scale,
         start, &a, &b);
        sums[0] = V(mul)(weights[0][0], a);
        sums[1] = V(mul)(weights[1][0], TAP(lead));
        for (int m = 1; m < taps; m++) {
            sums[0] = V(fma)(weights[0][m], TAP(m), sums[0]);
            sums[1] = V(fma)(weights[1][m], TAP(m + lead), sums[1]);
        }
        V(store)(pixels, sums[0]);
        V(store)(pixels + 16, sums[1]);
    }
}
#undef TAP

/* Whether that case applied and the rows are done. */
TARGET static bool NAME(comb_fits)(const snow_maximum_tile *t) {
    int taps = t->taps[0], lead = t->lead[0];
    if (t->phases[0] != 2 || (taps != 4 && taps != 6))
        return false;
    if (t->code_bytes == 1 && taps == 4 && lead)
        NAME(comb_windows)(t, 1, 4, 1);
    else if (t->code_bytes == 1 && taps == 4)
        NAME(comb_windows)(t, 1, 4, 0);
    else if (t->code_bytes == 1 && lead)
        NAME(comb_windows)(t, 1, 6, 1);
    else if (t->code_bytes == 1)
        NAME(comb_windows)(t, 1, 6, 0);
    else if (taps == 4 && lead)
        NAME(comb_windows)(t, 2, 4, 1);
    else if (taps == 4)
        NAME(comb_windows)(t, 2, 4, 0);
    else if (lead)
        NAME(comb_windows)(t, 2, 6, 1);
    else
        NAME(comb_windows)(t, 2, 6, 0);
    return true;
}
#else
TARGET static bool NAME(comb_fits)(const snow_maximum_tile *t) {
    (void)t;
    return false;
}
#endif

TARGET static void NAME(comb)(const snow_maximum_tile *t) {
    int lead = t->lead[0];
    if (NAME(comb_fits)(t))
        return;
    (t->code_bytes == 1 ? NAME(windows8) : NAME(windows16))(t);
    if (t->stride[0] > 1)
        NAME(comb_strided)(t);
    else if (t->columns == 32 && t->taps[0] == 6)
        NAME(comb_rows)(t, 6, 0, 1, 32);
    else if (t->columns == 32 && t->taps[0] == 5)
        NAME(comb_rows)(t, 5, 0, 1, 32);
    else if (t->phases[0] == 1)
        NAME(comb_rows)(t, t->taps[0], 0, 1, t->columns);
    else if (t->taps[0] == 4)
        NAME(comb_rows)(t, 4, lead, 2, 16);
    else if (t->taps[0] == 6)
        NAME(comb_rows)(t, 6, lead, 2, 16);
    else
        NAME(comb_rows)(t, t->taps[0], lead, 2, 16);
}

/* Both lines of a cell share their rows, except for the lead. */
static inline __attribute__((always_inline)) TARGET V(vec)
    NAME(most_pixels)(const snow_maximum_tile *t, const float *const *rows,
                      float *line, int at, int taps, int lead, int phases,
                      const V(vec) (*weights)[SNOW_TAPS_MOST]) {
    V(vec) sums[2], least = V(set1)(SNOW_MAXIMUM_NONE);
    for (int phase = 0; phase < phases; phase++) {
        const float *const *first = rows + phase * lead;
        sums[phase] = V(mul)(weights[phase][0], V(load)(first[0] + at));
        for (int m = 1; m < taps; m++)
            sums[phase] =
                V(fma)(weights[phase][m], V(load)(first[m] + at), sums[phase]);
    }
    for (int phase = 0; phase < phases; phase++) {
        float *pixels = line + phase * SNOW_MAXIMUM_LINE + at;
        if (t->factors)
            sums[phase] =
                V(mul)(sums[phase],
                       V(load)(t->factors + phase * SNOW_MAXIMUM_LINE + at));
        sums[phase] = V(max)(sums[phase], V(load)(pixels));
        V(store)(pixels, sums[phase]);
        least = V(min)(least, sums[phase]);
    }
    return least;
}

static inline __attribute__((always_inline)) TARGET void
NAME(most_cell)(const snow_maximum_tile *t, const float *const *rows, int cell,
                int taps, int lead, int phases, int width, int columns,
                const V(vec) (*weights)[SNOW_TAPS_MOST]) {
    float *line = t->lines + cell * phases * SNOW_MAXIMUM_LINE;
    uint16_t *least = t->least + (size_t)cell * t->patches;
    for (int at = 0; at < columns; at += LANES) {
        V(vec)
        pixels =
            NAME(most_pixels)(t, rows, line, at, taps, lead, phases, weights);
        if (width > columns)
            pixels =
                V(min)(pixels, NAME(most_pixels)(t, rows, line, at + columns,
                                                 taps, lead, phases, weights));
        uint64_t steps = V(least4)(V(mul)(pixels, V(set1)(SNOW_MAXIMUM_STEPS)));
        memcpy(least + at / 4, &steps, LANES / 4 * sizeof *least);
    }
}

static inline __attribute__((always_inline)) TARGET void
NAME(most_cells)(const snow_maximum_tile *t, int taps, int lead, int phases,
                 int width, int columns) {
    V(vec) weights[2][SNOW_TAPS_MOST];
    const float *rows[SNOW_TAPS_MOST + 1];
    NAME(take_weights)(t, 1, taps, phases, weights);
    for (uint64_t left = t->cells; left; left &= left - 1) {
        int cell = __builtin_ctzll(left), row = cell * t->stride[1];
        for (int m = 0; m < taps + lead; m++)
            rows[m] = t->held >> (row + m) & 1
                          ? t->ring + (row + m) * SNOW_MAXIMUM_LINE
                          : t->zero;
        NAME(most_cell)
        (t, rows, cell, taps, lead, phases, width, columns,
         (const V(vec)(*)[SNOW_TAPS_MOST])weights);
    }
}

TARGET static void NAME(most)(const snow_maximum_tile *t) {
    int taps = t->taps[1], lead = t->lead[1], phases = t->phases[1];
    if (t->phases[0] == 2 && phases == 2 && taps == 4 && lead)
        NAME(most_cells)(t, 4, 1, 2, 32, 16);
    else if (t->phases[0] == 2 && phases == 2 && taps == 4)
        NAME(most_cells)(t, 4, 0, 2, 32, 16);
    else if (t->phases[0] == 2 && phases == 2 && taps == 6 && lead)
        NAME(most_cells)(t, 6, 1, 2, 32, 16);
    else if (t->phases[0] == 2 && phases == 2 && taps == 6)
        NAME(most_cells)(t, 6, 0, 2, 32, 16);
    else if (t->columns == 32 && phases == 1 && taps == 6)
        NAME(most_cells)(t, 6, 0, 1, 32, 32);
    else if (t->columns == 32 && phases == 1 && taps == 5)
        NAME(most_cells)(t, 5, 0, 1, 32, 32);
    else
        NAME(most_cells)
    (t, taps, lead, phases, t->phases[0] * t->columns, t->columns);
}

/* --- interleaving --------------------------------------------------------- */

TARGET static void NAME(weave)(const float *const *values,
                               const float *const *weights, int phases,
                               int count, float *restrict pairs) {
    const float *restrict a = values[0], *restrict b = weights[0];
    if (phases == 1) {
        for (int n = 0; n < count; n++) {
            pairs[2 * n] = a[n];
            pairs[2 * n + 1] = b[n];
        }
        return;
    }
    const float *restrict c = values[1], *restrict d = weights[1];
    for (int n = 0; n < count; n++) {
        pairs[4 * n] = a[n];
        pairs[4 * n + 1] = b[n];
        pairs[4 * n + 2] = c[n];
        pairs[4 * n + 3] = d[n];
    }
}

static inline __attribute__((always_inline)) TARGET void
NAME(settle_pixels)(const float *restrict line, int phases, int columns,
                    int count, float *restrict pairs) {
    for (int n = 0; n < count; n++)
        for (int phase = 0; phase < phases; phase++) {
            float value = line[phase * columns + n];
            float step = value * SNOW_MAXIMUM_STEPS + MOST_WHOLE - MOST_WHOLE;
            bool there = value < SNOW_MAXIMUM_NONE;
            pairs[2 * (n * phases + phase)] =
                there ? step * (1.0f / SNOW_MAXIMUM_STEPS) : 0;
            pairs[2 * (n * phases + phase) + 1] = there ? 1 : 0;
        }
}

TARGET static void NAME(settle)(const float *line, int phases, int columns,
                                int count, float *pairs) {
    if (phases == 2 && columns == 16 && count == 16)
        NAME(settle_pixels)(line, 2, 16, 16, pairs);
    else
        NAME(settle_pixels)(line, phases, columns, count, pairs);
}

static const snow_row_fns NAME(row_fns) = {
    NAME(spread8), NAME(spread16), NAME(set),   NAME(add),
    NAME(look),    NAME(comb),     NAME(most),  NAME(hull),
    NAME(fours),   NAME(blocks),   NAME(weave), NAME(settle)};
