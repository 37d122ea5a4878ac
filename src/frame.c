/* frame.c - one picture, from voxels to pixels: figure 8 of the paper, whose
 * line numbers stand in the margins of render_slab and its callers.  Each line
 * calls one stage of figure 7; how a stage works is told in its folder. */
#include "frame.h"
#include "base/base.h"
#include "classify/classify.h"
#include "combine/combine.h"
#include "composite/over.h"
#include "decompose/slab.h"
#include "encode/encode.h"
#include "image/image.h"
#include "sheared.h"
#include "splat/splat.h"
#include "transform/transform.h"

#include <math.h>

struct snow_frame {
    snow_context *context;
    snow_stats stats;
    /* Buffers of the stages, kept from picture to picture. */
    snow_sparse sparse; /* EA, IA, PA */
    snow_sheet sheet;
    snow_span *spans; /* of one row */
    size_t spans_capacity;
    /* Made when the method is first used; one for each axis where a picture is
     * blended of several, else the first. */
    snow_sheared *sheared[3];
    float *layer; /* a picture to be blended */
    size_t layer_capacity;
};

/* What one picture is made from; lives as long as the call. */
typedef struct snow_job {
    snow_frame *frame;
    snow_settings settings; /* with every AUTO resolved */
    snow_placement placement;
    snow_slab slab;
    snow_classifier classifier;
    snow_shader shader;
    snow_strip strip;
    snow_splatter splatter;
    int channels;
    float *pixels; /* the local image */
    int64_t kept;  /* voxels splatted out of strips */
} snow_job;

snow_status snow_frame_new(snow_context *context, snow_frame **out) {
    snow_frame *frame = snow_allocate_clear(context, sizeof *frame);
    if (!frame)
        return SNOW_NO_MEMORY;
    frame->context = frame->sparse.context = context;
    *out = frame;
    return SNOW_OK;
}

void snow_frame_free(snow_frame *frame) {
    if (!frame)
        return;
    snow_sparse_fini(&frame->sparse);
    snow_release(frame->context, frame->sheet.pixels);
    snow_release(frame->context, frame->spans);
    for (int axis = 0; axis < 3; axis++)
        snow_sheared_free(frame->sheared[axis]);
    snow_release(frame->context, frame->layer);
    snow_release(frame->context, frame);
}

const snow_stats *snow_frame_stats(const snow_frame *frame) {
    return &frame->stats;
}

/* Adds the seconds since *mark to a total, and moves the mark. */
static void lap(double *mark, double *total) {
    double now = snow_seconds();
    *total += now - *mark;
    *mark = now;
}

/* Classifies and shades rows of a slice from `row` on into the job's strip. */
static void classify_and_shade(snow_job *job, int64_t slice, int64_t row) {
    snow_stats *stats = &job->frame->stats;
    snow_strip *strip = &job->strip;
    int64_t rows = job->placement.rows - row;
    double mark = snow_seconds();
    snow_classify_strip(&job->classifier, &job->placement, slice, row,
                        rows < strip->room_rows ? rows : strip->room_rows,
                        strip);
    lap(&mark, &stats->seconds_classify);
    if (job->settings.shade == SNOW_SHADE_PHONG)
        snow_shade_strip(&job->shader, job->channels, strip);
    lap(&mark, &stats->seconds_shade);
}

/* Measures density and runs on every 8th row of every 8th slice. */
static snow_encoding choose_encoding(snow_job *job) {
    const snow_placement *p = &job->placement;
    uint64_t voxels = 0, interesting = 0, runs = 0;
    for (int64_t slice = 0; slice < p->slices; slice += 8)
        for (int64_t row = slice / 8 % 8; row < p->rows; row += 8) {
            snow_classify_strip(&job->classifier, p, slice, row, 1,
                                &job->strip);
            voxels += (uint64_t)p->columns;
            interesting += job->strip.count;
            runs += snow_spans_of_columns(job->strip.columns, job->strip.count,
                                          job->frame->spans);
        }
    return snow_encoding_choose(voxels, interesting, runs);
}

/* Lines 04 to 06: one slice into the sparse matrix. */
static snow_status encode_slice(snow_job *job, int64_t slice) {
    snow_sparse *sparse = &job->frame->sparse;
    SNOW_TRY(snow_sparse_begin_slice(sparse));
    for (int64_t row = 0; row < job->placement.rows;
         row += job->strip.room_rows) {
        classify_and_shade(job, slice, row);
        double mark = snow_seconds();
        SNOW_TRY(snow_sparse_add_strip(sparse, &job->strip));
        lap(&mark, &job->frame->stats.seconds_encode);
    }
    return snow_sparse_end_slice(sparse);
}

/* Lines 08 to 12: the interesting voxels of one slice, out of EA and IA. */
static void splat_encoded_slice(snow_job *job, int64_t slice) {
    snow_walk walk;
    snow_walk_begin(&walk, &job->frame->sparse, slice - job->slab.first);
    for (int64_t row = 0; row < job->placement.rows; row++) {
        size_t voxel;
        size_t count = snow_walk_row(&walk, job->frame->spans, &voxel);
        snow_splat_row(&job->splatter, &job->frame->sheet, row,
                       job->frame->spans, count,
                       job->frame->sparse.ia + voxel * (size_t)job->channels);
    }
}

/* The same without a sparse matrix, row by row out of the volume: original
 * splatting, where the classifier keeps every voxel, and tested splatting. */
static void splat_classified_slice(snow_job *job, int64_t slice) {
    snow_strip *strip = &job->strip;
    for (int64_t row = 0; row < job->placement.rows; row += strip->room_rows) {
        classify_and_shade(job, slice, row);
        double mark = snow_seconds();
        job->kept += (int64_t)strip->count;
        size_t begin = 0;
        for (int64_t n = 0; n < strip->rows; n++) {
            size_t end = strip->row_end[n];
            size_t spans = snow_spans_of_columns(
                strip->columns + begin, end - begin, job->frame->spans);
            snow_splat_row(&job->splatter, &job->frame->sheet, row + n,
                           job->frame->spans, spans,
                           strip->samples + begin * (size_t)job->channels);
            begin = end;
        }
        lap(&mark, &job->frame->stats.seconds_splat);
    }
}

/* The slab's n-th slice from the viewer. */
static int64_t nth_slice(const snow_job *job, int64_t n) {
    snow_slab slab = job->slab;
    return slab.first + (job->placement.nearest_first ? n : slab.count - 1 - n);
}

/* Line 07, from front to back: the slab's slices onto the sheet, and each
 * sheet into the local image. */
static void splat_and_composite(snow_job *job) {
    snow_stats *stats = &job->frame->stats;
    for (int64_t n = 0; n < job->slab.count; n++) {
        int64_t slice = nth_slice(job, n);
        snow_splatter_begin_slice(&job->splatter, slice);
        double mark = snow_seconds();
        if (job->settings.method == SNOW_METHOD_FOOTPRINT) {
            splat_encoded_slice(job, slice);
            lap(&mark, &stats->seconds_splat);
        } else {
            splat_classified_slice(job, slice);
            mark = snow_seconds();
        }
        snow_composite_sheet(job->pixels, &job->frame->sheet);
        lap(&mark, &stats->seconds_composite);
    }
}

/* Leaves to footprints what the sheared method cannot make: along the best axis
 * or, in high quality, another that the picture may be blended of. */
static snow_status check_sheared(snow_job *job, const snow_volume *volume,
                                 const snow_view *view) {
    snow_settings *settings = &job->settings;
    bool fits = snow_sheared_fits(&job->placement, settings);
    double shares[3] = {0};
    if (settings->quality == SNOW_QUALITY_HIGH)
        snow_placement_shares(&volume->info, &job->placement, shares);
    for (int axis = 0; axis < 3; axis++) {
        snow_placement placement;
        if (shares[axis] == 0)
            continue;
        SNOW_TRY(snow_placement_make_along(job->frame->context, &volume->info,
                                           view, axis, &placement));
        fits = fits && snow_sheared_fits(&placement, settings);
    }
    if (!fits)
        settings->method = SNOW_METHOD_FOOTPRINT;
    return SNOW_OK;
}

/* Lines 01 and 02 for every method: settings, camera, slab. */
static snow_status place(snow_job *job, const snow_volume *volume,
                         const snow_view *view, int parts, int part) {
    snow_context *context = job->frame->context;
    SNOW_TRY(snow_settings_resolve(context, volume, &job->settings));
    SNOW_TRY(
        snow_placement_make(context, &volume->info, view, &job->placement));
    if (job->settings.method == SNOW_METHOD_SHEARED)
        SNOW_TRY(check_sheared(job, volume, view));
    job->slab = snow_slab_equal(job->placement.slices, parts, part);
    return SNOW_OK;
}

/* Classifier, shader, splatter and buffers for this volume, look and view. */
static snow_status prepare(snow_job *job, const snow_volume *volume,
                           const snow_transfer *transfer) {
    snow_frame *frame = job->frame;
    snow_context *context = frame->context;
    snow_settings *settings = &job->settings;
    const snow_placement *p = &job->placement;
    snow_classify_options options = {
        .threshold = settings->threshold,
        .opacity_exponent = p->path / settings->opacity_length,
        .keep_all = settings->method == SNOW_METHOD_ORIGINAL,
        .premultiply = settings->shade == SNOW_SHADE_NONE,
    };
    SNOW_TRY(snow_classifier_init(context, volume, transfer, &options,
                                  &job->classifier));
    /* Lines 02 and 03; normals are made for the voxels that are kept. */
    SNOW_TRY(snow_shader_init(context, volume, p, settings, &job->shader));
    SNOW_TRY(snow_strip_init(context, p, job->channels, &job->strip));
    SNOW_TRY(snow_splatter_init(context, p, settings->kernel,
                                settings->footprint, job->channels,
                                &job->splatter));
    double mark = snow_seconds();
    SNOW_TRY(snow_sheet_begin(context, p->width, p->height, job->channels,
                              &frame->sheet));
    lap(&mark, &frame->stats.seconds_composite);
    return snow_reserve(context, &frame->spans, &frame->spans_capacity, 0,
                        ((size_t)p->columns / 2 + 1) * sizeof *frame->spans);
}

/* Lines 04 to 06 for the slab: the volume into the sparse matrix. */
static snow_status encode_slab(snow_job *job) {
    snow_settings *settings = &job->settings;
    if (settings->encoding == SNOW_ENCODING_AUTO)
        settings->encoding = choose_encoding(job);
    SNOW_TRY(snow_sparse_begin(&job->frame->sparse,
                               snow_scheme_of(settings->encoding),
                               &job->placement, job->channels));
    for (int64_t n = 0; n < job->slab.count; n++)
        SNOW_TRY(encode_slice(job, job->slab.first + n));
    return SNOW_OK;
}

static void finish(snow_job *job) {
    snow_context *context = job->frame->context;
    snow_splatter_fini(context, &job->splatter);
    snow_strip_free(context, &job->strip);
    snow_classifier_fini(context, &job->classifier);
}

/* What is known at the end beside the times.  Original splatting keeps every
 * voxel, so nothing holds the number of interesting ones, and they are counted
 * here: over the whole volume, and outside of seconds_frame. */
static snow_status fill_stats(const snow_job *job, const snow_volume *volume,
                              const snow_transfer *transfer,
                              snow_stats *stats) {
    const snow_sparse *sparse = &job->frame->sparse;
    const snow_placement *p = &job->placement;
    stats->method = job->settings.method;
    stats->footprint = job->settings.footprint;
    stats->slice_axis = p->slice_axis;
    stats->threads = job->settings.threads;
    stats->isa = job->settings.isa;
    stats->quality = job->settings.quality;
    stats->voxels = p->columns * p->rows * job->slab.count;
    double voxels = (double)stats->voxels;
    if (stats->method == SNOW_METHOD_TESTED) {
        stats->interesting = job->kept;
        stats->sparse_ratio = voxels > 0 ? 1 - (double)job->kept / voxels : 1;
        return SNOW_OK;
    }
    if (stats->method == SNOW_METHOD_ORIGINAL) {
        SNOW_TRY(snow_transfer_sparse_ratio(
            transfer, volume, job->settings.threshold, &stats->sparse_ratio));
        stats->interesting = llround(voxels * (1 - stats->sparse_ratio));
        return SNOW_OK;
    }
    if (stats->method == SNOW_METHOD_SHEARED) {
        if (voxels > 0)
            stats->sparse_ratio = 1 - (double)stats->interesting / voxels;
        return SNOW_OK;
    }
    stats->encoding = job->settings.encoding;
    stats->interesting = (int64_t)sparse->ia_voxels;
    stats->sparse_ratio =
        voxels > 0 ? 1 - (double)sparse->ia_voxels / voxels : 1;
    stats->ea_bytes = sparse->ea_bytes;
    stats->ia_bytes =
        sparse->ia_voxels * (size_t)sparse->channels * sizeof *sparse->ia;
    stats->pa_bytes = (uint64_t)(sparse->filled + 1) * sizeof *sparse->pa;
    return SNOW_OK;
}

/* Figure 8, lines 02 to 13, by the methods that throw footprints onto the
 * picture itself. */
static snow_status render_footprints(snow_job *job, const snow_volume *volume,
                                     const snow_transfer *transfer) {
    /* 02 - 03 */ snow_status status = prepare(job, volume, transfer);
    if (status == SNOW_OK && job->settings.method == SNOW_METHOD_FOOTPRINT)
        /* 04 - 06 */ status = encode_slab(job);
    if (status == SNOW_OK)
        /* 07 - 13 */ splat_and_composite(job);
    finish(job);
    return status;
}

/* The same lines by the sheared method, with slices as `placement` says. */
static snow_status render_sheared(snow_job *job, const snow_volume *volume,
                                  const snow_transfer *transfer,
                                  const snow_view *view,
                                  const snow_placement *placement,
                                  snow_slab slab, snow_sheared **sheared,
                                  float *pixels) {
    snow_sheared_order order = {
        volume, transfer, view, &job->settings, placement, slab, job->channels};
    if (!*sheared)
        SNOW_TRY(snow_sheared_new(job->frame->context, sheared));
    return snow_sheared_render(*sheared, &order, pixels, &job->frame->stats);
}

/* Adds share * layer to the picture. */
static void blend(float *pixels, const float *layer, float share,
                  size_t count) {
    for (size_t i = 0; i < count; i++)
        pixels[i] += share * layer[i];
}

/* High quality of a whole volume: where two or three axes are nearly as good,
 * the picture is a blend of theirs, so that a turning one does not jump. */
static snow_status render_blended(snow_job *job, const snow_volume *volume,
                                  const snow_transfer *transfer,
                                  const snow_view *view) {
    snow_frame *frame = job->frame;
    size_t floats =
        (size_t)view->width * (size_t)view->height * (size_t)job->channels;
    double shares[3];
    snow_placement_shares(&volume->info, &job->placement, shares);
    SNOW_TRY(snow_reserve(frame->context, &frame->layer, &frame->layer_capacity,
                          0, floats * sizeof *frame->layer));
    for (int axis = 0; axis < 3; axis++) {
        snow_placement placement;
        if (shares[axis] == 0)
            continue;
        SNOW_TRY(snow_placement_make_along(frame->context, &volume->info, view,
                                           axis, &placement));
        SNOW_TRY(render_sheared(job, volume, transfer, view, &placement,
                                snow_slab_equal(placement.slices, 1, 0),
                                &frame->sheared[axis], frame->layer));
        blend(job->pixels, frame->layer, (float)shares[axis], floats);
    }
    return SNOW_OK;
}

static snow_status render_slab(snow_job *job, const snow_volume *volume,
                               const snow_transfer *transfer,
                               const snow_view *view) {
    if (job->settings.method != SNOW_METHOD_SHEARED)
        return render_footprints(job, volume, transfer);
    if (job->settings.quality == SNOW_QUALITY_HIGH &&
        job->slab.count == job->placement.slices)
        return render_blended(job, volume, transfer, view);
    return render_sheared(job, volume, transfer, view, &job->placement,
                          job->slab, &job->frame->sheared[0], job->pixels);
}

snow_status snow_frame_render_slab(snow_frame *frame, const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   const snow_view *view,
                                   const snow_settings *settings, int parts,
                                   int part, snow_image **out) {
    double start = snow_seconds(), cpu = snow_cpu_seconds();
    snow_job job = {.frame = frame, .settings = snow_settings_known(settings)};
    snow_image *image = NULL;
    job.channels = transfer->grey ? 2 : 4;
    frame->stats = (snow_stats){0};
    /* 01 */ snow_status status = place(&job, volume, view, parts, part);
    if (status == SNOW_OK)
        status = snow_image_new(frame->context, view->width, view->height,
                                job.channels, &image);
    if (status == SNOW_OK) {
        job.pixels = snow_image_pixels(image);
        status = render_slab(&job, volume, transfer, view);
        frame->stats.seconds_frame = snow_seconds() - start;
        frame->stats.cpu_frame = snow_cpu_seconds() - cpu;
    }
    if (status == SNOW_OK)
        status = fill_stats(&job, volume, transfer, &frame->stats);
    if (status == SNOW_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

snow_status snow_frame_render(snow_frame *frame, const snow_volume *volume,
                              const snow_transfer *transfer,
                              const snow_view *view,
                              const snow_settings *settings,
                              snow_image **image) {
    snow_image *local;
    SNOW_TRY(snow_frame_render_slab(frame, volume, transfer, view, settings, 1,
                                    0, &local));
    /* 14 - 18: one processor has no partner; its local image is the picture. */
    float *pixels = snow_image_pixels(local);
    snow_combine_tree(&pixels, 1, (size_t)view->width * (size_t)view->height,
                      snow_image_channels(local));
    /* 19 - 20 */ *image = local;
    return SNOW_OK;
}
