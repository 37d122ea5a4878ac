/* cmd_phantom.c - writes a built-in test volume to a file. */
#include "commands.h"
#include "report.h"

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
    done = status == SNOW_OK ? save_volume(context, asked, volume)
                             : fail_status(context, status);
    snow_volume_close(volume);
    snow_context_free(context);
    return done;
}
