/* tests/parallel/test_ranks.c - one picture by many processors equals the
 * serial one, whatever the number of ranks, the cut, the view and the method.
 */
#include "reference/model.h"
#include "support/scenario.h"

#include "image/image.h"
#include "render/picture.h"

#include <math.h>
#include <snowglass/ranks.h>
#include <stdatomic.h>

/* Rounding of over; where values are splatted, to 15 bits for each slab, which
 * adds up to some units and not to one a slab, for errors have both signs.
 * Where a pixel is given up half a step of 8 bits may shine through, which
 * parts do later than the whole, and Catmull-Rom's weights along both axes may
 * make 1.25^2 times that of it: one step at most (docs/model.md). */
#define BOUND 4e-6
#define BOUND_VALUES (40.0 / 32767)
#define BOUND_OPAQUE (1.0 / 255)

/* What a sweep came to. */
typedef struct sweep_summary {
    int clear, opaque;
    double clear_most, opaque_most, strongest;
} sweep_summary;

static void check(snow_context *context, scenario *p, const float *serial,
                  double strongest, int ranks, sweep_summary *summary) {
    scenario_by_ranks(context, p, ranks);
    double gap = scenario_gap(p, serial);
    bool values = p->stats.method == SNOW_METHOD_SHEAR_WARP;
    bool opaque = strongest > 1 - 0.5 / 255 - 1e-5;
    double bound = opaque ? BOUND_OPAQUE : values ? BOUND_VALUES : BOUND;
    if (p->how.pixel_bits == 8)
        bound += 0.5 / 255;
    if (!(gap <= bound))
        fail_msg("%d ranks differ by %g; cut %d, method %d, quality %d, fov "
                 "%g, combining %d, strongest %g",
                 ranks, gap, (int)p->cut, (int)p->settings.method,
                 (int)p->settings.quality, p->view.fov, (int)p->how.combining,
                 strongest);
    assert_int_equal(p->ranks, ranks);
    scenario_check_counts(p, ranks);
    if (p->how.pixel_bits != 8) {
        double *most = opaque ? &summary->opaque_most : &summary->clear_most;
        *most = fmax(*most, gap);
    }
    summary->clear += !opaque;
    summary->opaque += opaque;
    summary->strongest += strongest;
    free(p->picture);
}

static void report(const char *title, const sweep_summary *summary) {
    int all = summary->clear + summary->opaque;
    print_message("             %s: %d pictures differ by up to %.2g, %d with "
                  "opaque pixels by %.2g; strongest opacity %.2f in the mean\n",
                  title, summary->clear, summary->clear_most, summary->opaque,
                  summary->opaque_most, summary->strongest / all);
    assert_true(summary->strongest / all > 0.2);
}

/* --- small volumes of all kinds ------------------------------------------- */

static const int rank_counts[] = {1, 2, 3, 5, 7, 8, 16, 33};
#define COUNTS (int)(sizeof rank_counts / sizeof *rank_counts)

static const double turns[][3] = {
    {0, 0, 0},   {180, 0, 0},  {90, 0, 0},      {-90, 0, 30}, {0, 90, 0},
    {0, -90, 0}, {30, 20, 10}, {-130, -50, 70}, {44, 3, 0},   {25, -35, 200},
};
#define TURNS (int)(sizeof turns / sizeof *turns)

/* A scenario of a scene, of which everything varies with `n`. */
static scenario scenario_of(int n, int64_t depth, reference_scene *scene) {
    static const double zooms[] = {1, 0.3, 2, 0.6, 6};
    const double *turn = turns[n % TURNS];
    *scene = model_scene((int64_t[]){21, 18, depth},
                         n % 3 ? SNOW_TYPE_UINT8 : SNOW_TYPE_INT16, n % 4 == 0,
                         (model_matrix)(n % MODEL_MATRICES), (uint64_t)n + 1);
    model_turn(scene, turn[0], turn[1], turn[2], zooms[n % 5]);
    if (n / 6 % 2)
        model_fade(scene);
    scene->settings.method = SNOW_METHOD_SHEAR_WARP;
    scene->settings.kernel =
        n % 7 == 3 ? SNOW_KERNEL_BSPLINE : SNOW_KERNEL_TENT;
    scene->settings.footprint = n % 7 == 3 ? 4 : 2;
    scene->settings.encoding = (snow_encoding)(n % 4);
    scene->settings.threshold = n / 4 % 2 * 10;
    scene->settings.quality = (snow_quality)(n / 2 % 3);
    scene->settings.shade = n / 3 % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    scene->settings.threads = 1 + n % 2;
    if (n % 2)
        scene->settings.opacity_length = 15;
    return (scenario){.info = scene->info,
                      .voxels = scene->voxels,
                      .view = scene->view,
                      .settings = scene->settings,
                      .how = {.size = sizeof(snow_ranks_options),
                              .combining = (snow_combine)(n % 5)},
                      .pictures = 1 + n % 2};
}

/* Each scene with each number of ranks, all cuts in turn. */
static void sweep(const char *title, int scenes, double fov,
                  const snow_method *methods, int method_count) {
    snow_context *context = support_context();
    sweep_summary summary = {0};
    for (int n = 0; n < scenes * COUNTS; n++) {
        const int number = n / COUNTS, ranks = rank_counts[n % COUNTS];
        if (!support_takes((size_t)n, 13))
            continue;
        reference_scene scene;
        double strongest;
        scenario p = scenario_of(number, 24, &scene);
        p.view.fov = fov;
        p.settings.method = methods[number % method_count];
        if (p.settings.method != SNOW_METHOD_SHEAR_WARP)
            p.settings.kernel = (snow_kernel)(number / 2 % 5);
        snow_transfer *transfer = model_transfer(context, &scene);
        p.transfer = transfer;
        p.cut = (partitioning)((number + n) % PARTITIONINGS);
        p.how.pixel_bits = n % 7 == 0 ? 8 : 0;
        float *serial = scenario_alone(context, &p, &strongest);
        check(context, &p, serial, strongest, ranks, &summary);
        free(serial);
        snow_transfer_free(transfer);
        model_free(&scene);
    }
    report(title, &summary);
    snow_context_free(context);
}

static void any_number_of_ranks_makes_the_serial_picture(void **state) {
    (void)state;
    const snow_method shear_warp = SNOW_METHOD_SHEAR_WARP;
    sweep("shear-warp", 30, 0, &shear_warp, 1);
}

static void so_it_does_in_perspective(void **state) {
    (void)state;
    const snow_method shear_warp = SNOW_METHOD_SHEAR_WARP;
    sweep("perspective", 20, 35, &shear_warp, 1);
}

static void so_it_does_by_the_exact_methods(void **state) {
    (void)state;
    static const snow_method exact[] = {
        SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED, SNOW_METHOD_FOOTPRINT};
    sweep("exact", 12, 0, exact, 3);
    sweep("exact, perspective", 6, 50, exact, 3);
}

/* --- other modes ---------------------------------------------------------- */

/* Rounding of sums, and where it decides whether a ray misses. */
#define BOUND_SUMS 2e-6

/* The largest difference as a part of the largest value; infinite where a pixel
 * is in one of them only. */
static double gap_of(const float *a, const float *b, size_t count) {
    double most = 0, gap = 0;
    for (size_t n = 0; n < count; n++) {
        if (isnan(a[n]) != isnan(b[n]))
            return INFINITY;
        if (isnan(a[n]))
            continue;
        gap = fmax(gap, fabs((double)a[n] - (double)b[n]));
        most = fmax(most, fabs((double)b[n]));
    }
    return most > 0 ? gap / most : gap;
}

static bool shows_something(const scenario *p, const float *serial) {
    int steps = 0;
    for (size_t n = 1; n < scenario_floats(p); n++)
        steps += serial[n] != serial[n - 1] && !isnan(serial[n]);
    return steps > 20;
}

/* Serially, and by so many ranks. */
static bool compare_modes(snow_context *context, scenario *p, int ranks,
                          double bound, double depth_bound, double *most) {
    size_t pixels = (size_t)p->view.width * (size_t)p->view.height;
    float *depths = calloc(pixels, sizeof(float));
    double unused;
    p->depths = p->settings.depth ? depths : NULL;
    float *serial = scenario_alone(context, p, &unused);
    bool shows = shows_something(p, serial);
    float *others = calloc(pixels, sizeof(float));
    p->depths = p->settings.depth ? others : NULL;
    scenario_by_ranks(context, p, ranks);
    double gap = gap_of(p->picture, serial, scenario_floats(p));
    double depth = p->depths ? gap_of(others, depths, pixels) : 0;
    if (!(gap <= bound) || !(depth <= depth_bound))
        fail_msg("%s by %d ranks differs by %g, depth by %g; cut %d, "
                 "method %d, fov %g",
                 snow_mode_name(p->settings.mode), ranks, gap, depth,
                 (int)p->cut, (int)p->settings.method, p->view.fov);
    *most = fmax(*most, fmax(gap, depth));
    scenario_check_counts(p, ranks);
    free(p->picture);
    free(serial);
    free(depths);
    free(others);
    return shows;
}

static void mode_pictures(snow_mode mode, double bound, double depth_bound) {
    static const snow_method methods[] = {
        SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_FOOTPRINT,
        SNOW_METHOD_ORIGINAL};
    snow_context *context = support_context();
    double most = 0;
    int shown = 0, all = 0;
    for (int at = 0; at < 2 * TURNS * COUNTS; at++) {
        const int n = at / COUNTS;
        if (!support_takes((size_t)(at + 3 * (int)mode), 19))
            continue;
        reference_scene scene;
        scenario p = scenario_of(n, 24, &scene);
        p.settings.mode = mode;
        p.settings.method = mode == SNOW_MODE_ISO && n % 4 == 3
                                ? SNOW_METHOD_RAYCAST
                                : methods[n % 4];
        p.settings.depth = mode == SNOW_MODE_ISO || mode == SNOW_MODE_OVER;
        p.settings.iso = 60;
        p.view.fov = n % 5 == 4 ? 35 : 0;
        p.cut = (partitioning)((n + at) % PARTITIONINGS);
        snow_transfer *transfer = model_transfer(context, &scene);
        p.transfer = transfer;
        shown += compare_modes(context, &p, rank_counts[at % COUNTS], bound,
                               depth_bound, &most);
        all++;
        snow_transfer_free(transfer);
        model_free(&scene);
    }
    print_message("             %s: %d of %d pictures show something, differ "
                  "by up to %.2g\n",
                  snow_mode_name(mode), shown, all, most);
    assert_true(shown * 2 > all);
    snow_context_free(context);
}

static void largest_values_of_many_ranks_have_the_serial_bits(void **state) {
    (void)state;
    mode_pictures(SNOW_MODE_MIP, 0, 0);
    mode_pictures(SNOW_MODE_MINIP, 0, 0);
}

static void sums_of_many_ranks_differ_by_rounding(void **state) {
    (void)state;
    mode_pictures(SNOW_MODE_MEAN, BOUND_SUMS, 0);
    mode_pictures(SNOW_MODE_SUM, BOUND_SUMS, 0);
}

/* Of the picture itself more is tested above. */
static void depths_of_over_by_many_ranks(void **state) {
    (void)state;
    mode_pictures(SNOW_MODE_OVER, BOUND_OPAQUE, BOUND);
}

/* Depths have the serial bits. */
static void surfaces_of_many_ranks_are_near(void **state) {
    (void)state;
    mode_pictures(SNOW_MODE_ISO, BOUND_OPAQUE, 0);
}

/* --- phantoms ------------------------------------------------------------- */

/* Views along all axes from both sides, and oblique; every number of ranks; all
 * cuts in turn.  A draft of so few pixels, or 0: at the usual size.  Pixels of
 * a draft are means of many samples. */
static void look_around(const char *name, const snow_volume *volume,
                        int draft) {
    static const char *const names[] = {"+x", "-x", "+y",  "-y",
                                        "+z", "-z", "iso", "iso"};
    snow_context *context = support_context();
    snow_transfer *transfer = NULL;
    sweep_summary summary = {0};
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    for (int at = 0; at < 8 * COUNTS; at++) {
        const int n = at / COUNTS;
        double strongest;
        scenario p = {.info = *snow_volume_get_info(volume),
                      .voxels = snow_volume_voxels(volume),
                      .transfer = transfer,
                      .how = {.size = sizeof(snow_ranks_options),
                              .combining = (snow_combine)(n % 5)},
                      .cut = (partitioning)((n + at) % PARTITIONINGS),
                      .pictures = 1};
        if (!support_takes((size_t)at, 19))
            continue;
        snow_view_init(&p.view);
        assert_int_equal(snow_view_from_name(context, names[n], &p.view),
                         SNOW_STATUS_OK);
        snow_settings_init(&p.settings);
        p.view.width = draft ? draft : 160;
        p.view.height = draft ? draft : 120;
        p.view.zoom = draft ? 1 : 1 + n % 3 * 0.5;
        p.view.fov = n == 7 ? 30 : 0;
        p.settings.threads = 1;
        p.settings.quality = draft ? SNOW_QUALITY_DRAFT : (snow_quality)(n % 3);
        p.settings.shade = n % 3 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
        if (n / 2 % 2) /* thin */
            p.settings.opacity_length = 100;
        float *serial = scenario_alone(context, &p, &strongest);
        check(context, &p, serial, strongest, rank_counts[at % COUNTS],
              &summary);
        free(serial);
    }
    report(name, &summary);
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void phantoms_are_seen_alike_by_many_ranks(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int64_t dims[3];
        int draft;
    } cases[] = {
        {"head", {70, 64, 60}, 0},      {"engine", {70, 64, 60}, 0},
        {"shells", {70, 64, 60}, 0},    {"head", {100, 90, 99}, 20},
        {"engine", {121, 96, 93}, 64},  {"shells", {81, 79, 83}, 31},
        {"engine", {145, 140, 131}, 6},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        snow_context *context = support_context();
        snow_volume *volume = NULL;
        assert_int_equal(snow_volume_open_phantom(context, cases[n].name,
                                                  cases[n].dims, 1, &volume),
                         SNOW_STATUS_OK);
        look_around(cases[n].name, volume, cases[n].draft);
        snow_volume_close(volume);
        snow_context_free(context);
    }
}

/* --- real volumes --------------------------------------------------------- */

static void real_volumes_are_seen_alike_by_many_ranks(void **state) {
    (void)state;
    static const struct {
        const char *path;
        snow_volume_options options;
    } files[] = {
        {"classic/engine_256x256x110_u8.raw.gz",
         {.size = sizeof(snow_volume_options),
          .dims = {256, 256, 110},
          .type = SNOW_TYPE_UINT8}},
        {"classic/CThead_256x256x113_u16be.raw.gz",
         {.size = sizeof(snow_volume_options),
          .dims = {256, 256, 113},
          .type = SNOW_TYPE_UINT16,
          .endian = SNOW_ENDIAN_BIG,
          .spacing = {1, 1, 2}}},
    };
    if (!support_data(files[0].path) || !support_data(files[1].path))
        skip();
    for (int n = 0; n < 2; n++) {
        if (!support_takes((size_t)n, 2))
            continue;
        snow_context *context = support_context();
        snow_volume *volume = NULL;
        if (snow_volume_open(context, support_data(files[n].path),
                             &files[n].options, &volume) != SNOW_STATUS_OK)
            fail_msg("%s", snow_context_message(context));
        look_around(n ? "CThead" : "Engine", volume, 0);
        look_around(n ? "CThead, 128x128" : "Engine, 128x128", volume, 128);
        snow_volume_close(volume);
        snow_context_free(context);
    }
}

/* --- deterministic pictures ----------------------------------------------- */

/* Bits, over modes, methods and views. */
static void deterministic_pictures_are_the_same_bit_for_bit(void **state) {
    (void)state;
    snow_context *context = support_context();
    static const snow_method methods[] = {
        SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_FOOTPRINT,
        SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_TESTED};
    static const snow_mode modes[] = {SNOW_MODE_OVER, SNOW_MODE_MEAN,
                                      SNOW_MODE_OVER, SNOW_MODE_SUM};
    int pictures = 0;
    double moved = 0;
    for (int at = 0; at < 24 * COUNTS; at++) {
        const int n = at / COUNTS, ranks = rank_counts[at % COUNTS];
        if (!support_takes((size_t)at, 19))
            continue;
        reference_scene scene;
        double strongest;
        scenario p = scenario_of(n, n % 2 ? 24 : 70, &scene);
        if (n % TURNS == 8) /* a blend of two axes */
            p.settings.quality = SNOW_QUALITY_NORMAL;
        p.view.fov = n % 3 == 2 ? 40 : 0;
        p.settings.method = methods[n % 5];
        p.settings.mode = modes[n % 4];
        if (p.settings.mode != SNOW_MODE_OVER &&
            p.settings.method == SNOW_METHOD_TESTED)
            p.settings.method = SNOW_METHOD_FOOTPRINT;
        snow_transfer *transfer = model_transfer(context, &scene);
        p.transfer = transfer;
        float *usual = scenario_alone(context, &p, &strongest);
        p.settings.deterministic = 1;
        float *serial = scenario_alone(context, &p, &strongest);
        for (size_t i = 0; i < scenario_floats(&p); i++)
            moved = fmax(moved, fabs((double)usual[i] - (double)serial[i]));
        p.cut = GROUPED;
        scenario_by_ranks(context, &p, ranks);
        if (memcmp(p.picture, serial, scenario_floats(&p) * sizeof(float)) != 0)
            fail_msg("%d ranks: scene %d, %g", ranks, n,
                     scenario_gap(&p, serial));
        free(p.picture);
        pictures++;
        free(usual);
        free(serial);
        snow_transfer_free(transfer);
        model_free(&scene);
    }
    print_message("             %d pictures are the same; the usual ones "
                  "differ by up to %.2g\n",
                  pictures, moved);
    assert_true(moved < BOUND_OPAQUE);
    snow_context_free(context);
}

/* --- what goes wrong ------------------------------------------------------ */

/* A mistake that one rank makes, or all. */
typedef struct mishap {
    scenario scenario;
    const char *expected; /* part of the message */
    int wrong;            /* rank; -1: none but what the scenario has */
    void (*spoil)(scenario *p, snow_volume *volume);
    bool again; /* a second picture, without the mistake, is made */
} mishap;

static snow_status stumble(snow_comm *comm, void *user) {
    const mishap *m = user;
    scenario p = m->scenario;
    snow_context *context = snow_comm_context(comm);
    int rank = snow_comm_rank(comm);
    void *voxels = NULL;
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    SNOW_TRY(scenario_open_part(context, &p, &p.boxes[rank], &voxels, &volume));
    SNOW_TRY(scenario_copy_transfer(context, p.transfer, &transfer));
    SNOW_TRY(snow_frame_new(context, &frame));
    if (rank == m->wrong)
        m->spoil(&p, volume);
    snow_status status = snow_ranks_render(
        frame, comm, volume, transfer, &p.view, &p.settings, &p.how, &image);
    char message[300];
    snprintf(message, sizeof message, "%s", snow_context_message(context));
    bool given = strstr(message, m->expected) != NULL;
    if (status != SNOW_STATUS_BAD_USAGE || !given || image)
        status = snow_fail(context, SNOW_STATUS_BAD_OUTPUT,
                           "rank %d: %d, \"%s\"", rank, (int)status, message);
    else
        status = SNOW_STATUS_OK;
    if (status == SNOW_STATUS_OK && m->again) {
        status =
            snow_ranks_render(frame, comm, volume, transfer, &m->scenario.view,
                              &m->scenario.settings, &p.how, &image);
        snow_image_free(image);
    }
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    free(voxels);
    return status;
}

static void other_view(scenario *p, snow_volume *volume) {
    (void)volume;
    p->view.azimuth += 1;
}

static void other_light(scenario *p, snow_volume *volume) {
    (void)volume;
    p->settings.light = SNOW_LIGHT_KEY;
}

static void bad_threshold(scenario *p, snow_volume *volume) {
    (void)volume;
    p->settings.threshold = 300;
}

/* Leaves some of its voxels to nobody. */
static void modest(scenario *p, snow_volume *volume) {
    snow_extent part = {.size = sizeof part};
    (void)p;
    snow_volume_get_extent(volume, &part);
    for (int axis = 0; axis < 3; axis++)
        part.count[axis]--;
    assert_int_equal(snow_volume_set_extent(volume, &part), SNOW_STATUS_OK);
}

/* The part without its ghosts: refused by that rank alone. */
static void ghostless(scenario *p, snow_volume *volume) {
    snow_extent part = {.size = sizeof part};
    (void)p;
    snow_volume_get_extent(volume, &part);
    for (int axis = 0; axis < 3; axis++) {
        part.first[axis] = part.stored[axis];
        part.count[axis] = volume->info.dims[axis];
    }
    assert_int_equal(snow_volume_set_extent(volume, &part), SNOW_STATUS_OK);
}

static void what_one_rank_finds_wrong_all_are_told(void **state) {
    (void)state;
    static const struct {
        void (*spoil)(scenario *p, snow_volume *volume);
        const char *expected;
        bool deterministic, again;
        int bits;
        partitioning cut;
        bool draft; /* of few pixels */
    } cases[] = {
        {other_view, "differ between ranks", false, true, 0, BRICKS, false},
        {other_light, "differ between ranks", false, true, 0, BRICKS, false},
        {bad_threshold, "rank 2: invalid threshold 300", false, true, 0,
         ALONG_SLICES, false},
        {modest, "every voxel must belong to", false, false, 0, ALONG_OTHER,
         false},
        {ghostless, "rank 2: this view needs", false, false, 0, ALONG_OTHER,
         false},
        {ghostless, "rank 2: this view needs", false, false, 0, ALONG_SLICES,
         true},
        {NULL, "deterministic pictures need slabs", true, false, 0, ALONG_OTHER,
         false},
        {NULL, "must begin and end at multiples of", true, false, 0,
         ALONG_SLICES, false},
        {NULL, "invalid pixel_bits 7", false, false, 7, ALONG_SLICES, false},
    };
    snow_context *context = support_context();
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        reference_scene scene;
        snow_transfer *transfer = NULL;
        mishap m = {.scenario = scenario_of(0, 70, &scene),
                    .expected = cases[n].expected,
                    .spoil = cases[n].spoil,
                    .wrong = cases[n].spoil ? 2 : -1,
                    .again = cases[n].again};
        transfer = model_transfer(context, &scene);
        m.scenario.transfer = transfer;
        m.scenario.cut = cases[n].cut;
        m.scenario.settings.deterministic = cases[n].deterministic;
        m.scenario.how.pixel_bits = cases[n].bits;
        if (cases[n].draft) {
            m.scenario.settings.quality = SNOW_QUALITY_DRAFT;
            m.scenario.view.width = m.scenario.view.height = 6;
        }
        scenario_partition(context, &m.scenario, 5);
        if (snow_comm_run_threads(context, 5, stumble, &m) != SNOW_STATUS_OK)
            fail_msg("case %zu: %s", n, snow_context_message(context));
        snow_transfer_free(transfer);
        model_free(&scene);
    }
    snow_context_free(context);
}

/* --- memory --------------------------------------------------------------- */

/* Fails one allocation, or all from it on. */
typedef struct miser {
    atomic_long asked;
    long failing;
    bool for_good;
} miser;

static void *give_or_not(void *user, size_t bytes) {
    miser *m = user;
    long number = atomic_fetch_add(&m->asked, 1);
    bool fails = m->for_good ? number >= m->failing : number == m->failing;
    return m->failing >= 0 && fails ? NULL : malloc(bytes);
}

static void take_back(void *user, void *block) {
    (void)user;
    free(block);
}

/* Ranks' allocations come in any order, so a number is another one each time;
 * what counts is that all ranks end, and nothing is left. */
static void ranks_without_memory_fail_together(void **state) {
    (void)state;
    static const snow_mode modes[8] = {[4] = SNOW_MODE_MIP,
                                       [5] = SNOW_MODE_SUM,
                                       [6] = SNOW_MODE_ISO,
                                       [7] = SNOW_MODE_OVER};
    for (int n = 0; n < 8; n++) {
        reference_scene scene;
        snow_context *maker = support_context();
        snow_transfer *transfer = NULL;
        scenario p = scenario_of(2 + n, 70, &scene);
        p.settings.method =
            n == 2 || n == 5 ? SNOW_METHOD_FOOTPRINT : SNOW_METHOD_SHEAR_WARP;
        p.settings.mode = modes[n];
        p.settings.iso = 60;
        p.settings.depth = n >= 6;
        p.settings.quality = n == 3 ? SNOW_QUALITY_DRAFT : SNOW_QUALITY_NORMAL;
        if (n == 3) /* pixels are means */
            p.view.width = p.view.height = 12;
        p.settings.deterministic = n == 1;
        p.settings.shade = SNOW_SHADE_NONE;
        p.settings.threads = 1;
        p.cut = GROUPED;
        p.how.pixel_bits = 8;
        transfer = model_transfer(maker, &scene);
        p.transfer = transfer;
        p.channels = transfer->grey ? 2 : 4;
        if (n == 5)
            p.channels = 1;
        scenario_partition(maker, &p, 3);
        p.picture = malloc(scenario_floats(&p) * sizeof(float));
        assert_non_null(p.picture);
        long last = 1;
        /* Each of the first ones, then some. */
        for (long failing = -1; failing < last;
             failing += failing < 8            ? 1
                        : support_is_release() ? 5
                                               : 61) {
            miser m = {.failing = failing, .for_good = failing % 2};
            const snow_allocator allocator = {give_or_not, take_back, &m};
            snow_context *context = NULL;
            if (snow_context_new(&allocator, &context) != SNOW_STATUS_OK)
                continue;
            snow_status status =
                snow_comm_run_threads(context, 3, scenario_perform, &p);
            assert_int_equal(status, failing < 0 ? SNOW_STATUS_OK : status);
            assert_true(status == SNOW_STATUS_OK ||
                        status == SNOW_STATUS_NO_MEMORY);
            if (failing < 0)
                last = atomic_load(&m.asked);
            assert_int_equal(snow_context_bytes(context), 0);
            snow_context_free(context);
        }
        assert_true(last > 50);
        free(p.picture);
        snow_transfer_free(transfer);
        snow_context_free(maker);
        model_free(&scene);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_ranks_makes_the_serial_picture),
        cmocka_unit_test(so_it_does_in_perspective),
        cmocka_unit_test(so_it_does_by_the_exact_methods),
        cmocka_unit_test(largest_values_of_many_ranks_have_the_serial_bits),
        cmocka_unit_test(sums_of_many_ranks_differ_by_rounding),
        cmocka_unit_test(depths_of_over_by_many_ranks),
        cmocka_unit_test(surfaces_of_many_ranks_are_near),
        cmocka_unit_test(phantoms_are_seen_alike_by_many_ranks),
        cmocka_unit_test(real_volumes_are_seen_alike_by_many_ranks),
        cmocka_unit_test(deterministic_pictures_are_the_same_bit_for_bit),
        cmocka_unit_test(what_one_rank_finds_wrong_all_are_told),
        cmocka_unit_test(ranks_without_memory_fail_together),
    };
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
