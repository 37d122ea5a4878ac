/* cmd_phantom.c - writes a built-in test volume to a file. */
#include "commands.h"
#include "interrupt.h"
#include "outputs.h"
#include "report.h"

/* The name decides the format; a pipe may block, so there an interruption does
 * not wait for the write to end. */
static int save(snow_context *context, const options *asked,
                const snow_volume *volume) {
    char text[256];
    if (!is_special(asked->output))
        interrupt_hold();
    snow_status status =
        snow_volume_save(volume, asked->output, asked->overwrite);
    if (status != SNOW_OK)
        return fail_status(context, status);
    describe_volume(snow_volume_describe(volume), text, sizeof text);
    if (asked->verbosity >= 0)
        say("%s: %s", asked->output, text);
    return SNOW_OK;
}

/* Without an output nothing is made: there is no sensible default place. */
int cmd_phantom(const options *asked) {
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    if (!asked->output)
        return fail_usage("no output is named; add -o OUT.nrrd");
    int done = open_context(asked, &context);
    if (done != GO_ON)
        return done;
    snow_status status = snow_volume_phantom(context, asked->operands[0],
                                             asked->dims, asked->seed, &volume);
    done = status == SNOW_OK ? save(context, asked, volume)
                             : fail_status(context, status);
    snow_volume_close(volume);
    snow_context_free(context);
    return done;
}
