/* tests/render/test_tile_order.c - the order in which threads take tiles: each
 * once, and by the times of the picture before. */
#include "support/support.h"

#include "render/shear_warp/internal.h"

#define TILES 700

/* Each tile is there once. */
static void check_all(const snow_value_image *image, int tiles) {
    bool seen[TILES] = {false};
    for (int n = 0; n < tiles; n++) {
        const int32_t tile = image->turns[n].tile;
        assert_true(tile >= 0 && tile < tiles);
        assert_false(seen[tile]);
        seen[tile] = true;
    }
}

static void longest_come_first(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_value_image image = {.grid.tiles = {35, 20}};
    float took[TILES];
    uint64_t random = 5;
    assert_int_equal(snow_value_order_tiles(context, &image), SNOW_STATUS_OK);
    for (int n = 0; n < TILES; n++)
        assert_int_equal(image.turns[n].tile, n);
    for (int picture = 0; picture < 3; picture++) {
        for (int n = 0; n < TILES; n++) {
            const float seconds = (float)support_uniform(&random);
            image.turns[n].seconds = seconds;
            took[image.turns[n].tile] = seconds;
        }
        assert_int_equal(snow_value_order_tiles(context, &image),
                         SNOW_STATUS_OK);
        check_all(&image, TILES);
        for (int n = 0; n < TILES; n++)
            assert_true(image.turns[n].seconds == took[image.turns[n].tile]);
        for (int n = 1; n < TILES; n++) /* to a sixtieth of the longest */
            assert_true(image.turns[n].seconds <=
                        image.turns[n - 1].seconds + 1 / 60.0F);
    }
    /* Another grid begins anew. */
    image.grid.tiles[0] = 7;
    assert_int_equal(snow_value_order_tiles(context, &image), SNOW_STATUS_OK);
    for (int n = 0; n < 140; n++)
        assert_int_equal(image.turns[n].tile, n);
    snow_release(context, image.turns);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(longest_come_first)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
