/* image/jpeg.c - JPEG files, by libjpeg-turbo: 8 bits per channel, lossy, and
 * without alpha.
 *
 * A picture is laid on its background, black if it has none, as by a viewer
 * that knows no alpha.  Quality 92 without subsampling of colours keeps thin
 * letters and edges of colour clean. */
#include "image/image.h"

#include "io/jpeg.h"
#include "io/seekable.h"

#if SNOW_HAVE_JPEG

#define QUALITY 92
#define BUFFER_BYTES 65536

/* --- writing -------------------------------------------------------------- */

typedef struct jpeg_target {
    struct jpeg_destination_mgr base;
    snow_writer *writer;
    snow_status status;
    unsigned char bytes[BUFFER_BYTES];
} jpeg_target;

static void begin_target(j_compress_ptr info) {
    jpeg_target *target = (jpeg_target *)info->dest;
    target->base.next_output_byte = target->bytes;
    target->base.free_in_buffer = sizeof target->bytes;
}

static boolean empty_target(j_compress_ptr info) {
    jpeg_target *target = (jpeg_target *)info->dest;
    if (target->status == SNOW_STATUS_OK)
        target->status = snow_writer_write(target->writer, target->bytes,
                                           sizeof target->bytes);
    begin_target(info);
    return TRUE;
}

static void end_target(j_compress_ptr info) {
    jpeg_target *target = (jpeg_target *)info->dest;
    if (target->status == SNOW_STATUS_OK)
        target->status = snow_writer_write(target->writer, target->bytes,
                                           sizeof target->bytes -
                                               target->base.free_in_buffer);
}

/* Ends early with the target's status. */
static void compress(snow_levels *levels, struct jpeg_compress_struct *info,
                     jpeg_target *target) {
    info->image_width = (JDIMENSION)levels->image->width;
    info->image_height = (JDIMENSION)levels->image->height;
    info->input_components = levels->samples;
    info->in_color_space = levels->samples == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(info);
    jpeg_set_quality(info, QUALITY, TRUE);
    info->dct_method = JDCT_ISLOW; /* the same bytes on every machine */
    info->comp_info[0].h_samp_factor = info->comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(info, TRUE);
    for (int y = 0; y < levels->image->height; y++) {
        JSAMPROW row = (JSAMPROW)snow_levels_row(levels, y);
        jpeg_write_scanlines(info, &row, 1);
        if (target->status == SNOW_STATUS_OK)
            target->status = snow_image_report(levels->image, y);
        if (target->status != SNOW_STATUS_OK)
            return;
    }
    jpeg_finish_compress(info);
}

static snow_status write_jpeg(const snow_image *image,
                              const snow_image_options *given,
                              snow_writer *writer) {
    snow_image_options options = *given;
    if (!options.flatten)
        memset(options.background, 0, sizeof options.background);
    options.flatten = true;
    snow_levels levels;
    snow_jpeg_fault fault;
    struct jpeg_compress_struct info = {.err = snow_jpeg_begin_faults(&fault)};
    jpeg_target *target =
        snow_allocate_array(image->context, 1, sizeof *target);
    snow_status status = snow_levels_begin(image, &options, false, &levels);
    if (!target)
        status = SNOW_STATUS_NO_MEMORY;
    if (status == SNOW_STATUS_OK && setjmp(fault.out))
        status = snow_fail(image->context, SNOW_STATUS_FAILED,
                           "the JPEG file cannot be written (libjpeg: %s); "
                           "write a .png instead",
                           fault.text);
    else if (status == SNOW_STATUS_OK) {
        target->base =
            (struct jpeg_destination_mgr){.init_destination = begin_target,
                                          .empty_output_buffer = empty_target,
                                          .term_destination = end_target};
        target->writer = writer;
        target->status = SNOW_STATUS_OK;
        jpeg_create_compress(&info);
        info.dest = &target->base;
        compress(&levels, &info, target);
    }
    if (status == SNOW_STATUS_OK)
        status = target->status;
    jpeg_destroy_compress(&info);
    snow_levels_end(&levels);
    snow_release(image->context, target);
    return status;
}

/* --- reading -------------------------------------------------------------- */

static snow_status fail_jpeg(const snow_source *source, const char *reason) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s: the JPEG file is damaged, truncated or of an unusual "
                     "kind (libjpeg: %s); give a PNG",
                     snow_source_name(source), reason);
}

/* The bytes lie in the second half of their row of floats: pixel x ends at byte
 * 16 x + 16, its three bytes begin at 13 w + 3 x, which is not before. */
static void widen_to_floats(float *out, int width) {
    const unsigned char *raw = (const unsigned char *)out + 13 * (size_t)width;
    for (int x = 0; x < width; x++, raw += 3, out += 4) {
        const float rgb[3] = {(float)(raw[0] / 255.0), (float)(raw[1] / 255.0),
                              (float)(raw[2] / 255.0)};
        memcpy(out, rgb, sizeof rgb);
        out[3] = 1;
    }
}

/* The picture belongs to the caller, so that a jump loses nothing. */
static snow_status decode(const snow_source *source, const unsigned char *bytes,
                          size_t size, snow_jpeg_fault *fault,
                          struct jpeg_decompress_struct *info,
                          snow_image **out) {
    if (setjmp(fault->out))
        return fail_jpeg(source, fault->text);
    jpeg_create_decompress(info);
    info->mem->max_memory_to_use = SNOW_JPEG_COEFFICIENT_BYTES;
    jpeg_mem_src(info, bytes, (unsigned long)size);
    jpeg_read_header(info, TRUE);
    info->out_color_space = JCS_RGB;
    info->dct_method = JDCT_ISLOW;
    SNOW_TRY(
        snow_image_check_sides(source, info->image_width, info->image_height));
    SNOW_TRY(snow_image_make(snow_source_context(source),
                             (int)info->image_width, (int)info->image_height, 4,
                             out));
    jpeg_start_decompress(info);
    for (size_t y = 0; y < info->image_height; y++) {
        size_t width = info->image_width;
        float *line = (*out)->pixels + 4 * width * y;
        JSAMPROW row = (JSAMPROW)line + 13 * width;
        jpeg_read_scanlines(info, &row, 1);
        widen_to_floats(line, (int)width);
    }
    jpeg_finish_decompress(info);
    return SNOW_STATUS_OK;
}

/* The decoder needs all bytes in one block. */
static snow_status read_jpeg(snow_source *source, snow_image **out) {
    snow_context *context = snow_source_context(source);
    snow_seekable *store = NULL;
    snow_image *image = NULL;
    snow_jpeg_fault fault;
    struct jpeg_decompress_struct info = {.err =
                                              snow_jpeg_begin_faults(&fault)};
    SNOW_TRY(snow_seekable_open(source, &store));
    uint64_t size = snow_seekable_size(store);
    unsigned char *bytes = snow_allocate_array(context, size + 1, 1);
    snow_status status = bytes ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    if (bytes && snow_seekable_read(store, 0, bytes, (size_t)size) != size)
        status = fail_jpeg(source, "it cannot be read to its end");
    if (status == SNOW_STATUS_OK)
        status = decode(source, bytes, (size_t)size, &fault, &info, &image);
    jpeg_destroy_decompress(&info);
    snow_release(context, bytes);
    snow_seekable_close(store);
    if (status == SNOW_STATUS_OK) {
        image->alpha_unknown = true;
        *out = image;
    } else
        snow_image_free(image);
    return status;
}

const snow_image_format snow_image_jpeg = {.name = "JPEG",
                                           .suffix = ".jpg",
                                           .other = ".jpeg",
                                           .bits = 8,
                                           .write = write_jpeg,
                                           .probe = snow_jpeg_probe,
                                           .read = read_jpeg,
                                           .in_any_order = true};

#else

const snow_image_format snow_image_jpeg = {.name = "JPEG",
                                           .suffix = ".jpg",
                                           .other = ".jpeg",
                                           .bits = 8,
                                           .package = "libjpeg62-turbo-dev",
                                           .probe = snow_jpeg_probe};

#endif
