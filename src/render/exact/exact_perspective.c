/* render/exact/exact_perspective.c - the exact picture in perspective: figure 8
 * of the paper with footprints that differ from voxel to voxel
 * (splat/perspective.h).  Shear-warp is compared with it, and it is a
 * plain loop. */
#include "render/exact/exact_perspective.h"
#include "base/monitor.h"
#include "composite/over.h"
#include "render/exact/exact.h"
#include "render/modes/depth.h"
#include "splat/perspective.h"
#include "volume/volume.h"

#include <math.h>

/* What one picture is made from. */
typedef struct snow_exact_eye {
    const snow_job *job;
    snow_context *context;
    snow_stats *stats;
    snow_classifier classifier;
    snow_shader shader;
    snow_row_block row_block;
    snow_perspective_splatter splatter;
    snow_sparse sparse; /* EA, IA, PA, of method footprint */
    snow_sheet sheet;
    snow_span *spans; /* of one row */
    float *pixels;
    int64_t kept; /* voxels splatted out of strips */
} pass;

/* Lines 02 and 03: tables and buffers. */
static snow_status prepare(pass *s) {
    const snow_job *o = s->job;
    const snow_settings *settings = &o->settings;
    /* Opacities of the reference length; each voxel's own comes after. */
    snow_classify_options options = {
        .threshold = settings->threshold,
        .opacity_exponent = 1,
        .keep_all = settings->method == SNOW_METHOD_ORIGINAL,
        .premultiply = settings->shade == SNOW_SHADE_NONE,
        .isa = SNOW_ISA_SCALAR,
    };
    SNOW_TRY(snow_classifier_make(s->context, o->volume, o->transfer, &options,
                                  &s->classifier));
    SNOW_TRY(snow_shader_init(s->context, o->volume, &o->stored, settings,
                              &s->shader));
    SNOW_TRY(snow_row_block_make(s->context, &o->stored, o->channels,
                                 &s->row_block));
    SNOW_TRY(snow_perspective_splatter_init(
        s->context, &o->stored, settings->kernel, settings->footprint,
        o->channels, &s->splatter));
    SNOW_TRY(snow_sheet_begin(s->context, &o->stored, o->channels, 0,
                              o->stored.height, &s->sheet));
    s->spans = snow_allocate_array(
        s->context, (uint64_t)o->stored.columns / 2 + 1, sizeof *s->spans);
    return s->spans ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

static void free_pass(pass *s) {
    if (!s->context) /* nothing is there */
        return;
    snow_release(s->context, s->spans);
    snow_release(s->context, s->sheet.pixels);
    snow_sparse_fini(&s->sparse);
    snow_perspective_splatter_fini(s->context, &s->splatter);
    snow_row_block_free(s->context, &s->row_block);
    snow_classifier_fini(s->context, &s->classifier);
    *s = (pass){.context = NULL};
}

/* Classifies and shades rows of a slice from `row` on into the strip. */
static void classify_and_shade(pass *s, int64_t slice, int64_t row) {
    const snow_job *o = s->job;
    snow_row_block *row_block = &s->row_block;
    int64_t rows = o->stored.rows - row;
    double mark = snow_seconds();
    snow_classify_row_block(
        &s->classifier, &o->stored, slice, row,
        rows < row_block->room_rows ? rows : row_block->room_rows, row_block);
    snow_lap(&mark, &s->stats->seconds_classify);
    if (o->settings.shade == SNOW_SHADE_PHONG)
        snow_shade_row_block(&s->shader, o->channels, row_block);
    snow_lap(&mark, &s->stats->seconds_shade);
    if (o->settings.mode == SNOW_MODE_OVER)
        snow_scale_path_length(&o->stored, o->settings.opacity_length,
                               o->channels, row_block);
    else if (o->settings.mode == SNOW_MODE_SUM)
        snow_correct_opacity(&o->stored, o->settings.opacity_length,
                             o->channels, row_block);
    snow_lap(&mark, &s->stats->seconds_classify);
}

/* Lines 04 to 06: one slice into the sparse matrix. */
static snow_status encode_slice(pass *s, int64_t slice) {
    SNOW_TRY(snow_sparse_begin_slice(&s->sparse));
    for (int64_t row = 0; row < s->job->stored.rows;
         row += s->row_block.room_rows) {
        SNOW_TRY(snow_ask_stop(s->context));
        classify_and_shade(s, slice, row);
        double mark = snow_seconds();
        SNOW_TRY(snow_sparse_add_row_block(&s->sparse, &s->row_block));
        snow_lap(&mark, &s->stats->seconds_encode);
    }
    return snow_sparse_end_slice(&s->sparse);
}

static snow_status encode_slab(pass *s) {
    snow_encoding encoding = s->job->settings.encoding;
    if (encoding == SNOW_ENCODING_AUTO)
        encoding = snow_exact_measure(&s->classifier, &s->job->stored,
                                      &s->row_block, s->spans);
    s->stats->encoding = encoding;
    SNOW_TRY(snow_sparse_begin(&s->sparse, snow_scheme_of(encoding),
                               &s->job->stored, s->job->channels));
    for (int64_t n = 0; n < s->job->stored_slab.count; n++) {
        snow_monitor_report(s->context->monitor, SNOW_STAGE_ENCODE, (double)n,
                            (double)s->job->stored_slab.count);
        SNOW_TRY(encode_slice(s, s->job->stored_slab.first + n));
    }
    return SNOW_STATUS_OK;
}

/* Lines 08 to 12: the interesting voxels of one slice, out of EA and IA. */
static void splat_encoded_slice(pass *s, int64_t slice) {
    snow_walk walk;
    double mark = snow_seconds();
    snow_walk_begin(&walk, &s->sparse, slice - s->job->stored_slab.first);
    for (int64_t row = 0; row < s->job->stored.rows &&
                          !snow_monitor_look(s->context->monitor, 0);
         row++) {
        size_t voxel, count = snow_walk_row(&walk, s->spans, &voxel);
        snow_perspective_splat_row(
            &s->splatter, &s->sheet, row, s->spans, count,
            s->sparse.ia + voxel * (size_t)s->job->channels);
    }
    snow_lap(&mark, &s->stats->seconds_splat);
}

/* The same row by row out of the volume: original and tested splatting. */
static void splat_classified_slice(pass *s, int64_t slice) {
    snow_row_block *row_block = &s->row_block;
    for (int64_t row = 0; row < s->job->stored.rows &&
                          !snow_monitor_look(s->context->monitor, 0);
         row += row_block->room_rows) {
        classify_and_shade(s, slice, row);
        double mark = snow_seconds();
        size_t begin = 0;
        s->kept += (int64_t)row_block->count;
        for (int64_t n = 0; n < row_block->rows; n++) {
            size_t end = row_block->row_end[n];
            size_t spans = snow_spans_of_columns(row_block->columns + begin,
                                                 end - begin, s->spans);
            snow_perspective_splat_row(
                &s->splatter, &s->sheet, row + n, s->spans, spans,
                row_block->samples + begin * (size_t)s->job->channels);
            begin = end;
        }
        snow_lap(&mark, &s->stats->seconds_splat);
    }
}

/* Line 07, away from the eye: the slab's slices onto the sheet, and each sheet
 * into the local image. */
static snow_status splat_and_composite(pass *s) {
    const snow_job *o = s->job;
    for (int64_t n = 0; n < o->stored_slab.count; n++) {
        int64_t slice = snow_perspective_nth_slice(
            &o->stored.eye, o->stored_slab.first, o->stored_slab.count, n);
        bool seen;
        SNOW_TRY(snow_ask_stop(s->context));
        snow_monitor_report(s->context->monitor, SNOW_STAGE_RENDER, (double)n,
                            (double)o->stored_slab.count);
        SNOW_TRY(snow_perspective_splatter_begin_slice(s->context, &s->splatter,
                                                       slice, &seen));
        if (!seen)
            continue;
        if (o->settings.method == SNOW_METHOD_FOOTPRINT)
            splat_encoded_slice(s, slice);
        else
            splat_classified_slice(s, slice);
        double mark = snow_seconds();
        snow_job_clip_sheet(o, slice, &s->sheet);
        snow_depth_note_sheet(o, slice, &s->sheet);
        snow_composite_sheet(s->pixels, &s->sheet, snow_job_composite(o));
        snow_lap(&mark, &s->stats->seconds_composite);
    }
    return snow_monitor_status(s->context->monitor);
}

static snow_status count(const pass *s) {
    const snow_job *o = s->job;
    const snow_sparse *sparse = &s->sparse;
    snow_stats *stats = s->stats;
    double voxels = (double)o->stored.columns * (double)o->stored.rows *
                    (double)o->stored_slab.count;
    if (o->settings.method == SNOW_METHOD_ORIGINAL) {
        SNOW_TRY(snow_transfer_sparse_ratio(o->transfer, o->volume,
                                            o->settings.threshold,
                                            &stats->sparse_ratio));
        stats->interesting = llround(voxels * (1 - stats->sparse_ratio));
        return SNOW_STATUS_OK;
    }
    stats->interesting = s->kept;
    if (o->settings.method == SNOW_METHOD_FOOTPRINT) {
        stats->interesting = (int64_t)sparse->ia_voxels;
        stats->ea_bytes = sparse->ea_bytes;
        stats->ia_bytes =
            sparse->ia_voxels * (size_t)o->channels * sizeof *sparse->ia;
        stats->pa_bytes = (uint64_t)(sparse->filled + 1) * sizeof *sparse->pa;
    }
    stats->sparse_ratio =
        voxels > 0 ? 1 - (double)stats->interesting / voxels : 1;
    return SNOW_STATUS_OK;
}

/* What a picture that failed has left is dropped. */
static snow_status begin(snow_picture *p, snow_job *job) {
    pass *s = p->frame->exact_eye;
    if (!s)
        s = p->frame->exact_eye = snow_allocate_clear(job->context, sizeof *s);
    if (!s)
        return SNOW_STATUS_NO_MEMORY;
    free_pass(s);
    *s = (pass){.job = job,
                .context = job->context,
                .stats = job->stats,
                .sparse = {.context = job->context},
                .pixels = job->pixels};
    return prepare(s);
}

static snow_status encode(snow_picture *p, snow_job *job) {
    return job->settings.method == SNOW_METHOD_FOOTPRINT
               ? encode_slab(p->frame->exact_eye)
               : SNOW_STATUS_OK;
}

static snow_status splat(snow_picture *p, snow_job *job) {
    pass *s = p->frame->exact_eye;
    (void)job;
    SNOW_TRY(splat_and_composite(s));
    SNOW_TRY(count(s));
    free_pass(s);
    return SNOW_STATUS_OK;
}

const snow_render_method snow_method_exact_perspective = {
    .classify_and_shade = begin,
    .encode = encode,
    .splat_and_composite = splat,
};

void snow_exact_eye_free(snow_context *context, snow_exact_eye *eye) {
    if (eye)
        free_pass(eye);
    snow_release(context, eye);
}
