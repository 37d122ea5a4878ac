/* classify/normals.tmpl.h - normals of a block of neighbouring voxels, in
 * loops that the compiler carries to vectors.  For one level of simd/select.h,
 * which is to be included before.  No sum is fused or reordered, so all levels
 * make the same bits.
 *
 * NAME(differences)[type] subtracts, for `count` neighbours:
 *
 *   out[i] = high[i] - low[i]      of the scalar type, as a float
 *
 * NAME(encode) takes three such arrays as gradients, `carry` them to the world
 * and writes codes.  UNSURE stands where single precision could not tell.
 * `count` is a multiple of 16. */

#define DIFFERENCES(name, type, wide)                                  \
    TARGET static void NAME(differences_##name)(                       \
        const void *low, const void *high, size_t count, float *out) { \
        const type *a = low, *b = high;                                \
        for (size_t i = 0; i < count; i++)                             \
            out[i] = (float)((wide)b[i] - (wide)a[i]);                 \
    }

DIFFERENCES(int8, int8_t, int)
DIFFERENCES(uint8, uint8_t, int)
DIFFERENCES(int16, int16_t, int)
DIFFERENCES(uint16, uint16_t, int)
DIFFERENCES(int32, int32_t, double)
DIFFERENCES(uint32, uint32_t, double)
DIFFERENCES(int64, int64_t, double)
DIFFERENCES(uint64, uint64_t, double)
DIFFERENCES(float32, float, float)

#undef DIFFERENCES

/* A difference of doubles that is too small for a float becomes one that is
 * small, not 0: NAME(encode) then knows that it was not. */
TARGET static void NAME(differences_float64)(const void *low, const void *high,
                                             size_t count, float *out) {
    const double *a = low, *b = high;
    for (size_t i = 0; i < count; i++) {
        double d = b[i] - a[i];
        double bounded = fabs(d) < 1e38 ? d : 1e38;
        out[i] = fabs(d) > 0 && fabs(d) < 1e-38 ? 1e-38F : (float)bounded;
    }
}

TARGET static void NAME(encode)(const float carry[3][3],
                                const float *const gradients[3], size_t count,
                                uint16_t *codes) {
    const float *gu = gradients[0], *gv = gradients[1], *gw = gradients[2];
    for (size_t i = 0; i < count; i++) {
        float x =
            carry[0][0] * gu[i] + carry[0][1] * gv[i] + carry[0][2] * gw[i];
        float y =
            carry[1][0] * gu[i] + carry[1][1] * gv[i] + carry[1][2] * gw[i];
        float z =
            carry[2][0] * gu[i] + carry[2][1] * gv[i] + carry[2][2] * gw[i];
        float sum = fabsf(x) + fabsf(y) + fabsf(z);
        int none = fabsf(gu[i]) + fabsf(gv[i]) + fabsf(gw[i]) == 0;
        int sure = (sum > 1e-30F) & (sum < 1e30F);
        float scale = copysignf(127, z) / (sure ? sum : 1);
        float across = sure ? (x + y) * scale : 0;
        float down = sure ? (x - y) * scale : 0;
        int place = (int)(down + 127.5F) * 255 + (int)(across + 127.5F) + 1;
        codes[i] = (uint16_t)(none ? SNOW_NO_NORMAL : sure ? place : UNSURE);
    }
}

static const normal_kernels NAME(kernels) = {
    .differences =
        {
            [SNOW_INT8] = NAME(differences_int8),
            [SNOW_UINT8] = NAME(differences_uint8),
            [SNOW_INT16] = NAME(differences_int16),
            [SNOW_UINT16] = NAME(differences_uint16),
            [SNOW_INT32] = NAME(differences_int32),
            [SNOW_UINT32] = NAME(differences_uint32),
            [SNOW_INT64] = NAME(differences_int64),
            [SNOW_UINT64] = NAME(differences_uint64),
            [SNOW_FLOAT32] = NAME(differences_float32),
            [SNOW_FLOAT64] = NAME(differences_float64),
        },
    .encode = NAME(encode),
};
