/* input.c - opens the volume and makes the transfer function from the
 * options. */
#include "commands/commands.h"
#include "run/log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Values that were not given stay 0.  The library refuses options that do not
 * fit a format, so it must be able to see whether they were given. */
snow_volume_options data_options(const options *asked) {
    snow_volume_options data = {.size = sizeof data,
                                .type = asked->type,
                                .offset = asked->offset,
                                .time = asked->time,
                                .each_time = asked->each_time,
                                .channel = asked->channel,
                                .dataset = asked->dataset,
                                .series = asked->series,
                                .mask = asked->mask,
                                .labels = asked->labels};
    memcpy(data.clip, asked->clip, sizeof data.clip);
    for (int i = 0; i < 3; i++) {
        data.dims[i] = asked->dims[i];
        data.spacing[i] = asked->spacing[i];
        data.crop[i][0] = asked->crop[i][0];
        data.crop[i][1] = asked->crop[i][1];
    }
    if (asked->endian)
        data.endian = strcmp(asked->endian, "big") == 0 ? SNOW_ENDIAN_BIG
                                                        : SNOW_ENDIAN_LITTLE;
    return data;
}

/* The same words as in the library's messages. */
const char *name_of_input(const char *path) {
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

int open_input(snow_context *context, const options *asked, const char *path,
               snow_volume **out) {
    snow_volume_options data = data_options(asked);
    snow_status status = snow_volume_open(context, path, &data, out);
    return status == SNOW_STATUS_OK ? CONTINUE : fail_status(context, status);
}

/* --window and --level are the radiologists' way to give a range; neither means
 * anything alone. */
int look_load(options *asked) {
    if (!asked->tf)
        return CONTINUE;
    int done = open_context(asked, &asked->tf_context);
    if (done != CONTINUE)
        return done;
    snow_status status =
        snow_look_load(asked->tf_context, asked->tf, &asked->loaded);
    if (status != SNOW_STATUS_OK)
        done = fail_status(asked->tf_context, status);
    return done;
}

void look_unload(options *asked) {
    snow_look_file_free(asked->loaded);
    snow_context_free(asked->tf_context);
    asked->loaded = NULL;
    asked->tf_context = NULL;
}

int check_look(const options *asked) {
    bool window = !isnan(asked->window), level = !isnan(asked->level);
    if (window != level)
        return fail_usage("--%s: needs --%s too; add it",
                          window ? "window" : "level",
                          window ? "level" : "window");
    if (asked->tf && asked->preset)
        return fail_usage(
            "--tf: conflicts with --preset; give only one of them");
    if (window && asked->range.kind != SNOW_RANGE_AUTO)
        return fail_usage(
            "--window: conflicts with --range; give only one of them");
    return CONTINUE;
}

snow_look look_options(const options *asked) {
    snow_look look = {.size = sizeof look,
                      .preset = asked->preset,
                      .colormap = asked->colormap,
                      .range = asked->range.kind,
                      .low = asked->range.low,
                      .high = asked->range.high,
                      .log = asked->log,
                      .base = asked->loaded ? snow_look_file_look(asked->loaded)
                                            : NULL};
    /* The projections are grey over the full range by default, as usual. */
    if (strcmp(asked->mode, "over") != 0 && strcmp(asked->mode, "iso") != 0 &&
        !look.preset && !look.base)
        look.preset = "linear";
    if (!isnan(asked->window)) { /* --window and --level give the range */
        look.range = SNOW_RANGE_VALUES;
        look.low = asked->level - asked->window / 2;
        look.high = asked->level + asked->window / 2;
    }
    if (asked->opacities.count) {
        look.opacities = asked->opacities.points;
        look.opacity_count = asked->opacities.count;
    }
    if (asked->gradient_opacities.count) {
        look.gradient_opacities = asked->gradient_opacities.points;
        look.gradient_opacity_count = asked->gradient_opacities.count;
    }
    return look;
}

int open_look(snow_context *context, const options *asked,
              const snow_volume *volume, snow_transfer **out) {
    snow_look look = look_options(asked);
    snow_status status = snow_transfer_new_for_volume(volume, &look, out);
    return status == SNOW_STATUS_OK ? CONTINUE : fail_status(context, status);
}

/* Short enough for the single line that render prints. */
void describe_volume(const snow_volume_info *info, char *out, size_t size) {
    snprintf(out, size, "%s %lldx%lldx%lld %s, spacing %gx%gx%g%s%s",
             info->format, (long long)info->dims[0], (long long)info->dims[1],
             (long long)info->dims[2], snow_type_name(info->type),
             info->spacing[0], info->spacing[1], info->spacing[2],
             info->unit[0] ? " " : "", info->unit);
}
