/* bench/combine/combine_run.c - one exchange and one gather on every rank:
 * timed, counted, and compared with the picture of a chain.
 *
 * Real ranks leave a barrier at about the same time.  Simulated ones all have
 * the same clock, and start at the same moment of it; the picture is complete
 * when the last pixel is in rank 0's picture. */
#include "combine.h"

#include <snowglass/extend.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* One rank's buffers. */
typedef struct rank_state {
    combine_options options; /* with the size of files */
    snow_comm *comm;
    snow_combiner *combiner;
    combine_pattern pattern;
    int *spans, *order;
    float *pixels; /* the local image; NULL when only sizes are asked for */
    void *picture; /* rank 0's */
    snow_image_region region;
    combine_gather gather;
    double work[3]; /* of the profile: before the exchange, between it and the
                       gather, and in that */
} rank_state;

static double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static size_t picture_bytes(const combine_options *options) {
    return (size_t)options->width * (size_t)options->height *
           (size_t)options->channels * (options->bits == 8 ? 1 : sizeof(float));
}

/* --- the local image ------------------------------------------------------ */

static void draw(rank_state *state) {
    const combine_options *options = &state->options;
    const size_t channels = (size_t)options->channels;
    const snow_rectangle *drawn = &state->pattern.drawn;
    for (int y = drawn->y0; y < drawn->y1; y++)
        for (int x = drawn->x0; x < drawn->x1; x++)
            combine_pattern_pixel(
                &state->pattern, x, y,
                state->pixels +
                    ((size_t)y * (size_t)options->width + (size_t)x) *
                        channels);
}

/* The local image of a slab; spans of `lines` numbers are for a cube's. */
static snow_status open_pattern(const rank_state *state, int slab, int *spans,
                                combine_pattern *out) {
    if (state->options.pattern)
        return combine_file_open(state->comm->context, &state->options, slab,
                                 out);
    combine_pattern_make(&state->options, slab, state->comm->ranks, spans, out);
    return SNOW_STATUS_OK;
}

/* Collective.  The picture has the size of all files. */
static snow_status agree_size(rank_state *state) {
    const combine_pattern *own = &state->pattern;
    int64_t sizes[4] = {own->width, -own->width, own->height, -own->height};
    SNOW_TRY(snow_comm_reduce_ints(state->comm, sizes, 4, SNOW_REDUCE_MAX));
    if (sizes[0] != -sizes[1] || sizes[2] != -sizes[3])
        return snow_fail(state->comm->context, SNOW_STATUS_BAD_INPUT,
                         "%s: local images are of different sizes, %d to %d "
                         "columns and %d to %d lines; give pictures of one "
                         "view",
                         state->options.pattern, (int)-sizes[1], (int)sizes[0],
                         (int)-sizes[3], (int)sizes[2]);
    state->options.width = own->width;
    state->options.height = own->height;
    return SNOW_STATUS_OK;
}

/* Local work: this rank's line of the profile, if there is one. */
static snow_status read_profile(rank_state *state) {
    const char *path = state->options.profile;
    double *w = state->work;
    int lines = 0;
    char line[256];
    FILE *in = path ? fopen(path, "r") : NULL;
    while (in && fgets(line, sizeof line, in) &&
           sscanf(line, "%lf %lf %lf", &w[0], &w[1], &w[2]) == 3 &&
           ++lines <= state->comm->rank)
        continue;
    if (in)
        fclose(in);
    if (!path || lines == state->comm->rank + 1)
        return SNOW_STATUS_OK;
    return snow_fail(state->comm->context, SNOW_STATUS_BAD_INPUT,
                     "%s: has no line of three numbers for rank %d; write it "
                     "with bench frame --profile",
                     path, state->comm->rank);
}

/* Local work: lists, and the local image's pattern. */
static snow_status begin_pattern(rank_state *state) {
    snow_context *context = state->comm->context;
    const uint64_t lines = (uint64_t)state->options.height,
                   ranks = (uint64_t)state->comm->ranks;
    state->spans = snow_allocate_array(context, 2 * lines, sizeof(int));
    state->order = snow_allocate_array(context, ranks, sizeof(int));
    if (!state->spans || !state->order)
        return SNOW_STATUS_NO_MEMORY;
    for (int i = 0; i < state->comm->ranks; i++)
        state->order[i] = i;
    SNOW_TRY(read_profile(state));
    return open_pattern(state, state->comm->rank, state->spans,
                        &state->pattern);
}

/* Local work: the local image.  In a simulation of sizes alone there are no
 * pictures. */
static snow_status prepare(rank_state *state) {
    const combine_options *options = &state->options;
    snow_context *context = state->comm->context;
    if (options->sizes_only)
        return SNOW_STATUS_OK;
    state->pixels = snow_allocate_array(
        context, (uint64_t)options->width * (uint64_t)options->height,
        (size_t)options->channels * sizeof(float));
    if (!state->pixels)
        return SNOW_STATUS_NO_MEMORY;
    if (state->comm->rank == 0 && !(state->picture = snow_allocate_clear(
                                        context, picture_bytes(options))))
        return SNOW_STATUS_NO_MEMORY;
    draw(state);
    return SNOW_STATUS_OK;
}

static void finish(rank_state *state) {
    snow_context *context = state->comm->context;
    combine_gather_free(state->comm->context, &state->gather);
    snow_combiner_free(state->combiner);
    combine_file_close(context, &state->pattern);
    snow_release(context, state->spans);
    snow_release(context, state->order);
    snow_release(context, state->pixels);
    snow_release(context, state->picture);
}

/* --- one run -------------------------------------------------------------- */

/* All ranks go on together. */
static snow_status line_up(snow_comm *comm) {
    double now = snow_comm_seconds(comm);
    SNOW_TRY(snow_comm_reduce_doubles(comm, &now, 1, SNOW_REDUCE_MAX));
    /* The last rank has the news well within a second. */
    if (comm->ops.work)
        snow_comm_work(comm, now + 1 - snow_comm_seconds(comm));
    return SNOW_STATUS_OK;
}

/* Pixels of a piece that are not nothing. */
static int64_t count_shown(const snow_image_region *region) {
    int64_t shown = 0;
    for (int64_t i = region->first / 64; i * 64 < region->first + region->count;
         i++)
        shown += __builtin_popcountll(region->active[i - region->first / 64]);
    return shown;
}

/* Local images are as drawn, or, to take memory, empty. */
static snow_status run_once(rank_state *state, bool drawn,
                            combine_figures *out) {
    const combine_options *options = &state->options;
    snow_comm *comm = state->comm;
    const snow_rehearsal rehearsal = {combine_pattern_active, &state->pattern};
    const snow_exchange_params order = {
        .width = options->width,
        .height = options->height,
        .channels = options->channels,
        .pixels = state->pixels,
        .stride = (size_t)options->width * (size_t)options->channels,
        .drawn = drawn ? state->pattern.drawn : (snow_rectangle){0},
        .ranks = state->order,
        .method = options->method,
        .radix = options->radix,
        .grain = 1,
        .regions = options->regions,
        .whole = options->whole,
        .threads = options->threads,
        .rehearsal = options->sizes_only ? &rehearsal : NULL,
        .scan_seconds = options->scan,
        .blend_seconds = options->blend,
        .move_seconds = options->move};
    if (drawn)
        SNOW_TRY(line_up(comm));
    const uint64_t bytes = comm->bytes_sent, messages = comm->messages_sent,
                   lent = comm->bytes_lent;
    const double start = snow_comm_seconds(comm), cpu = cpu_seconds();
    snow_comm_work(comm, state->work[0]);
    SNOW_TRY(snow_exchange(state->combiner, &order, &state->region));
    snow_comm_work(comm, state->work[1]);
    const double between = snow_comm_seconds(comm), cpu_between = cpu_seconds();
    out->exchange_bytes = (int64_t)(comm->bytes_sent - bytes);
    out->exchange_messages = (int64_t)(comm->messages_sent - messages);
    SNOW_TRY(combine_gather_region(state->combiner, &state->gather,
                                   &state->region, options->bits,
                                   options->round, state->picture));
    snow_comm_work(comm, state->work[2]);
    const double end = snow_comm_seconds(comm);
    const snow_exchange_figures *given =
        snow_exchange_get_figures(state->combiner);
    out->exchange = between - start;
    out->gather = end - between;
    out->total = end - start;
    out->exchange_cpu = cpu_between - cpu;
    out->gather_cpu = cpu_seconds() - cpu_between;
    out->bytes_sent = (int64_t)(comm->bytes_sent - bytes);
    out->messages = (int64_t)(comm->messages_sent - messages);
    out->bytes_lent = (int64_t)(comm->bytes_lent - lent);
    out->active = given->active;
    out->scanned = given->scanned;
    out->laid = given->laid;
    out->shown = count_shown(&state->region);
    return SNOW_STATUS_OK;
}

/* --- the check ------------------------------------------------------------ */

/* Lays a local image behind a picture of floats, as a chain of ranks would. */
static void composite_behind(const combine_pattern *layer, float *picture) {
    const int last = layer->channels - 1;
    const snow_rectangle *drawn = &layer->drawn;
    for (int y = drawn->y0; y < drawn->y1; y++)
        for (int x = drawn->x0; x < drawn->x1; x++) {
            float *front =
                picture + ((size_t)y * (size_t)layer->width + (size_t)x) *
                              (size_t)layer->channels;
            float back[4], left = 1 - front[last];
            combine_pattern_pixel(layer, x, y, back);
            for (int k = 0; k <= last; k++)
                front[k] += left * back[k];
        }
}

/* The largest difference of a channel of rank 0's picture. */
static double compare(const combine_options *options, const float *expected,
                      const void *picture) {
    const size_t count = (size_t)options->width * (size_t)options->height *
                         (size_t)options->channels;
    const unsigned char *bytes = picture;
    const float *floats = picture;
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        double is = options->bits == 8 ? bytes[i] / 255.0 : (double)floats[i];
        double off = fabs(is - (double)expected[i]);
        most = off > most || off != off ? off : most;
    }
    return most;
}

static snow_status compare_picture(rank_state *state, double *out) {
    const combine_options *options = &state->options;
    snow_context *context = state->comm->context;
    snow_status status = SNOW_STATUS_OK;
    int *spans = snow_allocate_array(context, 2 * (uint64_t)options->height,
                                     sizeof *spans);
    float *expected = snow_allocate_clear(
        context, (size_t)options->width * (size_t)options->height *
                     (size_t)options->channels * sizeof *expected);
    if (!spans || !expected)
        status = SNOW_STATUS_NO_MEMORY;
    for (int i = 0; i < state->comm->ranks && status == SNOW_STATUS_OK; i++) {
        combine_pattern layer = {0};
        status = open_pattern(state, i, spans, &layer);
        if (status == SNOW_STATUS_OK)
            composite_behind(&layer, expected);
        combine_file_close(context, &layer);
    }
    if (status == SNOW_STATUS_OK)
        *out = compare(options, expected, state->picture);
    snow_release(context, spans);
    snow_release(context, expected);
    return status;
}

/* --- all ranks ------------------------------------------------------------ */

/* All figures as numbers of one kind: counters are far below 2^53. */
#define FIGURES 14

static void list_figures(const combine_figures *f, double list[FIGURES]) {
    const double all[FIGURES] = {f->exchange,
                                 f->gather,
                                 f->total,
                                 f->exchange_cpu,
                                 f->gather_cpu,
                                 (double)f->bytes_sent,
                                 (double)f->messages,
                                 (double)f->active,
                                 (double)f->scanned,
                                 (double)f->laid,
                                 (double)f->exchange_bytes,
                                 (double)f->exchange_messages,
                                 (double)f->shown,
                                 (double)f->bytes_lent};
    memcpy(list, all, sizeof all);
}

static snow_status reduce_by(snow_comm *comm, const combine_figures *mine,
                             snow_reduce by, combine_figures *out) {
    double f[FIGURES];
    list_figures(mine, f);
    SNOW_TRY(snow_comm_reduce_doubles(comm, f, FIGURES, by));
    *out = (combine_figures){.exchange = f[0],
                             .gather = f[1],
                             .total = f[2],
                             .exchange_cpu = f[3],
                             .gather_cpu = f[4],
                             .bytes_sent = (int64_t)f[5],
                             .messages = (int64_t)f[6],
                             .active = (int64_t)f[7],
                             .scanned = (int64_t)f[8],
                             .laid = (int64_t)f[9],
                             .exchange_bytes = (int64_t)f[10],
                             .exchange_messages = (int64_t)f[11],
                             .shown = (int64_t)f[12],
                             .bytes_lent = (int64_t)f[13],
                             .difference = mine->difference};
    return SNOW_STATUS_OK;
}

/* The fastest run counts; rank 0's total is that of the picture. */
static snow_status measure(rank_state *state, combine_result *out) {
    snow_comm *comm = state->comm;
    const combine_options *options = &state->options;
    combine_result best = {.ranks = comm->ranks};
    best.most.total = -1;
    /* Memory is taken in runs before the first that counts. */
    combine_figures spare;
    SNOW_TRY(run_once(state, false, &spare));
    if (snow_exchange_get_figures(state->combiner)->counted)
        SNOW_TRY(run_once(state, true, &spare));
    for (int i = 0; i < options->runs; i++) {
        combine_figures mine = {.difference = -1};
        combine_result this = {.ranks = comm->ranks,
                               .width = options->width,
                               .height = options->height};
        SNOW_TRY(run_once(state, true, &mine));
        this.given = *snow_exchange_get_figures(state->combiner);
        SNOW_TRY(reduce_by(comm, &mine, SNOW_REDUCE_MAX, &this.most));
        SNOW_TRY(reduce_by(comm, &mine, SNOW_REDUCE_SUM, &this.sum));
        if (best.most.total < 0 || this.most.total < best.most.total)
            best = this;
    }
    double difference = -1;
    snow_status status = SNOW_STATUS_OK;
    if (options->check && comm->rank == 0)
        status = compare_picture(state, &difference);
    best.most.difference = difference;
    SNOW_TRY(snow_comm_agree_status(comm, status));
    best.hosts = (bench_hosts){comm->ranks, 1}; /* as those simulated are */
    if (!options->simulated)
        SNOW_TRY(bench_hosts_count(comm, &best.hosts));
    if (comm->rank == 0)
        *out = best;
    return SNOW_STATUS_OK;
}

snow_status combine_body(snow_comm *comm, void *user) {
    combine_session *session = user;
    rank_state state = {.options = *session->options, .comm = comm};
    snow_status status = snow_combiner_new(comm, &state.combiner);
    if (status == SNOW_STATUS_OK)
        status = begin_pattern(&state);
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK && state.options.pattern)
        status = agree_size(&state);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_agree_status(comm, prepare(&state));
    if (status == SNOW_STATUS_OK)
        snow_gather_radix(state.combiner, session->options->gather);
    if (status == SNOW_STATUS_OK)
        status = measure(&state, &session->result);
    finish(&state);
    return status;
}
