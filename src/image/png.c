/* image/png.c - PNG files, written and read by libpng.
 *
 * Writes 8 or 16 bits per channel with straight alpha, or without alpha if the
 * picture is placed on a background.  Values are written as they are, without a
 * chunk about their meaning.  Reads every kind of PNG, as 16 bits per channel,
 * with alpha multiplied in; checksums must be right, and chunks other than the
 * picture are ignored.
 *
 * libpng allocates from the context, and leaves by longjmp on errors.  To lose
 * no variable, everything that must survive is in a `png_job` of the function
 * above the one that calls setjmp. */
#include "image/image.h"

#include <assert.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

static_assert(sizeof(float) == 4, "16-bit pixels are read behind float ones");

typedef struct png_job {
    snow_context *context;
    snow_status status;  /* why libpng failed, SNOW_STATUS_OK before */
    snow_status refusal; /* the status of libpng's own errors */
    const char *prefix;  /* the beginning of their messages */
    const char *remedy;  /* and their end */
    const char *comment; /* when writing; NULL: none */
    snow_source *source; /* when reading */
    snow_writer *writer; /* when writing */
    png_structp png;
    png_infop info;
    jmp_buf jump;
} png_job;

/* --- between libpng and the library --------------------------------------- */

/* Replaces malloc, also for zlib's state.  libpng may continue without the
 * block, or report an error; the status is kept for that case. */
static void *allocate_block(png_structp png, png_alloc_size_t bytes) {
    png_job *job = png_get_mem_ptr(png);
    void *block = snow_allocate(job->context, bytes);
    if (!block)
        job->status = SNOW_STATUS_NO_MEMORY;
    return block;
}

static void release_block(png_structp png, void *block) {
    png_job *job = png_get_mem_ptr(png);
    snow_release(job->context, block);
}

/* Leaves libpng after an error that already has its message. */
static void leave(png_job *job, snow_status status) {
    if (job->status == SNOW_STATUS_OK)
        job->status = status;
    longjmp(job->jump, 1);
}

/* Handles libpng's errors.  A failure below libpng (memory, the file) has a
 * more specific message. */
static void note_error(png_structp png, png_const_charp text) {
    png_job *job = png_get_error_ptr(png);
    if (job->status == SNOW_STATUS_OK)
        snow_fail(job->context, job->refusal, "%s (libpng: %s); %s",
                  job->prefix, text, job->remedy);
    leave(job, job->refusal);
}

/* Ignores warnings: they change nothing in the pixels. */
static void note_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

/* Sources and writers transfer all bytes, or fail with a message. */
static void read_bytes(png_structp png, png_bytep bytes, size_t size) {
    png_job *job = png_get_io_ptr(png);
    snow_status status =
        snow_source_read_all(job->source, bytes, size, "the PNG data");
    if (status != SNOW_STATUS_OK)
        leave(job, status);
}

static void write_bytes(png_structp png, png_bytep bytes, size_t size) {
    png_job *job = png_get_io_ptr(png);
    snow_status status = snow_writer_write(job->writer, bytes, size);
    if (status != SNOW_STATUS_OK)
        leave(job, status);
}

/* The writer flushes when it commits. */
static void flush_nothing(png_structp png) {
    (void)png;
}

/* libpng returned no structure: out of memory, or it is not the libpng of the
 * headers that this was built with. */
static snow_status refuse_library(png_job *job) {
    if (job->status != SNOW_STATUS_OK)
        return job->status;
    return snow_fail(job->context, SNOW_STATUS_FAILED,
                     "libpng %s is not compatible with %s, for which this was "
                     "built; install the latter",
                     png_get_libpng_ver(NULL), PNG_LIBPNG_VER_STRING);
}

/* --- writing -------------------------------------------------------------- */

/* A page's libpng is built without texts. */
static void set_comment(png_job *job) {
#ifdef PNG_WRITE_tEXt_SUPPORTED
    char *text = (char *)(uintptr_t)job->comment, key[] = "Snowglass";
    png_text chunk = {
        .compression = PNG_TEXT_COMPRESSION_NONE, .key = key, .text = text};
    if (text)
        png_set_text(job->png, job->info, &chunk, 1);
#else
    (void)job;
#endif
}

/* Level 1, the filter "up" and only runs (Z_RLE) were measured as the best
 * trade-off for renderings: as fast as deflate's quickest matching at 8 bits
 * and a third faster at 16, in somewhat less space.  Level 6 takes four times
 * as long for a fifth less. */
static void write_header(png_job *job, snow_levels *levels) {
    static const int types[] = {0, PNG_COLOR_TYPE_GRAY,
                                PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
    png_set_write_fn(job->png, job, write_bytes, flush_nothing);
    png_set_compression_level(job->png, 1);
    png_set_compression_strategy(job->png, Z_RLE);
    png_set_filter(job->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_compression_buffer_size(job->png, 1 << 16);
    png_set_IHDR(job->png, job->info, (png_uint_32)levels->image->width,
                 (png_uint_32)levels->image->height, levels->bits,
                 types[levels->samples], PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    set_comment(job);
    png_write_info(job->png, job->info);
}

/* Every failure in libpng returns here, once. */
static snow_status run_writer(png_job *job, snow_levels *levels) {
    if (setjmp(job->jump))
        return job->status;
    job->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, job, note_error,
                                         note_warning, job, allocate_block,
                                         release_block);
    if (job->png)
        job->info = png_create_info_struct(job->png);
    if (!job->info)
        return refuse_library(job);
    write_header(job, levels);
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
    png_job job = {.context = image->context,
                   .refusal = SNOW_STATUS_FAILED,
                   .prefix = "the PNG file cannot be written",
                   .remedy = "write a .npy instead",
                   .comment = options->comment,
                   .writer = writer};
    snow_status status = snow_levels_begin(image, options, false, &levels);
    if (status == SNOW_STATUS_OK)
        status = run_writer(&job, &levels);
    png_destroy_write_struct(&job.png, &job.info);
    snow_levels_end(&levels);
    return status;
}

/* --- reading -------------------------------------------------------------- */

static bool probe_png(const unsigned char *bytes, size_t size) {
    return size >= 8 && png_sig_cmp(bytes, 0, 8) == 0;
}

static uint32_t big_endian_32(const unsigned char *bytes) {
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 |
           (uint32_t)bytes[2] << 8 | bytes[3];
}

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
    uint64_t width = big_endian_32(start + 16);
    uint64_t height = big_endian_32(start + 20);
    SNOW_TRY(snow_image_check_sides(source, (int64_t)width, (int64_t)height));
    /* Bits per pixel in the file, from IHDR's depth and colour type; the
     * smallest possible for combinations that libpng will refuse. */
    static const unsigned char samples[7] = {1, 1, 3, 1, 2, 1, 4};
    uint64_t bits = width * height *
                    (start[24] >= 1 && start[24] <= 16 && start[25] < 7
                         ? start[24] * samples[start[25]]
                         : 1);
    return snow_source_expect(source, bits / 8 / 1032, "the pixels");
}

/* Reads everything before the pixels.  libpng will give 8 bytes per pixel: red,
 * green, blue, alpha, 16 bits, the high byte first. */
static void begin_reading(png_job *job) {
    png_structp png = job->png;
    png_set_read_fn(png, job, read_bytes);
    png_set_user_limits(png, SNOW_IMAGE_SIDE, SNOW_IMAGE_SIDE);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    /* -1: all chunks but IHDR, PLTE, tRNS, IDAT and IEND */
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    /* An error that libpng would forgive, such as a wrong Adler-32, is an
     * error. */
    png_set_benign_errors(png, 0);
    png_read_info(png, job->info);
    png_set_expand_16(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
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
static void read_rows(png_job *job, const snow_image *image) {
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
static snow_status run_reader(png_job *job, snow_image **image) {
    if (setjmp(job->jump))
        return job->status;
    job->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, job, note_error,
                                        note_warning, job, allocate_block,
                                        release_block);
    if (job->png)
        job->info = png_create_info_struct(job->png);
    if (!job->info)
        return refuse_library(job);
    begin_reading(job);
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
    png_job job = {.context = context,
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
    .probe = probe_png,
    .read = read_png,
};
