/* transfer/transfer.c - transfer functions: their control points and their
 * text. */
#include "transfer/transfer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Checks one point of either kind; `last` is the value before it. */
static snow_status check_point(snow_context *context, const char *kind,
                               size_t index, double value, double last) {
    if (!isfinite(value))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s point %zu has the value %g; give finite values",
                         kind, index + 1, value);
    if (index && value < last)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s point %zu at %g comes after %g; give the points "
                         "in rising order of values",
                         kind, index + 1, value, last);
    return SNOW_STATUS_OK;
}

static bool in_unit(double x) {
    return x >= 0 && x <= 1;
}

static snow_status check_colors(snow_context *context,
                                const snow_color_point *colors, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const snow_color_point *c = colors + i;
        SNOW_TRY(check_point(context, "colour", i, c->value,
                             i ? colors[i - 1].value : 0));
        if (!in_unit(c->red) || !in_unit(c->green) || !in_unit(c->blue))
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "colour point %zu is (%g, %g, %g); red, green and "
                             "blue range from 0 to 1",
                             i + 1, c->red, c->green, c->blue);
    }
    return SNOW_STATUS_OK;
}

static snow_status check_opacities(snow_context *context, const char *kind,
                                   const snow_opacity_point *opacities,
                                   size_t count) {
    for (size_t i = 0; i < count; i++) {
        SNOW_TRY(check_point(context, kind, i, opacities[i].value,
                             i ? opacities[i - 1].value : 0));
        if (!in_unit(opacities[i].opacity))
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "%s point %zu is %g; opacity ranges from 0 to 1",
                             kind, i + 1, opacities[i].opacity);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_transfer_new(snow_context *context,
                              const snow_color_point *colors,
                              size_t color_count,
                              const snow_opacity_point *opacities,
                              size_t opacity_count, snow_transfer **out) {
    if (!color_count || !opacity_count)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a transfer function of %zu colours and %zu opacities "
                         "is incomplete; give at least one point of each",
                         color_count, opacity_count);
    SNOW_TRY(check_colors(context, colors, color_count));
    SNOW_TRY(check_opacities(context, "opacity", opacities, opacity_count));
    snow_transfer *transfer = snow_allocate_clear(context, sizeof *transfer);
    if (!transfer)
        return SNOW_STATUS_NO_MEMORY;
    transfer->context = context;
    transfer->color_count = color_count;
    transfer->opacity_count = opacity_count;
    transfer->grey = true;
    for (size_t i = 0; i < color_count; i++)
        transfer->grey &=
            colors[i].red == colors[i].green && colors[i].red == colors[i].blue;
    snow_status status =
        SNOW_RESERVE(context, transfer->colors, 0, color_count);
    if (status == SNOW_STATUS_OK)
        status = SNOW_RESERVE(context, transfer->opacities, 0, opacity_count);
    if (status != SNOW_STATUS_OK) {
        snow_transfer_free(transfer);
        return status;
    }
    memcpy(transfer->colors, colors, color_count * sizeof *colors);
    memcpy(transfer->opacities, opacities, opacity_count * sizeof *opacities);
    char text[80];
    snprintf(text, sizeof text, "%zu colour and %zu opacity points",
             color_count, opacity_count);
    snow_transfer_describe(transfer, text);
    *out = transfer;
    return SNOW_STATUS_OK;
}

void snow_transfer_free(snow_transfer *transfer) {
    if (!transfer)
        return;
    snow_release(transfer->context, transfer->colors);
    snow_release(transfer->context, transfer->opacities);
    snow_release(transfer->context, transfer->gradients);
    snow_release(transfer->context, transfer->labels);
    snow_release(transfer->context, transfer);
}

/* Appends "; gradient opacity 0 at 2, 1 at 10", as far as it fits. */
static void describe_gradients(snow_transfer *transfer) {
    char *text = transfer->text;
    size_t capacity = sizeof transfer->text, used = transfer->look_bytes;
    text[used] = 0;
    for (size_t i = 0; i < transfer->gradient_count; i++) {
        used = strlen(text);
        if (used + 40 > capacity) { /* the longest entry, and an end */
            snprintf(text + used, capacity - used, ", ...");
            break;
        }
        snow_text_print(text + used, capacity - used, "%s %.4g at %.5g",
                        i ? "," : "; gradient opacity",
                        transfer->gradients[i].opacity,
                        transfer->gradients[i].value);
    }
}

void snow_transfer_describe(snow_transfer *transfer, const char *chosen) {
    snprintf(transfer->text, sizeof transfer->text, "%s", chosen);
    transfer->look_bytes = strlen(transfer->text);
    describe_gradients(transfer);
}

snow_status snow_transfer_set_gradient_opacity(snow_transfer *transfer,
                                               const snow_opacity_point *points,
                                               size_t count) {
    snow_opacity_point *gradients = NULL;
    SNOW_TRY(
        check_opacities(transfer->context, "gradient opacity", points, count));
    size_t ones = 0;
    while (ones < count && points[ones].opacity == 1)
        ones++;
    if (ones == count)
        count = 0;
    if (count) {
        SNOW_TRY(SNOW_RESERVE(transfer->context, gradients, 0, count));
        memcpy(gradients, points, count * sizeof *points);
    }
    snow_release(transfer->context, transfer->gradients);
    transfer->gradients = gradients;
    transfer->gradient_count = count;
    describe_gradients(transfer);
    return SNOW_STATUS_OK;
}

const char *snow_transfer_description(const snow_transfer *transfer) {
    return transfer->text;
}

void snow_transfer_domain(const snow_transfer *transfer, double *low,
                          double *high) {
    *low = transfer->colors[0].value;
    *high = transfer->colors[transfer->color_count - 1].value;
}

snow_status snow_transfer_get_look(const snow_transfer *transfer,
                                   snow_look *out) {
    const snow_look look = {
        .size = sizeof look,
        .name = transfer->preset,
        .log = transfer->log,
        .symlog = transfer->linear,
        .colors = transfer->colors,
        .color_count = transfer->color_count,
        .opacities = transfer->opacities,
        .opacity_count = transfer->opacity_count,
        .gradient_opacities = transfer->gradients,
        .gradient_opacity_count = transfer->gradient_count,
        .white = transfer->white,
    };
    return SNOW_RECORD_FILL(transfer->context, snow_look, &look, out);
}

bool snow_transfer_is_grey(const snow_transfer *transfer) {
    return transfer->grey;
}

snow_status snow_transfer_set_log(snow_transfer *transfer) {
    double color = transfer->colors[0].value;
    double opacity = transfer->opacities[0].value;
    if (!(color > 0) || !(opacity > 0))
        return snow_fail(transfer->context, SNOW_STATUS_BAD_USAGE,
                         "the %s at %g has no logarithm; give values above 0, "
                         "or symlog in place of log",
                         color > 0 ? "opacity" : "colour",
                         color > 0 ? opacity : color);
    transfer->log = true;
    return SNOW_STATUS_OK;
}

bool snow_transfer_is_unshaded(const snow_transfer *transfer) {
    return transfer->unshaded;
}

const snow_label *snow_transfer_label(const snow_transfer *transfer,
                                      size_t index) {
    return index < transfer->label_count ? &transfer->labels[index] : NULL;
}
