/* slice_find.c - which slices of a volume are drawn, and how they lie. */
#include "commands/world.h"
#include "movie/movie_encoder.h"
#include "movie/movie_names.h"
#include "picture/annotations.h"
#include "run/log.h"
#include "slice/slice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Degrees between a slice and the plane it stands for that are worth a note. */
#define OBLIQUE 1.0

/* A movie of more frames is a mistake. */
#define FRAMES_MOST 1000000

const char *slice_axis_name(const slice_work *w) {
    return w->opts.axis ? w->opts.axis : "axial";
}

const char *slice_unit(const slice_work *w) {
    return world_unit(&w->whole, w->world);
}

double slice_position(const slice_work *w, double index) {
    const snow_volume_info *info = &w->whole;
    double at = info->matrix[w->world][3];
    for (int i = 0; i < 3; i++)
        at += info->matrix[w->world][i] *
              (i == w->axis ? index : ((double)info->dims[i] - 1) / 2);
    return at / world_length(info, w->world) + 0.0; /* not -0 */
}

/* --- what is asked -------------------------------------------------------- */

static bool has_range(const options *opts) {
    return opts->at && strchr(opts->at, ':');
}

static int choose_grid(slice_work *w) {
    char rest;
    int *grid = w->grid;
    w->kind = SLICE_GRID;
    if (w->opts.at && !has_range(&w->opts))
        return fail_usage("--at: '%s' is one slice; with --grid give a range "
                          "A:B, or none",
                          w->opts.at);
    return sscanf(w->opts.grid, "%dx%d%c", &grid[0], &grid[1], &rest) == 2 &&
                   grid[0] > 0 && grid[1] > 0 && grid[0] <= 100 &&
                   grid[1] <= 100
               ? CONTINUE
               : fail_usage("--grid: '%s' is no grid; give COLUMNSxROWS of 1 "
                            "to 100, such as 5x4",
                            w->opts.grid);
}

/* WebP is a picture, or a movie where several slices are asked for. */
int slice_choose_kind(slice_work *w) {
    const options *opts = &w->opts;
    const movie_format *movie = movie_format_of(opts->output);
    const bool many = has_range(opts) || options_given(opts, "frames");
    if (opts->grid && opts->ortho)
        return fail_usage("--grid: conflicts with --ortho; give only one of "
                          "them");
    if (opts->ortho && opts->axis)
        return fail_usage("--axis: --ortho has all three; remove it");
    if (opts->grid)
        return choose_grid(w);
    w->kind = opts->ortho                           ? SLICE_ORTHO
              : names_are_meant(opts->output)       ? SLICE_FRAMES
              : movie && (movie->arguments || many) ? SLICE_FRAMES
                                                    : SLICE_ONE;
    if (w->kind != SLICE_FRAMES && (opts->resume || options_given(opts, "fps")))
        return fail_usage("--%s: is of many pictures; number the files, as in "
                          "s_%%03d.png, or name a movie (.mp4)",
                          opts->resume ? "resume" : "fps");
    if (w->kind == SLICE_ONE && many)
        return fail_usage("%s: holds one slice; number the files, as in "
                          "s_%%03d.png, name a movie (.mp4), or add --grid CxR",
                          opts->output);
    return CONTINUE;
}

/* --- one place ------------------------------------------------------------ */

static int refuse_place(const slice_work *w, const char *at) {
    const char *unit = slice_unit(w);
    const double last = (double)w->whole.dims[w->axis] - 1;
    return fail_usage("--at: '%s' is no slice across %s: must be 0 to %g, "
                      "or a position from %g%s to %g%s",
                      at, slice_axis_name(w), last, slice_position(w, 0), unit,
                      slice_position(w, last), unit);
}

/* A number, or a position with the unit of the world behind it, in numbers of
 * slices; NaN: neither.  `length` is a distance. */
static double read_place(const slice_work *w, const char *text, bool length,
                         bool *placed) {
    char *end = NULL;
    double index = strtod(text, &end);
    const double ratio = end > text ? world_ratio(&w->whole, w->world, end) : 0;
    *placed = ratio > 0;
    if (*placed)
        return (index * ratio - (length ? 0 : slice_position(w, 0))) *
               world_length(&w->whole, w->world) /
               w->whole.matrix[w->world][w->axis];
    return end > text && !*end ? index : NAN;
}

static int find_one(const slice_work *w, int64_t *out) {
    const char *at = w->opts.at;
    const double last = (double)w->whole.dims[w->axis] - 1;
    bool placed = false;
    double index =
        at ? read_place(w, at, false, &placed) : floor((last + 1) / 2);
    if (placed)
        index = rint(index);
    if (!(index >= 0 && index <= last) || index < floor(index) ||
        index > floor(index))
        return refuse_place(w, at);
    *out = (int64_t)index;
    return CONTINUE;
}

/* --- A:B:STEP ------------------------------------------------------------- */

/* The three parts, in numbers of slices; B is one past the last, and without a
 * step the way leads from A to B. */
static bool read_range(const slice_work *w, double out[3]) {
    const double all = (double)w->whole.dims[w->axis];
    const char *at = w->opts.at ? w->opts.at : ":";
    bool given[3] = {false}, placed[3] = {false};
    for (int n = 0; n < 3 && at; n++) {
        char part[64];
        const size_t length = strcspn(at, ":");
        snprintf(part, sizeof part, "%.*s", (int)length, at);
        given[n] = length > 0;
        out[n] = given[n] ? read_place(w, part, n == 2, &placed[n]) : 0;
        if (!isfinite(out[n]) || length >= sizeof part)
            return false;
        if (given[n] && !placed[n] && n < 2 && out[n] < 0)
            out[n] += all; /* from the end */
        at = at[length] ? at + length + 1 : NULL;
    }
    if (!given[2])
        out[2] = given[0] && given[1] && out[1] < out[0] ? -1 : 1;
    const bool back = out[2] < 0;
    if (!given[0])
        out[0] = back ? all - 1 : 0;
    if (!given[1])
        out[1] = back ? -1 : all;
    return !at && fabs(out[2]) > 0;
}

/* The slices of the range; positions mean the nearest ones. */
static int list_range(const slice_work *w, int64_t **list, int64_t *count) {
    const double last = (double)w->whole.dims[w->axis] - 1;
    double range[3] = {0, 0, 1};
    if (!read_range(w, range))
        return fail_usage("--at: '%s' is no range of slices; give A:B or "
                          "A:B:STEP, from A up to, not including, B, as "
                          "numbers from 0 or positions%s%s",
                          w->opts.at, *slice_unit(w) ? " in " : "",
                          slice_unit(w));
    const double room = (range[1] - range[0]) / range[2];
    int64_t *found =
        malloc((size_t)fmin(fmax(room, 0) + 2, FRAMES_MOST) * sizeof *found);
    if (!found)
        return fail_memory("out of memory for a list of slices; make fewer");
    *count = 0;
    for (int64_t n = 0; (double)n < room - 1e-9 && n < FRAMES_MOST; n++) {
        const double index = rint(range[0] + (double)n * range[2]);
        if (index >= 0 && index <= last)
            found[(*count)++] = (int64_t)index;
    }
    if (*count) {
        *list = found;
        return CONTINUE;
    }
    free(found);
    return refuse_place(w, w->opts.at);
}

/* Number `n` of `count` that lie evenly, each in the middle of its part. */
static int64_t spread(int64_t n, int64_t count, int64_t all) {
    return (int64_t)floor(((double)n + 0.5) * (double)all / (double)count);
}

/* All of them, or --frames of them; the first and the last are among them. */
static int list_frames(slice_work *w, int64_t **list, int64_t *count) {
    const int done = has_range(&w->opts) || !w->opts.at
                         ? list_range(w, list, count)
                         : CONTINUE;
    if (done == CONTINUE && !*list) { /* a single one */
        *list = malloc(sizeof **list);
        *count = 1;
        return *list ? find_one(w, *list) : fail_memory("out of memory");
    }
    if (done != CONTINUE || !options_given(&w->opts, "frames"))
        return done;
    const int64_t frames = w->opts.frames, all = *count;
    int64_t *made = malloc((size_t)frames * sizeof *made);
    if (!made)
        return fail_memory("out of memory for a list of slices; make fewer");
    for (int64_t n = 0; n < frames; n++)
        made[n] =
            (*list)[frames > 1 ? (int64_t)rint((double)n * (double)(all - 1) /
                                               (double)(frames - 1))
                               : all / 2];
    free(*list);
    *list = made;
    *count = frames;
    return CONTINUE;
}

/* --- where they lie ------------------------------------------------------- */

/* Of a volume that is a single slice, the cut that shows its face. */
static void choose_axis(slice_work *w) {
    static const char *const names[] = {"axial", "coronal", "sagittal"};
    const int64_t *dims = w->whole.dims;
    if (w->opts.axis || (dims[0] == 1) + (dims[1] == 1) + (dims[2] == 1) != 1)
        return;
    for (int n = 0; n < 3 && !w->opts.axis; n++) {
        snow_view view;
        int axis;
        snow_view_init(&view);
        if (!snow_slice_view(w->context, &w->whole, names[n], &view, &axis) &&
            dims[axis] == 1)
            w->opts.axis = names[n];
    }
}

/* The axis of the grid, the nearest one of the world, and how far the slice's
 * normal is from it. */
static int find_axis(slice_work *w, snow_view *view) {
    snow_view_init(view);
    view->width = (int)w->opts.size[0];
    view->height = (int)w->opts.size[1];
    choose_axis(w);
    snow_status status = snow_slice_view(w->context, &w->whole,
                                         slice_axis_name(w), view, &w->axis);
    if (status != SNOW_STATUS_OK)
        return fail_status(w->context, status);
    const double *normal = view->back;
    w->world = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) > fabs(normal[w->world]) + 1e-6)
            w->world = i;
    double angle = acos(fmin(fabs(normal[w->world]), 1)) * 180 / acos(-1);
    if (angle > OBLIQUE && strlen(slice_axis_name(w)) > 1 &&
        w->opts.verbosity >= 0)
        say("note: slices of the grid are %.0f degrees off %s: this is the "
            "nearest of them, as it is",
            angle, slice_axis_name(w));
    return CONTINUE;
}

static int make_places(slice_work *w, int64_t count) {
    w->places = calloc((size_t)count, sizeof *w->places);
    w->count = count;
    for (int64_t n = 0; n < count && w->places; n++)
        snow_slice_place_init(&w->places[n]);
    return w->places ? CONTINUE
                     : fail_memory("out of memory for a list of slices; make "
                                   "fewer");
}

/* Places of slices that each have a picture of their own. */
static int place_alone(slice_work *w, const snow_view *view,
                       const int64_t *list, int64_t count) {
    const int done = make_places(w, count);
    for (int64_t n = 0; n < count && done == CONTINUE; n++) {
        w->places[n].view = *view;
        w->places[n].axis = w->axis;
        w->places[n].index = list[n];
    }
    w->size[0] = view->width;
    w->size[1] = view->height;
    return done;
}

/* Slices that are spread over a list, of which all are shown where it has
 * fewer than there are places. */
static int place_grid(slice_work *w, const int64_t *list, int64_t count) {
    const int64_t room = (int64_t)w->grid[0] * w->grid[1];
    const int64_t shown = count < room ? count : room;
    int done = make_places(w, shown);
    for (int64_t n = 0; n < shown && done == CONTINUE; n++) {
        w->size[0] = (int)w->opts.size[0];
        w->size[1] = (int)w->opts.size[1];
        snow_status status = snow_slice_grid(
            w->context, &w->whole, slice_axis_name(w), w->grid[0], w->grid[1],
            (int)n, w->size, &w->places[n]);
        w->places[n].index = list[spread(n, shown, count)];
        if (status != SNOW_STATUS_OK)
            done = fail_status(w->context, status);
    }
    return done;
}

int slice_spread(slice_work *w) {
    int64_t ends[2], *list = NULL, count = 0;
    int done = CONTINUE;
    if (w->kind != SLICE_GRID)
        return CONTINUE;
    if (has_range(&w->opts))
        done = list_range(w, &list, &count);
    else {
        ends[0] = 0;
        ends[1] = w->whole.dims[w->axis] - 1;
        if (w->transfer && !w->in_file)
            done = check_status(
                w->context,
                snow_slice_shown(w->volume, w->transfer, w->axis, ends));
        count = ends[1] - ends[0] + 1;
        list = malloc((size_t)count * sizeof *list);
        if (!list)
            return fail_memory("out of memory for a list of slices");
        for (int64_t n = 0; n < count; n++)
            list[n] = ends[0] + n;
    }
    if (done == CONTINUE)
        done = place_grid(w, list, count);
    free(list);
    return done;
}

/* "x,y,z", with or without a unit that all have; the middle where there is
 * none. */
static int find_point(slice_work *w) {
    const snow_volume_info *info = &w->whole;
    const char *at = w->opts.at;
    double *p = w->point;
    char unit[24] = "", units[64];
    for (int row = 0; row < 3; row++) {
        p[row] = info->matrix[row][3];
        for (int i = 0; i < 3; i++)
            p[row] += info->matrix[row][i] * floor((double)info->dims[i] / 2);
        p[row] /= world_length(info, row);
    }
    if (!at)
        return CONTINUE;
    const int got = sscanf(at, "%lf,%lf,%lf%23s", &p[0], &p[1], &p[2], unit);
    bool right = got >= 3;
    for (int row = 0; row < 3; row++) {
        const double ratio = got == 4 ? world_ratio(info, row, unit) : 1;
        p[row] *= ratio;
        right = right && ratio > 0 && isfinite(p[row]);
    }
    world_units(info, units, sizeof units);
    return right ? CONTINUE
                 : fail_usage("--at: '%s' is no point; with --ortho give X,Y,Z "
                              "in%s of the world",
                              at, *units ? units : " units");
}

static int find_ortho(slice_work *w) {
    double world[3];
    int done = find_point(w);
    if (done == CONTINUE)
        done = make_places(w, 3);
    for (int n = 0; n < 3; n++)
        world[n] = w->point[n] * world_length(&w->whole, n);
    for (int n = 0; n < 3 && done == CONTINUE; n++) {
        w->size[0] = (int)w->opts.size[0];
        w->size[1] = (int)w->opts.size[1];
        snow_status status = snow_slice_ortho(w->context, &w->whole, world, n,
                                              w->size, &w->places[n]);
        if (status != SNOW_STATUS_OK)
            done = fail_usage("--at: %s", snow_context_message(w->context));
    }
    return done;
}

int slice_find(slice_work *w) {
    int64_t *list = NULL, one, count = 1;
    snow_view view;
    int done = CONTINUE;
    if (w->kind == SLICE_ORTHO)
        return find_ortho(w);
    done = find_axis(w, &view);
    if (done != CONTINUE || w->kind == SLICE_GRID)
        return done;
    if (w->kind == SLICE_FRAMES)
        done = list_frames(w, &list, &count);
    else
        done = find_one(w, &one);
    if (done == CONTINUE)
        done = place_alone(w, &view, list ? list : &one, count);
    free(list);
    return done;
}

/* Places of several slices anew, in what a strip leaves of a given width. */
static int place_beside(slice_work *w) {
    const int64_t width = w->opts.size[0];
    int done = CONTINUE;
    if (width <= 0) {
        w->size[0] = (int)rint(w->size[0] / (1 - w->strip));
        return CONTINUE;
    }
    w->opts.size[0] = (int64_t)rint((double)width * (1 - w->strip));
    free(w->places);
    w->places = NULL;
    done = w->kind == SLICE_GRID ? slice_spread(w) : find_ortho(w);
    w->opts.size[0] = width;
    w->size[0] = (int)width;
    return done;
}

int slice_leave_strip(slice_work *w) {
    w->strip = annotations_strip(
        &(picture_annotations){&w->opts,
                               w->whole,
                               slice_whole_view(w),
                               w->transfer,
                               {0, 0},
                               &w->channels,
                               layers_legend(&w->layers, false),
                               .measures = NULL});
    if (!(w->strip > 0))
        return CONTINUE;
    if (w->kind == SLICE_GRID || w->kind == SLICE_ORTHO)
        return place_beside(w);
    snow_view view = w->places[0].view;
    int axis;
    view.width = (int)w->opts.size[0];
    view.height = (int)w->opts.size[1];
    view.strip = w->strip;
    snow_status status = snow_slice_view(w->context, &w->whole,
                                         slice_axis_name(w), &view, &axis);
    for (int64_t n = 0; n < w->count; n++)
        w->places[n].view = view;
    w->size[0] = view.width;
    w->size[1] = view.height;
    return check_status(w->context, status);
}
