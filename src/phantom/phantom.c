/* phantom/phantom.c - the table of built-in volumes, and how one is made.
 *
 * The first three replace the paper's test sets (section 5.2, Table 1) and have
 * their sizes and their shares of uninteresting voxels; the real ones may not
 * be distributed.  A requested size samples the same shape in the same position
 * with other voxels. */
#include "phantom/phantom.h"

#include <string.h>

static const snow_phantom *const phantoms[] = {
    &snow_phantom_cube,   &snow_phantom_head,   &snow_phantom_engine,
    &snow_phantom_shells, &snow_phantom_signal, &snow_phantom_turbulence,
};

static const size_t phantom_count = sizeof phantoms / sizeof *phantoms;

const char *snow_phantom_name(size_t index) {
    return index < phantom_count ? phantoms[index]->name : NULL;
}

const char *snow_phantom_description(size_t index) {
    return index < phantom_count ? phantoms[index]->text : NULL;
}

static snow_status refuse_name(snow_context *context, const char *name) {
    char names[256] = "";
    for (size_t i = 0; i < phantom_count; i++) {
        strncat(names, i ? ", " : "", sizeof names - strlen(names) - 1);
        strncat(names, phantoms[i]->name, sizeof names - strlen(names) - 1);
    }
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "there is no phantom '%.64s'; choose one of %s", name,
                     names);
}

/* The grid of a phantom at the requested sizes; 0 means its own. */
static snow_status lay_grid(snow_context *context, const snow_phantom *phantom,
                            const int64_t dims[3], uint64_t seed,
                            snow_phantom_grid *grid) {
    *grid = (snow_phantom_grid){.seed = seed};
    for (int axis = 0; axis < 3; axis++) {
        int64_t count = dims[axis];
        if (count < 0)
            return snow_fail(
                context, SNOW_STATUS_BAD_USAGE,
                "phantom %s: %lld voxels along %c; give at least 1",
                phantom->name, (long long)count, "xyz"[axis]);
        if (count == 0)
            count = phantom->dims[axis];
        grid->dims[axis] = count;
        grid->step[axis] = phantom->extent[axis] / (double)count;
        grid->origin[axis] = grid->step[axis] * 0.5 - phantom->extent[axis] / 2;
        if (grid->edge < 1.25 * grid->step[axis])
            grid->edge = 1.25 * grid->step[axis];
    }
    return SNOW_STATUS_OK;
}

/* Voxel centres lie half a step inside the extent, which is centred on the
 * origin at every size. */
static snow_volume_info describe_phantom(const snow_phantom *phantom,
                                         const snow_phantom_grid *grid) {
    snow_volume_info info = snow_volume_info_default("phantom");
    info.type = phantom->type;
    info.medical = phantom->medical;
    if (phantom->medical)
        strcpy(info.unit, "mm");
    for (int axis = 0; axis < 3; axis++) {
        info.dims[axis] = grid->dims[axis];
        info.matrix[axis][axis] = grid->step[axis];
        info.matrix[axis][3] = grid->origin[axis];
    }
    return info;
}

/* Row by row: whatever depends only on y and z is computed once.  Rows are made
 * as a whole; for a box narrower than the volume a part is kept. */
static snow_status fill_phantom(const snow_phantom *phantom,
                                const snow_phantom_grid *grid,
                                const snow_region *box, snow_volume *volume) {
    size_t kept = (size_t)(box->count[0]) * box->value;
    bool whole = box->count[0] == box->dims[0];
    char *row = volume->owned, *wide = NULL;
    if (!whole)
        SNOW_TRY(snow_reserve(volume->context, &wide, 0, (uint64_t)box->dims[0],
                              box->value));
    for (int64_t k = 0; k < box->count[2]; k++) {
        snow_monitor_report(volume->context->monitor, SNOW_STAGE_READ,
                            (double)k, (double)box->count[2]);
        for (int64_t j = 0; j < box->count[1]; j++, row += kept) {
            if (snow_monitor_look(volume->context->monitor, 0))
                break;
            phantom->row(grid, box->first[1] + j, box->first[2] + k,
                         whole ? row : wide);
            if (!whole)
                memcpy(row, wide + (size_t)box->first[0] * box->value, kept);
        }
    }
    snow_release(volume->context, wide);
    return snow_monitor_status(volume->context->monitor);
}

/* A size that is too large is a usage error, not one of a file. */
snow_status snow_phantom_make(snow_context *context, const char *name,
                              const snow_volume_options *options, uint64_t seed,
                              snow_volume_info *info, snow_volume **out) {
    size_t number = 0;
    while (number < phantom_count && strcmp(name, phantoms[number]->name) != 0)
        number++;
    if (number == phantom_count)
        return refuse_name(context, name);
    const snow_phantom *phantom = phantoms[number];
    snow_phantom_grid grid;
    SNOW_TRY(lay_grid(context, phantom, options->dims, seed, &grid));
    snow_volume_info given = describe_phantom(phantom, &grid);
    snow_region box;
    snow_volume *volume = NULL;
    snow_status status = snow_region_lay_out(context, options, &given, &box);
    if (status == SNOW_STATUS_OK && out)
        status = snow_volume_new(context, &given, &volume);
    if (status == SNOW_STATUS_OK && out)
        status = fill_phantom(phantom, &grid, &box, volume);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return snow_fail_within(
            context,
            status == SNOW_STATUS_BAD_INPUT ? SNOW_STATUS_BAD_USAGE : status,
            "phantom %s", phantom->name);
    }
    *info = given;
    if (out)
        *out = volume;
    return SNOW_STATUS_OK;
}

snow_status snow_volume_open_phantom(snow_context *context, const char *name,
                                     const int64_t dims[3], uint64_t seed,
                                     snow_volume **out) {
    snow_volume_options options = {0};
    snow_volume_info info;
    snow_monitor monitor;
    if (dims)
        memcpy(options.dims, dims, sizeof options.dims);
    snow_monitor_begin_reading(context, &monitor);
    return snow_monitor_end(
        &monitor, snow_phantom_make(context, name, &options, seed, &info, out));
}
