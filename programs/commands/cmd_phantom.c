/* cmd_phantom.c - the verb phantom: writes a built-in test volume to a file. */
#include "commands/commands.h"
#include "run/log.h"

/* There is no sensible default output, so none is assumed. */
int cmd_phantom(const options *opts) {
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    if (!opts->output)
        return fail_usage("no output file given; add -o OUT.nrrd");
    int done = open_context(opts, &context);
    if (done != CONTINUE)
        return done;
    snow_status status = snow_volume_open_phantom(context, opts->operands[0],
                                                  opts->dims, 0, &volume);
    done = status == SNOW_STATUS_OK ? save_volume(context, opts, volume)
                                    : fail_status(context, status);
    snow_volume_close(volume);
    snow_context_free(context);
    return done;
}
