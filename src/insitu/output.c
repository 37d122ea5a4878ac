/* insitu/output.c - the files of pictures: their names by the number of the
 * step, their colours and what is drawn over them. */
#include "insitu/internal.h"

#include <snowglass/overlay.h>

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define PATH_BYTES 4096

/* The place of the step's number: "%d", or "%0Nd" with N up to 18; the only
 * sign of per cent.  NULL where the text is none such. */
static const char *find_number(const char *pattern, int *digits, size_t *end) {
    const char *at = strchr(pattern, '%');
    if (!at || strchr(at + 1, '%'))
        return NULL;
    const char *p = at + 1;
    *digits = 0;
    if (*p == '0')
        for (p++; *p >= '0' && *p <= '9' && *digits < 18; p++)
            *digits = 10 * *digits + (*p - '0');
    *end = (size_t)(p + 1 - pattern);
    return *p == 'd' && *digits <= 18 ? at : NULL;
}

snow_status snow_insitu_set_output(snow_insitu *insitu, const char *pattern,
                                   const snow_image_options *options) {
    snow_image_options form;
    int digits;
    size_t end, bytes = strlen(pattern) + 1;
    INSITU_TRY(snow_insitu_set_error(
        insitu,
        SNOW_RECORD_READ(insitu->context, snow_image_options, options, &form)));
    if (!find_number(pattern, &digits, &end))
        return snow_insitu_refuse(
            insitu,
            "%.200s: a movie's path has one %%d or %%04d for "
            "the number of the step",
            pattern);
    char *copy = snow_context_allocate(insitu->context, bytes);
    if (!copy)
        return snow_insitu_set_error(insitu, SNOW_STATUS_NO_MEMORY);
    memcpy(copy, pattern, bytes);
    snow_context_release(insitu->context, insitu->pattern);
    insitu->pattern = copy;
    insitu->form = form;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_annotations(snow_insitu *insitu, bool legend,
                                        bool scale_bar, bool step) {
    insitu->legend = legend;
    insitu->scale_bar = legend || scale_bar;
    insitu->step_label = step;
    return SNOW_STATUS_OK;
}

static bool format_path(const snow_insitu *insitu, int64_t step, char *out,
                        size_t room) {
    int digits = 0;
    size_t end = 0;
    const char *pattern = insitu->pattern;
    const char *at = find_number(pattern, &digits, &end);
    if (!at)
        return false;
    int length = snprintf(out, room, "%.*s%0*lld%s", (int)(at - pattern),
                          pattern, digits, (long long)step, pattern + end);
    return length > 0 && (size_t)length < room;
}

/* Bars and the step's number for a picture that was enlarged to its size, where
 * it was drawn smaller; `range` of values that colours are of, or NULL. */
static snow_status add_marks(snow_insitu *insitu, int64_t step,
                             const double range[2], snow_overlay *overlay) {
    snow_view view = snow_insitu_view(insitu);
    char text[40];
    if (insitu->legend)
        INSITU_TRY(
            snow_overlay_color_bar(overlay, insitu->transfer, NULL, range));
    if (insitu->scale_bar)
        INSITU_TRY(snow_overlay_scale_bar(overlay, &insitu->whole, &view));
    if (!insitu->step_label)
        return SNOW_STATUS_OK;
    snprintf(text, sizeof text, "step %" PRId64, step);
    return snow_overlay_title(overlay, text);
}

static snow_status save_colors(snow_insitu *insitu, int64_t step,
                               const char *path, const snow_image *image,
                               const double range[2]) {
    snow_image_options form = insitu->form;
    snow_overlay *overlay = NULL;
    bool marked = insitu->scale_bar || insitu->step_label;
    if (!marked || form.overlay || snow_image_format_bits(path) <= 0)
        return snow_image_save(image, path, &form);
    INSITU_TRY(snow_overlay_new(insitu->context, snow_image_width(image),
                                snow_image_height(image), &overlay));
    snow_status status = add_marks(insitu, step, range, overlay);
    form.overlay = overlay;
    if (status == SNOW_STATUS_OK)
        status = snow_image_save(image, path, &form);
    snow_overlay_free(overlay);
    return status;
}

/* Values (modes mean and sum) become colours where the file holds colours, over
 * what the look spreads over: the same in all frames. */
static snow_status save_picture(snow_insitu *insitu, int64_t step,
                                const char *path, const snow_image *image) {
    double range[2];
    snow_image *painted = NULL;
    if (snow_image_channels(image) != 1 || snow_image_format_bits(path) <= 0)
        return save_colors(insitu, step, path, image, NULL);
    snow_transfer_domain(insitu->transfer, &range[0], &range[1]);
    INSITU_TRY(snow_image_apply_colormap(image, insitu->transfer, range[0],
                                         range[1], &painted));
    snow_status status = save_colors(insitu, step, path, painted, range);
    snow_image_free(painted);
    return status;
}

snow_status snow_insitu_write(snow_insitu *insitu, int64_t step,
                              const snow_image *image) {
    char path[PATH_BYTES];
    double start = snow_comm_seconds(insitu->comm);
    snow_status status = SNOW_STATUS_OK;
    if (image && !format_path(insitu, step, path, sizeof path))
        status = snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "%.100s...: the path is too long; shorten it", insitu->pattern);
    if (image && status == SNOW_STATUS_OK)
        status = save_picture(insitu, step, path, image);
    insitu->seconds.write = snow_comm_seconds(insitu->comm) - start;
    return snow_comm_agree_status(insitu->comm, status);
}
