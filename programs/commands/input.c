/* input.c - opens the volume and makes the transfer function from the
 * options. */
#include "commands/commands.h"
#include "commands/world.h"
#include "picture/layers.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Data values stay as the file has them where they are not shown in colours. */
static const char *suv_of(const options *opts) {
    static const char *const kept[] = {"mean", "sum", "slice"};
    bool values = opts->one_channel;
    for (size_t i = 0; i < sizeof kept / sizeof *kept && opts->output; i++)
        values |= strcmp(opts->mode, kept[i]) == 0 &&
                  snow_image_format_bits(opts->output) == 0;
    return values && !opts->suv ? "none" : opts->suv;
}

/* Values that were not given stay 0.  The library refuses options that do not
 * fit a format, so it must be able to see whether they were given. */
snow_volume_options data_options(const options *opts) {
    snow_volume_options data = {
        .size = sizeof data,
        .type = opts->type,
        .offset = opts->offset,
        .time = opts->time,
        .each_time = opts->each_time,
        .time_given = options_given(opts, "time"),
        .channel = opts->channel,
        .channel_given = options_given(opts, "channel"),
        .each_channel = opts->mixes,
        .allow_gaps = opts->allow_gaps,
        .levels = opts->levels,
        .suv = suv_of(opts),
        .z_scale = opts->z_scale,
        .vertical = opts->vertical,
        .component = opts->component,
        .dataset = opts->dataset,
        .series = opts->series,
        .mask = opts->mask,
        .labels = opts->overlay_picks ? NULL : opts->labels,
        .label_table = opts->overlay ? NULL : opts->label_table};
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
    return check_status(context, snow_volume_open(context, path, &data, out));
}

/* What a file says.  Notes are left to the reading itself. */
static int inspect(const options *opts, const char *path,
                   snow_volume_info *info) {
    snow_context *context = NULL;
    snow_volume_options data = data_options(opts);
    snow_volume_info_init(info);
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_inspect(context, path, &data, info);
    int done = check_status(context, status);
    snow_context_free(context);
    return done;
}

/* Standard input can be read only once, and a pattern of names is no file. */
int check_input(const options *opts) {
    const char *path = opts->operand_count == 1 ? opts->operands[0] : "-";
    snow_volume_info info;
    if (strcmp(path, "-") == 0 || strchr(path, '%'))
        return CONTINUE;
    return inspect(opts, path, &info);
}

int check_input_first(const options *opts, const char *const *outputs,
                      size_t count) {
    bool free = true;
    for (size_t i = 0; i < count; i++)
        free &= !outputs[i] || is_free(outputs[i], opts->overwrite);
    return free ? CONTINUE : check_input(opts);
}

/* A segmentation, or beside no mask whole numbers, which its labels make one.
 */
static int overlay_is_labels(const options *opts, const char *path, bool *is) {
    snow_context *context = NULL; /* whose warnings come again */
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    const snow_look look = {.size = sizeof look};
    int done = layers_check_file(path);
    if (done != CONTINUE)
        return done;
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_open(context, path, NULL, &volume);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(volume, &look, &transfer);
    if (status == SNOW_STATUS_OK) {
        const snow_volume_info *info = snow_volume_get_info(volume);
        *is = snow_transfer_label(transfer, 0) ||
              (!opts->mask && info->type < SNOW_TYPE_FLOAT32 &&
               info->slope == 1 && info->intercept == 0);
    } else
        done = fail_status(context, status);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
    return done;
}

/* Whether --labels picks of the overlay.  What a verb does not show has no use
 * for them, nor for their table. */
static int share_labels(options *opts) {
    const char *path = opts->overlay ? opts->overlay : opts->overlay_hidden;
    bool picks = false;
    int done = CONTINUE;
    if (path && opts->labels &&
        (opts->overlay || !options_typed(opts, "labels")))
        done = overlay_is_labels(opts, path, &picks);
    opts->overlay_picks = picks && opts->overlay;
    if (!opts->overlay_hidden || done != CONTINUE)
        return done;
    if (opts->verbosity >= 0 && process_talks())
        say("note: the overlay %s is not shown", path);
    if (picks)
        opts->labels = NULL;
    if (!options_typed(opts, "label-table"))
        opts->label_table = NULL;
    return CONTINUE;
}

static int refuse_channel(const char *name, const snow_volume_info *info) {
    char text[400] = "";
    size_t used = 0;
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++)
        used += (size_t)snprintf(
            text + used, sizeof text - used, "%s%d%s%s", n ? ", " : "", n,
            *info->channel[n].name ? " " : "", info->channel[n].name);
    return fail_usage("--channel: there is no channel '%s'; the file has %s",
                      name, info->channels > 1 ? text : "no channels");
}

/* The number of each channel that was named. */
static int find_channels(options *opts) {
    const char *missing, *path = opts->operands[0];
    snow_volume_info info;
    if (strcmp(path, "-") == 0)
        return fail_usage("--channel: standard input is read once, so that "
                          "names are not known; give numbers");
    int done = inspect(opts, path, &info);
    if (done == CONTINUE && !channels_find(&opts->channels, &info, &missing))
        done = refuse_channel(missing, &info);
    return done;
}

int settle_channels(options *opts, bool pictures) {
    channel_list *list = &opts->channels;
    bool named = false;
    int done = CONTINUE;
    opts->one_channel = !pictures;
    if (!list->count || opts->operand_count < 1)
        return CONTINUE;
    if (!pictures && !list->plain)
        return fail_usage("--channel: only pictures mix channels in colours; "
                          "give one, by its number or name");
    if (!list->plain && opts->component)
        return fail_usage("--channel: conflicts with --component; give only "
                          "one of them");
    for (int n = 0; n < list->count; n++)
        named |= list->picks[n].index < 0;
    if (named)
        done = find_channels(opts);
    opts->channel = list->picks[0].index;
    if (list->plain)
        list->count = 0;
    return done;
}

int look_load(options *opts) {
    int done = share_labels(opts);
    if (!opts->tf || done != CONTINUE)
        return done;
    done = open_context(opts, &opts->tf_context);
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

int check_look(const options *opts) {
    if (opts->tf && opts->preset)
        return fail_usage(
            "--tf: conflicts with --preset; give only one of them");
    if (!isnan(opts->window[0]) && opts->range.kind != SNOW_RANGE_AUTO)
        return fail_usage(
            "--window: conflicts with --range; give only one of them");
    return CONTINUE;
}

snow_range automatic_range(const options *opts) {
    return strcmp(opts->mode, "slice") == 0 ? SNOW_RANGE_SLICES
                                            : SNOW_RANGE_ROBUST;
}

snow_look look_options(const options *opts) {
    const range_value range = options_range(opts);
    snow_look look = {.size = sizeof look,
                      .preset = opts->preset,
                      .colormap = opts->colormap,
                      .range = range.kind,
                      .low = range.low,
                      .high = range.high,
                      .log = opts->scale.log,
                      .symlog = opts->scale.symlog,
                      .base = opts->loaded ? snow_look_file_look(opts->loaded)
                                           : NULL};
    /* Projections are grey by default, over the file's window or all values but
     * a few far off. */
    if (mode_is_projection(opts->mode) && !look.preset && !look.base) {
        look.preset = "linear";
        if (look.range == SNOW_RANGE_AUTO) {
            const bool known = opts->usual.kind != SNOW_RANGE_AUTO;
            look.range = known ? opts->usual.kind
                         : strcmp(opts->mode, "minip") == 0
                             ? SNOW_RANGE_LEAST
                             : automatic_range(opts);
            look.low = opts->usual.low;
            look.high = opts->usual.high;
        }
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
    return check_status(context,
                        snow_transfer_new_for_volume(volume, &look, out));
}

/* Short enough for the single line that render prints. */
void describe_volume(const snow_volume_info *info, char *out, size_t size) {
    const snow_volume_info own = world_in_units(info);
    char units[64];
    world_units(info, units, sizeof units);
    snprintf(out, size, "%s %lldx%lldx%lld %s, spacing %gx%gx%g%s",
             info->format, (long long)info->dims[0], (long long)info->dims[1],
             (long long)info->dims[2], snow_type_name(info->type),
             own.spacing[0], own.spacing[1], own.spacing[2], units);
}
