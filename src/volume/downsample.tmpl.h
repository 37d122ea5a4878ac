/* volume/downsample.tmpl.h - rows of voxels to one of half as many, for one
 * type.
 *
 *   TYPE       of a voxel
 *   WORK       a real type that means are made in: float, or double where that
 *              does not hold a TYPE
 *   REAL(x)    x of type WORK rounded to a TYPE
 *   SUM        a type that holds the sum of 32 voxels, where even counts are
 *              added up in one; else undefined
 *   SHARE(s, shift)  s / 2^shift of type SUM rounded to a TYPE
 *   NAME(word) the name of a function of this type
 *
 * The loops are such that compilers make vectors of them, and those are as fast
 * as memory on any machine. */

/* The largest of each column of the rows, or where the volume leans down the
 * smallest. */
static void NAME(extreme_rows)(const downsampling *h, const row_taps *rows,
                               TYPE *restrict line) {
    int64_t n = h->width;
    memcpy(line, row_of(h, rows, 0), (size_t)n * sizeof *line);
    for (int tap = 1; tap < rows->count; tap++) {
        const TYPE *restrict row = row_of(h, rows, tap);
        if (h->lean > 0)
            for (int64_t i = 0; i < n; i++)
                line[i] = row[i] > line[i] ? row[i] : line[i];
        else
            for (int64_t i = 0; i < n; i++)
                line[i] = row[i] < line[i] ? row[i] : line[i];
    }
}

#ifdef SUM
/* The sum of 1, 2 or 4 rows. */
static void NAME(add_rows)(const downsampling *h, const row_taps *rows,
                           SUM *restrict line) {
    const TYPE *a = row_of(h, rows, 0), *b, *c, *d;
    int64_t n = h->width;
    switch (rows->count) {
    case 1:
        for (int64_t i = 0; i < n; i++)
            line[i] = (SUM)a[i];
        return;
    case 2:
        b = row_of(h, rows, 1);
        for (int64_t i = 0; i < n; i++)
            line[i] = (SUM)((SUM)a[i] + (SUM)b[i]);
        return;
    default:
        b = row_of(h, rows, 1);
        c = row_of(h, rows, 2);
        d = row_of(h, rows, 3);
        for (int64_t i = 0; i < n; i++)
            line[i] = (SUM)((SUM)((SUM)a[i] + (SUM)b[i]) +
                            (SUM)((SUM)c[i] + (SUM)d[i]));
    }
}

/* The two lines, their pairs taken together, as voxels. */
static void NAME(join)(const downsampling *h, const SUM *restrict sums,
                       const TYPE *restrict extremes, TYPE *restrict out) {
    int64_t n = h->out->info.dims[0];
    int shift = h->shift;
    bool pairs = h->axes[0].taps == 2;
    const SUM count = (SUM)(1 << shift);
#define LEAN(sum, extreme) \
    SHARE((SUM)((SUM)(3 * (sum)) + (SUM)(count * (SUM)(extreme))), shift + 2)
#define PAIR(line) ((SUM)(line[2 * i] + line[2 * i + 1]))
#define MORE(a, b) ((a) > (b) ? (a) : (b))
#define LESS(a, b) ((a) < (b) ? (a) : (b))
    if (!h->lean && pairs)
        for (int64_t i = 0; i < n; i++)
            out[i] = SHARE(PAIR(sums), shift);
    else if (!h->lean)
        for (int64_t i = 0; i < n; i++)
            out[i] = SHARE(sums[i], shift);
    else if (!pairs)
        for (int64_t i = 0; i < n; i++)
            out[i] = LEAN(sums[i], extremes[i]);
    else if (h->lean > 0)
        for (int64_t i = 0; i < n; i++)
            out[i] =
                LEAN(PAIR(sums), MORE(extremes[2 * i], extremes[2 * i + 1]));
    else
        for (int64_t i = 0; i < n; i++)
            out[i] =
                LEAN(PAIR(sums), LESS(extremes[2 * i], extremes[2 * i + 1]));
#undef LEAN
#undef PAIR
#undef MORE
#undef LESS
}

/* All voxels have the same weight. */
static void NAME(even_row)(const downsampling *h, const row_taps *rows,
                           const scratch_lines *lines, void *out) {
    NAME(add_rows)(h, rows, lines->work);
    if (h->lean)
        NAME(extreme_rows)(h, rows, lines->extremes);
    NAME(join)(h, lines->work, lines->extremes, out);
}
#endif

/* Of the voxels of the lines that a voxel is made of. */
static TYPE NAME(column)(const downsampling *h, const column_taps *taps,
                         const WORK *means, const TYPE *extremes) {
    WORK mean = 0;
    TYPE extreme = extremes[taps->first];
    for (int n = 0; n < taps->count; n++) {
        TYPE other = extremes[taps->first + n];
        mean += (WORK)taps->weights[n] * means[taps->first + n];
        if (h->lean > 0 ? other > extreme : other < extreme)
            extreme = other;
    }
    if (h->lean)
        mean += (WORK)SNOW_DOWNSAMPLE_LEAN * ((WORK)extreme - mean);
    return REAL(mean);
}

/* They have not. */
static void NAME(odd_row)(const downsampling *h, const row_taps *rows,
                          const scratch_lines *lines, void *out) {
    TYPE *to = out, *extremes = lines->extremes;
    WORK *restrict means = lines->work;
    int64_t n = h->width;
    for (int64_t i = 0; i < n; i++)
        means[i] = 0;
    for (int tap = 0; tap < rows->count; tap++) {
        const TYPE *restrict row = row_of(h, rows, tap);
        WORK weight = (WORK)rows->weights[tap];
        for (int64_t i = 0; i < n; i++)
            means[i] += weight * (WORK)row[i];
    }
    NAME(extreme_rows)(h, rows, extremes);
    for (int64_t i = 0; i < h->out->info.dims[0]; i++)
        to[i] = NAME(column)(h, &h->columns[i], means, extremes);
}

#undef TYPE
#undef WORK
#undef REAL
#undef SUM
#undef SHARE
#undef NAME
