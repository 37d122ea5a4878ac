/* insitu/output.c - the files of pictures: their names by the number of the
 * step, their colours and what is drawn over them. */
#include "insitu/internal.h"

#include <snowglass/overlay.h>

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define PATH_BYTES 4096

/* Points of the opacity that a comment has, at most; a number has at most 24
 * characters. */
#define POINTS_MOST 64
#define NUMBER_BYTES 32
#define COMMENT_BYTES (NUMBER_BYTES * (24 + 2 * POINTS_MOST + SNOW_INSITU_BINS))

/* The place of the step's number: "%d", or "%0Nd" with N up to 18; the only
 * sign of per cent.  NULL where the text is no such pattern. */
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

static snow_status check_path(snow_context *context, const char *path) {
    const snow_image_options over = {.size = sizeof over, .overwrite = true};
    return snow_image_check(context, path, 1, 1, &over);
}

/* Alike on all ranks: no file is looked at. */
static snow_status check_pattern(snow_context *context, const char *pattern) {
    int digits;
    size_t end;
    if (!find_number(pattern, &digits, &end))
        return snow_context_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "%.200s: a movie's path has one %%d or %%04d for "
            "the number of the step",
            pattern);
    return snow_image_format_bits(pattern) >= 0 ? SNOW_STATUS_OK
                                                : check_path(context, pattern);
}

/* What allows that files are replaced stays, unless it comes with an output. */
snow_status snow_insitu_keep_output(snow_insitu *insitu,
                                    const snow_insitu_settings *given) {
    snow_context *context = insitu->context;
    const char *pattern = given->output;
    snow_image_options form;
    INSITU_TRY(INSITU_READ(insitu, snow_image_options, given->image, &form));
    form.unsynced = !given->sync;
    form.overwrite |= !pattern && insitu->form.overwrite;
    if (pattern) {
        INSITU_TRY(
            snow_insitu_set_error(insitu, check_pattern(context, pattern)));
        const size_t bytes = strlen(pattern) + 1;
        char *copy = snow_context_allocate(context, bytes);
        if (!copy)
            return snow_insitu_set_error(insitu, SNOW_STATUS_NO_MEMORY);
        memcpy(copy, pattern, bytes);
        snow_context_release(context, insitu->pattern);
        insitu->pattern = copy;
    }
    insitu->form = form;
    return SNOW_STATUS_OK;
}

/* The title, the time or number of a step in lines. */
static void write_title(const snow_insitu *insitu, int64_t step, char *text,
                        size_t capacity) {
    const char *title = insitu->annotations.title;
    const char *format = insitu->annotations.time_format;
    char time[TEXT_BYTES] = "";
    if (insitu->annotations.step &&
        ((format && !*format) ||
         !snow_time_text(&insitu->says, format, time, sizeof time)))
        snprintf(time, sizeof time, "step %" PRId64, step);
    snprintf(text, capacity, "%s%s%s", title ? title : "",
             title && *time ? "\n" : "", time);
}

snow_status snow_insitu_set_time(snow_insitu *insitu, double time,
                                 const char *unit) {
    insitu->says.time_value = time;
    snprintf(insitu->says.time_unit, sizeof insitu->says.time_unit, "%s",
             unit ? unit : "");
    return SNOW_STATUS_OK;
}

static snow_status format_path(const snow_insitu *insitu, const char *pattern,
                               int64_t step, char out[PATH_BYTES]) {
    int digits = 0;
    size_t end = 0;
    const char *at = find_number(pattern, &digits, &end);
    const int length =
        at ? snprintf(out, PATH_BYTES, "%.*s%0*lld%s", (int)(at - pattern),
                      pattern, digits, (long long)step, pattern + end)
           : 0;
    return length > 0 && length < PATH_BYTES
               ? SNOW_STATUS_OK
               : snow_context_fail(
                     insitu->context, SNOW_STATUS_BAD_USAGE,
                     "%.100s...: the path is too long; shorten it", pattern);
}

static snow_status add_bar(const snow_insitu *insitu, const double range[2],
                           snow_overlay *overlay) {
    const snow_volume_info *says = &insitu->says;
    char text[2 * TEXT_BYTES];
    bool both = *says->quantity && *says->value_unit;
    if (!insitu->annotations.legend)
        return SNOW_STATUS_OK;
    snprintf(text, sizeof text, "%s%s%s%s", says->quantity, both ? " (" : "",
             says->value_unit, both ? ")" : "");
    return snow_overlay_color_bar(overlay, insitu->transfer, text, range, 0, 1);
}

snow_status snow_insitu_leave_strip(snow_insitu *insitu) {
    const snow_view view = snow_insitu_view(insitu);
    snow_overlay *overlay = NULL;
    if (!insitu->annotations.scale_bar || insitu->strip > 0 ||
        snow_image_format_bits(insitu->pattern) <= 0)
        return SNOW_STATUS_OK;
    INSITU_TRY(
        snow_overlay_new(insitu->context, view.width, view.height, &overlay));
    /* Sums are not known yet: room for numbers of such a magnitude. */
    const double sums[2] = {-1e4, 1e4};
    const bool summed = insitu->settings.mode == SNOW_MODE_MEAN ||
                        insitu->settings.mode == SNOW_MODE_SUM;
    snow_status status = add_bar(insitu, summed ? sums : NULL, overlay);
    if (insitu->annotations.legend || !(view.fov > 0))
        insitu->strip = snow_overlay_strip(overlay);
    snow_overlay_free(overlay);
    return status;
}

/* Bars and the step's number for a picture that was enlarged to its size, where
 * it was drawn smaller; `range` of values that colours are of, or NULL. */
static snow_status add_marks(snow_insitu *insitu, int64_t step,
                             const double range[2], snow_overlay *overlay) {
    snow_view view = snow_insitu_view(insitu);
    char text[2 * TEXT_BYTES];
    INSITU_TRY(add_bar(insitu, range, overlay));
    if (insitu->annotations.scale_bar)
        INSITU_TRY(snow_overlay_scale_bar(overlay, &insitu->whole, &view));
    write_title(insitu, step, text, sizeof text);
    INSITU_TRY(snow_overlay_title(overlay, text));
    if (insitu->annotations.outline || insitu->annotations.axes)
        INSITU_TRY(snow_overlay_box(overlay, &insitu->whole, &view,
                                    insitu->annotations.axes));
    return SNOW_STATUS_OK;
}

/* Adds a number in JSON, whatever the locale of the simulation. */
static char *add_number(char *at, double value, char end) {
    at += snow_text_print(at, NUMBER_BYTES, "%.17g", value);
    *at++ = end;
    *at = 0;
    return at;
}

static char *add_points(char *at, const snow_opacity_point *points,
                        size_t count) {
    at += snprintf(at, NUMBER_BYTES, ",\"opacity\":[");
    for (size_t i = 0; i < count; i++) {
        *at++ = '[';
        at = add_number(at, points[i].value, ',');
        at = add_number(at, points[i].opacity, ']');
        *at++ = i + 1 < count ? ',' : ']';
    }
    *at = 0;
    return at;
}

static char *add_counts(char *at, const snow_insitu *insitu) {
    at += snprintf(at, NUMBER_BYTES, ",\"ends\":[");
    at = add_number(at, insitu->ends[0], ',');
    at = add_number(at, insitu->ends[1], ']');
    at += snprintf(at, NUMBER_BYTES, ",\"counts\":[");
    for (int i = 0; i < SNOW_INSITU_BINS; i++)
        at += snprintf(at, NUMBER_BYTES, "%" PRId64 "%s", insitu->counts[i],
                       i + 1 < SNOW_INSITU_BINS ? "," : "]");
    return at;
}

/* What a viewer of the picture must know (docs/insitu.md): {"step": 60, "dims":
 * [48, 40, 56], "range": [0, 1], "matrix": [1, 0, 0, 0, 0, 1, ...], "opacity":
 * [[0, 0], [1, 0.5]], "ends": [-0.2, 1.1], "counts": [5, 17, ...]}, the opacity
 * of looks of few points, and the last two where they are known. */
static void describe(const snow_insitu *insitu, int64_t step,
                     char out[COMMENT_BYTES]) {
    const snow_volume_info *grid = &insitu->whole;
    double range[2];
    snow_transfer_domain(insitu->transfer, &range[0], &range[1]);
    char *at =
        out + snprintf(out, COMMENT_BYTES,
                       "{\"step\":%" PRId64 ",\"dims\":[%" PRId64 ",%" PRId64
                       ",%" PRId64 "],\"range\":[",
                       step, grid->dims[0], grid->dims[1], grid->dims[2]);
    at = add_number(at, range[0], ',');
    at = add_number(at, range[1], ']');
    at += snprintf(at, NUMBER_BYTES, ",\"matrix\":[");
    for (int i = 0; i < 12; i++)
        at = add_number(at, grid->matrix[i / 4][i % 4], i < 11 ? ',' : ']');
    snow_look look = {.size = sizeof look};
    if (snow_transfer_get_look(insitu->transfer, &look) == SNOW_STATUS_OK &&
        look.opacity_count && look.opacity_count <= POINTS_MOST)
        at = add_points(at, look.opacities, look.opacity_count);
    if (insitu->counted)
        at = add_counts(at, insitu);
    snprintf(at, NUMBER_BYTES, "}");
}

static snow_status save_colors(snow_insitu *insitu, int64_t step,
                               const char *path, const snow_image *image,
                               const double range[2]) {
    char comment[COMMENT_BYTES];
    snow_image_options form = insitu->form;
    describe(insitu, step, comment);
    form.comment = form.comment ? form.comment : comment;
    snow_overlay *overlay = NULL;
    bool marked = insitu->annotations.scale_bar || insitu->annotations.step ||
                  insitu->annotations.title || insitu->annotations.outline ||
                  insitu->annotations.axes;
    if (!marked || form.overlay || snow_image_format_bits(path) <= 0)
        return snow_image_save(image, path, &form);
    INSITU_TRY(snow_overlay_new(insitu->context, snow_image_width(image),
                                snow_image_height(image), &overlay));
    snow_overlay_set_picture(overlay, image);
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

/* A picture that is there already stays; what to do is said in words of these
 * calls, not of the tool. */
static snow_status check_free(const snow_insitu *insitu, int64_t step) {
    const snow_view view = snow_insitu_view(insitu);
    snow_context *context = insitu->context;
    char path[PATH_BYTES];
    INSITU_TRY(format_path(insitu, insitu->pattern, step, path));
    snow_status status =
        snow_image_check(context, path, view.width, view.height, &insitu->form);
    if (status != SNOW_STATUS_BAD_OUTPUT ||
        check_path(context, path) != SNOW_STATUS_OK)
        return status;
    return snow_context_fail(
        context, status,
        "%s: exists; remove it, choose another output, or set overwrite (of "
        "snow_image_options, or in the recipe)",
        path);
}

snow_status snow_insitu_check_file(snow_insitu *insitu, int64_t step) {
    snow_status status = SNOW_STATUS_OK;
    if (snow_comm_rank(insitu->comm) == 0)
        status = check_free(insitu, step);
    return snow_comm_agree_status(insitu->comm, status);
}

/* A folder whose name has the number is made by then. */
static snow_status try_first(const snow_insitu *insitu, const char *pattern) {
    char path[PATH_BYTES];
    if (!pattern)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "there is no path for pictures; give snow_insitu_set an output");
    INSITU_TRY(check_pattern(insitu->context, pattern));
    if (snow_comm_rank(insitu->comm) != 0 || strchr(strchr(pattern, '%'), '/'))
        return SNOW_STATUS_OK;
    INSITU_TRY(format_path(insitu, pattern, 0, path));
    return check_path(insitu->context, path);
}

snow_status snow_insitu_try_output(snow_insitu *insitu, const char *output) {
    snow_status status = try_first(insitu, output ? output : insitu->pattern);
    return snow_insitu_end(insitu,
                           snow_comm_agree_status(insitu->comm, status));
}

snow_status snow_insitu_write(snow_insitu *insitu, int64_t step,
                              const snow_image *image) {
    char path[PATH_BYTES];
    double start = snow_comm_seconds(insitu->comm);
    snow_status status = SNOW_STATUS_OK;
    if (image)
        status = format_path(insitu, insitu->pattern, step, path);
    if (image && status == SNOW_STATUS_OK)
        status = save_picture(insitu, step, path, image);
    insitu->seconds.write = snow_comm_seconds(insitu->comm) - start;
    return snow_comm_agree_status(insitu->comm, status);
}
