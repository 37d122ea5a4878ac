/* render/shear_warp/lattice.c - see lattice.h. */
#include "render/shear_warp/lattice.h"

#include <math.h>
#include <string.h>

/* Resampled slices and their phases are counted in an int. */
#define SLICES_MOST (1 << 22)

/* How far apart resampled slices may be, of the finer in-plane spacing; and
 * from how many pixels a voxel on normal has more resampled slices than slices
 * in any case. */
#define APART_MOST 1.5
#define DRAFT_APART_MOST (SNOW_VALUE_REACH_MOST / 2)
#define WIDE 4
/* Doublings of the cells of the wider axis of voxels: more than a cell has
 * phases, and few enough for an int. */
#define DOUBLINGS_MOST 16
/* Resampled slices a slice at most: powers of 2 have exact weights. */
#define PER_SLICE_MOST 16

/* --- cells ---------------------------------------------------------------- */

/* Pixels of the picture a voxel, along the finer in-plane axis. */
static snow_status measure_density(snow_context *context,
                                   const snow_volume_info *info,
                                   const snow_view *view,
                                   const snow_placement *p, double *pixels) {
    snow_camera camera;
    SNOW_TRY(snow_camera_make(context, info, view, &camera));
    if (p->perspective) /* at the volume's middle */
        camera.pitch *= 1 - camera.middle[2] / camera.distance;
    *pixels =
        fmin(info->spacing[p->u_axis], info->spacing[p->v_axis]) / camera.pitch;
    return SNOW_STATUS_OK;
}

static void choose_cells(const snow_volume_info *info, const snow_placement *p,
                         snow_quality quality, double pixels,
                         snow_value_lattice *l) {
    int each = 1;
    if (quality == SNOW_QUALITY_HIGH)
        each = pixels < 1 - 1e-6 ? 2 : 4;
    if (quality == SNOW_QUALITY_NORMAL) {
        l->quincunx = pixels >= 1 - 1e-6 && pixels <= sqrt(2) + 1e-6;
        each = pixels > sqrt(2) + 1e-6 ? 2 : 1;
    }
    double u = info->spacing[p->u_axis], v = info->spacing[p->v_axis];
    int fine = u <= v ? 0 : 1;
    double ratio = fine ? u / v : v / u;
    int doublings = (int)fmin(rint(log2(ratio)), DOUBLINGS_MOST);
    l->cells[fine] = each;
    for (; doublings > 0 &&
           each * (each << doublings) * (1 + l->quincunx) > SNOW_VALUE_PHASES;
         doublings--)
        ;
    l->cells[!fine] = each << doublings;
    l->phases = l->cells[0] * l->cells[1] * (1 + l->quincunx);
}

/* --- resampled slices ----------------------------------------------------- */

/* Resampled slices a slice, where a voxel is so many pixels wide. */
static int resampled_per_slice(const snow_volume_info *info,
                               const snow_placement *p, snow_quality quality,
                               double pixels) {
    const bool draft = quality == SNOW_QUALITY_DRAFT;
    double fine = fmin(info->spacing[p->u_axis], info->spacing[p->v_axis]);
    double ratio = info->spacing[p->slice_axis] / fine / (1 + 1e-9);
    bool wide = quality == SNOW_QUALITY_HIGH ||
                (quality == SNOW_QUALITY_NORMAL && pixels >= WIDE - 1e-6);
    int count = wide && p->slices > 1 ? 2 : 1;
    while (ratio > count * (draft ? DRAFT_APART_MOST : APART_MOST) &&
           p->slices > 1 && count < PER_SLICE_MOST &&
           p->slices * count <= SLICES_MOST)
        count *= 2;
    return count;
}

double snow_value_lattice_reach(const snow_volume_info *info,
                                const snow_placement *p, snow_quality quality) {
    double most = 0;
    const int axes[2] = {p->u_axis, p->v_axis};
    for (int n = 0; n < 2; n++) {
        const double *row = p->inverse[n];
        double slope = row[0] * p->step_slice[0] + row[1] * p->step_slice[1];
        double ratio = info->spacing[p->slice_axis] / info->spacing[axes[n]];
        most = fmax(most, fmax(fabs(slope), ratio * (1 + 1e-6)));
    }
    return most / resampled_per_slice(info, p, quality, 0);
}

bool snow_value_fits(const snow_volume_info *info, const snow_placement *p,
                     const snow_settings *s) {
    if (p->perspective)
        return snow_value_eye_fits(p,
                                   resampled_per_slice(info, p, s->quality, 0));
    return ceil(snow_value_lattice_reach(info, p, s->quality)) +
               (s->kernel == SNOW_KERNEL_BSPLINE) <=
           SNOW_VALUE_REACH_MOST;
}

void snow_value_lattice_slices(const snow_value_lattice *l,
                               const snow_placement *p,
                               snow_resampled_slice *resampled_slices,
                               snow_value_place *places) {
    for (int n = 0; n < l->resampled_count; n++) {
        int at = l->nearest_first ? n : l->resampled_count - 1 - n;
        snow_resampled_slice *s = &resampled_slices[n];
        const int part = at % l->per_slice;
        *s = (snow_resampled_slice){.at = (double)at / l->per_slice,
                                    .slice = at / l->per_slice,
                                    .between = part != 0};
        if (s->between)
            s->toward =
                (int16_t)(32768 * (2 * part - l->per_slice) / l->per_slice);
        int64_t last = p->slices - 1 - s->between;
        if (p->slices == 1) { /* one spacing thick, and constant */
            s->at = at - 0.5;
            s->slice = s->before = s->after = 0;
        } else if (last == 0 && s->between) { /* between the only two */
            s->after = 1;
            s->one_sided = true;
        } else {
            s->before = s->slice > 0 ? s->slice - 1 : 0;
            s->after = s->slice < last ? s->slice + 1 : last;
            s->between_across = s->between;
            s->one_sided = s->after - s->before == 1;
        }
        for (int phase = 0; places && phase < l->phases; phase++) {
            snow_value_place *place = &places[n * l->phases + phase];
            int middle = l->quincunx ? phase & 1 : 0,
                cell = phase >> l->quincunx;
            const int in[2] = {cell % l->cells[0], cell / l->cells[0]};
            for (int axis = 0; axis < 2; axis++) {
                double x = (in[axis] + 0.5 * middle) / l->cells[axis] -
                           (s->at - l->front) * l->slope[axis];
                int weight = (int)floor(32768 * (x - floor(x)) + 0.5);
                place->at[axis] = x;
                place->whole[axis] = (int32_t)floor(x);
                place->weight[axis] =
                    (int16_t)(weight < 32767 ? weight : 32767);
            }
        }
    }
}

/* --- the image ------------------------------------------------------------ */

/* The slice of the front resampled slice. */
static void place_front(const snow_placement *p, snow_value_lattice *l) {
    l->perspective = p->perspective;
    l->nearest_first = p->nearest_first;
    if (p->perspective) {
        l->nearest_first = p->eye.at[2] < 0;
        memcpy(l->eye, p->eye.at, sizeof l->eye);
    }
    if (p->slices == 1)
        l->front = l->nearest_first ? -0.5 : 0.5;
    else
        l->front = l->nearest_first ? 0 : (double)(p->slices - 1);
}

/* The lattice has its samples on the voxels of the front resampled slice, not
 * of slice 0: moves an axis of the image by that. */
static void anchor(snow_value_lattice *l, int axis, int phases) {
    double moved = (double)l->first[axis] - l->front * l->slope[axis];
    double first = floor(moved);
    l->shear.start[axis] += (moved - first) * phases;
    l->first[axis] = (int64_t)first;
    l->voxels[axis]++;
}

void snow_value_lattice_move(snow_value_lattice *l, int axis, double by) {
    l->shear.start[axis] += by;
    for (int n = 0; n < 3; n++)
        l->scaled.warp[axis][n] += by * l->scaled.warp[2][n];
}

/* The image turned by 45 degrees; its samples were twice as dense along both
 * axes, every second one of which is none. */
static void turn(snow_value_lattice *l) {
    snow_shear *s = &l->shear;
    int width = (int)l->voxels[0] * l->cells[0];
    int height = (int)l->voxels[1] * l->cells[1];
    double *const maps[6][2] = {{s->start, s->start + 1},
                                {s->along_x, s->along_x + 1},
                                {s->along_y, s->along_y + 1},
                                {&l->scaled.warp[0][0], &l->scaled.warp[1][0]},
                                {&l->scaled.warp[0][1], &l->scaled.warp[1][1]},
                                {&l->scaled.warp[0][2], &l->scaled.warp[1][2]}};
    for (int n = 0; n < 6; n++) {
        double u = *maps[n][0], v = *maps[n][1];
        *maps[n][0] = (u + v) / 2;
        *maps[n][1] = (u - v) / 2;
    }
    l->top = height;
    snow_value_lattice_move(l, 1, l->top);
    l->width = l->height = width + height + 1;
}

/* How many lattice pixels a pixel is wide, and what that asks of the warp. */
static void choose_warp(const snow_placement *p, snow_quality quality,
                        double pixels, snow_value_lattice *l) {
    const snow_shear *s = &l->shear;
    double wide = l->perspective ? snow_value_eye_density(l, p)
                                 : fmax(hypot(s->along_x[0], s->along_y[0]),
                                        hypot(s->along_x[1], s->along_y[1]));
    l->filter =
        quality == SNOW_QUALITY_DRAFT ? SNOW_BILINEAR : SNOW_CATMULL_ROM;
    l->means = 1;
    if (!(1 / pixels > 1.5) || !(wide > 1.5))
        return;
    for (; wide > 16; wide /= 2)
        l->halvings++;
    l->filter = SNOW_BILINEAR;
    l->means = (int)ceil(wide - 1e-6);
}

static snow_status place_image(snow_context *context,
                               const snow_volume_info *info,
                               const snow_placement *p, const int phases[2],
                               snow_value_lattice *l) {
    double aside = 1 + snow_value_lattice_reach(info, p, 1);
    SNOW_TRY(snow_shear_make(context, p, phases, aside, &l->shear));
    const snow_lattice *axes[2] = {&l->shear.u, &l->shear.v};
    l->empty = axes[0]->count == 0 || axes[1]->count == 0;
    for (int axis = 0; axis < 2; axis++) {
        int cells = axes[axis]->phases;
        l->slope[axis] = axes[axis]->slope;
        l->first[axis] = axes[axis]->first / cells;
        l->voxels[axis] = (axes[axis]->count + cells - 1) / cells;
        anchor(l, axis, cells);
    }
    return SNOW_STATUS_OK;
}

snow_status
snow_value_lattice_make(snow_context *context, const snow_volume_info *info,
                        const snow_view *view, const snow_placement *p,
                        snow_quality quality, snow_value_lattice *out) {
    snow_value_lattice l = {.cells = {1, 1}};
    double pixels;
    if (p->slices > SLICES_MOST)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%lld slices along this view are too many: the limit "
                         "is %d; take a view along another axis",
                         (long long)p->slices, SLICES_MOST);
    SNOW_TRY(measure_density(context, info, view, p, &pixels));
    choose_cells(info, p, quality, pixels, &l);
    l.per_slice = resampled_per_slice(info, p, quality, pixels);
    l.resampled_count =
        p->slices == 1 ? 2 : (int)(p->slices - 1) * l.per_slice + 1;
    l.path = p->path / l.per_slice;
    place_front(p, &l);
    const int dense = l.quincunx ? 2 : 1;
    const int phases[2] = {dense * l.cells[0], dense * l.cells[1]};
    SNOW_TRY(p->perspective ? snow_value_eye_image(context, p, phases, &l)
                            : place_image(context, info, p, phases, &l));
    l.width = (int)l.voxels[0] * l.cells[0];
    l.height = (int)l.voxels[1] * l.cells[1];
    if (l.quincunx)
        turn(&l);
    choose_warp(p, quality, pixels, &l);
    *out = l;
    return SNOW_STATUS_OK;
}

snow_value_pixels snow_value_lattice_pixels(const snow_value_lattice *l,
                                            int phase) {
    if (!l->quincunx)
        return (snow_value_pixels){{phase % l->cells[0], phase / l->cells[0]},
                                   {l->cells[0], 0},
                                   {0, l->cells[1]}};
    int middle = phase & 1, cell = phase >> 1;
    int i = cell % l->cells[0], j = cell / l->cells[0];
    return (snow_value_pixels){{i + j + middle, i - j + l->top},
                               {l->cells[0], l->cells[0]},
                               {l->cells[1], -l->cells[1]}};
}
