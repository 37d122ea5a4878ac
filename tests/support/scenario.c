/* tests/support/scenario.c - see scenario.h. */
#include "support/scenario.h"

#include "decompose/deterministic.h"
#include "image/image.h"
#include "render/ghosts.h"
#include "render/picture.h"

#include <math.h>

scenario scenario_of(const reference_scene *scene, int n,
                     const snow_transfer *transfer) {
    return (scenario){.info = scene->info,
                      .voxels = scene->voxels,
                      .masked = scene->masked,
                      .transfer = transfer,
                      .view = scene->view,
                      .settings = scene->settings,
                      .how = {.size = sizeof(snow_ranks_options),
                              .combining = (snow_combine)(n % 5)},
                      .pictures = 1 + n % 2};
}

size_t scenario_floats(const scenario *p) {
    return (size_t)p->view.width * (size_t)p->view.height * (size_t)p->channels;
}

static int slice_axis(snow_context *context, const scenario *p) {
    snow_placement placement;
    if (snow_placement_make(context, &p->info, &p->view, &placement) !=
        SNOW_STATUS_OK)
        return 0;
    return placement.slice_axis;
}

/* Cuts a box in two until each rank has one: by the number of ranks, or by half
 * of that. */
static void halve(snow_box box, int first, int count, bool uneven,
                  snow_box *boxes) {
    int longest = 0;
    boxes[first] = box;
    if (count == 1)
        return;
    for (int axis = 1; axis < 3; axis++)
        if (box.count[axis] > box.count[longest])
            longest = axis;
    snow_box low = box, high = box;
    low.count[longest] = box.count[longest] * (count / 2) / count;
    if (uneven)
        low.count[longest] = (low.count[longest] + 1) / 2;
    high.first[longest] += low.count[longest];
    high.count[longest] -= low.count[longest];
    halve(low, first, count / 2, uneven, boxes);
    halve(high, first + count / 2, count - count / 2, uneven, boxes);
}

void scenario_partition(snow_context *context, scenario *p, int ranks) {
    const int64_t *dims = p->info.dims;
    int axis = slice_axis(context, p);
    if (p->cut == ALONG_OTHER)
        axis = (axis + 1) % 3;
    snow_box all = {{0, 0, 0}, {dims[0], dims[1], dims[2]}};
    if (p->cut == BRICKS || p->cut == UNEVEN) {
        halve(all, 0, ranks, p->cut == UNEVEN, p->boxes);
        return;
    }
    for (int rank = 0; rank < ranks; rank++) {
        snow_slab slab = p->cut == GROUPED
                             ? snow_slab_grouped(dims[axis], ranks, rank)
                             : snow_slab_equal(dims[axis], ranks, rank);
        p->boxes[rank] = all;
        p->boxes[rank].first[axis] = slab.first;
        p->boxes[rank].count[axis] = slab.count;
    }
}

/* A box with its ghosts, as a volume. */
static snow_status open_part(snow_context *context, const scenario *p,
                             const snow_box *box, scenario_rank *r) {
    snow_volume_info info = p->info;
    size_t size = snow_type_size(info.type);
    int64_t layers[3];
    snow_extent part = {sizeof part, {0}, {0}, {0}, {0}};
    bool none = !snow_box_voxels(box);
    SNOW_TRY(snow_ghosts_needed(context, &p->info, &p->view, &p->settings,
                                snow_transfer_slopes(p->transfer, &p->info),
                                false, layers));
    for (int axis = 0; axis < 3; axis++) {
        int64_t low = none ? 0 : box->first[axis] - layers[axis];
        int64_t high =
            none ? 1 : box->first[axis] + box->count[axis] + layers[axis];
        part.dims[axis] = p->info.dims[axis];
        part.first[axis] = none ? 0 : box->first[axis];
        part.count[axis] = none ? 0 : box->count[axis];
        part.stored[axis] = low > 0 ? low : 0;
        high = high < part.dims[axis] ? high : part.dims[axis];
        info.dims[axis] = high - part.stored[axis];
    }
    for (int row = 0; row < 3; row++)
        for (int axis = 0; axis < 3; axis++)
            info.matrix[row][3] +=
                info.matrix[row][axis] * (double)part.stored[axis];
    size_t line = (size_t)info.dims[0] * size;
    char *to = r->voxels = malloc(line * (size_t)(info.dims[1] * info.dims[2]));
    for (int64_t z = 0; z < info.dims[2]; z++)
        for (int64_t y = 0; y < info.dims[1]; y++, to += line) {
            int64_t at =
                ((part.stored[2] + z) * part.dims[1] + part.stored[1] + y) *
                    part.dims[0] +
                part.stored[0];
            memcpy(to, (const char *)p->voxels + (size_t)at * size, line);
        }
    SNOW_TRY(snow_volume_wrap(context, &info, r->voxels, &r->volume));
    snow_volume_freeze(r->volume);
    return snow_volume_set_extent(r->volume, &part);
}

static snow_status copy_transfer(snow_context *context, const snow_transfer *t,
                                 snow_transfer **out) {
    SNOW_TRY(snow_transfer_new(context, t->colors, t->color_count, t->opacities,
                               t->opacity_count, out));
    return snow_transfer_set_gradient_opacity(*out, t->gradients,
                                              t->gradient_count);
}

static snow_status add_layer(const scenario *p, bool alone, scenario_rank *r) {
    snow_context *context = r->frame->context;
    if (!p->layer)
        return SNOW_STATUS_OK;
    SNOW_TRY(copy_transfer(context, p->layer_look, &r->look));
    SNOW_TRY(alone ? snow_volume_open(context, p->layer, NULL, &r->layer)
                   : snow_volume_open_streamed(context, p->layer, NULL, 3000,
                                               &r->layer));
    if (alone)
        SNOW_TRY(snow_volume_regrid(
            &r->layer, r->volume,
            snow_transfer_has_labels(r->look, &r->layer->info)));
    const snow_layer layer = {.volume = r->layer, .transfer = r->look};
    return snow_frame_set_layers(r->frame, &layer, 1);
}

void scenario_leave(scenario_rank *r) {
    snow_frame_free(r->frame);
    snow_transfer_free(r->transfer);
    snow_transfer_free(r->look);
    snow_volume_close(r->layer);
    snow_volume_close(r->volume);
    free(r->voxels);
}

snow_status scenario_enter(snow_context *context, const scenario *p,
                           const snow_box *box, scenario_rank *r) {
    *r = (scenario_rank){.voxels = NULL};
    snow_status status =
        box ? open_part(context, p, box, r)
            : snow_volume_wrap(context, &p->info, p->voxels, &r->volume);
    if (status == SNOW_STATUS_OK) {
        r->volume->masked = p->masked;
        status = copy_transfer(context, p->transfer, &r->transfer);
    }
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(context, &r->frame);
    if (status == SNOW_STATUS_OK)
        status = add_layer(p, !box, r);
    if (status != SNOW_STATUS_OK)
        scenario_leave(r);
    return status;
}

/* Of the picture that a frame has made. */
static void keep_depths(const scenario *p, snow_frame *frame) {
    if (p->depths)
        memcpy(p->depths, snow_frame_depth(frame)->pixels,
               (size_t)p->view.width * (size_t)p->view.height * sizeof(float));
}

static snow_status draw_part(snow_comm *comm, scenario *p, scenario_rank *r) {
    snow_context *context = snow_comm_context(comm);
    int rank = snow_comm_rank(comm);
    snow_image *image = NULL;
    SNOW_TRY(snow_ranks_render(r->frame, comm, r->volume, r->transfer, &p->view,
                               &p->settings, &p->how, &image));
    if ((rank == 0) != (image != NULL)) {
        snow_image_free(image);
        return snow_fail(context, SNOW_STATUS_BAD_OUTPUT, "a picture too many");
    }
    if (rank == 0) {
        memcpy(p->picture, snow_image_pixels(image),
               scenario_floats(p) * sizeof(float));
        p->stats = *snow_frame_stats(r->frame);
        p->ranks = snow_frame_ranks_stats(r->frame)->ranks;
        keep_depths(p, r->frame);
    }
    p->each[rank] = *snow_frame_stats(r->frame);
    snow_image_free(image);
    return SNOW_STATUS_OK;
}

snow_status scenario_perform(snow_comm *comm, void *user) {
    scenario *p = user;
    scenario_rank r;
    SNOW_TRY(scenario_enter(snow_comm_context(comm), p,
                            &p->boxes[snow_comm_rank(comm)], &r));
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n < p->pictures && status == SNOW_STATUS_OK; n++)
        status = draw_part(comm, p, &r);
    scenario_leave(&r);
    return status;
}

float *scenario_alone(snow_context *context, scenario *p, double *strongest) {
    scenario_rank r;
    snow_image *image = NULL;
    if (scenario_enter(context, p, NULL, &r) != SNOW_STATUS_OK ||
        snow_frame_render(r.frame, r.volume, r.transfer, &p->view, &p->settings,
                          &image) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    p->interesting = snow_frame_stats(r.frame)->interesting;
    p->voxels_drawn = snow_frame_stats(r.frame)->voxels;
    p->channels = snow_image_channels(image);
    float *pixels = malloc(scenario_floats(p) * sizeof(float));
    assert_non_null(pixels);
    memcpy(pixels, snow_image_pixels(image),
           scenario_floats(p) * sizeof(float));
    keep_depths(p, r.frame);
    size_t channels = (size_t)p->channels;
    *strongest = 0;
    for (size_t n = channels - 1; n < scenario_floats(p); n += channels)
        *strongest = fmax(*strongest, (double)pixels[n]);
    snow_image_free(image);
    scenario_leave(&r);
    return pixels;
}

void scenario_by_ranks(snow_context *context, scenario *p, int ranks) {
    p->picture = calloc(scenario_floats(p), sizeof(float));
    assert_non_null(p->picture);
    scenario_partition(context, p, ranks);
    if (snow_comm_run_threads(context, ranks, scenario_perform, p) !=
        SNOW_STATUS_OK)
        fail_msg("%d ranks: %s", ranks, snow_context_message(context));
}

double scenario_difference(const float *a, const float *b, size_t count,
                           bool relative) {
    double most = 0, gap = 0;
    for (size_t n = 0; n < count; n++) {
        if (isnan(a[n]) != isnan(b[n]))
            return INFINITY;
        if (isnan(a[n]))
            continue;
        gap = fmax(gap, fabs((double)a[n] - (double)b[n]));
        most = fmax(most, fabs((double)b[n]));
    }
    return relative && most > 0 ? gap / most : gap;
}

void scenario_check_counts(const scenario *p, int ranks) {
    int64_t interesting = 0, voxels = 0, all = p->voxels_drawn;
    for (int rank = 0; rank < ranks; rank++) {
        interesting += p->each[rank].interesting;
        voxels += p->each[rank].voxels;
    }
    if (interesting != p->interesting || voxels != all)
        fail_msg("%d ranks count %lld of %lld voxels as interesting, one "
                 "counts %lld of %lld; cut %d, method %d, quality %d",
                 ranks, (long long)interesting, (long long)voxels,
                 (long long)p->interesting, (long long)all, (int)p->cut,
                 (int)p->settings.method, (int)p->settings.quality);
}
