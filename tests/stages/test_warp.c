/* tests/stages/test_warp.c - lines of the warp on each level of vectors against
 * a plain loop: avx2 and avx512 have the same bits, and all are within a few
 * roundings of float64.  What lies before and behind results has to stay as it
 * was. */
#include <math.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_through_every_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
