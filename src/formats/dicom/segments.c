/* formats/dicom/segments.c - a segmentation (PS3.3, A.51, C.8.20) as a volume
 * of labels.
 *
 * A frame has the voxels of one segment in one slice, or, of a label map, the
 * segments' numbers.  A voxel becomes the number of its segment, 0 outside:
 *
 *   frames   segment 1, z 0   1, z 1   2, z 1   1, z 4
 *   slices          z 0         z 1          -     -     z 4    (-: empty)
 *
 * Labels are not interpolated: where slices lie unevenly, the nearest frames
 * are taken. */
#include "formats/dicom/dicom.h"

#include "formats/array.h"

#include <math.h>
#include <string.h>

#define TAG_SEGMENTS 0x00620002u
#define TAG_NUMBER 0x00620004u
#define TAG_LABEL 0x00620005u
#define TAG_COLOR 0x0062000du

/* --- names and colours ---------------------------------------------------- */

/* From CIELAB of the profile connection space (white D50, ICC.1) in 16 bits
 * (PS3.3, C.10.7.1.1) to sRGB; other colours than those of sRGB are clamped. */
static void color_of(const double lab[3], double rgb[3]) {
    static const double white[3] = {0.9642, 1, 0.8249};
    /* adapted to D65 by Bradford's method */
    static const double to_linear[3][3] = {{3.1338561, -1.6168667, -0.4906146},
                                           {-0.9787684, 1.9161415, 0.0334540},
                                           {0.0719453, -0.2289914, 1.4052427}};
    double level = (lab[0] * 100 / 65535 + 16) / 116;
    const double f[3] = {level + (lab[1] / 257 - 128) / 500, level,
                         level - (lab[2] / 257 - 128) / 200};
    double xyz[3];
    for (int i = 0; i < 3; i++)
        xyz[i] = white[i] * (f[i] > 6.0 / 29 ? f[i] * f[i] * f[i]
                                             : (f[i] - 4.0 / 29) * 108 / 841);
    for (int i = 0; i < 3; i++) {
        double c = fmin(fmax(snow_dot(to_linear[i], xyz), 0), 1);
        rgb[i] = c > 0.0031308 ? 1.055 * pow(c, 1 / 2.4) - 0.055 : 12.92 * c;
    }
}

/* Reads the segments of the file, which need not have frames. */
static snow_status read_labels(dicom_reader *r, snow_volume *volume) {
    const dicom_element *sequence =
        snow_dicom_find(r, 0, r->count, TAG_SEGMENTS);
    snow_label *labels = NULL;
    size_t count = 0;
    size_t at = sequence ? (size_t)(sequence - r->elements) + 1 : 0;
    snow_status status = SNOW_STATUS_OK;
    for (; sequence && at < sequence->next && status == SNOW_STATUS_OK;
         at = r->elements[at].next) {
        const dicom_element *item = &r->elements[at];
        snow_label label = {.color = {-1, 0, 0, -1}};
        double lab[3];
        if (!snow_dicom_shorts(r, snow_dicom_find_in(r, item, TAG_NUMBER),
                               &label.value, 1))
            continue;
        snow_dicom_words(r, snow_dicom_find_in(r, item, TAG_LABEL), label.name,
                         sizeof label.name);
        if (snow_dicom_shorts(r, snow_dicom_find_in(r, item, TAG_COLOR), lab,
                              3) == 3)
            color_of(lab, label.color);
        status = SNOW_RESERVE(r->context, labels, count, count + 1);
        if (status == SNOW_STATUS_OK)
            labels[count++] = label;
    }
    if (status == SNOW_STATUS_OK)
        status = snow_volume_set_labels(volume, labels, count);
    snow_release(r->context, labels);
    return status;
}

/* --- checks --------------------------------------------------------------- */

static unsigned segment_of(const dicom_frame *frame) {
    return (unsigned)frame->keys[DICOM_KEY_SEGMENT];
}

static snow_status check_image(snow_context *context,
                               const dicom_image *image) {
    if (image->segments == DICOM_UNKNOWN_SEGMENTS)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is a segmentation of an unknown type: only BINARY, "
                         "FRACTIONAL and LABELMAP are supported");
    bool bits = image->segments == DICOM_BINARY && image->allocated == 1;
    bool map = image->segments == DICOM_LABELMAP && image->allocated == 16;
    if (image->samples != 1 || (!bits && !map && image->allocated != 8) ||
        image->stored != image->allocated || image->high != image->stored - 1)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is a segmentation with %d values of %d bits per "
                         "pixel, of which %d are stored: only one of 1 or 8 "
                         "bits, or 16 of a label map, all stored, is supported",
                         image->samples, image->allocated, image->stored);
    if (image->whole < 1)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "claims that 0 is its largest fraction; it is damaged");
    return SNOW_STATUS_OK;
}

/* Every frame needs a place, and but for a label map a segment, which it has
 * there alone. */
static snow_status check_frames(snow_context *context,
                                const dicom_stack *stack) {
    const dicom_image *image = stack->frames->image;
    if (!stack->placed)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "is a segmentation whose frames have no positions: its functional "
            "groups need PlanePositionSequence and PlaneOrientationSequence");
    size_t count = stack->starts[stack->places];
    if ((int64_t)count != image->frames)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is a segmentation of which only %zu of %lld frames "
                         "have positions on one grid; the others have none, or "
                         "another direction or pixel size",
                         count, (long long)image->frames);
    for (size_t p = 0; p < stack->places; p++)
        for (size_t i = stack->starts[p]; i < stack->starts[p + 1]; i++) {
            const dicom_frame *frame = &stack->frames[i];
            bool map = image->segments == DICOM_LABELMAP;
            if (!map && segment_of(frame) < 1)
                return snow_fail(
                    context, SNOW_STATUS_BAD_INPUT,
                    "frame %lld of its segmentation names no segment: it needs "
                    "SegmentIdentificationSequence",
                    (long long)frame->number);
            if (i > stack->starts[p] &&
                (map || segment_of(frame) == segment_of(frame - 1)))
                return snow_fail(
                    context, SNOW_STATUS_BAD_INPUT,
                    "frames %lld and %lld of its segmentation have the same "
                    "place and segment; only one of each is supported",
                    (long long)frame[-1].number, (long long)frame->number);
        }
    return SNOW_STATUS_OK;
}

static void warn_about_segments(snow_context *context, const dicom_stack *stack,
                                bool spacing_given) {
    const dicom_frame *first = stack->frames;
    if (!first->measured && !spacing_given)
        snow_notify(context, "the size of a pixel is missing or invalid; 1 mm "
                             "is used, --spacing sets another");
    if (first->image->segments == DICOM_FRACTIONAL)
        snow_notify(context, "its segments are fractions; voxels of at least "
                             "one half belong to them");
    if (stack->slices && !stack->missing)
        snow_notify(context,
                    "its %zu slices lie %g to %g mm apart; of %zu, one every "
                    "%g mm, each is the nearest",
                    stack->places, stack->gap_least, stack->gap_most,
                    stack->slice_count, stack->gap);
}

/* --- the volume ----------------------------------------------------------- */

typedef struct segmenter {
    const dicom_stack *stack;
    const snow_region *window;
    dicom_reader reader;
    unsigned char *bytes; /* of a frame */
    bool overlap;         /* of segments was found */
} segmenter;

/* Marks the voxels of a frame's segment in a slice. */
static snow_status mark_frame(segmenter *s, const dicom_frame *frame,
                              uint16_t *slice) {
    const dicom_image *image = frame->image;
    const snow_region *w = s->window;
    bool map = image->segments == DICOM_LABELMAP, overlap = false;
    unsigned segment = segment_of(frame), whole = image->whole;
    dicom_words words;
    SNOW_TRY(snow_dicom_read_words(&s->reader, image, frame->number, s->bytes,
                                   &words));
    for (int64_t y = 0; y < w->count[1]; y++) {
        const unsigned char *at =
            s->bytes +
            (size_t)words.size *
                (size_t)((w->first[1] + y) * image->columns + w->first[0]);
        uint16_t *to = slice + y * w->count[0];
        for (int64_t x = 0; x < w->count[0]; x++, at += words.size) {
            uint16_t value = *at;
            if (words.size == 2)
                memcpy(&value, at, 2);
            if (value == 0 || (!map && 2u * value < whole))
                continue;
            overlap |= to[x] != 0;
            to[x] = map ? value : (uint16_t)segment;
        }
    }
    s->overlap |= overlap;
    return SNOW_STATUS_OK;
}

/* Segments at a place follow one another by their numbers: the last wins. */
static snow_status make_slice(segmenter *s, int64_t z, uint16_t *slice) {
    const dicom_stack *stack = s->stack;
    size_t count = (size_t)(s->window->count[0] * s->window->count[1]);
    dicom_slice from = {(size_t)z, (size_t)z, 0};
    memset(slice, 0, count * sizeof *slice);
    if (stack->slices)
        from = stack->slices[z];
    if (isnan(from.weight))
        return SNOW_STATUS_OK;
    size_t place = from.weight > 0.5 ? from.high : from.low;
    for (size_t i = stack->starts[place]; i < stack->starts[place + 1]; i++)
        SNOW_TRY(mark_frame(s, &stack->frames[i], slice));
    return SNOW_STATUS_OK;
}

static snow_status fill_volume(segmenter *s, snow_volume *volume) {
    snow_context *context = volume->context;
    size_t count = (size_t)(s->window->count[0] * s->window->count[1]);
    bool bytes = volume->info.type == SNOW_TYPE_UINT8;
    unsigned char *to = volume->owned;
    uint16_t *slice = snow_allocate_array(context, count, sizeof *slice);
    s->bytes = snow_allocate_array(
        context, snow_dicom_frame_bytes(s->stack->frames->image), 1);
    snow_status status =
        slice && s->bytes ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    for (int64_t z = 0; z < s->window->count[2] && status == SNOW_STATUS_OK;
         z++) {
        snow_monitor_report(context->monitor, SNOW_STAGE_READ, (double)z,
                            (double)s->window->count[2]);
        status = make_slice(s, s->window->first[2] + z, slice);
        for (size_t i = 0; bytes && i < count; i++)
            *to++ = (unsigned char)slice[i];
        if (!bytes) {
            memcpy(to, slice, count * sizeof *slice);
            to += count * sizeof *slice;
        }
    }
    snow_release(context, s->bytes);
    snow_release(context, slice);
    if (status == SNOW_STATUS_OK && s->overlap)
        snow_notify(context, "some of its segments overlap; there the one of "
                             "the highest number is used");
    return status;
}

/* Opens the file of the segmentation, and fills the volume from it. */
static snow_status fill_from_file(const dicom_input *input, segmenter *s,
                                  snow_volume *volume) {
    const dicom_image *image = s->stack->frames->image;
    snow_status status = snow_dicom_open(input->context, image->path,
                                         input->store, image, &s->reader);
    if (status == SNOW_STATUS_OK) {
        status = read_labels(&s->reader, volume);
        if (status == SNOW_STATUS_OK)
            status = fill_volume(s, volume);
        snow_dicom_close(&s->reader);
    }
    if (status != SNOW_STATUS_OK && image->path)
        snow_fail_in_file(input->context, status, image->path);
    return status;
}

static snow_status describe(snow_context *context, const dicom_stack *stack,
                            const snow_volume_options *options,
                            snow_volume_info *info) {
    const dicom_image *image = stack->frames->image;
    int64_t channel;
    unsigned most = 0;
    SNOW_TRY(check_image(context, image));
    SNOW_TRY(check_frames(context, stack));
    for (size_t i = 0; i < stack->starts[stack->places]; i++)
        if (segment_of(&stack->frames[i]) > most)
            most = segment_of(&stack->frames[i]);
    snow_dicom_describe(stack, info);
    info->type = most > UINT8_MAX || image->allocated == 16 ? SNOW_TYPE_UINT16
                                                            : SNOW_TYPE_UINT8;
    warn_about_segments(context, stack, snow_spacing_given(options));
    SNOW_TRY(snow_volume_pick_channel(context, options, 1, info, &channel));
    return snow_volume_pick_time(context, "volume", options, info);
}

snow_status snow_dicom_read_segments(const dicom_input *input,
                                     const dicom_stack *stack,
                                     const snow_volume_options *options,
                                     snow_volume_info *info,
                                     snow_volume **out) {
    snow_region window;
    snow_volume *volume;
    segmenter s = {.stack = stack, .window = &window};
    SNOW_TRY(describe(input->context, stack, options, info));
    SNOW_TRY(snow_region_lay_out(input->context, options, info, &window));
    if (!out)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_new(input->context, info, &volume));
    snow_status status = fill_from_file(input, &s, volume);
    memcpy(volume->patient, stack->frames->image->patient,
           sizeof volume->patient);
    return snow_volume_give(status, volume, out);
}
