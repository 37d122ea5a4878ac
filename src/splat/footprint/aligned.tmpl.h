/* splat/footprint/aligned.tmpl.h - the inner loops of splatting where the
 * slice's axes are parallel to the image's. Define before including:
 *
 *   SPLAT_CHANNELS  floats of a sample and of a pixel: 2 or 4
 *   SPLAT_ROW       name of the function
 *   SPLAT_STAMP     name of its helper
 *
 * All are undefined at the end.  Splatting without encoding and the three
 * encodings use these same loops, and additions to a pixel are in the order of
 * the voxels: an encoding cannot change a bit. */

/* Adds one voxel: the product of a run of taps along x and one along y. */
static inline void SPLAT_STAMP(snow_sheet *sheet,
                               const snow_footprint_table *taps_x, int64_t x,
                               const snow_footprint_table *taps_y, int64_t y,
                               const float *sample) {
    const float *weights_x = taps_x->weights + taps_x->offset[x];
    const float *weights_y = taps_y->weights + taps_y->offset[y];
    int columns = taps_x->count[x], lines = taps_y->count[y];
    if (!columns || !lines) /* out of view: `first` may be past the end */
        return;
    int first = taps_y->first[y] - sheet->top, j = first < 0 ? -first : 0;
    if (lines > sheet->bottom - taps_y->first[y])
        lines = sheet->bottom - taps_y->first[y];
    if (j >= lines) /* out of the band */
        return;
    size_t stride = (size_t)sheet->width * SPLAT_CHANNELS;
    float *line = sheet->pixels + (size_t)(first + j) * stride +
                  (size_t)taps_x->first[x] * SPLAT_CHANNELS;
    for (; j < lines; j++, line += stride) {
        float scaled[SPLAT_CHANNELS];
        for (int c = 0; c < SPLAT_CHANNELS; c++)
            scaled[c] = weights_y[j] * sample[c];
        for (int i = 0; i < columns; i++)
            for (int c = 0; c < SPLAT_CHANNELS; c++)
                line[i * SPLAT_CHANNELS + c] += weights_x[i] * scaled[c];
    }
}

static void SPLAT_ROW(const snow_splatter *splatter, snow_sheet *sheet,
                      int64_t row, const snow_span *spans, size_t count,
                      const float *samples) {
    const snow_footprint_table *u = &splatter->taps_u, *v = &splatter->taps_v;
    if (!v->count[row])
        return;
    for (size_t s = 0; s < count; s++) {
        int64_t end = (int64_t)spans[s].column + spans[s].length;
        for (int64_t column = spans[s].column; column < end; column++) {
            if (splatter->transposed)
                SPLAT_STAMP(sheet, v, row, u, column, samples);
            else
                SPLAT_STAMP(sheet, u, column, v, row, samples);
            samples += SPLAT_CHANNELS;
        }
    }
}

#undef SPLAT_CHANNELS
#undef SPLAT_ROW
#undef SPLAT_STAMP
