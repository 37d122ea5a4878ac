/* render/shear_warp/order.c - in which order threads take the tiles: those that
 * took longest in the picture before come first, so that no thread is left with
 * a long one at the end.  It changes no bit. */
#include "render/shear_warp/internal.h"

#include <string.h>

/* Times that are told apart. */
#define LENGTHS 64

/* 0 for the longest. */
static int length_of(const snow_value_turn *turn, float longest) {
    return longest > 0
               ? (int)((1 - turn->seconds / longest) * (LENGTHS - 1) + 0.5F)
               : 0;
}

snow_status snow_value_order_tiles(snow_context *context,
                                   snow_value_image *image) {
    const size_t tiles = snow_value_tiles(image);
    size_t first[LENGTHS + 1] = {0};
    float longest = 0;
    SNOW_TRY(SNOW_RESERVE(context, image->turns, 0, 2 * tiles));
    snow_value_turn *turns = image->turns, *sorted = turns + tiles;
    for (size_t n = 0; image->turn_count != tiles && n < tiles; n++)
        turns[n] = (snow_value_turn){.tile = (int32_t)n};
    image->turn_count = tiles;
    for (size_t n = 0; n < tiles; n++)
        longest = turns[n].seconds > longest ? turns[n].seconds : longest;
    for (size_t n = 0; n < tiles; n++)
        first[length_of(&turns[n], longest) + 1]++;
    for (int n = 0; n < LENGTHS; n++)
        first[n + 1] += first[n];
    for (size_t n = 0; n < tiles; n++)
        sorted[first[length_of(&turns[n], longest)]++] = turns[n];
    memcpy(turns, sorted, tiles * sizeof *turns);
    return SNOW_STATUS_OK;
}
