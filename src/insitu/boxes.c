/* insitu/boxes.c - boxes of voxels within the grid of all ranks. */
#include "insitu/internal.h"

snow_box snow_insitu_grow_box(const snow_box *box, const int64_t low[3],
                              const int64_t high[3], const int64_t dims[3]) {
    snow_box out;
    for (int i = 0; i < 3; i++) {
        int64_t end = box->first[i] + box->count[i];
        int64_t to_end = dims[i] - end;
        out.first[i] = box->first[i] > low[i] ? box->first[i] - low[i] : 0;
        out.count[i] =
            end + (high[i] < to_end ? high[i] : to_end) - out.first[i];
    }
    return out;
}

bool snow_insitu_box_holds(const snow_box *outer, const snow_box *inner) {
    for (int i = 0; i < 3; i++)
        if (inner->first[i] < outer->first[i] ||
            inner->first[i] + inner->count[i] >
                outer->first[i] + outer->count[i])
            return false;
    return true;
}
