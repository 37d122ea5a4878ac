/* classify/sample/sample.tmpl.h - codes to samples. Include simd/select.h
 * first, and define:
 *
 *   SAMPLE_CODE      C type of a code: uint8_t or uint16_t
 *   SAMPLE_WIDEN     V(widen8) or V(widen16), for the code
 *   SAMPLE_CHANNELS  floats of a sample: 2 or 4
 *   SAMPLE_NAME      name of the functions: SAMPLE_NAME(plain), (shaded),
 *                    (faded_plain), (faded_shaded)
 *
 * All are undefined at the end. The voxels of all windows are first collected
 * into one array, so that no lane of a vector is wasted on an empty place. Then
 * they are classified and shaded, and last spread over their windows. No branch
 * depends on which places hold a voxel; the processor would mispredict it at
 * every edge of an object. */

/* Collects the codes of all voxels; returns their number. */
TARGET static inline int SAMPLE_NAME(codes)(const snow_sample_job *job,
                                            const bool shaded) {
    SAMPLE_CODE *codes = (SAMPLE_CODE *)(void *)job->room->codes;
    int total = 0;
    for (uint64_t left = job->held; left; left &= left - 1) {
        int row = __builtin_ctzll(left);
        const SAMPLE_CODE *code =
            (const SAMPLE_CODE *)(const void *)job->codes[row];
        size_t before = job->before[row];
        SAMPLE_COPY(codes + total, code + before, job->count);
        if (shaded)
            SAMPLE_COPY(job->room->normals + total, job->normals[row] + before,
                        job->count);
        total += V(popcount)(job->bits[row]);
    }
    return total;
}

/* Spreads the samples over their windows. */
TARGET static inline void SAMPLE_NAME(spread)(const snow_sample_job *job) {
    const float *samples = job->room->samples;
    for (uint64_t left = job->held; left; left &= left - 1) {
        int row = __builtin_ctzll(left);
        VC(spread, SAMPLE_CHANNELS)
        (samples, job->bits[row], job->count,
         job->samples + (size_t)row * job->window);
        samples += SAMPLE_CHANNELS * V(popcount)(job->bits[row]);
    }
}

/* A sample of four floats is one vector: 16 bytes in one load and one store
 * are several times faster than a gather. */
TARGET static void SAMPLE_NAME(plain)(const snow_sample_job *job) {
    const SAMPLE_CODE *codes = (const SAMPLE_CODE *)(void *)job->room->codes;
    float *samples = job->room->samples;
    int total = SAMPLE_NAME(codes)(job, false);
    for (int i = 0; i < total; i += 4)
        for (int n = i; n < i + 4; n++)
            memcpy(samples + n * SAMPLE_CHANNELS,
                   job->palette + (size_t)codes[n] * SAMPLE_CHANNELS,
                   SAMPLE_CHANNELS * sizeof *samples);
    SAMPLE_NAME(spread)(job);
}

/* Looks up the palette entries of codes and the factors of normals. Some beyond
 * the last are looked up too; they are those of any voxel. */
TARGET static inline void SAMPLE_NAME(look_up)(const snow_sample_job *job,
                                               int total) {
    snow_sample_room *room = job->room;
    const SAMPLE_CODE *codes = (const SAMPLE_CODE *)(void *)room->codes;
    for (int i = 0; i < total; i += 16) {
        uint32_t normals[16];
        SAMPLE_WIDEN(codes + i, room->entries + i);
        V(widen16)(room->normals + i, normals);
        V(pairs16)(job->gloss, normals, room->factors + i, room->whites + i);
    }
}

TARGET static void SAMPLE_NAME(shaded)(const snow_sample_job *job) {
    snow_sample_room *room = job->room;
    const V(places) repeat = VC(repeat, SAMPLE_CHANNELS)();
    const V(vec) one = V(set1)(SNOW_GLOSS_ONE);
    const V(vec) step = V(set1)(1 / SNOW_GLOSS_ONE);
    int total = SAMPLE_NAME(codes)(job, true);
    SAMPLE_NAME(look_up)(job, total);
    for (int i = 0; i < total; i += LANES / SAMPLE_CHANNELS) {
        V(vec)
        straight = VC(gather, SAMPLE_CHANNELS)(job->palette, room->entries + i);
        V(vec) factor = V(pick)(room->factors + i, repeat);
        V(vec) white = V(pick)(room->whites + i, repeat);
        V(vec) color = V(min)(V(fma)(straight, factor, white), one);
        color =
            V(mul)(color, V(mul)(VC(alpha, SAMPLE_CHANNELS)(straight), step));
        V(store)
        (room->samples + i * SAMPLE_CHANNELS,
         VC(with_alpha, SAMPLE_CHANNELS)(color, straight));
    }
    SAMPLE_NAME(spread)(job);
}

/* --- with a gradient opacity ---------------------------------------------- */

/* The opacities of all voxels with their factors applied; the palette entries
 * are known. */
TARGET static inline void SAMPLE_NAME(fade)(const snow_sample_job *job,
                                            int total) {
    snow_sample_room *room = job->room;
    uint16_t *gradient_factors = room->gradient_factors;
    const float *last = job->palette + SAMPLE_CHANNELS - 1;
    float exponents[16];
    for (int i = 0; i < 16; i++)
        exponents[i] = job->exponent;
    for (uint64_t left = job->held; left; left &= left - 1) {
        int row = __builtin_ctzll(left);
        SAMPLE_COPY(gradient_factors,
                    job->gradient_factors[row] + job->before[row], job->count);
        gradient_factors += V(popcount)(job->bits[row]);
    }
    /* In a loop of its own: a vector load would wait for floats just stored. */
    for (int i = 0; i < total; i += 16)
        for (int n = i; n < i + 16; n++)
            room->opacities[n] =
                last[(size_t)room->entries[n] * SAMPLE_CHANNELS];
    for (int i = 0; i < total; i += 16) {
        uint32_t codes[16];
        V(widen16)(room->gradient_factors + i, codes);
        NAME(fade16)(codes, exponents, room->opacities + i);
    }
}

TARGET static void SAMPLE_NAME(faded_plain)(const snow_sample_job *job) {
    snow_sample_room *room = job->room;
    const SAMPLE_CODE *codes = (const SAMPLE_CODE *)(void *)room->codes;
    const V(places) repeat = VC(repeat, SAMPLE_CHANNELS)();
    int total = SAMPLE_NAME(codes)(job, false);
    for (int i = 0; i < total; i += 16)
        SAMPLE_WIDEN(codes + i, room->entries + i);
    SAMPLE_NAME(fade)(job, total);
    for (int i = 0; i < total; i += LANES / SAMPLE_CHANNELS) {
        V(vec)
        straight = VC(gather, SAMPLE_CHANNELS)(job->palette, room->entries + i);
        V(vec) opacity = V(pick)(room->opacities + i, repeat);
        V(store)
        (room->samples + i * SAMPLE_CHANNELS,
         VC(with_alpha, SAMPLE_CHANNELS)(V(mul)(straight, opacity), opacity));
    }
    SAMPLE_NAME(spread)(job);
}

TARGET static void SAMPLE_NAME(faded_shaded)(const snow_sample_job *job) {
    snow_sample_room *room = job->room;
    const V(places) repeat = VC(repeat, SAMPLE_CHANNELS)();
    const V(vec) one = V(set1)(SNOW_GLOSS_ONE);
    const V(vec) step = V(set1)(1 / SNOW_GLOSS_ONE);
    int total = SAMPLE_NAME(codes)(job, true);
    SAMPLE_NAME(look_up)(job, total);
    SAMPLE_NAME(fade)(job, total);
    for (int i = 0; i < total; i += LANES / SAMPLE_CHANNELS) {
        V(vec)
        straight = VC(gather, SAMPLE_CHANNELS)(job->palette, room->entries + i);
        V(vec) factor = V(pick)(room->factors + i, repeat);
        V(vec) white = V(pick)(room->whites + i, repeat);
        V(vec) opacity = V(pick)(room->opacities + i, repeat);
        V(vec) color = V(min)(V(fma)(straight, factor, white), one);
        color = V(mul)(color, V(mul)(opacity, step));
        V(store)
        (room->samples + i * SAMPLE_CHANNELS,
         VC(with_alpha, SAMPLE_CHANNELS)(color, opacity));
    }
    SAMPLE_NAME(spread)(job);
}

#undef SAMPLE_CODE
#undef SAMPLE_WIDEN
#undef SAMPLE_CHANNELS
#undef SAMPLE_NAME
