/* classify/values/entries.tmpl.h - the steps of ENTRIES entries of a table,
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
            V(vec)
            here =
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

#undef GROUPS
#undef EACH
