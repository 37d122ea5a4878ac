/* bench/tables/figures.c - figures 11 and 12 of the paper, measured: the nodes'
 * work is done and timed, one node after another; the network between them is
 * simulated (snow_comm_run_simulated).
 *
 * Each node holds a slab, the paper's equal ones, encodes it, splats it, and
 * the local images are combined at node 0.  Reading is not timed.  The SP2 is
 * this machine made slower by one factor, chosen so that the original splatting
 * takes on one node what it took there (Table 2), with a network of 35 MB/s and
 * 40 us. */
#include "figures.h"
#include "chart.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define IMAGE_SIDE 256 /* of the paper's pictures, section 5.2 */
#define TINY_SIDE 48   /* of a test's */
#define FOOTPRINT 2
#define PICTURES 3 /* of a run */
#define NODES_MOST 32
#define TOLERANCE (0.5 / 255)

/* One picture by some nodes. */
typedef struct figure_job {
    const bench_volume *volume;
    const figure_volume *paper;
    bench_way way;
    const figure_cluster *cluster;
    int side, pictures;
    const snow_image *expected; /* NULL: keep the picture instead */
    snow_image *kept;
    figure_time least;
    double largest;
    figure_progress *progress;
    int counted_way; /* for the progress; below 0: not counted */
} figure_job;

/* Which slices are the node's.  The original splatting works on all voxels, so
 * its slabs are equal by any measure. */
static snow_status plan(snow_comm *comm, const figure_job *job,
                        snow_box *mine) {
    snow_context *context = snow_comm_context(comm);
    snow_box parts[NODES_MOST];
    snow_volume *whole;
    snow_transfer *transfer = NULL;
    SNOW_TRY(snow_volume_wrap(context,
                              snow_volume_get_info(job->volume->volume),
                              snow_volume_voxels(job->volume->volume), &whole));
    snow_status status =
        snow_transfer_new_for_volume(whole, &bench_linear_look, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_ranks_partition(whole, transfer, job->paper->threshold,
                                      job->way == BENCH_ORIGINAL
                                          ? SNOW_PARTITION_EQUAL
                                          : job->cluster->cut,
                                      2, snow_comm_size(comm), parts, NULL);
    if (status == SNOW_STATUS_OK)
        *mine = parts[snow_comm_rank(comm)];
    snow_transfer_free(transfer);
    snow_volume_close(whole);
    return status;
}

/* The slab of a node.  One without slices holds one that is not its own. */
static snow_status open_slab(snow_comm *comm, const figure_job *job,
                             snow_volume **out) {
    snow_volume_info info = *snow_volume_get_info(job->volume->volume);
    const char *voxels = snow_volume_voxels(job->volume->volume);
    snow_extent part = {.size = sizeof part};
    snow_box box;
    SNOW_TRY(plan(comm, job, &box));
    memcpy(part.dims, info.dims, sizeof part.dims);
    memcpy(part.first, box.first, sizeof part.first);
    memcpy(part.count, box.count, sizeof part.count);
    bool none = part.count[2] == 0;
    memset(part.stored, 0, sizeof part.stored);
    part.stored[2] = none ? 0 : part.first[2];
    info.dims[2] = none ? 1 : part.count[2];
    for (int row = 0; row < 3; row++)
        info.matrix[row][3] += info.matrix[row][2] * (double)part.stored[2];
    size_t slice =
        (size_t)(info.dims[0] * info.dims[1]) * snow_type_size(info.type);
    snow_status status =
        snow_volume_wrap(snow_comm_context(comm), &info,
                         voxels + (size_t)part.stored[2] * slice, out);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_set_extent(*out, &part);
    return status;
}

/* As in Table 2: a voxel a pixel, no shading, plain loops, one thread. */
static snow_status settle(const figure_job *job, snow_context *context,
                          snow_view *view, snow_settings *settings) {
    snow_view_init(view);
    snow_status status = snow_view_from_name(context, "+z", view);
    view->width = view->height = job->side;
    view->zoom =
        snow_view_zoom_for_voxels(job->volume->volume, job->side, job->side);
    snow_settings_init(settings);
    settings->kernel = SNOW_KERNEL_GAUSS;
    settings->footprint = FOOTPRINT;
    settings->shade = SNOW_SHADE_NONE;
    settings->isa = SNOW_ISA_SCALAR;
    settings->threads = 1;
    settings->threshold = job->paper->threshold;
    bench_way_settings(job->way, settings);
    return status;
}

/* What a node needs for its pictures. */
typedef struct figure_node {
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    snow_view view;
    snow_settings settings;
} figure_node;

static snow_status equip(snow_comm *comm, const figure_job *job,
                         figure_node *node) {
    snow_context *context = snow_comm_context(comm);
    snow_status status = open_slab(comm, job, &node->volume);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(node->volume, &bench_linear_look,
                                              &node->transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(context, &node->frame);
    if (status == SNOW_STATUS_OK)
        status = settle(job, context, &node->view, &node->settings);
    return snow_comm_agree_status(comm, status);
}

/* Collective.  What the nodes' local images took of this machine. */
static snow_status compare_nodes(snow_comm *comm, const figure_node *node,
                                 figure_time *out) {
    const int nodes = snow_comm_size(comm);
    double mine = snow_frame_ranks_stats(node->frame)->cpu_splat;
    double all[NODES_MOST];
    snow_status status = snow_comm_allgather(comm, &mine, sizeof mine, all);
    for (int n = 0; n < nodes && status == SNOW_STATUS_OK; n++) {
        out->slowest = fmax(out->slowest, all[n]);
        out->mean += all[n] / nodes;
    }
    return status;
}

/* The least of the pictures is kept: what disturbs a node is not its work.
 * Nodes begin together, since they have just agreed. */
static snow_status time_picture(snow_comm *comm, figure_job *job,
                                figure_node *node, snow_image **image) {
    double start = snow_comm_seconds(comm);
    snow_image_free(*image);
    *image = NULL;
    const snow_ranks_options how = {.size = sizeof how,
                                    .combining = job->cluster->combining};
    snow_status status =
        snow_ranks_render(node->frame, comm, node->volume, node->transfer,
                          &node->view, &node->settings, &how, image);
    figure_time taken = {.seconds = snow_comm_seconds(comm) - start};
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK)
        status = compare_nodes(comm, node, &taken);
    if (snow_comm_rank(comm) == 0 && taken.seconds < job->least.seconds)
        job->least = taken;
    return status;
}

/* The first picture makes room, the others are timed. */
static snow_status time_pictures(snow_comm *comm, figure_job *job,
                                 figure_node *node) {
    snow_image *image = NULL;
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n <= job->pictures && status == SNOW_STATUS_OK; n++) {
        if (n <= 1 && snow_comm_rank(comm) == 0)
            job->least.seconds = INFINITY;
        status = time_picture(comm, job, node, &image);
    }
    if (snow_comm_rank(comm) != 0 || status != SNOW_STATUS_OK)
        return status;
    snow_image_difference difference = {.size = sizeof difference};
    if (!job->expected) {
        /* The picture goes with its context: its pixels are copied. */
        memcpy(snow_image_pixels(job->kept), snow_image_pixels(image),
               (size_t)job->side * (size_t)job->side * 2 * sizeof(float));
    } else {
        status = snow_image_compare(image, job->expected, &difference);
        job->largest = difference.largest;
    }
    snow_image_free(image);
    return status;
}

static snow_status be_node(snow_comm *comm, void *user) {
    figure_job *job = user;
    figure_node node = {0};
    snow_status status = equip(comm, job, &node);
    if (status == SNOW_STATUS_OK)
        status = time_pictures(comm, job, &node);
    snow_frame_free(node.frame);
    snow_transfer_free(node.transfer);
    snow_volume_close(node.volume);
    return status;
}

/* The least of some runs. */
static snow_status measure(snow_context *context, const snow_network *network,
                           int nodes, int runs, figure_job *job,
                           figure_time *out) {
    *out = (figure_time){.seconds = INFINITY};
    for (int run = 0; run < runs; run++) {
        double begin = figure_progress_clock();
        SNOW_TRY(
            snow_comm_run_simulated(context, nodes, network, be_node, job));
        if (job->least.seconds < out->seconds)
            *out = job->least;
        if (job->counted_way >= 0)
            figure_progress_step(job->progress, job->counted_way,
                                 figure_progress_clock() - begin,
                                 job->volume->name, nodes);
    }
    out->slowest *= network->slowness;
    out->mean *= network->slowness;
    return SNOW_STATUS_OK;
}

/* All node counts of a way on a cluster.  The picture of one node is what the
 * others are held against. */
static snow_status measure_way(snow_context *context, int runs,
                               const snow_network *network, figure_job *job,
                               figure_time *taken, double *largest) {
    job->expected = NULL;
    for (int n = 0; n < FIGURE_NODES; n++) {
        SNOW_TRY(
            measure(context, network, figure_nodes[n], runs, job, &taken[n]));
        job->expected = job->kept;
        if (job->largest > *largest)
            *largest = job->largest;
    }
    return SNOW_STATUS_OK;
}

static snow_status measure_cluster(snow_context *context, int runs, int cluster,
                                   figure_job *job, figure_times *times) {
    snow_network network = figure_clusters[cluster].network;
    job->cluster = &figure_clusters[cluster];
    snow_status status = SNOW_STATUS_OK;
    if (network.slowness == 0) { /* what one node of ours takes, first */
        snow_network ours = network;
        ours.slowness = 1;
        job->way = BENCH_ORIGINAL;
        job->counted_way = -1;
        job->expected = NULL;
        figure_time alone;
        status = measure(context, &ours, 1, runs, job, &alone);
        if (status == SNOW_STATUS_OK)
            network.slowness = job->paper->paper_seconds / alone.seconds;
    }
    times->slowness[cluster] = network.slowness;
    for (int way = 0; way < FIGURE_WAYS && status == SNOW_STATUS_OK; way++) {
        job->way = figure_ways[way];
        job->counted_way = way;
        status = measure_way(context, runs, &network, job,
                             times->taken[cluster][way], &times->largest);
    }
    return status;
}

static snow_status
measure_volume(snow_context *context, const bench_options *options,
               const figure_volume *paper, bench_volume *volume,
               figure_progress *progress, figure_times *times) {
    figure_job job = {.volume = volume,
                      .paper = paper,
                      .side = options->quick ? TINY_SIDE : IMAGE_SIDE,
                      .pictures = options->quick ? 1 : PICTURES,
                      .progress = progress};
    times->source = volume->source;
    snow_status status =
        snow_transfer_sparse_ratio(volume->transfer, volume->volume,
                                   paper->threshold, &times->sparse_ratio);
    if (status == SNOW_STATUS_OK)
        status = snow_image_new(context, job.side, job.side, 2, &job.kept);
    for (int c = 0; c < FIGURE_CLUSTERS && status == SNOW_STATUS_OK; c++)
        status = measure_cluster(context, options->runs, c, &job, times);
    snow_image_free(job.kept);
    if (status == SNOW_STATUS_OK && times->largest > TOLERANCE) {
        fprintf(stderr,
                "snowglass: bench: %s: the nodes' picture is %g off that of "
                "one; nothing is printed\n",
                volume->name, times->largest);
        return SNOW_STATUS_DIFFERENT;
    }
    return status;
}

static int run_figure(snow_context *context, const bench_options *options,
                      int figure) {
    bench_volume volumes[FIGURE_VOLUMES] = {{0}};
    figure_times times[FIGURE_VOLUMES] = {{0}};
    figure_progress progress;
    snow_status status = SNOW_STATUS_OK;
    if (options->chart && chart_check(options->chart) != SNOW_STATUS_OK)
        return SNOW_STATUS_BAD_OUTPUT;
    figure_progress_begin(&progress, figure, options->runs);
    for (int i = 0; i < FIGURE_VOLUMES && status == SNOW_STATUS_OK; i++) {
        const figure_volume *paper = &figure_volumes[i];
        status = bench_volume_open(context, paper->set, options, &volumes[i]);
        if (status == SNOW_STATUS_OK)
            status = measure_volume(context, options, paper, &volumes[i],
                                    &progress, &times[i]);
    }
    figure_progress_end(&progress);
    int code = status == SNOW_STATUS_DIFFERENT ? SNOW_STATUS_FAILED
               : status == SNOW_STATUS_OK      ? SNOW_STATUS_OK
                                               : bench_fail(context, status);
    if (code == SNOW_STATUS_OK && options->chart)
        code = (int)figure_chart(options, figure, times);
    if (code == SNOW_STATUS_OK && options->json)
        code = figure_print_json(options, figure, times);
    else if (code == SNOW_STATUS_OK)
        figure_print(options, figure, times);
    for (int i = 0; i < FIGURE_VOLUMES; i++)
        bench_volume_close(&volumes[i]);
    return code;
}

int bench_figure11(snow_context *context, const bench_options *options) {
    return run_figure(context, options, 11);
}

int bench_figure12(snow_context *context, const bench_options *options) {
    return run_figure(context, options, 12);
}
