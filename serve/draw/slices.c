/* slices.c - implements slices.h by the functions of the verb slice. */
#include "draw/slices.h"
#include "commands/commands.h"
#include "draw/mixed.h"
#include "options/config.h"
#include "run/log.h"
#include "run/start.h"
#include "slice/slab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define PANES 3

static const char *const of_patient[PANES] = {"axial", "coronal", "sagittal"};
static const char *const of_grid[PANES] = {"z", "y", "x"};

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* --- where slices lie ----------------------------------------------------- */

/* The view of a slice in a picture of its own size. */
static snow_status see(drawing *d, const snow_volume_info *info,
                       const char *axis, snow_view *view, int *along) {
    snow_view_init(view);
    view->width = view->height = 0;
    return snow_slice_view(d->state.context, info, axis, view, along);
}

/* The other axis of the grid that goes most along a direction: [0, -1]. */
static json_t *grid_axis(const snow_volume_info *info, int along,
                         const double way[3]) {
    int best = 0;
    double most = 0;
    for (int k = 0; k < 3; k++) {
        const double step[3] = {info->matrix[0][k], info->matrix[1][k],
                                info->matrix[2][k]};
        double part = dot(step, way) / sqrt(dot(step, step));
        if (k == along || fabs(part) <= fabs(most))
            continue;
        most = part;
        best = k;
    }
    return json_pack("[i,i]", best, most < 0 ? -1 : 1);
}

static json_t *pane_info(drawing *d, const char *axis, int *along) {
    const snow_volume_info *info = &d->state.whole;
    snow_view view;
    if (see(d, info, axis, &view, along) != SNOW_STATUS_OK)
        return NULL;
    const double *up = view.up, *back = view.back;
    const double down[3] = {-up[0], -up[1], -up[2]};
    const double right[3] = {up[1] * back[2] - up[2] * back[1],
                             up[2] * back[0] - up[0] * back[2],
                             up[0] * back[1] - up[1] * back[0]};
    return json_pack("{s:s, s:i, s:o, s:o, s:i, s:i}", "axis", axis, "along",
                     *along, "right", grid_axis(info, *along, right), "down",
                     grid_axis(info, *along, down), "width", view.width,
                     "height", view.height);
}

/* NULL where two of them would show slices across the same axis. */
static json_t *panes_info(drawing *d, const char *const names[PANES]) {
    json_t *list = json_array();
    int along = 0, seen = 0;
    for (int i = 0; i < PANES; i++) {
        json_t *pane = pane_info(d, names[i], &along);
        if (pane)
            json_array_append_new(list, pane);
        seen |= 1 << along;
    }
    if (json_array_size(list) == PANES && seen == 7)
        return list;
    json_decref(list);
    return NULL;
}

json_t *slices_info(drawing *d) {
    json_t *list = d->state.whole.medical ? panes_info(d, of_patient) : NULL;
    return list ? list : panes_info(d, of_grid);
}

/* --- what is asked, as options of the verb slice -------------------------- */

/* Channels are mixed where the colours of the look are asked. */
static void take_channels(const drawing *d, const slice_asked *asked,
                          json_t *tree) {
    char text[1024];
    const bool mixed = mixed_text(d, text, sizeof text);
    if (d->state.whole.channels < 2 && !mixed)
        return;
    if (!mixed || !asked->colored)
        snprintf(text, sizeof text, "%lld", (long long)mixed_first(d));
    if (!json_object_get(tree, "component"))
        json_object_set_new(tree, "channel", json_string(text));
}

/* The recipe of a slice: of the data what the volume has, but no clip planes;
 * of the look its colours alone. */
static json_t *slice_tree(const drawing *d, const slice_asked *asked) {
    static const char *const unwanted[] = {"clip", "size", "background",
                                           "window", "opacity"};
    static const char *const colors[] = {"preset", "tf", "colormap", "scale"};
    json_t *tree = json_copy(d->tree);
    const char *kernel = json_string_value(json_object_get(tree, "kernel"));
    for (size_t i = 0; i < sizeof unwanted / sizeof *unwanted; i++)
        json_object_del(tree, unwanted[i]);
    if (kernel && strcmp(kernel, "box") != 0 && strncmp(kernel, "box:", 4) != 0)
        json_object_del(tree, "kernel"); /* slices have none but tent */
    else if (kernel)
        json_object_set_new(tree, "kernel", json_string("box"));
    for (size_t i = 0; i < sizeof colors / sizeof *colors; i++)
        if (!asked->colored || (i == 1 && json_object_get(tree, "preset")))
            json_object_del(tree, colors[i]);
    const char *preset = json_string_value(json_object_get(tree, "preset"));
    if (preset && strcasecmp(preset, "labels") == 0) /* which have no range */
        json_object_del(tree, "range");
    else
        json_object_set_new(tree, "range",
                            json_pack("[f,f]", asked->low, asked->high));
    json_object_set_new(tree, "no-labels", json_true());
    if (asked->slab)
        json_object_set_new(tree, "slab", json_string(asked->slab));
    take_channels(d, asked, tree);
    return tree;
}

static int slice_options(const drawing *d, json_t *tree, options *out) {
    options_init(out);
    out->operands = d->first.operands;
    out->operand_count = 1;
    out->memory = d->first.memory;
    out->output = "-";
    int done = config_take_tree(out, verb_of(VERB_SLICE), tree);
    out->mode = "slice";
    if (out->tf)
        out->loaded = d->first.loaded;
    drawing_settle_overlay(d, out);
    if (done == CONTINUE)
        done = drawing_settle_channels(out);
    return done == CONTINUE ? check_look(out) : done;
}

static snow_status open_looks(drawing *d, const options *opts,
                              snow_volume *const *volumes) {
    channel_set *c = &d->slice_channels;
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n < c->list.count && status == SNOW_STATUS_OK; n++)
        status = channels_look(NULL, opts, snow_volume_get_info(volumes[n]),
                               &c->list.picks[n], volumes[n],
                               n ? &c->looks[n] : &d->slice_look);
    return status;
}

/* Makes the look of slices anew where another is meant. */
static int restyle(drawing *d, const options *opts, const json_t *tree,
                   snow_volume *const *volumes) {
    char *key = json_dumps(tree, JSON_COMPACT | JSON_SORT_KEYS);
    if (key && d->slice_key && strcmp(key, d->slice_key) == 0) {
        free(key);
        return CONTINUE;
    }
    snow_transfer_free(d->slice_look);
    channels_close(&d->slice_channels);
    free(d->slice_key);
    d->slice_look = NULL;
    d->slice_key = key;
    d->slice_channels.list = opts->channels;
    if (!opts->channels.count)
        return open_look(d->state.context, opts, volumes[0], &d->slice_look);
    return check_status(d->state.context, open_looks(d, opts, volumes));
}

/* --- the picture ---------------------------------------------------------- */

/* Whether this process has all voxels of the volume in memory. */
static bool has_all(const drawing *d) {
    return process_ranks() == 1 && snow_volume_voxels(d->state.volume);
}

static void forget_slice(kept_slice *kept) {
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++)
        snow_volume_close(kept->volumes[n]);
    *kept = (kept_slice){.index = 0};
}

void slices_forget(drawing *d) {
    for (int i = 0; i < 3; i++)
        forget_slice(&d->kept[i]);
}

/* One channel of a slice. */
static int open_kept(drawing *d, const options *given, kept_slice *kept,
                     int n) {
    static options opts; /* large; one thread draws */
    opts = *given;
    if (opts.channels.count)
        opts.channel = opts.channels.picks[n].index;
    return kept->volumes[n] ? CONTINUE
                            : open_input(d->state.context, &opts,
                                         opts.operands[0], &kept->volumes[n]);
}

/* A volume that stays in its file, or of which ranks have parts, is opened
 * again, cropped to the slice and those of its slab.  It is kept: the picture
 * at rest and the value where slices cross need it too. */
static int open_slice(drawing *d, options *opts, int along, const slab *s,
                      int64_t *index, snow_volume *out[SNOW_CHANNELS_MAX]) {
    kept_slice *kept = &d->kept[along];
    const int count = opts->channels.count ? opts->channels.count : 1;
    const bool here = has_all(d);
    int64_t *crop = opts->crop[along];
    int done = CONTINUE;
    if (!here && (kept->index != *index || kept->half < s->half))
        forget_slice(kept);
    if (!here && !kept->volumes[0])
        kept->half = s->half;
    const slab_slices slices = slab_around(&(slab){.half = kept->half},
                                           &d->state.whole, along, *index);
    crop[0] += here ? 0 : slices.first;
    crop[1] = here ? crop[1] : crop[0] + slices.count;
    kept->index = *index;
    for (int n = 0; n < count && done == CONTINUE; n++) {
        done = here ? CONTINUE : open_kept(d, opts, kept, n);
        out[n] = here ? drawing_unclipped(d, n) : kept->volumes[n];
    }
    *index -= here ? 0 : slices.first;
    return done;
}

/* That of the picture, where it lies on the same grid and nothing cuts it. */
static int open_overlay(drawing *d, const options *opts,
                        const snow_volume *volume, const layers **out) {
    *out = &d->state.layers;
    if (has_all(d) && !drawing_is_clipped(d))
        return CONTINUE;
    *out = &d->slice_layers;
    show_warnings(opts, d->state.context, false);
    int done = layers_open(opts, d->state.context, volume, &d->slice_layers);
    show_warnings(opts, d->state.context, true);
    return done;
}

/* The slice of each channel.  The view is that of the voxels that are there,
 * since its zoom counts in their size. */
static snow_status draw_values(drawing *d, snow_volume *const *volumes,
                               const char *axis, int64_t index,
                               const snow_settings *settings,
                               snow_image **image) {
    channel_set channels = d->slice_channels;
    snow_view view;
    int along;
    snow_status status =
        see(d, snow_volume_get_info(volumes[0]), axis, &view, &along);
    if (status == SNOW_STATUS_OK)
        status = snow_slice_render(volumes[0], index, d->slice_look, &view,
                                   settings, image);
    if (status != SNOW_STATUS_OK || !channels.list.count)
        return status;
    memcpy(channels.volumes, volumes, sizeof channels.volumes);
    return channels_add_slices(&channels, d->state.context, index, &view,
                               settings, image);
}

/* A slab has the overlay of its middle. */
static int draw(drawing *d, snow_volume *const *volumes, const char *axis,
                const slab *s, int64_t index, const options *opts,
                snow_image **image) {
    const int count = d->slice_channels.list.count;
    slab_volumes made = {.volumes = {NULL}};
    const layers *overlay;
    snow_settings settings;
    snow_view view;
    int along;
    fill_settings(opts, &settings);
    settings.threads = d->state.settings.threads;
    settings.mode = SNOW_MODE_OVER; /* a slice has none */
    snow_status status =
        see(d, snow_volume_get_info(volumes[0]), axis, &view, &along);
    if (status == SNOW_STATUS_OK && s->half)
        status = slab_project(d->state.context, s, volumes, count ? count : 1,
                              along, index, &made);
    if (status == SNOW_STATUS_OK)
        status = draw_values(d, s->half ? made.volumes : volumes, axis,
                             s->half ? 0 : index, &settings, image);
    slab_free(&made);
    if (status == SNOW_STATUS_OK) {
        int done = open_overlay(d, opts, volumes[0], &overlay);
        if (done != CONTINUE)
            return done;
        status = layers_lay_slice(opts, overlay, index, &view, &settings,
                                  d->state.context, image);
    }
    return check_status(d->state.context, status);
}

static int check_slice(drawing *d, const slice_asked *asked, int *along) {
    const snow_volume_info *info = &d->state.whole;
    snow_view view;
    snow_status status = see(d, info, asked->axis, &view, along);
    if (status != SNOW_STATUS_OK)
        return fail_status(d->state.context, status);
    if (asked->index >= 0 && asked->index < info->dims[*along])
        return CONTINUE;
    return fail_usage("slice: %lld is no slice across %s: must be 0 to %lld",
                      (long long)asked->index, asked->axis,
                      (long long)info->dims[*along] - 1);
}

int slices_draw(drawing *d, const slice_asked *asked, snow_image **image,
                snow_image_options *form) {
    static options opts; /* large; one thread draws */
    snow_volume *volumes[SNOW_CHANNELS_MAX] = {NULL};
    int64_t index = asked->index;
    slab thick;
    int along;
    *image = NULL;
    int done = check_slice(d, asked, &along);
    if (done == CONTINUE)
        done = slab_read(asked->slab, &d->state.whole, along, &thick);
    if (done != CONTINUE)
        return done;
    json_t *tree = slice_tree(d, asked);
    done = slice_options(d, tree, &opts);
    if (done == CONTINUE)
        done = open_slice(d, &opts, along, &thick, &index, volumes);
    if (done == CONTINUE)
        done = restyle(d, &opts, tree, volumes);
    if (done == CONTINUE)
        done = slab_check(&thick, d->slice_look);
    if (done == CONTINUE)
        done = draw(d, volumes, asked->axis, &thick, index, &opts, image);
    if (done != CONTINUE) {
        snow_image_free(*image);
        *image = NULL;
    }
    *form = picture_form(&opts, NULL);
    json_decref(tree);
    return done;
}

char *slices_command(drawing *d, const slice_asked *asked) {
    static options opts; /* large; one thread draws */
    char *text = NULL, output[100];
    const verb_row *verb = verb_of(VERB_SLICE);
    slab thick;
    int along;
    if (check_slice(d, asked, &along) != CONTINUE ||
        slab_read(asked->slab, &d->state.whole, along, &thick) != CONTINUE)
        return NULL;
    json_t *tree = slice_tree(d, asked);
    int done = slice_options(d, tree, &opts);
    json_decref(tree);
    if (done != CONTINUE)
        return NULL;
    drawing_name_output(opts.operands[0], asked->axis, output);
    opts.output = output;
    opts.mode = "over"; /* recipes have no mode of slices */
    config_note_slice(&opts, NULL, asked->axis, asked->index);
    tree = config_tree(&opts, verb);
    if (tree)
        text = config_command(&opts, verb, tree);
    json_decref(tree);
    return text;
}

/* --- a voxel ---------------------------------------------------------------
 */

static double value_at(const snow_volume *volume, const int64_t at[3]) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    const void *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 3; i++)
        if (!voxels || at[i] < 0 || at[i] >= info->dims[i])
            return NAN;
    int64_t i = at[0] + info->dims[0] * (at[1] + info->dims[1] * at[2]);
    switch (info->type) {
#define VALUE(name, type, text)                                  \
    case SNOW_TYPE_##name:                                       \
        return info->slope * (double)((const type *)voxels)[i] + \
               info->intercept;
        SNOW_TYPE_MAP(VALUE)
#undef VALUE
    case SNOW_TYPE_NONE:
        break;
    }
    return NAN;
}

/* Of a volume that is not here: of a slice that is, else of one across z, which
 * lies together in most files. */
static double value_in_file(drawing *d, const int64_t at[3]) {
    static options opts; /* large; one thread draws */
    const slice_asked any = {.low = 0, .high = 1};
    snow_volume *volumes[SNOW_CHANNELS_MAX];
    int64_t within[3] = {at[0], at[1], at[2]};
    int along = 2, done = CONTINUE;
    for (int i = 0; i < 3; i++) {
        if (at[i] < 0 || at[i] >= d->state.whole.dims[i])
            return NAN;
        if (d->kept[i].volumes[0] && d->kept[i].index == at[i])
            along = i;
    }
    json_t *tree = slice_tree(d, &any);
    done = slice_options(d, tree, &opts);
    json_decref(tree);
    if (done == CONTINUE)
        done = open_slice(d, &opts, along, &(slab){.half = 0}, &within[along],
                          volumes);
    return done == CONTINUE ? value_at(volumes[0], within) : NAN;
}

double slices_value(drawing *d, const int64_t at[3]) {
    return has_all(d) ? value_at(drawing_unclipped(d, 0), at)
                      : value_in_file(d, at);
}
