/* composite/over.tmpl.h - "over" for a run of pixels, for one instruction set.
 * Include simd/select.h first; nothing else needs to be defined.
 *
 * Each float is the same product and sum as in over_grey_scalar and
 * over_rgba_scalar, which also process the rest of a run: no bit depends on the
 * instruction set. */

static TARGET void NAME(over_grey)(float *front, const float *back,
                                   size_t count) {
    const V(vec) one = V(set1)(1);
    size_t n = 0;
    for (; n + LANES / 2 <= count; n += LANES / 2) {
        V(vec) f = V(load)(front + 2 * n);
        V(vec) left = V(sub)(one, V(alpha2)(f));
        V(store)(front + 2 * n, V(add)(f, V(mul)(left, V(load)(back + 2 * n))));
    }
    over_grey_scalar(front + 2 * n, back + 2 * n, count - n);
}

static TARGET void NAME(over_rgba)(float *front, const float *back,
                                   size_t count) {
    const V(vec) one = V(set1)(1);
    size_t n = 0;
    for (; n + LANES / 4 <= count; n += LANES / 4) {
        V(vec) f = V(load)(front + 4 * n);
        V(vec) left = V(sub)(one, V(alpha4)(f));
        V(store)(front + 4 * n, V(add)(f, V(mul)(left, V(load)(back + 4 * n))));
    }
    over_rgba_scalar(front + 4 * n, back + 4 * n, count - n);
}
