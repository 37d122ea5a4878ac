/* classify/shear_warp/entries.tmpl.h - the steps of ENTRIES entries of a table,
 * composited for one instruction set, LANES / 4 of them in a vector.  Include
 * simd/select.h first.  No sum is fused, so all have the same bits. */

/* Vectors that are made at once, so that their steps need not wait. */
#define GROUPS 4
#define EACH (LANES / 4)

/* Entries from `first` on, GROUPS x EACH of them. */
TARGET static inline void NAME(collect)(const snow_value_table *table,
                                        int steps, entry_ways *ways,
                                        int first) {
    V(vec) through[GROUPS], places[GROUPS], sum[GROUPS];
    int64_t *at = ways->at + first;
    for (int k = 0; k < GROUPS; k++) {
        through[k] = V(set1)(1);
        sum[k] = places[k] = V(set1)(0);
    }
    for (int n = 0; n < steps; n++) {
        uint32_t looks[GROUPS * EACH];
        for (int w = 0; w < GROUPS * EACH; w++) {
            looks[w] = (uint32_t)(at[w] >> 16);
            at[w] += ways->apart[first + w];
        }
        for (int k = 0; k < GROUPS; k++) {
            V(vec) here =
                V(mul)(V(gather4)(table->looks, looks + k * EACH), through[k]);
            sum[k] = V(add)(sum[k], here);
            places[k] =
                V(add)(places[k], V(mul)(here, V(set1)((float)n + 0.5F)));
            through[k] = V(sub)(through[k], V(alpha4)(here));
        }
    }
    for (int k = 0; k < GROUPS; k++) {
        V(store)(ways->sum[first + k * EACH], sum[k]);
        V(store)(ways->places[first + k * EACH], places[k]);
    }
}

TARGET static void NAME(collect_all)(const snow_value_table *table, int steps,
                                     entry_ways *ways) {
    for (int first = 0; first < ENTRIES; first += GROUPS * EACH)
        NAME(collect)(table, steps, ways, first);
}

/* Entries (front + w, front + apart + w) for w of 0 .. ENTRIES - 1, where nodes
 * are evenly placed: step n of the first is at look 2 steps front + apart (2 n
 * + 1), and those of the others are beside it in the planes.  `steps` is a
 * power of 2. */
TARGET static void NAME(collect_diagonal)(const snow_value_table *table,
                                          int steps, int front, int apart,
                                          float sums[5][ENTRIES]) {
    const int rows = 2 * steps, pitch = table->plane_pitch;
    const int bits = __builtin_ctz((unsigned)rows);
    for (int first = 0; first < ENTRIES; first += LANES) {
        V(vec) sum[5], through = V(set1)(1);
        for (int c = 0; c < 5; c++)
            sum[c] = V(set1)(0);
        for (int n = 0; n < steps; n++) {
            int on = apart * (2 * n + 1) + rows * SNOW_VALUE_PITCH;
            const float *at = table->planes + (on & (rows - 1)) * pitch +
                              ENTRIES + front + first + (on >> bits) -
                              SNOW_VALUE_PITCH;
            V(vec) here;
            for (int c = 0; c < 4; c++, at += rows * pitch) {
                here = V(mul)(V(load)(at), through);
                sum[c] = V(add)(sum[c], here);
            }
            sum[4] = V(add)(sum[4], V(mul)(here, V(set1)((float)n + 0.5F)));
            through = V(sub)(through, here);
        }
        for (int c = 0; c < 5; c++)
            V(store)(sums[c] + first, sum[c]);
    }
}

/* Entries of such sums: a word for each channel, whose bit 15 is one of the
 * place's. */
TARGET static void NAME(pack)(float sums[5][ENTRIES], float steps, float full,
                              bool placed, uint64_t out[ENTRIES]) {
    uint32_t words[4][ENTRIES], sixteenths[ENTRIES];
    for (int w = 0; w < ENTRIES; w++) {
        float alpha = sums[3][w] > 0 ? sums[3][w] : 1;
        float place = sums[4][w] / (steps * alpha) * 16;
        sixteenths[w] = (uint32_t)(int)(place < 15 ? place : 15);
    }
    for (int c = 0; c < 4; c++)
        for (int w = 0; w < ENTRIES; w++) {
            int word = (int)(sums[c][w] * full + 0.5F);
            word = word > 32767 ? 32767 : word;
            words[c][w] =
                (uint32_t)word | (placed ? (sixteenths[w] >> c & 1) << 15 : 0);
        }
    for (int w = 0; w < ENTRIES; w++) {
        uint64_t seen = (words[3][w] & 0x7fff) ? ~UINT64_C(0) : 0;
        out[w] = seen & (words[0][w] | words[1][w] << 16 |
                         (uint64_t)(words[2][w] | words[3][w] << 16) << 32);
    }
}

#undef GROUPS
#undef EACH
