/* transfer/describe.c - what a look is: of labels or not, and in a line of
 * text. */
#include "transfer/look.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- whether it is of labels ---------------------------------------------- */

bool snow_look_is_of_labels(const snow_look *look) {
    return look->preset && snow_same_name(look->preset, "labels");
}

bool snow_look_is_unranged(const snow_look *look) {
    return look->range == SNOW_RANGE_AUTO && !look->log && look->symlog == 0;
}

bool snow_look_is_free(const snow_look *look) {
    return !look->colormap && snow_look_is_unranged(look);
}

bool snow_look_suits_labels(const snow_look *look) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
    return snow_look_is_unranged(look) &&
           (!look->colormap || snow_colormap_list(look->colormap, points));
}

/* --- a line of text ------------------------------------------------------- */

/* Writes a value so that reading it gives the same, if twelve digits do; then
 * it was chosen or given.  Others are rounded. */
static const char *spell(double value, char text[40]) {
    for (int digits = 5; digits <= 12; digits++) {
        snow_text_print(text, 40, "%.*g", digits, value);
        double again = NAN;
        snow_text_scan(text, "%lf", &again);
        if (again <= value && again >= value)
            return text;
    }
    snow_text_print(text, 40, "%.5g", value);
    return text;
}

/* " logarithmic beyond -0.1..0.1" */
static void describe_scale(snow_scale scale, char text[128]) {
    char linear[40];
    *text = 0;
    if (scale.linear > 0)
        snprintf(text, 128, " logarithmic beyond -%.39s..%.39s",
                 spell(scale.linear, linear), linear);
    else if (scale.log)
        strcpy(text, " logarithmic");
}

void snow_transfer_builder_describe(const snow_transfer_builder *builder,
                                    const snow_look *look,
                                    snow_transfer *transfer) {
    char text[SNOW_TRANSFER_TEXT_BYTES / 2]; /* the rest is for the gradients */
    size_t capacity = sizeof text, used;
    char low[40], value[40], opacity[40], scale[128];
    const snow_opacity_point *points =
        look->opacities ? look->opacities : builder->opacities;
    size_t count =
        look->opacities ? look->opacity_count : builder->opacity_count;
    describe_scale(builder->scale, scale);
    snprintf(text, capacity, "%.64s %s..%s%s", builder->name,
             spell(builder->low, low), spell(builder->high, value), scale);
    if (!builder->labels)
        strcat(text, "; opacity");
    for (size_t i = 0; i < count && !builder->labels; i++) {
        used = strlen(text);
        /* The end is reserved for the reason. */
        if (used + 120 > capacity) {
            snprintf(text + used, capacity - used, ", ...");
            break;
        }
        snprintf(text + used, capacity - used, "%s %s at %s", i ? "," : "",
                 spell(points[i].opacity, opacity),
                 spell(points[i].value, value));
    }
    used = strlen(text);
    /* The source of the look: only what was not requested was chosen. */
    bool all_asked =
        look->opacities && look->range != SNOW_RANGE_AUTO && !look->preset;
    snprintf(text + used, capacity - used, " (%s%s%s)",
             all_asked ? "as requested" : builder->reason, builder->range_note,
             look->opacities && !all_asked ? "; opacities as requested" : "");
    snow_transfer_describe(transfer, text);
}
