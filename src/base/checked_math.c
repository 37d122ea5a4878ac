/* base/checked_math.c - arithmetic on sizes that reports an overflow. */
#include "base/base.h"

bool snow_mul_u64(uint64_t a, uint64_t b, uint64_t *out) {
    if (b && a > UINT64_MAX / b)
        return false;
    *out = a * b;
    return true;
}

bool snow_add_u64(uint64_t a, uint64_t b, uint64_t *out) {
    if (a > UINT64_MAX - b)
        return false;
    *out = a + b;
    return true;
}

int64_t snow_last_up_to(const int64_t *numbers, int64_t low, int64_t high,
                        int64_t most) {
    while (low < high) {
        int64_t middle = high - (high - low) / 2;
        if (numbers[middle] <= most)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}
