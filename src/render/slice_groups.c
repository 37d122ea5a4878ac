/* render/slice_groups.c - deterministic pictures of the footprint methods: each
 * group of slices is drawn by itself, and groups are composited by one binary
 * tree (decompose/deterministic.h). */
#include "base/clear.h"
#include "render/picture.h"

/* Lines 02 to 13. */
static snow_status draw_part(snow_picture *p, snow_job *job) {
    const snow_render_method *method = &snow_method_footprint;
    SNOW_TRY(method->classify_and_shade(p, job));
    SNOW_TRY(method->encode(p, job));
    SNOW_TRY(method->splat_and_composite(p, job));
    return snow_footprint_count(p->frame->footprint, job);
}

/* One group, as a slab. */
static snow_status render_group(snow_picture *p, const snow_job *job,
                                snow_slab slab, float *pixels) {
    snow_job group = *job;
    group.slab = group.stored_slab = slab;
    group.stored_slab.first -= job->clip.stored[2];
    group.pixels = pixels;
    return draw_part(p, &group);
}

bool snow_group_rises(const snow_placement *p, snow_group_node node) {
    if (!p->perspective)
        return p->nearest_first;
    int middle = (2 * node.index + 1) << (node.rank - 1);
    return p->eye.at[2] <
           (double)snow_group_slab(p->slices, middle).first - 0.5;
}

/* A node into `pixels`, which are transparent. */
static snow_status render_node(snow_picture *p, const snow_job *job,
                               snow_group_node node, float *pixels) {
    snow_frame *frame = p->frame;
    size_t count = (size_t)job->view->width * (size_t)job->view->height;
    size_t bytes = count * (size_t)job->channels * sizeof *pixels;
    int64_t slices = job->placement.slices;
    snow_slab first = snow_group_slab(slices, node.index << node.rank);
    if (first.count == 0)
        return SNOW_STATUS_OK; /* as all behind it */
    if (node.rank == 0)
        return render_group(p, job, first, pixels);
    float **spare = &frame->spare[node.rank - 1];
    SNOW_TRY(snow_reserve(frame->context, spare, 0, 1, bytes));
    SNOW_TRY(snow_clear(frame->context, *spare, bytes));
    bool rises = snow_group_rises(&job->placement, node);
    snow_group_node near = {node.rank - 1, 2 * node.index + !rises};
    snow_group_node far = {node.rank - 1, 2 * node.index + rises};
    SNOW_TRY(render_node(p, job, near, pixels));
    SNOW_TRY(render_node(p, job, far, *spare));
    snow_job_composite(job)(pixels, *spare, count);
    return SNOW_STATUS_OK;
}

/* All nodes of the local image. */
static snow_status draw_nodes(snow_picture *p, snow_job *job) {
    size_t floats = snow_job_bytes(job) / sizeof *job->pixels;
    for (int n = 0; n < p->local.layers; n++)
        SNOW_TRY(render_node(p, job, p->local.nodes[n],
                             job->pixels + (size_t)n * floats));
    return SNOW_STATUS_OK;
}

const snow_render_method snow_method_groups = {
    .splat_and_composite = draw_nodes,
};
