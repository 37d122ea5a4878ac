/* snowglass/insitu.h - pictures of a simulation while it runs (docs/insitu.md).
 *
 * Setters are local, and hold until they are called again. If one fails, so
 * does the next collective call, on all ranks. Collective calls return one
 * status on all ranks; only they read voxels. After an error the next step may
 * be tried. */
#ifndef SNOWGLASS_INSITU_H
#define SNOWGLASS_INSITU_H

#include <snowglass/ranks.h>

typedef struct snow_insitu snow_insitu;

/* Collective. Makes the pictures of one field, over the caller's communicator,
 * which is freed after them. */
SNOW_API snow_status snow_insitu_new(snow_comm *comm, snow_insitu **out);

/* Frees them; collective where freeing the communicator is. */
SNOW_API void snow_insitu_free(snow_insitu *insitu);

/* Returns the communicator. */
SNOW_API snow_comm *snow_insitu_comm(const snow_insitu *insitu);

/* Makes snow_insitu_free free the communicator, too, and its context. */
SNOW_API void snow_insitu_own_comm(snow_insitu *insitu, bool with_context);

/* Returns the message of the last call that failed, or "". */
SNOW_API const char *snow_insitu_message(const snow_insitu *insitu);

/* Takes a failure of the caller's as that of a setter, with the message of the
 * context: the next collective call fails. */
SNOW_API snow_status snow_insitu_set_error(
    snow_insitu *insitu, snow_status status);

/* Sets the status of a recipe: collective calls fail until it is OK. */
SNOW_API snow_status snow_insitu_set_recipe_status(
    snow_insitu *insitu, snow_status status);

/* What all ranks call before they take voxels; its failure is a warning. */
typedef snow_status snow_refresh_fn(snow_insitu *insitu, void *user);

/* Sets that function, or NULL. At the end it is called with `insitu` NULL. */
SNOW_API void snow_insitu_set_refresh(
    snow_insitu *insitu, snow_refresh_fn *refresh, void *user);

/* Sets who receives warnings on rank 0: pictures left out or lowered, and
 * why. */
SNOW_API void snow_insitu_set_warning(
    snow_insitu *insitu, snow_warning_fn *warning, void *user);

/* Sets the global grid, alike on all ranks: voxels along x, y, z, the place of
 * voxel 0 in the world (NULL: 0), and the distance of neighbours (NULL: 1). All
 * bricks are forgotten. */
SNOW_API snow_status snow_insitu_set_grid(snow_insitu *insitu,
    const int64_t dims[3], const double origin[3], const double spacing[3]);

/* Neighbours' voxels around a brick in memory, on both sides of each axis. */
typedef struct snow_halo {
    int64_t low[3], high[3];
} snow_halo;

/* Sets brick `id` (from 0) of this rank; a count of 0 removes it. The bricks of
 * all ranks make up the grid. `halo` (or NULL) must be up to date when voxels
 * are read. */
SNOW_API snow_status snow_insitu_set_brick(snow_insitu *insitu, int id,
    const int64_t first[3], const int64_t count[3], const snow_halo *halo);

/* Sets the voxels of a brick, which are read in collective calls only. `voxels`
 * is the first one behind the halo; strides are in values (NULL: x fastest,
 * with the halo). All bricks have one type. */
SNOW_API snow_status snow_insitu_set_voxels(snow_insitu *insitu, int id,
    snow_type type, const void *voxels, const int64_t stride[3]);

/* Sets how many voxels wide a brick's cells, which are floats, are along each
 * axis. Finer bricks cover coarser ones. */
SNOW_API snow_status snow_insitu_set_cells(
    snow_insitu *insitu, int id, const int64_t cells[3]);

/* A brick by its place in the world. */
typedef struct snow_world_brick {
    double origin[3]; /* of its first voxel, behind the halo */
    int64_t count[3]; /* voxels; 0: none */
    snow_halo halo;
} snow_world_brick;

/* Collective. Sets the grid that the bricks of all ranks span, and bricks 0 to
 * count - 1 of this rank. Of voxels that two bricks share the higher one owns
 * them. Errors: BAD_USAGE (the bricks lie on no grid). */
SNOW_API snow_status snow_insitu_place_bricks(snow_insitu *insitu,
    const snow_world_brick *bricks, int count, const double spacing[3]);

/* Where ghost voxels come from. */
typedef enum snow_ghosts {
    SNOW_GHOSTS_AUTO = 0, /* the bricks' halos, else from their owners */
    SNOW_GHOSTS_NONE      /* outermost voxels are repeated: faint seams */
} snow_ghosts;

/* Where the work is done. */
typedef enum snow_balance {
    SNOW_BALANCE_IN_PLACE = 0, /* where the voxels are, if the method can */
    SNOW_BALANCE_REPARTITION   /* voxels move to ranks with equal parts */
} snow_balance;

typedef struct snow_insitu_work {
    size_t size;
    snow_ghosts ghosts;
    snow_balance balance;
} snow_insitu_work;
SNOW_RECORD(snow_insitu_work);

/* What pictures may cost (docs/insitu.md, Cost); 0: no limit. */
typedef struct snow_insitu_limits {
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

/* Sets all that is not NULL in `settings`. */
SNOW_API snow_status snow_insitu_set(
    snow_insitu *insitu, const snow_insitu_settings *settings);

/* Collective. Checks that rank 0 can write to a path (NULL: the output that was
 * set). Errors: BAD_OUTPUT. */
SNOW_API snow_status snow_insitu_try_output(
    snow_insitu *insitu, const char *output);

/* Sets the time of the next step, which annotations may show. */
SNOW_API snow_status snow_insitu_set_time(
    snow_insitu *insitu, double time, const char *unit);

/* Collective. Takes the voxels. Afterwards they may change, if they were copied
 * (snow_insitu_stats.ranks_copied). */
SNOW_API snow_status snow_insitu_update(snow_insitu *insitu);

/* Collective. Renders the voxels last taken. *image is on rank 0, or of each
 * rank's part where pictures are scattered; NULL on others, and on all where
 * limits left it out. */
SNOW_API snow_status snow_insitu_render(
    snow_insitu *insitu, snow_image **image);

/* Collective. Takes voxels, renders, and writes on rank 0; means and sums
 * become colours. */
SNOW_API snow_status snow_insitu_step(snow_insitu *insitu, int64_t step);

/* A figure over the ranks. */
typedef struct snow_spread {
    double least, mean, most;
} snow_spread;

/* How a picture was lowered to keep a limit. */
typedef enum snow_degradation {
    SNOW_DEGRADATION_NONE = 0,
    SNOW_DEGRADATION_DRAFT,   /* draft quality */
    SNOW_DEGRADATION_HALF,    /* and half the width and height */
    SNOW_DEGRADATION_QUARTER, /* and a quarter */
    SNOW_DEGRADATION_SKIPPED  /* left out */
} snow_degradation;

/* Figures of the last picture, and of all so far. */
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

/* Collective. Fills *out with these figures. */
SNOW_API snow_status snow_insitu_get_stats(
    snow_insitu *insitu, snow_insitu_stats *out);

#endif
