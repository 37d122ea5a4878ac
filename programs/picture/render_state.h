/* render_state.h - a volume, its look and its camera, rendered by this process
 * or by all ranks together.  All ranks make the same calls and get the same
 * results. */
#ifndef SCENE_H
#define SCENE_H

#include "measure/measures.h"
#include "options/options.h"
#include "picture/channels.h"
#include "picture/layers.h"
#include "picture/render_stats.h"
#include "run/memory.h"

#include <snowglass/ranks.h>

/* The settings of one picture. */
typedef struct render_state_shot {
    const char *path;
    snow_volume_info whole; /* the whole volume; ranks have parts */
    snow_image *made;       /* until it is finished; NULL: by the frame */
} render_state_shot;

/* What each rank reports to the others about a picture. */
typedef struct rank_figures {
    snow_stats stats;
    double combine, gather; /* seconds */
    uint64_t peak;
} rank_figures;

typedef struct render_state {
    const options *opts;
    const char *path; /* path of the volume */
    bool each_time;   /* all time steps of the file are opened in turn */
    bool turns;       /* pictures from several sides are requested */
    bool steps;       /* or of several time steps */
    bool one_look;    /* all pictures have the look of the first */
    bool framed;      /* the view below frames all pictures */
    memory_plan plan; /* the memory plan, if this process is alone */
    bool in_slabs; /* the volume did not fit beside its interesting voxels: this
                      one and all later ones stay in their files */
    snow_context *context;
    snow_volume_info whole;      /* the whole volume; ranks have parts */
    snow_volume *volume, *ready; /* that is drawn; first, opened already */
    snow_transfer *transfer;
    layers layers;        /* drawn with it */
    channel_set channels; /* of its file, the first of which it is */
    snow_frame *frame;
    uint64_t frames_dropped;  /* freed; where it rises, the frame is another */
    snow_view view, frame_of; /* the latter: as framed */
    double strip;             /* of all pictures: what the first one needs */
    snow_settings settings;
    render_times
        times; /* seconds for reading and look; sums over all volumes */
    render_state_shot begun[2]; /* pictures in flight, the oldest first */
    int in_flight;
    int fault;        /* the reported error, 0: none; errors that follow are not
                         reported */
    snow_image *made; /* of the picture that is begun */
    /* The last picture; for ranks sums, and seconds of the slowest. */
    render_state_shot drawn;
    snow_stats stats;
    double combine, gather; /* seconds of stages of several ranks */
    uint64_t peak;          /* bytes; for ranks the maximum */
    double load; /* most interesting voxels of a rank, divided by the mean */
    rank_figures *figures; /* of all ranks */
    measures *measures;    /* of the volume, on the rank that draws them */
} render_state;

/* Refuses options that ranks do not support.  Returns CONTINUE or an exit
 * code. */
int render_state_check(const options *opts);

/* Returns CONTINUE or an exit code, as all functions here do. */
int render_state_new(const options *opts, render_state *out);
void render_state_free(render_state *s);

/* The options with another time step. */
options render_state_step(const render_state *s, int64_t time);

/* Opens a time step of a volume in place of the present one, and makes the
 * requested look unless the state has a transfer function already. */
int render_state_open(render_state *s, const char *path, int64_t time);

/* Measures what is asked in the volume that is open; `everywhere` as in
 * measures_find. */
int render_state_measure(render_state *s, bool everywhere);

/* If a look was chosen automatically for a volume without surfaces, it is not
 * shaded, unless shading is requested, or a surface. */
void render_state_choose_shade(render_state *s);

/* The look that gives the background (paint.h); NULL: light that is added up.
 */
const snow_transfer *render_state_ground(const render_state *s);

/* Leaves a strip of the picture to the legend. */
void render_state_leave_strip(render_state *s);

/* What the zoom of a framed box is multiplied by, so that its edges and the
 * numbers of its axes are in the picture, clear of the lines of a title; 1
 * where neither is drawn. */
double render_state_margin(const options *opts);

/* Renders from an azimuth.  *image belongs to the caller; NULL on ranks that do
 * not print. */
int render_state_draw(render_state *s, double azimuth, snow_image **image);

/* The same in two halves.  Ranks may have two pictures in flight; finish
 * returns the one that was begun first.  Another step may be opened in
 * between. */
int render_state_begin(render_state *s, double azimuth);
int render_state_finish(render_state *s, snow_image **image);

/* The figures of the last picture, without an image. */
render_report render_state_report(const render_state *s);

/* Notes what was chosen, for a configuration and the printed command; the range
 * as in config_note. */
void render_state_note(const render_state *s, const double painted[2]);

/* Writes the line that reports the automatic choices, except its end. */
void render_state_choices(const render_state *s, char *out, size_t size);

/* --- between render_state.c and render_picture.c -------------------------- */

/* Whether a status is a lack of memory that another beginning may help: with
 * the volume in its file; with the first one of channels that nobody asked for,
 * unless pictures before show them all. */
bool render_state_may_start_over(const render_state *s, int status);
int render_state_start_over(render_state *s, int64_t time);
void render_state_drop_frame(render_state *s);

/* Whether projections of channels are added up. */
bool render_state_is_sum(const render_state *s);

/* How ranks share the volume and the picture. */
snow_ranks_options render_state_how(const render_state *s);

#endif
