/* classify/sample.tmpl.h - codes to samples.  Define before including:
 *
 *   SAMPLE_CODE      C type of a code: uint8_t or uint16_t
 *   SAMPLE_CHANNELS  floats of a sample: 2 or 4
 *   SAMPLE_NAME      name of the functions: SAMPLE_NAME(plain), (shaded)
 *
 * All are undefined at the end.  A sample of four floats is one vector: 16
 * bytes in one load and one store are several times faster than a gather.
 * Whether a place holds a voxel is no branch, which the processor would guess
 * wrong at every edge of an object, but a choice between two addresses. */

static void SAMPLE_NAME(plain)(const void *codes, const uint16_t *normals,
                               uint64_t bits, int count, const float *palette,
                               const snow_gloss *gloss, float *samples) {
    static const float nothing[4];
    const SAMPLE_CODE *code = codes;
    (void)normals, (void)gloss;
    if (!(~bits << (64 - count))) {
        for (int i = 0; i < count; i++)
            memcpy(samples + i * SAMPLE_CHANNELS,
                   palette + (size_t)code[i] * SAMPLE_CHANNELS,
                   SAMPLE_CHANNELS * sizeof *samples);
        return;
    }
    for (int i = 0; i < count; i++) {
        const float *sample = palette + (size_t)*code * SAMPLE_CHANNELS;
        sample = bits & 1 ? sample : nothing;
        memcpy(samples + i * SAMPLE_CHANNELS, sample,
               SAMPLE_CHANNELS * sizeof *samples);
        code += bits & 1;
        bits >>= 1;
    }
}

static inline void SAMPLE_NAME(shade)(const float *straight, snow_gloss shine,
                                      float *sample) {
#if SAMPLE_CHANNELS == 4
    snow_scalar_vec color = snow_scalar_load(straight);
    snow_scalar_vec alpha = snow_scalar_alpha4(color);
    color =
        snow_scalar_add(snow_scalar_mul(color, snow_scalar_set1(shine.factor)),
                        snow_scalar_set1(shine.white));
    color = snow_scalar_min(color, snow_scalar_set1(1));
    color = snow_scalar_mul(color, alpha);
    color[3] = alpha[3];
    snow_scalar_store(sample, color);
#else
    float grey = straight[0] * shine.factor + shine.white;
    sample[0] = (grey < 1 ? grey : 1) * straight[1];
    sample[1] = straight[1];
#endif
}

static void SAMPLE_NAME(shaded)(const void *codes, const uint16_t *normals,
                                uint64_t bits, int count, const float *palette,
                                const snow_gloss *gloss, float *samples) {
    const SAMPLE_CODE *code = codes;
    static const float nothing[4];
    for (int i = 0; i < count; i++) {
        const float *straight = palette + (size_t)*code * SAMPLE_CHANNELS;
        straight = bits & 1 ? straight : nothing;
        SAMPLE_NAME(shade)
        (straight, gloss[*normals], samples + i * SAMPLE_CHANNELS);
        code += bits & 1;
        normals += bits & 1;
        bits >>= 1;
    }
}

#undef SAMPLE_CODE
#undef SAMPLE_CHANNELS
#undef SAMPLE_NAME
