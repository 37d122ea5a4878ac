/* drawing.c - implements drawing.h over the tool's render_state. */
#include "drawing.h"
#include "commands/commands.h"
#include "options/config.h"
#include "options/config_paths.h"
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
    "crop", "channel", "component", "labels", "clip", "time", NULL};
static const char *const base_keys[] = {"crop",   "channel", "component",
                                        "labels", "time",    NULL};
static const char *const look_keys[] = {
    "preset", "colormap", "log",   "opacity", "gradient-opacity",
    "range",  "window",   "level", "shift",   "mode",
    NULL};

/* The smallest side of a draft that is drawn in a hurry. */
#define SIDE_LEAST 64

/* A turn is framed from these angles on. */
#define TURN_SIDES 4

/* --- the recipe as options --------------------------------------------------
 */

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
    return done;
}

/* Where clip planes move, the volume without them is kept, and read only once.
 * What needs more memory than there is, or stays in its file, is opened as
 * ever. */
static bool reclip(drawing *d) {
    render_state *s = &d->state;
    snow_volume_options data = data_options(&d->opts);
    size_t count = 0;
    snow_volume *made = NULL;
    while (count < SNOW_CLIPS_MAX &&
           (data.clip[count][0] != 0 || data.clip[count][1] != 0 ||
            data.clip[count][2] != 0))
        count++;
    if (s->plan.streams || !s->volume || !count || data.mask)
        return false;
    memset(data.clip, 0, sizeof data.clip);
    if (!d->base && snow_volume_open(s->context, d->opts.operands[0], &data,
                                     &d->base) != SNOW_STATUS_OK)
        return false;
    if (snow_volume_clip(d->base, d->opts.clip[0], count, &made) !=
        SNOW_STATUS_OK)
        return false;
    snow_volume_close(s->volume);
    s->volume = made;
    s->whole = *snow_volume_get_info(made);
    return true;
}

/* Forgets the volume without clip planes where another is meant, or none. */
static void drop_base(drawing *d, char *key) {
    if (take_key(&d->base_key, key)) {
        snow_volume_close(d->base);
        d->base = NULL;
    }
}

static int restyle(drawing *d) {
    snow_transfer *made = NULL;
    snow_look look = look_options(&d->opts);
    snow_status status =
        snow_transfer_new_for_volume(d->state.volume, &look, &made);
    if (status != SNOW_STATUS_OK)
        return fail_status(d->state.context, status);
    snow_transfer_free(d->state.transfer);
    d->state.transfer = made;
    d->look_is_new = true;
    return CONTINUE;
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
    if (snow_transfer_is_unshaded(s->transfer) &&
        !options_given(&d->opts, "shade"))
        s->settings.shade = SNOW_SHADE_NONE;
    if (strcmp(d->opts.fit, "visible") != 0)
        return CONTINUE;
    snow_status status = snow_view_fit(NULL, s->volume, s->transfer,
                                       &s->settings, NULL, 0, &s->view);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(s->context, status);
}

/* After a fault nothing is known of volume and look. */
static void forget(drawing *d) {
    free(d->data_key);
    free(d->look_key);
    d->data_key = d->look_key = NULL;
}

int drawing_apply(drawing *d, const json_t *recipe) {
    int done = make_options(d, recipe, &d->opts);
    if (done != CONTINUE)
        return done;
    json_decref(d->tree);
    d->tree = json_deep_copy(recipe);
    bool other_data = take_key(&d->data_key, key_of(recipe, data_keys));
    bool other_look = take_key(&d->look_key, key_of(recipe, look_keys));
    bool clips = json_object_get(recipe, "clip") != NULL;
    drop_base(d, clips ? key_of(recipe, base_keys) : NULL);
    bool clipped = other_data && reclip(d);
    if ((other_data && !clipped) || !d->state.volume)
        done = reopen(d);
    else if (clipped || other_look || !d->state.transfer)
        done = restyle(d);
    if (done == CONTINUE)
        done = place(d);
    if (done != CONTINUE)
        forget(d);
    return done;
}

int drawing_open(const options *first, json_t *recipe, drawing *out) {
    *out = (drawing){.first = *first};
    int done = make_options(out, recipe, &out->opts);
    if (done == CONTINUE)
        done = render_state_new(&out->opts, &out->state);
    return done == CONTINUE ? drawing_apply(out, recipe) : done;
}

void drawing_close(drawing *d) {
    snow_volume_close(d->base);
    render_state_free(&d->state);
    json_decref(d->tree);
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
    double azimuths[TURN_SIDES], radius;
    if (view.has_position)
        return json_object();
    make_view(s->context, &d->opts, &s->whole, &view);
    for (int i = 0; i < TURN_SIDES; i++)
        azimuths[i] = view.azimuth + 180.0 * i / TURN_SIDES;
    view.zoom = 1;
    view.has_target = false;
    if (snow_view_fit(NULL, s->volume, s->transfer, &s->settings, azimuths,
                      TURN_SIDES, &view) != SNOW_STATUS_OK)
        return json_object();
    if (!view.has_target)
        drawing_middle(d, view.target, &radius);
    for (int i = 0; i < 3; i++)
        view.target[i] = rounded(view.target[i]);
    return json_pack("{s:f, s:o, s:s}", "zoom", rounded(view.zoom), "target",
                     json_vector(view.target, 3), "fit", "volume");
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
        {painted->range[0], painted->range[1]}};
    snow_status status = annotations_make(&annotations, s->view.azimuth, -1,
                                          image, s->context, out);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(s->context, status);
}

static int draw(drawing *d, snow_image **image, paint_given *painted) {
    render_state *s = &d->state;
    s->fault = 0;
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
    s->settings.quality = quality;
    s->settings.stop = stop;
    s->settings.stop_user = user;
    s->view.width = shrunk(view.width, shrink);
    s->view.height = shrunk(view.height, shrink);
    int done = draw(d, image, &painted);
    if (done == CONTINUE)
        done = annotate(d, &painted, *image, overlay);
    s->view = view;
    if (done == CONTINUE)
        return CONTINUE;
    snow_image_free(*image);
    *image = NULL;
    return done;
}

/* Its own frame: the one of the volume keeps its encoding. */
int drawing_thumbnail(drawing *d, const char *preset, int side,
                      snow_stop_fn *stop, void *user, snow_image **image) {
    render_state *s = &d->state;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_look look = {.size = sizeof look, .preset = *preset ? preset : NULL};
    if (!*preset && d->first.loaded) /* what no preset means then */
        look.base = snow_look_file_look(d->first.loaded);
    snow_view view = s->view;
    snow_settings settings = s->settings;
    settings.quality = SNOW_QUALITY_DRAFT;
    settings.mode = SNOW_MODE_OVER; /* what a preset is for */
    settings.stop = stop;
    settings.stop_user = user;
    view.width = view.height = side;
    snow_status status =
        snow_transfer_new_for_volume(s->volume, &look, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(s->context, &frame);
    if (status == SNOW_STATUS_OK && !options_given(&d->opts, "shade"))
        settings.shade = snow_transfer_is_unshaded(transfer) ? SNOW_SHADE_NONE
                                                             : SNOW_SHADE_PHONG;
    if (status == SNOW_STATUS_OK)
        status = snow_frame_render(frame, s->volume, transfer, &view, &settings,
                                   image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(s->context, status);
}

/* --- the command
 * ----------------------------------------------------------------- */

/* "head.png" for /data/head.nii.gz and phantom:head. */
static void name_output(const char *input, char out[80]) {
    const char *slash = strrchr(input, '/'), *colon = strchr(input, ':');
    const char *base = slash ? slash + 1 : colon ? colon + 1 : input;
    size_t length = strcspn(base, ".");
    if (length == 0 || length > 64)
        snprintf(out, 80, "picture.png");
    else
        snprintf(out, 80, "%.*s.png", (int)length, base);
}

json_t *drawing_recipe(const drawing *d) {
    static options opts; /* large; one thread draws */
    opts = d->opts;
    opts.output = NULL;
    opts.quality = "high";
    json_t *tree = config_tree(&opts, verb_of(VERB_RENDER));
    config_paths_write(tree, "/"); /* whole: the file may be put anywhere */
    return tree;
}

char *drawing_command(const drawing *d) {
    static options opts; /* large; one thread draws */
    char output[80];
    opts = d->opts;
    name_output(opts.operands[0], output);
    opts.output = output;
    opts.quality = "high";
    json_t *tree = config_tree(&opts, verb_of(VERB_RENDER));
    if (!tree)
        return NULL;
    char *text = config_command(&opts, verb_of(VERB_RENDER), tree);
    json_decref(tree);
    return text;
}
