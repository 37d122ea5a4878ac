/* scene.h - a volume, its look and its camera, rendered by this process or by
 * all ranks together.  Calls are made by all ranks alike, and what one of them
 * answers, all do. */
#ifndef SCENE_H
#define SCENE_H

#include "memory.h"
#include "options.h"
#include "render_stats.h"

#include <snowglass/ranks.h>

/* What a picture is of. */
typedef struct scene_shot {
    const char *path;
    snow_volume_info whole; /* of the volume, of which ranks have parts */
} scene_shot;

typedef struct scene {
    const options *asked;
    const char *path; /* of the volume */
    bool each_time;   /* all time steps of the file are opened in turn */
    bool turns;       /* pictures from several sides are asked for */
    int64_t left;     /* then: how many are to come, the next one with them */
    memory_plan plan; /* for it, where this process is alone */
    bool in_slabs;    /* it did not fit beside its interesting voxels: this one
                         and all after it stay in their files */
    snow_context *context;
    snow_volume_info whole; /* of the volume, of which ranks have parts */
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    snow_view view;
    snow_settings settings;
    render_times times;  /* read and look; sums over all that was opened */
    scene_shot begun[2]; /* pictures under way, the oldest first */
    int under_way;
    int fault;        /* that was told, 0: none: what follows from it is not */
    snow_image *made; /* by this process alone, and not finished */
    /* Of the last picture; of ranks sums, and seconds of the slowest. */
    scene_shot drawn;
    snow_stats stats;
    uint64_t peak; /* bytes; of ranks the most that one had */
    double load;   /* most interesting voxels of a rank by their mean */
    void *figures; /* of all ranks */
} scene;

/* Refuses what ranks cannot do.  Answers GO_ON or an exit code. */
int scene_check(const options *asked);

/* Answers GO_ON or an exit code, as all do. */
int scene_new(const options *asked, scene *out);
void scene_free(scene *s);

/* What is asked for, of one time step. */
options scene_step(const scene *s, int64_t time);

/* Opens a time step of a volume in place of the present one, with the look that
 * is asked for, unless the scene has a transfer function already. */
int scene_open(scene *s, const char *path, int64_t time);

/* Renders from an azimuth.  *image is the caller's; NULL on ranks that do not
 * talk. */
int scene_draw(scene *s, double azimuth, snow_image **image);

/* The same in two halves; of ranks two pictures may be under way, and finish is
 * of the one that was begun first.  Between them another step may be opened. */
int scene_begin(scene *s, double azimuth);
int scene_finish(scene *s, snow_image **image);

/* Figures of the last picture, without image. */
render_report scene_report(const scene *s);

/* The one line that says what was chosen where nothing was told, but for its
 * end. */
void scene_choices(const scene *s, char *out, size_t size);

#endif
