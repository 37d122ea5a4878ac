/* perspective.c - the exact picture in perspective: figure 8 of the paper with
 * footprints that differ from voxel to voxel (splat/perspective.h).  It is what
 * the sheared method is held against, and a plain loop. */
#include "perspective.h"
#include "classify/classify.h"
#include "composite/over.h"
#include "depth.h"
#include "encode/encode.h"
#include "splat/perspective.h"
#include "volume/volume.h"

#include <math.h>

/* What one picture is made from; lives as long as the call. */
typedef struct pass {
    const snow_job *job;
    snow_context *context;
    snow_stats *stats;
    snow_classifier classifier;
    snow_shader shader;
    snow_strip strip;
    snow_eye_splatter splatter;
    snow_sparse sparse; /* EA, IA, PA, of method footprint */
    snow_sheet sheet;
    snow_span *spans; /* of one row */
    float *pixels;
    int64_t kept; /* voxels splatted out of strips */
} pass;

/* Adds the seconds since *mark to a total, and moves the mark. */
static void lap(double *mark, double *total) {
    double now = snow_seconds();
    *total += now - *mark;
    *mark = now;
}

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
    SNOW_TRY(snow_strip_make(s->context, &o->stored, o->channels, &s->strip));
    SNOW_TRY(snow_eye_splatter_init(s->context, &o->stored, settings->kernel,
                                    settings->footprint, o->channels,
                                    &s->splatter));
    SNOW_TRY(snow_sheet_begin(s->context, &o->stored, o->channels, 0,
                              o->stored.height, &s->sheet));
    s->spans = snow_allocate_array(
        s->context, (uint64_t)o->stored.columns / 2 + 1, sizeof *s->spans);
    return s->spans ? SNOW_OK : SNOW_NO_MEMORY;
}

static void finish(pass *s) {
    snow_release(s->context, s->spans);
    snow_release(s->context, s->sheet.pixels);
    snow_sparse_fini(&s->sparse);
    snow_eye_splatter_fini(s->context, &s->splatter);
    snow_strip_free(s->context, &s->strip);
    snow_classifier_fini(s->context, &s->classifier);
}

/* Classifies and shades rows of a slice from `row` on into the strip. */
static void classify_and_shade(pass *s, int64_t slice, int64_t row) {
    const snow_job *o = s->job;
    snow_strip *strip = &s->strip;
    int64_t rows = o->stored.rows - row;
    double mark = snow_seconds();
    snow_classify_strip(&s->classifier, &o->stored, slice, row,
                        rows < strip->room_rows ? rows : strip->room_rows,
                        strip);
    lap(&mark, &s->stats->seconds_classify);
    if (o->settings.shade == SNOW_SHADE_PHONG)
        snow_shade_strip(&s->shader, o->channels, strip);
    lap(&mark, &s->stats->seconds_shade);
    if (o->settings.mode == SNOW_MODE_OVER)
        snow_lengthen_strip(&o->stored, o->settings.opacity_length, o->channels,
                            strip);
    else if (o->settings.mode == SNOW_MODE_SUM)
        snow_weigh_strip(&o->stored, o->settings.opacity_length, o->channels,
                         strip);
    lap(&mark, &s->stats->seconds_classify);
}

/* Lines 04 to 06: one slice into the sparse matrix. */
static snow_status encode_slice(pass *s, int64_t slice) {
    SNOW_TRY(snow_sparse_begin_slice(&s->sparse));
    for (int64_t row = 0; row < s->job->stored.rows;
         row += s->strip.room_rows) {
        classify_and_shade(s, slice, row);
        double mark = snow_seconds();
        SNOW_TRY(snow_sparse_add_strip(&s->sparse, &s->strip));
        lap(&mark, &s->stats->seconds_encode);
    }
    return snow_sparse_end_slice(&s->sparse);
}

/* Density and runs on every 8th row of every 8th slice. */
static snow_encoding choose_encoding(pass *s) {
    const snow_placement *p = &s->job->stored;
    uint64_t voxels = 0, interesting = 0, runs = 0;
    for (int64_t slice = 0; slice < p->slices; slice += 8)
        for (int64_t row = slice / 8 % 8; row < p->rows; row += 8) {
            snow_classify_strip(&s->classifier, p, slice, row, 1, &s->strip);
            voxels += (uint64_t)p->columns;
            interesting += s->strip.count;
            runs += snow_spans_of_columns(s->strip.columns, s->strip.count,
                                          s->spans);
        }
    return snow_encoding_choose(voxels, interesting, runs);
}

static snow_status encode_slab(pass *s) {
    snow_encoding encoding = s->job->settings.encoding;
    if (encoding == SNOW_ENCODING_AUTO)
        encoding = choose_encoding(s);
    s->stats->encoding = encoding;
    SNOW_TRY(snow_sparse_begin(&s->sparse, snow_scheme_of(encoding),
                               &s->job->stored, s->job->channels));
    for (int64_t n = 0; n < s->job->stored_slab.count; n++)
        SNOW_TRY(encode_slice(s, s->job->stored_slab.first + n));
    return SNOW_OK;
}

/* Lines 08 to 12: the interesting voxels of one slice, out of EA and IA. */
static void splat_encoded_slice(pass *s, int64_t slice) {
    snow_walk walk;
    double mark = snow_seconds();
    snow_walk_begin(&walk, &s->sparse, slice - s->job->stored_slab.first);
    for (int64_t row = 0; row < s->job->stored.rows; row++) {
        size_t voxel, count = snow_walk_row(&walk, s->spans, &voxel);
        snow_eye_splat_row(&s->splatter, &s->sheet, row, s->spans, count,
                           s->sparse.ia + voxel * (size_t)s->job->channels);
    }
    lap(&mark, &s->stats->seconds_splat);
}

/* The same row by row out of the volume: original and tested splatting. */
static void splat_classified_slice(pass *s, int64_t slice) {
    snow_strip *strip = &s->strip;
    for (int64_t row = 0; row < s->job->stored.rows; row += strip->room_rows) {
        classify_and_shade(s, slice, row);
        double mark = snow_seconds();
        size_t begin = 0;
        s->kept += (int64_t)strip->count;
        for (int64_t n = 0; n < strip->rows; n++) {
            size_t end = strip->row_end[n];
            size_t spans = snow_spans_of_columns(strip->columns + begin,
                                                 end - begin, s->spans);
            snow_eye_splat_row(
                &s->splatter, &s->sheet, row + n, s->spans, spans,
                strip->samples + begin * (size_t)s->job->channels);
            begin = end;
        }
        lap(&mark, &s->stats->seconds_splat);
    }
}

/* Line 07, away from the eye: the slab's slices onto the sheet, and each sheet
 * into the local image. */
static snow_status splat_and_composite(pass *s) {
    const snow_job *o = s->job;
    for (int64_t n = 0; n < o->stored_slab.count; n++) {
        int64_t slice = snow_eye_nth_slice(&o->stored.eye, o->stored_slab.first,
                                           o->stored_slab.count, n);
        bool seen;
        SNOW_TRY(snow_eye_splatter_begin_slice(s->context, &s->splatter, slice,
                                               &seen));
        if (!seen)
            continue;
        if (o->settings.method == SNOW_METHOD_FOOTPRINT)
            splat_encoded_slice(s, slice);
        else
            splat_classified_slice(s, slice);
        double mark = snow_seconds();
        snow_job_clip_sheet(o, slice, &s->sheet);
        snow_depth_note_sheet(o, slice, &s->sheet);
        snow_lay_sheet(s->pixels, &s->sheet, snow_job_lay(o));
        lap(&mark, &s->stats->seconds_composite);
    }
    return SNOW_OK;
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
        return SNOW_OK;
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
    return SNOW_OK;
}

snow_status snow_perspective_render(const snow_job *job) {
    pass s = {.job = job,
              .context = job->context,
              .stats = job->stats,
              .sparse = {.context = job->context},
              .pixels = job->pixels};
    snow_status status = prepare(&s);
    if (status == SNOW_OK && job->settings.method == SNOW_METHOD_FOOTPRINT)
        status = encode_slab(&s);
    if (status == SNOW_OK)
        status = splat_and_composite(&s);
    if (status == SNOW_OK)
        status = count(&s);
    finish(&s);
    return status;
}
