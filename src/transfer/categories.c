/* transfer/categories.c - whether the values that a transfer function shows are
 * the numbers of things rather than quantities. */
#include "transfer/transfer.h"

static bool same_color(const snow_color_point *a, const snow_color_point *b) {
    return a->red == b->red && a->green == b->green && a->blue == b->blue;
}

bool snow_transfer_has_categories(const snow_transfer *transfer) {
    const snow_color_point *c = transfer->colors;
    for (size_t n = 1; n < transfer->color_count; n++)
        if (c[n].value == c[n - 1].value && !same_color(&c[n], &c[n - 1]))
            return true;
    return false;
}

bool snow_transfer_has_labels(const snow_transfer *transfer, snow_type type) {
    const snow_color_point *c = transfer->colors;
    for (size_t n = 1; n < transfer->color_count; n++)
        if (c[n].value != c[n - 1].value && !same_color(&c[n], &c[n - 1]))
            return false;
    return type < SNOW_TYPE_FLOAT32 && snow_transfer_has_categories(transfer);
}
