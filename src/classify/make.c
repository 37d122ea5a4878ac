/* classify/make.c - from a user's wishes to a transfer function.
 *
 * A preset, or the histogram, drafts control points over values of its own; a
 * range that was asked for stretches the draft over it; a colour map then
 * replaces the colours, and opacities replace the opacities.  The gradient
 * opacity is what was asked for, or none. */
#include "classify/look.h"
#include "volume/stream.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef const char *name_fn(size_t index);

static snow_status refuse_name(snow_context *context, const char *what,
                               const char *name, name_fn *names) {
    char list[768] = "";
    for (size_t i = 0; names(i); i++) {
        strncat(list, i ? ", " : "", sizeof list - strlen(list) - 1);
        strncat(list, names(i), sizeof list - strlen(list) - 1);
    }
    return snow_fail(context, SNOW_BAD_USAGE,
                     "there is no %s '%.64s'; take one of %s", what, name,
                     list);
}

static snow_status check_look(snow_context *context, const snow_look *look) {
    if (look->preset && snow_preset_named(look->preset) < 0)
        return refuse_name(context, "preset", look->preset, snow_preset_name);
    if (look->colormap && snow_colormap_named(look->colormap) < 0)
        return refuse_name(context, "colour map", look->colormap,
                           snow_colormap_name);
    if (look->opacities && !look->opacity_count)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "a list of 0 opacities says nothing; give at least "
                         "one point");
    if (look->gradient_opacities && !look->gradient_opacity_count)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "a list of 0 gradient opacities says nothing; give at "
                         "least one point");
    if (look->range != SNOW_RANGE_VALUES &&
        look->range != SNOW_RANGE_PERCENTILES)
        return SNOW_OK;
    if (!isfinite(look->low) || !isfinite(look->high) ||
        !(look->low < look->high))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "a range from %g to %g is empty; give two finite ends "
                         "in rising order",
                         look->low, look->high);
    if (look->range == SNOW_RANGE_PERCENTILES &&
        (look->low < 0 || look->high > 100))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "percentiles %g to %g are out of range; give 0 to 100",
                         look->low, look->high);
    return SNOW_OK;
}

/* The data values of a range that was asked for. */
static snow_status resolve_range(const snow_census *census,
                                 const snow_look *look, double *low,
                                 double *high) {
    snow_full_range(census, low, high);
    if (look->range == SNOW_RANGE_VALUES) {
        *low = look->low;
        *high = look->high;
    }
    if (look->range != SNOW_RANGE_PERCENTILES || !census->finite)
        return SNOW_OK;
    const double shares[2] = {look->low / 100, look->high / 100};
    double ends[2];
    SNOW_TRY(snow_quantiles(census, SNOW_EXACT, shares, 2, ends));
    if (ends[0] < ends[1]) {
        *low = ends[0];
        *high = ends[1];
        return SNOW_OK;
    }
    snow_notify(census->volume->context,
                "percentiles %g and %g are both %g; the whole range is taken",
                look->low, look->high, ends[0]);
    return SNOW_OK;
}

/* Where `value` of the draft comes to lie when it is spread over low..high.  A
 * draft that rounding has left without width becomes a step. */
static double stretched(const snow_draft *draft, bool log, double value,
                        double low, double high) {
    if (!(draft->low < draft->high))
        return low;
    double share = snow_share_on(log, draft->low, draft->high, value);
    return snow_between_on(draft->log, low, high, share);
}

/* `log` says whether the draft's values were joined by logarithms: of shares
 * and the histogram they are, of data values only where their source says so.
 * Gradients are stretched as much as the values are. */
static void stretch(snow_draft *draft, bool log, double low, double high) {
    double steeper = (high - low) / (draft->high - draft->low);
    for (size_t i = 0; i < draft->color_count; i++)
        draft->colors[i].value =
            stretched(draft, log, draft->colors[i].value, low, high);
    for (size_t i = 0; i < draft->opacity_count; i++)
        draft->opacities[i].value =
            stretched(draft, log, draft->opacities[i].value, low, high);
    for (size_t i = 0; i < draft->gradient_count && isfinite(steeper); i++)
        draft->gradients[i].value *= steeper;
    draft->low = low;
    draft->high = high;
}

static const snow_points *points_of(const snow_look *look) {
    if (look->points)
        return look->points;
    return look->preset
               ? snow_preset_points((size_t)snow_preset_named(look->preset))
               : NULL;
}

/* Room for what the look is drafted from. */
static snow_status begin_draft(snow_context *context, const snow_look *look,
                               snow_draft *draft) {
    const snow_points *points = points_of(look);
    size_t colors = SNOW_DRAFT_POINTS, opacities = SNOW_DRAFT_POINTS;
    if (points && points->color_count > colors)
        colors = points->color_count;
    if (points && points->opacity_count > opacities)
        opacities = points->opacity_count;
    size_t gradients = points ? points->gradient_count : 0;
    uint64_t bytes;
    if (!snow_mul_u64(opacities + gradients, sizeof(snow_opacity_point),
                      &bytes) ||
        !snow_add_u64(bytes, colors * sizeof(snow_color_point), &bytes))
        bytes = UINT64_MAX;
    *draft = (snow_draft){.log = look->log || (points && points->log)};
    draft->block = snow_allocate_array(context, bytes, 1);
    if (!draft->block)
        return SNOW_NO_MEMORY; /* draft->block is to be freed all the same */
    draft->colors = draft->block;
    draft->opacities = (void *)(draft->colors + colors);
    draft->gradients = draft->opacities + opacities;
    return SNOW_OK;
}

/* What the values of a preset or a file are for, and are not here. */
static snow_status check_values(const snow_census *census,
                                const snow_look *look,
                                const snow_points *points,
                                const snow_draft *draft) {
    if (points->values != SNOW_VALUES_DATA || look->range != SNOW_RANGE_AUTO)
        return SNOW_OK;
    if (draft->log && !(draft->low > 0))
        return snow_fail(census->volume->context, SNOW_BAD_USAGE,
                         "%.64s has values of 0 and below, for which a "
                         "logarithmic scale has no place; give a range too",
                         points->name);
    if (!look->points && census->min >= 0)
        snow_notify(census->volume->context,
                    "%s is for Hounsfield units, but the smallest value is %g: "
                    "if the values have an offset, give a range",
                    look->preset, census->min);
    return SNOW_OK;
}

/* The points of a preset or a file, and where they say nothing, or nothing is
 * asked, the histogram's. */
static snow_status fill_draft(const snow_census *census, const snow_look *look,
                              snow_draft *draft) {
    const snow_points *points = points_of(look);
    if (!points || !points->color_count || !points->opacity_count)
        SNOW_TRY(snow_draft_automatic(census, draft));
    if (!points)
        return SNOW_OK;
    draft->reason = look->points ? "from the file" : look->preset;
    double low = draft->low, high = draft->high;
    SNOW_TRY(snow_draft_points(points, census, draft));
    draft->flat = draft->flat && !points->opacity_count;
    /* Colours alone that have no values go where the histogram says. */
    if (!points->opacity_count && points->values != SNOW_VALUES_DATA) {
        for (size_t i = 0; i < draft->color_count; i++)
            draft->colors[i].value =
                snow_between_on(draft->log, low, high, points->colors[i].value);
        draft->low = low;
        draft->high = high;
    }
    return check_values(census, look, points, draft);
}

/* Rounding of logarithms may have made two values fall. */
static void keep_rising(snow_draft *draft) {
    for (size_t i = 1; i < draft->color_count; i++)
        if (draft->colors[i].value < draft->colors[i - 1].value)
            draft->colors[i].value = draft->colors[i - 1].value;
    for (size_t i = 1; i < draft->opacity_count; i++)
        if (draft->opacities[i].value < draft->opacities[i - 1].value)
            draft->opacities[i].value = draft->opacities[i - 1].value;
}

static snow_status draft_look(const snow_census *census, const snow_look *look,
                              snow_draft *draft) {
    const snow_points *points = points_of(look);
    SNOW_TRY(fill_draft(census, look, draft));
    if (look->range != SNOW_RANGE_AUTO) {
        double low, high;
        bool data = points && points->values == SNOW_VALUES_DATA;
        SNOW_TRY(resolve_range(census, look, &low, &high));
        if (draft->log && !(low > 0))
            return snow_fail(census->volume->context, SNOW_BAD_USAGE,
                             "a range from %g has no beginning on a "
                             "logarithmic scale; begin above 0",
                             low);
        stretch(draft, data ? points->log : draft->log, low, high);
    }
    if (look->colormap)
        snow_draft_colormap(draft, snow_colormap_named(look->colormap),
                            draft->low, draft->high);
    keep_rising(draft);
    return SNOW_OK;
}

/* Where the look comes from: only what was not asked for was chosen. */
static void tell_reason(const snow_draft *draft, const snow_look *look,
                        char *text, size_t room) {
    bool all_asked =
        look->opacities && look->range != SNOW_RANGE_AUTO && !look->preset;
    snprintf(text, room, " (%s%s)", all_asked ? "as asked" : draft->reason,
             look->opacities && !all_asked ? "; opacities as asked" : "");
}

/* "grey 72..213; opacity 0 at 72, 0.4 at 213 (from the histogram)" */
static void describe(snow_transfer *transfer, const snow_draft *draft,
                     const snow_look *look) {
    char text[SNOW_TRANSFER_TEXT_BYTES / 2]; /* the rest is the gradients' */
    size_t room = sizeof text, used;
    snprintf(text, room, "%.64s %.5g..%.5g%s; opacity", draft->name, draft->low,
             draft->high, draft->log ? " logarithmic" : "");
    for (size_t i = 0; i < transfer->opacity_count; i++) {
        used = strlen(text);
        /* The end is kept for the reason. */
        if (used + 64 > room) {
            snprintf(text + used, room - used, ", ...");
            break;
        }
        snprintf(text + used, room - used, "%s %.4g at %.5g", i ? "," : "",
                 transfer->opacities[i].opacity, transfer->opacities[i].value);
    }
    used = strlen(text);
    tell_reason(draft, look, text + used, room - used);
    snow_transfer_tell(transfer, text);
}

/* The same on all ranks, but for the memory that it takes. */
static snow_status build(const snow_volume *volume, const snow_draft *draft,
                         const snow_look *look, snow_transfer **out) {
    snow_transfer *transfer;
    SNOW_TRY(snow_transfer_new(
        volume->context, draft->colors, draft->color_count,
        look->opacities ? look->opacities : draft->opacities,
        look->opacities ? look->opacity_count : draft->opacity_count,
        &transfer));
    describe(transfer, draft, look);
    bool own = look->gradient_opacities != NULL;
    snow_status status = snow_transfer_set_gradient_opacity(
        transfer, own ? look->gradient_opacities : draft->gradients,
        own ? look->gradient_opacity_count : draft->gradient_count);
    transfer->flat = draft->flat && !look->opacities;
    if (status == SNOW_OK && draft->log)
        status = snow_transfer_set_log(transfer);
    if (status != SNOW_OK) {
        snow_transfer_free(transfer);
        return status;
    }
    *out = transfer;
    return SNOW_OK;
}

bool snow_look_fades(const snow_look *look) {
    if (!look || look->gradient_opacities)
        return look != NULL;
    if (look->preset && snow_preset_named(look->preset) < 0)
        return false;
    const snow_points *points = points_of(look);
    return points && points->gradient_count > 0;
}

snow_status snow_transfer_make_among(snow_comm *comm, const snow_volume *volume,
                                     const snow_look *look,
                                     snow_transfer **out) {
    static const snow_look automatic;
    snow_draft draft;
    snow_census census;
    snow_transfer *transfer = NULL;
    if (!look)
        look = &automatic;
    SNOW_TRY(check_look(volume->context, look));
    snow_status status = begin_draft(volume->context, look, &draft);
    if (comm && status == SNOW_OK)
        status = snow_volume_need_voxels(volume);
    if (comm)
        status = snow_comm_agree(comm, status);
    if (status == SNOW_OK)
        status = snow_census_new(volume, comm, draft.log, &census);
    if (status == SNOW_OK) {
        status = draft_look(&census, look, &draft);
        snow_census_free(&census);
        if (status == SNOW_OK)
            status = build(volume, &draft, look, &transfer);
    }
    snow_release(volume->context, draft.block);
    if (comm)
        status = snow_comm_agree(comm, status);
    if (status != SNOW_OK) {
        snow_transfer_free(transfer);
        return status;
    }
    *out = transfer;
    return SNOW_OK;
}

snow_status snow_transfer_make(const snow_volume *volume, const snow_look *look,
                               snow_transfer **out) {
    return snow_transfer_make_among(NULL, volume, look, out);
}
