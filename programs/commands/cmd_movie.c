/* cmd_movie.c - the verb movie: one frame for each time step, all with the same
 * camera and the same transfer function.
 *
 * A transfer function chosen for each step would make the brightness flicker,
 * and steps could not be compared.  One chosen by the first step would cut off
 * values that appear later.  So all steps are read twice: first for their
 * values, then to be rendered. */
#include "commands/commands.h"
#include "movie/movie_files.h"
#include "movie/movie_render.h"
#include "run/log.h"
#include "run/start.h"

#include <stdlib.h>

/* Lists the steps.  The rank that writes also checks the output. */
static int prepare_movie(const options *opts, shot_renderer *shots,
                         step_files *files, shot_list *list, movie **s) {
    int done = opts->operand_count
                   ? movie_check(opts)
                   : fail_usage("movie: no input given; give snowglass movie "
                                "INPUT... -o OUT");
    if (done == CONTINUE)
        done = steps_find(opts, files);
    done = process_agree(done);
    if (done == CONTINUE)
        done = shots_open(opts, shots);
    if (done != CONTINUE)
        return done;
    done = steps_list(files, shots, list);
    /* People who ask for a movie of one volume often mean a turntable. */
    if (done == CONTINUE && list->count == 1 && opts->verbosity >= 0)
        say("note: this is one time step, so the movie is a still; for a movie "
            "around the volume use turntable, for a picture render");
    if (done == CONTINUE && process_talks())
        done = movie_open(opts, list, s);
    done = process_agree(done);
    if (done != CONTINUE)
        return done;
    /* ranks learn how many steps the look is chosen from */
    const int looked = process_share((int)list->looked);
    if (looked < list->looked)
        list->looked = looked;
    return CONTINUE;
}

/* Chooses the transfer function, then makes the frames. */
static int run_movie(const options *opts, shot_renderer *shots,
                     step_files *files, shot_list *list, movie **s,
                     double begin) {
    int done = prepare_movie(opts, shots, files, list, s);
    if (done == CONTINUE)
        done = steps_look(list, shots);
    if (done != CONTINUE)
        return done;
    shots->count = list->count;
    return movie_run(*s, opts, list, shots, begin);
}

int cmd_movie(const options *opts) {
    double begin = seconds_now();
    shot_renderer shots = {.count = 0};
    step_files files = {.paths = NULL};
    shot_list list = {.shots = NULL};
    movie *s = NULL;
    int done = run_movie(opts, &shots, &files, &list, &s, begin);
    progress(opts, NULL);
    movie_close(s);
    shots_close(&shots);
    free(list.shots);
    steps_free(&files);
    return done;
}
