/* render/shear_warp/axes.c - encodings along the three axes, which are kept
 * from picture to picture, so that a view that turns has no hitch.
 *
 *   view     z  z  z  z  z | x  x  x ... x | z  z
 *   made     z              |               |         kept: z, x
 *   of x        1  2  3  4  |                         bands, after pictures
 *
 * They have a bound of their own: the volume's bytes twice, or KEPT_LEAST where
 * that is more, and no more than is left of the context's limit when another
 * volume of the same size is read. */
#include "base/vec3.h"
#include "render/shear_warp/internal.h"

#include <math.h>
#include <string.h>

#define KEPT_LEAST (UINT64_C(256) << 20)
/* Turns from picture to picture that are gone on with, and how far: radians. */
#define TURN_LEAST 1e-4
#define TURN_MOST 0.35
#define TURN_AHEAD 0.8
#define PICTURES_AHEAD 64
/* Of a picture's time, for what is made behind it in any case. */
#define SHARE 0.1

static void forget(snow_value_encoding *kept) {
    kept->key.generation = 0;
    snow_value_store_fini(&kept->store);
}

bool snow_value_forget_axes(snow_value_path *path) {
    uint64_t bytes = snow_value_axes_bytes(path);
    for (int axis = 0; axis < 3; axis++)
        forget(&path->axes.kept[axis]);
    return bytes > 0;
}

uint64_t snow_value_axes_bytes(const snow_value_path *path) {
    uint64_t bytes = 0;
    for (int axis = 0; axis < 3; axis++)
        bytes += snow_value_store_bytes(&path->axes.kept[axis].store);
    return bytes;
}

static uint64_t size_of(const snow_volume *volume) {
    const int64_t *dims = volume->info.dims;
    return (uint64_t)(dims[0] * dims[1] * dims[2]) *
           snow_type_size(volume->info.type);
}

uint64_t snow_value_axes_most(const snow_volume *volume) {
    const uint64_t twice = 2 * size_of(volume);
    return twice > KEPT_LEAST ? twice : KEPT_LEAST;
}

/* Returns whether so many bytes more may be kept. */
static bool has_room(const snow_value_path *path, const snow_volume *volume,
                     uint64_t bytes) {
    const snow_context *context = path->context;
    return snow_value_axes_bytes(path) +
                   snow_value_store_bytes(&path->made.store) + bytes <=
               snow_value_axes_most(volume) &&
           (!context->limit ||
            context->bytes + bytes + size_of(volume) <= context->limit);
}

void snow_value_change_axis(snow_value_path *path,
                            const snow_value_params *params) {
    snow_value_encoding *kept = path->axes.kept;
    const uint64_t generation = params->volume->generation;
    const int axis = params->placement->slice_axis,
              here = path->made.key.slice_axis;
    snow_value_order order;
    for (int n = 0; n < 3; n++)
        if (kept[n].key.generation != generation)
            forget(&kept[n]);
    if (path->made.key.generation != generation || here == axis ||
        params->volume->is_part)
        return;
    bool known = kept[axis].key.generation != 0;
    if (!known &&
        snow_value_order_make(path, params, true, &order) != SNOW_STATUS_OK)
        return;
    uint64_t bytes = known ? 0 : snow_value_store_expect(&order.params);
    for (int n = 0; n < 3 && !has_room(path, params->volume, bytes); n++)
        if (n != axis)
            forget(&kept[n]);
    if (!known && !has_room(path, params->volume, bytes))
        return; /* it is encoded in the place of the other */
    snow_value_move(&kept[here], &path->made);
    if (known)
        snow_value_move(&path->made, &kept[axis]);
}

/* --- ahead ---------------------------------------------------------------- */

/* The placement along the next axis, and how many pictures it is until then; 0:
 * the view does not turn to another axis. */
static int find_next(const snow_value_params *params, double from[3][3],
                     double to[3][3], snow_placement *out) {
    double turn[3][3], across[3];
    snow_cross(from[2], to[2], across);
    const double angle = atan2(snow_length(across), snow_dot(from[2], to[2]));
    snow_view view = *params->view;
    view.azimuth = view.elevation = view.roll = 0;
    view.has_position = view.has_target = view.has_view_up = false;
    memcpy(view.up, to[1], sizeof view.up);
    memcpy(view.back, to[2], sizeof view.back);
    if (!(angle > TURN_LEAST && angle < TURN_MOST))
        return 0;
    /* The turn that leads from one camera to the next. */
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            turn[i][j] = from[0][j] * to[0][i] + from[1][j] * to[1][i] +
                         from[2][j] * to[2][i];
    for (int n = 1; n <= PICTURES_AHEAD && n * angle < TURN_AHEAD; n++) {
        for (int k = 0; k < 2; k++) {
            double *v = k ? view.back : view.up;
            const double was[3] = {v[0], v[1], v[2]};
            for (int i = 0; i < 3; i++)
                v[i] = snow_dot(turn[i], was);
            snow_normalize(v);
        }
        if (snow_placement_make(params->volume->context, &params->volume->info,
                                &view, out) != SNOW_STATUS_OK)
            return 0;
        if (out->slice_axis != params->placement->slice_axis)
            return n;
    }
    return 0;
}

/* Begins the encoding along an axis. */
static bool begin_axis(snow_value_path *path, const snow_value_params *params,
                       snow_value_order *order, snow_value_encoding *kept) {
    forget(kept);
    kept->store.context = path->context;
    kept->interesting = -1;
    order->params.in_parts = true;
    if (!has_room(path, params->volume,
                  snow_value_store_expect(&order->params)) ||
        snow_value_store_begin(&kept->store, &order->params) != SNOW_STATUS_OK)
        return false;
    kept->key = snow_value_key_of(path, params, params->volume->generation);
    return true;
}

/* Items more of it, so that it is whole when it is needed in so many pictures;
 * and what can be made in some seconds.  Errors: those of encoding. */
static snow_status go_on(snow_value_store *store,
                         const snow_value_store_params *params, int pictures,
                         double seconds) {
    const double until = snow_seconds() + seconds;
    const int64_t least = params->threads; /* or some of them would wait */
    int64_t left = snow_value_store_left(store);
    int64_t some = (left + pictures - 1) / pictures;
    while (left && (some || snow_seconds() < until)) {
        SNOW_TRY(
            snow_value_store_go_on(store, params, some > least ? some : least));
        left = snow_value_store_left(store);
        some = 0;
    }
    return SNOW_STATUS_OK;
}

void snow_value_prepare_axis(snow_value_path *path,
                             const snow_value_params *params, double seconds) {
    snow_value_axes *axes = &path->axes;
    const uint64_t generation = params->volume->generation;
    const bool turns = axes->camera_of == generation;
    const snow_placement *p = params->placement;
    double from[3][3];
    memcpy(from, axes->camera, sizeof from);
    memcpy(axes->camera[0], p->right, sizeof p->right);
    memcpy(axes->camera[1], p->up, sizeof p->up);
    memcpy(axes->camera[2], p->back, sizeof p->back);
    axes->camera_of = generation;
    if (!turns || params->shared || params->volume->is_part ||
        path->lattice.perspective || path->made.key.generation != generation)
        return;
    snow_placement next;
    snow_value_order order;
    snow_value_params ahead = *params;
    ahead.placement = ahead.stored = &next;
    int pictures = find_next(params, from, axes->camera, &next);
    if (!pictures ||
        !snow_value_fits(&params->volume->info, &next, params->settings) ||
        snow_value_order_make(path, &ahead, true, &order) != SNOW_STATUS_OK)
        return;
    snow_value_encoding *kept = &axes->kept[next.slice_axis];
    if (!(snow_value_fits_key(path, kept, &ahead, generation) ||
          begin_axis(path, &ahead, &order, kept)) ||
        go_on(&kept->store, &order.params, pictures, seconds * SHARE) !=
            SNOW_STATUS_OK)
        forget(kept);
}
