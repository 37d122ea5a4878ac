/* formats/axes.c - assigns x, y, z, time and channel to the axes of an array.
 */
#include "formats/axes.h"

/* The most components of a voxel, a tensor's, that leave a picture of three
 * axes; more entries are slices. */
#define MOST_OF_PICTURE 9

/* The place among `others`, the axes that are not time, of the one that counts
 * components: said to, or the fastest, by its size.  -1: there is none. */
static int find_components(const int64_t *sizes, const snow_axis_hint *hints,
                           const int *others, int count) {
    for (int n = 0; n < count && count > 2; n++)
        if (hints[others[n]].components &&
            (count > 3 || sizes[others[n]] <= MOST_OF_PICTURE))
            return n;
    const bool few = count > 3 && sizes[others[0]] >= 1 &&
                     sizes[others[0]] <= 4 &&
                     sizes[others[1]] > sizes[others[0]];
    return few && !hints[others[0]].space ? 0 : -1;
}

bool snow_axes_assign(int rank, const int64_t sizes[SNOW_MOST_AXES],
                      const snow_axis_hint hints[SNOW_MOST_AXES],
                      snow_axes *out) {
    int left[SNOW_MOST_AXES], count = 0;
    *out = (snow_axes){{-1, -1, -1}, -1, -1, false};
    /* Pictures of two axes, one of them time, stay pictures. */
    for (int i = rank - 1; i >= 0 && rank > 2 && out->time < 0; i--)
        if (hints[i].time || (hints[i].duration && i == rank - 1))
            out->time = i;
    for (int i = 0; i < rank; i++)
        if (i != out->time)
            left[count++] = i;
    /* Axes of one entry that a program has added behind x: (z, y, x, 1, 1). */
    while (count > 4 && sizes[left[0]] == 1 && sizes[left[1]] == 1 &&
           !hints[left[0]].space && !hints[left[0]].components) {
        count--;
        for (int i = 0; i < count; i++)
            left[i] = left[i + 1];
    }
    const int at = find_components(sizes, hints, left, count);
    if (at >= 0) {
        out->channel = left[at];
        out->interleaved = true;
        count--;
        for (int i = at; i < count; i++)
            left[i] = left[i + 1];
    }
    if (count > 3 && out->time < 0)
        out->time = left[--count];
    if (count > 3 && out->channel < 0)
        out->channel = left[--count];
    for (int i = 0; i < 3 && i < count; i++)
        out->space[i] = left[i];
    return count <= 3;
}
