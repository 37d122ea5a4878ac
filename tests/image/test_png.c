/* tests/image/test_png.c - PNG files hold the right bytes, and only whole and
 * right ones are read.  Files are checked and made with libpng's own functions,
 * not with those under test. */
#include "support/image.h"

#include <math.h>
#include <png.h>
#include <zlib.h>

/* --- files by libpng ------------------------------------------------------ */

typedef struct decoded {
    int width, height, bits, type, row_bytes;
    unsigned char bytes[4096]; /* all rows, as stored */
} decoded;

/* The stored bytes of a small PNG file. */
static decoded decode_file(const char *path) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    png_structp png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    decoded d = {.width = (int)png_get_image_width(png, info),
                 .height = (int)png_get_image_height(png, info),
                 .bits = png_get_bit_depth(png, info),
                 .type = png_get_color_type(png, info),
                 .row_bytes = (int)png_get_rowbytes(png, info)};
    assert_true((size_t)(d.row_bytes * d.height) <= sizeof d.bytes);
    png_bytepp rows = png_get_rows(png, info);
    for (int y = 0; y < d.height; y++)
        memcpy(d.bytes + y * d.row_bytes, rows[y], (size_t)d.row_bytes);
    png_destroy_read_struct(&png, &info, NULL);
    fclose(file);
    return d;
}

/* What a PNG of the tests is like. */
typedef struct recipe {
    int width, height, bits, type;
    bool interlaced;
    bool has_key;     /* a tRNS chunk for grey and colour */
    png_color_16 key; /* of this colour */
    int colours;      /* a palette of that many */
    png_color palette[4];
    unsigned char alphas[4]; /* of the palette when has_key */
} recipe;

static void append_bytes(png_structp png, png_bytep bytes, size_t size) {
    support_bytes *data = png_get_io_ptr(png);
    data->bytes = realloc(data->bytes, data->size + size);
    memcpy(data->bytes + data->size, bytes, size);
    data->size += size;
}

/* A file of the rows given as stored. */
static support_bytes encode(const recipe *r, const unsigned char *rows) {
    support_bytes data = {NULL, 0};
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &data, append_bytes, NULL);
    png_set_IHDR(png, info, (png_uint_32)r->width, (png_uint_32)r->height,
                 r->bits, r->type,
                 r->interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (r->colours)
        png_set_PLTE(png, info, r->palette, r->colours);
    if (r->has_key)
        png_set_tRNS(png, info, r->alphas, r->colours, &r->key);
    png_set_gAMA(png, info, 1.0);
    size_t row_bytes = png_get_rowbytes(png, info);
    png_bytep pointers[64];
    for (int y = 0; y < r->height; y++)
        pointers[y] = (png_bytep)(uintptr_t)(rows + (size_t)y * row_bytes);
    png_set_rows(png, info, pointers);
    png_write_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    png_destroy_write_struct(&png, &info);
    return data;
}

/* Loads such a file; the caller frees the picture. */
static snow_image *load_recipe(snow_context *context, const recipe *r,
                               const unsigned char *rows) {
    support_bytes data = encode(r, rows);
    snow_image *image = support_load(context, data.bytes, data.size);
    assert_int_equal(snow_image_width(image), r->width);
    assert_int_equal(snow_image_height(image), r->height);
    free(data.bytes);
    return image;
}

static void assert_pixel(snow_image *image, int index, double red, double green,
                         double blue, double alpha) {
    const float *pixel = snow_image_pixels(image) + 4 * index;
    const double wanted[4] = {red, green, blue, alpha};
    for (int c = 0; c < 4; c++)
        if (!(fabs((double)pixel[c] - wanted[c]) < 1e-7))
            fail_msg("pixel %d channel %d is %.9g, not %.9g", index, c,
                     (double)pixel[c], wanted[c]);
}

/* Saves one row of pixels and gives what the file stores. */
static decoded store_row(image_fixture *f, const float *pixels, int width,
                         int channels, const snow_image_options *options) {
    snow_image *image = support_blank(f->context, width, 1, channels);
    memcpy(snow_image_pixels(image), pixels,
           (size_t)(width * channels) * sizeof(float));
    const char *path = support_image_path(f, "row.png");
    assert_int_equal(snow_image_save(image, path, options), SNOW_STATUS_OK);
    snow_image_free(image);
    return decode_file(path);
}

/* --- writing -------------------------------------------------------------- */

/* What libpng reads of a file's only text. */
static void read_text(const char *path, char out[256]) {
    FILE *file = fopen(path, "rb");
    png_textp texts = NULL;
    int count = 0;
    assert_non_null(file);
    png_structp png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_info(png, info);
    png_get_text(png, info, &texts, &count);
    snprintf(out, 256, "%d", count);
    if (count)
        snprintf(out, 256, "%s: %s", texts[0].key, texts[0].text);
    png_destroy_read_struct(&png, &info, NULL);
    fclose(file);
}

static void a_comment_is_a_text_and_no_pixel(void **state) {
    const float pixels[] = {0.25f, 0.5f, 0.1f, 0.5f};
    image_fixture *f = *state;
    char text[256];
    snow_image_options options;
    snow_image_options_init(&options);
    options.overwrite = true;
    decoded plain = store_row(f, pixels, 1, 4, &options);
    read_text(f->path, text);
    assert_string_equal(text, "0");
    options.comment = "{\"step\": 1}";
    decoded other = store_row(f, pixels, 1, 4, &options);
    read_text(f->path, text);
    assert_string_equal(text, "Snowglass: {\"step\": 1}");
    assert_memory_equal(plain.bytes, other.bytes, 4);
}

/* Rows of pixels, and what a file stores of them. */
static void rows_are_stored_as_wanted(void **state) {
#define FLAT(r, g, b) .flatten = true, .background = {(r), (g), (b) }
    static const struct {
        const char *what;
        int width, channels;
        snow_image_options options;
        int bits, type;
        float pixels[16];
        size_t size;
        unsigned char bytes[16];
    } rows[] = {
        {"alpha is divided out, and rounded",
         3,
         4,
         {0},
         8,
         PNG_COLOR_TYPE_RGB_ALPHA,
         {0.25F, 0.5F, 0.1F, 0.5F, 0, 0, 0, 0, 1, 0, 0.3F, 1},
         12,
         {128, 255, 51, 128, 0, 0, 0, 0, 255, 0, 77, 255}},
        {"32767.5 and 16383.75 are rounded up",
         1,
         4,
         {.bits = 16},
         16,
         PNG_COLOR_TYPE_RGB_ALPHA,
         {0.25F, 0.5F, 0.125F, 0.5F},
         8,
         {0x80, 0, 0xff, 0xff, 0x40, 0, 0x80, 0}},
        {"grey is stored as grey",
         3,
         2,
         {0},
         8,
         PNG_COLOR_TYPE_GRAY_ALPHA,
         {0.25F, 0.5F, 0, 0, 1, 1},
         6,
         {128, 128, 0, 0, 255, 255}},
        {"a background takes alpha away",
         3,
         4,
         {FLAT(0.2, 0.4, 1)},
         8,
         PNG_COLOR_TYPE_RGB,
         {0.25F, 0.5F, 0, 0.5F, 0, 0, 0, 0, 1, 0, 0, 1},
         9,
         {89, 179, 128, 51, 102, 255, 255, 0, 0}},
        {"grey on grey is grey",
         2,
         2,
         {FLAT(0.5, 0.5, 0.5)},
         8,
         PNG_COLOR_TYPE_GRAY,
         {0.25F, 0.5F, 0, 0},
         2,
         {128, 128}},
        {"grey on blue is not",
         2,
         2,
         {FLAT(0, 0, 1)},
         8,
         PNG_COLOR_TYPE_RGB,
         {0.25F, 0.5F, 0, 0},
         6,
         {64, 64, 191, 0, 0, 255}},
        {"no number is transparent",
         3,
         4,
         {0},
         8,
         PNG_COLOR_TYPE_RGB_ALPHA,
         {NAN, 1, 1, 1, 1, 1, NAN, 1, 1, 1, 1, NAN},
         12,
         {0}},
        {"no number shows the background",
         3,
         4,
         {FLAT(0.2, 0.4, 1)},
         8,
         PNG_COLOR_TYPE_RGB,
         {NAN, 1, 1, 1, 1, 1, NAN, 1, 1, 1, 1, NAN},
         9,
         {51, 102, 255, 51, 102, 255, 51, 102, 255}},
        {"values out of range are limited, alpha first",
         4,
         4,
         {0},
         8,
         PNG_COLOR_TYPE_RGB_ALPHA,
         {INFINITY, -INFINITY, 2, 1, 0.5F, -0.5F, 0, 7, 1, 1, 1, -1, 0.5F,
          0.25F, 3e38F, 0x1p-140F},
         16,
         {255, 0, 255, 255, 128, 0, 0, 255, 0, 0, 0, 0, 255, 255, 255, 0}},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        snow_image_options options = rows[n].options;
        options.size = sizeof options;
        decoded d = store_row(*state, rows[n].pixels, rows[n].width,
                              rows[n].channels, &options);
        if (d.bits != rows[n].bits || d.type != rows[n].type ||
            (size_t)d.row_bytes != rows[n].size ||
            memcmp(d.bytes, rows[n].bytes, rows[n].size) != 0)
            fail_msg("%s", rows[n].what);
    }
}

/* As encoders of movies get them; libpng reads the file, not our reader. */
static void bytes_for_encoders_are_those_of_a_file(void **state) {
    image_fixture *f = *state;
    for (int n = 0; n < 4; n++) { /* grey and not, on a colour and on black */
        const double blue = n & 2 ? 0 : 1;
        const int channels = n & 1 ? 4 : 2;
        const snow_image_options flat = {
            .size = sizeof flat,
            .flatten = true,
            .background = {0.2 * blue, 0.4 * blue, blue}};
        unsigned char rgb[700 * 3];
        snow_image *image = support_picture(f->context, 700, 1, channels, 5);
        if (channels == 4)
            snow_image_pixels(image)[4 * 300] = NAN;
        decoded d =
            store_row(f, snow_image_pixels(image), 700, channels, &flat);
        size_t step = (size_t)d.row_bytes / 700;
        assert_int_equal(step, n == 2 ? 1 : 3);
        snow_image_to_rgb8(image, &flat, rgb);
        for (size_t i = 0; i < sizeof rgb; i++)
            assert_int_equal(rgb[i], d.bytes[step == 1 ? i / 3 : i]);
        snow_image_free(image);
    }
}

/* The stored level nearest to a value, halves going up. */
static int nearest_level(double value, int top) {
    return (int)floor((value > 1 ? 1 : value) * top + 0.5);
}

static void every_level_is_the_nearest(void **state) {
    uint64_t seed = 4;
    enum { WIDTH = 500 };
    for (int round = 0; round < 40; round++) {
        float pixels[2 * WIDTH];
        for (int x = 0; x < WIDTH; x++) {
            /* multiples of a power of two often lie half-way */
            pixels[2 * x + 1] = (float)(1 + support_random(&seed) % 256) / 256;
            pixels[2 * x] =
                pixels[2 * x + 1] * (float)(support_random(&seed) % 511) / 510;
        }
        const snow_image_options options = {.size = sizeof options,
                                            .bits = 8 + round % 2 * 8};
        decoded d = store_row(*state, pixels, WIDTH, 2, &options);
        for (int x = 0; x < 2 * WIDTH; x++) {
            double value = (double)pixels[x];
            if (x % 2 == 0)
                value /= (double)pixels[x + 1];
            int stored = d.bits == 8 ? d.bytes[x]
                                     : d.bytes[2 * x] << 8 | d.bytes[2 * x + 1];
            assert_int_equal(stored, nearest_level(value, (1 << d.bits) - 1));
        }
    }
}

static void row_0_is_the_top(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_blank(f->context, 1, 3, 2);
    memcpy(snow_image_pixels(image), ((float[]){0.2f, 1, 0.4f, 1, 0.6f, 1}),
           6 * sizeof(float));
    const char *path = support_image_path(f, "column.png");
    assert_int_equal(snow_image_save(image, path, NULL), SNOW_STATUS_OK);
    snow_image_free(image);
    decoded d = decode_file(path);
    assert_int_equal(d.height, 3);
    assert_memory_equal(d.bytes,
                        ((unsigned char[]){51, 255, 102, 255, 153, 255}), 6);
}

/* Levels divided out of many alphas are those that were put in. */
static void stored_levels_survive_a_round_trip(void **state) {
    image_fixture *f = *state;
    for (int bits = 8; bits <= 16; bits += 8) {
        int top = (1 << bits) - 1, side = 256;
        snow_image *image = support_blank(f->context, side, side, 2);
        float *pixel = snow_image_pixels(image);
        for (int i = 0; i < side * side; i++) {
            float alpha = (float)(1 + i % 97) / 97;
            pixel[2 * i] = alpha * (float)(i % (top + 1)) / (float)top;
            pixel[2 * i + 1] = alpha;
        }
        const snow_image_options options = {.size = sizeof options,
                                            .bits = bits};
        snow_image *again =
            support_round_trip(f, image, "levels.png", &options);
        for (int i = 0; i < side * side; i++) {
            const float *p = snow_image_pixels(again) + 4 * i;
            double level = (double)(p[0] / p[3]) * top;
            assert_true(fabs(level - i % (top + 1)) < 0.02);
        }
        snow_image_free(image);
        snow_image_free(again);
    }
}

static void odd_sizes_survive_a_round_trip(void **state) {
    image_fixture *f = *state;
    static const int sizes[][2] = {
        {1, 1}, {1, 300}, {300, 1}, {7, 5}, {640, 9}};
    for (int i = 0; i < 10; i++) {
        const int *size = sizes[i / 2];
        snow_image *image =
            support_picture(f->context, size[0], size[1], i % 2 ? 4 : 2, 5);
        const snow_image_options deep = {.size = sizeof deep, .bits = 16};
        snow_image *again = support_round_trip(f, image, "odd.png", &deep);
        assert_true(support_apart(image, again) < 1.01 / 65535);
        snow_image_free(image);
        snow_image_free(again);
    }
}

/* --- reading -------------------------------------------------------------- */

static void rows_are_read_as_they_are(void **state) {
#define ROW(pixels, depth, kind)                     \
    .width = (pixels), .height = 1, .bits = (depth), \
    .type = PNG_COLOR_TYPE_##kind
    static const struct {
        recipe recipe;
        unsigned char row[8];
        float pixels[3][4];
    } files[] = {
        {{ROW(2, 8, RGB_ALPHA)}, /* alpha is multiplied in */
         {255, 51, 0, 102, 10, 20, 30, 0},
         {{0.4F, 0.08F, 0, 0.4F}, {0, 0, 0, 0}}},
        {{ROW(1, 16, RGB)},
         {0x12, 0x34, 0, 1, 0xff, 0xff},
         {{0x1234 / 65535.0F, 1 / 65535.0F, 1, 1}}},
        {{ROW(2, 1, GRAY)}, {0x40}, {{0, 0, 0, 1}, {1, 1, 1, 1}}},
        {{ROW(2, 2, GRAY)},
         {0x60},
         {{1 / 3.0F, 1 / 3.0F, 1 / 3.0F, 1},
          {2 / 3.0F, 2 / 3.0F, 2 / 3.0F, 1}}},
        {{ROW(3, 4, GRAY)},
         {0x1b, 0xc0},
         {{1 / 15.0F, 1 / 15.0F, 1 / 15.0F, 1},
          {11 / 15.0F, 11 / 15.0F, 11 / 15.0F, 1},
          {0.8F, 0.8F, 0.8F, 1}}},
        {{ROW(3, 2, PALETTE), .colours = 3,
          .palette = {{255, 0, 0}, {0, 51, 0}, {0, 0, 255}}, .has_key = true,
          .alphas = {51, 255, 0}},
         {0x18}, /* 00 01 10 00 */
         {{0.2F, 0, 0, 0.2F}, {0, 0.2F, 0, 1}, {0, 0, 0, 0}}},
        {{ROW(2, 8, RGB), .has_key = true, /* is transparent */
          .key = {.red = 1, .green = 2, .blue = 3}},
         {1, 2, 3, 0, 255, 0},
         {{0, 0, 0, 0}, {0, 1, 0, 1}}},
        {{ROW(2, 16, GRAY), .has_key = true, .key = {.gray = 0x0102}},
         {1, 2, 1, 3},
         {{0, 0, 0, 0}, {259 / 65535.0F, 259 / 65535.0F, 259 / 65535.0F, 1}}},
    };
    image_fixture *f = *state;
    for (size_t n = 0; n < sizeof files / sizeof *files; n++) {
        snow_image *image =
            load_recipe(f->context, &files[n].recipe, files[n].row);
        for (int x = 0; x < files[n].recipe.width; x++)
            assert_pixel(image, x, (double)files[n].pixels[x][0],
                         (double)files[n].pixels[x][1],
                         (double)files[n].pixels[x][2],
                         (double)files[n].pixels[x][3]);
        snow_image_free(image);
    }
}

/* As libpng and most readers have it. */
static void a_colour_beyond_the_palette_is_black(void **state) {
    image_fixture *f = *state;
    const recipe r = {
        .width = 4,
        .height = 1,
        .bits = 2,
        .type = PNG_COLOR_TYPE_PALETTE,
        .colours = 4,
        .palette = {{255, 0, 0}, {0, 51, 0}, {0, 0, 255}, {255, 255, 255}}};
    const unsigned char rows[] = {0x1b};
    support_bytes data = encode(&r, rows);
    /* PLTE follows IHDR and gAMA: take its last colour away. */
    unsigned char *chunk = data.bytes + 8 + 25 + 16;
    assert_memory_equal(chunk + 4, "PLTE", 4);
    chunk[3] = 9;
    uLong crc = crc32(0, chunk + 4, 13);
    for (int i = 0; i < 4; i++)
        chunk[17 + i] = (unsigned char)(crc >> (24 - 8 * i));
    memmove(chunk + 21, chunk + 24, data.size - 8 - 25 - 16 - 24);
    snow_image *image = support_load(f->context, data.bytes, data.size - 3);
    assert_pixel(image, 2, 0, 0, 1, 1);
    assert_pixel(image, 3, 0, 0, 0, 1);
    snow_image_free(image);
    free(data.bytes);
}

static void an_interlaced_file_is_the_same_picture(void **state) {
    image_fixture *f = *state;
    static const int sizes[][2] = {{1, 1}, {3, 2}, {9, 11}, {8, 8}, {1, 12}};
    unsigned char rows[9 * 11 * 8];
    uint64_t seed = 3;
    for (size_t i = 0; i < sizeof rows; i++)
        rows[i] = (unsigned char)(support_random(&seed) >> 56);
    for (int i = 0; i < 15; i++) {
        static const int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB,
                                    PNG_COLOR_TYPE_RGB_ALPHA};
        static const int depths[] = {2, 8, 16};
        recipe r = {.width = sizes[i / 3][0],
                    .height = sizes[i / 3][1],
                    .bits = depths[i % 3],
                    .type = types[i % 3]};
        snow_image *plain = load_recipe(f->context, &r, rows);
        r.interlaced = true;
        snow_image *laced = load_recipe(f->context, &r, rows);
        assert_memory_equal(snow_image_pixels(plain), snow_image_pixels(laced),
                            (size_t)(r.width * r.height) * 16);
        snow_image_free(plain);
        snow_image_free(laced);
    }
}

/* --- damage --------------------------------------------------------------- */

/* A file of a few hundred bytes. */
static support_bytes small_file(void) {
    unsigned char rows[6 * 5 * 4];
    uint64_t seed = 9;
    for (size_t i = 0; i < sizeof rows; i++)
        rows[i] = (unsigned char)(support_random(&seed) >> 56);
    const recipe r = {
        .width = 6, .height = 5, .bits = 8, .type = PNG_COLOR_TYPE_RGB_ALPHA};
    return encode(&r, rows);
}

static void a_file_cut_anywhere_is_refused(void **state) {
    image_fixture *f = *state;
    support_bytes data = small_file();
    for (size_t size = 0; size < data.size; size++) {
        /* A copy of that size, so that reading past it is seen. */
        unsigned char *cut = malloc(size + 1);
        memcpy(cut, data.bytes, size);
        support_assert_refused(f->context, cut, size);
        free(cut);
    }
    free(data.bytes);
}

static void any_changed_bit_is_refused(void **state) {
    image_fixture *f = *state;
    support_bytes data = small_file();
    for (size_t i = 0; i < 8 * data.size; i++) {
        data.bytes[i / 8] ^= (unsigned char)(1 << i % 8);
        support_assert_refused(f->context, data.bytes, data.size);
        data.bytes[i / 8] ^= (unsigned char)(1 << i % 8);
    }
    snow_image_free(support_load(f->context, data.bytes, data.size));
    free(data.bytes);
}

/* Writes the CRC of the chunk that begins at `chunk`. */
static void seal_chunk(unsigned char *chunk) {
    size_t size = (size_t)chunk[2] << 8 | chunk[3];
    uLong crc = crc32(0, chunk + 4, (uInt)(size + 4));
    for (int i = 0; i < 4; i++)
        chunk[8 + size + (size_t)i] = (unsigned char)(crc >> (24 - 8 * i));
}

/* The Adler-32 in an IDAT chunk of its own, which is read after the pixels. */
static support_bytes split_file(void) {
    support_bytes data = small_file();
    unsigned char *chunk = data.bytes + 8 + 25 + 16;
    assert_memory_equal(chunk + 4, "IDAT", 4);
    size_t size = ((size_t)chunk[2] << 8 | chunk[3]) - 4;
    support_bytes split = {calloc(1, data.size + 12), data.size + 12};
    memcpy(split.bytes, data.bytes, (size_t)(chunk - data.bytes) + 8 + size);
    unsigned char *first = split.bytes + 8 + 25 + 16;
    unsigned char *second = first + 12 + size;
    first[2] = (unsigned char)(size >> 8);
    first[3] = (unsigned char)(size & 255);
    seal_chunk(first);
    memcpy(second, "\0\0\0\4IDAT", 8);
    memcpy(second + 8, chunk + 8 + size, 4);
    seal_chunk(second);
    /* IEND is the last 12 bytes of both */
    memcpy(second + 16, data.bytes + data.size - 12, 12);
    free(data.bytes);
    return split;
}

static void a_wrong_sum_of_the_pixels_is_refused(void **state) {
    image_fixture *f = *state;
    support_bytes data = split_file();
    snow_image_free(support_load(f->context, data.bytes, data.size));
    unsigned char *last = data.bytes + data.size - 12 - 16;
    last[11] ^= 1;
    seal_chunk(last);
    support_assert_refused(f->context, data.bytes, data.size);
    free(data.bytes);
}

/* A chunk that is not needed may be nonsense, as long as its CRC is right. */
static void other_chunks_are_passed_over(void **state) {
    image_fixture *f = *state;
    support_bytes data = small_file();
    unsigned char *chunk = data.bytes + 8 + 25;
    assert_memory_equal(chunk + 4, "gAMA", 4);
    memcpy(chunk + 4, "sRGB", 4); /* which has one byte, not four */
    support_assert_refused(f->context, data.bytes, data.size);
    seal_chunk(chunk);
    snow_image_free(support_load(f->context, data.bytes, data.size));
    free(data.bytes);
}

static void sizes_the_file_cannot_hold_cost_no_memory(void **state) {
    (void)state;
    static const uint32_t sides[][2] = {
        {32768, 32768},     {32769, 1}, {1, 32769}, {0x7fffffff, 0x7fffffff},
        {0xffffffff, 1},    {0, 5},     {5, 0},     {0x80000000, 0x80000000},
        {0x10001, 0x10001},
    };
    support_bytes data = small_file();
    for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
        for (int k = 0; k < 8; k++)
            data.bytes[16 + k] =
                (unsigned char)(sides[i][k / 4] >> (24 - 8 * (k % 4)));
        seal_chunk(data.bytes + 8);
        snow_context *context = support_context();
        support_assert_refused(context, data.bytes, data.size);
        assert_true(snow_context_peak_bytes(context) < 100000);
        snow_context_free(context);
    }
    free(data.bytes);
}

static void bytes_after_the_end_are_told(void **state) {
    image_fixture *f = *state;
    support_bytes data = small_file();
    data.bytes = realloc(data.bytes, data.size + 5);
    memcpy(data.bytes + data.size, "after", 5);
    snow_image_free(support_load(f->context, data.bytes, data.size));
    assert_string_equal(f->warning, "");
    snow_image_free(support_load(f->context, data.bytes, data.size + 5));
    assert_non_null(strstr(f->warning, "5 bytes"));
    free(data.bytes);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(a_comment_is_a_text_and_no_pixel),
        TEST(bytes_for_encoders_are_those_of_a_file),
        TEST(rows_are_stored_as_wanted),
        TEST(every_level_is_the_nearest),
        TEST(row_0_is_the_top),
        TEST(stored_levels_survive_a_round_trip),
        TEST(odd_sizes_survive_a_round_trip),
        TEST(rows_are_read_as_they_are),
        TEST(a_colour_beyond_the_palette_is_black),
        TEST(an_interlaced_file_is_the_same_picture),
        TEST(a_file_cut_anywhere_is_refused),
        TEST(any_changed_bit_is_refused),
        TEST(a_wrong_sum_of_the_pixels_is_refused),
        TEST(other_chunks_are_passed_over),
        TEST(sizes_the_file_cannot_hold_cost_no_memory),
        TEST(bytes_after_the_end_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
