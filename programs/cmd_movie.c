/* cmd_movie.c - a movie over time steps, each from the same camera and with the
 * same transfer function.
 *
 * Were the look chosen for each step anew, brightness would flicker and nothing
 * could be compared; were it chosen by the first, what grows later would be cut
 * off.  So all steps are read twice: first for their values, then to be drawn.
 */
#include "commands.h"
#include "launch.h"
#include "report.h"
#include "sequence_steps.h"

#include <stdlib.h>

static int check(const options *asked) {
    if (asked->operand_count == 0)
        return fail_usage("movie: something is missing; give snowglass movie "
                          "INPUT... -o OUT");
    return sequence_check(asked);
}

/* Lists the steps, and looks at the output, by the rank that writes it. */
static int prepare(const options *asked, shot_renderer *shots,
                   step_files *files, shot_list *list, sequence **s) {
    int done = check(asked);
    if (done == GO_ON)
        done = steps_find(asked, files);
    done = launch_agree(done);
    if (done == GO_ON)
        done = shots_open(asked, shots);
    if (done != GO_ON)
        return done;
    done = steps_list(files, shots, list);
    if (done == GO_ON && launch_talks())
        done = sequence_open(asked, list, s);
    return launch_agree(done);
}

/* Then chooses the look, and makes the frames. */
static int run(const options *asked, shot_renderer *shots, step_files *files,
               shot_list *list, sequence **s, double begin) {
    int done = prepare(asked, shots, files, list, s);
    if (done == GO_ON)
        done = steps_look(list, shots);
    if (done != GO_ON)
        return done;
    shots->count = list->count;
    sequence_renderer renderer = shots_renderer(shots);
    return sequence_run(*s, asked, list, &renderer, begin);
}

int cmd_movie(const options *asked) {
    double begin = seconds_now();
    shot_renderer shots = {.count = 0};
    step_files files = {NULL, 0, 0};
    shot_list list = {.shots = NULL};
    sequence *s = NULL;
    int done = run(asked, &shots, &files, &list, &s, begin);
    progress(asked, NULL);
    sequence_close(s);
    shots_close(&shots);
    free(list.shots);
    steps_free(&files);
    return done;
}
