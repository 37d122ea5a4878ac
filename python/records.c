/* records.c - records of the library from dictionaries, by tables of their
 * fields. */
#include "core.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct field {
    const char *name;
    char kind; /* d double, i int, l int64_t, u uint64_t, b bool, e enum, s
                  text, 3 three doubles, 6 three pairs of int64_t, n three
                  int64_t */
    size_t offset;
    const char *(*name_of)(int value); /* of an enum below ENUM_MOST, or NULL */
    int (*value_of)(const char *name); /* where names have other forms, too */
} field;

/* No enum has as many values. */
#define ENUM_MOST 16

bool record_numbers(const char *name, PyObject *value, Py_ssize_t count,
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
        fine = record_numbers("each of crop", PyTuple_GetItem(all, n), 2, true,
                              crop[n]);
    Py_XDECREF(all);
    if (!fine && !PyErr_Occurred())
        PyErr_SetString(PyExc_TypeError, "crop must be three pairs of voxels");
    return fine;
}

static int find_enum(const field *f, const char *name) {
    if (f->value_of)
        return f->value_of(name);
    for (int n = 0; n < ENUM_MOST; n++)
        if (f->name_of(n) && strcmp(f->name_of(n), name) == 0)
            return n;
    return -1;
}

static bool set_enum(const field *f, PyObject *value, int *to) {
    char known[256] = "";
    const char *name =
        PyUnicode_Check(value) ? PyUnicode_AsUTF8AndSize(value, NULL) : "";
    if (!name)
        return false;
    *to = find_enum(f, name);
    if (*to >= 0)
        return true;
    for (int n = 0, used = 0; n < ENUM_MOST && used < (int)sizeof known; n++)
        if (f->name_of(n))
            used += snprintf(known + used, sizeof known - (size_t)used, ", %s",
                             f->name_of(n));
    PyErr_Format(*name ? PyExc_ValueError : PyExc_TypeError,
                 "%s: there is no %R; take one of %s", f->name, value,
                 known + 2);
    return false;
}

/* An exception of Python's own, which does not know what it is about. */
static bool name_error(const field *f) {
    PyObject *type, *value, *trace;
    PyErr_Fetch(&type, &value, &trace);
    PyErr_Format(type, "%s: %S", f->name, value);
    Py_XDECREF(type);
    Py_XDECREF(value);
    Py_XDECREF(trace);
    return false;
}

static bool set_field(const field *f, PyObject *value, void *record) {
    char *to = (char *)record + f->offset;
    if (strchr("ilu", f->kind) && !PyIndex_Check(value)) {
        PyErr_Format(PyExc_TypeError, "%s: must be a whole number, not %R",
                     f->name, value);
        return false;
    }
    switch (f->kind) {
    case 'd':
        *(double *)(void *)to = PyFloat_AsDouble(value);
        break;
    case 'i': {
        long number = PyLong_AsLong(value);
        if (!PyErr_Occurred() && number != (int)number)
            PyErr_Format(PyExc_ValueError, "%ld is out of range", number);
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
        return record_numbers(f->name, value, 3, false, to);
    case 'n':
        return record_numbers(f->name, value, 3, true, to);
    default:
        return set_crop(value, (int64_t(*)[2])(void *)to);
    }
    return !PyErr_Occurred() || name_error(f);
}

bool record_has(PyObject *given, const char *name) {
    PyObject *item =
        given == Py_None ? NULL : PyDict_GetItemString(given, name);
    return item && item != Py_None;
}

/* Fields of a record from a dictionary's items; None leaves the default.
 * Python has checked the names, as it has some of its own. */
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

#define FIELD(record, name, kind) \
    { #name, kind, offsetof(record, name), NULL, NULL }
#define ENUM(record, name, name_of, value_of) \
    { #name, 'e', offsetof(record, name), name_of, value_of }

/* Those of the library, by numbers. */
#define NAMES_OF(what)                               \
    static const char *what##_at(int n) {            \
        return snow_##what##_name((snow_##what)(n)); \
    }
NAMES_OF(method)
NAMES_OF(encoding)
NAMES_OF(kernel)
NAMES_OF(quality)
NAMES_OF(isa)
NAMES_OF(mode)

static const char *type_at(int n) {
    return n > SNOW_TYPE_NONE && n <= SNOW_TYPE_FLOAT64
               ? snow_type_name((snow_type)n)
               : NULL;
}

static const char *shade_at(int n) {
    return n == SNOW_SHADE_PHONG  ? "phong"
           : n == SNOW_SHADE_NONE ? "none"
                                  : NULL;
}

static const char *light_at(int n) {
    return n == SNOW_LIGHT_AUTO        ? "auto"
           : n == SNOW_LIGHT_KEY       ? "key"
           : n == SNOW_LIGHT_HEAD      ? "head"
           : n == SNOW_LIGHT_DIRECTION ? "direction"
                                       : NULL;
}

static const char *endian_at(int n) {
    return n == SNOW_ENDIAN_LITTLE ? "little"
           : n == SNOW_ENDIAN_BIG  ? "big"
                                   : NULL;
}

static const char *domain_at(int n) {
    return n == SNOW_DOMAIN_RANGE ? "range" : NULL;
}

static int type_of_name(const char *name) {
    snow_type type = snow_type_from_name(name);
    return type == SNOW_TYPE_NONE ? -1 : (int)type;
}

#define SETTING(name, kind) FIELD(snow_settings, name, kind)
#define CHOICE(name, value_of) ENUM(snow_settings, name, name##_at, value_of)
static const field settings_fields[] = {
    SETTING(threshold, 'd'),
    CHOICE(method, snow_method_from_name),
    CHOICE(encoding, snow_encoding_from_name),
    CHOICE(kernel, snow_kernel_from_name),
    SETTING(footprint, 'i'),
    SETTING(opacity_length, 'd'),
    CHOICE(shade, NULL),
    SETTING(ambient, 'd'),
    SETTING(diffuse, 'd'),
    SETTING(specular, 'd'),
    SETTING(shininess, 'd'),
    SETTING(light_azimuth, 'd'),
    SETTING(light_elevation, 'd'),
    CHOICE(quality, snow_quality_from_name),
    CHOICE(isa, snow_isa_from_name),
    SETTING(threads, 'i'),
    SETTING(deterministic, 'b'),
    CHOICE(mode, snow_mode_from_name),
    SETTING(iso, 'd'),
    SETTING(depth, 'b'),
    CHOICE(light, NULL),
    SETTING(depth_darkening, 'd'),
    SETTING(occlusion, 'd'),
};

#define VIEW(name, kind) FIELD(snow_view, name, kind)
static const field view_fields[] = {
    VIEW(width, 'i'),   VIEW(height, 'i'),
    VIEW(azimuth, 'd'), VIEW(elevation, 'd'),
    VIEW(roll, 'd'),    VIEW(zoom, 'd'),
    VIEW(fov, 'd'),     VIEW(position, '3'),
    VIEW(target, '3'),  {"up", '3', offsetof(snow_view, view_up), NULL, NULL},
};

#define OPTION(name, kind) FIELD(snow_volume_options, name, kind)
static const field option_fields[] = {
    OPTION(dims, 'n'),
    ENUM(snow_volume_options, type, type_at, type_of_name),
    ENUM(snow_volume_options, endian, endian_at, NULL),
    OPTION(spacing, '3'),
    OPTION(offset, 'u'),
    OPTION(time, 'l'),
    OPTION(crop, '6'),
    OPTION(channel, 'l'),
    OPTION(dataset, 's'),
    OPTION(series, 's'),
    OPTION(mask, 's'),
    OPTION(labels, 's'),
    OPTION(label_table, 's'),
    OPTION(component, 's'),
    OPTION(allow_gaps, 'b'),
    OPTION(each_time, 'b'),
    OPTION(each_channel, 'b'),
    OPTION(levels, 'l'),
    OPTION(suv, 's'),
    OPTION(z_scale, 'd'),
    OPTION(vertical, 's'),
};

#define LOOK(name, kind) FIELD(snow_look, name, kind)
static const field look_fields[] = {
    LOOK(name, 's'),
    LOOK(preset, 's'),
    LOOK(colormap, 's'),
    LOOK(low, 'd'),
    LOOK(high, 'd'),
    LOOK(log, 'b'),
    LOOK(per_mm, 'b'),
    LOOK(symlog, 'd'),
    LOOK(overlay, 'b'),
    LOOK(white, 'd'),
    ENUM(snow_look, domain, domain_at, NULL),
};

#define FILL(given, fields, record) \
    fill(given, fields, sizeof(fields) / sizeof *(fields), record)

bool record_fill_settings(PyObject *given, snow_settings *settings) {
    return FILL(given, settings_fields, settings);
}

bool record_fill_view(PyObject *given, snow_view *view) {
    if (!FILL(given, view_fields, view))
        return false;
    view->has_position = record_has(given, "position");
    view->has_target = record_has(given, "target");
    view->has_view_up = record_has(given, "up");
    return true;
}

bool record_fill_options(PyObject *given, snow_volume_options *options) {
    options->channel_given = record_has(given, "channel");
    options->time_given = record_has(given, "time");
    return FILL(given, option_fields, options);
}

bool record_fill_look(PyObject *given, snow_look *look) {
    return FILL(given, look_fields, look);
}

/* --- names ---------------------------------------------------------------- */

static bool has_name(const field *fields, size_t count, const char *name) {
    size_t n = 0;
    while (n < count && strcmp(fields[n].name, name) != 0)
        n++;
    return n < count;
}

#define HAS_NAME(fields, name) \
    has_name(fields, sizeof(fields) / sizeof *(fields), name)

const char *record_setting_name(size_t n) {
    return n < sizeof settings_fields / sizeof *settings_fields
               ? settings_fields[n].name
               : NULL;
}

bool record_is_argument(const char *name) {
    static const field others[] = {{.name = "clip"},
                                   {.name = "range"},
                                   {.name = "size"},
                                   {.name = "material"},
                                   {.name = "overlay_look"}};
    return HAS_NAME(option_fields, name) || HAS_NAME(settings_fields, name) ||
           HAS_NAME(view_fields, name) || HAS_NAME(look_fields, name) ||
           HAS_NAME(others, name);
}
