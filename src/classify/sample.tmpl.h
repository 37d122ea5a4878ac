/* classify/sample.tmpl.h - codes to samples.  Define before including, with
 * simd/select.h's words in force:
 *
 *   SAMPLE_CODE      C type of a code: uint8_t or uint16_t
 *   SAMPLE_EXPAND    V(expand8) or V(expand16), as the code
 *   SAMPLE_CHANNELS  floats of a sample: 2 or 4
 *   SAMPLE_NAME      name of the functions: SAMPLE_NAME(plain), (shaded)
 *
 * All are undefined at the end.  Which places hold a voxel decides no branch,
 * which the processor would guess wrong at every edge of an object: places
 * without one have entry 0 of the palette, its zeros.  A sample of four floats
 * is one vector: 16 bytes in one load and one store are several times faster
 * than a gather. */

TARGET static void SAMPLE_NAME(plain)(const void *codes,
                                      const uint16_t *normals, uint64_t bits,
                                      int count, const float *palette,
                                      const snow_gloss *gloss, float *samples) {
    const float *entries = palette - SAMPLE_CHANNELS;
    uint32_t entry[SNOW_WINDOW_MOST + 1];
    const SAMPLE_CODE *code = codes;
    (void)normals, (void)gloss;
    for (int at = 0; at < count; at += 16) {
        uint32_t here = (uint32_t)(bits >> at) & 0xFFFF;
        SAMPLE_EXPAND(code, here, entry + at);
        code += V(popcount)(here);
    }
    for (int i = 0; i < count; i++)
        memcpy(samples + i * SAMPLE_CHANNELS,
               entries + (size_t)entry[i] * SAMPLE_CHANNELS,
               SAMPLE_CHANNELS * sizeof *samples);
}

TARGET static inline __attribute__((always_inline)) void
SAMPLE_NAME(shade)(const float *straight, const snow_gloss *shine,
                   float *sample) {
#if SAMPLE_CHANNELS == 4
    snow_scalar_vec color = snow_scalar_load(straight);
    snow_scalar_vec alpha = snow_scalar_alpha4(color);
    snow_scalar_vec factor = snow_scalar_set1(shine->factor);
    snow_scalar_vec white = snow_scalar_set1(shine->white);
    color = snow_scalar_add(snow_scalar_mul(color, factor), white);
    color = snow_scalar_min(color, snow_scalar_set1(1));
    color = snow_scalar_mul(color, alpha);
    color[3] = alpha[3];
    snow_scalar_store(sample, color);
#else
    float grey = straight[0] * shine->factor + shine->white;
    sample[0] = (grey < 1 ? grey : 1) * straight[1];
    sample[1] = straight[1];
#endif
}

TARGET static void SAMPLE_NAME(shaded)(const void *codes,
                                       const uint16_t *normals, uint64_t bits,
                                       int count, const float *palette,
                                       const snow_gloss *gloss,
                                       float *samples) {
    const float *entries = palette - SAMPLE_CHANNELS;
    uint32_t entry[SNOW_WINDOW_MOST + 1], normal[SNOW_WINDOW_MOST + 1];
    const SAMPLE_CODE *code = codes;
    for (int at = 0; at < count; at += 16) {
        uint32_t here = (uint32_t)(bits >> at) & 0xFFFF;
        SAMPLE_EXPAND(code, here, entry + at);
        V(expand16)(normals, here, normal + at);
        code += V(popcount)(here);
        normals += V(popcount)(here);
    }
    /* An expanded number is one more than the code, and 0 for none. */
    for (int i = 0; i < count; i++)
        SAMPLE_NAME(shade)
        (entries + (size_t)entry[i] * SAMPLE_CHANNELS,
         gloss + (normal[i] ? normal[i] - 1 : 0),
         samples + i * SAMPLE_CHANNELS);
}

#undef SAMPLE_CODE
#undef SAMPLE_EXPAND
#undef SAMPLE_CHANNELS
#undef SAMPLE_NAME
