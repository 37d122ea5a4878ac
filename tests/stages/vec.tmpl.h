/* tests/stages/vec.tmpl.h - operations of simd/select.h on sixteen floats, for
 * one instruction set: what they do lane by lane, pixel by pixel and entry by
 * entry does not depend on how many floats a vector holds. */

TARGET static void NAME(words)(const word_input *in, word_output *out) {
    for (int at = 0; at < 16; at += LANES) {
        V(vec) a = V(load)(in->a + at), b = V(load)(in->b + at);
        V(vec) c = V(load)(in->c + at);
        V(store)(out->lanes[ADD] + at, V(add)(a, b));
        V(store)(out->lanes[SUB] + at, V(sub)(a, b));
        V(store)(out->lanes[MUL] + at, V(mul)(a, b));
        V(store)(out->lanes[MIN] + at, V(min)(a, b));
        V(store)(out->lanes[MAX] + at, V(max)(a, b));
        V(store)(out->lanes[FMA] + at, V(fma)(a, b, c));
        V(store)(out->lanes[SET1] + at, V(set1)(in->a[3]));
        V(store)(out->lanes[ALPHA2] + at, V(alpha2)(a));
        V(store)(out->lanes[ALPHA4] + at, V(alpha4)(a));
        V(store)(out->lanes[GATHER4] + at,
                 V(gather4)(in->table, in->entries + at / 4));
        V(store)(out->lanes[GATHER2] + at,
                 V(gather2)(in->table, in->entries + at / 2));
        V(store)(out->lanes[FRACTIONS1] + at, V(fractions1)(in->places + at));
#if LANES <= 8
        V(vec) left, right;
        V(store)(out->lanes[FRACTIONS2] + at,
                 V(fractions2)(in->places + at / 2));
        V(store)(out->lanes[FRACTIONS4] + at,
                 V(fractions4)(in->places + at / 4));
        V(load_pairs2)(in->table, in->at + at / 2, &left, &right);
        V(store)(out->left2 + at, left);
        V(store)(out->right2 + at, right);
        V(load_pairs4)(in->table, in->at + at / 4, &left, &right);
        V(store)(out->left4 + at, left);
        V(store)(out->right4 + at, right);
#endif
    }
    V(vec) all[4];
    for (int n = 0; n < 4; n++)
        all[n] = V(load)(in->table + 1 + n * LANES);
    V(store)(out->sums4, V(sums4)(all));
#if LANES <= 8
    V(store)(out->sums2, V(sums2)(all));
#endif
    out->lane_count = LANES;
    out->popcount = V(popcount)(in->mask);
}
