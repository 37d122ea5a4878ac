/* classify/sample.tmpl.h - codes to samples.  Define before including, with
 * simd/select.h's words in force:
 *
 *   SAMPLE_CODE      C type of a code: uint8_t or uint16_t
 *   SAMPLE_WIDEN     V(widen8) or V(widen16), as the code
 *   SAMPLE_CHANNELS  floats of a sample: 2 or 4
 *   SAMPLE_GATHER, SAMPLE_SHINE, SAMPLE_ALPHA, SAMPLE_WITH_ALPHA, SAMPLE_SPREAD
 *                    V(gather2), V(gather2), V(alpha2), V(with_alpha2),
 *                    V(spread2), or V(gather4), V(double2), V(alpha4),
 *                    V(with_alpha4), V(spread4), as the channels
 *   SAMPLE_NAME      name of the functions: SAMPLE_NAME(plain), (shaded)
 *
 * All are undefined at the end.  The voxels of all windows are first set down
 * one after another, so that no lane of a vector is spent on a place without
 * one; then they are classified and shaded; then spread out over their windows.
 * Which places hold a voxel decides no branch, which the processor would guess
 * wrong at every edge of an object. */

/* Codes of a row, or normals, as places of tables. */
#define SAMPLE_SET_DOWN(widen, numbers, voxels, places) \
    for (int at = 0; at < (voxels); at += 16)           \
    widen((numbers) + at, (places) + at)

/* Sets down the entries of all voxels; returns how many they are. */
TARGET static inline int SAMPLE_NAME(entries)(const snow_sample_job *job,
                                              const bool shaded) {
    int total = 0;
    for (uint64_t left = job->held; left; left &= left - 1) {
        int row = __builtin_ctzll(left), voxels = V(popcount)(job->bits[row]);
        const SAMPLE_CODE *code =
            (const SAMPLE_CODE *)(const void *)job->codes[row] +
            job->before[row];
        SAMPLE_SET_DOWN(SAMPLE_WIDEN, code, voxels, job->room->entries + total);
        if (shaded)
            SAMPLE_SET_DOWN(V(widen16), job->normals[row] + job->before[row],
                            voxels, job->room->normals + total);
        total += voxels;
    }
    /* The last group of voxels reaches beyond them. */
    memset(job->room->entries + total, 0, 16 * sizeof(uint32_t));
    memset(job->room->normals + total, 0, 16 * sizeof(uint32_t));
    return total;
}

/* The samples to their windows. */
TARGET static inline void SAMPLE_NAME(spread)(const snow_sample_job *job) {
    const float *samples = job->room->samples;
    for (uint64_t left = job->held; left; left &= left - 1) {
        int row = __builtin_ctzll(left);
        SAMPLE_SPREAD(samples, job->bits[row], job->count,
                      job->samples + (size_t)row * job->window);
        samples += SAMPLE_CHANNELS * V(popcount)(job->bits[row]);
    }
}

/* A sample of four floats is one vector: 16 bytes in one load and one store
 * are several times faster than a gather. */
TARGET static void SAMPLE_NAME(plain)(const snow_sample_job *job) {
    const float *palette = job->palette;
    const uint32_t *entries = job->room->entries;
    float *samples = job->room->samples;
    int total = SAMPLE_NAME(entries)(job, false);
    for (int i = 0; i < total; i += 4)
        for (int n = i; n < i + 4; n++)
            memcpy(samples + n * SAMPLE_CHANNELS,
                   palette + (size_t)entries[n] * SAMPLE_CHANNELS,
                   SAMPLE_CHANNELS * sizeof *samples);
    SAMPLE_NAME(spread)(job);
}

TARGET static void SAMPLE_NAME(shaded)(const snow_sample_job *job) {
    const float *palette = job->palette;
    const float *shines = (const float *)(const void *)job->gloss;
    const uint32_t *entries = job->room->entries;
    const uint32_t *normals = job->room->normals;
    int total = SAMPLE_NAME(entries)(job, true);
    for (int i = 0; i < total; i += LANES / SAMPLE_CHANNELS) {
        V(vec) straight = SAMPLE_GATHER(palette, entries + i);
        V(vec) shine = SAMPLE_SHINE(shines, normals + i);
        V(vec) color = V(fma)(straight, V(even)(shine), V(odd)(shine));
        color = V(mul)(V(min)(color, V(set1)(1)), SAMPLE_ALPHA(straight));
        V(store)
        (job->room->samples + i * SAMPLE_CHANNELS,
         SAMPLE_WITH_ALPHA(color, straight));
    }
    SAMPLE_NAME(spread)(job);
}

#undef SAMPLE_CODE
#undef SAMPLE_WIDEN
#undef SAMPLE_CHANNELS
#undef SAMPLE_NAME
#undef SAMPLE_GATHER
#undef SAMPLE_SHINE
#undef SAMPLE_ALPHA
#undef SAMPLE_WITH_ALPHA
#undef SAMPLE_SPREAD
#undef SAMPLE_SET_DOWN
