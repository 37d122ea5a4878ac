/* tests/parallel/test_shear_warp_layer_parts.c - two volumes in one picture by
 * parts: slabs of both files and many ranks make the picture of one process in
 * memory, which test_shear_warp_layers.c holds against the reference. */
#include "reference/model.h"
#include "support/files.h"
#include "support/scenario.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* As of one volume (test_shear_warp_parts.c), whose parts are the layer's too.
 */
#define BOUND_PARTS(ranks) (1.25 * 1.25 * (0.5 / 255 + (ranks)*1.0 / 32767))

static const snow_color_point names[] = {{0, 1, 0, 0},  {30, 1, 0, 0},
                                         {30, 0, 1, 0}, {60, 0, 1, 0},
                                         {60, 0, 0, 1}, {100, 0, 0, 1}};
static const snow_color_point hot[] = {{0, 0.4, 0, 0}, {100, 1, 0.9, 0.2}};
static const snow_opacity_point some[] = {{0, 0}, {55, 0}, {75, 0.4}, {100, 1}};
static const snow_opacity_point clear[] = {
    {0, 0}, {45, 0}, {45, 0.3}, {100, 0.3}};
static const snow_opacity_point faint[] = {{0, 0.0002}, {100, 0.0015}};

static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                  SNOW_TYPE_FLOAT32, SNOW_TYPE_UINT16};
static const model_matrix matrices[] = {MODEL_PLAIN, MODEL_ANISOTROPIC,
                                        MODEL_OBLIQUE, MODEL_MIRRORED};

/* Slices along all axes from both sides, some in perspective. */
static reference_scene numbered(int n, int64_t depth) {
    static const double backs[][3] = {{0, 0, 1},  {0, 1, 0},  {1, 0, 0},
                                      {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}};
    static const double ups[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    reference_scene s =
        model_scene((int64_t[]){25, 22, depth}, types[n % 4], n % 5 == 0,
                    matrices[n / 2 % 4], (uint64_t)n + 1);
    s.info.medical = true;
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.threads = 1 + n % 2;
    s.settings.quality = (snow_quality)(n % 3);
    s.settings.shade = n / 3 % 3 == 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    s.opacities = n % 7 == 5 ? faint : some;
    s.opacity_count = n % 7 == 5 ? COUNT(faint) : COUNT(some);
    model_look(&s, backs[n % 6], ups[n % 3]);
    model_turn(&s, n % 2 ? 25 : -33, n * 37 % 70 - 35, n % 4 ? 0 : 15, 1.1);
    s.view.width = 50;
    s.view.height = 42;
    s.view.fov = n % 4 == 2 ? 25 : 0;
    if (n % 5 == 4) {
        s.settings.kernel = SNOW_KERNEL_BSPLINE;
        s.settings.footprint = 4;
    }
    return s;
}

/* Labels or values: on the grid; with half the voxels; along x the other way.
 */
static reference_scene layer_of(const reference_scene *base, int n) {
    const int64_t *dims = base->info.dims;
    const bool coarse = n % 3 == 1, turned = n % 3 == 2, labels = n / 3 % 2;
    const int64_t own[3] = {dims[0] / (1 + coarse), dims[1] / (1 + coarse),
                            dims[2] / (1 + coarse)};
    reference_scene s =
        model_scene(own, labels ? SNOW_TYPE_UINT8 : types[(n + 1) % 4], false,
                    MODEL_PLAIN, (uint64_t)n + 100);
    memcpy(s.info.matrix, base->info.matrix, sizeof s.info.matrix);
    s.info.medical = true;
    for (int row = 0; row < 3; row++) {
        double *m = s.info.matrix[row];
        for (int axis = 0; axis < 3; axis++) {
            m[3] += coarse ? m[axis] / 2 : 0;
            m[axis] *= 1 + coarse;
        }
        m[3] += turned ? m[0] * (double)(dims[0] - 1) : 0;
        m[0] *= turned ? -1 : 1;
    }
    s.colors = labels ? names : hot;
    s.color_count = labels ? COUNT(names) : COUNT(hot);
    s.opacities = labels ? clear : some;
    s.opacity_count = COUNT(clear);
    return s;
}

static void save(const support_files *place, const reference_scene *s,
                 const char *path) {
    snow_volume *volume;
    assert_int_equal(
        snow_volume_wrap(place->context, &s->info, s->voxels, &volume),
        SNOW_STATUS_OK);
    if (snow_volume_save(volume, path, true) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    snow_volume_close(volume);
}

static void free_numbered(reference_scene *s) {
    free((void *)(uintptr_t)s->voxels);
}

/* --- slabs of files ------------------------------------------------------- */

/* Both in memory (slices 0), or in slabs of so many bytes. */
static snow_image *picture_of(support_files *place, snow_frame *frame,
                              const scenario *p,
                              const snow_volume_options *options,
                              uint64_t bytes) {
    snow_context *context = place->context;
    const char *path = support_path(place, "base.mha");
    snow_volume *base, *layer, *cut;
    snow_image *image;
    if (bytes) {
        assert_int_equal(
            snow_volume_open_streamed(context, path, options, bytes, &base),
            SNOW_STATUS_OK);
        snow_volume_options own = *options;
        memset(own.crop, 0, sizeof own.crop);
        assert_int_equal(
            snow_volume_open_streamed(context, p->layer, &own, bytes, &layer),
            SNOW_STATUS_OK);
    } else {
        assert_int_equal(snow_volume_open(context, path, options, &base),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_volume_open(context, p->layer, NULL, &layer),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_volume_regrid(&layer, base,
                                            snow_transfer_has_labels(
                                                p->layer_look, &layer->info)),
                         SNOW_STATUS_OK);
        if (options->clip[0][2] != 0) {
            assert_int_equal(snow_volume_clip(layer, options->clip[0], 1, &cut),
                             SNOW_STATUS_OK);
            snow_volume_close(layer);
            layer = cut;
        }
    }
    const snow_layer inlay = {.volume = layer, .transfer = p->layer_look};
    assert_int_equal(snow_frame_set_layers(frame, &inlay, 1), SNOW_STATUS_OK);
    if (snow_frame_render(frame, base, p->transfer, &p->view, &p->settings,
                          &image) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    assert_int_equal(snow_frame_stats(frame)->method, SNOW_METHOD_SHEAR_WARP);
    assert_int_equal(snow_frame_set_layers(frame, NULL, 0), SNOW_STATUS_OK);
    snow_volume_close(layer);
    snow_volume_close(base);
    return image;
}

/* Two scenes, and the files that they are in. */
static scenario open_pair(support_files *place, int n, int64_t depth,
                          reference_scene *base, reference_scene *layer) {
    *base = numbered(n, depth);
    *layer = layer_of(base, n);
    save(place, base, support_path(place, "base.mha"));
    save(place, layer, support_path(place, "layer.mha"));
    return (scenario){.info = base->info,
                      .voxels = base->voxels,
                      .transfer = model_transfer(place->context, base),
                      .layer = support_path(place, "layer.mha"),
                      .layer_look = model_transfer(place->context, layer),
                      .view = base->view,
                      .settings = base->settings,
                      .how = {.size = sizeof(snow_ranks_options),
                              .combining = (snow_combine)(n % 5)},
                      .pictures = 1 + n % 2};
}

static void close_pair(scenario *p, reference_scene *base,
                       reference_scene *layer) {
    snow_transfer_free((snow_transfer *)(uintptr_t)p->transfer);
    snow_transfer_free((snow_transfer *)(uintptr_t)p->layer_look);
    free_numbered(base);
    free_numbered(layer);
}

static double gap_of(snow_image *a, snow_image *b) {
    double most = 0;
    assert_int_equal(snow_image_channels(a), snow_image_channels(b));
    for (int n = 0; n < 50 * 42 * snow_image_channels(a); n++)
        most = fmax(most, fabs((double)snow_image_pixels(a)[n] -
                               (double)snow_image_pixels(b)[n]));
    return most;
}

/* But where values are resampled: in memory their range is known then, and that
 * of the file is somewhat more, so that their 14 bits and the nodes of their
 * table are others. */
static void slabs_of_both_files_make_the_same_bits(void **state) {
    static const uint64_t slices[] = {1, 7, 12, 1000};
    support_files *place = *state;
    snow_frame *frame;
    double most = 0;
    assert_int_equal(snow_frame_new(place->context, &frame), SNOW_STATUS_OK);
    for (int n = 0; n < 24; n++) {
        if (!support_takes((size_t)n, 7))
            continue;
        reference_scene base, layer;
        scenario p = open_pair(place, n, 29, &base, &layer);
        snow_volume_options options = {.size = sizeof options};
        if (n % 4 == 3) {
            const double plane[4] = {0.3, n % 5 - 2, 0.7, n % 5 ? 8 : 2};
            memcpy(options.clip[0], plane, sizeof plane);
            options.crop[1][0] = 2;
            options.crop[2][1] = 28;
        }
        const uint64_t bytes = slices[(n + n / 4) % 4] * 25 * 22 *
                               (uint64_t)snow_type_size(base.info.type);
        snow_image *a = picture_of(place, frame, &p, &options, 0);
        for (int again = 0; again < 2; again++) {
            snow_image *b = picture_of(place, frame, &p, &options, bytes);
            assert_int_equal(snow_image_channels(a), snow_image_channels(b));
            const double gap = gap_of(a, b);
            if (n % 3 == 1 && n / 3 % 2 == 0)
                most = fmax(most, gap);
            else if (gap != 0)
                fail_msg("picture %d, %d bytes: %g; %s", n, (int)bytes,
                         gap * 255, model_words(&base));
            snow_image_free(b);
        }
        snow_image_free(a);
        close_pair(&p, &base, &layer);
    }
    print_message("             where values are resampled %.2g of a step\n",
                  most * 255);
    assert_true(most <= 6.0 / 255);
    snow_frame_free(frame);
}

/* --- many ranks ----------------------------------------------------------- */

static const int rank_counts[] = {2, 3, 5, 8, 16, 33};

static void ranks_make_the_picture_of_one(void **state) {
    support_files *place = *state;
    double most = 0, seen = 0;
    int scenes = 0;
    for (int n = 0; n < 24; n++) {
        if (!support_takes((size_t)n, 11))
            continue;
        scenes++;
        reference_scene base, layer;
        scenario p = open_pair(place, n, 24, &base, &layer);
        double strongest;
        float *alone = scenario_alone(place->context, &p, &strongest);
        int ranks = rank_counts[(size_t)(n + n / 6) % COUNT(rank_counts)];
        p.cut = (partitioning)(n / 2 % PARTITIONINGS);
        scenario_by_ranks(place->context, &p, ranks);
        double gap = scenario_gap(&p, alone);
        if (!(gap <= BOUND_PARTS(ranks)))
            fail_msg("picture %d, %d ranks, cut %d: %g; %s", n, ranks,
                     (int)p.cut, gap * 255, model_words(&base));
        most = fmax(most, gap);
        seen += strongest;
        free(p.picture);
        free(alone);
        close_pair(&p, &base, &layer);
    }
    print_message("             %d pictures differ by up to %.2g of a step\n",
                  scenes, most * 255);
    assert_true(seen > 0.3 * scenes);
}

static void deterministic_pictures_have_the_same_bytes(void **state) {
    support_files *place = *state;
    for (int n = 0; n < 16; n++) {
        if (!support_takes((size_t)n, 9))
            continue;
        reference_scene base, layer;
        scenario p = open_pair(place, n, n % 2 ? 24 : 47, &base, &layer);
        double strongest;
        float *usual = scenario_alone(place->context, &p, &strongest);
        p.settings.deterministic = 1;
        float *alone = scenario_alone(place->context, &p, &strongest);
        int ranks = rank_counts[(size_t)(n + n / 6) % COUNT(rank_counts)];
        p.cut = GROUPED;
        p.picture = usual;
        assert_true(scenario_gap(&p, alone) <= BOUND_PARTS(32));
        scenario_by_ranks(place->context, &p, ranks);
        if (memcmp(p.picture, alone, scenario_floats(&p) * sizeof(float)) != 0)
            fail_msg("picture %d, %d ranks: %g; %s", n, ranks,
                     scenario_gap(&p, alone), model_words(&base));
        free(p.picture);
        free(usual);
        free(alone);
        close_pair(&p, &base, &layer);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(slabs_of_both_files_make_the_same_bits,
                                        support_files_setup,
                                        support_files_teardown),
        cmocka_unit_test_setup_teardown(ranks_make_the_picture_of_one,
                                        support_files_setup,
                                        support_files_teardown),
        cmocka_unit_test_setup_teardown(
            deterministic_pictures_have_the_same_bytes, support_files_setup,
            support_files_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
