/* drawing.h - makes pictures of a recipe by the very functions of
 * `snowglass render`, so that the command of a recipe makes the same bytes.
 *
 * Of the volume, the look and the view only that is made anew which a recipe
 * changes.  All ranks call what is marked so, the others because the first does
 * (ranks.h). */
#ifndef DRAWING_H
#define DRAWING_H

#include "draw/identity.h"
#include "picture/render_state.h"

#include <jansson.h>

typedef struct kept_slice {
    snow_volume *volumes[SNOW_CHANNELS_MAX]; /* of each channel; or NULL */
    int64_t index, half;                     /* with so many on either side */
} kept_slice;

typedef struct kept_channel {
    snow_volume *volume; /* or NULL */
    int64_t index;
} kept_channel;

/* The values of the volume, which are counted once, and once more in each part
 * of their range that a page looks at (values.h); pages take turns. */
#define VALUES_BINS 256
#define VALUES_PARTS 32
typedef struct kept_counts {
    double low, high;
    int64_t done;  /* voxels that are counted from low to high; 0: none */
    uint64_t used; /* which of the uses was the last one */
    uint64_t counts[VALUES_BINS];
} kept_counts;

typedef struct kept_values {
    bool measured;                      /* the ends are known */
    double ends[2];                     /* of all of them */
    kept_counts kept[1 + VALUES_PARTS]; /* all values; parts of the range */
    uint64_t uses;
} kept_values;

typedef struct shown_channels {
    int64_t index[SNOW_CHANNELS_MAX];
    int count;
} shown_channels;

typedef struct drawing drawing;

/* Makes the picture of a drawing's state. */
typedef int draw_fn(drawing *d, snow_image **image);

struct drawing {
    options first; /* as of the command line */
    options opts;  /* of the present recipe */
    json_t *tree;
    render_state state;
    char identity[IDENTITY_BYTES]; /* of the file that was opened */
    char *data_key, *look_key;     /* what volume and look were made of */
    char *color_key;      /* and the look's colours, while points move */
    char *spread_key;     /* all but its range, while that moves */
    bool look_is_quick;   /* its colours are those of the look before */
    shown_channels shown; /* the numbers of what is drawn (mixed.h) */
    kept_channel away[SNOW_CHANNELS_MAX]; /* what was switched off */
    snow_volume *base[SNOW_CHANNELS_MAX]; /* each without clip planes, while
                                             these move; or NULL */
    char *base_key;                       /* what they were made of */
    char *plain_key; /* the same of the volume that is shown, where it has no
                        clip planes */
    kept_values values;
    bool volume_is_new, look_is_new; /* since the caller last looked */
    bool waits; /* nothing is open yet: a page chooses a volume of a folder */
    int opened; /* how many were chosen so */
    bool live;  /* a simulation draws it: nothing but grid and look is known */
    snow_transfer *slice_look;            /* of the last slice (slices.h) */
    channel_set slice_channels;           /* and of its channels */
    char *slice_key;                      /* what they were made of */
    char *overlay_key, *overlay_look_key; /* of the overlay: file; look */
    layers slice_layers;                  /* the overlay where slices lie */
    kept_slice kept[3]; /* the last slice across each axis of the grid, of a
                           volume that is not here */
    uint32_t followed;  /* the state that the last answer was made for */
    int followed_done;  /* and what came of it */
    char *measure_key;  /* what the measures are of */
    json_t *times;      /* texts of the file's steps (movies/times.h) */
    bool times_are_known;
    json_t *offer;   /* the movies that pages can order; NULL: none */
    char *share_key; /* what the share is of (share.h) */
    double share;
    draw_fn *draw;          /* instead of render_state_draw; or NULL */
    double earlier_seconds; /* that pieces of the last picture took before */
};

/* By all ranks.  Opens the volume of the command line.  Returns CONTINUE or an
 * exit code, as all functions here do. */
int drawing_open(const options *first, json_t *recipe, drawing *out);
void drawing_close(drawing *d);

/* Not for many ranks.  A drawing of nothing yet; then of a volume in the place
 * of what was open, which drawing_empty has freed.  Options, and what they
 * name, stay the caller's while it is drawn. */
int drawing_wait(const options *first, drawing *out);
int drawing_switch(drawing *d, const options *first, const json_t *recipe);

/* By all ranks.  Makes what a recipe needs, whose tree stays the caller's. */
int drawing_apply(drawing *d, const json_t *recipe);

/* Gives options of a recipe what the command line's overlay has, or nothing of
 * it where it is switched off. */
void drawing_settle_overlay(const drawing *d, options *opts);

/* Whether clip planes cut the volume. */
bool drawing_is_clipped(const drawing *d);

/* The volume, or its n-th channel, as it is without clip planes; as it is with
 * them, where that cannot be had.  Not for many ranks, which have parts. */
snow_volume *drawing_unclipped(drawing *d, int n);

/* Frees all that states before left, where the memory is short; drawing_apply
 * follows.  Not for many ranks. */
void drawing_empty(drawing *d);

/* The options of the present recipe, as a command of render needs them. */
void drawing_options(const drawing *d, options *out);

/* Options as recipes have them: which channels are meant.  A list replaces the
 * file of --tf, and gives way to its first one where it cannot be mixed. */
int drawing_settle_channels(options *opts);

/* By all ranks.  Frames what the look shows, from the sides of a turn: keys
 * that set the camera's target and zoom, a new reference. */
json_t *drawing_fit(drawing *d);

/* By all ranks.  Makes the look of the present recipe anew. */
int drawing_restyle(drawing *d);

/* --- pictures.c ---
 *
 * By all ranks.  Renders with a quality at a size of 1 / 2^shrink of the
 * recipe's, unless `stop` says so: SNOW_STATUS_STOPPED.  With values painted.
 * The picture is NULL on all ranks but the first. */
int drawing_render(drawing *d, snow_quality quality, int shrink,
                   snow_stop_fn *stop, void *user, snow_image **image,
                   snow_overlay **overlay);

/* What --measure asks for, anew where its words or the volume change; what
 * cannot be measured in this volume is said, and the picture has none. */
void drawing_measure(drawing *d);

/* The transfer function of a look for the volume, or its parts. */
snow_status drawing_new_transfer(drawing *d, const snow_look *look,
                                 snow_transfer **out);

/* "head.png" for /data/head.nii.gz and phantom:head; of a slice
 * "head-axial.png". */
void drawing_name_output(const char *input, const char *slice, char out[100]);

/* The middle of the volume, and from there to its farthest corner: what zoom 1
 * shows (snowglass/view.h). */
void drawing_middle(const drawing *d, double middle[3], double *radius);

/* The command that makes the picture at rest, to be freed. */
char *drawing_command(const drawing *d);

/* That of options, whose output is named, by a verb. */
char *drawing_command_of(const options *opts, unsigned verb);

#endif
