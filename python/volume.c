/* volume.c - volumes of files and over arrays, and their voxels as a buffer. */
#include "core.h"

#include "series/moment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void release_volume(void *object) {
    snow_volume_close(object);
}

static void release_frame(void *object) {
    snow_frame_free(object);
}

/* Type codes of the buffer protocol, by snow_type. */
static const char *const codes[] = {"",  "b", "B", "h", "H", "i",
                                    "I", "q", "Q", "f", "d"};

static void volume_free(PyObject *self) {
    volume_object *o = (volume_object *)self;
    if (o->context) {
        context_discard(o->context, release_frame, o->frame);
        context_discard(o->context, release_volume, o->volume);
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
        o->context = context_new();
    }
    if (o->context)
        return o;
    Py_DECREF((PyObject *)o);
    return NULL;
}

bool volume_is_open(const volume_object *o) {
    if (!o->volume)
        PyErr_SetString(PyExc_ValueError,
                        "the volume is closed: open it again");
    return o->volume != NULL;
}

bool volume_use(volume_object *o, PyObject *progress) {
    if (!context_enter(o->context, progress))
        return false;
    return volume_is_open(o) || context_leave(o->context, SNOW_STATUS_OK);
}

/* How many clip planes there are; -1 with an exception. */
static Py_ssize_t read_planes(PyObject *given, double planes[][4]) {
    Py_ssize_t count = given == Py_None ? 0 : PySequence_Size(given);
    if (count < 0 || count > SNOW_CLIPS_MAX) {
        PyErr_Format(PyExc_ValueError,
                     "clip must be a list of up to %d planes (a, b, c, d)",
                     SNOW_CLIPS_MAX);
        return -1;
    }
    for (Py_ssize_t n = 0; n < count; n++) {
        PyObject *plane = PySequence_GetItem(given, n);
        bool fine =
            plane && record_numbers("a clip plane", plane, 4, false, planes[n]);
        Py_XDECREF(plane);
        if (!fine)
            return -1;
    }
    return count;
}

static PyObject *volume_open(PyObject *module, PyObject *args) {
    PyObject *type, *given, *clip, *progress, *like = NULL;
    const char *path;
    unsigned long long limit;
    snow_volume_options options;
    snow_status status;
    (void)module;
    snow_volume_options_init(&options);
    if (!PyArg_ParseTuple(args, "OyOOKO|O", &type, &path, &given, &clip, &limit,
                          &progress, &like) ||
        !record_fill_options(given, &options))
        return NULL;
    if (read_planes(clip, options.clip) < 0)
        return NULL;
    volume_object *o = volume_begin(type, like);
    if (!o || !context_enter(o->context, progress)) {
        Py_XDECREF((PyObject *)o);
        return NULL;
    }
    if (!like)
        snow_context_set_memory_limit(o->context->context, limit);
    CALL(o->context, status,
         snow_volume_open(o->context->context, path, &options, &o->volume));
    if (!context_leave(o->context, status)) {
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
    memcpy(info->quantity, known->quantity, sizeof info->quantity);
    memcpy(info->value_unit, known->value_unit, sizeof info->value_unit);
    memcpy(info->description, known->description, sizeof info->description);
    info->hounsfield = known->hounsfield;
    info->eight_bits = known->eight_bits;
}

/* Copies a text to a room, of which a longer one fills all but whole letters of
 * UTF-8. */
static void keep(char *to, size_t size, const char *text) {
    size_t length = strlen(text);
    if (length >= size)
        for (length = size - 1; length && (text[length] & 0xc0) == 0x80;)
            length--;
    memcpy(to, text, length);
    to[length] = 0;
}

/* Over a C contiguous array (z, y, x) of the caller, whose own array has its
 * dimensions in an order. */
static PyObject *volume_wrap(PyObject *module, PyObject *args) {
    PyObject *type, *array, *matrix, *like, *window = Py_None;
    double slope, intercept;
    int medical, alike = 1;
    const char *unit, *quantity = NULL, *value_unit = "", *description = "";
    snow_status status;
    (void)module;
    int order[3];
    if (!PyArg_ParseTuple(args, "OO(iii)OddpsO|pO(sss)", &type, &array,
                          &order[0], &order[1], &order[2], &matrix, &slope,
                          &intercept, &medical, &unit, &like, &alike, &window,
                          &quantity, &value_unit, &description))
        return NULL;
    volume_object *o = volume_begin(type, like);
    if (!o)
        return NULL;
    memcpy(o->order, order, sizeof order);
    snow_volume_info info;
    snow_volume_info_init(&info);
    if (alike)
        copy_meaning(like, &info);
    if (PyObject_GetBuffer(array, &o->buffer,
                           PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) ||
        !record_numbers("matrix", matrix, 16, false, info.matrix) ||
        (window != Py_None &&
         !record_numbers("window", window, 2, false, info.window)))
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
    keep(info.unit, sizeof info.unit, unit);
    if (quantity) {
        keep(info.quantity, sizeof info.quantity, quantity);
        keep(info.value_unit, sizeof info.value_unit, value_unit);
        keep(info.description, sizeof info.description, description);
    }
    if (!context_enter(o->context, Py_None))
        goto failed;
    CALL(o->context, status,
         snow_volume_wrap(o->context->context, &info, o->buffer.buf,
                          &o->volume));
    if (context_leave(o->context, status))
        return (PyObject *)o;
failed:
    Py_DECREF((PyObject *)o);
    return NULL;
}

static PyObject *volume_masked(PyObject *module, PyObject *args) {
    PyObject *type, *given, *mask, *progress = Py_None;
    const char *labels;
    snow_label_range ranges[SNOW_LABELS_MAX];
    size_t count = 0;
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!O!z|O", &type, volume_type, &given,
                          volume_type, &mask, &labels, &progress))
        return NULL;
    if (labels && !snow_labels_parse(labels, ranges, SNOW_LABELS_MAX, &count))
        return PyErr_Format(PyExc_ValueError,
                            "labels: '%s' is no list of numbers and ranges "
                            "such as 1,4-7",
                            labels);
    volume_object *o = volume_begin(type, given);
    if (!o || !volume_use((volume_object *)given, progress)) {
        Py_XDECREF((PyObject *)o);
        return NULL;
    }
    memcpy(o->order, ((volume_object *)given)->order, sizeof o->order);
    CALL(o->context, status,
         snow_volume_mask(((volume_object *)given)->volume,
                          ((volume_object *)mask)->volume,
                          labels ? ranges : NULL, count, &o->volume));
    if (context_leave(o->context, status))
        return (PyObject *)o;
    Py_DECREF((PyObject *)o);
    return NULL;
}

/* clipped(Volume, volume, planes) */
static PyObject *volume_clipped(PyObject *module, PyObject *args) {
    PyObject *type, *given, *clip;
    double planes[SNOW_CLIPS_MAX][4];
    snow_status status;
    (void)module;
    if (!PyArg_ParseTuple(args, "OO!O", &type, volume_type, &given, &clip))
        return NULL;
    Py_ssize_t count = read_planes(clip, planes);
    volume_object *from = (volume_object *)given;
    volume_object *o = count < 0 ? NULL : volume_begin(type, given);
    if (!o || !volume_use(from, Py_None)) {
        Py_XDECREF((PyObject *)o);
        return NULL;
    }
    memcpy(o->order, from->order, sizeof o->order);
    CALL(o->context, status,
         snow_volume_clip(from->volume, planes[0], (size_t)count, &o->volume));
    if (context_leave(o->context, status))
        return (PyObject *)o;
    Py_DECREF((PyObject *)o);
    return NULL;
}

static int volume_buffer(PyObject *self, Py_buffer *view, int flags) {
    volume_object *o = (volume_object *)self;
    view->obj = NULL;
    if (!volume_is_open(o))
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
    if (!context_enter(o->context, Py_None))
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
    return context_leave(o->context, SNOW_STATUS_OK) ? Py_NewRef(Py_None)
                                                     : NULL;
}

/* None for what the file does not say. */
static PyObject *dict_of_channel(const snow_channel *c, bool light) {
    PyObject *color = c->color[0] < 0 ? Py_NewRef(Py_None)
                                      : Py_BuildValue("(ddd)", c->color[0],
                                                      c->color[1], c->color[2]);
    PyObject *window = c->window[0] < c->window[1]
                           ? Py_BuildValue("(dd)", c->window[0], c->window[1])
                           : Py_NewRef(Py_None);
    PyObject *row = Py_BuildValue(
        "{sO&sOsOsOsOsO}", "name", text_of, c->name, "color", color, "window",
        window, "shown", c->shown ? Py_True : Py_False, "own",
        c->own ? Py_True : Py_False, "light", light ? Py_True : Py_False);
    Py_XDECREF(color);
    Py_XDECREF(window);
    return row;
}

/* None where there is one of which nothing is said. */
static PyObject *list_of_channels(const snow_volume_info *i) {
    PyObject *list = PyList_New(0);
    const int64_t count =
        i->channels > 1 || *i->channel[0].name ? i->channels : 0;
    for (int n = 0; list && n < SNOW_CHANNELS_MAX && n < count; n++) {
        PyObject *one = dict_of_channel(&i->channel[n], i->light >> n & 1);
        if (!one || PyList_Append(list, one))
            Py_CLEAR(list);
        Py_XDECREF(one);
    }
    return list;
}

/* The unit of each axis of the world, and the world's length of one. */
static PyObject *axes_of_info(const snow_volume_info *i) {
    PyObject *list = PyList_New(0);
    for (int n = 0; list && n < 3; n++) {
        const char *own = i->axis_unit[n];
        const double scale = i->axis_scale[n];
        PyObject *one = Py_BuildValue("(O&d)", text_of,
                                      !*own              ? i->unit
                                      : strcmp(own, "1") ? own
                                                         : "",
                                      scale < 0 || scale > 0 ? scale : 1.0);
        if (!one || PyList_Append(list, one))
            Py_CLEAR(list);
        Py_XDECREF(one);
    }
    return list;
}

static PyObject *dict_of_info(const snow_volume_info *i) {
    const double(*m)[4] = i->matrix;
    return Py_BuildValue(
        "{s(LLL)sss(ddd)s((dddd)(dddd)(dddd)(dddd))sdsdsOsO&sssLsLsO&sO&sO"
        "sO&sO&sO&sdsO&sO&sLsNsNssszsOsO}",
        "dims", (long long)i->dims[0], (long long)i->dims[1],
        (long long)i->dims[2], "type", snow_type_name(i->type), "spacing",
        i->spacing[0], i->spacing[1], i->spacing[2], "matrix", m[0][0], m[0][1],
        m[0][2], m[0][3], m[1][0], m[1][1], m[1][2], m[1][3], m[2][0], m[2][1],
        m[2][2], m[2][3], m[3][0], m[3][1], m[3][2], m[3][3], "slope", i->slope,
        "intercept", i->intercept, "medical", i->medical ? Py_True : Py_False,
        "unit", text_of, i->unit, "format", i->format, "times",
        (long long)i->times, "time", (long long)i->time, "storage", text_of,
        i->storage, "modality", text_of, i->modality, "hounsfield",
        i->hounsfield ? Py_True : Py_False, "quantity", text_of, i->quantity,
        "value_unit", text_of, i->value_unit, "description", text_of,
        i->description, "time_value", i->time_value, "time_unit", text_of,
        i->time_unit, "calendar", text_of, i->calendar, "channel_count",
        (long long)(i->channels > 1 ? i->channels : 1), "channels",
        list_of_channels(i), "axes", axes_of_info(i), "first_mode",
        snow_mode_name(snow_mode_for(i)), "first_colormap",
        snow_colormap_for(i), "lengths",
        i->magnitude && i->components == 3 ? Py_True : Py_False, "directions",
        i->directions ? Py_True : Py_False);
}

static PyObject *volume_info(PyObject *self, void *closure) {
    volume_object *o = (volume_object *)self;
    (void)closure;
    return volume_is_open(o) ? dict_of_info(snow_volume_get_info(o->volume))
                             : NULL;
}

/* inspect(path, fields): what a file says of itself.  Its warnings come when it
 * is opened. */
static PyObject *volume_inspect(PyObject *module, PyObject *args) {
    PyObject *given;
    const char *path;
    snow_volume_options options;
    snow_volume_info info;
    snow_status status;
    (void)module;
    snow_volume_options_init(&options);
    snow_volume_info_init(&info);
    if (!PyArg_ParseTuple(args, "yO", &path, &given) ||
        !record_fill_options(given, &options))
        return NULL;
    context_object *c = context_new();
    if (!c || !context_enter(c, Py_None)) {
        Py_XDECREF((PyObject *)c);
        return NULL;
    }
    CALL(c, status, snow_volume_inspect(c->context, path, &options, &info));
    const bool quiet =
        PyList_SetSlice(c->warnings, 0, PY_SSIZE_T_MAX, NULL) == 0;
    PyObject *out =
        context_leave(c, status) && quiet ? dict_of_info(&info) : NULL;
    Py_DECREF((PyObject *)c);
    return out;
}

/* The steps of a file. */
typedef struct steps {
    snow_context *context;
    const char *path;
    snow_volume_options options;
} steps;

/* A moment_step_fn. */
static snow_status read_step(void *user, int64_t step, snow_volume_info *out) {
    steps *s = user;
    snow_volume_info_init(out);
    s->options.time = step;
    return snow_volume_inspect(s->context, s->path, &s->options, out);
}

/* Whether a text is a time is known by the caller. */
static snow_status find_moment(steps *s, const moment *wanted, int64_t *step,
                               snow_volume_info *at) {
    snow_status status = read_step(s, 0, at);
    if (!status)
        status =
            moment_find(s->context, wanted, at->times, read_step, s, step, at);
    return status;
}

/* find_step(path, fields, time): the step of a file that is nearest to a time
 * -> (step, the time that it has where that is another one, or None), or None
 * where the text is no time. */
static PyObject *volume_find_step(PyObject *module, PyObject *args) {
    PyObject *given;
    const char *text;
    steps s;
    moment wanted;
    snow_volume_info at;
    int64_t step = 0;
    snow_status status;
    char other[128] = "";
    (void)module;
    snow_volume_options_init(&s.options);
    if (!PyArg_ParseTuple(args, "yOs", &s.path, &given, &text) ||
        !record_fill_options(given, &s.options))
        return NULL;
    if (!moment_read(text, &wanted))
        return Py_NewRef(Py_None);
    s.options.each_time = true;
    context_object *c = context_new();
    if (!c || !context_enter(c, Py_None)) {
        Py_XDECREF((PyObject *)c);
        return NULL;
    }
    s.context = c->context;
    CALL(c, status, find_moment(&s, &wanted, &step, &at));
    const bool quiet =
        PyList_SetSlice(c->warnings, 0, PY_SSIZE_T_MAX, NULL) == 0;
    const bool fine = context_leave(c, status) && quiet;
    Py_DECREF((PyObject *)c);
    if (!fine)
        return NULL;
    if (!moment_is_at(&wanted, &at))
        (void)snow_time_text(&at, NULL, other, sizeof other);
    return Py_BuildValue("(Lz)", (long long)step, *other ? other : NULL);
}

static PyObject *volume_statistics(PyObject *self, PyObject *progress) {
    volume_object *o = (volume_object *)self;
    snow_volume_statistics s;
    snow_status status;
    snow_volume_statistics_init(&s);
    if (!volume_use(o, progress))
        return NULL;
    CALL(o->context, status, snow_volume_get_statistics(o->volume, &s));
    if (!context_leave(o->context, status))
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
    PyObject *progress;
    snow_status status;
    if (!PyArg_ParseTuple(args, "ddnO", &low, &high, &bins, &progress))
        return NULL;
    if (bins < 1 || bins > 1 << 24)
        return PyErr_Format(PyExc_ValueError, "%zd bins: give 1 to 16777216",
                            bins);
    uint64_t *counts = calloc((size_t)bins, sizeof *counts);
    if (!counts)
        return PyErr_NoMemory();
    PyObject *list = NULL;
    if (volume_use(o, progress)) {
        CALL(o->context, status,
             snow_volume_histogram(o->volume, low, high, (size_t)bins, counts));
        if (context_leave(o->context, status))
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
    PyObject *progress;
    snow_status status;
    if (!PyArg_ParseTuple(args, "ypO", &path, &overwrite, &progress) ||
        !volume_use(o, progress))
        return NULL;
    CALL(o->context, status, snow_volume_save(o->volume, path, overwrite));
    if (!context_leave(o->context, status))
        return NULL;
    Py_RETURN_NONE;
}

/* _regrid(volume of the same context, nearest, progress): resamples it to its
 * grid. */
static PyObject *volume_regrid(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    PyObject *grid, *progress;
    int nearest;
    snow_status status;
    if (!PyArg_ParseTuple(args, "O!pO", volume_type, &grid, &nearest,
                          &progress) ||
        !volume_use(o, progress))
        return NULL;
    CALL(o->context, status,
         snow_volume_regrid(&o->volume, ((volume_object *)grid)->volume,
                            nearest));
    if (!context_leave(o->context, status))
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *volume_freeze(PyObject *self, PyObject *nothing) {
    volume_object *o = (volume_object *)self;
    (void)nothing;
    if (!volume_use(o, Py_None))
        return NULL;
    snow_volume_freeze(o->volume);
    if (!context_leave(o->context, SNOW_STATUS_OK))
        return NULL;
    Py_RETURN_NONE;
}

/* How far a place is from a slice across an axis, in slices. */
static double off_slice(const snow_volume_info *info, const double place[3],
                        int axis, int64_t index) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double far = 0, thick = 0;
    for (int i = 0; i < 3; i++) {
        const double(*m)[4] = info->matrix;
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double scale = info->axis_scale[i] != 0 ? info->axis_scale[i] : 1;
        const double normal = m[j][u] * m[k][v] - m[k][u] * m[j][v];
        far += normal * (place[i] * scale - m[i][3]);
        thick += normal * m[i][axis];
    }
    return fabs(far / thick - (double)index);
}

static bool lies_in(const snow_volume_info *info, const snow_measure *m,
                    int axis, int64_t index) {
    bool lies = true;
    if (m->kind == SNOW_MEASURE_ELLIPSE)
        return m->axis == axis && m->index == index;
    for (int n = 0; n < (m->kind == SNOW_MEASURE_LINE ? 2 : 3); n++)
        lies &= off_slice(info, m->points[n], axis, index) <= 0.500001;
    return lies;
}

static PyObject *measure_of(const snow_measure *m, bool lies) {
    const double(*p)[3] = m->points;
    return Py_BuildValue(
        "(y#i((ddd)(ddd)(ddd))dLddddsiLiO)", (const char *)m,
        (Py_ssize_t)sizeof *m, (int)m->kind, p[0][0], p[0][1], p[0][2], p[1][0],
        p[1][1], p[1][2], p[2][0], p[2][1], p[2][2], m->result,
        (long long)m->count, m->mean, m->deviation, m->min, m->max, m->unit,
        m->axis, (long long)m->index, m->outside, lies ? Py_True : Py_False);
}

/* _measure(text, axis, index): of each the record, what it says, and whether it
 * lies in that slice (index -1: none is asked). */
static PyObject *volume_measure(PyObject *self, PyObject *args) {
    volume_object *o = (volume_object *)self;
    const char *text;
    int axis;
    long long index;
    snow_status status = SNOW_STATUS_OK;
    if (!PyArg_ParseTuple(args, "siL", &text, &axis, &index) ||
        !volume_use(o, Py_None))
        return NULL;
    const snow_volume_info *info = snow_volume_get_info(o->volume);
    PyObject *list = PyList_New(0);
    for (int n = 0; list && !status; n++) {
        snow_measure one = {.size = sizeof one};
        status = snow_measure_read(o->context->context, text, n, info, &one);
        if (!status && one.kind == SNOW_MEASURE_NONE)
            break;
        if (!status)
            CALL(o->context, status, snow_measure_values(o->volume, &one));
        PyObject *item =
            status ? NULL
                   : measure_of(&one,
                                index < 0 || lies_in(info, &one, axis, index));
        if (!status && (!item || PyList_Append(list, item)))
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    if (context_leave(o->context, status) && list)
        return list;
    Py_XDECREF(list);
    return NULL;
}

static PyMethodDef volume_methods[] = {
    METHOD("_measure", volume_measure, METH_VARARGS, "text, axis, index"),
    METHOD("_statistics", volume_statistics, METH_O, "of finite values"),
    METHOD("_histogram", volume_histogram, METH_VARARGS,
           "low, high, bins, progress"),
    METHOD("_save", volume_save, METH_VARARGS, "path, overwrite, progress"),
    METHOD("_regrid", volume_regrid, METH_VARARGS, "grid, nearest, progress"),
    METHOD("_freeze", volume_freeze, METH_NOARGS, "the voxels stay"),
    METHOD("_close", volume_close, METH_NOARGS, "gives its memory back"),
    METHOD("_look", volume_look, METH_VARARGS, "a transfer function"),
    METHOD("_ground", volume_ground, METH_VARARGS, "where white begins, or 0"),
    METHOD("_render", volume_render, METH_VARARGS, "a picture"),
    METHOD("_views", volume_views, METH_NOARGS, "back and up of each view"),
    METHOD("_slice_axis", volume_slice_axis, METH_O, "of the grid and world"),
    METHOD("_slice", volume_slice, METH_VARARGS, "a picture of a slice"),
    METHOD("_slices", volume_slices, METH_VARARGS, "of several"),
    METHOD("_slice_shown", volume_slice_shown, METH_VARARGS, "those to see"),
    {NULL, NULL, 0, NULL}};
static PyGetSetDef volume_values[] = {
    {"_info", volume_info, NULL, "snow_volume_info", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
PyMethodDef volume_functions[] = {
    METHOD("open", volume_open, METH_VARARGS, "a volume of a file"),
    METHOD("find_step", volume_find_step, METH_VARARGS, "by its time"),
    METHOD("inspect", volume_inspect, METH_VARARGS, "what a file says"),
    METHOD("wrap", volume_wrap, METH_VARARGS, "a volume over an array"),
    METHOD("masked", volume_masked, METH_VARARGS, "a volume within a mask"),
    METHOD("clipped", volume_clipped, METH_VARARGS, "a volume behind planes"),
    {NULL, NULL, 0, NULL}};

const type_parts volume_parts = {.name = "_snowglass.Volume",
                                 .size = sizeof(volume_object),
                                 .is_base = true,
                                 .dealloc = volume_free,
                                 .buffer = volume_buffer,
                                 .release = volume_release,
                                 .methods = volume_methods,
                                 .values = volume_values};
