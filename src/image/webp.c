/* image/webp.c - WebP files, by libwebp: 8 bits per channel, lossless.
 *
 * Writes the same levels as a PNG on the same background; with straight alpha,
 * colours below transparent alpha are kept.  The encoder runs at its fastest
 * setting, which takes as long as our PNG; others take many times that.  Reads
 * any still WebP, with alpha multiplied in.  libwebp allocates its own memory,
 * which no context counts. */
#include "image/image.h"

#include "io/seekable.h"

#include <string.h>

/* RIFF, four bytes of size, WEBP. */
static bool probe_webp(const unsigned char *bytes, size_t size) {
    return size >= 12 && memcmp(bytes, "RIFF", 4) == 0 &&
           memcmp(bytes + 8, "WEBP", 4) == 0;
}

#if SNOW_HAVE_WEBP

#include <webp/decode.h>
#include <webp/encode.h>

/* The state for libwebp's writer. */
typedef struct webp_job {
    const snow_image *image;
    snow_writer *writer;
    snow_status status;
} webp_job;

static int write_bytes(const uint8_t *bytes, size_t size,
                       const WebPPicture *picture) {
    webp_job *job = picture->custom_ptr;
    job->status = snow_writer_write(job->writer, bytes, size);
    return job->status == SNOW_STATUS_OK;
}

static int report(int percent, const WebPPicture *picture) {
    webp_job *job = picture->custom_ptr;
    job->status =
        snow_image_report(job->image, picture->height * percent / 100);
    return job->status == SNOW_STATUS_OK;
}

/* Converts the levels to libwebp's order: alpha in the highest byte. */
static void fill_line(const snow_levels *levels, const unsigned char *row,
                      uint32_t *out) {
    int samples = levels->samples;
    for (int x = 0; x < levels->image->width; x++, row += samples) {
        uint32_t alpha = samples == 4 ? row[3] : 255;
        out[x] = alpha << 24 | (uint32_t)row[0] << 16 | (uint32_t)row[1] << 8 |
                 row[2];
    }
}

static snow_status encode(snow_levels *levels, webp_job *job,
                          WebPPicture *picture) {
    snow_context *context = levels->image->context;
    WebPConfig config;
    int good = WebPConfigInit(&config) && WebPConfigLosslessPreset(&config, 0);
    config.exact = 1;
    picture->use_argb = 1;
    picture->width = levels->image->width;
    picture->height = levels->image->height;
    picture->writer = write_bytes;
    picture->progress_hook = report;
    picture->custom_ptr = job;
    bool memory = good && !WebPPictureAlloc(picture);
    good = good && !memory;
    for (int y = 0; y < picture->height && good; y++) {
        fill_line(levels, snow_levels_row(levels, y),
                  picture->argb + (size_t)y * (size_t)picture->argb_stride);
        good = report(0, picture);
    }
    if (good && WebPEncode(&config, picture))
        return SNOW_STATUS_OK;
    if (job->status != SNOW_STATUS_OK)
        return job->status;
    memory |= picture->error_code == VP8_ENC_ERROR_OUT_OF_MEMORY ||
              picture->error_code == VP8_ENC_ERROR_BITSTREAM_OUT_OF_MEMORY;
    if (memory)
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "out of memory to compress %d x %d pixels as WebP; "
                         "use a smaller picture",
                         picture->width, picture->height);
    return snow_fail(context, SNOW_STATUS_FAILED,
                     "the WebP file cannot be written (libwebp: error %d); "
                     "write a .png instead",
                     (int)picture->error_code);
}

static snow_status write_webp(const snow_image *image,
                              const snow_image_options *options,
                              snow_writer *writer) {
    snow_levels levels;
    webp_job job = {image, writer, SNOW_STATUS_OK};
    WebPPicture picture;
    if (!WebPPictureInit(&picture))
        return snow_fail(image->context, SNOW_STATUS_FAILED,
                         "libwebp is not compatible with the version for which "
                         "this was built; install that version");
    snow_status status = snow_levels_begin(image, options, true, &levels);
    if (status == SNOW_STATUS_OK)
        status = encode(&levels, &job, &picture);
    WebPPictureFree(&picture);
    snow_levels_end(&levels);
    return status;
}

/* --- reading -------------------------------------------------------------- */

static snow_status fail_webp(const snow_source *source, const char *reason) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s: %s", snow_source_name(source), reason);
}

/* Converts the bytes in the second half of each row to floats in place, as in
 * png.c: float pixel x ends at byte 16 x + 16, raw pixel x at 12 w + 4 x
 * + 4, which is not before. */
static void widen_to_floats(const snow_image *image) {
    size_t width = (size_t)image->width;
    for (int y = 0; y < image->height; y++) {
        float *out = image->pixels + 4 * width * (size_t)y;
        const unsigned char *raw = (const unsigned char *)(out + 3 * width);
        for (size_t x = 0; x < width; x++, raw += 4, out += 4) {
            double alpha = raw[3] / 255.0, rgb[3];
            for (int c = 0; c < 3; c++)
                rgb[c] = raw[c] / 255.0 * alpha;
            for (int c = 0; c < 3; c++)
                out[c] = (float)rgb[c];
            out[3] = (float)alpha;
        }
    }
}

static snow_status decode(const snow_source *source, const unsigned char *bytes,
                          size_t size, snow_image **out) {
    WebPBitstreamFeatures found;
    snow_image *image = NULL;
    if (WebPGetFeatures(bytes, size, &found) != VP8_STATUS_OK)
        return fail_webp(source,
                         "the WebP file is damaged or truncated; get it again");
    if (found.has_animation)
        return fail_webp(source,
                         "is an animated WebP; give a single picture, for "
                         "example from webpmux -get frame 1");
    SNOW_TRY(snow_image_check_sides(source, found.width, found.height));
    SNOW_TRY(snow_image_make(snow_source_context(source), found.width,
                             found.height, 4, &image));
    size_t width = (size_t)image->width, all = 16 * width;
    unsigned char *raw = (unsigned char *)(image->pixels + 3 * width);
    size_t capacity = all * (size_t)image->height - 12 * width;
    if (!WebPDecodeRGBAInto(bytes, size, raw, capacity, (int)all)) {
        snow_image_free(image);
        return fail_webp(source,
                         "the WebP file is damaged or truncated; get it again");
    }
    widen_to_floats(image);
    *out = image;
    return SNOW_STATUS_OK;
}

/* The decoder needs all bytes in one block. */
static snow_status read_webp(snow_source *source, snow_image **out) {
    snow_context *context = snow_source_context(source);
    snow_seekable *store = NULL;
    SNOW_TRY(snow_seekable_open(source, &store));
    uint64_t size = snow_seekable_size(store);
    unsigned char *bytes = snow_allocate_array(context, size + 1, 1);
    snow_status status = bytes ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    if (bytes && snow_seekable_read(store, 0, bytes, (size_t)size) != size)
        status = fail_webp(source, "the WebP file cannot be read to its end");
    if (status == SNOW_STATUS_OK)
        status = decode(source, bytes, (size_t)size, out);
    snow_release(context, bytes);
    snow_seekable_close(store);
    return status;
}

const snow_image_format snow_image_webp = {.name = "WebP",
                                           .suffix = ".webp",
                                           .bits = 8,
                                           .most_side = WEBP_MAX_DIMENSION,
                                           .write = write_webp,
                                           .probe = probe_webp,
                                           .read = read_webp,
                                           .in_any_order = true};

#else

const snow_image_format snow_image_webp = {.name = "WebP",
                                           .suffix = ".webp",
                                           .bits = 8,
                                           .package = "libwebp-dev",
                                           .probe = probe_webp};

#endif
