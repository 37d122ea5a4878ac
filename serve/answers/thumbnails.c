/* thumbnails.c - small pictures of presets and colour maps; see answers.h. */
#include "answers/answers.h"

#include "commands/commands.h"
#include "draw/small.h"
#include "message.h"
#include "pack.h"

#include <string.h>

#define THUMBNAIL_SIDE 96

/* The state that was the newest when a picture was begun. */
typedef struct begun {
    const viewer_state *state;
    uint32_t revision;
} begun;

static bool has_changed(void *user) {
    const begun *b = user;
    return state_is_stale(b->state, b->revision);
}

/* What a thumbnail shows: {"what": "thumbnail", "preset": "ct-bone", "pane":
 * 4}, with a "colormap" in its place, or as a projection, "mode": "mip". False:
 * it is nothing that there is. */
static bool read_thumbnail(const json_t *tree, thumbnail *out) {
    const char *mode = json_string_value(json_object_get(tree, "mode"));
    const json_t *map = json_object_get(tree, "colormap");
    *out = (thumbnail){.preset =
                           json_string_value(json_object_get(tree, "preset")),
                       .colormap = json_string_value(map),
                       .mip = mode && strcmp(mode, "mip") == 0};
    return out->preset &&
           (!*out->preset || snow_preset_from_name(out->preset) >= 0) &&
           (!map ||
            (out->colormap && snow_colormap_from_name(out->colormap) >= 0));
}

/* Is asked again where a page changes something meanwhile. */
void answer_thumbnail(drawing *d, viewer_state *s, outbox *box, uint64_t client,
                      json_t *tree) {
    begun now = {s, state_revision(s)};
    thumbnail of;
    json_int_t pane = json_integer_value(json_object_get(tree, "pane"));
    snow_image *image = NULL;
    if (!d->state.volume || pane < 4 || pane > 255 ||
        !read_thumbnail(tree, &of))
        return;
    int done =
        small_thumbnail(d, &of, THUMBNAIL_SIDE, has_changed, &now, &image);
    if (done == EXIT_INTERRUPTED) {
        json_object_set_new(tree, "again", json_true());
        state_ask(s, client, json_incref(tree));
    }
    if (done != CONTINUE)
        return;
    snow_image_options form = picture_form(&d->opts, NULL);
    if (d->opts.background.automatic)
        memcpy(form.background, of.ground, sizeof of.ground);
    outgoing *made = pack_small(image, &form, false, (int)pane, 0);
    if (made)
        made->client = client;
    outbox_put(box, made);
    snow_image_free(image);
}
