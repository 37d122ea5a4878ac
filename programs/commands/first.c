/* first.c - see first.h. */
#include "commands/first.h"
#include "commands/commands.h"
#include "movie/movie_files.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/memory.h"
#include "run/start.h"

#include <string.h>
#include <sys/stat.h>

/* Whether options are of a mode, or of opacities, surfaces and light, which are
 * of mode over.  Recipes have all keys, so that values count. */
static bool is_decided(const options *opts) {
    const bool opaque = opts->preset || opts->tf || opts->opacities.count ||
                        opts->gradient_opacities.count || opts->labels ||
                        opts->overlay || opts->threshold > 0;
    const bool lit = options_given(opts, "shade") ||
                     options_typed(opts, "light") || opts->depth ||
                     opts->depth_darkening > 0 || opts->occlusion > 0;
    return options_given(opts, "mode") || opaque || lit ||
           strcmp(opts->method, "original") == 0 ||
           strcmp(opts->method, "footprint") == 0 ||
           strcmp(opts->kernel, "gauss") == 0 ||
           strcmp(opts->kernel, "box") == 0;
}

/* Whether the input can be read twice, and is to be shown by what it is. */
static bool is_open(const options *opts) {
    struct stat what;
    const char *path = opts->operand_count > 0 ? opts->operands[0] : "-";
    const bool once = strcmp(path, "-") == 0 ||
                      (stat(path, &what) == 0 && !S_ISREG(what.st_mode) &&
                       !S_ISDIR(what.st_mode));
    return !once && (strcmp(opts->mode, "mip") == 0 || !is_decided(opts));
}

/* The channel that is drawn alone; a component may be one. */
static int64_t number_of_one(const options *opts) {
    int64_t number = opts->channel;
    if (opts->component && !value_integer(opts->component, &number))
        number = -1;
    return number;
}

/* The channels of light among those that are to be drawn. */
static uint64_t light_of(const options *opts, const snow_volume_info *info) {
    const channel_list *list = &opts->channels;
    const int64_t one = number_of_one(opts);
    if (list->count)
        return channels_are_light(list, info) ? 1 : 0;
    if (!opts->component && !options_given(opts, "channel"))
        return info->light;
    return one >= 0 && one < 64 ? info->light >> one & 1 : 0;
}

/* The file's, or that of what is above the noise. */
static range_value range_of_one(const options *opts,
                                const snow_volume_info *info) {
    const int64_t one = number_of_one(opts);
    const double *window = one >= 0 && one < SNOW_CHANNELS_MAX
                               ? info->channel[one].window
                               : info->window;
    if (window[0] < window[1])
        return (range_value){SNOW_RANGE_VALUES, window[0], window[1]};
    return (range_value){SNOW_RANGE_SIGNAL, 0, 0};
}

void first_take(options *opts, const snow_volume_info *info) {
    snow_volume_info seen = *info;
    seen.light = light_of(opts, info);
    const snow_mode mode = snow_mode_for(&seen);
    const char *map = snow_colormap_for(&seen);
    if (!is_decided(opts) && mode != SNOW_MODE_OVER) {
        options_take(opts, verb_of(VERB_RENDER), "mode", snow_mode_name(mode));
        opts->slab = !seen.light && !map;
    }
    if (mode != SNOW_MODE_MIP || strcmp(opts->mode, "mip") != 0)
        return;
    if (seen.light)
        opts->usual = range_of_one(opts, info);
    else if (map)
        opts->usual = (range_value){SNOW_RANGE_SIGNAL, 0, 0};
    if (!seen.light && !opts->colormap && !opts->preset && !opts->tf)
        opts->colormap = map;
}

void first_volume_free(first_volume *first) {
    snow_volume_close(first->volume);
    snow_context_free(first->context);
}

/* Where nothing else has to be known before: one picture, of voxels that fit
 * into memory.  What is wrong is said when it is read again. */
static bool open_at_once(options *opts) {
    static options step; /* large */
    first_volume *first = opts->first;
    if (!first || opts->memory || opts->verbosity > 0 || process_ranks() > 1 ||
        !memory_is_small_folder(opts->operands[0]) ||
        !is_free(opts->output, opts->overwrite) ||
        snow_context_new(NULL, &first->context) != SNOW_STATUS_OK)
        return false;
    step = *opts;
    step.mixes = true;
    const snow_volume_options data = data_options(&step);
    show_warnings(opts, first->context, true);
    snow_context_set_progress(first->context, progress_show, NULL);
    const double begin = seconds_now();
    progress_begin(opts, "reading");
    const snow_status status = snow_volume_open(
        first->context, opts->operands[0], &data, &first->volume);
    progress_end(opts);
    first->seconds = seconds_now() - begin;
    if (status == SNOW_STATUS_OK)
        first_take(opts, snow_volume_get_info(first->volume));
    return status == SNOW_STATUS_OK;
}

void first_settle(options *opts) {
    snow_context *context = NULL; /* whose warnings come again */
    snow_volume_info info = {.size = sizeof info};
    step_files files = {.gaps = true};
    const snow_volume_options data = data_options(opts);
    if (!is_open(opts) || open_at_once(opts) ||
        snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return;
    const char *path = opts->operands[0];
    if (files_are_meant(path) && steps_find(opts, &files) == CONTINUE)
        path = files.paths[0];
    if (snow_volume_inspect(context, path, &data, &info) == SNOW_STATUS_OK)
        first_take(opts, &info);
    steps_free(&files);
    snow_context_free(context);
}
