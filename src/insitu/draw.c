/* insitu/draw.c - pictures of a simulation's voxels, within their limits.
 *
 * The limits steer by what pictures took: a ladder of less and less work, on
 * which every rank stands on the same rung because all go by the same seconds,
 * those of the slowest.  A rung is left upwards only if the picture there,
 * judged by the ratio that was seen when it was left downwards, would keep the
 * limit with room to spare: so that pictures do not change to and fro. */
#include "insitu/internal.h"

#include <snowglass/overlay.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Share of the limit that a better picture may be expected to take. */
#define SPARE 0.7

#define PATH_BYTES 4096

/* --- the size that was asked for ------------------------------------------ */

/* Where pixel `at` of `to` lies among `from` pixels: between `low` and the next
 * one, `share` of the way. */
static int place_pixel(int at, int to, int from, float *share) {
    double place = (at + 0.5) * from / to - 0.5;
    double low = fmin(fmax(floor(place), 0), fmax(from - 2, 0));
    *share = (float)fmin(fmax(place - low, 0), from > 1 ? 1 : 0);
    return (int)low;
}

/* `share` of the way from a to b; the nearer one where one of them is no
 * number, as those of rays that meet nothing are in modes mean and sum. */
static float between(float a, float b, float share) {
    if (isnan(a) || isnan(b))
        return share < 0.5f ? a : b;
    return a + share * (b - a);
}

/* One line of the large picture, between two lines of the small one. */
static void enlarge_line(const float *a, const float *b, float share, int from,
                         int to, int channels, float *out) {
    for (int x = 0; x < to; x++) {
        float across;
        int n = place_pixel(x, to, from, &across) * channels;
        int next = from > 1 ? channels : 0;
        for (int c = 0; c < channels; c++) {
            float top = between(a[n + c], a[n + next + c], across);
            float low = between(b[n + c], b[n + next + c], across);
            *out++ = between(top, low, share);
        }
    }
}

/* The picture at the size that was asked for, bilinear; premultiplied colours
 * may be averaged as they are. */
static snow_status enlarge(snow_insitu *insitu, snow_image **image, int width,
                           int height) {
    snow_image *small = *image, *large;
    if (!small || (snow_image_width(small) == width &&
                   snow_image_height(small) == height))
        return SNOW_STATUS_OK;
    int columns = snow_image_width(small), rows = snow_image_height(small);
    int channels = snow_image_channels(small);
    INSITU_TRY(
        snow_image_new(insitu->context, width, height, channels, &large));
    size_t line = (size_t)columns * (size_t)channels;
    float *out = snow_image_pixels(large);
    for (int y = 0; y < height; y++) {
        float share;
        int n = place_pixel(y, height, rows, &share);
        const float *a = snow_image_pixels(small) + (size_t)n * line;
        enlarge_line(a, rows > 1 ? a + line : a, share, columns, width,
                     channels, out);
        out += (size_t)width * (size_t)channels;
    }
    snow_image_free(small);
    *image = large;
    return SNOW_STATUS_OK;
}

/* --- the limits ----------------------------------------------------------- */

static const char *name_of(snow_degradation lowering) {
    static const char *const names[] = {"as asked", "in draft quality",
                                        "at half the size",
                                        "at a quarter of the size"};
    return names[lowering];
}

static void step_down(snow_insitu *insitu) {
    if (insitu->lowering < SNOW_DEGRADATION_QUARTER)
        insitu->lowering = (snow_degradation)(insitu->lowering + 1);
}

/* The picture took too long: the next rung, or so many steps without one that
 * the mean is kept. */
static void spare(snow_insitu *insitu, double seconds) {
    if (insitu->lowering < SNOW_DEGRADATION_QUARTER) {
        step_down(insitu);
        snow_insitu_report(insitu,
                           "a picture took %.3g s of %.3g s; the next ones are "
                           "made %s",
                           seconds, insitu->limit_seconds,
                           name_of(insitu->lowering));
        return;
    }
    double count = ceil(seconds / insitu->limit_seconds) - 1;
    insitu->to_skip = count < 1e9 ? (int64_t)count : 1000000000;
    snow_insitu_report(
        insitu, "a picture took %.3g s of %.3g s; %lld are left out", seconds,
        insitu->limit_seconds, (long long)insitu->to_skip);
}

/* What the rung above would take now. */
static double expect_above(const snow_insitu *insitu, double seconds) {
    double above = insitu->cost[insitu->lowering - 1];
    double here = insitu->cost[insitu->lowering];
    return here > 0 ? seconds * above / here : seconds;
}

/* Goes by the seconds of the slowest rank, the same on all. */
static void steer(snow_insitu *insitu, double seconds) {
    snow_degradation at = insitu->lowering;
    if (insitu->limit_seconds <= 0 || at != insitu->layout.lowering)
        return; /* a further picture of voxels that were taken before */
    if (insitu->cost[at] <= 0)
        insitu->cost[at] = seconds;
    if (seconds > insitu->limit_seconds) {
        insitu->cost[at] = seconds;
        if (at < SNOW_DEGRADATION_QUARTER)
            insitu->cost[at + 1] = 0;
        spare(insitu, seconds);
    } else if (at != SNOW_DEGRADATION_NONE &&
               expect_above(insitu, seconds) < SPARE * insitu->limit_seconds) {
        insitu->lowering = (snow_degradation)(at - 1);
        snow_insitu_report(insitu, "pictures are made %s again",
                           name_of(insitu->lowering));
    }
}

static void leave_out(snow_insitu *insitu) {
    insitu->left_out = true;
    insitu->skipped++;
    insitu->last_lowering = SNOW_DEGRADATION_SKIPPED;
}

/* The context's own limit holds as well. */
static void begin_limit(snow_insitu *insitu) {
    uint64_t own = insitu->limit_bytes,
             outer = snow_context_limit(insitu->context);
    insitu->outer_bytes = outer;
    if (own && (!outer || own < outer))
        snow_context_set_memory_limit(insitu->context, own);
}

/* What became of a piece of work under the limit of bytes: where that did not
 * suffice, no error but a picture that is left out. */
static snow_status settle(snow_insitu *insitu, snow_status status) {
    snow_context_set_memory_limit(insitu->context, insitu->outer_bytes);
    if (status != SNOW_STATUS_NO_MEMORY || !insitu->limit_bytes ||
        snow_comm_broken(insitu->comm))
        return status;
    step_down(insitu);
    leave_out(insitu);
    snow_insitu_forget(insitu);
    snow_insitu_report(
        insitu, "a picture is left out: %s; the next is tried %s",
        snow_context_message(insitu->context), name_of(insitu->lowering));
    return SNOW_STATUS_OK;
}

/* --- update and draw ------------------------------------------------------ */

static uint64_t bytes_sent(const snow_insitu *insitu) {
    uint64_t messages, bytes;
    snow_comm_sent(insitu->comm, &messages, &bytes);
    return bytes;
}

static snow_status update(snow_insitu *insitu) {
    double start = snow_comm_seconds(insitu->comm);
    insitu->sent_before = bytes_sent(insitu);
    insitu->left_out = false;
    insitu->seconds = (snow_insitu_seconds){0};
    if (insitu->to_skip > 0) {
        insitu->to_skip--;
        leave_out(insitu);
        return SNOW_STATUS_OK;
    }
    begin_limit(insitu);
    snow_status status = settle(insitu, snow_insitu_take(insitu));
    insitu->seconds.update = snow_comm_seconds(insitu->comm) - start;
    return status;
}

/* Collective.  The transfer function, if it is not there yet. */
static snow_status choose_look(snow_insitu *insitu) {
    double start = snow_comm_seconds(insitu->comm);
    if (insitu->transfer)
        return SNOW_STATUS_OK;
    INSITU_TRY(snow_ranks_new_transfer(insitu->comm, insitu->volume,
                                       &insitu->look.look, &insitu->transfer));
    insitu->seconds.look = snow_comm_seconds(insitu->comm) - start;
    return SNOW_STATUS_OK;
}

/* Collective.  The picture of the rung, at the size that was asked for. */
static snow_status make_picture(snow_insitu *insitu, snow_image **out) {
    snow_view view, asked = snow_insitu_view(insitu);
    snow_settings settings;
    snow_image *image = NULL;
    snow_status status = SNOW_STATUS_OK;
    snow_insitu_lowered(insitu, &view, &settings);
    if (!insitu->frame)
        status = snow_frame_new(insitu->context, &insitu->frame);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    INSITU_TRY(choose_look(insitu));
    INSITU_TRY(snow_ranks_render(insitu->frame, insitu->comm, insitu->volume,
                                 insitu->transfer, &view, &settings,
                                 &insitu->how, &image));
    status = snow_comm_agree_status(
        insitu->comm, enlarge(insitu, &image, asked.width, asked.height));
    if (status == SNOW_STATUS_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

static void note_stages(snow_insitu *insitu) {
    const snow_stats *stats = snow_frame_stats(insitu->frame);
    insitu->seconds.encode =
        stats->seconds_classify + stats->seconds_shade + stats->seconds_encode;
    insitu->seconds.render = insitu->seconds.encode + stats->seconds_splat +
                             stats->seconds_composite + stats->seconds_warp;
}

/* Collective.  What the picture took on the slowest rank steers the next. */
static snow_status agree_seconds(snow_insitu *insitu) {
    double seconds = insitu->seconds.draw + insitu->seconds.update;
    INSITU_TRY(snow_comm_reduce_doubles(insitu->comm, &seconds, 1, SNOW_MAX));
    steer(insitu, seconds);
    return SNOW_STATUS_OK;
}

static snow_status draw(snow_insitu *insitu, snow_image **out) {
    double start = snow_comm_seconds(insitu->comm);
    snow_image *image = NULL;
    if (insitu->left_out) {
        *out = NULL;
        return SNOW_STATUS_OK;
    }
    if (!insitu->taken) /* the same on all ranks */
        return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                                 "there are no voxels to draw; call "
                                 "snow_insitu_update first");
    INSITU_TRY(snow_insitu_check(insitu));
    insitu->last_lowering = insitu->layout.lowering;
    begin_limit(insitu);
    INSITU_TRY(settle(insitu, make_picture(insitu, &image)));
    if (!insitu->left_out) {
        insitu->pictures++;
        note_stages(insitu);
        insitu->seconds.draw = snow_comm_seconds(insitu->comm) - start;
        snow_status status = agree_seconds(insitu);
        if (status != SNOW_STATUS_OK) {
            snow_image_free(image);
            return status;
        }
    }
    *out = image;
    return SNOW_STATUS_OK;
}

/* Bars and the step's number for a picture that was enlarged to its size, where
 * it was drawn smaller; `range` of values that colours were made of, or NULL.
 */
static snow_status add_marks(snow_insitu *insitu, int64_t step,
                             const double range[2], snow_overlay *overlay) {
    snow_view view = snow_insitu_view(insitu);
    char text[40];
    if (insitu->legend) {
        INSITU_TRY(
            snow_overlay_color_bar(overlay, insitu->transfer, NULL, range));
        INSITU_TRY(snow_overlay_scale_bar(overlay, &insitu->whole, &view));
    }
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
    bool marked = insitu->legend || insitu->step_label;
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
static snow_status save(snow_insitu *insitu, int64_t step, const char *path,
                        const snow_image *image) {
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

/* Collective.  Rank 0 writes, all hear how it went. */
static snow_status write(snow_insitu *insitu, int64_t step,
                         const snow_image *image) {
    char path[PATH_BYTES];
    double start = snow_comm_seconds(insitu->comm);
    snow_status status = SNOW_STATUS_OK;
    if (image && !snow_insitu_path(insitu, step, path, sizeof path))
        status = snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "%.100s...: the path is too long; shorten it", insitu->pattern);
    if (image && status == SNOW_STATUS_OK)
        status = save(insitu, step, path, image);
    insitu->seconds.write = snow_comm_seconds(insitu->comm) - start;
    return snow_comm_agree_status(insitu->comm, status);
}

/* --- calls ---------------------------------------------------------------- */

snow_status snow_insitu_update(snow_insitu *insitu) {
    snow_status status = snow_insitu_begin(insitu);
    if (status == SNOW_STATUS_OK)
        status = update(insitu);
    return snow_insitu_end(insitu, status);
}

snow_status snow_insitu_render(snow_insitu *insitu, snow_image **image) {
    snow_status status = snow_insitu_begin(insitu);
    if (status == SNOW_STATUS_OK)
        status = draw(insitu, image);
    return snow_insitu_end(insitu, status);
}

/* Whether pictures can be written.  Sums are no values of the data, so that no
 * range of those gives them colours. */
static snow_status check_output(const snow_insitu *insitu) {
    if (!insitu->pattern) /* on one rank only: found by its print below */
        return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                                 "there is no path for pictures; call "
                                 "snow_insitu_set_output");
    if (insitu->settings.mode == SNOW_MODE_SUM &&
        insitu->look.look.range == SNOW_RANGE_AUTO &&
        snow_image_format_bits(insitu->pattern) > 0)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "pictures of mode sum share one range of sums; give "
            "the look a range, or name files .npy");
    return SNOW_STATUS_OK;
}

static snow_status make_step(snow_insitu *insitu, int64_t step) {
    double start = snow_comm_seconds(insitu->comm);
    snow_image *image = NULL;
    INSITU_TRY(snow_comm_agree_status(insitu->comm, check_output(insitu)));
    if (insitu->how.scattered) /* the same on all ranks, or found so */
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "a scattered picture is in no one place to be written "
            "from; call snow_insitu_render and write its parts");
    INSITU_TRY(update(insitu));
    INSITU_TRY(draw(insitu, &image));
    snow_status status = SNOW_STATUS_OK;
    if (!insitu->left_out)
        status = write(insitu, step, image);
    snow_image_free(image);
    insitu->seconds.step = snow_comm_seconds(insitu->comm) - start;
    return status;
}

snow_status snow_insitu_step(snow_insitu *insitu, int64_t step) {
    snow_status status = snow_insitu_begin(insitu);
    if (status == SNOW_STATUS_OK)
        status = make_step(insitu, step);
    return snow_insitu_end(insitu, status);
}

/* --- figures -------------------------------------------------------------- */

/* In the order of the record's spreads. */
static void fill_figures(const snow_insitu *insitu, double *out) {
    const snow_stats *stats =
        insitu->frame ? snow_frame_stats(insitu->frame) : NULL;
    const snow_insitu_seconds *s = &insitu->seconds;
    const double figures[] = {
        s->update,
        s->look,
        s->render,
        s->encode,
        s->draw,
        s->write,
        s->step,
        (double)(bytes_sent(insitu) - insitu->sent_before),
        (double)snow_context_bytes(insitu->context),
        (double)snow_context_peak_bytes(insitu->context),
        (double)snow_box_voxels(&insitu->layout.stored),
        stats ? (double)stats->interesting : 0};
    memcpy(out, figures, sizeof figures);
}

#define FIGURES 12

void snow_insitu_stats_init_sized(snow_insitu_stats *stats, size_t size) {
    snow_record_init(stats, size, NULL, sizeof *stats);
}

snow_status snow_insitu_get_stats(snow_insitu *insitu, snow_insitu_stats *out) {
    double least[FIGURES], mean[FIGURES], most[FIGURES];
    snow_comm *comm = insitu->comm;
    int64_t copied = insitu->copied;
    fill_figures(insitu, least);
    memcpy(mean, least, sizeof mean);
    memcpy(most, least, sizeof most);
    INSITU_TRY(snow_comm_reduce_doubles(comm, least, FIGURES, SNOW_MIN));
    INSITU_TRY(snow_comm_reduce_doubles(comm, mean, FIGURES, SNOW_SUM));
    INSITU_TRY(snow_comm_reduce_doubles(comm, most, FIGURES, SNOW_MAX));
    INSITU_TRY(snow_comm_reduce_ints(comm, &copied, 1, SNOW_SUM));
    snow_insitu_stats f = {.pictures = insitu->pictures,
                           .skipped = insitu->skipped,
                           .ranks_copied = (int)copied,
                           .exchanged = insitu->layout.exchanged,
                           .recut = insitu->layout.recut,
                           .lowering = insitu->last_lowering};
    snow_spread *spreads[FIGURES] = {
        &f.seconds_update, &f.seconds_look, &f.seconds_render,
        &f.seconds_encode, &f.seconds_draw, &f.seconds_write,
        &f.seconds_step,   &f.bytes_sent,   &f.bytes_held,
        &f.bytes_peak,     &f.voxels,       &f.interesting};
    for (int i = 0; i < FIGURES; i++)
        *spreads[i] =
            (snow_spread){least[i], mean[i] / snow_comm_size(comm), most[i]};
    return SNOW_RECORD_FILL(insitu->context, snow_insitu_stats, &f, out);
}
