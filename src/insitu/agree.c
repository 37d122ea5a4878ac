/* insitu/agree.c - what all ranks know of one another: that they were given the
 * same view and settings, and what their voxels are, from one reduction of a
 * few numbers. */
#include "insitu/internal.h"

#include <string.h>

/* FNV-1a over bytes. */
static void add_bytes(uint64_t *print, const void *bytes, size_t count) {
    const unsigned char *at = bytes;
    for (size_t i = 0; i < count; i++)
        *print = (*print ^ at[i]) * UINT64_C(0x100000001b3);
}

/* NULL differs from "". */
static void add_text(uint64_t *print, const char *text) {
    bool given = text != NULL;
    add_bytes(print, &given, sizeof given);
    if (given)
        add_bytes(print, text, strlen(text) + 1);
}

#define ADD_ALL(print, array) add_bytes(print, array, sizeof(array))

/* Points are made of doubles alone. */
static void add_points(uint64_t *print, const void *points, size_t count,
                       size_t size) {
    add_bytes(print, &count, sizeof count);
    if (points)
        add_bytes(print, points, count * size);
}

static void add_look(uint64_t *print, const snow_look *look) {
    const double reals[] = {look->low, look->high, look->symlog};
    const int64_t wholes[] = {look->range, look->log, look->domain,
                              look->per_mm, look->base != NULL};
    add_text(print, look->preset);
    add_text(print, look->colormap);
    ADD_ALL(print, reals);
    ADD_ALL(print, wholes);
    add_points(print, look->colors, look->color_count, sizeof *look->colors);
    add_points(print, look->opacities, look->opacity_count,
               sizeof *look->opacities);
    add_points(print, look->gradient_opacities, look->gradient_opacity_count,
               sizeof *look->gradient_opacities);
    if (look->base)
        add_look(print, look->base);
}

static void add_view(uint64_t *print, const snow_view *view) {
    const double reals[] = {view->back[0], view->back[1],   view->back[2],
                            view->up[0],   view->up[1],     view->up[2],
                            view->azimuth, view->elevation, view->roll,
                            view->zoom,    view->fov};
    const int64_t wholes[] = {view->width, view->height, view->has_position,
                              view->has_target, view->has_view_up};
    ADD_ALL(print, reals);
    ADD_ALL(print, wholes);
    if (view->has_position)
        ADD_ALL(print, view->position);
    if (view->has_target)
        ADD_ALL(print, view->target);
    if (view->has_view_up)
        ADD_ALL(print, view->view_up);
}

/* All but threads and instruction sets, which machines may have of their
 * own. */
static void add_settings(uint64_t *print, const snow_settings *s) {
    const double reals[] = {
        s->threshold, s->opacity_length,  s->ambient,       s->diffuse,
        s->specular,  s->shininess,       s->light_azimuth, s->light_elevation,
        s->iso,       s->depth_darkening, s->occlusion};
    const int64_t wholes[] = {
        s->method,  s->encoding,      s->kernel, s->footprint, s->shade,
        s->quality, s->deterministic, s->mode,   s->depth,     s->light};
    ADD_ALL(print, reals);
    ADD_ALL(print, wholes);
}

/* A print of what must be the same everywhere, field by field, since records
 * have gaps between them. */
static int64_t print_of(const snow_insitu *insitu, const snow_view *view) {
    const snow_ranks_options *how = &insitu->how;
    const double reals[] = {insitu->limit_seconds};
    const int64_t wholes[] = {(int64_t)insitu->limit_bytes,
                              (int64_t)insitu->ghosts,
                              (int64_t)insitu->balance,
                              insitu->pattern != NULL,
                              insitu->transfer != NULL,
                              insitu->shaded,
                              insitu->clip_count,
                              how->cut,
                              how->combining,
                              how->radix,
                              how->pixel_bits,
                              how->turns,
                              how->scattered};
    uint64_t print = UINT64_C(0xcbf29ce484222325);
    ADD_ALL(&print, reals);
    ADD_ALL(&print, wholes);
    add_view(&print, view);
    add_settings(&print, &insitu->settings);
    add_look(&print, &insitu->look.look);
    add_points(&print, insitu->clips, (size_t)insitu->clip_count,
               sizeof *insitu->clips);
    ADD_ALL(&print, insitu->whole.dims);
    ADD_ALL(&print, insitu->whole.matrix);
    return (int64_t)(print >> 2);
}

static snow_status check_prints(snow_insitu *insitu, int64_t least,
                                int64_t most) {
    if (least == most)
        return SNOW_STATUS_OK;
    return snow_context_fail(
        insitu->context, SNOW_STATUS_BAD_USAGE,
        "grids, looks, views, settings, clip planes or limits "
        "differ between ranks; call the setters with the "
        "same values on all ranks");
}

snow_status snow_insitu_check(snow_insitu *insitu) {
    snow_view view = snow_insitu_view(insitu);
    int64_t print = print_of(insitu, &view), prints[2] = {print, -print};
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, prints, 2, SNOW_REDUCE_MIN));
    return check_prints(insitu, prints[0], -prints[1]);
}

/* Whether each brick's halo has all layers that lie within the grid. */
static bool snow_insitu_halos_suffice(const snow_insitu *insitu,
                                      const int64_t layers[3]) {
    for (int id = 0; id < insitu->brick_count; id++) {
        const snow_insitu_brick *brick = &insitu->bricks[id];
        if (!snow_box_voxels(&brick->box))
            continue;
        snow_box has = snow_insitu_grow_box(
            &brick->box, brick->halo.low, brick->halo.high, insitu->whole.dims);
        snow_box needs = snow_insitu_grow_box(&brick->box, layers, layers,
                                              insitu->whole.dims);
        if (!snow_insitu_box_holds(&has, &needs))
            return false;
    }
    return true;
}

static snow_status check_facts(snow_insitu *insitu, const int64_t *facts) {
    INSITU_TRY(check_prints(insitu, facts[SNOW_FACT_PRINT],
                            -facts[SNOW_FACT_PRINT_MOST]));
    if (facts[SNOW_FACT_TYPE] == INT64_MAX)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "no rank has a brick; call snow_insitu_set_brick");
    if (facts[SNOW_FACT_TYPE] != -facts[SNOW_FACT_TYPE_MOST])
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "voxels are %s on one rank and %s on another: all must have the "
            "same type",
            snow_type_name((snow_type)facts[SNOW_FACT_TYPE]),
            snow_type_name((snow_type)-facts[SNOW_FACT_TYPE_MOST]));
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_share_facts(snow_insitu *insitu, const snow_view *view,
                                    const int64_t layers[3], bool united,
                                    int64_t facts[SNOW_INSITU_FACTS]) {
    bool same = insitu->layout.planned && !insitu->changed &&
                memcmp(layers, insitu->layout.layers, 3 * sizeof *layers) == 0;
    insitu->boxes_known &= !insitu->changed;
    int64_t type = (int64_t)insitu->type;
    facts[SNOW_FACT_TYPE] = type ? type : INT64_MAX;
    facts[SNOW_FACT_TYPE_MOST] = -type;
    facts[SNOW_FACT_PRINT] = print_of(insitu, view);
    facts[SNOW_FACT_PRINT_MOST] = -facts[SNOW_FACT_PRINT];
    facts[SNOW_FACT_UNCHANGED] = same;
    facts[SNOW_FACT_UNITED] = united;
    facts[SNOW_FACT_HALOS] = snow_insitu_halos_suffice(insitu, layers);
    facts[SNOW_FACT_BOXES] = insitu->boxes_known;
    facts[SNOW_FACT_EVEN] = snow_insitu_is_even(insitu);
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, facts, SNOW_INSITU_FACTS,
                                     SNOW_REDUCE_MIN));
    INSITU_TRY(check_facts(insitu, facts));
    insitu->type = (snow_type)facts[SNOW_FACT_TYPE];
    return SNOW_STATUS_OK;
}
