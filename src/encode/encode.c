/* encode/encode.c - the common part of the three schemes: IA, PA and the walk
 * (section 3.1 of the paper, figure 3). */
#include "encode/encode.h"

const snow_scheme *snow_scheme_of(snow_encoding encoding) {
    switch (encoding) {
    case SNOW_ENCODING_CRS:
        return &snow_scheme_crs;
    case SNOW_ENCODING_RLE:
        return &snow_scheme_rle;
    default:
        return &snow_scheme_bitmap;
    }
}

snow_encoding snow_encoding_choose(uint64_t voxels, uint64_t interesting,
                                   uint64_t runs) {
    if ((double)interesting >= 0.05 * (double)voxels)
        return SNOW_ENCODING_BITMAP;
    if (interesting && interesting >= 16 * runs)
        return SNOW_ENCODING_RLE;
    return SNOW_ENCODING_CRS;
}

/* No slice is there yet. */
static snow_status begin_encoding(snow_sparse *s, const snow_scheme *scheme,
                                  int channels, int64_t columns, int64_t rows,
                                  int64_t slices) {
    SNOW_TRY(SNOW_RESERVE(s->context, s->pa, 0, slices + 1));
    s->scheme = scheme;
    s->channels = channels;
    s->columns = columns;
    s->rows = rows;
    s->filled = 0;
    s->ea_bytes = s->ia_voxels = 0;
    s->pa[0] = (snow_slice_pointer){0, 0};
    return SNOW_RESERVE(s->context, s->mask, 0, snow_mask_words(s));
}

snow_status snow_slice_check(snow_context *context, const snow_placement *p) {
    return p->columns * p->rows <= (int64_t)UINT32_MAX
               ? SNOW_STATUS_OK
               : snow_fail(
                     context, SNOW_STATUS_BAD_USAGE,
                     "slices of %lldx%lld voxels are too large to encode: "
                     "the limit is 4294967295 voxels; render a part of "
                     "the volume",
                     (long long)p->columns, (long long)p->rows);
}

snow_status snow_sparse_begin(snow_sparse *s, const snow_scheme *scheme,
                              const snow_placement *placement, int channels) {
    SNOW_TRY(snow_slice_check(s->context, placement));
    return begin_encoding(s, scheme, channels, placement->columns,
                          placement->rows, placement->slices);
}

snow_status snow_sparse_begin_slice(snow_sparse *s) {
    s->row = 0;
    return s->scheme->begin_slice(s);
}

snow_status snow_sparse_lend(snow_sparse *s, size_t voxels, float **samples) {
    SNOW_TRY(snow_reserve(s->context, &s->ia, s->ia_voxels,
                          s->ia_voxels + voxels,
                          (size_t)s->channels * sizeof **samples));
    *samples = s->ia + s->ia_voxels * (size_t)s->channels;
    return SNOW_STATUS_OK;
}

snow_status snow_sparse_add_row_block(snow_sparse *s,
                                      const snow_row_block *row_block) {
    /* Appends samples to IA; they may be there already. */
    float *end;
    SNOW_TRY(snow_sparse_lend(s, row_block->count, &end));
    if (row_block->samples != end)
        memcpy(end, row_block->samples,
               row_block->count * (size_t)s->channels *
                   sizeof *row_block->samples);
    s->ia_voxels += row_block->count;
    size_t begin = 0;
    for (int64_t row = 0; row < row_block->rows; row++) {
        memset(s->mask, 0, snow_mask_words(s) * sizeof *s->mask);
        for (; begin < row_block->row_end[row]; begin++) {
            uint32_t column = row_block->columns[begin];
            s->mask[column / 64] |= UINT64_C(1) << column % 64;
        }
        SNOW_TRY(s->scheme->add_row(s, s->mask));
        s->row++;
    }
    return SNOW_STATUS_OK;
}

/* The next slice begins here. */
static snow_status point(snow_sparse *s) {
    s->filled++;
    s->pa[s->filled] = (snow_slice_pointer){s->ea_bytes, s->ia_voxels};
    return SNOW_STATUS_OK;
}

snow_status snow_sparse_end_slice(snow_sparse *s) {
    if (s->scheme->end_slice)
        SNOW_TRY(s->scheme->end_slice(s));
    return point(s);
}

snow_status snow_sparse_begin_band(snow_sparse *s, const snow_scheme *scheme,
                                   int64_t columns, int64_t rows,
                                   int64_t slices) {
    return begin_encoding(s, scheme, 0, columns, rows, slices);
}

snow_status snow_sparse_add_masks(snow_sparse *s, const uint64_t *masks,
                                  size_t voxels) {
    if (!voxels)
        return point(s);
    SNOW_TRY(snow_sparse_begin_slice(s));
    for (; s->row < s->rows; s->row++, masks += snow_mask_words(s))
        SNOW_TRY(s->scheme->add_row(s, masks));
    return snow_sparse_end_slice(s);
}

void snow_sparse_fini(snow_sparse *s) {
    snow_release(s->context, s->ea);
    snow_release(s->context, s->ia);
    snow_release(s->context, s->quantized);
    snow_release(s->context, s->pa);
    snow_release(s->context, s->mask);
    *s = (snow_sparse){.context = s->context};
}

void snow_walk_begin(snow_walk *walk, const snow_sparse *s, int64_t slice) {
    snow_slice_pointer pointer = s->pa[slice];
    *walk = (snow_walk){.sparse = s, .voxel = (size_t)pointer.ia};
    if (s->pa[slice + 1].ea > pointer.ea)
        walk->slice = walk->ea = s->ea + pointer.ea;
}

size_t snow_walk_row(snow_walk *walk, snow_span *spans, size_t *voxel) {
    size_t voxels = 0, count = walk->slice
                                   ? walk->sparse->scheme->next_row(walk, spans)
                                   : 0;
    for (size_t i = 0; i < count; i++)
        voxels += spans[i].length;
    *voxel = walk->voxel;
    walk->voxel += voxels;
    walk->row++;
    return count;
}

size_t snow_spans_of_columns(const uint32_t *columns, size_t count,
                             snow_span *spans) {
    size_t spanned = 0;
    for (size_t i = 0; i < count; i++)
        spanned = snow_span_append(spans, spanned, columns[i], 1);
    return spanned;
}
