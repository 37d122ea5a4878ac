/* cmd_convert.c - the verb convert: writes a volume, or a box of it, in another
 * format. */
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/interrupt.h"
#include "run/log.h"

#include <string.h>
#include <strings.h>

/* The file name decides the format.  Writing to a pipe may block, so an
 * interruption there does not wait for the write to end. */
int save_volume(snow_context *context, const options *opts,
                const snow_volume *volume) {
    char text[256];
    int done = check_no_folder(opts->output);
    if (done != CONTINUE)
        return done;
    if (!is_special(opts->output))
        interrupt_hold();
    snow_status status =
        snow_volume_save(volume, opts->output, opts->overwrite);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    describe_volume(snow_volume_get_info(volume), text, sizeof text);
    if (opts->verbosity >= 0) /* without the input's format */
        say("%s: %s", opts->output, strchr(text, ' ') + 1);
    return SNOW_STATUS_OK;
}

/* Whether the format that this file name selects stores slope and intercept. */
static bool keeps_scaling(const char *path) {
    static const char *const suffixes[] = {".nii", ".nii.gz", ".mha"};
    for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes; i++) {
        size_t length = strlen(path), end = strlen(suffixes[i]);
        if (length >= end && strcasecmp(path + length - end, suffixes[i]) == 0)
            return true;
    }
    return false;
}

/* The data values that --range stands for.  Returns CONTINUE or an exit
 * code. */
static int find_range(const options *opts, const snow_volume *volume,
                      double range[2]) {
    snow_volume_statistics m = {.size = sizeof m};
    switch (opts->range.kind) {
    case SNOW_RANGE_PERCENTILES:
        return fail_usage("--range: percentiles cannot be converted; give two "
                          "data values or full");
    case SNOW_RANGE_FULL:
        snow_volume_get_statistics(volume, &m);
        range[0] = m.min;
        range[1] = m.max;
        return CONTINUE;
    default:
        range[0] = opts->range.low;
        range[1] = opts->range.high;
        return CONTINUE;
    }
}

/* Replaces the volume if another type is needed. */
static int change_type(snow_context *context, const options *opts,
                       snow_type type, snow_volume **volume) {
    const snow_volume_info *info = snow_volume_get_info(*volume);
    bool scaled = info->slope != 1 || info->intercept != 0;
    bool spread = opts->range.kind != SNOW_RANGE_AUTO;
    double range[2];
    snow_volume *made;
    if (!type && !spread && (!scaled || keeps_scaling(opts->output)))
        return CONTINUE;
    int done = spread ? find_range(opts, *volume, range) : CONTINUE;
    if (done != CONTINUE)
        return done;
    snow_status status =
        snow_volume_convert(*volume, type, spread ? range : NULL, &made);
    if (status != SNOW_STATUS_OK) {
        say("%s: %s", opts->operands[0], snow_context_message(context));
        return (int)status;
    }
    snow_volume_close(*volume);
    *volume = made;
    return CONTINUE;
}

static int convert(snow_context *context, const options *opts) {
    snow_volume_options data = data_options(opts);
    snow_type type = opts->as;
    snow_volume *volume = NULL;
    /* --dims and --type describe raw input.  Any other input states its own
     * type, so for it --type is the type to convert to. */
    if (!type && data.type && !data.dims[0]) {
        type = data.type;
        data.type = SNOW_TYPE_NONE;
    }
    snow_status status =
        snow_volume_open(context, opts->operands[0], &data, &volume);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    int done = change_type(context, opts, type, &volume);
    if (done == CONTINUE)
        done = save_volume(context, opts, volume);
    snow_volume_close(volume);
    return done;
}

int cmd_convert(const options *opts) {
    snow_context *context = NULL;
    if (!opts->output)
        return fail_usage("no output file given; add -o OUT.nrrd");
    if (opts->range.kind != SNOW_RANGE_AUTO && !opts->as && !opts->type)
        return fail_usage("--range: needs a type to spread the values over; "
                          "add --as uint8, for example");
    if (opts->as == AS_RGB24)
        return fail_usage("--as: rgb24 is of frames; give a voxel type");
    int done = open_context(opts, &context);
    if (done == CONTINUE)
        done = convert(context, opts);
    snow_context_free(context);
    return done;
}
