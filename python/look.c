/* look.c - transfer functions, which looks become for a volume. */
#include "core.h"
#include "picture/light.h"

#include <snowglass/channels.h>
#include <stdlib.h>
#include <string.h>

static void release_transfer(void *object) {
    snow_transfer_free(object);
}

static void transfer_free(PyObject *self) {
    transfer_object *o = (transfer_object *)self;
    if (o->context)
        context_discard(o->context, release_transfer, o->transfer);
    Py_XDECREF((PyObject *)o->context);
    end_object(self);
}

static PyObject *transfer_text(PyObject *self, void *closure) {
    transfer_object *o = (transfer_object *)self;
    (void)closure;
    return text_of(snow_transfer_description(o->transfer));
}

static PyObject *transfer_domain(PyObject *self, void *closure) {
    transfer_object *o = (transfer_object *)self;
    double low, high;
    (void)closure;
    snow_transfer_domain(o->transfer, &low, &high);
    return Py_BuildValue("(dd)", low, high);
}

static PyObject *transfer_labelled(PyObject *self, void *closure) {
    transfer_object *o = (transfer_object *)self;
    (void)closure;
    return PyBool_FromLong(snow_transfer_label(o->transfer, 0) != NULL);
}

static PyObject *transfer_unshaded(PyObject *self, void *closure) {
    transfer_object *o = (transfer_object *)self;
    (void)closure;
    return PyBool_FromLong(snow_transfer_is_unshaded(o->transfer));
}

static PyObject *list_of_points(const snow_opacity_point *points,
                                size_t count) {
    PyObject *list = PyList_New(0);
    for (size_t n = 0; list && n < count; n++) {
        PyObject *one =
            Py_BuildValue("(dd)", points[n].value, points[n].opacity);
        if (!one || PyList_Append(list, one))
            Py_CLEAR(list);
        Py_XDECREF(one);
    }
    return list;
}

/* Opacities by value, and by gradient. */
static PyObject *transfer_points(PyObject *self, void *closure) {
    transfer_object *o = (transfer_object *)self;
    snow_look look;
    (void)closure;
    snow_look_init(&look);
    snow_status status = snow_transfer_get_look(o->transfer, &look);
    if (status != SNOW_STATUS_OK) {
        context_set_error(status, snow_context_message(o->context->context));
        return NULL;
    }
    PyObject *by_value = list_of_points(look.opacities, look.opacity_count);
    PyObject *by_gradient =
        list_of_points(look.gradient_opacities, look.gradient_opacity_count);
    if (by_value && by_gradient)
        return Py_BuildValue("(NN)", by_value, by_gradient);
    Py_XDECREF(by_value);
    Py_XDECREF(by_gradient);
    return NULL;
}

static PyObject *transfer_evaluate(PyObject *self, PyObject *value) {
    transfer_object *o = (transfer_object *)self;
    double rgba[4], at = PyFloat_AsDouble(value);
    if (PyErr_Occurred())
        return NULL;
    snow_transfer_evaluate(o->transfer, at, rgba);
    return Py_BuildValue("(dddd)", rgba[0], rgba[1], rgba[2], rgba[3]);
}

/* Rows of `width` numbers as doubles; NULL with an exception, or for None. */
static double *read_points(PyObject *given, const char *what, Py_ssize_t width,
                           size_t *count) {
    *count = 0;
    if (given == Py_None)
        return NULL;
    PyObject *rows = PySequence_Tuple(given);
    Py_ssize_t size = rows ? PyTuple_Size(rows) : 0;
    double *points =
        rows ? malloc((size_t)(size + 1) * (size_t)width * sizeof *points)
             : NULL;
    bool fine = points != NULL;
    for (Py_ssize_t n = 0; fine && n < size; n++)
        fine = record_numbers(what, PyTuple_GetItem(rows, n), width, false,
                              points + n * width);
    Py_XDECREF(rows);
    if (fine) {
        *count = (size_t)size;
        return points;
    }
    if (!PyErr_Occurred())
        PyErr_NoMemory();
    free(points);
    return NULL;
}

static int range_of(const char *name) {
    static const char *const names[] = {"auto",        "full",   "values",
                                        "percentiles", "robust", "slices",
                                        "least",       "signal"};
    for (int n = 0; n < (int)(sizeof names / sizeof *names); n++)
        if (strcmp(names[n], name) == 0)
            return n;
    return -1;
}

/* look(volume, fields, range, colors, opacities, gradient opacities,
 * progress) */
PyObject *volume_look(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *given, *colors, *opacities, *gradients, *progress = Py_None;
    const char *range;
    snow_look look;
    snow_status status;
    snow_look_init(&look);
    if (!PyArg_ParseTuple(args, "OsOOO|O", &given, &range, &colors, &opacities,
                          &gradients, &progress) ||
        !record_fill_look(given, &look))
        return NULL;
    look.range = (snow_range)range_of(range);
    double *color =
        read_points(colors, "a point of colors", 4, &look.color_count);
    double *opacity = PyErr_Occurred()
                          ? NULL
                          : read_points(opacities, "a point of opacity", 2,
                                        &look.opacity_count);
    double *gradient =
        PyErr_Occurred() ? NULL
                         : read_points(gradients, "a point of gradient opacity",
                                       2, &look.gradient_opacity_count);
    look.colors = (const snow_color_point *)(void *)color;
    look.opacities = (const snow_opacity_point *)(void *)opacity;
    look.gradient_opacities = (const snow_opacity_point *)(void *)gradient;
    transfer_object *made = NULL;
    if (!PyErr_Occurred())
        made = (transfer_object *)PyType_GenericAlloc(transfer_type, 0);
    if (made && volume_use(o, progress)) {
        Py_INCREF((PyObject *)o->context);
        made->context = o->context;
        CALL(o->context, status,
             snow_transfer_new_for_volume(o->volume, &look, &made->transfer));
        context_leave(o->context, status);
    }
    free(color);
    free(opacity);
    free(gradient);
    if (!PyErr_Occurred())
        return (PyObject *)made;
    Py_XDECREF((PyObject *)made);
    return NULL;
}

/* ground(green, blue, three pairs of levels): the share of the levels from
 * which on the ground of colours, whose red this is, is white; else 0 */
PyObject *volume_ground(PyObject *self, PyObject *args) {
    PyObject *parts[3] = {self}, *pairs;
    const snow_volume *volumes[3];
    double white = 0, *levels = NULL;
    size_t count = 0;
    snow_status status;
    if (!PyArg_ParseTuple(args, "O!O!O", volume_type, &parts[1], volume_type,
                          &parts[2], &pairs))
        return NULL;
    levels = read_points(pairs, "a pair of levels", 2, &count);
    volume_object *o = (volume_object *)self;
    if (!PyErr_Occurred() && count == 3 && volume_use(o, Py_None)) {
        for (int c = 0; c < 3; c++)
            volumes[c] = ((volume_object *)parts[c])->volume;
        const int64_t middle = snow_volume_get_info(o->volume)->dims[2] / 2;
        CALL(o->context, status,
             snow_channels_ground(volumes, (const double(*)[2])(void *)levels,
                                  middle, &white));
        context_leave(o->context, status);
    }
    free(levels);
    return PyErr_Occurred() ? NULL : PyFloat_FromDouble(white);
}

/* faded(volume, factor, opacities or None): the same colours with those
 * opacities, or its own, times a factor */
static PyObject *transfer_faded(PyObject *self, PyObject *args) {
    transfer_object *o = (transfer_object *)self;
    PyObject *opacities, *volume;
    double factor;
    size_t count;
    snow_status status;
    if (!PyArg_ParseTuple(args, "O!dO", volume_type, &volume, &factor,
                          &opacities))
        return NULL;
    double *given = read_points(opacities, "a point of opacity", 2, &count);
    transfer_object *made =
        PyErr_Occurred()
            ? NULL
            : (transfer_object *)PyType_GenericAlloc(transfer_type, 0);
    if (made && volume_use((volume_object *)volume, Py_None)) {
        Py_INCREF((PyObject *)o->context);
        made->context = o->context;
        CALL(o->context, status,
             light_fade(NULL, o->transfer, ((volume_object *)volume)->volume,
                        factor, (const snow_opacity_point *)(void *)given,
                        count, &made->transfer));
        context_leave(o->context, status);
    }
    free(given);
    if (!PyErr_Occurred())
        return (PyObject *)made;
    Py_XDECREF((PyObject *)made);
    return NULL;
}

/* colormap_color(name): red, green and blue where it is a map from black to
 * one colour, else None */
PyObject *look_colormap_color(PyObject *module, PyObject *name) {
    double rgb[3];
    const char *text = PyUnicode_AsUTF8AndSize(name, NULL);
    (void)module;
    if (!text)
        return NULL;
    const int found = snow_colormap_from_name(text);
    if (found < 0)
        return PyErr_Format(PyExc_ValueError,
                            "'%s' is no colour: give red, green, blue, cyan, "
                            "magenta, yellow, grey, #rrggbb or another colour "
                            "map",
                            text);
    if (!light_of_colormap((size_t)found, rgb))
        Py_RETURN_NONE;
    return Py_BuildValue("(ddd)", rgb[0], rgb[1], rgb[2]);
}

static PyMethodDef transfer_methods[] = {
    METHOD("_faded", transfer_faded, METH_VARARGS, "with other opacities"),
    METHOD("evaluate", transfer_evaluate, METH_O,
           "red, green, blue and opacity, 0 to 1, of a data value"),
    {NULL, NULL, 0, NULL}};
static PyGetSetDef transfer_values[] = {
    {"description", transfer_text, NULL, "what was chosen, one line", NULL},
    {"domain", transfer_domain, NULL, "first and last data value", NULL},
    {"points", transfer_points, NULL, "opacities by value, by gradient", NULL},
    {"labelled", transfer_labelled, NULL, "a colour for each label", NULL},
    {"unshaded", transfer_unshaded, NULL, "better drawn unshaded", NULL},
    {NULL, NULL, NULL, NULL, NULL}};

const type_parts transfer_parts = {.name = "_snowglass.Transfer",
                                   .size = sizeof(transfer_object),
                                   .dealloc = transfer_free,
                                   .methods = transfer_methods,
                                   .values = transfer_values};
