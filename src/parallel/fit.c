/* parallel/fit.c - frames what a look shows: the bounds before the camera of
 * the interesting voxels that can be seen, of one process or of all ranks'
 * parts.
 *
 * The corners of their convex hull bound all of them, in perspective too.
 * Bounds are largest values, which do not depend on the order of rows, threads
 * and ranks. */
#include "base/monitor.h"
#include "base/vec3.h"
#include "comm/comm.h"
#include "parallel/fit_object.h"
#include "render/job.h"
#include "transform/hull.h"
#include "volume/stream.h"

#include <math.h>

/* The bounds fill so much of a picture's side. */
#define FILLED 0.92

/* The largest places of voxels: before the first camera along right, up and
 * back and against them; in all pictures to the right, left, top and bottom, in
 * half pictures from the middle. */
#define PLACES 6
#define BOUNDS (PLACES + 4)

typedef struct fit {
    snow_context *context;
    const snow_transfer *transfer;
    snow_settings settings;
    snow_volume_info whole;
    const snow_view *view;
    snow_camera *cameras;
    double (*margins)[3]; /* of each: half a voxel along right, up and back */
    size_t count;
    snow_interesting_fn *visit; /* of the present walk */
    snow_extent part;           /* of the present slab */
    uint32_t (*rows)[2];    /* the first and last column of its rows that can be
                               seen; a first one behind the last: none */
    snow_hull hull;         /* of all these */
    snow_fit_object object; /* what can be seen */
} fit;

/* Sides of a turn from which is decided what can be seen. */
#define SIDES 8

/* --- bounds --------------------------------------------------------------- */

/* Half a voxel's box along the camera's axes. */
static void find_margin(const fit *f, const snow_camera *camera,
                        double margin[3]) {
    const double *axes[3] = {camera->right, camera->up, camera->back};
    for (int i = 0; i < 3; i++) {
        margin[i] = 0;
        for (int axis = 0; axis < 3; axis++) {
            double step[3];
            for (int k = 0; k < 3; k++)
                step[k] = f->whole.matrix[k][axis];
            margin[i] += fabs(snow_dot(step, axes[i])) / 2;
        }
    }
}

/* Widens the last bounds by a voxel's box; all is in the picture up to 1. */
static void add_place(const snow_view *view, const snow_camera *camera,
                      const double at[3], const double margin[3],
                      double bounds[4]) {
    const double half[2] = {camera->pitch / 2 * snow_view_room(view),
                            camera->pitch / 2 * view->height};
    double depth = camera->distance;
    double scale = depth > 0 ? depth / (depth - at[2] - margin[2]) : 1;
    for (int i = 0; i < 4; i++) {
        double place = i % 2 ? -at[i / 2] : at[i / 2];
        bounds[i] =
            fmax(bounds[i], (place + margin[i / 2]) * scale / half[i / 2]);
    }
}

/* A voxel of the whole, whose number may be a fraction. */
static void add_voxel(const fit *f, const double voxel[3],
                      double bounds[BOUNDS]) {
    double from_middle[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++)
            from_middle[i] +=
                f->whole.matrix[i][axis] *
                (voxel[axis] - ((double)f->whole.dims[axis] - 1) / 2);
    for (size_t n = 0; n < f->count; n++) {
        const snow_camera *c = &f->cameras[n];
        const double *axes[3] = {c->right, c->up, c->back};
        double at[3];
        for (int i = 0; i < 3; i++) {
            at[i] = c->middle[i] + snow_dot(from_middle, axes[i]);
            if (n == 0) {
                bounds[2 * i] = fmax(bounds[2 * i], at[i]);
                bounds[2 * i + 1] = fmax(bounds[2 * i + 1], -at[i]);
            }
        }
        add_place(f->view, c, at, f->margins[n], bounds + PLACES);
    }
}

static void begin_bounds(double bounds[BOUNDS]) {
    for (int i = 0; i < BOUNDS; i++)
        bounds[i] = -INFINITY;
}

/* --- voxels --------------------------------------------------------------- */

static void add_row(void *of, const snow_interesting_row *row) {
    fit *f = of;
    snow_fit_object_add(&f->object, row);
}

static void end_row(void *of, const snow_interesting_row *row) {
    const fit *f = of;
    const snow_extent *part = &f->part;
    const uint32_t first = (uint32_t)(part->first[0] - row->stored);
    size_t ends[2];
    if (!snow_fit_object_trim(&f->object, row, &ends[0], &ends[1]))
        return;
    uint32_t *out = f->rows[(row->z - part->first[2]) * part->count[1] +
                            row->y - part->first[1]];
    for (int n = 0; n < 2; n++)
        out[n] = row->columns[ends[n]] - first;
}

static snow_status visit_slab(const snow_volume *slab, void *user) {
    fit *f = user;
    const bool ends = f->visit == end_row;
    const snow_interesting_walk walk = {
        .volume = slab,
        .transfer = f->transfer,
        .threshold = f->settings.threshold,
        .exponent = 1,
        .only_counts = ends,
        .isa = f->settings.isa,
        /* under a limit there may be no room for more row blocks */
        .threads = f->context->limit ? 1 : f->settings.threads};
    snow_volume_find_extent(slab, &f->part);
    const int64_t rows = f->part.count[1] * f->part.count[2];
    if (ends)
        SNOW_TRY(SNOW_RESERVE(f->context, f->rows, 0, rows));
    for (int64_t n = 0; ends && n < rows; n++) {
        f->rows[n][0] = 1;
        f->rows[n][1] = 0;
    }
    SNOW_TRY(snow_visit_interesting(&walk, f->visit, user));
    return ends ? snow_hull_add(&f->hull, &f->part, f->rows) : SNOW_STATUS_OK;
}

static snow_status visit_slabs(fit *f, const snow_volume *volume,
                               snow_interesting_fn *visit) {
    const snow_slab_cut cut = {.ghosts = f->transfer->gradient_count > 0};
    f->visit = visit;
    return snow_slabs_visit(volume, &cut, visit_slab, f);
}

/* The middles of the voxels at the corners. */
static void bound_box(const fit *f, double bounds[BOUNDS]) {
    for (int corner = 0; corner < 8; corner++) {
        double voxel[3];
        for (int i = 0; i < 3; i++)
            voxel[i] = corner >> i & 1 ? (double)(f->whole.dims[i] - 1) : 0;
        add_voxel(f, voxel, bounds);
    }
}

/* Collective.  One walk over what is shown. */
static snow_status find_hull(fit *f, snow_comm *comm,
                             const snow_volume *volume) {
    snow_status status = SNOW_STATUS_OK;
    if (f->transfer)
        status = visit_slabs(f, volume, end_row);
    if (status == SNOW_STATUS_OK)
        status = snow_hull_end(&f->hull);
    return comm ? snow_comm_agree_status(comm, status) : status;
}

/* Collective. */
static snow_status find_bounds(const fit *f, snow_comm *comm,
                               double out[BOUNDS]) {
    begin_bounds(out);
    for (size_t n = 0; n < f->hull.count; n++)
        add_voxel(f, f->hull.points[n], out);
    if (comm)
        SNOW_TRY(snow_comm_reduce_doubles(comm, out, BOUNDS, SNOW_REDUCE_MAX));
    if (!(out[0] > -INFINITY))
        bound_box(f, out);
    return SNOW_STATUS_OK;
}

/* --- the view ------------------------------------------------------------- */

static snow_status place_cameras(fit *f, const double *azimuths,
                                 const snow_view *view) {
    f->view = view;
    for (size_t n = 0; n < f->count; n++) {
        snow_view turned = *view;
        turned.azimuth = azimuths ? azimuths[n] : view->azimuth;
        SNOW_TRY(
            snow_camera_make(f->context, &f->whole, &turned, &f->cameras[n]));
        find_margin(f, &f->cameras[n], f->margins[n]);
    }
    return SNOW_STATUS_OK;
}

static void move_target(const fit *f, const double step[3], snow_view *view) {
    const snow_camera *c = &f->cameras[0];
    const double *axes[3] = {c->right, c->up, c->back};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            view->target[i] += axes[k][i] * step[k];
}

/* The middle of the bounds before the first camera.  In depth it is that of
 * the volume, unless a parallel camera turns about it. */
static void aim(const fit *f, const double bounds[BOUNDS], snow_view *view) {
    const bool turns = f->count > 1 && !(view->fov > 0);
    const double step[3] = {(bounds[0] - bounds[1]) / 2,
                            (bounds[2] - bounds[3]) / 2,
                            turns ? (bounds[4] - bounds[5]) / 2 : 0};
    view->has_target = true;
    for (int i = 0; i < 3; i++) {
        view->target[i] = f->whole.matrix[i][3];
        for (int axis = 0; axis < 3; axis++)
            view->target[i] += f->whole.matrix[i][axis] *
                               ((double)f->whole.dims[axis] - 1) / 2;
    }
    move_target(f, step, view);
}

/* Collective.  One walk for what can be seen. */
static snow_status find_object(fit *f, snow_comm *comm,
                               const snow_volume *volume) {
    if (!f->transfer)
        return SNOW_STATUS_OK;
    snow_status status = snow_fit_object_make(
        f->context, &f->whole, f->settings.opacity_length, &f->object);
    if (status == SNOW_STATUS_OK)
        status = visit_slabs(f, volume, add_row);
    if (comm)
        status = snow_comm_agree_status(comm, status);
    const size_t step = (f->count - 1) / SIDES + 1;
    for (size_t n = 0; n < f->count && status == SNOW_STATUS_OK; n += step)
        status = snow_fit_object_see(&f->object, comm, &f->cameras[n]);
    return status;
}

/* The first bounds give the target, the last ones how far what is shown is from
 * it. */
static snow_status fit_view(fit *f, snow_comm *comm, const snow_volume *volume,
                            const double *azimuths, snow_view *view) {
    double bounds[BOUNDS], zoom = view->zoom, reach = 0;
    SNOW_TRY(place_cameras(f, azimuths, view));
    SNOW_TRY(find_object(f, comm, volume));
    SNOW_TRY(find_hull(f, comm, volume));
    SNOW_TRY(find_bounds(f, comm, bounds));
    view->zoom = 1;
    aim(f, bounds, view);
    SNOW_TRY(place_cameras(f, azimuths, view));
    if (f->count == 1 && !(view->fov > 0)) {
        /* Those of one parallel picture, around its middle. */
        const double at[3] = {(bounds[0] + bounds[1]) / 2,
                              (bounds[2] + bounds[3]) / 2, 0};
        begin_bounds(bounds);
        add_place(f->view, f->cameras, at, f->margins[0], bounds + PLACES);
    } else
        SNOW_TRY(find_bounds(f, comm, bounds));
    if (f->count == 1 && view->fov > 0) {
        /* Perspective moves the middle of the bounds, which is put right again.
         */
        const double half = f->cameras[0].pitch / 2, *in = bounds + PLACES;
        const double step[3] = {(in[0] - in[1]) / 2 * half *
                                    snow_view_room(view),
                                (in[2] - in[3]) / 2 * half * view->height, 0};
        move_target(f, step, view);
        SNOW_TRY(place_cameras(f, azimuths, view));
        SNOW_TRY(find_bounds(f, comm, bounds));
    }
    for (int i = PLACES; i < BOUNDS; i++)
        reach = fmax(reach, bounds[i]);
    view->zoom = zoom * FILLED / reach;
    return SNOW_STATUS_OK;
}

/* The surface of mode iso is where values begin. */
static snow_status choose_transfer(fit *f, snow_transfer **own) {
    const double iso = f->settings.iso;
    const snow_color_point white = {iso, 1, 1, 1};
    const snow_opacity_point step[] = {{iso, 0}, {iso, 1}};
    if (f->settings.mode != SNOW_MODE_OVER && f->settings.mode != SNOW_MODE_ISO)
        f->transfer = NULL;
    if (f->settings.mode != SNOW_MODE_ISO || !f->transfer)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_transfer_new(f->context, &white, 1, step, 2, own));
    f->transfer = *own;
    return SNOW_STATUS_OK;
}

/* The voxels are measured, which is no stage of a picture. */
static snow_status fit_watched(fit *f, snow_comm *comm,
                               const snow_volume *volume,
                               const double *azimuths, snow_view *view) {
    snow_monitor monitor;
    snow_monitor_begin(f->context, &monitor, f->settings.stop,
                       f->settings.stop_user);
    monitor.last = SNOW_STAGE_READ;
    return snow_monitor_end(&monitor,
                            fit_view(f, comm, volume, azimuths, view));
}

snow_status snow_view_fit(snow_comm *comm, const snow_volume *volume,
                          const snow_transfer *transfer,
                          const snow_settings *settings, const double *azimuths,
                          size_t count, snow_view *view) {
    fit f = {.context = volume->context,
             .transfer = transfer,
             .hull = {.context = volume->context},
             .object = {.context = volume->context}};
    snow_transfer *own = NULL;
    snow_view fitted;
    snow_volume_whole(volume, &f.whole);
    f.count = azimuths ? count : 1;
    SNOW_TRY(SNOW_RECORD_READ(f.context, snow_view, view, &fitted));
    SNOW_TRY(SNOW_RECORD_READ(f.context, snow_settings, settings, &f.settings));
    if (fitted.has_position || fitted.has_target || !f.count)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_settings_resolve(f.context, &f.whole, &f.settings));
    snow_status status = choose_transfer(&f, &own);
    if (status == SNOW_STATUS_OK)
        status = SNOW_RESERVE(f.context, f.cameras, 0, f.count);
    if (status == SNOW_STATUS_OK)
        status = SNOW_RESERVE(f.context, f.margins, 0, f.count);
    if (comm)
        status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK)
        status = fit_watched(&f, comm, volume, azimuths, &fitted);
    snow_release(f.context, f.cameras);
    snow_release(f.context, f.margins);
    snow_release(f.context, f.rows);
    snow_hull_free(&f.hull);
    snow_fit_object_free(&f.object);
    snow_transfer_free(own);
    return status == SNOW_STATUS_OK
               ? SNOW_RECORD_FILL(f.context, snow_view, &fitted, view)
               : status;
}
