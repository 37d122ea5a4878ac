/* sequence_render.h - the frames of a sequence, rendered by this process or by
 * all ranks (scene.h). */
#ifndef SEQUENCE_RENDER_H
#define SEQUENCE_RENDER_H

#include "paint.h"
#include "scene.h"
#include "sequence.h"

typedef struct shot_renderer {
    scene scene;
    int64_t count;         /* of frames, to be told */
    int64_t begun;         /* of those */
    int64_t time;          /* of the present volume */
    snow_volume_info grid; /* of the first volume */
    bool whole_files;      /* a file with several time steps is an error: it is
                              one of many, and nobody said which step */
    bool drawn;            /* a picture has been made, and choices told */
    paint_told painted;    /* what was made of values */
} shot_renderer;

/* Answers GO_ON or an exit code. */
int shots_open(const options *asked, shot_renderer *out);
void shots_close(shot_renderer *shots);

/* Whether a volume is one step, and on the grid of the first one that was asked
 * about.  Answers GO_ON or an exit code. */
int shots_check(shot_renderer *shots, const char *path,
                const snow_volume_info *info);

/* Makes a shot's volume the present one.  Answers GO_ON or an exit code. */
int shots_volume(shot_renderer *shots, const movie_shot *shot);

/* For sequence_run; valid as long as the renderer. */
sequence_renderer shots_renderer(shot_renderer *shots);

#endif
