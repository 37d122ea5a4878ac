/* classify/make.c - from a user's wishes to a transfer function.
 *
 * A preset, or the histogram, drafts control points over values of its own; a
 * range that was asked for stretches the draft over it; a colour map then
 * replaces the colours, and opacities replace the opacities.  The gradient
 * opacity is what was asked for, or none. */
#include "classify/look.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef const char *name_fn(size_t index);

static snow_status refuse_name(snow_context *context, const char *what,
                               const char *name, name_fn *names) {
    char list[256] = "";
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
static double stretched(const snow_draft *draft, double value, double low,
                        double high) {
    if (!(draft->low < draft->high))
        return low;
    double scale = isfinite(draft->high - draft->low) ? 1 : 0.5;
    double share = (scale * value - scale * draft->low) /
                   (scale * draft->high - scale * draft->low);
    return snow_between(low, high, share);
}

static void stretch(snow_draft *draft, double low, double high) {
    for (size_t i = 0; i < draft->color_count; i++)
        draft->colors[i].value =
            stretched(draft, draft->colors[i].value, low, high);
    for (size_t i = 0; i < draft->opacity_count; i++)
        draft->opacities[i].value =
            stretched(draft, draft->opacities[i].value, low, high);
    draft->low = low;
    draft->high = high;
}

/* The preset's own draft, or the histogram's. */
static snow_status begin_draft(const snow_census *census, const snow_look *look,
                               snow_draft *draft) {
    if (!look->preset)
        return snow_draft_automatic(census, draft);
    int preset = snow_preset_named(look->preset);
    if (snow_preset_is_hounsfield(preset) && census->min >= 0 &&
        look->range == SNOW_RANGE_AUTO)
        snow_notify(census->volume->context,
                    "%s is for Hounsfield units, but the smallest value is %g: "
                    "if the values have an offset, give a range",
                    look->preset, census->min);
    return snow_draft_preset(preset, census, draft);
}

static snow_status draft_look(const snow_census *census, const snow_look *look,
                              snow_draft *draft) {
    SNOW_TRY(begin_draft(census, look, draft));
    if (look->range != SNOW_RANGE_AUTO) {
        double low, high;
        SNOW_TRY(resolve_range(census, look, &low, &high));
        stretch(draft, low, high);
    }
    if (look->colormap)
        snow_draft_colormap(draft, snow_colormap_named(look->colormap),
                            draft->low, draft->high);
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
    snprintf(text, room, "%s %.5g..%.5g; opacity", draft->name, draft->low,
             draft->high);
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
    snow_status status = snow_transfer_set_gradient_opacity(
        transfer, look->gradient_opacities, look->gradient_opacity_count);
    if (status != SNOW_OK) {
        snow_transfer_free(transfer);
        return status;
    }
    *out = transfer;
    return SNOW_OK;
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
    SNOW_TRY(snow_census_new(volume, comm, &census));
    snow_status status = draft_look(&census, look, &draft);
    snow_census_free(&census);
    if (status != SNOW_OK)
        return status;
    status = build(volume, &draft, look, &transfer);
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
