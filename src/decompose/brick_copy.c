/* decompose/brick_copy.c - boxes of voxels: what two share, and copies between
 * memories of any strides. */
#define _DEFAULT_SOURCE /* madvise */
#include "decompose/redistribute.h"
#include "decompose/slab.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Side of the blocks in which strided voxels are copied: at most 16 * 16 cache
 * lines, whichever axis is the fastest in memory. */
#define TILE 16

/* Voxels of one box, count[0] along x and so on; steps are in values. */
typedef struct copy_params {
    const char *from;
    char *to;
    int64_t from_step[3], to_step[3], count[3];
} copy_params;

#define COPY_VALUES(bits)                                                   \
    static void copy_##bits(const copy_params *o) {                         \
        for (int64_t z = 0; z < o->count[2]; z++)                           \
            for (int64_t y = 0; y < o->count[1]; y++) {                     \
                const uint##bits##_t *from =                                \
                    (const uint##bits##_t *)(const void *)o->from +         \
                    z * o->from_step[2] + y * o->from_step[1];              \
                uint##bits##_t *to = (uint##bits##_t *)(void *)o->to +      \
                                     z * o->to_step[2] + y * o->to_step[1]; \
                for (int64_t x = 0; x < o->count[0]; x++)                   \
                    to[x] = from[x * o->from_step[0]];                      \
            }                                                               \
    }
COPY_VALUES(8)
COPY_VALUES(16)
COPY_VALUES(32)
COPY_VALUES(64)

static void copy_block(const copy_params *o, size_t value) {
    switch (value) {
    case 1:
        copy_8(o);
        break;
    case 2:
        copy_16(o);
        break;
    case 4:
        copy_32(o);
        break;
    default:
        copy_64(o);
        break;
    }
}

/* The block of a copy that begins at `at`. */
static copy_params block_at(const copy_params *o, const int64_t at[3],
                            size_t value) {
    copy_params block = *o;
    for (int i = 0; i < 3; i++) {
        int64_t left = o->count[i] - at[i];
        block.from += at[i] * o->from_step[i] * (int64_t)value;
        block.to += at[i] * o->to_step[i] * (int64_t)value;
        block.count[i] = left < TILE ? left : TILE;
    }
    return block;
}

static void copy(const copy_params *o, size_t value) {
    if (o->from_step[0] == 1) {
        /* Rows that are contiguous in memory. */
        int64_t bytes = (int64_t)value;
        for (int64_t z = 0; z < o->count[2]; z++)
            for (int64_t y = 0; y < o->count[1]; y++)
                memcpy(o->to + (z * o->to_step[2] + y * o->to_step[1]) * bytes,
                       o->from +
                           (z * o->from_step[2] + y * o->from_step[1]) * bytes,
                       (size_t)(o->count[0] * bytes));
        return;
    }
    int64_t at[3];
    for (at[2] = 0; at[2] < o->count[2]; at[2] += TILE)
        for (at[1] = 0; at[1] < o->count[1]; at[1] += TILE)
            for (at[0] = 0; at[0] < o->count[0]; at[0] += TILE) {
                copy_params block = block_at(o, at, value);
                copy_block(&block, value);
            }
}

void snow_brick_copy(const snow_brick *brick, size_t value, const snow_box *box,
                     const snow_box *whole, void *dense) {
    copy_params o = {
        .from = brick->voxels,
        .to = dense,
        .to_step = {1, whole->count[0], whole->count[0] * whole->count[1]}};
    for (int i = 0; i < 3; i++) {
        int64_t bytes = (int64_t)value;
        o.from_step[i] = brick->stride[i];
        o.count[i] = box->count[i];
        o.from +=
            (box->first[i] - brick->box.first[i]) * o.from_step[i] * bytes;
        o.to += (box->first[i] - whole->first[i]) * o.to_step[i] * bytes;
    }
    copy(&o, value);
}

int64_t snow_box_voxels(const snow_box *box) {
    return box->count[0] * box->count[1] * box->count[2];
}

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

snow_box snow_box_slices(const snow_box *held, int round, int rounds) {
    const snow_slab slab = snow_slab_equal(held->count[2], rounds, round);
    snow_box box = *held;
    box.first[2] += slab.first;
    box.count[2] = slab.count;
    return box;
}

void snow_brick_forget(const snow_brick *brick, int round, int rounds,
                       size_t value) {
    const snow_box box = snow_box_slices(&brick->box, round, rounds);
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const int64_t first = box.first[2] - brick->box.first[2];
    const int64_t size = (box.count[2] - 1) * brick->stride[2] +
                         (box.count[1] - 1) * brick->stride[1] + box.count[0];
    const uintptr_t at = (uintptr_t)brick->voxels +
                         (uintptr_t)(first * brick->stride[2]) * value;
    const uintptr_t begin = (at + page - 1) / page * page;
    const uintptr_t end = (at + (uintptr_t)size * value) / page * page;
    if (snow_box_voxels(&box) && begin < end)
        (void)madvise((void *)begin, end - begin, MADV_DONTNEED);
}
