/* formats/amr/plotfile.c - plotfiles of AMReX: a folder, in which the text file
 * Header has
 *
 *     HyperCLaw-V1.1                       or NavierStokes-V1.1
 *     2                                    components, and their names
 *     density
 *     temperature
 *     3                                    axes
 *     0.25                                 time
 *     1                                    the finest level
 *     0 0 0                                the grid's corner, and the opposite
 *     1 1 1
 *     2                                    ratio of each level to the next
 *     ((0,0,0) (31,31,31) (0,0,0)) ((0,0,0) (63,63,63) (0,0,0))
 *     100 200                              steps of each level
 *     0.03125 0.03125 0.03125              cells, level by level
 *     0.015625 0.015625 0.015625
 *     0                                    coordinates: 0 for x, y and z
 *     0
 *     0 8 0.25                             level, boxes, time
 *     100
 *     0 0.5                                each box along x, y and z
 *     ...
 *     Level_0/Cell                         the level's files
 *
 * Ratios are those of the levels' cells, which may differ from axis to axis.
 * After AMReX_PlotFileUtil.cpp. */
#include "formats/amr/amr.h"
#include "formats/array.h"
#include "io/folder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LINE_BYTES 8192

/* The header while it is read. */
typedef struct reading {
    amr_plotfile file;
    snow_source *source;
    const snow_volume_options *options;
    double low[3], high[3];
    char list[256]; /* names of components, for messages */
    snow_channel named[SNOW_CHANNELS_MAX];
    char line[LINE_BYTES];
} reading;

static snow_status fail_plotfile(const reading *r, const char *what) {
    return snow_amr_refuse(r->file.context, r->line, what);
}

static snow_status next_line(reading *r, const char *what) {
    return snow_amr_line(r->source, r->line, LINE_BYTES, what);
}

/* Reads a line that begins with one whole number of a range. */
static snow_status take_number(reading *r, const char *what, int64_t least,
                               int64_t most, int64_t *out) {
    double numbers[4];
    SNOW_TRY(next_line(r, what));
    int count = snow_amr_numbers(r->line, numbers, 4);
    if (count < 1 || !(numbers[0] >= (double)least) ||
        !(numbers[0] <= (double)most) || numbers[0] != rint(numbers[0]))
        return fail_plotfile(r, what);
    *out = (int64_t)numbers[0];
    return SNOW_STATUS_OK;
}

/* Reads a line of one number for each axis. */
static snow_status take_point(reading *r, const char *what, double out[3]) {
    SNOW_TRY(next_line(r, what));
    if (snow_amr_numbers(r->line, out, 3) != r->file.axes)
        return fail_plotfile(r, what);
    for (int i = 0; i < r->file.axes; i++)
        if (!isfinite(out[i]))
            return fail_plotfile(r, what);
    return SNOW_STATUS_OK;
}

/* --- components ----------------------------------------------------------- */

static const char *wanted_name(const snow_volume_options *options) {
    int64_t number = 0;
    const char *given = options->component;
    if (options->dataset || !given || snow_parse_int64(given, &number))
        return options->dataset;
    return given;
}

/* The tool has made the letters of --component small. */
static bool is_wanted(const reading *r, const char *name, int64_t number,
                      int64_t wanted) {
    const char *asked = wanted_name(r->options);
    if (!asked)
        return number == wanted;
    return wanted < 0 && (r->options->dataset ? !strcmp(name, asked)
                                              : snow_same_name(name, asked));
}

/* The number that the options ask for; that of a name once it is found. */
static snow_status wanted_component(reading *r, int64_t *out) {
    const snow_volume_options *options = r->options;
    *out = wanted_name(options) ? -1 : options->channel;
    if (*out >= 0 && options->component)
        (void)snow_parse_int64(options->component, out);
    if (!wanted_name(options) && (*out < 0 || *out >= r->file.components))
        return snow_fail(r->file.context, SNOW_STATUS_BAD_USAGE,
                         "component %lld does not exist; the plotfile has "
                         "%lld, counted from 0",
                         (long long)*out, (long long)r->file.components);
    return SNOW_STATUS_OK;
}

static snow_status check_component(const reading *r, int64_t found) {
    const snow_volume_options *options = r->options;
    if (found < 0)
        return snow_fail(r->file.context, SNOW_STATUS_BAD_USAGE,
                         "there is no component %.100s; the plotfile has %s",
                         wanted_name(options), r->list);
    if (r->file.components > 1 && !options->dataset && !options->component &&
        !options->channel && !options->channel_given && !options->each_time)
        snow_notify(r->file.context,
                    "component %s is taken, the first of %s; --component NAME "
                    "takes another",
                    r->file.name, r->list);
    return SNOW_STATUS_OK;
}

static snow_status take_components(reading *r) {
    amr_plotfile *file = &r->file;
    int64_t wanted;
    SNOW_TRY(take_number(r, "a number of components", 1, AMR_MOST_COMPONENTS,
                         &file->components));
    SNOW_TRY(wanted_component(r, &wanted));
    for (int64_t i = 0; i < file->components; i++) {
        SNOW_TRY(next_line(r, "the names of its components"));
        snow_list_add(r->list, sizeof r->list, "%s", r->line);
        if (i < SNOW_CHANNELS_MAX)
            snow_copy_name(r->line, r->named[i].name, sizeof r->named[i].name);
        if (is_wanted(r, r->line, i, wanted)) {
            wanted = file->component = i;
            snow_copy_name(r->line, file->name, sizeof file->name);
        }
    }
    return check_component(r, wanted);
}

/* --- levels --------------------------------------------------------------- */

/* All domains span the same world, so that their cells give the ratios. */
static snow_status take_domain(reading *r, int level, const int64_t *ends) {
    amr_grid *grid = &r->file.grid;
    int64_t below[3];
    for (int i = 0; i < 3; i++)
        below[i] = 1;
    if (level)
        snow_amr_cells(grid, level - 1, below);
    for (int i = 0; i < 3; i++) {
        const bool is_there = i < r->file.axes;
        const int64_t low = is_there ? ends[i] : 0;
        const int64_t high = is_there ? ends[r->file.axes + i] : 0;
        const int64_t cells = high - low + 1;
        if (low < -INT32_MAX || high > (INT64_C(1) << 40) || cells < 1 ||
            (level && cells % below[i]))
            return snow_fail(
                r->file.context, SNOW_STATUS_BAD_INPUT,
                "its level %d has a domain of %lld cells along %c, no multiple "
                "of the %lld of the level below; write it again",
                level, (long long)cells, "xyz"[i], (long long)below[i]);
        r->file.first[level][i] = low;
        grid->ratio[level][i] = level ? cells / below[i] : 1;
        if (!level)
            grid->cells[i] = cells;
    }
    return SNOW_STATUS_OK;
}

/* The world, axis by axis; an axis that is missing has the size of x. */
static snow_status place_in_world(reading *r) {
    amr_grid *grid = &r->file.grid;
    for (int i = 0; i < 3; i++) {
        const bool is_there = i < r->file.axes;
        grid->corner[i] = is_there ? r->low[i] : 0;
        grid->size[i] = is_there
                            ? (r->high[i] - r->low[i]) / (double)grid->cells[i]
                            : grid->size[0];
        if (!(grid->size[i] > 0) || !isfinite(grid->size[i]))
            return snow_fail(
                r->file.context, SNOW_STATUS_BAD_INPUT,
                "its domain reaches from %g to %g along %c; correct its Header",
                r->low[i], r->high[i], "xyz"[i]);
    }
    return SNOW_STATUS_OK;
}

/* What follows the domains, up to the levels. */
static snow_status take_rest(reading *r) {
    int64_t kind = 0;
    SNOW_TRY(next_line(r, "the steps of its levels"));
    for (int l = 0; l < r->file.grid.levels; l++)
        SNOW_TRY(next_line(r, "the sizes of its cells"));
    SNOW_TRY(take_number(r, "a kind of coordinates", 0, 2, &kind));
    if (kind)
        snow_notify(r->file.context,
                    "its coordinates are %s; they are shown as x, y and z",
                    kind == 1 ? "cylindrical" : "spherical");
    return next_line(r, "its levels");
}

static snow_status take_front(reading *r) {
    amr_plotfile *file = &r->file;
    int64_t number = 0;
    SNOW_TRY(next_line(r, "its name"));
    SNOW_TRY(take_components(r));
    SNOW_TRY(take_number(r, "1, 2 or 3 axes", 1, 3, &number));
    file->axes = (int)number;
    SNOW_TRY(next_line(r, "a time"));
    if (snow_amr_numbers(r->line, &file->time, 1) != 1)
        return fail_plotfile(r, "a time");
    SNOW_TRY(take_number(r, "the number of its finest level", 0,
                         AMR_MOST_LEVELS - 1, &number));
    file->grid.levels = (int)number + 1;
    SNOW_TRY(take_point(r, "the low corner of its domain", r->low));
    SNOW_TRY(take_point(r, "the high corner of its domain", r->high));
    SNOW_TRY(next_line(r, "the ratios of its levels"));
    int64_t ends[9 * AMR_MOST_LEVELS];
    const int each = 3 * r->file.axes, levels = r->file.grid.levels;
    SNOW_TRY(next_line(r, "the domains of its levels"));
    int count = snow_amr_integers(r->line, ends, 9 * AMR_MOST_LEVELS);
    if (count != each * levels)
        return fail_plotfile(r, "the domains of its levels");
    for (int l = 0; l < levels; l++)
        SNOW_TRY(take_domain(r, l, ends + each * l));
    SNOW_TRY(snow_amr_check(&r->file.grid));
    SNOW_TRY(place_in_world(r));
    return take_rest(r);
}

/* A level: the place of each box in the world is not needed. */
static snow_status take_level(reading *r, int level) {
    char name[AMR_NAME_BYTES];
    int64_t values[1];
    double numbers[3];
    SNOW_TRY(next_line(r, "its levels"));
    if (snow_amr_numbers(r->line, numbers, 3) < 2 || numbers[0] != level ||
        !(numbers[1] >= 0) || !(numbers[1] <= AMR_MOST_BOXES))
        return fail_plotfile(r, "a level and its number of boxes");
    SNOW_TRY(next_line(r, "the step of a level"));
    for (int64_t i = 0; i < (int64_t)numbers[1] * r->file.axes; i++)
        SNOW_TRY(next_line(r, "the boxes of a level"));
    SNOW_TRY(next_line(r, "the files of a level"));
    if (strlen(r->line) + 3 > sizeof name ||
        snow_amr_integers(r->line, values, 1) >= 0)
        return fail_plotfile(r, "the name of a level's files");
    snprintf(name, sizeof name, "%s_H", r->line);
    return snow_plotfile_read_boxes(&r->file, level, name);
}

/* --- all of it ------------------------------------------------------------ */

static snow_status read_values(reading *r, snow_volume_info *info,
                               snow_volume **out) {
    amr_plotfile *file = &r->file;
    amr_grid *grid = &file->grid;
    size_t first = 0;
    *info = snow_volume_info_default("amrex");
    SNOW_TRY(take_front(r));
    for (int l = 0; l < grid->levels; l++)
        SNOW_TRY(take_level(r, l));
    if (!grid->count)
        return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                         "has no boxes of cells; write it again");
    SNOW_TRY(snow_plotfile_type(file, first, &grid->type));
    SNOW_TRY(snow_amr_describe(grid, r->options, info));
    SNOW_TRY(
        snow_volume_pick_time(file->context, "time step", r->options, info));
    info->time_value = file->time;
    snprintf(info->quantity, sizeof info->quantity, "%s", file->name);
    info->components = file->components;
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++)
        memcpy(info->channel[n].name, r->named[n].name,
               sizeof r->named[n].name);
    return snow_amr_read(grid, r->options, info, out);
}

snow_status snow_plotfile_read(snow_source *header, amr_open_fn *open,
                               void *user, const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(header);
    reading *r = snow_allocate_clear(context, sizeof *r);
    if (!r)
        return SNOW_STATUS_NO_MEMORY;
    r->source = header;
    r->options = options;
    r->file.context = r->file.grid.context = context;
    r->file.open = open;
    r->file.user = user;
    r->file.grid.read = snow_plotfile_read_box;
    r->file.grid.user = &r->file;
    snow_status status = read_values(r, info, out);
    snow_amr_free(&r->file.grid);
    snow_release(context, r->file.fabs);
    snow_release(context, r->file.names);
    snow_release(context, r);
    return status;
}

static snow_status open_beside(void *user, const char *name,
                               snow_source **out) {
    return snow_source_open_sibling_as_is(user, name, out);
}

static snow_status read_folder(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    return snow_plotfile_read(source, open_beside, source, options, info, out);
}

static bool probe(const unsigned char *bytes, size_t size) {
    static const char *const names[] = {"HyperCLaw-V", "NavierStokes-V"};
    for (int i = 0; i < 2; i++)
        if (size > strlen(names[i]) &&
            !memcmp(bytes, names[i], strlen(names[i])))
            return true;
    return false;
}

snow_status snow_plotfile_header(snow_context *context, const char *path,
                                 char **out) {
    unsigned char bytes[16];
    size_t got = 0, length = strlen(path) + sizeof "/Header";
    snow_source *source;
    *out = NULL;
    if (!snow_is_folder(context, path))
        return SNOW_STATUS_OK;
    char *name = snow_allocate(context, length);
    if (!name)
        return SNOW_STATUS_NO_MEMORY;
    snprintf(name, length, "%s/Header", path);
    snow_status status = SNOW_STATUS_OK;
    if (snow_is_there(context, name, strlen(name)) &&
        !snow_is_folder(context, name)) {
        status = snow_source_open(context, name, &source);
        if (status == SNOW_STATUS_OK) {
            status = snow_source_peek(source, bytes, sizeof bytes, &got);
            snow_source_close(source);
        }
    }
    /* The Header of a checkpoint is refused as a file. */
    const bool other = got > 10 && (!memcmp(bytes, "CheckPoint", 10) ||
                                    !memcmp(bytes, "Checkpoint", 10));
    if (status == SNOW_STATUS_OK && (other || probe(bytes, got)))
        *out = name;
    else
        snow_release(context, name);
    return status;
}

const snow_format snow_format_amrex = {
    .name = "amrex",
    .text = "plotfiles of AMReX, with levels of refinement (folders)",
    .suffixes = {NULL},
    .probe = probe,
    .crops = true,
    .sets = true,
    .channels = true,
    .names = true,
    .levels = true,
    .read = read_folder,
};
