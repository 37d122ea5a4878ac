/* image/exr.c - OpenEXR files, by the core library of OpenEXR 3 (in C).
 *
 * Writes one part of scan lines with ZIP compression.  Its channels are A, B,
 * G, R of 32-bit floats, premultiplied as the format requires, or Y for values
 * in data units, and Z for depth.  The format expects linear light; our values
 * are written as they are.  Reads parts of scan lines with any compression,
 * channels R, G, B, A or Y, also halves and integers; other channels are
 * ignored.
 *
 * The library allocates its own memory, which no context counts: one chunk of
 * 16 lines at a time. */
#include "image/image.h"

#include "io/memory_file.h"
#include "io/seekable.h"

static bool probe_exr(const unsigned char *bytes, size_t size) {
    return size >= 4 && bytes[0] == 0x76 && bytes[1] == 0x2f &&
           bytes[2] == 0x31 && bytes[3] == 0x01;
}

#if SNOW_HAVE_EXR

#include <openexr.h>
#include <stdio.h>

/* The state for the library's callbacks. */
typedef struct exr_file {
    snow_context *context;
    exr_context_t exr;
    snow_memory_file store; /* when writing */
    snow_seekable *bytes;   /* when reading */
    snow_status status;     /* of our functions below the library */
    char complaint[200];
} exr_file;

/* The first error is the most specific. */
static void note_error(exr_const_context_t exr, exr_result_t code,
                       const char *text) {
    void *user = NULL;
    exr_get_user_data(exr, &user);
    exr_file *file = user;
    (void)code;
    if (file && !*file->complaint)
        snprintf(file->complaint, sizeof file->complaint, "%s", text);
}

/* While a file is written, OpenEXR reports errors with its lock held, for which
 * every question about the file waits for ever.  The code says enough. */
static void ignore_error(exr_const_context_t exr, exr_result_t code,
                         const char *text) {
    (void)exr;
    (void)code;
    (void)text;
}

static int64_t write_bytes(exr_const_context_t exr, void *user,
                           const void *bytes, uint64_t size, uint64_t at,
                           exr_stream_error_func_ptr_t fail) {
    exr_file *file = user;
    (void)exr;
    (void)fail;
    file->status = snow_memory_file_put(&file->store, at, bytes, (size_t)size);
    return file->status == SNOW_STATUS_OK ? (int64_t)size : -1;
}

static int64_t read_bytes(exr_const_context_t exr, void *user, void *bytes,
                          uint64_t size, uint64_t at,
                          exr_stream_error_func_ptr_t fail) {
    exr_file *file = user;
    (void)exr;
    (void)fail;
    return (int64_t)snow_seekable_read(file->bytes, at, bytes, (size_t)size);
}

static int64_t set_size(exr_const_context_t exr, void *user) {
    (void)exr;
    return (int64_t)snow_seekable_size(((exr_file *)user)->bytes);
}

static exr_context_initializer_t hooks_of(exr_file *file) {
    exr_context_initializer_t hooks = EXR_DEFAULT_CONTEXT_INITIALIZER;
    hooks.error_handler_fn = note_error;
    hooks.user_data = file;
    hooks.read_fn = read_bytes;
    hooks.size_fn = set_size;
    hooks.write_fn = write_bytes;
    hooks.max_image_width = hooks.max_image_height = SNOW_IMAGE_SIDE;
    return hooks;
}

/* --- writing -------------------------------------------------------------- */

/* Samples of a pixel for writing: red, green, blue (or the value), alpha,
 * depth. */
#define SAMPLES 5

/* Channels in the order of their names, as the format requires, and the sample
 * of a pixel for each. */
typedef struct exr_channel {
    const char *name;
    int sample;
} exr_channel;

static const exr_channel channels[] = {
    {"A", 3}, {"B", 2}, {"G", 1}, {"R", 0}, {"Z", 4}};
static const exr_channel value_channels[] = {{"Y", 0}, {"Z", 4}};

/* A picture and its depth. */
typedef struct exr_content {
    const snow_image *image, *depth; /* NULL: none */
    const exr_channel *channels;
    int count; /* number of channels */
} exr_content;

static exr_result_t begin_part(exr_file *file, const exr_content *content) {
    int part = 0;
    exr_result_t code =
        exr_add_part(file->exr, "picture", EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(
            file->exr, part, content->image->width, content->image->height,
            EXR_COMPRESSION_ZIP);
    for (int n = 0; n < content->count && code == EXR_ERR_SUCCESS; n++)
        code = exr_add_channel(file->exr, part, content->channels[n].name,
                               EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1);
    return code == EXR_ERR_SUCCESS ? exr_write_header(file->exr) : code;
}

/* Fills lines from y on. */
static void fill_lines(const exr_content *content, int y, int count,
                       float *out) {
    size_t width = (size_t)content->image->width, first = (size_t)y * width;
    for (size_t i = 0; i < (size_t)count * width; i++, out += SAMPLES) {
        snow_image_rgba(content->image, first + i, out);
        out[4] = content->depth ? content->depth->pixels[first + i] : 0;
    }
}

static exr_result_t write_chunk(exr_file *file, int y, const float *lines,
                                const exr_content *content,
                                exr_encode_pipeline_t *pipe) {
    exr_chunk_info_t info;
    exr_result_t code = exr_write_scanline_chunk_info(file->exr, 0, y, &info);
    if (code != EXR_ERR_SUCCESS)
        return code;
    code = y == 0 ? exr_encoding_initialize(file->exr, 0, &info, pipe)
                  : exr_encoding_update(file->exr, 0, &info, pipe);
    if (code != EXR_ERR_SUCCESS)
        return code;
    for (int n = 0; n < pipe->channel_count; n++) {
        exr_coding_channel_info_t *channel = &pipe->channels[n];
        channel->encode_from_ptr =
            (const uint8_t *)(lines + content->channels[n].sample);
        channel->user_bytes_per_element = 4;
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = 4 * SAMPLES;
        channel->user_line_stride = 4 * SAMPLES * content->image->width;
    }
    if (y == 0)
        code = exr_encoding_choose_default_routines(file->exr, 0, pipe);
    return code == EXR_ERR_SUCCESS ? exr_encoding_run(file->exr, 0, pipe)
                                   : code;
}

static exr_result_t write_lines(exr_file *file, const exr_content *content,
                                float *lines, int at_once) {
    int height = content->image->height;
    exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int y = 0; y < height && code == EXR_ERR_SUCCESS; y += at_once) {
        int rest = height - y;
        fill_lines(content, y, rest < at_once ? rest : at_once, lines);
        file->status = snow_image_report(content->image, y);
        code = file->status == SNOW_STATUS_OK
                   ? write_chunk(file, y, lines, content, &pipe)
                   : EXR_ERR_UNKNOWN;
    }
    exr_encoding_destroy(file->exr, &pipe);
    return code;
}

static snow_status make_file(exr_file *file, const exr_content *content) {
    exr_context_initializer_t hooks = hooks_of(file);
    hooks.error_handler_fn = ignore_error;
    int at_once = 0;
    float *lines = NULL;
    exr_result_t code = exr_start_write(&file->exr, "picture.exr",
                                        EXR_WRITE_FILE_DIRECTLY, &hooks);
    if (code == EXR_ERR_SUCCESS)
        code = begin_part(file, content);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_scanlines_per_chunk(file->exr, 0, &at_once);
    if (code == EXR_ERR_SUCCESS) {
        uint64_t pixels = (uint64_t)content->image->width * (uint64_t)at_once;
        lines = snow_allocate_array(file->context, pixels, 4 * SAMPLES);
        if (!lines)
            return SNOW_STATUS_NO_MEMORY;
        code = write_lines(file, content, lines, at_once);
    }
    snow_release(file->context, lines);
    if (code == EXR_ERR_SUCCESS)
        return SNOW_STATUS_OK;
    if (file->status != SNOW_STATUS_OK)
        return file->status;
    return snow_fail(
        file->context,
        code == EXR_ERR_OUT_OF_MEMORY ? SNOW_STATUS_NO_MEMORY
                                      : SNOW_STATUS_FAILED,
        "the EXR file cannot be written (OpenEXR: %s); write a .npy instead",
        exr_get_default_error_message(code));
}

static snow_status write_exr(const snow_image *image,
                             const snow_image_options *options,
                             snow_writer *writer) {
    exr_file file = {.context = image->context,
                     .store = {.context = image->context}};
    bool values = image->channels == 1;
    const exr_content content =
        (exr_content){.image = image,
                      .depth = options->depth,
                      .channels = values ? value_channels : channels,
                      .count = (values ? 1 : 4) + (options->depth != NULL)};
    snow_status status = make_file(&file, &content);
    if (file.exr)
        exr_finish(&file.exr);
    if (status == SNOW_STATUS_OK)
        status = snow_writer_write(writer, file.store.bytes, file.store.size);
    snow_memory_file_free(&file.store);
    return status;
}

/* --- reading -------------------------------------------------------------- */

/* A lower bound for the compressed bytes: the strongest, a lossy compression,
 * turns a block of 64 values into its share of a Deflate stream. */
#define PACKED_MOST (64 * SNOW_DEFLATE_RATIO)

static snow_status fail_exr(const exr_file *file, const snow_source *source) {
    return snow_fail(
        file->context, SNOW_STATUS_BAD_INPUT,
        "%s: is a damaged or truncated EXR file (OpenEXR: %s); get it again",
        snow_source_name(source),
        *file->complaint ? file->complaint : "no more bytes");
}

/* The index of a channel's sample: 0 to 3; -1 none; Y stands for all
 * colours. */
static int sample_of(const char *name, bool *grey) {
    *grey = name[0] == 'Y' && !name[1];
    if (*grey)
        return 0;
    for (int n = 0; n < 4; n++)
        if (name[0] == channels[n].name[0] && !name[1])
            return channels[n].sample;
    return -1;
}

/* The channels that the file has; grey is copied to all colours later. */
typedef struct exr_plan {
    int x0, y0, width, height;
    int at_once;
    bool grey, has_alpha;
} exr_plan;

static snow_status find_channels(const exr_file *file,
                                 const snow_source *source, exr_plan *plan) {
    const exr_attr_chlist_t *list = NULL;
    int colors = 0;
    if (exr_get_channels(file->exr, 0, &list) != EXR_ERR_SUCCESS)
        return fail_exr(file, source);
    for (int n = 0; n < list->num_channels; n++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[n];
        bool grey;
        int sample = sample_of(entry->name.str, &grey);
        if (sample < 0)
            continue;
        if (entry->x_sampling != 1 || entry->y_sampling != 1)
            colors = -9;
        plan->grey |= grey;
        plan->has_alpha |= sample == 3;
        colors += sample < 3 && !grey;
    }
    if (colors == 3 || (colors == 0 && plan->grey))
        return SNOW_STATUS_OK;
    return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                     "%s: has neither complete channels R, G and B nor Y "
                     "alone; give a file with these",
                     snow_source_name(source));
}

static snow_status read_header(const exr_file *file, const snow_source *source,
                               exr_plan *plan) {
    exr_storage_t storage;
    exr_attr_box2i_t box;
    int32_t at_once = 0;
    if (exr_get_storage(file->exr, 0, &storage) != EXR_ERR_SUCCESS ||
        exr_get_data_window(file->exr, 0, &box) != EXR_ERR_SUCCESS)
        return fail_exr(file, source);
    if (storage != EXR_STORAGE_SCANLINE)
        return snow_fail(
            file->context, SNOW_STATUS_BAD_INPUT,
            "%s: its first part is tiled or deep; give one with scan lines",
            snow_source_name(source));
    int64_t width = (int64_t)box.max.x - box.min.x + 1;
    int64_t height = (int64_t)box.max.y - box.min.y + 1;
    SNOW_TRY(snow_image_check_sides(source, width, height));
    if ((uint64_t)(width * height) / PACKED_MOST >
        snow_seekable_size(file->bytes))
        return fail_exr(file, source);
    if (exr_get_scanlines_per_chunk(file->exr, 0, &at_once) !=
            EXR_ERR_SUCCESS ||
        at_once < 1)
        return fail_exr(file, source);
    *plan = (exr_plan){.x0 = box.min.x,
                       .y0 = box.min.y,
                       .width = (int)width,
                       .height = (int)height,
                       .at_once = at_once};
    return find_channels(file, source, plan);
}

static exr_result_t read_chunk(const exr_file *file, const exr_plan *plan,
                               int y, float *pixels,
                               exr_decode_pipeline_t *pipe) {
    exr_chunk_info_t info;
    exr_result_t code =
        exr_read_scanline_chunk_info(file->exr, 0, plan->y0 + y, &info);
    if (code != EXR_ERR_SUCCESS)
        return code;
    code = y == 0 ? exr_decoding_initialize(file->exr, 0, &info, pipe)
                  : exr_decoding_update(file->exr, 0, &info, pipe);
    if (code != EXR_ERR_SUCCESS)
        return code;
    if (info.start_y != plan->y0 + y || info.width != plan->width ||
        info.height > plan->height - y)
        return EXR_ERR_CORRUPT_CHUNK;
    for (int n = 0; n < pipe->channel_count; n++) {
        exr_coding_channel_info_t *channel = &pipe->channels[n];
        bool grey;
        int sample = sample_of(channel->channel_name, &grey);
        if (sample < 0 || (grey && !plan->grey))
            continue;
        channel->decode_to_ptr =
            (uint8_t *)(pixels + 4 * (size_t)y * (size_t)plan->width + sample);
        channel->user_bytes_per_element = 4;
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = 16;
        channel->user_line_stride = 16 * plan->width;
    }
    if (y == 0)
        code = exr_decoding_choose_default_routines(file->exr, 0, pipe);
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(file->exr, 0, pipe)
                                   : code;
}

static snow_status read_lines(const exr_file *file, const snow_source *source,
                              const exr_plan *plan, snow_image *image) {
    exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t code = EXR_ERR_SUCCESS;
    size_t pixels = (size_t)plan->width * (size_t)plan->height;
    for (int y = 0; y < plan->height && code == EXR_ERR_SUCCESS;
         y += plan->at_once)
        code = read_chunk(file, plan, y, image->pixels, &pipe);
    exr_decoding_destroy(file->exr, &pipe);
    if (code != EXR_ERR_SUCCESS)
        return fail_exr(file, source);
    for (size_t i = 0; i < pixels; i++) {
        float *pixel = image->pixels + 4 * i;
        if (plan->grey)
            pixel[1] = pixel[2] = pixel[0];
        if (!plan->has_alpha)
            pixel[3] = 1;
    }
    return SNOW_STATUS_OK;
}

static snow_status read_file(exr_file *file, const snow_source *source,
                             snow_image **out) {
    exr_context_initializer_t hooks = hooks_of(file);
    exr_plan plan = {0};
    snow_image *image = NULL;
    if (exr_start_read(&file->exr, snow_source_name(source), &hooks) !=
        EXR_ERR_SUCCESS)
        return fail_exr(file, source);
    SNOW_TRY(read_header(file, source, &plan));
    SNOW_TRY(snow_image_new(file->context, plan.width, plan.height, 4, &image));
    snow_status status = read_lines(file, source, &plan, image);
    if (status == SNOW_STATUS_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

static snow_status read_exr(snow_source *source, snow_image **out) {
    exr_file file = {.context = snow_source_context(source)};
    SNOW_TRY(snow_seekable_open(source, &file.bytes));
    snow_status status = read_file(&file, source, out);
    if (file.exr)
        exr_finish(&file.exr);
    snow_seekable_close(file.bytes);
    return status;
}

const snow_image_format snow_image_exr = {.name = "EXR",
                                          .suffix = ".exr",
                                          .write = write_exr,
                                          .probe = probe_exr,
                                          .read = read_exr,
                                          .in_any_order = true,
                                          .takes_depth = true};

#else

const snow_image_format snow_image_exr = {.name = "EXR",
                                          .suffix = ".exr",
                                          .package = "libopenexr-dev",
                                          .takes_depth = true,
                                          .probe = probe_exr};

#endif
