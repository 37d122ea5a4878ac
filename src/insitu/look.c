/* insitu/look.c - the look that a simulation asks for: a copy of all that it
 * points to. */
#include "insitu/internal.h"

#include <stdio.h>
#include <string.h>

void snow_insitu_free_look(snow_context *context, snow_own_look *look) {
    snow_context_release(context, look->opacities);
    snow_context_release(context, look->gradients);
    snow_context_release(context, look->point_block);
}

/* A name and where it is kept; NULL stays NULL. */
static const char *keep_name(const char *name, char out[64]) {
    if (!name)
        return NULL;
    snprintf(out, 64, "%s", name);
    return out;
}

/* A copy in memory of its own; NULL of none. */
static snow_status keep_points(snow_insitu *insitu,
                               const snow_opacity_point *points, size_t count,
                               snow_opacity_point **out) {
    size_t bytes = points ? count * sizeof *points : 0;
    if (!bytes)
        return SNOW_STATUS_OK;
    *out = snow_context_allocate(insitu->context, bytes);
    if (!*out)
        return snow_insitu_set_error(insitu, SNOW_STATUS_NO_MEMORY);
    memcpy(*out, points, bytes);
    return SNOW_STATUS_OK;
}

/* The points of a file or the like, and all that they hold, in one block. */
static snow_status keep_form(snow_insitu *insitu, const snow_points *points,
                             snow_own_look *own) {
    size_t colors = points->color_count * sizeof *points->colors;
    size_t opacities = points->opacity_count * sizeof *points->opacities;
    size_t gradients = points->gradient_count * sizeof *points->gradients;
    char *block = snow_context_allocate(insitu->context,
                                        colors + opacities + gradients + 1);
    if (!block)
        return snow_insitu_set_error(insitu, SNOW_STATUS_NO_MEMORY);
    own->point_block = block;
    own->points = *points;
    own->points.colors = (void *)block;
    own->points.opacities = (void *)(block + colors);
    own->points.gradients = (void *)(block + colors + opacities);
    if (colors)
        memcpy(block, points->colors, colors);
    if (opacities)
        memcpy(block + colors, points->opacities, opacities);
    if (gradients)
        memcpy(block + colors + opacities, points->gradients, gradients);
    return SNOW_STATUS_OK;
}

/* All that a look holds. */
static snow_status keep_look(snow_insitu *insitu, const snow_look *look,
                             snow_own_look *own) {
    INSITU_TRY(keep_points(insitu, look->opacities, look->opacity_count,
                           &own->opacities));
    INSITU_TRY(keep_points(insitu, look->gradient_opacities,
                           look->gradient_opacity_count, &own->gradients));
    return look->points ? keep_form(insitu, look->points, own) : SNOW_STATUS_OK;
}

/* The old one stays where there is no memory for the new one. */
snow_status snow_insitu_set_look(snow_insitu *insitu, const snow_look *given) {
    snow_own_look *own = &insitu->look, next = {.points = {0}};
    const snow_look *look = &next.look;
    INSITU_TRY(snow_insitu_set_error(
        insitu,
        SNOW_RECORD_READ(insitu->context, snow_look, given, &next.look)));
    if ((look->preset && snow_preset_from_name(look->preset) < 0) ||
        (look->colormap && snow_colormap_from_name(look->colormap) < 0))
        return snow_insitu_refuse(
            insitu,
            "there is no preset '%.40s' or no colour map '%.40s'; "
            "leave out what is not known",
            look->preset ? look->preset : "",
            look->colormap ? look->colormap : "");
    snow_status status = keep_look(insitu, look, &next);
    if (status != SNOW_STATUS_OK) {
        snow_insitu_free_look(insitu->context, &next);
        return status;
    }
    snow_insitu_free_look(insitu->context, own);
    *own = next;
    own->look.points = look->points ? &own->points : NULL;
    if (look->points)
        own->points.name = keep_name(look->points->name, own->name);
    own->look.preset = keep_name(look->preset, own->preset);
    own->look.colormap = keep_name(look->colormap, own->colormap);
    own->look.opacities = own->opacities;
    own->look.gradient_opacities = own->gradients;
    snow_transfer_free(insitu->transfer);
    insitu->transfer = NULL;
    return SNOW_STATUS_OK;
}
