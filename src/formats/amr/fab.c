/* formats/amr/fab.c - the values of a box of a plotfile, a FAB:
 *
 *     FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2 1)))
 *         ((0,0,0) (15,15,15) (0,0,0)) 5
 *
 * in one line, which are the bits of a number, the order of its bytes, the
 * cells with their ghosts, and the components.  Their values follow in bytes,
 * component after component, x fastest.  After AMReX_FPC.cpp and
 * AMReX_FArrayBox.cpp.
 *
 * A file that lost bytes would be read into the next FAB: so that must begin
 * behind the end of this one, and values lie between the extremes that Cell_H
 * has. */
#include "formats/amr/amr.h"

#include <math.h>
#include <string.h>

#define LINE_BYTES 512

/* Numbers in the line: two lists with their lengths, a box, the components. */
#define MOST_NUMBERS 32

typedef struct fab {
    snow_type type;
    bool big_endian;
    snow_box box; /* of values, from the corner of the level */
    int64_t components;
    int64_t header; /* bytes */
} fab;

static snow_status fail_fab(snow_source *source, const char *line) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "\"%.120s\" is not the header of values that its Cell_H "
                     "promises here; copy or write the files again",
                     line);
}

bool snow_plotfile_take_type(const int64_t *numbers, int count, int *used,
                             snow_type *type, bool *big_endian) {
    static const int64_t singles[] = {8, 32, 8, 23, 0, 1, 9, 0, 127};
    static const int64_t doubles[] = {8, 64, 11, 52, 0, 1, 12, 0, 1023};
    if (count < 10)
        return false;
    if (!memcmp(numbers, singles, sizeof singles))
        *type = SNOW_TYPE_FLOAT32;
    else if (!memcmp(numbers, doubles, sizeof doubles))
        *type = SNOW_TYPE_FLOAT64;
    else
        return false;
    const int bytes = (int)snow_type_size(*type);
    const int64_t *order = numbers + 10;
    *used = 10 + bytes;
    if (numbers[9] != bytes || count < *used)
        return false;
    *big_endian = order[0] == 1;
    for (int i = 0; i < bytes; i++)
        if (order[i] != (*big_endian ? i + 1 : bytes - i))
            return false;
    return true;
}

static bool take_box(const amr_plotfile *file, int level,
                     const int64_t *numbers, fab *out) {
    const int axes = file->axes;
    out->box = (snow_box){{0, 0, 0}, {1, 1, 1}};
    for (int i = 0; i < axes; i++) {
        const int64_t low = numbers[i], high = numbers[axes + i];
        if (low < -INT32_MAX || low > high || high > INT32_MAX)
            return false;
        out->box.first[i] = low - file->first[level][i];
        out->box.count[i] = high - low + 1;
    }
    out->components = numbers[3 * axes];
    return out->components == file->level[level].components;
}

/* Returns whether the box that the level's list has, and its ghosts, are
 * there. */
static bool holds_box(const amr_plotfile *file, size_t number,
                      const fab *values) {
    const amr_box *listed = &file->grid.boxes[number];
    const int64_t *ghosts = file->ghosts[listed->level];
    for (int i = 0; i < 3; i++)
        if (values->box.first[i] != listed->box.first[i] - ghosts[i] ||
            values->box.count[i] != listed->box.count[i] + 2 * ghosts[i])
            return false;
    return true;
}

/* Without headers they are what Cell_H says. */
static fab bare_fab(const amr_plotfile *file, size_t number) {
    const amr_box *listed = &file->grid.boxes[number];
    const amr_fabs *level = &file->level[listed->level];
    fab out = {.type = level->type,
               .big_endian = level->big_endian,
               .box = listed->box,
               .components = level->components};
    for (int i = 0; i < 3; i++) {
        const int64_t ghosts = file->ghosts[listed->level][i];
        out.box.first[i] -= ghosts;
        out.box.count[i] += 2 * ghosts;
    }
    return out;
}

/* Leaves the source at the first component. */
static snow_status read_header(const amr_plotfile *file, size_t number,
                               snow_source *source, fab *out) {
    const int level = file->grid.boxes[number].level;
    char line[LINE_BYTES] = "";
    int64_t numbers[MOST_NUMBERS];
    bool got;
    int used;
    snow_source_plan(source, 0);
    SNOW_TRY(snow_source_skip(source, (uint64_t)file->fabs[number].offset,
                              "the values of a box"));
    *out = bare_fab(file, number);
    if (file->level[level].bare)
        return SNOW_STATUS_OK;
    snow_source_plan(source, LINE_BYTES);
    SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
    if (!got || strncmp(line, "FAB", 3) != 0)
        return fail_fab(source, line);
    out->header = (int64_t)strlen(line) + 1;
    int count = snow_amr_integers(line + 3, numbers, MOST_NUMBERS);
    if (!snow_plotfile_take_type(numbers, count, &used, &out->type,
                                 &out->big_endian) ||
        count != used + 3 * file->axes + 1 ||
        !take_box(file, level, numbers + used, out) ||
        !holds_box(file, number, out))
        return fail_fab(source, line);
    return SNOW_STATUS_OK;
}

static snow_status open_box(const amr_plotfile *file, size_t number,
                            snow_source **out) {
    return file->open(file->user, file->names + file->fabs[number].name, out);
}

/* Closes the file of a box; its name is in the message of a failure. */
static snow_status close_box(snow_source *source, snow_status status) {
    if (status != SNOW_STATUS_OK)
        snow_fail_in_file(snow_source_context(source), status,
                          snow_source_name(source));
    snow_source_close(source);
    return status;
}

snow_status snow_plotfile_type(const amr_plotfile *file, size_t number,
                               snow_type *out) {
    snow_source *source;
    fab values;
    SNOW_TRY(open_box(file, number, &source));
    snow_status status = read_header(file, number, source, &values);
    if (status == SNOW_STATUS_OK)
        *out = values.type;
    return close_box(source, status);
}

/* All components are there, before the next FAB begins. */
static snow_status check_end(const amr_plotfile *file, size_t number,
                             snow_source *source, const fab *values,
                             uint64_t each) {
    const amr_fab *at = &file->fabs[number];
    uint64_t all;
    if (!snow_mul_u64(each, (uint64_t)values->components, &all))
        all = UINT64_MAX;
    SNOW_TRY(snow_source_expect(source, all, "the values of a box"));
    if (all <= INT64_MAX &&
        (int64_t)all <= at->end - at->offset - values->header)
        return SNOW_STATUS_OK;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "the values of the box at byte %lld need %llu bytes, and "
                     "the next box begins before; it is damaged, copy it "
                     "again",
                     (long long)at->offset, (unsigned long long)all);
}

/* Reads the cells from the first component on. */
static snow_status read_cells(const amr_plotfile *file, size_t number,
                              snow_source *source, const fab *values,
                              const snow_box *part, snow_volume **out) {
    snow_context *context = file->context;
    snow_volume_info info = snow_volume_info_default("amrex");
    snow_volume_options options = {.size = sizeof options};
    snow_region region;
    uint64_t skip;
    info.type = values->type;
    for (int i = 0; i < 3; i++) {
        info.dims[i] = values->box.count[i];
        options.crop[i][0] = part->first[i] - values->box.first[i];
        options.crop[i][1] = options.crop[i][0] + part->count[i];
    }
    SNOW_TRY(snow_region_lay_out(context, &options, &info, &region));
    if (!snow_mul_u64(region.all, (uint64_t)file->component, &skip))
        return fail_fab(source, "too many components");
    SNOW_TRY(check_end(file, number, source, values, region.all));
    snow_source_plan(source, 0);
    SNOW_TRY(snow_source_skip(source, skip, "the values of a box"));
    const snow_file_part whole = {&region, 0, region.all};
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(context, &info, &volume));
    snow_status status = snow_file_part_read(source, &whole, volume->owned);
    if (status == SNOW_STATUS_OK)
        snow_volume_order_bytes(volume, values->big_endian);
    return snow_volume_give(status, volume, out);
}

/* A value beyond the extremes, which are rounded as the values are; NaN where
 * all lie between, or one is NaN and the extremes mean nothing. */
static double find_beyond(const amr_fab *listed, const snow_volume *cells) {
    const bool narrow = cells->info.type == SNOW_TYPE_FLOAT32;
    const double largest = fmax(fabs(listed->low), fabs(listed->high));
    const double slack = (narrow ? 1e-6 : 1e-14) * largest;
    const double low = listed->low - slack, high = listed->high + slack;
    const int64_t *dims = cells->info.dims, count = dims[0] * dims[1] * dims[2];
    double beyond = NAN;
    for (int64_t i = 0; i < count; i++) {
        const double value = narrow ? (double)((const float *)cells->owned)[i]
                                    : ((const double *)cells->owned)[i];
        if (isnan(value))
            return NAN;
        if (value < low || value > high)
            beyond = value;
    }
    return beyond;
}

/* A NaN may be elsewhere in the box, which is read whole before it is
 * refused. */
static snow_status check_extremes(amr_plotfile *file, size_t number,
                                  snow_source *source, const snow_box *part,
                                  const snow_volume *cells) {
    const snow_box *all = &file->grid.boxes[number].box;
    const amr_fab *listed = &file->fabs[number];
    snow_volume *whole;
    if (!isfinite(listed->low) || !isfinite(listed->high))
        return SNOW_STATUS_OK;
    const double beyond = find_beyond(listed, cells);
    if (isnan(beyond))
        return SNOW_STATUS_OK;
    if (snow_box_voxels(part) < snow_box_voxels(all)) {
        SNOW_TRY(snow_plotfile_read_box(file, number, all, &whole));
        snow_volume_close(whole);
        return SNOW_STATUS_OK;
    }
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "the box at byte %lld has the value %g where its Cell_H "
                     "has %g to %g; it is damaged, copy it again",
                     (long long)listed->offset, beyond, listed->low,
                     listed->high);
}

snow_status snow_plotfile_read_box(void *user, size_t number,
                                   const snow_box *part, snow_volume **out) {
    amr_plotfile *file = user;
    snow_source *source;
    snow_volume *cells = NULL;
    fab values;
    SNOW_TRY(open_box(file, number, &source));
    snow_status status = read_header(file, number, source, &values);
    if (status == SNOW_STATUS_OK)
        status = read_cells(file, number, source, &values, part, &cells);
    if (status == SNOW_STATUS_OK)
        status = check_extremes(file, number, source, part, cells);
    status = snow_volume_give(status, cells, out);
    return close_box(source, status);
}
