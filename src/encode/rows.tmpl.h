/* encode/rows.tmpl.h - the row loop for codes of one size and one instruction
 * set.  Define before including:
 *
 *   ROW_CODE   uint8_t or uint16_t: the code, and a voxel's bits
 *   ROW(word)  word with size and instruction set appended
 *   TARGET     attribute of each function (simd/select.h)
 *
 * and these, for a block of 64 voxels:
 *
 *   ROW(block)                      its type
 *   ROW(load)(p, bias)              64 voxels as codes
 *   ROW(within)(block, first, last) a bit for each code from first to last
 *   ROW(pack)(block, mask, out)     the codes of set bits; may write 64 codes
 *   ROW(bits)(block, keep)          keep[code] of each as a bit
 *
 * ROW_CODE and ROW are undefined at the end. */

/* Tests against RUNS runs, a constant where this is inlined. */
static inline __attribute__((always_inline)) TARGET uint64_t
ROW(test)(const snow_quantizer *quantizer, int runs, ROW(block) block) {
    uint64_t mask = 0;
    for (int n = 0; n < runs; n++)
        mask |= ROW(within)(block, (ROW_CODE)quantizer->runs[n].first,
                            (ROW_CODE)quantizer->runs[n].last);
    return mask;
}

/* Encodes one block; `runs` -1: by the table. */
static inline __attribute__((always_inline)) TARGET uint64_t
ROW(encode_block)(const snow_row_encoder *encoder, int runs,
                  const ROW_CODE *voxels, uint64_t valid, ROW_CODE *codes) {
    const snow_quantizer *quantizer = encoder->quantizer;
    ROW(block) block = ROW(load)(voxels, (ROW_CODE)encoder->bias);
    uint64_t mask = runs < 0 ? ROW(bits)(block, quantizer->keep)
                             : ROW(test)(quantizer, runs, block);
    mask &= valid;
    ROW(pack)(block, mask, codes);
    return mask;
}

/* Encodes the columns of a row that fill no block; nothing is read beyond them.
 */
static inline __attribute__((always_inline)) TARGET uint64_t
ROW(encode_rest)(const snow_row_encoder *encoder, int runs,
                 const ROW_CODE *voxels, size_t columns, ROW_CODE *codes) {
    ROW_CODE rest[64] = {0};
    memcpy(rest, voxels, columns * sizeof *rest);
    return ROW(encode_block)(encoder, runs, rest, (UINT64_C(1) << columns) - 1,
                             codes);
}

static inline __attribute__((always_inline)) TARGET size_t
ROW(encode)(const snow_row_encoder *encoder, int runs, const snow_rows *rows,
            uint64_t *masks, ROW_CODE *codes) {
    ROW_CODE *at = codes;
    for (size_t row = 0; row < rows->rows; row++) {
        const ROW_CODE *voxels =
            (const ROW_CODE *)(const void *)(rows->voxels + row * rows->stride);
        size_t left = rows->columns;
        for (; left >= 64; left -= 64, voxels += 64) {
            for (size_t n = 0; n < sizeof(ROW_CODE); n++)
                __builtin_prefetch((const char *)voxels + rows->ahead + 64 * n,
                                   0, 2);
            uint64_t mask =
                ROW(encode_block)(encoder, runs, voxels, ~UINT64_C(0), at);
            at += __builtin_popcountll(mask);
            *masks++ = mask;
        }
        if (left) {
            uint64_t mask = ROW(encode_rest)(encoder, runs, voxels, left, at);
            at += __builtin_popcountll(mask);
            *masks++ = mask;
        }
    }
    return (size_t)(at - codes);
}

/* A threshold gives a single interval, which has a loop of its own. */
TARGET static size_t ROW(encode_one)(const snow_row_encoder *encoder,
                                     const snow_rows *rows, uint64_t *masks,
                                     void *codes) {
    return ROW(encode)(encoder, 1, rows, masks, codes);
}

TARGET static size_t ROW(encode_runs)(const snow_row_encoder *encoder,
                                      const snow_rows *rows, uint64_t *masks,
                                      void *codes) {
    return ROW(encode)(encoder, encoder->quantizer->run_count, rows, masks,
                       codes);
}

TARGET static size_t ROW(encode_table)(const snow_row_encoder *encoder,
                                       const snow_rows *rows, uint64_t *masks,
                                       void *codes) {
    return ROW(encode)(encoder, -1, rows, masks, codes);
}

static snow_encode_rows_fn *const ROW(loops)[3] = {
    ROW(encode_table), ROW(encode_one), ROW(encode_runs)};

#undef ROW_CODE
#undef ROW
