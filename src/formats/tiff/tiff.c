/* formats/tiff/tiff.c - TIFF files whose pages are slices: .tif.
 *
 * Pages are slices from z = 0 on, the first in front, with row 0 at the top.
 * Descriptions by ImageJ and OME give the order of channels, slices and times,
 * and the size of a voxel.  Values are read as stored: neither palettes nor
 * "white is zero" change them.  Bits become uint8 of 0 and 1, half floats
 * float32, 24-bit integers 32-bit ones. */
#include "formats/tiff/tiff.h"
#include "formats/array.h"
#include "formats/features.h"

#include <math.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

/* More of one slice are read as slices; see take_for_slices. */
#define MOST_CHANNELS 7

/* How the file's images form volumes. */
typedef struct tiff_plan {
    tiff_page page;
    tiff_shape shape;
    int64_t images; /* pages, or the images that ImageJ wrote after the first */
    bool raw;       /* the latter */
    bool measured;  /* the size of a pixel is known by the resolution alone */
    /* Distances, in images, of channels, slices and times. */
    int64_t channel_step, slice_step, time_step;
    int64_t channels, slices, times;
} tiff_plan;

static bool same_page(const tiff_page *a, const tiff_page *b) {
    return a->width == b->width && a->height == b->height &&
           a->samples == b->samples && a->type == b->type &&
           a->bits == b->bits && a->coding == b->coding;
}

/* Advances to the next page that counts; *got is false after the last. */
static snow_status next_page(snow_tiff *file, bool *got) {
    uint32_t kind = 0;
    do { /* past thumbnails of others */
        SNOW_TRY(snow_tiff_next(file, got));
        TIFFGetFieldDefaulted(file->tiff, TIFFTAG_SUBFILETYPE, &kind);
    } while (*got && (kind & FILETYPE_REDUCEDIMAGE));
    return SNOW_STATUS_OK;
}

/* Counts the pages, which must be alike: the first that differs is named. */
static snow_status count_pages(snow_tiff *file, tiff_plan *plan) {
    bool got;
    for (plan->images = 1;; plan->images++) {
        tiff_page page;
        SNOW_TRY(next_page(file, &got));
        if (!got)
            return SNOW_STATUS_OK;
        SNOW_TRY(snow_tiff_describe(file, &page));
        if (!same_page(&page, &plan->page))
            return snow_fail(
                file->context, SNOW_STATUS_BAD_INPUT,
                "page %lld has %lldx%lld pixels of %s, but the first has "
                "%lldx%lld of %s; all slices of a volume must be alike",
                (long long)plan->images, (long long)page.width,
                (long long)page.height, snow_type_name(page.type),
                (long long)plan->page.width, (long long)plan->page.height,
                snow_type_name(plan->page.type));
    }
}

/* Programs often call slices times, or channels, of which ImageJ shows at most
 * seven: a volume of one slice is hardly meant. */
static void take_for_slices(snow_context *context, tiff_plan *plan) {
    bool times = plan->times > 1;
    bool channels = plan->times == 1 && plan->channels > MOST_CHANNELS;
    if (plan->slices > 1 || (!times && !channels))
        return;
    int64_t *count = times ? &plan->times : &plan->channels;
    snow_notify(context, "its %lld %s of one slice are read as slices",
                (long long)*count, times ? "times" : "channels");
    plan->slice_step = times ? plan->time_step : plan->channel_step;
    plan->slices = *count;
    *count = 1;
}

/* Channels, slices and times by the description, if their product is the number
 * of images; otherwise all are slices. */
static void share_images(snow_context *context, tiff_plan *plan) {
    const tiff_shape *shape = &plan->shape;
    int64_t c = shape->channels ? shape->channels : 1;
    int64_t z = shape->slices ? shape->slices : 1;
    int64_t t = shape->frames ? shape->frames : 1;
    uint64_t all;
    /* OME counts the samples of a pixel as channels too. */
    if (!shape->imagej && plan->page.samples > 1 && c % plan->page.samples == 0)
        c /= plan->page.samples;
    bool right = snow_mul_u64((uint64_t)c, (uint64_t)z, &all) &&
                 snow_mul_u64(all, (uint64_t)t, &all) &&
                 all == (uint64_t)plan->images && (c > 1 || z > 1 || t > 1);
    if (!right) {
        c = t = 1;
        z = plan->images;
    }
    int64_t step = 1;
    for (const char *at = right ? shape->order + 2 : "CZT"; *at; at++) {
        if (*at == 'C') {
            plan->channel_step = step;
            step *= c;
        } else if (*at == 'Z') {
            plan->slice_step = step;
            step *= z;
        } else {
            plan->time_step = step;
            step *= t;
        }
    }
    plan->channels = c;
    plan->slices = z;
    plan->times = t;
    take_for_slices(context, plan);
}

/* Sizes of a pixel that microscopes, scanners and cameras give. */
#define LEAST_MM 1e-6
#define MOST_MM 10

/* Pixels an inch that programs write for screens and printers, or for nothing,
 * and that nobody has measured; an inch of 2.54 cm may be rounded. */
static bool is_of_paper(double inch) {
    static const short usual[] = {1,   72,  75,  90,  96,  100,  120,
                                  144, 150, 180, 200, 220, 240,  300,
                                  350, 360, 400, 600, 720, 1200, 2400};
    for (size_t n = 0; n < sizeof usual / sizeof *usual; n++)
        if (fabs(inch - usual[n]) < 0.005 * usual[n])
            return true;
    return false;
}

/* Returns whether somebody has measured pixels of this size. */
static bool is_measured(double mm) {
    return mm >= LEAST_MM && mm <= MOST_MM && !is_of_paper(25.4 / mm);
}

/* Pixels per unit of length: of ImageJ in the unit that its description names,
 * of others, where that gives no size, per inch or cm. */
static void take_resolution(snow_tiff *file, tiff_plan *plan) {
    tiff_shape *shape = &plan->shape;
    float x = 0, y = 0;
    uint16_t unit = RESUNIT_NONE;
    if (!TIFFGetField(file->tiff, TIFFTAG_XRESOLUTION, &x) ||
        !TIFFGetField(file->tiff, TIFFTAG_YRESOLUTION, &y))
        return;
    TIFFGetFieldDefaulted(file->tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
    double mm = shape->imagej                ? 1
                : unit == RESUNIT_INCH       ? 25.4
                : unit == RESUNIT_CENTIMETER ? 10
                                             : 0;
    plan->measured = !shape->imagej && !(shape->spacing[0] > 0) && x > 0 &&
                     y > 0 && is_measured(mm / (double)x) &&
                     is_measured(mm / (double)y);
    if (!shape->imagej && !plan->measured)
        return;
    shape->spacing[0] = mm / (double)x;
    shape->spacing[1] = mm / (double)y;
    if (plan->measured)
        memcpy(shape->unit, "mm", 3);
}

/* Samples that are colours have known names. */
static void describe_channels(const tiff_plan *plan, snow_volume_info *info) {
    const tiff_shape *shape = &plan->shape;
    const int64_t samples = plan->page.samples;
    snow_channels_begin(info, plan->channels * samples, true);
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++) {
        info->channel[n] = shape->channel[n];
        info->channel[n].shown = true;
    }
    if (plan->channels == 1 && shape->colors)
        snow_channels_are_colors(info);
    else if (plan->channels == 1 && shape->opacity && samples > 1 &&
             samples <= SNOW_CHANNELS_MAX)
        info->channel[samples - 1].shown = false;
}

static snow_status make_plan(snow_tiff *file, tiff_plan *plan,
                             snow_volume_info *info) {
    char *text = NULL;
    SNOW_TRY(snow_tiff_describe(file, &plan->page));
    TIFFGetField(file->tiff, TIFFTAG_IMAGEDESCRIPTION, &text);
    snow_tiff_read_text(text, &plan->shape);
    /* Slices whose distance is not given are as far apart as pixels. */
    tiff_shape *shape = &plan->shape;
    take_resolution(file, plan);
    for (int i = 0; i < 3; i++)
        if (shape->spacing[i] > 0 && isfinite(shape->spacing[i]))
            info->matrix[i][i] = shape->spacing[i];
        else if (i == 2)
            info->matrix[2][2] = info->matrix[0][0];
    snow_image_turn(info->matrix);
    memcpy(info->unit, shape->unit, sizeof info->unit);
    snow_tiff_read_channels(file, &plan->page, &plan->shape);
    SNOW_TRY(count_pages(file, plan));
    /* ImageJ writes one page followed by all images if they exceed 4 GB. */
    plan->raw = plan->images == 1 && plan->shape.imagej &&
                plan->shape.images > 1 && plan->page.coding == TIFF_PLAIN &&
                plan->page.compression == COMPRESSION_NONE &&
                !plan->page.separate;
    if (plan->raw)
        plan->images = plan->shape.images;
    share_images(file->context, plan);
    info->dims[0] = plan->page.width;
    info->dims[1] = plan->page.height;
    info->dims[2] = plan->slices;
    info->type = plan->page.type;
    info->times = plan->times;
    describe_channels(plan, info);
    return SNOW_STATUS_OK;
}

/* Checks that the file can hold all pixels of all images, compressed or not. */
static snow_status check_size(const snow_tiff *file, const tiff_plan *plan) {
    const tiff_page *page = &plan->page;
    uint64_t bits;
    bool counts =
        snow_mul_u64((uint64_t)page->width, (uint64_t)page->height, &bits) &&
        snow_mul_u64(bits, (uint64_t)page->samples, &bits) &&
        snow_mul_u64(bits, (uint64_t)plan->images, &bits) &&
        snow_mul_u64(bits, page->bits, &bits);
    uint64_t size = snow_seekable_size(file->bytes);
    if (counts && snow_tiff_least(page, bits / 8) <= size)
        return SNOW_STATUS_OK;
    return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                     "claims %lld images of %lldx%lld pixels, which its %llu "
                     "bytes cannot hold; it is truncated or damaged",
                     (long long)plan->images, (long long)page->width,
                     (long long)page->height, (unsigned long long)size);
}

/* Reads a page with its own layout: samples may be interleaved in one page and
 * in planes in the next, with another compression. */
static snow_status read_page(snow_tiff *file, const tiff_plan *plan,
                             int64_t sample, const snow_region *region,
                             unsigned char *slice) {
    tiff_page page;
    SNOW_TRY(snow_tiff_describe(file, &page));
    if (!same_page(&page, &plan->page))
        return snow_tiff_fail(file);
    return snow_tiff_read_page(file, &page, sample, region, slice);
}

/* Walks the pages from the first on, since each gives the position of the next;
 * those in the box are read into their slices. */
static snow_status read_pages(snow_tiff *file, const tiff_plan *plan,
                              int64_t first, int64_t sample,
                              const snow_region *region, snow_volume *volume) {
    size_t slice_bytes = (size_t)(region->count[0] * region->count[1]) *
                         snow_type_size(volume->info.type);
    int64_t at = 0;
    bool got = TIFFSetDirectory(file->tiff, 0) != 0;
    for (int64_t z = 0; z < region->count[2]; z++) {
        int64_t wanted = first + (region->first[2] + z) * plan->slice_step;
        unsigned char *slice =
            (unsigned char *)volume->owned + (size_t)z * slice_bytes;
        if (plan->raw) {
            SNOW_TRY(snow_tiff_read_raw(file, &plan->page, wanted, sample,
                                        region, slice));
            continue;
        }
        for (; at < wanted && got; at++)
            SNOW_TRY(next_page(file, &got));
        if (!got)
            return snow_tiff_fail(file);
        SNOW_TRY(read_page(file, plan, sample, region, slice));
    }
    return SNOW_STATUS_OK;
}

/* Channels are samples of a pixel or pages of their own. */
static snow_status read_open(snow_tiff *file,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    tiff_plan plan = {0};
    int64_t channel;
    snow_region region;
    SNOW_TRY(make_plan(file, &plan, info));
    if (plan.measured && !snow_spacing_given(options))
        snow_notify(file->context,
                    "a pixel is taken to be %.4g x %.4g mm by the file's "
                    "resolution; --spacing sets another",
                    plan.shape.spacing[0], plan.shape.spacing[1]);
    if (info->dims[2] > 1 && info->matrix[0][0] != 1 &&
        !(plan.shape.spacing[2] > 0) && !snow_spacing_given(options))
        snow_notify(file->context, SNOW_WIDTH_IS_DISTANCE, info->matrix[0][0]);
    SNOW_TRY(check_size(file, &plan));
    SNOW_TRY(snow_volume_pick_channel(file->context, options,
                                      plan.channels * plan.page.samples, info,
                                      &channel));
    SNOW_TRY(snow_volume_pick_time(file->context, "time step", options, info));
    SNOW_TRY(snow_region_lay_out(file->context, options, info, &region));
    if (!out)
        return SNOW_STATUS_OK;
    int64_t first = info->time * plan.time_step +
                    channel / plan.page.samples * plan.channel_step;
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(file->context, info, &volume));
    snow_status status = read_pages(
        file, &plan, first, channel % plan.page.samples, &region, volume);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_STATUS_OK;
}

static snow_status read_tiff(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_tiff file;
    *info = snow_volume_info_default("tiff");
    snow_status status = snow_tiff_open(source, &file);
    if (status == SNOW_STATUS_OK)
        status = read_open(&file, options, info, out);
    snow_tiff_close(&file);
    return status;
}

#elif SNOW_LOADS && SNOW_HAVE_TIFF

static snow_status read_tiff(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    return snow_read_by_module("tiff", source, options, info, out);
}

#else

static snow_status read_tiff(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    (void)options;
    (void)info;
    (void)out;
    return snow_fail_unbuilt(snow_source_context(source), "TIFF",
                             "libtiff-dev");
}

#endif

const snow_format snow_format_tiff = {
    .name = "tiff",
    .text = "TIFF, BigTIFF: pages, a folder or a pattern of files (.tif)",
    .suffixes = {".tif", ".tiff", ".btf", ".tif.gz", ".tiff.gz"},
    .probe = snow_tiff_probe,
    .crops = true,
    .channels = true,
    .slices = true,
    .read = read_tiff,
};
