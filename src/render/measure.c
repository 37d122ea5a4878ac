/* render/measure.c - lengths, angles and ellipses in the world of a volume.
 *
 * All is computed in the units of the world's axes, without the scale that
 * axis_scale has: a picture may be higher than its volume, a length is not.
 * Voxels are compared with an ellipse by their centres. */
#include "base/vec3.h"
#include "volume/volume.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Words of a measure, at most; one more is found to be too many. */
#define WORDS_MOST 6
#define WORD_BYTES 96

/* Voxels that lie on the border of a volume, or an ellipse, are in it. */
#define BORDER 1e-9

/* One measure of a list, while it is read. */
typedef struct reading {
    snow_context *context;
    int n; /* from 1, for messages */
    char text[256];
    char words[WORDS_MOST + 1][WORD_BYTES];
    int count;
    const snow_volume_info *info; /* in units of the axes; NULL: none */
} reading;

SNOW_RECORD_OF_ZEROS(snow_measure);

/* --- the world ------------------------------------------------------------ */

/* The volume in the units of its axes. */
static snow_volume_info unscaled(const snow_volume_info *info) {
    snow_volume_info own = *info;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4 && fabs(info->axis_scale[i]) > 0; j++)
            own.matrix[i][j] /= info->axis_scale[i];
    for (int j = 0; j < 3; j++) {
        const double step[3] = {own.matrix[0][j], own.matrix[1][j],
                                own.matrix[2][j]};
        own.spacing[j] = snow_length(step);
        own.axis_scale[j] = 0;
    }
    return own;
}

static const char *unit_of(const snow_volume_info *info, int axis) {
    const char *own = info->axis_unit[axis];
    return !*own ? info->unit : strcmp(own, "1") == 0 ? "" : own;
}

static void place_of(const snow_volume_info *info, const double index[3],
                     double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = info->matrix[i][3] + snow_dot(info->matrix[i], index);
}

static bool index_of(const snow_volume_info *info, const double at[3],
                     double index[3]) {
    double inverse[3][3], from[3];
    if (!snow_matrix_invert3(info->matrix, inverse))
        return false;
    for (int i = 0; i < 3; i++)
        from[i] = at[i] - info->matrix[i][3];
    for (int i = 0; i < 3; i++)
        index[i] = snow_dot(inverse[i], from);
    return true;
}

static bool is_within(const snow_volume_info *info, const double at[3]) {
    double index[3];
    if (!index_of(info, at, index))
        return false;
    for (int i = 0; i < 3; i++) {
        const double last = (double)info->dims[i] - 0.5;
        if (!(index[i] >= -0.5 - 1e-6 && index[i] <= last + 1e-6))
            return false;
    }
    return true;
}

/* --- reading -------------------------------------------------------------- */

static const char *const kinds[] = {"", "line", "angle", "ellipse"};

static snow_status refuse(const reading *r, const char *why) {
    static const char *const examples[] = {
        "line X,Y,Z X,Y,Z, angle P P P, or ellipse AXIS POS C A B, such as "
        "line 0,0,0 10,0,0",
        "line X,Y,Z X,Y,Z, such as line 0,0,0 10,0,0",
        "angle X,Y,Z X,Y,Z X,Y,Z, such as angle 10,0,0 0,0,0 0,10,0",
        "ellipse AXIS POS C A B, such as ellipse axial 12.5 0,20 15 10"};
    int kind = 0;
    for (int n = 1; n < 4; n++)
        if (r->count > 0 && strcmp(r->words[0], kinds[n]) == 0)
            kind = n;
    return snow_fail(r->context, SNOW_STATUS_BAD_USAGE,
                     "measure %d, '%.120s': %s; give %s", r->n, r->text, why,
                     examples[kind]);
}

/* Finds measure n, from 0; an empty one at the end is none. */
static bool find_text(const char *text, int n, reading *r) {
    for (; n > 0 && text; n--) {
        text = strchr(text, ';');
        text += text != NULL;
    }
    if (!text)
        return false;
    text += strspn(text, " \t\n");
    if (!*text)
        return false;
    const size_t length = strcspn(text, ";");
    snprintf(r->text, sizeof r->text, "%.*s", (int)fmin((double)length, 255),
             text);
    if (length >= sizeof r->text)
        r->count = -1;
    return true;
}

static void split(reading *r) {
    const char *at = r->text;
    while (r->count >= 0 && r->count <= WORDS_MOST) {
        at += strspn(at, " \t\n");
        const size_t length = strcspn(at, " \t\n");
        if (!length)
            return;
        snprintf(r->words[r->count++], WORD_BYTES, "%.*s", (int)length, at);
        at += length;
    }
}

/* The numbers of "1,2,3"; 0: it is no list of them, or of more than `most`. */
static int read_numbers(const char *word, int most, double *out) {
    char rest[2];
    int count = 0, used;
    for (const char *at = word; count < most; at += used + 1) {
        char one[WORD_BYTES];
        snprintf(one, sizeof one, "%.*s", (int)strcspn(at, ","), at);
        used = (int)strlen(one);
        if (snow_text_scan(one, "%lf%1s", &out[count], rest) != 1 ||
            !isfinite(out[count]) || one[strspn(one, "+-.0123456789eE")])
            return 0;
        count++;
        if (!at[used])
            return count;
    }
    return 0;
}

/* --- lines and angles ----------------------------------------------------- */

/* Axes along which the ways differ have one unit, which is the result's. */
static snow_status find_unit(const reading *r, const double (*ways)[3],
                             int count, snow_measure *m) {
    const snow_volume_info *info = r->info;
    const char *unit = NULL;
    for (int i = 0; i < 3; i++) {
        double far = 0, all = 0;
        for (int n = 0; n < count; n++) {
            far = fmax(far, fabs(ways[n][i]));
            all = fmax(all, snow_length(ways[n]));
        }
        if (far <= 1e-9 * all)
            continue;
        if (unit && strcmp(unit, unit_of(info, i)) != 0)
            return snow_fail(
                r->context, SNOW_STATUS_BAD_USAGE,
                "measure %d, '%.120s': the axes of this world have different "
                "units, %s and %s: no length is valid across them; keep to one",
                r->n, r->text, unit, unit_of(info, i));
        unit = unit_of(info, i);
    }
    snow_text_print(m->unit, sizeof m->unit, "%s", unit ? unit : info->unit);
    return SNOW_STATUS_OK;
}

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static snow_status read_points(const reading *r, snow_measure *m) {
    const int count = m->kind == SNOW_MEASURE_LINE ? 2 : 3;
    double ways[2][3], normal[3];
    if (r->count != 1 + count)
        return refuse(r, count == 2 ? "a line has two points"
                                    : "an angle has three points, of which the "
                                      "second is its corner");
    for (int n = 0; n < count; n++)
        if (read_numbers(r->words[1 + n], 3, m->points[n]) != 3)
            return refuse(r, "a point has three numbers");
    if (!r->info)
        return SNOW_STATUS_OK;
    for (int n = count - 1; n >= 0; n--)
        if (!is_within(r->info, m->points[n]))
            m->outside = n + 1;
    subtract(m->points[0], m->points[1], ways[0]);
    subtract(m->points[2], m->points[1], ways[1]);
    SNOW_TRY(find_unit(r, (const double(*)[3])ways, count - 1, m));
    if (count == 2) {
        m->result = snow_length(ways[0]);
        return SNOW_STATUS_OK;
    }
    if (!(snow_length(ways[0]) > 0 && snow_length(ways[1]) > 0))
        return refuse(r, "two points of the angle are one");
    snow_cross(ways[0], ways[1], normal);
    m->result =
        atan2(snow_length(normal), snow_dot(ways[0], ways[1])) * 180 / acos(-1);
    return SNOW_STATUS_OK;
}

/* --- ellipses ------------------------------------------------------------- */

/* The axis of the world that a slice lies across. */
static int world_axis(const snow_view *view) {
    int found = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(view->back[i]) > fabs(view->back[found]) + 1e-6)
            found = i;
    return found;
}

/* The slice whose middle is nearest to a position. */
static void find_slice(const snow_volume_info *info, int world, double position,
                       snow_measure *m) {
    const double *row = info->matrix[world];
    double first = row[3];
    for (int i = 0; i < 3; i++)
        if (i != m->axis)
            first += row[i] * ((double)info->dims[i] - 1) / 2;
    const double at = rint((position - first) / row[m->axis]);
    const double last = (double)info->dims[m->axis] - 1;
    m->index = (int64_t)fmin(fmax(at, -1), last + 1);
    if (m->index < 0 || m->index > info->dims[m->axis] - 1)
        m->outside = 1;
}

/* The place of the slice with two coordinates, those but `world`. */
static bool on_slice(const snow_volume_info *info, int world,
                     const snow_measure *m, const double *numbers, int count,
                     double out[3]) {
    const int u = (m->axis + 1) % 3, v = (m->axis + 2) % 3;
    double index[3] = {0}, origin[3], to[2];
    const double(*matrix)[4] = info->matrix;
    int rows[2], used = 0;
    index[m->axis] = (double)m->index;
    place_of(info, index, origin);
    for (int i = 0; i < 3; i++) {
        if (i == world)
            continue;
        to[used] = numbers[count == 3 ? i : used] - origin[i];
        rows[used++] = i;
    }
    const double *a = matrix[rows[0]], *b = matrix[rows[1]];
    const double whole = a[u] * b[v] - a[v] * b[u];
    if (!(fabs(whole) > 0))
        return false;
    index[u] = (to[0] * b[v] - a[v] * to[1]) / whole;
    index[v] = (a[u] * to[1] - to[0] * b[u]) / whole;
    place_of(info, index, out);
    return true;
}

/* The end of a half-axis: a length along `way`, or a place. */
static const char *read_end(const reading *r, int world, const char *word,
                            const double way[3], snow_measure *m,
                            double out[3]) {
    double numbers[3];
    const int count = read_numbers(word, 3, numbers);
    if (count == 1 && numbers[0] > 0) {
        for (int i = 0; i < 3; i++)
            out[i] = m->points[0][i] + numbers[0] * way[i];
        return NULL;
    }
    return count > 1 && on_slice(r->info, world, m, numbers, count, out)
               ? NULL
               : "a half-axis is a length above 0, or the place where it ends";
}

static double cross_length(const snow_measure *m, double ways[2][3]) {
    double normal[3];
    for (int n = 0; n < 2; n++)
        subtract(m->points[n + 1], m->points[0], ways[n]);
    snow_cross(ways[0], ways[1], normal);
    return snow_length(normal);
}

static snow_status check_ellipse(const reading *r, double *position) {
    double numbers[3];
    static const char *const axes[] = {"x",     "y",       "z",
                                       "axial", "coronal", "sagittal"};
    bool known = false;
    for (int n = 0; n < 6 && r->count > 1; n++)
        known |= strcmp(r->words[1], axes[n]) == 0;
    if (r->count != 6)
        return refuse(r, "an ellipse has an axis, a position, a middle and two "
                         "half-axes");
    if (!known)
        return refuse(r, "the axis must be x, y, z, axial, coronal or "
                         "sagittal");
    if (read_numbers(r->words[2], 1, position) != 1)
        return refuse(r, "the position along the axis is one number");
    if (read_numbers(r->words[3], 3, numbers) < 2)
        return refuse(r, "the middle is a point, whose coordinate along the "
                         "axis may be left out");
    for (int n = 4; n < 6; n++) {
        const int count = read_numbers(r->words[n], 3, numbers);
        if (!count || (count == 1 && !(numbers[0] > 0)))
            return refuse(r, "a half-axis is a length above 0, or the place "
                             "where it ends");
    }
    return SNOW_STATUS_OK;
}

static snow_status read_ellipse(const reading *r, snow_measure *m) {
    const snow_volume_info *info = r->info;
    snow_view view;
    double position, numbers[3], right[3], ways[2][3];
    SNOW_TRY(check_ellipse(r, &position));
    if (!info)
        return SNOW_STATUS_OK;
    snow_view_init(&view);
    SNOW_TRY(snow_slice_view(r->context, info, r->words[1], &view, &m->axis));
    const int world = world_axis(&view);
    find_slice(info, world, position, m);
    const int count = read_numbers(r->words[3], 3, numbers);
    if (!on_slice(info, world, m, numbers, count, m->points[0]))
        return refuse(r, "the slice has no such place");
    if (!is_within(info, m->points[0]))
        m->outside = 1;
    snow_cross(view.up, view.back, right);
    const char *wrong = read_end(r, world, r->words[4], right, m, m->points[1]);
    if (!wrong)
        wrong = read_end(r, world, r->words[5], view.up, m, m->points[2]);
    if (wrong)
        return refuse(r, wrong);
    const double area = cross_length(m, ways);
    if (!(area > 1e-9 * snow_length(ways[0]) * snow_length(ways[1])))
        return refuse(r, "the half-axes have one direction");
    m->result = acos(-1) * area;
    return find_unit(r, (const double(*)[3])ways, 2, m);
}

snow_status snow_measure_read(snow_context *context, const char *text, int n,
                              const snow_volume_info *info, snow_measure *out) {
    reading r = {.context = context, .n = n + 1};
    snow_volume_info volume;
    snow_measure m;
    snow_measure_init(&m);
    m.mean = m.deviation = m.min = m.max = NAN;
    if (info) {
        SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, info, &volume));
        volume = unscaled(&volume);
        r.info = &volume;
    }
    if (n >= SNOW_MEASURES_MAX && find_text(text, n, &r))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "there are more than %d measures: leave some out",
                         SNOW_MEASURES_MAX);
    if (!find_text(text, n, &r))
        return SNOW_RECORD_FILL(context, snow_measure, &m, out);
    split(&r);
    for (int kind = 1; kind < 4 && r.count > 0; kind++)
        if (strcmp(r.words[0], kinds[kind]) == 0)
            m.kind = (snow_measure_kind)kind;
    if (m.kind == SNOW_MEASURE_NONE)
        return refuse(&r, r.count < 0
                              ? "it is too long"
                              : "its kind must be line, angle or ellipse");
    SNOW_TRY(m.kind == SNOW_MEASURE_ELLIPSE ? read_ellipse(&r, &m)
                                            : read_points(&r, &m));
    return SNOW_RECORD_FILL(context, snow_measure, &m, out);
}

/* --- values --------------------------------------------------------------- */

/* The voxels of a slice, before an ellipse in it: of voxel (i, j) the shares of
 * both half-axes, s and t, are origin + i step[0] + j step[1]. */
typedef struct ellipse_grid {
    const snow_volume *volume;
    int u, v;
    int64_t first; /* linear index of voxel (0, 0) */
    int64_t stride[2];
    double origin[2], step[2][2];
} ellipse_grid;

/* Shares of the half-axes of a vector in their plane. */
static void shares_of(double ways[2][3], const double vector[3],
                      double out[2]) {
    const double aa = snow_dot(ways[0], ways[0]),
                 ab = snow_dot(ways[0], ways[1]),
                 bb = snow_dot(ways[1], ways[1]), whole = aa * bb - ab * ab;
    const double a = snow_dot(ways[0], vector), b = snow_dot(ways[1], vector);
    out[0] = (a * bb - b * ab) / whole;
    out[1] = (b * aa - a * ab) / whole;
}

static bool place_grid(const snow_volume *volume, const snow_measure *m,
                       ellipse_grid *out) {
    const snow_volume_info info = unscaled(&volume->info);
    const int64_t strides[3] = {1, info.dims[0], info.dims[0] * info.dims[1]};
    double ways[2][3], index[3], corner[3], from[3];
    *out = (ellipse_grid){
        .volume = volume, .u = (m->axis + 1) % 3, .v = (m->axis + 2) % 3};
    if (!(cross_length(m, ways) > 0) || !index_of(&info, m->points[0], index))
        return false;
    const double slice = rint(index[m->axis]);
    if (!(slice >= 0 && slice < (double)info.dims[m->axis]))
        return false;
    out->first = (int64_t)slice * strides[m->axis];
    out->stride[0] = strides[out->u];
    out->stride[1] = strides[out->v];
    memset(index, 0, sizeof index);
    index[m->axis] = slice;
    place_of(&info, index, corner);
    subtract(corner, m->points[0], from);
    shares_of(ways, from, out->origin);
    for (int n = 0; n < 2; n++) {
        const int k = n ? out->v : out->u;
        const double step[3] = {info.matrix[0][k], info.matrix[1][k],
                                info.matrix[2][k]};
        shares_of(ways, step, out->step[n]);
    }
    return true;
}

/* Adds the values inside; or, of a second pass, squares of their distances from
 * the mean. */
static double sum_up(const ellipse_grid *g, bool second, snow_measure *m) {
    const snow_volume_info *info = &g->volume->info;
    double sum = 0;
    for (int64_t j = 0; j < info->dims[g->v]; j++)
        for (int64_t i = 0; i < info->dims[g->u]; i++) {
            const double s = g->origin[0] + (double)i * g->step[0][0] +
                             (double)j * g->step[1][0];
            const double t = g->origin[1] + (double)i * g->step[0][1] +
                             (double)j * g->step[1][1];
            if (s * s + t * t > 1 + BORDER)
                continue;
            const double native = snow_volume_native(
                g->volume, g->first + i * g->stride[0] + j * g->stride[1]);
            const double value = info->slope * native + info->intercept;
            if (!isfinite(value))
                continue;
            if (second) {
                sum += (value - m->mean) * (value - m->mean);
                continue;
            }
            m->min = m->count ? fmin(m->min, value) : value;
            m->max = m->count ? fmax(m->max, value) : value;
            m->count++;
            sum += value;
        }
    return sum;
}

snow_status snow_measure_values(const snow_volume *volume,
                                snow_measure *measure) {
    snow_context *context = volume->context;
    ellipse_grid grid;
    snow_measure m;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_measure, measure, &m));
    if (m.kind != SNOW_MEASURE_ELLIPSE)
        return SNOW_STATUS_OK;
    if (!snow_volume_voxels(volume))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "the voxels of a measure are in their file; open the "
                         "slice as a crop");
    m.count = -1;
    m.mean = m.deviation = m.min = m.max = NAN;
    if (place_grid(volume, &m, &grid)) {
        m.count = 0;
        const double sum = sum_up(&grid, false, &m);
        if (m.count > 0)
            m.mean = sum / (double)m.count;
        if (m.count > 1)
            m.deviation = sqrt(sum_up(&grid, true, &m) / (double)(m.count - 1));
    }
    return SNOW_RECORD_FILL(context, snow_measure, &m, measure);
}
