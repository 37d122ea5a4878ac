/* splat/splat.h - reconstruction by splatting (R in figure 7, lines 8 to 12 of
 * figure 8, section 2): every voxel throws its footprint onto the sheet.
 *
 * A voxel's footprint is its kernel along u times its kernel along v, carried
 * to the image by the slice's map: a parallelogram.  Where the slice's axes
 * lie along the image's ("aligned" views) it is a rectangle, and the weights of
 * each column and each row of the slice are tabulated beforehand: at one voxel
 * per pixel that is the paper's K x K footprint table. */
#ifndef SNOW_SPLAT_H
#define SNOW_SPLAT_H

#include "encode/encode.h"
#include "splat/kernel.h"
#include "splat/taps.h"

/* The buffer of one slice for a band of the image: its rows top .. bottom - 1,
 * which is all of them on one thread.  Only the pixels from (x0, y0) up to
 * (x1, y1), not included, can differ from 0. */
typedef struct snow_sheet {
    int width, height, channels; /* of the image */
    int top, bottom;
    float *pixels;   /* from row `top` on */
    size_t capacity; /* of pixels, bytes */
    int x0, y0, x1, y1;
} snow_sheet;

/* One axis of the grid in an oblique view. */
typedef struct snow_oblique_axis {
    double step, rise; /* grid units per pixel to the right, downwards */
    double lean;       /* middle of the footprint, pixels per row down */
    double extent;     /* half its width on a row, pixels; perhaps infinite */
} snow_oblique_axis;

typedef struct snow_splatter snow_splatter;

/* The loop over one row's voxels that a view needs. */
typedef void snow_splat_row_fn(const snow_splatter *splatter, snow_sheet *sheet,
                               int64_t row, const snow_span *spans,
                               size_t count, const float *samples);

/* All that the footprints of one view need. */
struct snow_splatter {
    const snow_placement *placement;
    snow_taper along_u, along_v;
    snow_splat_row_fn *splat_row;
    double origin[2]; /* pixel position of voxel (0, 0) of the slice */
    double reach[2];  /* half the footprint's bounding box, pixels */
    bool aligned;
    bool transposed;          /* aligned views: u lies along the image's y */
    snow_taps taps_u, taps_v; /* aligned views */
    snow_taper_table table_u, table_v;      /* oblique views, but for the box */
    snow_oblique_axis oblique_u, oblique_v; /* oblique views */
};

/* Readies a splatter for a view; the record begins as zeros, and keeps its
 * memory from view to view.  Errors: SNOW_NO_MEMORY.  Free with
 * snow_splatter_fini. */
snow_status snow_splatter_make(snow_context *context,
                               const snow_placement *placement,
                               snow_kernel kernel, int support, int channels,
                               snow_splatter *splatter);
void snow_splatter_fini(snow_context *context, snow_splatter *splatter);

/* Makes `slice` the current one. */
void snow_splatter_begin_slice(snow_splatter *splatter, int64_t slice);

/* Rows [*first, *end) of the current slice, outside of which no footprint meets
 * the sheet's band. */
void snow_splatter_rows(const snow_splatter *splatter, const snow_sheet *sheet,
                        int64_t *first, int64_t *end);

/* Splats the spans of one row of the current slice onto the sheet; `samples`
 * are theirs, in order. */
void snow_splat_row(const snow_splatter *splatter, snow_sheet *sheet,
                    int64_t row, const snow_span *spans, size_t count,
                    const float *samples);

/* Makes a sheet of zeros for rows top .. bottom - 1 of an image of this size;
 * the buffer is kept where it fits.  Errors: SNOW_NO_MEMORY. */
snow_status snow_sheet_begin(snow_context *context, const snow_placement *image,
                             int channels, int top, int bottom,
                             snow_sheet *sheet);

/* Says that the sheet is all zeros again. */
static inline void snow_sheet_unmark(snow_sheet *sheet) {
    sheet->x0 = sheet->width;
    sheet->y0 = sheet->bottom;
    sheet->x1 = 0;
    sheet->y1 = sheet->top;
}

#endif
