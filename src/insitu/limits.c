/* insitu/limits.c - the limits of seconds and bytes.
 *
 * The limits steer by what pictures took: a ladder of less and less work, on
 * which every rank stands on the same rung because all go by the same seconds,
 * those of the slowest. Quality is raised only if the predicted time stays
 * below SPARE of the limit (hysteresis); the prediction is the ratio of times
 * that was seen when quality was lowered. */
#include "insitu/internal.h"

#include <math.h>

/* Share of the limit that a better picture may be expected to take. */
#define SPARE 0.7

static const char *degradation_name(snow_degradation lowering) {
    static const char *const names[] = {"as asked", "in draft quality",
                                        "at half the size",
                                        "at a quarter of the size"};
    return names[lowering];
}

static void degrade_more(snow_insitu *insitu) {
    if (insitu->lowering < SNOW_DEGRADATION_QUARTER)
        insitu->lowering = (snow_degradation)(insitu->lowering + 1);
}

/* The picture took too long: the next rung, or so many steps without one that
 * the mean is kept. */
static void spare_seconds(snow_insitu *insitu, double seconds) {
    if (insitu->lowering < SNOW_DEGRADATION_QUARTER) {
        degrade_more(insitu);
        snow_insitu_report(insitu,
                           "a picture took %.3g s of %.3g s; the next ones are "
                           "made %s",
                           seconds, insitu->limit_seconds,
                           degradation_name(insitu->lowering));
        return;
    }
    double count = ceil(seconds / insitu->limit_seconds) - 1;
    insitu->to_skip = count < 1e9 ? (int64_t)count : 1000000000;
    snow_insitu_report(
        insitu, "a picture took %.3g s of %.3g s; %lld are left out", seconds,
        insitu->limit_seconds, (long long)insitu->to_skip);
}

void snow_insitu_steer(snow_insitu *insitu, double seconds) {
    snow_degradation at = insitu->lowering;
    if (insitu->limit_seconds <= 0 || at != insitu->layout.lowering)
        return; /* a further picture of voxels that were taken before */
    if (insitu->cost[at] <= 0)
        insitu->cost[at] = seconds;
    if (seconds > insitu->limit_seconds) {
        insitu->cost[at] = seconds;
        if (at < SNOW_DEGRADATION_QUARTER)
            insitu->cost[at + 1] = 0;
        spare_seconds(insitu, seconds);
        return;
    }
    if (at == SNOW_DEGRADATION_NONE)
        return;
    /* What the rung above would take now. */
    const double above = insitu->cost[at] > 0
                             ? seconds * insitu->cost[at - 1] / insitu->cost[at]
                             : seconds;
    if (above < SPARE * insitu->limit_seconds) {
        insitu->lowering = (snow_degradation)(at - 1);
        snow_insitu_report(insitu, "pictures are made %s again",
                           degradation_name(insitu->lowering));
    }
}

void snow_insitu_leave_out(snow_insitu *insitu) {
    insitu->left_out = true;
    insitu->skipped++;
    insitu->last_lowering = SNOW_DEGRADATION_SKIPPED;
}

void snow_insitu_begin_limit(snow_insitu *insitu) {
    uint64_t own = insitu->limit_bytes,
             outer = snow_context_limit(insitu->context);
    insitu->outer_bytes = outer;
    if (own && (!outer || own < outer))
        snow_context_set_memory_limit(insitu->context, own);
}

snow_status snow_insitu_end_limit(snow_insitu *insitu, snow_status status) {
    snow_context_set_memory_limit(insitu->context, insitu->outer_bytes);
    if (status != SNOW_STATUS_NO_MEMORY || !insitu->limit_bytes ||
        snow_comm_broken(insitu->comm))
        return status;
    degrade_more(insitu);
    snow_insitu_leave_out(insitu);
    snow_insitu_forget(insitu);
    snow_insitu_report(insitu,
                       "a picture is left out: %s; the next is tried %s",
                       snow_context_message(insitu->context),
                       degradation_name(insitu->lowering));
    return SNOW_STATUS_OK;
}

void snow_insitu_lowered(const snow_insitu *insitu, snow_view *view,
                         snow_settings *settings) {
    snow_degradation lowering = insitu->layout.lowering;
    *view = snow_insitu_view(insitu);
    *settings = insitu->settings;
    const int by = lowering == SNOW_DEGRADATION_HALF      ? 2
                   : lowering == SNOW_DEGRADATION_QUARTER ? 4
                                                          : 1;
    view->width = (view->width + by - 1) / by;
    view->height = (view->height + by - 1) / by;
    if (lowering != SNOW_DEGRADATION_NONE)
        settings->quality = SNOW_QUALITY_DRAFT;
}
