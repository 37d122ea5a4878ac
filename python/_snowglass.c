/* _snowglass.c - the extension module: its types, its functions and lists of
 * names. */
#include "core.h"

#include <string.h>

PyTypeObject *context_type, *volume_type, *transfer_type, *image_type;

/* --- lists ---------------------------------------------------------------- */

static PyObject *list_of(const char *(*name)(size_t)) {
    PyObject *list = PyList_New(0);
    for (size_t n = 0; list && name(n); n++) {
        PyObject *one = PyUnicode_FromString(name(n));
        if (!one || PyList_Append(list, one)) {
            Py_XDECREF(one);
            Py_DECREF(list);
            return NULL;
        }
        Py_DECREF(one);
    }
    return list;
}

static PyObject *names_of(PyObject *module, PyObject *what) {
    static const struct {
        const char *what;
        const char *(*name)(size_t);
    } lists[] = {{"presets", snow_preset_name},
                 {"preset_descriptions", snow_preset_description},
                 {"colormaps", snow_colormap_name},
                 {"phantoms", snow_phantom_name},
                 {"formats", snow_format_name},
                 {"views", snow_view_name},
                 {"settings", record_setting_name}};
    const char *name = PyUnicode_AsUTF8AndSize(what, NULL);
    (void)module;
    for (size_t n = 0; name && n < sizeof lists / sizeof *lists; n++)
        if (strcmp(lists[n].what, name) == 0)
            return list_of(lists[n].name);
    return name ? PyErr_Format(PyExc_ValueError, "no list '%s'", name) : NULL;
}

static PyObject *version(PyObject *module, PyObject *nothing) {
    (void)module;
    (void)nothing;
    return PyUnicode_FromString(snow_version());
}

/* fail(status, message): raises what that is; of _insitu.c, too */
static PyObject *fail(PyObject *module, PyObject *args) {
    int status;
    const char *message;
    (void)module;
    if (PyArg_ParseTuple(args, "is", &status, &message))
        context_set_error((snow_status)status, message);
    return NULL;
}

static PyObject *text(PyObject *module, PyObject *message) {
    const char *given = PyUnicode_AsUTF8AndSize(message, NULL);
    (void)module;
    return given ? message_text(given) : NULL;
}

/* A unit of length in picometres, 0 if it is not known, and its usual name. */
static PyObject *length_unit(PyObject *self, PyObject *unit) {
    (void)self;
    char name[16] = "";
    const char *text = PyUnicode_AsUTF8AndSize(unit, NULL);
    return text ? Py_BuildValue("ds", snow_unit_length(text, name), name)
                : NULL;
}

static PyMethodDef functions[] = {
    METHOD("fail", fail, METH_VARARGS, "raises a status with its message"),
    METHOD("text", text, METH_O, "a message in words of Python"),
    METHOD("names", names_of, METH_O, "presets, colormaps, ..."),
    METHOD("length_unit", length_unit, METH_O, "picometres, name"),
    METHOD("version", version, METH_NOARGS, "of the library"),
    METHOD("colormap_color", look_colormap_color, METH_O, "of maps of one"),
    {NULL, NULL, 0, NULL}};

/* A slot's function as the pointer that a record has. */
#define SLOT(number, function) slot_of(number, (void (*)(void))(function))
static PyType_Slot slot_of(int number, void (*function)(void)) {
    PyType_Slot slot = {number, NULL};
    memcpy(&slot.pfunc, &function, sizeof slot.pfunc);
    return slot;
}

static PyTypeObject *add_type(PyObject *module, const type_parts *parts) {
    const unsigned flags = Py_TPFLAGS_DEFAULT |
                           Py_TPFLAGS_DISALLOW_INSTANTIATION |
                           (parts->is_base ? (unsigned)Py_TPFLAGS_BASETYPE : 0);
    PyType_Slot slots[7] = {{0, NULL}};
    int n = 0;
    slots[n++] = SLOT(Py_tp_dealloc, parts->dealloc);
    if (parts->methods)
        slots[n++] = (PyType_Slot){Py_tp_methods, parts->methods};
    if (parts->values)
        slots[n++] = (PyType_Slot){Py_tp_getset, parts->values};
    if (parts->buffer)
        slots[n++] = SLOT(Py_bf_getbuffer, parts->buffer);
    if (parts->release)
        slots[n++] = SLOT(Py_bf_releasebuffer, parts->release);
    PyType_Spec spec = {parts->name, (int)parts->size, 0, flags, slots};
    PyObject *type = PyType_FromSpec(&spec);
    if (type &&
        PyModule_AddObjectRef(module, strchr(parts->name, '.') + 1, type))
        Py_CLEAR(type);
    return (PyTypeObject *)type;
}

static bool add_types(PyObject *module) {
    context_type = add_type(module, &context_parts);
    transfer_type = add_type(module, &transfer_parts);
    volume_type = add_type(module, &volume_parts);
    image_type = add_type(module, &image_parts);
    return context_type && transfer_type && volume_type && image_type;
}

static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT,
                                        "_snowglass",
                                        NULL,
                                        -1,
                                        functions,
                                        NULL,
                                        NULL,
                                        NULL,
                                        NULL};

PyMODINIT_FUNC PyInit__snowglass(void);
PyMODINIT_FUNC PyInit__snowglass(void) {
    PyObject *m = PyModule_Create(&definition);
    if (m && add_types(m) && errors_add(m) &&
        !PyModule_AddFunctions(m, volume_functions) &&
        !PyModule_AddFunctions(m, image_functions))
        return m;
    Py_XDECREF(m);
    return NULL;
}
