/* cmd_convert.c - a volume into another format, whole or a box of it. */
#include "commands.h"
#include "interrupt.h"
#include "outputs.h"
#include "report.h"

#include <string.h>
#include <strings.h>

/* The name decides the format; a pipe may block, so there an interruption does
 * not wait for the write to end. */
int save_volume(snow_context *context, const options *asked,
                const snow_volume *volume) {
    char text[256];
    if (!is_special(asked->output))
        interrupt_hold();
    snow_status status =
        snow_volume_save(volume, asked->output, asked->overwrite);
    if (status != SNOW_OK)
        return fail_status(context, status);
    describe_volume(snow_volume_describe(volume), text, sizeof text);
    if (asked->verbosity >= 0) /* without the format that it came from */
        say("%s: %s", asked->output, strchr(text, ' ') + 1);
    return SNOW_OK;
}

/* Raw data are told by --dims and --type; the type of any other input is known,
 * so that --type says what to make of it. */
static snow_type wanted_type(const options *asked, snow_volume_options *data) {
    snow_type type = asked->as;
    if (!type && data->type && !data->dims[0]) {
        type = data->type;
        data->type = SNOW_TYPE_NONE;
    }
    return type;
}

/* Whether files of this name say slope and intercept. */
static bool keeps_scaling(const char *path) {
    static const char *const suffixes[] = {".nii", ".nii.gz", ".mha"};
    for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes; i++) {
        size_t length = strlen(path), end = strlen(suffixes[i]);
        if (length >= end && strcasecmp(path + length - end, suffixes[i]) == 0)
            return true;
    }
    return false;
}

/* The range that --range means.  Answers GO_ON or an exit code. */
static int find_range(const options *asked, const snow_volume *volume,
                      double range[2]) {
    snow_volume_measures m;
    switch (asked->range.kind) {
    case SNOW_RANGE_PERCENTILES:
        return fail_usage("--range: convert takes two data values or full");
    case SNOW_RANGE_FULL:
        snow_volume_measure(volume, &m);
        range[0] = m.min;
        range[1] = m.max;
        return GO_ON;
    default:
        range[0] = asked->range.low;
        range[1] = asked->range.high;
        return GO_ON;
    }
}

/* Takes the volume's place where another type is needed. */
static int change_type(snow_context *context, const options *asked,
                       snow_type type, snow_volume **volume) {
    const snow_volume_info *info = snow_volume_describe(*volume);
    bool scaled = info->slope != 1 || info->intercept != 0;
    bool spread = asked->range.kind != SNOW_RANGE_AUTO;
    double range[2];
    snow_volume *made;
    if (!type && !spread && (!scaled || keeps_scaling(asked->output)))
        return GO_ON;
    int done = spread ? find_range(asked, *volume, range) : GO_ON;
    if (done != GO_ON)
        return done;
    snow_status status =
        snow_volume_convert(*volume, type, spread ? range : NULL, &made);
    if (status != SNOW_OK) {
        say("%s: %s", asked->operands[0], snow_context_message(context));
        return (int)status;
    }
    snow_volume_close(*volume);
    *volume = made;
    return GO_ON;
}

static int convert(snow_context *context, const options *asked) {
    snow_volume_options data = data_options(asked);
    snow_type type = wanted_type(asked, &data);
    snow_volume *volume = NULL;
    snow_status status =
        snow_volume_open(context, asked->operands[0], &data, &volume);
    if (status != SNOW_OK)
        return fail_status(context, status);
    int done = change_type(context, asked, type, &volume);
    if (done == GO_ON)
        done = save_volume(context, asked, volume);
    snow_volume_close(volume);
    return done;
}

int cmd_convert(const options *asked) {
    snow_context *context = NULL;
    if (!asked->output)
        return fail_usage("no output is named; add -o OUT.nrrd");
    if (asked->range.kind != SNOW_RANGE_AUTO && !asked->as && !asked->type)
        return fail_usage("--range: spreads values over a type; add --as "
                          "uint8, say");
    int done = open_context(asked, &context);
    if (done == GO_ON)
        done = convert(context, asked);
    snow_context_free(context);
    return done;
}
