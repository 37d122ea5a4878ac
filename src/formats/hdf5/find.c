/* formats/hdf5/find.c - selects the data set of an HDF5 file that is the
 * volume.
 *
 * By default it is the only numeric array with three axes or more.  If there
 * are several, the user selects one from a list. */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <stdio.h>
#include <string.h>

/* The results of a search through the file. */
typedef struct survey {
    int axes;      /* the fewest axes wanted */
    bool anywhere; /* not the last ones: others may have one entry */
    const hdf5_file *file;
    cf_aside aside;  /* data sets that say where others lie */
    bool of_aside;   /* these are wanted */
    const char *end; /* of the paths that are wanted; NULL: all */
    long found;
    char first[HDF5_NAME_BYTES]; /* path of the first match */
    char list[800];              /* all matches, as far as they fit */
} survey;

/* The smallest type that holds every value; libhdf5 converts other types.
 * Enumerations, also booleans, are read as numbers. */
static snow_type type_of(hid_t type) {
    size_t size = H5Tget_size(type);
    switch (H5Tget_class(type)) {
    case H5T_INTEGER:
        while (size < 8 && size & (size - 1)) /* 3 bytes are read as 4 */
            size++;
        return snow_type_of_integer(size, H5Tget_sign(type) == H5T_SGN_2);
    case H5T_FLOAT:
        return !size       ? SNOW_TYPE_NONE
               : size <= 4 ? SNOW_TYPE_FLOAT32
                           : SNOW_TYPE_FLOAT64;
    case H5T_ENUM: {
        hid_t base = H5Tget_super(type);
        snow_type found = base < 0 ? SNOW_TYPE_NONE : type_of(base);
        if (found == SNOW_TYPE_INT8 && H5Tget_nmembers(type) == 2)
            found = SNOW_TYPE_UINT8; /* false and true */
        snow_hdf5_drop(base);
        return found;
    }
    default:
        return SNOW_TYPE_NONE;
    }
}

bool snow_hdf5_describe(hid_t id, hdf5_set *out) {
    hid_t type = H5Dget_type(id), space = H5Dget_space(id);
    int axes = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    out->type = type < 0 ? SNOW_TYPE_NONE : type_of(type);
    bool right = out->type && axes >= 1 && axes <= HDF5_MOST_AXES &&
                 H5Sget_simple_extent_dims(space, out->sizes, NULL) == axes;
    out->axes = axes;
    out->constant = out->no_sign = false;
    out->id = id;
    snow_hdf5_drop(type);
    snow_hdf5_drop(space);
    return right;
}

/* openPMD: the components of a record may have one value everywhere. */
static bool describe_constant(hid_t id, hdf5_set *out) {
    double shape[HDF5_MOST_AXES];
    const int axes = snow_hdf5_numbers(id, "shape", HDF5_MOST_AXES, shape);
    if (axes < 1 || snow_hdf5_numbers(id, "value", 1, &out->value) != 1)
        return false;
    for (int i = 0; i < axes; i++) {
        if (!(shape[i] >= 1) || !(shape[i] < 0x1p40))
            return false;
        out->sizes[i] = (hsize_t)shape[i];
    }
    out->axes = axes;
    out->type = SNOW_TYPE_FLOAT64;
    out->constant = true;
    out->no_sign = false;
    out->id = id;
    return true;
}

bool snow_hdf5_open_values(hid_t file, const char *path, hdf5_set *out) {
    if (H5Oexists_by_name(file, path, H5P_DEFAULT) <= 0)
        return false;
    const hid_t id = H5Oopen(file, path, H5P_DEFAULT);
    const H5I_type_t kind = id < 0 ? H5I_BADID : H5Iget_type(id);
    if ((kind == H5I_DATASET && snow_hdf5_describe(id, out)) ||
        (kind == H5I_GROUP && describe_constant(id, out)))
        return true;
    snow_hdf5_drop(id);
    return false;
}

/* "4x3x2", x first. */
static void spell_sizes(const hdf5_set *set, char *text, size_t capacity) {
    size_t used = 0;
    for (int i = set->axes - 1; i >= 0 && used < capacity; i--)
        used += (size_t)snprintf(text + used, capacity - used, "%s%llu",
                                 i == set->axes - 1 ? "" : "x",
                                 (unsigned long long)set->sizes[i]);
}

/* Whether a path is the end that is wanted, or ends with it behind a slash. */
static bool has_end(const survey *s, const char *path) {
    const size_t length = strlen(path), end = s->end ? strlen(s->end) : 0;
    return !s->end || (length > end && path[length - end - 1] == '/' &&
                       !strcmp(path + length - end, s->end));
}

static bool is_wanted(const survey *s, const hdf5_set *set) {
    int wide = 0;
    if (set->axes < s->axes)
        return false;
    for (int i = 0; i < (s->anywhere ? set->axes : s->axes); i++)
        wide += set->sizes[set->axes - 1 - i] > 1;
    return wide >= s->axes;
}

static void note(survey *s, const char *name, const hdf5_set *set) {
    char sizes[128];
    if (!s->found++)
        snprintf(s->first, sizeof s->first, "/%s", name);
    spell_sizes(set, sizes, sizeof sizes);
    snow_list_add(s->list, sizeof s->list, "/%s (%s)", name, sizes);
}

/* Adds the data sets that an attribute of this one names. */
static herr_t look_aside(hid_t file, const char *name, const H5O_info_t *info,
                         void *user) {
    static const char *const attributes[] = {"bounds", "coordinates"};
    survey *s = user;
    char text[1024];
    hid_t id =
        info->type == H5O_TYPE_DATASET ? H5Dopen2(file, name, H5P_DEFAULT) : -1;
    for (int i = 0; i < 2 && id >= 0; i++) {
        snow_hdf5_text(s->file, id, attributes[i], 0, text, sizeof text);
        snow_cf_aside_add(attributes[i], text, &s->aside);
    }
    snow_hdf5_drop(id);
    return 0;
}

static herr_t look(hid_t file, const char *name, const H5O_info_t *info,
                   void *user) {
    survey *s = user;
    hdf5_set set;
    if (info->type != H5O_TYPE_DATASET || strlen(name) + 2 > HDF5_NAME_BYTES ||
        snow_cf_is_aside(&s->aside, name) != s->of_aside || !has_end(s, name))
        return 0;
    hid_t id = H5Dopen2(file, name, H5P_DEFAULT);
    if (id < 0)
        return 0;
    if (snow_hdf5_describe(id, &set) && is_wanted(s, &set))
        note(s, name, &set);
    H5Dclose(id);
    return 0;
}

/* A walk through all groups of a file. */
typedef struct visit {
    H5O_iterate_t look;
    void *user;
    long objects; /* visited */
    bool deep;    /* one of them lies too deep */
} visit;

/* A positive result ends the visit. */
static herr_t visit_object(hid_t file, const char *name, const H5O_info_t *info,
                           void *user) {
    visit *v = user;
    int depth = 0;
    for (const char *at = strchr(name, '/'); at; at = strchr(at + 1, '/'))
        depth++;
    v->deep = depth > HDF5_MOST_DEPTH;
    if (v->deep || ++v->objects > HDF5_MOST_OBJECTS)
        return 1;
    return v->look(file, name, info, v->user);
}

snow_status snow_hdf5_visit(snow_context *context, hid_t file,
                            H5O_iterate_t visitor, void *user) {
    visit v = {.look = visitor, .user = user};
    if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit_object, &v,
                  H5O_INFO_BASIC) < 0)
        return snow_hdf5_fail(context, "its groups cannot be listed");
    if (v.deep)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "has groups more than %d deep: it is damaged, or a "
                         "link leads back to its root; write it again",
                         HDF5_MOST_DEPTH);
    return SNOW_STATUS_OK;
}

/* Finds all volumes of the file; if there are none, those with further axes of
 * one entry, or images with two axes; then those that say where others lie. */
static snow_status find_only(snow_context *context, hid_t file, survey *s) {
    SNOW_TRY(snow_hdf5_visit(context, file, look_aside, s));
    for (int way = 0; way < 6 && !s->found; way++) {
        s->axes = way % 3 < 2 ? 3 : 2;
        s->anywhere = way % 3 == 1;
        s->of_aside = way >= 3;
        SNOW_TRY(snow_hdf5_visit(context, file, look, s));
    }
    if (s->found == 1)
        return SNOW_STATUS_OK;
    if (!s->found && H5Aexists(file, "openPMD") > 0)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is an openPMD file without meshes: particles are no "
                         "volume; write meshes too, or deposit the particles "
                         "on a grid");
    if (!s->found)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "has no numeric array with three axes; choose another "
                         "file, or a data set with --dataset");
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "holds %ld volumes; choose one with --dataset: %s",
                     s->found, s->list);
}

snow_status snow_hdf5_complete(snow_context *context, const hdf5_file *file,
                               const char *asked, char path[HDF5_NAME_BYTES]) {
    survey s = {.file = file, .axes = 2, .end = asked};
    snprintf(path, HDF5_NAME_BYTES, "%s", asked);
    if (strlen(asked) + 2 > HDF5_NAME_BYTES ||
        H5Oexists_by_name(snow_hdf5_id(file), asked, H5P_DEFAULT) > 0)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_hdf5_visit(context, snow_hdf5_id(file), look, &s));
    if (s.found > 1)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.200s: is the end of %ld paths; choose "
                         "one: %s",
                         asked, s.found, s.list);
    if (s.found)
        memcpy(path, s.first, sizeof s.first);
    return SNOW_STATUS_OK;
}

snow_status snow_hdf5_find(snow_context *context, const hdf5_file *from,
                           const char *asked, hdf5_set *out) {
    const hid_t file = snow_hdf5_id(from);
    survey s = {.file = from};
    if (!asked) {
        SNOW_TRY(find_only(context, file, &s));
        asked = s.first;
    }
    if (strlen(asked) + 2 > HDF5_NAME_BYTES)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--dataset: the path is longer than any in a file");
    const bool opened = snow_hdf5_open_values(file, asked, out);
    hid_t id = opened ? out->id : H5Dopen2(file, asked, H5P_DEFAULT);
    if (id < 0) {
        (void)find_only(context, file, &s);
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.200s: there is no such data set; %s%s",
                         asked, *s.list ? "the file has " : "check the path",
                         s.list);
    }
    if (!opened) {
        H5Dclose(id);
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%.200s is not a numeric array with one to five axes; "
                         "choose another with --dataset",
                         asked);
    }
    snprintf(out->path, sizeof out->path, "%s%s", *asked == '/' ? "" : "/",
             asked);
    out->spatial = !strncmp(asked, "/./", 3);
    return SNOW_STATUS_OK;
}

#endif
