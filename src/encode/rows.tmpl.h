/* encode/rows.tmpl.h - the row loop for codes of one size at one level.  Define
 * before including:
 *
 *   ROW_CODE   uint8_t or uint16_t: the code, and a voxel's bits
 *   ROW(word)  word with size and level behind it: kept_8_avx2
 *   TARGET     what stands before each function (simd/select.h)
 *
 * and these, which work on a block of 64 voxels:
 *
 *   ROW(block)                      its type
 *   ROW(load)(p, bias)              64 voxels as codes
 *   ROW(within)(block, first, last) a bit for each code from first to last
 *   ROW(pack)(block, mask, out)     the codes of set bits; may write 64 codes
 *   ROW(bits)(block, keep)          keep[code] of each as a bit
 *
 * ROW_CODE and ROW are undefined at the end. */

/* As many runs as RUNS says, which is a constant where this is inlined. */
static inline __attribute__((always_inline)) TARGET uint64_t
ROW(test)(const snow_coder *coder, int runs, ROW(block) block) {
    uint64_t mask = 0;
    for (int n = 0; n < runs; n++)
        mask |= ROW(within)(block, (ROW_CODE)coder->runs[n].first,
                            (ROW_CODE)coder->runs[n].last);
    return mask;
}

/* One block; `runs` -1: by the table. */
static inline __attribute__((always_inline)) TARGET uint64_t
ROW(encode_block)(const snow_row_encoder *encoder, int runs,
                  const ROW_CODE *voxels, uint64_t valid, ROW_CODE *codes) {
    const snow_coder *coder = encoder->coder;
    ROW(block) block = ROW(load)(voxels, (ROW_CODE)encoder->bias);
    uint64_t mask = runs < 0 ? ROW(bits)(block, coder->keep)
                             : ROW(test)(coder, runs, block);
    mask &= valid;
    ROW(pack)(block, mask, codes);
    return mask;
}

static inline __attribute__((always_inline)) TARGET size_t
ROW(encode)(const snow_row_encoder *encoder, int runs, const ROW_CODE *voxels,
            size_t columns, uint64_t *masks, ROW_CODE *codes) {
    size_t count = 0, column = 0;
    for (; column + 64 <= columns; column += 64, masks++) {
        *masks = ROW(encode_block)(encoder, runs, voxels + column, ~UINT64_C(0),
                                   codes + count);
        count += (size_t)__builtin_popcountll(*masks);
    }
    if (column < columns) {
        ROW_CODE rest[64] = {0}; /* nothing is read beyond the row */
        memcpy(rest, voxels + column, (columns - column) * sizeof *rest);
        *masks = ROW(encode_block)(encoder, runs, rest,
                                   (UINT64_C(1) << (columns - column)) - 1,
                                   codes + count);
        count += (size_t)__builtin_popcountll(*masks);
    }
    return count;
}

/* One interval is what a threshold gives, and has a loop of its own. */
TARGET static size_t ROW(encode_one)(const snow_row_encoder *encoder,
                                     const void *voxels, size_t columns,
                                     uint64_t *masks, void *codes) {
    return ROW(encode)(encoder, 1, voxels, columns, masks, codes);
}

TARGET static size_t ROW(encode_runs)(const snow_row_encoder *encoder,
                                      const void *voxels, size_t columns,
                                      uint64_t *masks, void *codes) {
    return ROW(encode)(encoder, encoder->coder->run_count, voxels, columns,
                       masks, codes);
}

TARGET static size_t ROW(encode_table)(const snow_row_encoder *encoder,
                                       const void *voxels, size_t columns,
                                       uint64_t *masks, void *codes) {
    return ROW(encode)(encoder, -1, voxels, columns, masks, codes);
}

static snow_encode_row_fn *const ROW(loops)[3] = {
    ROW(encode_table), ROW(encode_one), ROW(encode_runs)};

#undef ROW_CODE
#undef ROW
