/* catalyst/mesh.c - from a Blueprint mesh to a brick.
 *
 * What is read of a domain:
 *
 *   coordsets/C/type            "uniform"
 *   coordsets/C/dims/{i,j,k}    points; one fewer cells
 *   coordsets/C/origin/{x,y,z}, coordsets/C/spacing/{dx,dy,dz}
 *   topologies/T/{type,coordset}        type "uniform"
 *   fields/F/{association,topology,values}    "vertex" or "element"
 *   fields/{ascent_ghosts,vtkGhostType}/values    0: the domain's own
 *
 * Arrays are used where they lie, with their strides; x is the fastest.  The
 * samples of cells lie half a spacing from the points. */
#include "mesh.h"

#include <stdio.h>
#include <string.h>

#define PATH_BYTES 512

/* C API of Conduit takes nodes that are not const; nothing here changes one. */
static conduit_node *at_path(const conduit_node *node, const char *path) {
    conduit_node *n = (conduit_node *)node;
    return conduit_node_has_path(n, path) ? conduit_node_fetch(n, path) : NULL;
}

/* The type of an array's elements, SNOW_TYPE_NONE for texts and trees. */
static snow_type type_of(const conduit_datatype *type) {
    if (conduit_datatype_is_float64(type))
        return SNOW_TYPE_FLOAT64;
    if (conduit_datatype_is_float32(type))
        return SNOW_TYPE_FLOAT32;
    if (conduit_datatype_is_int8(type))
        return SNOW_TYPE_INT8;
    if (conduit_datatype_is_uint8(type))
        return SNOW_TYPE_UINT8;
    if (conduit_datatype_is_int16(type))
        return SNOW_TYPE_INT16;
    if (conduit_datatype_is_uint16(type))
        return SNOW_TYPE_UINT16;
    if (conduit_datatype_is_int32(type))
        return SNOW_TYPE_INT32;
    if (conduit_datatype_is_uint32(type))
        return SNOW_TYPE_UINT32;
    if (conduit_datatype_is_int64(type))
        return SNOW_TYPE_INT64;
    if (conduit_datatype_is_uint64(type))
        return SNOW_TYPE_UINT64;
    return SNOW_TYPE_NONE;
}

/* Element `index` of an array as a double. */
static double element(const conduit_node *node, int64_t index) {
    conduit_node *n = (conduit_node *)node;
    const void *at = conduit_node_element_ptr(n, index);
    switch (type_of(conduit_node_dtype(n))) {
#define ELEMENT_CASE(name, c_type, text)  \
    case SNOW_TYPE_##name: {              \
        c_type value;                     \
        memcpy(&value, at, sizeof value); \
        return (double)value;             \
    }
        SNOW_TYPE_MAP(ELEMENT_CASE)
#undef ELEMENT_CASE
    default:
        return 0;
    }
}

double mesh_number(const conduit_node *node, const char *path,
                   double otherwise) {
    conduit_node *n = at_path(node, path);
    if (!n || type_of(conduit_node_dtype(n)) == SNOW_TYPE_NONE)
        return otherwise;
    return element(n, 0);
}

const char *mesh_text(const conduit_node *node, const char *path) {
    conduit_node *n = at_path(node, path);
    return n && conduit_datatype_is_char8_str(conduit_node_dtype(n))
               ? conduit_node_as_char8_str(n)
               : NULL;
}

/* A message's end; always false. */
static bool refuse(char wrong[MESH_WRONG], const char *text, const char *what) {
    snprintf(wrong, MESH_WRONG, text, what);
    return false;
}

/* A domain's points: how many, where the first one lies, how far apart. */
typedef struct points {
    int64_t count[3];
    double origin[3], spacing[3];
} points;

static bool read_points(const conduit_node *coords, points *out,
                        char wrong[MESH_WRONG]) {
    static const char *const counts[] = {"dims/i", "dims/j", "dims/k"};
    static const char *const origins[] = {"origin/x", "origin/y", "origin/z"};
    static const char *const spacings[] = {"spacing/dx", "spacing/dy",
                                           "spacing/dz"};
    const char *type = mesh_text(coords, "type");
    if (!type || strcmp(type, "uniform") != 0)
        return refuse(wrong,
                      "has a coordset of type '%.40s'; only uniform "
                      "ones are shown",
                      type ? type : "");
    for (int i = 0; i < 3; i++) {
        out->count[i] = (int64_t)mesh_number(coords, counts[i], 0);
        out->origin[i] = mesh_number(coords, origins[i], 0);
        out->spacing[i] = mesh_number(coords, spacings[i], 1);
        if (out->count[i] < 1)
            return refuse(wrong, "has no %s: it must be three-dimensional",
                          counts[i]);
    }
    return true;
}

/* The field of a name, or the first one. */
static conduit_node *find_field(const conduit_node *domain, const char *name) {
    char path[PATH_BYTES];
    if (*name) {
        snprintf(path, sizeof path, "fields/%s", name);
        return at_path(domain, path);
    }
    conduit_node *fields = at_path(domain, "fields");
    return fields && conduit_node_number_of_children(fields) > 0
               ? conduit_node_child(fields, 0)
               : NULL;
}

/* The coordset of the field's topology. */
static const conduit_node *find_coords(const conduit_node *domain,
                                       const conduit_node *field,
                                       char wrong[MESH_WRONG]) {
    char path[PATH_BYTES];
    const char *topology = mesh_text(field, "topology");
    snprintf(path, sizeof path, "topologies/%.200s/coordset",
             topology ? topology : "");
    const char *coordset = mesh_text(domain, path);
    if (!coordset) {
        refuse(wrong, "has no topology '%.40s' with a coordset",
               topology ? topology : "");
        return NULL;
    }
    snprintf(path, sizeof path, "coordsets/%.200s", coordset);
    const conduit_node *coords = at_path(domain, path);
    if (!coords)
        refuse(wrong, "has no coordset '%.40s'", coordset);
    return coords;
}

/* The values, with their stride in elements, and how many there are. */
static bool read_values(const conduit_node *field, int64_t count,
                        mesh_brick *out, char wrong[MESH_WRONG]) {
    conduit_node *values = at_path(field, "values");
    /* Of a vector field, the first component. */
    if (values && conduit_datatype_is_object(conduit_node_dtype(values)) &&
        conduit_node_number_of_children(values) > 0)
        values = conduit_node_child(values, 0);
    if (!values)
        return refuse(wrong, "has a field without %s", "values");
    const conduit_datatype *type = conduit_node_dtype(values);
    out->type = type_of(type);
    int64_t bytes = conduit_datatype_element_bytes(type);
    int64_t stride = conduit_datatype_stride(type);
    if (out->type == SNOW_TYPE_NONE || bytes < 1 || stride % bytes != 0)
        return refuse(wrong, "has a field whose values are %s",
                      "no numbers, or not whole elements apart");
    if (conduit_datatype_number_of_elements(type) != count)
        return refuse(wrong, "has a field with another %s than its mesh",
                      "number of values");
    out->voxels = conduit_node_element_ptr(values, 0);
    out->stride[0] = stride / bytes;
    return true;
}

/* --- ghosts --------------------------------------------------------------- */

/* Whose voxels the domain has: those flagged 0 are its own. */
static conduit_node *find_ghosts(const conduit_node *domain, int64_t count) {
    static const char *const paths[] = {"fields/ascent_ghosts/values",
                                        "fields/vtkGhostType/values"};
    for (int i = 0; i < 2; i++) {
        conduit_node *n = at_path(domain, paths[i]);
        if (n &&
            conduit_datatype_number_of_elements(conduit_node_dtype(n)) == count)
            return n;
    }
    return NULL;
}

/* The box of a domain's own voxels: first and one past the last. */
static void find_own(const conduit_node *ghosts, const int64_t count[3],
                     int64_t first[3], int64_t end[3]) {
    for (int i = 0; i < 3; i++) {
        first[i] = count[i];
        end[i] = 0;
    }
    int64_t at[3], index = 0;
    for (at[2] = 0; at[2] < count[2]; at[2]++)
        for (at[1] = 0; at[1] < count[1]; at[1]++)
            for (at[0] = 0; at[0] < count[0]; at[0]++, index++)
                if (element(ghosts, index) == 0)
                    for (int i = 0; i < 3; i++) {
                        first[i] = at[i] < first[i] ? at[i] : first[i];
                        end[i] = at[i] >= end[i] ? at[i] + 1 : end[i];
                    }
}

/* Takes ghost voxels out of the brick, into its halo. */
static void leave_ghosts(const conduit_node *ghosts, const double spacing[3],
                         mesh_brick *brick) {
    int64_t first[3], end[3];
    snow_world_brick *p = &brick->place;
    find_own(ghosts, p->count, first, end);
    int64_t back = 0;
    for (int i = 0; i < 3; i++) {
        if (end[i] <= first[i]) {
            memset(p->count, 0, sizeof p->count);
            return;
        }
        p->halo.low[i] = first[i];
        p->halo.high[i] = p->count[i] - end[i];
        p->count[i] = end[i] - first[i];
        p->origin[i] += (double)first[i] * spacing[i];
        back += first[i] * brick->stride[i];
    }
    brick->voxels = (const char *)brick->voxels +
                    back * (int64_t)snow_type_size(brick->type);
}

bool mesh_read(const conduit_node *domain, const char *field, mesh_brick *out,
               double spacing[3], char wrong[MESH_WRONG]) {
    mesh_brick brick = {.type = SNOW_TYPE_NONE};
    points p;
    const conduit_node *node = find_field(domain, field);
    if (!node)
        return refuse(wrong, *field ? "has no field '%.60s'" : "has no field%s",
                      field);
    const conduit_node *coords = find_coords(domain, node, wrong);
    if (!coords || !read_points(coords, &p, wrong))
        return false;
    const char *where = mesh_text(node, "association");
    bool cells = where && strcmp(where, "element") == 0;
    int64_t count = 1;
    for (int i = 0; i < 3; i++) {
        brick.place.count[i] = p.count[i] - cells;
        brick.place.origin[i] = p.origin[i] + (cells ? p.spacing[i] / 2 : 0);
        count *= brick.place.count[i];
    }
    if (!read_values(node, count, &brick, wrong))
        return false;
    for (int i = 1; i < 3; i++)
        brick.stride[i] = brick.stride[i - 1] * brick.place.count[i - 1];
    const conduit_node *ghosts = find_ghosts(domain, count);
    if (ghosts)
        leave_ghosts(ghosts, p.spacing, &brick);
    memcpy(spacing, p.spacing, sizeof p.spacing);
    *out = brick;
    return true;
}
