/* insitu/settings.c - what holds for many steps: copies of all that the
 * caller's record points to. */
#include "insitu/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static snow_status keep_view(snow_insitu *insitu, const snow_view *given) {
    snow_view view;
    INSITU_TRY(INSITU_READ(insitu, snow_view, given, &view));
    if (view.width < 1 || view.height < 1)
        return snow_insitu_refuse(
            insitu,
            "invalid picture of %dx%d pixels; set width and height of the view",
            view.width, view.height);
    insitu->view = view;
    insitu->has_view = true;
    return SNOW_STATUS_OK;
}

static snow_status keep_clip(snow_insitu *insitu, const double *planes,
                             size_t count) {
    if (count > SNOW_CLIPS_MAX)
        return snow_insitu_refuse(insitu,
                                  "too many clip planes: %zu; give at most %d",
                                  count, SNOW_CLIPS_MAX);
    if (count && !planes)
        return snow_insitu_refuse(insitu,
                                  "no clip planes where there are to be %zu; "
                                  "give them, or none",
                                  count);
    for (size_t i = 0; i < 4 * count; i++)
        if (!isfinite(planes[i]))
            return snow_insitu_refuse(
                insitu, "clip plane %zu has a number that is not finite",
                i / 4);
    insitu->clip_count = (int64_t)count;
    if (count)
        memcpy(insitu->clips, planes, count * sizeof *insitu->clips);
    return SNOW_STATUS_OK;
}

static snow_status keep_picture(snow_insitu *insitu,
                                const snow_insitu_settings *given) {
    snow_settings known;
    INSITU_TRY(INSITU_READ(insitu, snow_settings, given->picture, &known));
    insitu->settings = known;
    insitu->shaded = given->shaded;
    return SNOW_STATUS_OK;
}

static snow_status keep_work(snow_insitu *insitu,
                             const snow_insitu_work *given) {
    snow_insitu_work work;
    INSITU_TRY(INSITU_READ(insitu, snow_insitu_work, given, &work));
    if ((int)work.ghosts < 0 || work.ghosts > SNOW_GHOSTS_NONE ||
        (int)work.balance < 0 || work.balance > SNOW_BALANCE_REPARTITION)
        return snow_insitu_refuse(insitu,
                                  "invalid ghosts %d or balance %d; use values "
                                  "of snow_ghosts and snow_balance",
                                  (int)work.ghosts, (int)work.balance);
    insitu->ghosts = work.ghosts;
    insitu->balance = work.balance;
    insitu->changed = true;
    return SNOW_STATUS_OK;
}

/* Limits that are given again, as by a recipe that is read for each step, leave
 * pictures as they have been lowered. */
static snow_status keep_limits(snow_insitu *insitu,
                               const snow_insitu_limits *given) {
    snow_insitu_limits limits;
    INSITU_TRY(INSITU_READ(insitu, snow_insitu_limits, given, &limits));
    if (!(limits.seconds >= 0))
        return snow_insitu_refuse(
            insitu, "invalid limit %g s: must not be negative", limits.seconds);
    if (insitu->limit_seconds == limits.seconds &&
        insitu->limit_bytes == limits.bytes)
        return SNOW_STATUS_OK;
    insitu->limit_seconds = limits.seconds;
    insitu->limit_bytes = limits.bytes;
    insitu->lowering = SNOW_DEGRADATION_NONE;
    insitu->to_skip = 0;
    return SNOW_STATUS_OK;
}

static snow_status keep_annotations(snow_insitu *insitu,
                                    const snow_insitu_annotations *given) {
    snow_insitu_annotations marks;
    snow_volume_info *says = &insitu->says;
    INSITU_TRY(INSITU_READ(insitu, snow_insitu_annotations, given, &marks));
    const struct {
        const char *from;
        char *to;
        size_t room;
    } kept[] = {{marks.title, insitu->title, TEXT_BYTES},
                {marks.time_format, insitu->time_format, TEXT_BYTES},
                {marks.quantity, says->quantity, sizeof says->quantity},
                {marks.unit, says->value_unit, sizeof says->value_unit}};
    for (size_t n = 0; n < sizeof kept / sizeof *kept; n++)
        snprintf(kept[n].to, kept[n].room, "%s",
                 kept[n].from ? kept[n].from : "");
    marks.title = marks.title ? insitu->title : NULL;
    marks.time_format = marks.time_format ? insitu->time_format : NULL;
    marks.quantity = marks.unit = NULL;
    marks.scale_bar = marks.legend || marks.scale_bar;
    insitu->annotations = marks;
    insitu->strip = 0;
    return SNOW_STATUS_OK;
}

/* The path comes first, since it may be refused. */
snow_status snow_insitu_set(snow_insitu *insitu,
                            const snow_insitu_settings *given) {
    snow_insitu_settings s;
    INSITU_TRY(INSITU_READ(insitu, snow_insitu_settings, given, &s));
    if (s.output || s.image)
        INSITU_TRY(snow_insitu_keep_output(insitu, &s));
    if (s.look)
        INSITU_TRY(snow_insitu_keep_look(insitu, s.look));
    if (s.view)
        INSITU_TRY(keep_view(insitu, s.view));
    if (s.picture)
        INSITU_TRY(keep_picture(insitu, &s));
    if (s.clip || s.clip_count)
        INSITU_TRY(keep_clip(insitu, s.clip, s.clip_count));
    if (s.annotations)
        INSITU_TRY(keep_annotations(insitu, s.annotations));
    snow_ranks_options how = insitu->how;
    if (s.ranks)
        INSITU_TRY(INSITU_READ(insitu, snow_ranks_options, s.ranks, &how));
    insitu->how = how;
    if (s.work)
        INSITU_TRY(keep_work(insitu, s.work));
    return s.limits ? keep_limits(insitu, s.limits) : SNOW_STATUS_OK;
}

void snow_insitu_work_init_sized(snow_insitu_work *work, size_t size) {
    snow_record_init(work, size, NULL, sizeof *work);
}

void snow_insitu_limits_init_sized(snow_insitu_limits *limits, size_t size) {
    snow_record_init(limits, size, NULL, sizeof *limits);
}

void snow_insitu_annotations_init_sized(snow_insitu_annotations *annotations,
                                        size_t size) {
    snow_record_init(annotations, size, NULL, sizeof *annotations);
}

void snow_insitu_settings_init_sized(snow_insitu_settings *settings,
                                     size_t size) {
    snow_record_init(settings, size, NULL, sizeof *settings);
}
