/* _snowglass - the core of the Python package, in the limited API of CPython
 * 3.11, so that one build serves all later versions.
 *
 * Everything comfortable is Python (snowglass/): here are objects that own
 * those of the library, and records that are filled from dictionaries.
 *
 *   Context    a snow_context and its lock; every other object holds one
 *   Volume     a volume and the frame that draws it
 *   Transfer   a transfer function
 *   Image      a picture, read and written by the buffer protocol
 *
 * A context belongs to one thread at a time. A call takes its lock, gives back
 * the interpreter's, and calls the library; other threads wait. An object may
 * die while another thread draws by its context: it is put aside then, and
 * freed when that call ends. */
#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <snowglass/ranks.h>
#include <snowglass/snowglass.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static PyObject *error_type, *warning_type;
static PyTypeObject *context_type, *volume_type, *transfer_type, *image_type;

/* The end of an object's dealloc. */
static void end_object(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    void *slot = PyType_GetSlot(type, Py_tp_free);
    freefunc release;
    memcpy(&release, &slot, sizeof release);
    release(self);
    Py_DECREF((PyObject *)type);
}

/* Names of files and their texts may be in any encoding. */
static PyObject *text_of(const void *text) {
    return PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace");
}

/* --- contexts ------------------------------------------------------------- */

typedef void free_fn(void *object);

typedef struct pending {
    free_fn *release;
    void *object;
    struct pending *next;
} pending;

typedef struct context_object {
    PyObject_HEAD snow_context *context;
    PyThread_type_lock lock;
    unsigned long holder; /* the thread that has the lock */
    bool held;
    PyThreadState *saved; /* of a call that is under way */
    PyObject *progress;   /* what it reports to, borrowed; or NULL */
    bool raised;          /* by a signal or by what it reports to */
    PyObject *warnings;   /* texts of it */
    pending *garbage;
} context_object;

static void release_volume(void *object) {
    snow_volume_close(object);
}

static void release_transfer(void *object) {
    snow_transfer_free(object);
}

static void release_image(void *object) {
    snow_image_free(object);
}

static void release_frame(void *object) {
    snow_frame_free(object);
}

static void collect(context_object *c) {
    while (c->garbage) {
        pending *first = c->garbage;
        c->garbage = first->next;
        first->release(first->object);
        free(first);
    }
}

/* Frees an object now, or as soon as the context is free. */
static void discard(context_object *c, free_fn *release, void *object) {
    if (!object)
        return;
    if (PyThread_acquire_lock(c->lock, NOWAIT_LOCK)) {
        release(object);
        PyThread_release_lock(c->lock);
        return;
    }
    pending *one = malloc(sizeof *one);
    if (one) { /* else it stays until the process ends */
        *one = (pending){release, object, c->garbage};
        c->garbage = one;
    }
}

/* Called by the thread that called the library. */
static bool report(void *user, snow_stage stage, double fraction) {
    static const char *const names[] = {"read", "encode", "render"};
    context_object *c = user;
    if (!c->saved)
        return false;
    PyEval_RestoreThread(c->saved);
    if (!c->raised)
        c->raised = PyErr_CheckSignals() != 0;
    if (!c->raised && c->progress) {
        PyObject *result =
            PyObject_CallFunction(c->progress, "sd", names[stage], fraction);
        c->raised = !result;
        Py_XDECREF(result);
    }
    c->saved = PyEval_SaveThread();
    return c->raised;
}

/* Warnings become those of Python when the call has ended. */
static void keep_warning(void *user, const char *text) {
    context_object *c = user;
    PyGILState_STATE state = PyGILState_Ensure();
    PyObject *one = text_of(text);
    if (!one || PyList_Append(c->warnings, one))
        PyErr_Clear();
    Py_XDECREF(one);
    PyGILState_Release(state);
}

static PyObject *context_make(PyTypeObject *type, PyObject *args,
                              PyObject *keywords) {
    (void)args;
    (void)keywords;
    context_object *c = (context_object *)PyType_GenericAlloc(type, 0);
    if (!c)
        return NULL;
    c->lock = PyThread_allocate_lock();
    c->warnings = PyList_New(0);
    if (!c->lock || !c->warnings ||
        snow_context_new(NULL, &c->context) != SNOW_STATUS_OK) {
        Py_DECREF((PyObject *)c);
        return PyErr_NoMemory();
    }
    snow_context_set_warning(c->context, keep_warning, c);
    snow_context_set_progress(c->context, report, c);
    return (PyObject *)c;
}

static void context_free(PyObject *self) {
    context_object *c = (context_object *)self;
    if (c->context) {
        collect(c);
        snow_context_free(c->context);
    }
    if (c->lock)
        PyThread_free_lock(c->lock);
    Py_XDECREF(c->warnings);
    end_object(self);
}

/* Waits while another thread draws; false when a signal's handler raised. */
static bool wait_for(context_object *c) {
    PyLockStatus got = PY_LOCK_FAILURE;
    while (got != PY_LOCK_ACQUIRED) {
        PyThreadState *saved = PyEval_SaveThread();
        got = PyThread_acquire_lock_timed(c->lock, 50000, 1);
        PyEval_RestoreThread(saved);
        if (got != PY_LOCK_ACQUIRED && PyErr_CheckSignals())
            return false;
    }
    return true;
}

/* Takes the lock; false with an exception. */
static bool enter(context_object *c, PyObject *progress) {
    unsigned long here = PyThread_get_thread_ident();
    if (c->held && c->holder == here) {
        PyErr_SetString(PyExc_RuntimeError,
                        "this volume is in use by the call that reports its "
                        "progress: a callback must use another one");
        return false;
    }
    if (!PyThread_acquire_lock(c->lock, NOWAIT_LOCK) && !wait_for(c))
        return false;
    c->held = true;
    c->holder = here;
    c->raised = false;
    c->progress = progress == Py_None ? NULL : progress;
    return true;
}

/* Without the interpreter's lock. */
#define CALL(c, status, call)             \
    do {                                  \
        (c)->saved = PyEval_SaveThread(); \
        (status) = (call);                \
        PyEval_RestoreThread((c)->saved); \
        (c)->saved = NULL;                \
    } while (0)

static void set_error(snow_status status, const char *message) {
    PyObject *text = text_of(message), *number = PyLong_FromLong(status);
    PyObject *type = status == SNOW_STATUS_NO_MEMORY   ? PyExc_MemoryError
                     : status == SNOW_STATUS_BAD_USAGE ? PyExc_ValueError
                                                       : error_type;
    PyObject *error =
        text && number ? PyObject_CallFunction(type, "O", text) : NULL;
    if (error && (type != error_type ||
                  !PyObject_SetAttrString(error, "status", number)))
        PyErr_SetObject(type, error);
    Py_XDECREF(error);
    Py_XDECREF(number);
    Py_XDECREF(text);
}

/* Gives the lock back; false with an exception, if the status is an error or a
 * warning is one. */
static bool leave(context_object *c, snow_status status) {
    bool fine = !c->raised && status == SNOW_STATUS_OK;
    if (!c->raised && !PyErr_Occurred() && status != SNOW_STATUS_OK)
        set_error(status, snow_context_message(c->context));
    PyObject *texts = c->warnings, *empty = PyList_New(0);
    if (empty)
        c->warnings = empty;
    collect(c);
    c->held = false;
    c->progress = NULL;
    PyThread_release_lock(c->lock);
    for (Py_ssize_t n = 0; fine && empty && n < PyList_Size(texts); n++) {
        const char *text =
            PyUnicode_AsUTF8AndSize(PyList_GetItem(texts, n), NULL);
        fine = text && !PyErr_WarnEx(warning_type, text, 2);
    }
    if (empty)
        Py_DECREF(texts);
    return fine && !PyErr_Occurred();
}

/* --- records from dictionaries -------------------------------------------- */

typedef struct field {
    const char *name;
    char kind; /* d double, i int, l int64_t, u uint64_t, b bool, e enum, s
                  text, 3 three doubles, 6 three pairs of int64_t, n three
                  int64_t */
    size_t offset;
    int (*value_of)(const char *name); /* of an enum */
} field;

static bool set_triple(const char *name, PyObject *value, Py_ssize_t count,
                       bool whole, void *to) {
    PyObject *all = PySequence_Tuple(value);
    bool fine = all && PyTuple_Size(all) == count;
    for (Py_ssize_t n = 0; fine && n < count; n++) {
        PyObject *item = PyTuple_GetItem(all, n);
        if (whole)
            ((int64_t *)to)[n] = PyLong_AsLongLong(item);
        else
            ((double *)to)[n] = PyFloat_AsDouble(item);
        fine = !PyErr_Occurred();
    }
    Py_XDECREF(all);
    if (!fine) {
        PyErr_Clear();
        PyErr_Format(PyExc_TypeError, "%s must be %zd %s", name, count,
                     whole ? "whole numbers" : "numbers");
    }
    return fine;
}

static bool set_crop(PyObject *value, int64_t crop[3][2]) {
    PyObject *all = PySequence_Tuple(value);
    bool fine = all && PyTuple_Size(all) == 3;
    for (Py_ssize_t n = 0; fine && n < 3; n++)
        fine = set_triple("each of crop", PyTuple_GetItem(all, n), 2, true,
                          crop[n]);
    Py_XDECREF(all);
    if (!fine && !PyErr_Occurred())
        PyErr_SetString(PyExc_TypeError, "crop must be three pairs of voxels");
    return fine;
}

static bool set_enum(const field *f, PyObject *value, int *to) {
    const char *name = PyUnicode_AsUTF8AndSize(value, NULL);
    if (!name)
        return false;
    *to = f->value_of(name);
    if (*to >= 0)
        return true;
    PyErr_Format(PyExc_ValueError, "%s: there is no '%s'", f->name, name);
    return false;
}

static bool set_field(const field *f, PyObject *value, void *record) {
    char *to = (char *)record + f->offset;
    switch (f->kind) {
    case 'd':
        *(double *)(void *)to = PyFloat_AsDouble(value);
        break;
    case 'i': {
        long number = PyLong_AsLong(value);
        if (!PyErr_Occurred() && number != (int)number)
            PyErr_Format(PyExc_ValueError, "%s: %ld is out of range", f->name,
                         number);
        *(int *)(void *)to = (int)number;
        break;
    }
    case 'l':
        *(int64_t *)(void *)to = PyLong_AsLongLong(value);
        break;
    case 'u':
        *(uint64_t *)(void *)to = PyLong_AsUnsignedLongLong(value);
        break;
    case 'b':
        *(bool *)to = PyObject_IsTrue(value) == 1;
        break;
    case 's': /* the dictionary keeps it; paths are bytes */
        *(const char **)(void *)to = PyBytes_Check(value)
                                         ? PyBytes_AsString(value)
                                         : PyUnicode_AsUTF8AndSize(value, NULL);
        break;
    case 'e':
        return set_enum(f, value, (int *)(void *)to);
    case '3':
        return set_triple(f->name, value, 3, false, to);
    case 'n':
        return set_triple(f->name, value, 3, true, to);
    default:
        return set_crop(value, (int64_t(*)[2])(void *)to);
    }
    return !PyErr_Occurred();
}

/* Fields of a record from a dictionary's items; None leaves the default. */
static bool fill(PyObject *given, const field *fields, size_t count,
                 void *record) {
    PyObject *key, *value;
    Py_ssize_t at = 0;
    if (given == Py_None)
        return true;
    while (PyDict_Next(given, &at, &key, &value)) {
        const char *name = PyUnicode_AsUTF8AndSize(key, NULL);
        size_t n = 0;
        if (!name)
            return false;
        while (n < count && strcmp(fields[n].name, name) != 0)
            n++;
        if (n == count) {
            PyErr_Format(PyExc_TypeError, "there is no option '%s'", name);
            return false;
        }
        if (value != Py_None && !set_field(&fields[n], value, record))
            return false;
    }
    return true;
}

#define FIELD(record, name, kind, of) \
    { #name, kind, offsetof(record, name), of }
#define FIELDS(fields) fields, sizeof fields / sizeof *fields

static int shade_of(const char *name) {
    return strcmp(name, "phong") == 0  ? SNOW_SHADE_PHONG
           : strcmp(name, "none") == 0 ? SNOW_SHADE_NONE
                                       : -1;
}

static int light_of(const char *name) {
    return strcmp(name, "auto") == 0        ? SNOW_LIGHT_AUTO
           : strcmp(name, "key") == 0       ? SNOW_LIGHT_KEY
           : strcmp(name, "head") == 0      ? SNOW_LIGHT_HEAD
           : strcmp(name, "direction") == 0 ? SNOW_LIGHT_DIRECTION
                                            : -1;
}

static int type_of_name(const char *name) {
    snow_type type = snow_type_from_name(name);
    return type == SNOW_TYPE_NONE ? -1 : (int)type;
}

static int endian_of(const char *name) {
    return strcmp(name, "little") == 0 ? SNOW_ENDIAN_LITTLE
           : strcmp(name, "big") == 0  ? SNOW_ENDIAN_BIG
                                       : -1;
}

#define SETTING(name, kind, of) FIELD(snow_settings, name, kind, of)
static const field settings_fields[] = {
    SETTING(threshold, 'd', NULL),
    SETTING(method, 'e', snow_method_from_name),
    SETTING(encoding, 'e', snow_encoding_from_name),
    SETTING(kernel, 'e', snow_kernel_from_name),
    SETTING(footprint, 'i', NULL),
    SETTING(opacity_length, 'd', NULL),
    SETTING(shade, 'e', shade_of),
    SETTING(ambient, 'd', NULL),
    SETTING(diffuse, 'd', NULL),
    SETTING(specular, 'd', NULL),
    SETTING(shininess, 'd', NULL),
    SETTING(light_azimuth, 'd', NULL),
    SETTING(light_elevation, 'd', NULL),
    SETTING(quality, 'e', snow_quality_from_name),
    SETTING(isa, 'e', snow_isa_from_name),
    SETTING(threads, 'i', NULL),
    SETTING(deterministic, 'b', NULL),
    SETTING(mode, 'e', snow_mode_from_name),
    SETTING(iso, 'd', NULL),
    SETTING(depth, 'b', NULL),
    SETTING(light, 'e', light_of),
    SETTING(depth_darkening, 'd', NULL),
    SETTING(occlusion, 'd', NULL),
};

#define VIEW(name, kind) FIELD(snow_view, name, kind, NULL)
static const field view_fields[] = {
    VIEW(width, 'i'),     VIEW(height, 'i'),   VIEW(azimuth, 'd'),
    VIEW(elevation, 'd'), VIEW(roll, 'd'),     VIEW(zoom, 'd'),
    VIEW(fov, 'd'),       VIEW(position, '3'), VIEW(target, '3'),
    VIEW(upward, '3'),
};

#define OPTION(name, kind, of) FIELD(snow_volume_options, name, kind, of)
static const field option_fields[] = {
    OPTION(dims, 'n', NULL),        OPTION(type, 'e', type_of_name),
    OPTION(endian, 'e', endian_of), OPTION(spacing, '3', NULL),
    OPTION(offset, 'u', NULL),      OPTION(time, 'l', NULL),
    OPTION(crop, '6', NULL),        OPTION(channel, 'l', NULL),
    OPTION(dataset, 's', NULL),     OPTION(series, 's', NULL),
    OPTION(mask, 's', NULL),        OPTION(labels, 's', NULL),
    OPTION(component, 's', NULL),   OPTION(allow_gaps, 'b', NULL),
    OPTION(each_time, 'b', NULL),
};

#define LOOK(name, kind) FIELD(snow_look, name, kind, NULL)
static const field look_fields[] = {
    LOOK(name, 's'), LOOK(preset, 's'), LOOK(colormap, 's'), LOOK(low, 'd'),
    LOOK(high, 'd'), LOOK(log, 'b'),    LOOK(per_mm, 'b'),
};

/* --- images --------------------------------------------------------------- */

typedef struct image_object {
    PyObject_HEAD context_object *context;
    snow_image *image;
    Py_ssize_t shape[3], strides[3];
    /* What letters, bars and scales need; NULL: a picture of a file. */
    PyObject *transfer;
    snow_volume_info info;
    snow_view view;
    bool opaque; /* a slice, which fills its picture */
} image_object;

static PyObject *image_make(PyTypeObject *type, context_object *context,
                            snow_image *image) {
    image_object *o = (image_object *)PyType_GenericAlloc(type, 0);
    if (!o) {
        discard(context, release_image, image);
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
        discard(o->context, release_image, o->image);
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

typedef struct transfer_object {
    PyObject_HEAD context_object *context;
    snow_transfer *transfer;
} transfer_object;

typedef struct annotations {
    int letters, legend, scale_bar;
    const char *unit, *title;
    double range[2]; /* of colours without opacity; not a number: none */
} annotations;

/* In the order of the command line: what comes first takes its place. */
static snow_status annotate(const image_object *o, const annotations *a,
                            snow_overlay *overlay) {
    const transfer_object *t = (const transfer_object *)o->transfer;
    snow_status status = SNOW_STATUS_OK;
    snow_overlay_keep_off(overlay, o->opaque ? NULL : o->image);
    if (t && a->legend)
        status = snow_overlay_color_bar(overlay, t->transfer, a->unit,
                                        isnan(a->range[0]) ? NULL : a->range);
    if (t && (a->legend || a->scale_bar) && !status)
        status = snow_overlay_scale_bar(overlay, &o->info, &o->view);
    if (a->title && !status)
        status = snow_overlay_title(overlay, a->title);
    if (t && a->letters && !status)
        status = snow_overlay_orientation(overlay, &o->info, &o->view);
    return status;
}

/* To a file, or without a path as red, green and blue: bytes. */
static PyObject *image_save(PyObject *self, PyObject *args,
                            PyObject *keywords) {
    static char *names[] = {"path",    "background", "bits",  "overwrite",
                            "letters", "legend",     "unit",  "scale_bar",
                            "title",   "depth",      "range", NULL};
    image_object *o = (image_object *)self;
    snow_image_options options;
    PyObject *file, *background = Py_None, *depth = Py_None, *rgb = NULL;
    char *path = NULL;
    int overwrite = 0;
    annotations a = {.range = {NAN, NAN}};
    snow_image_options_init(&options);
    if (!PyArg_ParseTupleAndKeywords(
            args, keywords, "O|$OipppzpzO(dd)", names, &file, &background,
            &options.bits, &overwrite, &a.letters, &a.legend, &a.unit,
            &a.scale_bar, &a.title, &depth, &a.range[0], &a.range[1]))
        return NULL;
    if (file != Py_None && PyBytes_AsStringAndSize(file, &path, NULL))
        return NULL;
    options.overwrite = overwrite;
    options.flatten = background != Py_None;
    if (options.flatten &&
        !set_triple("background", background, 3, false, options.background))
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
    if (!enter(o->context, Py_None)) {
        Py_XDECREF(rgb);
        return NULL;
    }
    snow_overlay *overlay = NULL;
    snow_status status = SNOW_STATUS_OK;
    if (a.letters || a.legend || a.scale_bar || a.title)
        status = snow_overlay_new(o->context->context, (int)o->shape[1],
                                  (int)o->shape[0], &overlay);
    if (overlay)
        status = annotate(o, &a, overlay);
    options.overlay = overlay;
    if (!status)
        CALL(o->context, status,
             rgb ? snow_image_to_rgb8_with(o->image, &options, bytes)
                 : snow_image_save(o->image, path, &options));
    snow_overlay_free(overlay);
    if (leave(o->context, status))
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
        !enter(o->context, Py_None))
        return NULL;
    if (isnan(low))
        snow_image_value_range(o->image, &low, &high);
    CALL(o->context, status,
         snow_image_apply_colormap(o->image, t->transfer, low, high, &painted));
    const bool fine = leave(o->context, status);
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
    return Py_BuildValue("(Ndd)", image, low, high);
}

static PyObject *image_load(PyObject *module, PyObject *args) {
    PyObject *type;
    const char *path;
    snow_image *image = NULL;
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "Oy", &type, &path))
        return NULL;
    context_object *c =
        (context_object *)context_make(context_type, NULL, NULL);
    if (!c || !enter(c, Py_None)) {
        Py_XDECREF((PyObject *)c);
        return NULL;
    }
    CALL(c, status, snow_image_load(c->context, path, &image));
    const bool fine = leave(c, status);
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
    if (!enter(first->context, Py_None))
        return NULL;
    CALL(first->context, status,
         snow_image_compare(first->image, second->image, &d));
    if (!leave(first->context, status))
        return NULL;
    return Py_BuildValue("(ddddii)", d.largest, d.mean, d.psnr, d.ssim, d.x,
                         d.y);
}

/* --- transfer functions --------------------------------------------------- */

static void transfer_free(PyObject *self) {
    transfer_object *o = (transfer_object *)self;
    if (o->context)
        discard(o->context, release_transfer, o->transfer);
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

static PyObject *transfer_unshaded(PyObject *self, void *closure) {
    transfer_object *o = (transfer_object *)self;
    (void)closure;
    return PyBool_FromLong(snow_transfer_is_unshaded(o->transfer));
}

static PyObject *transfer_evaluate(PyObject *self, PyObject *value) {
    transfer_object *o = (transfer_object *)self;
    double rgba[4], at = PyFloat_AsDouble(value);
    if (PyErr_Occurred())
        return NULL;
    snow_transfer_evaluate(o->transfer, at, rgba);
    return Py_BuildValue("(dddd)", rgba[0], rgba[1], rgba[2], rgba[3]);
}

/* --- volumes -------------------------------------------------------------- */

typedef struct volume_object {
    PyObject_HEAD context_object *context;
    snow_volume *volume;
    snow_frame *frame;
    Py_buffer buffer; /* of wrapped voxels */
    int order[3]; /* that dimensions of an array have in memory, slowest 0 */
    Py_ssize_t shape[3], strides[3], exports;
} volume_object;

/* Type codes of the buffer protocol, by snow_type. */
static const char *const codes[] = {"",  "b", "B", "h", "H", "i",
                                    "I", "q", "Q", "f", "d"};

static void volume_free(PyObject *self) {
    volume_object *o = (volume_object *)self;
    if (o->context) {
        discard(o->context, release_frame, o->frame);
        discard(o->context, release_volume, o->volume);
    }
    PyBuffer_Release(&o->buffer);
    Py_XDECREF((PyObject *)o->context);
    end_object(self);
}

/* A new one in the context of `like`, or in its own. */
static volume_object *volume_begin(PyObject *type, PyObject *like) {
    volume_object *o =
        (volume_object *)PyType_GenericAlloc((PyTypeObject *)type, 0);
    if (!o)
        return NULL;
    for (int n = 0; n < 3; n++)
        o->order[n] = n;
    if (like && PyObject_TypeCheck(like, volume_type)) {
        o->context = ((volume_object *)like)->context;
        Py_INCREF((PyObject *)o->context);
    } else {
        o->context = (context_object *)context_make(context_type, NULL, NULL);
    }
    if (o->context)
        return o;
    Py_DECREF((PyObject *)o);
    return NULL;
}

/* Whether a dictionary has an item other than None. */
static bool is_given(PyObject *given, const char *name) {
    PyObject *item =
        given == Py_None ? NULL : PyDict_GetItemString(given, name);
    return item && item != Py_None;
}

static bool is_open(const volume_object *o) {
    if (!o->volume)
        PyErr_SetString(PyExc_ValueError,
                        "the volume is closed: open it again");
    return o->volume != NULL;
}

/* Takes the lock of a volume that is not closed. */
static bool use(volume_object *o, PyObject *progress) {
    if (!enter(o->context, progress))
        return false;
    return is_open(o) || leave(o->context, SNOW_STATUS_OK);
}

static PyObject *volume_open(PyObject *module, PyObject *args) {
    PyObject *type, *given, *clip, *progress;
    const char *path;
    unsigned long long limit;
    snow_volume_options options;
    snow_status status;
    (void)module;
    snow_volume_options_init(&options);
    if (!PyArg_ParseTuple(args, "OyOOKO", &type, &path, &given, &clip, &limit,
                          &progress) ||
        !fill(given, FIELDS(option_fields), &options))
        return NULL;
    options.channel_given = is_given(given, "channel");
    Py_ssize_t planes = clip == Py_None ? 0 : PySequence_Size(clip);
    if (planes < 0 || planes > SNOW_CLIPS_MAX)
        return PyErr_Format(PyExc_ValueError,
                            "clip must be a list of up to %d planes (a, b, c, "
                            "d)",
                            SNOW_CLIPS_MAX);
    for (Py_ssize_t n = 0; n < planes; n++) {
        PyObject *plane = PySequence_GetItem(clip, n);
        bool fine = plane && set_triple("a clip plane", plane, 4, false,
                                        options.clip[n]);
        Py_XDECREF(plane);
        if (!fine)
            return NULL;
    }
    volume_object *o = volume_begin(type, NULL);
    if (!o || !enter(o->context, progress)) {
        Py_XDECREF((PyObject *)o);
        return NULL;
    }
    snow_context_set_memory_limit(o->context->context, limit);
    CALL(o->context, status,
         snow_volume_open(o->context->context, path, &options, &o->volume));
    if (!leave(o->context, status)) {
        Py_DECREF((PyObject *)o);
        return NULL;
    }
    return (PyObject *)o;
}

static snow_type type_of_buffer(const Py_buffer *buffer) {
    const char *format = buffer->format ? buffer->format : "B";
    if (strchr("@=<|", *format) && *format)
        format++;
    for (int type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++) {
        /* l and L are as long as the machine's */
        char code = *format == 'l'   ? (buffer->itemsize == 8 ? 'q' : 'i')
                    : *format == 'L' ? (buffer->itemsize == 8 ? 'Q' : 'I')
                    : *format == '?' ? 'B'
                                     : *format;
        if (*codes[type] == code && !format[1])
            return (snow_type)type;
    }
    return SNOW_TYPE_NONE;
}

/* What the values of another volume mean. */
static void copy_meaning(PyObject *like, snow_volume_info *info) {
    if (like == Py_None || !((volume_object *)like)->volume)
        return;
    const snow_volume_info *known =
        snow_volume_get_info(((volume_object *)like)->volume);
    memcpy(info->modality, known->modality, sizeof info->modality);
    memcpy(info->window, known->window, sizeof info->window);
    info->hounsfield = known->hounsfield;
    info->eight_bits = known->eight_bits;
}

/* Over a C contiguous array (z, y, x) of the caller, whose own array has its
 * dimensions in an order. */
static PyObject *volume_wrap(PyObject *module, PyObject *args) {
    PyObject *type, *array, *matrix, *like;
    double slope, intercept;
    int medical;
    const char *unit;
    snow_status status;
    (void)module;
    int order[3];
    if (!PyArg_ParseTuple(args, "OO(iii)OddpsO", &type, &array, &order[0],
                          &order[1], &order[2], &matrix, &slope, &intercept,
                          &medical, &unit, &like))
        return NULL;
    volume_object *o = volume_begin(type, like);
    if (!o)
        return NULL;
    memcpy(o->order, order, sizeof order);
    snow_volume_info info;
    snow_volume_info_init(&info);
    copy_meaning(like, &info);
    if (PyObject_GetBuffer(array, &o->buffer,
                           PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) ||
        !set_triple("matrix", matrix, 16, false, info.matrix))
        goto failed;
    info.type = type_of_buffer(&o->buffer);
    if (o->buffer.ndim != 3 || info.type == SNOW_TYPE_NONE) {
        PyErr_Format(PyExc_TypeError,
                     "an array of %d dimensions and type '%s': volumes have "
                     "three dimensions of integers or floats; convert it",
                     o->buffer.ndim, o->buffer.format ? o->buffer.format : "B");
        goto failed;
    }
    for (int n = 0; n < 3; n++)
        info.dims[n] = o->buffer.shape[2 - n];
    info.slope = slope;
    info.intercept = intercept;
    info.medical = medical;
    strncpy(info.unit, unit, sizeof info.unit - 1);
    if (!enter(o->context, Py_None))
        goto failed;
    CALL(o->context, status,
         snow_volume_wrap(o->context->context, &info, o->buffer.buf,
                          &o->volume));
    if (leave(o->context, status))
        return (PyObject *)o;
failed:
    Py_DECREF((PyObject *)o);
    return NULL;
}

static PyObject *volume_masked(PyObject *module, PyObject *args) {
    PyObject *type, *given, *mask;
    const char *labels;
    snow_label_range ranges[SNOW_LABELS_MAX];
    size_t count = 0;
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!O!z", &type, volume_type, &given,
                          volume_type, &mask, &labels))
        return NULL;
    if (labels && !snow_labels_parse(labels, ranges, SNOW_LABELS_MAX, &count))
        return PyErr_Format(PyExc_ValueError,
                            "labels: '%s' is no list of numbers and ranges "
                            "such as 1,4-7",
                            labels);
    volume_object *o = volume_begin(type, given);
    if (!o || !use((volume_object *)given, Py_None)) {
        Py_XDECREF((PyObject *)o);
        return NULL;
    }
    memcpy(o->order, ((volume_object *)given)->order, sizeof o->order);
    CALL(o->context, status,
         snow_volume_mask(((volume_object *)given)->volume,
                          ((volume_object *)mask)->volume,
                          labels ? ranges : NULL, count, &o->volume));
    if (leave(o->context, status))
        return (PyObject *)o;
    Py_DECREF((PyObject *)o);
    return NULL;
}

static int volume_buffer(PyObject *self, Py_buffer *view, int flags) {
    volume_object *o = (volume_object *)self;
    view->obj = NULL;
    if (!is_open(o))
        return -1;
    const snow_volume_info *info = snow_volume_get_info(o->volume);
    const void *voxels = snow_volume_voxels(o->volume);
    const int64_t *dims = info->dims;
    Py_ssize_t size = (Py_ssize_t)snow_type_size(info->type);
    const Py_ssize_t steps[3] = {size * dims[0] * dims[1], size * dims[0],
                                 size};
    const int all =
        PyBUF_C_CONTIGUOUS | PyBUF_F_CONTIGUOUS | PyBUF_ANY_CONTIGUOUS;
    bool turned = o->order[0] > o->order[1] || o->order[1] > o->order[2];
    if (!voxels || (turned && (flags & all) != PyBUF_STRIDES)) {
        PyErr_SetString(PyExc_BufferError,
                        voxels ? "the array is not C contiguous"
                               : "the voxels stay in their file");
        return -1;
    }
    for (int n = 0; n < 3; n++) {
        o->shape[n] = (Py_ssize_t)dims[2 - o->order[n]];
        o->strides[n] = steps[o->order[n]];
    }
    if (PyBuffer_FillInfo(view, self, (void *)voxels, steps[0] * dims[2], 1,
                          flags))
        return -1;
    o->exports++;
    view->itemsize = size;
    view->ndim = 3;
    view->shape = o->shape;
    view->strides = o->strides;
    view->format = (char *)codes[info->type];
    return 0;
}

static void volume_release(PyObject *self, Py_buffer *view) {
    (void)view;
    ((volume_object *)self)->exports--;
}

/* Gives the memory back, which arrays may still use. */
static PyObject *volume_close(PyObject *self, PyObject *nothing) {
    volume_object *o = (volume_object *)self;
    (void)nothing;
    if (!enter(o->context, Py_None))
        return NULL;
    if (o->exports)
        PyErr_SetString(PyExc_BufferError,
                        "the volume cannot be closed: arrays of its voxels are "
                        "in use; delete them");
    else {
        snow_frame_free(o->frame);
        snow_volume_close(o->volume);
        o->frame = NULL;
        o->volume = NULL;
        PyBuffer_Release(&o->buffer);
    }
    return leave(o->context, SNOW_STATUS_OK) ? Py_NewRef(Py_None) : NULL;
}

static PyObject *volume_info(PyObject *self, void *closure) {
    volume_object *o = (volume_object *)self;
    if (!is_open(o))
        return NULL;
    const snow_volume_info *i = snow_volume_get_info(o->volume);
    const double(*m)[4] = i->matrix;
    (void)closure;
    return Py_BuildValue(
        "{s(LLL)sss(ddd)s((dddd)(dddd)(dddd)(dddd))sdsdsOsO&sssLsLsO&sO&sO}",
        "dims", (long long)i->dims[0], (long long)i->dims[1],
        (long long)i->dims[2], "type", snow_type_name(i->type), "spacing",
        i->spacing[0], i->spacing[1], i->spacing[2], "matrix", m[0][0], m[0][1],
        m[0][2], m[0][3], m[1][0], m[1][1], m[1][2], m[1][3], m[2][0], m[2][1],
        m[2][2], m[2][3], m[3][0], m[3][1], m[3][2], m[3][3], "slope", i->slope,
        "intercept", i->intercept, "medical", i->medical ? Py_True : Py_False,
        "unit", text_of, i->unit, "format", i->format, "times",
        (long long)i->times, "time", (long long)i->time, "storage", text_of,
        i->storage, "modality", text_of, i->modality, "hounsfield",
        i->hounsfield ? Py_True : Py_False);
}

static PyObject *volume_statistics(PyObject *self, PyObject *nothing) {
    volume_object *o = (volume_object *)self;
    snow_volume_statistics s;
    snow_status status;
    (void)nothing;
    snow_volume_statistics_init(&s);
    if (!use(o, Py_None))
        return NULL;
    CALL(o->context, status, snow_volume_get_statistics(o->volume, &s));
    if (!leave(o->context, status))
        return NULL;
    const bool hu =
        snow_are_hounsfield(snow_volume_get_info(o->volume), s.min, s.max);
    return Py_BuildValue("{sLsLsdsdsdsO}", "voxels", (long long)s.voxels,
                         "finite", (long long)s.finite, "min", s.min, "max",
                         s.max, "sum", s.sum, "hounsfield",
                         hu ? Py_True : Py_False);
}

static PyObject *volume_histogram(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    double low, high;
    Py_ssize_t bins;
    snow_status status;
    if (!PyArg_ParseTuple(args, "ddn", &low, &high, &bins))
        return NULL;
    if (bins < 1 || bins > 1 << 24)
        return PyErr_Format(PyExc_ValueError, "%zd bins: give 1 to 16777216",
                            bins);
    uint64_t *counts = calloc((size_t)bins, sizeof *counts);
    if (!counts)
        return PyErr_NoMemory();
    PyObject *list = NULL;
    if (use(o, Py_None)) {
        CALL(o->context, status,
             snow_volume_histogram(o->volume, low, high, (size_t)bins, counts));
        if (leave(o->context, status))
            list = PyList_New(bins);
    }
    for (Py_ssize_t n = 0; list && n < bins; n++)
        PyList_SetItem(list, n, PyLong_FromUnsignedLongLong(counts[n]));
    free(counts);
    return list;
}

static PyObject *volume_save(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    const char *path;
    int overwrite;
    snow_status status;
    if (!PyArg_ParseTuple(args, "yp", &path, &overwrite) || !use(o, Py_None))
        return NULL;
    CALL(o->context, status, snow_volume_save(o->volume, path, overwrite));
    if (!leave(o->context, status))
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *volume_freeze(PyObject *self, PyObject *nothing) {
    volume_object *o = (volume_object *)self;
    (void)nothing;
    if (!use(o, Py_None))
        return NULL;
    snow_volume_freeze(o->volume);
    if (!leave(o->context, SNOW_STATUS_OK))
        return NULL;
    Py_RETURN_NONE;
}

/* --- looks ---------------------------------------------------------------- */

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
        fine = set_triple(what, PyTuple_GetItem(rows, n), width, false,
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
    static const char *const names[] = {"auto", "full", "values", "percentiles",
                                        "robust"};
    for (int n = 0; n < 5; n++)
        if (strcmp(names[n], name) == 0)
            return n;
    return -1;
}

/* look(volume, fields, range, colors, opacities, gradient opacities) */
static PyObject *volume_look(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *given, *colors, *opacities, *gradients;
    const char *range;
    snow_look look;
    snow_status status;
    snow_look_init(&look);
    if (!PyArg_ParseTuple(args, "OsOOO", &given, &range, &colors, &opacities,
                          &gradients) ||
        !fill(given, FIELDS(look_fields), &look))
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
    if (made && use(o, Py_None)) {
        Py_INCREF((PyObject *)o->context);
        made->context = o->context;
        CALL(o->context, status,
             snow_transfer_new_for_volume(o->volume, &look, &made->transfer));
        leave(o->context, status);
    }
    free(color);
    free(opacity);
    free(gradient);
    if (!PyErr_Occurred())
        return (PyObject *)made;
    Py_XDECREF((PyObject *)made);
    return NULL;
}

/* --- pictures ------------------------------------------------------------- */

static bool make_view(volume_object *o, const char *name, PyObject *given,
                      snow_view *view) {
    context_object *c = o->context;
    snow_status status = SNOW_STATUS_OK;
    snow_view_init(view);
    name = snow_view_name_for(snow_volume_get_info(o->volume), name);
    status = snow_view_from_name(c->context, name, view);
    if (status != SNOW_STATUS_OK) {
        set_error(status, snow_context_message(c->context));
        return false;
    }
    if (!fill(given, FIELDS(view_fields), view))
        return false;
    for (int n = 0; given != Py_None && n < 3; n++) {
        static const char *const names[] = {"position", "target", "upward"};
        bool *has[] = {&view->has_position, &view->has_target, &view->has_up};
        PyObject *value = PyDict_GetItemString(given, names[n]);
        *has[n] = value && value != Py_None;
    }
    return true;
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
    snow_view view;
    snow_settings settings;
    const double *azimuths; /* all that are to fit */
    size_t azimuth_count;
    bool fit;
    snow_image *image, *depth;
} request;

static snow_status draw(request *r) {
    volume_object *o = r->volume;
    snow_status status = SNOW_STATUS_OK;
    if (!o->frame)
        status = snow_frame_new(o->context->context, &o->frame);
    if (!status && r->fit)
        status =
            snow_view_fit(NULL, o->volume, r->transfer->transfer, &r->settings,
                          r->azimuths, r->azimuth_count, &r->view);
    if (!status)
        status = snow_frame_render(o->frame, o->volume, r->transfer->transfer,
                                   &r->view, &r->settings, &r->image);
    if (!status && r->settings.depth)
        status = copy_depth(o, &r->depth);
    return status;
}

/* What the last picture took. */
static PyObject *stats_of(const volume_object *o) {
    const snow_stats *s = snow_frame_stats(o->frame);
    return Py_BuildValue(
        "{sssssssssisLsLsdsd}", "method", snow_method_name(s->method),
        "encoding", snow_encoding_name(s->encoding), "kernel",
        snow_kernel_name(s->kernel), "isa", snow_isa_name(s->isa), "threads",
        s->threads, "voxels", (long long)s->voxels, "interesting",
        (long long)s->interesting, "sparse_ratio", s->sparse_ratio, "seconds",
        s->seconds_frame);
}

/* render(Image, transfer, view, view's fields, settings, fit, azimuths or None,
 * progress) -> (image, depth or None, the view's target or None, zoom, stats)
 */
static PyObject *volume_render(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *type, *transfer, *view, *settings, *azimuths, *progress;
    const char *name;
    request r = {.volume = o};
    snow_status status;
    int fit;
    snow_settings_init(&r.settings);
    if (!PyArg_ParseTuple(args, "OO!zOOpOO", &type, transfer_type, &transfer,
                          &name, &view, &settings, &fit, &azimuths,
                          &progress) ||
        !fill(settings, FIELDS(settings_fields), &r.settings))
        return NULL;
    r.transfer = (transfer_object *)transfer;
    r.fit = fit;
    double *turns = NULL;
    if (azimuths != Py_None) {
        Py_ssize_t count = PySequence_Size(azimuths);
        if (count < 1 ||
            !(turns = PyMem_Malloc((size_t)count * sizeof *turns)) ||
            !set_triple("azimuths", azimuths, count, false, turns)) {
            PyMem_Free(turns);
            return PyErr_Occurred() ? NULL : PyErr_NoMemory();
        }
        r.azimuth_count = (size_t)count;
        r.azimuths = turns;
    }
    if (!use(o, progress)) {
        PyMem_Free(turns);
        return NULL;
    }
    if (!make_view(o, name, view, &r.view)) {
        leave(o->context, SNOW_STATUS_OK);
        PyMem_Free(turns);
        return NULL;
    }
    CALL(o->context, status, draw(&r));
    PyMem_Free(turns);
    PyObject *stats = status == SNOW_STATUS_OK ? stats_of(o) : NULL;
    const bool fine = leave(o->context, status);
    PyObject *image = NULL, *depth = NULL, *target = NULL, *out = NULL;
    if (r.image)
        image = image_make((PyTypeObject *)type, o->context, r.image);
    if (r.depth)
        depth = image_make((PyTypeObject *)type, o->context, r.depth);
    if (image) {
        image_object *made = (image_object *)image;
        Py_INCREF(transfer);
        made->transfer = transfer;
        made->info = *snow_volume_get_info(o->volume);
        made->view = r.view;
    }
    if (fine && r.view.has_target)
        target = Py_BuildValue("(ddd)", r.view.target[0], r.view.target[1],
                               r.view.target[2]);
    if (fine && image && stats)
        out = Py_BuildValue("(OOOdO)", image, depth ? depth : Py_None,
                            target ? target : Py_None, r.view.zoom, stats);
    Py_XDECREF(target);
    Py_XDECREF(image);
    Py_XDECREF(depth);
    Py_XDECREF(stats);
    return out;
}

/* --- slices --------------------------------------------------------------- */

/* slice_axis(name) -> the grid's axis, and the nearest of the world */
static PyObject *volume_slice_axis(PyObject *self, PyObject *name) {
    volume_object *o = (volume_object *)self;
    const char *text = PyUnicode_AsUTF8AndSize(name, NULL);
    int axis = 0, world = 0;
    snow_view view;
    snow_view_init(&view);
    if (!text || !use(o, Py_None))
        return NULL;
    if (!leave(o->context, snow_slice_view(o->context->context,
                                           snow_volume_get_info(o->volume),
                                           text, &view, &axis)))
        return NULL;
    for (int n = 1; n < 3; n++)
        if (fabs(view.back[n]) > fabs(view.back[world]) + 1e-6)
            world = n;
    return Py_BuildValue("(ii)", axis, world);
}

static snow_status draw_slice(request *r, const char *axis, int64_t index,
                              const snow_transfer *transfer) {
    int found;
    snow_status status = snow_slice_view(
        r->volume->context->context, snow_volume_get_info(r->volume->volume),
        axis, &r->view, &found);
    if (status == SNOW_STATUS_OK)
        status = snow_slice_render(r->volume->volume, index, transfer, &r->view,
                                   &r->settings, &r->image);
    return status;
}

/* slice(Image, axis, index, transfer or None for values, width, height,
 * settings) */
static PyObject *volume_slice(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *type, *transfer, *settings;
    const char *axis;
    long long index;
    int width, height;
    request r = {.volume = o};
    snow_status status;
    snow_settings_init(&r.settings);
    snow_view_init(&r.view);
    if (!PyArg_ParseTuple(args, "OsLOiiO", &type, &axis, &index, &transfer,
                          &width, &height, &settings) ||
        !fill(settings, FIELDS(settings_fields), &r.settings))
        return NULL;
    bool colored = PyObject_TypeCheck(transfer, transfer_type);
    r.view.width = width;
    r.view.height = height;
    if (!use(o, Py_None))
        return NULL;
    CALL(o->context, status,
         draw_slice(&r, axis, index,
                    colored ? ((transfer_object *)transfer)->transfer : NULL));
    if (!leave(o->context, status)) {
        discard(o->context, release_image, r.image);
        return NULL;
    }
    image_object *made =
        (image_object *)image_make((PyTypeObject *)type, o->context, r.image);
    if (!made)
        return NULL;
    made->info = *snow_volume_get_info(o->volume);
    made->view = r.view;
    made->opaque = true;
    if (colored) {
        Py_INCREF(transfer);
        made->transfer = transfer;
    }
    return (PyObject *)made;
}

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
                 {"colormaps", snow_colormap_name},
                 {"phantoms", snow_phantom_name},
                 {"formats", snow_format_name},
                 {"views", snow_view_name}};
    const char *name = PyUnicode_AsUTF8AndSize(what, NULL);
    (void)module;
    for (size_t n = 0; name && n < sizeof lists / sizeof *lists; n++)
        if (strcmp(lists[n].what, name) == 0)
            return list_of(lists[n].name);
    return name ? PyErr_Format(PyExc_ValueError, "no list '%s'", name) : NULL;
}

/* Most bits a channel of a picture file; 0: floats; -1: none that is written.
 */
static PyObject *format_bits(PyObject *module, PyObject *path) {
    const char *text = PyBytes_AsString(path);
    (void)module;
    return text ? PyLong_FromLong(snow_image_format_bits(text)) : NULL;
}

static PyObject *version(PyObject *module, PyObject *nothing) {
    (void)module;
    (void)nothing;
    return PyUnicode_FromString(snow_version());
}

/* --- the module ----------------------------------------------------------- */

#define METHOD(name, function, flags, text) \
    { name, (PyCFunction)(void (*)(void))(function), flags, text }

static PyMethodDef image_methods[] = {
    METHOD("_save", image_save, METH_VARARGS | METH_KEYWORDS,
           "to a file, or as bytes"),
    METHOD("_paint", image_paint, METH_VARARGS, "values as colours"),
    {NULL, NULL, 0, NULL}};
static PyGetSetDef image_values[] = {
    {"shape", image_shape, NULL, "(height, width, channels)", NULL},
    {"checksum", image_checksum, NULL, "64-bit FNV-1a of the floats", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
static PyMethodDef transfer_methods[] = {
    METHOD("evaluate", transfer_evaluate, METH_O,
           "red, green, blue and opacity, 0 to 1, of a data value"),
    {NULL, NULL, 0, NULL}};
static PyGetSetDef transfer_values[] = {
    {"description", transfer_text, NULL, "what was chosen, one line", NULL},
    {"domain", transfer_domain, NULL, "first and last data value", NULL},
    {"unshaded", transfer_unshaded, NULL, "better drawn unshaded", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
static PyMethodDef volume_methods[] = {
    METHOD("_statistics", volume_statistics, METH_NOARGS, "of finite values"),
    METHOD("_histogram", volume_histogram, METH_VARARGS, "low, high, bins"),
    METHOD("_save", volume_save, METH_VARARGS, "path, overwrite"),
    METHOD("_freeze", volume_freeze, METH_NOARGS, "the voxels stay"),
    METHOD("_close", volume_close, METH_NOARGS, "gives its memory back"),
    METHOD("_look", volume_look, METH_VARARGS, "a transfer function"),
    METHOD("_render", volume_render, METH_VARARGS, "a picture"),
    METHOD("_slice_axis", volume_slice_axis, METH_O, "of the grid and world"),
    METHOD("_slice", volume_slice, METH_VARARGS, "a picture of a slice"),
    {NULL, NULL, 0, NULL}};
static PyGetSetDef volume_values[] = {
    {"_info", volume_info, NULL, "snow_volume_info", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
static PyMethodDef functions[] = {
    METHOD("open", volume_open, METH_VARARGS, "a volume of a file"),
    METHOD("wrap", volume_wrap, METH_VARARGS, "a volume over an array"),
    METHOD("masked", volume_masked, METH_VARARGS, "a volume within a mask"),
    METHOD("load_image", image_load, METH_VARARGS, "a picture of a file"),
    METHOD("compare", image_compare, METH_VARARGS, "of two pictures"),
    METHOD("names", names_of, METH_O, "presets, colormaps, ..."),
    METHOD("format_bits", format_bits, METH_O, "of a picture file's name"),
    METHOD("version", version, METH_NOARGS, "of the library"),
    {NULL, NULL, 0, NULL}};

/* A slot's function as the pointer that a record has. */
#define SLOT(number, function) slot_of(number, (void (*)(void))(function))
static PyType_Slot slot_of(int number, void (*function)(void)) {
    PyType_Slot slot = {number, NULL};
    memcpy(&slot.pfunc, &function, sizeof slot.pfunc);
    return slot;
}

typedef int buffer_fn(PyObject *self, Py_buffer *view, int flags);
typedef void release_fn(PyObject *self, Py_buffer *view);

static PyTypeObject *add_type(PyObject *module, const char *name, size_t size,
                              destructor dealloc, buffer_fn *buffer,
                              release_fn *release, PyMethodDef *methods,
                              PyGetSetDef *values, unsigned flags) {
    PyType_Slot slots[7] = {{0, NULL}};
    int n = 0;
    slots[n++] = SLOT(Py_tp_dealloc, dealloc);
    if (methods)
        slots[n++] = (PyType_Slot){Py_tp_methods, methods};
    if (values)
        slots[n++] = (PyType_Slot){Py_tp_getset, values};
    if (buffer)
        slots[n++] = SLOT(Py_bf_getbuffer, buffer);
    if (release)
        slots[n++] = SLOT(Py_bf_releasebuffer, release);
    PyType_Spec spec = {name, (int)size, 0, Py_TPFLAGS_DEFAULT | flags, slots};
    PyObject *type = PyType_FromSpec(&spec);
    if (type && PyModule_AddObjectRef(module, strchr(name, '.') + 1, type))
        Py_CLEAR(type);
    return (PyTypeObject *)type;
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
    const unsigned closed = Py_TPFLAGS_DISALLOW_INSTANTIATION;
    PyObject *m = PyModule_Create(&definition);
    if (!m)
        return NULL;
    context_type = add_type(m, "_snowglass.Context", sizeof(context_object),
                            context_free, NULL, NULL, NULL, NULL, closed);
    transfer_type = add_type(m, "_snowglass.Transfer", sizeof(transfer_object),
                             transfer_free, NULL, NULL, transfer_methods,
                             transfer_values, closed);
    volume_type =
        add_type(m, "_snowglass.Volume", sizeof(volume_object), volume_free,
                 volume_buffer, volume_release, volume_methods, volume_values,
                 closed | Py_TPFLAGS_BASETYPE);
    image_type = add_type(m, "_snowglass.Image", sizeof(image_object),
                          image_free, image_buffer, NULL, image_methods,
                          image_values, closed | Py_TPFLAGS_BASETYPE);
    error_type =
        PyErr_NewException("snowglass.Error", PyExc_RuntimeError, NULL);
    warning_type = PyErr_NewException("snowglass.SnowglassWarning",
                                      PyExc_UserWarning, NULL);
    if (!context_type || !transfer_type || !volume_type || !image_type ||
        PyModule_AddObjectRef(m, "Error", error_type) ||
        PyModule_AddObjectRef(m, "SnowglassWarning", warning_type)) {
        Py_DECREF(m);
        return NULL;
    }
    return m;
}
