/* tests/parallel/test_insitu.c - pictures of a running simulation: however the
 * grid is cut, dealt to ranks and laid out in memory, the picture is that of
 * one process; what is wrong on one rank is told to all; limits are kept; no
 * step takes more memory than the one before. */
#include "support/comm.h"
#include "support/failing.h"
#include "support/folder.h"
#include "support/scenario.h"

#include "image/image.h"
#include "insitu/internal.h"
#include "render/tested.h"

#include <math.h>
#include <unistd.h>

/* snow_insitu_set with these parts of the record. */
#define SET(insitu, ...)                           \
    snow_insitu_set(insitu,                        \
                    &(const snow_insitu_settings){ \
                        .size = sizeof(snow_insitu_settings), __VA_ARGS__})

#define BRICKS_MOST 40
#define RANKS_MOST 16

/* The largest difference from the serial picture: rounding of "over", and where
 * it is opaque what may shine through. */
#define BOUND (0.51 / 255)

/* --- scenes --------------------------------------------------------------- */

/* Of a context, beside those of in situ pictures. */
#define OUTER_LIMIT (UINT64_C(1) << 40)

/* A grid of bricks, who holds them, and how they lie in memory. */
typedef struct scene {
    int64_t dims[3];
    snow_type type;
    int ranks, bricks;
    snow_box box[BRICKS_MOST];
    int owner[BRICKS_MOST];
    int layout;   /* 0 dense, 1 other order of axes, 2 interleaved and padded */
    int64_t halo; /* voxels around each brick, also beyond the grid */
    snow_view view;
    snow_settings settings;
    snow_balance balance;
    snow_ghosts ghosts;
    bool fades;               /* by gradients */
    bool clipped;             /* by planes */
    bool preset;              /* by those of a preset */
    bool automatic;           /* a look chosen from the values */
    bool grows;               /* its last slices do, after step 0 */
    const char *colormap;     /* NULL: viridis */
    bool first_deterministic; /* the picture before */
    /* What the ranks found. */
    double difference; /* from the serial picture */
    snow_insitu_stats figures;
    uint64_t encoded; /* of a second picture of the same voxels */
} scene;

/* A few blobs that look different from all sides; `t` moves them. */
static double field(const int64_t dims[3], double x, double y, double z,
                    double t) {
    double u = x / (double)dims[0], v = y / (double)dims[1],
           w = z / (double)dims[2];
    double a = exp(-20 * ((u - 0.4 - t) * (u - 0.4 - t) +
                          (v - 0.5) * (v - 0.5) + (w - 0.35) * (w - 0.35)));
    double b = exp(-60 * ((u - 0.7) * (u - 0.7) + (v - 0.3) * (v - 0.3) +
                          (w - 0.7) * (w - 0.7)));
    return 200 * a + 150 * b + 10 * sin(9 * u + 5 * v) * cos(7 * w);
}

/* Of a scene; the same where it does not grow. */
static double value_of(const scene *s, int64_t x, int64_t y, int64_t z,
                       double t) {
    const bool grown = s->grows && t > 0 && z >= s->dims[2] - 2;
    return (grown ? 9 : 1) * field(s->dims, (double)x, (double)y, (double)z, t);
}

static double scale_of(snow_type type) {
    return type == SNOW_TYPE_UINT16 || type == SNOW_TYPE_INT16 ? 100 : 1;
}

static void put_value(snow_type type, char *at, double value) {
    const double scaled = value * scale_of(type);
    const bool below = type == SNOW_TYPE_UINT8 || type == SNOW_TYPE_UINT16;
#define PUT(name, ctype, text)                                       \
    case SNOW_TYPE_##name: {                                         \
        const ctype put = (ctype)(below ? fmax(scaled, 0) : scaled); \
        memcpy(at, &put, sizeof put);                                \
        break;                                                       \
    }
    switch (type) {
        SNOW_TYPE_MAP(PUT)
    case SNOW_TYPE_NONE:
        break;
    }
#undef PUT
}

/* The whole grid, as one process has it. */
static void *whole_field(const scene *s, double t) {
    size_t value = snow_type_size(s->type);
    char *voxels =
             malloc((size_t)(s->dims[0] * s->dims[1] * s->dims[2]) * value),
         *at = voxels;
    for (int64_t z = 0; z < s->dims[2]; z++)
        for (int64_t y = 0; y < s->dims[1]; y++)
            for (int64_t x = 0; x < s->dims[0]; x++, at += value)
                put_value(s->type, at, value_of(s, x, y, z, t));
    return voxels;
}

/* Opacities, and factors by gradients behind them. */
static const snow_opacity_point points[] = {
    {30, 0}, {90, 0.2}, {180, 0.9}, {4, 0}, {20, 1}};

/* In the units of the type. */
static snow_look look_of(const scene *s, snow_opacity_point scaled[5]) {
    snow_type type = s->type;
    for (int i = 0; i < 5; i++) {
        scaled[i] = points[i];
        scaled[i].value *= scale_of(type);
    }
    if (s->automatic)
        return (snow_look){.size = sizeof(snow_look)};
    if (s->preset)
        return (snow_look){.size = sizeof(snow_look),
                           .preset = "ct-cardiac",
                           .range = SNOW_RANGE_VALUES,
                           .high = 200 * scale_of(type)};
    return (snow_look){.size = sizeof(snow_look),
                       .preset = "linear",
                       .colormap = s->colormap ? s->colormap : "viridis",
                       .range = SNOW_RANGE_VALUES,
                       .low = 0,
                       .high = 200 * scale_of(type),
                       .opacities = scaled,
                       .opacity_count = 3,
                       .gradient_opacities = s->fades ? scaled + 3 : NULL,
                       .gradient_opacity_count = s->fades ? 2 : 0};
}

static const double planes[2][4] = {{1, 0.5, 0, 18}, {0, 0, -1, -4}};

/* The picture of one process. */
static snow_image *serial_picture(snow_context *context, const scene *s,
                                  double t, const snow_look *look) {
    snow_volume_info info = {.size = sizeof info, .type = s->type};
    memcpy(info.dims, s->dims, sizeof info.dims);
    void *voxels = whole_field(s, t);
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    if (s->clipped) {
        snow_volume *cut;
        assert_int_equal(snow_volume_clip(volume, planes[0], 2, &cut),
                         SNOW_STATUS_OK);
        snow_volume_close(volume);
        volume = cut;
    }
    assert_int_equal(snow_transfer_new_for_volume(volume, look, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    snow_settings settings = s->settings; /* as the tool chooses */
    if (snow_transfer_is_unshaded(transfer))
        settings.shade = SNOW_SHADE_NONE;
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &s->view, &settings, &image),
        SNOW_STATUS_OK);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    free(voxels);
    return image;
}

/* Cuts the grid n[0] x n[1] x n[2] times, nearly equally, and deals the boxes
 * in turns. */
static scene make_scene(int ranks, int nx, int ny, int nz) {
    scene s = {.dims = {29, 23, 19}, .type = SNOW_TYPE_FLOAT32, .ranks = ranks};
    const int n[3] = {nx, ny, nz};
    snow_settings_init(&s.settings);
    s.settings.threads = 1;
    for (int i = 0; i < nx * ny * nz; i++) {
        const int at[3] = {i % nx, i / nx % ny, i / nx / ny};
        for (int k = 0; k < 3; k++) {
            int64_t first = s.dims[k] * at[k] / n[k];
            s.box[i].first[k] = first;
            s.box[i].count[k] = s.dims[k] * (at[k] + 1) / n[k] - first;
        }
        s.owner[i] = i * ranks / (nx * ny * nz);
    }
    s.bricks = nx * ny * nz;
    snow_context *context = support_context();
    snow_view_init(&s.view);
    snow_view_from_name(context, "iso", &s.view);
    snow_context_free(context);
    s.view.width = 61;
    s.view.height = 47;
    s.view.azimuth = 10;
    return s;
}

/* --- a rank of the simulation --------------------------------------------- */

/* Its bricks' memory. */
typedef struct rank_memory {
    void *block[BRICKS_MOST];
    int count;
} rank_memory;

static void free_memory(rank_memory *m) {
    for (int i = 0; i < m->count; i++)
        free(m->block[i]);
}

/* Strides in values of a brick with its halo, by the scene's layout. */
static int64_t lay_out(const scene *s, const int64_t size[3],
                       int64_t stride[3]) {
    static const int orders[3][3] = {{0, 1, 2}, {2, 1, 0}, {1, 0, 2}};
    int64_t step = s->layout == 2 ? 3 : 1;
    for (int i = 0; i < 3; i++) {
        int axis = orders[s->layout][i];
        stride[axis] = step;
        step *= size[axis] + (s->layout == 2);
    }
    return step;
}

/* Writes a brick and its halo at time t; beyond the grid lies nonsense. */
static void fill_brick(const scene *s, const snow_box *box, char *first,
                       const int64_t stride[3], double t) {
    size_t value = snow_type_size(s->type);
    for (int64_t z = -s->halo; z < box->count[2] + s->halo; z++)
        for (int64_t y = -s->halo; y < box->count[1] + s->halo; y++)
            for (int64_t x = -s->halo; x < box->count[0] + s->halo; x++) {
                const int64_t at[3] = {box->first[0] + x, box->first[1] + y,
                                       box->first[2] + z};
                bool inside = true;
                for (int i = 0; i < 3; i++)
                    inside = inside && at[i] >= 0 && at[i] < s->dims[i];
                double real =
                    inside ? value_of(s, at[0], at[1], at[2], t) : 199;
                put_value(s->type,
                          first +
                              (x * stride[0] + y * stride[1] + z * stride[2]) *
                                  (int64_t)value,
                          real);
            }
}

/* Tells all bricks of this rank, in the order of the scene. */
static snow_status describe_bricks(snow_insitu *insitu, const scene *s,
                                   int rank, double t, rank_memory *m) {
    const snow_halo halo = {{s->halo, s->halo, s->halo},
                            {s->halo, s->halo, s->halo}};
    size_t value = snow_type_size(s->type);
    for (int n = 0; n < s->bricks; n++) {
        if (s->owner[n] != rank)
            continue;
        const snow_box *box = &s->box[n];
        int64_t size[3], stride[3];
        for (int i = 0; i < 3; i++)
            size[i] = box->count[i] + 2 * s->halo;
        int id = m->count;
        m->block[id] = calloc((size_t)lay_out(s, size, stride), value);
        char *first =
            (char *)m->block[id] +
            s->halo * (stride[0] + stride[1] + stride[2]) * (int64_t)value;
        m->count++;
        fill_brick(s, box, first, stride, t);
        SNOW_TRY(snow_insitu_set_brick(insitu, id, box->first, box->count,
                                       s->halo ? &halo : NULL));
        SNOW_TRY(snow_insitu_set_voxels(insitu, id, s->type, first,
                                        s->layout ? stride : NULL));
    }
    return SNOW_STATUS_OK;
}

/* Everything but the bricks. */
static snow_status describe_picture(snow_insitu *insitu, const scene *s) {
    snow_opacity_point scaled[5];
    snow_look look = look_of(s, scaled);
    SNOW_TRY(snow_insitu_set_grid(insitu, s->dims, NULL, NULL));
    const snow_insitu_work work = {
        .size = sizeof work, .ghosts = s->ghosts, .balance = s->balance};
    return SET(insitu, .view = &s->view, .picture = &s->settings, .look = &look,
               .work = &work, .clip = s->clipped ? planes[0] : NULL,
               .clip_count = s->clipped ? 2 : 0);
}

/* Of values as a part of the largest. */
static double largest_difference(const snow_image *a, const snow_image *b) {
    if (a->width != b->width || a->height != b->height ||
        a->channels != b->channels)
        return INFINITY;
    return scenario_difference(a->pixels, b->pixels,
                               (size_t)(a->width * a->height * a->channels),
                               a->channels == 1);
}

/* Two pictures on each rank; the first is compared on rank 0. */
static snow_status draw_twice(snow_insitu *insitu, scene *s, int rank) {
    snow_image *image = NULL;
    SNOW_TRY(snow_insitu_update(insitu));
    SNOW_TRY(snow_insitu_render(insitu, &image));
    if (rank == 0) {
        snow_opacity_point scaled[5];
        snow_look look = look_of(s, scaled);
        snow_context *context = support_context();
        snow_image *generation = serial_picture(context, s, 0, &look);
        s->difference = largest_difference(image, generation);
        snow_image_free(generation);
        snow_context_free(context);
    } else if (image)
        s->difference = INFINITY; /* not on the others */
    snow_image_free(image);
    image = NULL;
    snow_insitu_stats figures = {.size = sizeof figures};
    SNOW_TRY(snow_insitu_get_stats(insitu, &figures));
    SNOW_TRY(snow_insitu_render(insitu, &image));
    snow_image_free(image);
    if (rank == 0) {
        s->figures = figures;
        s->encoded = (uint64_t)snow_frame_stats(insitu->frame)->encoded;
    }
    return SNOW_STATUS_OK;
}

/* One that is made otherwise, before the others. */
static snow_status draw_deterministic(snow_insitu *insitu, const scene *s) {
    snow_settings settings = s->settings;
    snow_image *image = NULL;
    settings.deterministic = 1;
    SNOW_TRY(SET(insitu, .picture = &settings));
    SNOW_TRY(snow_insitu_update(insitu));
    SNOW_TRY(snow_insitu_render(insitu, &image));
    snow_image_free(image);
    return SET(insitu, .picture = &s->settings);
}

static snow_status run_rank(snow_comm *comm, void *user) {
    scene *s = user;
    rank_memory m = {.count = 0};
    snow_insitu *insitu = NULL;
    int rank = snow_comm_rank(comm);
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    snow_context_set_memory_limit(insitu->context, OUTER_LIMIT);
    snow_status status = describe_picture(insitu, s);
    if (status == SNOW_STATUS_OK)
        status = describe_bricks(insitu, s, rank, 0, &m);
    if (status == SNOW_STATUS_OK && s->first_deterministic)
        status = draw_deterministic(insitu, s);
    if (status == SNOW_STATUS_OK)
        status = draw_twice(insitu, s, rank);
    if (status == SNOW_STATUS_OK && insitu->context->limit != OUTER_LIMIT)
        status = snow_fail(insitu->context, SNOW_STATUS_FAILED,
                           "the context's own limit is lost");
    snow_insitu_free(insitu);
    free_memory(&m);
    return status;
}

static void run_scene(scene *s) {
    snow_context *context = support_context();
    s->difference = INFINITY;
    snow_status status = snow_comm_run_threads(context, s->ranks, run_rank, s);
    if (status != SNOW_STATUS_OK)
        print_error("%d ranks: %s\n", s->ranks, snow_context_message(context));
    assert_int_equal(status, SNOW_STATUS_OK);
    snow_context_free(context);
}

static void expect_serial(scene *s, const char *what) {
    run_scene(s);
    if (!(s->difference <= BOUND))
        fail_msg("%s, %d ranks: the picture differs by %g", what, s->ranks,
                 s->difference);
}

/* --- the picture ---------------------------------------------------------- */

/* Halos as wide as any picture needs. */
#define WIDE 8

static const snow_mode modes[] = {
    SNOW_MODE_OVER, SNOW_MODE_OVER, SNOW_MODE_OVER,  SNOW_MODE_OVER,
    SNOW_MODE_OVER, SNOW_MODE_MIP,  SNOW_MODE_MINIP, SNOW_MODE_MEAN,
    SNOW_MODE_SUM,  SNOW_MODE_ISO};

/* Everything varies with the number. */
static scene scene_of(int n) {
    static const int cuts[][4] = {{1, 1, 1, 1},  {2, 1, 1, 2}, {2, 2, 1, 1},
                                  {3, 1, 3, 1},  {4, 2, 2, 1}, {8, 2, 2, 2},
                                  {12, 3, 2, 2}, {7, 1, 7, 1}, {3, 1, 4, 3},
                                  {3, 1, 2, 3},  {4, 2, 1, 2}};
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_UINT16,
                                      SNOW_TYPE_INT16, SNOW_TYPE_FLOAT32,
                                      SNOW_TYPE_FLOAT64};
    static const double turns[][3] = {{0, 0, 0},   {90, 0, 0},  {180, 20, 0},
                                      {0, 90, 10}, {95, 10, 0}, {-120, -45, 30},
                                      {37, 5, 0}};
    static const int64_t halos[] = {WIDE, 0, 1, WIDE};
    const int *cut = cuts[n % 11];
    scene s = make_scene(cut[0], cut[1], cut[2], cut[3]);
    s.type = types[n % 5];
    s.layout = n % 3 == 2 ? 1 + n / 3 % 2 : 0;
    s.halo = halos[n % 4];
    s.view.azimuth = turns[n % 7][0] + n;
    s.view.elevation = turns[n % 7][1];
    s.view.roll = turns[n % 7][2];
    s.view.fov = n % 9 == 2 ? 40 : 0;
    s.settings.mode = modes[n / 2 % 10];
    s.settings.iso = 90 * scale_of(s.type);
    s.settings.method = n % 8 == 3     ? SNOW_METHOD_TESTED
                        : n % 8 != 5   ? SNOW_METHOD_AUTO
                        : s.ranks == 1 ? SNOW_METHOD_RAYCAST
                                       : SNOW_METHOD_FOOTPRINT;
    s.balance = n % 6 == 4 ? SNOW_BALANCE_REPARTITION : s.balance;
    s.first_deterministic = n % 16 == 7;
    if (s.settings.mode != SNOW_MODE_OVER)
        return s;
    if (s.settings.method == SNOW_METHOD_AUTO && n % 12 < 4) {
        s.settings.quality = SNOW_QUALITY_DRAFT; /* pixels are means */
        s.view.width = s.view.height = 15;
    }
    s.fades = n % 7 == 3;
    s.preset = n % 7 == 5;
    s.automatic = n % 7 == 6;
    s.clipped = n % 9 == 7 && !s.automatic;
    if (s.fades || s.preset)
        s.settings.quality = n % 2 ? SNOW_QUALITY_HIGH : s.settings.quality;
    return s;
}

/* Largest and smallest values to the bit, sums but for rounding. */
static double bound_of(const scene *s) {
    switch (s->settings.mode) {
    case SNOW_MODE_OVER: /* each rank's layer is rounded to 15 bits */
        return BOUND + s->ranks / 32767.0;
    case SNOW_MODE_ISO:
        return 1e-4;
    default:
        return s->settings.mode == SNOW_MODE_MEAN ||
                       s->settings.mode == SNOW_MODE_SUM
                   ? 2e-6
                   : 0;
    }
}

/* Parts with wide halos are used as they lie, also beyond the grid, where
 * nonsense lies: neither sent nor copied. */
static void any_simulation_is_seen_as_by_one_process(void **state) {
    (void)state;
    for (int n = 0; n < 330; n++) {
        if (!support_takes((size_t)n, 13))
            continue;
        scene s = scene_of(n);
        run_scene(&s);
        if (!(s.difference <= bound_of(&s)))
            fail_msg("scene %d, mode %s, %d ranks: it differs by %g", n,
                     snow_mode_name(s.settings.mode), s.ranks, s.difference);
        if (s.balance == SNOW_BALANCE_REPARTITION)
            continue;
        assert_false(s.figures.recut);
        if (s.halo == 0)
            assert_true(s.figures.exchanged == (s.ranks > 1));
        if (s.halo == WIDE && s.layout == 0 && s.bricks == s.ranks &&
            !s.clipped)
            assert_int_equal(s.figures.ranks_copied, 0);
        if (s.halo == WIDE && s.settings.method == SNOW_METHOD_AUTO)
            assert_false(s.figures.exchanged);
    }
}

/* As many colours as a list has at most: the text is longer than any name, and
 * the caller's is gone when pictures are made. */
static void a_list_of_colours_does(void **state) {
    (void)state;
    char list[32 * 16];
    size_t used = 0;
    for (unsigned n = 0; n < 32; n++)
        used += (size_t)snprintf(list + used, sizeof list - used,
                                 "%s%.3f:#%02x%02x%02x", n ? "," : "",
                                 200 / 31.0 * n, n * 37 % 256, n * 101 % 256,
                                 n * 67 % 256);
    scene s = make_scene(3, 1, 1, 3);
    s.colormap = list;
    expect_serial(&s, "a list of 32 colours");
}

static void without_ghosts_there_are_seams_and_no_messages(void **state) {
    (void)state;
    scene s = make_scene(4, 2, 2, 1);
    s.ghosts = SNOW_GHOSTS_NONE;
    s.halo = 1;
    run_scene(&s);
    assert_false(s.figures.exchanged);
    assert_true(s.difference > 2.0 / 255); /* seams */
    assert_true(s.difference < 0.3);       /* but no holes */
}

static void voxels_that_lie_as_wanted_are_not_copied(void **state) {
    (void)state;
    scene s = make_scene(1, 1, 1, 1);
    expect_serial(&s, "one brick");
    assert_int_equal(s.figures.ranks_copied, 0);
    s.layout = 1;
    expect_serial(&s, "the other way round");
    assert_int_equal(s.figures.ranks_copied, 1);
}

static void bricks_that_are_no_box_are_recut(void **state) {
    (void)state;
    scene s = make_scene(3, 3, 3, 3);
    for (int n = 0; n < s.bricks; n++)
        s.owner[n] = (n + n / 3) % 3;
    expect_serial(&s, "scattered bricks");
    assert_true(s.figures.recut);
}

static void ranks_without_bricks_help(void **state) {
    (void)state;
    scene s = make_scene(5, 1, 1, 2);
    s.owner[0] = 3;
    s.owner[1] = 1;
    expect_serial(&s, "empty ranks");
    s.balance = SNOW_BALANCE_REPARTITION;
    expect_serial(&s, "empty ranks, recut");
    assert_true(s.figures.recut);
}

/* A scattered picture's parts, added up. */
typedef struct scattered {
    scene scene;
    float sum[61 * 47 * 4], whole[61 * 47 * 4];
    int with_pixels[RANKS_MOST]; /* pixels that are not transparent */
} scattered;

static snow_status scatter_rank(snow_comm *comm, void *user) {
    scattered *all = user;
    rank_memory m = {.count = 0};
    snow_insitu *insitu = NULL;
    snow_image *image = NULL;
    snow_ranks_options how = {.size = sizeof how};
    int rank = snow_comm_rank(comm);
    const size_t floats = sizeof all->sum / sizeof *all->sum;
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    describe_picture(insitu, &all->scene);
    describe_bricks(insitu, &all->scene, rank, 0, &m);
    SNOW_TRY(snow_insitu_update(insitu));
    SNOW_TRY(snow_insitu_render(insitu, &image));
    if (rank == 0)
        memcpy(all->whole, snow_image_pixels(image), sizeof all->whole);
    snow_image_free(image);
    how.scattered = 1;
    SET(insitu, .ranks = &how);
    SNOW_TRY(snow_insitu_render(insitu, &image));
    /* One after the other. */
    for (int turn = 0; turn < all->scene.ranks; turn++) {
        for (size_t n = 0; turn == rank && n < floats; n++) {
            float value = snow_image_pixels(image)[n];
            all->with_pixels[rank] += value != 0;
            all->sum[n] += value;
        }
        SNOW_TRY(snow_comm_agree_status(comm, SNOW_STATUS_OK));
    }
    snow_image_free(image);
    snow_insitu_free(insitu);
    free_memory(&m);
    return SNOW_STATUS_OK;
}

static void parts_of_a_scattered_picture_add_up_to_it(void **state) {
    (void)state;
    scattered *all = calloc(1, sizeof *all);
    all->scene = make_scene(4, 2, 1, 2);
    snow_context *context = support_context();
    assert_int_equal(snow_comm_run_threads(context, 4, scatter_rank, all),
                     SNOW_STATUS_OK);
    assert_memory_equal(all->sum, all->whole, sizeof all->sum);
    int ranks = 0;
    for (int rank = 0; rank < 4; rank++)
        ranks += all->with_pixels[rank] > 0;
    assert_true(ranks > 1);
    snow_context_free(context);
    free(all);
}

static void a_deterministic_picture_is_the_same_bit_for_bit(void **state) {
    (void)state;
    static const double turns[][2] = {{0, 0}, {70, 0}, {0, 80}};
    for (int i = 0; i < 3; i++) {
        scene s = make_scene(3, 1, 3, 1);
        s.settings.deterministic = 1;
        s.view.azimuth = turns[i][0];
        s.view.elevation = turns[i][1];
        run_scene(&s);
        assert_true(s.difference == 0);
        assert_true(s.figures.recut);
    }
}

/* Three bars, each before the next, and a cube in what they leave: boxes that
 * no order from front to back fits. */
static void bars_in_a_ring_are_recut(void **state) {
    (void)state;
    static const snow_box ring[] = {{{0, 0, 0}, {10, 20, 10}},
                                    {{10, 0, 0}, {10, 10, 20}},
                                    {{0, 10, 10}, {20, 10, 10}},
                                    {{0, 0, 10}, {10, 10, 10}},
                                    {{10, 10, 0}, {10, 10, 10}}};
    scene s = make_scene(5, 1, 1, 1);
    s.dims[0] = s.dims[1] = s.dims[2] = 20;
    s.bricks = 5;
    for (int n = 0; n < 5; n++) {
        s.box[n] = ring[n];
        s.owner[n] = n;
    }
    /* From the one side they are in a ring, from the other not. */
    for (int side = -1; side <= 1; side += 2) {
        const double back[3] = {side / sqrt(3), side / sqrt(3), 1 / sqrt(3)};
        const double up[3] = {-side / sqrt(6), -side / sqrt(6), 2 / sqrt(6)};
        memcpy(s.view.back, back, sizeof back);
        memcpy(s.view.up, up, sizeof up);
        s.view.azimuth = 0;
        expect_serial(&s, "a ring");
        assert_true(s.figures.recut == (side < 0));
    }
}

static void another_picture_of_the_same_voxels_encodes_nothing(void **state) {
    (void)state;
    scene s = make_scene(2, 1, 1, 2);
    run_scene(&s);
    assert_int_equal(s.encoded, 0);
}

/* --- bricks in the world -------------------------------------------------- */

/* Ranks whose bricks are told by their places: slabs along z, which share the
 * voxels of their borders or do not. */
typedef struct world {
    bool shared;
    double shift, spacing; /* of rank 1, from what is right */
    const char *refusal;   /* words of its message; NULL: none */
} world;

static snow_status place_bricks(snow_insitu *insitu, const world *w,
                                const scene *s) {
    snow_comm *comm = snow_insitu_comm(insitu);
    const int rank = snow_comm_rank(comm);
    const snow_box *box = &s->box[rank];
    const bool odd = rank == 1, shares = w->shared && rank + 1 < s->ranks;
    const double spacing[3] = {0.5, 0.25, 2 + (odd ? w->spacing : 0)};
    const snow_world_brick brick = {
        .origin = {-7 + (odd ? w->shift : 0), 3, 2 * (double)box->first[2]},
        .count = {box->count[0], box->count[1], box->count[2] + shares}};
    snow_status status = snow_insitu_place_bricks(insitu, &brick, 1, spacing);
    if (w->refusal) {
        CHECK(status == SNOW_STATUS_BAD_USAGE);
        CHECK(strstr(snow_insitu_message(insitu), w->refusal));
        return SNOW_STATUS_OK;
    }
    if (status == SNOW_STATUS_OK) /* what is as it was stays */
        status = snow_insitu_place_bricks(insitu, &brick, 1, spacing);
    SNOW_TRY(status);
    const snow_volume_info *whole = &insitu->whole;
    CHECK(memcmp(whole->dims, s->dims, sizeof s->dims) == 0);
    CHECK(whole->matrix[0][3] == -7 && whole->matrix[2][2] == 2);
    CHECK(memcmp(&insitu->bricks[0].box, box, sizeof *box) == 0);
    CHECK(insitu->bricks[0].halo.high[2] == shares);
    return SNOW_STATUS_OK;
}

static snow_status place_rank(snow_comm *comm, void *user) {
    const scene s = make_scene(3, 1, 1, 3);
    snow_insitu *insitu = NULL;
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    const snow_status status = place_bricks(insitu, user, &s);
    snow_insitu_free(insitu);
    return status;
}

static void bricks_in_the_world_find_their_grid(void **state) {
    (void)state;
    world cases[] = {
        {false, 0, 0, NULL},
        {true, 0, 0, NULL},
        {false, 0.2, 0, "begins at voxel 0.4 along axis 0"},
        {false, 0, 0.5, "spacings along axis 2 are between 2"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        snow_context *context = support_context();
        if (snow_comm_run_threads(context, 3, place_rank, &cases[n]) !=
            SNOW_STATUS_OK)
            fail_msg("case %zu: %s", n, snow_context_message(context));
        snow_context_free(context);
    }
}

/* --- movies --------------------------------------------------------------- */

/* A movie of some steps, and what became of it. */
typedef struct movie {
    scene scene;
    int steps;
    double speed;       /* of the field, a step */
    const char *suffix; /* of the frames; NULL: png */
    int run;            /* in the name of its frames */
    char pattern[256];
    double limit_seconds;
    uint64_t limit_bytes;
    bool automatic; /* look */
    snow_insitu_stats figures[20];
    int64_t most_blocks; /* of all ranks at a time */
    char given[2048];    /* remarks of rank 0 */
    snow_status status;
    char message[512];
} movie;

static void hear(void *user, const char *text) {
    movie *m = user;
    size_t used = strlen(m->given);
    snprintf(m->given + used, sizeof m->given - used, "%s\n", text);
}

static snow_status make_movie(snow_insitu *insitu, movie *m, int rank) {
    for (int step = 0; step < m->steps; step++) {
        rank_memory memory = {.count = 0};
        snow_insitu_stats figures = {.size = sizeof figures};
        snow_status status =
            describe_bricks(insitu, &m->scene, rank, m->speed * step, &memory);
        if (status == SNOW_STATUS_OK)
            status = snow_insitu_step(insitu, step);
        free_memory(&memory);
        SNOW_TRY(status);
        SNOW_TRY(snow_insitu_get_stats(insitu, &figures));
        if (rank == 0)
            m->figures[step] = figures;
    }
    return SNOW_STATUS_OK;
}

static snow_status movie_rank(snow_comm *comm, void *user) {
    movie *m = user;
    snow_insitu *insitu = NULL;
    const snow_look automatic = {.size = sizeof automatic};
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    snow_insitu_set_warning(insitu, hear, m);
    snow_status status = describe_picture(insitu, &m->scene);
    if (status == SNOW_STATUS_OK && m->automatic)
        status = SET(insitu, .look = &automatic);
    if (status == SNOW_STATUS_OK)
        status = SET(insitu, .output = m->pattern);
    const snow_insitu_limits limits = {.size = sizeof limits,
                                       .seconds = m->limit_seconds,
                                       .bytes = m->limit_bytes};
    if (status == SNOW_STATUS_OK)
        status = SET(insitu, .limits = &limits);
    if (status == SNOW_STATUS_OK)
        status = make_movie(insitu, m, snow_comm_rank(comm));
    snow_insitu_free(insitu);
    return status;
}

/* The movie must come to this status. */
static void run_movie(movie *m, const char *folder, snow_status wanted) {
    support_failing memory = {.failing = -1};
    const snow_allocator allocator = support_failing_allocator(&memory);
    snow_context *context = NULL;
    m->given[0] = 0;
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    snprintf(m->pattern, sizeof m->pattern, "%s/u%d_%%03d.%s", folder, m->run,
             m->suffix ? m->suffix : "png");
    const snow_status status =
        snow_comm_run_threads(context, m->scene.ranks, movie_rank, m);
    snprintf(m->message, sizeof m->message, "%s",
             snow_context_message(context));
    if (status != wanted)
        fail_msg("status %d: %s", (int)status, m->message);
    snow_context_free(context);
    assert_int_equal(memory.held, 0);
    m->most_blocks = memory.most_held;
}

static void path_of_frame(const movie *m, int step, char path[300]) {
    const int length = (int)(strstr(m->pattern, "%03d") - m->pattern);
    snprintf(path, 300, "%.*s%03d%s", length, m->pattern, step,
             m->pattern + length + 4);
}

static int count_frames(const movie *m) {
    int count = 0;
    char path[300];
    for (int step = 0; step < m->steps; step++) {
        path_of_frame(m, step, path);
        count += access(path, R_OK) == 0;
    }
    return count;
}

static snow_image *load_frame(snow_context *context, const movie *m, int step) {
    char path[300];
    snow_image *image = NULL;
    path_of_frame(m, step, path);
    assert_int_equal(snow_image_load(context, path, &image), SNOW_STATUS_OK);
    return image;
}

/* A frame is what one process draws of its field with a look. */
static void expect_frame(const movie *m, int step, const snow_look *look,
                         snow_image_difference *d) {
    snow_context *context = support_context();
    snow_image *frame = load_frame(context, m, step);
    snow_image *serial =
        serial_picture(context, &m->scene, m->speed * step, look);
    *d = (snow_image_difference){.size = sizeof *d};
    assert_int_equal(snow_image_compare(frame, serial, d), SNOW_STATUS_OK);
    snow_image_free(serial);
    snow_image_free(frame);
    snow_context_free(context);
}

/* Of bricks that stay in place, and of ones that are recut; of a field that
 * stands still, and of one that moves: which voxels are interesting then
 * changes a little, and rows of the encoding with it. */
static void no_step_takes_more_memory_than_the_one_before(void **state) {
    for (int i = 0; i < 4; i++) {
        movie m = {.scene = make_scene(3, i % 2 ? 3 : 1, 1, 3),
                   .steps = 6,
                   .run = 2 * i,
                   .speed = i < 2 ? 0 : 0.02};
        if (i % 2) /* recut */
            for (int n = 0; n < m.scene.bricks; n++)
                m.scene.owner[n] = (n + n / 3) % 3;
        run_movie(&m, *state, SNOW_STATUS_OK);
        int64_t most_blocks = m.most_blocks;
        assert_int_equal(count_frames(&m), 6);
        m.steps = 18;
        m.run++;
        run_movie(&m, *state, SNOW_STATUS_OK);
        assert_int_equal(m.figures[17].pictures, 18);
        double slack = i < 2 ? 1 : 1.05;
        const snow_spread *late = &m.figures[17].bytes_held,
                          *early = &m.figures[3].bytes_held;
        assert_true(late->mean <= slack * early->mean);
        assert_true(late->most <= slack * early->most);
        /* Messages on their way are blocks too, now more, now fewer. */
        assert_true(m.most_blocks <= most_blocks + 20);
        assert_int_equal(count_frames(&m), 18);
    }
}

/* An automatic look is chosen from the first step. */
static void colours_are_those_of_the_first_step(void **state) {
    movie m = {.scene = make_scene(3, 1, 1, 3), .steps = 4, .automatic = true};
    const snow_look automatic = {.size = sizeof automatic};
    snow_image_difference d;
    run_movie(&m, *state, SNOW_STATUS_OK);
    for (int step = 0; step < 4; step++) {
        expect_frame(&m, step, &automatic, &d);
        assert_true(d.largest < 1.01 / 255);
    }
}

/* The range that automatic looks of one process have together at both times. */
static void find_range(snow_context *context, const scene *s, double t,
                       snow_look *look) {
    const snow_look automatic = {.size = sizeof automatic};
    look->range = SNOW_RANGE_VALUES;
    look->low = INFINITY;
    look->high = -INFINITY;
    for (int n = 0; n < 2; n++) {
        snow_volume_info info = {.size = sizeof info, .type = s->type};
        memcpy(info.dims, s->dims, sizeof info.dims);
        void *voxels = whole_field(s, n * t);
        snow_volume *volume = NULL;
        snow_transfer *transfer = NULL;
        double low, high;
        assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                         SNOW_STATUS_OK);
        assert_int_equal(
            snow_transfer_new_for_volume(volume, &automatic, &transfer),
            SNOW_STATUS_OK);
        snow_transfer_domain(transfer, &low, &high);
        look->low = fmin(look->low, low);
        look->high = fmax(look->high, high);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        free(voxels);
    }
}

/* Growth is seen in all slices of bricks that are used in place, with halos
 * around them; what lies there beyond the grid is no growth. */
static void colours_are_spread_for_voxels_used_in_place(void **state) {
    (void)state;
    static const int cuts[][4] = {{1, 1, 1, 1}, {2, 1, 2, 1}, {4, 2, 2, 1}};
    for (int n = 0; n < 6; n++) {
        const int *cut = cuts[n % 3];
        movie m = {.scene = make_scene(cut[0], cut[1], cut[2], cut[3]),
                   .steps = 2,
                   .run = n,
                   .speed = 0.01,
                   .automatic = true};
        m.scene.grows = true;
        m.scene.halo = WIDE;
        m.scene.type = n / 3 ? SNOW_TYPE_FLOAT64 : SNOW_TYPE_FLOAT32;
        run_movie(&m, *state, SNOW_STATUS_OK);
        assert_int_equal(m.figures[1].ranks_copied, 0);
        assert_non_null(strstr(m.given, "values go beyond those before"));
        snow_look look = {.size = sizeof look};
        snow_context *context = support_context();
        snow_image_difference d;
        find_range(context, &m.scene, m.speed, &look);
        snow_context_free(context);
        expect_frame(&m, 1, &look, &d);
        if (!(d.largest < 1.01 / 255))
            fail_msg("case %d: it differs by %g from a picture of %g to %g; %s",
                     n, d.largest, look.low, look.high, m.given);
    }
}

/* Means are painted as the tool paints those of a movie; sums are, where the
 * look has a range. */
static void values_become_colours_in_files_of_colours(void **state) {
    (void)state;
    for (int n = 0; n < 2; n++) {
        movie m = {.scene = make_scene(3, 1, 1, 3), .steps = 1, .run = n};
        m.scene.settings.mode = n ? SNOW_MODE_SUM : SNOW_MODE_MEAN;
        run_movie(&m, *state, SNOW_STATUS_OK);
        snow_context *context = support_context();
        snow_opacity_point scaled[5];
        snow_look look = look_of(&m.scene, scaled);
        snow_image *frame = load_frame(context, &m, 0), *painted = NULL;
        snow_image *values = serial_picture(context, &m.scene, 0, &look);
        snow_volume *volume = NULL;
        snow_transfer *transfer = NULL;
        snow_volume_info info = {
            .size = sizeof info, .type = m.scene.type, .dims = {1, 1, 1}};
        double voxel = 0;
        snow_volume_wrap(context, &info, &voxel, &volume);
        assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                         SNOW_STATUS_OK);
        assert_int_equal(
            snow_image_apply_colormap(values, transfer, 0, 200, &painted),
            SNOW_STATUS_OK);
        assert_true(largest_difference(frame, painted) < 1.01 / 255);
        snow_image_free(painted);
        snow_image_free(values);
        snow_image_free(frame);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        snow_context_free(context);
    }
}

static void sums_without_a_range_are_for_files_of_numbers(void **state) {
    movie m = {.scene = make_scene(2, 1, 1, 2), .steps = 1, .automatic = true};
    m.scene.settings.mode = SNOW_MODE_SUM;
    run_movie(&m, *state, SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(m.message, "one range of sums for all pictures"));
    assert_int_equal(count_frames(&m), 0);
    m.suffix = "npy";
    run_movie(&m, *state, SNOW_STATUS_OK);
    assert_int_equal(count_frames(&m), 1);
}

/* Rays that meet nothing have no value: what a picture made larger has of them
 * is as much. */
static void values_that_are_made_larger_keep_their_outline(void **state) {
    double empty[4] = {0};
    movie m = {.scene = make_scene(2, 1, 1, 2),
               .steps = 4,
               .limit_seconds = 1e-9,
               .suffix = "npy"};
    m.scene.settings.mode = SNOW_MODE_MEAN;
    run_movie(&m, *state, SNOW_STATUS_OK);
    assert_int_equal(m.figures[3].lowering, SNOW_DEGRADATION_QUARTER);
    snow_context *context = support_context();
    for (int step = 0; step < 4; step++) {
        snow_image *image = load_frame(context, &m, step);
        int pixels = image->width * image->height;
        for (int n = 0; n < pixels; n++)
            empty[step] += (double)isnan(image->pixels[n]) / pixels;
        snow_image_free(image);
    }
    assert_true(empty[0] > 0.1 && empty[0] < 0.9);
    assert_true(fabs(empty[3] / empty[0] - 1) < 0.07);
    snow_context_free(context);
}

static void frames_of_an_earlier_run_are_kept(void **state) {
    movie m = {.scene = make_scene(2, 1, 1, 2), .steps = 1};
    run_movie(&m, *state, SNOW_STATUS_OK);
    run_movie(&m, *state, SNOW_STATUS_BAD_OUTPUT);
    assert_non_null(strstr(m.message, "u0_000.png"));
    assert_int_equal(count_frames(&m), 1);
}

/* Frames have the size that was asked for, and show the same. */
static void
a_limit_of_time_lowers_pictures_and_then_leaves_some_out(void **state) {
    movie m = {.scene = make_scene(2, 1, 1, 2),
               .steps = 12,
               .speed = 0.02,
               .limit_seconds = 1e-7};
    static const snow_degradation steps[] = {
        SNOW_DEGRADATION_NONE, SNOW_DEGRADATION_DRAFT, SNOW_DEGRADATION_HALF,
        SNOW_DEGRADATION_QUARTER, SNOW_DEGRADATION_SKIPPED};
    run_movie(&m, *state, SNOW_STATUS_OK);
    for (int n = 0; n < 5; n++)
        assert_int_equal(m.figures[n].lowering, steps[n]);
    assert_int_equal(m.figures[11].pictures, 4);
    assert_int_equal(m.figures[11].skipped, 8);
    assert_non_null(strstr(m.given, "quarter of the size"));
    assert_non_null(strstr(m.given, "left out"));
    snow_opacity_point scaled[5];
    snow_look look = look_of(&m.scene, scaled);
    snow_image_difference d;
    expect_frame(&m, 3, &look, &d);
    assert_true(d.psnr > 20);
    assert_int_equal(count_frames(&m), 4);
}

static void a_limit_that_suffices_lowers_nothing(void **state) {
    movie m = {.scene = make_scene(2, 1, 1, 2),
               .steps = 4,
               .limit_seconds = 1000,
               .limit_bytes = UINT64_C(1) << 32};
    run_movie(&m, *state, SNOW_STATUS_OK);
    assert_int_equal(m.figures[3].pictures, 4);
    assert_int_equal(m.figures[3].lowering, SNOW_DEGRADATION_NONE);
    assert_string_equal(m.given, "");
    assert_int_equal(count_frames(&m), 4);
}

static void a_limit_of_memory_is_kept_and_told(void **state) {
    movie m = {.scene = make_scene(2, 1, 1, 2),
               .steps = 6,
               .limit_bytes = 40000}; /* less than the voxels of a rank */
    run_movie(&m, *state, SNOW_STATUS_OK);
    assert_int_equal(m.figures[5].pictures, 0);
    assert_int_equal(m.figures[5].skipped, 6);
    assert_true(m.figures[5].bytes_peak.most <= 40000);
    assert_non_null(strstr(m.given, "under a limit"));
    assert_int_equal(count_frames(&m), 0);
}

/* What a movie held at most without a limit is too much by half: pictures get
 * smaller until they fit, and what the first try took is given back. */
static void pictures_are_smaller_where_memory_lacks(void **state) {
    movie m = {.scene = make_scene(2, 1, 1, 2), .steps = 8};
    m.scene.view.width = 900;
    m.scene.view.height = 700;
    run_movie(&m, *state, SNOW_STATUS_OK);
    double most = m.figures[7].bytes_peak.most;
    m.limit_bytes = (uint64_t)(0.75 * most);
    m.run++;
    run_movie(&m, *state, SNOW_STATUS_OK);
    assert_true(m.figures[7].pictures > 0);
    assert_int_equal(m.figures[0].lowering, SNOW_DEGRADATION_SKIPPED);
    assert_true(m.figures[0].bytes_held.most < 0.01 * most);
    assert_true(m.figures[7].lowering > SNOW_DEGRADATION_NONE);
    assert_true(m.figures[7].bytes_peak.most <= (double)m.limit_bytes);
    assert_int_equal(count_frames(&m), m.figures[7].pictures);
}

/* --- memory that fails ---------------------------------------------------- */

/* A rank that draws one picture of scattered bricks. */
static snow_status draw_once(snow_comm *comm, void *user) {
    const scene *s = user;
    rank_memory m = {.count = 0};
    snow_insitu *insitu = NULL;
    snow_image *image = NULL;
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    describe_picture(insitu, s);
    describe_bricks(insitu, s, snow_comm_rank(comm), 0, &m);
    snow_status status = snow_insitu_update(insitu);
    if (status == SNOW_STATUS_OK)
        status = snow_insitu_render(insitu, &image);
    snow_image_free(image);
    snow_insitu_free(insitu);
    free_memory(&m);
    return status;
}

/* Whichever block is refused on whichever rank: all fail alike, nobody waits
 * for ever, and nothing is left. */
static void no_block_that_is_refused_hangs_or_leaks(void **state) {
    (void)state;
    scene s = make_scene(3, 3, 1, 2);
    long refused = 0;
    for (int n = 0; n < s.bricks; n++)
        s.owner[n] = n % 3 == 0 ? 2 : n / 3;
    for (long n = 1;; n += n < 100 ? 1 : 3) {
        support_failing memory = {.failing = n};
        const snow_allocator allocator = support_failing_allocator(&memory);
        snow_context *context = NULL;
        assert_int_equal(snow_context_new(&allocator, &context),
                         SNOW_STATUS_OK);
        const snow_status status =
            snow_comm_run_threads(context, s.ranks, draw_once, &s);
        const bool all = memory.allocations <= n; /* there were no more */
        if (status != SNOW_STATUS_OK &&
            (all || status != SNOW_STATUS_NO_MEMORY))
            fail_msg("block %ld: %s", n, snow_context_message(context));
        snow_context_free(context);
        if (memory.held)
            fail_msg("block %ld: %ld are left", n, memory.held);
        if (all)
            break;
        refused++;
    }
    assert_true(refused > 50);
}

/* --- errors --------------------------------------------------------------- */

/* One way to be wrong on one rank. */
typedef enum fault {
    FAULT_SETTER,  /* a brick beyond the grid */
    FAULT_VOXELS,  /* no voxels told */
    FAULT_TYPE,    /* another type */
    FAULT_VIEW,    /* another view */
    FAULT_LOOK,    /* another colour map */
    FAULT_OPACITY, /* another opacity of one point */
    FAULT_LIGHT,   /* another setting */
    FAULT_CLIP,    /* planes on rank 0 only */
    FAULT_OVERLAP, /* voxels held twice */
    FAULT_LACK,    /* voxels that nobody holds */
    FAULT_NO_GRID, /* everywhere */
    FAULT_NO_PATH, /* a step without an output */
    FAULTS
} fault;

static const char *const fault_words[FAULTS] = {
    "rank 1: brick 0 has voxels 20 to 48 along axis 0",
    "rank 1: brick 0 has no voxels",
    "voxels are float32 on one rank and float64 on another",
    "differ between ranks",
    "differ between ranks",
    "differ between ranks",
    "differ between ranks",
    "clip planes or limits differ between ranks",
    "belongs to two ranks",
    "no rank holds",
    "there is no grid",
    "there is no path"};

typedef struct faulty {
    scene scene;
    fault fault;
    snow_status status[RANKS_MOST];
    char message[RANKS_MOST][256];
    bool recovers[RANKS_MOST];
} faulty;

static void make_fault(snow_insitu *insitu, faulty *f, int rank) {
    static const double nothing[4];
    const snow_box *box = &f->scene.box[rank];
    snow_view view = f->scene.view;
    int64_t first[3] = {20, 0, 0}, count[3];
    memcpy(count, box->count, sizeof count);
    if (f->fault == FAULT_SETTER)
        snow_insitu_set_brick(insitu, 0, first, f->scene.dims, NULL);
    if (f->fault == FAULT_VOXELS)
        snow_insitu_set_brick(insitu, 0, box->first, box->count, NULL);
    if (f->fault == FAULT_TYPE)
        snow_insitu_set_voxels(insitu, 0, SNOW_TYPE_FLOAT64, nothing, NULL);
    if (f->fault == FAULT_VIEW) {
        view.azimuth++;
        SET(insitu, .view = &view);
    }
    snow_opacity_point ramp[] = {{0, 0}, {1, 0.5}};
    snow_look look = {.size = sizeof look,
                      .colormap = "viridis",
                      .opacities = ramp,
                      .opacity_count = 2};
    snow_settings settings = {.size = sizeof settings};
    if (f->fault == FAULT_LOOK)
        look.colormap = "magma";
    if (f->fault == FAULT_OPACITY)
        ramp[1].opacity = 0.75;
    if (f->fault == FAULT_LOOK || f->fault == FAULT_OPACITY)
        SET(insitu, .look = &look);
    snow_settings_init(&settings);
    settings.diffuse = 0.5;
    if (f->fault == FAULT_LIGHT)
        SET(insitu, .picture = &settings);
    if (f->fault == FAULT_CLIP)
        SET(insitu, .clip = &(const double){0});
    if (f->fault == FAULT_OVERLAP)
        count[2]++;
    if (f->fault == FAULT_LACK)
        count[2]--;
    if (f->fault == FAULT_OVERLAP || f->fault == FAULT_LACK) {
        snow_insitu_set_brick(insitu, 0, box->first, count, NULL);
        snow_insitu_set_voxels(insitu, 0, SNOW_TYPE_FLOAT32, nothing, NULL);
    }
}

static snow_status faulty_rank(snow_comm *comm, void *user) {
    faulty *f = user;
    int rank = snow_comm_rank(comm);
    rank_memory m = {.count = 0};
    snow_insitu *insitu = NULL;
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    if (f->fault != FAULT_NO_GRID) {
        describe_picture(insitu, &f->scene);
        describe_bricks(insitu, &f->scene, rank, 0, &m);
    }
    if (rank == 1 || (rank == 2 && f->fault == FAULT_CLIP))
        make_fault(insitu, f, rank);
    f->status[rank] = f->fault == FAULT_NO_PATH ? snow_insitu_step(insitu, 0)
                                                : snow_insitu_update(insitu);
    snprintf(f->message[rank], sizeof f->message[rank], "%s",
             snow_insitu_message(insitu));
    /* After it, the same works where it is told right. */
    free_memory(&m);
    m.count = 0;
    describe_picture(insitu, &f->scene);
    describe_bricks(insitu, &f->scene, rank, 0, &m);
    f->recovers[rank] = snow_insitu_update(insitu) == SNOW_STATUS_OK;
    snow_insitu_free(insitu);
    free_memory(&m);
    return SNOW_STATUS_OK;
}

static void what_is_wrong_on_one_rank_is_told_to_all(void **state) {
    (void)state;
    for (int n = 0; n < FAULTS; n++) {
        snow_context *context = support_context();
        faulty f = {.scene = make_scene(3, 1, 1, 3), .fault = (fault)n};
        f.scene.clipped = n == FAULT_CLIP;
        assert_int_equal(snow_comm_run_threads(context, 3, faulty_rank, &f),
                         SNOW_STATUS_OK);
        for (int rank = 0; rank < 3; rank++) {
            assert_int_equal(f.status[rank], SNOW_STATUS_BAD_USAGE);
            if (!strstr(f.message[rank], fault_words[n]))
                fail_msg("fault %d, rank %d: %s", n, rank, f.message[rank]);
            assert_true(f.recovers[rank]);
        }
        snow_context_free(context);
    }
}

static void setters_refuse_what_cannot_be(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_comm *comm = NULL;
    snow_insitu *insitu = NULL;
    const int64_t none[3] = {0, 1, 1}, dims[3] = {4, 4, 4}, zero[3] = {0};
    const double flat[3] = {1, 0, 1};
    const snow_halo halo = {{0, -1, 0}, {0, 0, 0}};
    const snow_look look = {.size = sizeof look, .preset = "nothing"};
    char voxel = 0;
    assert_int_equal(snow_comm_new_self(context, &comm), SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_new(comm, &insitu), SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_set_brick(insitu, 0, zero, dims, NULL),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_insitu_set_grid(insitu, none, NULL, NULL),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_insitu_set_grid(insitu, dims, NULL, flat),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_insitu_set_grid(insitu, dims, NULL, NULL),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_set_brick(insitu, -1, zero, dims, NULL),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_insitu_set_brick(insitu, 0, zero, dims, &halo),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(
        snow_insitu_set_voxels(insitu, 0, SNOW_TYPE_UINT8, &voxel, NULL),
        SNOW_STATUS_BAD_USAGE);
    assert_int_equal(SET(insitu, .look = &look), SNOW_STATUS_BAD_USAGE);
    assert_int_equal(SET(insitu, .clip_count = 1), SNOW_STATUS_BAD_USAGE);
    assert_int_equal(SET(insitu, .clip = &(const double){0}), SNOW_STATUS_OK);
    static const char *const patterns[] = {
        "a.png", "a_%s.png", "a_%d%d.png", "a_%04x.png", "a_%099d.png", "%"};
    for (int i = 0; i < 6; i++)
        assert_int_equal(SET(insitu, .output = patterns[i]),
                         SNOW_STATUS_BAD_USAGE);
    assert_int_equal(SET(insitu, .output = "a_%d.png"), SNOW_STATUS_OK);
    /* The first of them is what the next collective call tells. */
    assert_int_equal(snow_insitu_update(insitu), SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_insitu_message(insitu), "there is no grid"));
    snow_insitu_free(insitu);
    snow_comm_free(comm);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void an_adopted_communicator_goes_with_it(void **state) {
    (void)state;
    support_failing memory = {.failing = -1};
    const snow_allocator allocator = support_failing_allocator(&memory);
    snow_context *context = NULL;
    snow_comm *comm = NULL;
    snow_insitu *insitu = NULL;
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    assert_int_equal(snow_comm_new_self(context, &comm), SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_new(comm, &insitu), SNOW_STATUS_OK);
    snow_insitu_own_comm(insitu, true);
    snow_insitu_free(insitu);
    assert_int_equal(memory.held, 0);
}

#define MOVIE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_folder_setup, \
                                    support_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_simulation_is_seen_as_by_one_process),
        cmocka_unit_test(a_list_of_colours_does),
        cmocka_unit_test(without_ghosts_there_are_seams_and_no_messages),
        cmocka_unit_test(voxels_that_lie_as_wanted_are_not_copied),
        cmocka_unit_test(bricks_that_are_no_box_are_recut),
        cmocka_unit_test(ranks_without_bricks_help),
        cmocka_unit_test(parts_of_a_scattered_picture_add_up_to_it),
        cmocka_unit_test(a_deterministic_picture_is_the_same_bit_for_bit),
        cmocka_unit_test(bars_in_a_ring_are_recut),
        cmocka_unit_test(another_picture_of_the_same_voxels_encodes_nothing),
        cmocka_unit_test(bricks_in_the_world_find_their_grid),
        MOVIE(no_step_takes_more_memory_than_the_one_before),
        MOVIE(colours_are_those_of_the_first_step),
        MOVIE(colours_are_spread_for_voxels_used_in_place),
        MOVIE(values_become_colours_in_files_of_colours),
        MOVIE(sums_without_a_range_are_for_files_of_numbers),
        MOVIE(values_that_are_made_larger_keep_their_outline),
        MOVIE(frames_of_an_earlier_run_are_kept),
        MOVIE(a_limit_of_time_lowers_pictures_and_then_leaves_some_out),
        MOVIE(a_limit_that_suffices_lowers_nothing),
        MOVIE(a_limit_of_memory_is_kept_and_told),
        MOVIE(pictures_are_smaller_where_memory_lacks),
        cmocka_unit_test(no_block_that_is_refused_hangs_or_leaks),
        cmocka_unit_test(what_is_wrong_on_one_rank_is_told_to_all),
        cmocka_unit_test(setters_refuse_what_cannot_be),
        cmocka_unit_test(an_adopted_communicator_goes_with_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
