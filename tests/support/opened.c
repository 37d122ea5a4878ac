/* tests/support/opened.c - see opened.h. */
#include "support/opened.h"

void opened_leave(opened *o) {
    snow_frame_free(o->frame);
    snow_transfer_free(o->transfer);
    snow_volume_close(o->volume);
}

snow_status opened_enter(snow_comm *comm, const opened_request *r,
                         opened *out) {
    *out = (opened){.comm = comm, .request = r};
    SNOW_TRY(snow_ranks_open(
        comm, r->path, &r->options, r->look.size ? &r->look : NULL, &r->view,
        &r->settings, &r->how, &out->volume, &out->transfer));
    const snow_status status =
        snow_frame_new(snow_comm_context(comm), &out->frame);
    if (status != SNOW_STATUS_OK)
        opened_leave(out);
    return status;
}

snow_status opened_cut(opened *o, const snow_view *view) {
    const opened_request *r = o->request;
    return snow_ranks_repartition(o->comm, o->transfer, view, &r->settings,
                                  &r->how, &o->volume);
}

snow_status opened_draw(opened *o, const snow_view *view, snow_image **image) {
    const opened_request *r = o->request;
    return snow_ranks_render(o->frame, o->comm, o->volume, o->transfer, view,
                             &r->settings, &r->how, image);
}
