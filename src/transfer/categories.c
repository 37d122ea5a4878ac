/* transfer/categories.c - whether the values that a transfer function shows are
 * the numbers of things rather than quantities. */
#include "transfer/transfer.h"

static bool same_color(const snow_color_point *a, const snow_color_point *b) {
    return a->red == b->red && a->green == b->green && a->blue == b->blue;
}

/* Colours of categories have steps, and do not change in between. */
bool snow_transfer_has_labels(const snow_transfer *transfer, snow_type type) {
    const snow_color_point *c = transfer->colors;
    bool steps = false;
    for (size_t n = 1; n < transfer->color_count; n++) {
        if (same_color(&c[n], &c[n - 1]))
            continue;
        if (c[n].value != c[n - 1].value)
            return false;
        steps = true;
    }
    return steps && type < SNOW_TYPE_FLOAT32;
}
