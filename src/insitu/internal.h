/* insitu/internal.h - the inside of snowglass/insitu.h, which these files
 * share:
 *
 *   insitu.c  view and settings          grid.c    the grid and its bricks
 *   look.c    the look                   place.c   bricks by their positions
 *   data.c    takes voxels, by way of    agree.c   what all ranks know
 *                                        layout.c  who draws what
 *                                        levels.c  cells that are wider, and
 *                                        needs.c   which are needed where,
 *                                        cells.c   how they go there,
 *                                        means.c   what is below
 *   draw.c    makes pictures of them     limits.c  with less and less work
 *   output.c  and writes them            enlarge.c at the size asked for
 *   counts.c  how often values occur */
#ifndef SNOW_INSITU_INTERNAL_H
#define SNOW_INSITU_INTERNAL_H

#include <snowglass/extend.h>
#include <snowglass/insitu.h>
#include <snowglass/snowglass.h>

#define SNOW_INSITU_MESSAGE 4608 /* of a path of PATH_BYTES, and text */
#define TEXT_BYTES 256
#define SNOW_INSITU_BINS 256

/* Leaves a function when a call in it fails. */
#define INSITU_TRY(call)                         \
    do {                                         \
        snow_status insitu_try_status = (call);  \
        if (insitu_try_status != SNOW_STATUS_OK) \
            return insitu_try_status;            \
    } while (0)

/* A brick of this rank as it was given; it has no type until its voxels are
 * given. */
typedef struct snow_insitu_brick {
    snow_box box; /* empty: there is none of this number */
    snow_halo halo;
    int64_t cells[3]; /* voxels of one of its cells */
    snow_type type;
    const void *voxels;
    int64_t stride[3];
} snow_insitu_brick;

/* A look with its texts and points, which live as long as it. */
typedef struct snow_own_look {
    snow_look look, base;
    void *blocks[2]; /* points and texts of both */
} snow_own_look;

/* Of the last picture. */
typedef struct snow_insitu_seconds {
    double update, look, render, encode, draw, write, step;
} snow_insitu_seconds;

/* What all ranks know of a brick where cells are wider than voxels. */
typedef struct snow_level_brick {
    snow_box box; /* of voxels; empty: there is none */
    int64_t cells[3];
    int level;         /* of its cells; 0: the widest */
    int64_t pieces[2]; /* that finer ones leave of it: the first, and behind the
                          last */
} snow_level_brick;

/* Cells that a rank needs: a brick's, or of a level below, whose values are the
 * means of these. */
typedef struct snow_level_block {
    const snow_level_brick *brick;
    int level;
    snow_box cells;
} snow_level_block;

typedef struct snow_level_blocks {
    snow_level_block *blocks;
    int count;
    int64_t value_count; /* of all, where a mean counts as a double */
    char *values;        /* theirs, one block after another */
} snow_level_blocks;

#define SNOW_LEVELS_MOST 32

typedef struct snow_insitu_levels {
    int64_t sizes[SNOW_LEVELS_MOST][3]; /* of the cells of each, in voxels */
    int finest;                         /* that of the voxels */
    snow_level_brick *bricks;           /* of all ranks, `most` of each */
    int64_t most, count;
    snow_box *pieces;
    int64_t piece_count;
    snow_level_blocks sent, received;
    snow_box *places; /* of sent blocks among the cells of all messages */
    snow_brick *moved;
} snow_insitu_levels;

/* How the voxels of a picture are held; `planned` and `exchanged` are the same
 * on all ranks. */
typedef struct snow_insitu_layout {
    bool planned, exchanged, recut;
    bool uneven;               /* some cells are wider than voxels */
    snow_degradation lowering; /* that pictures of these voxels are made with */
    int64_t layers[3];         /* ghost voxels around the owned box */
    snow_box owned;            /* what this rank draws; may be empty */
    snow_box stored; /* with its ghosts; of one voxel where owned is empty */
    int recut_axis;  /* of slabs, -1: bricks */
} snow_insitu_layout;

struct snow_insitu {
    snow_comm *comm;
    snow_context *context;
    bool owns_comm, owns_context;
    snow_warning_fn *warning;
    void *warning_user;
    char message[SNOW_INSITU_MESSAGE];
    snow_status given;  /* of the first setter that failed since the last
                          collective call; message is its */
    snow_status recipe; /* of the last recipe, and its message */
    char recipe_message[SNOW_INSITU_MESSAGE];
    snow_refresh_fn *refresh; /* before voxels are taken; NULL: none */
    void *refresh_user;

    /* As given by the setters. */
    snow_volume_info whole; /* dims 0 until there is a grid */
    snow_insitu_brick *bricks;
    int brick_count;
    snow_ghosts ghosts;
    snow_balance balance;
    snow_own_look look;
    snow_view view;
    bool has_view;
    double strip; /* of the pictures, for their legend; 0: not known yet */
    snow_settings settings;
    bool shaded; /* as they say, whatever the look */
    double clips[SNOW_CLIPS_MAX][4];
    int64_t clip_count;
    snow_ranks_options how;
    char *pattern; /* NULL: no output */
    snow_image_options form;
    snow_insitu_annotations annotations;
    snow_volume_info says; /* quantity, unit, time: all else is `whole` */
    char title[TEXT_BYTES], time_format[TEXT_BYTES]; /* of these */
    double limit_seconds;
    uint64_t limit_bytes, outer_bytes; /* the latter the context's own */

    /* The voxels taken last. */
    snow_insitu_layout layout;
    bool changed; /* bricks or sharing, since they were planned with */
    snow_type type;
    snow_voxels *voxels;
    snow_box *boxes;  /* every rank's bricks united, where they are boxes */
    bool boxes_known; /* these are there, of the bricks as they are */
    snow_box *held;   /* the bricks' boxes, and the bricks, in one order */
    snow_brick *moved;
    int held_count;
    snow_insitu_levels levels;
    char *dense;
    bool copied;
    snow_volume *volume; /* NULL: none yet */
    int64_t pitch[2];    /* values from one of its rows, and slices, to the next
                          */
    bool taken;          /* an update has succeeded */

    /* Pictures of them. */
    snow_frame *frame;
    snow_transfer *transfer; /* NULL: to be chosen */
    double seen[2];          /* the values that it was chosen from; NaN: none */
    double ends[2];          /* of the values, where a recipe is read again */
    bool knows_ends;         /* those of this step's, from choosing the look */
    int64_t counts[SNOW_INSITU_BINS]; /* and how often they occur between, */
    bool counted;                     /* where that is known */

    /* The limits: the same on all ranks. */
    snow_degradation lowering;
    int64_t to_skip;                       /* pictures still to be left out */
    bool left_out;                         /* the last update was */
    double cost[SNOW_DEGRADATION_SKIPPED]; /* seconds when last drawn so */

    /* Figures. */
    snow_insitu_seconds seconds;
    uint64_t sent_before; /* bytes, before the step */
    int64_t pictures, skipped;
    double ended;           /* the last step did, by the communicator's clock */
    double between, within; /* seconds of all: of the simulation, of steps */
    snow_degradation last_lowering;
};

/* Parts of snow_insitu_set. */
snow_status snow_insitu_keep_look(snow_insitu *insitu, const snow_look *given);
snow_status snow_insitu_keep_output(snow_insitu *insitu,
                                    const snow_insitu_settings *given);

/* For setters, beside snow_insitu_set_error: SNOW_STATUS_BAD_USAGE with that
 * message. */
snow_status snow_insitu_refuse(snow_insitu *insitu, const char *format, ...)
    SNOW_PRINTF(2, 3);

/* For setters: reads a record of the caller. */
#define INSITU_READ(insitu, type, given, copy) \
    snow_insitu_set_error(                     \
        insitu, SNOW_RECORD_READ((insitu)->context, type, given, copy))

/* Frees what a look holds (look.c). */
void snow_insitu_free_look(snow_context *context, snow_own_look *look);

/* A warning, on rank 0. */
void snow_insitu_report(snow_insitu *insitu, const char *format, ...)
    SNOW_PRINTF(2, 3);

/* Collective: whatever setters found wrong on any rank.  To be called before
 * all else in a collective call. */
snow_status snow_insitu_begin(snow_insitu *insitu);

/* Collective: whatever is to be done before voxels are taken. */
void snow_insitu_refresh(snow_insitu *insitu);

/* Ends a collective call: keeps its message. */
snow_status snow_insitu_end(snow_insitu *insitu, snow_status status);

/* Frees what pictures need, to be made again when there is more memory. */
void snow_insitu_forget(snow_insitu *insitu);

/* The view of the picture: as given, or the default one. */
snow_view snow_insitu_view(const snow_insitu *insitu);

/* Leaves a strip of the pictures to the legend, once the look is known. */
snow_status snow_insitu_leave_strip(snow_insitu *insitu);

/* View and settings of pictures of the voxels last taken, lowered for limits
 * (limits.c). */
void snow_insitu_lowered(const snow_insitu *insitu, snow_view *view,
                         snow_settings *settings);

/* Collective: the voxels, as they are now, become the ranks' parts of a volume
 * (data.c). */
snow_status snow_insitu_take(snow_insitu *insitu);

/* Collective: refuses a view, settings or limits that differ from rank to rank
 * (agree.c). */
snow_status snow_insitu_check(snow_insitu *insitu);

/* --- agree.c, layout.c, data.c ---

 * What ranks agree on before voxels are taken, by a minimum over all ranks. */
enum {
    SNOW_FACT_TYPE,       /* of the voxels; the greatest number where none */
    SNOW_FACT_TYPE_MOST,  /* minus the type; 0 where none */
    SNOW_FACT_PRINT,      /* of all that must be the same on all ranks */
    SNOW_FACT_PRINT_MOST, /* minus that */
    SNOW_FACT_UNCHANGED,  /* 1: what was planned still holds */
    SNOW_FACT_UNITED,     /* 1: the bricks are one box together, or none */
    SNOW_FACT_HALOS,      /* 1: halos are as wide as the layers */
    SNOW_FACT_BOXES,      /* 1: every rank's bricks united are known */
    SNOW_FACT_EVEN,       /* 1: cells are voxels everywhere */
    SNOW_INSITU_FACTS
};
/* Collective.  What is found here is the same everywhere, failures too. */
snow_status snow_insitu_share_facts(snow_insitu *insitu, const snow_view *view,
                                    const int64_t layers[3], bool united,
                                    int64_t facts[SNOW_INSITU_FACTS]);

/* Collective.  Looks whether the plan still holds, and makes a new one where it
 * does not. */
snow_status snow_insitu_lay_out(snow_insitu *insitu);

/* What a rank draws and, with its ghosts, stores of boxes that are cut anew. */
snow_box snow_insitu_recut_box(const snow_insitu *insitu,
                               const snow_insitu_layout *layout, int rank);

/* Whether all cells of this rank are voxels (levels.c). */
bool snow_insitu_is_even(const snow_insitu *insitu);

/* Collective.  Lists the bricks of all ranks, and their pieces; those of this
 * rank are what it holds. */
snow_status snow_insitu_cut_levels(snow_insitu *insitu);

/* What a rank needs of each level, for a box of voxels; `refined` is what has
 * to be made of the level below, a part of it (needs.c).  The cells of a size
 * that lie in a box of voxels. */
typedef struct snow_level_needs {
    snow_box cells[SNOW_LEVELS_MOST], refined[SNOW_LEVELS_MOST];
} snow_level_needs;
void snow_insitu_find_needs(const snow_insitu *insitu, const snow_box *wanted,
                            snow_level_needs *out);
snow_box snow_level_cells_in(const snow_box *voxels, const int64_t size[3]);

/* Collective.  Plans which cells go where; moves them, and refines what arrives
 * to the dense box (cells.c). */
snow_status snow_insitu_plan_cells(snow_insitu *insitu,
                                   const snow_insitu_layout *layout);
snow_status snow_insitu_move_cells(snow_insitu *insitu, size_t value);

/* A brick of this rank whose voxels are its cells (cells.c); the means of these
 * in the cells of a block, doubles (means.c). */
snow_brick snow_insitu_cells_of(const snow_insitu *insitu,
                                const snow_level_brick *brick);
snow_status snow_insitu_mean_cells(const snow_insitu *insitu,
                                   const snow_level_block *block, char *out);

/* --- boxes.c ---

 * A box with so many layers more on all sides, as far as the grid goes. */
snow_box snow_insitu_grow_box(const snow_box *box, const int64_t low[3],
                              const int64_t high[3], const int64_t dims[3]);

bool snow_insitu_box_holds(const snow_box *outer, const snow_box *inner);

/* --- grid.c: the record of a grid without sizes. */
snow_volume_info snow_insitu_empty_grid(void);

/* --- limits.c ---

 * Lowers or raises the quality by the seconds of the slowest rank, the same on
 * all. */
void snow_insitu_steer(snow_insitu *insitu, double seconds);

/* The picture of this step is left out. */
void snow_insitu_leave_out(snow_insitu *insitu);

/* The limit of bytes holds from the first to the second; the context's own
 * limit holds as well. Where it did not suffice there is no error, but a
 * picture that is left out. */
void snow_insitu_begin_limit(snow_insitu *insitu);
snow_status snow_insitu_end_limit(snow_insitu *insitu, snow_status status);

/* Collective.  The smallest and largest value of all ranks' parts (draw.c); how
 * often values between them occur in some rows, for `ends` and `counts` of the
 * file of a picture (counts.c), where a viewer may want them and there is
 * memory. */
snow_status snow_insitu_find_values(snow_insitu *insitu, double ends[2]);
snow_status snow_insitu_count(snow_insitu *insitu);

/* Replaces a picture by one of another size (enlarge.c). */
snow_status snow_insitu_enlarge(snow_insitu *insitu, snow_image **image,
                                int width, int height);

/* Collective.  Whether rank 0 can write that of a step, before it is drawn. */
snow_status snow_insitu_check_file(snow_insitu *insitu, int64_t step);

/* Collective.  Rank 0 writes its picture, all learn how it went (output.c). */
snow_status snow_insitu_write(snow_insitu *insitu, int64_t step,
                              const snow_image *image);

#endif
