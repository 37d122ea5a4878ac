/* classify/classify_row.tmpl.h - the row loops of classification, for one
 * scalar type.  Define before including:
 *
 *   ROW_TYPE    C type of a voxel
 *   ROW_NAME    name of the function
 *   ROW_LOWEST  the smallest value of the type: if defined, rows are classified
 *               by table; otherwise every voxel is evaluated
 *   ROW_BYTES   defined for 8-bit types, which may have faster loops
 *
 * All are undefined at the end. */

static size_t ROW_NAME(const snow_classifier *c, const void *voxels,
                       int64_t stride, int64_t columns, uint32_t *kept,
                       float *samples) {
    const ROW_TYPE *voxel = voxels;
    size_t count = 0;
#ifdef ROW_LOWEST
#ifdef ROW_BYTES
    if (c->classify_u8 && stride == 1)
        count = c->classify_u8(c->keep, voxels, (unsigned char)(ROW_LOWEST),
                               columns, kept);
    else
#endif
        /* First the columns, without a branch: the next voxel overwrites one
         * that is not kept. */
        for (int64_t i = 0; i < columns; i++) {
            kept[count] = (uint32_t)i;
            count += c->keep[(int)voxel[i * stride] - (ROW_LOWEST)];
        }
    if (c->channels == 2)
        for (size_t n = 0; n < count; n++) {
            size_t entry = (size_t)(voxel[kept[n] * stride] - (ROW_LOWEST));
            memcpy(samples + 2 * n, c->table + 2 * entry, 2 * sizeof *samples);
        }
    else
        for (size_t n = 0; n < count; n++) {
            size_t entry = (size_t)(voxel[kept[n] * stride] - (ROW_LOWEST));
            memcpy(samples + 4 * n, c->table + 4 * entry, 4 * sizeof *samples);
        }
#else
    for (int64_t i = 0; i < columns; i++) {
        double value = (double)voxel[i * stride];
        float *sample = samples + count * (size_t)c->channels;
        kept[count] = (uint32_t)i;
        count += snow_classify_value(c, value, sample) || c->keep_all;
    }
#endif
    return count;
}

#undef ROW_TYPE
#undef ROW_NAME
#undef ROW_LOWEST
#undef ROW_BYTES
