/* formats/jpeg/jpeg.c - JPEG images as slices: .jpg, usually in folders.
 *
 * Grey is one channel, colours are three: red, green and blue.  What libjpeg
 * needs for a file is bounded before it decodes: the file must be able to hold
 * its sizes, coefficients have a limit, and so have scans.  A file is read to
 * its end whatever the box, since damage is found by decoding only. */
#include "io/jpeg.h"
#include "formats/array.h"
#include "formats/features.h"

#if SNOW_HAVE_JPEG

#include <jerror.h>

/* More than any program writes: each costs a walk over all coefficients. */
#define MOST_SCANS 500

/* Bytes before the pixels, and of the codes of a block of pixels in all scans;
 * libjpeg reads on through what is no code. */
#define HEADER_BYTES ((uint64_t)16 << 20)
#define BLOCK_BYTES 1024

typedef struct jpeg_reader {
    snow_context *context;
    snow_source *source;
    snow_status status; /* why the source failed, SNOW_STATUS_OK before */
    snow_jpeg_fault fault;
    struct jpeg_decompress_struct info;
    struct jpeg_source_mgr bytes; /* a copy of the source's next ones */
    struct jpeg_progress_mgr progress;
    uint64_t left; /* bytes that may yet be read */
    size_t copied;
    unsigned char copy[SNOW_PEEK_BYTES];
    unsigned char *row;
} jpeg_reader;

/* --- between libjpeg and the library -------------------------------------- */

static void leave_unless(j_decompress_ptr info, snow_status status) {
    jpeg_reader *reader = info->client_data;
    reader->status = status;
    if (status != SNOW_STATUS_OK)
        longjmp(reader->fault.out, 1);
}

/* The source gives what libjpeg is done with. */
static void skip_bytes(j_decompress_ptr info, size_t bytes) {
    jpeg_reader *reader = info->client_data;
    reader->copied = reader->bytes.bytes_in_buffer = 0;
    leave_unless(info, snow_source_skip(reader->source, bytes, "the pixels"));
}

static boolean fill(j_decompress_ptr info) {
    jpeg_reader *reader = info->client_data;
    size_t got;
    skip_bytes(info, reader->copied);
    if (reader->left < sizeof reader->copy)
        leave_unless(info,
                     snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                               "is a JPEG file with more bytes than its pixels "
                               "can have; it is damaged, get it again"));
    reader->left -= sizeof reader->copy;
    leave_unless(info, snow_source_peek(reader->source, reader->copy,
                                        sizeof reader->copy, &got));
    if (!got)
        ERREXIT(info, JERR_INPUT_EOF);
    reader->copied = reader->bytes.bytes_in_buffer = got;
    reader->bytes.next_input_byte = reader->copy;
    return TRUE;
}

static void skip(j_decompress_ptr info, long count) {
    jpeg_reader *reader = info->client_data;
    size_t left = reader->bytes.bytes_in_buffer;
    if (count < 1)
        return;
    if ((size_t)count > left) {
        skip_bytes(info, reader->copied - left + (size_t)count);
        return;
    }
    reader->bytes.next_input_byte += count;
    reader->bytes.bytes_in_buffer -= (size_t)count;
}

static void do_nothing(j_decompress_ptr info) {
    (void)info;
}

static void count_scans(j_common_ptr common) {
    const struct jpeg_decompress_struct *info =
        (const struct jpeg_decompress_struct *)common;
    jpeg_reader *reader = common->client_data;
    if (info->input_scan_number <= MOST_SCANS)
        return;
    reader->status = snow_fail(
        reader->context, SNOW_STATUS_BAD_INPUT,
        "is a JPEG file of more than %d scans, which is damaged or made to "
        "take long; get it again",
        MOST_SCANS);
    longjmp(reader->fault.out, 1);
}

/* Why libjpeg or the source jumped. */
static snow_status refuse_fault(const jpeg_reader *reader) {
    const struct jpeg_error_mgr *fault = &reader->fault.base;
    if (reader->status != SNOW_STATUS_OK)
        return reader->status;
    if (fault->msg_code == JERR_INPUT_EOF)
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "is a truncated JPEG file; get it again");
    if (fault->msg_code == JERR_BAD_PRECISION)
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "is a JPEG file of %d bits a sample, where 8 are "
                         "read; convert it to PNG or TIFF",
                         fault->msg_parm.i[0]);
    if (fault->msg_code == JERR_OUT_OF_MEMORY)
        return snow_fail(reader->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory in libjpeg; close other programs or "
                         "use smaller slices");
    if (fault->msg_code == JERR_NO_BACKING_STORE)
        return snow_fail(
            reader->context, SNOW_STATUS_NO_MEMORY,
            "out of memory: the scans of the JPEG file need more than %ld "
            "bytes; raise the limit, or convert the file with jpegtran to one "
            "that is not progressive",
            reader->info.mem->max_memory_to_use);
    return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                     "is a damaged or unusual JPEG file (libjpeg: "
                     "%s); get it again",
                     reader->fault.text);
}

/* --- header --------------------------------------------------------------- */

/* Every failure of libjpeg returns here or in decode, once. */
static snow_status read_header(jpeg_reader *reader) {
    if (setjmp(reader->fault.out))
        return refuse_fault(reader);
    jpeg_create_decompress(&reader->info);
    reader->bytes =
        (struct jpeg_source_mgr){.init_source = do_nothing,
                                 .fill_input_buffer = fill,
                                 .skip_input_data = skip,
                                 .resync_to_restart = jpeg_resync_to_restart,
                                 .term_source = do_nothing};
    reader->progress.progress_monitor = count_scans;
    reader->info.client_data = reader;
    reader->info.src = &reader->bytes;
    reader->info.progress = &reader->progress;
    jpeg_read_header(&reader->info, TRUE);
    return SNOW_STATUS_OK;
}

static snow_status check_colors(const jpeg_reader *reader) {
    switch (reader->info.jpeg_color_space) {
    case JCS_GRAYSCALE:
    case JCS_YCbCr:
    case JCS_RGB:
        return SNOW_STATUS_OK;
    case JCS_CMYK:
    case JCS_YCCK:
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "has colours of print (CMYK), where grey and RGB are "
                         "read; convert it to one of these");
    default:
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "has %d samples a pixel of no known colours, where "
                         "grey and RGB are read; convert it to one of these",
                         reader->info.num_components);
    }
}

/* Checks that the file can hold its sizes, before memory is allocated for them:
 * each block of pixels has a code of one bit at least.  Only arithmetic codes
 * may be shorter. */
static snow_status check_size(jpeg_reader *reader) {
    const struct jpeg_decompress_struct *info = &reader->info;
    uint64_t blocks = 0;
    if (info->arith_code)
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "is a JPEG file of arithmetic codes, which are not "
                         "read; convert it with jpegtran");
    for (int i = 0; i < info->num_components; i++)
        blocks += (uint64_t)info->comp_info[i].width_in_blocks *
                  info->comp_info[i].height_in_blocks;
    reader->left += blocks * BLOCK_BYTES;
    return snow_source_expect(reader->source, blocks / 8, "the pixels");
}

static snow_status describe(jpeg_reader *reader, snow_volume_info *info) {
    *info = snow_volume_info_default("jpeg");
    SNOW_TRY(read_header(reader));
    SNOW_TRY(check_colors(reader));
    SNOW_TRY(check_size(reader));
    bool grey = reader->info.jpeg_color_space == JCS_GRAYSCALE;
    snow_image_turn(info->matrix);
    info->dims[0] = reader->info.image_width;
    info->dims[1] = reader->info.image_height;
    info->type = SNOW_TYPE_UINT8;
    snow_channels_begin(info, grey ? 1 : 3, false);
    if (!grey)
        snow_channels_are_colors(info);
    return SNOW_STATUS_OK;
}

/* --- pixels --------------------------------------------------------------- */

static snow_status decode(jpeg_reader *reader, int64_t channel,
                          const snow_region *region, unsigned char *out) {
    struct jpeg_decompress_struct *info = &reader->info;
    if (setjmp(reader->fault.out))
        return refuse_fault(reader);
    /* Not above what the context has left; 0 would mean no limit. */
    const uint64_t limit = reader->context->limit;
    const uint64_t held = snow_context_bytes(reader->context);
    info->mem->max_memory_to_use =
        !limit || limit >= held + SNOW_JPEG_COEFFICIENT_BYTES
            ? SNOW_JPEG_COEFFICIENT_BYTES
        : limit > held ? (long)(limit - held)
                       : 1;
    info->out_color_space =
        info->jpeg_color_space == JCS_GRAYSCALE ? JCS_GRAYSCALE : JCS_RGB;
    info->dct_method = JDCT_ISLOW; /* the same values on every machine */
    jpeg_start_decompress(info);
    for (int64_t y = 0; y < info->image_height; y++) {
        int64_t wanted = y - region->first[1];
        jpeg_read_scanlines(info, &reader->row, 1);
        if (wanted >= 0 && wanted < region->count[1]) {
            int samples = reader->info.output_components;
            const unsigned char *from =
                reader->row + region->first[0] * samples + channel;
            for (int64_t x = 0; x < region->count[0]; x++)
                (out + wanted * region->count[0])[x] = from[x * samples];
        }
    }
    jpeg_finish_decompress(info);
    skip_bytes(info, reader->copied - reader->bytes.bytes_in_buffer);
    return snow_source_finish(reader->source);
}

static snow_status read_pixels(jpeg_reader *reader, int64_t channel,
                               const snow_region *region,
                               const snow_volume_info *info,
                               snow_volume **out) {
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(reader->context, info, &volume));
    reader->row =
        snow_allocate_array(reader->context, reader->info.image_width, 3);
    snow_status status = reader->row
                             ? decode(reader, channel, region, volume->owned)
                             : SNOW_STATUS_NO_MEMORY;
    snow_release(reader->context, reader->row);
    return snow_volume_give(status, volume, out);
}

static snow_status read_open(jpeg_reader *reader,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_region region;
    int64_t channel;
    SNOW_TRY(describe(reader, info));
    SNOW_TRY(snow_volume_pick_channel(reader->context, options, info->channels,
                                      info, &channel));
    SNOW_TRY(
        snow_volume_pick_time(reader->context, "time step", options, info));
    SNOW_TRY(snow_region_lay_out(reader->context, options, info, &region));
    return out ? read_pixels(reader, channel, &region, info, out)
               : SNOW_STATUS_OK;
}

static snow_status read_jpeg(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    jpeg_reader reader = {.context = snow_source_context(source),
                          .source = source,
                          .left = HEADER_BYTES};
    reader.info.err = snow_jpeg_begin_faults(&reader.fault);
    snow_status status = read_open(&reader, options, info, out);
    jpeg_destroy_decompress(&reader.info);
    return status;
}

#else

SNOW_READ_UNBUILT(read_jpeg, "JPEG", "libjpeg62-turbo-dev")

#endif

const snow_format snow_format_jpeg = {
    .name = "jpeg",
    .text = "JPEG slices in a folder or by a pattern (.jpg)",
    .suffixes = {".jpg", ".jpeg"},
    .probe = snow_jpeg_probe,
    .crops = true,
    .channels = true,
    .slices = true,
    .previews = true,
    .read = read_jpeg,
};
