/* command.c - implements command.h. */
#include "movies/command.h"

#include <stdio.h>
#include <string.h>

char *movie_command(const drawing *d, const movie_order *order,
                    char output[100]) {
    static options opts; /* large; one thread draws */
    char rate[32];
    const unsigned verb = order->steps ? VERB_MOVIE : VERB_TURNTABLE;
    drawing_options(d, &opts);
    drawing_name_output(opts.operands[0], "", output);
    snprintf(strrchr(output, '.'), 6, ".%s", order->format);
    snprintf(rate, sizeof rate, "%.6g", order->fps);
    opts.output = output;
    opts.size[0] = order->width;
    opts.size[1] = order->height;
    opts.frames = order->frames;
    if (order->steps) {
        opts.time = order->first;
        opts.time_end = order->last + 1;
        opts.time_range = true;
    }
    const bool good = order->fps <= 0 || options_take(&opts, verb_of(verb),
                                                      "fps", rate) == CONTINUE;
    return good ? drawing_command_of(&opts, verb) : NULL;
}
