/* bench/speed/speed.c - `bench speed`: which pictures are timed, one case after
 * the other, and the two sweeps that make charts. */
#include "speed.h"
#include "chart.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define THRESHOLD 10.0       /* of 0 to 255, as in the paper's tables */
#define READ_BYTES 512000000 /* beyond what most caches hold */
#define QUICK_BYTES 8000000

/* One run of the program. */
typedef struct speed_run {
    snow_context *context;
    const bench_options *options;
    speed_filter filter;
    speed_machine machine;
    json_t *list;      /* of rows; NULL for text */
    chart_plot *chart; /* NULL but in sweeps */
} speed_run;

/* --- one case ------------------------------------------------------------- */

/* One row for each way and number of threads; baselines have one thread. */
static void lay_out(const speed_filter *filter, const speed_case *job,
                    const bench_options *options, speed_result *out) {
    for (int way = 0; way < speed_way_count; way++) {
        bool single = speed_is_baseline(&speed_ways[way]);
        if (!speed_way_taken(filter, job->sweep, way))
            continue;
        for (int i = 0; i < (single ? 1 : options->threads.count); i++)
            out->rows[out->count++] =
                (speed_row){.way = &speed_ways[way],
                            .threads = single ? 1 : options->threads.values[i]};
    }
}

snow_status speed_measure(snow_context *context, const bench_options *options,
                          const speed_filter *filter, const speed_case *job,
                          speed_result *out) {
    speed_session session = {
        .context = context, .job = job, .options = options};
    *out = (speed_result){.load = machine_load()};
    lay_out(filter, job, options, out);
    snow_view_init(&session.view);
    snow_status status = snow_view_from_name(context, "+z", &session.view);
    session.view.width = session.view.height = job->side;
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_sparse_ratio(job->volume->transfer,
                                            job->volume->volume, job->threshold,
                                            &out->sparse_ratio);
    const int64_t *dims = snow_volume_get_info(job->volume->volume)->dims;
    out->interesting = llround((double)(dims[0] * dims[1] * dims[2]) *
                               (1 - out->sparse_ratio));
    session.volume = job->volume->volume;
    if (status == SNOW_STATUS_OK)
        status = snow_volume_wrap(context, snow_volume_get_info(session.volume),
                                  snow_volume_voxels(session.volume),
                                  &session.changing);
    if (status == SNOW_STATUS_OK)
        status = speed_verify(&session, out);
    machine_mark mark = machine_mark_now();
    if (status == SNOW_STATUS_OK)
        status = speed_time(&session, out);
    out->others = machine_others(&mark);
    for (int way = 0; way < SPEED_WAYS_MOST; way++)
        snow_frame_free(session.frames[way]);
    speed_table_free(context, session.table);
    snow_volume_close(session.changing);
    return status;
}

static snow_status do_case(speed_run *run, const speed_case *job,
                           speed_result *result) {
    snow_status status =
        speed_measure(run->context, run->options, &run->filter, job, result);
    if (status == SNOW_STATUS_OK)
        speed_print_case(&run->machine, job, result, run->list);
    return status;
}

/* --- the table: volumes, looks, colours, shading, sizes ------------------- */

/* All pictures of one volume that the filter takes. */
static snow_status do_volume(speed_run *run, bench_volume *volume) {
    const bench_options *options = run->options;
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n < 8 * options->sides.count && status == SNOW_STATUS_OK;
         n++) {
        speed_result result;
        speed_case job = {
            .volume = volume,
            .look = n & 4 ? SPEED_OPAQUE : SPEED_TRANSLUCENT,
            .color = n & 2,
            .shade = n & 1 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE,
            .side = options->sides.values[n / 8],
            .threshold = THRESHOLD,
        };
        if (!speed_filter_takes(&run->filter, SPEED_LOOK, (int)job.look) ||
            !speed_filter_takes(&run->filter, SPEED_COLOR, job.color) ||
            !speed_filter_takes(&run->filter, SPEED_SHADE, (int)job.shade))
            continue;
        status = speed_dress(run->context, volume, job.look, job.color);
        if (status == SNOW_STATUS_OK)
            status = do_case(run, &job, &result);
    }
    return status;
}

static snow_status do_table(speed_run *run) {
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; speed_source(run->options, i) && status == SNOW_STATUS_OK;
         i++) {
        bench_volume volume;
        if (!speed_source_taken(run->options, i))
            continue;
        status = bench_source_open(run->context, speed_source(run->options, i),
                                   run->options, &volume);
        if (status != SNOW_STATUS_OK)
            break;
        status = do_volume(run, &volume);
        bench_volume_close(&volume);
    }
    return status;
}

/* --- sweeps --------------------------------------------------------------- */

/* A point for each charted way, of the first number of threads. */
static void add_points(speed_run *run, int panel, double x,
                       const speed_result *result) {
    for (int i = 0; i < result->count; i++) {
        const speed_row *row = &result->rows[i];
        if (row->threads != run->options->threads.values[0] &&
            !speed_is_baseline(row->way))
            continue;
        for (int n = 0; n < run->chart->line_count; n++) {
            chart_line *line = &run->chart->panels[panel].lines[n];
            if (run->chart->names[n] != row->way->charted ||
                line->count == CHART_POINTS)
                continue;
            line->x[line->count] = x;
            line->y[line->count++] = row->median;
        }
    }
}

static speed_case sweep_case(const speed_run *run, const bench_volume *volume) {
    return (speed_case){.volume = volume,
                        .look = SPEED_TRANSLUCENT,
                        .color = true,
                        .shade = SNOW_SHADE_NONE,
                        .side = run->options->sides.values[0],
                        .threshold = THRESHOLD,
                        .sweep = true};
}

static snow_status open_phantom(speed_run *run, const char *name, int64_t x,
                                int64_t y, int64_t z, bench_volume *out) {
    bench_options no_data = *run->options;
    bench_source source = {
        name,
        name,
        NULL,
        {.size = sizeof(snow_volume_options), .dims = {x, y, z}}};
    no_data.data = NULL;
    snow_status status =
        bench_source_open(run->context, &source, &no_data, out);
    if (status == SNOW_STATUS_OK)
        status = speed_dress(run->context, out, SPEED_TRANSLUCENT, true);
    if (status != SNOW_STATUS_OK)
        bench_volume_close(out);
    return status;
}

/* The threshold that makes exactly the voxels of values above `value`
 * interesting: between the opacities of two values. */
static double threshold_above(int value) {
    return 255 * speed_slope(SPEED_TRANSLUCENT) * (value + 0.25);
}

/* The least value above which no more than 1 - `target` of the voxels lie, by
 * halving; 254 when there is none. */
static snow_status find_value(const bench_volume *volume, double target,
                              int *value, double *sparse_ratio) {
    int low = 0, high = 254;
    while (low < high) {
        int middle = (low + high) / 2;
        SNOW_TRY(snow_transfer_sparse_ratio(volume->transfer, volume->volume,
                                            threshold_above(middle),
                                            sparse_ratio));
        if (*sparse_ratio >= target)
            high = middle;
        else
            low = middle + 1;
    }
    *value = low;
    return snow_transfer_sparse_ratio(volume->transfer, volume->volume,
                                      threshold_above(low), sparse_ratio);
}

/* Thresholds that bring a volume near each of these sparse ratios; what it
 * cannot be brought near to, for its values have gaps, is left out. */
static snow_status sweep_volume(speed_run *run, int panel,
                                const bench_volume *volume) {
    static const double targets[] = {0.3, 0.4, 0.5,  0.6,  0.7,
                                     0.8, 0.9, 0.95, 0.98, 0.99};
    int count = (int)(sizeof targets / sizeof *targets), last = -1;
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < count && status == SNOW_STATUS_OK; i++) {
        speed_case job = sweep_case(run, volume);
        speed_result result;
        double sparse_ratio = 0;
        int value;
        if (run->options->quick && i % 4 != 2)
            continue;
        status = find_value(volume, targets[i], &value, &sparse_ratio);
        if (status != SNOW_STATUS_OK || value == last ||
            sparse_ratio > 0.9985 ||
            (i + 1 < count && sparse_ratio > targets[i + 1] - 0.002))
            continue;
        job.original_known = last >= 0;
        job.threshold = threshold_above(value);
        last = value;
        status = do_case(run, &job, &result);
        if (status == SNOW_STATUS_OK)
            add_points(run, panel, 100 * sparse_ratio, &result);
    }
    return status;
}

static snow_status sweep_sparse(speed_run *run) {
    static const struct {
        const char *phantom;
        int dims[3];
    } panels[CHART_PANELS] = {{"phantom:head", {256, 256, 113}},
                              {"phantom:shells", {256, 256, 256}},
                              {"phantom:cube", {256, 256, 110}}};
    static const int quick_dims[3] = {40, 40, 32};
    snow_status status = SNOW_STATUS_OK;
    chart_plot *chart = run->chart;
    chart->title = "Time of a frame against the sparse ratio";
    chart->x_label = "sparse ratio, %";
    chart->tick_count = 8;
    for (int i = 0; i < 8; i++)
        chart->ticks[i] = 30 + 10 * i;
    for (int i = 0; i < CHART_PANELS && status == SNOW_STATUS_OK; i++) {
        const int *dims = run->options->quick ? quick_dims : panels[i].dims;
        chart_panel *panel = &chart->panels[chart->panel_count++];
        bench_volume volume;
        snprintf(panel->title, sizeof panel->title, "%s %dx%dx%d",
                 panels[i].phantom, dims[0], dims[1], dims[2]);
        status = open_phantom(run, panels[i].phantom, dims[0], dims[1], dims[2],
                              &volume);
        if (status != SNOW_STATUS_OK)
            break;
        status = sweep_volume(run, i, &volume);
        bench_volume_close(&volume);
    }
    return status;
}

/* Cubes of growing sides: up to 256^3, with --large up to 512^3. */
static snow_status sweep_size(speed_run *run) {
    static const char *const panels[] = {"phantom:engine", "phantom:head"};
    static const int sides[] = {128, 192, 256, 384, 512};
    static const int quick_sides[] = {24, 32, 40};
    const bool quick = run->options->quick;
    const int *list = quick ? quick_sides : sides;
    int count = quick ? 3 : run->options->large ? 5 : 3;
    snow_status status = SNOW_STATUS_OK;
    chart_plot *chart = run->chart;
    chart->title = "Time of a frame against the size of the volume";
    chart->x_label = "voxels along each side";
    chart->x_log = true;
    chart->tick_count = count;
    for (int i = 0; i < count; i++)
        chart->ticks[i] = list[i];
    for (int n = 0; n < 2 * count && status == SNOW_STATUS_OK; n++) {
        int panel = n / count, side = list[n % count];
        bench_volume volume;
        speed_result result;
        chart->panel_count = panel + 1;
        snprintf(chart->panels[panel].title, sizeof chart->panels[panel].title,
                 "%s", panels[panel]);
        status = open_phantom(run, panels[panel], side, side, side, &volume);
        if (status != SNOW_STATUS_OK)
            break;
        speed_case job = sweep_case(run, &volume);
        status = do_case(run, &job, &result);
        if (status == SNOW_STATUS_OK)
            add_points(run, panel, side, &result);
        bench_volume_close(&volume);
    }
    return status;
}

/* The sweep, and its chart when one was asked for. */
static snow_status do_sweep(speed_run *run, chart_plot *chart) {
    char how[192], where[512];
    int threads = run->options->threads.values[0];
    run->chart = chart;
    chart->y_label = "milliseconds per frame (median)";
    for (int way = 0; way < speed_way_count; way++)
        if (speed_ways[way].charted && chart->line_count < CHART_LINES)
            chart->names[chart->line_count++] = speed_ways[way].charted;
    snow_status status = strcmp(run->options->sweep, "size") == 0
                             ? sweep_size(run)
                             : sweep_sparse(run);
    snprintf(how, sizeof how,
             "translucent, RGBA, unshaded, %dx%d pixels, cubic B-spline 4x4, "
             "shear-warp tent; original and tested on 1 thread, others on %d",
             run->options->sides.values[0], run->options->sides.values[0],
             threads);
    snprintf(where, sizeof where, "%s; isa %s; %s; load average %.2f",
             machine_processor(), snow_isa_used(), machine_compiler(),
             machine_load());
    chart->notes[0] = how;
    chart->notes[1] = where;
    if (status == SNOW_STATUS_OK && run->options->chart)
        status = chart_write(chart, run->options->chart);
    return status;
}

/* --- the verb ------------------------------------------------------------- */

/* Asked before anything is measured, which takes minutes. */
static snow_status check(const bench_options *options) {
    if (!speed_volumes_known(options))
        return SNOW_STATUS_BAD_USAGE;
    if (options->chart && chart_check(options->chart) != SNOW_STATUS_OK)
        return SNOW_STATUS_BAD_OUTPUT;
    for (int i = 0; !options->sweep && speed_source(options, i); i++)
        if (speed_source_taken(options, i) &&
            !bench_source_found(speed_source(options, i), options))
            return SNOW_STATUS_BAD_INPUT;
    return SNOW_STATUS_OK;
}

/* The machine's rates for 1 thread, which baselines have, and for all numbers
 * of the list. */
static void measure_machine(const bench_options *options,
                            speed_machine *machine) {
    size_t bytes = options->quick ? QUICK_BYTES : READ_BYTES;
    bool one = false;
    for (int i = 0; i < options->threads.count; i++)
        one = one || options->threads.values[i] == 1;
    for (int i = one ? 0 : -1; i < options->threads.count; i++) {
        int threads = i < 0 ? 1 : options->threads.values[i];
        if (machine->count < SPEED_POWERS_MOST &&
            machine_measure(threads, bytes, &machine->power[machine->count]))
            machine->count++;
    }
}

/* What the library says, unless it was told already where it was found. */
static int end_in_failure(speed_run *run, snow_status status) {
    bool given =
        status == SNOW_STATUS_BAD_OUTPUT || status == SNOW_STATUS_DIFFERENT;
    json_decref(run->list);
    if (!given && *snow_context_message(run->context))
        bench_fail(run->context, status);
    else if (status == SNOW_STATUS_NO_MEMORY)
        fprintf(stderr, "snowglass: bench: %s\n",
                snow_status_description(status));
    return status == SNOW_STATUS_DIFFERENT ? SNOW_STATUS_FAILED : (int)status;
}

int bench_speed(snow_context *context, const bench_options *asked) {
    chart_plot chart = {0};
    bench_options options = *asked;
    speed_run run = {.context = context, .options = &options};
    if (options.chart && !options.sweep)
        options.sweep = "sparse";
    if (!options.sides.count)
        options.sides = (bench_list){1, {options.quick ? 64 : 512}};
    if (!options.threads.count) {
        options.threads = (bench_list){1, {1}};
        if (snow_processors() > 1)
            options.threads.values[options.threads.count++] = snow_processors();
    }
    if (!speed_filter_read(options.only, &run.filter))
        return SNOW_STATUS_BAD_USAGE;
    snow_status status = check(&options);
    if (status != SNOW_STATUS_OK)
        return (int)status;
    measure_machine(&options, &run.machine);
    run.list = options.json ? json_array() : NULL;
    if (!run.list)
        speed_print_machine(&run.machine);
    status = options.sweep ? do_sweep(&run, &chart) : do_table(&run);
    if (status != SNOW_STATUS_OK)
        return end_in_failure(&run, status);
    if (!run.list)
        return SNOW_STATUS_OK;
    return bench_print_json(json_pack(
        "{s:s, s:i, s:o, s:o}", "bench", "speed", "runs", options.runs,
        "machine", speed_machine_json(&run.machine), "rows", run.list));
}
