/* formats/nrrd/grid.c - selects the spatial axes of an NRRD array and places
 * the samples.
 *
 * Up to three axes are spatial, and one at any place may be time or a list of
 * volumes, of which one is read.  Another one may have the values of a voxel: a
 * colour, whose parts are channels, a vector, a tensor.  Axes with one sample
 * are ignored:
 *
 *   sizes 1 64 64 20 5, kinds stub domain domain domain time
 *         -  x  y  z t */
#include "base/vec3.h"
#include "formats/nrrd/nrrd.h"
#include "volume/length_unit.h"

#include <math.h>
#include <string.h>

/* The selected axes, by index. */
typedef struct axis_choice {
    int space[NRRD_MOST_AXES];
    int spaces;
    int time, values; /* -1: none */
} axis_choice;

/* A direction in space is more reliable than a kind: some files call spatial
 * axes "list" or nothing at all.  An axis without a direction and kind among
 * others with one holds values if it is the first, else volumes. */
static nrrd_role role_of(const nrrd_header *header, int i) {
    const nrrd_axis *axis = &header->axes[i];
    if (axis->directed) {
        const double *step = axis->direction;
        bool only_time =
            step[0] == 0 && step[1] == 0 && step[2] == 0 && step[3] != 0;
        return only_time ? NRRD_AXIS_TIME : NRRD_AXIS_SPACE;
    }
    if (header->directions && axis->role < NRRD_AXIS_TIME)
        return i ? NRRD_AXIS_LIST : NRRD_AXIS_VALUES;
    return axis->role == NRRD_AXIS_UNKNOWN ? NRRD_AXIS_SPACE : axis->role;
}

/* Ignores spatial axes of one sample, the last first, while there are more than
 * three. */
static void drop_flat_axes(const nrrd_header *header, axis_choice *choice) {
    for (int i = choice->spaces; i-- > 0 && choice->spaces > 3;) {
        if (header->axes[choice->space[i]].size > 1)
            continue;
        for (int k = i + 1; k < choice->spaces; k++)
            choice->space[k - 1] = choice->space[k];
        choice->spaces--;
    }
}

/* Returns whether values of an axis of a role are an image's colours. Many
 * programs call those of 8 bits a vector. */
static bool are_colors(const nrrd_header *header, int axis) {
    const nrrd_role role = header->axes[axis].role;
    const int64_t size = header->axes[axis].size;
    return (role == NRRD_AXIS_COLORS ||
            (role == NRRD_AXIS_VECTOR &&
             header->data.type == SNOW_TYPE_UINT8)) &&
           (size == 3 || size == 4);
}

/* Of four axes that may all be of space, as ITK writes those of an image with
 * time, the last one is no space.  A short first axis without a kind may be
 * one of values, though. */
static void take_fourth(const nrrd_header *header, axis_choice *choice) {
    const nrrd_axis *first = &header->axes[choice->space[0]];
    if (choice->spaces != 4 || choice->time >= 0 ||
        (first->role == NRRD_AXIS_UNKNOWN && !first->directed &&
         first->size <= 4))
        return;
    choice->time = choice->space[--choice->spaces];
    snow_notify(header->context,
                "axis %d is taken to be time or a list of volumes, since three "
                "others are of space",
                choice->time);
}

static snow_status choose_axes(const nrrd_header *header, axis_choice *out) {
    *out = (axis_choice){.time = -1, .values = -1};
    for (int i = 0; i < header->dimension; i++) {
        nrrd_role role = role_of(header, i);
        if (role == NRRD_AXIS_SPACE) {
            out->space[out->spaces++] = i;
            continue;
        }
        if (header->axes[i].size == 1)
            continue;
        int *of = role <= NRRD_AXIS_LIST ? &out->time : &out->values;
        if (*of >= 0)
            return snow_fail(header->context, SNOW_STATUS_BAD_INPUT,
                             "axes %d and %d are both %s; extract one volume",
                             *of, i,
                             of == &out->time ? "time or a list of volumes"
                                              : "values of each voxel");
        *of = i;
    }
    drop_flat_axes(header, out);
    take_fourth(header, out);
    if (out->spaces > 3)
        return snow_fail(
            header->context, SNOW_STATUS_BAD_INPUT,
            "has %d axes, and the meaning of the 4th is unknown; add \"kinds: "
            "domain domain domain time\", or extract a volume",
            out->spaces);
    return SNOW_STATUS_OK;
}

/* A direction of length 1 for each missing column, orthogonal to the others. */
static void complete_columns(double m[4][4], int given) {
    double axes[3][3];
    for (int i = 0; i < 3; i++) {
        axes[0][i] = m[i][0];
        axes[1][i] = m[i][1];
    }
    if (given == 1) {
        int least = 0;
        for (int i = 1; i < 3; i++)
            if (fabs(m[i][0]) < fabs(m[least][0]))
                least = i;
        const double axis[3] = {least == 0, least == 1, least == 2};
        snow_cross(axis, axes[0], axes[1]);
    }
    snow_cross(axes[0], axes[1], axes[2]);
    for (int j = given; j < 3; j++) {
        const double length = snow_length(axes[j]);
        for (int i = 0; i < 3; i++)
            m[i][j] = length > 0 ? axes[j][i] / length : 0;
    }
}

/* Axis j of the volume is the j-th spatial axis in the file's order; without
 * directions it runs along world axis j. */
static void fill_matrix(const nrrd_header *header, const axis_choice *choice,
                        double m[4][4]) {
    for (int j = 0; j < choice->spaces; j++) {
        const nrrd_axis *axis = &header->axes[choice->space[j]];
        for (int i = 0; i < 3; i++) {
            m[i][j] = i == j ? axis->spacing : 0;
            if (axis->directed)
                m[i][j] = axis->direction[i];
        }
    }
    if (header->directions && choice->spaces > 0 && choice->spaces < 3)
        complete_columns(m, choice->spaces);
    for (int i = 0; i < 3; i++) {
        m[i][3] = header->origin[i];
        if (i < choice->spaces) /* 0 if there are directions or an origin */
            m[i][3] += header->axes[choice->space[i]].first;
        for (int j = 0; j < 4; j++)
            /* + 0 removes negative zeros. */
            m[i][j] = m[i][j] * header->turn[i] + 0.0;
    }
}

/* The space's units have priority over the axes', as directions over spacings.
 * Medical spaces are in millimetres by default. */
static void take_units(const nrrd_header *header, const axis_choice *choice,
                       snow_volume_info *info) {
    const bool of_space = header->space_unit_count > 0;
    const char *texts[3] = {NULL};
    double factors[3];
    for (int i = 0; i < 3; i++)
        if (of_space && i < header->space_unit_count)
            texts[i] = header->space_units[i];
        else if (!of_space && i < choice->spaces)
            texts[i] = header->axes[choice->space[i]].unit;
    snow_length_join(header->context, texts, factors, info->unit);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            info->matrix[i][j] *= factors[of_space ? i : j];
        if (of_space || !header->directions)
            info->matrix[i][3] *= factors[i];
    }
    if (!*info->unit && header->medical)
        memcpy(info->unit, "mm", 3);
}

/* Where the voxels lie that are chosen. */
static snow_status lay_array(const nrrd_header *header,
                             const axis_choice *choice, int64_t value,
                             const snow_volume_info *info, snow_array *out) {
    int64_t sizes[NRRD_MOST_AXES];
    uint64_t steps[NRRD_MOST_AXES];
    *out = (snow_array){.big_endian = header->data.big_endian};
    for (int i = 0; i < header->dimension; i++)
        sizes[i] = header->axes[i].size;
    if (!snow_array_steps(sizes, header->dimension,
                          snow_type_size(header->data.type), steps, &out->all))
        return snow_fail(header->context, SNOW_STATUS_BAD_INPUT,
                         "its sizes are too large for any file; correct the "
                         "header");
    for (int i = 0; i < choice->spaces; i++)
        out->step[i] = steps[choice->space[i]];
    if (choice->time >= 0)
        out->first = (uint64_t)info->time * steps[choice->time];
    if (choice->values >= 0)
        out->first += (uint64_t)value * steps[choice->values];
    return SNOW_STATUS_OK;
}

/* Spacings that are not a number are common where only some are known. */
static void complete_spacings(nrrd_header *header, const axis_choice *choice) {
    for (int i = 0; i < choice->spaces; i++) {
        nrrd_axis *axis = &header->axes[choice->space[i]];
        if (axis->directed || !isnan(axis->spacing))
            continue;
        axis->spacing = 1;
        snow_notify(header->context,
                    "the spacing of axis %d is not known and taken as 1; "
                    "--spacing sets another",
                    choice->space[i]);
    }
}

/* The matrix is checked before the time step: an error of the file comes before
 * one of the options. */
snow_status snow_nrrd_lay_out(nrrd_header *header,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_array *values) {
    axis_choice choice;
    int64_t value;
    *values = (snow_array){.all = 0};
    SNOW_TRY(choose_axes(header, &choice));
    const int time = choice.time;
    info->type = header->data.type;
    info->medical = header->medical;
    for (int i = 0; i < choice.spaces; i++)
        info->dims[i] = header->axes[choice.space[i]].size;
    if (time >= 0)
        info->times = header->axes[time].size;
    complete_spacings(header, &choice);
    fill_matrix(header, &choice, info->matrix);
    take_units(header, &choice, info);
    SNOW_TRY(snow_volume_info_check(header->context, info));
    SNOW_TRY(snow_volume_pick_time(
        header->context,
        time >= 0 && role_of(header, time) == NRRD_AXIS_TIME ? "time step"
                                                             : "volume",
        options, info));
    const bool some = choice.values >= 0;
    const bool colors = some && are_colors(header, choice.values);
    info->directions =
        some && !colors && header->axes[choice.values].role == NRRD_AXIS_VECTOR;
    SNOW_TRY(snow_volume_pick_value(header->context, options,
                                    some ? header->axes[choice.values].size : 1,
                                    colors, info, &value));
    if (some ||
        (time >= 0 && choice.spaces && time < choice.space[choice.spaces - 1]))
        SNOW_TRY(lay_array(header, &choice, value, info, values));
    if (header->turn[2] < 0)
        snow_notify(header->context,
                    "the world is left-handed; z is flipped, so that "
                    "nothing is mirrored");
    return SNOW_STATUS_OK;
}
