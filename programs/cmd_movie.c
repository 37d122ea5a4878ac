/* cmd_movie.c - a movie over time steps, each from the same camera and with the
 * same transfer function.
 *
 * Were the look chosen for each step anew, brightness would flicker and nothing
 * could be compared; were it chosen by the first, what grows later would be cut
 * off.  So all steps are read twice: first for their values, then to be drawn.
 */
#include "commands.h"
#include "report.h"
#include "sequence_steps.h"

#include <stdlib.h>

static int check(const options *asked) {
    if (asked->operand_count == 0)
        return fail_usage("movie: something is missing; give snowglass movie "
                          "INPUT... -o OUT");
    return sequence_check(asked);
}

/* Lists the steps, looks at the output, chooses the look, makes the frames. */
static int run(const options *asked, serial_renderer *serial, step_files *files,
               shot_list *list, sequence **s, double begin) {
    int done = check(asked);
    if (done == GO_ON)
        done = steps_find(asked, files);
    if (done == GO_ON)
        done = serial_open(asked, serial);
    if (done == GO_ON)
        done = steps_list(files, serial, list);
    if (done == GO_ON)
        done = sequence_open(asked, list, s);
    if (done == GO_ON)
        done = steps_look(list, serial);
    if (done != GO_ON)
        return done;
    serial->count = list->count;
    sequence_renderer renderer = serial_renderer_of(serial);
    return sequence_run(*s, asked, list, &renderer, begin);
}

int cmd_movie(const options *asked) {
    double begin = seconds_now();
    serial_renderer serial = {.asked = asked};
    step_files files = {NULL, 0, 0};
    shot_list list = {.shots = NULL};
    sequence *s = NULL;
    int done = run(asked, &serial, &files, &list, &s, begin);
    progress(asked, NULL);
    sequence_close(s);
    serial_close(&serial);
    free(list.shots);
    steps_free(&files);
    return done;
}
