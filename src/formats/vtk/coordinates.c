/* formats/vtk/coordinates.c - rectilinear grids: the coordinates of their
 * points along each axis, and whether they are even. */
#include "formats/ascii.h"
#include "formats/vtk/vtk.h"

#include <string.h>

/* A volume of one row serves to convert the numbers. */
static snow_status read_binary(snow_source *source, const vtk_line *line,
                               snow_volume *row, double *out) {
    const size_t size = snow_type_size(line->type);
    SNOW_TRY(snow_source_read_all(source, row->owned,
                                  (size_t)line->count * size, line->what));
    if (line->big_endian != snow_machine_big_endian())
        snow_swap_bytes(row->owned, (uint64_t)line->count, size);
    snow_volume_stored(row, 0, (size_t)line->count, out);
    return SNOW_STATUS_OK;
}

static snow_status read_line(snow_source *source, const vtk_line *line,
                             double *out) {
    snow_context *context = snow_source_context(source);
    if (line->text) {
        const uint64_t bytes = (uint64_t)line->count * sizeof *out;
        const snow_region all = {.all = bytes,
                                 .value = sizeof *out,
                                 .dims = {line->count, 1, 1},
                                 .count = {line->count, 1, 1}};
        const snow_file_part whole = {&all, 0, bytes};
        return snow_read_numbers(source, SNOW_TYPE_FLOAT64, false, &whole, out);
    }
    snow_volume_info info = snow_volume_info_default("vtk");
    snow_volume *row;
    info.dims[0] = line->count;
    info.type = line->type;
    SNOW_TRY(snow_volume_new(context, &info, &row));
    snow_status status = read_binary(source, line, row, out);
    snow_volume_close(row);
    return status;
}

snow_status snow_vtk_read_line(snow_source *source, const vtk_line *line,
                               double **out) {
    snow_context *context = snow_source_context(source);
    if (!line->type || line->count < 1 || line->count > CF_MOST_COORDINATES)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%s: %lld numbers of an unknown type, or more than "
                         "any grid has; write the file again",
                         line->what, (long long)line->count);
    SNOW_TRY(snow_source_expect(source, (uint64_t)line->count, line->what));
    double *values =
        snow_allocate_array(context, (uint64_t)line->count, sizeof *values);
    if (!values)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = read_line(source, line, values);
    if (status != SNOW_STATUS_OK) {
        snow_release(context, values);
        return status;
    }
    *out = values;
    return SNOW_STATUS_OK;
}

/* The coordinates of an array's values: of cells those half-way between
 * points. */
static snow_status measure_axis(snow_context *context, const vtk_grid *grid,
                                bool cells, int axis, cf_axis *out) {
    const double *at = grid->coordinates[axis];
    int64_t count = grid->points[axis] - (cells && grid->points[axis] > 1);
    if (!at)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "lacks the coordinates along %c of its rectilinear "
                         "grid; write the file again",
                         "xyz"[axis]);
    double *own = snow_allocate_array(context, (uint64_t)count, sizeof *own);
    if (!own)
        return SNOW_STATUS_NO_MEMORY;
    for (int64_t i = 0; i < count; i++)
        own[i] = count < grid->points[axis] ? (at[i] + at[i + 1]) / 2 : at[i];
    cf_attributes says;
    snow_cf_attributes_begin(&says);
    snow_cf_measure(own, count, &says, out);
    if (count == 1 || (out->given && (out->even || out->uneven)))
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "its coordinates along %c neither rise nor fall "
                     "throughout; correct them",
                     "xyz"[axis]);
}

snow_status snow_vtk_place_rectilinear(snow_context *context, vtk_grid *grid,
                                       bool cells,
                                       const snow_volume_options *options,
                                       snow_volume_info *info) {
    snow_cf_release(context, grid->axes, 3);
    memset(grid->axes, 0, sizeof grid->axes);
    for (int i = 0; i < 3; i++)
        SNOW_TRY(measure_axis(context, grid, cells, i, &grid->axes[i]));
    snow_cf_place(context, grid->axes, options, info, &grid->uneven);
    for (int i = 0; i < 3; i++)
        if (!grid->axes[i].given)
            info->matrix[i][3] = grid->coordinates[i][0];
    return SNOW_STATUS_OK;
}

void snow_vtk_release(snow_context *context, vtk_grid *grid) {
    snow_cf_release(context, grid->axes, 3);
    for (int i = 0; i < 3; i++)
        snow_release(context, grid->coordinates[i]);
}
