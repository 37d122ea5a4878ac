/* cmd_phantom.c - the verb phantom: writes a built-in test volume to a file. */
#include "commands/commands.h"
#include "run/log.h"

/* There is no sensible default output, so none is assumed. */
int cmd_phantom(const options *asked) {
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    if (!asked->output)
        return fail_usage("no output file given; add -o OUT.nrrd");
    int done = open_context(asked, &context);
    if (done != CONTINUE)
        return done;
    snow_status status = snow_volume_open_phantom(
        context, asked->operands[0], asked->dims, asked->seed, &volume);
    done = status == SNOW_STATUS_OK ? save_volume(context, asked, volume)
                                    : fail_status(context, status);
    snow_volume_close(volume);
    snow_context_free(context);
    return done;
}
