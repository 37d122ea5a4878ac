/* tests/stages/test_kernels.c - the warp and the vector operations that
 * templates are made of, each level against a plain loop and against the
 * others: avx2 and avx512 have the same bits, and all are within a few
 * roundings of float64. What lies before and behind results has to stay as it
 * was.
 *
 * With --time: nanoseconds per call of each kernel and level instead. */
#include <math.h>

#include "base/base.h"
#include "support/support.h"
#include "warp/warp.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Of values up to 1: what sums of 16 products may lose in float. */
#define BOUND 2e-6

static const snow_isa levels[] = {SNOW_ISA_SCALAR, SNOW_ISA_AVX2,
                                  SNOW_ISA_AVX512};

static int draw(uint64_t *random, int count) {
    return (int)((support_random(random) >> 33) % (uint64_t)count);
}

/* --- inputs --------------------------------------------------------------- */

typedef enum fill { NOISE, ZEROS, ONES, SUBNORMAL, MIXED, FILLS } fill;

static const char *const fill_names[] = {"noise", "zeros", "ones", "subnormal",
                                         "mixed"};

static float value_of(fill kind, uint64_t *random) {
    if (kind == MIXED)
        kind = (fill)draw(random, MIXED);
    switch (kind) {
    case ZEROS:
        return 0;
    case ONES:
        return 1;
    case SUBNORMAL:
        return (float)(support_uniform(random) * 1e-39);
    default:
        return (float)support_uniform(random);
    }
}

/* Premultiplied pixels: no channel is above the last. */
static void fill_pixels(float *pixels, size_t count, int channels, fill kind,
                        uint64_t *random) {
    for (size_t n = 0; n < count; n++, pixels += channels) {
        float alpha = value_of(kind, random);
        for (int c = 0; c < channels - 1; c++)
            pixels[c] = alpha * value_of(kind, random);
        pixels[channels - 1] = alpha;
    }
}

/* A block between guards that end at its bytes. */
#define GUARD 256
#define GUARD_BYTE 0xA7

typedef struct guarded {
    unsigned char *raw;
    size_t bytes;
} guarded;

static guarded guarded_new(size_t bytes) {
    guarded block = {malloc(bytes + 2 * GUARD), bytes};
    assert_non_null(block.raw);
    memset(block.raw, GUARD_BYTE, bytes + 2 * GUARD);
    return block;
}

static void *guarded_at(const guarded *block) {
    return block->raw + GUARD;
}

/* Whether the guards are as they were; frees the block. */
static bool guarded_end(guarded *block) {
    bool sound = true;
    for (size_t n = 0; n < GUARD; n++)
        sound &= block->raw[n] == GUARD_BYTE &&
                 block->raw[GUARD + block->bytes + n] == GUARD_BYTE;
    free(block->raw);
    return sound;
}

static uint64_t draw_mask(uint64_t *random, int bits) {
    uint64_t mask = support_random(random);
    int kind = draw(random, 6);
    mask = kind == 0   ? ~UINT64_C(0)
           : kind == 1 ? UINT64_C(1) << draw(random, bits)
           : kind == 2 ? mask & support_random(random)
                       : mask;
    return mask & (~UINT64_C(0) >> (64 - bits));
}

/* --- the warp ------------------------------------------------------------- */

typedef struct warp_case {
    snow_intermediate_view plane;
    snow_warp_line line;
    snow_filter filter;
    fill kind;
    int first, count;
} warp_case;

static const char *warp_words(const warp_case *w) {
    static char words[200];
    snprintf(words, sizeof words,
             "%s, %d channels, plane %dx%d, %d pixels from %d, start %.9f %.9f "
             "step %.9f %.9f, %s",
             w->filter == SNOW_BILINEAR ? "bilinear" : "Catmull-Rom",
             w->plane.channels, w->plane.width, w->plane.height, w->count,
             w->first, (double)w->line.start[0] * 0x1p-32,
             (double)w->line.start[1] * 0x1p-32,
             (double)w->line.step[0] * 0x1p-32,
             (double)w->line.step[1] * 0x1p-32, fill_names[w->kind]);
    return words;
}

/* A line within the plane that begins and ends near its limits. */
static void draw_line(warp_case *w, uint64_t *random) {
    int before = w->filter == SNOW_CATMULL_ROM;
    const int sides[2] = {w->plane.width, w->plane.height};
    w->first = draw(random, 5);
    w->count = draw(random, 40);
    for (int axis = 0; axis < 2; axis++) {
        double low = before, high = sides[axis] - 2 - before;
        double a =
            low + (high - low) * (draw(random, 3) ? support_uniform(random)
                                                  : draw(random, 2) * 0.999999);
        double b = low + (high - low) * support_uniform(random);
        if (draw(random, 6) == 0)
            b = a = floor(a);
        double step = w->count > 1 ? (b - a) / (w->count - 1) : 0;
        w->line.step[axis] = (int64_t)(step * 0x1p32);
        w->line.start[axis] =
            (int64_t)(a * 0x1p32) - w->first * w->line.step[axis];
    }
}

static double cubic(double t) {
    t = fabs(t);
    if (t < 1)
        return 1 - 2.5 * t * t + 1.5 * t * t * t;
    return t < 2 ? 2 - 4 * t + 2.5 * t * t - 0.5 * t * t * t : 0;
}

static double tap(snow_filter filter, double t) {
    return filter == SNOW_BILINEAR ? fmax(0, 1 - fabs(t)) : cubic(t);
}

static void plain_warp(const warp_case *w, int n, double out[4]) {
    double x = (double)(w->line.start[0] + n * w->line.step[0]) * 0x1p-32;
    double y = (double)(w->line.start[1] + n * w->line.step[1]) * 0x1p-32;
    int channels = w->plane.channels;
    for (int c = 0; c < 4; c++)
        out[c] = 0;
    for (int row = 0; row < w->plane.height; row++)
        for (int column = 0; column < w->plane.width; column++) {
            double weight =
                tap(w->filter, x - column) * tap(w->filter, y - row);
            const float *at = w->plane.pixels + (size_t)row * w->plane.stride +
                              column * channels;
            for (int c = 0; weight != 0 && c < channels; c++)
                out[c] += weight * (double)at[c];
        }
    for (int c = channels - 1; c >= 0; c--)
        out[c] =
            fmax(0, fmin(out[c], c == channels - 1 ? 1 : out[channels - 1]));
}

static void check_warp(const warp_case *w, double *most) {
    int channels = w->plane.channels;
    size_t floats = (size_t)(w->count * channels);
    float avx2[40 * 4];
    for (size_t level = 0; level < COUNT(levels); level++) {
        if (!snow_isa_runs(levels[level]))
            continue;
        guarded block = guarded_new(floats * sizeof(float));
        float *out = guarded_at(&block);
        snow_warp_of(levels[level], w->filter,
                     channels)(&w->plane, &w->line, w->first, w->count, out);
        for (int n = 0; n < w->count; n++) {
            double plain[4];
            plain_warp(w, w->first + n, plain);
            for (int c = 0; c < channels; c++) {
                double gap = fabs((double)out[n * channels + c] - plain[c]);
                if (!(gap <= BOUND))
                    fail_msg("%s differs by %g at pixel %d: %s",
                             snow_isa_name(levels[level]), gap, n,
                             warp_words(w));
                *most = fmax(*most, gap);
            }
        }
        if (levels[level] == SNOW_ISA_AVX2)
            memcpy(avx2, out, floats * sizeof *out);
        else if (levels[level] == SNOW_ISA_AVX512 &&
                 memcmp(avx2, out, floats * sizeof *out) != 0)
            fail_msg("avx2 and avx512 differ: %s", warp_words(w));
        if (!guarded_end(&block))
            fail_msg("a guard of %s is broken: %s",
                     snow_isa_name(levels[level]), warp_words(w));
    }
}

/* A plane, with no numbers where a line has no pixels any more: those behind
 * the last pixel may be read, but must not count. */
static float *make_plane(warp_case *w, uint64_t *random) {
    snow_intermediate_view *p = &w->plane;
    p->stride = (size_t)((p->width + 4) * p->channels);
    size_t floats = p->stride * (size_t)p->height;
    float *pixels = malloc(floats * sizeof *pixels);
    assert_non_null(pixels);
    for (size_t n = 0; n < floats; n++)
        pixels[n] = NAN;
    for (int row = 0; row < p->height; row++)
        fill_pixels(pixels + (size_t)row * p->stride, (size_t)p->width,
                    p->channels, w->kind, random);
    p->pixels = pixels;
    return pixels;
}

static void lines_through_every_plane(void **state) {
    (void)state;
    uint64_t random = 4;
    double most = 0;
    int done = 0;
    for (int kind = 0; kind < 4 * FILLS; kind++)
        for (int size = 0; size < 25; size++) {
            warp_case w = {.filter = (snow_filter)(kind % 2),
                           .kind = (fill)(kind / 4)};
            w.plane.channels = kind / 2 % 2 ? 4 : 2;
            w.plane.width = 5 + draw(&random, 20);
            w.plane.height = 5 + draw(&random, 20);
            float *pixels = make_plane(&w, &random);
            for (int n = 0; n < 12; n++, done++) {
                draw_line(&w, &random);
                check_warp(&w, &most);
            }
            free(pixels);
        }
    print_message("             %d lines are within %.2g of float64\n", done,
                  most);
}

/* --- words ---------------------------------------------------------------- */

enum word {
    ADD,
    SUB,
    MUL,
    MIN,
    MAX,
    FMA,
    SET1,
    ALPHA2,
    ALPHA4,
    GATHER4,
    FRACTIONS1,
    FRACTIONS2,
    FRACTIONS4,
    GATHER2,
    WORDS
};

#define ENTRIES 50

typedef struct word_input {
    float a[16], b[16], c[16];
    float table[ENTRIES * 4];
    uint32_t entries[16];
    uint64_t mask;
    int64_t at[16]; /* of pixels of the table */
    uint64_t places[16];
} word_input;

typedef struct word_output {
    float lanes[WORDS][16];
    float sums2[16], sums4[16];
    int lane_count, popcount;
    float left2[16], right2[16], left4[16], right4[16];
} word_output;

#define TEMPLATE "stages/vec.tmpl.h"
#include "simd/each_isa.h"

typedef void words_fn(const word_input *in, word_output *out);

static words_fn *words_of(snow_isa isa) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return words_avx512;
    if (isa == SNOW_ISA_AVX2)
        return words_avx2;
#endif
    (void)isa;
    return words_scalar;
}

static float plain_fraction(uint64_t place) {
    return (float)ldexp(floor((double)(place & UINT32_MAX) / 256), -24);
}

/* Lane i of a word; `fused` where products are not rounded. */
static float plain_word(const word_input *in, enum word word, int i,
                        bool fused) {
    float a = in->a[i], b = in->b[i], c = in->c[i], product = a * b;
    switch (word) {
    case ADD:
        return a + b;
    case SUB:
        return a - b;
    case MUL:
        return product;
    case MIN:
        return a < b ? a : b;
    case MAX:
        return a > b ? a : b;
    case FMA:
        return fused ? fmaf(a, b, c) : product + c;
    case SET1:
        return in->a[3];
    case ALPHA2:
        return in->a[i | 1];
    case ALPHA4:
        return in->a[i | 3];
    case GATHER4:
        return in->table[in->entries[i / 4] * 4 + (uint32_t)i % 4];
    case FRACTIONS1:
        return plain_fraction(in->places[i]);
    case FRACTIONS2:
        return plain_fraction(in->places[i / 2]);
    case FRACTIONS4:
        return plain_fraction(in->places[i / 4]);
    default:
        return in->table[in->entries[i / 2] * 2 + (uint32_t)i % 2];
    }
}

static bool same_float(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static void check_lanes(const word_input *in, const word_output *out,
                        const char *name) {
    bool fused = out->lane_count > 4;
    for (int word = 0; word < WORDS; word++)
        for (int i = 0; i < 16; i++) {
            if (out->lane_count == 16 &&
                (word == FRACTIONS2 || word == FRACTIONS4))
                continue;
            float expected = plain_word(in, (enum word)word, i, fused);
            if (!same_float(out->lanes[word][i], expected))
                fail_msg("%s: word %d gives %.9g in lane %d, not %.9g", name,
                         word, (double)out->lanes[word][i], i,
                         (double)expected);
        }
}

/* Adds the upper half to the lower until `left` floats are left. */
static void fold(float *values, int count, int left) {
    for (int half = count / 2; half >= left; half /= 2)
        for (int i = 0; i < half; i++)
            values[i] += values[i + half];
}

static void check_vectors(const word_input *in, const word_output *out,
                          const char *name) {
    const int lanes = out->lane_count;
    for (int i = 0; i < lanes; i++) {
        float two[16], four[16];
        memcpy(two, in->table + 1 + i / 2 * lanes, (size_t)lanes * sizeof *two);
        memcpy(four, in->table + 1 + i / 4 * lanes,
               (size_t)lanes * sizeof *four);
        fold(two, lanes, 2);
        fold(four, lanes, 4);
        if (!same_float(out->sums4[i], four[i % 4]) ||
            (lanes <= 8 && !same_float(out->sums2[i], two[i % 2])))
            fail_msg("%s: a sum differs in lane %d", name, i);
    }
}

static void check_bits(const word_input *in, const word_output *out) {
    int bits = 0;
    for (int i = 0; i < 64; i++)
        bits += (int)(in->mask >> i & 1);
    assert_int_equal(out->popcount, bits);
}

static void check_pixels(const word_input *in, const word_output *out,
                         const char *name) {
    for (int i = 0; out->lane_count < 16 && i < 16; i++) {
        const float *two = in->table + in->at[i / 2] + i % 2;
        const float *four = in->table + in->at[i / 4] + i % 4;
        if (out->left2[i] != two[0] || out->right2[i] != two[2] ||
            out->left4[i] != four[0] || out->right4[i] != four[4])
            fail_msg("%s: pixels apart differ in lane %d", name, i);
    }
}

static float odd_value(uint64_t *random) {
    static const float odd[] = {0,      -0.0f,    1,         -1,
                                1e-40f, INFINITY, -INFINITY, NAN};
    int kind = draw(random, 24);
    return kind < (int)COUNT(odd) ? odd[kind]
                                  : (float)(support_uniform(random) * 4 - 2);
}

static void draw_words(word_input *in, uint64_t *random) {
    for (int i = 0; i < 16; i++) {
        in->a[i] = odd_value(random);
        in->b[i] = draw(random, 4) ? odd_value(random) : in->a[i];
        in->c[i] = odd_value(random);
    }
    for (int i = 0; i < ENTRIES * 4; i++)
        in->table[i] = (float)i;
    for (int i = 0; i < 16; i++)
        in->entries[i] = (uint32_t)draw(random, ENTRIES);
    in->mask = draw_mask(random, 64);
    for (int i = 0; i < 16; i++)
        in->at[i] = 2 * draw(random, ENTRIES * 2 - 3);
    for (int i = 0; i < 16; i++)
        in->places[i] = support_random(random);
}

static void words_mean_what_they_say(void **state) {
    (void)state;
    uint64_t random = 5;
    for (int n = 0; n < 20000; n++) {
        word_input in;
        draw_words(&in, &random);
        for (size_t level = 0; level < COUNT(levels); level++) {
            word_output out;
            const char *name = snow_isa_name(levels[level]);
            if (!snow_isa_runs(levels[level]))
                continue;
            memset(&out, GUARD_BYTE, sizeof out);
            words_of(levels[level])(&in, &out);
            check_lanes(&in, &out, name);
            check_vectors(&in, &out, name);
            check_bits(&in, &out);
            check_pixels(&in, &out, name);
        }
    }
}

/* --- times ---------------------------------------------------------------- */

typedef void timed_fn(void *user, snow_isa isa);

/* The least time of 15 rounds, which other programs disturb least. */
static void time_kernel(const char *name, timed_fn *call, void *user) {
    printf("%-34s", name);
    for (size_t level = 0; level < COUNT(levels); level++) {
        double least = INFINITY;
        if (!snow_isa_runs(levels[level]))
            continue;
        for (int round = 0; round < 15; round++) {
            double start = snow_seconds();
            for (int n = 0; n < 2000; n++)
                call(user, levels[level]);
            least = fmin(least, snow_seconds() - start);
        }
        printf("  %s %8.1f ns", snow_isa_name(levels[level]),
               least / 2000 * 1e9);
    }
    printf("\n");
}

static void call_warp(void *user, snow_isa isa) {
    warp_case *w = user;
    float out[40 * 4];
    snow_warp_of(isa, w->filter, w->plane.channels)(&w->plane, &w->line,
                                                    w->first, w->count, out);
}

static void time_warps(uint64_t *random) {
    for (int kind = 0; kind < 4; kind++) {
        char name[64];
        warp_case w = {.filter = (snow_filter)(kind % 2)};
        w.plane = (snow_intermediate_view){.width = 40, .height = 40};
        w.plane.channels = kind / 2 ? 4 : 2;
        float *pixels = make_plane(&w, random);
        draw_line(&w, random);
        w.count = 32;
        w.first = 0;
        w.line = (snow_warp_line){{INT64_C(3) << 32, INT64_C(3) << 32},
                                  {INT64_C(1) << 32, INT64_C(1) << 30}};
        snprintf(name, sizeof name, "warp 32 pixels %s %dch",
                 kind % 2 ? "cubic" : "linear", w.plane.channels);
        time_kernel(name, call_warp, &w);
        free(pixels);
    }
}

static int time_all(void) {
    uint64_t random = 8;
    time_warps(&random);
    return 0;
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_through_every_plane),
        cmocka_unit_test(words_mean_what_they_say),
    };
    if (argc > 1 && strcmp(argv[1], "--time") == 0)
        return time_all();
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
