/* render/shear_warp/eye.c - the lattice in perspective: its samples lie on the
 * voxels of the front resampled slice, and ever farther apart on those behind.
 */
#include "render/shear_warp/lattice.h"

#include <math.h>
#include <string.h>

/* The field's ends along an axis of a slice. */
static void ends_of(const snow_placement *p, int axis, double ends[2]) {
    int64_t voxels = axis == 0 ? p->columns : p->rows;
    ends[0] = voxels == 1 ? -0.5 : 0;
    ends[1] = voxels == 1 ? 0.5 : (double)(voxels - 1);
}

static double back_of(const snow_value_lattice *l, const snow_placement *p) {
    double depth = p->slices == 1 ? 1 : (double)(p->slices - 1);
    return l->nearest_first ? l->front + depth : l->front - depth;
}

/* From the eye to the ends of the field along the slices. */
static void heights_of(const snow_placement *p, double heights[2]) {
    double half = p->slices == 1 ? 0.5 : 0;
    heights[0] = -half - p->eye.at[2];
    heights[1] = (double)(p->slices - 1) + half - p->eye.at[2];
}

double snow_value_eye_slope(const snow_placement *p, int axis) {
    double most = 0, heights[2], ends[2];
    heights_of(p, heights);
    ends_of(p, axis, ends);
    for (int corner = 0; corner < 4; corner++)
        most = fmax(most, fabs((ends[corner >> 1] - p->eye.at[axis]) /
                               heights[corner & 1]));
    return most;
}

static double slope_of(const snow_placement *p) {
    return fmax(snow_value_eye_slope(p, 0), snow_value_eye_slope(p, 1));
}

bool snow_value_eye_fits(const snow_placement *p, int per_slice) {
    double heights[2];
    heights_of(p, heights);
    double near = fmin(fabs(heights[0]), fabs(heights[1]));
    double spread = fmax(fabs(heights[0]), fabs(heights[1])) / near;
    return heights[0] * heights[1] > 0 && near > 1e-6 &&
           spread <= SNOW_VALUE_SPREAD_MOST &&
           ceil(slope_of(p) / per_slice) + fmax(2, ceil(spread)) - 1 <=
               SNOW_VALUE_REACH_MOST;
}

/* --- the image ------------------------------------------------------------ */

/* The volume's range along an axis, in voxels of the front resampled slice, and
 * one voxel more of each resampled slice. */
static void covered_range(const snow_value_lattice *l, const snow_placement *p,
                          int axis, double range[2]) {
    double ends[2], m = snow_value_eye_step(l, back_of(l, p));
    ends_of(p, axis, ends);
    for (int side = 0; side < 2; side++) {
        double end = ends[side] + (side ? 1 : -1);
        double back = l->eye[axis] + (end - l->eye[axis]) / m;
        range[side] = side ? fmax(end, back) : fmin(end, back);
    }
}

snow_status snow_value_eye_image(snow_context *context, const snow_placement *p,
                                 const int phases[2], snow_value_lattice *l) {
    const double pitch[2] = {1.0 / phases[0], 1.0 / phases[1]};
    double covered[2][2];
    for (int axis = 0; axis < 2; axis++)
        covered_range(l, p, axis, covered[axis]);
    SNOW_TRY(snow_perspective_shear_cover(context, p, l->front - l->eye[2],
                                          pitch, covered, &l->scaled));
    l->empty = l->scaled.u.count == 0 || l->scaled.v.count == 0;
    /* Whole voxels of the front resampled slice: n pixels are `phases` of
     * them. */
    for (int axis = 0; axis < 2; axis++) {
        const snow_perspective_shear_axis *from =
            axis ? &l->scaled.v : &l->scaled.u;
        const int n = phases[axis];
        const int64_t rest = ((from->first % n) + n) % n;
        l->first[axis] = (from->first - rest) / n;
        l->voxels[axis] = (from->count + rest + n - 1) / n;
        snow_value_lattice_move(l, axis, (double)rest);
    }
    return SNOW_STATUS_OK;
}

double snow_value_eye_density(const snow_value_lattice *l,
                              const snow_placement *p) {
    const double step[3] = {p->eye.middle[0] - l->eye[0],
                            p->eye.middle[1] - l->eye[1],
                            p->eye.middle[2] - l->eye[2]};
    double pixel[2] = {0, 0}, at[3], most = 0;
    snow_perspective_sees(&p->eye, step, pixel); /* all voxels are */
    for (int i = 0; i < 3; i++)
        at[i] = l->scaled.warp[i][0] + pixel[0] * l->scaled.warp[i][1] +
                pixel[1] * l->scaled.warp[i][2];
    for (int axis = 0; axis < 2; axis++) {
        double by[2];
        for (int n = 0; n < 2; n++)
            by[n] = (l->scaled.warp[axis][n + 1] -
                     at[axis] / at[2] * l->scaled.warp[2][n + 1]) /
                    at[2];
        most = fmax(most, hypot(by[0], by[1]));
    }
    return most;
}

/* --- resampled slices ----------------------------------------------------- */

/* Samples from one to those of its gradient: about one voxel. */
static int apart_of(int cells, double step) {
    return (int)fmax(1, rint(cells / step));
}

double snow_value_eye_reach(const snow_value_lattice *l,
                            const snow_placement *p) {
    double wide = 1, back = back_of(l, p);
    for (int n = 0; n < l->resampled_count; n++) {
        double slice =
            l->front + (back - l->front) * n / (l->resampled_count - 1);
        double step = snow_value_eye_step(l, slice);
        for (int axis = 0; axis < 2; axis++)
            wide = fmax(wide,
                        apart_of(l->cells[axis], step) * step / l->cells[axis]);
    }
    double most = slope_of(p) / l->per_slice;
    return ceil(most * (1 - 1e-9)) + ceil(wide * (1 - 1e-9)) - 1;
}

snow_value_spread snow_value_eye_spread(const snow_value_lattice *l,
                                        const snow_resampled_slice *resampled) {
    snow_value_spread spread = {.step = snow_value_eye_step(l, resampled->at)};
    for (int axis = 0; axis < 2; axis++) {
        int apart = apart_of(l->cells[axis], spread.step);
        double share = l->cells[axis] / (apart * spread.step);
        spread.apart[axis] = apart;
        if (spread.step != 1)
            spread.stretch[axis] = (int16_t)rint(32768 * (share - 1));
    }
    return spread;
}

/* Places are multiples of 2^-32 voxels. */
static void place_lanes(double start, double step, snow_value_lanes *out) {
    double first = floor(start);
    int64_t at = (int64_t)floor((start - first) * 0x1p32 + 0.5);
    int64_t by = (int64_t)floor(step * 0x1p32 + 0.5);
    out->start = start;
    out->first = (int32_t)first;
    for (int n = 0; n < SNOW_VALUE_LANES; n++, at += by) {
        uint32_t weight = ((uint32_t)at >> 16) + 1;
        out->at[n] = (int16_t)(at >> 32);
        out->weight[n] = (int16_t)(weight / 2 < 32767 ? weight / 2 : 32767);
    }
}

static void select_lanes(int margin, snow_value_lanes *lanes) {
    int64_t bit = (int64_t)lanes->first + margin + 32;
    int64_t word = bit >= 0 ? bit / 32 : -((31 - bit) / 32);
    int shift = (int)(bit - 32 * word);
    memset(lanes->select, 0, sizeof lanes->select);
    lanes->word = (int32_t)word;
    for (int n = 0; n < 32; n++) {
        int place = shift + lanes->at[n];
        lanes->select[place / 32] |= UINT32_C(1) << place % 32;
    }
}

void snow_value_eye_lanes(const snow_value_lattice *l,
                          const snow_resampled_slice *resampled, int axis,
                          int tiles, int64_t stored, int margin,
                          snow_value_lanes *lanes) {
    double step = snow_value_eye_step(l, resampled->at), eye = l->eye[axis];
    int phases = l->cells[axis] * (l->quincunx ? 2 : 1);
    int side = axis == 0 ? SNOW_VALUE_COLUMNS : SNOW_VALUE_ROWS;
    for (int phase = 0; phase < phases; phase++)
        for (int tile = 0; tile < tiles; tile++, lanes++) {
            double front = (double)(l->first[axis] + (int64_t)tile * side - 1) +
                           (double)phase / phases;
            place_lanes(eye + (front - eye) * step, step, lanes);
            lanes->first -= (int32_t)stored;
            if (axis == 0)
                select_lanes(margin, lanes);
        }
}
