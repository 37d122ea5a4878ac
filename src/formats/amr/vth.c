/* formats/amr/vth.c - levels of refinement of VTK, whose boxes are files of
 * image data:
 *
 *     <VTKFile type="vtkOverlappingAMR" version="1.1">
 *       <vtkOverlappingAMR origin="0 0 0" grid_description="XYZ">
 *         <Block level="0" spacing="1 1 1">
 *           <DataSet index="0" amr_box="0 7 0 7 0 7" file="a/a_0.vti"/>
 *
 * Older files are a vtkHierarchicalBoxDataSet, and lack origin and spacing.
 * Each file says where its cells are, so that only levels and files count here.
 * What a box is of its level is found by the distance from the least corner of
 * all; ratios are those of the cells' sizes. */
#include "formats/amr/amr.h"
#include "formats/index/index.h"
#include "formats/vtk/vtk.h"

#include <math.h>
#include <string.h>

/* Places may differ from the grid by this share of a cell. */
#define NEAR 0.02

typedef struct vth_file {
    snow_source *source;
    const snow_volume_options *options;
    index_list list; /* the steps are levels */
    int level;       /* of the element */
    amr_grid grid;
    snow_volume_info *places; /* of the files; `grid` counts boxes as they are
                                 listed */
    double time;
} vth_file;

static snow_status begin_element(void *user, const char *name,
                                 const char **attributes) {
    vth_file *f = user;
    const char *text;
    int64_t level;
    if (!strcmp(name, "Block")) {
        text = snow_index_attribute(attributes, "level");
        if (!text || !snow_parse_int64(text, &level) || level < 0 ||
            level >= AMR_MOST_LEVELS)
            return snow_fail(f->list.context, SNOW_STATUS_BAD_INPUT,
                             "has a Block of level \"%.40s\": must be 0 to %d",
                             text ? text : "", AMR_MOST_LEVELS - 1);
        f->level = (int)level;
    } else if (!strcmp(name, "DataSet")) {
        text = snow_index_attribute(attributes, "file");
        if (f->list.count == AMR_MOST_BOXES)
            return snow_fail(f->list.context, SNOW_STATUS_BAD_INPUT,
                             "names more than %d files", AMR_MOST_BOXES);
        if (text)
            return snow_index_add(&f->list, text, f->level, NAN);
    }
    return SNOW_STATUS_OK;
}

static snow_status fail_vth(const vth_file *f, size_t number,
                            const char *what) {
    return snow_fail(f->list.context, SNOW_STATUS_BAD_INPUT,
                     "%s %s; write the file again",
                     snow_index_name(&f->list, number), what);
}

/* Returns whether the axes are those of the world, rising. */
static bool is_straight(const snow_volume_info *info) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (i == j ? !(info->matrix[i][i] > 0)
                       : fabs(info->matrix[i][j]) > 1e-9 * info->spacing[j])
                return false;
    return true;
}

/* Warnings of the first file hold for all. */
static snow_status look_at_files(vth_file *f) {
    snow_context *context = f->list.context;
    snow_warning_fn *warning = context->warning;
    snow_volume_options whole = *f->options;
    snow_status status = SNOW_STATUS_OK;
    memset(whole.crop, 0, sizeof whole.crop);
    whole.levels = 0;
    for (size_t i = 0; i < f->list.count && status == SNOW_STATUS_OK; i++) {
        snow_volume_info *info = &f->places[i];
        status = snow_volume_open_named(f->source, snow_index_name(&f->list, i),
                                        &whole, info, NULL);
        context->warning = NULL;
        if (status == SNOW_STATUS_OK && !is_straight(info))
            status = fail_vth(f, i, "has axes that are turned");
        if (status == SNOW_STATUS_OK && info->type != f->places[0].type)
            status =
                fail_vth(f, i, "has values of another type than the first");
        if (status == SNOW_STATUS_OK)
            snow_volume_info_measure(info);
    }
    context->warning = warning;
    return status;
}

/* The first file of a level. */
static const snow_volume_info *of_level(const vth_file *f, int level,
                                        size_t *number) {
    for (size_t i = 0; i < f->list.count; i++)
        if (f->list.entries[i].step == level) {
            *number = i;
            return &f->places[i];
        }
    return NULL;
}

static snow_status find_ratios(vth_file *f) {
    for (int l = 0; l < f->grid.levels; l++) {
        size_t number, below;
        const snow_volume_info *info = of_level(f, l, &number);
        if (!info)
            return snow_fail(f->list.context, SNOW_STATUS_BAD_INPUT,
                             "has no files of level %d; write it again", l);
        for (int i = 0; i < 3; i++) {
            const snow_volume_info *coarse =
                l ? of_level(f, l - 1, &below) : info;
            const double ratio = coarse->matrix[i][i] / info->matrix[i][i];
            const bool whole = ratio >= 0.5 && ratio < 1024 &&
                               fabs(ratio - rint(ratio)) < NEAR;
            f->grid.ratio[l][i] = !l ? 1 : whole ? (int64_t)rint(ratio) : 0;
            if (!f->grid.ratio[l][i])
                return fail_vth(
                    f, number,
                    "has cells that do not divide those of the level below");
        }
    }
    return SNOW_STATUS_OK;
}

/* The grid is that of level 0: from its least corner to its greatest. */
static void span_grid(vth_file *f) {
    amr_grid *grid = &f->grid;
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t n = 0; n < f->list.count; n++) {
            const snow_volume_info *info = &f->places[n];
            const double step = info->matrix[i][i];
            const double corner = info->matrix[i][3] - step / 2;
            if (f->list.entries[n].step != 0)
                continue;
            grid->size[i] = step;
            low = fmin(low, corner);
            high = fmax(high, corner + step * (double)info->dims[i]);
        }
        grid->corner[i] = low;
        const double cells = rint((high - low) / grid->size[i]);
        grid->cells[i] = cells >= 1 && cells < 0x1p31 ? (int64_t)cells : 0;
    }
}

/* Where a file's cells are among those of its level. */
static snow_status place_box(vth_file *f, size_t number) {
    const snow_volume_info *info = &f->places[number];
    const int level = (int)f->list.entries[number].step;
    int64_t all[3], coarse[3];
    snow_box box;
    snow_amr_cells(&f->grid, level, all);
    snow_amr_cells(&f->grid, 0, coarse);
    for (int i = 0; i < 3; i++) {
        const double step =
            f->grid.size[i] * (double)coarse[i] / (double)all[i];
        const double at = (info->matrix[i][3] - f->grid.corner[i]) / step - 0.5;
        if (!(fabs(info->matrix[i][i] - step) <= 1e-3 * step))
            return fail_vth(f, number,
                            "has cells of another size than its level");
        if (!(fabs(at) < 0x1p31) || fabs(at - rint(at)) > NEAR)
            return fail_vth(f, number,
                            "lies between the cells of its level (values at "
                            "points have no levels)");
        box.first[i] = (int64_t)rint(at);
        box.count[i] = info->dims[i];
    }
    return snow_amr_add(&f->grid, level, &box);
}

/* Reads a part of a file. */
static snow_status read_box(void *user, size_t number, const snow_box *part,
                            snow_volume **out) {
    const vth_file *f = user;
    const snow_box *box = &f->grid.boxes[number].box;
    snow_context *context = f->list.context;
    snow_volume_options own = *f->options;
    snow_volume_info info;
    snow_warning_fn *warning = context->warning;
    own.levels = 0;
    for (int i = 0; i < 3; i++) {
        own.crop[i][0] = part->first[i] - box->first[i];
        own.crop[i][1] = own.crop[i][0] + part->count[i];
    }
    context->warning = NULL;
    snow_status status = snow_volume_open_named(
        f->source, snow_index_name(&f->list, number), &own, &info, out);
    context->warning = warning;
    return status;
}

static snow_status find_boxes(vth_file *f) {
    const size_t count = f->list.count;
    for (size_t i = 0; i < count; i++)
        if (f->list.entries[i].step >= f->grid.levels)
            f->grid.levels = (int)f->list.entries[i].step + 1;
    f->places = snow_allocate_array(f->list.context, count, sizeof *f->places);
    if (!f->places)
        return SNOW_STATUS_NO_MEMORY;
    SNOW_TRY(look_at_files(f));
    SNOW_TRY(find_ratios(f));
    span_grid(f);
    SNOW_TRY(snow_amr_check(&f->grid));
    for (size_t i = 0; i < count; i++)
        SNOW_TRY(place_box(f, i));
    f->grid.type = f->places[0].type;
    return SNOW_STATUS_OK;
}

static snow_status read_all(vth_file *f, snow_volume_info *info,
                            snow_volume **out) {
    const index_xml handlers = {.begin = begin_element};
    snow_context *context = f->list.context;
    SNOW_TRY(snow_index_parse(f->source, &handlers, f));
    if (!f->list.count)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "names no files; write it again");
    SNOW_TRY(find_boxes(f));
    *info = f->places[0];
    info->format = "vth";
    memset(info->matrix, 0, sizeof info->matrix);
    info->matrix[3][3] = 1;
    SNOW_TRY(snow_amr_describe(&f->grid, f->options, info));
    SNOW_TRY(snow_volume_pick_time(context, "time step", f->options, info));
    return snow_amr_read(&f->grid, f->options, info, out);
}

static snow_status read_vth(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    vth_file f = {.source = source,
                  .options = options,
                  .list = {.context = context},
                  .grid = {.context = context, .read = read_box, .user = &f}};
    snow_status status = read_all(&f, info, out);
    snow_amr_free(&f.grid);
    snow_release(context, f.places);
    snow_index_free(&f.list);
    return status;
}

static bool probe(const unsigned char *bytes, size_t size) {
    return snow_vtk_probe_xml(bytes, size, "vtkOverlappingAMR") ||
           snow_vtk_probe_xml(bytes, size, "vtkHierarchicalBoxDataSet");
}

const snow_format snow_format_vth = {
    .name = "vth",
    .text = "levels of refinement of VTK (.vth)",
    .suffixes = {".vth", ".vthb"},
    .probe = probe,
    .crops = true,
    .sets = true,
    .channels = true,
    .levels = true,
    .read = read_vth,
};
