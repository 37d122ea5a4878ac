/* splat/footprint/splat.c - the footprints of one view (figure 2 of the paper),
 * and the sheet that they are added to. */
#include "splat/footprint/splat.h"
#include "base/minmax.h"

#include <math.h>
#include <string.h>

#define SPLAT_CHANNELS 2
#define SPLAT_ROW aligned_grey
#define SPLAT_STAMP stamp_grey
#include "splat/footprint/aligned.tmpl.h"

#define SPLAT_CHANNELS 4
#define SPLAT_ROW aligned_rgba
#define SPLAT_STAMP stamp_rgba
#include "splat/footprint/aligned.tmpl.h"

static inline float table_weight(const snow_splatter *splatter, float u,
                                 float v) {
    return snow_scaled_kernel_look_up(&splatter->table_u, u) *
           snow_scaled_kernel_look_up(&splatter->table_v, v);
}

static inline float box_weight(const snow_splatter *splatter, float u,
                               float v) {
    return snow_scaled_kernel_box(&splatter->along_u, (double)u) *
           snow_scaled_kernel_box(&splatter->along_v, (double)v);
}

#define SPLAT_CHANNELS 2
#define SPLAT_WEIGHT table_weight
#define SPLAT_ROW oblique_grey
#define SPLAT_SCATTER scatter_grey
#include "splat/footprint/oblique.tmpl.h"

#define SPLAT_CHANNELS 4
#define SPLAT_WEIGHT table_weight
#define SPLAT_ROW oblique_rgba
#define SPLAT_SCATTER scatter_rgba
#include "splat/footprint/oblique.tmpl.h"

#define SPLAT_CHANNELS 2
#define SPLAT_WEIGHT box_weight
#define SPLAT_ROW oblique_box_grey
#define SPLAT_SCATTER scatter_box_grey
#include "splat/footprint/oblique.tmpl.h"

#define SPLAT_CHANNELS 4
#define SPLAT_WEIGHT box_weight
#define SPLAT_ROW oblique_box_rgba
#define SPLAT_SCATTER scatter_box_rgba
#include "splat/footprint/oblique.tmpl.h"

/* Pixels by which the far end of a slice may deviate from its image axis in an
 * aligned view. */
#define ALIGNED 1e-6

/* An axis counts as upright if its change per pixel to the right is less than
 * this fraction of its change per pixel down. */
#define UPRIGHT 1e-12

/* Returns whether steps along u move along one image axis only, and steps
 * along v along the other: u along `axis` (0 x, 1 y). If voxels are smaller
 * than pixels the tolerance shrinks with them, since a table divides by their
 * steps. */
static bool lies_along(const snow_placement *p, int axis) {
    double step = fmin(fabs(p->step_u[axis]), fabs(p->step_v[1 - axis]));
    return fabs(p->step_u[1 - axis]) * (double)p->columns +
               fabs(p->step_v[axis]) * (double)p->rows <
           ALIGNED * fmin(1, step);
}

static snow_oblique_axis oblique_axis(const double inverse[2],
                                      const snow_scaled_kernel *scaled_kernel) {
    snow_oblique_axis axis = {inverse[0], inverse[1], 0, INFINITY};
    if (fabs(axis.step) > UPRIGHT * fabs(axis.rise)) {
        axis.lean = -axis.rise / axis.step;
        axis.extent = snow_scaled_kernel_reach(scaled_kernel) / fabs(axis.step);
    }
    return axis;
}

static snow_status make_aligned(snow_context *context, int channels,
                                snow_splatter *s) {
    const snow_placement *p = s->placement;
    int across = s->transposed ? p->height : p->width;
    int down = s->transposed ? p->width : p->height;
    s->splat_row = channels == 2 ? aligned_grey : aligned_rgba;
    SNOW_TRY(snow_footprint_table_make(context, &s->along_u, p->columns, across,
                                       &s->taps_u));
    return snow_footprint_table_make(context, &s->along_v, p->rows, down,
                                     &s->taps_v);
}

static snow_status make_oblique(snow_context *context, int channels,
                                snow_splatter *s) {
    const snow_placement *p = s->placement;
    s->oblique_u = oblique_axis(p->inverse[0], &s->along_u);
    s->oblique_v = oblique_axis(p->inverse[1], &s->along_v);
    if (s->along_u.kernel == SNOW_KERNEL_BOX) {
        s->splat_row = channels == 2 ? oblique_box_grey : oblique_box_rgba;
        return SNOW_STATUS_OK;
    }
    s->splat_row = channels == 2 ? oblique_grey : oblique_rgba;
    SNOW_TRY(snow_scaled_kernel_table_make(context, &s->along_u, &s->table_u));
    return snow_scaled_kernel_table_make(context, &s->along_v, &s->table_v);
}

snow_status snow_splatter_make(snow_context *context, const snow_placement *p,
                               snow_kernel kernel, int support, int channels,
                               snow_splatter *s) {
    s->placement = p;
    s->along_u = snow_scaled_kernel_make(
        kernel, support, hypot(p->inverse[0][0], p->inverse[0][1]));
    s->along_v = snow_scaled_kernel_make(
        kernel, support, hypot(p->inverse[1][0], p->inverse[1][1]));
    for (int i = 0; i < 2; i++)
        s->reach[i] =
            fabs(p->step_u[i]) * snow_scaled_kernel_reach(&s->along_u) +
            fabs(p->step_v[i]) * snow_scaled_kernel_reach(&s->along_v);
    s->transposed = lies_along(p, 1);
    s->aligned = s->transposed || lies_along(p, 0);
    return s->aligned ? make_aligned(context, channels, s)
                      : make_oblique(context, channels, s);
}

void snow_splatter_fini(snow_context *context, snow_splatter *s) {
    snow_footprint_table_fini(context, &s->taps_u);
    snow_footprint_table_fini(context, &s->taps_v);
    snow_release(context, s->table_u.cells);
    snow_release(context, s->table_v.cells);
    *s = (snow_splatter){0};
}

void snow_splatter_begin_slice(snow_splatter *s, int64_t slice) {
    const snow_placement *p = s->placement;
    for (int i = 0; i < 2; i++)
        s->origin[i] = p->origin[i] + (double)slice * p->step_slice[i];
    if (!s->aligned)
        return;
    int u = s->transposed ? 1 : 0, v = 1 - u;
    const int pixels[2] = {p->width, p->height};
    snow_footprint_table_place(&s->taps_u, &s->along_u, p->columns, pixels[u],
                               s->origin[u], p->step_u[u]);
    snow_footprint_table_place(&s->taps_v, &s->along_v, p->rows, pixels[v],
                               s->origin[v], p->step_v[v]);
}

/* Marks the pixels that a voxel of the current slice can reach. */
static void mark_voxel(const snow_splatter *s, snow_sheet *sheet,
                       int64_t column, int64_t row) {
    const snow_placement *p = s->placement;
    double at[2];
    for (int i = 0; i < 2; i++)
        at[i] = s->origin[i] + (double)column * p->step_u[i] +
                (double)row * p->step_v[i];
    int x0 = snow_first_pixel(at[0] - s->reach[0], sheet->width);
    int y0 = snow_first_pixel(at[1] - s->reach[1], sheet->height);
    int x1 = snow_last_pixel(at[0] + s->reach[0], sheet->width) + 1;
    int y1 = snow_last_pixel(at[1] + s->reach[1], sheet->height) + 1;
    y0 = y0 > sheet->top ? y0 : sheet->top;
    y1 = y1 < sheet->bottom ? y1 : sheet->bottom;
    sheet->x0 = x0 < sheet->x0 ? x0 : sheet->x0;
    sheet->y0 = y0 < sheet->y0 ? y0 : sheet->y0;
    sheet->x1 = x1 > sheet->x1 ? x1 : sheet->x1;
    sheet->y1 = y1 > sheet->y1 ? y1 : sheet->y1;
}

void snow_splatter_rows(const snow_splatter *s, const snow_sheet *sheet,
                        int64_t *first, int64_t *end) {
    const snow_placement *p = s->placement;
    double step = p->step_v[1], across = (double)p->columns * p->step_u[1];
    *first = 0;
    *end = p->rows;
    if (fabs(step) * (double)p->rows < ALIGNED)
        return;
    /* One extra pixel on either side does no harm; one less would. */
    double low = sheet->top - s->origin[1] - s->reach[1] - SNOW_MAX(across, 0);
    double high =
        sheet->bottom - s->origin[1] + s->reach[1] - SNOW_MIN(across, 0);
    double a = (low - 1) / step, b = (high + 1) / step;
    double rows = (double)p->rows;
    *first = (int64_t)fmin(fmax(floor(SNOW_MIN(a, b)), 0), rows);
    *end = (int64_t)fmin(fmax(ceil(SNOW_MAX(a, b)) + 1, 0), rows);
}

void snow_splat_row(const snow_splatter *s, snow_sheet *sheet, int64_t row,
                    const snow_span *spans, size_t count,
                    const float *samples) {
    if (!count)
        return;
    snow_span last = spans[count - 1];
    mark_voxel(s, sheet, spans[0].column, row);
    mark_voxel(s, sheet, (int64_t)last.column + last.length - 1, row);
    s->splat_row(s, sheet, row, spans, count, samples);
}

snow_status snow_sheet_begin(snow_context *context, const snow_placement *image,
                             int channels, int top, int bottom,
                             snow_sheet *sheet) {
    size_t bytes = (size_t)image->width * (size_t)(bottom - top) *
                   (size_t)channels * sizeof *sheet->pixels;
    SNOW_TRY(snow_reserve(context, &sheet->pixels, 0, 1, bytes));
    memset(sheet->pixels, 0, bytes);
    sheet->width = image->width;
    sheet->height = image->height;
    sheet->channels = channels;
    sheet->top = top;
    sheet->bottom = bottom;
    snow_sheet_unmark(sheet);
    return SNOW_STATUS_OK;
}
