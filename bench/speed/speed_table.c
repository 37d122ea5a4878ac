/* bench/speed/speed_table.c - original splatting with a footprint table, as
 * Westover's method is written (L. Westover, Footprint evaluation for volume
 * rendering, 1990): the weights of a voxel's pixels are made once for a view,
 * for SUBS x SUBS places of the voxel within a pixel, and every voxel takes
 * those of the nearest place.  Classification, shading and composition are the
 * library's; it has no such method, since its own are exact. */
#include "speed.h"

#include "classify/classify.h"
#include "composite/over.h"
#include "render/job.h"
#include "transform/transform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SUBS 16

/* The pixels of a line of a footprint, from its first one that is not 0. */
typedef struct footprint_line {
    int first, count;
    size_t at; /* of the weights */
} footprint_line;

struct speed_table {
    snow_placement placement;
    snow_scaled_kernel along[2];
    int reach[2];          /* pixels beside that of the voxel */
    footprint_line *lines; /* [place down][place across][line] */
    float *weights;
    snow_classifier classifier;
    snow_row_block block;
    snow_shader shader;
    snow_sheet sheet;
    int channels;
};

/* The weight at a pixel that is (x, y) pixels from the voxel. */
static float weigh(const speed_table *t, double x, double y) {
    double weight = 1;
    for (int n = 0; n < 2; n++)
        weight *= snow_scaled_kernel_weight(&t->along[n],
                                            t->placement.inverse[n][0] * x +
                                                t->placement.inverse[n][1] * y);
    return (float)weight;
}

/* A line without the zeros at its ends; returns where the next one begins. */
static size_t trim(speed_table *t, footprint_line *line, size_t at,
                   int across) {
    int first = 0, end = across;
    while (first < end && t->weights[at + (size_t)first] == 0)
        first++;
    while (end > first && t->weights[at + (size_t)end - 1] == 0)
        end--;
    *line = (footprint_line){
        .first = first - t->reach[0], .count = end - first, .at = at};
    memmove(t->weights + at, t->weights + at + first,
            (size_t)(end - first) * sizeof *t->weights);
    return at + (size_t)(end - first);
}

static void fill(speed_table *t) {
    const int across = 2 * t->reach[0] + 1, down = 2 * t->reach[1] + 1;
    footprint_line *line = t->lines;
    size_t at = 0;
    for (int place = 0; place < SUBS * SUBS; place++) {
        double x = (place % SUBS + 0.5) / SUBS, y = (place / SUBS + 0.5) / SUBS;
        for (int j = 0; j < down; j++, line++) {
            for (int i = 0; i < across; i++)
                t->weights[at + (size_t)i] = weigh(t, i - t->reach[0] + 0.5 - x,
                                                   j - t->reach[1] + 0.5 - y);
            at = trim(t, line, at, across);
        }
    }
}

static snow_status make_table(speed_table *t, const snow_settings *s) {
    const snow_placement *p = &t->placement;
    for (int n = 0; n < 2; n++)
        t->along[n] = snow_scaled_kernel_make(
            s->kernel, s->footprint, hypot(p->inverse[n][0], p->inverse[n][1]));
    for (int i = 0; i < 2; i++)
        t->reach[i] = (int)ceil(
            fabs(p->step_u[i]) * snow_scaled_kernel_reach(&t->along[0]) +
            fabs(p->step_v[i]) * snow_scaled_kernel_reach(&t->along[1]) + 0.5);
    size_t lines = (size_t)(SUBS * SUBS) * (size_t)(2 * t->reach[1] + 1);
    free(t->lines);
    free(t->weights);
    t->lines = malloc(lines * sizeof *t->lines);
    t->weights =
        malloc(lines * (size_t)(2 * t->reach[0] + 1) * sizeof *t->weights);
    if (!t->lines || !t->weights)
        return SNOW_STATUS_NO_MEMORY;
    fill(t);
    return SNOW_STATUS_OK;
}

/* --- one voxel ------------------------------------------------------------ */

static int larger(int a, int b) {
    return a > b ? a : b;
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

static inline void add_line(const speed_table *t, const footprint_line *line,
                            int x, int y, const float *sample,
                            const int channels) {
    int first = larger(x + line->first, 0);
    int end = smaller(x + line->first + line->count, t->sheet.width);
    const float *weights = t->weights + line->at;
    float *pixels =
        t->sheet.pixels + (size_t)y * (size_t)t->sheet.width * (size_t)channels;
    for (int i = first; i < end; i++)
        for (int c = 0; c < channels; c++)
            pixels[i * channels + c] +=
                weights[i - x - line->first] * sample[c];
}

static inline void add_voxel(speed_table *t, double x, double y,
                             const float *sample, const int channels) {
    double left = floor(x), top = floor(y);
    int place = (int)((y - top) * SUBS) * SUBS + (int)((x - left) * SUBS);
    int down = 2 * t->reach[1] + 1;
    const footprint_line *lines = t->lines + (size_t)place * (size_t)down;
    int from = (int)top - t->reach[1];
    int first = larger(from, 0), end = smaller(from + down, t->sheet.height);
    for (int j = first; j < end; j++)
        add_line(t, &lines[j - from], (int)left, j, sample, channels);
}

/* --- the picture ---------------------------------------------------------- */

/* Marks the pixels that a voxel can reach: of a row the first and the last. */
static void mark(speed_table *t, double x, double y) {
    snow_sheet *sheet = &t->sheet;
    int left = (int)floor(x) - t->reach[0], top = (int)floor(y) - t->reach[1];
    int right = left + 2 * t->reach[0] + 1, end = top + 2 * t->reach[1] + 1;
    sheet->x0 = larger(0, smaller(sheet->x0, left));
    sheet->y0 = larger(0, smaller(sheet->y0, top));
    sheet->x1 = smaller(sheet->width, larger(sheet->x1, right));
    sheet->y1 = smaller(sheet->height, larger(sheet->y1, end));
}

static void add_rows(speed_table *t, int64_t slice, const int channels) {
    const snow_placement *p = &t->placement;
    const snow_row_block *b = &t->block;
    size_t n = 0;
    for (int64_t r = 0; r < b->rows; r++) {
        double at[2];
        for (int i = 0; i < 2; i++)
            at[i] = p->origin[i] + (double)slice * p->step_slice[i] +
                    (double)(b->first_row + r) * p->step_v[i];
        mark(t, at[0], at[1]);
        mark(t, at[0] + (double)(p->columns - 1) * p->step_u[0],
             at[1] + (double)(p->columns - 1) * p->step_u[1]);
        for (; n < b->row_end[r]; n++)
            add_voxel(t, at[0] + b->columns[n] * p->step_u[0],
                      at[1] + b->columns[n] * p->step_u[1],
                      b->samples + n * (size_t)channels, channels);
    }
}

static void add_slice(speed_table *t, int64_t slice, bool shaded,
                      float *pixels) {
    const snow_placement *p = &t->placement;
    snow_row_block *b = &t->block;
    for (int64_t row = 0; row < p->rows; row += b->room_rows) {
        int64_t rows =
            p->rows - row < b->room_rows ? p->rows - row : b->room_rows;
        snow_classify_row_block(&t->classifier, p, slice, row, rows, b);
        if (shaded)
            snow_shade_row_block(&t->shader, t->channels, b);
        if (t->channels == 2)
            add_rows(t, slice, 2);
        else
            add_rows(t, slice, 4);
    }
    snow_composite_sheet(pixels, &t->sheet, snow_over_of(t->channels));
}

static snow_status prepare(snow_context *context, const snow_volume *volume,
                           const snow_transfer *transfer, const snow_view *view,
                           const snow_settings *s, speed_table *t) {
    const snow_placement *p = &t->placement;
    SNOW_TRY(snow_placement_make(context, snow_volume_get_info(volume), view,
                                 &t->placement));
    const snow_classify_options options = {
        .opacity_exponent = p->path / s->opacity_length,
        .keep_all = true,
        .premultiply = s->shade == SNOW_SHADE_NONE,
        .isa = SNOW_ISA_SCALAR};
    SNOW_TRY(snow_classifier_make(context, volume, transfer, &options,
                                  &t->classifier));
    t->channels = t->classifier.channels;
    SNOW_TRY(snow_row_block_make(context, p, t->channels, &t->block));
    SNOW_TRY(snow_shader_init(context, volume, p, s, &t->shader));
    SNOW_TRY(
        snow_sheet_begin(context, p, t->channels, 0, p->height, &t->sheet));
    return make_table(t, s);
}

snow_status speed_table_render(snow_context *context, speed_table **table,
                               const snow_volume *volume,
                               const snow_transfer *transfer,
                               const snow_view *view,
                               const snow_settings *settings, snow_stats *stats,
                               snow_image **image) {
    double mark = snow_seconds(), cpu = snow_cpu_seconds();
    snow_settings s = *settings;
    if (!*table)
        *table = calloc(1, sizeof **table);
    if (!*table)
        return SNOW_STATUS_NO_MEMORY;
    speed_table *t = *table;
    SNOW_TRY(snow_settings_resolve(context, snow_volume_get_info(volume), &s));
    SNOW_TRY(prepare(context, volume, transfer, view, &s, t));
    SNOW_TRY(
        snow_image_new(context, view->width, view->height, t->channels, image));
    const snow_placement *p = &t->placement;
    for (int64_t n = 0; n < p->slices; n++)
        add_slice(t, p->nearest_first ? n : p->slices - 1 - n,
                  s.shade == SNOW_SHADE_PHONG, snow_image_pixels(*image));
    *stats = (snow_stats){.size = sizeof *stats,
                          .method = SNOW_METHOD_ORIGINAL,
                          .kernel = s.kernel,
                          .footprint = s.footprint,
                          .slice_axis = p->slice_axis,
                          .threads = 1,
                          .isa = SNOW_ISA_SCALAR,
                          .voxels = p->columns * p->rows * p->slices,
                          .seconds_frame = snow_seconds() - mark,
                          .cpu_frame = snow_cpu_seconds() - cpu};
    return SNOW_STATUS_OK;
}

void speed_table_free(snow_context *context, speed_table *table) {
    if (!table)
        return;
    snow_classifier_fini(context, &table->classifier);
    snow_row_block_free(context, &table->block);
    snow_release(context, table->sheet.pixels);
    free(table->lines);
    free(table->weights);
    free(table);
}
