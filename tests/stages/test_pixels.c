/* tests/stages/test_pixels.c - the inner loops of the exchange on every level
 * of vectors, against plain loops over single pixels: the same bits and the
 * same pixels for masks of every density, for runs of every length that begin
 * anywhere, and for numbers at the ends of their range. */
#include "support/support.h"

#include "combine/active.h"
#include "combine/pixels.h"

#include <float.h>

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

static const snow_isa levels[] = {SNOW_ISA_SCALAR, SNOW_ISA_AVX2,
                                  SNOW_ISA_AVX512};

/* What loops may touch behind packed pixels, in floats; and what they must not.
 */
#define SLACK (SNOW_PIXELS_SLACK / 4)
#define GUARD 32
#define MARK 77.0f

/* --- pixels --------------------------------------------------------------- */

/* How active pixels lie. */
typedef enum pattern { NONE, FEW, SOME, MOST, ALL, RUNS, PATTERNS } pattern;

static bool is_active(pattern kind, uint64_t *random, int64_t at) {
    static const unsigned of_100[] = {0, 4, 30, 85, 100};
    if (kind == RUNS)
        return (at / 37 + at / 101) % 2 == 0;
    return support_random(random) % 100 < of_100[kind];
}

static float extreme(uint64_t *random) {
    static const float some[] = {1,      FLT_MIN / 8, -FLT_MIN, 1e-30f,
                                 -1e30f, FLT_EPSILON, 1e30f,    -0.0f,
                                 0.5f,   -1,          3e-39f,   FLT_MAX};
    return some[support_random(random) % COUNT_OF(some)];
}

/* A pixel, with an alpha in [0, 1]; one that is not active is of 0 and -0.  Of
 * an active one any channel alone may be what makes it so. */
static void make_pixel(float *pixel, int channels, bool active,
                       uint64_t *random) {
    const bool odd = support_random(random) % 4 == 0;
    for (int c = 0; c < channels; c++)
        pixel[c] = support_random(random) % 2 ? 0.0f : -0.0f;
    if (!active)
        return;
    if (support_random(random) % 5 == 0) {
        pixel[support_random(random) % (unsigned)channels] = FLT_MIN / 64;
        return;
    }
    for (int c = 0; c < channels - 1; c++)
        pixel[c] = odd ? extreme(random) / 64 : (float)support_uniform(random);
    pixel[channels - 1] =
        odd ? 1 : 0.01f + 0.98f * (float)support_uniform(random);
}

static bool has_anything(const float *pixel, int channels) {
    for (int c = 0; c < channels; c++)
        if (pixel[c] != 0)
            return true;
    return false;
}

/* A block of exactly so many floats, so that a sanitizer sees each that is
 * touched beyond. */
static float *floats(size_t count) {
    assert_true(count < 1 << 20);
    return malloc((count + !count) * sizeof(float));
}

/* --- scan ----------------------------------------------------------------- */

static void check_look(const snow_pixel_loops *loops, const float *pixels,
                       int channels, int count) {
    uint64_t want = 0;
    float *exact = floats((size_t)count * (size_t)channels);
    memcpy(exact, pixels, (size_t)count * (size_t)channels * sizeof *exact);
    for (int i = 0; i < count; i++)
        want |= (uint64_t)has_anything(pixels + i * channels, channels) << i;
    uint64_t bits = loops->look(exact, count);
    free(exact);
    if (bits != want)
        fail_msg("%d pixels of %d: %llx, not %llx", count, channels,
                 (unsigned long long)bits, (unsigned long long)want);
}

/* `count` pixels from number `at` on, into masks that have bits already. */
static void check_scan(const snow_pixel_loops *loops, const float *pixels,
                       int channels, int64_t at, int count) {
    const size_t words = (size_t)((at + count) / 64 - at / 64 + 2);
    const uint64_t before = ((uint64_t)1 << (at % 64)) - 1;
    uint64_t *mask = calloc(words, sizeof *mask);
    uint64_t *want = calloc(words, sizeof *want);
    float *exact = floats((size_t)count * (size_t)channels);
    float *out = floats((size_t)count * (size_t)channels + SLACK + GUARD);
    float *expected = floats((size_t)count * (size_t)channels);
    size_t active = 0;
    memcpy(exact, pixels, (size_t)count * (size_t)channels * sizeof *exact);
    for (size_t i = 0; i < (size_t)count * (size_t)channels + SLACK + GUARD;
         i++)
        out[i] = MARK;
    mask[0] = want[0] = before;
    for (int i = 0; i < count; i++) {
        if (!has_anything(pixels + i * channels, channels))
            continue;
        want[(at + i) / 64 - at / 64] |= (uint64_t)1 << ((at + i) % 64);
        memcpy(expected + active++ * (size_t)channels, pixels + i * channels,
               (size_t)channels * sizeof *out);
    }
    float *end = loops->scan(exact, at, count, mask, out);
    assert_int_equal(end - out, (long)active * channels);
    assert_memory_equal(mask, want, words * sizeof *mask);
    assert_memory_equal(out, expected, active * (size_t)channels * sizeof *out);
    for (int i = 0; i < GUARD; i++)
        assert_true(end[SLACK + i] == MARK);
    free(mask);
    free(want);
    free(exact);
    free(out);
    free(expected);
}

static void check_scans(const snow_pixel_loops *loops, int channels,
                        pattern kind) {
    enum { MOST_PIXELS = 300 };
    float pixels[MOST_PIXELS * 4];
    uint64_t random = (uint64_t)kind * 4 + (uint64_t)channels;
    for (int turn = 0; turn < 3; turn++) {
        for (int i = 0; i < MOST_PIXELS; i++)
            make_pixel(pixels + i * channels, channels,
                       is_active(kind, &random, i), &random);
        for (int count = 1; count <= 64; count++)
            check_look(loops, pixels, channels, count);
        for (int at = 0; at < 64; at++)
            check_scan(loops, pixels, channels, 640 + at,
                       (int)(support_random(&random) % MOST_PIXELS) + 1);
        for (int count = 0; count < MOST_PIXELS; count += 1 + count / 70)
            check_scan(loops, pixels, channels,
                       (int64_t)(support_random(&random) % 200), count);
    }
}

static void every_level_sees_and_packs_the_same_pixels(void **state) {
    (void)state;
    for (size_t l = 0; l < COUNT_OF(levels); l++)
        for (int channels = 2; channels <= 4; channels += 2)
            for (pattern kind = NONE;
                 kind < PATTERNS && snow_isa_runs(levels[l]); kind++)
                check_scans(
                    snow_pixels_pick(levels[l], channels, SNOW_COMPOSITE_OVER),
                    channels, kind);
}

/* --- merge ---------------------------------------------------------------- */

#define LAYERS 5

/* Layers in the middle of a picture. */
typedef struct stack {
    snow_composite_op composite_op;
    int channels, count;
    int64_t first, last;
    snow_active layers[LAYERS];
    float *pixels[LAYERS]; /* all, from the layer's first on */
    int64_t laid;
} stack;

static bool stack_active(const stack *s, int layer, int64_t at) {
    const snow_active *l = &s->layers[layer];
    if (at < l->first || at >= l->last)
        return false;
    return l->words[at / 64 - l->first / 64] >> (at % 64) & 1;
}

/* One layer: some lie in part of the picture only. */
static void make_layer(stack *s, int n, uint64_t *random) {
    const int channels = s->channels;
    int64_t pixels = s->last - s->first;
    snow_active *l = &s->layers[n];
    pattern kind = (pattern)(support_random(random) % PATTERNS);
    l->first = s->first;
    l->last = s->last;
    if (support_random(random) % 3 == 0) {
        l->first += (int64_t)(support_random(random) % (uint64_t)pixels);
        l->last -=
            (int64_t)(support_random(random) % (uint64_t)(l->last - l->first));
    }
    l->own = support_random(random) % 3 == 0;
    uint64_t *words =
        calloc((size_t)snow_active_words(l->first, l->last), sizeof *words);
    size_t count = (size_t)(l->last - l->first), active = 0;
    float *packed = floats(count * (size_t)channels + SLACK);
    s->pixels[n] = floats(count * (size_t)channels);
    for (int64_t at = l->first; at < l->last; at++) {
        float *pixel = s->pixels[n] + (at - l->first) * channels;
        bool on = is_active(kind, random, at);
        make_pixel(pixel, channels, on, random);
        if (!on)
            continue;
        memcpy(packed + active++ * (size_t)channels, pixel,
               (size_t)channels * sizeof *packed);
        words[at / 64 - l->first / 64] |= (uint64_t)1 << (at % 64);
        s->laid += !l->own;
    }
    for (int i = 0; i < SLACK; i++)
        packed[active * (size_t)channels + (size_t)i] = MARK;
    l->pixels = l->next = packed;
    l->words = words;
}

static void free_layer(stack *s, int n) {
    uint64_t *words;
    float *packed;
    memcpy(&words, &s->layers[n].words, sizeof words);
    memcpy(&packed, &s->layers[n].pixels, sizeof packed);
    free(words);
    free(packed);
    free(s->pixels[n]);
}

/* A pixel of all layers; whether there is one. */
static bool expect(const stack *s, int64_t at, float *out) {
    const int last = s->channels - 1;
    bool any = false;
    memset(out, 0, (size_t)s->channels * sizeof *out);
    for (int n = 0; n < s->count; n++) {
        const float *back =
            s->pixels[n] + (at - s->layers[n].first) * s->channels;
        if (!stack_active(s, n, at))
            continue;
        float left = 1 - out[last];
        for (int c = 0; c <= last; c++)
            if (s->composite_op == SNOW_COMPOSITE_MAXIMUM)
                out[c] = back[c] > out[c] ? back[c] : out[c];
            else
                out[c] += s->composite_op == SNOW_COMPOSITE_SUM
                              ? back[c]
                              : left * back[c];
        any = true;
    }
    return any;
}

/* Merges pixels from .. to - 1, the next that are asked for. */
static void check_merge(const snow_pixel_loops *loops, stack *s, int64_t from,
                        int64_t to, bool packed, int64_t *laid) {
    const size_t channels = (size_t)s->channels;
    const size_t room = (size_t)(to - from) * channels;
    uint64_t *words =
        calloc((size_t)snow_active_words(from, to), sizeof *words);
    float *out = floats(room + (packed ? SLACK + GUARD : 0));
    float *at = out;
    for (size_t i = 0; packed && i < room + SLACK + GUARD; i++)
        out[i] = MARK;
    float *end =
        loops->merge(s->layers, s->count, from, to, words, out, packed, laid);
    for (int64_t n = from; n < to; n++) {
        float want[4];
        bool any = expect(s, n, want);
        bool bit = words[n / 64 - from / 64] >> (n % 64) & 1;
        if (bit != any ||
            ((any || !packed) && memcmp(at, want, channels * sizeof *at) != 0))
            fail_msg("pixel %lld of %lld to %lld: %.9g %.9g, not %.9g %.9g",
                     (long long)n, (long long)from, (long long)to,
                     (double)at[0], (double)at[1], (double)want[0],
                     (double)want[1]);
        at += any || !packed ? channels : 0;
    }
    assert_ptr_equal(at, end);
    for (int i = 0; packed && i < GUARD; i++)
        assert_true(end[SLACK + i] == MARK);
    free(words);
    free(out);
}

static void check_stack(snow_isa isa, int channels,
                        snow_composite_op composite_op, uint64_t *random) {
    const snow_pixel_loops *loops =
        snow_pixels_pick(isa, channels, composite_op);
    stack s = {.channels = channels, .composite_op = composite_op};
    int64_t laid = 0;
    s.first = (int64_t)(support_random(random) % 300);
    s.last = s.first + 1 + (int64_t)(support_random(random) % 400);
    s.count = 1 + (int)(support_random(random) % LAYERS);
    bool packed = support_random(random) % 2;
    for (int n = 0; n < s.count; n++)
        make_layer(&s, n, random);
    for (int64_t from = s.first; from < s.last;) { /* in parts */
        int64_t to = from + 1 + (int64_t)(support_random(random) % 200);
        to = to < s.last ? to : s.last;
        check_merge(loops, &s, from, to, packed, &laid);
        from = to;
    }
    assert_int_equal(laid, s.laid);
    for (int n = 0; n < s.count; n++)
        free_layer(&s, n);
}

static void every_level_lays_the_same_pixels(void **state) {
    (void)state;
    for (size_t l = 0; l < COUNT_OF(levels); l++)
        for (int kind = SNOW_COMPOSITE_OVER; kind <= SNOW_COMPOSITE_SUM + 1;
             kind++) {
            int channels = kind > SNOW_COMPOSITE_SUM ? 4 : 2;
            snow_composite_op composite_op =
                channels == 4 ? SNOW_COMPOSITE_OVER : (snow_composite_op)kind;
            uint64_t random = 5;
            for (int i = 0; i < 1500 && snow_isa_runs(levels[l]); i++)
                check_stack(levels[l], channels, composite_op, &random);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_level_sees_and_packs_the_same_pixels),
        cmocka_unit_test(every_level_lays_the_same_pixels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
