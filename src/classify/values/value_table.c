/* classify/values/value_table.c - see value_table.h.
 *
 * An entry's steps are at values (i + 1/2) / N of the way.  Where nodes are
 * evenly placed all of these lie on one fine raster, 2 N points from node to
 * node, so that the look is evaluated there once and entries only composite. */
#include "classify/values/value_table.h"

#include "base/thread_pool.h"

#include <math.h>
#include <string.h>

/* Numbers between two looks where nodes are placed by measure. */
#define MEASURED_STEP 0.25

/* The largest alpha of tables whose words count smaller parts, and how often
 * these are halved at most. */
#define FAINTEST 0.004F
#define HALVINGS_MOST 96

/* A look whose steepest ramp spans fewer nodes has them placed by measure. */
#define STEEP_NODES 4

/* --- looks ------------------------------------------------------------------
 */

/* Colour and opacity of the reference length at number V. */
static void look_at(const snow_value_look *look, double v,
                    snow_transfer_hint *hint, double rgba[4]) {
    snow_transfer_near(look->transfer, snow_value_of(&look->scale, v), hint,
                       rgba);
    if (!snow_is_interesting(rgba[3], look->threshold))
        rgba[3] = 0;
}

static double alpha_of(double opacity, double exponent) {
    return opacity >= 1 ? 1 : 1 - pow(1 - opacity, exponent);
}

/* Looks of a step, `step` numbers apart. */
static snow_status fill_looks(snow_context *context,
                              const snow_value_look *look,
                              snow_value_table *table) {
    snow_transfer_hint hint = {0};
    double exponent = look->exponent / look->steps;
    SNOW_TRY(snow_reserve(context, &table->looks, &table->looks_capacity, 0,
                          4 * table->look_count * sizeof *table->looks));
    double last = -1, alpha = 0;
    for (size_t n = 0; n < table->look_count; n++) {
        double rgba[4];
        float *out = table->looks + 4 * n;
        look_at(look, (double)n * table->step, &hint, rgba);
        if (rgba[3] != last)
            alpha = alpha_of(last = rgba[3], exponent);
        for (int c = 0; c < 3; c++)
            out[c] = (float)(alpha * rgba[c]);
        out[3] = (float)alpha;
    }
    return SNOW_STATUS_OK;
}

/* --- nodes ------------------------------------------------------------------
 */

/* The shortest way between two points of different opacity, steps left out, in
 * nodes that are evenly placed. */
static bool is_steep(const snow_value_look *look) {
    const snow_transfer *t = look->transfer;
    double shortest = INFINITY;
    for (size_t n = 0; n + 1 < t->opacity_count; n++) {
        const snow_opacity_point *p = &t->opacities[n];
        double length = look->scale.log ? log10(p[1].value) - log10(p[0].value)
                                        : p[1].value - p[0].value;
        if (p[1].opacity != p[0].opacity && length > 0)
            shortest = fmin(shortest, length);
    }
    return shortest * (look->nodes - 1) <
           STEEP_NODES * (look->scale.high - look->scale.low);
}

/* How much the look of a slab of one value changes from one to the other. */
static double change(const double a[4], const double b[4]) {
    double sum = 0;
    for (int c = 0; c < 4; c++)
        sum += (c == 3 ? 3 : 1) * fabs(b[c] - a[c]);
    return sum;
}

/* Half of the nodes evenly, half where the look changes; no number has more of
 * this than one node. */
static void measure_nodes(const snow_value_look *look, double *until,
                          double *at) {
    snow_transfer_hint hint = {0};
    double before[4], total = 0;
    for (int v = 0; v <= SNOW_VALUE_MOST; v++) {
        double here[4];
        look_at(look, v, &hint, here);
        here[3] = alpha_of(here[3], look->exponent);
        for (int c = 0; c < 3; c++)
            here[c] *= here[3];
        total += until[v] = v ? change(before, here) : 0;
        memcpy(before, here, sizeof before);
    }
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
        at[node] = v;
    }
}

static void find_nodes(const snow_value_look *look, snow_value_table *table) {
    for (int v = 0, node = 0; v <= SNOW_VALUE_MOST; v++) {
        while (node + 1 < look->nodes &&
               table->at[node + 1] - v <= v - table->at[node])
            node++;
        table->node_of[v] = table->nodes
                                ? (uint8_t)node
                                : (uint8_t)((v * table->scale + 0x4000) >> 15);
    }
}

static snow_status place_nodes(snow_context *context,
                               const snow_value_look *look,
                               snow_value_table *table) {
    bool measured = is_steep(look);
    size_t values = SNOW_VALUE_MOST + 1;
    SNOW_TRY(snow_reserve(context, &table->at, &table->at_capacity, 0,
                          (SNOW_VALUE_PITCH + values) * sizeof *table->at));
    SNOW_TRY(snow_reserve(context, &table->node_of, &table->node_of_capacity, 0,
                          values));
    double apart =
        look->nodes == 129 ? 128 : (double)SNOW_VALUE_MOST / (look->nodes - 1);
    for (int node = 0; node < look->nodes; node++)
        table->at[node] = look->nodes == 129 ? 128 * node
                                             : (double)SNOW_VALUE_MOST * node /
                                                   (look->nodes - 1);
    table->scale = look->nodes == 129 ? 256 : 510;
    table->nodes = measured ? table->node_of : NULL;
    table->step = measured ? MEASURED_STEP : apart / (2 * look->steps);
    table->look_count = measured
                            ? (size_t)(SNOW_VALUE_MOST / MEASURED_STEP) + 2
                            : (size_t)(2 * look->steps * (look->nodes - 1)) + 1;
    if (measured)
        measure_nodes(look, table->at + SNOW_VALUE_PITCH, table->at);
    find_nodes(look, table);
    return SNOW_STATUS_OK;
}

/* The place of a node among the looks. */
static int64_t look_of(const snow_value_table *table,
                       const snow_value_look *look, int node) {
    return table->nodes ? (int64_t)(table->at[node] / MEASURED_STEP + 0.5)
                        : (int64_t)(2 * look->steps) * node;
}

/* --- entries ----------------------------------------------------------------
 */

typedef float four_floats __attribute__((vector_size(16)));

/* Entries that are made at once, so that their steps need not wait. */
#define LANES 4

/* The way through an entry: its first look and the way from step to step, both
 * times 65536; then colours and alpha, and the place, 0 to 1. */
typedef struct entry_way {
    int64_t at, apart;
    four_floats sum;
    float place;
} entry_way;

static four_floats all_of(float x) {
    return (four_floats){x, x, x, x};
}

static void collect(const snow_value_table *table, int steps,
                    entry_way ways[LANES]) {
    four_floats through[LANES], places[LANES], sum[LANES];
    for (int w = 0; w < LANES; w++) {
        through[w] = all_of(1);
        sum[w] = places[w] = all_of(0);
    }
    for (int n = 0; n < steps; n++)
        for (int w = 0; w < LANES; w++) {
            four_floats here;
            memcpy(&here, table->looks + 4 * (ways[w].at >> 16), sizeof here);
            ways[w].at += ways[w].apart;
            here *= through[w];
            sum[w] += here;
            places[w] += here * all_of((float)n + 0.5F);
            through[w] -= all_of(here[3]);
        }
    for (int w = 0; w < LANES; w++) {
        ways[w].sum = sum[w];
        ways[w].place =
            sum[w][3] > 0 ? places[w][3] / ((float)steps * sum[w][3]) : 0.5F;
    }
}

static uint64_t pack(four_floats rgba, float place, float full, bool placed) {
    uint64_t entry = 0;
    int sixteenths = place * 16 < 15 ? (int)(place * 16) : 15;
    for (int c = 0; c < 4; c++) {
        int word = (int)(rgba[c] * full + 0.5F);
        word = word > 32767 ? 32767 : word;
        if (placed)
            word |= (sixteenths >> c & 1) << 15;
        entry |= (uint64_t)(unsigned)word << 16 * c;
    }
    return entry;
}

typedef struct table_job {
    const snow_value_look *look;
    snow_value_table *table;
    float full;                   /* the word of an alpha of 1 */
    float most[SNOW_VALUE_PITCH]; /* alpha, of each row */
} table_job;

/* The looks next to one, down and up, that show something. */
static void find_seen(const snow_value_table *table, int64_t from,
                      int64_t seen[2]) {
    seen[0] = seen[1] = from;
    while (seen[0] >= 0 && !(table->looks[4 * seen[0] + 3] > 0))
        seen[0]--;
    while (seen[1] < (int64_t)table->look_count &&
           !(table->looks[4 * seen[1] + 3] > 0))
        seen[1]++;
}

/* Up to LANES entries of a row. */
static void fill_some(const table_job *job, int64_t first, const int *backs,
                      int count, uint64_t *row, float *most) {
    const snow_value_look *look = job->look;
    entry_way ways[LANES];
    for (int w = 0; w < LANES; w++) {
        int64_t way =
            look_of(job->table, look, backs[w < count ? w : 0]) - first;
        int64_t apart = way * 65536 / look->steps;
        ways[w] = (entry_way){.at = first * 65536 + apart / 2, .apart = apart};
    }
    collect(job->table, look->steps, ways);
    for (int w = 0; w < count; w++) {
        uint64_t entry = ways[w].sum[3] > 0 ? pack(ways[w].sum, ways[w].place,
                                                   job->full, look->placed)
                                            : 0;
        *most = ways[w].sum[3] > *most ? ways[w].sum[3] : *most;
        row[backs[w]] = (entry >> 48 & 0x7fff) == 0 ? 0 : entry;
    }
}

static void fill_row(void *of, int64_t front, int worker) {
    table_job *job = of;
    const snow_value_look *look = job->look;
    const snow_value_table *table = job->table;
    uint64_t *row = table->entries + front * SNOW_VALUE_PITCH;
    int64_t first = look_of(table, look, (int)front), seen[2];
    int backs[LANES], count = 0;
    float most = 0;
    (void)worker;
    find_seen(table, first, seen);
    for (int back = 0; back < look->nodes; back++) {
        int64_t last = look_of(table, look, back);
        row[back] = 0;
        if (last > seen[0] && last < seen[1]) /* and so is all between */
            continue;
        backs[count++] = back;
        if (count == LANES) {
            fill_some(job, first, backs, count, row, &most);
            count = 0;
        }
    }
    if (count)
        fill_some(job, first, backs, count, row, &most);
    job->most[front] = most;
}

/* All entries; again in smaller parts where all are faint, of which there may
 * be eight times as many: rays of other pixels are longer in perspective. */
static snow_status fill_entries(snow_context *context,
                                const snow_value_look *look,
                                snow_value_table *table) {
    table_job job = {.look = look, .table = table, .full = 32767};
    float most = 0;
    SNOW_TRY(
        snow_parallel(context, look->threads, look->nodes, fill_row, &job));
    for (int n = 0; n < look->nodes; n++)
        most = job.most[n] > most ? job.most[n] : most;
    table->faint = most > 0 && most < FAINTEST;
    for (int n = 0; table->faint && n < HALVINGS_MOST && most <= 0.0625F; n++) {
        most *= 2;
        job.full *= 2;
    }
    table->unit = 1 / job.full;
    return table->faint ? snow_parallel(context, look->threads, look->nodes,
                                        fill_row, &job)
                        : SNOW_STATUS_OK;
}

/* --- invisible runs --------------------------------------------------------
 */

/* Keeps the longest runs; they stay rising. */
void snow_value_table_hide(snow_value_table *table, snow_value_run run) {
    int shortest = 0, count = table->run_count;
    if (count < SNOW_VALUE_RUNS) {
        table->runs[table->run_count++] = run;
        return;
    }
    for (int n = 1; n < count; n++)
        if (table->runs[n].last - table->runs[n].first <
            table->runs[shortest].last - table->runs[shortest].first)
            shortest = n;
    if (run.last - run.first <=
        table->runs[shortest].last - table->runs[shortest].first)
        return;
    for (int n = shortest; n + 1 < count; n++)
        table->runs[n] = table->runs[n + 1];
    table->runs[count - 1] = run;
}

/* The last node up to which all looks from `node` on are invisible; below it
 * where not even its own is. */
static int blind_until(const snow_value_table *table,
                       const snow_value_look *look, int node) {
    int64_t n = look_of(table, look, node);
    int64_t end = (int64_t)table->look_count;
    while (n < end && !(table->looks[4 * n + 3] > 0))
        n++;
    int last = node - 1;
    while (last + 1 < look->nodes && look_of(table, look, last + 1) < n)
        last++;
    return last;
}

static void find_runs(const snow_value_look *look, snow_value_table *table) {
    const uint8_t *node_of = table->node_of;
    table->run_count = 0;
    for (int v = 0; v <= SNOW_VALUE_MOST;) {
        int last = blind_until(table, look, node_of[v]), end = v;
        while (end <= SNOW_VALUE_MOST && node_of[end] <= last)
            end++;
        if (end > v)
            snow_value_table_hide(
                table, (snow_value_run){(int16_t)v, (int16_t)(end - 1)});
        for (last = node_of[v]; end <= SNOW_VALUE_MOST && node_of[end] <= last;)
            end++;
        v = end;
    }
}

/* --- the table --------------------------------------------------------------
 */

/* The points of a look, to know it again. */
static snow_status take_key(snow_context *context, const snow_transfer *t,
                            snow_value_table *table, bool *same) {
    size_t count = 4 * t->color_count + 2 * t->opacity_count, n = 0;
    SNOW_TRY(snow_reserve(context, &table->next_key, &table->next_key_capacity,
                          0, (count + 1) * sizeof(double)));
    double *key = table->next_key;
    for (size_t i = 0; i < t->color_count; i++) {
        key[n++] = t->colors[i].value;
        key[n++] = t->colors[i].red;
        key[n++] = t->colors[i].green;
        key[n++] = t->colors[i].blue;
    }
    for (size_t i = 0; i < t->opacity_count; i++) {
        key[n++] = t->opacities[i].value;
        key[n++] = t->opacities[i].opacity;
    }
    *same = table->key_count == count &&
            memcmp(key, table->key, count * sizeof *key) == 0;
    size_t capacity = table->key_capacity;
    table->next_key = table->key;
    table->key = key;
    table->key_capacity = table->next_key_capacity;
    table->next_key_capacity = capacity;
    table->key_count = count;
    return SNOW_STATUS_OK;
}

static bool same_look(const snow_value_look *a, const snow_value_look *b) {
    return a->nodes == b->nodes && a->steps == b->steps &&
           a->placed == b->placed && a->threshold == b->threshold &&
           a->exponent == b->exponent &&
           snow_value_same_scale(&a->scale, &b->scale);
}

snow_status snow_value_table_make(snow_context *context,
                                  const snow_value_look *look,
                                  snow_value_table *table) {
    const size_t bytes =
        SNOW_VALUE_PITCH * SNOW_VALUE_PITCH * sizeof *table->entries;
    bool same;
    SNOW_TRY(take_key(context, look->transfer, table, &same));
    if (same && same_look(look, &table->made))
        return SNOW_STATUS_OK;
    bool anew = !table->entries;
    table->made.nodes = 0; /* until it is whole */
    SNOW_TRY(snow_reserve(context, &table->entries, &table->entries_capacity, 0,
                          bytes));
    if (anew)
        memset(table->entries, 0, bytes);
    SNOW_TRY(place_nodes(context, look, table));
    SNOW_TRY(fill_looks(context, look, table));
    SNOW_TRY(fill_entries(context, look, table));
    find_runs(look, table);
    table->made = *look;
    return SNOW_STATUS_OK;
}

void snow_value_table_begin(const snow_value_look *look,
                            snow_value_table *table) {
    table->made = *look;
    table->made.nodes = 0;
    table->run_count = 0;
    table->faint = false;
    table->unit = 1.0F / 32767;
}

void snow_value_table_fini(snow_context *context, snow_value_table *table) {
    snow_release(context, table->entries);
    snow_release(context, table->node_of);
    snow_release(context, table->at);
    snow_release(context, table->looks);
    snow_release(context, table->key);
    snow_release(context, table->next_key);
    *table = (snow_value_table){0};
}
