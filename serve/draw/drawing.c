/* drawing.c - implements drawing.h over the tool's render_state. */
#include "draw/drawing.h"
#include "commands/commands.h"
#include "commands/first.h"
#include "draw/kept.h"
#include "draw/mixed.h"
#include "draw/ranks.h"
#include "draw/slices.h"
#include "options/config.h"
#include "picture/annotations.h"
#include "run/log.h"

#include <snowglass/ranks.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a volume is opened by, and what a look is made of besides. */
static const char *const data_keys[] = {"crop", "component", "labels", "clip",
                                        "time", "z-scale",   "mask",   NULL};
static const char *const overlay_keys[] = {"overlay", "labels", "time", NULL};
static const char *const overlay_look_keys[] = {"overlay-look", NULL};
static const char *const look_keys[] = {
    "preset", "colormap", "scale", "opacity", "gradient-opacity",
    "range",  "window",   "mode",  "channel", NULL};

/* A turn is framed from these angles on. */
#define TURN_SIDES 4

/* --- the recipe as options --------------------------------------------------
 */

void drawing_settle_overlay(const drawing *d, options *opts) {
    const bool on = opts->overlay;
    opts->overlay_picks = d->first.overlay_picks;
    if (on)
        return;
    opts->overlay = d->first.overlay;
    layers_leave_out(opts);
}

int drawing_settle_channels(options *opts) {
    int done = settle_channels(opts, true);
    opts->mixes = true; /* the page lists the others */
    if (opts->channels.count) {
        opts->tf = NULL; /* which is of one volume */
        opts->loaded = NULL;
    }
    if (opts->channels.count && channels_hinder(opts))
        opts->channels.count = 0;
    return done;
}

/* A preset that a page chose replaces the file of --tf. */
static int make_options(drawing *d, const json_t *given, options *out) {
    json_t *recipe = json_copy((json_t *)given);
    if (json_object_get(recipe, "preset"))
        json_object_del(recipe, "tf");
    options_init(out);
    out->operands = d->first.operands;
    out->operand_count = 1;
    out->memory = d->first.memory;
    out->progress = "never";
    out->output = "-"; /* a picture of levels */
    int done = config_take_tree(out, verb_of(VERB_RENDER), recipe);
    json_decref(recipe);
    if (out->tf)
        out->loaded = d->first.loaded;
    drawing_settle_overlay(d, out);
    if (done == CONTINUE)
        done = drawing_settle_channels(out);
    if (done == CONTINUE && d->state.volume)
        first_take(out, &d->state.whole);
    else if (done == CONTINUE)
        first_settle(out);
    return done == CONTINUE ? check_settings(out) : done;
}

/* What stays the same while points of opacity are dragged; NULL: there are
 * none. */
static char *color_key_of(const json_t *recipe) {
    json_t *without = json_copy((json_t *)recipe);
    bool dragged = json_object_del(without, "opacity") == 0;
    char *text = dragged ? kept_key_of(without, look_keys) : NULL;
    json_decref(without);
    return text;
}

/* What stays the same while a range is dragged, over which the points of the
 * look are spread; NULL: there is none, or some points stay at their values. */
static char *spread_key_of(const json_t *recipe) {
    static const char *const ends[] = {"range", "window"};
    const char *map = json_string_value(json_object_get(recipe, "colormap"));
    const bool stay =
        json_object_get(recipe, "opacity") || (map && strchr(map, ':'));
    json_t *without = json_copy((json_t *)recipe);
    bool dragged = false;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        dragged |= json_object_del(without, ends[i]) == 0;
    char *text = dragged && !stay ? kept_key_of(without, look_keys) : NULL;
    json_decref(without);
    return text;
}

/* --- volume, look, view ------------------------------------------------------
 */

static int reopen(drawing *d) {
    render_state *s = &d->state;
    snow_transfer_free(s->transfer);
    s->transfer = NULL;
    s->framed = false;
    mixed_forget(d);
    channels_close(&s->channels);
    s->channels.chosen = false;
    int done = render_state_open(s, d->opts.operands[0], d->opts.time);
    d->look_is_new = d->volume_is_new = true;
    d->look_is_quick = false;
    return done == CONTINUE ? mixed_note(d) : done;
}

snow_status drawing_new_transfer(drawing *d, const snow_look *look,
                                 snow_transfer **out) {
    return process_ranks() > 1
               ? snow_ranks_new_transfer(process_comm(), d->state.volume, look,
                                         out)
               : snow_transfer_new_for_volume(d->state.volume, look, out);
}

/* The ranks of the drawing; NULL: one. */
static snow_comm *comm_of_all(void) {
    return process_ranks() > 1 ? process_comm() : NULL;
}

int drawing_restyle(drawing *d) {
    snow_transfer *made = NULL;
    snow_look look = look_options(&d->opts);
    if (d->state.channels.list.count)
        return mixed_restyle(d);
    snow_status status = drawing_new_transfer(d, &look, &made);
    if (status != SNOW_STATUS_OK)
        return fail_status(d->state.context, status);
    snow_transfer_free(d->state.transfer);
    d->state.transfer = made;
    d->look_is_new = true;
    d->look_is_quick = false;
    return CONTINUE;
}

/* The look before with other opacities or, where `spread` is set, over another
 * range, for which no voxel is counted; of the pictures at rest the look is
 * made anew, whose text is another. Whether it can be had. */
static bool restyle_quickly(drawing *d, bool spread) {
    snow_transfer *made = NULL, *before = d->state.transfer;
    const range_value range = options_range(&d->opts);
    snow_look base = {.size = sizeof base}, look = look_options(&d->opts);
    if (!before || d->state.channels.list.count ||
        snow_transfer_label(before, 0) ||
        snow_transfer_get_look(before, &base) != SNOW_STATUS_OK ||
        base.symlog > 0 || (spread && range.kind != SNOW_RANGE_VALUES))
        return false;
    snow_look quick = {.size = sizeof quick, .base = &base};
    if (spread) {
        quick.range = SNOW_RANGE_VALUES;
        quick.low = range.low;
        quick.high = range.high;
    } else {
        quick.opacities = look.opacities;
        quick.opacity_count = look.opacity_count;
    }
    if (drawing_new_transfer(d, &quick, &made) != SNOW_STATUS_OK)
        return false;
    snow_transfer_free(before);
    d->state.transfer = made;
    d->look_is_quick = true;
    d->look_is_new |= spread;
    return true;
}

/* Forgets of the overlay what a recipe changes; whether that is its look. */
static bool drop_overlay(drawing *d, const json_t *recipe, bool other_data) {
    layers *all[] = {&d->state.layers, &d->slice_layers};
    const bool file =
        kept_take_key(&d->overlay_key, kept_key_of(recipe, overlay_keys));
    const bool look = kept_take_key(&d->overlay_look_key,
                                    kept_key_of(recipe, overlay_look_keys));
    for (int i = 0; i < 2; i++) {
        if (file)
            layers_close(all[i]);
        if (look)
            layers_drop_look(all[i]);
    }
    if (other_data)
        layers_drop_volume(&d->state.layers);
    return file || look;
}

/* Of a volume that was not opened again.  What is said of its grid was. */
static int open_overlay(drawing *d) {
    render_state *s = &d->state;
    s->layers.quiet = false;
    show_warnings(&d->opts, s->context, false);
    int done = layers_open(&d->opts, s->context, s->volume, &s->layers);
    show_warnings(&d->opts, s->context, true);
    return process_agree(done);
}

/* The look whose visible part is framed; NULL: the whole box is. */
static const snow_transfer *framed_by(const drawing *d) {
    return d->state.channels.list.count > 1 ? NULL : d->state.transfer;
}

/* As render_state_open does. */
static int place(drawing *d) {
    render_state *s = &d->state;
    int done = make_view(s->context, &d->opts, &s->whole, &s->view);
    if (done == CONTINUE)
        done = make_settings(&d->opts, &s->whole, &s->settings);
    if (done != CONTINUE)
        return done;
    annotations_find_unit(&d->opts, s->volume, false, &s->whole);
    render_state_choose_shade(s);
    const double strip = s->strip;
    render_state_leave_strip(s);
    d->look_is_new |= fabs(s->strip - strip) > 0;
    if (strcmp(d->opts.fit, "visible") != 0)
        return CONTINUE;
    return check_status(s->context,
                        snow_view_fit(comm_of_all(), s->volume, framed_by(d),
                                      &s->settings, NULL, 0, &s->view));
}

/* After a fault nothing is known of volume and look. */
static void forget(drawing *d) {
    free(d->data_key);
    free(d->look_key);
    free(d->color_key);
    free(d->spread_key);
    free(d->plain_key);
    free(d->overlay_key);
    free(d->overlay_look_key);
    free(d->share_key);
    free(d->measure_key);
    mixed_forget(d);
    d->shown.count = 0;
    d->data_key = d->look_key = d->color_key = d->spread_key = NULL;
    d->plain_key = d->share_key = d->measure_key = NULL;
    d->overlay_key = d->overlay_look_key = NULL;
}

/* What pictures before left in it has to go before more is opened where there
 * is little memory. */
static void drop_frame(drawing *d) {
    snow_frame_free(d->state.frame);
    d->state.frame = NULL;
}

static int apply(drawing *d, const json_t *recipe) {
    int done = make_options(d, recipe, &d->opts);
    if (done != CONTINUE)
        return done;
    json_decref(d->tree);
    d->tree = json_deep_copy(recipe);
    bool anew, rearranged;
    done = process_agree(mixed_follow(d, &anew, &rearranged));
    if (done != CONTINUE) {
        forget(d);
        return done;
    }
    bool other_data =
        kept_take_key(&d->data_key, kept_key_of(recipe, data_keys)) || anew;
    bool other_look =
        kept_take_key(&d->look_key, kept_key_of(recipe, look_keys));
    bool other_colors = kept_take_key(&d->color_key, color_key_of(recipe));
    bool other_shape = kept_take_key(&d->spread_key, spread_key_of(recipe));
    bool overlaid = drop_overlay(d, recipe, other_data);
    bool clips = json_object_get(recipe, "clip") != NULL;
    if (other_data || rearranged)
        slices_forget(d);
    if (other_data || rearranged || !d->state.volume)
        d->values = (kept_values){.uses = 0};
    if (d->state.plan.streams && (other_data || other_look || overlaid))
        drop_frame(d);
    anew |= other_look && d->state.channels.list.count && process_ranks() > 1;
    kept_drop(d, clips ? kept_base_key(d, recipe) : NULL);
    if (other_data)
        mixed_forget(d);
    bool clipped = other_data && !anew && kept_clip(d);
    if (anew || (other_data && !clipped) || !d->state.volume) {
        done = reopen(d);
    } else {
        if (clipped || !d->state.transfer ||
            (other_look && ((other_colors && other_shape) ||
                            !restyle_quickly(d, other_colors))))
            done = drawing_restyle(d);
        if (done == CONTINUE)
            done = open_overlay(d);
    }
    kept_take_key(&d->plain_key, clips ? NULL : kept_base_key(d, recipe));
    d->look_is_new |= overlaid;
    if (done == CONTINUE)
        done = place(d);
    if (done == CONTINUE)
        drawing_measure(d);
    done = process_agree(done);
    if (done != CONTINUE)
        forget(d);
    return done;
}

int drawing_apply(drawing *d, const json_t *recipe) {
    ranks_tell(d, RANKS_APPLY, json_copy((json_t *)recipe));
    return apply(d, recipe);
}

int drawing_open(const options *first, json_t *recipe, drawing *out) {
    *out = (drawing){.first = *first,
                     .slice_layers = {.keeps = true, .alone = true}};
    identity_of(first->operands[0], out->identity);
    int done = make_options(out, recipe, &out->opts);
    if (done == CONTINUE)
        done = render_state_new(&out->opts, &out->state);
    out->state.layers.keeps = true;
    out->state.turns = process_ranks() > 1; /* neighbours' voxels for all
                                               directions */
    return done == CONTINUE ? apply(out, recipe) : done;
}

int drawing_wait(const options *first, drawing *out) {
    *out = (drawing){.first = *first,
                     .opts = *first,
                     .waits = true,
                     .slice_layers = {.keeps = true, .alone = true}};
    int done = render_state_new(&out->opts, &out->state);
    out->state.layers.keeps = true;
    return done;
}

int drawing_switch(drawing *d, const options *first, const json_t *recipe) {
    d->first = *first;
    identity_of(first->operands[0], d->identity);
    return drawing_apply(d, recipe);
}

void drawing_empty(drawing *d) {
    render_state *s = &d->state;
    drop_frame(d);
    kept_drop(d, NULL);
    slices_forget(d);
    snow_transfer_free(d->slice_look);
    d->slice_look = NULL;
    channels_close(&d->slice_channels);
    kept_take_key(&d->slice_key, NULL);
    mixed_forget(d);
    channels_close(&s->channels);
    layers_close(&s->layers);
    layers_close(&d->slice_layers);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    s->transfer = NULL;
    s->volume = NULL;
    json_decref(d->times); /* it may be another file */
    d->times = NULL;
    d->times_are_known = false;
    s->in_slabs = s->channels.chosen = false;
    s->drawn.path = NULL; /* the next picture is the first one */
    d->followed = 0;
    forget(d);
}

void drawing_close(drawing *d) {
    drawing_empty(d);
    render_state_free(&d->state); /* what opened the volumes */
    json_decref(d->tree);
}

/* To five digits, which read well in a command. */
static double rounded(double value) {
    char text[32];
    snprintf(text, sizeof text, "%.5g", value);
    return strtod(text, NULL);
}

json_t *drawing_fit(drawing *d) {
    render_state *s = &d->state;
    snow_view view = s->view;
    const double margin = render_state_margin(&d->opts);
    const snow_transfer *seen = margin < 1 ? NULL : framed_by(d);
    double azimuths[TURN_SIDES], radius;
    ranks_tell(d, RANKS_FIT, NULL);
    if (view.has_position)
        return json_object();
    make_view(s->context, &d->opts, &s->whole, &view);
    for (int i = 0; i < TURN_SIDES; i++)
        azimuths[i] = view.azimuth + 180.0 * i / TURN_SIDES;
    view.zoom = 1;
    view.strip = s->strip;
    view.has_target = false;
    if (snow_view_fit(comm_of_all(), s->volume, seen, &s->settings, azimuths,
                      TURN_SIDES, &view) != SNOW_STATUS_OK)
        return json_object();
    if (!view.has_target)
        drawing_middle(d, view.target, &radius);
    for (int i = 0; i < 3; i++)
        view.target[i] = rounded(view.target[i]);
    return json_pack("{s:f, s:o, s:s}", "zoom", rounded(view.zoom * margin),
                     "target", json_vector(view.target, 3), "fit", "volume");
}
