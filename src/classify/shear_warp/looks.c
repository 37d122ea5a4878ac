/* classify/shear_warp/looks.c - the looks that the entries of a table are
 * made of, and where its nodes are; see classify/shear_warp/table.h.
 *
 * An entry's steps are at values (i + 1/2) / N of the way.  Where nodes are
 * evenly placed all of these lie on one fine raster, 2 N points from node to
 * node, so that the look is evaluated there once and entries only composite. */
#include "classify/shear_warp/table.h"

#include "base/exp_log.h"
#include "base/thread_pool.h"

#include <math.h>
#include <string.h>

/* Quantized values between two looks where nodes are placed by measure. */
#define MEASURED_STEP 0.25

/* A look whose steepest ramp spans fewer nodes has them placed by measure. */
#define STEEP_NODES 4

/* Looks that are made at once, by vectors. */
#define ALPHAS 64

#define TEMPLATE "classify/shear_warp/looks.tmpl.h"
#include "simd/each_isa.h"

/* --- looks ---------------------------------------------------------------- */

/* Colour and opacity of the reference length at number V. */
static void look_at(const snow_value_look *look, double v,
                    snow_transfer_hint *hint, double rgba[4]) {
    snow_transfer_near(look->transfer, snow_value_of(&look->scale, v), hint,
                       rgba);
    if (!snow_is_interesting(rgba[3], look->threshold))
        rgba[3] = 0;
}

/* Looks that are made as one item of work. */
#define LOOKS 8192

typedef struct looks_job {
    const snow_value_look *look;
    snow_value_table *table;
} looks_job;

/* All looks of a table, by items. */
static snow_status make_looks(snow_context *context,
                              const snow_value_look *look,
                              snow_value_table *table, snow_work_fn *work) {
    looks_job job = {look, table};
    return snow_parallel(context, look->threads,
                         (int64_t)(table->look_count + LOOKS - 1) / LOOKS, work,
                         &job);
}

/* The end of an item's looks. */
static size_t looks_end(const snow_value_table *table, int64_t item) {
    const size_t end = ((size_t)item + 1) * LOOKS;
    return end < table->look_count ? end : table->look_count;
}

/* Straight colours, and the logarithms of what shines through the reference
 * length: all that a look has before the length of its rays is known. */
static void find_plain(void *of, int64_t item, int worker) {
    const looks_job *job = of;
    const snow_value_look *look = job->look;
    snow_value_table *table = job->table;
    const size_t end = looks_end(table, item);
    snow_transfer_hint hint = {0};
    double logs[ALPHAS] = {0};
    (void)worker;
    for (size_t n = (size_t)item * LOOKS; n < end; n++) {
        double rgba[4];
        look_at(look, (double)n * table->step, &hint, rgba);
        for (int c = 0; c < 3; c++)
            table->plain[3 * n + (size_t)c] = (float)rgba[c];
        logs[n % ALPHAS] = rgba[3];
        if (n % ALPHAS + 1 < ALPHAS && n + 1 < end)
            continue;
        SNOW_OF_ISA(look->isa, logs_of)(logs);
        memcpy(table->logs + n - n % ALPHAS, logs,
               (n % ALPHAS + 1) * sizeof *logs);
    }
}

/* Those of every `step`-th look from `first` on, of so many reference lengths;
 * the last look stands for all behind it. */
static void find_alphas(const snow_value_table *table, snow_isa isa,
                        size_t first, size_t step, double exponent,
                        double out[ALPHAS]) {
    for (size_t n = 0; n < ALPHAS; n++) {
        size_t at = first + n * step;
        out[n] =
            table->logs[at < table->look_count ? at : table->look_count - 1];
    }
    SNOW_OF_ISA(isa, alphas_of)(exponent, out);
}

/* Looks of a step, `step` quantized values apart. */
static void fill_looks(void *of, int64_t item, int worker) {
    const looks_job *job = of;
    const snow_value_look *look = job->look;
    const snow_value_table *table = job->table;
    const size_t end = looks_end(table, item);
    (void)worker;
    for (size_t first = (size_t)item * LOOKS; first < end; first += ALPHAS) {
        double alphas[ALPHAS];
        find_alphas(table, look->isa, first, 1, look->exponent / look->steps,
                    alphas);
        for (size_t n = 0; n < ALPHAS && n < end - first; n++) {
            float *out = table->looks + 4 * (first + n);
            const float *plain = table->plain + 3 * (first + n);
            for (int c = 0; c < 3; c++)
                out[c] = (float)alphas[n] * plain[c];
            out[3] = (float)alphas[n];
        }
    }
}

/* The looks where those of neighbouring entries are beside each other. */
static snow_status fill_planes(snow_context *context,
                               const snow_value_look *look,
                               snow_value_table *table) {
    const size_t rows = 2 * (size_t)look->steps;
    const size_t pitch = (size_t)look->nodes + 2 * SNOW_VALUE_ENTRIES;
    SNOW_TRY(SNOW_RESERVE(context, table->planes, 0, 4 * rows * pitch));
    memset(table->planes, 0, 4 * rows * pitch * sizeof *table->planes);
    table->plane_pitch = (int)pitch;
    for (size_t n = 0; n < table->look_count; n++) {
        float *at = table->planes + n % rows * pitch + n / rows;
        for (size_t c = 0; c < 4; c++)
            at[c * rows * pitch + SNOW_VALUE_ENTRIES] = table->looks[4 * n + c];
    }
    return SNOW_STATUS_OK;
}

/* --- nodes ---------------------------------------------------------------- */

/* Whether opacity would rise from 0 to its largest within so few nodes that are
 * evenly placed, as it does along its steepest ramp, steps left out. */
static bool is_steep(const snow_value_look *look) {
    const snow_transfer *t = look->transfer;
    double steepest = 0, most = 0;
    for (size_t n = 0; n < t->opacity_count; n++) {
        const snow_opacity_point *p = &t->opacities[n];
        most = fmax(most, p->opacity);
        if (n + 1 == t->opacity_count)
            break;
        const double linear = look->scale.linear;
        double length = look->scale.log ? log10(p[1].value) - log10(p[0].value)
                                        : snow_place_of(linear, p[1].value) -
                                              snow_place_of(linear, p[0].value);
        if (length > 0)
            steepest =
                fmax(steepest, fabs(p[1].opacity - p[0].opacity) / length);
    }
    return most * (look->nodes - 1) <
           steepest * STEEP_NODES * (look->scale.high - look->scale.low);
}

/* The same from each V to the next; `until` is that up to V. */
static double measure_changes(const snow_value_look *look,
                              const snow_value_table *table, double *until) {
    const size_t step = (size_t)(1 / MEASURED_STEP);
    double before[4] = {0}, alphas[ALPHAS], total = 0;
    for (size_t v = 0; v <= SNOW_VALUE_MOST; v++) {
        if (v % ALPHAS == 0)
            find_alphas(table, look->isa, v * step, step, look->exponent,
                        alphas);
        double here[4] = {0, 0, 0, alphas[v % ALPHAS]};
        for (int c = 0; c < 3; c++)
            here[c] = (double)table->plain[3 * v * step + (size_t)c] * here[3];
        until[v] = 0; /* how much the look of a slab of one value changes */
        for (int c = 0; c < 4 && v; c++)
            until[v] += (c == 3 ? 3 : 1) * fabs(here[c] - before[c]);
        total += until[v];
        memcpy(before, here, sizeof before);
    }
    return total;
}

/* Half of the nodes evenly, half where the look changes; no number has more of
 * this than one node. */
static void measure_nodes(const snow_value_look *look,
                          snow_value_table *table) {
    double *until = table->at + SNOW_VALUE_PITCH;
    const double total = measure_changes(look, table, until);
    for (int v = 1; v <= SNOW_VALUE_MOST; v++) {
        double part = total > 0 ? until[v] / total : 1.0 / SNOW_VALUE_MOST;
        part =
            fmin(0.5 / SNOW_VALUE_MOST + 0.5 * part, 1.0 / (look->nodes - 1));
        until[v] = until[v - 1] + part;
    }
    for (int node = 0, v = 0; node < look->nodes; node++) {
        while (v < SNOW_VALUE_MOST &&
               until[v] < until[SNOW_VALUE_MOST] * node / (look->nodes - 1))
            v++;
        table->at[node] = v;
    }
}

/* Whether opacity jumps somewhere: at the threshold, or where two points of the
 * look have one value. */
static bool has_step(const snow_value_look *look) {
    const snow_transfer *t = look->transfer;
    for (size_t n = 0; n + 1 < t->opacity_count; n++)
        if (t->opacities[n].value == t->opacities[n + 1].value &&
            t->opacities[n].opacity != t->opacities[n + 1].opacity)
            return true;
    return look->threshold > 0;
}

/* The last number before the step between two nodes: opacity changes there by
 * more than half of what it changes by from node to node.  -1 without one. */
static int find_step(const snow_value_look *look, int from, int to,
                     snow_transfer_hint *hint) {
    double first[4], last[4], before[4], here[4];
    look_at(look, from, hint, first);
    look_at(look, to, hint, last);
    memcpy(before, first, sizeof before);
    for (int v = from; v < to; v++) {
        look_at(look, v + 1, hint, here);
        if (2 * fabs(here[3] - before[3]) > fabs(last[3] - first[3]))
            return v;
        memcpy(before, here, sizeof before);
    }
    return -1;
}

/* Two nodes are moved so that a step lies midway between them, or it would be
 * seen up to half a node from its place.  They stay where looks are known. */
static void move_to_steps(const snow_value_look *look,
                          snow_value_table *table) {
    snow_transfer_hint hint = {0};
    for (int node = 0; node + 1 < look->nodes; node++) {
        double *at = table->at + node;
        int from = (int)ceil(at[0]), to = (int)floor(at[1]);
        int step = from < to ? find_step(look, from, to, &hint) : -1;
        if (step < 0)
            continue;
        double by = step + 0.5 - 0.5 * (at[0] + at[1]);
        by = rint(by / table->step) * table->step;
        at[0] += by;
        at[1] += by;
        node++; /* the next one has its place */
    }
}

/* Evenly placed nodes, and the looks that steps from one to another meet. */
static snow_status place_evenly(snow_context *context,
                                const snow_value_look *look,
                                snow_value_table *table) {
    size_t values = SNOW_VALUE_MOST + 1;
    SNOW_TRY(SNOW_RESERVE(context, table->at, 0, SNOW_VALUE_PITCH + values));
    SNOW_TRY(SNOW_RESERVE(context, table->node_of, 0, values));
    double apart =
        look->nodes == 129 ? 128 : (double)SNOW_VALUE_MOST / (look->nodes - 1);
    for (int node = 0; node < look->nodes; node++)
        table->at[node] = look->nodes == 129 ? 128 * node
                                             : (double)SNOW_VALUE_MOST * node /
                                                   (look->nodes - 1);
    table->scale = look->nodes == 129 ? 256 : 510;
    table->measured = is_steep(look);
    bool moved = look->nodes == 256 && has_step(look);
    table->nodes = table->measured || moved ? table->node_of : NULL;
    table->step = table->measured ? MEASURED_STEP : apart / (2 * look->steps);
    table->look_count = table->measured
                            ? (size_t)(SNOW_VALUE_MOST / MEASURED_STEP) + 2
                            : (size_t)(2 * look->steps * (look->nodes - 1)) + 1;
    return SNOW_STATUS_OK;
}

snow_status snow_value_looks_make(snow_context *context,
                                  const snow_value_look *look, bool known,
                                  snow_value_table *table) {
    if (!known) {
        SNOW_TRY(place_evenly(context, look, table));
        SNOW_TRY(SNOW_RESERVE(context, table->plain, 0, 3 * table->look_count));
        SNOW_TRY(SNOW_RESERVE(context, table->logs, 0, table->look_count));
        SNOW_TRY(make_looks(context, look, table, find_plain));
    }
    if (table->measured)
        measure_nodes(look, table);
    if (!known && table->nodes && !table->measured)
        move_to_steps(look, table);
    if (table->measured || !known) {
        for (int v = 0, node = 0; v <= SNOW_VALUE_MOST; v++) {
            while (node + 1 < look->nodes &&
                   table->at[node + 1] - v <= v - table->at[node])
                node++;
            table->node_of[v] =
                table->nodes ? (uint8_t)node
                             : (uint8_t)((v * table->scale + 0x4000) >> 15);
        }
    }
    for (int node = 0; node < look->nodes; node++)
        table->look_of[node] = (int)(table->at[node] / table->step + 0.5);
    SNOW_TRY(SNOW_RESERVE(context, table->looks, 0, 4 * table->look_count));
    SNOW_TRY(make_looks(context, look, table, fill_looks));
    return table->nodes ? SNOW_STATUS_OK : fill_planes(context, look, table);
}
