/* formats/raw/advice.c - what a raw file of the wrong size may be: dims and
 * types that hold just its bytes. */
#include "formats/raw/raw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The most dims that are listed; more confuse. */
#define MOST_LISTED 4

typedef struct advice {
    uint64_t bytes;
    char *out;
    size_t used, listed;
    int64_t last[3]; /* the dims that were listed last */
} advice;

/* The usual types of a size in bytes. */
static const char *types_of(uint64_t size) {
    switch (size) {
    case 1:
        return "uint8 or int8";
    case 2:
        return "uint16 or int16";
    case 4:
        return "float32, int32 or uint32";
    case 8:
        return "float64";
    default:
        return NULL;
    }
}

/* The product, 0 if it is too large. */
static uint64_t product(const int64_t dims[3]) {
    uint64_t count = 1;
    for (int i = 0; i < 3; i++)
        if (!snow_mul_u64(count, (uint64_t)dims[i], &count))
            return 0;
    return count;
}

/* Lists dims and type if they hold the bytes exactly; types are the usual ones
 * of the size if `type` is not given. */
static void list(advice *a, const int64_t dims[3], uint64_t size,
                 snow_type type) {
    uint64_t count = product(dims), all;
    const char *types = type ? snow_type_name(type) : types_of(size);
    if (!count || !types || !snow_mul_u64(count, size, &all) ||
        all != a->bytes || a->listed == MOST_LISTED ||
        memcmp(dims, a->last, sizeof a->last) == 0)
        return;
    memcpy(a->last, dims, sizeof a->last);
    int length = snprintf(
        a->out + a->used, RAW_ADVICE_BYTES - a->used, "%s%lldx%lldx%lld %s",
        a->listed++ ? ", " : "; what fits: ", (long long)dims[0],
        (long long)dims[1], (long long)dims[2], types);
    a->used += length > 0 ? (size_t)length : 0;
}

/* The dims with another type, and with another number of slices. */
static void list_by_dims(advice *a, const int64_t dims[3], snow_type type) {
    uint64_t count = product(dims), slice;
    if (count && a->bytes % count == 0)
        list(a, dims, a->bytes / count, SNOW_TYPE_NONE);
    int64_t other[3] = {dims[0], dims[1], 1};
    slice = product(other) * (type ? snow_type_size(type) : 0);
    if (!slice || a->bytes % slice || a->bytes / slice > INT64_MAX)
        return;
    other[2] = (int64_t)(a->bytes / slice);
    list(a, other, snow_type_size(type), type);
}

/* Stacks of square slices of usual sides, not much longer than wide. */
static void list_squares(advice *a, uint64_t size, snow_type type) {
    for (uint64_t side = 64; side <= 1024; side *= 2) {
        uint64_t slice = side * side * size, slices = a->bytes / slice;
        const int64_t dims[3] = {(int64_t)side, (int64_t)side, (int64_t)slices};
        if (slices >= side / 8 && slices < side)
            list(a, dims, size, type);
    }
}

/* Squares or cubes of the type, or of any. */
static void list_guesses(advice *a, bool squares, snow_type type) {
    for (uint64_t size = 1; size <= 8; size *= 2) {
        if (type && snow_type_size(type) != size)
            continue;
        if (squares)
            list_squares(a, size, type);
        else {
            int64_t side = (int64_t)(cbrt((double)(a->bytes / size)) + 0.5);
            const int64_t dims[3] = {side, side, side};
            list(a, dims, size, type);
        }
    }
}

void snow_raw_list_fitting(uint64_t bytes, const snow_volume_options *options,
                           char out[RAW_ADVICE_BYTES]) {
    advice a = {.bytes = bytes, .out = out};
    out[0] = 0;
    if (options->dims[0])
        list_by_dims(&a, options->dims, options->type);
    else
        list_guesses(&a, true, options->type);
    list_guesses(&a, false, options->type);
}
