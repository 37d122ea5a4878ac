/* records.c - records of the library from dictionaries, by tables of their
 * fields. */
#include "core.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef struct field {
    const char *name;
    char kind; /* d double, i int, l int64_t, u uint64_t, b bool, e enum, s
                  text, 3 three doubles, 6 three pairs of int64_t, n three
                  int64_t */
    size_t offset;
    int (*value_of)(const char *name); /* of an enum */
} field;

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
        return record_numbers(f->name, value, 3, false, to);
    case 'n':
        return record_numbers(f->name, value, 3, true, to);
    default:
        return set_crop(value, (int64_t(*)[2])(void *)to);
    }
    return !PyErr_Occurred();
}

bool record_has(PyObject *given, const char *name) {
    PyObject *item =
        given == Py_None ? NULL : PyDict_GetItemString(given, name);
    return item && item != Py_None;
}

static bool refuse_name(const char *name, const field *fields, size_t count) {
    char known[1024];
    int used = 0;
    for (size_t n = 0; n < count && used < (int)sizeof known; n++)
        used += snprintf(known + used, sizeof known - (size_t)used, ", %s",
                         fields[n].name);
    PyErr_Format(PyExc_TypeError, "there is no option '%s'; take one of %s",
                 name, known + 2);
    return false;
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
        if (n == count)
            return refuse_name(name, fields, count);
        if (value != Py_None && !set_field(&fields[n], value, record))
            return false;
    }
    return true;
}

#define FIELD(record, name, kind, of) \
    { #name, kind, offsetof(record, name), of }

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
    OPTION(dims, 'n', NULL),         OPTION(type, 'e', type_of_name),
    OPTION(endian, 'e', endian_of),  OPTION(spacing, '3', NULL),
    OPTION(offset, 'u', NULL),       OPTION(time, 'l', NULL),
    OPTION(crop, '6', NULL),         OPTION(channel, 'l', NULL),
    OPTION(dataset, 's', NULL),      OPTION(series, 's', NULL),
    OPTION(mask, 's', NULL),         OPTION(labels, 's', NULL),
    OPTION(label_table, 's', NULL),  OPTION(component, 's', NULL),
    OPTION(allow_gaps, 'b', NULL),   OPTION(each_time, 'b', NULL),
    OPTION(each_channel, 'b', NULL), OPTION(levels, 'l', NULL),
};

static int domain_of(const char *name) {
    return strcmp(name, "range") == 0 ? SNOW_DOMAIN_RANGE : -1;
}

#define LOOK(name, kind) FIELD(snow_look, name, kind, NULL)
static const field look_fields[] = {
    LOOK(name, 's'),
    LOOK(preset, 's'),
    LOOK(colormap, 's'),
    LOOK(low, 'd'),
    LOOK(high, 'd'),
    LOOK(log, 'b'),
    LOOK(per_mm, 'b'),
    LOOK(symlog, 'd'),
    FIELD(snow_look, domain, 'e', domain_of),
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
    view->has_up = record_has(given, "upward");
    return true;
}

bool record_fill_options(PyObject *given, snow_volume_options *options) {
    options->channel_given = record_has(given, "channel");
    return FILL(given, option_fields, options);
}

bool record_fill_look(PyObject *given, snow_look *look) {
    return FILL(given, look_fields, look);
}
