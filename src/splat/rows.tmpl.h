/* splat/rows.tmpl.h - the loops of splat/rows.h for one level: simd/select.h's
 * words are in force.  Nothing else is to be defined. */

/* --- spreading -------------------------------------------------------------
 */

/* Entries are codes and 1 more, 0 where there is no voxel. */
static inline __attribute__((always_inline)) TARGET void
NAME(values)(const uint32_t *entries, float scale, float start, float *row) {
    for (int i = 0; i < 16; i++) {
        float value = start + scale * (float)(int32_t)(entries[i] - 1);
        row[i] = entries[i] ? value : 0;
    }
}

#define SPREAD(bits_of_code, type)                                          \
    TARGET static void NAME(spread##bits_of_code)(                          \
        const uint64_t *bits, size_t step, size_t words,                    \
        const unsigned char *codes, float scale, float start, float *row) { \
        const type *code = (const type *)(const void *)codes;               \
        for (size_t word = 0; word < words; word++, row += 64) {            \
            uint64_t left = bits[word * step];                              \
            for (int at = 0; at < 64; at += 16, left >>= 16) {              \
                uint32_t entries[16];                                       \
                V(expand##bits_of_code)                                     \
                (code, (uint32_t)(left & 0xFFFF), entries);                 \
                NAME(values)(entries, scale, start, row + at);              \
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
#define MOST(at, sum) V(store)(at, V(max)(V(load)(at), sum))

/* Vectors from n on: all of them, or those that are whole. */
#define RUN(name, action, whole)                                        \
    static inline __attribute__((always_inline)) TARGET int NAME(name)( \
        const snow_rows_job *job, int taps, int lead, int phases) {     \
        NAME(sums) s;                                                   \
        float *line = job->lines[0], *next = job->lines[1];             \
        int n = job->first, end = job->end - ((whole) ? LANES - 1 : 0); \
        NAME(take)(job, taps, lead, phases, &s);                        \
        for (; n < end; n += LANES) {                                   \
            V(vec) sum = NAME(sum_at)(&s, 0, 0, taps, n);               \
            action(line + n, sum);                                      \
            if (phases == 2) {                                          \
                V(vec) other = NAME(sum_at)(&s, 1, lead, taps, n);      \
                action(next + n, other);                                \
            }                                                           \
        }                                                               \
        return n;                                                       \
    }
RUN(set_run, SET, 0)
RUN(add_run, ADD, 0)
RUN(most_run, MOST, 1)
#undef RUN
#undef SET
#undef ADD
#undef MOST

/* The usual numbers of taps as constants. */
#define ROWS(name)                                                          \
    TARGET static int NAME(name##_all)(const snow_rows_job *job) {          \
        if (!job->lines[1])                                                 \
            return job->taps == 4 ? NAME(name##_run)(job, 4, 0, 1)          \
                                  : NAME(name##_run)(job, job->taps, 0, 1); \
        if (job->taps == 4)                                                 \
            return job->lead ? NAME(name##_run)(job, 4, 1, 2)               \
                             : NAME(name##_run)(job, 4, 0, 2);              \
        if (job->taps == 2)                                                 \
            return job->lead ? NAME(name##_run)(job, 2, 1, 2)               \
                             : NAME(name##_run)(job, 2, 0, 2);              \
        return NAME(name##_run)(job, job->taps, job->lead, 2);              \
    }
ROWS(set)
ROWS(add)
ROWS(most)
#undef ROWS

TARGET static void NAME(set)(const snow_rows_job *job) {
    NAME(set_all)(job);
}

TARGET static void NAME(add)(const snow_rows_job *job) {
    NAME(add_all)(job);
}

/* What is left at the end is done with what came before it: the larger of two
 * numbers stays so. */
TARGET static void NAME(most)(const snow_rows_job *job) {
    NAME(sums) s;
    int n = NAME(most_all)(job), phases = job->lines[1] ? 2 : 1;
    if (n >= job->end)
        return;
    int at = n - job->first >= LANES ? job->end - LANES : n;
    NAME(take)(job, job->taps, job->lead, phases, &s);
    for (int i = 0; i < phases; i++) {
        float *line = job->lines[i], last[LANES];
        V(store)(last, NAME(sum_at)(&s, i, i * job->lead, job->taps, at));
        for (int lane = 0; at + lane < job->end; lane++)
            line[at + lane] =
                last[lane] > line[at + lane] ? last[lane] : line[at + lane];
    }
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

static const snow_row_fns NAME(row_fns) = {NAME(spread8), NAME(spread16),
                                           NAME(set),     NAME(add),
                                           NAME(most),    NAME(weave)};
