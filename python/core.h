/* core.h - what the files of the extension module _snowglass share.
 *
 * It is the core of the Python package, in the limited API of CPython 3.11, so
 * that one build serves all later versions. Everything comfortable is Python
 * (snowglass/): here are objects that own those of the library, and records
 * that are filled from dictionaries.
 *
 *   context.c  Context: a snow_context and its lock; every other object holds
 *              one
 *   errors.c   exceptions of what the library answers
 *   records.c  records of the library from dictionaries
 *   messages.c messages of the library as Python's
 *   volume.c   Volume: a volume and the frame that draws it
 *   look.c     Transfer: a transfer function
 *   picture.c  pictures and slices of volumes
 *   image.c    Image: a picture, read and written by the buffer protocol */
#ifndef SNOWGLASS_PYTHON_CORE_H
#define SNOWGLASS_PYTHON_CORE_H

#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <snowglass/snowglass.h>

#include <stdbool.h>

extern PyObject *error_type, *warning_type;
extern PyTypeObject *context_type, *volume_type, *transfer_type, *image_type;

/* --- contexts ------------------------------------------------------------- */

typedef void free_fn(void *object);

typedef struct pending {
    free_fn *release;
    void *object;
    struct pending *next;
} pending;

/* A context belongs to one thread at a time. A call takes its lock, gives back
 * the interpreter's, and calls the library; other threads wait. */
typedef struct context_object {
    PyObject_HEAD snow_context *context;
    PyThread_type_lock lock;
    unsigned long holder; /* the thread that has the lock */
    bool held;
    PyThreadState *saved; /* of a call that is under way */
    PyObject *progress;   /* what it reports to, borrowed; or NULL */
    bool raised;          /* by a signal or by what it reports to */
    double looked;        /* when signals were looked for last */
    PyObject *warnings;   /* texts of it */
    pending *garbage;
} context_object;

/* A new one; NULL with an exception. */
context_object *context_new(void);

/* Takes the lock; false with an exception. */
bool context_enter(context_object *c, PyObject *progress);

/* Gives the lock back; false with an exception, if the status is an error or a
 * warning is one. */
bool context_leave(context_object *c, snow_status status);

/* For settings.stop, with a context_object: whether a signal has raised. */
bool context_is_stopped(void *context);

/* A call of the library between the two, without the interpreter's lock. */
#define CALL(c, status, call)             \
    do {                                  \
        (c)->saved = PyEval_SaveThread(); \
        (status) = (call);                \
        PyEval_RestoreThread((c)->saved); \
        (c)->saved = NULL;                \
    } while (0)

/* Frees an object of the library now, or, where another thread draws by its
 * context, when that call ends. */
void context_discard(context_object *c, free_fn *release, void *object);

/* An exception with a text of the library. */
void context_set_error(snow_status status, const char *message);

/* Adds the classes of exceptions to the module; false with an exception. */
bool errors_add(PyObject *module);

/* The end of an object's dealloc. */
void end_object(PyObject *self);

/* Names of files and their texts may be in any encoding. */
PyObject *text_of(const void *text);

/* --- records from dictionaries -------------------------------------------- */

/* Items by the names of the records' fields; None leaves the default. False
 * with an exception. */
bool record_fill_settings(PyObject *given, snow_settings *settings);
bool record_fill_view(PyObject *given, snow_view *view);
bool record_fill_options(PyObject *given, snow_volume_options *options);
bool record_fill_look(PyObject *given, snow_look *look);

/* As many doubles, or int64_t where they are whole, of a sequence; false with
 * an exception that has the name. */
bool record_numbers(const char *name, PyObject *value, Py_ssize_t count,
                    bool whole, void *to);

/* The names of settings, by numbers; NULL behind the last. */
const char *record_setting_name(size_t n);

/* Whether there is an argument of such a name. */
bool record_is_argument(const char *name);

/* Whether a dictionary has an item other than None. */
bool record_has(PyObject *given, const char *name);

/* A message of the library, in which options of the tool are arguments: crop=
 * for --crop, time=2 for --time 2, dims=(4, 5, 6) for --dims 4x5x6. */
PyObject *message_text(const char *message);

/* --- objects -------------------------------------------------------------- */

typedef struct transfer_object {
    PyObject_HEAD context_object *context;
    snow_transfer *transfer;
} transfer_object;

typedef struct image_object {
    PyObject_HEAD context_object *context;
    snow_image *image;
    Py_ssize_t shape[3], strides[3];
    /* What letters, bars and scales need; NULL: a picture of a file. */
    PyObject *transfer;
    snow_volume_info info;
    snow_view view;
    bool placed; /* the view is that of all pixels */
} image_object;

/* Leaves a strip of a view whose size is known to (legend, unit or None, (low,
 * high) or NaN, bars or None), or without a legend to a scale bar; false with
 * an exception. */
bool image_leave_strip(const transfer_object *t, PyObject *marks,
                       snow_view *view);

typedef struct volume_object {
    PyObject_HEAD context_object *context;
    snow_volume *volume;
    snow_frame *frame;
    Py_buffer buffer; /* of wrapped voxels */
    int order[3]; /* that dimensions of an array have in memory, slowest 0 */
    Py_ssize_t shape[3], strides[3], exports;
} volume_object;

/* Takes over the image; NULL with an exception. */
PyObject *image_make(PyTypeObject *type, context_object *context,
                     snow_image *image);

/* False with an exception where it is closed. */
bool volume_is_open(const volume_object *o);

/* Takes the lock of a volume that is not closed; false with an exception. */
bool volume_use(volume_object *o, PyObject *progress);

PyObject *look_colormap_color(PyObject *module, PyObject *name);
PyObject *volume_ground(PyObject *self, PyObject *args);
PyObject *volume_look(PyObject *self, PyObject *args);
PyObject *volume_render(PyObject *self, PyObject *args);
PyObject *volume_views(PyObject *self, PyObject *nothing);
PyObject *volume_slice_axis(PyObject *self, PyObject *name);
PyObject *volume_slice(PyObject *self, PyObject *args);
PyObject *volume_slices(PyObject *self, PyObject *args);
PyObject *volume_slice_shown(PyObject *self, PyObject *args);

/* --- the module ----------------------------------------------------------- */

#define METHOD(name, function, flags, text) \
    { name, (PyCFunction)(void (*)(void))(function), flags, text }

typedef int buffer_fn(PyObject *self, Py_buffer *view, int flags);
typedef void release_fn(PyObject *self, Py_buffer *view);

/* What a type has; what it has not is NULL. */
typedef struct type_parts {
    const char *name; /* with that of the module */
    size_t size;
    bool is_base; /* Python derives from it */
    destructor dealloc;
    buffer_fn *buffer;
    release_fn *release;
    PyMethodDef *methods;
    PyGetSetDef *values;
} type_parts;

extern const type_parts context_parts, volume_parts, transfer_parts,
    image_parts;

/* Functions of the module, by volume.c and image.c. */
extern PyMethodDef volume_functions[], image_functions[];

#endif
