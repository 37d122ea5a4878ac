/* tests/transfer/test_histogram.c - many ranks make of their parts the transfer
 * function that one makes of the whole, to the bit, however it is cut. */
#include "support/support.h"

#include "transfer/look.h"

#include <snowglass/ranks.h>

#include <math.h>

#define MOST_RANKS 33

/* A volume that is dealt out. */
typedef struct whole {
    snow_volume_info info;
    const unsigned char *voxels;
    snow_extent parts[MOST_RANKS];
    const snow_look *look;
    const snow_transfer *expected;
    bool shared; /* parts are runs of the whole's memory: slabs along z */
} whole;

/* On a thread of its own, where nothing can be asserted. */
static snow_status compare(const snow_transfer *a, const snow_transfer *b) {
    if (a->color_count == b->color_count &&
        a->opacity_count == b->opacity_count &&
        !memcmp(a->colors, b->colors, a->color_count * sizeof *a->colors) &&
        !memcmp(a->opacities, b->opacities,
                a->opacity_count * sizeof *a->opacities) &&
        !strcmp(a->text, b->text))
        return SNOW_STATUS_OK;
    return snow_fail(a->context, SNOW_STATUS_BAD_INPUT, "\"%s\" is not \"%s\"",
                     a->text, b->text);
}

/* The voxels of a part, ghosts and all. */
static void take(const whole *w, const snow_extent *part,
                 const int64_t stored[3], unsigned char *to) {
    size_t size = snow_type_size(w->info.type);
    const int64_t *dims = w->info.dims;
    for (int64_t z = 0; z < stored[2]; z++)
        for (int64_t y = 0; y < stored[1]; y++) {
            int64_t row =
                ((part->stored[2] + z) * dims[1] + part->stored[1] + y) *
                    dims[0] +
                part->stored[0];
            memcpy(to, w->voxels + (size_t)row * size,
                   (size_t)stored[0] * size);
            to += (size_t)stored[0] * size;
        }
}

/* One rank: its part with a layer of ghosts, or one voxel of nobody's. */
static snow_status make_part(snow_comm *comm, void *user) {
    const whole *w = user;
    snow_extent part = w->parts[snow_comm_rank(comm)];
    snow_volume_info info = w->info;
    snow_volume *volume;
    snow_transfer *transfer;
    bool none = !part.count[0] || !part.count[1] || !part.count[2];
    for (int i = 0; i < 3; i++) {
        int64_t ghosts = w->shared ? 0 : 1;
        int64_t first = none ? 0 : part.first[i] - ghosts;
        int64_t end = none ? 1 : part.first[i] + part.count[i] + ghosts;
        part.dims[i] = w->info.dims[i];
        part.stored[i] = first < 0 ? 0 : first;
        info.dims[i] =
            (end < part.dims[i] ? end : part.dims[i]) - part.stored[i];
    }
    size_t size = snow_type_size(info.type);
    size_t slice = (size_t)(info.dims[0] * info.dims[1]) * size;
    unsigned char *own = NULL;
    const unsigned char *voxels = w->voxels + (size_t)part.stored[2] * slice;
    if (!w->shared) {
        own = malloc(slice * (size_t)info.dims[2]);
        take(w, &part, info.dims, own);
        voxels = own;
    }
    SNOW_TRY(snow_volume_wrap(snow_comm_context(comm), &info, voxels, &volume));
    snow_status status = snow_volume_set_extent(volume, &part);
    if (status == SNOW_STATUS_OK)
        status = snow_ranks_new_transfer(comm, volume, w->look, &transfer);
    if (status == SNOW_STATUS_OK) {
        status = compare(transfer, w->expected);
        snow_transfer_free(transfer);
    }
    snow_volume_close(volume);
    free(own);
    return status;
}

/* Cuts a box in two again and again, anywhere, so that some get nothing. */
static void cut(whole *w, uint64_t *random, snow_extent box, int first,
                int ranks) {
    if (ranks == 1) {
        w->parts[first] = box;
        return;
    }
    int axis = (int)(support_random(random) % 3), half = ranks / 2;
    int64_t at =
        (int64_t)(support_random(random) % (uint64_t)(box.count[axis] + 1));
    snow_extent low = box, high = box;
    low.count[axis] = at;
    high.first[axis] += at;
    high.count[axis] -= at;
    cut(w, random, low, first, half);
    cut(w, random, high, first + half, ranks - half);
}

static const snow_opacity_point points[] = {{0, 0}, {9, 0.5}};
static const snow_look looks[] = {
    {.size = sizeof(snow_look)},
    {.size = sizeof(snow_look), .range = SNOW_RANGE_FULL},
    {.size = sizeof(snow_look),
     .range = SNOW_RANGE_PERCENTILES,
     .low = 3,
     .high = 97.5},
    {.size = sizeof(snow_look),
     .preset = "ct-bone",
     .range = SNOW_RANGE_PERCENTILES,
     .high = 60},
    {.size = sizeof(snow_look), .preset = "linear", .colormap = "viridis"},
    {.size = sizeof(snow_look),
     .opacities = points,
     .opacity_count = 2,
     .range = SNOW_RANGE_VALUES,
     .low = 1,
     .high = 5},
};

/* All looks of a volume that is whole, and as many ranks have it. */
static void check(snow_context *context, whole *w, int ranks,
                  uint64_t *random) {
    snow_volume *volume;
    assert_int_equal(snow_volume_wrap(context, &w->info, w->voxels, &volume),
                     SNOW_STATUS_OK);
    for (size_t i = 0; i < sizeof looks / sizeof *looks; i++) {
        snow_transfer *expected;
        snow_extent all = {
            .size = sizeof all,
            .count = {w->info.dims[0], w->info.dims[1], w->info.dims[2]}};
        assert_int_equal(
            snow_transfer_new_for_volume(volume, &looks[i], &expected),
            SNOW_STATUS_OK);
        w->look = &looks[i];
        w->expected = expected;
        cut(w, random, all, 0, ranks);
        if (snow_comm_run_threads(context, ranks, make_part, w) !=
            SNOW_STATUS_OK)
            fail_msg("%s", snow_context_message(context));
        snow_transfer_free(expected);
    }
    snow_volume_close(volume);
}

/* Air, an object and what is denser in it, as a type has them. */
static double value_at(uint64_t *random, int64_t i) {
    double noise = support_uniform(random);
    return i % 7 < 4   ? 3 + 2 * noise
           : i % 7 < 6 ? 60 + 20 * noise
                       : 110 + noise;
}

static void fill(snow_type type, unsigned char *to, int64_t voxels,
                 uint64_t *random) {
    for (int64_t i = 0; i < voxels; i++) {
        double value = value_at(random, i);
        switch (type) {
#define STORE(name, c_type, text)                  \
    case SNOW_TYPE_##name:                         \
        ((c_type *)(void *)to)[i] = (c_type)value; \
        break;
            SNOW_TYPE_MAP(STORE)
#undef STORE
        default:
            break;
        }
    }
}

#define VOXELS (13 * 11 * 9)

static void every_type_gives_the_same_function_for_any_cut(void **state) {
    (void)state;
    static uint64_t memory[VOXELS];
    snow_context *context = support_context();
    uint64_t random = 11;
    for (int type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++) {
        whole w = {.info = {.size = sizeof(snow_volume_info),
                            .dims = {13, 11, 9},
                            .type = (snow_type)type,
                            .slope = type % 2 ? 0.25 : -3,
                            .intercept = 2},
                   .voxels = (unsigned char *)memory};
        fill((snow_type)type, (unsigned char *)memory, VOXELS, &random);
        check(context, &w, 1 + type % 5, &random);
        if (support_takes((size_t)type, 3))
            check(context, &w, 3 * type + 3, &random);
    }
    snow_context_free(context);
}

static void values_that_are_no_numbers_are_left_out_on_all_ranks(void **state) {
    (void)state;
    static float values[VOXELS];
    snow_context *context = support_context();
    uint64_t random = 5;
    whole w = {.info = {.size = sizeof(snow_volume_info),
                        .dims = {13, 11, 9},
                        .type = SNOW_TYPE_FLOAT32},
               .voxels = (unsigned char *)values};
    fill(SNOW_TYPE_FLOAT32, (unsigned char *)values, VOXELS, &random);
    for (int i = 0; i < VOXELS; i += 2)
        values[i] = i % 3 ? NAN : i % 5 ? INFINITY : -INFINITY;
    check(context, &w, 7, &random);
    for (int i = 0; i < VOXELS; i++)
        values[i] = NAN;
    check(context, &w, 4, &random);
    values[700] = -2;
    check(context, &w, 16, &random);
    for (int i = 0; i < VOXELS; i++)
        values[i] = i % 2 ? 0.0F : -0.0F;
    check(context, &w, 5, &random);
    snow_context_free(context);
}

/* Slices of padding, and slices with no voxel of it. */
static void padding_is_counted_where_it_is(void **state) {
    (void)state;
    static float values[VOXELS];
    snow_context *context = support_context();
    uint64_t random = 5;
    whole w = {.info = {.size = sizeof(snow_volume_info),
                        .dims = {13, 11, 9},
                        .type = SNOW_TYPE_FLOAT32},
               .voxels = (unsigned char *)values};
    fill(SNOW_TYPE_FLOAT32, (unsigned char *)values, VOXELS, &random);
    for (int i = 0; i < VOXELS; i++)
        values[i] = i < VOXELS / 3 ? -1 : values[i] < 50 ? 3 : values[i];
    for (int i = 0; i < 3; i++)
        check(context, &w, 6, &random);
    snow_context_free(context);
}

/* 2^25 voxels and some: every second block of 1024 voxels is looked at, the
 * same ones by whomever. */
/* A prime: rows of the volume differ. */
#define PERIOD 1048573

static void a_sample_of_a_large_volume_is_the_same_one(void **state) {
    (void)state;
    snow_context *context = support_context();
    uint64_t random = 9;
    whole w = {.info = {.size = sizeof(snow_volume_info),
                        .dims = {509, 401, 165},
                        .type = SNOW_TYPE_FLOAT32},
               .shared = true};
    const int64_t *dims = w.info.dims;
    size_t voxels = (size_t)(dims[0] * dims[1] * dims[2]);
    float *values = malloc(voxels * sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < PERIOD; i++)
        values[i] = (float)value_at(&random, (int64_t)(i / 20));
    for (size_t i = PERIOD; i < voxels; i += PERIOD)
        memcpy(values + i, values,
               (voxels - i < PERIOD ? voxels - i : PERIOD) * sizeof *values);
    w.voxels = (unsigned char *)values;
    snow_volume *volume;
    snow_transfer *expected;
    assert_int_equal(snow_volume_wrap(context, &w.info, values, &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, &looks[0], &expected),
                     SNOW_STATUS_OK);
    w.look = &looks[0];
    w.expected = expected;
    for (int rank = 0, at = 0; rank < 3; rank++) {
        int count = rank < 2 ? 47 + 8 * rank : 165 - at;
        w.parts[rank] = (snow_extent){.size = sizeof(snow_extent),
                                      .first = {0, 0, at},
                                      .count = {dims[0], dims[1], count}};
        at += count;
    }
    assert_int_equal(snow_comm_run_threads(context, 3, make_part, &w),
                     SNOW_STATUS_OK);
    snow_transfer_free(expected);
    snow_volume_close(volume);
    free(values);
    snow_context_free(context);
}

static void a_look_that_is_none_fails_on_all_ranks(void **state) {
    (void)state;
    static const uint8_t values[VOXELS];
    static const snow_look look = {.size = sizeof look, .preset = "none"};
    snow_context *context = support_context();
    uint64_t random = 1;
    whole w = {.info = {.size = sizeof(snow_volume_info),
                        .dims = {13, 11, 9},
                        .type = SNOW_TYPE_UINT8},
               .voxels = values,
               .look = &look};
    snow_extent all = {.size = sizeof all, .count = {13, 11, 9}};
    cut(&w, &random, all, 0, 5);
    assert_int_equal(snow_comm_run_threads(context, 5, make_part, &w),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "preset"));
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type_gives_the_same_function_for_any_cut),
        cmocka_unit_test(values_that_are_no_numbers_are_left_out_on_all_ranks),
        cmocka_unit_test(padding_is_counted_where_it_is),
        cmocka_unit_test(a_sample_of_a_large_volume_is_the_same_one),
        cmocka_unit_test(a_look_that_is_none_fails_on_all_ranks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
