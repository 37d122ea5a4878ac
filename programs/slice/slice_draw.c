/* slice_draw.c - the picture of a slice, or of several beside one another. */
#include "picture/annotations.h"
#include "run/log.h"
#include "slice/slice.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <snowglass/overlay.h>

/* --- one slice ------------------------------------------------------------ */

/* A slice that was read alone, or with those around it, is counted in its
 * volume, in whose size the zoom of the view counts. */
static snow_status find_view(slice_work *w, int64_t part, snow_view *view,
                             int64_t *index) {
    static const char *const axes[] = {"x", "y", "z"};
    int axis;
    *view = w->places[part].view;
    *index = w->places[part].index - w->first;
    if (w->kind != SLICE_ONE)
        return SNOW_STATUS_OK;
    view->width = (int)w->opts.size[0];
    view->height = (int)w->opts.size[1];
    snow_status status =
        snow_slice_view(w->context, snow_volume_get_info(w->volume),
                        axes[w->axis], view, &axis);
    w->places[part].view = *view;
    w->size[0] = view->width;
    w->size[1] = view->height;
    return status;
}

/* The slice of each channel, in colours, or of the first one in numbers. */
static snow_status draw_values(slice_work *w, snow_volume *const *volumes,
                               int64_t index, const snow_view *view,
                               snow_image **image) {
    channel_set channels = w->channels;
    snow_status status = snow_slice_render(volumes[0], index, w->transfer, view,
                                           &w->settings, image);
    if (status != SNOW_STATUS_OK || !w->transfer || !channels.list.count)
        return status;
    memcpy(channels.volumes, volumes, sizeof channels.volumes);
    return channels_add_slices(&channels, w->context, index, view, &w->settings,
                               image);
}

static snow_status draw_slab(slice_work *w, int axis, int64_t index,
                             snow_volume *const *volumes, const snow_view *view,
                             snow_image **image) {
    const int count =
        w->transfer && w->channels.list.count ? w->channels.list.count : 1;
    slab_volumes made;
    snow_view seen;
    snow_status status = slab_project(w->context, &w->slabs[axis], volumes,
                                      count, axis, index, &made);
    if (status != SNOW_STATUS_OK)
        return status;
    status = slab_see(w->context, w->volume, &made, axis, view, &seen);
    if (status == SNOW_STATUS_OK)
        status = draw_values(w, made.volumes, 0, &seen, image);
    slab_free(&made);
    return status;
}

/* A slab has the overlay of its middle slice. */
static snow_status draw(slice_work *w, int64_t part, int64_t index,
                        const snow_view *view, snow_image **out) {
    const int axis = w->places[part].axis;
    snow_volume *volumes[SNOW_CHANNELS_MAX];
    snow_image *image = NULL;
    memcpy(volumes, w->channels.volumes, sizeof volumes);
    volumes[0] = w->volume;
    snow_status status = w->slabs[axis].half
                             ? draw_slab(w, axis, index, volumes, view, &image)
                             : draw_values(w, volumes, index, view, &image);
    if (status == SNOW_STATUS_OK)
        status = layers_lay_slice(&w->opts, &w->layers, index, view,
                                  &w->settings, w->context, &image);
    if (status == SNOW_STATUS_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

/* The view of a slice of `from` on that slice, read alone: at the same scale,
 * whatever the zooms count in. */
static snow_status find_view_alone(const slice_work *from, slice_work *w,
                                   snow_view *view) {
    static const char *const axes[] = {"x", "y", "z"};
    const snow_view place = w->places[0].view;
    snow_view whole = place, alone = place;
    int axis;
    snow_status status = snow_slice_view(from->context, &from->whole,
                                         axes[w->axis], &whole, &axis);
    if (status == SNOW_STATUS_OK)
        status = snow_slice_view(from->context, snow_volume_get_info(w->volume),
                                 axes[w->axis], &alone, &axis);
    alone.zoom *= place.zoom / whole.zoom;
    *view = alone;
    return status;
}

static snow_status draw_from_file(slice_work *w, int64_t part,
                                  snow_image **out) {
    slice_work *alone = calloc(1, sizeof *alone); /* large */
    snow_view view;
    if (!alone)
        return SNOW_STATUS_NO_MEMORY;
    int done = slice_read_alone(w, part, alone);
    snow_status status =
        done == CONTINUE ? find_view_alone(w, alone, &view) : (snow_status)done;
    if (status == SNOW_STATUS_OK)
        status =
            draw(alone, 0, alone->places[0].index - alone->first, &view, out);
    slice_close_alone(alone);
    free(alone);
    return status;
}

snow_status slice_draw_part(slice_work *w, int64_t part, snow_image **out) {
    snow_view view;
    int64_t index;
    const double begin = seconds_now();
    if (w->in_file)
        return draw_from_file(w, part, out);
    snow_status status = find_view(w, part, &view, &index);
    if (status == SNOW_STATUS_OK)
        status = draw(w, part, index, &view, out);
    w->frame = seconds_now() - begin;
    return status;
}

/* --- several -------------------------------------------------------------- */

/* Where there are no slices the picture is clear, or has no values. */
static snow_status new_sheet(slice_work *w) {
    const int parts = w->transfer ? 4 : 1;
    snow_status status =
        snow_image_new(w->context, w->size[0], w->size[1], parts, &w->image);
    const size_t count = (size_t)w->size[0] * (size_t)w->size[1];
    for (size_t n = 0; n < count && parts == 1 && status == SNOW_STATUS_OK; n++)
        snow_image_pixels(w->image)[n] = NAN;
    return status;
}

snow_status slice_draw(slice_work *w) {
    if (w->kind == SLICE_ONE)
        return slice_draw_part(w, 0, &w->image);
    const double begin = seconds_now();
    snow_status status = new_sheet(w);
    for (int64_t n = 0; n < w->count && status == SNOW_STATUS_OK; n++) {
        snow_image *image = NULL;
        status = slice_draw_part(w, n, &image);
        if (status != SNOW_STATUS_OK)
            break;
        status =
            snow_slice_lay(image, &w->places[n],
                           w->kind == SLICE_ORTHO && w->transfer, w->image);
        snow_image_free(image);
    }
    w->frame = seconds_now() - begin;
    return status;
}

/* --- what is drawn over it ------------------------------------------------ */

snow_view slice_whole_view(const slice_work *w) {
    snow_view view = w->places[0].view;
    const double across = view.width * (1 - view.strip);
    const double side = fmin(across, view.height);
    view.width = w->size[0];
    view.height = w->size[1];
    view.strip = w->strip;
    view.zoom *= side / fmin(view.width * (1 - view.strip), view.height);
    return view;
}

static double text_height(const slice_work *w, double share) {
    const snow_view *view = &w->places[0].view;
    return fmax(9, rint(share * fmin(view->width, view->height)));
}

/* In the upper left of each, or the upper right where a title is. */
static snow_status add_numbers(const slice_work *w, snow_overlay *overlay) {
    const double height = text_height(w, 0.05), margin = 0.6 * height;
    snow_status status = SNOW_STATUS_OK;
    const bool right = w->opts.title || w->opts.annotate.text;
    for (int64_t n = 0; n < w->count && status == SNOW_STATUS_OK; n++) {
        const snow_slice_place *place = &w->places[n];
        char text[24];
        snprintf(text, sizeof text, "%" PRId64, place->index);
        status = snow_overlay_text(
            overlay, place->x + (right ? place->view.width - margin : margin),
            place->y + margin, right, 0, height, text);
    }
    return status;
}

/* The letters of each of the three, or of the first one of a grid. */
static snow_status add_letters(const slice_work *w, snow_overlay *overlay) {
    static const double shares[4][2] = {{0, 0.5}, {1, 0.5}, {0.5, 0}, {0.5, 1}};
    const double height =
        fmin(snow_overlay_text_height(overlay), text_height(w, 0.06));
    const double margin =
        0.02 * fmin(w->places[0].view.width, w->places[0].view.height);
    snow_status status = SNOW_STATUS_OK;
    const int64_t count = w->kind == SLICE_GRID ? 1 : w->count;
    for (int n = 0; n < 4 * count && status == SNOW_STATUS_OK; n++) {
        const snow_slice_place *place = &w->places[n / 4];
        const double *share = shares[n % 4];
        char letters[4][4];
        status =
            snow_view_orientation(w->context, &w->whole, &place->view, letters);
        if (status == SNOW_STATUS_OK && *letters[n % 4])
            status = snow_overlay_text(
                overlay,
                place->x + margin + share[0] * (place->view.width - 2 * margin),
                place->y + margin +
                    share[1] * (place->view.height - 2 * margin),
                share[0], share[1], height, letters[n % 4]);
    }
    return status;
}

/* In each slice those that lie in it. */
static snow_status add_measures(const slice_work *w, snow_overlay *overlay) {
    const snow_volume_info *info = snow_volume_get_info(w->volume);
    snow_status status = SNOW_STATUS_OK;
    for (int64_t n = 0; n < w->count && status == SNOW_STATUS_OK; n++) {
        const snow_slice_place *place = &w->places[n];
        status = measures_draw(w->measures, info, &place->view, place->x,
                               place->y, place->axis, place->index, overlay);
    }
    return status;
}

static snow_status add_all(const void *user, snow_overlay *overlay) {
    const slice_work *w = user;
    snow_status status = SNOW_STATUS_OK;
    if (!w->opts.no_labels)
        status = add_letters(w, overlay);
    if (status == SNOW_STATUS_OK && !w->opts.no_labels && w->kind == SLICE_GRID)
        status = add_numbers(w, overlay);
    if (status == SNOW_STATUS_OK && w->measures)
        status = add_measures(w, overlay);
    return status;
}

snow_status slice_make_overlay(slice_work *w, snow_overlay **out) {
    options opts = w->opts;
    opts.no_labels |= w->kind != SLICE_ONE; /* each has its own */
    picture_annotations annotations = {&opts,
                                       *snow_volume_get_info(w->volume),
                                       slice_whole_view(w),
                                       w->transfer,
                                       {0, 0},
                                       w->transfer ? &w->channels : NULL,
                                       layers_legend(&w->layers, false),
                                       .measures = NULL};
    const bool several = w->kind != SLICE_ONE && slice_has_colors(w);
    if (several && (!w->opts.no_labels || w->measures)) {
        annotations.more = add_all;
        annotations.user = w;
    }
    if (w->kind == SLICE_ONE) {
        annotations.measures = w->measures;
        annotations.axis = w->axis;
        annotations.index = &w->places[0].index;
    }
    annotations_find_unit(&opts, w->volume, false, &annotations.info);
    return annotations_make(&annotations, 0, -1, NULL, w->context, out);
}
