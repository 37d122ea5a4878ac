/* formats/index/mosaic.c - files that lie side by side on one grid, as ranks of
 * a simulation write them:
 *
 *     |  a  |  b  |      each is placed by its own matrix; where two share
 *     |  c  |  d  |      voxels, the later one is taken
 *
 * Voxels in none of them are NaN, or 0 of integers. */
#include "base/minmax.h"
#include "formats/index/index.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Places may differ from the grid by this share of a voxel: origins are often
 * written with few digits. */
#define NEAR 0.02

typedef struct part {
    int64_t first[3], dims[3]; /* on the grid, from the first file's voxel 0 */
} part;

typedef struct mosaic {
    const index_parts *from;
    part *parts;
    int64_t first[3]; /* the whole's first voxel, counted as those of parts */
} mosaic;

static snow_status fail_mosaic(const mosaic *m, size_t index,
                               const char *what) {
    char names[2][INDEX_NAME_BYTES];
    m->from->name(m->from->user, index, names[0]);
    m->from->name(m->from->user, 0, names[1]);
    return snow_fail(m->from->context, SNOW_STATUS_BAD_INPUT,
                     "%s has %s than %s, so they are no parts of one grid; "
                     "open one of them",
                     names[0], what, names[1]);
}

/* Returns whether the voxels have the same size and direction. */
static bool is_parallel(const snow_volume_info *a, const snow_volume_info *b) {
    for (int j = 0; j < 3; j++) {
        double length = 0;
        for (int i = 0; i < 3; i++)
            length = fmax(length, fabs(a->matrix[i][j]));
        for (int i = 0; i < 3; i++)
            if (!(fabs(a->matrix[i][j] - b->matrix[i][j]) <= 1e-4 * length))
                return false;
    }
    return true;
}

/* Returns where a part's first voxel lies on the grid of the first one. */
static bool find_place(const snow_volume_info *grid,
                       const snow_volume_info *info, part *out) {
    double inverse[3][3];
    if (!snow_matrix_invert3(grid->matrix, inverse))
        return false;
    for (int i = 0; i < 3; i++) {
        double at = 0;
        for (int j = 0; j < 3; j++)
            at += inverse[i][j] * (info->matrix[j][3] - grid->matrix[j][3]);
        if (!(fabs(at) < 0x1p40) || fabs(at - rint(at)) > NEAR)
            return false;
        out->first[i] = (int64_t)rint(at);
        out->dims[i] = info->dims[i];
    }
    return true;
}

/* Inspects a file; `grid` becomes that of the first one. */
static snow_status look(const mosaic *m, size_t index,
                        const snow_volume_options *options,
                        snow_volume_info *grid) {
    snow_volume_info info;
    SNOW_TRY(m->from->open(m->from->user, index, options, &info, NULL));
    if (!index)
        *grid = info;
    if (info.type != grid->type)
        return fail_mosaic(m, index, "voxels of another type");
    if (!is_parallel(grid, &info))
        return fail_mosaic(m, index, "voxels of another size");
    if (!find_place(grid, &info, &m->parts[index]))
        return fail_mosaic(m, index, "voxels between others");
    return SNOW_STATUS_OK;
}

/* Warnings of the first file hold for all. */
static snow_status look_at_all(const mosaic *m,
                               const snow_volume_options *options,
                               snow_volume_info *grid) {
    snow_context *context = m->from->context;
    snow_warning_fn *warning = context->warning;
    snow_status status = SNOW_STATUS_OK;
    for (size_t i = 0; i < m->from->count && status == SNOW_STATUS_OK; i++) {
        status = look(m, i, options, grid);
        context->warning = NULL;
    }
    context->warning = warning;
    return status;
}

/* The box around all parts. */
static snow_status measure(mosaic *m, snow_volume_info *info) {
    int64_t end[3];
    double voxels = 0;
    for (int i = 0; i < 3; i++) {
        m->first[i] = INT64_MAX;
        end[i] = INT64_MIN;
    }
    for (size_t n = 0; n < m->from->count; n++) {
        const part *p = &m->parts[n];
        for (int i = 0; i < 3; i++) {
            m->first[i] = SNOW_MIN(m->first[i], p->first[i]);
            end[i] = SNOW_MAX(end[i], p->first[i] + p->dims[i]);
        }
        voxels += (double)p->dims[0] * (double)p->dims[1] * (double)p->dims[2];
    }
    double all = 1;
    for (int i = 0; i < 3; i++) {
        info->dims[i] = end[i] - m->first[i];
        all *= (double)info->dims[i];
        for (int j = 0; j < 3; j++)
            info->matrix[i][3] += info->matrix[i][j] * (double)m->first[j];
    }
    if (all > 64 * voxels + 0x1p20)
        return snow_fail(m->from->context, SNOW_STATUS_BAD_INPUT,
                         "its %zu parts are far apart on their grid; open one "
                         "of them",
                         m->from->count);
    if (all > voxels)
        snow_notify(m->from->context,
                    "%.0f of %.0f voxels are in none of the parts; they are %s",
                    all - voxels, all,
                    info->type >= SNOW_TYPE_FLOAT32 ? "transparent" : "0");
    return SNOW_STATUS_OK;
}

void snow_mosaic_copy(const snow_volume *from, const int64_t at[3],
                      const int64_t first[3], snow_volume *to) {
    const int64_t *wide = from->info.dims, *dims = to->info.dims;
    const size_t size = snow_type_size(to->info.type);
    int64_t low[3], high[3]; /* in `to` */
    for (int i = 0; i < 3; i++) {
        low[i] = SNOW_MAX(at[i] - first[i], 0);
        high[i] = SNOW_MIN(at[i] + wide[i] - first[i], dims[i]);
        if (low[i] >= high[i])
            return;
    }
    for (int64_t z = low[2]; z < high[2]; z++)
        for (int64_t y = low[1]; y < high[1]; y++) {
            const int64_t row =
                (z + first[2] - at[2]) * wide[1] + y + first[1] - at[1];
            memcpy((unsigned char *)to->owned +
                       (size_t)((z * dims[1] + y) * dims[0] + low[0]) * size,
                   (const unsigned char *)from->voxels +
                       (size_t)(row * wide[0] + low[0] + first[0] - at[0]) *
                           size,
                   (size_t)(high[0] - low[0]) * size);
        }
}

/* Reads what a file has of the box, which begins at `first`. */
static snow_status read_part(const mosaic *m, size_t index,
                             const snow_volume_options *options,
                             const int64_t first[3], snow_volume *to) {
    const part *p = &m->parts[index];
    snow_volume_options own = *options;
    snow_volume_info info;
    snow_volume *from;
    int64_t at[3];
    for (int i = 0; i < 3; i++) {
        int64_t low = first[i] - p->first[i];
        int64_t high = low + to->info.dims[i];
        own.crop[i][0] = low > 0 ? low : 0;
        own.crop[i][1] = high < p->dims[i] ? high : p->dims[i];
        at[i] = p->first[i] + own.crop[i][0];
        if (own.crop[i][0] >= own.crop[i][1])
            return SNOW_STATUS_OK;
    }
    SNOW_TRY(m->from->open(m->from->user, index, &own, &info, &from));
    if (info.type == to->info.type)
        snow_mosaic_copy(from, at, first, to);
    snow_volume_close(from);
    return SNOW_STATUS_OK;
}

static snow_status read_parts(const mosaic *m,
                              const snow_volume_options *options,
                              const int64_t first[3], snow_volume *to) {
    snow_context *context = m->from->context;
    snow_warning_fn *warning = context->warning;
    snow_status status = SNOW_STATUS_OK;
    context->warning = NULL;
    snow_volume_fill(to, to->info.type < SNOW_TYPE_FLOAT32 ? 0 : NAN);
    for (size_t i = 0; i < m->from->count && status == SNOW_STATUS_OK; i++) {
        snow_monitor_part whole = snow_monitor_divide(
            context->monitor, (double)i, (double)m->from->count);
        status = read_part(m, i, options, first, to);
        snow_monitor_whole(context->monitor, whole);
    }
    context->warning = warning;
    return status;
}

static snow_status read_box(mosaic *m, const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = m->from->context;
    snow_volume_options own = *options;
    snow_region box;
    snow_volume *volume;
    int64_t first[3];
    memset(own.crop, 0, sizeof own.crop);
    SNOW_TRY(look_at_all(m, &own, info));
    SNOW_TRY(measure(m, info));
    SNOW_TRY(snow_region_lay_out(context, options, info, &box));
    if (!out)
        return SNOW_STATUS_OK;
    for (int i = 0; i < 3; i++)
        first[i] = m->first[i] + box.first[i];
    SNOW_TRY(snow_volume_new(context, info, &volume));
    snow_status status = read_parts(m, &own, first, volume);
    return snow_volume_give(status, volume, out);
}

snow_status snow_mosaic_read(const index_parts *parts,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    mosaic m = {.from = parts};
    m.parts =
        snow_allocate_array(parts->context, parts->count, sizeof *m.parts);
    if (!m.parts)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = read_box(&m, options, info, out);
    snow_release(parts->context, m.parts);
    return status;
}

/* --- files of a list ------------------------------------------------------ */

typedef struct named_parts {
    snow_source *source;
    const index_list *list;
    size_t begin, count; /* the files of the list */
} named_parts;

static void name_of(void *user, size_t index, char name[INDEX_NAME_BYTES]) {
    const named_parts *n = user;
    snprintf(name, INDEX_NAME_BYTES, "%s",
             snow_index_name(n->list, n->begin + index));
}

static snow_status open_named(void *user, size_t index,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    const named_parts *n = user;
    return snow_volume_open_named(n->source,
                                  snow_index_name(n->list, n->begin + index),
                                  options, info, out);
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* A list that names one file 200,000 times would open it as often. */
static snow_status check_names(const named_parts *n) {
    snow_context *context = n->list->context;
    const char **names = snow_allocate_array(context, n->count, sizeof *names);
    snow_status status = SNOW_STATUS_OK;
    if (!names)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < n->count; i++)
        names[i] = snow_index_name(n->list, n->begin + i);
    qsort(names, n->count, sizeof *names, by_name);
    for (size_t i = 1; i < n->count && status == SNOW_STATUS_OK; i++)
        if (!strcmp(names[i], names[i - 1]))
            status = snow_fail(context, SNOW_STATUS_BAD_INPUT,
                               "names %s more than once, but each part of a "
                               "grid has a file of its own; write the list "
                               "again",
                               names[i]);
    snow_release(context, names);
    return status;
}

snow_status snow_mosaic_read_named(snow_source *source, const index_list *list,
                                   size_t first, size_t end,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out) {
    named_parts named = {source, list, first, end - first};
    const index_parts parts = {list->context, named.count, &named, name_of,
                               open_named};
    SNOW_TRY(check_names(&named));
    return snow_mosaic_read(&parts, options, info, out);
}
