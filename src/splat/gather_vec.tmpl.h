/* splat/gather_vec.tmpl.h - the operations of splat/gather_vec.h that AVX2 and
 * AVX-512 have alike.  Include simd/select.h first, and define; all are
 * undefined at the end:
 *
 *   M(word)     the compiler's operation: _mm256_word or _mm512_word
 *   INLINE      what begins a function
 *   PAIRS       its vector of doubles
 *   B(word)     the name of an operation of blocks of as many floats */

INLINE V(vec) V(to_floats)(V(ints) i) {
    return M(cvtepi32_ps)(i);
}

INLINE V(ints) V(to_ints)(V(vec) v) {
    return M(cvttps_epi32)(v);
}

INLINE V(ints) V(clamp)(V(ints) i, int low, int high) {
    i = M(max_epi32)(i, M(set1_epi32)(low));
    return M(min_epi32)(i, M(set1_epi32)(high));
}

INLINE V(ints) V(add_int)(V(ints) i, int n) {
    return M(add_epi32)(i, M(set1_epi32)(n));
}

INLINE V(ints) V(times)(V(ints) i, int n) {
    return M(mullo_epi32)(i, M(set1_epi32)(n));
}

INLINE V(ints) V(place)(V(ints) i, int i_step, V(ints) j, int j_step) {
    return M(add_epi32)(V(times)(i, i_step), V(times)(j, j_step));
}

INLINE void V(store_fours)(float *p, V(vec) a, V(vec) b, V(vec) c, V(vec) d) {
    PAIRS ab_low = M(castps_pd)(M(unpacklo_ps)(a, b));
    PAIRS cd_low = M(castps_pd)(M(unpacklo_ps)(c, d));
    PAIRS ab_high = M(castps_pd)(M(unpackhi_ps)(a, b));
    PAIRS cd_high = M(castps_pd)(M(unpackhi_ps)(c, d));
    V(store)(p, M(castpd_ps)(M(unpacklo_pd)(ab_low, cd_low)));
    V(store)(p + LANES, M(castpd_ps)(M(unpackhi_pd)(ab_low, cd_low)));
    V(store)(p + 2 * LANES, M(castpd_ps)(M(unpacklo_pd)(ab_high, cd_high)));
    V(store)(p + 3 * LANES, M(castpd_ps)(M(unpackhi_pd)(ab_high, cd_high)));
}

typedef V(vec) B(block);

INLINE B(block) B(load)(const float *p) {
    return V(load)(p);
}

INLINE B(block) B(scale)(float s, B(block) b) {
    return V(mul)(V(set1)(s), b);
}

INLINE B(block) B(more)(float s, B(block) b, B(block) c) {
    return V(fma)(V(set1)(s), b, c);
}

INLINE B(block) B(zero)(void) {
    return M(setzero_ps)();
}

INLINE B(block) B(fma)(B(block) a, B(block) b, B(block) c) {
    return V(fma)(a, b, c);
}

#undef M
#undef INLINE
#undef PAIRS
#undef B
