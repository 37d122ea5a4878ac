/* drawing.c - implements drawing.h over the tool's render_state. */
#include "draw/drawing.h"
#include "commands/commands.h"
#include "draw/ranks.h"
#include "draw/slices.h"
#include "options/config.h"
#include "picture/annotations.h"
#include "picture/paint.h"
#include "run/log.h"

#include <snowglass/ranks.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a volume is opened by, and what a look is made of besides. */
static const char *const data_keys[] = {
    "crop", "channel", "component", "labels", "clip", "time", "mask", NULL};
static const char *const base_keys[] = {
    "crop", "channel", "component", "labels", "time", "mask", NULL};
static const char *const overlay_keys[] = {"overlay", "labels", "time", NULL};
static const char *const overlay_look_keys[] = {
    "overlay-preset", "overlay-colormap", "overlay-range", "overlay-opacity",
    NULL};
static const char *const look_keys[] = {
    "preset", "colormap", "log",   "symlog", "opacity", "gradient-opacity",
    "range",  "window",   "level", "shift",  "mode",    NULL};

/* The smallest side of a draft that is drawn in a hurry. */
#define SIDE_LEAST 64

/* So many are expected: moving voxels between ranks may pay. */
#define PICTURES_LEFT 100

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
    return done == CONTINUE ? check_settings(out) : done;
}

/* Some keys of a recipe as a text that changes with them. */
static char *key_of(const json_t *recipe, const char *const *names) {
    json_t *some = json_object();
    for (; *names; names++)
        if (json_object_get(recipe, *names))
            json_object_set(some, *names, json_object_get(recipe, *names));
    char *text = json_dumps(some, JSON_COMPACT | JSON_SORT_KEYS);
    json_decref(some);
    return text;
}

/* What stays the same while points of opacity are dragged; NULL: there are
 * none. */
static char *color_key_of(const json_t *recipe) {
    json_t *without = json_copy((json_t *)recipe);
    bool dragged = json_object_del(without, "opacity") == 0;
    char *text = dragged ? key_of(without, look_keys) : NULL;
    json_decref(without);
    return text;
}

/* Replaces a key; whether it is another. */
static bool take_key(char **key, char *now) {
    bool other = !*key || !now || strcmp(*key, now) != 0;
    free(*key);
    *key = now;
    return other;
}

/* --- volume, look, view ------------------------------------------------------
 */

static int reopen(drawing *d) {
    render_state *s = &d->state;
    snow_transfer_free(s->transfer);
    s->transfer = NULL;
    s->framed = false;
    int done = render_state_open(s, d->opts.operands[0], d->opts.time);
    d->look_is_new = d->volume_is_new = true;
    d->look_is_quick = false;
    return done;
}

static size_t count_clips(const snow_volume_options *data) {
    size_t count = 0;
    while (count < SNOW_CLIPS_MAX &&
           (data->clip[count][0] != 0 || data->clip[count][1] != 0 ||
            data->clip[count][2] != 0))
        count++;
    return count;
}

/* The volume without clip planes: the one that was shown before there were any,
 * or opened once; NULL where it stays in its file, or does not fit. */
static snow_volume *base_of(drawing *d) {
    snow_volume_options data = data_options(&d->opts);
    memset(data.clip, 0, sizeof data.clip);
    if (d->base || d->state.plan.streams)
        return d->base;
    if (d->plain_key && d->base_key && !strcmp(d->plain_key, d->base_key)) {
        d->base = d->state.volume;
        d->state.volume = NULL;
        take_key(&d->plain_key, NULL);
    }
    if (d->base)
        return d->base;
    if (snow_volume_open(d->state.context, d->opts.operands[0], &data,
                         &d->base) != SNOW_STATUS_OK)
        d->base = NULL;
    return d->base;
}

/* Where clip planes move, the volume without them is kept, and read only once.
 * What needs more memory than there is, stays in its file or is that of many
 * ranks is opened as ever. */
static bool reclip(drawing *d) {
    render_state *s = &d->state;
    snow_volume_options data = data_options(&d->opts);
    size_t count = count_clips(&data);
    snow_volume *made = NULL, *base;
    if (process_ranks() > 1 || !s->volume || !count || data.mask ||
        !(base = base_of(d)))
        return false;
    if (snow_volume_clip(base, d->opts.clip[0], count, &made) != SNOW_STATUS_OK)
        return false;
    snow_volume_close(s->volume);
    s->volume = made;
    s->whole = *snow_volume_get_info(made);
    return true;
}

bool drawing_is_clipped(const drawing *d) {
    snow_volume_options data = data_options(&d->opts);
    return count_clips(&data) > 0;
}

const snow_volume *drawing_unclipped(drawing *d) {
    const snow_volume *base = drawing_is_clipped(d) ? base_of(d) : NULL;
    return base ? base : d->state.volume;
}

/* Forgets the volume without clip planes where another is meant, or none. */
static void drop_base(drawing *d, char *key) {
    if (take_key(&d->base_key, key)) {
        snow_volume_close(d->base);
        d->base = NULL;
    }
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

static int restyle(drawing *d) {
    snow_transfer *made = NULL;
    snow_look look = look_options(&d->opts);
    snow_status status = drawing_new_transfer(d, &look, &made);
    if (status != SNOW_STATUS_OK)
        return fail_status(d->state.context, status);
    snow_transfer_free(d->state.transfer);
    d->state.transfer = made;
    d->look_is_new = true;
    d->look_is_quick = false;
    return CONTINUE;
}

/* The colours of the look before with other opacities, for which no voxel is
 * counted; of the pictures at rest the look is made anew, whose text is
 * another. Whether it can be had. */
static bool restyle_quickly(drawing *d) {
    snow_transfer *made = NULL, *before = d->state.transfer;
    snow_look base = {.size = sizeof base}, look = look_options(&d->opts);
    if (!before || snow_transfer_label(before, 0) ||
        snow_transfer_get_look(before, &base) != SNOW_STATUS_OK ||
        base.symlog > 0)
        return false;
    const snow_look quick = {.size = sizeof quick,
                             .base = &base,
                             .opacities = look.opacities,
                             .opacity_count = look.opacity_count};
    if (drawing_new_transfer(d, &quick, &made) != SNOW_STATUS_OK)
        return false;
    snow_transfer_free(before);
    d->state.transfer = made;
    d->look_is_quick = true;
    return true;
}

/* Forgets of the overlay what a recipe changes; whether that is its look. */
static bool drop_overlay(drawing *d, const json_t *recipe, bool other_data) {
    layers *all[] = {&d->state.layers, &d->slice_layers};
    const bool file = take_key(&d->overlay_key, key_of(recipe, overlay_keys));
    const bool look =
        take_key(&d->overlay_look_key, key_of(recipe, overlay_look_keys));
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
    hear_warnings(&d->opts, s->context, false);
    int done = layers_open(&d->opts, s->context, s->volume, &s->layers);
    hear_warnings(&d->opts, s->context, true);
    return process_agree(done);
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
    if (strcmp(d->opts.fit, "visible") != 0)
        return CONTINUE;
    snow_status status = snow_view_fit(comm_of_all(), s->volume, s->transfer,
                                       &s->settings, NULL, 0, &s->view);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(s->context, status);
}

/* After a fault nothing is known of volume and look. */
static void forget(drawing *d) {
    free(d->data_key);
    free(d->look_key);
    free(d->color_key);
    free(d->plain_key);
    free(d->overlay_key);
    free(d->overlay_look_key);
    d->data_key = d->look_key = d->color_key = d->plain_key = NULL;
    d->overlay_key = d->overlay_look_key = NULL;
}

static int apply(drawing *d, const json_t *recipe) {
    int done = make_options(d, recipe, &d->opts);
    if (done != CONTINUE)
        return done;
    json_decref(d->tree);
    d->tree = json_deep_copy(recipe);
    bool other_data = take_key(&d->data_key, key_of(recipe, data_keys));
    bool other_look = take_key(&d->look_key, key_of(recipe, look_keys));
    bool other_colors = take_key(&d->color_key, color_key_of(recipe));
    bool overlaid = drop_overlay(d, recipe, other_data);
    bool clips = json_object_get(recipe, "clip") != NULL;
    if (other_data)
        slices_forget(d);
    drop_base(d, clips ? key_of(recipe, base_keys) : NULL);
    bool clipped = other_data && reclip(d);
    if ((other_data && !clipped) || !d->state.volume) {
        done = reopen(d);
        take_key(&d->plain_key, clips ? NULL : key_of(recipe, base_keys));
    } else {
        if (clipped || !d->state.transfer ||
            (other_look && (other_colors || !restyle_quickly(d))))
            done = restyle(d);
        if (done == CONTINUE)
            done = open_overlay(d);
    }
    d->look_is_new |= overlaid;
    if (done == CONTINUE)
        done = place(d);
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
    int done = make_options(out, recipe, &out->opts);
    if (done == CONTINUE)
        done = render_state_new(&out->opts, &out->state);
    out->state.layers.keeps = true;
    out->state.turns = process_ranks() > 1; /* neighbours' voxels for all
                                               directions */
    return done == CONTINUE ? apply(out, recipe) : done;
}

void drawing_close(drawing *d) {
    snow_volume_close(d->base);
    snow_transfer_free(d->slice_look);
    layers_close(&d->slice_layers);
    slices_forget(d);
    render_state_free(&d->state);
    json_decref(d->tree);
    free(d->slice_key);
    forget(d);
    free(d->base_key);
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
    const snow_transfer *seen = margin < 1 ? NULL : s->transfer;
    double azimuths[TURN_SIDES], radius;
    ranks_tell(d, RANKS_FIT, NULL);
    if (view.has_position)
        return json_object();
    make_view(s->context, &d->opts, &s->whole, &view);
    for (int i = 0; i < TURN_SIDES; i++)
        azimuths[i] = view.azimuth + 180.0 * i / TURN_SIDES;
    view.zoom = 1;
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

void drawing_middle(const drawing *d, double middle[3], double *radius) {
    const snow_volume_info *info = &d->state.whole;
    double square[4] = {0};
    for (int i = 0; i < 3; i++) {
        middle[i] = info->matrix[i][3];
        for (int k = 0; k < 3; k++)
            middle[i] += info->matrix[i][k] * (double)(info->dims[k] - 1) / 2;
    }
    for (int corner = 0; corner < 4; corner++)
        for (int i = 0; i < 3; i++) {
            double along = 0;
            for (int k = 0; k < 3; k++)
                along += (k && corner & k ? -1 : 1) * info->matrix[i][k] *
                         (double)info->dims[k] / 2;
            square[corner] += along * along;
        }
    *radius = 0;
    for (int corner = 0; corner < 4; corner++)
        *radius = fmax(*radius, sqrt(square[corner]));
}

/* --- pictures
 * ------------------------------------------------------------------ */

static int shrunk(int side, int shrink) {
    int small = side >> shrink;
    return small >= SIDE_LEAST ? small : side < SIDE_LEAST ? side : SIDE_LEAST;
}

/* Letters and bars, as `snowglass render` draws them. */
static int annotate(drawing *d, const paint_given *painted,
                    const snow_image *image, snow_overlay **out) {
    render_state *s = &d->state;
    const picture_annotations annotations = {
        &d->opts,
        s->whole,
        s->view,
        s->transfer,
        {painted->range[0], painted->range[1]},
        &s->channels,
        layers_legend(&s->layers)};
    snow_status status = annotations_make(&annotations, s->view.azimuth, -1,
                                          image, s->context, out);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(s->context, status);
}

static int draw(drawing *d, snow_image **image, paint_given *painted) {
    render_state *s = &d->state;
    s->fault = 0;
    s->left = PICTURES_LEFT;
    int done = render_state_draw(s, s->view.azimuth, image);
    if (done != CONTINUE)
        return done;
    done =
        paint_values(&d->opts, s->context, s->transfer, false, image, painted);
    if (done == CONTINUE)
        return CONTINUE;
    snow_image_free(*image);
    *image = NULL;
    return done;
}

int drawing_render(drawing *d, snow_quality quality, int shrink,
                   snow_stop_fn *stop, void *user, snow_image **image,
                   snow_overlay **overlay) {
    render_state *s = &d->state;
    const snow_view view = s->view;
    paint_given painted;
    *image = NULL;
    *overlay = NULL;
    ranks_tell(d, RANKS_RENDER, json_pack("[i,i]", (int)quality, shrink));
    s->settings.quality = quality;
    s->settings.stop = stop;
    s->settings.stop_user = user;
    s->view.width = shrunk(view.width, shrink);
    s->view.height = shrunk(view.height, shrink);
    int done = quality != SNOW_QUALITY_DRAFT && d->look_is_quick ? restyle(d)
                                                                 : CONTINUE;
    if (done == CONTINUE)
        done = draw(d, image, &painted);
    if (done == CONTINUE && *image)
        done = annotate(d, &painted, *image, overlay);
    s->view = view;
    if (done == CONTINUE)
        return CONTINUE;
    snow_image_free(*image);
    *image = NULL;
    return done;
}

/* --- the command
 * ----------------------------------------------------------------- */

void drawing_name_output(const char *input, const char *slice, char out[100]) {
    const char *slash = strrchr(input, '/'), *colon = strchr(input, ':');
    const char *base = slash ? slash + 1 : colon ? colon + 1 : input;
    size_t length = strcspn(base, ".");
    if (length == 0 || length > 64)
        snprintf(out, 100, "picture.png");
    else
        snprintf(out, 100, "%.*s%s%.16s.png", (int)length, base,
                 *slice ? "-" : "", slice);
}

char *drawing_command(const drawing *d, unsigned verb) {
    static options opts; /* large; one thread draws */
    char output[100];
    opts = d->opts;
    drawing_name_output(opts.operands[0], "", output);
    if (verb == VERB_TURNTABLE)
        memcpy(strrchr(output, '.'), ".mp4", 4);
    opts.output = output;
    opts.quality = "high";
    if (strcmp(opts.mode, "over") != 0)
        layers_leave_out(&opts);
    json_t *tree = config_tree(&opts, verb_of(verb));
    if (!tree)
        return NULL;
    char *text = config_command(&opts, verb_of(verb), tree);
    json_decref(tree);
    return text;
}
