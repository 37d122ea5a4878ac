/* tests/stages/test_bands.c - the bands of the sheared method hold what a plain
 * loop over the volume finds: spans, codes and normals, for every type, axis,
 * scheme, density, level of instructions and number of threads. */
#include "support/support.h"

#include "encode/bands/bands.h"
#include "simd/isa.h"

#include <math.h>

/* --- a volume and what a plain loop finds in it --------------------------- */

typedef struct scene {
    snow_context *context;
    snow_volume *volume;
    unsigned char *voxels;
    snow_transfer *transfer;
    snow_quantizer quantizer;
    snow_normal_maker maker;
    snow_placement placement;
} scene;

/* Where interesting voxels lie. */
typedef enum pattern {
    NOTHING,
    TINY, /* a few voxels */
    SOME, /* half of them, at random */
    MOST, /* all but a few */
    ALL,
    STREAKS, /* runs of up to 700 voxels along x */
    PATTERNS
} pattern;

/* Values 0 to 255 of which 100 to 180 are interesting. */
static int random_value(pattern kind, uint64_t *seed, int *run, bool *on) {
    int one = 100 + (int)(support_random(seed) % 81);
    int other = (int)(support_random(seed) % 175);
    other = other < 100 ? other : other + 81;
    uint64_t dice = support_random(seed) % 1000;
    switch (kind) {
    case NOTHING:
        return other;
    case TINY:
        return dice < 7 ? one : other;
    case SOME:
        return dice < 500 ? one : other;
    case MOST:
        return dice < 985 ? one : other;
    case ALL:
        return one;
    default:
        if (!*run) {
            *run = (int)(support_random(seed) % 700) + 1;
            *on = !*on;
        }
        --*run;
        return *on ? one : other;
    }
}

/* The interval of interesting data values in native ones: 8-bit types take the
 * values as they are (int8 less 128), wider ones times 50 less an offset. */
static double native_of(snow_type type, int value) {
    switch (type) {
    case SNOW_TYPE_UINT8:
        return value;
    case SNOW_TYPE_INT8:
        return value - 128;
    case SNOW_TYPE_INT16:
    case SNOW_TYPE_INT32:
    case SNOW_TYPE_INT64:
        return value * 101 - 13000;
    case SNOW_TYPE_UINT16:
    case SNOW_TYPE_UINT32:
    case SNOW_TYPE_UINT64:
        return value * 101;
    default:
        return value * 0.37 - 20.5;
    }
}

static void store(void *voxels, snow_type type, size_t at, double native) {
    switch (type) {
#define STORE(name, ctype, text)               \
    case SNOW_TYPE_##name:                     \
        ((ctype *)voxels)[at] = (ctype)native; \
        break;
        SNOW_TYPE_MAP(STORE)
#undef STORE
    case SNOW_TYPE_NONE:
        break;
    }
}

/* Steps of opacity at the ends of so many intervals that fill the interesting
 * range, with a hole of a value between each two. */
static snow_transfer *make_transfer(snow_context *context, snow_type type,
                                    int intervals) {
    snow_color_point color = {0, 1, 0.5, 0.25};
    snow_opacity_point points[200] = {{native_of(type, 0) - 1, 0}};
    size_t count = 1;
    int width = 81 / intervals;
    for (int n = 0; n < intervals; n++) {
        double gap = native_of(type, 1) - native_of(type, 0);
        double first = native_of(type, 100 + n * width) - 0.3 * gap;
        bool last = n + 1 == intervals;
        int end = last ? 180 : 100 + (n + 1) * width - 1;
        double past = native_of(type, end) + (last ? 0.3 : -0.3) * gap;
        points[count++] = (snow_opacity_point){first, 0};
        points[count++] = (snow_opacity_point){first, 0.5};
        points[count++] = (snow_opacity_point){past, 0.75};
        points[count++] = (snow_opacity_point){past, 0};
    }
    snow_transfer *transfer;
    assert_int_equal(
        snow_transfer_new(context, &color, 1, points, count, &transfer),
        SNOW_STATUS_OK);
    return transfer;
}

static void place(snow_placement *p, const int64_t dims[3], int axis) {
    p->slice_axis = axis;
    p->u_axis = axis == 0 ? 1 : 0;
    p->v_axis = axis == 2 ? 1 : 2;
    p->columns = dims[p->u_axis];
    p->rows = dims[p->v_axis];
    p->slices = dims[axis];
}

/* A scene whose slices have these columns and rows. */
static scene make_scene(snow_context *context, snow_type type, int axis,
                        int64_t columns, int64_t rows, int64_t slices,
                        pattern kind, int intervals, uint64_t seed) {
    scene s = {.context = context};
    snow_volume_info info = {.size = sizeof info, .type = type};
    info.dims[axis] = slices;
    info.dims[axis == 0 ? 1 : 0] = columns;
    info.dims[axis == 2 ? 1 : 2] = rows;
    size_t count = (size_t)(columns * rows * slices);
    /* Of this very size, so that a sanitizer sees what is read beyond. */
    s.voxels = malloc(count * snow_type_size(type));
    assert_non_null(s.voxels);
    int run = 0;
    bool on = false;
    for (size_t n = 0; n < count; n++)
        store(s.voxels, type, n,
              native_of(type, random_value(kind, &seed, &run, &on)));
    bool real = type == SNOW_TYPE_FLOAT32 || type == SNOW_TYPE_FLOAT64;
    for (size_t n = 17; real && n < count; n += 1001)
        store(s.voxels, type, n, n % 2 ? (double)NAN : (double)INFINITY);
    assert_int_equal(snow_volume_wrap(context, &info, s.voxels, &s.volume),
                     SNOW_STATUS_OK);
    s.transfer = make_transfer(context, type, intervals);
    assert_int_equal(
        snow_quantizer_make(context, s.volume, s.transfer, 10, &s.quantizer),
        SNOW_STATUS_OK);
    assert_int_equal(snow_normal_maker_init(context, s.volume, &s.maker),
                     SNOW_STATUS_OK);
    place(&s.placement, info.dims, axis);
    return s;
}

static void free_scene(scene *s) {
    snow_quantizer_fini(s->context, &s->quantizer);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    free(s->voxels);
}

/* The native value of a voxel of a slice; of odd slices with `between` the
 * mean, halves of integers rounded up. */
static double value_at(const scene *s, bool between, int64_t slice, int64_t row,
                       int64_t column) {
    const snow_placement *p = &s->placement;
    const int64_t *dims = s->volume->info.dims;
    int64_t at[3];
    at[p->u_axis] = column;
    at[p->v_axis] = row;
    at[p->slice_axis] = between ? slice / 2 : slice;
    double a = snow_volume_native(s->volume,
                                  at[0] + dims[0] * (at[1] + dims[1] * at[2]));
    if (!between || slice % 2 == 0)
        return a;
    at[p->slice_axis]++;
    double b = snow_volume_native(s->volume,
                                  at[0] + dims[0] * (at[1] + dims[1] * at[2]));
    switch (s->volume->info.type) {
    case SNOW_TYPE_FLOAT32:
        return (float)((a + b) / 2);
    case SNOW_TYPE_FLOAT64:
        return (a + b) / 2;
    default:
        return floor((a + b + 1) / 2);
    }
}

static snow_bands_params order_of(const scene *s, snow_encoding encoding) {
    return (snow_bands_params){.volume = s->volume,
                               .placement = &s->placement,
                               .quantizer = &s->quantizer,
                               .encoding = encoding,
                               .slice_count = s->placement.slices,
                               .isa = SNOW_ISA_SCALAR,
                               .threads = 1};
}

/* --- bands against the plain loop ----------------------------------------- */

/* A row by a plain loop: its columns and codes. */
static size_t plain_row(const scene *s, const snow_bands_params *order,
                        int64_t slice, int64_t row, uint32_t *columns,
                        uint16_t *codes) {
    int64_t doubled = order->first_slice * (order->between ? 2 : 1) + slice;
    size_t count = 0;
    for (int64_t column = 0; column < s->placement.columns; column++) {
        double value = value_at(s, order->between, doubled, row, column);
        columns[count] = (uint32_t)column;
        if (isfinite(value) &&
            snow_quantizer_code(&s->quantizer, value, codes + count))
            count++;
    }
    return count;
}

static void plain_normals(const snow_bands_params *order, int64_t slice,
                          int64_t row, const uint32_t *columns, size_t count,
                          uint16_t *normals) {
    bool doubled = order->between;
    int64_t here = order->first_slice + (doubled ? slice / 2 : slice);
    snow_normals_of_row(order->maker, order->placement, here, row,
                        doubled && slice % 2, columns, count, normals);
}

static uint16_t code_at(const snow_sparse *band, size_t voxel) {
    const unsigned char *code = snow_bands_codes(band, voxel);
    uint16_t wide;
    if (band->code_bytes == 1)
        return *code;
    memcpy(&wide, code, sizeof wide);
    return wide;
}

/* Spans are maximal, and those of the columns. */
static void check_spans(const snow_span *spans, size_t count,
                        const uint32_t *columns, size_t voxels) {
    size_t n = 0;
    for (size_t i = 0; i < count; i++) {
        assert_true(spans[i].length > 0);
        if (i)
            assert_true(spans[i].column >
                        spans[i - 1].column + spans[i - 1].length);
        for (uint32_t k = 0; k < spans[i].length; k++, n++) {
            assert_true(n < voxels);
            assert_int_equal(spans[i].column + k, columns[n]);
        }
    }
    assert_int_equal(n, voxels);
}

/* One slice of a band; returns its voxels.  `skip` rows are passed over before
 * each one that is read. */
static size_t check_slice(const scene *s, const snow_bands *bands,
                          const snow_bands_params *order, int64_t number,
                          int64_t slice, int64_t skip) {
    const snow_sparse *band = &bands->bands[number];
    size_t room = (size_t)bands->columns;
    uint32_t *columns = malloc(room * sizeof *columns);
    uint16_t *codes = malloc(room * sizeof *codes);
    uint16_t *normals = malloc(room * sizeof *normals);
    snow_span *spans = malloc((room / 2 + 1) * sizeof *spans);
    assert_true(columns && codes && normals && spans);
    snow_walk walk;
    snow_walk_begin(&walk, band, slice);
    size_t expected = (size_t)band->pa[slice].ia, voxels = 0;
    int64_t first = number * SNOW_BAND_ROWS;
    for (int64_t row = 0; row < band->rows; row++) {
        size_t count = plain_row(s, order, slice, first + row, columns, codes),
               voxel;
        if (skip && row % (skip + 1) == 0) {
            int64_t rows = row + skip < band->rows ? skip : band->rows - row;
            snow_walk_skip(&walk, rows);
        }
        if (skip && row % (skip + 1) != skip) {
            expected += count;
            continue;
        }
        size_t span_count = snow_walk_row(&walk, spans, &voxel);
        check_spans(spans, span_count, columns, count);
        assert_int_equal(voxel, expected);
        for (size_t n = 0; n < count; n++)
            assert_int_equal(code_at(band, voxel + n), codes[n]);
        if (order->maker && count) {
            plain_normals(order, slice, first + row, columns, count, normals);
            assert_memory_equal(snow_bands_normals(band, voxel), normals,
                                count * sizeof *normals);
        }
        expected += count;
        voxels += count;
    }
    assert_int_equal(expected, band->pa[slice + 1].ia);
    free(columns);
    free(codes);
    free(normals);
    free(spans);
    return voxels;
}

static void check_bands(const scene *s, const snow_bands *bands,
                        const snow_bands_params *order) {
    int64_t slices = order->slice_count;
    if (order->between && slices)
        slices = 2 * slices - 1;
    assert_int_equal(bands->slices, slices);
    assert_int_equal(bands->band_count,
                     (s->placement.rows + SNOW_BAND_ROWS - 1) / SNOW_BAND_ROWS);
    uint64_t voxels = 0, ea = 0;
    for (int64_t number = 0; number < bands->band_count; number++) {
        for (int64_t slice = slices - 1; slice >= 0; slice--)
            voxels += check_slice(s, bands, order, number, slice, 0);
        ea += bands->bands[number].ea_bytes;
    }
    assert_int_equal(bands->voxels, voxels);
    assert_int_equal(bands->ea_bytes, ea);
    uint64_t size = (uint64_t)s->quantizer.bytes + (order->maker ? 2 : 0);
    assert_int_equal(bands->ia_bytes, voxels * size);
    assert_int_equal(bands->pa_bytes,
                     (uint64_t)bands->band_count * ((uint64_t)slices + 1) * 16);
}

/* Encodes and checks. */
static void encode_and_check(const scene *s, const snow_bands_params *order,
                             snow_bands *bands) {
    assert_int_equal(snow_bands_encode(bands, order), SNOW_STATUS_OK);
    check_bands(s, bands, order);
}

/* Whether two encodings are the same in every byte. */
static void assert_same(const snow_bands *a, const snow_bands *b) {
    assert_int_equal(a->band_count, b->band_count);
    assert_int_equal(a->encoding, b->encoding);
    for (int64_t n = 0; n < a->band_count; n++) {
        const snow_sparse *p = &a->bands[n], *q = &b->bands[n];
        assert_int_equal(p->ea_bytes, q->ea_bytes);
        assert_int_equal(p->ia_voxels, q->ia_voxels);
        if (p->ea_bytes)
            assert_memory_equal(p->ea, q->ea, p->ea_bytes);
        if (p->ia_voxels)
            assert_memory_equal(p->codes, q->codes,
                                p->ia_voxels * (size_t)p->code_bytes);
        if (p->ia_voxels && a->with_normals)
            assert_memory_equal(p->normals, q->normals, p->ia_voxels * 2);
        assert_memory_equal(p->pa, q->pa,
                            ((size_t)a->slices + 1) * sizeof *p->pa);
    }
}

static const snow_encoding schemes[] = {SNOW_ENCODING_CRS, SNOW_ENCODING_BITMAP,
                                        SNOW_ENCODING_RLE};

/* --- tests ---------------------------------------------------------------- */

static void all_types_axes_schemes_and_patterns_hold_the_volume(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (snow_type type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++)
        for (int axis = 0; axis < 3; axis++)
            for (int kind = 0; kind < PATTERNS; kind++) {
                scene s = make_scene(context, type, axis, 83, 37, 5,
                                     (pattern)kind, 1, 77 + (uint64_t)kind);
                for (int e = 0; e < 3; e++) {
                    snow_bands_params order = order_of(&s, schemes[e]);
                    order.maker = e == 1 ? &s.maker : NULL;
                    encode_and_check(&s, &order, &bands);
                }
                free_scene(&s);
            }
    snow_bands_fini(&bands);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* Columns 1 to 130, rows 1 to 70, and more slices than a line of voxels. */
static void every_tail_of_a_row_and_a_band_is_right(void **state) {
    (void)state;
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32};
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (int64_t columns = 1; columns <= 130;
         columns += (int64_t)support_stride(5))
        for (int axis = 0; axis < 3; axis++) {
            int64_t rows = (columns * 29 + axis) % 70 + 1;
            pattern kind = (pattern)((columns + axis) % PATTERNS);
            snow_type type = types[columns % 3];
            int64_t slices = columns % 13 == 0 ? 67 : 3;
            scene s = make_scene(context, type, axis, columns, rows, slices,
                                 kind, 1, (uint64_t)columns);
            for (int e = 0; e < 3; e++) {
                snow_bands_params order = order_of(&s, schemes[e]);
                encode_and_check(&s, &order, &bands);
            }
            free_scene(&s);
        }
    snow_bands_fini(&bands);
    snow_context_free(context);
}

static void long_rows_hold_runs_of_any_length(void **state) {
    (void)state;
    static const int64_t widths[] = {255, 256, 257, 509, 510, 511, 1031, 4999};
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++)
        for (int kind = 0; kind < PATTERNS; kind++) {
            scene s = make_scene(context, SNOW_TYPE_UINT8, 2, widths[w], 33, 2,
                                 (pattern)kind, 1, w);
            for (int e = 0; e < 3; e++) {
                snow_bands_params order = order_of(&s, schemes[e]);
                encode_and_check(&s, &order, &bands);
            }
            free_scene(&s);
        }
    snow_bands_fini(&bands);
    snow_context_free(context);
}

/* Up to 16 intervals of codes are compared, more go through a table. */
static void any_number_of_intervals_is_kept(void **state) {
    (void)state;
    static const int intervals[] = {1, 2, 16, 17, 27};
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT8,
                                      SNOW_TYPE_UINT16, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT64};
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (size_t n = 0; n < sizeof intervals / sizeof *intervals; n++)
        for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
            scene s = make_scene(context, types[t], 2, 200, 40, 2, ALL,
                                 intervals[n], n + t);
            if (s.quantizer.keep)
                assert_int_equal(s.quantizer.run_count,
                                 intervals[n] > 16 ? -1 : intervals[n]);
            for (int isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++) {
                snow_bands_params order = order_of(&s, SNOW_ENCODING_BITMAP);
                order.isa = (snow_isa)isa;
                if (snow_isa_runs(order.isa))
                    encode_and_check(&s, &order, &bands);
            }
            free_scene(&s);
        }
    snow_bands_fini(&bands);
    snow_context_free(context);
}

static void levels_and_threads_change_no_byte(void **state) {
    (void)state;
    static const int threads[] = {1, 2, 5};
    snow_context *context = support_context();
    for (int round = 0; round < 120; round += (int)support_stride(7)) {
        snow_type type = (snow_type)(SNOW_TYPE_INT8 + round % 10);
        int64_t columns = 1 + (round * 37) % 300;
        scene s = make_scene(context, type, round % 3, columns,
                             1 + (round * 53) % 150, 1 + round % 71,
                             (pattern)(round % PATTERNS), 1 + round % 20,
                             (uint64_t)round);
        snow_bands first = {.context = context};
        snow_bands_params order = order_of(&s, (snow_encoding)(round % 4));
        order.maker = round % 2 ? &s.maker : NULL;
        order.between = round % 5 == 0;
        assert_int_equal(snow_bands_encode(&first, &order), SNOW_STATUS_OK);
        for (int isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++)
            for (int t = 0; t < 3; t++) {
                snow_bands bands = {.context = context};
                order.isa = (snow_isa)isa;
                order.threads = threads[t];
                /* More threads than processors are slow: not every time. */
                if (!snow_isa_runs(order.isa) || (t && (round + isa) % 4))
                    continue;
                assert_int_equal(snow_bands_encode(&bands, &order),
                                 SNOW_STATUS_OK);
                assert_same(&first, &bands);
                snow_bands_fini(&bands);
            }
        snow_bands_fini(&first);
        free_scene(&s);
    }
    snow_context_free(context);
}

static void a_slab_holds_its_slices_only(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (int axis = 0; axis < 3; axis++) {
        scene s =
            make_scene(context, SNOW_TYPE_UINT8, axis, 70, 40, 150, SOME, 1, 5);
        for (int64_t first = 0; first < 150; first += 47)
            for (int64_t count = 0; first + count <= 150; count += 51) {
                snow_bands_params order = order_of(&s, SNOW_ENCODING_BITMAP);
                order.first_slice = first;
                order.slice_count = count;
                order.maker = &s.maker;
                encode_and_check(&s, &order, &bands);
            }
        free_scene(&s);
    }
    snow_bands_fini(&bands);
    snow_context_free(context);
}

static void slices_between_are_means(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (snow_type type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++)
        for (int axis = 0; axis < 3; axis++) {
            int64_t slices = axis == 0 ? 131 : 4;
            scene s =
                make_scene(context, type, axis, 67, 35, slices, SOME, 1, 9);
            for (int64_t first = 0; first < 2; first++) {
                snow_bands_params order = order_of(&s, SNOW_ENCODING_CRS);
                order.between = true;
                order.maker = &s.maker;
                order.first_slice = first;
                order.slice_count = slices - 2 * first;
                encode_and_check(&s, &order, &bands);
            }
            free_scene(&s);
        }
    snow_bands_fini(&bands);
    snow_context_free(context);
}

/* Rows are skipped in steps of 1 to all, and one row after each step read. */
static void skipping_rows_is_walking_them(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (int kind = 0; kind < PATTERNS; kind++)
        for (int e = 0; e < 3; e++) {
            scene s = make_scene(context, SNOW_TYPE_UINT8, 2, 301, 70, 2,
                                 (pattern)kind, 1, 3);
            snow_bands_params order = order_of(&s, schemes[e]);
            encode_and_check(&s, &order, &bands);
            for (int64_t band = 0; band < bands.band_count; band++)
                for (int64_t skip = 1; skip <= 32; skip++)
                    check_slice(&s, &bands, &order, band, 1, skip);
            free_scene(&s);
        }
    snow_bands_fini(&bands);
    snow_context_free(context);
}

static void what_is_empty_takes_no_bytes(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    scene s =
        make_scene(context, SNOW_TYPE_UINT8, 2, 256, 64, 4, NOTHING, 1, 3);
    for (int e = 0; e < 3; e++) {
        snow_bands_params order = order_of(&s, schemes[e]);
        encode_and_check(&s, &order, &bands);
        assert_int_equal(bands.ea_bytes, 0);
        assert_int_equal(bands.ia_bytes, 0);
    }
    free_scene(&s);
    snow_bands_fini(&bands);
    snow_context_free(context);
}

/* One voxel in a band's slice of 256 x 32. */
static void a_sparse_slice_takes_few_bytes(void **state) {
    (void)state;
    static const uint64_t bytes[] = {4 + 2, 16 + 8, 4 + 3};
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    scene s =
        make_scene(context, SNOW_TYPE_UINT8, 2, 256, 32, 1, NOTHING, 1, 3);
    s.voxels[1000] = 150;
    for (int e = 0; e < 3; e++) {
        snow_bands_params order = order_of(&s, schemes[e]);
        encode_and_check(&s, &order, &bands);
        assert_int_equal(bands.voxels, 1);
        assert_int_equal(bands.ea_bytes, bytes[e]);
    }
    free_scene(&s);
    snow_bands_fini(&bands);
    snow_context_free(context);
}

/* The drawings of crs.c, bitmap.c and rle.c: a row of 600 columns. */
static void the_bytes_of_a_row_are_those_of_the_drawings(void **state) {
    (void)state;
    static const struct {
        snow_encoding encoding;
        size_t size;
        unsigned char bytes[32];
    } cases[] = {
        {SNOW_ENCODING_CRS, 9, {0x6, 1, 44, 45, 3, 77, 78, 79, 80}},
        {SNOW_ENCODING_BITMAP,
         18,
         {0x10, 0x02, 0, 0, 0, 0, 0, 0x30, 0, 0, 0, 0xe0, 0x01}},
        {SNOW_ENCODING_RLE, 10, {1, 255, 0, 45, 2, 255, 0, 32, 4, 7}},
    };
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    scene s = make_scene(context, SNOW_TYPE_UINT8, 2, 600, 1, 1, NOTHING, 1, 3);
    memset(s.voxels + 300, 150, 2);
    memset(s.voxels + 589, 150, 4);
    for (size_t n = 0; n < 3; n++) {
        snow_bands_params order = order_of(&s, cases[n].encoding);
        encode_and_check(&s, &order, &bands);
        const snow_sparse *band = &bands.bands[0];
        assert_int_equal(band->ea_bytes, cases[n].size);
        assert_memory_equal(band->ea, cases[n].bytes, cases[n].size);
    }
    /* A gap is split only where it must be. */
    static const unsigned char runs[] = {1, 10, 240, 50, 255, 0, 45};
    memset(s.voxels, 150, 600);
    memset(s.voxels, 0, 10);
    memset(s.voxels + 250, 0, 50);
    snow_bands_params order = order_of(&s, SNOW_ENCODING_RLE);
    encode_and_check(&s, &order, &bands);
    assert_int_equal(bands.ea_bytes, sizeof runs);
    assert_memory_equal(bands.bands[0].ea, runs, sizeof runs);
    free_scene(&s);
    snow_bands_fini(&bands);
    snow_context_free(context);
}

static void auto_is_chosen_by_density_and_runs(void **state) {
    (void)state;
    static const struct {
        pattern kind;
        snow_encoding encoding;
    } cases[] = {{NOTHING, SNOW_ENCODING_CRS},
                 {TINY, SNOW_ENCODING_CRS},
                 {SOME, SNOW_ENCODING_BITMAP},
                 {ALL, SNOW_ENCODING_BITMAP},
                 {STREAKS, SNOW_ENCODING_BITMAP}};
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int axis = 1; axis < 3; axis++) {
            scene s = make_scene(context, SNOW_TYPE_UINT8, axis, 300, 100, 30,
                                 cases[n].kind, 1, n);
            snow_bands_params order = order_of(&s, SNOW_ENCODING_AUTO);
            encode_and_check(&s, &order, &bands);
            assert_int_equal(bands.encoding, cases[n].encoding);
            free_scene(&s);
        }
    snow_bands_fini(&bands);
    snow_context_free(context);
}

static void slices_too_large_for_32_bits_are_refused(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    scene s = make_scene(context, SNOW_TYPE_UINT8, 2, 8, 8, 2, SOME, 1, 1);
    s.placement.columns = 65536;
    s.placement.rows = 65536;
    snow_bands_params order = order_of(&s, SNOW_ENCODING_CRS);
    assert_int_equal(snow_bands_encode(&bands, &order), SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "65536x65536"));
    free_scene(&s);
    snow_bands_fini(&bands);
    snow_context_free(context);
}

/* --- memory --------------------------------------------------------------- */

/* malloc that counts, and fails from one call on. */
typedef struct supply {
    int64_t calls, fail_at; /* 0: never */
} supply;

static void *allocate(void *user, size_t bytes) {
    supply *memory = user;
    memory->calls++;
    if (memory->fail_at && memory->calls >= memory->fail_at)
        return NULL;
    return malloc(bytes);
}

static void release(void *user, void *block) {
    (void)user;
    free(block);
}

static snow_context *counting_context(supply *memory) {
    const snow_allocator allocator = {allocate, release, memory};
    snow_context *context;
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    return context;
}

static void encoding_again_allocates_nothing(void **state) {
    (void)state;
    supply memory = {0};
    snow_context *context = counting_context(&memory);
    for (int axis = 0; axis < 3; axis++)
        for (int e = 0; e < 4; e++) {
            scene s = make_scene(context, SNOW_TYPE_UINT8, axis, 130, 130, 70,
                                 SOME, 1, 2);
            snow_bands bands = {.context = context};
            snow_bands_params order = order_of(&s, (snow_encoding)e);
            order.maker = &s.maker;
            order.threads = 2;
            encode_and_check(&s, &order, &bands);
            int64_t calls = memory.calls;
            uint64_t bytes = snow_context_bytes(context);
            encode_and_check(&s, &order, &bands);
            assert_int_equal(memory.calls, calls);
            assert_int_equal(snow_context_bytes(context), bytes);
            snow_bands_fini(&bands);
            free_scene(&s);
        }
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* A smaller volume and a larger one in turn, in one record. */
static void one_record_serves_volumes_of_any_size(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_bands bands = {.context = context};
    for (int round = 0; round < 12; round++) {
        int64_t size = round % 2 ? 20 + round : 140 + 9 * round;
        snow_type type = round % 3 ? SNOW_TYPE_UINT8 : SNOW_TYPE_INT16;
        scene s =
            make_scene(context, type, round % 3, size, size, 3, STREAKS, 1, 4);
        snow_bands_params order = order_of(&s, schemes[round % 3]);
        order.maker = round % 2 ? &s.maker : NULL;
        encode_and_check(&s, &order, &bands);
        free_scene(&s);
    }
    snow_bands_fini(&bands);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void memory_that_runs_out_anywhere_is_told(void **state) {
    (void)state;
    supply memory = {0};
    snow_context *context = counting_context(&memory);
    for (int threads = 1; threads < 3; threads++)
        for (int e = 0; e < 4; e++) {
            scene s =
                make_scene(context, SNOW_TYPE_UINT8, 0, 70, 70, 9, SOME, 1, 2);
            snow_bands bands = {.context = context};
            snow_bands_params order = order_of(&s, (snow_encoding)e);
            order.maker = &s.maker;
            order.threads = threads;
            uint64_t before = snow_context_bytes(context);
            int failures = 0;
            for (int64_t n = 1;; n++) {
                memory.fail_at = memory.calls + n;
                snow_status status = snow_bands_encode(&bands, &order);
                memory.fail_at = 0;
                if (status == SNOW_STATUS_OK)
                    break;
                assert_int_equal(status, SNOW_STATUS_NO_MEMORY);
                assert_non_null(
                    strstr(snow_context_message(context), "out of memory"));
                snow_bands_fini(&bands);
                assert_int_equal(snow_context_bytes(context), before);
                failures++;
            }
            assert_true(failures > 10);
            check_bands(&s, &bands, &order);
            snow_bands_fini(&bands);
            free_scene(&s);
        }
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_types_axes_schemes_and_patterns_hold_the_volume),
        cmocka_unit_test(every_tail_of_a_row_and_a_band_is_right),
        cmocka_unit_test(long_rows_hold_runs_of_any_length),
        cmocka_unit_test(any_number_of_intervals_is_kept),
        cmocka_unit_test(levels_and_threads_change_no_byte),
        cmocka_unit_test(a_slab_holds_its_slices_only),
        cmocka_unit_test(slices_between_are_means),
        cmocka_unit_test(skipping_rows_is_walking_them),
        cmocka_unit_test(what_is_empty_takes_no_bytes),
        cmocka_unit_test(a_sparse_slice_takes_few_bytes),
        cmocka_unit_test(the_bytes_of_a_row_are_those_of_the_drawings),
        cmocka_unit_test(auto_is_chosen_by_density_and_runs),
        cmocka_unit_test(slices_too_large_for_32_bits_are_refused),
        cmocka_unit_test(encoding_again_allocates_nothing),
        cmocka_unit_test(one_record_serves_volumes_of_any_size),
        cmocka_unit_test(memory_that_runs_out_anywhere_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
