/* simd/vec_avx.tmpl.h - the vector operations that AVX2 and AVX-512 have alike.
 * simd/select.h describes them.  Define before including; all are undefined at
 * the end:
 *
 *   V(word)  the name of an operation
 *   M(word)  that of the compiler's: _mm256_word or _mm512_word
 *   INLINE   what begins a function */

INLINE V(vec) V(load)(const float *p) {
    return M(loadu_ps)(p);
}

INLINE void V(store)(float *p, V(vec) v) {
    M(storeu_ps)(p, v);
}

INLINE V(vec) V(set1)(float x) {
    return M(set1_ps)(x);
}

INLINE V(vec) V(add)(V(vec) a, V(vec) b) {
    return M(add_ps)(a, b);
}

INLINE V(vec) V(sub)(V(vec) a, V(vec) b) {
    return M(sub_ps)(a, b);
}

INLINE V(vec) V(mul)(V(vec) a, V(vec) b) {
    return M(mul_ps)(a, b);
}

INLINE V(vec) V(min)(V(vec) a, V(vec) b) {
    return M(min_ps)(a, b);
}

INLINE V(vec) V(max)(V(vec) a, V(vec) b) {
    return M(max_ps)(a, b);
}

INLINE V(vec) V(fma)(V(vec) a, V(vec) b, V(vec) c) {
    return M(fmadd_ps)(a, b, c);
}

INLINE V(vec) V(sqrt)(V(vec) v) {
    return M(sqrt_ps)(v);
}

INLINE V(vec) V(alpha2)(V(vec) v) {
    return M(permute_ps)(v, 0xF5);
}

INLINE V(vec) V(alpha4)(V(vec) v) {
    return M(permute_ps)(v, 0xFF);
}

INLINE V(wide) V(low_times)(V(wide) a, V(wide) b) {
    return (V(wide))M(mul_epu32)((V(int))a, (V(int))b);
}

/* The upper 24 of the 32 bits of each lane, as a fraction. */
INLINE V(vec) V(fraction)(V(int) v) {
    return M(mul_ps)(M(cvtepi32_ps)(M(srli_epi32)(v, 8)), M(set1_ps)(0x1p-24f));
}

INLINE int V(popcount)(uint64_t x) {
    return __builtin_popcountll(x);
}

#undef V
#undef M
#undef INLINE
