/* slice.h - slices of a volume: one picture of one or of several, or a frame
 * for each of many.
 *
 * The header says where slices lie, and one alone is read as a crop, so that
 * its volume may be larger than memory.  Several are cut from the volume in
 * memory, or read one by one where that has no room for it. */
#ifndef SLICE_H
#define SLICE_H

#include "measure/measures.h"
#include "picture/channels.h"
#include "picture/layers.h"
#include "picture/render_stats.h"
#include "slice/slab.h"

typedef enum slice_kind {
    SLICE_ONE,
    SLICE_GRID,   /* many in one picture */
    SLICE_ORTHO,  /* axial, coronal and sagittal through a point */
    SLICE_FRAMES, /* a series of pictures, or a movie */
} slice_kind;

typedef struct slice_work {
    options opts; /* in a mode of its own, cropped where it is one slice */
    slice_kind kind;
    snow_context *context;
    const char *path;
    snow_volume_info whole; /* what the slices are counted in */
    int axis, world;        /* of the grid, and of the world beside it */
    int grid[2];            /* columns and rows of SLICE_GRID */
    double point[3];        /* of SLICE_ORTHO, in units of the axes */
    snow_slice_place *places;
    int64_t count;
    slab slabs[3]; /* across each axis of the grid */
    int64_t first; /* of SLICE_ONE: the slice that its volume begins with */
    int size[2];   /* of the picture, or of a frame */
    double strip;  /* of it, that is left to a legend */
    snow_volume *volume;  /* the slice, or all of them */
    bool in_file;         /* that has no room in memory: each is read alone */
    char *cut;            /* its voxels, if all came through a pipe */
    channel_set channels; /* of colours, the first of which it is */
    snow_transfer *transfer;
    layers layers; /* that lie over it */
    snow_image *image;
    measures *measures; /* or NULL */
    snow_settings settings;
    render_times times;
    double begin, frame;
} slice_work;

/* All that may fail returns CONTINUE or an exit code, after the error was
 * printed. */

/* What the options ask for, and whether they fit together. */
int slice_choose_kind(slice_work *w);

/* --- slice_find.c: which slices ------------------------------------------- */

const char *slice_axis_name(const slice_work *w);

/* The coordinate of a slice's middle along the axis of the world that it lies
 * across, and its unit. */
double slice_position(const slice_work *w, double index);
const char *slice_unit(const slice_work *w);

/* Finds the slices in `whole`; those of a grid that has no --at only when there
 * is a look (slice_spread). */
int slice_find(slice_work *w);
int slice_spread(slice_work *w);

/* Leaves a strip of a picture with a look to its legend. */
int slice_leave_strip(slice_work *w);

/* --- slice_read.c --------------------------------------------------------- */

/* Whether a picture has colours; files of numbers get the values. */
bool slice_has_colors(const slice_work *w);

/* Looks at the header and finds the slices; reads them, with what lies over
 * them, and makes the look; reads one of those that stay in their file. */
int slice_inspect(slice_work *w);
int slice_read(slice_work *w);
int slice_read_alone(const slice_work *w, int64_t part, slice_work *out);
void slice_close_alone(slice_work *w);
int slice_open_colors(slice_work *w);

/* What --measure asks for, in the volume that is read. */
int slice_measure(slice_work *w);

/* The look without its opacities, which a slice ignores. */
void slice_describe_colors(const slice_work *w, char *out, size_t size);

/* "; maximum of 5 slices", the most that a picture has, or "". */
void slice_describe_slab(const slice_work *w, char *out, size_t size);

/* --- slice_draw.c --------------------------------------------------------- */

/* One of the slices, or the picture of all. */
snow_status slice_draw_part(slice_work *w, int64_t part, snow_image **out);
snow_status slice_draw(slice_work *w);

/* The view whose size is the picture's, and whose scale is the slices'. */
snow_view slice_whole_view(const slice_work *w);

/* Letters, bars, titles and the numbers of a grid; NULL: none.  Letters stay at
 * the edges: a slice fills its picture. */
snow_status slice_make_overlay(slice_work *w, snow_overlay **out);

/* --- slice_frames.c ------------------------------------------------------- */

int slice_run_frames(slice_work *w);

#endif
