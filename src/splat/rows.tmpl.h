/* splat/rows.tmpl.h - the loops of splat/rows.h for one level: simd/select.h's
 * words are in force.  Nothing else is to be defined. */

/* --- spreading -------------------------------------------------------------
 */

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
 * ONE(name)(line, sum) is what becomes of a vector of the line. */

/* Stores are thought to change pointers and weights, so that these are copied
 * to where nothing points. */
typedef struct NAME(sums) {
    const float *rows[SNOW_TAPS_MOST + 1];
    V(vec) weights[2][SNOW_TAPS_MOST];
} NAME(sums);

static inline __attribute__((always_inline)) TARGET void
NAME(take)(const snow_rows_job *job, int taps, int lead, int phases,
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
        NAME(take)(job, taps, lead, phases, &s);                         \
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

/* The usual numbers of taps as constants. */
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

/* --- largest values --------------------------------------------------------
 */

/* Weights add up to 1, and factors make up for those that are not found, but
 * for rounding, by which a sheet may be above all of its voxels. */
#define MOST_MARGIN 1.000004f

TARGET static void NAME(block)(const float *row, int64_t count, size_t step,
                               uint16_t *blocks) {
    for (int64_t at = 0; at < count; at += SNOW_BLOCK_COLUMNS, row += 16) {
        int64_t here = count - at < 16 ? count - at : 16;
        float most = 0;
        for (int64_t n = 0; n < here; n++)
            most = row[n] > most ? row[n] : most;
        most = snow_most_step(most * MOST_MARGIN);
        *blocks = (uint16_t)(most < SNOW_MOST_STEPS ? most : SNOW_MOST_STEPS);
        blocks += step;
    }
}
#undef MOST_MARGIN

TARGET static uint64_t NAME(look)(const snow_most_look *look) {
    uint16_t most[SNOW_MOST_ROWS] = {0};
    float bound[SNOW_MOST_ROWS + 16], reached[SNOW_MOST_CELLS + 16];
    uint64_t cells = 0;
    for (int n = 0; n < look->block_count; n++) {
        const uint16_t *blocks = look->blocks[n];
        for (int row = look->first; row < look->end; row++)
            most[row] = blocks[row] > most[row] ? blocks[row] : most[row];
    }
    for (int row = 0; row < SNOW_MOST_ROWS; row++)
        bound[row] = most[row];
    for (int cell = 0; cell < look->cells; cell += LANES) {
        const float *rows = bound + cell;
        V(vec) high;
        if (look->stride == 1) {
            high = V(load)(rows);
            for (int m = 1; m < look->reach; m++)
                high = V(max)(high, V(load)(rows + m));
        } else {
            for (int i = 0; i < LANES && cell + i < look->cells; i++) {
                float here = 0;
                for (int m = 0; m < look->reach; m++) {
                    float next = bound[(cell + i) * look->stride + m];
                    here = next > here ? next : here;
                }
                reached[i] = here;
            }
            high = V(load)(reached);
        }
        cells |= (uint64_t)V(less)(V(load)(look->least + cell), high) << cell;
    }
    return cells & (~UINT64_C(0) >> (64 - look->cells));
}

/* Windows as floats. */
#define WINDOWS(bits_of_code, type)                                            \
    TARGET static void NAME(windows##bits_of_code)(const snow_most_tile *t) {  \
        const float scale = t->scale, start = t->start;                        \
        const int window = t->window;                                          \
        for (uint64_t held = t->held; held; held &= held - 1) {                \
            int row = __builtin_ctzll(held);                                   \
            const type *code =                                                 \
                (const type *)(const void *)t->codes[row] + t->before[row];    \
            float *samples = t->samples + row * SNOW_MOST_WINDOW;              \
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
NAME(comb_rows)(const snow_most_tile *t, int taps, int lead, int phases,
                int columns) {
    V(vec) weights[2][SNOW_TAPS_MOST];
    for (int phase = 0; phase < phases; phase++)
        for (int m = 0; m < taps; m++)
            weights[phase][m] = V(set1)(t->weights[0][phase][m]);
    for (uint64_t held = t->held; held; held &= held - 1) {
        int row = __builtin_ctzll(held);
        const float *samples = t->samples + row * SNOW_MOST_WINDOW;
        float *pixels = t->ring + row * SNOW_MOST_LINE;
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

/* Several voxels a pixel. */
TARGET static void NAME(comb_strided)(const snow_most_tile *t) {
    for (uint64_t held = t->held; held; held &= held - 1) {
        int row = __builtin_ctzll(held);
        const float *sample = t->samples + row * SNOW_MOST_WINDOW;
        float *pixels = t->ring + row * SNOW_MOST_LINE;
        for (int n = 0; n < t->columns; n++, sample += t->stride[0]) {
            float sum = t->weights[0][0][0] * sample[0];
            for (int m = 1; m < t->taps[0]; m++)
                sum += t->weights[0][0][m] * sample[m];
            pixels[n] = sum;
        }
    }
}

TARGET static void NAME(comb)(const snow_most_tile *t) {
    int lead = t->lead[0];
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
    else
        NAME(comb_rows)(t, t->taps[0], lead, 2, 16);
}

/* Both lines of a cell share their rows, but for the lead. */
static inline __attribute__((always_inline)) TARGET void
NAME(most_cell)(const snow_most_tile *t, const float *const *rows, int cell,
                int taps, int lead, int phases, int width,
                const V(vec) (*weights)[SNOW_TAPS_MOST]) {
    float *line = t->lines + cell * phases * SNOW_MOST_LINE;
    V(vec) least = V(set1)(2);
    for (int at = 0; at < width; at += LANES) {
        V(vec) sums[2];
        for (int phase = 0; phase < phases; phase++) {
            const float *const *first = rows + phase * lead;
            sums[phase] = V(mul)(weights[phase][0], V(load)(first[0] + at));
            for (int m = 1; m < taps; m++)
                sums[phase] = V(fma)(weights[phase][m], V(load)(first[m] + at),
                                     sums[phase]);
        }
        for (int phase = 0; phase < phases; phase++) {
            float *pixels = line + phase * SNOW_MOST_LINE + at;
            if (t->factors)
                sums[phase] =
                    V(mul)(sums[phase],
                           V(load)(t->factors + phase * SNOW_MOST_LINE + at));
            sums[phase] = V(max)(sums[phase], V(load)(pixels));
            V(store)(pixels, sums[phase]);
            least = V(min)(least, sums[phase]);
        }
    }
    t->least[cell] = snow_most_step(V(least)(least));
}

static inline __attribute__((always_inline)) TARGET void
NAME(most_cells)(const snow_most_tile *t, int taps, int lead, int phases,
                 int width) {
    V(vec) weights[2][SNOW_TAPS_MOST];
    const float *rows[SNOW_TAPS_MOST + 1];
    for (int phase = 0; phase < phases; phase++)
        for (int m = 0; m < taps; m++)
            weights[phase][m] = V(set1)(t->weights[1][phase][m]);
    for (uint64_t left = t->cells; left; left &= left - 1) {
        int cell = __builtin_ctzll(left), row = cell * t->stride[1];
        for (int m = 0; m < taps + lead; m++)
            rows[m] = t->held >> (row + m) & 1
                          ? t->ring + (row + m) * SNOW_MOST_LINE
                          : t->zero;
        NAME(most_cell)
        (t, rows, cell, taps, lead, phases, width,
         (const V(vec)(*)[SNOW_TAPS_MOST])weights);
    }
}

TARGET static void NAME(most)(const snow_most_tile *t) {
    int taps = t->taps[1], lead = t->lead[1], phases = t->phases[1];
    if (t->phases[0] == 2 && phases == 2 && taps == 4 && lead)
        NAME(most_cells)(t, 4, 1, 2, SNOW_MOST_LINE);
    else if (t->phases[0] == 2 && phases == 2 && taps == 4)
        NAME(most_cells)(t, 4, 0, 2, SNOW_MOST_LINE);
    else if (t->columns == 32 && phases == 1 && taps == 6)
        NAME(most_cells)(t, 6, 0, 1, 32);
    else if (t->columns == 32 && phases == 1 && taps == 5)
        NAME(most_cells)(t, 5, 0, 1, 32);
    else
        NAME(most_cells)
    (t, taps, lead, phases, t->phases[0] * t->columns);
}

/* --- weaving ---------------------------------------------------------------
 */

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

static const snow_row_fns NAME(row_fns) = {
    NAME(spread8), NAME(spread16), NAME(set),   NAME(add),  NAME(look),
    NAME(comb),    NAME(most),     NAME(block), NAME(weave)};
