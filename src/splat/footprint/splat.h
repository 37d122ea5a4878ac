/* splat/footprint/splat.h - reconstruction by splatting (R in figure 7, lines 8
 * to 12 of figure 8, section 2): every voxel's footprint is added to the sheet.
 *
 * A voxel's footprint is its kernel along u times its kernel along v, mapped to
 * the image by the slice's map: a parallelogram. If the slice's axes are
 * parallel to the image's ("aligned" views) it is a rectangle, and the weights
 * of each column and each row of the slice are tabulated beforehand. At one
 * voxel per pixel that is the paper's K x K footprint table. */
#ifndef SNOW_SPLAT_FOOTPRINT_SPLAT_H
#define SNOW_SPLAT_FOOTPRINT_SPLAT_H

#include "encode/encode.h"
#include "splat/footprint/table.h"

/* The buffer of one slice for a band of the image: its rows top .. bottom - 1,
 * all of them with a single thread. Only the pixels from (x0, y0) up to, but
 * not including, (x1, y1) can differ from 0. */
typedef struct snow_sheet {
    int width, height, channels; /* of the image */
    int top, bottom;
    float *pixels; /* from row `top` on */
    int x0, y0, x1, y1;
} snow_sheet;

/* One axis of the grid in an oblique view. */
typedef struct snow_oblique_axis {
    double step, rise; /* grid units per pixel to the right, downwards */
    double lean;       /* middle of the footprint, pixels per row down */
    double extent;     /* half its width on a row, pixels; may be infinite */
} snow_oblique_axis;

typedef struct snow_splatter snow_splatter;

/* The loop over one row's voxels for a view. */
typedef void snow_splat_row_fn(const snow_splatter *splatter, snow_sheet *sheet,
                               int64_t row, const snow_span *spans,
                               size_t count, const float *samples);

/* The state of one view's footprints. */
struct snow_splatter {
    const snow_placement *placement;
    snow_scaled_kernel along_u, along_v;
    snow_splat_row_fn *splat_row;
    double origin[2]; /* pixel position of voxel (0, 0) of the slice */
    double reach[2];  /* half the footprint's bounding box, pixels */
    bool aligned;
    bool transposed; /* aligned views: u is parallel to the image's y */
    snow_footprint_table taps_u, taps_v; /* aligned views */
    snow_scaled_kernel_table table_u,
        table_v; /* oblique views, except for the box */
    snow_oblique_axis oblique_u, oblique_v; /* oblique views */
};

/* Prepares a splatter for a view; the record begins as zeros, and reuses its
 * memory from view to view. Errors: SNOW_STATUS_NO_MEMORY. Free with
 * snow_splatter_fini. */
snow_status snow_splatter_make(snow_context *context,
                               const snow_placement *placement,
                               snow_kernel kernel, int support, int channels,
                               snow_splatter *splatter);
void snow_splatter_fini(snow_context *context, snow_splatter *splatter);

/* Makes `slice` the current one. */
void snow_splatter_begin_slice(snow_splatter *splatter, int64_t slice);

/* Rows [*first, *end) of the current slice; footprints of other rows do not
 * touch the sheet's band. */
void snow_splatter_rows(const snow_splatter *splatter, const snow_sheet *sheet,
                        int64_t *first, int64_t *end);

/* Splats the spans of one row of the current slice onto the sheet; `samples`
 * are the samples of the spans, in order. */
void snow_splat_row(const snow_splatter *splatter, snow_sheet *sheet,
                    int64_t row, const snow_span *spans, size_t count,
                    const float *samples);

/* Makes a sheet of zeros for rows top .. bottom - 1 of an image of this size;
 * the buffer is reused if large enough. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_sheet_begin(snow_context *context, const snow_placement *image,
                             int channels, int top, int bottom,
                             snow_sheet *sheet);

/* Marks the sheet as all zeros. */
static inline void snow_sheet_unmark(snow_sheet *sheet) {
    sheet->x0 = sheet->width;
    sheet->y0 = sheet->bottom;
    sheet->x1 = 0;
    sheet->y1 = sheet->top;
}

#endif
