/* formats/dicom/voxels.c - decodes frames, crops them to the box, scales them
 * if each has its own scale, and stacks them.
 *
 * A stored value is the bits from the highest stored one down, in a word of 8,
 * 16 or 32 (PS3.5, 8.1.1); other bits, such as old overlays, are dropped.
 * Values stay as stored, with one scale for all.  They become floats if there
 * is padding, which becomes NaN, if slices differ in scale, and if slices are
 * interpolated, missing or cut. Palette colours become channels.
 *
 * A file stays open until another is needed. */
#include "base/minmax.h"
#include "formats/dicom/dicom.h"

#include "formats/array.h"

#include <math.h>
#include <string.h>

/* The box of one frame, as doubles. */
typedef struct plane {
    const dicom_frame *frame;
    double *values;
} plane;

typedef struct decoder {
    const dicom_input *input;
    const dicom_image *image; /* the image whose file is open; NULL: none */
    dicom_reader reader;
    dicom_palette palette; /* of the open file */
    unsigned char *bytes;  /* of a frame */
    dicom_words words;
    const dicom_image *held; /* the mosaic whose frame it is; NULL: none */
    const snow_region *window;
    int64_t channel;
    bool scales; /* each frame has its own slope and intercept */
    plane planes[2];
} decoder;

/* --- a file --------------------------------------------------------------- */

static void close_image(decoder *d) {
    if (d->image)
        snow_dicom_close(&d->reader);
    snow_release(d->input->context, d->palette.levels);
    d->palette = (dicom_palette){0};
    d->image = NULL;
}

static bool has_palette(const dicom_image *image) {
    return strcmp(image->photometric, "PALETTE COLOR") == 0;
}

/* Opens the file of an image and keeps it open. */
static snow_status open_image(decoder *d, const dicom_image *image) {
    snow_context *context = d->input->context;
    if (d->image == image)
        return SNOW_STATUS_OK;
    close_image(d);
    SNOW_TRY(snow_dicom_open(context, image->path, d->input->store, image,
                             &d->reader));
    d->image = image;
    return has_palette(image)
               ? snow_dicom_palette_read(&d->reader, image, &d->palette)
               : SNOW_STATUS_OK;
}

/* --- a frame -------------------------------------------------------------- */

/* How the bits of a word form a value. */
typedef struct bits {
    uint32_t mask, sign; /* of the value, after shifting it down */
    int shift;
} bits;

static uint32_t word_at(const unsigned char *at, int size) {
    uint16_t s;
    uint32_t l;
    if (size == 1)
        return *at;
    if (size == 2) {
        memcpy(&s, at, 2);
        return s;
    }
    memcpy(&l, at, 4);
    return l;
}

/* Reads a row of the box from its first word on; words are `step` bytes
 * apart. */
static void take_row(const decoder *d, const dicom_frame *frame,
                     const unsigned char *at, size_t step, double *out) {
    uint32_t mask = d->words.stored == 32
                        ? UINT32_MAX
                        : ((uint32_t)1 << d->words.stored) - 1;
    bits b = (bits){mask, d->words.is_signed ? mask ^ mask >> 1 : 0,
                    d->words.high + 1 - d->words.stored};
    int size = d->words.size;
    /* Padding may lie outside the range of the stored bits: then the whole word
     * is compared with the header. */
    bool pads = frame->image->pads;
    const double *padding = frame->image->padding;
    double slope = d->scales ? frame->slope : 1;
    double intercept = d->scales ? frame->intercept : 0;
    const unsigned char *levels =
        d->palette.levels
            ? d->palette.levels + (size_t)d->channel * d->palette.count
            : NULL;
    for (int64_t x = 0; x < d->window->count[0]; x++, at += step) {
        uint32_t word = word_at(at, size);
        int64_t bits_of = word >> b.shift & b.mask;
        if (b.sign)
            bits_of = (bits_of ^ (int64_t)b.sign) - (int64_t)b.sign;
        double value = (double)bits_of;
        if (pads && ((value >= padding[0] && value <= padding[1]) ||
                     (size == 2 && word == (uint16_t)(int32_t)padding[0])))
            out[x] = NAN;
        else if (levels) {
            double place = value - (double)d->palette.first;
            double last = (double)(d->palette.count - 1);
            place = place > 0 ? SNOW_MIN(place, last) : 0;
            out[x] = (double)levels[(size_t)place];
        } else
            out[x] = slope * value + intercept;
    }
}

static snow_status take_frame(decoder *d, const dicom_frame *frame,
                              double *out) {
    const snow_region *w = d->window;
    for (int64_t i = 0; frame->lost && i < w->count[0] * w->count[1]; i++)
        out[i] = NAN;
    if (frame->lost)
        return SNOW_STATUS_OK;
    /* Errors name the file that contains the frame. */
    const char *path = frame->image->path;
    const dicom_image *image = frame->image;
    const bool mosaic = image->tiles > 1;
    const bool held = d->held == image;
    d->held = NULL;
    snow_status status = open_image(d, image);
    if (status == SNOW_STATUS_OK && !held)
        status = snow_dicom_read_words(
            &d->reader, image, mosaic ? 0 : frame->number, d->bytes, &d->words);
    if (status != SNOW_STATUS_OK && path)
        snow_fail_in_file(d->input->context, status, path);
    SNOW_TRY(status);
    d->held = mosaic ? image : NULL;
    const int64_t tile = mosaic ? frame->number : 0;
    const int64_t tiles = mosaic ? image->tiles : 1;
    const int64_t left = tile % tiles * snow_dicom_columns(image);
    const int64_t top = tile / tiles * snow_dicom_rows(image);
    size_t size = (size_t)d->words.size;
    size_t samples = (size_t)image->samples, columns = (size_t)image->columns;
    size_t area = columns * (size_t)image->rows;
    size_t step = d->words.planes ? size : size * samples;
    size_t apart = d->words.planes ? area * size : size;
    const unsigned char *at =
        d->bytes + (samples > 1 ? (size_t)d->channel * apart : 0);
    for (int64_t y = 0; y < w->count[1]; y++) {
        size_t first = (size_t)(top + w->first[1] + y) * columns +
                       (size_t)(left + w->first[0]);
        take_row(d, frame, at + first * step, step, out + y * w->count[0]);
    }
    return SNOW_STATUS_OK;
}

/* Reads a frame's values; the last two frames are kept, since interpolated
 * slices use the same ones again. */
static snow_status fetch(decoder *d, const dicom_frame *frame,
                         const double **out) {
    for (int i = 0; i < 2; i++)
        if (d->planes[i].frame == frame) {
            *out = d->planes[i].values;
            return SNOW_STATUS_OK;
        }
    plane oldest = d->planes[0];
    d->planes[0] = d->planes[1];
    oldest.frame = NULL;
    d->planes[1] = oldest;
    SNOW_TRY(take_frame(d, frame, oldest.values));
    d->planes[1].frame = frame;
    *out = oldest.values;
    return SNOW_STATUS_OK;
}

/* --- the volume ----------------------------------------------------------- */

/* Returns false if the type does not hold a value. */
static bool store_values(snow_type type, const double *values, size_t count,
                         void *to) {
    const double *limits = snow_type_limits(type);
    for (size_t i = 0; i < count && type < SNOW_TYPE_FLOAT32; i++)
        if (!(values[i] >= limits[0] && values[i] <= limits[1]))
            return false;
    snow_type_store(type, values, count, to);
    return true;
}

/* Makes slice `z` of the whole volume. */
static snow_status fill_slice(decoder *d, const dicom_stack *stack, int64_t z,
                              snow_volume *volume, double *mixed, void *to) {
    size_t count = (size_t)(d->window->count[0] * d->window->count[1]);
    size_t time = (size_t)volume->info.time;
    dicom_slice slice = {(size_t)z, (size_t)z, 0};
    if (stack->slices)
        slice = stack->slices[z];
    const dicom_frame *frames = stack->frames + time;
    const double *low = NULL, *high = NULL, *values;
    if (slice.weight < 1)
        SNOW_TRY(fetch(d, frames + slice.low * stack->times, &low));
    if (slice.weight > 0)
        SNOW_TRY(fetch(d, frames + slice.high * stack->times, &high));
    values = low ? low : high ? high : mixed;
    for (size_t i = 0; values == mixed && i < count; i++)
        mixed[i] = NAN; /* the slice is missing */
    if (low && high) {  /* a missing value stays missing */
        for (size_t i = 0; i < count; i++)
            mixed[i] = (1 - slice.weight) * low[i] + slice.weight * high[i];
        values = mixed;
    }
    if (!store_values(volume->info.type, values, count, to))
        return snow_fail(volume->context, SNOW_STATUS_BAD_INPUT,
                         "its compressed pixels have values that its header's "
                         "type cannot hold; it is damaged");
    return SNOW_STATUS_OK;
}

static snow_status fill_volume(decoder *d, const dicom_stack *stack,
                               snow_volume *volume) {
    snow_context *context = volume->context;
    size_t count = (size_t)(d->window->count[0] * d->window->count[1]);
    double *block = snow_allocate_array(context, count, 3 * sizeof *block);
    d->bytes = snow_allocate_array(
        context, snow_dicom_frame_bytes(stack->frames->image), 1);
    snow_status status =
        block && d->bytes ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    d->planes[0].values = block;
    d->planes[1].values = block ? block + count : NULL;
    unsigned char *to = volume->owned;
    size_t bytes = count * snow_type_size(volume->info.type);
    double slices = (double)d->window->count[2];
    for (int64_t z = 0; z < d->window->count[2] && status == SNOW_STATUS_OK;
         z++) {
        snow_monitor_report(context->monitor, SNOW_STAGE_READ,
                            (double)z + slices / (DICOM_HEADER_SHARE - 1),
                            slices * DICOM_HEADER_SHARE /
                                (DICOM_HEADER_SHARE - 1));
        status = fill_slice(d, stack, d->window->first[2] + z, volume,
                            block + 2 * count, to + (size_t)z * bytes);
    }
    close_image(d);
    snow_release(context, d->bytes);
    snow_release(context, block);
    return status;
}

/* Whether the frames have more than one scale, and any has padding. */
static void survey(const dicom_stack *stack, bool *scales, bool *pads) {
    *scales = *pads = false;
    for (size_t i = 0; i < stack->places * stack->times; i++) {
        const dicom_frame *frame = &stack->frames[i];
        *scales |= frame->slope != stack->frames[0].slope ||
                   frame->intercept != stack->frames[0].intercept;
        *pads |= frame->image->pads || frame->lost;
    }
}

static snow_status stored_type(snow_context *context, const dicom_image *image,
                               snow_type *out) {
    const int wide = image->allocated;
    if (wide != 8 && wide != 16 && wide != 32)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "pixels of %d bits are not supported, only 8, 16 and 32", wide);
    *out = snow_type_of_integer((size_t)wide / 8, image->is_signed);
    if (image->stored < 1 || image->high < image->stored - 1 ||
        image->high >= image->allocated)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "claims %d of %d bits stored, up to number %d; it is damaged",
            image->stored, image->allocated, image->high);
    return SNOW_STATUS_OK;
}

/* The most gaps that notes name one by one. */
#define MOST_NAMED 8

/* A frame's place along the normal, in mm, as in SliceLocation. */
static double height(const dicom_stack *stack, const dicom_frame *frame) {
    return snow_dot(frame->position, stack->normal);
}

/* Names each gap by the slices around it. */
static void warn_missing(snow_context *context, const dicom_stack *stack) {
    size_t named = 0;
    for (size_t z = 0; stack->missing && z < stack->slice_count; z++) {
        const dicom_slice *slice = &stack->slices[z];
        size_t lost = 0;
        while (isnan(stack->slices[z].weight) &&
               stack->slices[z].low == slice->low) {
            lost++;
            z++;
        }
        if (!lost || ++named > MOST_NAMED)
            continue;
        const dicom_frame *low = &stack->frames[slice->low * stack->times];
        const dicom_frame *high = &stack->frames[slice->high * stack->times];
        snow_notify(context,
                    "%zu slice%s missing between %s (frame %lld, at %g mm) and "
                    "%s (frame %lld, at %g mm); the gap is left transparent",
                    lost, lost > 1 ? "s are" : " is", snow_dicom_name(low),
                    (long long)low->number, height(stack, low),
                    snow_dicom_name(high), (long long)high->number,
                    height(stack, high));
    }
    if (named > MOST_NAMED)
        snow_notify(context, "in all %zu slices are missing in %zu gaps",
                    stack->missing, named);
}

/* Names each slice whose file is cut; refuses a volume without others. */
static snow_status warn_lost(snow_context *context, const dicom_stack *stack) {
    size_t lost = 0, named = 0, count = stack->places * stack->times;
    for (size_t i = 0; i < count; i++)
        lost += stack->frames[i].lost;
    if (lost == count)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "all of its slices are cut; get their files again");
    for (size_t i = 0; i < count && named < MOST_NAMED; i++) {
        const dicom_frame *frame = &stack->frames[i];
        if (!frame->lost)
            continue;
        named++;
        snow_notify(
            context,
            "%s is cut: its slice (frame %lld, at %g mm) is left transparent",
            snow_dicom_name(frame), (long long)frame->number,
            height(stack, frame));
    }
    if (lost > named)
        snow_notify(context, "in all %zu slices are cut", lost);
    return SNOW_STATUS_OK;
}

/* Whether images at one position have no time, echo or acquisition. */
static bool are_only_numbered(const dicom_stack *stack) {
    for (size_t i = 1; i < stack->times; i++)
        for (int key = 0; key < DICOM_KEY_INSTANCE; key++)
            if (stack->frames[i].keys[key] != stack->frames[0].keys[key])
                return false;
    return true;
}

/* Gives all warnings about a volume, each once. */
static void warn_about_volume(snow_context *context, const dicom_stack *stack,
                              bool spacing_given) {
    const dicom_frame *first = stack->frames;
    bool unscaled = false, unmapped = false, no_frames = false;
    for (size_t i = 0; i < stack->places * stack->times; i++) {
        unscaled |= first[i].unscaled;
        unmapped |= first[i].unmapped;
        no_frames |= first[i].image->no_frames;
    }
    if (no_frames)
        snow_notify(context, "claims 0 frames (NumberOfFrames); 1 is taken");
    if (unmapped)
        snow_notify(context, "its table or map of values (ModalityLUTSequence, "
                             "RealWorldValueMappingSequence) is not applied; "
                             "the values are as stored");
    if (!first->measured && !spacing_given)
        snow_notify(context, "the size of a pixel is missing or invalid; 1 mm "
                             "is used, --spacing sets another");
    if (stack->slice_count > 1 && (!stack->given || first->guessed) &&
        !spacing_given)
        snow_notify(context,
                    "the distance of the slices is missing; %g mm is used, "
                    "--spacing sets another",
                    stack->gap);
    warn_missing(context, stack);
    if (stack->slices && !stack->missing)
        snow_notify(context,
                    "its %zu slices lie %g to %g mm apart; they are resampled "
                    "to %zu, one every %g mm",
                    stack->places, stack->gap_least, stack->gap_most,
                    stack->slice_count, stack->gap);
    else if (stack->placed && !stack->missing &&
             stack->gap_most - stack->gap_least > 1e-3 * stack->gap)
        snow_notify(context,
                    "its slices lie %g to %g mm apart; their mean distance, %g "
                    "mm, is used",
                    stack->gap_least, stack->gap_most, stack->gap);
    if (!strcmp(first->image->photometric, "MONOCHROME1"))
        snow_notify(
            context,
            first->slope == -1
                ? "high stored values are dark (MONOCHROME1); they are inverted"
                : "is MONOCHROME1, high values dark; the values are kept, as a "
                  "rescale defines them");
    if (stack->placed && stack->places == 1 && stack->times > 1 &&
        are_only_numbered(stack))
        snow_notify(context,
                    "all its %zu images lie at one position and differ in "
                    "their numbers only; they are taken for time steps",
                    stack->times);
    if (unscaled)
        snow_notify(context, "a rescale slope of 0 is not possible; 1 is used");
}

/* The two transforms of JPEG 2000 are undone with its compression, that of
 * JPEG by the reader of pixels. */
static bool is_rgb(const dicom_image *image) {
    return !strcmp(image->photometric, "RGB") ||
           !strcmp(image->photometric, "YBR_RCT") ||
           !strcmp(image->photometric, "YBR_ICT") || snow_dicom_is_ybr(image);
}

static snow_status check_colors(snow_context *context,
                                const dicom_image *image) {
    if (image->samples != 1 && (has_palette(image) || !is_rgb(image)))
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "its colours are %.16s with %d values per pixel, which is not "
            "supported; convert it to RGB, for example with gdcmconv",
            image->photometric, image->samples);
    if (image->more)
        snow_notify(context,
                    "its pixels have %llu bytes more than its rows and "
                    "columns; these are not used",
                    (unsigned long long)image->more);
    return SNOW_STATUS_OK;
}

static snow_status describe_stack(const dicom_input *input,
                                  const dicom_stack *stack,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, decoder *d) {
    snow_context *context = input->context;
    const dicom_frame *first = stack->frames;
    const dicom_image *image = first->image;
    bool pads;
    snow_dicom_describe(stack, info);
    SNOW_TRY(snow_dicom_check_mosaic(context, first));
    SNOW_TRY(stored_type(context, image, &info->type));
    SNOW_TRY(check_colors(context, image));
    survey(stack, &d->scales, &pads);
    if (pads || d->scales || stack->slices)
        info->type =
            image->allocated > 16 ? SNOW_TYPE_FLOAT64 : SNOW_TYPE_FLOAT32;
    else if (has_palette(image))
        info->type = SNOW_TYPE_UINT8;
    bool plain = d->scales || has_palette(image);
    info->slope = plain ? 1 : first->slope;
    info->intercept = plain ? 0 : first->intercept;
    /* A CT's rescale leads to them unless it names another unit (PS3.3,
     * C.8.2.1). */
    info->hounsfield =
        !strcmp(image->rescale_type, "HU") ||
        (!strcmp(image->modality, "CT") && !*image->rescale_type &&
         (d->scales || first->intercept != 0));
    memcpy(info->window, first[stack->places / 2 * stack->times].window,
           sizeof info->window);
    SNOW_TRY(snow_dicom_set_unit(input, stack, options->suv, info));
    SNOW_TRY(warn_lost(context, stack));
    warn_about_volume(context, stack, snow_spacing_given(options));
    const int channels = has_palette(image) ? 3 : image->samples;
    snow_channels_begin(info, channels, false);
    if (channels == 3)
        snow_channels_are_colors(info);
    SNOW_TRY(snow_volume_pick_channel(context, options, channels, info,
                                      &d->channel));
    return snow_volume_pick_time(context, "volume", options, info);
}

snow_status snow_dicom_read_stack(const dicom_input *input,
                                  const dicom_stack *stack,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out) {
    snow_region window;
    snow_volume *volume;
    decoder d = {.input = input, .window = &window};
    SNOW_TRY(describe_stack(input, stack, options, info, &d));
    SNOW_TRY(snow_region_lay_out(input->context, options, info, &window));
    if (!out)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_new(input->context, info, &volume));
    snow_status status = fill_volume(&d, stack, volume);
    memcpy(volume->patient, stack->frames->image->patient,
           sizeof volume->patient);
    return snow_volume_give(status, volume, out);
}
