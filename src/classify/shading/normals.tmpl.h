/* classify/shading/normals.tmpl.h - normals of a block of voxels, in loops that
 * the compiler vectorizes, for one instruction set. Include simd/select.h
 * first. The including file has SUBTRACTIONS, `normal_kernels` and UNSURE. No
 * sum is fused or reordered, so all instruction sets give the same bits.
 *
 * NAME(differences_TYPE) subtracts `count` neighbours of that scalar type:
 *
 *   out[i] = (high[i] - low[i]) * weight
 *
 * NAME(add) adds to an array of such differences.
 *
 * NAME(encode) takes three such arrays as gradients along u, v and w,
 * transforms them to world space and writes codes. Where single precision does
 * not give the direction it writes UNSURE; it returns whether it wrote any.
 *
 * `count` is a multiple of 16. */

#define DIFFERENCES(name, type, as, subtract)                               \
    TARGET static void NAME(differences_##name)(                            \
        const void *low, const void *high, size_t count, float weight,      \
        float *restrict out) {                                              \
        const type *a = low, *b = high;                                     \
        for (size_t n = 0; n < count; n += GROUP)                           \
            for (size_t i = 0; i < GROUP; i++)                              \
                out[n + i] = subtract((as)b[n + i], (as)a[n + i]) * weight; \
    }

SUBTRACTIONS(DIFFERENCES)
#undef DIFFERENCES

/* A sum that cancels becomes LEAST, because differences that were raised to
 * LEAST would vanish too. */
TARGET static void NAME(add)(const float *more, size_t count,
                             float *restrict out) {
    for (size_t n = 0; n < count; n += GROUP)
        for (size_t i = 0; i < GROUP; i++) {
            float sum = out[n + i] + more[n + i];
            float least = more[n + i] == 0 ? 0 : LEAST;
            out[n + i] = sum == 0 ? least : sum;
        }
}

TARGET static bool NAME(encode)(const float carry[9], float gradients[3][BLOCK],
                                size_t count, uint32_t *restrict codes) {
    const float *gu = gradients[0], *gv = gradients[1], *gw = gradients[2];
    int unsure[GROUP] = {0}, any = 0;
    for (size_t n = 0; n < count; n += GROUP)
        for (size_t i = 0; i < GROUP; i++) {
            float u = gu[n + i], v = gv[n + i], w = gw[n + i];
            float x = carry[0] * u + carry[1] * v + carry[2] * w;
            float y = carry[3] * u + carry[4] * v + carry[5] * w;
            float z = carry[6] * u + carry[7] * v + carry[8] * w;
            float sum = fabsf(x) + fabsf(y) + fabsf(z);
            int sure = (sum > SUM_LEAST) & (sum < SUM_MOST);
            float scale = copysignf(MIDDLE, z) / (sure ? sum : 1);
            float across = sure ? (x + y) * scale : 0;
            float down = sure ? (x - y) * scale : 0;
            int place = (int)(down + (MIDDLE + 0.5F)) * SIDE +
                        (int)(across + (MIDDLE + 0.5F)) + 1;
            unsure[i] |= !sure & (sum != 0);
            int other = sum == 0 ? SNOW_NO_NORMAL : UNSURE;
            codes[n + i] = (uint32_t)(sure ? place : other);
        }
    for (size_t i = 0; i < GROUP; i++)
        any |= unsure[i];
    return any != 0;
}

static const normal_kernels NAME(kernels) = {
    .differences =
        {
#define ENTRY(name, type, text) [SNOW_TYPE_##name] = NAME(differences_##name),
            SNOW_TYPE_MAP(ENTRY)
#undef ENTRY
        },
    .add = NAME(add),
    .encode = NAME(encode),
};
