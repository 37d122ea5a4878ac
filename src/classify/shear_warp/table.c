/* classify/shear_warp/table.c - see table.h. */
#include "classify/shear_warp/table.h"

#include "base/thread_pool.h"

#include <string.h>

/* The largest alpha of tables whose words count smaller parts, and how often
 * these are halved at most. */
#define FAINTEST 0.004
#define HALVINGS_MOST 96

/* --- entries -------------------------------------------------------------- */

#define ENTRIES SNOW_VALUE_ENTRIES

/* The ways through some entries: the first look and the way from step to step,
 * both times 65536; then sums of colours and alpha, and of them by steps. */
typedef struct entry_ways {
    int64_t at[ENTRIES], apart[ENTRIES];
    float sum[ENTRIES][4], places[ENTRIES][4];
} entry_ways;

#define TEMPLATE "classify/shear_warp/entries.tmpl.h"
#include "simd/each_isa.h"

typedef struct table_job {
    const snow_value_look *look;
    snow_value_table *table;
    float most[SNOW_VALUE_PITCH]; /* alpha, of each row */
} table_job;

/* Up to ENTRIES entries of a row. */
static void fill_some(const table_job *job, int64_t first, const int *backs,
                      int count, uint64_t *row, float *most) {
    const snow_value_look *look = job->look;
    entry_ways ways;
    float sums[5][ENTRIES];
    uint64_t entries[ENTRIES];
    for (int w = 0; w < ENTRIES; w++) {
        int64_t way = job->table->look_of[backs[w < count ? w : 0]] - first;
        ways.apart[w] = way * (65536 / look->steps);
        ways.at[w] = first * 65536 + ways.apart[w] / 2;
    }
    SNOW_OF_ISA(look->isa, collect_all)(job->table, look->steps, &ways);
    for (int w = 0; w < ENTRIES; w++)
        for (int c = 0; c < 5; c++)
            sums[c][w] = c < 4 ? ways.sum[w][c] : ways.places[w][3];
    SNOW_OF_ISA(look->isa, pack)(sums, (float)look->steps, job->table->full,
                                 look->placed, entries);
    for (int w = 0; w < count; w++) {
        *most = sums[3][w] > *most ? sums[3][w] : *most;
        row[backs[w]] = entries[w];
    }
}

static void fill_row(void *of, int64_t front, int worker) {
    table_job *job = of;
    const snow_value_look *look = job->look;
    const snow_value_table *table = job->table;
    uint64_t *row = table->entries + front * SNOW_VALUE_PITCH;
    int64_t first = table->look_of[front], seen[2];
    int backs[ENTRIES], count = 0;
    float most = 0;
    (void)worker;
    /* The looks next to one, down and up, that show something. */
    seen[0] = seen[1] = first;
    while (seen[0] >= 0 && !(table->looks[4 * seen[0] + 3] > 0))
        seen[0]--;
    while (seen[1] < (int64_t)table->look_count &&
           !(table->looks[4 * seen[1] + 3] > 0))
        seen[1]++;
    for (int back = 0; back < look->nodes; back++) {
        int64_t last = table->look_of[back];
        row[back] = 0;
        if (last > seen[0] && last < seen[1]) /* and so is all between */
            continue;
        backs[count++] = back;
        if (count == ENTRIES) {
            fill_some(job, first, backs, count, row, &most);
            count = 0;
        }
    }
    if (count)
        fill_some(job, first, backs, count, row, &most);
    job->most[front] = most;
}

/* ENTRIES rows of a table of evenly placed nodes, diagonal by diagonal. */
static void fill_rows(void *of, int64_t item, int worker) {
    table_job *job = of;
    const snow_value_look *look = job->look;
    const int front = (int)item * ENTRIES, nodes = look->nodes;
    const int count = nodes - front < ENTRIES ? nodes - front : ENTRIES;
    uint64_t *row = job->table->entries + (size_t)front * SNOW_VALUE_PITCH;
    float most = 0;
    (void)worker;
    for (int apart = 1 - count - front; apart < nodes - front; apart++) {
        float sums[5][ENTRIES];
        uint64_t entries[ENTRIES];
        const int first = front + apart; /* the back of entry 0 */
        SNOW_OF_ISA(look->isa, collect_diagonal)(job->table, look->steps, front,
                                                 apart, sums);
        SNOW_OF_ISA(look->isa, pack)(sums, (float)look->steps, job->table->full,
                                     look->placed, entries);
        for (int w = first < 0 ? -first : 0; w < count && first + w < nodes;
             w++) {
            row[w * SNOW_VALUE_PITCH + first + w] = entries[w];
            most = sums[3][w] > most ? sums[3][w] : most;
        }
    }
    job->most[front] = most;
}

/* Words count smaller parts where all is faint, of which there may be eight
 * times as many: rays of other pixels are longer in perspective. */
void snow_value_table_scale(snow_value_table *table, double most,
                            double faintest) {
    double full = 32767;
    table->faint = most > 0 && most < faintest;
    for (int n = 0; table->faint && n < HALVINGS_MOST && most <= 0.0625; n++) {
        most *= 2;
        full *= 2;
    }
    table->unit = (float)(1 / full);
    table->full = (float)full;
}

/* --- transparent intervals ------------------------------------------------ */

/* Keeps the longest intervals; they stay rising. */
void snow_value_table_hide(snow_value_table *table,
                           snow_transparent_interval interval) {
    int shortest = 0, count = table->interval_count;
    if (count < SNOW_VALUE_RUNS) {
        table->intervals[table->interval_count++] = interval;
        return;
    }
    for (int n = 1; n < count; n++)
        if (table->intervals[n].last - table->intervals[n].first <
            table->intervals[shortest].last - table->intervals[shortest].first)
            shortest = n;
    if (interval.last - interval.first <=
        table->intervals[shortest].last - table->intervals[shortest].first)
        return;
    for (int n = shortest; n + 1 < count; n++)
        table->intervals[n] = table->intervals[n + 1];
    table->intervals[count - 1] = interval;
}

static void find_intervals(const snow_value_look *look,
                           snow_value_table *table) {
    const uint8_t *node_of = table->node_of;
    table->interval_count = 0;
    for (int v = 0; v <= SNOW_VALUE_MOST;) {
        /* The last node up to which all looks from here on are invisible;
         * below the one of v where not even its own is. */
        int64_t n = table->look_of[node_of[v]];
        while (n < (int64_t)table->look_count && !(table->looks[4 * n + 3] > 0))
            n++;
        int last = node_of[v] - 1, end = v;
        while (last + 1 < look->nodes && table->look_of[last + 1] < n)
            last++;
        while (end <= SNOW_VALUE_MOST && node_of[end] <= last)
            end++;
        if (end > v)
            snow_value_table_hide(table, (snow_transparent_interval){
                                             (int16_t)v, (int16_t)(end - 1)});
        for (last = node_of[v]; end <= SNOW_VALUE_MOST && node_of[end] <= last;)
            end++;
        v = end;
    }
}

/* --- the table ------------------------------------------------------------ */

/* The points of a look, to know it again. */
static snow_status take_key(snow_context *context, const snow_transfer *t,
                            snow_value_table *table, bool *same) {
    size_t count = 4 * t->color_count + 2 * t->opacity_count, n = 0;
    SNOW_TRY(SNOW_RESERVE(context, table->next_key, 0, count + 1));
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
    table->next_key = table->key;
    table->key = key;
    table->key_count = count;
    return SNOW_STATUS_OK;
}

snow_status snow_value_table_make(snow_context *context,
                                  const snow_value_look *look,
                                  snow_value_table *table) {
    const size_t entries = SNOW_VALUE_PITCH * SNOW_VALUE_PITCH;
    bool same;
    SNOW_TRY(take_key(context, look->transfer, table, &same));
    const snow_value_look *made = &table->made;
    /* The looks serve again, whatever the length of rays and what entries keep.
     */
    const bool known = same && look->nodes == made->nodes &&
                       look->steps == made->steps &&
                       look->threshold == made->threshold &&
                       snow_value_same_scale(&look->scale, &made->scale);
    if (known && look->exponent == made->exponent &&
        look->placed == made->placed)
        return SNOW_STATUS_OK;
    bool anew = !table->entries;
    table->made.nodes = 0; /* until it is whole */
    SNOW_TRY(SNOW_RESERVE(context, table->entries, 0, entries));
    if (anew)
        memset(table->entries, 0, entries * sizeof *table->entries);
    SNOW_TRY(snow_value_looks_make(context, look, known, table));
    /* All entries; again where all are faint. */
    table_job job = {.look = look, .table = table};
    snow_work_fn *work = table->nodes ? fill_row : fill_rows;
    int items =
        table->nodes ? look->nodes : (look->nodes + ENTRIES - 1) / ENTRIES;
    float most = 0;
    snow_value_table_scale(table, 1, 0);
    SNOW_TRY(snow_parallel(context, look->threads, items, work, &job));
    for (int n = 0; n < look->nodes; n++)
        most = job.most[n] > most ? job.most[n] : most;
    snow_value_table_scale(table, most, FAINTEST);
    if (table->faint)
        SNOW_TRY(snow_parallel(context, look->threads, items, work, &job));
    find_intervals(look, table);
    table->made = *look;
    return SNOW_STATUS_OK;
}

void snow_value_table_begin(const snow_value_look *look,
                            snow_value_table *table) {
    table->made = *look;
    table->made.nodes = 0;
    table->interval_count = 0;
    snow_value_table_scale(table, 1, 0);
}

void snow_value_table_fini(snow_context *context, snow_value_table *table) {
    void *const blocks[] = {table->entries, table->node_of, table->at,
                            table->logs,    table->plain,   table->looks,
                            table->planes,  table->key,     table->next_key};
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++)
        snow_release(context, blocks[n]);
    *table = (snow_value_table){0};
}
