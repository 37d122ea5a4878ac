/* tests/render/test_deterministic.c - parts of a volume: where they lie, and
 * what they need of their neighbours.  That their local images make up the
 * whole picture test_ranks shows, and in which order they are seen test_order.
 */
#include "reference/model.h"

#include "render/ghosts.h"
#include "render/job.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

/* --- boxes ---------------------------------------------------------------- */

static snow_volume *small_volume(const model_stage *stage) {
    static const unsigned char voxels[4 * 5 * 6];
    const snow_volume_info info = {
        .size = sizeof info,
        .dims = {4, 5, 6},
        .type = SNOW_TYPE_UINT8,
        .matrix = {{2, 0, 0, 10}, {0, 3, 0, 20}, {0, 0, 4, 30}, {0, 0, 0, 1}}};
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_wrap(stage->context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

static void a_part_knows_its_place_in_the_whole(void **state) {
    static const snow_extent all = {
        sizeof all, {4, 5, 6}, {0, 0, 0}, {0, 0, 0}, {4, 5, 6}};
    static const snow_extent part = {
        sizeof part, {9, 5, 20}, {3, 0, 14}, {4, 0, 15}, {2, 5, 5}};
    snow_volume *volume = small_volume(*state);
    snow_extent given = {.size = sizeof given};
    snow_volume_info whole = {.size = sizeof whole};
    snow_volume_get_extent(volume, &given);
    assert_memory_equal(&given, &all, sizeof given);
    assert_int_equal(snow_volume_set_extent(volume, &part), SNOW_STATUS_OK);
    snow_volume_get_extent(volume, &given);
    assert_memory_equal(&part, &given, sizeof part);
    snow_volume_whole(volume, &whole);
    assert_memory_equal(whole.dims, part.dims, sizeof whole.dims);
    assert_near(whole.matrix[0][3], 10 - 3 * 2, 1e-12);
    assert_near(whole.matrix[1][3], 20, 1e-12);
    assert_near(whole.matrix[2][3], 30 - 14 * 4, 1e-12);
    snow_volume_close(volume);
}

static void boxes_that_do_not_lie_in_one_another_are_refused(void **state) {
    static const int64_t bad[][4][3] = {
        /* beyond the grid, before it, not stored */
        {{9, 5, 20}, {6, 0, 14}, {6, 0, 14}, {2, 5, 5}},
        {{9, 5, 20}, {-1, 0, 14}, {0, 0, 14}, {2, 5, 5}},
        {{9, 5, 20}, {3, 0, 14}, {2, 0, 14}, {2, 5, 5}},
        {{9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {5, 5, 5}},
        {{9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {-1, 5, 5}},
        {{9, 0, 20}, {3, 0, 14}, {3, 0, 14}, {1, 5, 5}},
        {{9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {INT64_MAX, 5, 5}},
        {{9, 5, 20}, {INT64_MAX, 0, 14}, {INT64_MAX, 0, 14}, {1, 5, 5}},
    };
    const model_stage *stage = *state;
    snow_volume *volume = small_volume(stage);
    snow_extent part = {.size = sizeof part};
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        memcpy(part.dims, bad[n][0], sizeof part.dims);
        memcpy(part.stored, bad[n][1], sizeof part.stored);
        memcpy(part.first, bad[n][2], sizeof part.first);
        memcpy(part.count, bad[n][3], sizeof part.count);
        assert_int_equal(snow_volume_set_extent(volume, &part),
                         SNOW_STATUS_BAD_USAGE);
        assert_non_null(
            strstr(snow_context_message(stage->context), "is not inside"));
        snow_volume_get_extent(volume, &part);
        assert_int_equal(part.dims[0], 4);
    }
    /* A part may own nothing. */
    const snow_extent none = {
        sizeof none, {9, 5, 20}, {3, 0, 14}, {0, 0, 0}, {0, 0, 0}};
    assert_int_equal(snow_volume_set_extent(volume, &none), SNOW_STATUS_OK);
    snow_volume_close(volume);
}

/* --- ghosts --------------------------------------------------------------- */

/* Asks for a whole of 100 x 80 x 60 voxels. */
static void ghosts(const model_stage *stage, const snow_view *view,
                   const snow_settings *settings, bool fades, bool any_turn,
                   int64_t layers[3]) {
    snow_volume_info whole = snow_volume_info_default("memory");
    whole.dims[0] = 100;
    whole.dims[1] = 80;
    whole.dims[2] = 60;
    whole.type = SNOW_TYPE_UINT8;
    if (snow_ghosts_needed(stage->context, &whole, view, settings, fades,
                           any_turn, layers) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(stage->context));
}

/* In the plane the voxel behind a sample, a gradient's and one for rays that
 * move aside; across slices the other sheet of a slab, and a gradient's.  A
 * cubic kernel takes a voxel more.  Footprints reach 2 voxels from a sample
 * half a voxel outside, and slices none; where pixels are wide they reach as
 * far as they are widened: of 141.4 voxels across 10 pixels w = sqrt(1 +
 * (14.14^2 - 1) / 4) = 7.12, a support of 28.5; at most the whole grid.  Rays
 * of any turn move aside by up to sqrt(2) voxels from slice to slice. */
static void kernels_and_gradients_need_ghosts(void **state) {
#define VALUES SNOW_METHOD_SHEAR_WARP
#define PRINTS SNOW_METHOD_FOOTPRINT
#define CUBIC SNOW_KERNEL_BSPLINE
#define TENT SNOW_KERNEL_TENT
    static const struct {
        const char *view;
        double azimuth;
        int pixels;
        snow_method method;
        bool shaded, any_turn;
        snow_kernel kernel;
        int64_t layers[3];
    } cases[] = {
        {"+z", 0, 512, VALUES, true, false, TENT, {3, 3, 2}},
        {"+z", 0, 512, VALUES, false, false, TENT, {2, 2, 1}},
        {"+z", 0, 512, VALUES, false, false, CUBIC, {3, 3, 2}},
        {"-x", 0, 512, VALUES, false, false, TENT, {1, 2, 2}},
        {"-x", 45, 512, VALUES, false, false, TENT, {2, 1, 2}}, /* along y */
        {"+z", 0, 512, PRINTS, true, false, CUBIC, {3, 3, 1}},
        {"+z", 0, 512, PRINTS, false, false, CUBIC, {2, 2, 0}},
        {"+z", 0, 512, PRINTS, false, false, TENT, {1, 1, 0}},
        {"-x", 0, 512, PRINTS, false, false, TENT, {0, 1, 1}},
        {"+z", 0, 10, VALUES, false, false, TENT, {2, 2, 1}},
        {"+z", 0, 10, PRINTS, false, false, CUBIC, {14, 14, 0}},
        {"+z", 0, 1, PRINTS, false, false, CUBIC, {99, 79, 0}},
        {"iso", 0, 150, VALUES, true, true, TENT, {4, 4, 4}},
        {"iso", 0, 150, PRINTS, true, true, CUBIC, {3, 3, 3}},
    };
    const model_stage *stage = *state;
    for (size_t n = 0; n < 3 * sizeof cases / sizeof *cases; n++) {
        const size_t c = n / 3;
        snow_settings settings;
        snow_view view = {.size = sizeof view};
        int64_t layers[3], faded[3];
        snow_settings_init(&settings);
        assert_int_equal(
            snow_view_from_name(stage->context, cases[c].view, &view),
            SNOW_STATUS_OK);
        view.azimuth = cases[c].azimuth;
        view.width = view.height = cases[c].pixels;
        settings.method = cases[c].method;
        settings.quality = (snow_quality)(n % 3);
        settings.kernel = cases[c].kernel;
        settings.footprint = cases[c].kernel == CUBIC ? 4 : 2;
        settings.shade = cases[c].shaded ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
        ghosts(stage, &view, &settings, false, cases[c].any_turn, layers);
        for (int axis = 0; axis < 3; axis++)
            if (layers[axis] != cases[c].layers[axis])
                fail_msg("case %zu: %lld layers along axis %d", c,
                         (long long)layers[axis], axis);
        /* A gradient opacity needs those of shading. */
        ghosts(stage, &view, &settings, true, cases[c].any_turn, faded);
        settings.shade = SNOW_SHADE_PHONG;
        ghosts(stage, &view, &settings, false, cases[c].any_turn, layers);
        assert_memory_equal(faded, layers, sizeof faded);
    }
}

static void every_turn_needs_no_more_than_the_bound(void **state) {
    static const double turns[] = {-80, -45, -20, 0, 33, 45, 60, 90, 170};
    static const double fovs[] = {0, 0.5, 30, 60};
    const model_stage *stage = *state;
    for (int n = 0; n < 48; n++) {
        snow_settings settings;
        snow_view view = {.size = sizeof view};
        int64_t bound[3], layers[3];
        snow_settings_init(&settings);
        snow_view_from_name(stage->context, "iso", &view);
        settings.quality = (snow_quality)(n % 3);
        settings.method =
            n < 24 ? SNOW_METHOD_SHEAR_WARP : SNOW_METHOD_FOOTPRINT;
        view.fov = fovs[n / 3 % 4];
        view.width = view.height = n / 12 % 2 ? 30 : 200;
        ghosts(stage, &view, &settings, false, true, bound);
        for (int turn = 0; turn < 81; turn++) {
            view.azimuth = turns[turn / 9];
            view.elevation = turns[turn % 9];
            ghosts(stage, &view, &settings, false, false, layers);
            for (int axis = 0; axis < 3; axis++)
                assert_true(layers[axis] <= bound[axis]);
        }
    }
}

/* --- pictures of parts ---------------------------------------------------- */

/* Scene number `n` of a sweep: everything varies. */
static reference_scene scene_of(int n) {
    static const double zooms[] = {1, 0.2, 4, 0.55, 1.5};
    static const snow_kernel kernels[] = {SNOW_KERNEL_BSPLINE,
                                          SNOW_KERNEL_BSPLINE, SNOW_KERNEL_TENT,
                                          SNOW_KERNEL_GAUSS, SNOW_KERNEL_BOX};
    reference_scene scene = model_scene(
        (int64_t[]){13, 10, 11}, n % 3 ? SNOW_TYPE_UINT8 : SNOW_TYPE_FLOAT32,
        n % 4 == 0, (model_matrix)(n % MODEL_MATRICES), (uint64_t)(n + 1));
    model_stand_at(&scene, (size_t)n, zooms[n % 5]);
    if (n / 6 % 2)
        model_fade(&scene);
    scene.view.fov = n % 2 ? 30 : 0;
    scene.settings.method = SNOW_METHOD_SHEAR_WARP;
    scene.settings.quality = (snow_quality)(n / 2 % 3);
    scene.settings.shade = n / 3 % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    scene.settings.kernel = kernels[n / 5 % 5];
    scene.settings.encoding = (snow_encoding)(n % 4);
    scene.settings.threshold = n % 2 * 10;
    scene.settings.threads = 1 + n % 2;
    /* Half of them so thin that nothing is opaque. */
    if (n % 2)
        scene.settings.opacity_length = 12;
    return scene;
}

/* Draws a part of a scene's volume, all of which is stored. */
static snow_status draw_part(const model_stage *stage,
                             const reference_scene *scene,
                             const snow_extent *part, snow_image **image) {
    snow_volume *volume = model_volume(stage->context, scene);
    snow_transfer *transfer = model_transfer(stage->context, scene);
    assert_int_equal(snow_volume_set_extent(volume, part), SNOW_STATUS_OK);
    snow_status status = snow_frame_render(
        stage->frame, volume, transfer, &scene->view, &scene->settings, image);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static void a_part_that_is_the_whole_gives_the_same_bits(void **state) {
    const model_stage *stage = *state;
    const snow_extent all = {
        sizeof all, {13, 10, 11}, {0, 0, 0}, {0, 0, 0}, {13, 10, 11}};
    for (int n = 0; n < 24; n++) {
        reference_scene scene = scene_of(n);
        snow_image *part = NULL, *whole = model_image(stage, &scene);
        assert_int_equal(draw_part(stage, &scene, &all, &part), SNOW_STATUS_OK);
        assert_int_equal(snow_image_checksum(part), snow_image_checksum(whole));
        snow_image_free(part);
        snow_image_free(whole);
        model_free(&scene);
    }
}

static void a_part_without_voxels_of_its_own_is_transparent(void **state) {
    const model_stage *stage = *state;
    const snow_extent none = {
        .size = sizeof none, .dims = {20, 20, 20}, .stored = {3, 4, 5}};
    for (int n = 0; n < 4; n++) {
        reference_scene scene = scene_of(n);
        snow_image *image = NULL;
        scene.settings.method =
            n < 2 ? SNOW_METHOD_SHEAR_WARP : SNOW_METHOD_FOOTPRINT;
        assert_int_equal(draw_part(stage, &scene, &none, &image),
                         SNOW_STATUS_OK);
        float *pixels = model_spread(image);
        for (int i = 0; i < 64 * 48 * 4; i++)
            assert_true(pixels[i] == 0);
        free(pixels);
        snow_image_free(image);
        model_free(&scene);
    }
}

static void a_part_with_too_few_ghosts_is_refused(void **state) {
    const model_stage *stage = *state;
    reference_scene scene = scene_of(0);
    scene.settings.shade = SNOW_SHADE_PHONG;
    scene.settings.kernel = SNOW_KERNEL_TENT;
    for (int ghosts_there = 2; ghosts_there <= 3; ghosts_there++) {
        const snow_extent part = {sizeof part,
                                  {30, 10, 11},
                                  {3, 0, 0},
                                  {3 + ghosts_there, 0, 0},
                                  {13 - 2 * ghosts_there, 10, 11}};
        snow_image *image = NULL;
        assert_int_equal(draw_part(stage, &scene, &part, &image),
                         ghosts_there < 3 ? SNOW_STATUS_BAD_USAGE
                                          : SNOW_STATUS_OK);
        if (ghosts_there < 3)
            assert_non_null(strstr(snow_context_message(stage->context),
                                   "needs 3 layers of ghost voxels along x"));
        snow_image_free(image);
    }
    model_free(&scene);
}

/* --- groups of slices ----------------------------------------------------- */

static void slabs_of_groups_are_made_of_whole_nodes(void **state) {
    (void)state;
    static const int64_t sizes[] = {1, 5, 31, 32, 33, 100, 513};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (int parts = 1; parts <= 40; parts++) {
            int64_t end = 0;
            for (int part = 0; part < parts; part++) {
                snow_slab slab = snow_slab_grouped(sizes[s], parts, part);
                snow_group_node nodes[SNOW_NODES_MOST];
                int count = snow_group_nodes(sizes[s], slab, nodes);
                if (slab.count == 0) {
                    assert_int_equal(count, 0);
                    continue;
                }
                assert_int_equal(slab.first, end);
                assert_true(count > 0 && count <= SNOW_NODES_MOST);
                int group = nodes[0].index << nodes[0].rank;
                assert_int_equal(snow_group_slab(sizes[s], group).first, end);
                for (int n = 0; n < count; n++) {
                    assert_int_equal(nodes[n].index << nodes[n].rank, group);
                    group += 1 << nodes[n].rank;
                }
                end = slab.first + slab.count;
            }
            assert_int_equal(end, sizes[s]);
        }
    snow_group_node nodes[SNOW_NODES_MOST];
    assert_int_equal(snow_group_nodes(100, (snow_slab){1, 4}, nodes), -1);
    assert_int_equal(snow_group_nodes(320, (snow_slab){0, 320}, nodes), 1);
    assert_int_equal(nodes[0].rank, SNOW_GROUP_RANKS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(a_part_knows_its_place_in_the_whole),
        MODEL_TEST(boxes_that_do_not_lie_in_one_another_are_refused),
        MODEL_TEST(kernels_and_gradients_need_ghosts),
        MODEL_TEST(every_turn_needs_no_more_than_the_bound),
        MODEL_TEST(a_part_that_is_the_whole_gives_the_same_bits),
        MODEL_TEST(a_part_without_voxels_of_its_own_is_transparent),
        MODEL_TEST(a_part_with_too_few_ghosts_is_refused),
        cmocka_unit_test(slabs_of_groups_are_made_of_whole_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
