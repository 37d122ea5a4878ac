/* tests/parallel/test_shear_warp_parts.c - method shear-warp by parts: slabs of
 * a file and many ranks make the picture of one process, which test_truth.c
 * holds against the truth. */
#include "reference/model.h"
#include "support/files.h"
#include "support/scenario.h"

#include "render/picture.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Planes of 15 bits are rounded part by part.  Where a pixel ends half a step
 * of 8 bits may shine through, which parts do later than the whole, and
 * Catmull-Rom's weights along both axes may make 1.25^2 times that of it. */
#define BOUND_PARTS(ranks) (1.25 * 1.25 * (0.5 / 255 + (ranks)*1.0 / 32767))

static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                  SNOW_TYPE_FLOAT32, SNOW_TYPE_UINT16};
static const model_matrix matrices[] = {MODEL_PLAIN, MODEL_ANISOTROPIC,
                                        MODEL_OBLIQUE, MODEL_MIRRORED};

static const snow_opacity_point ramp[] = {
    {0, 0}, {35, 0}, {70, 0.5}, {100, 0.9}};
static const snow_opacity_point steep[] = {
    {0, 0}, {50, 0}, {51.5, 0.9}, {100, 0.9}};
static const snow_opacity_point bands[] = {{0, 0},    {20, 0}, {28, 0.4},
                                           {36, 0},   {55, 0}, {64, 0.7},
                                           {72, 0.1}, {80, 0}, {100, 0}};
static const snow_opacity_point thin[] = {{0, 0.02}, {100, 0.1}};
static const snow_opacity_point faint[] = {{0, 0.0002}, {100, 0.0015}};
/* Steps between constant colours: whole numbers are labels. */
static const snow_color_point names[] = {{0, 1, 0, 0},  {30, 1, 0, 0},
                                         {30, 0, 1, 0}, {60, 0, 1, 0},
                                         {60, 0, 0, 1}, {100, 0, 0, 1}};
static const struct {
    const snow_opacity_point *points;
    size_t count;
} looks[] = {{ramp, COUNT(ramp)},
             {steep, COUNT(steep)},
             {bands, COUNT(bands)},
             {thin, COUNT(thin)},
             {faint, COUNT(faint)}};

/* Takes values away here and there, from a corner and a slice. */
static void make_holes(reference_scene *s) {
    float *voxel = (float *)(uintptr_t)s->voxels;
    const int64_t *dims = s->info.dims;
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++)
            for (int64_t x = 0; x < dims[0]; x++, voxel++)
                if ((x < 9 && y < 8 && z < 10) || z == 14 ||
                    (x + 3 * y + 5 * z) % 61 == 0)
                    *voxel = NAN;
    s->masked = true;
}

/* A scene for each number: slices along all axes from both sides, oblique, some
 * in perspective; all types, spacings, qualities, densities, shades and looks.
 */
static reference_scene numbered(int n, int64_t depth) {
    static const double backs[][3] = {{0, 0, 1},  {0, 1, 0},  {1, 0, 0},
                                      {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}};
    static const double ups[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    static const double zooms[] = {1.1, 2.6, 0.35, 5};
    reference_scene s =
        model_scene((int64_t[]){25, 22, depth}, types[n % 4], n % 5 == 0,
                    matrices[n / 2 % 4], (uint64_t)n + 1);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.threads = 1 + n % 2;
    s.settings.quality = (snow_quality)(n % 3);
    s.settings.shade = n / 3 % 3 == 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    s.settings.encoding = (snow_encoding)(n / 2 % 4);
    s.opacities = looks[(size_t)(n + n / 4) % COUNT(looks)].points;
    s.opacity_count = looks[(size_t)(n + n / 4) % COUNT(looks)].count;
    model_look(&s, backs[n % 6], ups[n % 3]);
    model_turn(&s, n % 2 ? 25 : -33, n * 37 % 70 - 35, n % 4 ? 0 : 15,
               zooms[n / 5 % 4]);
    s.view.width = 50;
    s.view.height = 42;
    s.view.fov = n % 4 == 2 || n % 16 == 9 ? 25 : 0;
    if (n % 7 == 3)
        model_fade(&s);
    if (n % 8 == 1) {
        s.colors = names;
        s.color_count = COUNT(names);
    }
    if (n % 4 == 2 && n % 3 != 1)
        make_holes(&s);
    if (n % 5 == 4) {
        s.settings.kernel = SNOW_KERNEL_BSPLINE;
        s.settings.footprint = 4;
    }
    if (n % 13 == 0) /* smaller images are halved, or means */
        s.view.width = s.view.height = n / 13 % 2 ? 3 : 9;
    return s;
}

/* The same in a mode other than over. */
static reference_scene projected(int n, int64_t depth) {
    static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MEAN,
                                      SNOW_MODE_MINIP, SNOW_MODE_SUM,
                                      SNOW_MODE_ISO};
    reference_scene s = numbered(n, depth);
    s.settings.iso = 30 + n * 17 % 50;
    s.settings.mode = modes[(size_t)(n + n / 6) % COUNT(modes)];
    return s;
}

typedef reference_scene scene_fn(int n, int64_t depth);

static void free_numbered(reference_scene *s) {
    free((void *)(uintptr_t)s->voxels);
}

/* --- slabs of a file ------------------------------------------------------ */

/* A picture of a volume by a frame that has made others. */
static snow_image *image_of(snow_frame *frame, const snow_volume *volume,
                            const snow_transfer *transfer,
                            const reference_scene *s) {
    snow_image *image;
    if (snow_frame_render(frame, volume, transfer, &s->view, &s->settings,
                          &image) != SNOW_STATUS_OK)
        fail_msg("%s", model_words(s));
    return image;
}

/* Whether two pictures are the same: bit by bit, but for sums, which are
 * rounded slab by slab. */
static bool same_picture(const reference_scene *s, snow_image *a,
                         snow_image *b) {
    size_t floats =
        (size_t)(s->view.width * s->view.height * snow_image_channels(a));
    const float *x = snow_image_pixels(a), *y = snow_image_pixels(b);
    if (s->settings.mode != SNOW_MODE_MEAN && s->settings.mode != SNOW_MODE_SUM)
        return memcmp(x, y, floats * sizeof *x) == 0;
    for (size_t n = 0; n < floats; n++)
        if (isnan(x[n]) != isnan(y[n]) ||
            fabsf(x[n] - y[n]) > 2e-6F * (100 + fabsf(x[n])))
            return false;
    return true;
}

/* Slabs of so many slices, ghosts included, make the picture of the volume in
 * memory. */
static void compare_stream(support_files *place, const reference_scene *s,
                           const char *path, const snow_volume_options *options,
                           snow_frame *frame, int slices) {
    snow_volume *whole, *stream;
    assert_int_equal(snow_volume_open(place->context, path, options, &whole),
                     SNOW_STATUS_OK);
    const snow_volume_info *info = snow_volume_get_info(whole);
    uint64_t slice =
        (uint64_t)(info->dims[0] * info->dims[1]) * snow_type_size(info->type);
    snow_transfer *transfer = model_transfer(place->context, s);
    assert_int_equal(snow_volume_open_streamed(place->context, path, options,
                                               slice * (uint64_t)slices,
                                               &stream),
                     SNOW_STATUS_OK);
    snow_image *a = image_of(frame, whole, transfer, s);
    const snow_stats given = *snow_frame_stats(frame);
    snow_image *b = image_of(frame, stream, transfer, s);
    const snow_stats *same = snow_frame_stats(frame);
    assert_int_equal(same->method, SNOW_METHOD_SHEAR_WARP);
    if (same->interesting != given.interesting || same->voxels != given.voxels)
        fail_msg("%lld of %lld voxels, and in slabs %lld of %lld: %s",
                 (long long)given.interesting, (long long)given.voxels,
                 (long long)same->interesting, (long long)same->voxels,
                 model_words(s));
    assert_int_equal(same->encoded, given.encoded);
    if (!same_picture(s, a, b))
        fail_msg("%d slices: %s", slices, model_words(s));
    snow_image_free(a);
    snow_image_free(b);
    snow_transfer_free(transfer);
    snow_volume_close(stream);
    snow_volume_close(whole);
}

static void check_slabs(support_files *place, scene_fn *scene) {
    static const int slices[] = {1, 7, 12, 1000};
    snow_frame *frame;
    assert_int_equal(snow_frame_new(place->context, &frame), SNOW_STATUS_OK);
    for (int n = 0; n < 48; n++) {
        if (!support_takes((size_t)n, 13))
            continue;
        reference_scene s = scene(n, 29);
        snow_volume *volume;
        assert_int_equal(
            snow_volume_wrap(place->context, &s.info, s.voxels, &volume),
            SNOW_STATUS_OK);
        const char *path = support_path(place, "scene.mha");
        if (snow_volume_save(volume, path, true) != SNOW_STATUS_OK)
            fail_msg("%s", snow_context_message(place->context));
        snow_volume_close(volume);
        const snow_volume_options options = {
            .size = sizeof options,
            .clip = {{0.3, n % 5 - 2, 0.7, n % 5 ? 8 : 2}},
            .crop = {{0, 0}, {2, 21}, {3, 28}},
            .mask = s.masked ? path : NULL};
        compare_stream(place, &s, path, n % 3 ? NULL : &options, frame,
                       slices[(size_t)(n + n / 4) % COUNT(slices)]);
        free_numbered(&s);
    }
    snow_frame_free(frame);
}

static void slabs_of_a_file_make_the_same_bits(void **state) {
    check_slabs(*state, numbered);
}

static void slabs_of_a_file_are_projected_alike(void **state) {
    check_slabs(*state, projected);
}

/* --- many ranks ----------------------------------------------------------- */

static scenario scenario_of(const reference_scene *s, int n,
                            const snow_transfer *transfer) {
    return (scenario){.info = s->info,
                      .voxels = s->voxels,
                      .masked = s->masked,
                      .transfer = transfer,
                      .view = s->view,
                      .settings = s->settings,
                      .how = {.size = sizeof(snow_ranks_options),
                              .combining = (snow_combine)(n % 5)},
                      .pictures = 1 + n % 2};
}

static const int rank_counts[] = {2, 3, 5, 8, 16, 33};

/* Extremes are the same numbers; sums are rounded part by part, in data units.
 */
static double bound_of(const reference_scene *s, int ranks) {
    switch (s->settings.mode) {
    case SNOW_MODE_OVER:
    case SNOW_MODE_ISO:
        return BOUND_PARTS(ranks);
    case SNOW_MODE_MIP:
    case SNOW_MODE_MINIP:
        return 1e-6;
    default:
        return 2e-3;
    }
}

static void check_ranks(scene_fn *scene) {
    snow_context *context = support_context();
    double most = 0, seen = 0;
    int scenes = 0;
    for (int n = 0; n < 72; n++) {
        if (!support_takes((size_t)n, 19))
            continue;
        scenes++;
        reference_scene s = scene(n, 24);
        snow_transfer *transfer = model_transfer(context, &s);
        scenario p = scenario_of(&s, n, transfer);
        double strongest;
        float *alone = scenario_alone(context, &p, &strongest);
        int ranks = rank_counts[(size_t)(n + n / 6) % COUNT(rank_counts)];
        p.cut = (partitioning)(n / 2 % PARTITIONINGS);
        scenario_by_ranks(context, &p, ranks);
        double gap = scenario_gap(&p, alone);
        if (!(gap <= bound_of(&s, ranks)))
            fail_msg("%d ranks, cut %d: %g; %s", ranks, (int)p.cut, gap * 255,
                     model_words(&s));
        scenario_check_counts(&p, ranks);
        most = fmax(most, gap);
        seen += strongest;
        free(p.picture);
        free(alone);
        snow_transfer_free(transfer);
        free_numbered(&s);
    }
    print_message("             %d pictures differ by up to %.2g of a step\n",
                  scenes, most * 255);
    assert_true(seen > 0.3 * scenes);
    snow_context_free(context);
}

static void ranks_make_the_picture_of_one(void **state) {
    (void)state;
    check_ranks(numbered);
}

static void ranks_project_what_one_does(void **state) {
    (void)state;
    check_ranks(projected);
}

static void deterministic_pictures_have_the_same_bytes(void **state) {
    (void)state;
    snow_context *context = support_context();
    for (int n = 0; n < 36; n++) {
        if (!support_takes((size_t)n, 19))
            continue;
        reference_scene s = numbered(n, n % 2 ? 24 : 47);
        snow_transfer *transfer = model_transfer(context, &s);
        scenario p = scenario_of(&s, n, transfer);
        double strongest;
        float *usual = scenario_alone(context, &p, &strongest);
        p.settings.deterministic = 1;
        float *alone = scenario_alone(context, &p, &strongest);
        int ranks = rank_counts[(size_t)(n + n / 6) % COUNT(rank_counts)];
        p.cut = GROUPED;
        p.picture = usual;
        assert_true(scenario_gap(&p, alone) <= BOUND_PARTS(32));
        scenario_by_ranks(context, &p, ranks);
        if (memcmp(p.picture, alone, scenario_floats(&p) * sizeof(float)) != 0)
            fail_msg("%d ranks: %g; %s", ranks, scenario_gap(&p, alone),
                     model_words(&s));
        free(p.picture);
        free(usual);
        free(alone);
        snow_transfer_free(transfer);
        free_numbered(&s);
    }
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(slabs_of_a_file_make_the_same_bits,
                                        support_files_setup,
                                        support_files_teardown),
        cmocka_unit_test_setup_teardown(slabs_of_a_file_are_projected_alike,
                                        support_files_setup,
                                        support_files_teardown),
        cmocka_unit_test(ranks_make_the_picture_of_one),
        cmocka_unit_test(ranks_project_what_one_does),
        cmocka_unit_test(deterministic_pictures_have_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
