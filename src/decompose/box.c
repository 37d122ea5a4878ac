/* decompose/box.c - see snowglass/extend.h. */
#include <snowglass/extend.h>

bool snow_box_intersect(const snow_box *a, const snow_box *b, snow_box *out) {
    snow_box shared;
    for (int i = 0; i < 3; i++) {
        int64_t end_a = a->first[i] + a->count[i];
        int64_t end_b = b->first[i] + b->count[i];
        int64_t end = end_a < end_b ? end_a : end_b;
        shared.first[i] = a->first[i] > b->first[i] ? a->first[i] : b->first[i];
        shared.count[i] = end - shared.first[i];
        if (shared.count[i] <= 0)
            return false;
    }
    *out = shared;
    return true;
}
