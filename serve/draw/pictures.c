/* pictures.c - pictures of a drawing, and the command that makes one; see
 * drawing.h. */
#include "draw/drawing.h"
#include "draw/kept.h"
#include "draw/mixed.h"
#include "draw/ranks.h"
#include "options/config.h"
#include "picture/annotations.h"
#include "picture/paint.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The smallest side of a draft that is drawn in a hurry. */
#define SIDE_LEAST 64

/* --- pictures
 * ------------------------------------------------------------------ */

static int shrunk(int side, int shrink) {
    int small = side >> shrink;
    return small >= SIDE_LEAST ? small : side < SIDE_LEAST ? side : SIDE_LEAST;
}

/* Shear-warp draws voxel by voxel: where a pixel is as large as two of them,
 * one of fewer pixels takes as long. */
static int useful_shrink(const drawing *d, int shrink) {
    const snow_view *view = &d->state.view;
    const double *step = d->state.whole.spacing;
    double middle[3], radius;
    drawing_middle(d, middle, &radius);
    const double voxels =
        2 * radius / view->zoom / fmin(step[0], fmin(step[1], step[2]));
    while (shrink > 0 && d->state.stats.method == SNOW_METHOD_SHEAR_WARP &&
           fmin(view->width, view->height) / (1 << shrink) < voxels / 2)
        shrink--;
    return shrink;
}

void drawing_measure(drawing *d) {
    static options opts; /* large; one thread draws */
    render_state *s = &d->state;
    const char *text = d->opts.measure ? d->opts.measure : "";
    const char *data = d->data_key ? d->data_key : "";
    const size_t room = strlen(text) + strlen(data) + 2;
    char *key = malloc(room);
    if (key)
        snprintf(key, room, "%s\n%s", text, data);
    if (!kept_take_key(&d->measure_key, key) || !process_talks())
        return;
    opts = render_state_step(s, d->opts.time);
    memset(opts.clip, 0, sizeof opts.clip); /* as slices, which show all */
    (void)measures_find(&opts, s->context, s->path, &s->whole,
                        process_ranks() == 1 ? drawing_unclipped(d, 0) : NULL,
                        true, &s->measures);
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
        layers_legend(&s->layers, false),
        .measures = s->measures};
    return check_status(s->context,
                        annotations_make(&annotations, s->view.azimuth, -1,
                                         image, s->context, out));
}

static int draw(drawing *d, snow_image **image, paint_given *painted) {
    render_state *s = &d->state;
    const int channels = s->channels.list.count;
    s->fault = 0;
    int done = d->draw ? d->draw(d, image)
                       : render_state_draw(s, s->view.azimuth, image);
    d->look_is_new |= s->channels.list.count != channels; /* some gave way */
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
    shrink = useful_shrink(d, shrink);
    ranks_tell(d, RANKS_RENDER, json_pack("[i,i]", (int)quality, shrink));
    s->settings.quality = quality;
    s->settings.stop = stop;
    s->settings.stop_user = user;
    s->view.width = shrunk(view.width, shrink);
    s->view.height = shrunk(view.height, shrink);
    int done = quality != SNOW_QUALITY_DRAFT && d->look_is_quick
                   ? drawing_restyle(d)
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

void drawing_options(const drawing *d, options *out) {
    *out = d->opts;
    out->quality = "high";
    if (strcmp(out->mode, "over") != 0)
        layers_leave_out(out);
    mixed_settle(d, out);
}

char *drawing_command_of(const options *opts, unsigned verb) {
    json_t *tree = config_tree(opts, verb_of(verb));
    if (!tree)
        return NULL;
    if (identity_isa())
        json_object_set_new(tree, "isa", json_string(identity_isa()));
    char *text = config_command(opts, verb_of(verb), tree);
    json_decref(tree);
    return text;
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

char *drawing_command(const drawing *d) {
    static options opts; /* large; one thread draws */
    char output[100];
    drawing_options(d, &opts);
    drawing_name_output(opts.operands[0], "", output);
    opts.output = output;
    return drawing_command_of(&opts, VERB_RENDER);
}
