/* formats/png/png.c - PNG images as slices: .png, usually in folders.
 *
 * Samples are read as stored, with 8 or 16 bits; fewer bits become 8 with the
 * same number, and palettes are not applied.  Colours and opacity are
 * channels. */
#include "io/png.h"
#include "formats/array.h"

#include <string.h>

typedef struct png_reader {
    snow_png job;
    unsigned char *row; /* one row, or all if they are interlaced */
} png_reader;

typedef struct png_shape {
    int64_t width, height;
    int depth, samples;
    bool interlaced;
} png_shape;

/* --- header --------------------------------------------------------------- */

/* Checks before libpng that the file can hold its sizes, while nothing is
 * allocated. */
static snow_status read_shape(snow_source *source, png_shape *out) {
    static const int samples[7] = {1, 0, 3, 1, 2, 0, 4};
    snow_context *context = snow_source_context(source);
    unsigned char start[SNOW_PNG_HEADER_BYTES];
    size_t got;
    SNOW_TRY(snow_source_peek(source, start, sizeof start, &got));
    if (got < sizeof start || !snow_png_probe(start, got) ||
        memcmp(start + 12, "IHDR", 4) != 0 || start[25] > 6 ||
        !samples[start[25]])
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is truncated or damaged in its header, or not a PNG "
                         "file although its name says so; get it again");
    int64_t sides[2];
    snow_png_sides(start, sides);
    *out = (png_shape){.width = sides[0],
                       .height = sides[1],
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

/* Rows after the box are read as well: the checksum comes last. */
static void read_rows(png_reader *reader, const png_shape *shape,
                      int64_t channel, const snow_region *region,
                      unsigned char *out) {
    const size_t size = shape->depth == 16 ? 2 : 1;
    const size_t bytes = (size_t)(shape->width * shape->samples) * size;
    png_structp png = reader->job.png;
    png_set_packing(png);
    const int passes = png_set_interlace_handling(png);
    if (size == 2 && !snow_machine_big_endian())
        png_set_swap(png);
    png_read_update_info(png, reader->job.info);
    if (png_get_rowbytes(png, reader->job.info) != bytes)
        png_error(png, "unexpected row size");
    for (int pass = 0; pass < passes; pass++)
        for (int64_t y = 0; y < shape->height; y++) {
            unsigned char *row =
                reader->row + (shape->interlaced ? (size_t)y * bytes : 0);
            int64_t wanted = y - region->first[1];
            png_read_row(png, row, NULL);
            if (pass == passes - 1 && wanted >= 0 &&
                wanted < region->count[1]) {
                const unsigned char *from =
                    row + size * (size_t)(region->first[0] * shape->samples +
                                          channel);
                unsigned char *to =
                    out + size * (size_t)(wanted * region->count[0]);
                for (int64_t x = 0; x < region->count[0]; x++)
                    memcpy(to + (size_t)x * size,
                           from + (size_t)(x * shape->samples) * size, size);
            }
        }
    png_read_end(png, NULL);
}

/* Every failure in libpng returns here, once. */
static snow_status run_reader(png_reader *reader, const png_shape *shape,
                              int64_t channel, const snow_region *region,
                              unsigned char *out) {
    snow_png *job = &reader->job;
    if (setjmp(job->jump))
        return job->status;
    SNOW_TRY(snow_png_begin(job, INT32_MAX));
    read_rows(reader, shape, channel, region, out);
    return snow_source_finish(job->source);
}

static snow_status read_pixels(snow_source *source, const png_shape *shape,
                               int64_t channel, const snow_region *region,
                               unsigned char *out) {
    snow_context *context = snow_source_context(source);
    png_reader reader = {.job = {.context = context,
                                 .refusal = SNOW_STATUS_BAD_INPUT,
                                 .prefix = "is a damaged PNG file",
                                 .remedy = "get it again",
                                 .source = source}};
    uint64_t bytes = (uint64_t)(shape->width * shape->samples) * 2;
    if (shape->interlaced &&
        !snow_mul_u64(bytes, (uint64_t)shape->height, &bytes))
        bytes = UINT64_MAX;
    reader.row = snow_allocate_array(context, bytes, 1);
    if (!reader.row)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = run_reader(&reader, shape, channel, region, out);
    png_destroy_read_struct(&reader.job.png, &reader.job.info, NULL);
    snow_release(context, reader.row);
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
    return snow_volume_give(
        read_pixels(source, &shape, channel, &region, volume->owned), volume,
        out);
}

const snow_format snow_format_png = {
    .name = "png",
    .text = "PNG slices in a folder or by a pattern (.png)",
    .suffixes = {".png"},
    .probe = snow_png_probe,
    .crops = true,
    .channels = true,
    .slices = true,
    .read = read_png,
};
