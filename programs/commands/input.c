/* input.c - opens the volume and makes the transfer function from the
 * options. */
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Values that were not given stay 0.  The library refuses options that do not
 * fit a format, so it must be able to see whether they were given. */
snow_volume_options data_options(const options *opts) {
    snow_volume_options data = {.size = sizeof data,
                                .type = opts->type,
                                .offset = opts->offset,
                                .time = opts->time,
                                .each_time = opts->each_time,
                                .channel = opts->channel,
                                .channel_given = options_given(opts, "channel"),
                                .allow_gaps = opts->allow_gaps,
                                .component = opts->component,
                                .dataset = opts->dataset,
                                .series = opts->series,
                                .mask = opts->mask,
                                .labels = opts->labels};
    memcpy(data.clip, opts->clip, sizeof data.clip);
    for (int i = 0; i < 3; i++) {
        data.dims[i] = opts->dims[i];
        data.spacing[i] = opts->spacing[i];
        data.crop[i][0] = opts->crop[i][0];
        data.crop[i][1] = opts->crop[i][1];
    }
    if (opts->endian)
        data.endian = strcmp(opts->endian, "big") == 0 ? SNOW_ENDIAN_BIG
                                                       : SNOW_ENDIAN_LITTLE;
    return data;
}

/* The same words as in the library's messages. */
const char *name_of_input(const char *path) {
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

int open_input(snow_context *context, const options *opts, const char *path,
               snow_volume **out) {
    snow_volume_options data = data_options(opts);
    snow_status status = snow_volume_open(context, path, &data, out);
    return status == SNOW_STATUS_OK ? CONTINUE : fail_status(context, status);
}

/* Notes are left to the reading itself.  Standard input can be read only once,
 * and a pattern of names is no file. */
int check_input(const options *opts) {
    const char *path = opts->operand_count == 1 ? opts->operands[0] : "-";
    snow_context *context = NULL;
    if (strcmp(path, "-") == 0 || strchr(path, '%'))
        return CONTINUE;
    snow_volume_info info;
    snow_volume_options data = data_options(opts);
    snow_volume_info_init(&info);
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_inspect(context, path, &data, &info);
    int done =
        status == SNOW_STATUS_OK ? CONTINUE : fail_status(context, status);
    snow_context_free(context);
    return done;
}

int check_input_first(const options *opts, const char *const *outputs,
                      size_t count) {
    bool free = true;
    for (size_t i = 0; i < count; i++)
        free &= !outputs[i] || is_free(outputs[i], opts->overwrite);
    return free ? CONTINUE : check_input(opts);
}

int look_load(options *opts) {
    if (!opts->tf)
        return CONTINUE;
    int done = open_context(opts, &opts->tf_context);
    if (done != CONTINUE)
        return done;
    snow_status status =
        snow_look_load(opts->tf_context, opts->tf, &opts->loaded);
    if (status != SNOW_STATUS_OK)
        done = fail_status(opts->tf_context, status);
    return done;
}

void look_unload(options *opts) {
    snow_look_file_free(opts->loaded);
    snow_context_free(opts->tf_context);
    opts->loaded = NULL;
    opts->tf_context = NULL;
}

/* --window and --level are the radiologists' way to give a range; neither means
 * anything alone. */
int check_look(const options *opts) {
    bool window = !isnan(opts->window), level = !isnan(opts->level);
    if (window != level)
        return fail_usage("--%s: needs --%s too; add it",
                          window ? "window" : "level",
                          window ? "level" : "window");
    if (opts->tf && opts->preset)
        return fail_usage(
            "--tf: conflicts with --preset; give only one of them");
    if (window && opts->range.kind != SNOW_RANGE_AUTO)
        return fail_usage(
            "--window: conflicts with --range; give only one of them");
    return CONTINUE;
}

snow_look look_options(const options *opts) {
    const range_value range = options_range(opts);
    snow_look look = {.size = sizeof look,
                      .preset = opts->preset,
                      .colormap = opts->colormap,
                      .range = range.kind,
                      .low = range.low,
                      .high = range.high,
                      .log = opts->log,
                      .shift = opts->shift,
                      .base = opts->loaded ? snow_look_file_look(opts->loaded)
                                           : NULL};
    /* Projections are grey by default, over the file's window or all values but
     * a few far off. */
    if (mode_is_projection(opts->mode) && !look.preset && !look.base) {
        look.preset = "linear";
        if (look.range == SNOW_RANGE_AUTO)
            look.range = SNOW_RANGE_ROBUST;
    }
    if (opts->opacities.count) {
        look.opacities = opts->opacities.points;
        look.opacity_count = opts->opacities.count;
    }
    if (opts->gradient_opacities.count) {
        look.gradient_opacities = opts->gradient_opacities.points;
        look.gradient_opacity_count = opts->gradient_opacities.count;
    }
    return look;
}

int open_look(snow_context *context, const options *opts,
              const snow_volume *volume, snow_transfer **out) {
    snow_look look = look_options(opts);
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
