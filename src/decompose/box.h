/* decompose/box.h - boxes of voxels of a grid. */
#ifndef SNOW_BOX_H
#define SNOW_BOX_H

#include <stdbool.h>
#include <stdint.h>

/* Voxels first .. first + count - 1 along x, y, z; empty where a count is 0. */
typedef struct snow_box {
    int64_t first[3], count[3];
} snow_box;

static inline int64_t snow_box_voxels(const snow_box *box) {
    return box->count[0] * box->count[1] * box->count[2];
}

/* What two boxes share; false where that is nothing, with *out untouched. */
static inline bool snow_box_intersect(const snow_box *a, const snow_box *b,
                                      snow_box *out) {
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

#endif
