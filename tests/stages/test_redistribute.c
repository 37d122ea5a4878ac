/* tests/stages/test_redistribute.c - voxels that change hands: any cut of a
 * grid into boxes, in any layout in memory, against a copy in one process. */
#include "support/failing.h"

#include "decompose/redistribute.h"

#define BOXES_MOST 80

/* A grid cut into boxes that are dealt to ranks, and what each rank wants. */
typedef struct scene {
    int64_t dims[3];
    int ranks, boxes;
    snow_box box[BOXES_MOST];
    int owner[BOXES_MOST];
    snow_box wanted[64];
    uint64_t seed;
    size_t value;
} scene;

static int64_t below(uint64_t *seed, int64_t end) {
    return (int64_t)(support_random(seed) % (uint64_t)end);
}

/* A voxel's value: told by its place, so that a wrong one shows. */
static uint64_t value_at(const scene *s, int64_t x, int64_t y, int64_t z) {
    uint64_t at = (uint64_t)((z * s->dims[1] + y) * s->dims[0] + x);
    return at * UINT64_C(0x9e3779b97f4a7c15) + 1;
}

/* Cuts a random box of the scene in two, across a random axis, until there are
 * enough. */
static void cut_boxes(scene *s, int boxes) {
    s->boxes = 1;
    s->box[0] = (snow_box){{0, 0, 0}, {s->dims[0], s->dims[1], s->dims[2]}};
    for (int tries = 0; s->boxes < boxes && tries < 1000; tries++) {
        snow_box *a = &s->box[below(&s->seed, s->boxes)];
        int axis = (int)below(&s->seed, 3);
        if (a->count[axis] < 2)
            continue;
        int64_t cut = 1 + below(&s->seed, a->count[axis] - 1);
        snow_box *b = &s->box[s->boxes++];
        *b = *a;
        b->first[axis] += cut;
        b->count[axis] -= cut;
        a->count[axis] = cut;
    }
    for (int n = 0; n < s->boxes; n++)
        s->owner[n] = (int)below(&s->seed, s->ranks);
}

static snow_box random_box(scene *s) {
    snow_box box;
    for (int i = 0; i < 3; i++) {
        box.first[i] = below(&s->seed, s->dims[i]);
        box.count[i] = 1 + below(&s->seed, s->dims[i] - box.first[i]);
    }
    return box;
}

static scene make_scene(int ranks, int boxes, uint64_t seed) {
    static const size_t values[] = {1, 2, 4, 8};
    scene s = {.ranks = ranks, .seed = seed * 7919 + 1};
    s.value = values[seed % 4];
    for (int i = 0; i < 3; i++)
        s.dims[i] = 5 + below(&s.seed, 30);
    cut_boxes(&s, boxes);
    for (int n = 0; n < ranks; n++) {
        s.wanted[n] = random_box(&s);
        if (below(&s.seed, 8) == 0)
            s.wanted[n].count[n % 3] = 0;
    }
    return s;
}

/* A brick with its voxels somewhere in a block, the axes in any order, padded,
 * interleaved, some running backwards. */
static snow_brick lay_out(const scene *s, const snow_box *box, uint64_t seed,
                          void **block) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int *order = orders[below(&seed, 6)];
    snow_brick brick = {*box, NULL, {0, 0, 0}};
    int64_t step = 1 + below(&seed, 3), origin = 0;
    for (int n = 0; n < 3; n++) {
        int axis = order[n];
        brick.stride[axis] = step;
        step *= box->count[axis] + below(&seed, 3);
        if (below(&seed, 4) == 0) {
            origin += brick.stride[axis] * (box->count[axis] - 1);
            brick.stride[axis] = -brick.stride[axis];
        }
    }
    char *bytes = calloc((size_t)step, s->value);
    char *first = bytes + (size_t)origin * s->value;
    for (int64_t z = 0; z < box->count[2]; z++)
        for (int64_t y = 0; y < box->count[1]; y++)
            for (int64_t x = 0; x < box->count[0]; x++) {
                uint64_t value = value_at(s, box->first[0] + x,
                                          box->first[1] + y, box->first[2] + z);
                int64_t at = x * brick.stride[0] + y * brick.stride[1] +
                             z * brick.stride[2];
                memcpy(first + at * (int64_t)s->value, &value, s->value);
            }
    *block = bytes;
    brick.voxels = first;
    return brick;
}

/* Whether a dense box holds the values of its place. */
static bool is_right(const scene *s, const snow_box *box, const char *dense) {
    for (int64_t z = 0; z < box->count[2]; z++)
        for (int64_t y = 0; y < box->count[1]; y++)
            for (int64_t x = 0; x < box->count[0]; x++, dense += s->value) {
                uint64_t value = value_at(s, box->first[0] + x,
                                          box->first[1] + y, box->first[2] + z);
                if (memcmp(dense, &value, s->value) != 0)
                    return false;
            }
    return true;
}

/* Fails in words that the group of ranks passes on. */
static snow_status expect(snow_comm *comm, bool right, const char *what) {
    return right ? SNOW_STATUS_OK
                 : snow_fail(snow_comm_context(comm), SNOW_STATUS_FAILED, "%s",
                             what);
}

/* Moves twice; the second time may not take memory. */
static snow_status move(snow_comm *comm, const scene *s, snow_voxels *voxels,
                        const snow_brick *bricks, char *dense) {
    const snow_box *wanted = &s->wanted[snow_comm_rank(comm)];
    SNOW_TRY(snow_voxels_move(voxels, bricks, s->value, dense));
    SNOW_TRY(expect(comm, is_right(s, wanted, dense), "wrong voxels"));
    uint64_t peak = snow_context_peak_bytes(snow_comm_context(comm));
    memset(dense, 0, (size_t)snow_box_voxels(wanted) * s->value);
    SNOW_TRY(snow_voxels_move(voxels, bricks, s->value, dense));
    SNOW_TRY(expect(comm, is_right(s, wanted, dense), "wrong voxels again"));
    return expect(comm,
                  snow_context_peak_bytes(snow_comm_context(comm)) == peak,
                  "the second move took memory");
}

static snow_status move_scene(snow_comm *comm, void *user) {
    const scene *s = user;
    int me = snow_comm_rank(comm), count = 0;
    snow_box held[BOXES_MOST];
    snow_brick bricks[BOXES_MOST];
    void *blocks[BOXES_MOST];
    for (int n = 0; n < s->boxes; n++)
        if (s->owner[n] == me) {
            held[count] = s->box[n];
            bricks[count] =
                lay_out(s, &s->box[n], s->seed + (uint64_t)n, &blocks[count]);
            count++;
        }
    size_t bytes = (size_t)snow_box_voxels(&s->wanted[me]) * s->value;
    char *dense = calloc(bytes + 1, 1);
    snow_voxels *voxels = NULL;
    snow_status status = snow_voxels_new(comm, &voxels);
    if (status == SNOW_STATUS_OK)
        status = snow_voxels_plan(voxels, held, count, &s->wanted[me]);
    if (status == SNOW_STATUS_OK)
        status = move(comm, s, voxels, bricks, dense);
    snow_voxels_free(voxels);
    for (int n = 0; n < count; n++)
        free(blocks[n]);
    free(dense);
    return status;
}

/* Runs a scene on its ranks. */
static void run_scene(scene *s) {
    snow_context *context = support_context();
    snow_status status =
        snow_comm_run_threads(context, s->ranks, move_scene, s);
    if (status != SNOW_STATUS_OK)
        print_error("%d ranks, seed %llu: %s\n", s->ranks,
                    (unsigned long long)s->seed, snow_context_message(context));
    assert_int_equal(status, SNOW_STATUS_OK);
    snow_context_free(context);
}

static void any_cut_moves_to_any_boxes(void **state) {
    (void)state;
    static const int ranks[] = {1, 2, 3, 4, 5, 7, 8, 13, 16, 27, 33};
    for (uint64_t seed = 0; seed < 66; seed++) {
        if (!support_takes((size_t)seed, 5))
            continue;
        int count = ranks[seed % 11];
        scene s = make_scene(count, 1 + (int)(seed * 5 % BOXES_MOST), seed);
        run_scene(&s);
    }
}

/* More than the buffers hold, of thin and of thick boxes. */
static void many_voxels_move_in_rounds(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        scene s = make_scene(3, 1, seed);
        s.dims[0] = 160;
        s.dims[1] = 150;
        s.dims[2] = 140;
        s.value = 8; /* 27 MB */
        const snow_box all = {{0, 0, 0}, {160, 150, 140}};
        cut_boxes(&s, 3 * (int)seed);
        for (int n = 0; n < s.ranks; n++)
            s.wanted[n] = n ? random_box(&s) : all;
        run_scene(&s);
    }
}

/* Which of the two ranks held voxel n of a box. */
static int holder_of(const scene *s, const snow_box *box, int64_t n) {
    const int64_t x = box->first[0] + n % box->count[0];
    const int64_t z = box->first[2] + n / (box->count[0] * box->count[1]);
    return x >= s->box[1].first[0] && z >= s->box[1].first[2];
}

/* Two ranks, which need what they held no longer. */
static snow_status give_up(snow_comm *comm, void *user) {
    const scene *s = user;
    const int me = snow_comm_rank(comm);
    const snow_box *b = &s->box[me], *wanted = &s->wanted[me];
    const size_t bytes = (size_t)snow_box_voxels(b) * s->value;
    const size_t moved = (size_t)snow_box_voxels(wanted) * s->value;
    char *held = malloc(bytes), *dense = malloc(moved);
    const snow_brick brick = {
        *b, held, {1, b->count[0], b->count[0] * b->count[1]}};
    snow_voxels *voxels = NULL;
    memset(held, me + 1, bytes);
    snow_status status = snow_voxels_new(comm, &voxels);
    if (status == SNOW_STATUS_OK)
        status = snow_voxels_plan(voxels, b, 1, wanted);
    if (status == SNOW_STATUS_OK) {
        snow_voxels_expect(voxels, true, false);
        status = snow_voxels_move(voxels, &brick, s->value, dense);
    }
    for (size_t n = 0; n < moved && status == SNOW_STATUS_OK; n++)
        status = expect(
            comm, dense[n] == 1 + holder_of(s, wanted, (int64_t)(n / s->value)),
            "wrong voxels");
#ifdef __linux__ /* fills pages that were given back with zeros */
    for (size_t n = bytes / 8; n < bytes && status == SNOW_STATUS_OK;
         n += bytes / 8)
        status = expect(comm, held[n] == 0, "no memory was given back");
#endif
    snow_voxels_free(voxels);
    free(held);
    free(dense);
    return status;
}

/* Of 16 MB each rank keeps 15, some slices at a time: 1 MB that moves is never
 * held at once. */
static void what_is_kept_is_not_held_twice(void **state) {
    (void)state;
    scene s = {.ranks = 2, .value = 8};
    s.box[0] = (snow_box){{0, 0, 0}, {64, 128, 256}};
    s.box[1] = (snow_box){{64, 0, 0}, {64, 128, 256}};
    s.wanted[0] = (snow_box){{0, 0, 0}, {60, 128, 256}};
    s.wanted[1] = (snow_box){{60, 0, 0}, {68, 128, 256}};
    support_failing failing = {.failing = -1, .largest = (size_t)1 << 19};
    snow_allocator allocator = support_failing_allocator(&failing);
    snow_context *context = NULL;
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    if (snow_comm_run_threads(context, 2, give_up, &s) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    snow_context_free(context);
}

static void what_has_moved_gives_its_memory_back(void **state) {
    (void)state;
    scene s = {.ranks = 2, .value = 4};
    s.box[0] = s.wanted[1] = (snow_box){{0, 0, 0}, {150, 161, 63}};
    s.box[1] = s.wanted[0] = (snow_box){{0, 0, 63}, {150, 161, 63}};
    snow_context *context = support_context();
    assert_int_equal(snow_comm_run_threads(context, 2, give_up, &s),
                     SNOW_STATUS_OK);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_cut_moves_to_any_boxes),
        cmocka_unit_test(many_voxels_move_in_rounds),
        cmocka_unit_test(what_is_kept_is_not_held_twice),
        cmocka_unit_test(what_has_moved_gives_its_memory_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
