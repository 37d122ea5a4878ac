/* classify/sample.tmpl.h - codes to samples.  Define before including:
 *
 *   SAMPLE_CODE      C type of a code: uint8_t or uint16_t
 *   SAMPLE_CHANNELS  floats of a sample: 2 or 4
 *   SAMPLE_NAME      name of the functions: SAMPLE_NAME(plain), (shaded)
 *
 * All are undefined at the end.  A sample of four floats is one vector: 16
 * bytes in one load and one store are several times faster than a gather. */

static void SAMPLE_NAME(plain)(const void *codes, const uint16_t *normals,
                               size_t count, const float *palette,
                               const snow_gloss *gloss, float *samples) {
    const SAMPLE_CODE *code = codes;
    (void)normals, (void)gloss;
    for (size_t i = 0; i < count; i++)
        memcpy(samples + i * SAMPLE_CHANNELS,
               palette + (size_t)code[i] * SAMPLE_CHANNELS,
               SAMPLE_CHANNELS * sizeof *samples);
}

static void SAMPLE_NAME(shaded)(const void *codes, const uint16_t *normals,
                                size_t count, const float *palette,
                                const snow_gloss *gloss, float *samples) {
    const SAMPLE_CODE *code = codes;
    for (size_t i = 0; i < count; i++) {
        const float *straight = palette + (size_t)code[i] * SAMPLE_CHANNELS;
        snow_gloss shine = gloss[normals[i]];
        float *sample = samples + i * SAMPLE_CHANNELS;
#if SAMPLE_CHANNELS == 4
        snow_scalar_vec color = snow_scalar_load(straight);
        snow_scalar_vec alpha = snow_scalar_alpha4(color);
        color = snow_scalar_add(
            snow_scalar_mul(color, snow_scalar_set1(shine.factor)),
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
}

#undef SAMPLE_CODE
#undef SAMPLE_CHANNELS
#undef SAMPLE_NAME
