/* combine/pixels.tmpl.h - the loops of pixels.h for one instruction set and one
 * number of channels. Include simd/select.h first, and define:
 *
 *   PIXELS_CHANNELS  floats of a pixel: 2 or 4
 *   PIXELS_COMPOSITE_OP(front, back)
 *                    composites a vector of pixels before another; an empty
 *                    back must change nothing
 *   PIXELS_NAME      name of the functions: PIXELS_NAME(look), (scan), (merge)
 *
 * All are undefined at the end. Usually all or none of 64 pixels are active;
 * all are one loop. Otherwise no branch depends on which of them are, since it
 * would be mispredicted. Active pixels are listed by number, and a vector holds
 * only these, wherever they are, which costs the same at any density. But for a
 * vector of eight, fetching them one by one would take longer than processing
 * neighbours, active or not.
 *
 * Data are prefetched some lines ahead, since there are as many streams as
 * layers and each begins a new page every few hundred pixels. */

#if PIXELS_CHANNELS == 2
#define PIXELS_SOME V(some2)
#else
#define PIXELS_SOME V(nonzero4)
#endif
#define PIXELS_LISTED (LANES / PIXELS_CHANNELS < 8)
#define PIXELS_EACH (LANES / PIXELS_CHANNELS) /* pixels of a vector */
#define PIXELS_FEW(bits) ((unsigned)(bits) & ((1u << PIXELS_EACH) - 1))
#define PIXELS_AHEAD 256 /* floats */
#define PIXELS_SPARSE 4  /* so few of 64 pixels take less time one by one */

TARGET static uint64_t PIXELS_NAME(look)(const float *pixels, int count) {
    uint64_t bits = 0;
    int at = 0;
    for (; at + 16 <= count; at += 16) {
        const float *ahead = pixels + at * PIXELS_CHANNELS + 2 * PIXELS_AHEAD;
        for (int i = 0; i < 16 * PIXELS_CHANNELS; i += 16)
            __builtin_prefetch(ahead + i);
        bits |= (uint64_t)PIXELS_SOME(pixels + at * PIXELS_CHANNELS) << at;
    }
    if (at < count) {
        float rest[16 * PIXELS_CHANNELS] = {0};
        memcpy(rest, pixels + at * PIXELS_CHANNELS,
               (size_t)((count - at) * PIXELS_CHANNELS) * sizeof *rest);
        bits |= (uint64_t)PIXELS_SOME(rest) << at;
    }
    return bits;
}

#if PIXELS_LISTED
/* Lists the numbers of active pixels, and pads the list with `spare` to whole
 * vectors. */
TARGET static inline int PIXELS_NAME(list)(uint64_t bits, uint32_t spare,
                                           uint32_t places[64 + 16]) {
    int count = V(list)(bits, places);
    for (int i = 0; i < PIXELS_EACH - 1; i++)
        places[count + i] = spare;
    return count;
}
#endif

/* Packs those of 64 pixels whose bits are set, and reads no others. */
TARGET static inline float *PIXELS_NAME(pack)(float *out, const float *pixels,
                                              uint64_t bits) {
    if (!bits)
        return out;
    if (bits == ~(uint64_t)0) {
        for (int i = 0; i < 64 * PIXELS_CHANNELS; i += LANES)
            V(store)(out + i, V(load)(pixels + i));
        return out + 64 * PIXELS_CHANNELS;
    }
#if PIXELS_LISTED
    uint32_t places[64 + 16];
    int count =
        PIXELS_NAME(list)(bits, (uint32_t)__builtin_ctzll(bits), places);
    for (int i = 0; i < count; i += PIXELS_EACH)
        V(store)(out + i * PIXELS_CHANNELS,
                 VC(gather, PIXELS_CHANNELS)(pixels, places + i));
    return out + count * PIXELS_CHANNELS;
#else
    for (; bits; bits >>= PIXELS_EACH, pixels += LANES)
        out += 2 * V(compress2)(pixels, PIXELS_FEW(bits), out);
    return out;
#endif
}

TARGET static float *PIXELS_NAME(scan)(const float *pixels, int64_t at,
                                       int64_t count, uint64_t *words,
                                       float *out) {
    const int64_t end = at + count, begin = at / 64;
    while (at < end) {
        int shift = (int)(at % 64), some = 64 - shift;
        if (some > end - at)
            some = (int)(end - at);
        uint64_t bits = PIXELS_NAME(look)(pixels, some);
        words[at / 64 - begin] |= bits << shift;
        out = PIXELS_NAME(pack)(out, pixels, bits);
        pixels += some * PIXELS_CHANNELS;
        at += some;
    }
    return out;
}

/* Composites packed pixels behind those of a tile of 64 and a scratch pixel;
 * returns the first pixel not used. */
TARGET static inline const float *
PIXELS_NAME(composite)(float *tile, const float *packed, uint64_t bits) {
    if (bits == ~(uint64_t)0) {
        for (int i = 0; i < 64 * PIXELS_CHANNELS; i += LANES) {
            V(vec) front = V(load)(tile + i);
            front = PIXELS_COMPOSITE_OP(front, V(load)(packed + i));
            V(store)(tile + i, front);
        }
        return packed + 64 * PIXELS_CHANNELS;
    }
#if PIXELS_LISTED
    uint32_t places[64 + 16];
    if (V(popcount)(bits) <= PIXELS_SPARSE) {
        for (int i = 1; i < PIXELS_EACH; i++)
            places[i] = 64;
        for (; bits; bits &= bits - 1, packed += PIXELS_CHANNELS) {
            places[0] = (uint32_t)__builtin_ctzll(bits);
            V(vec) front = VC(gather, PIXELS_CHANNELS)(tile, places);
            front = PIXELS_COMPOSITE_OP(front, V(load)(packed));
            VC(scatter, PIXELS_CHANNELS)(tile, places, front);
        }
        return packed;
    }
    int count = PIXELS_NAME(list)(bits, 64, places);
    for (int i = 0; i < count; i += PIXELS_EACH) {
        const float *from = packed + i * PIXELS_CHANNELS;
        V(vec) front = VC(gather, PIXELS_CHANNELS)(tile, places + i);
        __builtin_prefetch(from + PIXELS_AHEAD);
        front = PIXELS_COMPOSITE_OP(front, V(load)(from));
        VC(scatter, PIXELS_CHANNELS)(tile, places + i, front);
    }
    return packed + count * PIXELS_CHANNELS;
#else
    __builtin_prefetch(packed + PIXELS_AHEAD);
    for (int i = 0; i < 64 * 2; i += LANES, bits >>= PIXELS_EACH) {
        V(vec) back = V(next2)(packed, PIXELS_FEW(bits));
        V(store)(tile + i, PIXELS_COMPOSITE_OP(V(load)(tile + i), back));
        packed += 2 * V(popcount)(PIXELS_FEW(bits));
    }
    return packed;
#endif
}

/* Copies a tile's pixels in first .. last - 1; its first is number `at`. */
TARGET static inline float *PIXELS_NAME(copy)(float *out, const float *tile,
                                              int64_t at, int64_t first,
                                              int64_t last) {
    int64_t from = at > first ? at : first;
    int64_t to = at + 64 < last ? at + 64 : last;
    size_t floats = (size_t)((to - from) * PIXELS_CHANNELS);
    memcpy(out, tile + (from - at) * PIXELS_CHANNELS, floats * sizeof *out);
    return out + floats;
}

TARGET static inline void PIXELS_NAME(clear)(float *tile) {
    for (int i = 0; i < 64 * PIXELS_CHANNELS; i += LANES)
        V(store)(tile + i, V(set1)(0));
}

TARGET static float *PIXELS_NAME(merge)(snow_active *layers, int count,
                                        int64_t first, int64_t last,
                                        uint64_t *words, float *out,
                                        bool packed, int64_t *laid) {
    float tile[65 * PIXELS_CHANNELS] = {0};
    int64_t came = 0;
    for (int64_t n = first / 64; n * 64 < last; n++) {
        const uint64_t range = snow_active_range(n, first, last);
        uint64_t seen = 0;
        for (int i = 0; i < count; i++) {
            uint64_t bits = snow_active_bits(&layers[i], n, range);
            if (!bits)
                continue;
            if (!seen)
                PIXELS_NAME(clear)(tile);
            layers[i].next = PIXELS_NAME(composite)(tile, layers[i].next, bits);
            seen |= bits;
            came += layers[i].own ? 0 : V(popcount)(bits);
        }
        words[n - first / 64] = seen;
        if (!seen && !packed)
            PIXELS_NAME(clear)(tile);
        out = packed ? PIXELS_NAME(pack)(out, tile, seen)
                     : PIXELS_NAME(copy)(out, tile, n * 64, first, last);
    }
    *laid += came;
    return out;
}

static const snow_pixel_loops PIXELS_NAME(loops) = {
    PIXELS_NAME(look), PIXELS_NAME(scan), PIXELS_NAME(merge)};

#undef PIXELS_LISTED
#undef PIXELS_EACH
#undef PIXELS_FEW
#undef PIXELS_AHEAD
#undef PIXELS_SPARSE
#undef PIXELS_CHANNELS
#undef PIXELS_SOME
#undef PIXELS_COMPOSITE_OP
#undef PIXELS_NAME
