/* snowglass/insitu.h - pictures of a simulation while it runs.
 *
 * Every rank tells which boxes of the global grid it holds and where their
 * voxels lie in memory; then each step is one collective call:
 *
 *   snow_insitu_new(comm, &movie);                     once
 *   snow_insitu_set_grid(movie, dims, NULL, NULL);
 *   snow_insitu_set_brick(movie, 0, first, count, NULL);
 *   snow_insitu_set_voxels(movie, 0, SNOW_TYPE_FLOAT64, u, NULL);
 *   snow_insitu_set_output(movie, "u_%04d.png", NULL);
 *   ...
 *   snow_insitu_step(movie, step);                     as often as wished
 *   ...
 *   snow_insitu_free(movie);
 *
 * Voxels are read only inside of collective calls.  What a setter is told
 * holds until it is told otherwise.  The picture is the one of the whole grid,
 * however it is cut into bricks and dealt to ranks.
 *
 * Errors.  Setters are local.  One that fails says so, and the next collective
 * call fails on all ranks with its message: a caller may look at those alone.
 * A collective call answers the same on all ranks.  No error ends the process,
 * and after any but a broken communicator the next step may be tried. */
#ifndef SNOWGLASS_INSITU_H
#define SNOWGLASS_INSITU_H

#include <snowglass/ranks.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct snow_insitu snow_insitu;

/* Collective.  A movie (or a single picture) of one field.  `comm` stays the
 * caller's and is freed after it; for MPI and Fortran communicators see
 * snowglass/mpi.h.  Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_insitu_new(snow_comm *comm, snow_insitu **out);

/* Hands the communicator over, and its context with it or not: they are freed
 * when it is. */
SNOW_API void snow_insitu_own_comm(snow_insitu *insitu, bool with_context);

/* Collective where the communicator's own free is.  NULL is accepted. */
SNOW_API void snow_insitu_free(snow_insitu *insitu);

/* The message of the last call that failed; "" before any. */
SNOW_API const char *snow_insitu_message(const snow_insitu *insitu);

/* A failure of the caller's own on this rank, as if a setter's: the next
 * collective call fails on all ranks with the message that the context has.
 * SNOW_STATUS_OK is none.  Returns the status. */
SNOW_API snow_status snow_insitu_set_error(snow_insitu *insitu,
                                           snow_status status);

/* The communicator that it was made over. */
SNOW_API snow_comm *snow_insitu_comm(const snow_insitu *insitu);

/* Who hears remarks (pictures left out or made smaller, and why): one line of
 * text, on rank 0. */
SNOW_API void snow_insitu_set_warning(snow_insitu *insitu,
                                      snow_warning_fn *notice, void *user);

/* --- the data ------------------------------------------------------------- */

/* The global grid: voxels along x, y, z, the world place of voxel (0, 0, 0) and
 * the world distance of neighbours.  NULL origin: 0, 0, 0; NULL spacing: 1, 1,
 * 1.  The same on all ranks.  Forgets all bricks.  Errors:
 * SNOW_STATUS_BAD_USAGE. */
SNOW_API snow_status snow_insitu_set_grid(snow_insitu *insitu,
                                          const int64_t dims[3],
                                          const double origin[3],
                                          const double spacing[3]);

/* Ghost voxels of a neighbour that lie around a brick in memory, on the low and
 * the high side of each axis. */
typedef struct snow_halo {
    int64_t low[3], high[3];
} snow_halo;

/* Brick `id` (from 0) of this rank answers for voxels first .. first + count -
 * 1 of the grid; a count of 0 takes it away.  Bricks of all ranks together are
 * the grid, without an overlap; a rank may have none.  `halo` tells what lies
 * around it besides, and is up to date whenever a picture is made; where it is
 * as wide as the picture asks for on all ranks nothing is exchanged.  NULL: no
 * halo.  Parts of it beyond the grid are left alone.  Forgets the brick's
 * voxels.  Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_insitu_set_brick(snow_insitu *insitu, int id,
                                           const int64_t first[3],
                                           const int64_t count[3],
                                           const snow_halo *halo);

/* Where a brick's voxels lie: `voxels` is the address of voxel `first`, that is
 * behind the halo, and voxel first + (i, j, k) lies i * stride[0] + j *
 * stride[1] + k * stride[2] values from it.  NULL: x fastest, without gaps,
 * halo included.  Any strides will do: arrays of C and of Fortran, padding,
 * one component of several.  One type for all bricks of all ranks.  Nothing is
 * read before the next collective call.  Errors: SNOW_STATUS_BAD_USAGE. */
SNOW_API snow_status snow_insitu_set_voxels(snow_insitu *insitu, int id,
                                            snow_type type, const void *voxels,
                                            const int64_t stride[3]);

/* A brick that is known by its place in the world. */
typedef struct snow_world_brick {
    double origin[3]; /* of its first voxel, behind the halo */
    int64_t count[3]; /* voxels; 0: none */
    snow_halo halo;
} snow_world_brick;

/* Collective.  Grid and bricks in one, for those who do not know the grid: it
 * is what the bricks of all ranks span together.  This rank's get the numbers 0
 * .. count - 1.  Where bricks share the voxels of their borders, as meshes do
 * that have values at the corners of cells, the higher one keeps them, and they
 * are the other's halo.  Grid and bricks that are as they were need not be
 * planned anew.  Errors: SNOW_STATUS_BAD_USAGE (spacings that differ, a brick
 * between the voxels of the others), SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_insitu_place_bricks(snow_insitu *insitu,
                                              const snow_world_brick *bricks,
                                              int count,
                                              const double spacing[3]);

/* Where ghost voxels come from. */
typedef enum snow_ghosts {
    SNOW_GHOSTS_AUTO = 0, /* the bricks' halos, else from their owners */
    SNOW_GHOSTS_NONE      /* from nowhere: each rank repeats its outermost
                             voxels; no message, and faint seams where parts
                             meet */
} snow_ghosts;

/* Where the work is done. */
typedef enum snow_balance {
    SNOW_BALANCE_IN_PLACE = 0, /* where the voxels are, as long as each rank's
                                  bricks are one box together and the method
                                  draws any cut; else as RECUT */
    SNOW_BALANCE_REPARTITION   /* all voxels go to ranks with equal parts */
} snow_balance;

SNOW_API snow_status snow_insitu_set_distribution(snow_insitu *insitu,
                                                  snow_ghosts ghosts,
                                                  snow_balance balance);

/* --- the picture, the same on all ranks ----------------------------------- */

/* The look (copied): transfer function and colours; zeros choose it from the
 * values.  What it takes from the values it takes from those of the next
 * picture, once: the colours of a movie do not change their meaning from frame
 * to frame.  Setting it again, also to the same, chooses anew.  Errors:
 * SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_insitu_set_look(snow_insitu *insitu,
                                          const snow_look *look);

/* The camera and the size of the picture (the default view of a volume unless
 * told), and what it is made with. */
SNOW_API snow_status snow_insitu_set_view(snow_insitu *insitu,
                                          const snow_view *view);
SNOW_API snow_status snow_insitu_set_settings(snow_insitu *insitu,
                                              const snow_settings *settings);
SNOW_API snow_status snow_insitu_set_ranks(snow_insitu *insitu,
                                           const snow_ranks_options *how);

/* Where snow_insitu_step writes: a path with one %d (or %04d) in place of the
 * step's number.  Files of an earlier run are kept, and an error, unless
 * options->overwrite.  Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_insitu_set_output(snow_insitu *insitu,
                                            const char *pattern,
                                            const snow_image_options *options);

/* What snow_insitu_step draws over its pictures (snowglass/overlay.h): colour
 * bar and scale bar, and the number of the step (nothing, unless told).  Files
 * of floats have none. */
SNOW_API snow_status snow_insitu_set_annotations(snow_insitu *insitu,
                                                 bool legend, bool step);

/* What pictures may cost; 0: whatever they do.
 *
 * `seconds`: for each step, on the mean.  What the last pictures took decides:
 * over it the next ones are made in draft quality, then at half and at a
 * quarter of the size (and enlarged to the size that was asked for), and then
 * so many steps are left out that the mean is kept; under it they get better
 * again.  The first picture is made as asked.
 *
 * `bytes`: of the communicator's context on each rank, all that it holds
 * together, kept to while a collective call works.  Where it does not suffice
 * the picture is left out, all buffers are freed, and the next is tried a step
 * lower.
 *
 * The listener hears of every change. */
SNOW_API snow_status snow_insitu_set_limits(snow_insitu *insitu, double seconds,
                                            uint64_t bytes);

/* --- collective ----------------------------------------------------------- */

/* Takes the voxels as they are now.  They may change again when it returns,
 * unless this rank's lie in memory as the picture wants them and were not
 * copied: keep them until the last picture of them. */
SNOW_API snow_status snow_insitu_update(snow_insitu *insitu);

/* A picture of the voxels last taken: on rank 0, owned by the caller; NULL on
 * the others, and on all where the limits left it out.  Where the options of
 * snow_insitu_set_ranks say scattered, each rank's part of it, ungathered, on
 * all ranks.  Another picture of the
 * same voxels (another view, say) costs no exchange and no encoding. */
SNOW_API snow_status snow_insitu_render(snow_insitu *insitu,
                                        snow_image **image);

/* Update, draw, and write the picture on rank 0.  Means and sums (modes of
 * those names) become colours where the file holds colours: the look's, over
 * the values that it is spread over; for sums these must have been told. */
SNOW_API snow_status snow_insitu_step(snow_insitu *insitu, int64_t step);

/* The least, the mean and the most of a figure over the ranks. */
typedef struct snow_spread {
    double least, mean, most;
} snow_spread;

/* How far a picture was lowered to keep a limit. */
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
    snow_spread seconds_update; /* voxels copied and exchanged */
    snow_spread seconds_look;   /* transfer function chosen */
    snow_spread seconds_render; /* the local image: stages of snow_stats */
    snow_spread seconds_encode; /* of them, with classification and shading */
    snow_spread seconds_draw;   /* render and combine, until it lies on rank 0
                                 */
    snow_spread seconds_write;
    snow_spread seconds_step;  /* all of a step */
    snow_spread bytes_sent;    /* in that step */
    snow_spread bytes_held;    /* by the context, now */
    snow_spread bytes_peak;    /* the most that it ever held */
    snow_spread voxels;        /* stored for the picture, ghosts included */
    snow_spread interesting;   /* of them: the work */
    int64_t pictures;          /* made so far */
    int64_t skipped;           /* left out so far */
    int ranks_copied;          /* that copied voxels; the others shared them */
    bool exchanged;            /* voxels travelled */
    bool recut;                /* work was done where the voxels are not */
    snow_degradation lowering; /* of the last picture */
} snow_insitu_stats;
SNOW_RECORD(snow_insitu_stats);

/* Collective. */
SNOW_API snow_status snow_insitu_get_stats(snow_insitu *insitu,
                                           snow_insitu_stats *out);

#ifdef __cplusplus
}
#endif
#endif
