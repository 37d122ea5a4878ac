/* encode/transpose.tmpl.h - transposes a tile of 64 lines of 64 bytes by AVX2.
 * Define before including, beside TARGET of simd/select.h:
 *
 *   TILE_SIZE   bytes of a value: 1 or 2
 *   TILE(word)  word with size and instruction set appended
 *   TILE_LOW(a, b), TILE_HIGH(a, b)  interleave the values of the lower, the
 *               upper halves of each 16 bytes of two vectors
 *
 * All are undefined at the end.
 *
 * N = 16 / TILE_SIZE lines are processed at once. Within each 16 bytes of them
 * they are a matrix of N x N values. One round interleaves line i with line i +
 * N/2: it rotates the index of a value, line and position as one binary number,
 * by a bit. So log2 N rounds exchange line and position. */

#define TILE_LINES (16 / TILE_SIZE)

static inline __attribute__((always_inline)) TARGET void
TILE(round)(const __m256i *in, __m256i *out) {
    for (int n = 0; n < TILE_LINES / 2; n++) {
        out[2 * n] = TILE_LOW(in[n], in[n + TILE_LINES / 2]);
        out[2 * n + 1] = TILE_HIGH(in[n], in[n + TILE_LINES / 2]);
    }
}

/* TILE_LINES lines, 32 bytes of each. */
static inline __attribute__((always_inline)) TARGET void
TILE(part)(const unsigned char *in, size_t stride, unsigned char *out,
           size_t pitch) {
    __m256i a[TILE_LINES], b[TILE_LINES];
    for (int n = 0; n < TILE_LINES; n++)
        a[n] = _mm256_loadu_si256((const void *)(in + (size_t)n * stride));
    TILE(round)(a, b);
    TILE(round)(b, a);
    TILE(round)(a, b);
#if TILE_SIZE == 1
    TILE(round)(b, a);
#endif
    for (int n = 0; n < TILE_LINES; n++)
        wide_spread(TILE_SIZE == 1 ? a[n] : b[n], out + (size_t)n * pitch,
                    TILE_LINES * pitch);
}

TARGET static void TILE(transpose)(const unsigned char *in, size_t stride,
                                   unsigned char *out, size_t pitch,
                                   const unsigned char *next) {
    for (size_t line = 0; line < SNOW_TILE_LINES; line += TILE_LINES) {
        for (size_t n = line; n < line + TILE_LINES; n++)
            __builtin_prefetch(next + n * stride, 0, 2);
        for (size_t at = 0; at < SNOW_TILE_BYTES; at += 32)
            TILE(part)
        (in + line * stride + at, stride,
         out + at / TILE_SIZE * pitch + line * TILE_SIZE, pitch);
    }
}

#undef TILE_LINES
#undef TILE_SIZE
#undef TILE
#undef TILE_LOW
#undef TILE_HIGH
