/* formats/axes.c - assigns x, y, z, time and channel to the axes of an array.
 */
#include "formats/axes.h"

/* Pictures of two axes, one of them time, stay pictures. */
static int find_time(int rank, const snow_axis_hint *hints) {
    for (int i = rank - 1; i >= 0 && rank > 2; i--)
        if (hints[i].time || (hints[i].duration && i == rank - 1))
            return i;
    return -1;
}

/* `others` are the axes that are not time. */
static bool holds_components(const int64_t *sizes, const snow_axis_hint *hint,
                             const int *others, int count) {
    if (hint->components)
        return count > 2;
    return count > 3 && sizes[others[0]] >= 1 && sizes[others[0]] <= 4 &&
           sizes[others[1]] > sizes[others[0]] && !hint->space;
}

/* The slowest axis that has no meaning yet. */
static int slowest(const int *left, int *count) {
    return left[--*count];
}

bool snow_axes_assign(int rank, const int64_t sizes[SNOW_MOST_AXES],
                      const snow_axis_hint hints[SNOW_MOST_AXES],
                      snow_axes *out) {
    int left[SNOW_MOST_AXES], count = 0;
    *out = (snow_axes){{-1, -1, -1}, find_time(rank, hints), -1, false};
    for (int i = 0; i < rank; i++)
        if (i != out->time)
            left[count++] = i;
    int first = 0;
    if (count && holds_components(sizes, &hints[left[0]], left, count)) {
        out->channel = left[first++];
        out->interleaved = true;
    }
    if (count - first > 3 && out->time < 0)
        out->time = slowest(left, &count);
    if (count - first > 3 && out->channel < 0)
        out->channel = slowest(left, &count);
    for (int i = 0; i < 3 && first + i < count; i++)
        out->space[i] = left[first + i];
    return count - first <= 3;
}
