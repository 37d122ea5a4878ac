/* tests/stages/test_encode.c - EA, IA and PA are those of section 3 of the
 * paper, and all three schemes are read back as the same spans. */
#include "support/support.h"

#include "encode/encode.h"
#include "encode/fetch.h"

static const snow_scheme *const schemes[] = {
    &snow_scheme_crs, &snow_scheme_bitmap, &snow_scheme_rle};

/* A strip over rows of 0 and 1: each 1 is kept, its sample is its number. */
static void fill_strip(snow_row_block *strip, const unsigned char *mask,
                       int64_t rows, int64_t columns, float *number) {
    strip->rows = rows;
    strip->count = 0;
    for (int64_t row = 0; row < rows; row++) {
        for (int64_t column = 0; column < columns; column++)
            if (mask[row * columns + column]) {
                strip->columns[strip->count] = (uint32_t)column;
                strip->samples[2 * strip->count] = *number;
                strip->samples[2 * strip->count + 1] = 1;
                strip->count++;
                ++*number;
            }
        strip->row_end[row] = strip->count;
    }
}

/* Encodes `slices` slices of a mask by a scheme. */
static void encode(snow_context *context, const snow_scheme *scheme,
                   const unsigned char *mask, int64_t slices, int64_t rows,
                   int64_t columns, snow_sparse *sparse) {
    snow_placement placement = {
        .columns = columns, .rows = rows, .slices = slices};
    snow_row_block strip = {0};
    float number = 1;
    *sparse = (snow_sparse){.context = context};
    assert_int_equal(snow_row_block_make(context, &placement, 2, &strip),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_sparse_begin(sparse, scheme, &placement, 2),
                     SNOW_STATUS_OK);
    for (int64_t slice = 0; slice < slices; slice++) {
        assert_int_equal(snow_sparse_begin_slice(sparse), SNOW_STATUS_OK);
        for (int64_t row = 0; row < rows; row++) {
            fill_strip(&strip, mask + (slice * rows + row) * columns, 1,
                       columns, &number);
            assert_int_equal(snow_sparse_add_row_block(sparse, &strip),
                             SNOW_STATUS_OK);
        }
        assert_int_equal(snow_sparse_end_slice(sparse), SNOW_STATUS_OK);
    }
    snow_row_block_free(context, &strip);
}

/* Walks every slice, last first, and compares spans and samples with the mask
 * itself. */
static void assert_walks_like(const snow_sparse *sparse,
                              const unsigned char *mask) {
    int64_t rows = sparse->rows, columns = sparse->columns;
    snow_span *spans = malloc(((size_t)columns / 2 + 1) * sizeof *spans);
    assert_non_null(spans);
    for (int64_t slice = sparse->filled - 1; slice >= 0; slice--) {
        snow_walk walk;
        snow_walk_begin(&walk, sparse, slice);
        float number = (float)sparse->pa[slice].ia + 1;
        for (int64_t row = 0; row < rows; row++) {
            const unsigned char *line = mask + (slice * rows + row) * columns;
            size_t voxel;
            size_t count = snow_walk_row(&walk, spans, &voxel), span = 0;
            const float *samples = sparse->ia + 2 * voxel;
            for (int64_t column = 0; column < columns; span++) {
                while (column < columns && !line[column])
                    column++;
                if (column == columns)
                    break;
                assert_true(span < count);
                assert_int_equal(spans[span].column, column);
                for (; column < columns && line[column]; column++, samples += 2)
                    assert_true(samples[0] == number++);
                assert_int_equal(spans[span].column + spans[span].length,
                                 column);
            }
            assert_int_equal(span, count);
        }
    }
    free(spans);
}

/* The sparse matrix of figure 4: 1 where an element is not 0. */
static const unsigned char figure4[25] = {0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0,
                                          1, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0};

/* Of a mask of one slice: indr and col of figure 4, a bit for each element in
 * figure 5, and lengths of runs, the first of which is uninteresting, in figure
 * 6; runs above 255 are split by runs of 0. */
static void figures_of_the_paper_are_met(void **state) {
    (void)state;
    static const struct {
        uint32_t indr[6];
        uint16_t col[7];
    } crs = {{0, 1, 3, 4, 6, 7}, {4, 0, 1, 3, 0, 4, 1}};
    static const unsigned char bits[] = {0x70, 0xa0, 0x28, 0x00};
    static const unsigned char runs[] = {4, 3, 6, 1, 1, 1, 3, 1, 1, 1, 3};
    static const unsigned char split[] = {255, 0, 45, 255, 0, 255, 1, 1};
    static unsigned char wide[812];
    const struct {
        const snow_scheme *scheme;
        const unsigned char *mask;
        const void *ea;
        size_t bytes;
        int64_t rows, columns;
    } cases[] = {
        {&snow_scheme_crs, figure4, &crs, 38, 5, 5},
        {&snow_scheme_bitmap, figure4, bits, sizeof bits, 5, 5},
        {&snow_scheme_rle, figure4, runs, sizeof runs, 5, 5},
        {&snow_scheme_rle, wide, split, sizeof split, 1, 812},
    };
    memset(wide + 300, 1, 510);
    wide[811] = 1;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        snow_context *context = support_context();
        snow_sparse sparse;
        encode(context, cases[n].scheme, cases[n].mask, 1, cases[n].rows,
               cases[n].columns, &sparse);
        assert_in_range(sparse.ea_bytes, cases[n].bytes, cases[n].bytes + 3);
        assert_memory_equal(sparse.ea, cases[n].ea, cases[n].bytes);
        assert_walks_like(&sparse, cases[n].mask);
        snow_sparse_fini(&sparse);
        snow_context_free(context);
    }
}

/* Fills a mask with runs of random lengths up to `longest` of either kind. */
static void random_runs(unsigned char *mask, size_t size, uint64_t longest,
                        uint64_t seed) {
    unsigned char kind = seed % 2;
    for (size_t i = 0; i < size; kind = !kind)
        for (uint64_t run = support_random(&seed) % longest + 1;
             run && i < size; run--)
            mask[i++] = kind;
}

/* Among them slices that are empty, and full. */
static void all_schemes_walk_the_same_spans(void **state) {
    (void)state;
    static const int64_t widths[] = {1,  2,  7,   8,   9,   55,  56,  57,
                                     63, 64, 111, 112, 113, 255, 256, 511};
    snow_context *context = support_context();
    static unsigned char mask[3 * 5 * 511];
    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
        for (uint64_t longest = 1; longest < 2000; longest *= 3)
            for (int s = 0; s < 3; s++) {
                snow_sparse sparse;
                random_runs(mask, sizeof mask, longest, w * 977 + longest);
                encode(context, schemes[s], mask, 3, 5, widths[w], &sparse);
                assert_walks_like(&sparse, mask);
                snow_sparse_fini(&sparse);
            }
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void rows_longer_than_a_crs_column_can_say_are_cut(void **state) {
    (void)state;
    int64_t columns = 3 * 65536 + 5;
    unsigned char *mask = malloc(2 * (size_t)columns);
    assert_non_null(mask);
    random_runs(mask, 2 * (size_t)columns, 9000, 7);
    snow_context *context = support_context();
    for (int s = 0; s < 3; s++) {
        snow_sparse sparse;
        encode(context, schemes[s], mask, 1, 2, columns, &sparse);
        assert_walks_like(&sparse, mask);
        snow_sparse_fini(&sparse);
    }
    snow_context_free(context);
    free(mask);
}

static void auto_goes_by_density_and_run_length(void **state) {
    (void)state;
    assert_int_equal(snow_encoding_choose(1000, 10, 1), SNOW_ENCODING_CRS);
    assert_int_equal(snow_encoding_choose(1000, 400, 4), SNOW_ENCODING_BITMAP);
    assert_int_equal(snow_encoding_choose(1000, 16, 1), SNOW_ENCODING_RLE);
    assert_int_equal(snow_encoding_choose(1000, 400, 200),
                     SNOW_ENCODING_BITMAP);
    assert_int_equal(snow_encoding_choose(1000, 0, 0), SNOW_ENCODING_CRS);
}

/* Slices along x of a volume of random bytes, each beside its voxels. */
static void check_fetch(snow_type type, const int64_t dims[3], snow_isa isa) {
    const size_t size = snow_type_size(type);
    const size_t bytes = (size_t)(dims[0] * dims[1] * dims[2]) * size;
    unsigned char *voxels = malloc(bytes);
    uint64_t random = 5;
    for (size_t n = 0; n < bytes; n++)
        voxels[n] = (unsigned char)support_random(&random);
    const snow_volume volume = {
        .info = {.dims = {dims[0], dims[1], dims[2]}, .type = type},
        .voxels = voxels};
    const snow_placement placement = {.u_axis = 1,
                                      .v_axis = 2,
                                      .slice_axis = 0,
                                      .columns = dims[1],
                                      .rows = dims[2],
                                      .slices = dims[0]};
    const snow_fetch_params params = {.volume = &volume,
                                      .placement = &placement,
                                      .slices = dims[0],
                                      .rows = dims[2],
                                      .isa = isa};
    void *scratch =
        aligned_alloc(64, (snow_fetch_bytes(&params) + 63) / 64 * 64);
    snow_fetch fetch;
    snow_fetch_begin(&fetch, &params, scratch);
    for (int64_t x = 0; x < dims[0]; x++) {
        snow_rows rows;
        snow_fetch_slice(&fetch, x, &rows);
        for (int64_t z = 0; z < dims[2]; z++)
            for (int64_t y = 0; y < dims[1]; y++)
                assert_memory_equal(
                    rows.voxels + (size_t)z * rows.stride + (size_t)y * size,
                    voxels + (size_t)((z * dims[1] + y) * dims[0] + x) * size,
                    size);
    }
    free(scratch);
    free(voxels);
}

static void slices_along_x_have_their_voxels(void **state) {
    (void)state;
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32, SNOW_TYPE_FLOAT64};
    static const int64_t slices[] = {1, 7, 8, 33, 64, 65, 72};
    static const int64_t columns[] = {1, 63, 64, 65, 130};
    for (size_t t = 0; t < sizeof types / sizeof *types; t++)
        for (size_t x = 0; x < sizeof slices / sizeof *slices; x++)
            for (size_t y = 0; y < sizeof columns / sizeof *columns; y++)
                for (int isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX2; isa++)
                    if (snow_isa_runs((snow_isa)isa))
                        check_fetch(types[t],
                                    (int64_t[]){slices[x], columns[y], 3},
                                    (snow_isa)isa);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_of_the_paper_are_met),
        cmocka_unit_test(all_schemes_walk_the_same_spans),
        cmocka_unit_test(rows_longer_than_a_crs_column_can_say_are_cut),
        cmocka_unit_test(auto_goes_by_density_and_run_length),
        cmocka_unit_test(slices_along_x_have_their_voxels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
