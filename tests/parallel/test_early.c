/* tests/parallel/test_early.c - local images that are exchanged while they are
 * drawn: the picture has the bits of one whose local images were there, nothing
 * is read before it is drawn, and parts do travel early. */
#include "support/comm.h"

#include "combine/exchange.h"

#include <math.h>

#define RANKS_MOST 33
#define BAND 3 /* lines that are drawn together */
#define HEIGHT_MOST 70

/* --- local images --------------------------------------------------------- */

/* One rank's, on its way.  Bands are begun in order, and finished as many steps
 * later as `lag`, as by other threads. */
typedef struct sketch {
    int width, height, channels, seed, rank;
    float *pixels; /* NaN where nothing was drawn */
    int bands, first, begun, finished, lag, ended;
} sketch;

static uint32_t chance(const sketch *s, int x, int y, int what) {
    uint64_t n = (uint64_t)s->seed * 7919 + (uint64_t)s->rank * 104729 +
                 (uint64_t)y * 1299709 + (uint64_t)x * 15485863 +
                 (uint64_t)what * 32452843;
    n = (n ^ (n >> 29)) * 0xbf58476d1ce4e5b9u;
    n = (n ^ (n >> 32)) * 0x94d049bb133111ebu;
    return (uint32_t)(n >> 33);
}

/* A disk with holes, whose place differs from rank to rank. */
static bool is_active(const sketch *s, int x, int y) {
    int dx = 2 * x - s->width + s->rank % 5, dy = 2 * y - s->height + s->seed;
    return dx * dx + dy * dy < s->height * s->height &&
           chance(s, x, y, 0) % 3 > 0;
}

/* What is drawn of lines: all but some columns. */
static snow_rectangle frame_of(const sketch *s, int y0, int y1) {
    return (snow_rectangle){s->rank % 3, y0, s->width - s->rank % 2, y1};
}

static void draw_band(sketch *s, int band) {
    const size_t channels = (size_t)s->channels;
    for (int y = band * BAND; y < (band + 1) * BAND && y < s->height; y++) {
        snow_rectangle frame = frame_of(s, y, y + 1);
        for (int x = frame.x0; x < frame.x1; x++)
            for (size_t c = 0; c < channels; c++)
                s->pixels[(size_t)(y * s->width + x) * channels + c] =
                    is_active(s, x, y)
                        ? (float)(chance(s, x, y, 1 + (int)c) % 1000) / 1024
                        : 0;
    }
}

static void finish_bands(sketch *s, int until) {
    for (; s->finished < until; s->finished++)
        draw_band(s, (s->first + s->finished) % s->bands);
}

static bool step(sketch *s) {
    bool any = s->begun < s->bands;
    s->begun += any;
    if (s->begun - s->lag > s->finished)
        finish_bands(s, s->begun - s->lag);
    return any;
}

static bool look(const sketch *s, int y0, int y1, snow_rectangle *drawn) {
    for (int band = y0 / BAND; band * BAND < y1; band++)
        if ((band - s->first + s->bands) % s->bands >= s->finished)
            return false;
    *drawn = frame_of(s, y0, y1);
    return true;
}

static void end(sketch *s) {
    finish_bands(s, s->bands);
    s->begun = s->bands;
    s->ended++;
}

/* The paper is clean again. */
static void begin_sketch(sketch *s, int seed, double at) {
    size_t floats = (size_t)(s->width * s->height * s->channels);
    s->seed = seed;
    s->bands = (s->height + BAND - 1) / BAND;
    s->first = (int)(at * s->bands) % s->bands;
    s->begun = s->finished = s->ended = 0;
    s->lag = seed % 3;
    for (size_t n = 0; n < floats; n++)
        s->pixels[n] = NAN;
}

/* --- exchanges ------------------------------------------------------------ */

typedef struct way {
    snow_combine method;
    int radix;
    snow_image_partition regions;
} way;

static const way ways[] = {
    {SNOW_COMBINE_AUTO, 0, SNOW_IMAGE_PARTITION_AUTO},
    {SNOW_COMBINE_AUTO, 0, SNOW_IMAGE_PARTITION_COUNTED},
    {SNOW_COMBINE_SWAP, 0, SNOW_IMAGE_PARTITION_EVEN},
    {SNOW_COMBINE_SWAP, 0, SNOW_IMAGE_PARTITION_COUNTED},
    {SNOW_COMBINE_DIRECT, 0, SNOW_IMAGE_PARTITION_EVEN},
    {SNOW_COMBINE_DIRECT, 0, SNOW_IMAGE_PARTITION_COUNTED},
    {SNOW_COMBINE_RADIX, 3, SNOW_IMAGE_PARTITION_COUNTED},
    {SNOW_COMBINE_RADIX, 4, SNOW_IMAGE_PARTITION_EVEN},
    {SNOW_COMBINE_TREE, 0, SNOW_IMAGE_PARTITION_EVEN},
};
#define WAYS (int)(sizeof ways / sizeof *ways)

/* All that a rank needs of one series of pictures. */
typedef struct painter {
    snow_comm *comm;
    const way *way;
    snow_combiner *combiner;
    sketch sketch;
    int ranks[RANKS_MOST];
    double begin_at;
} painter;

/* Sends what is finished while the rest is drawn. */
static snow_status exchange_early(snow_combiner *combiner, sketch *s,
                                  const snow_exchange_params *params,
                                  snow_image_region *region) {
    snow_rectangle drawn;
    int y0, y1;
    SNOW_TRY(snow_exchange_begin(combiner, params));
    for (bool any = true; any;) {
        for (int n = 0; snow_exchange_awaits(combiner, n, &y0, &y1);)
            if (look(s, y0, y1, &drawn))
                SNOW_TRY(snow_exchange_send(combiner, n, drawn));
            else
                n++;
        any = step(s);
        if (any)
            snow_exchange_progress(combiner);
    }
    end(s);
    return snow_exchange_end(combiner, frame_of(s, 0, s->height), region);
}

/* A region to rank 0, a run for each of its lines. */
static snow_status gather_lines(snow_combiner *combiner, const sketch *s,
                                const snow_image_region *region,
                                float *picture) {
    snow_pixel_run runs[HEIGHT_MOST + 1];
    size_t count = 0;
    int64_t left = region->count;
    for (int64_t at = region->first; left > 0; count++) {
        int64_t x = at % s->width, some = s->width - x;
        some = some < left ? some : left;
        runs[count] = (snow_pixel_run){(int32_t)x, (int32_t)(at / s->width),
                                       (int32_t)some};
        at += some;
        left -= some;
    }
    return snow_gather(combiner, s->width, s->height, runs, count,
                       region->pixels, (size_t)s->channels * sizeof(float),
                       picture);
}

/* A picture to rank 0's `picture`; how many bytes were sent early. */
static snow_status paint(painter *p, int seed, bool early, float *picture,
                         int64_t *early_bytes) {
    snow_comm *comm = p->comm;
    sketch *s = &p->sketch;
    snow_exchange_params order = {.width = s->width,
                                  .height = s->height,
                                  .channels = s->channels,
                                  .pixels = s->pixels,
                                  .stride = (size_t)(s->width * s->channels),
                                  .drawn = early ? (snow_rectangle){0, 0, 0, 0}
                                                 : frame_of(s, 0, s->height),
                                  .ranks = p->ranks,
                                  .method = p->way->method,
                                  .radix = p->way->radix,
                                  .grain = seed % 2 ? s->width : 1,
                                  .regions = p->way->regions};
    snow_image_region region;
    const int64_t *mine;
    int64_t counts[SNOW_COUNTS_MOST];
    begin_sketch(s, seed, p->begin_at);
    if (!early)
        end(s);
    if (early) {
        order.counts = counts;
        order.count_groups = snow_exchange_counts(p->combiner, &mine);
        memcpy(counts, mine, sizeof counts);
        SNOW_TRY(
            snow_comm_reduce_both(comm, counts, 0, (size_t)order.count_groups));
    }
    SNOW_TRY(early ? exchange_early(p->combiner, s, &order, &region)
                   : snow_exchange(p->combiner, &order, &region));
    CHECK(s->ended == 1 && s->finished == s->bands);
    p->begin_at = snow_exchange_get_figures(p->combiner)->begin_at;
    CHECK(p->begin_at >= 0 && p->begin_at < 1);
    *early_bytes = snow_exchange_get_figures(p->combiner)->early;
    return gather_lines(p->combiner, s, &region, picture);
}

#define PICTURES 4

/* Whether both combiners have cut the picture alike. */
static bool same_pieces(const painter *both) {
    int64_t firsts[2][RANKS_MOST], counts[2][RANKS_MOST];
    size_t bytes = (size_t)both->comm->ranks * sizeof **firsts;
    for (int i = 0; i < 2; i++)
        snow_exchange_regions(both[i].combiner, firsts[i], counts[i]);
    return memcmp(firsts[0], firsts[1], bytes) == 0 &&
           memcmp(counts[0], counts[1], bytes) == 0;
}

/* Each picture both ways, each way by a combiner of its own; the last two are
 * the same, so that what was counted in one is right for the other. */
static snow_status paint_series(painter *both, float *pictures[2],
                                int64_t *early_bytes) {
    snow_comm *comm = both->comm;
    const sketch *s = &both->sketch;
    size_t bytes = (size_t)(s->width * s->height * s->channels) * sizeof(float);
    for (int n = 0; n < PICTURES; n++) {
        int64_t early[2] = {0};
        int seed = n < PICTURES - 1 ? n : n - 1;
        for (int i = 0; i < 2; i++) {
            memset(pictures[i], 0, bytes);
            SNOW_TRY(paint(&both[i], seed, i == 1, pictures[i], &early[i]));
        }
        CHECK(comm->rank || memcmp(pictures[0], pictures[1], bytes) == 0);
        CHECK(early[0] == 0);
        *early_bytes += early[1];
    }
    CHECK(same_pieces(both));
    return SNOW_STATUS_OK;
}

/* Only what cannot be cut into parts of the picture is not early. */
static snow_status check_early(snow_comm *comm, const way *w, int64_t early) {
    bool never = comm->ranks == 1 || w->method == SNOW_COMBINE_TREE;
    SNOW_TRY(snow_comm_reduce_ints(comm, &early, 1, SNOW_REDUCE_SUM));
    CHECK(never ? early == 0 : early > 0);
    return SNOW_STATUS_OK;
}

static snow_status paint_way(snow_comm *comm, int number) {
    painter both[2];
    float *pictures[2];
    int64_t early = 0;
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n < 2; n++) {
        painter *p = &both[n];
        *p = (painter){.comm = comm, .way = &ways[number]};
        p->sketch = (sketch){.width = 37 + number,
                             .height = number % 2 ? HEIGHT_MOST : 41,
                             .channels = comm->ranks % 2 ? 4 : 2,
                             .rank = comm->rank};
        size_t floats = (size_t)(p->sketch.width * p->sketch.height) * 4;
        p->sketch.pixels = malloc(floats * sizeof(float));
        pictures[n] = malloc(floats * sizeof(float));
        for (int i = 0; i < comm->ranks; i++) /* any order */
            p->ranks[i] = number % 2 ? i : comm->ranks - 1 - i;
        if (status == SNOW_STATUS_OK)
            status = snow_combiner_new(comm, &p->combiner);
    }
    if (status == SNOW_STATUS_OK)
        status = paint_series(both, pictures, &early);
    if (status == SNOW_STATUS_OK)
        status = check_early(comm, &ways[number], early);
    for (int n = 0; n < 2; n++) {
        snow_combiner_free(both[n].combiner);
        free(both[n].sketch.pixels);
        free(pictures[n]);
    }
    return status;
}

static snow_status paint_all_ways(snow_comm *comm, void *user) {
    (void)user;
    for (int n = 0; n < WAYS; n++)
        SNOW_TRY(paint_way(comm, n));
    return SNOW_STATUS_OK;
}

static void unfinished_images_give_the_bits_of_finished_ones_for_1_to_33_ranks(
    void **state) {
    (void)state;
    snow_context *context = support_context();
    for (int ranks = 1; ranks <= RANKS_MOST; ranks++)
        if (support_takes_ranks(ranks, RANKS_MOST) &&
            snow_comm_run_threads(context, ranks, paint_all_ways, NULL) !=
                SNOW_STATUS_OK)
            fail_msg("%d ranks: %s", ranks, snow_context_message(context));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* --- what goes wrong ------------------------------------------------------ */

static snow_status begin_badly(snow_comm *comm, void *user) {
    (void)user;
    const int all[] = {0, 1, 2};
    float pixels[10 * 9 * 4] = {0};
    snow_combiner *combiner;
    snow_image_region region;
    snow_status status[3];
    int y0, y1;
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    for (int n = 0; n < 3; n++) {
        const snow_exchange_params order = {.width = n == 0 ? 0 : 10,
                                            .height = 9,
                                            .channels = 4,
                                            .pixels = pixels,
                                            .stride = 40,
                                            .ranks = all,
                                            .grain = n == 1 ? 3 : 1};
        status[n] = snow_exchange_begin(combiner, &order);
        if (n < 2)
            CHECK(!snow_exchange_awaits(combiner, 0, &y0, &y1));
    }
    CHECK(status[0] == SNOW_STATUS_BAD_USAGE &&
          status[1] == SNOW_STATUS_BAD_USAGE && status[2] == SNOW_STATUS_OK);
    snow_status ended =
        snow_exchange_end(combiner, (snow_rectangle){0, 0, 10, 9}, &region);
    snow_combiner_free(combiner);
    return ended;
}

static void an_exchange_that_cannot_begin_awaits_nothing(void **state) {
    (void)state;
    snow_context *context = support_context();
    if (snow_comm_run_threads(context, 3, begin_badly, NULL) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            unfinished_images_give_the_bits_of_finished_ones_for_1_to_33_ranks),
        cmocka_unit_test(an_exchange_that_cannot_begin_awaits_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
