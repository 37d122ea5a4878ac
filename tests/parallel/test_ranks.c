/* tests/parallel/test_ranks.c - one picture by many processors equals the
 * serial one, whatever the number of ranks, the cut, the view and the method.
 */
#include "support/failing.h"
#include "support/files.h"
#include "support/scenario.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Rounding of over; where values are splatted, to 15 bits for each slab, which
 * adds up to some units and not to one a slab, for errors have both signs.
 * Where a pixel is given up half a step of 8 bits may shine through, which
 * parts do later than the whole, and Catmull-Rom's weights along both axes may
 * make 1.25^2 times that of it (docs/model.md). */
#define BOUND 4e-6
#define BOUND_VALUES (60.0 / 32767)
#define BOUND_OPAQUE(ranks) (1.25 * 1.25 * (0.5 / 255 + (ranks) / 32767.0))

/* Rounding of sums. */
#define BOUND_SUMS 2e-6

static const int rank_counts[] = {1, 2, 3, 5, 7, 8, 16, 33};
#define COUNTS (int)COUNT(rank_counts)

/* --- one picture ---------------------------------------------------------- */

/* What a sweep came to. */
typedef struct sweep_summary {
    int pictures, shown, opaque;
    double clear_most, opaque_most, moved; /* by being deterministic */
} sweep_summary;

static bool is_projection(const scenario *p) {
    return p->settings.mode != SNOW_MODE_OVER &&
           p->settings.mode != SNOW_MODE_ISO;
}

static double bound_of(const scenario *p, bool opaque, int ranks) {
    const double bytes = p->how.pixel_bits == 8 ? 0.5 / 255 : 0;
    if (p->settings.deterministic || p->settings.mode == SNOW_MODE_MIP ||
        p->settings.mode == SNOW_MODE_MINIP)
        return 0;
    if (is_projection(p))
        return BOUND_SUMS;
    if (opaque)
        return BOUND_OPAQUE(ranks) + bytes;
    return bytes +
           (p->stats.method == SNOW_METHOD_SHEAR_WARP ? BOUND_VALUES : BOUND);
}

static bool shows_something(const scenario *p, const float *serial) {
    int steps = 0;
    for (size_t n = 1; n < scenario_floats(p); n++)
        steps += serial[n] != serial[n - 1] && !isnan(serial[n]);
    return steps > 20;
}

/* Depths have the serial bits but where opacities add up to them. */
static void check_depths(const scenario *p, const float *serial, int ranks) {
    const size_t pixels = (size_t)p->view.width * (size_t)p->view.height;
    const double gap = scenario_difference(p->depths, serial, pixels, true);
    if (!(gap <= (p->settings.mode == SNOW_MODE_OVER ? BOUND : 0)))
        fail_msg("depths by %d ranks differ by %g; cut %d, method %d", ranks,
                 gap, (int)p->cut, (int)p->settings.method);
}

/* Serially, and by so many ranks. */
static void check(snow_context *context, scenario *p, int ranks,
                  sweep_summary *summary) {
    const size_t pixels = (size_t)p->view.width * (size_t)p->view.height;
    float *depths = calloc(2 * pixels, sizeof(float));
    double strongest;
    p->depths = p->settings.depth ? depths : NULL;
    float *serial = scenario_alone(context, p, &strongest);
    p->depths = p->settings.depth ? depths + pixels : NULL;
    scenario_by_ranks(context, p, ranks);
    const bool opaque = strongest > 1 - 0.5 / 255 - 1e-5;
    const double bound = bound_of(p, opaque, ranks);
    const double gap = scenario_difference(
        p->picture, serial, scenario_floats(p), is_projection(p));
    if (!(gap <= bound))
        fail_msg("%s by %d ranks differs by %g of %g; cut %d, method %d, "
                 "quality %d, fov %g, combining %d, strongest %g",
                 snow_mode_name(p->settings.mode), ranks, gap, bound,
                 (int)p->cut, (int)p->settings.method, (int)p->settings.quality,
                 p->view.fov, (int)p->how.combining, strongest);
    if (p->settings.depth)
        check_depths(p, depths, ranks);
    assert_int_equal(p->ranks, ranks);
    if (!p->layer)
        scenario_check_counts(p, ranks);
    double *most = opaque ? &summary->opaque_most : &summary->clear_most;
    *most = fmax(*most, p->how.pixel_bits ? 0 : gap);
    summary->opaque += opaque;
    summary->shown += shows_something(p, serial);
    summary->pictures++;
    free(p->picture);
    free(serial);
    free(depths);
}

static void report(const char *title, const sweep_summary *s) {
    print_message("             %s: %d of %d pictures show something; clear "
                  "ones differ by up to %.2g, %d with opaque pixels by %.2g\n",
                  title, s->shown, s->pictures, s->clear_most, s->opaque,
                  s->opaque_most);
    assert_true(s->shown > 0 || support_is_sanitized());
}

/* --- small volumes of all kinds ------------------------------------------- */

typedef struct kind {
    const char *name;
    int scenes;
    snow_mode mode;
    snow_method methods[4]; /* in turn; AUTO: shear-warp */
    double fov;             /* 0: as the scene has it */
    bool depth, draft, layered, deterministic;
} kind;

#define EXACT                                                            \
    {                                                                    \
        SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED, SNOW_METHOD_FOOTPRINT, \
            SNOW_METHOD_FOOTPRINT                                        \
    }
#define ALL                                                        \
    {                                                              \
        SNOW_METHOD_AUTO, SNOW_METHOD_AUTO, SNOW_METHOD_FOOTPRINT, \
            SNOW_METHOD_ORIGINAL                                   \
    }
#define VALUES                                                     \
    {                                                              \
        SNOW_METHOD_AUTO, SNOW_METHOD_AUTO, SNOW_METHOD_FOOTPRINT, \
            SNOW_METHOD_RAYCAST                                    \
    }

static const kind kinds[] = {
    {"shear-warp", 40, .mode = SNOW_MODE_OVER},
    {"perspective", 16, .mode = SNOW_MODE_OVER, .fov = 35},
    {"exact", 16, .mode = SNOW_MODE_OVER, .methods = EXACT},
    {"exact, perspective", 8, .mode = SNOW_MODE_OVER, .methods = EXACT,
     .fov = 50},
    {"drafts of few pixels", 16, .mode = SNOW_MODE_OVER, .draft = true},
    {"depths", 16, .mode = SNOW_MODE_OVER, .methods = ALL, .depth = true},
    {"surfaces", 20, .mode = SNOW_MODE_ISO, .methods = VALUES, .depth = true},
    {"largest values", 16, .mode = SNOW_MODE_MIP, .methods = ALL},
    {"smallest values", 16, .mode = SNOW_MODE_MINIP, .methods = ALL},
    {"means", 16, .mode = SNOW_MODE_MEAN, .methods = ALL},
    {"sums", 16, .mode = SNOW_MODE_SUM, .methods = ALL},
    {"two volumes", 24, .mode = SNOW_MODE_OVER, .layered = true},
    {"deterministic", 20, .mode = SNOW_MODE_OVER, .methods = ALL,
     .deterministic = true},
    {"deterministic means", 8, .mode = SNOW_MODE_MEAN, .methods = ALL,
     .deterministic = true},
    {"deterministic sums", 8, .mode = SNOW_MODE_SUM, .methods = ALL,
     .deterministic = true},
    {"deterministic, two volumes", 16, .mode = SNOW_MODE_OVER, .layered = true,
     .deterministic = true},
};

/* Scene n of a kind. */
static reference_scene scene_of(const kind *k, int n) {
    const snow_method method = k->methods[(n + n / 4) % 4];
    reference_scene s = scenario_scene(n, k->draft                    ? 62
                                          : k->deterministic && n % 2 ? 47
                                                                      : 24);
    s.settings.mode = k->mode;
    s.settings.iso = 30 + n * 17 % 50;
    s.settings.depth = k->depth;
    s.settings.deterministic = k->deterministic;
    if (method != SNOW_METHOD_AUTO)
        s.settings.method = method;
    if (s.settings.method != SNOW_METHOD_SHEAR_WARP &&
        k->mode == SNOW_MODE_OVER) {
        s.settings.kernel = (snow_kernel)(n / 2 % 5);
        s.settings.footprint = n % 7 == 3 ? 4 : 2;
    }
    if (k->fov > 0)
        s.view.fov = k->fov;
    if (k->draft) {
        s.settings.quality = SNOW_QUALITY_DRAFT;
        s.view.width = 3 + n * 5 % 14;
        s.view.height = 3 + n * 7 % 11;
    }
    return s;
}

/* Writes the second volume; p->layer lasts as long as the next. */
static void add_layer(support_files *place, scenario *p,
                      const reference_scene *front) {
    snow_volume *volume;
    p->layer = support_path(place, "layer.mha");
    p->layer_look = model_transfer(place->context, front);
    assert_int_equal(
        snow_volume_wrap(place->context, &front->info, front->voxels, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, p->layer, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
}

/* A deterministic picture is another one than the usual, but no worse. */
static void measure_move(snow_context *context, scenario *p,
                         sweep_summary *summary) {
    double strongest;
    scenario usual = *p;
    usual.settings.deterministic = 0;
    float *a = scenario_alone(context, p, &strongest);
    float *b = scenario_alone(context, &usual, &strongest);
    summary->moved =
        fmax(summary->moved,
             scenario_difference(a, b, scenario_floats(p), is_projection(p)));
    free(a);
    free(b);
}

/* Each scene with half of the numbers of ranks (of two volumes, which are dear,
 * with two), all cuts in turn. */
static void sweep(support_files *place, const kind *k) {
    sweep_summary summary = {0};
    const int each = k->layered ? 2 : COUNTS / 2;
    for (int at = 0; at < k->scenes * each; at++) {
        const int n = at / each, first = n / 3 % 2 * (COUNTS / 2);
        const int ranks = rank_counts[first + at % each * (COUNTS / 2 / each)];
        if (!support_takes((size_t)(at + 5 * (int)(k - kinds)), 19))
            continue;
        reference_scene base = scene_of(k, n), front = {.voxels = NULL};
        snow_transfer *transfer = model_transfer(place->context, &base);
        scenario p = scenario_of(&base, n, transfer);
        p.cut = k->deterministic ? GROUPED
                                 : (partitioning)((n + at) % PARTITIONINGS);
        if (k->mode == SNOW_MODE_OVER && !k->depth && !k->deterministic)
            p.how.pixel_bits = at % 7 == 0 ? 8 : 0;
        if (k->layered) {
            front = scenario_front(&base, n);
            add_layer(place, &p, &front);
        }
        if (k->deterministic)
            measure_move(place->context, &p, &summary);
        check(place->context, &p, ranks, &summary);
        snow_transfer_free((snow_transfer *)(uintptr_t)p.layer_look);
        snow_transfer_free(transfer);
        scenario_free_scene(&base);
        scenario_free_scene(&front);
    }
    report(k->name, &summary);
    assert_true(summary.moved < BOUND_OPAQUE(SCENARIO_RANKS));
}

static void any_number_of_ranks_makes_the_serial_picture(void **state) {
    for (size_t n = 0; n < COUNT(kinds); n++)
        sweep(*state, &kinds[n]);
}

/* --- phantoms ------------------------------------------------------------- */

/* Views along all axes from both sides, and oblique; every number of ranks; all
 * cuts in turn.  A draft of so few pixels, or 0: at the usual size. */
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
        check(context, &p, rank_counts[at % COUNTS], &summary);
    }
    report(name, &summary);
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void phantoms_are_seen_alike_by_many_ranks(void **state) {
    support_files *place = *state;
    static const struct {
        const char *name;
        int64_t dims[3];
        int draft;
    } cases[] = {
        {"head", {70, 64, 60}, 0},
        {"engine", {70, 64, 60}, 0},
        {"shells", {70, 64, 60}, 0},
        {"engine", {121, 96, 93}, 31},
    };
    for (size_t n = 0; n < COUNT(cases); n++) {
        snow_volume *volume = NULL;
        assert_int_equal(snow_volume_open_phantom(place->context, cases[n].name,
                                                  cases[n].dims, 1, &volume),
                         SNOW_STATUS_OK);
        look_around(cases[n].name, volume, cases[n].draft);
        snow_volume_close(volume);
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
        snow_volume_close(volume);
        snow_context_free(context);
    }
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
    scenario_rank r;
    snow_image *image = NULL;
    SNOW_TRY(scenario_enter(context, &p, &p.boxes[rank], &r));
    if (rank == m->wrong)
        m->spoil(&p, r.volume);
    snow_status status =
        snow_ranks_render(r.frame, comm, r.volume, r.transfer, &p.view,
                          &p.settings, &p.how, &image);
    char message[300];
    snprintf(message, sizeof message, "%s", snow_context_message(context));
    bool given = strstr(message, m->expected) != NULL;
    if (status != SNOW_STATUS_BAD_USAGE || !given || image)
        status = snow_fail(context, SNOW_STATUS_BAD_OUTPUT,
                           "rank %d: %d, \"%s\"", rank, (int)status, message);
    else
        status = SNOW_STATUS_OK;
    if (status == SNOW_STATUS_OK && m->again) {
        status = snow_ranks_render(r.frame, comm, r.volume, r.transfer,
                                   &m->scenario.view, &m->scenario.settings,
                                   &p.how, &image);
        snow_image_free(image);
    }
    scenario_leave(&r);
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

static void set_part(snow_volume *volume, bool ghosts_too, int64_t fewer) {
    snow_extent part = {.size = sizeof part};
    snow_volume_get_extent(volume, &part);
    for (int axis = 0; axis < 3; axis++) {
        if (ghosts_too) {
            part.first[axis] = part.stored[axis];
            part.count[axis] = volume->info.dims[axis];
        }
        part.count[axis] -= fewer;
    }
    assert_int_equal(snow_volume_set_extent(volume, &part), SNOW_STATUS_OK);
}

/* Leaves some of its voxels to nobody. */
static void modest(scenario *p, snow_volume *volume) {
    (void)p;
    set_part(volume, false, 1);
}

/* The part without its ghosts: refused by that rank alone. */
static void ghostless(scenario *p, snow_volume *volume) {
    (void)p;
    set_part(volume, true, 0);
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
    for (size_t n = 0; n < COUNT(cases); n++) {
        reference_scene scene = scenario_scene(21, 70);
        snow_transfer *transfer = model_transfer(context, &scene);
        mishap m = {.scenario = scenario_of(&scene, 0, transfer),
                    .expected = cases[n].expected,
                    .spoil = cases[n].spoil,
                    .wrong = cases[n].spoil ? 2 : -1,
                    .again = cases[n].again};
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
        scenario_free_scene(&scene);
    }
    snow_context_free(context);
}

/* --- memory --------------------------------------------------------------- */

/* By three ranks whose allocation number `failing` fails, or all from it on;
 * returns how many there were. */
static long draw_with_little(scenario *p, long failing) {
    support_failing memory = {.failing = failing, .for_good = failing % 2};
    const snow_allocator allocator = support_failing_allocator(&memory);
    snow_context *context = NULL;
    if (snow_context_new(&allocator, &context) != SNOW_STATUS_OK)
        return 0;
    snow_status status = snow_comm_run_threads(context, 3, scenario_perform, p);
    assert_true(status == SNOW_STATUS_OK ||
                (failing >= 0 && status == SNOW_STATUS_NO_MEMORY));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
    return memory.allocations;
}

/* Ranks' allocations come in any order, so a number is another one each time;
 * what counts is that all ranks end, and nothing is left. */
static void ranks_without_memory_fail_together(void **state) {
    support_files *place = *state;
    static const kind cases[] = {
        {"shear-warp", .mode = SNOW_MODE_OVER},
        {"deterministic", .mode = SNOW_MODE_OVER, .deterministic = true},
        {"footprint", .mode = SNOW_MODE_OVER, .methods = EXACT},
        {"draft", .mode = SNOW_MODE_OVER, .draft = true},
        {"maximum", .mode = SNOW_MODE_MIP},
        {"sum", .mode = SNOW_MODE_SUM, .methods = EXACT},
        {"surface", .mode = SNOW_MODE_ISO, .depth = true},
        {"depth", .mode = SNOW_MODE_OVER, .depth = true},
    };
    for (size_t n = 0; n < COUNT(cases); n++) {
        reference_scene scene = scene_of(&cases[n], 2);
        snow_transfer *transfer = model_transfer(place->context, &scene);
        scenario p = scenario_of(&scene, 2, transfer);
        p.settings.threads = 1;
        p.cut = GROUPED;
        p.how.pixel_bits = 8;
        p.channels = 4;
        scenario_partition(place->context, &p, 3);
        const size_t pixels = (size_t)p.view.width * (size_t)p.view.height;
        p.picture = calloc(4 * pixels, sizeof(float));
        p.channels = n == 4 || n == 5 ? 1 : transfer->grey ? 2 : 4;
        const long last = draw_with_little(&p, -1);
        assert_true(last > 50);
        /* Each of the first ones, then some. */
        for (long failing = 0; failing < last; failing += failing < 8 ? 1
                                                          : support_is_release()
                                                              ? 5
                                                              : 97)
            draw_with_little(&p, failing);
        free(p.picture);
        snow_transfer_free(transfer);
        scenario_free_scene(&scene);
    }
}

int main(int argc, char **argv) {
#define HERE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_files_setup, \
                                    support_files_teardown)
    const struct CMUnitTest tests[] = {
        HERE(any_number_of_ranks_makes_the_serial_picture),
        HERE(phantoms_are_seen_alike_by_many_ranks),
        cmocka_unit_test(real_volumes_are_seen_alike_by_many_ranks),
        cmocka_unit_test(what_one_rank_finds_wrong_all_are_told),
        HERE(ranks_without_memory_fail_together),
    };
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
