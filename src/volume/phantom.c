/* volume/phantom.c - the built-in volumes: their table, and how one is made.
 *
 * The first three stand in for the paper's test sets (section 5.2, Table 1) and
 * have their sizes and their shares of uninteresting voxels; the real ones may
 * not be handed on.  A size that is asked for samples the same shape in the
 * same place with other voxels. */
#include "volume/phantom.h"

#include <string.h>

static const snow_phantom *const phantoms[] = {
    &snow_phantom_cube,   &snow_phantom_head,   &snow_phantom_engine,
    &snow_phantom_shells, &snow_phantom_signal, &snow_phantom_turbulence,
};

static const size_t phantom_count = sizeof phantoms / sizeof *phantoms;

/* One product and one sum, so that all machines round alike. */
double snow_phantom_place(const snow_phantom_grid *grid, int axis,
                          int64_t index) {
    return grid->origin[axis] + grid->step[axis] * (double)index;
}

/* To the nearest, halves up; noise may reach past either end. */
uint8_t snow_phantom_byte(double value) {
    if (value <= 0)
        return 0;
    return value >= 255 ? 255 : (uint8_t)(value + 0.5);
}

const char *snow_phantom_name(size_t index) {
    return index < phantom_count ? phantoms[index]->name : NULL;
}

const char *snow_phantom_text(size_t index) {
    return index < phantom_count ? phantoms[index]->text : NULL;
}

static const snow_phantom *find(const char *name) {
    for (size_t i = 0; i < phantom_count; i++)
        if (strcmp(name, phantoms[i]->name) == 0)
            return phantoms[i];
    return NULL;
}

static snow_status refuse_name(snow_context *context, const char *name) {
    char names[256] = "";
    for (size_t i = 0; i < phantom_count; i++) {
        strncat(names, i ? ", " : "", sizeof names - strlen(names) - 1);
        strncat(names, phantoms[i]->name, sizeof names - strlen(names) - 1);
    }
    return snow_fail(context, SNOW_BAD_USAGE,
                     "there is no phantom '%.64s'; take one of %s", name,
                     names);
}

/* The grid of a phantom at the sizes asked for, 0 for its own. */
static snow_status lay_grid(snow_context *context, const snow_phantom *phantom,
                            const int64_t dims[3], uint64_t seed,
                            snow_phantom_grid *grid) {
    *grid = (snow_phantom_grid){.seed = seed};
    for (int axis = 0; axis < 3; axis++) {
        int64_t count = dims[axis];
        if (count < 0)
            return snow_fail(
                context, SNOW_BAD_USAGE,
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
    return SNOW_OK;
}

/* Voxel centres lie half a step inside the extent, which is centred on the
 * origin at every size. */
static snow_volume_info describe(const snow_phantom *phantom,
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

/* Row by row: what the row's y and z decide is decided once.  Rows are made
 * whole, and of a box narrower than the volume a part is kept. */
static snow_status fill(const snow_phantom *phantom,
                        const snow_phantom_grid *grid, const snow_window *box,
                        snow_volume *volume) {
    size_t kept = (size_t)(box->count[0]) * box->value;
    bool whole = box->count[0] == box->dims[0];
    char *row = volume->owned, *wide = NULL;
    if (!whole) {
        wide = snow_allocate_array(volume->context, (uint64_t)box->dims[0],
                                   box->value);
        if (!wide)
            return SNOW_NO_MEMORY;
    }
    for (int64_t k = 0; k < box->count[2]; k++)
        for (int64_t j = 0; j < box->count[1]; j++, row += kept) {
            phantom->row(grid, box->first[1] + j, box->first[2] + k,
                         whole ? row : wide);
            if (!whole)
                memcpy(row, wide + (size_t)box->first[0] * box->value, kept);
        }
    snow_release(volume->context, wide);
    return SNOW_OK;
}

/* A size that is too large is the caller's wish, no file's fault: usage. */
snow_status snow_phantom_make(snow_context *context, const char *name,
                              const snow_volume_options *options, uint64_t seed,
                              snow_volume_info *info, snow_volume **out) {
    const snow_phantom *phantom = find(name);
    if (!phantom)
        return refuse_name(context, name);
    snow_phantom_grid grid;
    SNOW_TRY(lay_grid(context, phantom, options->dims, seed, &grid));
    snow_volume_info told = describe(phantom, &grid);
    snow_window box;
    snow_volume *volume = NULL;
    snow_status status = snow_window_lay(context, options, &told, &box);
    if (status == SNOW_OK && out)
        status = snow_volume_new(context, &told, &volume);
    if (status == SNOW_OK && out)
        status = fill(phantom, &grid, &box, volume);
    if (status != SNOW_OK) {
        snow_volume_close(volume);
        return snow_fail_within(
            context, status == SNOW_BAD_INPUT ? SNOW_BAD_USAGE : status,
            "phantom %s", phantom->name);
    }
    *info = told;
    if (out)
        *out = volume;
    return SNOW_OK;
}

snow_status snow_volume_phantom(snow_context *context, const char *name,
                                const int64_t dims[3], uint64_t seed,
                                snow_volume **out) {
    snow_volume_options options = {0};
    snow_volume_info info;
    if (dims)
        memcpy(options.dims, dims, sizeof options.dims);
    return snow_phantom_make(context, name, &options, seed, &info, out);
}
