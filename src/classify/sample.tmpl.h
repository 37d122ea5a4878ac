/* classify/sample.tmpl.h - codes to samples.  Define before including, with
 * simd/select.h's words in force:
 *
 *   SAMPLE_CODE      C type of a code: uint8_t or uint16_t
 *   SAMPLE_EXPAND    V(expand8) or V(expand16), as the code
 *   SAMPLE_CHANNELS  floats of a sample: 2 or 4
 *   SAMPLE_GATHER, SAMPLE_SHINE, SAMPLE_ALPHA, SAMPLE_WITH_ALPHA
 *                    V(gather2), V(gather2), V(alpha2), V(with_alpha2), or
 *                    V(gather4), V(double2), V(alpha4), V(with_alpha4), as the
 *                    channels
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
    uint32_t entry[SNOW_WINDOW_MOST + 17];
    const SAMPLE_CODE *code = codes;
    (void)normals, (void)gloss;
    for (int at = 0; at < count; at += 16) {
        uint32_t here = (uint32_t)(bits >> at) & 0xFFFF;
        SAMPLE_EXPAND(code, here, entry + at);
        code += V(popcount)(here);
    }
    /* Four at a time, past the end: entries there are 0. */
    for (int i = 0; i < count; i += 4)
        for (int n = i; n < i + 4; n++)
            memcpy(samples + n * SAMPLE_CHANNELS,
                   entries + (size_t)entry[n] * SAMPLE_CHANNELS,
                   SAMPLE_CHANNELS * sizeof *samples);
}

TARGET static void SAMPLE_NAME(shaded)(const void *codes,
                                       const uint16_t *normals, uint64_t bits,
                                       int count, const float *palette,
                                       const snow_gloss *gloss,
                                       float *samples) {
    const float *entries = palette - SAMPLE_CHANNELS;
    const float *shines = (const float *)(const void *)(gloss - 1);
    uint32_t entry[SNOW_WINDOW_MOST + 17], normal[SNOW_WINDOW_MOST + 17];
    const SAMPLE_CODE *code = codes;
    for (int at = 0; at < count; at += 16) {
        uint32_t here = (uint32_t)(bits >> at) & 0xFFFF;
        SAMPLE_EXPAND(code, here, entry + at);
        V(expand16)(normals, here, normal + at);
        code += V(popcount)(here);
        normals += V(popcount)(here);
    }
    for (int i = 0; i < count; i += LANES / SAMPLE_CHANNELS) {
        V(vec) straight = SAMPLE_GATHER(entries, entry + i);
        V(vec) shine = SAMPLE_SHINE(shines, normal + i);
        V(vec) color = V(fma)(straight, V(even)(shine), V(odd)(shine));
        color = V(mul)(V(min)(color, V(set1)(1)), SAMPLE_ALPHA(straight));
        V(store)
        (samples + i * SAMPLE_CHANNELS, SAMPLE_WITH_ALPHA(color, straight));
    }
}

#undef SAMPLE_CODE
#undef SAMPLE_EXPAND
#undef SAMPLE_CHANNELS
#undef SAMPLE_NAME
#undef SAMPLE_GATHER
#undef SAMPLE_SHINE
#undef SAMPLE_ALPHA
#undef SAMPLE_WITH_ALPHA
