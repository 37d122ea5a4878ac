/* test_combine - the exchange and the gather, by every method, for 1 to 33
 * ranks in one process, against all local images laid over one another in
 * double precision.
 *
 * The bound: an "over" of floats in [0, 1] has three roundings of at most 2^-25
 * each (of 1 - a, the product, the sum), and hands the errors of both colours
 * on no larger, but for that of the front's alpha, which it adds once.  A pixel
 * of n layers is thus off by less than 6 n 2^-25, in any order of laying. */
#include "support.h"

#include "combine/exchange.h"
#include "combine/rounds.h"

#include <math.h>

#define RANKS_MOST 33

#define CHECK(condition)                                           \
    do {                                                           \
        if (!(condition))                                          \
            return snow_fail(snow_comm_context(comm), SNOW_FAILED, \
                             "line %d: %s", __LINE__, #condition); \
    } while (0)

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

/* A pixel of a local image: half of the ranks have speckles, half have runs;
 * some pixels are opaque, some glow without hiding anything. */
static void pixel_of(const job *j, int rank, int x, int y, float *out) {
    const snow_rectangle d = drawn_by(j, rank);
    const int last = j->channels - 1;
    memset(out, 0, (size_t)j->channels * sizeof *out);
    if (x < d.x0 || x >= d.x1 || y < d.y0 || y >= d.y1 ||
        draw(j, rank, rank % 2 ? x / 9 : x, y, 5) % 10 > 3)
        return;
    uint64_t kind = draw(j, rank, x, y, 6) % 16;
    float alpha = (float)(draw(j, rank, x, y, 7) % 1000) / 1000;
    out[last] = kind == 0 ? 1 : kind == 1 ? 0 : alpha;
    for (int c = 0; c < last; c++)
        out[c] = (kind == 1 ? 0.01f : out[last]) *
                 (float)(draw(j, rank, x, y, 8 + c) % 256) / 255;
}

/* The local image; what is not drawn must not be read. */
static void fill_local(const job *j, int rank, float *pixels, size_t stride) {
    const snow_rectangle d = drawn_by(j, rank);
    for (int y = 0; y < j->height; y++)
        for (size_t i = 0; i < stride; i++)
            pixels[(size_t)y * stride + i] = NAN;
    for (int y = d.y0; y < d.y1; y++)
        for (int x = d.x0; x < d.x1; x++)
            pixel_of(j, rank, x, y,
                     pixels + (size_t)y * stride + x * j->channels);
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

/* --- one exchange --------------------------------------------------------- */

static snow_exchange_order order_of(const job *j, int rank, const float *pixels,
                                    size_t stride) {
    return (snow_exchange_order){.width = j->width,
                                 .height = j->height,
                                 .channels = j->channels,
                                 .pixels = pixels,
                                 .stride = stride,
                                 .drawn = drawn_by(j, rank),
                                 .ranks = j->ranks,
                                 .grain = 1};
}

/* The pixel numbers of pieces: together all, each once, and this rank's. */
static snow_status check_pieces(snow_comm *comm, const snow_combiner *combiner,
                                const job *j, int grain,
                                const snow_piece *mine) {
    int64_t firsts[RANKS_MOST], counts[RANKS_MOST];
    int64_t sum = 0, pixels = (int64_t)j->width * j->height;
    snow_exchange_pieces(combiner, firsts, counts);
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
    return SNOW_OK;
}

static snow_status check_piece(snow_comm *comm, const snow_combiner *combiner,
                               const job *j, const snow_piece *piece) {
    for (int64_t i = 0; i < piece->count; i++) {
        int64_t at = piece->first + i;
        int x = (int)(at % j->width);
        int y = snow_exchange_line(combiner, (int)(at / j->width));
        double want[4];
        expect(j, x, y, want);
        for (int c = 0; c < j->channels; c++) {
            double is = (double)piece->pixels[i * j->channels + c];
            if (!(fabs(is - want[c]) <= bound(j->count)))
                return snow_fail(comm->context, SNOW_FAILED,
                                 "pixel %d %d of %d ranks: %.9g, not %.9g", x,
                                 y, j->count, is, want[c]);
        }
    }
    return SNOW_OK;
}

/* The piece's lines as runs, without pixels that are nothing. */
static size_t runs_of(const snow_combiner *combiner, const job *j,
                      const snow_piece *piece, snow_pixel_run *runs,
                      float *packed) {
    size_t count = 0;
    int64_t last = -2;
    for (int64_t i = 0; i < piece->count; i++) {
        const float *pixel = piece->pixels + i * j->channels;
        bool any = false;
        for (int c = 0; c < j->channels; c++)
            any = any || pixel[c] != 0;
        if (!any)
            continue;
        int64_t at = piece->first + i;
        int x = (int)(at % j->width);
        if (last != at - 1 || x == 0)
            runs[count++] = (snow_pixel_run){
                x, snow_exchange_line(combiner, (int)(at / j->width)), 0};
        runs[count - 1].count++;
        last = at;
        memcpy(packed, pixel, (size_t)j->channels * sizeof *pixel);
        packed += j->channels;
    }
    return count;
}

static snow_status check_gather(snow_comm *comm, snow_combiner *combiner,
                                const job *j, const snow_piece *piece) {
    const size_t pixels = (size_t)j->width * (size_t)j->height;
    const size_t bytes = (size_t)j->channels * sizeof(float);
    snow_pixel_run *runs = calloc((size_t)piece->count + 1, sizeof *runs);
    float *packed = calloc((size_t)piece->count + 1, bytes);
    float *picture = comm->rank == 0 ? calloc(pixels, bytes) : NULL;
    size_t count = runs_of(combiner, j, piece, runs, packed);
    snow_status status = snow_gather(combiner, j->width, j->height, runs, count,
                                     packed, bytes, picture);
    for (size_t i = 0; i < pixels && picture && status == SNOW_OK; i++) {
        double want[4];
        expect(j, (int)i % j->width, (int)i / j->width, want);
        for (int c = 0; c < j->channels; c++)
            if (!(fabs((double)picture[i * (size_t)j->channels + (size_t)c] -
                       want[c]) <= bound(j->count)))
                status = snow_fail(comm->context, SNOW_FAILED,
                                   "pixel %zu of the picture differs", i);
    }
    free(runs);
    free(packed);
    free(picture);
    return status;
}

/* --- all methods ---------------------------------------------------------- */

typedef struct way {
    snow_combining method;
    int radix;
    bool whole;
} way;

static const way ways[] = {
    {SNOW_COMBINE_AUTO, 0, false},  {SNOW_COMBINE_TREE, 0, false},
    {SNOW_COMBINE_TREE, 0, true},   {SNOW_COMBINE_SWAP, 0, false},
    {SNOW_COMBINE_SWAP, 0, true},   {SNOW_COMBINE_DIRECT, 0, false},
    {SNOW_COMBINE_RADIX, 3, false}, {SNOW_COMBINE_RADIX, 4, true},
    {SNOW_COMBINE_RADIX, 8, false},
};

static const int sizes[][2] = {{1, 1}, {5, 3}, {61, 7}, {64, 16}, {37, 41}};

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

/* A shuffled order of ranks. */
static void shuffle(job *j) {
    for (int i = 0; i < j->count; i++)
        j->ranks[i] = i;
    for (int i = j->count - 1; i > 0; i--) {
        int k = (int)(draw(j, i, 0, 0, 99) % (uint64_t)(i + 1));
        int swapped = j->ranks[i];
        j->ranks[i] = j->ranks[k];
        j->ranks[k] = swapped;
    }
}

static snow_status combine_once(snow_comm *comm, snow_combiner *combiner,
                                const job *j, const way *w, int grain,
                                snow_pieces pieces) {
    const size_t stride = (size_t)(j->width * j->channels) + 3;
    float *pixels = malloc(stride * (size_t)j->height * sizeof *pixels);
    fill_local(j, comm->rank, pixels, stride);
    snow_exchange_order order = order_of(j, comm->rank, pixels, stride);
    order.method = w->method;
    order.radix = w->radix;
    order.whole = w->whole;
    order.grain = grain;
    order.pieces = pieces;
    snow_piece piece;
    snow_status status = snow_exchange(combiner, &order, &piece);
    free(pixels);
    SNOW_TRY(status);
    SNOW_TRY(check_pieces(comm, combiner, j, grain, &piece));
    SNOW_TRY(check_piece(comm, combiner, j, &piece));
    snow_gather_radix(combiner, (int)(draw(j, 0, 0, 0, 1) % 6));
    return check_gather(comm, combiner, j, &piece);
}

/* Every way, with sizes, channels, grains and pieces taken in turns. */
static snow_status combine_all_ways(snow_comm *comm, void *user) {
    snow_combiner *combiner;
    int turn = *(int *)user + comm->ranks;
    snow_status status = SNOW_OK;
    SNOW_TRY(snow_combiner_new(comm, &combiner));
    for (size_t i = 0; i < COUNT_OF(ways) && status == SNOW_OK; i++)
        for (size_t k = 0; k < COUNT_OF(sizes) && status == SNOW_OK; k++) {
            turn++;
            job j = {.width = sizes[k][0],
                     .height = sizes[k][1],
                     .channels = turn % 2 ? 2 : 4,
                     .seed = turn,
                     .count = comm->ranks};
            shuffle(&j);
            status = combine_once(comm, combiner, &j, &ways[i],
                                  turn % 3 ? 1 : j.width,
                                  (snow_pieces)(turn / 2 % 4));
            status = snow_comm_agree(comm, status);
        }
    snow_combiner_free(combiner);
    return status;
}

static void
every_method_gives_the_picture_of_a_chain_for_1_to_33_ranks(void **state) {
    (void)state;
    snow_context *context = support_context();
    for (int ranks = 1; ranks <= RANKS_MOST; ranks++)
        for (int turn = 0; turn < 2; turn++) {
            int first = turn * 1000;
            snow_status status =
                snow_comm_threads(context, ranks, combine_all_ways, &first);
            if (status != SNOW_OK)
                print_message("%d ranks: %s\n", ranks,
                              snow_context_message(context));
            assert_int_equal(status, SNOW_OK);
        }
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            every_method_gives_the_picture_of_a_chain_for_1_to_33_ranks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
