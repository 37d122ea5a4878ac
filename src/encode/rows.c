/* encode/rows.c - the row loops of encoding, for all voxel types and levels.
 *
 * Voxels of 8 and 16 bits are compared with the intervals of interesting codes,
 * 64 at a time; wider ones go through the coder one by one, those that cannot
 * be interesting excepted. */
#include "encode/rows.h"

#include "encode/blocks_scalar.h"

#define SELECT_SCALAR
#include "simd/select.h"
#define ROW_CODE uint8_t
#define ROW(word) NAME(word##_8)
#include "encode/rows.tmpl.h"
#define ROW_CODE uint16_t
#define ROW(word) NAME(word##_16)
#include "encode/rows.tmpl.h"

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

/* Sets the codes of a block's voxels that pass the coder. */
static uint64_t encode_values(const snow_row_encoder *e, const double *values,
                              uint64_t candidates, uint16_t *codes) {
    uint64_t mask = 0;
    for (; candidates; candidates &= candidates - 1) {
        int n = __builtin_ctzll(candidates);
        uint64_t kept = snow_coder_code(e->coder, values[n], codes);
        codes += kept;
        mask |= kept << n;
    }
    return mask;
}

#define WIDE_ROW(NAME_, type, text)                                        \
    static size_t encode_##NAME_(const snow_row_encoder *e,                \
                                 const void *voxels, size_t columns,       \
                                 uint64_t *masks, void *codes) {           \
        const type *voxel = voxels;                                        \
        uint16_t *code = codes;                                            \
        for (size_t at = 0; at < columns; at += 64) {                      \
            size_t some = columns - at < 64 ? columns - at : 64;           \
            double values[64];                                             \
            unsigned char flags[64] = {0};                                 \
            for (size_t n = 0; n < some; n++) {                            \
                values[n] = (double)voxel[at + n];                         \
                flags[n] = values[n] == values[n];                         \
            }                                                              \
            *masks = encode_values(e, values, bits_of_flags(flags), code); \
            code += __builtin_popcountll(*masks++);                        \
        }                                                                  \
        return (size_t)(code - (uint16_t *)codes);                         \
    }

SNOW_TYPE_MAP(WIDE_ROW)

static snow_encode_row_fn *const wide_rows[] = {
#define WIDE_ENTRY(name, type, text) [SNOW_##name] = encode_##name,
    SNOW_TYPE_MAP(WIDE_ENTRY)};

void snow_row_encoder_init(const snow_coder *coder, snow_isa isa,
                           snow_row_encoder *out) {
    bool wide = snow_type_size(coder->type) > 2;
    *out = (snow_row_encoder){.coder = coder,
                              .encode_row = wide_rows[coder->type],
                              .bias = (uint16_t)-coder->lowest};
    if (wide)
        return;
    (void)isa;
    int loop = coder->run_count < 0 ? 0 : coder->run_count == 1 ? 1 : 2;
    out->encode_row =
        coder->bytes == 1 ? loops_8_scalar[loop] : loops_16_scalar[loop];
}
