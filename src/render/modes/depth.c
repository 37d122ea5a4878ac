/* render/modes/depth.c - depths of mode over: footprints once more, front to
 * back, with an eye on opacity alone. */
#include "render/modes/depth.h"
#include "base/vec3.h"

#include <string.h>

void snow_depth_place(const snow_job *job, double of[4]) {
    const snow_placement *p = &job->placement;
    snow_volume_info info;
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    const int64_t sides[3] = {p->columns, p->rows, p->slices};
    snow_volume_whole(job->volume, &info);
    of[3] = 0;
    for (int n = 0; n < 3; n++) {
        of[n] = 0;
        for (int r = 0; r < 3; r++)
            of[n] -= info.matrix[r][axes[n]] * p->back[r];
        if (!job->view->has_target)
            of[3] -= of[n] * (double)(sides[n] - 1) / 2;
    }
    for (int r = 0; job->view->has_target && r < 3; r++)
        of[3] -= (info.matrix[r][3] - job->view->target[r]) * p->back[r];
}

/* Where the ray of a pixel meets slice k, which need not be a whole number. */
static void meet_slice(const snow_placement *p, int x, int y, double k,
                       double at[2]) {
    double x0 = x + 0.5 - p->origin[0] - k * p->step_slice[0];
    double y0 = y + 0.5 - p->origin[1] - k * p->step_slice[1], ray[3];
    for (int axis = 0; axis < 2; axis++)
        at[axis] = p->inverse[axis][0] * x0 + p->inverse[axis][1] * y0;
    if (!p->perspective)
        return;
    snow_perspective_ray(&p->eye, x + 0.5, y + 0.5, ray);
    for (int axis = 0; axis < 2; axis++)
        at[axis] = p->eye.at[axis] + (k - p->eye.at[2]) * (ray[axis] / ray[2]);
}

void snow_depth_find(const snow_placement *p, const double of[4], int x, int y,
                     double depth, double at[3], double away[3]) {
    at[2] = 0;
    away[2] = 1;
    meet_slice(p, x, y, 0, at);
    meet_slice(p, x, y, 1, away);
    away[0] -= at[0];
    away[1] -= at[1];
    if (p->perspective) {
        memcpy(at, p->eye.at, sizeof p->eye.at);
        snow_perspective_ray(&p->eye, x + 0.5, y + 0.5, away);
    }
    const double rise = snow_dot(of, away);
    for (int n = 0; n < 3; n++)
        away[n] /= rise;
    const double way = depth - of[3] - snow_dot(of, at);
    for (int n = 0; n < 3; n++)
        at[n] += way * away[n];
}

/* Returns whether slices rise along the ray of a pixel. */
static bool rises(const snow_placement *p, int x, int y) {
    double ray[3];
    if (!p->perspective)
        return p->nearest_first;
    snow_perspective_ray(&p->eye, x + 0.5, y + 0.5, ray);
    return ray[2] > 0;
}

/* Of `count` pixels of a row from (x, y) on; `sheet` is the first one's. */
static void note_row(const snow_job *job, int64_t slice, int x, int y,
                     int count, const float *sheet) {
    const snow_placement *p = &job->placement;
    size_t channels = (size_t)job->channels;
    size_t first = (size_t)y * (size_t)p->width + (size_t)x;
    const float *image = job->pixels + first * channels + channels - 1;
    double of[4], at[2];
    sheet += channels - 1;
    for (int n = 0; n < count; n++, image += channels, sheet += channels) {
        double before = (double)*image;
        double after = before + (1 - before) * (double)*sheet;
        if (before >= 0.5 || !(after >= 0.5))
            continue;
        double share = (0.5 - before) / (after - before) - 0.5;
        double k = (double)(slice + job->clip.stored[2]) +
                   (rises(p, x + n, y) ? share : -share);
        snow_depth_place(job, of);
        meet_slice(p, x + n, y, k, at);
        job->depths[first + (size_t)n] =
            (float)(of[0] * at[0] + of[1] * at[1] + of[2] * k + of[3]);
    }
}

void snow_depth_note_sheet(const snow_job *job, int64_t slice,
                           const snow_sheet *sheet) {
    if (!job->depths || sheet->x0 >= sheet->x1)
        return;
    for (int y = sheet->y0; y < sheet->y1; y++)
        note_row(job, slice, sheet->x0, y, sheet->x1 - sheet->x0,
                 sheet->pixels +
                     ((size_t)(y - sheet->top) * (size_t)sheet->width +
                      (size_t)sheet->x0) *
                         (size_t)job->channels);
}
