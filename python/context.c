/* context.c - contexts and their lock: what calls of the library from several
 * threads of Python go through.
 *
 * An object may die while another thread draws by its context: it is put aside
 * then, and freed when that call ends. */
#include "core.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Seconds between two looks for signals, for each of which other threads of
 * Python may have to give way. */
#define LOOK_INTERVAL 0.03

void end_object(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    void *slot = PyType_GetSlot(type, Py_tp_free);
    freefunc release;
    memcpy(&release, &slot, sizeof release);
    release(self);
    Py_DECREF((PyObject *)type);
}

PyObject *text_of(const void *text) {
    return PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace");
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
void context_discard(context_object *c, free_fn *release, void *object) {
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

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* With the interpreter's lock. */
static void look_for_signals(context_object *c) {
    if (!c->raised)
        c->raised = PyErr_CheckSignals() != 0;
    c->looked = seconds();
}

/* Both are called by the thread that called the library. */
bool context_is_stopped(void *user) {
    context_object *c = user;
    if (!c->saved || c->raised || seconds() - c->looked < LOOK_INTERVAL)
        return c->raised;
    PyEval_RestoreThread(c->saved);
    look_for_signals(c);
    c->saved = PyEval_SaveThread();
    return c->raised;
}

static bool report(void *user, snow_stage stage, double fraction) {
    static const char *const names[] = {"read", "encode", "render", "write"};
    context_object *c = user;
    if (!c->saved)
        return false;
    PyEval_RestoreThread(c->saved);
    look_for_signals(c);
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
    PyObject *one = message_text(text);
    if (!one || PyList_Append(c->warnings, one))
        PyErr_Clear();
    Py_XDECREF(one);
    PyGILState_Release(state);
}

context_object *context_new(void) {
    context_object *c = (context_object *)PyType_GenericAlloc(context_type, 0);
    if (!c)
        return NULL;
    c->lock = PyThread_allocate_lock();
    c->warnings = PyList_New(0);
    if (!c->lock || !c->warnings ||
        snow_context_new(NULL, &c->context) != SNOW_STATUS_OK) {
        Py_DECREF((PyObject *)c);
        PyErr_NoMemory();
        return NULL;
    }
    snow_context_set_warning(c->context, keep_warning, c);
    snow_context_set_progress(c->context, report, c);
    return c;
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

bool context_enter(context_object *c, PyObject *progress) {
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

/* As warnings of the line that called the package. */
static bool warn_of(PyObject *texts) {
    PyObject *module = PyImport_ImportModule("snowglass._warnings");
    bool fine = module != NULL;
    for (Py_ssize_t n = 0; fine && n < PyList_Size(texts); n++) {
        PyObject *warned =
            PyObject_CallMethod(module, "warn", "O", PyList_GetItem(texts, n));
        fine = warned != NULL;
        Py_XDECREF(warned);
    }
    Py_XDECREF(module);
    return fine;
}

bool context_leave(context_object *c, snow_status status) {
    bool fine = !c->raised && status == SNOW_STATUS_OK;
    if (!c->raised && !PyErr_Occurred() && status != SNOW_STATUS_OK)
        context_set_error(status, snow_context_message(c->context));
    PyObject *texts = c->warnings, *empty = PyList_New(0);
    if (empty)
        c->warnings = empty;
    collect(c);
    c->held = false;
    c->progress = NULL;
    PyThread_release_lock(c->lock);
    if (fine && empty && PyList_Size(texts) > 0)
        fine = warn_of(texts);
    if (empty)
        Py_DECREF(texts);
    return fine && !PyErr_Occurred();
}

const type_parts context_parts = {.name = "_snowglass.Context",
                                  .size = sizeof(context_object),
                                  .dealloc = context_free};
