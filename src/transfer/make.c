/* transfer/make.c - makes a transfer function from a look.
 *
 * A preset, or the histogram, gives control points over values of its own.  A
 * requested range stretches these points over it.  A colour map then replaces
 * the colours, and opacities replace the opacities.  The gradient opacity is
 * used only if requested. */
#include "transfer/look.h"

#include <snowglass/ranks.h>

#include <math.h>
#include <string.h>

SNOW_RECORD_OF_ZEROS(snow_look);

typedef const char *name_fn(size_t index);

static snow_status refuse_name(snow_context *context, const char *what,
                               const char *name, name_fn *names) {
    char list[768] = "";
    for (size_t i = 0; names(i); i++) {
        strncat(list, i ? ", " : "", sizeof list - strlen(list) - 1);
        strncat(list, names(i), sizeof list - strlen(list) - 1);
    }
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "%s '%.64s' is unknown; choose one of %s", what, name,
                     list);
}

static snow_status check_look(snow_context *context, const snow_look *look) {
    if ((int)look->range < SNOW_RANGE_AUTO || look->range > SNOW_RANGE_SIGNAL)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "range %d is out of range; take a value of snow_range",
                         (int)look->range);
    if (look->preset && snow_preset_from_name(look->preset) < 0)
        return refuse_name(context, "preset", look->preset, snow_preset_name);
    if (look->colormap && snow_colormap_from_name(look->colormap) < 0)
        return refuse_name(context, "colour map", look->colormap,
                           snow_colormap_name);
    if (snow_look_is_of_labels(look) && !snow_look_suits_labels(look))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "labels have a colour each, and no range; leave out "
                         "range and log, and give colours by a list "
                         "such as 3:#ff8800, not by the name of a map");
    if ((look->log && look->symlog != 0) || !isfinite(look->symlog))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "logarithms and symmetric ones from %g on exclude one "
                         "another; give one of them, with a finite number",
                         look->symlog);
    if (!(look->white >= 0 && look->white <= 1))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a white of %g is no brightness; give 0 to 1",
                         look->white);
    if (look->opacities && !look->opacity_count)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "a list of 0 opacities has no meaning; give at least one point");
    if (look->gradient_opacities && !look->gradient_opacity_count)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a list of 0 gradient opacities has no meaning; give "
                         "at least one point");
    if (look->range != SNOW_RANGE_VALUES &&
        look->range != SNOW_RANGE_PERCENTILES)
        return SNOW_STATUS_OK;
    if (!isfinite(look->low) || !isfinite(look->high) ||
        !(look->low < look->high))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a range from %g to %g is empty; give two finite ends "
                         "in rising order",
                         look->low, look->high);
    if (look->range == SNOW_RANGE_PERCENTILES &&
        (look->low < 0 || look->high > 100))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "percentiles %g to %g are out of range; give 0 to 100",
                         look->low, look->high);
    return SNOW_STATUS_OK;
}

/* The data values of the requested range. */
static snow_status resolve_range(const snow_histogram *histogram,
                                 const snow_look *look, double *low,
                                 double *high, snow_transfer_builder *builder) {
    snow_full_range(histogram, low, high);
    if (look->range == SNOW_RANGE_VALUES) {
        *low = look->low;
        *high = look->high;
    }
    if (look->range == SNOW_RANGE_SIGNAL)
        return snow_signal_range(histogram, low, high, builder);
    if (look->range >= SNOW_RANGE_ROBUST)
        return snow_robust_range(histogram, look->range, low, high, builder);
    if (look->range != SNOW_RANGE_PERCENTILES || !histogram->finite)
        return SNOW_STATUS_OK;
    const double shares[2] = {look->low / 100, look->high / 100};
    double ends[2];
    SNOW_TRY(snow_quantiles(histogram, SNOW_HISTOGRAM_EXACT, shares, 2, ends));
    if (ends[0] < ends[1]) {
        *low = ends[0];
        *high = ends[1];
        return SNOW_STATUS_OK;
    }
    snow_notify(histogram->volume->context,
                "percentiles %g and %g are both %g; the whole range is used",
                look->low, look->high, ends[0]);
    return SNOW_STATUS_OK;
}

/* The new position of `value` when the points are stretched over low..high.
 * Points whose range rounding has reduced to nothing become a step. */
static double stretched(const snow_transfer_builder *builder, snow_scale scale,
                        double value, double low, double high) {
    if (!(builder->low < builder->high))
        return low;
    double share = snow_share_on(scale, builder->low, builder->high, value);
    return snow_transfer_builder_place(builder, low, high, share);
}

/* `scale` is what the values were interpolated on: for shares and the histogram
 * the builder's, for data values that of their source.
 * Gradients are stretched by the same factor as the values. */
static void stretch(snow_transfer_builder *builder, snow_scale scale,
                    double low, double high) {
    double steeper = (high - low) / (builder->high - builder->low);
    if (builder->around_0 && low == builder->low && high == builder->high)
        return; /* as it is, to the last bit */
    for (size_t i = 0; i < builder->color_count; i++)
        builder->colors[i].value =
            stretched(builder, scale, builder->colors[i].value, low, high);
    for (size_t i = 0; i < builder->opacity_count; i++)
        builder->opacities[i].value =
            stretched(builder, scale, builder->opacities[i].value, low, high);
    for (size_t i = 0; i < builder->gradient_count && isfinite(steeper); i++)
        builder->gradients[i].value *= steeper;
    builder->low = low;
    builder->high = high;
}

static const snow_look *points_of(const snow_look *look) {
    if (look->base)
        return look->base;
    return look->preset
               ? snow_preset_look((size_t)snow_preset_from_name(look->preset))
               : NULL;
}

/* Allocates the points. */
static snow_status begin_builder(snow_context *context, const snow_look *look,
                                 snow_transfer_builder *builder) {
    const snow_look *points = points_of(look);
    size_t colors = SNOW_TRANSFER_BUILDER_POINTS,
           opacities = SNOW_TRANSFER_BUILDER_POINTS;
    if (points && points->color_count > colors)
        colors = points->color_count;
    if (points && points->opacity_count > opacities)
        opacities = points->opacity_count;
    size_t gradients = points ? points->gradient_opacity_count : 0;
    *builder = (snow_transfer_builder){
        .scale = {look->log || (points && points->log), fmax(look->symlog, 0)}};
    return snow_transfer_builder_reserve(context, colors, opacities, gradients,
                                         builder);
}

/* What most files of CT add to Hounsfield units that say nothing of it. */
#define CT_OFFSET 1024

/* Checks that the values suit those of a preset or a file.  Values of 8 bits
 * are no Hounsfield units: presets for these are spread over the object's. */
static snow_status fit_values(const snow_histogram *histogram,
                              const snow_look *look, const snow_look *points,
                              snow_transfer_builder *builder) {
    snow_context *context = histogram->volume->context;
    double low, high;
    if (points->domain != SNOW_DOMAIN_DATA || look->range != SNOW_RANGE_AUTO)
        return SNOW_STATUS_OK;
    if (builder->scale.log && !(builder->low > 0))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%.64s has values of 0 and below, which a logarithmic "
                         "scale cannot show; give a range too",
                         points->name);
    if (look->base || !(histogram->min >= 0) || histogram->had_negative)
        return SNOW_STATUS_OK;
    if (!snow_has_8_bits(&histogram->volume->info) || builder->scale.log ||
        histogram->max > 255) {
        const char *offset =
            histogram->max > CT_OFFSET
                ? "if the values have an offset of 1024, give --range"
                : "another range may suit them better than";
        const double added = histogram->max > CT_OFFSET ? CT_OFFSET : 0;
        snow_notify(context,
                    "%s is for Hounsfield units, but the smallest value is %g "
                    "and the largest %g: %s %g,%g",
                    look->preset, histogram->min, histogram->max, offset,
                    builder->low + added, builder->high + added);
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(snow_object_range(histogram, &low, &high));
    stretch(builder, (snow_scale){0}, low, high);
    snow_notify(context,
                "%s is for Hounsfield units, and the values are of 8 bits: it "
                "is spread over the object's, %g to %g; --range sets others",
                look->preset, low, high);
    return SNOW_STATUS_OK;
}

/* What has to be known of the values where no colour and no opacity is to be
 * guessed. */
static snow_histogram_need need_of_range(const snow_volume *volume,
                                         const snow_look *look,
                                         const snow_look *points) {
    snow_domain values = points ? points->domain : SNOW_DOMAIN_DATA;
    if (look->range == SNOW_RANGE_PERCENTILES ||
        look->range >= SNOW_RANGE_ROBUST || values == SNOW_DOMAIN_OBJECT ||
        values == SNOW_DOMAIN_SYMMETRIC)
        return SNOW_NEED_COUNTS;
    if (look->range == SNOW_RANGE_FULL || values == SNOW_DOMAIN_RANGE ||
        (look->symlog < 0 && look->range != SNOW_RANGE_VALUES))
        return SNOW_NEED_RANGE;
    /* Hounsfield units (fit_values). */
    bool preset = look->range == SNOW_RANGE_AUTO && !look->base;
    if (preset && snow_has_8_bits(&volume->info))
        return SNOW_NEED_COUNTS;
    return preset ? SNOW_NEED_SIGN : SNOW_NEED_NOTHING;
}

static snow_histogram_need need_of(const snow_volume *volume,
                                   const snow_look *look) {
    const snow_look *points = points_of(look);
    bool colors = look->colormap || (points && points->color_count);
    bool opacities = look->opacities || (points && points->opacity_count);
    if (!colors || !opacities)
        return SNOW_NEED_COUNTS;
    if (!points && look->range == SNOW_RANGE_AUTO)
        return SNOW_NEED_COUNTS;
    if (points && !points->opacity_count && points->domain != SNOW_DOMAIN_DATA)
        return SNOW_NEED_COUNTS;
    return need_of_range(volume, look, points);
}

/* The points of a preset or a file, and where they say nothing, or nothing is
 * asked, the histogram's. */
static snow_status fill_builder(const snow_histogram *histogram,
                                const snow_look *look,
                                snow_transfer_builder *builder) {
    const snow_look *points = points_of(look);
    const bool asked = snow_look_is_of_labels(look);
    if (asked || (!points && snow_look_is_free(look)))
        SNOW_TRY(snow_transfer_builder_labels(histogram, look, asked, builder));
    if (builder->labels)
        return SNOW_STATUS_OK;
    builder->high = 1; /* without points, until it is stretched */
    if (need_of(histogram->volume, look) == SNOW_NEED_COUNTS &&
        (!points || !points->color_count || !points->opacity_count))
        SNOW_TRY(snow_transfer_builder_automatic(histogram, look, builder));
    if (!points)
        SNOW_TRY(snow_transfer_builder_overlay(histogram, look, builder));
    if (!builder->around_0) /* whose reach is round */
        snow_transfer_builder_round(builder);
    if (!points)
        return SNOW_STATUS_OK;
    builder->reason = !look->base  ? look->preset
                      : look->name ? look->name
                                   : "from the file";
    builder->preset = NULL;
    builder->colormap = points->color_count ? NULL : builder->colormap;
    double low = builder->low, high = builder->high;
    SNOW_TRY(snow_transfer_builder_points(points, histogram, builder));
    builder->unshaded = builder->unshaded && !points->opacity_count;
    builder->range_note[0] = 0;
    /* Colours without values and opacities use the range of the histogram. */
    if (!points->opacity_count && points->domain != SNOW_DOMAIN_DATA) {
        for (size_t i = 0; i < builder->color_count; i++)
            builder->colors[i].value = snow_between_on(
                builder->scale, low, high, points->colors[i].value);
        builder->low = low;
        builder->high = high;
    }
    return fit_values(histogram, look, points, builder);
}

static snow_status build_look(const snow_histogram *histogram,
                              const snow_look *look,
                              snow_transfer_builder *builder) {
    const snow_look *points = points_of(look);
    SNOW_TRY(fill_builder(histogram, look, builder));
    builder->slice = snow_is_slice(histogram->volume);
    if (look->range != SNOW_RANGE_AUTO) {
        double low, high;
        bool data = points && points->domain == SNOW_DOMAIN_DATA;
        SNOW_TRY(resolve_range(histogram, look, &low, &high, builder));
        if (builder->scale.log && !(low > 0))
            return snow_fail(histogram->volume->context, SNOW_STATUS_BAD_USAGE,
                             "a range from %g has no logarithm; begin above 0",
                             low);
        stretch(builder, data ? (snow_scale){points->log, 0} : builder->scale,
                low, high);
    }
    const snow_volume_info *info = &histogram->volume->info;
    const bool linear = look->preset && !strcmp(look->preset, "linear");
    const char *map = look->colormap ? look->colormap : builder->colormap;
    if (!look->colormap && info->negative && linear)
        map = "grey_r";
    /* Lengths of vectors have colours, as in ParaView; those of complex numbers
     * are MR. */
    if (!look->colormap && info->magnitude && info->components == 3 &&
        (linear || !points))
        map = "viridis";
    if (map && !builder->labels) /* which have taken theirs */
        snow_transfer_builder_colormap(builder, map, builder->low,
                                       builder->high);
    /* Rounding of logarithms may have made values decrease. */
    for (size_t i = 1; i < builder->color_count; i++)
        if (builder->colors[i].value < builder->colors[i - 1].value)
            builder->colors[i].value = builder->colors[i - 1].value;
    for (size_t i = 1; i < builder->opacity_count; i++)
        if (builder->opacities[i].value < builder->opacities[i - 1].value)
            builder->opacities[i].value = builder->opacities[i - 1].value;
    return SNOW_STATUS_OK;
}

/* The same on all ranks, except for errors of memory. */
static snow_status build(const snow_volume *volume,
                         snow_transfer_builder *builder, const snow_look *look,
                         snow_transfer **out) {
    snow_transfer *transfer;
    const bool given = look->opacities && !builder->labels;
    SNOW_TRY(snow_transfer_new(
        volume->context, builder->colors, builder->color_count,
        given ? look->opacities : builder->opacities,
        given ? look->opacity_count : builder->opacity_count, &transfer));
    snow_status refined = snow_transfer_refine(transfer, builder->scale.linear);
    if (refined != SNOW_STATUS_OK) {
        snow_transfer_free(transfer);
        return refined;
    }
    transfer->labels = builder->labels;
    transfer->label_count = builder->label_count;
    snow_transfer_builder_describe(builder, look, transfer);
    builder->labels = NULL;
    bool own = look->gradient_opacities != NULL;
    snow_status status = snow_transfer_set_gradient_opacity(
        transfer, own ? look->gradient_opacities : builder->gradients,
        own ? look->gradient_opacity_count : builder->gradient_count);
    transfer->unshaded =
        builder->slice || (builder->unshaded && !look->opacities);
    transfer->preset = builder->preset;
    transfer->white = look->white;
    if (status == SNOW_STATUS_OK && builder->scale.log)
        status = snow_transfer_set_log(transfer);
    if (status != SNOW_STATUS_OK) {
        snow_transfer_free(transfer);
        return status;
    }
    *out = transfer;
    return SNOW_STATUS_OK;
}

static bool has_gradient_opacity(const snow_look *look) {
    if (look->gradient_opacities)
        return true;
    if (look->preset && snow_preset_from_name(look->preset) < 0)
        return false;
    snow_look base;
    return SNOW_RECORD_READ(NULL, snow_look, points_of(look), &base) ==
               SNOW_STATUS_OK &&
           base.gradient_opacity_count > 0;
}

/* Colours with steps are of labels; `info` NULL: none are. */
int snow_look_slopes(const snow_look *look, const snow_volume_info *info) {
    bool asked = snow_look_is_of_labels(look);
    bool labels = asked || look->base || look->colors || look->colormap ||
                  (!look->preset && snow_look_is_free(look));
    return (has_gradient_opacity(look) ? SNOW_SLOPES_FADE : 0) |
           (labels && info &&
                    (asked || info->whole || info->type < SNOW_TYPE_FLOAT32)
                ? SNOW_SLOPES_WIDE
                : 0);
}

/* A look, and the points that stand for a preset. */
typedef struct known_look {
    snow_look look, base;
    bool reversed; /* instead of a map of that name */
} known_look;

/* The look's own points become its base. */
static void take_own_points(known_look *r) {
    r->base = r->look;
    if (!r->base.name)
        r->base.name = "own";
    r->look.name = "as given";
    r->look.colors = NULL;
    r->look.opacities = r->look.gradient_opacities = NULL;
    r->look.color_count = r->look.opacity_count = 0;
    r->look.gradient_opacity_count = 0;
    r->look.domain = SNOW_DOMAIN_DATA;
    r->look.base = &r->base;
}

static snow_status read_look(snow_context *context, const snow_look *given,
                             known_look *out) {
    SNOW_TRY(SNOW_RECORD_READ(context, snow_look, given, &out->look));
    const snow_look *look = &out->look;
    bool own = look->colors || look->domain != SNOW_DOMAIN_DATA;
    if ((own || look->base) + (own && look->base) + (look->preset != NULL) > 1)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a look has two sources of colours; give only one of "
                         "colors, base and preset");
    if (look->domain < SNOW_DOMAIN_DATA || look->domain > SNOW_DOMAIN_SYMMETRIC)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "domain %d is out of range; take a value of "
                         "snow_domain",
                         (int)look->domain);
    if (own)
        take_own_points(out);
    else if (look->base) {
        SNOW_TRY(SNOW_RECORD_READ(context, snow_look, look->base, &out->base));
        out->look.base = &out->base;
    }
    out->reversed = look->colormap && snow_colormap_is_reversed(look->colormap);
    if (out->reversed)
        out->look.colormap = NULL;
    return SNOW_STATUS_OK;
}

static snow_status make_among(snow_comm *comm, const snow_volume *volume,
                              const snow_look *given, snow_transfer **out) {
    snow_transfer_builder builder = {.block = NULL};
    snow_histogram histogram;
    snow_transfer *transfer = NULL;
    known_look known;
    const snow_look *look = &known.look;
    snow_status status = read_look(volume->context, given, &known);
    if (status == SNOW_STATUS_OK)
        status = check_look(volume->context, look);
    if (status == SNOW_STATUS_OK)
        status = begin_builder(volume->context, look, &builder);
    if (status == SNOW_STATUS_OK && volume->left_out.any)
        status = snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                           "the volume was opened for one look and lacks "
                           "voxels that another depends on; open it without "
                           "one_look (snow_ranks_options)");
    if (comm && status == SNOW_STATUS_OK && !volume->is_part)
        status = snow_volume_need_voxels(volume); /* all parts are alike */
    if (comm)
        status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK)
        status = snow_histogram_new(volume, comm, builder.scale,
                                    need_of(volume, look), &histogram);
    if (status == SNOW_STATUS_OK) {
        snow_transfer_builder_symlog(&histogram, look, &builder);
        status = build_look(&histogram, look, &builder);
        snow_histogram_free(&histogram);
        if (known.reversed && status == SNOW_STATUS_OK && !builder.labels)
            snow_transfer_builder_reverse(&builder);
        if (status == SNOW_STATUS_OK)
            status = build(volume, &builder, look, &transfer);
    }
    snow_release(volume->context, builder.block);
    snow_release(volume->context, builder.labels);
    if (comm)
        status = snow_comm_agree_status(comm, status);
    if (status != SNOW_STATUS_OK) {
        snow_transfer_free(transfer);
        return status;
    }
    *out = transfer;
    return SNOW_STATUS_OK;
}

/* Without a communicator it is that of one volume; slabs of a file are read
 * for it. */
snow_status snow_ranks_new_transfer(snow_comm *comm, const snow_volume *volume,
                                    const snow_look *look,
                                    snow_transfer **out) {
    snow_monitor monitor;
    snow_monitor_begin_reading(volume->context, &monitor);
    return snow_monitor_end(&monitor, make_among(comm, volume, look, out));
}

snow_status snow_transfer_new_for_volume(const snow_volume *volume,
                                         const snow_look *look,
                                         snow_transfer **out) {
    return snow_ranks_new_transfer(NULL, volume, look, out);
}
