/* _insitu - pictures of a running simulation for Python, over the communicator
 * of mpi4py: snowglass/insitu.py is what users see.
 *
 * A module of its own, since it brings an MPI. The communicator comes as its
 * Fortran handle, so that nothing of mpi4py is needed to build it. */
#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <snowglass/mpi.h>
#include <snowglass/recipe.h>

#include <stdbool.h>
#include <string.h>

#define NAME "snowglass.insitu"

static PyObject *core, *warnings; /* of the package */

static void end_movie(PyObject *capsule) {
    snow_insitu_free(PyCapsule_GetPointer(capsule, NAME));
}

static snow_insitu *movie_of(PyObject *capsule) {
    return PyCapsule_GetPointer(capsule, NAME);
}

static snow_context *context_of(const snow_insitu *movie) {
    return snow_comm_context(snow_insitu_comm(movie));
}

/* What the library says to programs in C, and what it is in Python. */
static const char *const words[][2] = {
    {"give snow_insitu_set an output", "give output= to Movie"},
    {"call snow_insitu_set_brick", "call Movie.brick"},
    {"call snow_insitu_set_voxels", "call Movie.brick"},
    {"correct first and count", "correct first= or the shape of the array"},
    {"set width and height of the view", "give size= to Movie"},
    {"set overwrite (of snow_image_options, or in the recipe)",
     "give overwrite=True to Movie"},
    {"invalid brick ", "invalid id="},
    {"invalid spacing ", "invalid spacing="},
};

/* An argument takes the place of a name where its value follows. */
static const char *find_words(const char *message, const char *const pair[2]) {
    const char *at = strstr(message, pair[0]);
    const char behind = at ? at[strlen(pair[0])] : 0;
    const bool names =
        strchr(pair[1], '=') && pair[0][strlen(pair[0]) - 1] == ' ';
    return names && !(behind == '-' || (behind >= '0' && behind <= '9')) ? NULL
                                                                         : at;
}

/* Bytes that are not UTF-8, as of paths, are replaced. */
static PyObject *decode(const char *text, size_t bytes) {
    return PyUnicode_DecodeUTF8(text, (Py_ssize_t)bytes, "replace");
}

/* A message with the first of these replaced, a new text. */
static PyObject *text_of(const char *message) {
    const char *at = NULL;
    size_t n = 0;
    while (n < sizeof words / sizeof *words &&
           !(at = find_words(message, words[n])))
        n++;
    if (!at)
        return decode(message, strlen(message));
    const char *rest = at + strlen(words[n][0]);
    PyObject *before = decode(message, (size_t)(at - message));
    PyObject *after = decode(rest, strlen(rest)), *text = NULL;
    if (before && after)
        text = PyUnicode_FromFormat("%U%s%U", before, words[n][1], after);
    Py_XDECREF(before);
    Py_XDECREF(after);
    return text;
}

/* Raises what the status is, with the message and what follows it. */
static PyObject *answer_and(snow_status status, const char *message,
                            const char *more) {
    if (PyErr_Occurred())
        return NULL;
    if (status == SNOW_STATUS_OK)
        Py_RETURN_NONE;
    PyObject *text = text_of(message), *whole = NULL;
    if (text)
        whole = PyUnicode_FromFormat("%U%s", text, more);
    if (whole)
        PyObject_CallMethod(core, "fail", "iO", (int)status, whole);
    Py_XDECREF(whole);
    Py_XDECREF(text);
    return NULL;
}

static PyObject *answer(snow_status status, const char *message) {
    return answer_and(status, message, "");
}

/* Called by the thread that called the library, without Python's lock. */
static void warn(void *user, const char *message) {
    PyGILState_STATE state = PyGILState_Ensure();
    (void)user;
    if (!PyErr_Occurred()) {
        PyObject *text = PyObject_CallMethod(core, "text", "s", message);
        if (text)
            Py_XDECREF(PyObject_CallMethod(warnings, "warn", "O", text));
        Py_XDECREF(text);
    }
    PyGILState_Release(state);
}

/* new(the communicator's Fortran handle) */
static PyObject *movie_new(PyObject *module, PyObject *args) {
    int group;
    snow_insitu *movie = NULL;
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "i", &group))
        return NULL;
    Py_BEGIN_ALLOW_THREADS;
    status = snow_insitu_new_mpi_fortran((MPI_Fint)group, &movie);
    Py_END_ALLOW_THREADS;
    if (status != SNOW_STATUS_OK)
        return answer(status, "no movie over this communicator: MPI must run, "
                              "and be the one that Snowglass was built with");
    snow_insitu_set_warning(movie, warn, NULL);
    return PyCapsule_New(movie, NAME, end_movie);
}

/* recipe(movie, its JSON text, its output or None): collective */
static PyObject *movie_recipe(PyObject *module, PyObject *args) {
    PyObject *capsule;
    const char *text, *output;
    (void)module;
    if (!PyArg_ParseTuple(args, "Osz", &capsule, &text, &output) ||
        !movie_of(capsule))
        return NULL;
    snow_insitu *movie = movie_of(capsule);
    snow_status status = snow_recipe_apply_text(movie, text);
    Py_BEGIN_ALLOW_THREADS;
    status = snow_comm_agree_status(snow_insitu_comm(movie), status);
    if (status == SNOW_STATUS_OK && output)
        status = snow_insitu_try_output(movie, output);
    Py_END_ALLOW_THREADS;
    return answer(status, snow_context_message(context_of(movie)));
}

/* grid(movie, (x, y, z), origin, spacing) */
static PyObject *movie_grid(PyObject *module, PyObject *args) {
    PyObject *capsule;
    long long dims[3];
    double origin[3], spacing[3];
    (void)module;
    if (!PyArg_ParseTuple(args, "O(LLL)(ddd)(ddd)", &capsule, &dims[0],
                          &dims[1], &dims[2], &origin[0], &origin[1],
                          &origin[2], &spacing[0], &spacing[1], &spacing[2]) ||
        !movie_of(capsule))
        return NULL;
    const int64_t all[3] = {dims[0], dims[1], dims[2]};
    snow_insitu *movie = movie_of(capsule);
    return answer(snow_insitu_set_grid(movie, all, origin, spacing),
                  snow_insitu_message(movie));
}

/* brick(movie, id, first, count, cells, halo, type, address, strides): all
 * along x, y, z, the halo of the lower sides first; the address is that of the
 * first voxel behind it, strides are in values. */
static PyObject *movie_brick(PyObject *module, PyObject *args) {
    PyObject *capsule;
    int id;
    long long f[3], c[3], w[3], l[3], u[3], s[3];
    unsigned long long address;
    const char *type;
    (void)module;
    if (!PyArg_ParseTuple(args, "Oi(LLL)(LLL)(LLL)(LLL)(LLL)sK(LLL)", &capsule,
                          &id, &f[0], &f[1], &f[2], &c[0], &c[1], &c[2], &w[0],
                          &w[1], &w[2], &l[0], &l[1], &l[2], &u[0], &u[1],
                          &u[2], &type, &address, &s[0], &s[1], &s[2]) ||
        !movie_of(capsule))
        return NULL;
    const int64_t first[3] = {f[0], f[1], f[2]}, count[3] = {c[0], c[1], c[2]};
    const int64_t strides[3] = {s[0], s[1], s[2]};
    const int64_t cells[3] = {w[0], w[1], w[2]};
    const snow_halo halo = {{l[0], l[1], l[2]}, {u[0], u[1], u[2]}};
    snow_insitu *movie = movie_of(capsule);
    snow_status status = snow_insitu_set_brick(movie, id, first, count, &halo);
    if (status == SNOW_STATUS_OK)
        status = snow_insitu_set_cells(movie, id, cells);
    if (status == SNOW_STATUS_OK && count[0] * count[1] * count[2] > 0)
        status =
            snow_insitu_set_voxels(movie, id, snow_type_from_name(type),
                                   (const void *)(uintptr_t)address, strides);
    /* The movie's own message is that of its first error. */
    return answer_and(status, snow_context_message(context_of(movie)),
                      "; the next step raises this too");
}

/* step(movie, number, time, unit): collective; NaN: without a time */
static PyObject *movie_step(PyObject *module, PyObject *args) {
    PyObject *capsule;
    long long number;
    double time;
    const char *unit;
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "OLds", &capsule, &number, &time, &unit) ||
        !movie_of(capsule))
        return NULL;
    snow_insitu *movie = movie_of(capsule);
    snow_insitu_set_time(movie, time, unit);
    Py_BEGIN_ALLOW_THREADS;
    status = snow_insitu_step(movie, number);
    Py_END_ALLOW_THREADS;
    return answer(status, snow_insitu_message(movie));
}

static PyMethodDef functions[] = {
    {"new", movie_new, METH_VARARGS, "a movie over a communicator"},
    {"recipe", movie_recipe, METH_VARARGS, "its look, view and output"},
    {"grid", movie_grid, METH_VARARGS, "the whole grid"},
    {"brick", movie_brick, METH_VARARGS, "this rank's voxels"},
    {"step", movie_step, METH_VARARGS, "draws and writes; collective"},
    {NULL, NULL, 0, NULL}};

static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT,
                                        "_insitu",
                                        NULL,
                                        -1,
                                        functions,
                                        NULL,
                                        NULL,
                                        NULL,
                                        NULL};

PyMODINIT_FUNC PyInit__insitu(void);
PyMODINIT_FUNC PyInit__insitu(void) {
    core = PyImport_ImportModule("snowglass._snowglass");
    if (!core)
        return NULL;
    warnings = PyImport_ImportModule("snowglass._warnings");
    return warnings ? PyModule_Create(&definition) : NULL;
}
