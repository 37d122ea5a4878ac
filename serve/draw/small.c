/* small.c - implements small.h. */
#include "draw/small.h"
#include "draw/ranks.h"
#include "run/log.h"

#include <snowglass/ranks.h>

#include <string.h>

static snow_status render_part(drawing *d, snow_frame *frame,
                               const snow_transfer *transfer,
                               const snow_view *view,
                               const snow_settings *settings,
                               snow_image **image) {
    const snow_ranks_options how = {.size = sizeof how, .turns = true};
    snow_status status = snow_ranks_repartition(
        process_comm(), transfer, view, settings, &how, &d->state.volume);
    return status == SNOW_STATUS_OK
               ? snow_ranks_render(frame, process_comm(), d->state.volume,
                                   transfer, view, settings, &how, image)
               : status;
}

snow_status small_render(drawing *d, const snow_transfer *transfer,
                         const snow_view *view, const snow_settings *settings,
                         snow_frame **frame, snow_image **image) {
    snow_status status = snow_frame_new(d->state.context, frame);
    const bool many = process_ranks() > 1;
    if (many)
        status = snow_comm_agree_status(process_comm(), status);
    if (status != SNOW_STATUS_OK)
        return status;
    return many ? render_part(d, *frame, transfer, view, settings, image)
                : snow_frame_render(*frame, d->state.volume, transfer, view,
                                    settings, image);
}

/* Projections of PET go over what is read of it, as those of the command. */
static void take_projection(const drawing *d, snow_look *look) {
    const bool pet = strcmp(d->state.whole.modality, "PT") == 0;
    look->preset = "linear";
    look->range = pet ? SNOW_RANGE_SIGNAL : SNOW_RANGE_ROBUST;
}

int small_thumbnail(drawing *d, thumbnail *of, int side, snow_stop_fn *stop,
                    void *user, snow_image **image) {
    render_state *s = &d->state;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_look look = {.size = sizeof look,
                      .preset = *of->preset ? of->preset : NULL,
                      .colormap = of->colormap};
    ranks_tell(
        d, RANKS_THUMBNAIL,
        json_pack("[s,s?,b,i]", of->preset, of->colormap, of->mip, side));
    if (of->mip)
        take_projection(d, &look);
    else if (!*of->preset && d->first.loaded) /* what no preset means then */
        look.base = snow_look_file_look(d->first.loaded);
    snow_view view = s->view;
    snow_settings settings = s->settings;
    settings.quality = SNOW_QUALITY_DRAFT;
    settings.mode = of->mip ? SNOW_MODE_MIP : SNOW_MODE_OVER;
    settings.stop = stop;
    settings.stop_user = user;
    view.width = view.height = side;
    snow_status status = drawing_new_transfer(d, &look, &transfer);
    if (status == SNOW_STATUS_OK && !options_given(&d->opts, "shade"))
        settings.shade = snow_transfer_is_unshaded(transfer) ? SNOW_SHADE_NONE
                                                             : SNOW_SHADE_PHONG;
    if (status == SNOW_STATUS_OK) {
        snow_mode_background(settings.mode, transfer, of->ground);
        status = small_render(d, transfer, &view, &settings, &frame, image);
    }
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    return check_status(s->context, status);
}
