/* tests/parallel/test_insitu_levels.c - bricks whose cells are several voxels
 * wide, in one picture with finer ones: however they are dealt to ranks it is
 * that of the same field on the finest grid. */
#include "support/support.h"

#include "formats/amr/amr.h"
#include "image/image.h"
#include "insitu/internal.h"

#include <math.h>

#define BRICKS 6
#define DIMS \
    { 96, 80, 64 }

/* Values below finer cells, which must not be seen. */
#define COVERED 1e30

/* A grid of three sizes of cells, and what is to be found wrong with it. */
typedef struct scene {
    int ranks;
    snow_type type;
    int64_t halo;
    snow_context *context; /* of one rank, and its grid */
    snow_volume_info whole;
    const char *wrong; /* part of a message; NULL: none */
    snow_box odd;      /* replaces the finest brick, unless it is empty */
    uint64_t sent[8];  /* by each rank: bytes, of values in place */
    double share;      /* of pixels that differ by more than 2 of 255 */
    double largest;
} scene;

static const int64_t dims[3] = DIMS;
static const struct {
    snow_box box; /* of voxels */
    int64_t cells[3];
} bricks[BRICKS] = {
    {{{0, 0, 0}, {48, 80, 64}}, {4, 4, 4}},
    {{{48, 0, 0}, {48, 80, 64}}, {4, 4, 4}},
    {{{24, 16, 16}, {28, 40, 32}}, {2, 2, 2}},
    {{{52, 16, 16}, {20, 40, 32}}, {2, 2, 2}},
    {{{0, 60, 0}, {12, 20, 16}}, {2, 2, 2}}, /* at the grid's side */
    {{{32, 24, 20}, {32, 24, 20}}, {1, 1, 1}},
};

static double field(double x, double y, double z) {
    double u = x / 96 - 0.5, v = y / 80 - 0.45, w = z / 64 - 0.5;
    return exp(-(u * u + v * v + w * w) / 0.03) + 0.1 * sin(5 * x / 96 + v);
}

static bool holds(const snow_box *box, const double at[3]) {
    for (int i = 0; i < 3; i++)
        if (at[i] < (double)box->first[i] ||
            at[i] > (double)(box->first[i] + box->count[i] - 1))
            return false;
    return true;
}

/* At the centre of a cell, in voxels; covered cells have nonsense. */
static double value_at(int n, const double at[3]) {
    for (int m = 2; m < BRICKS; m++)
        if (bricks[m].cells[0] < bricks[n].cells[0] &&
            holds(&bricks[m].box, at))
            return COVERED;
    return field(at[0], at[1], at[2]);
}

static void put(snow_type type, void *voxels, int64_t at, double value) {
    if (type == SNOW_TYPE_FLOAT32)
        ((float *)voxels)[at] = (float)value;
    else if (type == SNOW_TYPE_FLOAT64)
        ((double *)voxels)[at] = value;
}

/* A brick's cells with their halo; *own: the first one behind it. */
static void *make_cells(const scene *s, int n, const snow_box *box,
                        void **own) {
    const int64_t *cells = bricks[n].cells;
    int64_t size[3], at = 0;
    double place[3];
    for (int i = 0; i < 3; i++)
        size[i] = box->count[i] / cells[i] + 2 * s->halo;
    char *made = calloc((size_t)(size[0] * size[1] * size[2]), 8);
    for (int64_t z = 0; z < size[2]; z++)
        for (int64_t y = 0; y < size[1]; y++)
            for (int64_t x = 0; x < size[0]; x++) {
                const int64_t from[3] = {x, y, z};
                for (int i = 0; i < 3; i++)
                    place[i] =
                        (double)box->first[i] +
                        ((double)(from[i] - s->halo) + 0.5) * (double)cells[i] -
                        0.5;
                put(s->type, made, at++, value_at(n, place));
            }
    *own = made + (size_t)(s->halo * (1 + size[0] * (1 + size[1]))) *
                      snow_type_size(s->type);
    return made;
}

static snow_status give_bricks(snow_insitu *insitu, const scene *s, int rank,
                               void *blocks[BRICKS]) {
    const snow_halo halo = {{s->halo, s->halo, s->halo},
                            {s->halo, s->halo, s->halo}};
    int id = 0;
    for (int n = 0; n < BRICKS; n++) {
        const bool odd = n == BRICKS - 1 && s->odd.count[0];
        const snow_box *box = odd ? &s->odd : &bricks[n].box;
        void *own;
        if (n % s->ranks != rank)
            continue;
        blocks[n] = make_cells(s, n, box, &own);
        SNOW_TRY(
            snow_insitu_set_brick(insitu, id, box->first, box->count, &halo));
        SNOW_TRY(snow_insitu_set_cells(insitu, id, bricks[n].cells));
        SNOW_TRY(snow_insitu_set_voxels(insitu, id++, s->type, own, NULL));
    }
    return SNOW_STATUS_OK;
}

static snow_view view_of(void) {
    snow_view view = {.size = sizeof view};
    snow_view_init(&view);
    view.width = view.height = 160;
    view.azimuth = 30;
    view.elevation = 20;
    return view;
}

static const snow_opacity_point points[] = {{0.1, 0}, {0.5, 0.05}, {1, 0.5}};
static const snow_look look = {.size = sizeof look,
                               .preset = "linear",
                               .colormap = "inferno",
                               .range = SNOW_RANGE_VALUES,
                               .high = 1,
                               .opacities = points,
                               .opacity_count = 3};

/* The field on the finest grid, by one process. */
static snow_image *even_picture(snow_context *context) {
    snow_volume_info info = {
        .size = sizeof info, .type = SNOW_TYPE_FLOAT32, .dims = DIMS};
    float *voxels = malloc((size_t)(dims[0] * dims[1] * dims[2]) * 4);
    snow_view view = view_of();
    snow_settings settings;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    snow_image *image = NULL;
    for (int64_t i = 0; i < dims[0] * dims[1] * dims[2]; i++)
        voxels[i] =
            (float)field((double)(i % dims[0]), (double)(i / dims[0] % dims[1]),
                         (double)(i / dims[0] / dims[1]));
    snow_settings_init(&settings);
    settings.shade = SNOW_SHADE_NONE;
    snow_volume_wrap(context, &info, voxels, &volume);
    snow_transfer_new_for_volume(volume, &look, &transfer);
    snow_frame_new(context, &frame);
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &view, &settings, &image),
        SNOW_STATUS_OK);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    free(voxels);
    return image;
}

static void compare(scene *s, const snow_image *image) {
    snow_context *context = support_context();
    snow_image *even = even_picture(context);
    const int pixels = image->width * image->height;
    int differ = 0;
    s->largest = 0;
    for (int i = 0; i < pixels; i++) {
        double most = 0;
        for (int c = 0; c < 4; c++)
            most = fmax(most, fabs((double)image->pixels[4 * i + c] -
                                   (double)even->pixels[4 * i + c]));
        differ += most > 2. / 255;
        s->largest = fmax(s->largest, most);
    }
    s->share = (double)differ / pixels;
    snow_image_free(even);
    snow_context_free(context);
}

static snow_status draw(snow_insitu *insitu, scene *s) {
    const snow_view view = view_of();
    snow_settings settings;
    snow_image *image = NULL;
    snow_settings_init(&settings);
    settings.shade = SNOW_SHADE_NONE;
    const snow_insitu_settings all = {
        .size = sizeof all, .view = &view, .picture = &settings, .look = &look};
    SNOW_TRY(snow_insitu_set(insitu, &all));
    uint64_t messages, before = 0,
                       *sent = &s->sent[snow_comm_rank(insitu->comm)];
    for (int again = 0; again < 2; again++) {
        snow_image_free(image);
        image = NULL;
        snow_comm_sent(insitu->comm, &messages, &before);
        SNOW_TRY(snow_insitu_update(insitu));
        snow_comm_sent(insitu->comm, &messages, sent);
        *sent -= before;
        SNOW_TRY(snow_insitu_render(insitu, &image));
    }
    if (image)
        compare(s, image);
    snow_image_free(image);
    return SNOW_STATUS_OK;
}

static snow_status run_rank(snow_comm *comm, void *user) {
    scene *s = user;
    void *blocks[BRICKS] = {NULL};
    snow_insitu *insitu = NULL;
    const int rank = snow_comm_rank(comm);
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    snow_status status = snow_insitu_set_grid(insitu, dims, NULL, NULL);
    if (status == SNOW_STATUS_OK) /* what is wrong is told to all below */
        give_bricks(insitu, s, rank, blocks);
    if (status == SNOW_STATUS_OK)
        status = draw(insitu, s);
    if (s->wrong && !strstr(snow_insitu_message(insitu), s->wrong))
        status = snow_fail(insitu->context, SNOW_STATUS_FAILED, "says \"%s\"",
                           snow_insitu_message(insitu));
    snow_insitu_free(insitu);
    for (int n = 0; n < BRICKS; n++)
        free(blocks[n]);
    return status;
}

static void run(scene *s, snow_status wanted) {
    snow_context *context = support_context();
    snow_status status = snow_comm_run_threads(context, s->ranks, run_rank, s);
    if (status != wanted)
        fail_msg("%d ranks: %s", s->ranks, snow_context_message(context));
    snow_context_free(context);
}

static void cells_of_all_sizes_are_one_picture(void **state) {
    (void)state;
    static const int ranks[] = {1, 2, 3, 6};
    for (size_t i = 0; i < 4; i++)
        for (int64_t halo = 0; halo <= 3; halo += 3) {
            scene s = {.ranks = ranks[i],
                       .halo = halo,
                       .type = i % 2 ? SNOW_TYPE_FLOAT64 : SNOW_TYPE_FLOAT32};
            run(&s, SNOW_STATUS_OK);
            if (s.share > 0.01 || s.largest > 0.05)
                fail_msg("%d ranks, halo %d: %g of the pixels differ, by %g",
                         s.ranks, (int)halo, s.share, s.largest);
        }
}

/* Not voxels: of the finest grid all ranks would send most of 1.97 MB. */
static void ranks_send_the_cells_that_others_need(void **state) {
    (void)state;
    static const uint64_t bounds[] = {0, 0, 120000, 360000, 460000};
    for (int ranks = 2; ranks <= 4; ranks++) {
        scene s = {.ranks = ranks, .halo = 3, .type = SNOW_TYPE_FLOAT32};
        run(&s, SNOW_STATUS_OK);
        uint64_t all = 0;
        for (int rank = 0; rank < ranks; rank++)
            all += s.sent[rank];
        if (all == 0 || all > bounds[ranks])
            fail_msg("%d ranks send %llu bytes", ranks,
                     (unsigned long long)all);
    }
}

static void what_cannot_be_refined_is_refused(void **state) {
    (void)state;
    static const struct {
        snow_type type;
        snow_box odd;
        const char *wrong;
    } cases[] = {
        {SNOW_TYPE_INT16, {{0, 0, 0}, {0, 0, 0}}, "must be float32 or float64"},
        {SNOW_TYPE_FLOAT32,
         {{33, 24, 20}, {31, 24, 20}},
         "let finer bricks end where coarser cells do"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int ranks = 1; ranks < 4; ranks += 2) {
            scene s = {.ranks = ranks,
                       .type = cases[i].type,
                       .odd = cases[i].odd,
                       .wrong = cases[i].wrong};
            run(&s, SNOW_STATUS_BAD_USAGE);
        }
}

/* --- files ---------------------------------------------------------------- */

/* A part of a brick's cells, as a file would have them. */
static snow_status read_cells(void *user, size_t number, const snow_box *part,
                              snow_volume **out) {
    const scene *s = user;
    const int64_t *cells = bricks[number].cells;
    snow_volume_info info = s->whole;
    info.type = s->type;
    memcpy(info.dims, part->count, sizeof info.dims);
    SNOW_TRY(snow_volume_new(s->context, &info, out));
    for (int64_t n = 0; n < snow_box_voxels(part); n++) {
        const int64_t at[3] = {n % part->count[0],
                               n / part->count[0] % part->count[1],
                               n / part->count[0] / part->count[1]};
        double place[3];
        for (int i = 0; i < 3; i++)
            place[i] =
                ((double)(part->first[i] + at[i]) + 0.5) * (double)cells[i] -
                0.5;
        put(s->type, (*out)->owned, n, value_at((int)number, place));
    }
    return SNOW_STATUS_OK;
}

/* The box that a rank holds, read as that of a file with these bricks. */
static snow_status read_box(scene *s, const snow_box *box, snow_volume **out) {
    amr_grid grid = {.context = s->context,
                     .levels = 3,
                     .ratio = {{1, 1, 1}, {2, 2, 2}, {2, 2, 2}},
                     .cells = {dims[0] / 4, dims[1] / 4, dims[2] / 4},
                     .size = {4, 4, 4},
                     .type = s->type,
                     .read = read_cells,
                     .user = s};
    snow_volume_options options = {.size = sizeof options};
    snow_volume_info info = s->whole;
    for (int n = 0; n < BRICKS; n++) {
        const int64_t wide = bricks[n].cells[0];
        snow_box cells = bricks[n].box;
        for (int i = 0; i < 3; i++) {
            cells.first[i] /= wide;
            cells.count[i] /= wide;
        }
        SNOW_TRY(snow_amr_add(&grid,
                              wide == 4   ? 0
                              : wide == 2 ? 1
                                          : 2,
                              &cells));
    }
    SNOW_TRY(snow_amr_describe(&grid, &options, &info));
    for (int i = 0; i < 3; i++) {
        options.crop[i][0] = box->first[i];
        options.crop[i][1] = box->first[i] + box->count[i];
    }
    snow_status status = snow_amr_read(&grid, &options, &info, out);
    snow_amr_free(&grid);
    return status;
}

static snow_status hold_against_file(snow_comm *comm, void *user) {
    scene s = *(const scene *)user;
    void *blocks[BRICKS] = {NULL};
    snow_insitu *insitu = NULL;
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    s.context = insitu->context;
    SNOW_TRY(snow_insitu_set_grid(insitu, dims, NULL, NULL));
    s.whole = insitu->whole;
    SNOW_TRY(give_bricks(insitu, &s, snow_comm_rank(comm), blocks));
    SNOW_TRY(snow_insitu_update(insitu));
    snow_volume *file = NULL;
    SNOW_TRY(read_box(&s, &insitu->layout.stored, &file));
    const size_t bytes = (size_t)snow_box_voxels(&insitu->layout.stored) *
                         snow_type_size(s.type);
    const bool same = memcmp(snow_volume_voxels(insitu->volume),
                             snow_volume_voxels(file), bytes) == 0;
    snow_volume_close(file);
    snow_insitu_free(insitu);
    for (int n = 0; n < BRICKS; n++)
        free(blocks[n]);
    return same ? SNOW_STATUS_OK
                : snow_context_fail(s.context, SNOW_STATUS_FAILED, "differ");
}

/* Bit for bit, so that pictures of a run and of its files are the same. */
static void voxels_are_those_of_a_file(void **state) {
    (void)state;
    for (int ranks = 1; ranks <= 7; ranks += 3)
        for (int i = 0; i < 2; i++) {
            scene s = {.ranks = ranks,
                       .halo = 3 * i,
                       .type = i ? SNOW_TYPE_FLOAT64 : SNOW_TYPE_FLOAT32};
            snow_context *context = support_context();
            if (snow_comm_run_threads(context, ranks, hold_against_file, &s) !=
                SNOW_STATUS_OK)
                fail_msg("%d ranks: %s", ranks, snow_context_message(context));
            snow_context_free(context);
        }
}

static snow_status set_wrong(snow_comm *comm, void *user) {
    static const int64_t first[3] = {4, 0, 0}, count[3] = {6, 8, 8};
    static const int64_t four[3] = {4, 4, 4}, none[3] = {1, 0, 1};
    snow_insitu *insitu = NULL;
    (void)user;
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    snow_insitu_set_grid(insitu, dims, NULL, NULL);
    assert_int_equal(snow_insitu_set_cells(insitu, 0, four),
                     SNOW_STATUS_BAD_USAGE);
    snow_insitu_set_brick(insitu, 0, first, count, NULL);
    assert_int_equal(snow_insitu_set_cells(insitu, 0, four),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_insitu_set_cells(insitu, 0, none),
                     SNOW_STATUS_BAD_USAGE);
    snow_insitu_free(insitu);
    return SNOW_STATUS_OK;
}

static void a_brick_ends_where_its_cells_do(void **state) {
    (void)state;
    snow_context *context = support_context();
    assert_int_equal(snow_comm_run_threads(context, 1, set_wrong, NULL),
                     SNOW_STATUS_OK);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_of_all_sizes_are_one_picture),
        cmocka_unit_test(voxels_are_those_of_a_file),
        cmocka_unit_test(ranks_send_the_cells_that_others_need),
        cmocka_unit_test(what_cannot_be_refined_is_refused),
        cmocka_unit_test(a_brick_ends_where_its_cells_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
