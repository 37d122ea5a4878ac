/* snowglass/insitu.h - pictures of a simulation while it runs (docs/insitu.md).
 *
 * Setters are local and hold until called again. If one fails, so does the next
 * collective call, on all ranks. Collective calls return one status on all
 * ranks; only they read voxels. After an error the next step may be tried. */
#ifndef SNOWGLASS_INSITU_H
#define SNOWGLASS_INSITU_H

#include <snowglass/ranks.h>

typedef struct snow_insitu snow_insitu;
/* Collective. A movie of one field over the caller's communicator, freed after
 * it; freeing is collective where the communicator's is. */
SNOW_API snow_status snow_insitu_new(snow_comm *comm, snow_insitu **out);
SNOW_API void snow_insitu_free(snow_insitu *insitu);
/* Its communicator; makes it free that, and its context, when it is freed. */
SNOW_API snow_comm *snow_insitu_comm(const snow_insitu *insitu);
SNOW_API void snow_insitu_own_comm(snow_insitu *insitu, bool with_context);
/* The message of the last call that failed, or ""; a failure of the caller's,
 * as if a setter's, with the context's message. */
SNOW_API const char *snow_insitu_message(const snow_insitu *insitu);
SNOW_API snow_status snow_insitu_set_error(snow_insitu *, snow_status);
/* Of a recipe: collective calls fail until one is OK. What all ranks call
 * before they take voxels, with NULL at the end; its failure is a warning. */
SNOW_API snow_status snow_insitu_set_recipe_status(snow_insitu *, snow_status);
typedef snow_status snow_refresh_fn(snow_insitu *insitu, void *user);
SNOW_API void snow_insitu_set_refresh(snow_insitu *, snow_refresh_fn *, void *);
/* Receives warnings (pictures left out or lowered, and why), on rank 0. */
SNOW_API void snow_insitu_set_warning(snow_insitu *, snow_warning_fn *, void *);
/* Alike on all ranks: voxels of the global grid along x, y, z, world place of
 * voxel 0 (NULL: 0), distance of neighbours (NULL: 1). Forgets all bricks. */
SNOW_API snow_status snow_insitu_set_grid(snow_insitu *insitu,
    const int64_t dims[3], const double origin[3], const double spacing[3]);
/* Neighbours' voxels around a brick in memory, on both sides of each axis. */
typedef struct snow_halo {
    int64_t low[3], high[3];
} snow_halo;
/* Brick `id` (from 0) of this rank; a count of 0 removes it. Bricks of all
 * ranks make up the grid. `halo` (or NULL) is up to date when it is read. */
SNOW_API snow_status snow_insitu_set_brick(snow_insitu *insitu, int id,
    const int64_t first[3], const int64_t count[3], const snow_halo *halo);
/* `voxels` points at the first one behind the halo; strides in values, NULL: x
 * fastest, halo included. One type for all bricks. */
SNOW_API snow_status snow_insitu_set_voxels(snow_insitu *insitu, int id,
    snow_type type, const void *voxels, const int64_t stride[3]);
/* A brick's cells, floats, are so many voxels wide; finer bricks cover them. */
SNOW_API snow_status snow_insitu_set_cells(
    snow_insitu *insitu, int id, const int64_t cells[3]);
typedef struct snow_world_brick { /* a brick by its place in the world */
    double origin[3];             /* of its first voxel, behind the halo */
    int64_t count[3];             /* voxels; 0: none */
    snow_halo halo;
} snow_world_brick;
/* Collective. Grid, spanned by the bricks of all ranks, and bricks 0 .. count -
 * 1; the higher owns voxels that two share. Errors: BAD_USAGE (no grid). */
SNOW_API snow_status snow_insitu_place_bricks(snow_insitu *insitu,
    const snow_world_brick *bricks, int count, const double spacing[3]);
typedef enum snow_ghosts { /* where ghost voxels come from */
    SNOW_GHOSTS_AUTO = 0,  /* the bricks' halos, else from their owners */
    SNOW_GHOSTS_NONE       /* outermost voxels are repeated: faint seams */
} snow_ghosts;
typedef enum snow_balance {    /* where the work is done */
    SNOW_BALANCE_IN_PLACE = 0, /* where the voxels are, if the method can */
    SNOW_BALANCE_REPARTITION   /* voxels move to ranks with equal parts */
} snow_balance;
typedef struct snow_insitu_work {
    size_t size;
    snow_ghosts ghosts;
    snow_balance balance;
} snow_insitu_work;
SNOW_RECORD(snow_insitu_work);
typedef struct snow_insitu_limits { /* docs/insitu.md, Cost; 0: none */
    size_t size;
    double seconds; /* of a step in the mean */
    uint64_t bytes; /* of each rank's context */
} snow_insitu_limits;
SNOW_RECORD(snow_insitu_limits);
/* What is drawn over pictures (snow_time_text, snow_overlay_box). */
typedef struct snow_insitu_annotations {
    size_t size;
    const char *title, *quantity, *unit; /* NULL: none */
    const char *time_format;      /* NULL: the usual; "": the step's number */
    bool legend, scale_bar, step; /* bars; the latter alone; time or number */
    bool outline, axes;           /* of the volume's box */
} snow_insitu_annotations;
SNOW_RECORD(snow_insitu_annotations);
/* All that holds for many steps, alike on all ranks, copied. What is NULL stays
 * as it was, at first the default. A look given fits the next picture. */
typedef struct snow_insitu_settings {
    size_t size;
    const char *output; /* where a step writes, with one %d (or %04d) */
    const snow_image_options *image; /* NULL: with output, the default */
    const snow_look *look;
    const snow_view *view;
    const snow_settings *picture;
    bool shaded; /* with picture: also where a look is best unshaded */
    size_t clip_count;
    const double *clip; /* planes of 4; cut voxels taken from now on */
    const snow_insitu_annotations *annotations;
    const snow_ranks_options *ranks;
    const snow_insitu_work *work;
    const snow_insitu_limits *limits;
    bool sync; /* with output or image: a step waits for the disk */
} snow_insitu_settings;
SNOW_RECORD(snow_insitu_settings);
SNOW_API snow_status snow_insitu_set(
    snow_insitu *insitu, const snow_insitu_settings *settings);
/* Collective. Whether rank 0 can write there (NULL: the output set). */
SNOW_API snow_status snow_insitu_try_output(snow_insitu *, const char *output);
/* The time of the next step, which annotations may have. */
SNOW_API snow_status snow_insitu_set_time(
    snow_insitu *insitu, double time, const char *unit);
/* Collective. Takes the voxels; then they may change, if they were copied. */
SNOW_API snow_status snow_insitu_update(snow_insitu *insitu);
/* Collective. A picture of the voxels last taken, on rank 0 (scattered: each
 * rank's part); NULL on others, and on all where limits left it out. */
SNOW_API snow_status snow_insitu_render(snow_insitu *, snow_image **image);
/* Collective. Updates, renders, writes on rank 0; means and sums as colours. */
SNOW_API snow_status snow_insitu_step(snow_insitu *insitu, int64_t step);
typedef struct snow_spread { /* over the ranks */
    double least, mean, most;
} snow_spread;
typedef enum snow_degradation { /* of a picture, to keep a limit */
    SNOW_DEGRADATION_NONE = 0,
    SNOW_DEGRADATION_DRAFT,   /* draft quality */
    SNOW_DEGRADATION_HALF,    /* and half the width and height */
    SNOW_DEGRADATION_QUARTER, /* and a quarter */
    SNOW_DEGRADATION_SKIPPED  /* left out */
} snow_degradation;
/* Figures of the last picture, and of all so far; collective. */
typedef struct snow_insitu_stats {
    size_t size;
    snow_spread seconds_update, seconds_look;   /* voxels; transfer function */
    snow_spread seconds_render, seconds_encode; /* local image; encoding */
    snow_spread seconds_draw; /* until the picture lies on rank 0 */
    snow_spread seconds_write, seconds_step; /* the latter all of a step */
    snow_spread bytes_sent;                  /* in that step */
    snow_spread bytes_held, bytes_peak;      /* by the context: now, the most */
    snow_spread voxels, interesting;         /* stored, with ghosts; the work */
    int64_t pictures, skipped;               /* made and left out so far */
    int ranks_copied;          /* that copied voxels; the others shared them */
    bool exchanged, recut;     /* voxels travelled; work was done elsewhere */
    snow_degradation lowering; /* of the last picture */
} snow_insitu_stats;
SNOW_RECORD(snow_insitu_stats);
SNOW_API snow_status snow_insitu_get_stats(snow_insitu *, snow_insitu_stats *);

#endif
