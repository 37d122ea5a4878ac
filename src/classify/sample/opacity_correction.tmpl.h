/* classify/sample/opacity_correction.tmpl.h - codes to samples, each with its
 * own exponent, for one variant. Define before including, besides the macros of
 * classify/sample/opacity_correction_kinds.tmpl.h:
 *
 *   RAY_SHADED            whether normals and gloss are used: 0 or 1
 *   RAY_GRADIENT_OPACITY  whether factors are used: 0 or 1
 *   RAY_KIND              name of the variant
 *
 * These three are undefined at the end. */
TARGET static void
RAY_NAME(RAY_KIND)(const void *codes, const uint16_t *normals,
                   const uint16_t *gradient_factors, uint64_t bits, int count,
                   const float *palette, const snow_gloss *gloss,
                   const float square[3], float *samples) {
    const float *entries = palette - RAY_CHANNELS;
    uint32_t entry[SNOW_WINDOW_MOST + 17];
    float exponents[SNOW_WINDOW_MOST + 33];
    const RAY_CODE *code = codes;
#if RAY_SHADED
    float factors[SNOW_WINDOW_MOST + 33], whites[SNOW_WINDOW_MOST + 33];
#else
    (void)normals, (void)gloss;
#endif
#if RAY_GRADIENT_OPACITY
    float opacities[SNOW_WINDOW_MOST + 33];
    uint32_t fade[SNOW_WINDOW_MOST + 17];
#else
    (void)gradient_factors;
#endif
    for (int at = 0; at < count; at += 16) {
        uint32_t here = (uint32_t)(bits >> at) & 0xFFFF;
        RAY_EXPAND(code, here, entry + at);
        code += V(popcount)(here);
#if RAY_GRADIENT_OPACITY
        V(expand16)
        (gradient_factors, here, fade + at); /* one more than the code */
        gradient_factors += V(popcount)(here);
#endif
#if RAY_SHADED
        uint32_t normal[16];
        V(expand16)(normals, here, normal);
        V(pairs16)(gloss - 1, normal, factors + at, whites + at);
        normals += V(popcount)(here);
#endif
    }
    /* Up to a multiple of 16, the number of factors handled at once. */
    for (int at = 0;
         at < (RAY_GRADIENT_OPACITY ? (count + 15) / 16 * 16 : count);
         at += LANES) {
        V(vec) x = V(load)(ray_places + at);
        V(vec) sum = V(fma)(V(set1)(square[2]), x, V(set1)(square[1]));
        V(store)(exponents + at, V(sqrt)(V(fma)(sum, x, V(set1)(square[0]))));
    }
#if RAY_GRADIENT_OPACITY
    /* In a loop of its own: a vector load would wait for floats just stored. */
    int all = (count + 15) / 16 * 16;
    for (int i = 0; i < all; i++)
        fade[i] -= fade[i] != 0;
    for (int i = 0; i < all; i++)
        opacities[i] = entries[entry[i] * RAY_CHANNELS + RAY_CHANNELS - 1];
    for (int at = 0; at < all; at += 16)
        NAME(fade16)(fade + at, exponents + at, opacities + at);
#else
    const V(vec) round = V(set1)(0x1.8p23f);
#endif
    const V(places) spread = VC(repeat, RAY_CHANNELS)();
    const V(vec) one = V(set1)(1);
    (void)one;
    for (int i = 0; i < count; i += LANES / RAY_CHANNELS) {
        V(vec) straight = VC(gather, RAY_CHANNELS)(entries, entry + i);
#if RAY_GRADIENT_OPACITY
        V(vec) alpha = V(pick)(opacities + i, spread);
#else
        V(vec)
        power = V(mul)(VC(alpha, RAY_CHANNELS)(straight),
                       V(pick)(exponents + i, spread));
        power = V(max)(power, V(set1)(-126));
        /* 2^power as 2^k 2^f with |f| <= 1/2; 2^f - 1 by its series. */
        V(vec) whole = V(add)(power, round);
        V(vec) f = V(sub)(power, V(sub)(whole, round));
        V(vec) series = V(set1)(0.00133335581464f);
        series = V(fma)(series, f, V(set1)(0.00961812910763f));
        series = V(fma)(series, f, V(set1)(0.0555041086648f));
        series = V(fma)(series, f, V(set1)(0.240226506959f));
        series = V(fma)(series, f, V(set1)(0.693147180560f));
        V(vec) scale = V(power2)(whole);
        V(vec) alpha = V(fnma)(V(mul)(scale, f), series, V(sub)(one, scale));
#endif
        V(vec) color = straight;
#if RAY_SHADED
        V(vec) factor = V(pick)(factors + i, spread);
        V(vec) white = V(pick)(whites + i, spread);
        color = V(fma)(straight, factor, white);
        color = V(min)(V(mul)(color, V(set1)(1 / SNOW_GLOSS_ONE)), one);
#endif
        V(store)
        (samples + i * RAY_CHANNELS,
         VC(with_alpha, RAY_CHANNELS)(V(mul)(color, alpha), alpha));
    }
}

#undef RAY_SHADED
#undef RAY_GRADIENT_OPACITY
#undef RAY_KIND
