/* picture.c - pictures and slices of volumes. */
#include "core.h"

#include "picture/light.h"

#include <math.h>
#include <snowglass/overlay.h>
#include <string.h>

static bool make_view(volume_object *o, const char *name, PyObject *given,
                      snow_view *view) {
    context_object *c = o->context;
    snow_status status = SNOW_STATUS_OK;
    snow_view_init(view);
    name = snow_view_name_for(snow_volume_get_info(o->volume), name);
    status = snow_view_from_name(c->context, name, view);
    if (status != SNOW_STATUS_OK) {
        context_set_error(status, snow_context_message(c->context));
        return false;
    }
    return record_fill_view(given, view);
}

/* {"left": ((x, y, z), (x, y, z)), ...}: the camera's back and up of each view,
 * and of the default one, which has no name. */
PyObject *volume_views(PyObject *self, PyObject *nothing) {
    volume_object *o = (volume_object *)self;
    (void)nothing;
    if (!volume_use(o, Py_None))
        return NULL;
    PyObject *all = PyDict_New();
    for (size_t n = 0; all && (n == 0 || snow_view_name(n - 1)); n++) {
        const char *name = n ? snow_view_name(n - 1) : NULL;
        snow_view v;
        PyObject *one = NULL;
        if (make_view(o, name, Py_None, &v))
            one = Py_BuildValue("((ddd)(ddd))", v.back[0], v.back[1], v.back[2],
                                v.up[0], v.up[1], v.up[2]);
        if (!one || PyDict_SetItemString(all, name ? name : "", one))
            Py_CLEAR(all);
        Py_XDECREF(one);
    }
    context_leave(o->context, SNOW_STATUS_OK);
    return all;
}

/* A copy of the frame's depths, which last until its next picture. */
static snow_status copy_depth(const volume_object *o, snow_image **out) {
    const snow_image *depth = snow_frame_depth(o->frame);
    if (!depth)
        return SNOW_STATUS_OK;
    int width = snow_image_width(depth), height = snow_image_height(depth);
    snow_status status =
        snow_image_new(o->context->context, width, height, 1, out);
    if (status == SNOW_STATUS_OK)
        memcpy(snow_image_pixels(*out), snow_image_pixels((snow_image *)depth),
               (size_t)width * (size_t)height * sizeof(float));
    return status;
}

typedef struct request {
    volume_object *volume;
    transfer_object *transfer;
    snow_layer layers[SNOW_LAYERS_MAX + 1]; /* channels, then an overlay */
    int count, mixing;                      /* of them, of which channels */
    bool mixed;   /* the volume is one of channels, too */
    bool outline; /* of the overlay of a slice, the borders alone */
    double
        shares[SNOW_LAYERS_MAX + 2]; /* of light: the volume's, the layers' */
    snow_view view;
    snow_settings settings;
    const double *azimuths; /* all that are to fit */
    size_t azimuth_count;
    bool fit, empty; /* the latter: nothing is seen */
    double shown;    /* voxels that the looks show; below 0: as of the frame */
    snow_image *image, *depth;
} request;

static snow_status draw_one(const request *r, const snow_volume *volume,
                            const snow_transfer *transfer, int64_t index,
                            snow_image **out) {
    return index < 0 ? snow_frame_render(r->volume->frame, volume, transfer,
                                         &r->view, &r->settings, out)
                     : snow_slice_render(volume, index, transfer, &r->view,
                                         &r->settings, out);
}

/* Overlays over a slice, whose share of light says whether opacities are
 * asked. */
static snow_status lay_over(request *r, int64_t index) {
    snow_status status = SNOW_STATUS_OK;
    for (int n = r->mixing; n < r->count && index >= 0 && !status; n++) {
        const snow_layer *layer = &r->layers[n];
        status = light_lay_slice(
            r->volume->context->context, layer->volume, layer->transfer,
            light_cover(layer->transfer, r->shares[n + 1] > 0, -1, r->outline),
            r->outline, index, &r->view, &r->settings, &r->image);
    }
    return status;
}

/* A slice, or from -1 a picture: of the volume, or of all channels, whose light
 * adds up. */
static snow_status draw_apart(request *r, bool added, int64_t index) {
    snow_context *context = r->volume->context->context;
    snow_image *one = NULL, *sum = NULL;
    snow_status status =
        draw_one(r, r->volume->volume,
                 r->transfer ? r->transfer->transfer : NULL, index, &one);
    if (!status && !added) {
        r->image = one;
        return lay_over(r, index);
    }
    if (!status)
        status = light_add(context, one, r->shares[0], &sum);
    for (int n = 0; n < r->mixing && !status; n++) {
        const snow_layer *layer = &r->layers[n];
        snow_image_free(one);
        one = NULL;
        status = draw_one(r, layer->volume, layer->transfer, index, &one);
        if (!status)
            status = light_add(context, one, r->shares[n + 1], &sum);
    }
    snow_image_free(one);
    if (status) {
        snow_image_free(sum);
        return status;
    }
    light_limit(sum);
    r->image = sum;
    return lay_over(r, index);
}

/* Whether nothing is seen, as the command line finds it. */
static bool is_empty(snow_image *image) {
    const size_t channels = (size_t)snow_image_channels(image);
    const size_t count = (size_t)snow_image_width(image) *
                         (size_t)snow_image_height(image) * channels;
    const float *pixels = snow_image_pixels(image);
    for (size_t n = channels - 1; n < count; n += channels)
        if (channels == 1 ? !isnan(pixels[n]) : pixels[n] != 0)
            return false;
    return true;
}

/* Adds the voxels of a volume that a look shows; those of a file are left out,
 * as they would all be read. */
static snow_status add_shown(request *r, const snow_volume *volume,
                             const snow_transfer *transfer) {
    const int64_t *dims = snow_volume_get_info(volume)->dims;
    double hidden = 1;
    if (!snow_volume_voxels(volume))
        return SNOW_STATUS_OK;
    const snow_status status = snow_transfer_sparse_ratio(
        transfer, volume, r->settings.threshold, &hidden);
    r->shown +=
        (1 - hidden) * (double)dims[0] * (double)dims[1] * (double)dims[2];
    return status;
}

/* Why a picture is empty. The frame's count is of the look that its voxels were
 * encoded for, which may have shown more than this one. */
static snow_status count_shown(request *r) {
    const volume_object *o = r->volume;
    if (!r->empty || r->settings.mode != SNOW_MODE_OVER ||
        !snow_volume_voxels(o->volume))
        return SNOW_STATUS_OK;
    r->shown = 0;
    snow_status status = add_shown(r, o->volume, r->transfer->transfer);
    for (int n = 0; n < r->count && !status; n++)
        status = add_shown(r, r->layers[n].volume, r->layers[n].transfer);
    return status;
}

static snow_status draw(request *r) {
    volume_object *o = r->volume;
    const bool added = r->mixed && r->settings.mode != SNOW_MODE_OVER;
    const int apart = added ? r->mixing : 0;
    snow_status status = SNOW_STATUS_OK;
    if (!o->frame)
        status = snow_frame_new(o->context->context, &o->frame);
    if (!status)
        status = snow_frame_set_layers(o->frame, r->layers + apart,
                                       r->count - apart);
    if (!status && r->fit)
        status = snow_view_fit(
            NULL, o->volume, r->mixing ? NULL : r->transfer->transfer,
            &r->settings, r->azimuths, r->azimuth_count, &r->view);
    if (!status)
        status = draw_apart(r, added, -1);
    r->empty = !status && is_empty(r->image);
    if (!status)
        status = count_shown(r);
    if (!status && r->settings.depth)
        status = copy_depth(o, &r->depth);
    return status;
}

/* What the last picture took. */
static PyObject *stats_of(const request *r) {
    const snow_stats *s = snow_frame_stats(r->volume->frame);
    const bool counted = r->shown >= 0;
    const long long interesting =
        counted ? llround(r->shown) : (long long)s->interesting;
    const double sparse =
        counted && s->voxels > 0
            ? fmax(0, 1 - (double)interesting / (double)s->voxels)
            : s->sparse_ratio;
    return Py_BuildValue(
        "{sOsssssssssisLsLsdsd}", "empty", r->empty ? Py_True : Py_False,
        "method", snow_method_name(s->method), "encoding",
        snow_encoding_name(s->encoding), "kernel", snow_kernel_name(s->kernel),
        "isa", snow_isa_name(s->isa), "threads", s->threads, "voxels",
        (long long)s->voxels, "interesting", interesting, "sparse_ratio",
        sparse, "seconds", s->seconds_frame);
}

/* Directions of the camera that are all to fit, or NULL with none of them;
 * false with an exception. */
static bool read_azimuths(PyObject *given, double **azimuths, size_t *count) {
    *azimuths = NULL;
    *count = 0;
    if (given == Py_None)
        return true;
    Py_ssize_t size = PySequence_Size(given);
    if (size < 0)
        return false;
    double *all = PyMem_Malloc((size_t)(size + 1) * sizeof *all);
    if (!all)
        PyErr_NoMemory();
    if (!all || !record_numbers("azimuths", given, size, false, all)) {
        PyMem_Free(all);
        return false;
    }
    *azimuths = all;
    *count = (size_t)size;
    return true;
}

/* An image of Python, with what annotations will need; NULL: none was made, or
 * an exception. */
static PyObject *finish_image(PyObject *type, const request *r,
                              const snow_volume_info *info) {
    if (!r->image)
        return NULL;
    PyObject *image =
        image_make((PyTypeObject *)type, r->volume->context, r->image);
    image_object *made = (image_object *)image;
    if (!made)
        return NULL;
    made->transfer = Py_XNewRef((PyObject *)r->transfer);
    made->info = *info;
    made->view = r->view;
    made->placed = true;
    return image;
}

static PyObject *answer(PyObject *type, const request *r, PyObject *image,
                        PyObject *stats) {
    const double *at = r->view.target;
    PyObject *depth = NULL, *target = NULL, *out = NULL;
    if (r->depth)
        depth = image_make((PyTypeObject *)type, r->volume->context, r->depth);
    if (r->view.has_target && !PyErr_Occurred())
        target = Py_BuildValue("(ddd)", at[0], at[1], at[2]);
    if (image && stats && !PyErr_Occurred())
        out = Py_BuildValue("(OOOdO)", image, depth ? depth : Py_None,
                            target ? target : Py_None, r->view.zoom, stats);
    Py_XDECREF(target);
    Py_XDECREF(depth);
    return out;
}

/* (volume, transfer, whether it is a channel), ... of the picture's context,
 * whose lock is held, channels first; false with an exception. */
static bool read_layers(PyObject *given, request *r) {
    const Py_ssize_t count = PyTuple_Size(given);
    if (count > SNOW_LAYERS_MAX + 1)
        PyErr_SetString(PyExc_ValueError, "too many channels");
    for (Py_ssize_t n = 0; n < count && !PyErr_Occurred(); n++) {
        PyObject *volume, *transfer;
        int mixes;
        if (!PyArg_ParseTuple(PyTuple_GetItem(given, n), "O!O!pd", volume_type,
                              &volume, transfer_type, &transfer, &mixes,
                              &r->shares[n + 1]))
            return false;
        if (!volume_is_open((volume_object *)volume))
            return false;
        r->layers[n] =
            (snow_layer){((volume_object *)volume)->volume,
                         ((transfer_object *)transfer)->transfer, mixes};
        r->mixing += mixes;
    }
    r->count = (int)count;
    return !PyErr_Occurred();
}

/* render(Image, transfer, view, view's fields, settings, fit, azimuths or None,
 * progress, layers, whether they are mixed, share, marks of a legend or None)
 * -> (image, depth or None, the view's target or None, zoom, stats) */
PyObject *volume_render(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *type, *transfer, *view, *settings, *azimuths, *progress, *layers;
    PyObject *stats = NULL, *marks;
    const char *name;
    double *turns;
    request r = {.volume = o, .shown = -1};
    snow_volume_info info;
    snow_status status = SNOW_STATUS_OK;
    int fit, mixed;
    snow_settings_init(&r.settings);
    if (!PyArg_ParseTuple(args, "OO!zOOpOOO!pdO", &type, transfer_type,
                          &transfer, &name, &view, &settings, &fit, &azimuths,
                          &progress, &PyTuple_Type, &layers, &mixed,
                          &r.shares[0], &marks) ||
        !record_fill_settings(settings, &r.settings) ||
        !read_azimuths(azimuths, &turns, &r.azimuth_count))
        return NULL;
    r.settings.stop = context_is_stopped;
    r.settings.stop_user = o->context;
    r.transfer = (transfer_object *)transfer;
    r.fit = fit;
    r.mixed = mixed;
    r.azimuths = turns;
    if (!volume_use(o, progress)) {
        PyMem_Free(turns);
        return NULL;
    }
    info = *snow_volume_get_info(o->volume);
    const bool viewed =
        read_layers(layers, &r) && make_view(o, name, view, &r.view) &&
        (marks == Py_None || image_leave_strip(r.transfer, marks, &r.view));
    if (viewed)
        CALL(o->context, status, draw(&r));
    PyMem_Free(turns);
    if (viewed && status == SNOW_STATUS_OK)
        stats = stats_of(&r);
    context_leave(o->context, status);
    PyObject *image = finish_image(type, &r, &info);
    PyObject *out = answer(type, &r, image, stats);
    Py_XDECREF(image);
    Py_XDECREF(stats);
    return out;
}

/* --- slices --------------------------------------------------------------- */

/* slice_axis(name) -> the grid's axis, and the nearest of the world */
PyObject *volume_slice_axis(PyObject *self, PyObject *name) {
    volume_object *o = (volume_object *)self;
    const char *text = PyUnicode_AsUTF8AndSize(name, NULL);
    int axis = 0, world = 0;
    snow_view view;
    snow_view_init(&view);
    if (!text || !volume_use(o, Py_None))
        return NULL;
    if (!context_leave(o->context,
                       snow_slice_view(o->context->context,
                                       snow_volume_get_info(o->volume), text,
                                       &view, &axis)))
        return NULL;
    for (int n = 1; n < 3; n++)
        if (fabs(view.back[n]) > fabs(view.back[world]) + 1e-6)
            world = n;
    return Py_BuildValue("(ii)", axis, world);
}

/* The view of a slice, beside which a strip is left to a legend; false with an
 * exception, or a status. */
static bool see_slice(request *r, const char *axis, PyObject *marks,
                      snow_status *status) {
    const snow_volume *volume = r->volume->volume;
    const snow_volume_info *info = snow_volume_get_info(volume);
    snow_context *context = r->volume->context->context;
    snow_view view = r->view;
    int found;
    *status = snow_slice_view(context, info, axis, &view, &found);
    if (marks != Py_None && !*status) {
        if (!image_leave_strip(r->transfer, marks, &view))
            return false;
        r->view.strip = view.strip;
        view = r->view;
        *status = snow_slice_view(context, info, axis, &view, &found);
    }
    r->view = view;
    return !*status;
}

/* slice_shown(transfer, axis) -> the first and the last slice that shows */
PyObject *volume_slice_shown(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *transfer;
    int axis;
    int64_t ends[2] = {0, 0};
    if (!PyArg_ParseTuple(args, "O!i", transfer_type, &transfer, &axis) ||
        !volume_use(o, Py_None))
        return NULL;
    snow_status status = SNOW_STATUS_OK;
    CALL(o->context, status,
         snow_slice_shown(o->volume, ((transfer_object *)transfer)->transfer,
                          axis, ends));
    return context_leave(o->context, status)
               ? Py_BuildValue("(LL)", (long long)ends[0], (long long)ends[1])
               : NULL;
}

/* What is asked of several slices in one picture. */
typedef struct sheet {
    const char *axis; /* of a grid; NULL: three through a point */
    int columns, rows, size[2];
    double at[3];
    const double *indices;
    int count;
    snow_image *image;
    PyObject *places;
} sheet;

/* Where part `n` lies. */
static snow_status place_part(const request *r, sheet *s, int n,
                              snow_slice_place *out) {
    snow_context *context = r->volume->context->context;
    const snow_volume_info *info = snow_volume_get_info(r->volume->volume);
    int size[2] = {s->size[0], s->size[1]};
    snow_slice_place_init(out);
    snow_status status =
        s->axis ? snow_slice_grid(context, info, s->axis, s->columns, s->rows,
                                  n, size, out)
                : snow_slice_ortho(context, info, s->at, n, size, out);
    if (s->axis && !status)
        out->index = (int64_t)s->indices[n];
    if (!s->image && !status)
        status = snow_image_new(context, size[0], size[1], 4, &s->image);
    return status;
}

static snow_status draw_sheet(request *r, sheet *s) {
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n < s->count && !status; n++) {
        snow_slice_place place;
        status = place_part(r, s, n, &place);
        r->view = place.view;
        if (!status)
            status = draw_apart(r, r->mixed, place.index);
        if (!status)
            status = snow_slice_lay(r->image, &place, !s->axis, s->image);
        snow_image_free(r->image);
        r->image = NULL;
    }
    return status;
}

/* (number, x, y, width, height, the letters of its edges) of each. */
static bool tell_places(const request *r, sheet *s) {
    snow_context *context = r->volume->context->context;
    const snow_volume_info *info = snow_volume_get_info(r->volume->volume);
    s->places = PyList_New(0);
    for (int n = 0; n < s->count && s->places; n++) {
        snow_slice_place p;
        char edges[4][4] = {"", "", "", ""};
        if (place_part(r, s, n, &p) ||
            snow_view_orientation(context, info, &p.view, edges))
            break;
        PyObject *row = Py_BuildValue("(Liiii(ssss))", (long long)p.index, p.x,
                                      p.y, p.view.width, p.view.height,
                                      edges[0], edges[1], edges[2], edges[3]);
        if (!row || PyList_Append(s->places, row))
            Py_CLEAR(s->places);
        Py_XDECREF(row);
    }
    return s->places != NULL;
}

/* The view of the whole picture, for the scale. */
static void widen_view(const sheet *s, snow_view *view) {
    const int width = snow_image_width(s->image);
    const int height = snow_image_height(s->image);
    view->zoom *= fmin(view->width, view->height) / fmin(width, height);
    view->width = width;
    view->height = height;
}

/* slices(Image, transfer, axis or None, columns, rows, (x, y, z), indices,
 * width, height, settings, layers, whether they are mixed, share, whether an
 * overlay is an outline, progress) -> (image, places) */
PyObject *volume_slices(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *type, *transfer, *settings, *layers, *indices, *out = NULL;
    PyObject *progress;
    double list[10000];
    int mixed, outline;
    request r = {.volume = o};
    sheet s = {.axis = NULL};
    snow_status status = SNOW_STATUS_OK;
    snow_settings_init(&r.settings);
    snow_view_init(&r.view);
    if (!PyArg_ParseTuple(args, "OO!zii(ddd)OiiOO!pdpO", &type, transfer_type,
                          &transfer, &s.axis, &s.columns, &s.rows, &s.at[0],
                          &s.at[1], &s.at[2], &indices, &s.size[0], &s.size[1],
                          &settings, &PyTuple_Type, &layers, &mixed,
                          &r.shares[0], &outline, &progress) ||
        !record_fill_settings(settings, &r.settings))
        return NULL;
    const Py_ssize_t count = PySequence_Size(indices);
    if (count < 0 || count > 10000 ||
        !record_numbers("indices", indices, count, false, list))
        return NULL;
    s.indices = list;
    s.count = (int)count;
    r.outline = outline;
    r.transfer = (transfer_object *)transfer;
    r.mixed = mixed;
    if (!volume_use(o, progress))
        return NULL;
    r.settings.stop = context_is_stopped;
    r.settings.stop_user = o->context;
    snow_volume_info info = *snow_volume_get_info(o->volume);
    if (read_layers(layers, &r))
        CALL(o->context, status, draw_sheet(&r, &s));
    if (!status && !PyErr_Occurred() && tell_places(&r, &s))
        widen_view(&s, &r.view);
    const bool fine = context_leave(o->context, status);
    r.image = s.image;
    PyObject *image = finish_image(type, &r, &info);
    if (image)
        ((image_object *)image)->placed = false;
    if (fine && image && s.places)
        out = Py_BuildValue("(OO)", image, s.places);
    Py_XDECREF(image);
    Py_XDECREF(s.places);
    return out;
}

/* slice(Image, axis, index, transfer or None for values, width, height,
 * settings, layers, whether they are mixed, share, marks of a legend or None,
 * whether an overlay is an outline) */
PyObject *volume_slice(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *type, *transfer, *settings, *layers, *marks;
    const char *axis;
    long long index;
    int width, height, mixed, outline;
    request r = {.volume = o};
    snow_status status = SNOW_STATUS_OK;
    snow_settings_init(&r.settings);
    snow_view_init(&r.view);
    if (!PyArg_ParseTuple(args, "OsLOiiOO!pdOp", &type, &axis, &index,
                          &transfer, &width, &height, &settings, &PyTuple_Type,
                          &layers, &mixed, &r.shares[0], &marks, &outline) ||
        !record_fill_settings(settings, &r.settings))
        return NULL;
    r.outline = outline;
    if (PyObject_TypeCheck(transfer, transfer_type))
        r.transfer = (transfer_object *)transfer;
    r.mixed = mixed;
    r.view.width = width;
    r.view.height = height;
    if (!volume_use(o, Py_None))
        return NULL;
    snow_volume_info info = *snow_volume_get_info(o->volume);
    if (read_layers(layers, &r) && see_slice(&r, axis, marks, &status))
        CALL(o->context, status, draw_apart(&r, r.mixed, index));
    const bool fine = context_leave(o->context, status);
    PyObject *image = finish_image(type, &r, &info);
    if (!fine)
        Py_CLEAR(image);
    return image;
}
