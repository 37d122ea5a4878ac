/* formats/index/xdmf.c - XDMF (xdmf.org, versions 2 and 3) of uniform and
 * rectilinear grids, whose values are in HDF5 or raw files:
 *
 *     <Grid GridType="Collection" CollectionType="Temporal">
 *       <Grid> <Time Value="0.5"/>
 *         <Topology TopologyType="3DCoRectMesh" Dimensions="nz ny nx"/>
 *         <Geometry GeometryType="ORIGIN_DXDYDZ"> z y x of the first point,
 *                                                 and of the spacing
 *         <Attribute Name="rho" Center="Node">
 *           <DataItem Format="HDF">run.h5:/rho</DataItem>
 *
 * Numbers stand in the order of the array, the slowest first.  A grid without a
 * topology or geometry of its own, or with a reference, has the last one
 * before.  Values may be a HyperSlab, a box of an array of up to five axes, or
 * several arrays joined to a vector.  Grids of a collection in space are parts
 * of one grid.  A collection in time may list the times of its grids (TimeType
 * "List", or "HyperSlab": the first, the step, how many). */
#include "formats/index/xdmf.h"
#include "formats/vtk/vtk.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* The box, step and channel of a data set that a HyperSlab is; the crop of the
 * options counts within it. */
static snow_status select_slab(const xdmf_file *f, const xdmf_item *item,
                               snow_volume_options *own) {
    const int lead = item->axes > 3 ? item->axes - 3 : 0;
    bool right = true;
    own->dataset = NULL;
    own->time = 0;
    for (int a = 0; a < item->axes; a++) {
        const int64_t first = item->slab[0][a], count = item->slab[2][a];
        const int k = item->axes - 1 - a;
        right = right && first >= 0 && count >= 1 &&
                first < INT64_MAX - count &&
                (a < lead ? count == 1 : count == 1 || item->slab[1][a] == 1);
        if (a < lead || !right)
            continue;
        own->crop[k][1] = first + (own->crop[k][1] ? own->crop[k][1] : count);
        own->crop[k][0] += first;
    }
    if (lead)
        own->time = item->slab[0][0];
    if (lead > 1)
        own->channel = item->slab[0][1];
    own->each_time = own->each_channel = true;
    return right ? SNOW_STATUS_OK
                 : snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                             "has a HyperSlab of %s that is not one box of its "
                             "last three axes; write it as a data set",
                             item->text);
}

/* Opens what an item is of a data set. */
static snow_status open_item(const xdmf_file *f, const xdmf_item *item,
                             snow_volume_options *own, snow_volume_info *info,
                             snow_volume **out) {
    SNOW_TRY(select_slab(f, item, own));
    const snow_status status =
        snow_volume_open_named(f->source, item->text, own, info, out);
    return item->axes && status == SNOW_STATUS_BAD_USAGE
               ? snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                           "has a HyperSlab that does not lie in %s; correct "
                           "it",
                           item->text)
               : status;
}

/* Reads numbers of the geometry: `count` of them. */
static snow_status read_numbers(xdmf_file *f, const xdmf_item *item,
                                int64_t count, double **out) {
    const vtk_line line = {"its geometry", count, true, false,
                           SNOW_TYPE_FLOAT64};
    snow_volume_options plain = {.size = sizeof plain};
    snow_volume_info info;
    snow_volume *row;
    if (item->xml) {
        snow_source *text;
        SNOW_TRY(snow_source_open_memory(f->context, "its geometry",
                                         f->numbers + item->numbers,
                                         item->length, &text));
        snow_status status = snow_vtk_read_line(text, &line, out);
        snow_source_close(text);
        return status;
    }
    if (!item->hdf)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "its geometry is in a raw file, which is not "
                         "supported; write it into the XML");
    SNOW_TRY(open_item(f, item, &plain, &info, &row));
    const int64_t *dims = row->info.dims;
    snow_status status = SNOW_STATUS_OK;
    if (dims[0] * dims[1] * dims[2] != count)
        status = snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                           "%s has another number of values than the grid has "
                           "points; correct it",
                           item->text);
    double *values =
        status == SNOW_STATUS_OK
            ? snow_allocate_array(f->context, (uint64_t)count, sizeof *values)
            : NULL;
    if (values) {
        snow_volume_stored(row, 0, (size_t)count, values);
        *out = values;
    }
    snow_volume_close(row);
    return status != SNOW_STATUS_OK || values ? status : SNOW_STATUS_NO_MEMORY;
}

/* The time of a step by those of its collection; NaN: there are none.  Data
 * sets are read whole. */
static double time_of(xdmf_file *f, int64_t step) {
    double *values = NULL, time = NAN;
    int64_t count = f->even_times ? 2 : step + 1;
    if (!f->times.xml)
        count = f->even_times ? 3 : f->steps;
    if (!f->times.length && !*f->times.text)
        return NAN;
    if (read_numbers(f, &f->times, count, &values) == SNOW_STATUS_OK)
        time =
            f->even_times ? values[0] + (double)step * values[1] : values[step];
    if (!isfinite(time))
        snow_notify(f->context,
                    "its list of times has none that can be read for step "
                    "%" PRId64 "; write a number for each step into the XML",
                    step);
    snow_release(f->context, values);
    return time;
}

/* ORIGIN_DXDYDZ has two rows z y x, also of a grid in a plane (y x). */
static snow_status place_uniform(xdmf_file *f, const xdmf_grid *from,
                                 vtk_grid *grid) {
    const int axes =
        from->points[2] > 1 || snow_xdmf_is(from->kind, "3dcorectmesh") ? 3 : 2;
    double *rows[2] = {NULL, NULL};
    if (from->item_count < 2)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "its Geometry has no origin and spacing; add them");
    snow_status status = read_numbers(f, &from->items[0], axes, &rows[0]);
    if (status == SNOW_STATUS_OK)
        status = read_numbers(f, &from->items[1], axes, &rows[1]);
    for (int i = 0; i < axes && status == SNOW_STATUS_OK; i++) {
        grid->origin[i] = rows[0][axes - 1 - i];
        grid->spacing[i] = rows[1][axes - 1 - i];
    }
    snow_release(f->context, rows[0]);
    snow_release(f->context, rows[1]);
    return status;
}

/* VXVYVZ has the coordinates of x, y and z. */
static snow_status place_rectilinear(xdmf_file *f, const xdmf_grid *from,
                                     vtk_grid *grid) {
    grid->rectilinear = true;
    for (int i = 0; i < 3; i++)
        if (i < from->item_count)
            SNOW_TRY(read_numbers(f, &from->items[i], grid->points[i],
                                  &grid->coordinates[i]));
    return SNOW_STATUS_OK;
}

static snow_status place_grid(xdmf_file *f, vtk_grid *grid) {
    const xdmf_grid *from = &f->kept.grid;
    *grid = snow_vtk_grid_default();
    memcpy(grid->points, from->points, sizeof grid->points);
    if (!from->known)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "has a grid of \"%.60s\"; only 3DCoRectMesh and "
                         "3DRectMesh are supported, so resample it first",
                         *from->kind ? from->kind : "no topology");
    return from->rectilinear ? place_rectilinear(f, from, grid)
                             : place_uniform(f, from, grid);
}

/* --- values --------------------------------------------------------------- */

typedef struct xdmf_values {
    xdmf_file *file;
    int64_t channel;
    int64_t dims[3];
} xdmf_values;

/* That of a component, of those that are joined. */
static const xdmf_item *item_of(const xdmf_values *v) {
    const xdmf_step *kept = &v->file->kept;
    return kept->joined ? &kept->parts[v->channel] : &kept->item;
}

static snow_status read_raw(const xdmf_values *v,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    const xdmf_file *f = v->file;
    const xdmf_item *item = item_of(v);
    const bool joined = f->kept.joined > 0;
    snow_array array = {.big_endian = item->big_endian};
    snow_source *data;
    if (item->axes)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "has a HyperSlab of a raw file, which is not "
                         "supported; write it as a file");
    if (!snow_array_of_grid(
            item->type, v->dims, f->kept.vector && !joined ? 3 : 1,
            joined ? 0 : v->channel, (uint64_t)item->seek, &array))
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "its sizes are too large for any file; correct them");
    array.more = f->attributes > 1; /* their values may stand behind */
    SNOW_TRY(snow_source_open_sibling(f->source, item->text, &data));
    snow_status status = snow_array_read(data, options, &array, info, out);
    snow_source_close(data);
    return status;
}

/* A box of the file's own values. */
static snow_status read_values(void *user, const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    const xdmf_values *v = user;
    const xdmf_item *item = item_of(v);
    const bool joined = v->file->kept.joined > 0;
    snow_volume_options own = *options;
    snow_volume_info set = *info;
    snow_region box;
    if (item->binary)
        return read_raw(v, options, info, out);
    SNOW_TRY(snow_region_lay_out(v->file->context, options, &set, &box));
    if (joined) {
        own.component = NULL;
        own.channel = 0;
    }
    SNOW_TRY(select_slab(v->file, item, &own));
    SNOW_TRY(
        snow_volume_open_named(v->file->source, item->text, &own, &set, out));
    memcpy(info->dims, set.dims, sizeof info->dims);
    info->type = set.type;
    info->slope = set.slope;
    info->intercept = set.intercept;
    if (!joined) {
        info->components = set.components;
        info->magnitude = set.magnitude;
    }
    if (*set.value_unit)
        memcpy(info->value_unit, set.value_unit, sizeof info->value_unit);
    return SNOW_STATUS_OK;
}

/* The type, and of a data set its sizes, which must be those of the grid. */
static snow_status look_at_values(xdmf_file *f, vtk_grid *grid,
                                  vtk_array *array) {
    const xdmf_item *item = &f->kept.item;
    snow_volume_options own = *f->options;
    snow_volume_info set;
    array->type = item->type;
    if (item->binary)
        return SNOW_STATUS_OK;
    memset(own.crop, 0, sizeof own.crop);
    if (f->kept.joined) {
        own.component = NULL;
        own.channel = 0;
    }
    SNOW_TRY(open_item(f, item, &own, &set, NULL));
    array->type = set.type;
    for (int i = 0; i < 3; i++) {
        int64_t count = grid->points[i] - (array->cells && grid->points[i] > 1);
        if (set.dims[i] != count)
            return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                             "%s has %lldx%lldx%lld values, which is not the "
                             "size of its grid; correct the Dimensions",
                             item->text, (long long)set.dims[0],
                             (long long)set.dims[1], (long long)set.dims[2]);
    }
    return SNOW_STATUS_OK;
}

static snow_status read_grid(xdmf_file *f, vtk_grid *grid,
                             snow_volume_info *info, snow_volume **out) {
    vtk_array array = {.cells = f->kept.cells, .channels = 1};
    xdmf_values v = {.file = f};
    snow_volume_info series = *info;
    SNOW_TRY(place_grid(f, grid));
    SNOW_TRY(look_at_values(f, grid, &array));
    memcpy(array.name, f->kept.name, sizeof f->kept.name);
    SNOW_TRY(snow_vtk_describe(f->context, grid, &array, f->options, info));
    if (f->kept.item.binary || f->kept.joined)
        SNOW_TRY(snow_volume_pick_component(f->context, f->options,
                                            f->kept.joined   ? f->kept.joined
                                            : f->kept.vector ? 3
                                                             : 1,
                                            info, &v.channel));
    memcpy(v.dims, grid->uneven.count, sizeof v.dims);
    info->times = 1;
    info->time = 0;
    SNOW_TRY(snow_uneven_read(f->context, &grid->uneven, f->options,
                              read_values, &v, info, out));
    info->times = series.times;
    info->time = series.time;
    const double time =
        isnan(f->kept.time) ? time_of(f, info->time) : f->kept.time;
    info->time_value = isfinite(time) ? time : NAN;
    return SNOW_STATUS_OK;
}

static snow_status check_kept(const xdmf_file *f) {
    if (!f->kept.found && f->options->dataset)
        return snow_fail(f->context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.100s: there is no such attribute; the "
                         "file has %s",
                         f->options->dataset, *f->seen ? f->seen : "none");
    if (!f->kept.found)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "has no attribute with values; write one");
    if (f->kept.item.xml)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "its values are in the XML itself, which is not "
                         "supported; write them to HDF5");
    return SNOW_STATUS_OK;
}

/* --- grids side by side --------------------------------------------------- */

static void name_part(void *user, size_t index, char name[INDEX_NAME_BYTES]) {
    (void)user;
    *name = 0;
    snow_append(name, INDEX_NAME_BYTES, "grid %lld", (long long)index);
}

static snow_status open_part(void *user, size_t index,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    xdmf_file *f = user;
    const snow_volume_options *before = f->options;
    vtk_grid grid;
    f->kept = f->parts[index];
    f->options = options;
    *info = snow_volume_info_default("xdmf");
    SNOW_TRY(check_kept(f));
    snow_status status = read_grid(f, &grid, info, out);
    snow_vtk_release(f->context, &grid);
    f->options = before;
    return status;
}

static snow_status read_parts(xdmf_file *f, snow_volume_info *info,
                              snow_volume **out) {
    const snow_volume_info series = *info;
    const index_parts parts = {f->context, f->part_count, f, name_part,
                               open_part};
    SNOW_TRY(snow_mosaic_read(&parts, f->options, info, out));
    const double time =
        isnan(f->kept.time) ? time_of(f, series.time) : f->kept.time;
    info->times = series.times;
    info->time = series.time;
    info->time_value = isfinite(time) ? time : NAN;
    return SNOW_STATUS_OK;
}

static snow_status read_file(xdmf_file *f, snow_volume_info *info,
                             snow_volume **out) {
    vtk_grid grid;
    *info = snow_volume_info_default("xdmf");
    SNOW_TRY(snow_xdmf_parse(f));
    if (!f->steps)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "has no grid; write one");
    info->times = f->steps;
    SNOW_TRY(snow_volume_pick_time(f->context, "time step", f->options, info));
    if (f->options->time <
        -1) { /* counted from the end, now that it is known */
        snow_volume_options own = *f->options;
        own.time = info->time;
        return snow_fail(f->context, SNOW_STATUS_BAD_USAGE,
                         "time step %lld: of an XDMF file only -1 counts from "
                         "the end; give %lld",
                         (long long)f->options->time, (long long)own.time);
    }
    if (f->part_count > 1)
        return read_parts(f, info, out);
    SNOW_TRY(check_kept(f));
    snow_status status = read_grid(f, &grid, info, out);
    snow_vtk_release(f->context, &grid);
    return status;
}

static snow_status read_xdmf(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    xdmf_file *f = snow_allocate_clear(context, sizeof *f);
    if (!f)
        return SNOW_STATUS_NO_MEMORY;
    f->source = source;
    f->context = context;
    f->options = options;
    f->now.time = NAN;
    snow_status status = read_file(f, info, out);
    snow_release(context, f->numbers);
    snow_release(context, f->parts);
    snow_release(context, f);
    return status;
}

static bool probe_xdmf(const unsigned char *bytes, size_t size) {
    static const char tag[] = "<Xdmf";
    for (size_t i = 0; i + sizeof tag - 1 <= size && i < 1024; i++)
        if (!memcmp(bytes + i, tag, sizeof tag - 1))
            return true;
    return false;
}

const snow_format snow_format_xdmf = {
    .name = "xdmf",
    .text = "XDMF of uniform and rectilinear grids (.xdmf, .xmf)",
    .suffixes = {".xdmf", ".xmf", ".xdmf2", ".xdmf3"},
    .probe = probe_xdmf,
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_xdmf,
};
