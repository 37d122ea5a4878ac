/* formats/tiff/tiff.c - TIFF files whose pages are slices: .tif.
 *
 * Pages are slices from z = 0 on, the first in front, with row 0 at the top.
 * Descriptions by ImageJ, tifffile and OME give the order of channels, slices
 * and times, and the size of a voxel.  Palettes do not change values.  Half
 * floats become float32, integers the next larger type. */
#include "formats/tiff/tiff.h"
#include "formats/array.h"
#include "formats/features.h"
#include "volume/length_unit.h"
#include "volume/mask.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

/* More of one slice are read as slices; see take_for_slices. */
#define MOST_CHANNELS 7

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

/* Channels, slices and times by the description, and how far apart each lie;
 * without one all pages are slices. */
static snow_status share_planes(snow_context *context, tiff_plan *plan) {
    const tiff_shape *shape = &plan->shape;
    const int64_t sizes[3] = {shape->channels, shape->slices, shape->frames};
    uint64_t all;
    int64_t *steps[3] = {&plan->channel_step, &plan->slice_step,
                         &plan->time_step};
    if (!snow_mul_u64((uint64_t)sizes[0], (uint64_t)sizes[1], &all) ||
        !snow_mul_u64(all, (uint64_t)sizes[2], &all) || all >> 40)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its description claims more planes than any file "
                         "has; it is damaged");
    plan->planes = (int64_t)all;
    int64_t step = 1;
    for (const char *at = shape->order + 2; *at; at++) {
        const int axis = (int)(strchr("CZT", *at) - "CZT");
        *steps[axis] = step;
        step *= sizes[axis];
    }
    plan->channels = sizes[0];
    plan->slices = sizes[1];
    plan->times = sizes[2];
    return SNOW_STATUS_OK;
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
    for (int i = 0; i < 3 && plan->measured; i++)
        memcpy(shape->units[i], "mm", 3);
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
    if ((shape->ome || shape->imagej) && !shape->colors)
        snow_channels_are_light(info, shape->through);
}

/* Where one page is followed by all planes, as ImageJ writes more than 4 GB and
 * MetaMorph all, those that are there. */
static snow_status count_raw(const snow_tiff *file, tiff_plan *plan) {
    const tiff_page *page = &plan->page;
    const bool stk = plan->shape.metamorph;
    const uint64_t at = TIFFCurrentDirOffset(file->tiff);
    const uint64_t plane =
        TIFFScanlineSize64(file->tiff) * (uint64_t)page->height;
    uint64_t *offsets = NULL, end = snow_seekable_size(file->bytes);
    plan->raw = plan->present == 1 && plan->planes > 1 &&
                page->coding == TIFF_PLAIN && !page->separate && plane &&
                page->compression == COMPRESSION_NONE &&
                TIFFGetField(file->tiff, TIFFTAG_STRIPOFFSETS, &offsets) &&
                offsets && *offsets < end && (stk || at < *offsets);
    if (stk && !plan->raw)
        return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                         "is a stack of MetaMorph (.stk) whose planes are "
                         "packed; save it as TIFF with ImageJ");
    if (plan->raw && at > *offsets && at < end)
        end = at;
    if (plan->raw)
        plan->present = (int64_t)((end - *offsets) / plane);
    if (plan->raw && plan->present > plan->planes)
        plan->present = plan->planes;
    return SNOW_STATUS_OK;
}

/* Channels, slices and times of ImageJ count if their product is the number of
 * images that it says, or without that of pages. */
static snow_status plan_pages(tiff_set *set, tiff_plan *plan) {
    tiff_shape *shape = &plan->shape;
    tiff_reader *own = &set->own;
    const double said =
        (double)shape->channels * (double)shape->slices * (double)shape->frames;
    const int64_t most = shape->images > 1 ? shape->images : INT64_MAX;
    SNOW_TRY(snow_tiff_list_pages(own, false, &plan->page, most));
    if (!TIFFSetSubDirectory(own->file.tiff, *own->pages))
        return snow_tiff_fail(&own->file);
    plan->present = own->count;
    const int64_t all = shape->images > 1 ? shape->images : own->count;
    if (said != (double)all) {
        shape->channels = shape->frames = 1;
        shape->slices = all;
    }
    if (!*shape->order)
        memcpy(shape->order, "XYCZT", sizeof shape->order);
    SNOW_TRY(share_planes(set->context, plan));
    if (plan->present > plan->planes) {
        snow_notify(set->context,
                    "%lld pages beyond the %lld images of its description are "
                    "left out",
                    (long long)(plan->present - plan->planes),
                    (long long)plan->planes);
        plan->present = plan->planes;
    }
    SNOW_TRY(count_raw(&own->file, plan));
    return snow_tiff_check_count(set, plan->present, plan->planes);
}

/* Pages are as the first that the XML names and that is there. */
static snow_status plan_ome(tiff_set *set, tiff_plan *plan, tiff_reader **out) {
    const tiff_ome *ome = &set->ome;
    tiff_reader *reader = NULL;
    plan->shape = ome->shape;
    if (set->own.open)
        SNOW_TRY(snow_tiff_list_pages(&set->own, true, NULL, 0));
    size_t n = 0;
    for (; n < ome->run_count; n++) {
        SNOW_TRY(snow_tiff_open_member(set, ome->runs[n].file, &reader));
        if (reader && ome->runs[n].page < reader->count)
            break;
    }
    if (n == ome->run_count)
        return snow_fail(set->context, SNOW_STATUS_BAD_INPUT,
                         "none of the pages of its image is there; get its "
                         "other files, and put them beside it");
    if (!TIFFSetSubDirectory(reader->file.tiff,
                             reader->pages[ome->runs[n].page]))
        return snow_tiff_fail(&reader->file);
    SNOW_TRY(snow_tiff_describe(&reader->file, &plan->page));
    /* Samples of a pixel are counted as channels too. */
    if (plan->page.samples > 1 &&
        plan->shape.channels % plan->page.samples == 0)
        plan->shape.channels /= plan->page.samples;
    SNOW_TRY(share_planes(set->context, plan));
    SNOW_TRY(snow_tiff_place(set, plan));
    return snow_tiff_open_member(set, ome->runs[n].file, out);
}

/* Slices whose distance is not given are as far apart as pixels. */
static void take_matrix(snow_tiff *file, tiff_plan *plan,
                        snow_volume_info *info) {
    const tiff_shape *shape = &plan->shape;
    const char *texts[3];
    double factors[3];
    take_resolution(file, plan);
    for (int i = 0; i < 3; i++)
        texts[i] =
            shape->spacing[i] > 0 || *shape->units[i] ? shape->units[i] : NULL;
    snow_length_join(file->context, texts, factors, info->unit);
    for (int i = 0; i < 3; i++)
        if (shape->spacing[i] > 0 && isfinite(shape->spacing[i]))
            info->matrix[i][i] = factors[i] * shape->spacing[i];
        else if (i == 2)
            info->matrix[2][2] = info->matrix[0][0];
    snow_image_turn(info->matrix);
}

/* ImageJ calibrates samples of 8 and 16 bits; ranges are of stored values. */
static void take_calibration(const tiff_plan *plan, snow_volume_info *info) {
    const tiff_shape *shape = &plan->shape;
    if (plan->page.samples > 1 || info->type > SNOW_TYPE_UINT16)
        return;
    info->intercept = shape->scale[0];
    info->slope = shape->scale[1];
    memcpy(info->value_unit, shape->value_unit, sizeof info->value_unit);
    info->hounsfield = snow_has_suffix(shape->value_unit, "HU") ||
                       strstr(shape->value_unit, "ounsfield");
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++) {
        double *window = info->channel[n].window;
        for (int end = 0; end < 2 && (window[0] != 0 || window[1] != 0); end++)
            window[end] = info->intercept + info->slope * window[end];
    }
}

static snow_status make_plan(tiff_set *set, tiff_plan *plan,
                             snow_volume_info *info) {
    tiff_reader *reader = &set->own;
    char *text = NULL;
    if (set->is_ome) {
        SNOW_TRY(plan_ome(set, plan, &reader));
    } else {
        SNOW_TRY(snow_tiff_describe(&reader->file, &plan->page));
        TIFFGetField(reader->file.tiff, TIFFTAG_IMAGEDESCRIPTION, &text);
        snow_tiff_read_text(text, &plan->shape);
        SNOW_TRY(snow_tiff_read_shape(set->context, text, &plan->page,
                                      &plan->shape));
        snow_tiff_read_tags(&reader->file, &plan->page, &plan->shape);
        SNOW_TRY(plan_pages(set, plan));
    }
    take_matrix(&reader->file, plan, info);
    snow_tiff_read_channels(&reader->file, &plan->page, &plan->shape);
    take_for_slices(set->context, plan);
    info->dims[0] = plan->page.width;
    info->dims[1] = plan->page.height;
    info->dims[2] = plan->slices;
    info->type = plan->page.type;
    info->times = plan->times;
    info->negative = plan->page.white && !plan->page.flip;
    describe_channels(plan, info);
    take_calibration(plan, info);
    return SNOW_STATUS_OK;
}

/* --- what is said --------------------------------------------------------- */

static void note_spacing(snow_context *context, const tiff_plan *plan,
                         const snow_volume_options *options,
                         const snow_volume_info *info) {
    if (snow_spacing_given(options))
        return;
    if (plan->measured)
        snow_notify(context,
                    "a pixel is taken to be %.4g x %.4g mm by the file's "
                    "resolution; --spacing sets another",
                    plan->shape.spacing[0], plan->shape.spacing[1]);
    if (info->dims[2] > 1 && info->matrix[0][0] != 1 &&
        !(plan->shape.spacing[2] > 0))
        snow_notify(context, SNOW_WIDTH_IS_DISTANCE, info->matrix[0][0]);
}

static void note_set(const tiff_set *set, const snow_volume_options *options,
                     snow_volume_info *info) {
    if (set->ome.images > 1 && !options->dataset && !options->series)
        snow_notify(set->context,
                    "has %lld images: %s; image %lld is taken, --dataset "
                    "selects another by its number or name",
                    (long long)set->ome.images, set->ome.list,
                    (long long)set->ome.taken);
    if (set->renamed)
        snow_notify(set->context,
                    "%lld of its files have other names than it says, and "
                    "were found by their UUIDs or as the only one",
                    (long long)set->renamed);
    if (set->strange)
        snow_notify(set->context,
                    "%lld of its files have another UUID than it says; files "
                    "of those names are taken",
                    (long long)set->strange);
    if (set->ome.files > 1)
        snprintf(info->storage, sizeof info->storage, SNOW_SET_OF_FILES,
                 set->ome.files);
}

static void note_values(snow_context *context, const tiff_plan *plan) {
    if (plan->page.flip)
        snow_notify(context, "its 0 is white (MinIsWhite): values are inverted "
                             "to be bright where it is");
    else if (plan->page.white)
        snow_notify(context, "its 0 is white (MinIsWhite): values are kept, "
                             "and high ones are dark in slices");
    if (plan->page.turn > 1)
        snow_notify(context,
                    "its pages are meant to be turned or mirrored (Orientation "
                    "%d); rows and columns are kept as they are stored",
                    plan->page.turn);
    if (!isnan(plan->shape.nodata))
        snow_notify(context,
                    "voxels of %.9g have no value, by its tag GDAL_NODATA",
                    plan->shape.nodata);
    if (plan->shape.bent)
        snow_notify(context, "its values have a calibration of ImageJ that is "
                             "no straight line; they are as stored");
}

/* --- voxels --------------------------------------------------------------- */

/* Puts NaN where slices or values are missing, for which the type changes. */
static snow_status leave_gaps(snow_volume **volume, double nodata,
                              const bool *missing) {
    snow_volume *old = *volume, *made;
    snow_volume_info info = old->info;
    const int64_t slice = info.dims[0] * info.dims[1];
    snow_mask_info(&info);
    SNOW_TRY(snow_volume_new(old->context, &info, &made));
    for (int64_t i = 0; i < slice * info.dims[2]; i++) {
        double value = snow_volume_native(old, i);
        if (missing[i / slice] || value == nodata)
            value = NAN;
        if (info.type == SNOW_TYPE_FLOAT32)
            ((float *)made->owned)[i] = (float)value;
        else
            ((double *)made->owned)[i] = value;
    }
    snow_volume_close(old);
    *volume = made;
    return SNOW_STATUS_OK;
}

static snow_status read_box(tiff_set *set, const tiff_plan *plan, bool gaps,
                            int64_t channel, const snow_region *region,
                            snow_volume_info *info, snow_volume **out) {
    const int64_t samples = plan->page.samples;
    const int64_t first =
        info->time * plan->time_step + channel / samples * plan->channel_step;
    snow_volume *volume = NULL;
    bool *missing =
        snow_allocate_array(set->context, (uint64_t)region->count[2], 1);
    if (!missing)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = snow_volume_new(set->context, info, &volume);
    if (status == SNOW_STATUS_OK)
        status = snow_tiff_read_planes(set, plan, first, channel % samples,
                                       region, volume, missing);
    if (status == SNOW_STATUS_OK && gaps)
        status = leave_gaps(&volume, plan->shape.nodata, missing);
    snow_release(set->context, missing);
    return snow_volume_give(status, volume, out);
}

/* Channels are samples of a pixel or pages of their own. */
static snow_status read_open(tiff_set *set, tiff_plan *plan,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = set->context;
    int64_t channel;
    bool gaps;
    snow_region region;
    SNOW_TRY(make_plan(set, plan, info));
    note_spacing(context, plan, options, info);
    SNOW_TRY(snow_volume_pick_channel(
        context, options, plan->channels * plan->page.samples, info, &channel));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    SNOW_TRY(snow_tiff_check_planes(
        set, plan, options, channel / plan->page.samples, info->time, &gaps));
    gaps |= !isnan(plan->shape.nodata);
    note_set(set, options, info);
    note_values(context, plan);
    SNOW_TRY(snow_region_lay_out(context, options, info, &region));
    if (out)
        SNOW_TRY(read_box(set, plan, gaps, channel, &region, info, out));
    if (gaps)
        snow_mask_info(info);
    return SNOW_STATUS_OK;
}

static snow_status read_tiff(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    tiff_set set;
    tiff_plan plan = {.places = NULL};
    *info = snow_volume_info_default("tiff");
    snow_status status = snow_tiff_open_set(source, options, &set);
    if (status == SNOW_STATUS_OK)
        status = read_open(&set, &plan, options, info, out);
    snow_release(set.context, plan.places);
    snow_tiff_close_set(&set);
    return status;
}

#elif SNOW_LOADS && SNOW_HAVE_TIFF

SNOW_READ_BY_MODULE(read_tiff, "tiff")

#else

SNOW_READ_UNBUILT(read_tiff, "TIFF", "libtiff-dev")

#endif

const snow_format snow_format_tiff = {
    .name = "tiff",
    .text = "TIFF, BigTIFF: pages, a folder or a pattern of files (.tif)",
    .suffixes = {".tif", ".tiff", ".btf", ".tif.gz", ".tiff.gz",
                 SNOW_COMPANION},
    .probe = snow_tiff_probe,
    .crops = true,
    .sets = true,
    .series = true,
    .channels = true,
    .slices = true,
    .read = read_tiff,
};
