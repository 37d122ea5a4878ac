/* insitu/look.c - the look that a simulation asks for: a copy of all that it
 * points to. */
#include "insitu/internal.h"

#include <string.h>

void snow_insitu_free_look(snow_context *context, snow_own_look *look) {
    snow_context_release(context, look->blocks[0]);
    snow_context_release(context, look->blocks[1]);
}

static size_t text_bytes(const char *text) {
    return text ? strlen(text) + 1 : 0;
}

/* Copies a list of points or a text; NULL and empty lists are NULL. */
static void *keep_list(const void *points, size_t bytes, char **at) {
    void *own = *at;
    if (!points || !bytes)
        return NULL;
    memcpy(own, points, bytes);
    *at += bytes;
    return own;
}

/* All points and texts of a look, in one block. */
static snow_status keep_block(snow_insitu *insitu, snow_look *look,
                              void **block) {
    size_t colors = look->color_count * sizeof *look->colors;
    size_t opacities = look->opacity_count * sizeof *look->opacities;
    size_t gradients =
        look->gradient_opacity_count * sizeof *look->gradient_opacities;
    size_t name = text_bytes(look->name), preset = text_bytes(look->preset);
    size_t colormap = text_bytes(look->colormap);
    char *at = snow_context_allocate(insitu->context,
                                     colors + opacities + gradients + name +
                                         preset + colormap + 1);
    if (!at)
        return snow_insitu_set_error(insitu, SNOW_STATUS_NO_MEMORY);
    *block = at;
    look->colors = keep_list(look->colors, colors, &at);
    look->opacities = keep_list(look->opacities, opacities, &at);
    look->gradient_opacities =
        keep_list(look->gradient_opacities, gradients, &at);
    look->name = keep_list(look->name, name, &at);
    look->preset = keep_list(look->preset, preset, &at);
    look->colormap = keep_list(look->colormap, colormap, &at);
    return SNOW_STATUS_OK;
}

/* The look and its base, with points and texts of their own. */
static snow_status keep_look(snow_insitu *insitu, const snow_look *given,
                             snow_own_look *own) {
    INSITU_TRY(INSITU_READ(insitu, snow_look, given, &own->look));
    INSITU_TRY(INSITU_READ(insitu, snow_look, own->look.base, &own->base));
    INSITU_TRY(keep_block(insitu, &own->look, &own->blocks[0]));
    return own->look.base ? keep_block(insitu, &own->base, &own->blocks[1])
                          : SNOW_STATUS_OK;
}

static snow_status check_names(snow_insitu *insitu, const snow_look *look) {
    if ((!look->preset || snow_preset_from_name(look->preset) >= 0) &&
        (!look->colormap || snow_colormap_from_name(look->colormap) >= 0))
        return SNOW_STATUS_OK;
    return snow_insitu_refuse(
        insitu,
        "there is no preset '%.40s' or no colour map '%.40s'; "
        "leave out what is not known",
        look->preset ? look->preset : "", look->colormap ? look->colormap : "");
}

/* The old one stays where there is no memory for the new one. */
snow_status snow_insitu_keep_look(snow_insitu *insitu, const snow_look *given) {
    snow_own_look *own = &insitu->look, next = {.blocks = {NULL}};
    snow_status status = keep_look(insitu, given, &next);
    if (status == SNOW_STATUS_OK)
        status = check_names(insitu, &next.look);
    if (status != SNOW_STATUS_OK) {
        snow_insitu_free_look(insitu->context, &next);
        return status;
    }
    snow_insitu_free_look(insitu->context, own);
    *own = next;
    own->look.base = next.look.base ? &own->base : NULL;
    snow_transfer_free(insitu->transfer);
    insitu->transfer = NULL;
    return SNOW_STATUS_OK;
}
