/* tests/stages/test_kernels.c - the kernels of the sheared method, each level
 * against a plain loop and against the others: avx2 and avx512 have the same
 * bits, and all are within a few roundings of float64.  What lies before,
 * behind and between results has to stay as it was.
 *
 * With --time: nanoseconds per call of each kernel and level instead. */
#include <math.h>

#include "classify/sample/sample.h"
#include "composite/tile.h"
#include "encode/decode.h"
#include "splat/separable/rows.h"
#include "support/support.h"
#include "warp/warp.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Of values up to 1: what sums of up to 900 products may lose in float. */
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

/* --- tiles ---------------------------------------------------------------- */

typedef struct tile_case {
    int channels, taps_u, taps_v, cells;
    fill kind, front;
    snow_lattice u, v;
    snow_comb comb_u, comb_v;
    uint64_t held, wanted;
    size_t window, line, pixels; /* floats */
    float *samples, *before;     /* pixels as they are at first */
    uint64_t seed;
} tile_case;

static const char *tile_words(const tile_case *t) {
    static char words[256];
    snprintf(words, sizeof words,
             "%d channels, taps %d %d, phases %d %d, stride %d %d, lead %d %d, "
             "%d cells, held %llx, wanted %llx, samples %s on %s, seed %llu",
             t->channels, t->taps_u, t->taps_v, t->u.phases, t->v.phases,
             t->u.stride, t->v.stride, t->comb_u.lead[1], t->comb_v.lead[1],
             t->cells, (unsigned long long)t->held,
             (unsigned long long)t->wanted, fill_names[t->kind],
             fill_names[t->front], (unsigned long long)t->seed);
    return words;
}

static void draw_comb(snow_comb *comb, const snow_lattice *lattice, int taps,
                      uint64_t *random) {
    memset(comb, 0, sizeof *comb);
    comb->lead[1] = lattice->phases == 2 ? draw(random, 2) : 0;
    for (int phase = 0; phase < 2; phase++) {
        float sum = 0;
        for (int m = 0; m < taps; m++)
            sum += comb->weights[phase][m] =
                draw(random, 5) ? (float)support_uniform(random) : 0;
        for (int m = 0; m < taps; m++)
            comb->weights[phase][m] /= sum > 0 ? sum : 1;
        for (int m = taps; m < SNOW_TAPS_MOST; m++)
            comb->weights[phase][m] = NAN; /* none of theirs */
    }
}

static void draw_lattice(snow_lattice *lattice, int kind) {
    lattice->phases = kind == 0 ? 2 : 1;
    lattice->stride = kind == 2 ? 2 : 1;
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

/* Samples of rows that are not held, and behind the windows, are no numbers:
 * they must not count. */
static void fill_samples(tile_case *t, size_t voxels, uint64_t *random) {
    size_t pixel = (size_t)t->channels;
    t->samples = malloc(SNOW_TILE_ROWS * t->window * sizeof *t->samples);
    assert_non_null(t->samples);
    for (size_t row = 0; row < SNOW_TILE_ROWS; row++) {
        float *at = t->samples + row * t->window;
        for (size_t n = 0; n < t->window; n++)
            at[n] = NAN;
        if (t->held >> row & 1)
            fill_pixels(at, voxels, t->channels, t->kind, random);
    }
    (void)pixel;
}

static tile_case draw_tile(int lattices, int channels, int taps_u, int taps_v,
                           uint64_t *random) {
    tile_case t = {.channels = channels, .taps_u = taps_u, .taps_v = taps_v};
    t.seed = *random;
    t.kind = (fill)draw(random, FILLS);
    t.front = (fill)draw(random, FILLS);
    draw_lattice(&t.u, lattices % 3);
    draw_lattice(&t.v, lattices / 3);
    draw_comb(&t.comb_u, &t.u, taps_u, random);
    draw_comb(&t.comb_v, &t.v, taps_v, random);
    int most = (SNOW_TILE_ROWS - taps_v - t.v.phases + 1) / t.v.stride + 1;
    most = most < SNOW_TILE_CELLS ? most : SNOW_TILE_CELLS;
    t.cells = 1 + draw(random, most);
    t.held = draw_mask(random, 64);
    t.wanted = draw_mask(random, t.cells);
    size_t voxels = (size_t)((SNOW_TILE_COLUMNS - 1) * t.u.stride + taps_u +
                             t.u.phases - 1);
    t.window = (voxels + SNOW_TILE_COLUMNS) * (size_t)channels;
    fill_samples(&t, voxels, random);
    size_t width = (size_t)(SNOW_TILE_COLUMNS * t.u.phases);
    t.line = (width + (size_t)draw(random, 20)) * (size_t)channels;
    t.pixels =
        (size_t)(t.cells * t.v.phases - 1) * t.line + width * (size_t)channels;
    t.before = malloc(t.pixels * sizeof *t.before);
    assert_non_null(t.before);
    fill_pixels(t.before, t.pixels / (size_t)channels, channels, t.front,
                random);
    for (size_t n = 0; n < t.pixels / (size_t)channels; n++)
        t.before[(n + 1) * (size_t)channels - 1] -= 1;
    return t;
}

static void free_tile(tile_case *t) {
    free(t->samples);
    free(t->before);
}

/* What row `row` of voxels gives to pixel `n` of a phase along u. */
static double filtered(const tile_case *t, int row, int phase, int n, int c) {
    double sum = 0;
    const float *at = t->samples + (size_t)row * t->window;
    if (!(t->held >> row & 1))
        return 0;
    for (int m = 0; m < t->taps_u; m++)
        sum +=
            (double)t->comb_u.weights[phase][m] *
            (double)
                at[(n * t->u.stride + t->comb_u.lead[phase] + m) * t->channels +
                   c];
    return sum;
}

/* The plain loop over one pixel; returns what still shines through. */
static double lay_pixel(const tile_case *t, int cell, int phase_v, int n,
                        int phase_u, double *pixels) {
    double sums[4] = {0};
    double *pixel = pixels + (size_t)(cell * t->v.phases + phase_v) * t->line +
                    (size_t)((n * t->u.phases + phase_u) * t->channels);
    for (int m = 0; m < t->taps_v; m++)
        for (int c = 0; c < t->channels; c++)
            sums[c] +=
                (double)t->comb_v.weights[phase_v][m] *
                filtered(t, cell * t->v.stride + t->comb_v.lead[phase_v] + m,
                         phase_u, n, c);
    double through = -pixel[t->channels - 1];
    for (int c = 0; c < t->channels; c++)
        pixel[c] += through * sums[c];
    return -pixel[t->channels - 1];
}

/* The plain loop; cells that rounding may decide about go into *unsure. */
static uint64_t composite_tile(const tile_case *t, double *pixels,
                               uint64_t *unsure) {
    uint64_t finished = 0;
    *unsure = 0;
    for (int cell = 0; cell < t->cells; cell++) {
        double most = 0;
        if (!(t->wanted >> cell & 1))
            continue;
        for (int phase_v = 0; phase_v < t->v.phases; phase_v++)
            for (int n = 0; n < SNOW_TILE_COLUMNS; n++)
                for (int phase_u = 0; phase_u < t->u.phases; phase_u++)
                    most = fmax(
                        most, lay_pixel(t, cell, phase_v, n, phase_u, pixels));
        double limit = (double)SNOW_OPAQUE_ENOUGH;
        finished |= (uint64_t)(most <= limit) << cell;
        *unsure |= (uint64_t)(fabs(most - limit) < 1e-5) << cell;
    }
    return finished;
}

/* One level; the pixels come back in `out`. */
static uint64_t run_tile(const tile_case *t, snow_isa isa, float *out) {
    size_t ring_row = 2 * SNOW_TILE_COLUMNS * (size_t)t->channels;
    guarded pixels = guarded_new(t->pixels * sizeof(float));
    guarded ring = guarded_new(SNOW_TILE_ROWS * ring_row * sizeof(float));
    float zero[2 * SNOW_TILE_COLUMNS * 4] = {0};
    memcpy(guarded_at(&pixels), t->before, pixels.bytes);
    memset(guarded_at(&ring), 0xFF, ring.bytes); /* no numbers */
    snow_tile tile = {&t->u,
                      &t->v,
                      &t->comb_u,
                      &t->comb_v,
                      t->taps_u,
                      t->taps_v,
                      t->samples,
                      t->window,
                      t->held,
                      t->wanted,
                      guarded_at(&ring),
                      zero,
                      guarded_at(&pixels),
                      t->line};
    uint64_t finished = snow_tile_of(isa, t->channels)(&tile);
    memcpy(out, guarded_at(&pixels), pixels.bytes);
    bool sound = guarded_end(&pixels);
    if (!guarded_end(&ring) || !sound)
        fail_msg("a guard of %s is broken: %s", snow_isa_name(isa),
                 tile_words(t));
    return finished;
}

static void check_tile(const tile_case *t, double *most) {
    float *out = malloc(t->pixels * sizeof *out);
    float *avx2 = malloc(t->pixels * sizeof *avx2);
    double *plain = malloc(t->pixels * sizeof *plain);
    assert_true(out && avx2 && plain);
    for (size_t n = 0; n < t->pixels; n++)
        plain[n] = (double)t->before[n];
    uint64_t unsure, finished = composite_tile(t, plain, &unsure), of_avx2 = 0;
    for (size_t level = 0; level < COUNT(levels); level++) {
        if (!snow_isa_runs(levels[level]))
            continue;
        uint64_t got = run_tile(t, levels[level], out);
        if ((got ^ finished) & ~unsure)
            fail_msg("%s finishes %llx, not %llx: %s",
                     snow_isa_name(levels[level]), (unsigned long long)got,
                     (unsigned long long)finished, tile_words(t));
        for (size_t n = 0; n < t->pixels; n++) {
            double gap = fabs((double)out[n] - plain[n]);
            /* Nothing is drawn there. */
            bool same = plain[n] != (double)t->before[n] || !(gap > 0) ||
                        t->kind == SUBNORMAL || t->kind == MIXED;
            if (!(gap <= BOUND) || !same)
                fail_msg("%s differs by %g at float %zu: %s",
                         snow_isa_name(levels[level]), gap, n, tile_words(t));
            *most = fmax(*most, gap);
        }
        if (levels[level] == SNOW_ISA_AVX2) {
            memcpy(avx2, out, t->pixels * sizeof *out);
            of_avx2 = got;
        } else if (levels[level] == SNOW_ISA_AVX512 &&
                   (memcmp(avx2, out, t->pixels * sizeof *out) != 0 ||
                    of_avx2 != got)) {
            fail_msg("avx2 and avx512 differ: %s", tile_words(t));
        }
    }
    free(out);
    free(avx2);
    free(plain);
}

static void tiles_of_every_lattice_and_number_of_taps(void **state) {
    (void)state;
    uint64_t random = 1;
    double most = 0;
    int done = 0;
    for (int lattices = 0; lattices < 9; lattices++)
        for (int channels = 2; channels <= 4; channels += 2)
            for (int taps = 2; taps <= SNOW_TAPS_MOST; taps += 2)
                for (int other = 0; other < 6; other++) {
                    int taps_v = other < 3 ? taps : 2 + 2 * draw(&random, 15);
                    tile_case t =
                        draw_tile(lattices, channels, taps, taps_v, &random);
                    check_tile(&t, &most);
                    free_tile(&t);
                    done++;
                }
    print_message("             %d tiles are within %.2g of float64\n", done,
                  most);
}

static void pixels_are_cleared_and_finished(void **state) {
    (void)state;
    for (int channels = 2; channels <= 4; channels += 2)
        for (size_t count = 0; count < 70; count++) {
            size_t floats = count * (size_t)channels;
            guarded block = guarded_new(floats * sizeof(float));
            float *pixels = guarded_at(&block);
            snow_tile_clear(pixels, count, channels);
            for (size_t n = 0; n < floats; n++)
                assert_true(pixels[n] ==
                            ((n + 1) % (size_t)channels ? 0.0f : -1.0f));
            snow_tile_finish(pixels, count, channels);
            for (size_t n = 0; n < floats; n++)
                assert_true(pixels[n] == 0);
            assert_true(guarded_end(&block));
        }
}

/* --- samples -------------------------------------------------------------- */

#define VOXELS_BEFORE 5 /* at most: of a row, before its window */
#define ROW_VOXELS (VOXELS_BEFORE + SNOW_WINDOW_MOST + SNOW_SAMPLE_MARGIN)

typedef struct sample_case {
    int code_bytes, channels, count;
    bool shaded;
    fill kind;
    uint64_t held, bits[SNOW_SAMPLE_ROWS];
    uint32_t before[SNOW_SAMPLE_ROWS];
    unsigned char codes[SNOW_SAMPLE_ROWS][ROW_VOXELS * 2];
    uint16_t normals[SNOW_SAMPLE_ROWS][ROW_VOXELS];
    float *palette; /* of code 0 */
    snow_gloss *gloss;
} sample_case;

static const char *sample_words(const sample_case *s, int row) {
    static char words[160];
    snprintf(words, sizeof words,
             "codes of %d bytes, %d channels, %s, %d places, rows %llx, bits "
             "of row %d %llx, %s",
             s->code_bytes, s->channels, s->shaded ? "shaded" : "plain",
             s->count, (unsigned long long)s->held, row,
             (unsigned long long)s->bits[row], fill_names[s->kind]);
    return words;
}

static void draw_sample(sample_case *s, int count, uint64_t *random) {
    s->count = count;
    s->held = draw_mask(random, SNOW_SAMPLE_ROWS);
    for (int row = 0; row < SNOW_SAMPLE_ROWS; row++) {
        s->bits[row] = draw_mask(random, count);
        s->before[row] = (uint32_t)draw(random, VOXELS_BEFORE + 1);
        for (size_t n = 0; n < sizeof s->codes[row]; n++)
            s->codes[row][n] =
                draw(random, 4) ? (unsigned char)draw(random, 256) : 255;
        for (size_t n = 0; n < ROW_VOXELS; n++)
            s->normals[row][n] =
                (uint16_t)(draw(random, 4) ? draw(random, 65536)
                                           : 65535 * draw(random, 2));
    }
}

/* The plain loop for one place. */
static void plain_sample(const sample_case *s, int row, int place,
                         double out[4]) {
    int voxel = (int)s->before[row];
    for (int n = 0; n < place; n++)
        voxel += (int)(s->bits[row] >> n & 1);
    for (int c = 0; c < 4; c++)
        out[c] = 0;
    if (!(s->bits[row] >> place & 1))
        return;
    uint16_t code = s->codes[row][voxel];
    if (s->code_bytes == 2)
        memcpy(&code, s->codes[row] + 2 * voxel, 2);
    const float *entry = s->palette + (size_t)code * (size_t)s->channels;
    for (int c = 0; c < s->channels; c++)
        out[c] = (double)entry[c];
    if (!s->shaded)
        return;
    snow_gloss gloss = s->gloss[s->normals[row][voxel]];
    double alpha = out[s->channels - 1], one = (double)SNOW_GLOSS_ONE;
    for (int c = 0; c < s->channels - 1; c++)
        out[c] = alpha *
                 fmin(1, out[c] * (gloss & 0xFFFF) / one + (gloss >> 16) / one);
}

/* Makes the samples of a case by a level. */
static void make_samples(const sample_case *s, snow_isa isa, size_t window,
                         snow_sample_room *room, float *out) {
    const unsigned char *codes[SNOW_SAMPLE_ROWS];
    const uint16_t *normals[SNOW_SAMPLE_ROWS];
    for (int row = 0; row < SNOW_SAMPLE_ROWS; row++) {
        codes[row] = s->codes[row];
        normals[row] = s->shaded ? s->normals[row] : NULL;
    }
    snow_sample_job job = {
        s->held, s->count,  s->bits,    codes,
        normals, s->before, s->palette, s->shaded ? s->gloss : NULL,
        room,    out,       window,     NULL,
        0};
    snow_sample_of(isa, s->code_bytes, s->channels, s->shaded, false)(&job);
}

static void check_row(const sample_case *s, int row, const float *samples,
                      const char *name, double *most) {
    for (int place = 0; place < s->count; place++) {
        double plain[4];
        plain_sample(s, row, place, plain);
        for (int c = 0; c < s->channels; c++) {
            double gap =
                fabs((double)samples[place * s->channels + c] - plain[c]);
            bool exact = !s->shaded || !(s->bits[row] >> place & 1);
            if (!(gap <= (exact ? 0 : 2e-7)))
                fail_msg("%s differs by %g at place %d: %s", name, gap, place,
                         sample_words(s, row));
            *most = fmax(*most, gap);
        }
    }
}

static void check_sample(const sample_case *s, double *most) {
    static float avx2[SNOW_SAMPLE_ROWS][SNOW_WINDOW_MOST * 4];
    static snow_sample_room room;
    size_t window = (size_t)(s->count * s->channels);
    for (size_t level = 0; level < COUNT(levels); level++) {
        const char *name = snow_isa_name(levels[level]);
        if (!snow_isa_runs(levels[level]))
            continue;
        guarded block = guarded_new(
            (SNOW_SAMPLE_ROWS * window + SNOW_SAMPLE_BEYOND) * sizeof(float));
        float *out = guarded_at(&block);
        memset(&room, GUARD_BYTE, sizeof room);
        make_samples(s, levels[level], window, &room, out);
        for (int row = 0; row < SNOW_SAMPLE_ROWS; row++) {
            const float *samples = out + (size_t)row * window;
            if (!(s->held >> row & 1))
                continue;
            check_row(s, row, samples, name, most);
            if (levels[level] == SNOW_ISA_AVX2)
                memcpy(avx2[row], samples, window * sizeof *out);
            else if (levels[level] == SNOW_ISA_AVX512 &&
                     memcmp(avx2[row], samples, window * sizeof *out) != 0)
                fail_msg("avx2 and avx512 differ: %s", sample_words(s, row));
        }
        if (!guarded_end(&block))
            fail_msg("a guard of %s is broken: %s", name, sample_words(s, 0));
    }
}

/* Tables of all codes and normals, made exactly as long. */
static void make_tables(sample_case *s, uint64_t *random) {
    size_t codes = s->code_bytes == 1 ? 256 : 65536;
    size_t floats = codes * (size_t)s->channels;
    s->palette = malloc(floats * sizeof *s->palette);
    s->gloss = malloc(SNOW_NORMALS * sizeof *s->gloss);
    assert_true(s->palette && s->gloss);
    for (size_t n = 0; n < floats; n++)
        s->palette[n] = value_of(s->kind, random);
    for (size_t n = 0; n < SNOW_NORMALS; n++)
        s->gloss[n] = (snow_gloss)(support_random(random) >> 32);
}

static void free_tables(sample_case *s) {
    free(s->palette);
    free(s->gloss);
}

static void samples_of_every_window(void **state) {
    (void)state;
    uint64_t random = 2;
    double most = 0;
    int done = 0;
    for (int kind = 0; kind < 8 * FILLS; kind++) {
        static sample_case s;
        s.code_bytes = 1 + kind % 2;
        s.channels = kind / 2 % 2 ? 4 : 2;
        s.shaded = kind / 4 % 2;
        s.kind = (fill)(kind / 8);
        make_tables(&s, &random);
        for (int count = 1; count <= SNOW_WINDOW_MOST; count++)
            for (int n = 0; n < support_sweep(3, 1); n++, done++) {
                draw_sample(&s, count, &random);
                check_sample(&s, &most);
            }
        free_tables(&s);
    }
    print_message(
        "             %d times 64 windows are within %.2g of float64\n", done,
        most);
}

/* --- windows -------------------------------------------------------------- */

typedef struct window_case {
    int columns, count;
    int64_t column;
    uint64_t wanted;
    snow_mask_rows rows;
    uint64_t bits[SNOW_DECODE_ROWS * 8];
    uint32_t rank[SNOW_DECODE_ROWS * 8];
} window_case;

static bool bit_at(const window_case *w, int row, int64_t column) {
    if (column < 0 || column >= w->columns)
        return false;
    uint64_t word =
        w->bits[(size_t)(column + SNOW_DECODE_PAD) / 64 * SNOW_DECODE_ROWS +
                (size_t)row];
    return word >> (column + SNOW_DECODE_PAD) % 64 & 1;
}

static void draw_rows(window_case *w, int columns, uint64_t *random) {
    w->columns = columns;
    w->rows.words = snow_decode_words(columns);
    w->rows.bits = w->bits;
    w->rows.rank = w->rank;
    w->rows.held = draw_mask(random, SNOW_DECODE_ROWS);
    for (size_t n = 0; n < COUNT(w->bits); n++) {
        w->bits[n] = support_random(random); /* of rows that are not held */
        w->rank[n] = 0xDEADBEEF;
    }
    for (int row = 0; row < SNOW_DECODE_ROWS; row++) {
        if (!(w->rows.held >> row & 1))
            continue;
        uint64_t *words = w->bits + row;
        int kind = draw(random, 5);
        for (size_t word = 0; word < w->rows.words; word++)
            words[word * SNOW_DECODE_ROWS] = 0;
        for (int n = SNOW_DECODE_PAD; n < SNOW_DECODE_PAD + columns; n++)
            if (kind == 0 || (kind == 1 && draw(random, 40) == 0) ||
                (kind > 1 && draw(random, 2)))
                words[n / 64 * SNOW_DECODE_ROWS] |= UINT64_C(1) << n % 64;
    }
}

/* The voxels of a row before each of its words. */
static void rank_rows(window_case *w) {
    for (int row = 0; row < SNOW_DECODE_ROWS; row++) {
        uint32_t rank = 0;
        for (size_t word = 0; word < w->rows.words; word++) {
            size_t at = word * SNOW_DECODE_ROWS + (size_t)row;
            if (w->rows.held >> row & 1)
                w->rank[at] = rank;
            for (int n = 0; n < 64; n++)
                rank += (uint32_t)(w->bits[at] >> n & 1);
        }
    }
}

static void check_window(const window_case *w, snow_isa isa) {
    uint64_t bits[SNOW_DECODE_ROWS], found = 0;
    uint32_t before[SNOW_DECODE_ROWS];
    memset(bits, GUARD_BYTE, sizeof bits);
    memset(before, GUARD_BYTE, sizeof before);
    uint64_t got = snow_decode_fns_of(isa)->windows(
        &w->rows, w->wanted, w->column, w->count, bits, before);
    for (int row = 0; row < SNOW_DECODE_ROWS; row++) {
        uint64_t window = 0;
        uint32_t voxels = 0;
        for (int n = 0; n < w->count; n++)
            window |= (uint64_t)bit_at(w, row, w->column + n) << n;
        for (int64_t n = 0; n < w->column; n++)
            voxels += bit_at(w, row, n);
        if (!window || !(w->rows.held >> row & w->wanted >> row & 1))
            continue;
        found |= UINT64_C(1) << row;
        if (bits[row] != window || before[row] != voxels)
            fail_msg("%s: row %d has %llx after %u, not %llx after %u: %d "
                     "columns, %d from %d",
                     snow_isa_name(isa), row, (unsigned long long)bits[row],
                     before[row], (unsigned long long)window, voxels,
                     w->columns, w->count, (int)w->column);
    }
    assert_true(got == found);
}

static void windows_at_every_column(void **state) {
    (void)state;
    uint64_t random = 3;
    static window_case w;
    for (int columns = 1; columns <= 130; columns++)
        for (size_t level = 0; level < COUNT(levels); level++) {
            if (!snow_isa_runs(levels[level]))
                continue;
            draw_rows(&w, columns, &random);
            rank_rows(&w);
            for (int n = 0; n < 24; n++) {
                w.count = 1 + (n < 4 ? SNOW_WINDOW_MOST - 1
                                     : draw(&random, SNOW_WINDOW_MOST));
                w.column = draw(&random, columns + w.count - 1) - w.count + 1;
                if (n % 4 == 0)
                    w.column = n % 8 ? columns - 1 : 1 - w.count;
                w.wanted = draw_mask(&random, SNOW_DECODE_ROWS);
                check_window(&w, levels[level]);
            }
        }
}

/* --- rows of bands -------------------------------------------------------- */

#define SLICES 3

/* A small volume, of which values from 128 on are interesting, in bands. */
typedef struct band_case {
    snow_context *context;
    snow_volume *volume;
    snow_quantizer quantizer;
    snow_bands bands;
    int columns, rows;
    unsigned char voxels[SLICES * 70 * 130];
} band_case;

/* Slices of noise, of long runs, and of next to nothing. */
static void fill_slices(band_case *b, uint64_t *random) {
    int count = b->columns * b->rows;
    for (int slice = 0; slice < SLICES; slice++)
        for (int at = 0; at < count;) {
            int most = slice == 0 ? 3 : slice == 1 ? 300 : 1;
            int run = 1 + draw(random, most);
            bool kept = draw(random, slice == 2 ? 200 : 2) == 0;
            for (; run-- && at < count; at++)
                b->voxels[slice * count + at] =
                    (unsigned char)(draw(random, 128) + 128 * kept);
        }
}

static void begin_bands(band_case *b, snow_encoding encoding,
                        uint64_t *random) {
    static const snow_color_point white[] = {{0, 1, 1, 1}};
    static const snow_opacity_point step[] = {{128, 0}, {128, 0.5}};
    snow_volume_info info = {.size = sizeof info,
                             .dims = {b->columns, b->rows, SLICES},
                             .type = SNOW_TYPE_UINT8};
    snow_view view = {.size = sizeof view};
    snow_placement placement;
    snow_transfer *transfer = NULL;
    fill_slices(b, random);
    b->context = support_context();
    assert_int_equal(snow_volume_wrap(b->context, &info, b->voxels, &b->volume),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_transfer_new(b->context, white, 1, step, 2, &transfer),
        SNOW_STATUS_OK);
    assert_int_equal(
        snow_quantizer_make(b->context, b->volume, transfer, 0, &b->quantizer),
        SNOW_STATUS_OK);
    assert_int_equal(snow_view_from_name(b->context, "+z", &view),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_placement_make(b->context,
                                         snow_volume_get_info(b->volume), &view,
                                         &placement),
                     SNOW_STATUS_OK);
    snow_bands_params order = {.volume = b->volume,
                               .placement = &placement,
                               .quantizer = &b->quantizer,
                               .encoding = encoding,
                               .slice_count = SLICES,
                               .isa = snow_isa_resolve(SNOW_ISA_AUTO),
                               .threads = 1};
    b->bands = (snow_bands){.context = b->context};
    assert_int_equal(snow_bands_encode(&b->bands, &order), SNOW_STATUS_OK);
    snow_transfer_free(transfer);
}

static void end_bands(band_case *b) {
    snow_bands_fini(&b->bands);
    snow_quantizer_fini(b->context, &b->quantizer);
    snow_volume_close(b->volume);
    assert_int_equal(snow_context_bytes(b->context), 0);
    snow_context_free(b->context);
}

/* Row `row` of the slice as it was read at place n: bits, ranks and codes. */
static void check_read_row(const band_case *b, const snow_mask_rows *rows,
                           int slice, int64_t row, int n, const char *name) {
    const unsigned char *voxels =
        b->voxels +
        ((size_t)slice * (size_t)b->rows + (size_t)row) * (size_t)b->columns;
    const uint64_t *bits = rows->bits + n;
    const uint32_t *rank = rows->rank + n;
    uint32_t count = 0;
    for (size_t at = 0; at < 64 * rows->words; at++) {
        size_t column = at - SNOW_DECODE_PAD; /* far beyond, before the first */
        bool kept = column < (size_t)b->columns && voxels[column] >= 128;
        size_t word = at / 64 * SNOW_DECODE_ROWS;
        if (at % 64 == 0 && rank[word] != count)
            fail_msg("%s ranks word %zu of row %d of %dx%d %u, not %u", name,
                     at / 64, (int)row, b->columns, b->rows, rank[word], count);
        if ((bits[word] >> at % 64 & 1) != kept)
            fail_msg("%s: bit %zu of row %d of %dx%d is not %d", name, at,
                     (int)row, b->columns, b->rows, kept);
        if (kept)
            assert_int_equal(rows->codes[n][count], voxels[column]);
        count += kept;
    }
}

static bool holds_voxels(const band_case *b, int slice, int64_t row) {
    if (row < 0 || row >= b->rows)
        return false;
    for (int column = 0; column < b->columns; column++)
        if (b->voxels[((size_t)slice * (size_t)b->rows + (size_t)row) *
                          (size_t)b->columns +
                      (size_t)column] >= 128)
            return true;
    return false;
}

/* Whether `any` tells of the columns of those rows that are held. */
static void check_any(const band_case *b, const snow_mask_rows *rows, int slice,
                      int64_t first) {
    for (int column = 0; column < b->columns; column++) {
        bool any = false;
        for (int n = 0; n < SNOW_DECODE_ROWS; n++)
            any |= rows->held >> n & 1 &&
                   b->voxels[((size_t)slice * (size_t)b->rows +
                              (size_t)(first + n)) *
                                 (size_t)b->columns +
                             (size_t)column] >= 128;
        assert_int_equal(snow_decode_any(rows, column, 1), any);
    }
    assert_false(snow_decode_any(rows, b->columns, SNOW_WINDOW_MOST));
    assert_false(snow_decode_any(rows, -SNOW_WINDOW_MOST, SNOW_WINDOW_MOST));
    assert_int_equal(
        snow_decode_any(rows, 1 - SNOW_WINDOW_MOST, SNOW_WINDOW_MOST),
        snow_decode_any(rows, 0, 1));
}

static void check_read(const band_case *b, snow_isa isa, int slice,
                       int64_t first, uint64_t wanted) {
    int low = __builtin_ctzll(wanted), high = 63 - __builtin_clzll(wanted);
    size_t words = snow_decode_words(b->columns);
    guarded bits = guarded_new(SNOW_DECODE_ROWS * words * sizeof(uint64_t));
    guarded rank = guarded_new(SNOW_DECODE_ROWS * words * sizeof(uint32_t));
    guarded spans =
        guarded_new(((size_t)b->columns / 2 + 1) * sizeof(snow_span));
    guarded any = guarded_new(words * sizeof(uint64_t));
    snow_mask_rows rows = {.bits = guarded_at(&bits),
                           .rank = guarded_at(&rank),
                           .any = guarded_at(&any),
                           .words = words,
                           .fetch = first % 2 == 0};
    snow_decode_fns_of(isa)->read(&b->bands, slice, first, wanted,
                                  guarded_at(&spans), &rows);
    for (int n = 0; n < SNOW_DECODE_ROWS; n++) {
        bool held = n >= low && n <= high && holds_voxels(b, slice, first + n);
        if ((rows.held >> n & 1) != held)
            fail_msg("%s: row %d of %dx%d is%s held", snow_isa_name(isa),
                     (int)first + n, b->columns, b->rows, held ? " not" : "");
        if (held)
            check_read_row(b, &rows, slice, first + n, n, snow_isa_name(isa));
    }
    check_any(b, &rows, slice, first);
    bool sound = guarded_end(&bits);
    sound &= guarded_end(&rank);
    sound &= guarded_end(&any);
    if (!guarded_end(&spans) || !sound)
        fail_msg("a guard of %s is broken: %dx%d", snow_isa_name(isa),
                 b->columns, b->rows);
}

static void rows_of_bands_are_read_as_bits(void **state) {
    (void)state;
    uint64_t random = 9;
    static band_case b;
    for (b.columns = 1; b.columns <= 130; b.columns++)
        for (int encoding = SNOW_ENCODING_CRS; encoding <= SNOW_ENCODING_RLE;
             encoding++) {
            b.rows = 1 + draw(&random, 70);
            begin_bands(&b, (snow_encoding)encoding, &random);
            for (int n = 0; n < 12 * (int)COUNT(levels); n++) {
                snow_isa isa = levels[(size_t)n % COUNT(levels)];
                int count = 1 + draw(&random, SNOW_DECODE_ROWS);
                int64_t first = draw(&random, b.rows + count) - count;
                if (snow_isa_runs(isa))
                    check_read(&b, isa, draw(&random, SLICES), first,
                               draw_mask(&random, count) | 1);
            }
            end_bands(&b);
        }
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
    FNMA,
    SET1,
    ALPHA2,
    ALPHA4,
    WITH_ALPHA2,
    WITH_ALPHA4,
    GATHER4,
    GATHER2,
    WORDS
};

#define ENTRIES 50

typedef struct word_input {
    float a[16], b[16], c[16];
    float table[ENTRIES * 4];
    uint32_t pairs[ENTRIES], entries[16];
    uint8_t bytes[32];
    uint16_t shorts[32], others[32];
    float whole[16]; /* 0 to 1e5 */
    uint8_t many[64];
    uint32_t bits;
    uint64_t mask, low[8], high[8], within;
    int64_t at[16]; /* of pixels of the table */
    unsigned shift;
} word_input;

typedef struct word_output {
    float lanes[WORDS][16];
    float interleave2[32], interleave4[32];
    float hadd2[4][4], hadd4[4][4];
    bool less[4];
    int lane_count, popcount;
    uint32_t expand8[16], expand16[16], widen8[16], widen16[16];
    float low[16], high[16], spread2[16 * 2 + 16], spread4[16 * 4 + 16];
    float left2[16], right2[16], left4[16], right4[16];
    uint64_t windows[8], turned[8];
    unsigned found, above;
    uint16_t least[4];
} word_output;

#define TEMPLATE "reference/shear_warp_operations.tmpl.h"
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
    case FNMA:
        return fused ? fmaf(-a, b, c) : c - product;
    case SET1:
        return in->a[3];
    case ALPHA2:
        return in->a[i | 1];
    case ALPHA4:
        return in->a[i | 3];
    case WITH_ALPHA2:
        return i % 2 == 1 ? b : a;
    case WITH_ALPHA4:
        return i % 4 == 3 ? b : a;
    case GATHER4:
        return in->table[in->entries[i / 4] * 4 + (uint32_t)i % 4];
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
            float expected = plain_word(in, (enum word)word, i, fused);
            if (!same_float(out->lanes[word][i], expected))
                fail_msg("%s: word %d gives %.9g in lane %d, not %.9g", name,
                         word, (double)out->lanes[word][i], i,
                         (double)expected);
        }
    for (int i = 0; i < 32; i++) {
        const float *two = i / 2 % 2 ? in->b : in->a;
        const float *four = i / 4 % 2 ? in->b : in->a;
        assert_true(same_float(out->interleave2[i], two[i / 4 * 2 + i % 2]));
        assert_true(same_float(out->interleave4[i], four[i / 8 * 4 + i % 4]));
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
    int lanes = out->lane_count;
    for (int n = 0; n < 16 / lanes; n++) {
        float two[16], four[16];
        bool less = false;
        memcpy(two, in->a + n * lanes, (size_t)lanes * sizeof *two);
        memcpy(four, in->a + n * lanes, (size_t)lanes * sizeof *four);
        fold(two, lanes, 2);
        fold(four, lanes, 4);
        for (int i = 0; i < lanes; i++)
            less |= in->a[n * lanes + i] < in->b[n * lanes + i];
        for (int i = 0; i < 4; i++)
            if (!same_float(out->hadd4[n][i], four[i]) ||
                (i < 2 && !same_float(out->hadd2[n][i], two[i])))
                fail_msg("%s: a fold differs in lane %d", name, i);
        if (out->less[n] != less)
            fail_msg("%s: any_less is %d", name, out->less[n]);
    }
}

static void check_bits(const word_input *in, const word_output *out,
                       const char *name) {
    int next = 0, bits = 0;
    for (int i = 0; i < 16; i++) {
        bool here = in->bits >> i & 1;
        uint32_t byte = here ? in->bytes[next] + 1u : 0;
        uint32_t word = here ? in->shorts[next] + 1u : 0;
        for (int c = 0; c < 4; c++) {
            float two = here ? in->table[2 * next + c] : 0;
            float four = here ? in->table[4 * next + c] : 0;
            assert_true((c >= 2 || out->spread2[2 * i + c] == two) &&
                        out->spread4[4 * i + c] == four);
        }
        uint32_t pair = in->pairs[in->entries[i]];
        assert_true(out->low[i] == (float)(pair & 0xFFFF) &&
                    out->high[i] == (float)(pair >> 16));
        assert_true(out->widen8[i] == in->bytes[i] &&
                    out->widen16[i] == in->shorts[i]);
        next += here;
        if (out->expand8[i] != byte || out->expand16[i] != word)
            fail_msg("%s: bits %x expand to %u and %u at %d, not %u and %u",
                     name, in->bits, out->expand8[i], out->expand16[i], i, byte,
                     word);
    }
    for (int i = 0; i < 64; i++)
        bits += (int)(in->mask >> i & 1);
    assert_int_equal(out->popcount, bits);
}

static void check_windows(const word_input *in, const word_output *out) {
    for (int n = 0; n < 8; n++) {
        uint64_t window = in->low[n] >> in->shift;
        if (in->shift)
            window |= in->high[n] << (64 - in->shift);
        window &= in->within;
        assert_true(out->windows[n] == window);
        assert_int_equal(out->found >> n & 1, window != 0);
    }
}

static void check_pixels(const word_input *in, const word_output *out,
                         const char *name) {
    for (int i = 0; i < 16; i++) {
        const float *two = in->table + in->at[i / 2] + i % 2;
        const float *four = in->table + in->at[i / 4] + i % 4;
        if (out->left2[i] != two[0] || out->right2[i] != two[2] ||
            out->left4[i] != four[0] || out->right4[i] != four[4])
            fail_msg("%s: pixels apart differ in lane %d", name, i);
    }
}

static void check_numbers(const word_input *in, const word_output *out,
                          const char *name) {
    for (int i = 0; i < 4; i++) {
        const float *four = in->whole + 4 * i;
        double least = fmin(fmin((double)four[0], (double)four[1]),
                            fmin((double)four[2], (double)four[3]));
        if (out->least[i] != (uint16_t)fmin(rint(least), 65535))
            fail_msg("%s: the least of four is %u, not %g", name, out->least[i],
                     least);
    }
    for (int i = 0; i < 8; i++) {
        bool above = false;
        for (int n = 4 * i; n < 4 * i + 4; n++)
            above |= in->shorts[n] > in->others[n];
        if ((out->above >> i & 1) != above)
            fail_msg("%s: above32 is %x", name, out->above);
    }
    for (int i = 0; i < 512; i++)
        if ((out->turned[i / 64] >> i % 64 & 1) !=
            (in->many[i % 64] >> i / 64 & 1))
            fail_msg("%s: turn64 loses bit %d of byte %d", name, i / 64,
                     i % 64);
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
    for (int i = 0; i < ENTRIES; i++)
        in->pairs[i] = (uint32_t)(support_random(random) >> 32);
    for (int i = 0; i < 16; i++)
        in->entries[i] = (uint32_t)draw(random, ENTRIES);
    for (int i = 0; i < 32; i++) {
        in->bytes[i] = (uint8_t)draw(random, 256);
        in->shorts[i] = (uint16_t)draw(random, 65536);
        int more = in->shorts[i] + draw(random, 8) - 1;
        in->others[i] = (uint16_t)(more < 0 ? 0 : more > 65535 ? 65535 : more);
    }
    for (int i = 0; i < 16; i++)
        in->whole[i] = (float)draw(random, 200000) / 2;
    for (int i = 0; i < 64; i++)
        in->many[i] = (uint8_t)draw(random, 256);
    in->bits = (uint32_t)draw_mask(random, 16);
    in->mask = draw_mask(random, 64);
    for (int i = 0; i < 8; i++) {
        in->low[i] = draw_mask(random, 64);
        in->high[i] = draw_mask(random, 64);
    }
    in->within = (UINT64_C(1) << draw(random, 64)) - 1;
    in->shift = (unsigned)draw(random, 64);
    for (int i = 0; i < 16; i++)
        in->at[i] = 2 * draw(random, ENTRIES * 2 - 3);
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
            check_bits(&in, &out, name);
            check_windows(&in, &out);
            check_pixels(&in, &out, name);
            check_numbers(&in, &out, name);
        }
    }
}

/* --- combs ---------------------------------------------------------------- */

/* A comb's weights are the kernel's, wherever a slice lies. */
static void combs_hold_the_kernel(void **state) {
    (void)state;
    uint64_t random = 6;
    for (int n = 0; n < 20000; n++) {
        snow_lattice lattice = {0};
        snow_comb comb;
        draw_lattice(&lattice, draw(&random, 3));
        lattice.slope = draw(&random, 4) ? 2 * support_uniform(&random) - 1
                                         : draw(&random, 3) * 0.5;
        snow_scaled_kernel taper = snow_scaled_kernel_make(
            (snow_kernel)draw(&random, 4), 2 + draw(&random, 8),
            draw(&random, 3) ? 3 * support_uniform(&random) : 1);
        int taps = snow_comb_taps(&taper);
        if (taps > SNOW_TAPS_MOST)
            continue;
        double slice = draw(&random, 400) * 0.5;
        snow_comb_make(&taper, &lattice, slice, &comb);
        assert_int_equal(comb.lead[0], 0);
        for (int phase = 0; phase < lattice.phases; phase++) {
            double sum = 0;
            double at = (double)phase / lattice.phases - slice * lattice.slope;
            assert_in_range(comb.lead[phase], 0, 1);
            for (int m = 0; m < taps; m++) {
                double voxel = (double)(comb.offset + comb.lead[phase] + m);
                double weight = (double)comb.weights[phase][m];
                assert_true(fabs(weight - snow_scaled_kernel_weight(
                                              &taper, at - voxel)) < 1e-6);
                sum += weight;
            }
            assert_true(fabs(sum - 1) < 1e-6);
        }
    }
}

/* A row of noise, of spikes, or smooth. */
#define BOUND_VOXELS 96
static void draw_voxels(float *voxels, uint64_t *random) {
    int kind = draw(random, 3);
    double phase = 6 * support_uniform(random);
    for (int n = 0; n < BOUND_VOXELS; n++) {
        double noise = support_uniform(random);
        voxels[n] = (float)(kind == 0   ? noise
                            : kind == 1 ? noise > 0.8
                                        : 0.5 + 0.5 * sin(phase + 0.7 * n));
    }
}

/* What sheets of cubic B-splines of any width may reach at most: the bounds of
 * the places between all voxels of a pixel but the first and the last. */
static void sheets_stay_below_their_bounds(void **state) {
    (void)state;
    uint64_t random = 9;
    double nearest = 1;
    for (int n = 0; n < 60000; n++) {
        const snow_row_fns *fns =
            snow_row_fns_of(snow_isa_resolve(SNOW_ISA_AUTO));
        float voxels[BOUND_VOXELS], bounds[BOUND_VOXELS] = {0};
        snow_lattice lattice = {.phases = 1, .stride = 1};
        snow_comb comb;
        lattice.slope = support_uniform(&random);
        snow_scaled_kernel taper = snow_scaled_kernel_make(
            SNOW_KERNEL_BSPLINE, 4,
            draw(&random, 3) ? 1 + 8 * support_uniform(&random) : 1);
        int taps = snow_comb_taps(&taper);
        snow_comb_make(&taper, &lattice, 1, &comb);
        draw_voxels(voxels, &random);
        const float *rows[4] = {voxels, voxels + 1, voxels + 2, voxels + 3};
        fns->hull(rows, BOUND_VOXELS - 3, bounds);
        int first = draw(&random, BOUND_VOXELS - taps + 1);
        double sheet = 0, bound = 0;
        for (int m = 0; m < taps; m++)
            sheet += (double)comb.weights[0][m] * (double)voxels[first + m];
        for (int m = 0; m < taps - 3; m++)
            bound = fmax(bound, (double)bounds[first + m]);
        if (sheet > bound * 1.000001)
            fail_msg("%d voxels add up to %.9g, above %.9g", taps, sheet,
                     bound);
        nearest = fmin(nearest, 1 - sheet / bound);
    }
    assert_true(nearest < 1e-6); /* no more than is needed */
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

typedef struct timed_tile {
    snow_tile tile;
    int channels;
} timed_tile;

static void call_tile(void *user, snow_isa isa) {
    timed_tile *t = user;
    snow_tile_of(isa, t->channels)(&t->tile);
}

static void time_tile(int lattice, int taps, int channels) {
    uint64_t random = 7;
    tile_case t = draw_tile(lattice * 4, channels, taps, taps, &random);
    static float ring[SNOW_TILE_ROWS * 2 * SNOW_TILE_COLUMNS * 4], zero[128];
    char name[64];
    for (size_t n = 0; n < SNOW_TILE_ROWS * t.window; n++)
        t.samples[n] = 0.001f;
    t.held = ~UINT64_C(0);
    t.wanted = ~UINT64_C(0) >> (64 - t.cells);
    timed_tile timed = {{&t.u, &t.v, &t.comb_u, &t.comb_v, taps, taps,
                         t.samples, t.window, t.held, t.wanted, ring, zero,
                         t.before, t.line},
                        channels};
    snprintf(name, sizeof name, "tile %d taps %d cells %d/%d %dch", taps,
             t.cells, t.u.phases, t.u.stride, channels);
    time_kernel(name, call_tile, &timed);
    free_tile(&t);
}

static void call_sample(void *user, snow_isa isa) {
    static float out[(SNOW_SAMPLE_ROWS * SNOW_WINDOW_MOST + 8) * 4];
    static snow_sample_room room;
    const sample_case *s = user;
    make_samples(s, isa, (size_t)((s->count + 3) / 4 * 4 * s->channels), &room,
                 out);
}

static void call_windows(void *user, snow_isa isa) {
    window_case *w = user;
    uint64_t bits[SNOW_DECODE_ROWS];
    uint32_t before[SNOW_DECODE_ROWS];
    snow_decode_fns_of(isa)->windows(&w->rows, w->wanted, w->column, w->count,
                                     bits, before);
}

typedef struct timed_read {
    band_case bands;
    window_case window;
} timed_read;

static void call_read(void *user, snow_isa isa) {
    timed_read *t = user;
    snow_span spans[66];
    snow_decode_fns_of(isa)->read(&t->bands.bands, 0, 16, ~UINT64_C(0) >> 28,
                                  spans, &t->window.rows);
}

static void time_windows(uint64_t *random) {
    static const char *const names[] = {"crs", "bitmap", "rle"};
    static timed_read t;
    draw_rows(&t.window, 130, random);
    rank_rows(&t.window);
    t.window.rows.held = ~UINT64_C(0) >> 28;
    t.window.wanted = ~UINT64_C(0);
    t.window.count = 20;
    t.window.column = 55;
    static uint64_t any[8];
    t.window.rows.any = any;
    time_kernel("windows of 36 rows", call_windows, &t.window);
    for (int n = 0; n < 3; n++) {
        char name[64];
        t.bands.columns = 130;
        t.bands.rows = 70;
        begin_bands(&t.bands, (snow_encoding)(SNOW_ENCODING_CRS + n), random);
        snprintf(name, sizeof name, "read 36 rows of 130 from %s", names[n]);
        time_kernel(name, call_read, &t);
        end_bands(&t.bands);
    }
}

static void call_warp(void *user, snow_isa isa) {
    warp_case *w = user;
    float out[40 * 4];
    snow_warp_of(isa, w->filter, w->plane.channels)(&w->plane, &w->line,
                                                    w->first, w->count, out);
}

static void time_samples(uint64_t *random) {
    static sample_case s;
    for (int kind = 0; kind < 8; kind++) {
        char name[64];
        s.code_bytes = 1 + kind % 2;
        s.channels = kind / 2 % 2 ? 4 : 2;
        s.shaded = kind / 4;
        make_tables(&s, random);
        draw_sample(&s, 17, random);
        s.held = 0xFFFFF;
        for (int row = 0; row < SNOW_SAMPLE_ROWS; row++)
            s.bits[row] = support_random(random) >> 47;
        snprintf(name, sizeof name, "20 x 17 samples of %d bytes %dch %s",
                 s.code_bytes, s.channels, s.shaded ? "shaded" : "plain");
        time_kernel(name, call_sample, &s);
        free_tables(&s);
    }
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
    for (int channels = 2; channels <= 4; channels += 2) {
        time_tile(0, 4, channels);
        time_tile(1, 4, channels);
        time_tile(1, 2, channels);
        time_tile(1, 6, channels);
        time_tile(1, 8, channels);
        time_tile(2, 12, channels);
    }
    time_samples(&random);
    time_windows(&random);
    time_warps(&random);
    return 0;
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles_of_every_lattice_and_number_of_taps),
        cmocka_unit_test(pixels_are_cleared_and_finished),
        cmocka_unit_test(samples_of_every_window),
        cmocka_unit_test(windows_at_every_column),
        cmocka_unit_test(rows_of_bands_are_read_as_bits),
        cmocka_unit_test(lines_through_every_plane),
        cmocka_unit_test(words_mean_what_they_say),
        cmocka_unit_test(combs_hold_the_kernel),
        cmocka_unit_test(sheets_stay_below_their_bounds),
    };
    if (argc > 1 && strcmp(argv[1], "--time") == 0)
        return time_all();
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
