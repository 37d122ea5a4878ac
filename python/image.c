/* image.c - pictures: their pixels as a buffer, files of them, differences. */
#include "core.h"

#include <math.h>
#include <string.h>

static void release_image(void *object) {
    snow_image_free(object);
}

PyObject *image_make(PyTypeObject *type, context_object *context,
                     snow_image *image) {
    image_object *o = (image_object *)PyType_GenericAlloc(type, 0);
    if (!o) {
        context_discard(context, release_image, image);
        return NULL;
    }
    Py_INCREF((PyObject *)context);
    o->context = context;
    o->image = image;
    o->shape[0] = snow_image_height(image);
    o->shape[1] = snow_image_width(image);
    o->shape[2] = snow_image_channels(image);
    o->strides[2] = sizeof(float);
    o->strides[1] = o->strides[2] * o->shape[2];
    o->strides[0] = o->strides[1] * o->shape[1];
    return (PyObject *)o;
}

static void image_free(PyObject *self) {
    image_object *o = (image_object *)self;
    if (o->context)
        context_discard(o->context, release_image, o->image);
    Py_XDECREF(o->transfer);
    Py_XDECREF((PyObject *)o->context);
    end_object(self);
}

/* float32, (height, width, channels), or (height, width) of values. */
static int image_buffer(PyObject *self, Py_buffer *view, int flags) {
    image_object *o = (image_object *)self;
    if (PyBuffer_FillInfo(view, self, snow_image_pixels(o->image),
                          o->shape[0] * o->strides[0], 0, flags))
        return -1;
    view->itemsize = sizeof(float);
    view->ndim = o->shape[2] == 1 ? 2 : 3;
    view->shape = o->shape;
    view->strides = o->strides;
    view->format = (char *)"f";
    return 0;
}

static PyObject *image_shape(PyObject *self, void *closure) {
    image_object *o = (image_object *)self;
    (void)closure;
    if (o->shape[2] == 1)
        return Py_BuildValue("(nn)", o->shape[0], o->shape[1]);
    return Py_BuildValue("(nnn)", o->shape[0], o->shape[1], o->shape[2]);
}

static PyObject *image_checksum(PyObject *self, void *closure) {
    image_object *o = (image_object *)self;
    (void)closure;
    return PyLong_FromUnsignedLongLong(snow_image_checksum(o->image));
}
typedef struct annotations {
    int letters, legend, scale_bar;
    const char *unit, *title;
    double range[2]; /* of colours without opacity; not a number: none */
    PyObject *texts; /* (x, y, share of x, of y, height, text), ...; or NULL */
    PyObject *measures; /* records as bytes; or NULL */
    const char *value_unit;
    PyObject *bars; /* (transfer, name, low, high), ...: of channels, the lowest
                       first; or NULL */
} annotations;

/* One, or one for each channel; an exception, too, where they are no bars. */
static snow_status add_bars(const transfer_object *t, const annotations *a,
                            snow_overlay *overlay) {
    snow_status status = SNOW_STATUS_OK;
    if (!a->bars)
        return snow_overlay_color_bar(overlay, t->transfer, a->unit,
                                      isnan(a->range[0]) ? NULL : a->range, 0,
                                      1);
    const int count = (int)PyTuple_Size(a->bars);
    for (int n = 0; n < count && !status; n++) {
        PyObject *transfer;
        const char *name;
        double range[2];
        if (!PyArg_ParseTuple(PyTuple_GetItem(a->bars, n), "O!sdd",
                              transfer_type, &transfer, &name, &range[0],
                              &range[1]))
            return SNOW_STATUS_BAD_USAGE;
        status = snow_overlay_color_bar(
            overlay, ((transfer_object *)transfer)->transfer, name,
            isnan(range[0]) ? NULL : range, n, count);
    }
    return status;
}

/* What is said of the bars is said when they are drawn. */
bool image_leave_strip(const transfer_object *t, PyObject *marks,
                       snow_view *view) {
    annotations a = {.range = {NAN, NAN}};
    snow_context *silent = NULL;
    snow_overlay *overlay = NULL;
    if (!PyArg_ParseTuple(marks, "pz(dd)O", &a.legend, &a.unit, &a.range[0],
                          &a.range[1], &a.bars))
        return false;
    a.bars = a.bars == Py_None ? NULL : a.bars;
    snow_status status = snow_context_new(NULL, &silent);
    if (!status)
        status = snow_overlay_new(silent, view->width, view->height, &overlay);
    if (!status && a.legend)
        status = add_bars(t, &a, overlay);
    if (!status && (a.legend || !(view->fov > 0)))
        view->strip = snow_overlay_strip(overlay);
    if (status && !PyErr_Occurred())
        context_set_error(status, snow_context_message(silent));
    snow_overlay_free(overlay);
    snow_context_free(silent);
    return !status;
}

static snow_status add_texts(PyObject *texts, snow_overlay *overlay) {
    snow_status status = SNOW_STATUS_OK;
    for (Py_ssize_t n = 0; texts && n < PyTuple_Size(texts) && !status; n++) {
        double x, y, share_x, share_y, height;
        const char *text;
        if (!PyArg_ParseTuple(PyTuple_GetItem(texts, n), "ddddds", &x, &y,
                              &share_x, &share_y, &height, &text))
            return SNOW_STATUS_BAD_USAGE;
        status =
            snow_overlay_text(overlay, x, y, share_x, share_y, height, text);
    }
    return status;
}

static snow_status add_measures(const image_object *o, const annotations *a,
                                snow_overlay *overlay) {
    snow_status status = SNOW_STATUS_OK;
    const Py_ssize_t count = a->measures ? PyTuple_Size(a->measures) : 0;
    for (Py_ssize_t n = 0; n < count && !status; n++) {
        snow_measure one;
        PyObject *record = PyTuple_GetItem(a->measures, n);
        if (!PyBytes_Check(record) || PyBytes_Size(record) != sizeof one)
            return SNOW_STATUS_BAD_USAGE;
        memcpy(&one, PyBytes_AsString(record), sizeof one);
        status = snow_overlay_measure(overlay, &o->info, &o->view, 0, 0,
                                      a->value_unit, &one);
    }
    return status;
}

/* In the order of the command line: what comes first takes its place. */
static snow_status annotate(const image_object *o, const annotations *a,
                            snow_overlay *overlay) {
    const transfer_object *t = (const transfer_object *)o->transfer;
    snow_status status = SNOW_STATUS_OK;
    if (t && a->legend)
        status = add_bars(t, a, overlay);
    if (t && (a->legend || a->scale_bar) && !status)
        status = snow_overlay_scale_bar(overlay, &o->info, &o->view);
    if (t && a->letters && !status)
        status = snow_overlay_orientation(overlay, &o->info, &o->view);
    if (a->title && !status)
        status = snow_overlay_title(overlay, a->title);
    if (!status)
        status = add_texts(a->texts, overlay);
    if (!status)
        status = add_measures(o, a, overlay);
    return status;
}

/* To a file, or without a path as red, green and blue: bytes. */
static PyObject *image_save(PyObject *self, PyObject *args,
                            PyObject *keywords) {
    static char *names[] = {
        "path",  "background", "bits",       "overwrite", "letters", "legend",
        "unit",  "scale_bar",  "title",      "depth",     "range",   "bars",
        "texts", "measures",   "value_unit", "progress",  NULL};
    image_object *o = (image_object *)self;
    snow_image_options options;
    PyObject *file, *background = Py_None, *depth = Py_None, *rgb = NULL;
    PyObject *progress = Py_None;
    char *path = NULL;
    int overwrite = 0;
    annotations a = {.range = {NAN, NAN}};
    snow_image_options_init(&options);
    if (!PyArg_ParseTupleAndKeywords(
            args, keywords, "O|$OipppzpzO(dd)O!O!O!zO", names, &file,
            &background, &options.bits, &overwrite, &a.letters, &a.legend,
            &a.unit, &a.scale_bar, &a.title, &depth, &a.range[0], &a.range[1],
            &PyTuple_Type, &a.bars, &PyTuple_Type, &a.texts, &PyTuple_Type,
            &a.measures, &a.value_unit, &progress))
        return NULL;
    if (file != Py_None && PyBytes_AsStringAndSize(file, &path, NULL))
        return NULL;
    options.overwrite = overwrite;
    options.flatten = background != Py_None;
    if (options.flatten &&
        !record_numbers("background", background, 3, false, options.background))
        return NULL;
    if (depth != Py_None) {
        if (!PyObject_TypeCheck(depth, image_type))
            return PyErr_Format(PyExc_TypeError, "depth must be an Image");
        options.depth = ((image_object *)depth)->image;
    }
    if (!path &&
        !(rgb = PyBytes_FromStringAndSize(NULL, o->shape[0] * o->shape[1] * 3)))
        return NULL;
    unsigned char *bytes = rgb ? (unsigned char *)PyBytes_AsString(rgb) : NULL;
    if (!context_enter(o->context, progress)) {
        Py_XDECREF(rgb);
        return NULL;
    }
    snow_overlay *overlay = NULL;
    snow_status status = SNOW_STATUS_OK;
    if (a.letters || a.legend || a.scale_bar || a.title || a.texts ||
        a.measures)
        status = snow_overlay_new(o->context->context, (int)o->shape[1],
                                  (int)o->shape[0], &overlay);
    if (overlay)
        status = annotate(o, &a, overlay);
    options.overlay = overlay;
    if (!status)
        CALL(o->context, status,
             rgb ? snow_image_to_rgb8(o->image, &options, bytes)
                 : snow_image_save(o->image, path, &options));
    snow_overlay_free(overlay);
    if (context_leave(o->context, status))
        return rgb ? rgb : Py_NewRef(Py_None);
    Py_XDECREF(rgb);
    return NULL;
}

/* paint(Image, low, high): data values in the look's colours; from not a
 * number: between those of the picture -> (image, low, high) */
static PyObject *image_paint(PyObject *self, PyObject *args) {
    image_object *o = (image_object *)self;
    const transfer_object *t = (const transfer_object *)o->transfer;
    PyObject *type;
    double low, high;
    snow_image *painted = NULL;
    snow_status status;
    if (!PyArg_ParseTuple(args, "Odd", &type, &low, &high) ||
        !context_enter(o->context, Py_None))
        return NULL;
    if (isnan(low))
        snow_image_value_range(o->image, &low, &high);
    CALL(o->context, status,
         snow_image_apply_colormap(o->image, t->transfer, low, high, &painted));
    const bool fine = context_leave(o->context, status);
    PyObject *image =
        painted ? image_make((PyTypeObject *)type, o->context, painted) : NULL;
    if (!image)
        return NULL;
    if (!fine) {
        Py_DECREF(image);
        return NULL;
    }
    image_object *made = (image_object *)image;
    made->transfer = Py_NewRef(o->transfer);
    made->info = o->info;
    made->view = o->view;
    made->placed = o->placed;
    return Py_BuildValue("(Ndd)", image, low, high);
}

/* places(points or pixels, whether these are pixels): three doubles each, as
 * bytes -> the others, as bytes */
static PyObject *image_places(PyObject *self, PyObject *args) {
    image_object *o = (image_object *)self;
    const size_t one = 3 * sizeof(double);
    Py_buffer given;
    int back;
    snow_status status = SNOW_STATUS_BAD_USAGE;
    if (!o->placed)
        return PyErr_Format(PyExc_ValueError,
                            "the picture knows no place in the world: ask one "
                            "of Volume.render or Volume.slice");
    if (!PyArg_ParseTuple(args, "y*p", &given, &back))
        return NULL;
    const size_t count = (size_t)given.len / one;
    PyObject *bytes = PyBytes_FromStringAndSize(NULL, given.len);
    bool fine = bytes && context_enter(o->context, Py_None);
    if (fine) {
        double *out = (double *)(void *)PyBytes_AsString(bytes);
        status = (back ? snow_view_pixel_to_world : snow_view_world_to_pixel)(
            o->context->context, &o->info, &o->view, given.buf, count, out);
        fine = context_leave(o->context, status);
    }
    PyBuffer_Release(&given);
    if (!fine)
        Py_CLEAR(bytes);
    return bytes;
}

static PyObject *image_load(PyObject *module, PyObject *args) {
    PyObject *type;
    const char *path;
    snow_image *image = NULL;
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "Oy", &type, &path))
        return NULL;
    context_object *c = context_new();
    if (!c || !context_enter(c, Py_None)) {
        Py_XDECREF((PyObject *)c);
        return NULL;
    }
    CALL(c, status, snow_image_load(c->context, path, &image));
    const bool fine = context_leave(c, status);
    PyObject *made = image ? image_make((PyTypeObject *)type, c, image) : NULL;
    Py_DECREF((PyObject *)c);
    if (!fine)
        Py_CLEAR(made);
    return made;
}

static PyObject *image_compare(PyObject *module, PyObject *args) {
    PyObject *a, *b;
    snow_image_difference d;
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "O!O!", image_type, &a, image_type, &b))
        return NULL;
    image_object *first = (image_object *)a, *second = (image_object *)b;
    snow_image_difference_init(&d);
    if (!context_enter(first->context, Py_None))
        return NULL;
    CALL(first->context, status,
         snow_image_compare(first->image, second->image, &d));
    if (!context_leave(first->context, status))
        return NULL;
    return Py_BuildValue("(ddddii)", d.largest, d.mean, d.psnr, d.ssim, d.x,
                         d.y);
}

/* Most bits a channel of a picture file; 0: floats; -1: none that is written.
 */
static PyObject *format_bits(PyObject *module, PyObject *path) {
    const char *text = PyBytes_AsString(path);
    (void)module;
    return text ? PyLong_FromLong(snow_image_format_bits(text)) : NULL;
}

static PyMethodDef image_methods[] = {
    METHOD("_save", image_save, METH_VARARGS | METH_KEYWORDS,
           "to a file, or as bytes"),
    METHOD("_places", image_places, METH_VARARGS, "in the world, or in pixels"),
    METHOD("_paint", image_paint, METH_VARARGS, "values as colours"),
    {NULL, NULL, 0, NULL}};
static PyGetSetDef image_values[] = {
    {"shape", image_shape, NULL, "(height, width, channels)", NULL},
    {"checksum", image_checksum, NULL, "64-bit FNV-1a of the floats", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
PyMethodDef image_functions[] = {
    METHOD("load_image", image_load, METH_VARARGS, "a picture of a file"),
    METHOD("compare", image_compare, METH_VARARGS, "of two pictures"),
    METHOD("format_bits", format_bits, METH_O, "of a picture file's name"),
    {NULL, NULL, 0, NULL}};

const type_parts image_parts = {.name = "_snowglass.Image",
                                .size = sizeof(image_object),
                                .is_base = true,
                                .dealloc = image_free,
                                .buffer = image_buffer,
                                .methods = image_methods,
                                .values = image_values};
