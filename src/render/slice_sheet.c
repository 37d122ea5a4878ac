/* render/slice_sheet.c - where slices lie in one picture of several: a grid of
 * slices across one axis, or the three through a point.
 *
 *   0 1 2        axial | coronal | sagittal, at one scale, each with the
 *   3 4 5        place of the point in it */
#include "base/vec3.h"
#include "image/image.h"
#include "render/slice.h"
#include "transfer/scale.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

#include <snowglass/snowglass.h>

#include <math.h>
#include <string.h>

/* Pixels between slices. */
#define GAP 2

/* A slice of a volume shows something if such a share of its voxels lies so far
 * above the lower end of the window. */
#define SHOWN_VOXELS 0.01
#define SHOWN_ABOVE 0.1

/* Voxels that are looked at in a slice, about. */
#define SAMPLE 65536

SNOW_RECORD_OF_ZEROS(snow_slice_place);

/* --- the three through a point -------------------------------------------- */

typedef struct row_of_three {
    snow_slice_place places[3];
    double extent[3][2]; /* in the world */
    double pitch;
    int size[2];
} row_of_three;

/* The point in voxels; false outside of the volume. */
static bool find_voxel(const snow_volume_info *info, const double at[3],
                       double voxel[3]) {
    double inverse[3][3];
    if (!snow_matrix_invert3(info->matrix, inverse))
        return false;
    for (int i = 0; i < 3; i++) {
        voxel[i] = 0;
        for (int n = 0; n < 3; n++)
            voxel[i] += inverse[i][n] * (at[n] - info->matrix[n][3]);
        if (!(voxel[i] >= -0.5 && voxel[i] <= (double)info->dims[i] - 0.5))
            return false;
    }
    return true;
}

/* Where lines cross, in pixels of the slice. */
static void find_cross(const snow_volume_info *info, const double voxel[3],
                       double pitch, snow_slice_place *place) {
    const snow_view *view = &place->view;
    double right[3], from[3] = {0, 0, 0};
    snow_cross(view->up, view->back, right);
    for (int i = 0; i < 3; i++)
        for (int n = 0; n < 3 && i != place->axis; n++)
            from[n] += info->matrix[n][i] *
                       (voxel[i] - ((double)info->dims[i] - 1) / 2);
    place->cross[0] = view->width / 2.0 + snow_dot(from, right) / pitch;
    place->cross[1] = view->height / 2.0 - snow_dot(from, view->up) / pitch;
}

/* One scale for all, by the size, or by the least spacing. */
static void scale_row(const snow_volume_info *info, row_of_three *row) {
    double wide = 0, high = 0;
    const bool own = row->size[0] <= 0 || row->size[1] <= 0;
    for (int n = 0; n < 3; n++) {
        wide += row->extent[n][0];
        high = fmax(high, row->extent[n][1]);
    }
    const double room[2] = {
        fmax((own ? SNOW_IMAGE_SIDE : row->size[0]) - 2 * GAP, 3),
        own ? SNOW_IMAGE_SIDE : row->size[1]};
    const double fit = fmax(wide / room[0], high / room[1]);
    row->pitch = own ? fmax(row->pitch, fit) : fit;
    int x = 0, most = 1;
    for (int n = 0; n < 3; n++) {
        snow_view *view = &row->places[n].view;
        view->width =
            (int)fmax(floor(row->extent[n][0] / row->pitch + 1e-6), 1);
        view->height =
            (int)fmax(floor(row->extent[n][1] / row->pitch + 1e-6), 1);
        snow_slice_scale(info, row->pitch, view);
        row->places[n].x = x;
        x += view->width + GAP;
        most = view->height > most ? view->height : most;
    }
    if (own) {
        row->size[0] = x - GAP;
        row->size[1] = most;
    }
    for (int n = 0; n < 3; n++) {
        row->places[n].x += (row->size[0] - (x - GAP)) / 2;
        row->places[n].y = (row->size[1] - row->places[n].view.height) / 2;
    }
}

snow_status snow_slice_ortho(snow_context *context,
                             const snow_volume_info *info, const double at[3],
                             int part, int size[2], snow_slice_place *out) {
    static const char *const names[3] = {"axial", "coronal", "sagittal"};
    row_of_three row = {.pitch = INFINITY, .size = {size[0], size[1]}};
    double voxel[3];
    if (part < 0 || part > 2)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "there is no part %d of three slices", part);
    if (!find_voxel(info, at, voxel))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "the point %g,%g,%g lies outside of the volume", at[0],
                         at[1], at[2]);
    for (int n = 0; n < 3; n++) {
        snow_slice_place *place = &row.places[n];
        *place = (snow_slice_place){.size = sizeof *place};
        snow_view_init(&place->view);
        place->view.width = place->view.height = 0;
        SNOW_TRY(snow_slice_view(context, info, names[n], &place->view,
                                 &place->axis));
        row.pitch =
            fmin(row.pitch, snow_slice_measure(info, place->axis, &place->view,
                                               row.extent[n]));
        place->index = (int64_t)fmin(fmax(rint(voxel[place->axis]), 0),
                                     (double)info->dims[place->axis] - 1);
    }
    scale_row(info, &row);
    find_cross(info, voxel, row.pitch, &row.places[part]);
    size[0] = row.size[0];
    size[1] = row.size[1];
    return SNOW_RECORD_FILL(context, snow_slice_place, &row.places[part], out);
}

/* --- a grid of them ------------------------------------------------------- */

snow_status snow_slice_grid(snow_context *context, const snow_volume_info *info,
                            const char *axis, int columns, int rows, int part,
                            int size[2], snow_slice_place *out) {
    const int counts[2] = {columns, rows};
    snow_slice_place place = {.size = sizeof place};
    int sides[2];
    if (columns < 1 || rows < 1 || columns > 100 || rows > 100 || part < 0 ||
        part >= columns * rows)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a grid of %d x %d slices is not possible: must be 1 "
                         "to 100 across and down",
                         columns, rows);
    for (int tries = 0; tries < 2; tries++) {
        const bool own = tries == 0 && (size[0] <= 0 || size[1] <= 0);
        for (int i = 0; i < 2; i++) {
            const int all = size[i] > 0 ? size[i] : SNOW_IMAGE_SIDE;
            sides[i] = (all - (counts[i] - 1) * GAP) / counts[i];
            sides[i] = sides[i] > 1 ? sides[i] : 1;
        }
        snow_view_init(&place.view);
        place.view.width = own ? 0 : sides[0];
        place.view.height = own ? 0 : sides[1];
        SNOW_TRY(
            snow_slice_view(context, info, axis, &place.view, &place.axis));
        if (place.view.width <= sides[0] && place.view.height <= sides[1])
            break;
    }
    const int steps[2] = {place.view.width + GAP, place.view.height + GAP};
    place.x = part % columns * steps[0];
    place.y = part / columns * steps[1];
    if (size[0] <= 0 || size[1] <= 0) {
        size[0] = columns * steps[0] - GAP;
        size[1] = rows * steps[1] - GAP;
    }
    return SNOW_RECORD_FILL(context, snow_slice_place, &place, out);
}

/* Whether enough of a slice's voxels lie above a value. */
static bool is_shown(const snow_volume *volume, const snow_transfer *transfer,
                     int axis, int64_t index, double above) {
    const snow_volume_info *info = &volume->info;
    const int64_t steps[3] = {1, info->dims[0], info->dims[0] * info->dims[1]};
    const int u = axis == 0, v = axis == 2 ? 1 : 2;
    const int64_t all = info->dims[u] * info->dims[v];
    const int64_t skip = all > SAMPLE ? (int64_t)sqrt((double)all / SAMPLE) : 1;
    int64_t shown = 0, count = 0;
    for (int64_t b = 0; b < info->dims[v]; b += skip)
        for (int64_t a = 0; a < info->dims[u]; a += skip) {
            const double value =
                info->slope * snow_volume_native(volume, index * steps[axis] +
                                                             a * steps[u] +
                                                             b * steps[v]) +
                info->intercept;
            double rgba[4] = {0, 0, 0, value > above};
            if (transfer->label_count)
                snow_transfer_evaluate(transfer, value, rgba);
            shown += rgba[3] > 0;
            count++;
        }
    return (double)shown >= fmax(SHOWN_VOXELS * (double)count, 1);
}

snow_status snow_slice_shown(const snow_volume *volume,
                             const snow_transfer *transfer, int axis,
                             int64_t ends[2]) {
    double low, high;
    SNOW_TRY(snow_volume_need_voxels(volume));
    snow_transfer_domain(transfer, &low, &high);
    const double above = snow_between_on(
        (snow_scale){transfer->log, transfer->linear}, low, high, SHOWN_ABOVE);
    const int64_t count = volume->info.dims[axis];
    int64_t first = 0, last = count - 1;
    while (first < count && !is_shown(volume, transfer, axis, first, above))
        first++;
    while (last > first && !is_shown(volume, transfer, axis, last, above))
        last--;
    ends[0] = first < count ? first : 0;
    ends[1] = first < count ? last : count - 1;
    return SNOW_STATUS_OK;
}

/* --- the picture of all --------------------------------------------------- */

/* Lines through a point, which leave it free: of a picture's shorter side. */
#define CROSS_GAP 0.03
#define LETTERS_LEAST 64
static const float cross_color[4] = {0.25F, 0.9F, 0.35F, 1};

static float *pixel_at(const snow_image *image, int x, int y) {
    return image->pixels + ((size_t)y * (size_t)image->width + (size_t)x) *
                               (size_t)image->channels;
}

/* Fills the pixels of a slice from (x0, y0) to (x1, y1), as far as they are
 * within. */
static void fill(const snow_slice_place *place, double x0, double y0, double x1,
                 double y1, snow_image *sheet) {
    const int left = (int)fmax(rint(x0), 0), top = (int)fmax(rint(y0), 0);
    const int right = (int)fmin(rint(x1), place->view.width);
    const int bottom = (int)fmin(rint(y1), place->view.height);
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++)
            memcpy(pixel_at(sheet, place->x + x, place->y + y), cross_color,
                   sizeof cross_color);
}

static void draw_cross(const snow_slice_place *place, snow_image *sheet) {
    const double side = fmin(sheet->width, sheet->height);
    const double wide = fmax(rint(side / 600), 1);
    const double gap = fmax(CROSS_GAP * side, 3);
    const double x = floor(place->cross[0] - (wide - 1) / 2);
    const double y = floor(place->cross[1] - (wide - 1) / 2);
    const double right = place->view.width, bottom = place->view.height;
    /* Where letters may stand, which smaller pictures have none of. */
    const double edge = side < LETTERS_LEAST ? 0 : 1.5 * gap;
    fill(place, x, edge, x + wide, y - gap, sheet);
    fill(place, x, y + wide + gap, x + wide, bottom - edge, sheet);
    fill(place, edge, y, x - gap, y + wide, sheet);
    fill(place, x + wide + gap, y, right - edge, y + wide, sheet);
}

snow_status snow_slice_lay(const snow_image *slice,
                           const snow_slice_place *place, bool cross,
                           snow_image *sheet) {
    const int parts = slice->channels, to = sheet->channels;
    snow_slice_place at;
    SNOW_TRY(SNOW_RECORD_READ(sheet->context, snow_slice_place, place, &at));
    if (at.x < 0 || at.y < 0 || at.x + slice->width > sheet->width ||
        at.y + slice->height > sheet->height || (to != parts && to != 4) ||
        slice->width != at.view.width || slice->height != at.view.height)
        return snow_fail(sheet->context, SNOW_STATUS_BAD_USAGE,
                         "a slice of %d x %d pixels has no place in a picture "
                         "of %d x %d",
                         slice->width, slice->height, sheet->width,
                         sheet->height);
    for (int y = 0; y < slice->height; y++)
        for (int x = 0; x < slice->width; x++) {
            const float *pixel = pixel_at(slice, x, y);
            float *out = pixel_at(sheet, at.x + x, at.y + y);
            for (int c = 0; c < to; c++)
                out[c] = pixel[parts == to ? c : c == 3 ? parts - 1 : 0];
        }
    if (cross && to == 4)
        draw_cross(&at, sheet);
    return SNOW_STATUS_OK;
}
