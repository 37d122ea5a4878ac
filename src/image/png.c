/* image/png.c - PNG files, written and read by libpng.
 *
 * Writes 8 or 16 bits per channel with straight alpha, or without alpha if the
 * picture is placed on a background.  Values are written as they are, without a
 * chunk about their meaning.  Reads every kind of PNG, as 16 bits per channel,
 * with alpha multiplied in; checksums must be right, and chunks other than the
 * picture are ignored.
 */
#include "io/png.h"
#include "image/image.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

static_assert(sizeof(float) == 4, "16-bit pixels are read behind float ones");

typedef struct png_writer {
    snow_png job;
    const char *comment; /* NULL: none */
    snow_writer *writer;
} png_writer;

/* --- writing -------------------------------------------------------------- */

/* Writers transfer all bytes, or fail with a message. */
static void write_bytes(png_structp png, png_bytep bytes, size_t size) {
    png_writer *to = png_get_io_ptr(png);
    snow_status status = snow_writer_write(to->writer, bytes, size);
    if (status != SNOW_STATUS_OK)
        snow_png_leave(&to->job, status);
}

/* The writer flushes when it commits. */
static void flush_nothing(png_structp png) {
    (void)png;
}

/* A page's libpng is built without texts. */
static void set_comment(png_writer *to) {
#ifdef PNG_WRITE_tEXt_SUPPORTED
    char *text = (char *)(uintptr_t)to->comment, key[] = "Snowglass";
    png_text chunk = {
        .compression = PNG_TEXT_COMPRESSION_NONE, .key = key, .text = text};
    if (text)
        png_set_text(to->job.png, to->job.info, &chunk, 1);
#else
    (void)to;
#endif
}

/* Level 1, the filter "up" and only runs (Z_RLE) were measured as the best
 * trade-off for renderings: as fast as deflate's quickest matching at 8 bits
 * and a third faster at 16, in somewhat less space.  Level 6 takes four times
 * as long for a fifth less. */
static void write_header(png_writer *to, snow_levels *levels) {
    static const int types[] = {0, PNG_COLOR_TYPE_GRAY,
                                PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
    const snow_png *job = &to->job;
    png_set_write_fn(job->png, to, write_bytes, flush_nothing);
    png_set_compression_level(job->png, 1);
    png_set_compression_strategy(job->png, Z_RLE);
    png_set_filter(job->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_compression_buffer_size(job->png, 1 << 16);
    png_set_IHDR(job->png, job->info, (png_uint_32)levels->image->width,
                 (png_uint_32)levels->image->height, levels->bits,
                 types[levels->samples], PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    set_comment(to);
    png_write_info(job->png, job->info);
}

/* Every failure in libpng returns here, once. */
static snow_status run_writer(png_writer *to, snow_levels *levels) {
    snow_png *job = &to->job;
    if (setjmp(job->jump))
        return job->status;
    SNOW_TRY(snow_png_make(job, true));
    write_header(to, levels);
    for (int y = 0; y < levels->image->height; y++) {
        SNOW_TRY(snow_image_report(levels->image, y));
        png_write_row(job->png, snow_levels_row(levels, y));
    }
    png_write_end(job->png, job->info);
    return SNOW_STATUS_OK;
}

static snow_status write_png(const snow_image *image,
                             const snow_image_options *options,
                             snow_writer *writer) {
    snow_levels levels;
    png_writer to = {.job = {.context = image->context,
                             .refusal = SNOW_STATUS_FAILED,
                             .prefix = "the PNG file cannot be written",
                             .remedy = "write a .npy instead"},
                     .comment = options->comment,
                     .writer = writer};
    snow_status status = snow_levels_begin(image, options, false, &levels);
    if (status == SNOW_STATUS_OK)
        status = run_writer(&to, &levels);
    png_destroy_write_struct(&to.job.png, &to.job.info);
    snow_levels_end(&levels);
    return status;
}

/* --- reading -------------------------------------------------------------- */

/* Checks IHDR, which comes first, before libpng does.  Sides that are too long,
 * or need more compressed bytes than the file has, are refused before anything
 * is allocated.  Deflate compresses at most 1032 bytes into one. */
static snow_status check_header(snow_source *source) {
    unsigned char start[26];
    size_t got;
    SNOW_TRY(snow_source_peek(source, start, sizeof start, &got));
    if (got < sizeof start || memcmp(start + 12, "IHDR", 4) != 0)
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "%s: the PNG file is truncated or damaged in its "
                         "header; get it again",
                         snow_source_name(source));
    int64_t sides[2];
    snow_png_sides(start, sides);
    SNOW_TRY(snow_image_check_sides(source, sides[0], sides[1]));
    /* Bits per pixel in the file, from IHDR's depth and colour type; the
     * smallest possible for combinations that libpng will refuse. */
    static const unsigned char samples[7] = {1, 1, 3, 1, 2, 1, 4};
    uint64_t bits = (uint64_t)(sides[0] * sides[1]) *
                    (start[24] >= 1 && start[24] <= 16 && start[25] < 7
                         ? start[24] * samples[start[25]]
                         : 1);
    return snow_source_expect(source, bits / 8 / 1032, "the pixels");
}

/* A row of `width` float pixels is twice as long as one of 16-bit pixels, so
 * the latter is read into its second half.  Interlaced files need all rows
 * until the last pass; this way they need no memory besides the picture's:
 *
 *   while libpng reads   |  undefined  | R0 R1 R2 R3 |   8 bytes a pixel
 *   afterwards           |  F0  |  F1  |  F2  |  F3  |  16 bytes a pixel */
static unsigned char *raw_row(const snow_image *image, int y) {
    size_t width = (size_t)image->width;
    float *row = image->pixels + 4 * width * (size_t)y;
    return (unsigned char *)(row + 2 * width);
}

/* Reads the pixels into the picture's own memory; all passes of an interlaced
 * file write to the same place. */
static void read_rows(snow_png *job, const snow_image *image) {
    int passes = png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    if (png_get_rowbytes(job->png, job->info) != 8 * (size_t)image->width)
        png_error(job->png, "unexpected row size");
    for (int pass = 0; pass < passes; pass++)
        for (int y = 0; y < image->height; y++)
            png_read_row(job->png, raw_row(image, y), NULL);
    png_read_end(job->png, NULL);
}

/* Converts the 16-bit pixels of a row to premultiplied floats, in place, from
 * the left.  With w pixels in a row, float pixel x ends at byte 16 x + 16.
 * That is not beyond the end of raw pixel x at 8 w + 8 x + 8, so no later pixel
 * is overwritten.  Levels of 8 bits come as 257 times themselves, so their
 * quotient by 65535 is the one by 255. */
static void widen_row(const snow_image *image, int y) {
    const unsigned char *raw = raw_row(image, y);
    float *out = image->pixels + 4 * (size_t)image->width * (size_t)y;
    for (int x = 0; x < image->width; x++, raw += 8, out += 4) {
        double samples[4];
        for (int c = 0; c < 4; c++)
            samples[c] = (raw[2 * c] << 8 | raw[2 * c + 1]) / 65535.0;
        for (int c = 0; c < 3; c++)
            out[c] = (float)(samples[c] * samples[3]);
        out[3] = (float)samples[3];
    }
}

/* Every failure in libpng returns here, once; the caller frees *image if it is
 * not NULL. */
static snow_status run_reader(snow_png *job, snow_image **image) {
    if (setjmp(job->jump))
        return job->status;
    /* libpng will give 8 bytes per pixel: red, green, blue, alpha, 16 bits, the
     * high byte first. */
    SNOW_TRY(snow_png_begin(job, SNOW_IMAGE_SIDE));
    png_set_expand_16(job->png);
    png_set_gray_to_rgb(job->png);
    png_set_add_alpha(job->png, 0xffff, PNG_FILLER_AFTER);
    SNOW_TRY(snow_image_make(
        job->context, (int)png_get_image_width(job->png, job->info),
        (int)png_get_image_height(job->png, job->info), 4, image));
    read_rows(job, *image);
    return SNOW_STATUS_OK;
}

static snow_status read_png(snow_source *source, snow_image **out) {
    SNOW_TRY(check_header(source));
    snow_context *context = snow_source_context(source);
    char prefix[SNOW_MESSAGE_BYTES];
    snprintf(prefix, sizeof prefix, "%s: the PNG file is damaged",
             snow_source_name(source));
    snow_png job = {.context = context,
                    .refusal = SNOW_STATUS_BAD_INPUT,
                    .prefix = prefix,
                    .remedy = "get it again",
                    .source = source};
    snow_image *image = NULL;
    snow_status status = run_reader(&job, &image);
    png_destroy_read_struct(&job.png, &job.info, NULL);
    if (status != SNOW_STATUS_OK) {
        snow_image_free(image);
        return status;
    }
    for (int y = 0; y < image->height; y++)
        widen_row(image, y);
    *out = image;
    return SNOW_STATUS_OK;
}

const snow_image_format snow_image_png = {
    .name = "PNG",
    .suffix = ".png",
    .bits = 16,
    .write = write_png,
    .probe = snow_png_probe,
    .read = read_png,
};
