/* test_combine - the exchange and the gather, by every method, for 1 to 33
 * ranks in one process, against all local images laid over one another in
 * double precision; and local images that are exchanged while they are drawn.
 *
 * The bound: an "over" of floats in [0, 1] has three roundings of at most 2^-25
 * each (of 1 - a, the product, the sum), and hands the errors of both colours
 * on no larger, but for that of the front's alpha, which it adds once.  A pixel
 * of n layers is thus off by less than 6 n 2^-25, in any order of laying. */
#include "support/comm.h"
#include "support/failing.h"

#include "combine/combiner.h"
#include "combine/rounds.h"

#include <math.h>

#define RANKS_MOST 33
#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

static double bound(int layers) {
    return 6.0 * layers / (1 << 25);
}

/* --- local images --------------------------------------------------------- */

typedef struct job {
    int width, height, channels, seed;
    int ranks[RANKS_MOST]; /* from front to back */
    int count;
} job;

static uint64_t mix(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

static uint64_t draw(const job *j, int rank, int x, int y, int what) {
    return mix(
        mix(mix(mix((uint64_t)j->seed * 977 + (uint64_t)rank) + (uint64_t)y) +
            (uint64_t)x) +
        (uint64_t)what);
}

/* What a rank has drawn into: one in six nothing, one in six all. */
static snow_rectangle drawn_by(const job *j, int rank) {
    int w = j->width, h = j->height;
    uint64_t kind = draw(j, rank, -1, -1, 0) % 6;
    if (kind == 0)
        return (snow_rectangle){0, 0, 0, 0};
    if (kind == 1)
        return (snow_rectangle){0, 0, w, h};
    int x0 = (int)(draw(j, rank, -1, -1, 1) % (uint64_t)w);
    int y0 = (int)(draw(j, rank, -1, -1, 2) % (uint64_t)h);
    int x1 = x0 + 1 + (int)(draw(j, rank, -1, -1, 3) % (uint64_t)(w - x0));
    int y1 = y0 + 1 + (int)(draw(j, rank, -1, -1, 4) % (uint64_t)(h - y0));
    return (snow_rectangle){x0, y0, x1, y1};
}

/* A pixel of a local image: half of the ranks have speckles, half have runs,
 * and one that has drawn all leaves next to nothing out, so that its messages
 * are as long as can be; some pixels are opaque, some glow without hiding
 * anything. */
static void pixel_of(const job *j, int rank, int x, int y, float *out) {
    const snow_rectangle d = drawn_by(j, rank);
    const int last = j->channels - 1;
    const bool all = d.x1 - d.x0 == j->width && d.y1 - d.y0 == j->height;
    memset(out, 0, (size_t)j->channels * sizeof *out);
    if (x < d.x0 || x >= d.x1 || y < d.y0 || y >= d.y1 ||
        (!all && draw(j, rank, rank % 2 ? x / 9 : x, y, 5) % 10 > 3))
        return;
    uint64_t kind = draw(j, rank, x, y, 6) % 16;
    float alpha = (float)(draw(j, rank, x, y, 7) % 1000) / 1000;
    out[last] = kind == 0 ? 1 : kind == 1 ? 0 : alpha;
    for (int c = 0; c < last; c++)
        out[c] = (kind == 1 ? 0.01f : out[last]) *
                 (float)(draw(j, rank, x, y, 8 + c) % 256) / 255;
}

/* What is not drawn must not be read. */
static void clear_local(const job *j, float *pixels, size_t stride) {
    for (size_t n = 0; n < stride * (size_t)j->height; n++)
        pixels[n] = NAN;
}

/* What a rank has drawn into lines y0 .. y1 - 1. */
static snow_rectangle drawn_lines(const job *j, int rank, int y0, int y1) {
    snow_rectangle d = drawn_by(j, rank);
    d.y0 = d.y0 > y0 ? d.y0 : y0;
    d.y1 = d.y1 < y1 ? d.y1 : y1;
    return d.y0 < d.y1 ? d : (snow_rectangle){0, 0, 0, 0};
}

static void draw_lines(const job *j, int rank, int y0, int y1, float *pixels,
                       size_t stride) {
    const snow_rectangle d = drawn_lines(j, rank, y0, y1);
    for (int y = d.y0; y < d.y1; y++)
        for (int x = d.x0; x < d.x1; x++)
            pixel_of(j, rank, x, y,
                     pixels + (size_t)y * stride + x * j->channels);
}

/* The local image, to be freed. */
static float *local_image(const job *j, int rank, size_t stride) {
    float *pixels = malloc(stride * (size_t)j->height * sizeof *pixels);
    clear_local(j, pixels, stride);
    draw_lines(j, rank, 0, j->height, pixels, stride);
    return pixels;
}

/* All local images, one over the other. */
static void expect(const job *j, int x, int y, double *out) {
    const int last = j->channels - 1;
    for (int c = 0; c <= last; c++)
        out[c] = 0;
    for (int i = 0; i < j->count; i++) {
        float back[4];
        pixel_of(j, j->ranks[i], x, y, back);
        double left = 1 - out[last];
        for (int c = 0; c <= last; c++)
            out[c] += left * (double)back[c];
    }
}

/* A job of four channels with a shuffled order of ranks. */
static job job_of(const snow_comm *comm, int width, int height, int seed) {
    job j = {.width = width,
             .height = height,
             .channels = 4,
             .seed = seed,
             .count = comm->ranks};
    for (int i = 0; i < j.count; i++)
        j.ranks[i] = i;
    for (int i = j.count - 1; i > 0; i--) {
        int k = (int)(draw(&j, i, 0, 0, 99) % (uint64_t)(i + 1));
        int swapped = j.ranks[i];
        j.ranks[i] = j.ranks[k];
        j.ranks[k] = swapped;
    }
    return j;
}

/* --- one exchange --------------------------------------------------------- */

typedef struct way {
    snow_combine method;
    int radix;
} way;

static const way ways[] = {
    {SNOW_COMBINE_AUTO, 0},   {SNOW_COMBINE_TREE, 0},  {SNOW_COMBINE_SWAP, 0},
    {SNOW_COMBINE_DIRECT, 0}, {SNOW_COMBINE_RADIX, 3}, {SNOW_COMBINE_RADIX, 4},
    {SNOW_COMBINE_RADIX, 8},
};

static snow_exchange_params order_of(const job *j, int rank, const way *w,
                                     const float *pixels, size_t stride) {
    return (snow_exchange_params){.width = j->width,
                                  .height = j->height,
                                  .channels = j->channels,
                                  .pixels = pixels,
                                  .stride = stride,
                                  .drawn = drawn_by(j, rank),
                                  .ranks = j->ranks,
                                  .method = w->method,
                                  .radix = w->radix,
                                  .grain = 1};
}

/* The pixel numbers of pieces: together all, each once, and this rank's. */
static snow_status check_pieces(snow_comm *comm, const snow_combiner *combiner,
                                const job *j, int grain,
                                const snow_image_region *mine) {
    int64_t firsts[RANKS_MOST], counts[RANKS_MOST];
    int64_t sum = 0, pixels = (int64_t)j->width * j->height;
    snow_exchange_regions(combiner, firsts, counts);
    for (int i = 0; i < j->count; i++) {
        CHECK(counts[i] >= 0 && counts[i] % grain == 0);
        CHECK(counts[i] == 0 || firsts[i] % grain == 0);
        CHECK(firsts[i] >= 0 && firsts[i] + counts[i] <= pixels);
        sum += counts[i];
        for (int k = 0; k < i; k++)
            CHECK(!counts[i] || !counts[k] ||
                  firsts[i] >= firsts[k] + counts[k] ||
                  firsts[k] >= firsts[i] + counts[i]);
    }
    CHECK(sum == pixels);
    CHECK(firsts[comm->rank] == mine->first || !mine->count);
    CHECK(counts[comm->rank] == mine->count);
    return SNOW_STATUS_OK;
}

static snow_status check_piece(snow_comm *comm, const job *j,
                               const snow_image_region *region) {
    for (int64_t i = 0; i < region->count; i++) {
        int64_t at = region->first + i;
        int x = (int)(at % j->width);
        int y = (int)(at / j->width);
        double want[4];
        expect(j, x, y, want);
        for (int c = 0; c < j->channels; c++) {
            double is = (double)region->pixels[i * j->channels + c];
            if (!(fabs(is - want[c]) <= bound(j->count)))
                return snow_fail(comm->context, SNOW_STATUS_FAILED,
                                 "pixel %d %d of %d ranks: %.9g, not %.9g", x,
                                 y, j->count, is, want[c]);
        }
    }
    return SNOW_STATUS_OK;
}

/* The piece's lines as runs, without pixels that are nothing. */
static size_t runs_of(const job *j, const snow_image_region *region,
                      snow_pixel_run *runs, float *packed) {
    size_t count = 0;
    int64_t last = -2;
    for (int64_t i = 0; i < region->count; i++) {
        const float *pixel = region->pixels + i * j->channels;
        bool any = false;
        for (int c = 0; c < j->channels; c++)
            any = any || pixel[c] != 0;
        if (!any)
            continue;
        int64_t at = region->first + i;
        int x = (int)(at % j->width);
        if (last != at - 1 || x == 0)
            runs[count++] = (snow_pixel_run){x, (int)(at / j->width), 0};
        runs[count - 1].count++;
        last = at;
        memcpy(packed, pixel, (size_t)j->channels * sizeof *pixel);
        packed += j->channels;
    }
    return count;
}

/* The picture on rank 0, to be freed; NULL elsewhere. */
static snow_status gather_pieces(snow_comm *comm, snow_combiner *combiner,
                                 const job *j, const snow_image_region *region,
                                 float **picture) {
    const size_t bytes = (size_t)j->channels * sizeof(float);
    snow_pixel_run *runs = calloc((size_t)region->count + 1, sizeof *runs);
    float *packed = calloc((size_t)region->count + 1, bytes);
    size_t count = runs_of(j, region, runs, packed);
    int64_t some = 0;
    *picture = comm->rank == 0
                   ? calloc((size_t)j->width * (size_t)j->height, bytes)
                   : NULL;
    for (size_t i = 0; i < count; i++)
        some += runs[i].count;
    snow_status status = snow_comm_agree_status(
        comm,
        snow_gather_reserve(combiner, j->width, j->height, count, some, bytes));
    if (status == SNOW_STATUS_OK)
        status = snow_gather(combiner, j->width, j->height, runs, count, packed,
                             bytes, *picture);
    free(runs);
    free(packed);
    return status;
}

static snow_status check_gather(snow_comm *comm, snow_combiner *combiner,
                                const job *j, const snow_image_region *region) {
    float *picture;
    snow_status status = gather_pieces(comm, combiner, j, region, &picture);
    const snow_image_region all = {0, (int64_t)j->width * j->height, picture,
                                   NULL};
    if (status == SNOW_STATUS_OK && picture)
        status = check_piece(comm, j, &all);
    free(picture);
    return status;
}

/* --- all methods ---------------------------------------------------------- */

static const int sizes[][2] = {{1, 1}, {5, 3}, {61, 7}, {64, 16}, {37, 41}};

static snow_status combine_once(snow_comm *comm, snow_combiner *combiner,
                                const job *j, const way *w, int grain,
                                snow_image_partition regions) {
    const size_t stride = (size_t)(j->width * j->channels) + 3;
    float *pixels = local_image(j, comm->rank, stride);
    snow_exchange_params order = order_of(j, comm->rank, w, pixels, stride);
    order.grain = grain;
    order.regions = regions;
    snow_image_region region;
    snow_status status = snow_exchange(combiner, &order, &region);
    free(pixels);
    SNOW_TRY(status);
    SNOW_TRY(check_pieces(comm, combiner, j, grain, &region));
    SNOW_TRY(check_piece(comm, j, &region));
    snow_gather_radix(combiner, (int)(draw(j, 0, 0, 0, 1) % 6));
    return check_gather(comm, combiner, j, &region);
}

/* Threads as if they were on nodes: one, each alone, two each, of unequal
 * numbers, and of ranks that do not follow one another. */
static int in_pairs(void *self, int rank) {
    (void)self;
    return rank / 2;
}

static int alone(void *self, int rank) {
    (void)self;
    return rank;
}

static int first_alone(void *self, int rank) {
    (void)self;
    return (rank + 2) / 3;
}

static int by_turns(void *self, int rank) {
    (void)self;
    return rank % 2;
}

typedef int node_of_fn(void *self, int rank);
static node_of_fn *const nodes[] = {NULL, in_pairs, alone, first_alone,
                                    by_turns};

/* Every way, with sizes, channels, grains, pieces and nodes taken in turns. */
static snow_status combine_all_ways(snow_comm *comm, void *user) {
    snow_combiner *combiner;
    int turn = *(int *)user + comm->ranks;
    snow_status status = SNOW_STATUS_OK;
    node_of_fn *on_one = comm->ops.node_of;
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    for (size_t i = 0; i < COUNT_OF(ways) && status == SNOW_STATUS_OK; i++) {
        node_of_fn *several = nodes[(i + (size_t)turn) % COUNT_OF(nodes)];
        const uint64_t lent = comm->bytes_shared;
        comm->ops.node_of = several ? several : on_one;
        for (size_t k = 0; k < COUNT_OF(sizes) && status == SNOW_STATUS_OK;
             k++) {
            turn++;
            job j = job_of(comm, sizes[k][0], sizes[k][1], turn);
            j.channels = turn % 2 ? 2 : 4;
            status = combine_once(comm, combiner, &j, &ways[i],
                                  turn % 3 ? 1 : j.width,
                                  (snow_image_partition)(turn / 2 % 3));
            status = snow_comm_agree_status(comm, status);
        }
        int64_t all = (int64_t)(comm->bytes_shared - lent);
        if (status == SNOW_STATUS_OK)
            status = snow_comm_reduce_ints(comm, &all, 1, SNOW_REDUCE_SUM);
        CHECK(status != SNOW_STATUS_OK || several != alone || all == 0);
        CHECK(status != SNOW_STATUS_OK || several || comm->ranks == 1 || all);
    }
    snow_combiner_free(combiner);
    return status;
}

/* --- memory of nodes ------------------------------------------------------ */

/* Of this thread's rank: its number, and how its memory is made. */
static _Thread_local int this_rank;
static _Thread_local snow_status (*share_of_threads)(void *, size_t, void **);

/* The node of ranks 0 and 1 has no memory that they share. */
static snow_status share_elsewhere(void *self, size_t bytes, void **own) {
    snow_status status = share_of_threads(self, bytes, own);
    if (this_rank < 2)
        *own = NULL;
    return status;
}

static snow_status combine_size(snow_comm *comm, snow_combiner *combiner,
                                int width, int height) {
    const way w = {SNOW_COMBINE_DIRECT, 0};
    const job j = job_of(comm, width, height, width);
    return snow_comm_agree_status(
        comm,
        combine_once(comm, combiner, &j, &w, 1, SNOW_IMAGE_PARTITION_EVEN));
}

static snow_status shared_by_all(snow_comm *comm, int64_t *out) {
    *out = (int64_t)comm->bytes_shared;
    return snow_comm_reduce_ints(comm, out, 1, SNOW_REDUCE_SUM);
}

/* Larger and smaller pictures; a second combiner, which one rank makes after
 * it has freed the first one, and others before. */
static snow_status combine_on_nodes(snow_comm *comm, void *user) {
    snow_combiner *first, *second;
    (void)user;
    this_rank = comm->rank;
    share_of_threads = comm->ops.share;
    comm->ops.share = share_elsewhere;
    comm->ops.node_of = in_pairs;
    SNOW_TRY(snow_combiner_new(comm, &first));
    SNOW_TRY(combine_size(comm, first, 64, 16));
    SNOW_TRY(combine_size(comm, first, 128, 90));
    SNOW_TRY(combine_size(comm, first, 61, 7));
    int64_t lent, again;
    SNOW_TRY(shared_by_all(comm, &lent));
    CHECK(lent > 0);
    SNOW_TRY(snow_combiner_new(comm, &second));
    if (comm->rank == 1)
        snow_combiner_free(first);
    SNOW_TRY(combine_size(comm, second, 200, 150));
    SNOW_TRY(shared_by_all(comm, &again));
    CHECK(again == lent);
    if (comm->rank != 1)
        snow_combiner_free(first);
    SNOW_TRY(combine_size(comm, second, 256, 200));
    SNOW_TRY(combine_size(comm, second, 64, 16));
    SNOW_TRY(shared_by_all(comm, &again));
    CHECK(again > lent && (comm->rank > 1 || comm->bytes_shared == 0));
    snow_combiner_free(second);
    return SNOW_STATUS_OK;
}

static void run_body(int ranks, snow_comm_body_fn *body, void *user) {
    snow_context *context = support_context();
    snow_status status = snow_comm_run_threads(context, ranks, body, user);
    if (status != SNOW_STATUS_OK)
        print_message("%d ranks: %s\n", ranks, snow_context_message(context));
    assert_int_equal(status, SNOW_STATUS_OK);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* For numbers of ranks up to the most. */
static void run_all(snow_comm_body_fn *body, void *user) {
    for (int ranks = 1; ranks <= RANKS_MOST; ranks++)
        if (support_takes_ranks(ranks, RANKS_MOST))
            run_body(ranks, body, user);
}

static void
every_method_gives_the_picture_of_a_chain_for_1_to_33_ranks(void **state) {
    (void)state;
    for (int turn = 0; turn <= 1000; turn += 1000)
        run_all(combine_all_ways, &turn);
}

static void nodes_with_memory_and_without_work_together(void **state) {
    (void)state;
    run_body(4, combine_on_nodes, NULL);
    run_body(7, combine_on_nodes, NULL);
}

/* --- images that are still drawn ------------------------------------------ */

#define BAND 3 /* lines that are drawn together */

/* Bands of lines are begun in order, and finished as many steps later as `lag`,
 * as by other threads. */
typedef struct sketch {
    const job *j;
    int rank;
    float *pixels;
    size_t stride;
    int bands, first, begun, finished, lag;
} sketch;

static void finish_bands(sketch *s, int until) {
    for (; s->finished < until; s->finished++) {
        const int y = (s->first + s->finished) % s->bands * BAND;
        draw_lines(s->j, s->rank, y, y + BAND, s->pixels, s->stride);
    }
}

static bool step(sketch *s) {
    bool any = s->begun < s->bands;
    s->begun += any;
    if (s->begun - s->lag > s->finished)
        finish_bands(s, s->begun - s->lag);
    return any;
}

static bool is_finished(const sketch *s, int y0, int y1) {
    for (int band = y0 / BAND; band * BAND < y1; band++)
        if ((band - s->first + s->bands) % s->bands >= s->finished)
            return false;
    return true;
}

/* Sends what is finished while the rest is drawn. */
static snow_status exchange_early(snow_combiner *combiner, sketch *s,
                                  const snow_exchange_params *order,
                                  snow_image_region *region) {
    int y0, y1;
    SNOW_TRY(snow_exchange_begin(combiner, order));
    for (bool any = true; any;) {
        for (int n = 0; snow_exchange_awaits(combiner, n, &y0, &y1);)
            if (is_finished(s, y0, y1))
                SNOW_TRY(snow_exchange_send(
                    combiner, n, drawn_lines(s->j, s->rank, y0, y1)));
            else
                n++;
        any = step(s);
        if (any)
            snow_exchange_progress(combiner);
    }
    finish_bands(s, s->bands);
    return snow_exchange_end(combiner, drawn_by(s->j, s->rank), region);
}

/* Whether both combiners have cut the picture alike. */
static bool same_pieces(const snow_comm *comm, snow_combiner *const both[2]) {
    int64_t firsts[2][RANKS_MOST], counts[2][RANKS_MOST];
    const size_t bytes = (size_t)comm->ranks * sizeof **firsts;
    for (int i = 0; i < 2; i++)
        snow_exchange_regions(both[i], firsts[i], counts[i]);
    return memcmp(firsts[0], firsts[1], bytes) == 0 &&
           memcmp(counts[0], counts[1], bytes) == 0;
}

/* The same picture by the second combiner, with what it has counted before. */
static snow_status draw_early(snow_comm *comm, snow_combiner *combiner,
                              snow_exchange_params order, sketch *s,
                              const float *wanted) {
    const int64_t *mine;
    int64_t counts[SNOW_COUNTS_MOST];
    snow_image_region region;
    float *picture;
    const double begin_at = snow_exchange_get_figures(combiner)->begin_at;
    CHECK(begin_at >= 0 && begin_at < 1);
    s->bands = (s->j->height + BAND - 1) / BAND;
    s->first = (int)(begin_at * s->bands) % s->bands;
    s->begun = s->finished = 0;
    clear_local(s->j, s->pixels, s->stride);
    order.counts = counts;
    order.count_groups = snow_exchange_counts(combiner, &mine);
    memcpy(counts, mine, (size_t)order.count_groups * sizeof *counts);
    SNOW_TRY(
        snow_comm_reduce_both(comm, counts, 0, (size_t)order.count_groups));
    SNOW_TRY(exchange_early(combiner, s, &order, &region));
    CHECK(s->finished == s->bands);
    SNOW_TRY(gather_pieces(comm, combiner, s->j, &region, &picture));
    const size_t bytes = (size_t)(order.width * order.height) *
                         (size_t)order.channels * sizeof(float);
    const bool same = !picture || memcmp(picture, wanted, bytes) == 0;
    free(picture);
    CHECK(same);
    return SNOW_STATUS_OK;
}

/* Each picture at once, and twice while it is drawn, so that what was counted
 * in the one is right for the other. */
static snow_status draw_both_ways(snow_comm *comm, snow_combiner *const both[2],
                                  const job *j, const way *w, int turn,
                                  int64_t *early) {
    const size_t stride = (size_t)(j->width * j->channels);
    sketch s = {j, comm->rank, local_image(j, comm->rank, stride), stride,
                .lag = turn % 3};
    snow_exchange_params order = order_of(j, comm->rank, w, s.pixels, stride);
    order.grain = turn % 2 ? j->width : 1;
    order.regions = (snow_image_partition)(turn % 3);
    snow_image_region region;
    float *wanted = NULL;
    snow_status status = snow_exchange(both[0], &order, &region);
    if (status == SNOW_STATUS_OK)
        status = gather_pieces(comm, both[0], j, &region, &wanted);
    for (int again = 0; again < 2 && status == SNOW_STATUS_OK; again++)
        status = draw_early(comm, both[1], order, &s, wanted);
    free(s.pixels);
    free(wanted);
    SNOW_TRY(status);
    CHECK(snow_exchange_get_figures(both[0])->early == 0);
    CHECK(same_pieces(comm, both));
    /* A tree cannot cut the picture into parts. */
    CHECK(w->method != SNOW_COMBINE_TREE ||
          snow_exchange_get_figures(both[1])->early == 0);
    *early += snow_exchange_get_figures(both[1])->early;
    return SNOW_STATUS_OK;
}

static snow_status draw_all_ways(snow_comm *comm, void *user) {
    snow_combiner *both[2] = {NULL, NULL};
    snow_status status = snow_combiner_new(comm, &both[0]);
    int64_t early = 0;
    (void)user;
    if (status == SNOW_STATUS_OK)
        status = snow_combiner_new(comm, &both[1]);
    for (size_t i = 0; i < COUNT_OF(ways) && status == SNOW_STATUS_OK; i++) {
        const int turn = (int)i + comm->ranks;
        job j = job_of(comm, 37 + (int)i, turn % 2 ? 70 : 41, turn);
        j.channels = turn % 4 < 2 ? 4 : 2;
        status = draw_both_ways(comm, both, &j, &ways[i], turn, &early);
    }
    if (status == SNOW_STATUS_OK)
        status = snow_comm_reduce_ints(comm, &early, 1, SNOW_REDUCE_SUM);
    snow_combiner_free(both[0]);
    snow_combiner_free(both[1]);
    CHECK(status != SNOW_STATUS_OK || (comm->ranks > 1) == (early > 0));
    return status;
}

static void images_that_are_still_drawn_give_the_same_bits(void **state) {
    (void)state;
    run_all(draw_all_ways, NULL);
}

/* --- threads -------------------------------------------------------------- */

/* The piece by several threads, copied. */
static snow_status exchange_by(snow_combiner *combiner,
                               snow_exchange_params *order, int threads,
                               snow_image_region *region, float **kept) {
    order->threads = threads;
    SNOW_TRY(snow_exchange(combiner, order, region));
    const size_t bytes =
        (size_t)region->count * (size_t)order->channels * sizeof **kept;
    *kept = malloc(bytes + 1);
    if (bytes)
        memcpy(*kept, region->pixels, bytes);
    return SNOW_STATUS_OK;
}

static snow_status combine_by_threads(snow_comm *comm, const way *w) {
    const job j = job_of(comm, 301, 240, 0);
    snow_combiner *combiner;
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    float *pixels = local_image(&j, comm->rank, 301 * 4);
    float *alone = NULL, *shared = NULL;
    snow_exchange_params order = order_of(&j, comm->rank, w, pixels, 301 * 4);
    snow_image_region region;
    snow_status status = exchange_by(combiner, &order, 1, &region, &alone);
    const snow_exchange_figures by_one = *snow_exchange_get_figures(combiner);
    if (status == SNOW_STATUS_OK)
        /* ranks may have different numbers */
        status =
            exchange_by(combiner, &order, 4 + comm->rank, &region, &shared);
    if (status == SNOW_STATUS_OK)
        status = check_piece(comm, &j, &region);
    const snow_exchange_figures *figures = snow_exchange_get_figures(combiner);
    bool same = status == SNOW_STATUS_OK &&
                memcmp(alone, shared, (size_t)region.count * 16) == 0 &&
                figures->laid == by_one.laid &&
                figures->scanned == by_one.scanned &&
                figures->active == by_one.active;
    free(pixels);
    free(alone);
    free(shared);
    snow_combiner_free(combiner);
    SNOW_TRY(status);
    CHECK(same);
    return SNOW_STATUS_OK;
}

static snow_status combine_all_ways_by_threads(snow_comm *comm, void *user) {
    (void)user;
    for (size_t i = 0; i < COUNT_OF(ways); i++)
        SNOW_TRY(combine_by_threads(comm, &ways[i]));
    return SNOW_STATUS_OK;
}

static void threads_of_ranks_change_no_bit(void **state) {
    (void)state;
    static const int counts[] = {1, 2, 5, 8};
    for (size_t i = 0; i < COUNT_OF(counts); i++)
        run_body(counts[i], combine_all_ways_by_threads, NULL);
}

/* --- what it costs -------------------------------------------------------- */

/* From now on there is no memory, or there is again. */
static void refuse_all(support_failing *memory, bool refuses) {
    memory->failing = refuses ? memory->allocations : -1;
    memory->for_good = refuses;
}

/* Runs a body's work with the communicator's memory taken from an allocator:
 * only what is made meanwhile is, not the transport's own. */
static snow_status with_memory(snow_comm *comm,
                               snow_status (*work)(snow_comm *,
                                                   support_failing *)) {
    support_failing memory = {.failing = -1};
    const snow_allocator allocator = support_failing_allocator(&memory);
    snow_context *usual = comm->context, *own;
    SNOW_TRY(snow_context_new(&allocator, &own));
    comm->context = own;
    snow_status status = work(comm, &memory);
    comm->context = usual;
    if (status != SNOW_STATUS_OK)
        status = snow_fail(usual, status, "%s", snow_context_message(own));
    snow_context_free(own);
    return status;
}

#define VIEWS 3

/* One of several views; views are seen twice.  Memory is for the first picture
 * of all, for counted pieces and for packed pixels of views not seen before. */
static snow_status combine_view(snow_comm *comm, snow_combiner *combiner,
                                const way *w, snow_image_partition regions,
                                int turn, support_failing *memory) {
    const job j = job_of(comm, 61, 33, turn % VIEWS);
    snow_gather_radix(combiner, 3);
    float *pixels = local_image(&j, comm->rank, 61 * 4);
    snow_exchange_params order = order_of(&j, comm->rank, w, pixels, 61 * 4);
    order.regions = regions;
    snow_image_region region;
    refuse_all(memory,
               turn >
                   (regions == SNOW_IMAGE_PARTITION_COUNTED ? VIEWS - 1 : 0));
    snow_status status = snow_exchange(combiner, &order, &region);
    free(pixels);
    refuse_all(memory, turn >= VIEWS);
    if (status == SNOW_STATUS_OK)
        status = check_piece(comm, &j, &region);
    if (status == SNOW_STATUS_OK)
        status = check_gather(comm, combiner, &j, &region);
    return status;
}

static snow_status combine_twice(snow_comm *comm, support_failing *memory) {
    static const snow_image_partition cuts[] = {SNOW_IMAGE_PARTITION_EVEN,
                                                SNOW_IMAGE_PARTITION_COUNTED};
    snow_combiner *combiner;
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    snow_status status = SNOW_STATUS_OK;
    for (size_t i = 0; i < 2 * COUNT_OF(ways) && status == SNOW_STATUS_OK; i++)
        for (int turn = 0; turn < 2 * VIEWS && status == SNOW_STATUS_OK; turn++)
            status = combine_view(comm, combiner, &ways[i / 2], cuts[i % 2],
                                  turn, memory);
    snow_combiner_free(combiner);
    return status;
}

static snow_status combine_twice_with_memory_once(snow_comm *comm, void *user) {
    (void)user;
    return with_memory(comm, combine_twice);
}

static void
pictures_that_need_no_more_than_others_take_no_memory(void **state) {
    (void)state;
    run_body(1, combine_twice_with_memory_once, NULL);
    run_body(7, combine_twice_with_memory_once, NULL);
    run_body(16, combine_twice_with_memory_once, NULL);
}

/* --- pieces --------------------------------------------------------------- */

/* All that is active lies in some lines: how many pixels of layers the busiest
 * rank gets, against the mean. */
static snow_status lay_band(snow_comm *comm, void *user) {
    const way w = {SNOW_COMBINE_DIRECT, 0};
    const job j = job_of(comm, 128, 256, 0);
    float *pixels = calloc(128 * 256 * 4, sizeof *pixels);
    for (int n = 80 * 128 * 4; n < 120 * 128 * 4; n++)
        pixels[n] = 0.25f;
    snow_combiner *combiner;
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    snow_exchange_params order = order_of(&j, comm->rank, &w, pixels, 128 * 4);
    order.drawn = (snow_rectangle){0, 0, 128, 256};
    order.regions = *(snow_image_partition *)user;
    snow_image_region region;
    snow_status status = snow_exchange(combiner, &order, &region);
    int64_t laid[2] = {snow_exchange_get_figures(combiner)->laid, 0};
    free(pixels);
    snow_combiner_free(combiner);
    SNOW_TRY(status);
    laid[1] = laid[0];
    SNOW_TRY(snow_comm_reduce_ints(comm, laid, 1, SNOW_REDUCE_SUM));
    SNOW_TRY(snow_comm_reduce_ints(comm, laid + 1, 1, SNOW_REDUCE_MAX));
    double ratio = (double)laid[1] * comm->ranks / (double)laid[0];
    CHECK(order.regions == SNOW_IMAGE_PARTITION_EVEN ? ratio > 5
                                                     : ratio < 1.45);
    return SNOW_STATUS_OK;
}

static void counted_pieces_are_balanced(void **state) {
    snow_image_partition regions[] = {SNOW_IMAGE_PARTITION_EVEN,
                                      SNOW_IMAGE_PARTITION_COUNTED};
    (void)state;
    for (int i = 0; i < 2; i++)
        run_body(16, lay_band, &regions[i]);
}

/* --- plans of many ranks -------------------------------------------------- */

/* How many messages go from seat to seat in each round, counted at both ends,
 * as a sum that tells who, whom and when. */
static void check_plan(snow_combine method, int radix, int rank_count) {
    snow_rounds rounds;
    snow_rounds_choose(&rounds, method, radix, rank_count, 1, 1 << 20, 16);
    assert_true(rounds.count <= SNOW_ROUNDS_MOST);
    size_t room = snow_rounds_capacity(&rounds);
    rounds.shares = calloc(room + 1, sizeof *rounds.shares);
    int *table = calloc((size_t)rank_count, sizeof *table);
    int *owners = calloc((size_t)rank_count, sizeof *owners);
    uint64_t sent = 0, received = 0;
    for (int rank_position = 0; rank_position < rank_count; rank_position++) {
        snow_rounds_fill(&rounds, rank_position, rank_count / 3, table);
        assert_true((size_t)rounds.share_count <= room);
        for (int i = 0; i < rounds.count; i++) {
            const snow_round *round = &rounds.rounds[i];
            const snow_share *share = rounds.shares + round->first_send;
            for (int k = 0; k < round->sends; k++)
                sent += mix(mix(mix((uint64_t)i) + (uint64_t)rank_position) +
                            (uint64_t)share[k].rank_position);
            share = rounds.shares + round->first_receive;
            for (int k = 0; k < round->receives; k++)
                received += mix(
                    mix(mix((uint64_t)i) + (uint64_t)share[k].rank_position) +
                    (uint64_t)rank_position);
        }
        int last = snow_rounds_last(&rounds, rank_position);
        if (last >= 0)
            owners[last]++;
    }
    assert_true(sent == received);
    for (int i = 0; i < (method == SNOW_COMBINE_TREE ? 1 : rank_count); i++)
        assert_int_equal(owners[i], 1);
    free(rounds.shares);
    free(table);
    free(owners);
}

/* With `node` ranks on each of `count` nodes: some rounds combine whole nodes,
 * before others do more. */
static void check_nodes(int node, int count) {
    snow_rounds rounds;
    snow_rounds_choose(&rounds, SNOW_COMBINE_RADIX, 0, node * count, node,
                       1 << 20, 16);
    int subsets = 1, level = 0;
    while (subsets < node && level < rounds.count)
        subsets *= rounds.radices[level++];
    if (count > 1)
        assert_int_equal(subsets, node);
    for (; level < rounds.count; level++)
        subsets *= rounds.radices[level];
    assert_true(subsets >= node * count);
}

static void the_first_rounds_combine_the_ranks_of_nodes(void **state) {
    static const int sizes_of_nodes[] = {1, 2, 3, 5, 12, 31, 48, 67, 128};
    (void)state;
    for (size_t i = 0; i < COUNT_OF(sizes_of_nodes); i++)
        for (int count = 1; count <= 20; count += 1 + count / 3)
            check_nodes(sizes_of_nodes[i], count);
}

static void what_is_sent_is_waited_for_with_any_number_of_ranks(void **state) {
    static const int many[] = {128, 257, 360};
    (void)state;
    for (size_t i = 0; i < COUNT_OF(ways); i++) {
        for (int ranks = 1; ranks <= 70; ranks++)
            if (support_takes((size_t)ranks + i, 5))
                check_plan(ways[i].method, ways[i].radix, ranks);
        for (size_t k = 0; k < COUNT_OF(many); k++)
            check_plan(ways[i].method, ways[i].radix, many[k]);
    }
}

/* --- failures ------------------------------------------------------------- */

/* Nor does one begin that awaits something. */
static snow_status combine_bad_orders(snow_comm *comm, void *user) {
    const job j = job_of(comm, 6, 4, 0);
    (void)user;
    snow_combiner *combiner;
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    snow_image_region region = {.first = 7};
    snow_exchange_params good = order_of(&j, comm->rank, ways, NULL, 0), bad[6];
    good.drawn = (snow_rectangle){-5, -5, -1, 90};
    for (int i = 0; i < 6; i++)
        bad[i] = good;
    bad[0].width = 0;
    bad[1].channels = 3;
    bad[2].grain = 4;
    bad[3].radix = 1;
    bad[4].height = -1;
    const int outsiders[] = {8, 9, 10};
    bad[5].ranks = outsiders;
    snow_status status = SNOW_STATUS_OK;
    int y0, y1;
    for (int i = 0; i < 6; i++)
        if (snow_exchange(combiner, &bad[i], &region) !=
                SNOW_STATUS_BAD_USAGE ||
            region.first != 7 ||
            snow_exchange_begin(combiner, &bad[i]) != SNOW_STATUS_BAD_USAGE ||
            snow_exchange_awaits(combiner, 0, &y0, &y1))
            status =
                snow_fail(comm->context, SNOW_STATUS_FAILED, "order %d", i);
    if (status == SNOW_STATUS_OK)
        status = snow_exchange(combiner, &good, &region);
    snow_combiner_free(combiner);
    return status;
}

static void what_is_no_order_is_refused(void **state) {
    (void)state;
    run_body(3, combine_bad_orders, NULL);
}

static snow_status gather_bad_runs(snow_comm *comm, void *user) {
    snow_combiner *combiner;
    unsigned char picture[8 * 4] = {0}, pixels[64] = {0};
    const snow_pixel_run wrong = {6, 1, 3}, right = {0, comm->rank, 8};
    (void)user;
    memset(pixels, comm->rank + 1, sizeof pixels);
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    snow_status status =
        snow_gather(combiner, 8, 4, comm->rank == 2 ? &wrong : &right, 1,
                    pixels, 1, picture);
    snow_combiner_free(combiner);
    CHECK(status == (comm->rank == 2 ? SNOW_STATUS_BAD_USAGE : SNOW_STATUS_OK));
    for (int i = 0; i < 8 && comm->rank == 0; i++) {
        CHECK(picture[i] == 1 && picture[8 + i] == 2);
        CHECK(picture[16 + i] == 0 && picture[24 + i] == 4);
    }
    return SNOW_STATUS_OK;
}

static void wrong_runs_of_one_rank_fail_there_and_nobody_waits(void **state) {
    (void)state;
    run_body(4, gather_bad_runs, NULL);
}

/* One rank is refused one block after another. */
static snow_status combine_with_gaps(snow_comm *comm, support_failing *memory) {
    snow_status status = SNOW_STATUS_OK;
    int failed = 0;
    for (int n = 1; n <= 40 && status == SNOW_STATUS_OK; n++) {
        const job j = job_of(comm, 61, 33, n);
        snow_combiner *combiner;
        SNOW_TRY(snow_combiner_new(comm, &combiner));
        float *pixels = local_image(&j, comm->rank, 61 * 4);
        snow_exchange_params order =
            order_of(&j, comm->rank, ways, pixels, 61 * 4);
        order.regions = SNOW_IMAGE_PARTITION_COUNTED;
        snow_image_region region;
        memory->failing = comm->rank == 3 ? memory->allocations + n - 1 : -1;
        status = snow_exchange(combiner, &order, &region);
        if (status == SNOW_STATUS_OK)
            status = snow_comm_agree_status(
                comm, check_gather(comm, combiner, &j, &region));
        memory->failing = -1;
        failed += status == SNOW_STATUS_NO_MEMORY;
        if (status ==
            SNOW_STATUS_NO_MEMORY) /* the combiner is as good as before */
            status = snow_exchange(combiner, &order, &region);
        if (status == SNOW_STATUS_OK)
            status = check_piece(comm, &j, &region);
        free(pixels);
        snow_combiner_free(combiner);
    }
    if (status == SNOW_STATUS_OK && (failed < 15 || failed == 40))
        status =
            snow_fail(comm->context, SNOW_STATUS_FAILED, "%d failed", failed);
    return status;
}

static snow_status combine_with_gaps_in_memory(snow_comm *comm, void *user) {
    (void)user;
    return with_memory(comm, combine_with_gaps);
}

static void any_block_that_one_rank_does_not_get_fails_all(void **state) {
    (void)state;
    run_body(6, combine_with_gaps_in_memory, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            every_method_gives_the_picture_of_a_chain_for_1_to_33_ranks),
        cmocka_unit_test(nodes_with_memory_and_without_work_together),
        cmocka_unit_test(images_that_are_still_drawn_give_the_same_bits),
        cmocka_unit_test(threads_of_ranks_change_no_bit),
        cmocka_unit_test(pictures_that_need_no_more_than_others_take_no_memory),
        cmocka_unit_test(counted_pieces_are_balanced),
        cmocka_unit_test(what_is_sent_is_waited_for_with_any_number_of_ranks),
        cmocka_unit_test(the_first_rounds_combine_the_ranks_of_nodes),
        cmocka_unit_test(what_is_no_order_is_refused),
        cmocka_unit_test(wrong_runs_of_one_rank_fail_there_and_nobody_waits),
        cmocka_unit_test(any_block_that_one_rank_does_not_get_fails_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
