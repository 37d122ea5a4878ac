/* tests/reference/shear_warp_operations.tmpl.h - every word of simd/select.h on
 * sixteen floats, for one level: what words do lane by lane, pixel by pixel and
 * entry by entry does not depend on how many floats a vector holds. */

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
        V(store)(out->lanes[FNMA] + at, V(fnma)(a, b, c));
        V(store)(out->lanes[SET1] + at, V(set1)(in->a[3]));
        V(store)(out->lanes[ALPHA2] + at, V(alpha2)(a));
        V(store)(out->lanes[ALPHA4] + at, V(alpha4)(a));
        V(store)(out->lanes[WITH_ALPHA2] + at, V(with_alpha2)(a, b));
        V(store)(out->lanes[WITH_ALPHA4] + at, V(with_alpha4)(a, b));
        V(store)
        (out->lanes[GATHER4] + at, V(gather4)(in->table, in->entries + at / 4));
        V(store)
        (out->lanes[GATHER2] + at, V(gather2)(in->table, in->entries + at / 2));
        V(interleave2)(a, b, out->interleave2 + 2 * at);
        V(interleave4)(a, b, out->interleave4 + 2 * at);
        out->less[at / LANES] = V(any_less)(a, b) != 0;
        snow_scalar_store(out->hadd2[at / LANES], V(hadd2)(a));
        snow_scalar_store(out->hadd4[at / LANES], V(hadd4)(a));
    }
    out->lane_count = LANES;
    V(expand8)(in->bytes, in->bits, out->expand8);
    V(expand16)(in->shorts, in->bits, out->expand16);
    V(pairs16)(in->pairs, in->entries, out->low, out->high);
    V(widen8)(in->bytes, out->widen8);
    V(widen16)(in->shorts, out->widen16);
    V(spread2)(in->table, in->bits, 16, out->spread2);
    V(spread4)(in->table, in->bits, 16, out->spread4);
    out->found =
        V(windows)(in->low, in->high, in->shift, in->within, out->windows);
    for (int at = 0; at < 16; at += LANES) {
        V(vec) left, right;
        V(load_pairs2)(in->table, in->at + at / 2, &left, &right);
        V(store)(out->left2 + at, left);
        V(store)(out->right2 + at, right);
        V(load_pairs4)(in->table, in->at + at / 4, &left, &right);
        V(store)(out->left4 + at, left);
        V(store)(out->right4 + at, right);
    }
    out->popcount = V(popcount)(in->mask);
    for (int at = 0; at < 16; at += LANES) {
        uint64_t least = V(least4)(V(load)(in->whole + at));
        memcpy(out->least + at / 4, &least, LANES / 4 * sizeof *out->least);
    }
    out->above = V(above32)(in->shorts, in->others);
    V(transpose64)(in->many, out->turned);
}
