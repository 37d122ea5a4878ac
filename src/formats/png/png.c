/* formats/png/png.c - PNG images as slices: .png, usually in folders.
 *
 * Samples are read as stored, with 8 or 16 bits; fewer bits become 8 with the
 * same number, and palettes are not applied.  Colours and opacity are
 * channels. */
#include "formats/array.h"

#include <png.h>
#include <setjmp.h>
#include <string.h>

/* IHDR, which comes first: after the signature, a length and a name. */
#define HEADER_BYTES 29

typedef struct png_reader {
    snow_context *context;
    snow_source *source;
    snow_status status; /* why libpng failed, SNOW_STATUS_OK before */
    png_structp png;
    png_infop info;
    int passes;
    unsigned char *row; /* one row, or all if they are interlaced */
    jmp_buf jump;
} png_reader;

typedef struct png_shape {
    int64_t width, height;
    int depth, samples;
    bool interlaced;
} png_shape;

static bool probe_png(const unsigned char *bytes, size_t size) {
    return size >= 8 && png_sig_cmp(bytes, 0, 8) == 0;
}

/* --- between libpng and the library --------------------------------------- */

static void *allocate_block(png_structp png, png_alloc_size_t bytes) {
    png_reader *reader = png_get_mem_ptr(png);
    void *block = snow_allocate(reader->context, bytes);
    if (!block)
        reader->status = SNOW_STATUS_NO_MEMORY;
    return block;
}

static void release_block(png_structp png, void *block) {
    png_reader *reader = png_get_mem_ptr(png);
    snow_release(reader->context, block);
}

static void leave(png_reader *reader, snow_status status) {
    if (reader->status == SNOW_STATUS_OK)
        reader->status = status;
    longjmp(reader->jump, 1);
}

static void note_error(png_structp png, png_const_charp text) {
    png_reader *reader = png_get_error_ptr(png);
    if (reader->status == SNOW_STATUS_OK)
        snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                  "is a damaged PNG file (libpng: %s); get it again", text);
    leave(reader, SNOW_STATUS_BAD_INPUT);
}

static void note_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

static void read_bytes(png_structp png, png_bytep bytes, size_t size) {
    png_reader *reader = png_get_io_ptr(png);
    snow_status status =
        snow_source_read_all(reader->source, bytes, size, "the pixels");
    if (status != SNOW_STATUS_OK)
        leave(reader, status);
}

/* --- header --------------------------------------------------------------- */

static int64_t big_endian_32(const unsigned char *bytes) {
    return (int64_t)bytes[0] << 24 | (int64_t)bytes[1] << 16 |
           (int64_t)bytes[2] << 8 | bytes[3];
}

/* Checks before libpng that the file can hold its sizes, while nothing is
 * allocated. */
static snow_status read_shape(snow_source *source, png_shape *out) {
    static const int samples[7] = {1, 0, 3, 1, 2, 0, 4};
    snow_context *context = snow_source_context(source);
    unsigned char start[HEADER_BYTES];
    size_t got;
    SNOW_TRY(snow_source_peek(source, start, sizeof start, &got));
    if (got < sizeof start || !probe_png(start, got) ||
        memcmp(start + 12, "IHDR", 4) != 0 || start[25] > 6 ||
        !samples[start[25]])
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is truncated or damaged in its header, or not a PNG "
                         "file although its name says so; get it again");
    *out = (png_shape){.width = big_endian_32(start + 16),
                       .height = big_endian_32(start + 20),
                       .depth = start[24],
                       .samples = samples[start[25]],
                       .interlaced = start[28] != 0};
    uint64_t bits;
    if (out->width < 1 || out->height < 1 || out->width > INT32_MAX ||
        out->height > INT32_MAX ||
        !snow_mul_u64((uint64_t)out->width * (uint64_t)out->height,
                      (uint64_t)(out->depth * out->samples), &bits))
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "has invalid sizes of %lldx%lld pixels; get the file again",
            (long long)out->width, (long long)out->height);
    return snow_source_expect(source, bits / 8 / SNOW_DEFLATE_RATIO,
                              "the pixels");
}

/* --- pixels --------------------------------------------------------------- */

/* Checks every checksum, and reads rows as stored, in the machine's byte
 * order. */
static void begin_reading(png_reader *reader, const png_shape *shape) {
    png_structp png = reader->png;
    png_set_read_fn(png, reader, read_bytes);
    png_set_user_limits(png, INT32_MAX, INT32_MAX);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    png_set_benign_errors(png, 0);
    png_read_info(png, reader->info);
    png_set_packing(png);
    reader->passes = png_set_interlace_handling(png);
    if (shape->depth == 16 && !snow_machine_big_endian())
        png_set_swap(png);
    png_read_update_info(png, reader->info);
}

/* Rows after the box are read as well: the checksum comes last. */
static void read_rows(png_reader *reader, const png_shape *shape,
                      int64_t channel, const snow_region *region,
                      unsigned char *out) {
    size_t bytes =
        (size_t)(shape->width * shape->samples) * (shape->depth == 16 ? 2 : 1);
    if (png_get_rowbytes(reader->png, reader->info) != bytes)
        png_error(reader->png, "unexpected row size");
    for (int pass = 0; pass < reader->passes; pass++)
        for (int64_t y = 0; y < shape->height; y++) {
            unsigned char *row =
                reader->row + (shape->interlaced ? (size_t)y * bytes : 0);
            int64_t wanted = y - region->first[1];
            png_read_row(reader->png, row, NULL);
            if (pass == reader->passes - 1 && wanted >= 0 &&
                wanted < region->count[1]) {
                size_t size = shape->depth == 16 ? 2 : 1;
                for (int64_t x = 0; x < region->count[0]; x++)
                    memcpy(
                        (out + (size_t)(wanted * region->count[0]) *
                                   (shape->depth == 16 ? 2 : 1)) +
                            (size_t)x * size,
                        row + (size_t)((region->first[0] + x) * shape->samples +
                                       channel) *
                                  size,
                        size);
            }
        }
    png_read_end(reader->png, NULL);
}

/* Every failure in libpng returns here, once. */
static snow_status run_reader(png_reader *reader, const png_shape *shape,
                              int64_t channel, const snow_region *region,
                              unsigned char *out) {
    if (setjmp(reader->jump))
        return reader->status;
    reader->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, reader,
                                           note_error, note_warning, reader,
                                           allocate_block, release_block);
    if (reader->png)
        reader->info = png_create_info_struct(reader->png);
    if (!reader->info)
        return reader->status != SNOW_STATUS_OK
                   ? reader->status
                   : snow_fail(reader->context, SNOW_STATUS_FAILED,
                               "libpng %s is not the version for which this "
                               "was built; install %s",
                               png_get_libpng_ver(NULL), PNG_LIBPNG_VER_STRING);
    begin_reading(reader, shape);
    read_rows(reader, shape, channel, region, out);
    return snow_source_finish(reader->source);
}

static snow_status read_pixels(snow_source *source, const png_shape *shape,
                               int64_t channel, const snow_region *region,
                               unsigned char *out) {
    png_reader reader = {.context = snow_source_context(source),
                         .source = source};
    uint64_t bytes = (uint64_t)(shape->width * shape->samples) * 2;
    if (shape->interlaced &&
        !snow_mul_u64(bytes, (uint64_t)shape->height, &bytes))
        bytes = UINT64_MAX;
    reader.row = snow_allocate_array(reader.context, bytes, 1);
    if (!reader.row)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = run_reader(&reader, shape, channel, region, out);
    png_destroy_read_struct(&reader.png, &reader.info, NULL);
    snow_release(reader.context, reader.row);
    return status;
}

static snow_status read_png(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    png_shape shape;
    snow_region region;
    int64_t channel;
    *info = snow_volume_info_default("png");
    snow_image_turn(info->matrix);
    SNOW_TRY(read_shape(source, &shape));
    info->dims[0] = shape.width;
    info->dims[1] = shape.height;
    info->type = shape.depth == 16 ? SNOW_TYPE_UINT16 : SNOW_TYPE_UINT8;
    snow_channels_begin(info, shape.samples, false);
    if (shape.samples > 2)
        snow_channels_are_colors(info);
    SNOW_TRY(snow_volume_pick_channel(context, options, shape.samples, info,
                                      &channel));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    SNOW_TRY(snow_region_lay_out(context, options, info, &region));
    if (!out)
        return SNOW_STATUS_OK;
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(context, info, &volume));
    snow_status status =
        read_pixels(source, &shape, channel, &region, volume->owned);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_STATUS_OK;
}

const snow_format snow_format_png = {
    .name = "png",
    .text = "PNG slices in a folder or by a pattern (.png)",
    .suffixes = {".png"},
    .probe = probe_png,
    .crops = true,
    .channels = true,
    .slices = true,
    .read = read_png,
};
