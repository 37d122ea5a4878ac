/* formats/nrrd/grid.c - selects the spatial axes of an NRRD array and places
 * the samples.
 *
 * Up to three axes are spatial, and one after them may be time (or a list of
 * volumes), of which one step is read.  One before them may have the values of
 * a voxel: a colour, whose parts are channels, or a vector.  Axes with one
 * sample may be ignored anywhere, since the order of the samples does not
 * depend on them:
 *
 *   sizes 1 64 64 20 5, kinds stub domain domain domain time
 *         -  x  y  z t */
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
 * axes "list" or nothing at all. */
static nrrd_role role_of(const nrrd_header *header, const nrrd_axis *axis) {
    if (axis->directed) {
        const double *step = axis->direction;
        bool only_time =
            step[0] == 0 && step[1] == 0 && step[2] == 0 && step[3] != 0;
        return only_time ? NRRD_AXIS_TIME : NRRD_AXIS_SPACE;
    }
    /* "none" among the directions, and no kind that says more. */
    if (header->directions && axis->role < NRRD_AXIS_TIME)
        return NRRD_AXIS_VALUES;
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
            (role == NRRD_AXIS_VECTOR && header->type == SNOW_TYPE_UINT8)) &&
           (size == 3 || size == 4);
}

/* A time step must be contiguous, so time comes last, and the values of a voxel
 * first. */
static snow_status choose_axes(snow_context *context, const nrrd_header *header,
                               axis_choice *out) {
    *out = (axis_choice){.time = -1, .values = -1};
    for (int i = 0; i < header->dimension; i++) {
        nrrd_role role = role_of(header, &header->axes[i]);
        if (role != NRRD_AXIS_SPACE && header->axes[i].size == 1)
            continue;
        const bool first = out->values < 0 && !out->spaces && out->time < 0;
        if (first && (are_colors(header, i) || role == NRRD_AXIS_VECTOR)) {
            out->values = i;
            continue;
        }
        if (role >= NRRD_AXIS_COLORS)
            return snow_fail(
                context, SNOW_STATUS_BAD_INPUT,
                "axis %d has %lld values for each voxel, and is no first axis "
                "of 3 or 4 colours or of a vector; extract one as a volume",
                i, (long long)header->axes[i].size);
        /* Spatial axes after time would be scattered in the file. */
        if (out->time >= 0)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "axis %d, time or a list of volumes, is not the "
                             "last one; reorder the axes",
                             out->time);
        if (role == NRRD_AXIS_TIME)
            out->time = i;
        else
            out->space[out->spaces++] = i;
    }
    drop_flat_axes(header, out);
    if (out->spaces > 3)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "has %d axes, and the meaning of the 4th is unknown; add \"kinds: "
            "domain domain domain time\", or extract a volume",
            out->spaces);
    return SNOW_STATUS_OK;
}

/* A direction of length 1 for each missing column, orthogonal to the others. */
static void complete_columns(double m[4][4], int given) {
    if (given == 1) {
        int least = 0;
        for (int i = 1; i < 3; i++)
            if (fabs(m[i][0]) < fabs(m[least][0]))
                least = i;
        double axis[3] = {least == 0, least == 1, least == 2};
        for (int i = 0; i < 3; i++) {
            int a = (i + 1) % 3, b = (i + 2) % 3;
            m[i][1] = axis[a] * m[b][0] - axis[b] * m[a][0];
        }
        double length = hypot(hypot(m[0][1], m[1][1]), m[2][1]);
        for (int i = 0; i < 3 && length > 0; i++)
            m[i][1] /= length;
    }
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        m[i][2] = m[a][0] * m[b][1] - m[b][0] * m[a][1];
    }
    double length = hypot(hypot(m[0][2], m[1][2]), m[2][2]);
    for (int i = 0; i < 3 && length > 0; i++)
        m[i][2] /= length;
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
static void take_units(snow_context *context, const nrrd_header *header,
                       const axis_choice *choice, snow_volume_info *info) {
    const bool of_space = header->space_unit_count > 0;
    const char *texts[3] = {NULL};
    double factors[3];
    for (int i = 0; i < 3; i++)
        if (of_space && i < header->space_unit_count)
            texts[i] = header->space_units[i];
        else if (!of_space && i < choice->spaces)
            texts[i] = header->axes[choice->space[i]].unit;
    snow_length_join(context, texts, factors, info->unit);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            info->matrix[i][j] *= factors[of_space ? i : j];
        if (of_space || !header->directions)
            info->matrix[i][3] *= factors[i];
    }
    if (!*info->unit && header->medical)
        memcpy(info->unit, "mm", 3);
}

/* The channel or component of the options. */
static snow_status lay_values(snow_context *context, const nrrd_header *header,
                              int axis, const snow_volume_options *options,
                              snow_volume_info *info, snow_array *out) {
    const int64_t sizes[5] = {header->axes[axis].size, info->dims[0],
                              info->dims[1], info->dims[2], info->times};
    const uint64_t size = snow_type_size(header->type);
    snow_array array = {.big_endian = header->big_endian};
    uint64_t steps[5];
    int64_t value = 0;
    if (!snow_array_steps(sizes, 5, size, steps, &array.all))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its sizes are too large for any file; correct the "
                         "header");
    if (are_colors(header, axis)) {
        snow_channels_begin(info, sizes[0], false);
        snow_channels_are_colors(info);
        SNOW_TRY(
            snow_volume_pick_channel(context, options, sizes[0], info, &value));
    } else {
        SNOW_TRY(snow_volume_pick_component(context, options, sizes[0], info,
                                            &value));
    }
    memcpy(array.step, steps + 1, sizeof array.step);
    array.first = (uint64_t)info->time * steps[4] + (uint64_t)value * steps[0];
    *out = array;
    return SNOW_STATUS_OK;
}

/* The matrix is checked before the time step: an error of the file comes before
 * one of the options. */
snow_status snow_nrrd_lay_out(snow_context *context, const nrrd_header *header,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_region *region,
                              snow_array *values) {
    axis_choice choice;
    int64_t only;
    *values = (snow_array){.all = 0};
    SNOW_TRY(choose_axes(context, header, &choice));
    info->type = header->type;
    info->medical = header->medical;
    for (int i = 0; i < choice.spaces; i++)
        info->dims[i] = header->axes[choice.space[i]].size;
    if (choice.time >= 0)
        info->times = header->axes[choice.time].size;
    fill_matrix(header, &choice, info->matrix);
    take_units(context, header, &choice, info);
    SNOW_TRY(snow_volume_info_check(context, info));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    if (choice.values < 0)
        SNOW_TRY(snow_volume_pick_channel(context, options, 1, info, &only));
    SNOW_TRY(choice.values < 0
                 ? snow_region_lay_out(context, options, info, region)
                 : lay_values(context, header, choice.values, options, info,
                              values));
    if (header->turn[2] < 0)
        snow_notify(context, "the world is left-handed; z is flipped, so that "
                             "nothing is mirrored");
    return SNOW_STATUS_OK;
}
