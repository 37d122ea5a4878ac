/* insitu/draw.c - pictures of a simulation's voxels, and their figures. */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

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
        snow_insitu_leave_out(insitu);
        return SNOW_STATUS_OK;
    }
    snow_insitu_begin_limit(insitu);
    snow_status status =
        snow_insitu_end_limit(insitu, snow_insitu_take(insitu));
    insitu->seconds.update = snow_comm_seconds(insitu->comm) - start;
    return status;
}

/* Whether a look spreads over the values that there are. */
static bool is_spread(const snow_look *look) {
    const char *preset = look->preset;
    if (look->range == SNOW_RANGE_VALUES)
        return false;
    return look->range != SNOW_RANGE_AUTO || !preset ||
           snow_preset_look((size_t)snow_preset_from_name(preset))->domain !=
               SNOW_DOMAIN_DATA;
}

/* The finite extremes of voxels, row by row, in a fifth of the time that
 * statistics take; of whole numbers in less. */
#define EXTREMES(type, most, lowest)                                      \
    static void find_##type(const type *voxels, const int64_t dims[3],    \
                            const int64_t pitch[2], double least[2]) {    \
        type low = most, high = lowest;                                   \
        for (int64_t n = 0; n < dims[1] * dims[2]; n++) {                 \
            const type *row =                                             \
                voxels + n / dims[1] * pitch[1] + n % dims[1] * pitch[0]; \
            for (int64_t x = 0; x < dims[0]; x++) {                       \
                bool finite = row[x] - row[x] == 0;                       \
                low = finite && row[x] < low ? row[x] : low;              \
                high = finite && row[x] > high ? row[x] : high;           \
            }                                                             \
        }                                                                 \
        least[0] = (double)low;                                           \
        least[1] = -(double)high;                                         \
    }
EXTREMES(float, INFINITY, -INFINITY)
EXTREMES(double, INFINITY, -INFINITY)
EXTREMES(int8_t, INT8_MAX, INT8_MIN)
EXTREMES(uint8_t, UINT8_MAX, 0)
EXTREMES(int16_t, INT16_MAX, INT16_MIN)
EXTREMES(uint16_t, UINT16_MAX, 0)

/* The least value and minus the most of this rank's part, with its ghosts. */
static snow_status find_own_values(const snow_insitu *insitu, double least[2]) {
    const snow_volume *volume = insitu->volume;
    const void *voxels = snow_volume_voxels(volume);
    const snow_volume_info *info = snow_volume_get_info(volume);
    snow_volume_statistics here;
    least[0] = least[1] = INFINITY;
    if (snow_box_voxels(&insitu->layout.owned) == 0)
        return SNOW_STATUS_OK;
#define FIND(name, type)                                       \
    case SNOW_TYPE_##name:                                     \
        find_##type(voxels, info->dims, insitu->pitch, least); \
        return SNOW_STATUS_OK;
    switch (info->type) {
        FIND(FLOAT32, float)
        FIND(FLOAT64, double)
        FIND(INT8, int8_t)
        FIND(UINT8, uint8_t)
        FIND(INT16, int16_t)
        FIND(UINT16, uint16_t)
    default:
        break;
    }
    snow_volume_statistics_init(&here);
    INSITU_TRY(snow_volume_get_statistics(volume, &here));
    least[0] = here.min;
    least[1] = -here.max;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_find_values(snow_insitu *insitu, double ends[2]) {
    double least[2];
    INSITU_TRY(
        snow_comm_agree_status(insitu->comm, find_own_values(insitu, least)));
    INSITU_TRY(
        snow_comm_reduce_doubles(insitu->comm, least, 2, SNOW_REDUCE_MIN));
    ends[0] = least[0];
    ends[1] = -least[1];
    return SNOW_STATUS_OK;
}

/* Values beyond those that the look was chosen from, by a share of their range,
 * choose it anew. */
#define BEYOND 0.01

static void take_look(snow_insitu *insitu, snow_transfer *now) {
    snow_transfer_free(insitu->transfer);
    insitu->transfer = now;
}

/* Whether a look knows all labels of another; both are in rising order. */
static bool knows_labels(const snow_transfer *look, const snow_transfer *now) {
    const snow_label *label, *known;
    size_t at = 0;
    for (size_t n = 0; (label = snow_transfer_label(now, n)) != NULL; n++) {
        while ((known = snow_transfer_label(look, at)) != NULL &&
               known->value < label->value)
            at++;
        if (!known || known->value > label->value)
            return false;
    }
    return true;
}

/* Collective.  Colours are those of the labels' numbers, and stay with them:
 * where there are new ones the look is made anew. */
static snow_status learn_labels(snow_insitu *insitu) {
    snow_look look = insitu->look.look;
    snow_transfer *now = NULL;
    look.preset = "labels"; /* also where that was found by itself */
    snow_status status =
        snow_ranks_new_transfer(insitu->comm, insitu->volume, &look, &now);
    if (status == SNOW_STATUS_BAD_USAGE)
        return SNOW_STATUS_OK; /* one value, or too many: as they were */
    if (status == SNOW_STATUS_OK && !knows_labels(insitu->transfer, now))
        take_look(insitu, now);
    else
        snow_transfer_free(now);
    return status;
}

/* Collective.  A look for the values as they are, over a range that holds that
 * of the look before, if that had one, so that no colour means less than it
 * did. */
static snow_status widen_look(snow_insitu *insitu, bool had_range) {
    snow_look look = insitu->look.look;
    snow_transfer *now = NULL;
    double range[2], before[2];
    snow_transfer_domain(insitu->transfer, &before[0], &before[1]);
    INSITU_TRY(
        snow_ranks_new_transfer(insitu->comm, insitu->volume, &look, &now));
    snow_transfer_domain(now, &range[0], &range[1]);
    if (had_range && !snow_transfer_label(now, 0)) {
        look.low = range[0] = fmin(range[0], before[0]);
        look.high = range[1] = fmax(range[1], before[1]);
        look.range = SNOW_RANGE_VALUES;
        snow_transfer_free(now);
        if (range[0] == before[0] && range[1] == before[1])
            return SNOW_STATUS_OK;
        INSITU_TRY(
            snow_ranks_new_transfer(insitu->comm, insitu->volume, &look, &now));
    }
    take_look(insitu, now);
    snow_insitu_report(insitu,
                       "values go beyond those before: colours are spread over "
                       "%.5g to %.5g from here on, in place of %.5g to %.5g",
                       range[0], range[1], before[0], before[1]);
    return SNOW_STATUS_OK;
}

/* Collective.  The transfer function, if it is not there yet, or too narrow. */
static snow_status choose_look(snow_insitu *insitu) {
    double start = snow_comm_seconds(insitu->comm);
    double *seen = insitu->seen, *ends = insitu->ends;
    const bool spread = is_spread(&insitu->look.look);
    const double capacity = BEYOND * (seen[1] - seen[0]);
    const bool labels =
        insitu->transfer && snow_transfer_label(insitu->transfer, 0);
    insitu->knows_ends = spread && !labels;
    ends[0] = ends[1] = 0;
    if (insitu->transfer && !spread && !labels)
        return SNOW_STATUS_OK;
    if (insitu->knows_ends)
        INSITU_TRY(snow_insitu_find_values(insitu, ends));
    if (!insitu->transfer) {
        INSITU_TRY(snow_ranks_new_transfer(insitu->comm, insitu->volume,
                                           &insitu->look.look,
                                           &insitu->transfer));
        memcpy(seen, ends, sizeof insitu->ends);
    } else if (labels) {
        INSITU_TRY(learn_labels(insitu));
    } else if (ends[0] <= ends[1] && !(ends[0] >= seen[0] - capacity &&
                                       ends[1] <= seen[1] + capacity)) {
        const bool had_range = seen[0] < seen[1];
        INSITU_TRY(widen_look(insitu, had_range));
        seen[0] = had_range ? fmin(seen[0], ends[0]) : ends[0];
        seen[1] = had_range ? fmax(seen[1], ends[1]) : ends[1];
    }
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
    INSITU_TRY(snow_insitu_leave_strip(insitu));
    view.strip = snow_insitu_view(insitu).strip;
    if (!insitu->shaded && snow_transfer_is_unshaded(insitu->transfer) &&
        settings.mode != SNOW_MODE_ISO)
        settings.shade = SNOW_SHADE_NONE; /* as the tool */
    INSITU_TRY(snow_ranks_render(insitu->frame, insitu->comm, insitu->volume,
                                 insitu->transfer, &view, &settings,
                                 &insitu->how, &image));
    status = snow_comm_agree_status(
        insitu->comm,
        snow_insitu_enlarge(insitu, &image, asked.width, asked.height));
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
    INSITU_TRY(
        snow_comm_reduce_doubles(insitu->comm, &seconds, 1, SNOW_REDUCE_MAX));
    snow_insitu_steer(insitu, seconds);
    return SNOW_STATUS_OK;
}

static snow_status draw_picture(snow_insitu *insitu, snow_image **out) {
    double start = snow_comm_seconds(insitu->comm);
    snow_image *image = NULL;
    if (insitu->left_out) {
        *out = NULL;
        return SNOW_STATUS_OK;
    }
    if (!insitu->taken) /* the same on all ranks */
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "there are no voxels to draw; call snow_insitu_update first");
    INSITU_TRY(snow_insitu_check(insitu));
    insitu->last_lowering = insitu->layout.lowering;
    snow_insitu_begin_limit(insitu);
    INSITU_TRY(snow_insitu_end_limit(insitu, make_picture(insitu, &image)));
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

/* --- calls ---------------------------------------------------------------- */

snow_status snow_insitu_update(snow_insitu *insitu) {
    snow_status status = snow_insitu_begin(insitu);
    if (status == SNOW_STATUS_OK) {
        snow_insitu_refresh(insitu);
        status = update(insitu);
    }
    return snow_insitu_end(insitu, status);
}

snow_status snow_insitu_render(snow_insitu *insitu, snow_image **image) {
    snow_status status = snow_insitu_begin(insitu);
    if (status == SNOW_STATUS_OK)
        status = draw_picture(insitu, image);
    return snow_insitu_end(insitu, status);
}

/* Whether pictures can be written.  Sums are no values of the data, so that no
 * range of those gives them colours. */
static snow_status check_output(const snow_insitu *insitu) {
    if (!insitu->pattern) /* on one rank only: found by its print below */
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "there is no path for pictures; give snow_insitu_set an output");
    if (insitu->settings.mode == SNOW_MODE_SUM &&
        insitu->look.look.range == SNOW_RANGE_AUTO &&
        snow_image_format_bits(insitu->pattern) > 0)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "mode sum needs one range of sums for all pictures; give the look "
            "a range, or write .npy files");
    return SNOW_STATUS_OK;
}

/* What steps take beside what lies between them. */
static void add_cost(snow_insitu *insitu, double start) {
    if (insitu->ended > 0) {
        insitu->between += start - insitu->ended;
        insitu->within += insitu->seconds.step;
    }
    insitu->ended = snow_comm_seconds(insitu->comm);
}

static snow_status make_step(snow_insitu *insitu, int64_t step) {
    double start = snow_comm_seconds(insitu->comm);
    snow_image *image = NULL;
    INSITU_TRY(snow_comm_agree_status(insitu->comm, check_output(insitu)));
    if (insitu->how.scattered) /* the same on all ranks, or found so */
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "cannot write a scattered picture, whose parts are on several "
            "ranks; call snow_insitu_render and write the parts");
    snow_insitu_refresh(insitu);
    INSITU_TRY(update(insitu));
    if (!insitu->left_out) /* the same on all ranks */
        INSITU_TRY(snow_insitu_check_file(insitu, step));
    INSITU_TRY(draw_picture(insitu, &image));
    snow_status status = SNOW_STATUS_OK;
    if (!insitu->left_out)
        status = snow_insitu_count(insitu);
    if (!insitu->left_out && status == SNOW_STATUS_OK)
        status = snow_insitu_write(insitu, step, image);
    snow_image_free(image);
    insitu->seconds.step = snow_comm_seconds(insitu->comm) - start;
    add_cost(insitu, start);
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
    INSITU_TRY(snow_comm_reduce_doubles(comm, least, FIGURES, SNOW_REDUCE_MIN));
    INSITU_TRY(snow_comm_reduce_doubles(comm, mean, FIGURES, SNOW_REDUCE_SUM));
    INSITU_TRY(snow_comm_reduce_doubles(comm, most, FIGURES, SNOW_REDUCE_MAX));
    INSITU_TRY(snow_comm_reduce_ints(comm, &copied, 1, SNOW_REDUCE_SUM));
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
