/* volume/tiff.c - TIFF files whose pages are slices: .tif.
 *
 * Page after page from z = 0 on; ImageJ and OME tell in a description how the
 * pages go over channels, slices and times, and how large a voxel is.  Values
 * stay as they are stored: neither palettes nor "white is zero" change them.
 * Bits become uint8 of 0 and 1, half floats float32, 24 bits 32. */
#include "volume/tiff.h"
#include "volume/array.h"
#include "volume/optional.h"

#include <math.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

/* More of one slice are slices; see take_for_slices. */
#define MOST_CHANNELS 7

/* How the file's images make volumes. */
typedef struct tiff_plan {
    tiff_page page;
    tiff_shape shape;
    int64_t images; /* pages, or what ImageJ wrote behind the first */
    bool raw;       /* the latter */
    /* Images from one channel, slice and time to the next. */
    int64_t channel_step, slice_step, time_step;
    int64_t channels, slices, times;
} tiff_plan;

/* Small copies beside the images, for those who want a quick look. */
static bool is_reduced(TIFF *tiff) {
    uint32_t kind = 0;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SUBFILETYPE, &kind);
    return (kind & FILETYPE_REDUCEDIMAGE) != 0;
}

static bool same_page(const tiff_page *a, const tiff_page *b) {
    return a->width == b->width && a->height == b->height &&
           a->samples == b->samples && a->type == b->type &&
           a->bits == b->bits && a->coding == b->coding;
}

/* Goes to the next page that counts; *got is false behind the last.  Its answer
 * does not tell an end from a damaged page, libtiff's complaint does. */
static snow_status next_page(snow_tiff *file, bool *got) {
    do {
        *file->complaint = 0;
        *got = TIFFReadDirectory(file->tiff) != 0;
        if (!*got)
            return *file->complaint ? snow_tiff_fail(file) : SNOW_OK;
    } while (is_reduced(file->tiff));
    return SNOW_OK;
}

/* All pages must be alike: the first that is not is named. */
static snow_status count_pages(snow_tiff *file, tiff_plan *plan) {
    bool got;
    for (plan->images = 1;; plan->images++) {
        tiff_page page;
        SNOW_TRY(next_page(file, &got));
        if (!got)
            return SNOW_OK;
        SNOW_TRY(snow_tiff_describe(file, &page));
        if (!same_page(&page, &plan->page))
            return snow_fail(
                file->context, SNOW_BAD_INPUT,
                "page %lld has %lldx%lld pixels of %s where the first has "
                "%lldx%lld of %s; a volume's slices must be alike",
                (long long)plan->images, (long long)page.width,
                (long long)page.height, snow_type_name(page.type),
                (long long)plan->page.width, (long long)plan->page.height,
                snow_type_name(plan->page.type));
    }
}

/* ImageJ writes one page and all images behind it when they have more than
 * 4 GB. */
static void find_raw(tiff_plan *plan) {
    plan->raw = plan->images == 1 && plan->shape.imagej &&
                plan->shape.images > 1 && plan->page.coding == TIFF_PLAIN &&
                plan->page.compression == COMPRESSION_NONE &&
                !plan->page.separate;
    if (plan->raw)
        plan->images = plan->shape.images;
}

/* Programs often call slices times, or channels, of which ImageJ shows seven
 * at most: a volume of one slice is hardly meant. */
static void take_for_slices(snow_context *context, tiff_plan *plan) {
    bool times = plan->times > 1;
    bool channels = plan->times == 1 && plan->channels > MOST_CHANNELS;
    if (plan->slices > 1 || (!times && !channels))
        return;
    int64_t *count = times ? &plan->times : &plan->channels;
    snow_notify(context, "its %lld %s of one slice are taken for slices",
                (long long)*count, times ? "times" : "channels");
    plan->slice_step = times ? plan->time_step : plan->channel_step;
    plan->slices = *count;
    *count = 1;
}

/* Channels, slices and times by the description, where they are as many as
 * there are images; else all are slices. */
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

/* ImageJ has the pixels to the unit of length where others have those to the
 * inch on paper, which mean nothing here. */
static void place(snow_tiff *file, tiff_plan *plan, snow_volume_info *info) {
    tiff_shape *shape = &plan->shape;
    float x = 0, y = 0;
    if (shape->imagej && TIFFGetField(file->tiff, TIFFTAG_XRESOLUTION, &x) &&
        TIFFGetField(file->tiff, TIFFTAG_YRESOLUTION, &y)) {
        shape->spacing[0] = 1 / (double)x;
        shape->spacing[1] = 1 / (double)y;
    }
    for (int i = 0; i < 3; i++)
        if (shape->spacing[i] > 0 && isfinite(shape->spacing[i]))
            info->matrix[i][i] = shape->spacing[i];
    memcpy(info->unit, shape->unit, sizeof info->unit);
}

static snow_status make_plan(snow_tiff *file, tiff_plan *plan,
                             snow_volume_info *info) {
    char *text = NULL;
    SNOW_TRY(snow_tiff_describe(file, &plan->page));
    TIFFGetField(file->tiff, TIFFTAG_IMAGEDESCRIPTION, &text);
    snow_tiff_read_text(text, &plan->shape);
    place(file, plan, info);
    SNOW_TRY(count_pages(file, plan));
    find_raw(plan);
    share_images(file->context, plan);
    info->dims[0] = plan->page.width;
    info->dims[1] = plan->page.height;
    info->dims[2] = plan->slices;
    info->type = plan->page.type;
    info->times = plan->times;
    return SNOW_OK;
}

/* All pixels of all images must be in the file, packed or not. */
static snow_status check_size(const snow_tiff *file, const tiff_plan *plan) {
    const tiff_page *page = &plan->page;
    uint64_t bits;
    bool counts =
        snow_mul_u64((uint64_t)page->width, (uint64_t)page->height, &bits) &&
        snow_mul_u64(bits, (uint64_t)page->samples, &bits) &&
        snow_mul_u64(bits, (uint64_t)plan->images, &bits) &&
        snow_mul_u64(bits, page->bits, &bits);
    uint64_t size = snow_random_size(file->bytes);
    if (counts && snow_tiff_least(page, bits / 8) <= size)
        return SNOW_OK;
    return snow_fail(file->context, SNOW_BAD_INPUT,
                     "says that it has %lld images of %lldx%lld pixels, which "
                     "its %llu bytes cannot hold; it is cut or damaged",
                     (long long)plan->images, (long long)page->width,
                     (long long)page->height, (unsigned long long)size);
}

/* A page as it says of itself: samples may lie beside one another in one and in
 * planes in the next, and be packed otherwise. */
static snow_status read_page(snow_tiff *file, const tiff_plan *plan,
                             int64_t sample, const snow_window *window,
                             unsigned char *slice) {
    tiff_page page;
    SNOW_TRY(snow_tiff_describe(file, &page));
    if (!same_page(&page, &plan->page))
        return snow_tiff_fail(file);
    return snow_tiff_read_page(file, &page, sample, window, slice);
}

/* Pages are gone through from the first on, since each tells where the next
 * one is; those wanted are put in their slice. */
static snow_status read_pages(snow_tiff *file, const tiff_plan *plan,
                              int64_t first, int64_t sample,
                              const snow_window *window, snow_volume *volume) {
    size_t slice_bytes = (size_t)(window->count[0] * window->count[1]) *
                         snow_type_size(volume->info.type);
    int64_t at = 0;
    bool got = TIFFSetDirectory(file->tiff, 0) != 0;
    for (int64_t z = 0; z < window->count[2]; z++) {
        int64_t wanted = first + (window->first[2] + z) * plan->slice_step;
        unsigned char *slice =
            (unsigned char *)volume->owned + (size_t)z * slice_bytes;
        if (plan->raw) {
            SNOW_TRY(snow_tiff_read_raw(file, &plan->page, wanted, sample,
                                        window, slice));
            continue;
        }
        for (; at < wanted && got; at++)
            SNOW_TRY(next_page(file, &got));
        if (!got)
            return snow_tiff_fail(file);
        SNOW_TRY(read_page(file, plan, sample, window, slice));
    }
    return SNOW_OK;
}

/* Channels lie in the pixels or in pages of their own. */
static snow_status read_open(snow_tiff *file,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    tiff_plan plan = {0};
    int64_t channel;
    snow_window window;
    SNOW_TRY(make_plan(file, &plan, info));
    SNOW_TRY(check_size(file, &plan));
    SNOW_TRY(snow_volume_pick_channel(
        file->context, options, plan.channels * plan.page.samples, &channel));
    SNOW_TRY(snow_volume_pick_time(file->context, "time step", options, info));
    SNOW_TRY(snow_window_lay(file->context, options, info, &window));
    if (!out)
        return SNOW_OK;
    int64_t first = info->time * plan.time_step +
                    channel / plan.page.samples * plan.channel_step;
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(file->context, info, &volume));
    snow_status status = read_pages(
        file, &plan, first, channel % plan.page.samples, &window, volume);
    if (status != SNOW_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_OK;
}

static snow_status read_tiff(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_tiff file;
    *info = snow_volume_info_default("tiff");
    snow_status status = snow_tiff_open(source, &file);
    if (status == SNOW_OK)
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
