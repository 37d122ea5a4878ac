/* classify/classify_row.tmpl.h - the row loops of classification, for one
 * scalar type (volume/each_type.h): by table where it has a LOWEST value,
 * otherwise every voxel is evaluated. */

static size_t TYPED(classify_row)(const snow_classifier *c, const void *voxels,
                                  int64_t stride, int64_t columns,
                                  uint32_t *kept, float *samples) {
    const TYPE *voxel = voxels;
    size_t count = 0;
#ifdef LOWEST
    /* First the columns, without a branch: the next voxel overwrites one that
     * is not kept. */
    for (int64_t i = 0; i < columns; i++) {
        kept[count] = (uint32_t)i;
        count += c->keep[(int)voxel[i * stride] - (LOWEST)];
    }
    if (c->channels == 2)
        for (size_t n = 0; n < count; n++) {
            size_t entry = (size_t)(voxel[kept[n] * stride] - (LOWEST));
            memcpy(samples + 2 * n, c->table + 2 * entry, 2 * sizeof *samples);
        }
    else
        for (size_t n = 0; n < count; n++) {
            size_t entry = (size_t)(voxel[kept[n] * stride] - (LOWEST));
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

#undef TYPE
#undef TYPED
#undef LOWEST
