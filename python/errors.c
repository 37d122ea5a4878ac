/* errors.c - exceptions. Those of files are also the ones that Python itself has
 * for such a fault, so that `except FileNotFoundError` catches them. */
#include "core.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

PyObject *error_type, *warning_type;

/* All faults of files; of them those that have a class of their own. */
static PyObject *file_error_type;

/* A fault is known by its number's text in the message, or by other words. */
static struct file_fault {
    const char *name; /* of the class, here and in Python */
    PyObject **base;
    int number;
    const char *words[3];
    PyObject *type;
} faults[] = {
    {"FileNotFoundError", &PyExc_FileNotFoundError, ENOENT,
     {"there is no such f", "a file that is not there;"}, NULL},
    {"FileExistsError", &PyExc_FileExistsError, EEXIST,
     {": the file exists;", ": exists;"}, NULL},
    {"PermissionError", &PyExc_PermissionError, EACCES, {NULL}, NULL}};
#define FAULTS (sizeof faults / sizeof *faults)

static bool is_fault(const struct file_fault *fault, const char *message) {
    char reason[128];
    snprintf(reason, sizeof reason, ": %s;", strerror(fault->number));
    if (strstr(message, reason))
        return true;
    for (size_t n = 0; fault->words[n]; n++)
        if (strstr(message, fault->words[n]))
            return true;
    return false;
}

static PyObject *type_of(snow_status status, const char *message,
                         int *number) {
    *number = 0;
    if (status == SNOW_STATUS_NO_MEMORY)
        return PyExc_MemoryError;
    if (status == SNOW_STATUS_BAD_USAGE)
        return PyExc_ValueError;
    const bool written = status == SNOW_STATUS_BAD_OUTPUT;
    for (size_t n = 0; n < FAULTS; n++)
        if ((written || status == SNOW_STATUS_BAD_INPUT) &&
            is_fault(&faults[n], message)) {
            *number = faults[n].number;
            return faults[n].type;
        }
    return written ? file_error_type : error_type;
}

/* The exit status of the command line and, of a file's fault, its number. */
static bool set_numbers(PyObject *error, snow_status status, int number) {
    PyObject *exit = PyLong_FromLong(status), *fault = PyLong_FromLong(number);
    const bool fine =
        exit && fault && !PyObject_SetAttrString(error, "status", exit) &&
        (number == 0 || !PyObject_SetAttrString(error, "errno", fault));
    Py_XDECREF(exit);
    Py_XDECREF(fault);
    return fine;
}

void context_set_error(snow_status status, const char *message) {
    int number;
    PyObject *type = type_of(status, message, &number);
    PyObject *text = message_text(message);
    PyObject *error = text ? PyObject_CallFunction(type, "O", text) : NULL;
    const bool plain = type == PyExc_MemoryError || type == PyExc_ValueError;
    if (error && (plain || set_numbers(error, status, number)))
        PyErr_SetObject(type, error);
    Py_XDECREF(error);
    Py_XDECREF(text);
}

/* Adds snowglass.NAME, which is both; NULL with an exception. */
static PyObject *add_error(PyObject *module, const char *name, const char *doc,
                           PyObject *ours, PyObject *theirs) {
    char full[64];
    snprintf(full, sizeof full, "snowglass.%s", name);
    PyObject *bases = theirs ? PyTuple_Pack(2, ours, theirs) : NULL;
    PyObject *type =
        theirs && !bases
            ? NULL
            : PyErr_NewExceptionWithDoc(full, doc, theirs ? bases : ours, NULL);
    Py_XDECREF(bases);
    if (type && PyModule_AddObjectRef(module, name, type))
        Py_CLEAR(type);
    return type;
}

bool errors_add(PyObject *module) {
    error_type = add_error(
        module, "Error",
        "What is neither of arguments nor of memory; status is the exit status "
        "of the command line.",
        PyExc_RuntimeError, NULL);
    warning_type = add_error(module, "SnowglassWarning",
                             "All warnings of the package.", PyExc_UserWarning,
                             NULL);
    if (!error_type || !warning_type)
        return false;
    file_error_type =
        add_error(module, "FileError",
                  "A file is missing, or cannot be read or written; also OSError.",
                  error_type, PyExc_OSError);
    for (size_t n = 0; n < FAULTS && file_error_type; n++) {
        faults[n].type = add_error(module, faults[n].name, "Also Python's own.",
                                   file_error_type, *faults[n].base);
        if (!faults[n].type)
            return false;
    }
    return file_error_type != NULL;
}
