/* encode/rows.c - the row loops of encoding, for all voxel types and
 * instruction sets.
 *
 * Voxels of 8 and 16 bits are compared with the intervals of interesting codes,
 * 64 at a time. Wider ones go through the quantizer one by one, except those
 * that cannot be interesting. */
#include "encode/rows.h"

#include "encode/blocks_scalar.h"
#if SNOW_HAS_AVX
#include "encode/blocks_avx2.h"
#include "encode/blocks_avx512.h"
#endif

#include <math.h>

#define TEMPLATE "encode/rows_isa.h"
#include "simd/each_isa.h"

/* By instruction set, and bytes of a code less one: see rows.tmpl.h. */
static snow_encode_rows_fn *const *loops_of(snow_isa isa, int bytes) {
    return bytes == 1 ? SNOW_OF_ISA(isa, loops_8) : SNOW_OF_ISA(isa, loops_16);
}

size_t snow_columns_of_masks(const uint64_t *masks, size_t words,
                             uint32_t *columns) {
    size_t count = 0;
    for (size_t w = 0; w < words; w++)
        for (uint64_t mask = masks[w]; mask; mask &= mask - 1)
            columns[count++] =
                (uint32_t)(64 * w + (size_t)__builtin_ctzll(mask));
    return count;
}

/* --- wider types ---------------------------------------------------------- */

/* Sets the codes of a block's voxels that the quantizer keeps. */
static uint64_t encode_values(const snow_row_encoder *e, const double *values,
                              uint64_t candidates, uint16_t *codes) {
    uint64_t mask = 0;
    for (; candidates; candidates &= candidates - 1) {
        int n = __builtin_ctzll(candidates);
        uint64_t kept = snow_quantizer_code(e->quantizer, values[n], codes);
        codes += kept;
        mask |= kept << n;
    }
    return mask;
}

/* Up to 64 voxels; those out of bounds, and NaN, skip the quantizer. */
#define WIDE_ROWS(name, type, text)                                            \
    static uint64_t block_##name(const snow_row_encoder *e, const type *voxel, \
                                 size_t count, uint16_t *codes) {              \
        double values[64];                                                     \
        unsigned char flags[64] = {0};                                         \
        for (size_t n = 0; n < count; n++) {                                   \
            values[n] = (double)voxel[n];                                      \
            flags[n] = (values[n] >= e->low) & (values[n] <= e->high);         \
        }                                                                      \
        return encode_values(e, values, bits_of_flags(flags), codes);          \
    }                                                                          \
                                                                               \
    static size_t encode_##name(const snow_row_encoder *e,                     \
                                const snow_rows *rows, uint64_t *masks,        \
                                void *codes) {                                 \
        uint16_t *code = codes;                                                \
        for (size_t row = 0; row < rows->rows; row++) {                        \
            const type *voxel =                                                \
                (const type *)(const void *)(rows->voxels +                    \
                                             row * rows->stride);              \
            for (size_t at = 0; at < rows->columns; at += 64) {                \
                size_t left = rows->columns - at;                              \
                uint64_t mask =                                                \
                    block_##name(e, voxel + at, left < 64 ? left : 64, code);  \
                code += __builtin_popcountll(mask);                            \
                *masks++ = mask;                                               \
            }                                                                  \
        }                                                                      \
        return (size_t)(code - (uint16_t *)codes);                             \
    }

SNOW_TYPE_MAP(WIDE_ROWS)

static snow_encode_rows_fn *const wide_rows[] = {
#define WIDE_ENTRY(name, type, text) [SNOW_TYPE_##name] = encode_##name,
    SNOW_TYPE_MAP(WIDE_ENTRY)};

void snow_row_encoder_init(const snow_quantizer *quantizer, snow_isa isa,
                           snow_row_encoder *out) {
    size_t runs = quantizer->native_run_count;
    *out = (snow_row_encoder){.quantizer = quantizer,
                              .encode_rows = wide_rows[quantizer->type],
                              .bias = (uint16_t)-quantizer->lowest,
                              .low = INFINITY,
                              .high = -INFINITY};
    if (runs) {
        out->low = quantizer->native_runs[0].first;
        out->high = quantizer->native_runs[runs - 1].last;
    }
    if (snow_type_size(quantizer->type) > 2)
        return;
    int loop = quantizer->run_count < 0 ? 0 : quantizer->run_count == 1 ? 1 : 2;
    out->encode_rows = loops_of(isa, quantizer->bytes)[loop];
}
