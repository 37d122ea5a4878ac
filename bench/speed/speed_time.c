/* bench/speed/speed_time.c - times of one case, taken in turns.
 *
 * The camera turns by half a degree from picture to picture, as a user turns
 * it, so that a method which keeps its encoding can.  In each run every way
 * draws some pictures in a row, the first of which only warms the caches that
 * the way before has filled; then the next way has its turn, so that a change
 * of the machine's speed meets them all.  Slow ways stop early: three pictures
 * of a second each tell enough. */
#include "speed.h"

#include <stdlib.h>

#define AZIMUTH 25.0 /* degrees: between two axes, far from any switch */
#define ELEVATION 20.0
#define STEP 0.5
#define STEPS 21 /* up to 35 degrees, then from the first again */

#define BURST_SECONDS 0.04 /* one turn of a way, */
#define BURST_MOST 16      /* or so many pictures */
#define BUDGET_SECONDS 1.0 /* for a way in all, after FRAMES_LEAST */
#define FRAMES_LEAST 3
#define SLOW_SECONDS 5.0 /* a picture that takes so long is drawn twice */
#define RUNS_MOST 99
#define FRAMES_MOST (RUNS_MOST * BURST_MOST)

/* Milliseconds of all pictures of one row. */
typedef struct row_samples {
    int count, encodes;
    double spent; /* seconds */
    double wall[FRAMES_MOST], cpu[FRAMES_MOST];
    double serial[FRAMES_MOST], longest[FRAMES_MOST];
    double encode[RUNS_MOST], anew[RUNS_MOST];
} row_samples;

const snow_view *speed_view(speed_session *session, int step) {
    session->view.azimuth = AZIMUTH + STEP * (step % STEPS);
    session->view.elevation = ELEVATION;
    return &session->view;
}

static snow_status hand_over(snow_image *made, snow_image **image) {
    if (image)
        *image = made;
    else
        snow_image_free(made);
    return SNOW_STATUS_OK;
}

snow_status speed_render(speed_session *session, int index, snow_isa isa,
                         int threads, double threshold, int step,
                         snow_image **image) {
    const speed_way *way = &speed_ways[index];
    snow_settings settings;
    snow_image *made;
    snow_settings_init(&settings);
    settings.method = way->method;
    settings.encoding = way->encoding;
    settings.quality = way->quality;
    settings.kernel = way->kernel;
    settings.footprint = way->footprint;
    settings.shade = session->job->shade;
    settings.isa = isa;
    settings.threads = threads ? threads : 1;
    settings.threshold = threshold;
    settings.light = SNOW_LIGHT_HEAD; /* as peers have */
    if (way->tabled) {
        snow_status status = speed_table_render(
            session->context, &session->table, session->volume,
            session->job->volume->transfer, speed_view(session, step),
            &settings, &session->table_stats, &made);
        return status == SNOW_STATUS_OK ? hand_over(made, image) : status;
    }
    if (!session->frames[index]) {
        SNOW_TRY(snow_frame_new(session->context, &session->frames[index]));
    }
    snow_status status = snow_frame_render(
        session->frames[index], session->volume, session->job->volume->transfer,
        speed_view(session, step), &settings, &made);
    return status == SNOW_STATUS_OK ? hand_over(made, image) : status;
}

const snow_stats *speed_stats(const speed_session *session, int way) {
    return speed_ways[way].tabled ? &session->table_stats
                                  : snow_frame_stats(session->frames[way]);
}

static int way_of(const speed_row *row) {
    return (int)(row->way - speed_ways);
}

/* What keeps no encoding tells how long it took; what keeps it, whether it
 * did. */
static bool has_encoded(const snow_stats *stats) {
    return stats->encoded || (stats->method == SNOW_METHOD_FOOTPRINT &&
                              stats->seconds_encode > 0);
}

/* One picture, whose figures are kept unless it warms up. */
static snow_status draw(speed_session *session, speed_row *row,
                        row_samples *samples, int step, bool warming) {
    SNOW_TRY(speed_render(session, way_of(row), SNOW_ISA_AUTO, row->threads,
                          session->job->threshold, step, NULL));
    const snow_stats *stats = speed_stats(session, way_of(row));
    row->stats = *stats;
    samples->spent += stats->seconds_frame;
    if (warming)
        return SNOW_STATUS_OK;
    samples->wall[samples->count] = 1e3 * stats->seconds_frame;
    samples->serial[samples->count] =
        1e3 * (stats->seconds_frame - stats->seconds_shared);
    samples->longest[samples->count] = 1e3 * stats->seconds_longest;
    samples->cpu[samples->count++] = 1e3 * stats->cpu_frame;
    row->encoded_frames += has_encoded(stats);
    return SNOW_STATUS_OK;
}

/* A way's turn in a run.  Caches do not matter to a picture that takes as long
 * as a whole turn. */
static snow_status draw_burst(speed_session *session, speed_row *row,
                              row_samples *samples, int run) {
    bool slow = samples->count &&
                samples->spent > BURST_SECONDS * (double)samples->count;
    int most = session->options->quick ? 1 : BURST_MOST;
    double end = samples->spent + BURST_SECONDS;
    const bool enough =
        samples->count && samples->spent > SLOW_SECONDS * samples->count
            ? samples->count >= 2
            : samples->spent > BUDGET_SECONDS && samples->count >= FRAMES_LEAST;
    if (enough)
        return SNOW_STATUS_OK;
    snow_status status =
        slow ? SNOW_STATUS_OK : draw(session, row, samples, run, true);
    for (int i = 0; i < most && status == SNOW_STATUS_OK; i++) {
        status = draw(session, row, samples, run + i, false);
        if (samples->spent >= end)
            break;
    }
    return status;
}

static snow_status draw_still(speed_session *session, const speed_row *row) {
    return speed_render(session, way_of(row), SNOW_ISA_AUTO, row->threads,
                        session->job->threshold, 0, NULL);
}

/* As if a lower threshold was asked for: all is encoded, to arrays that are
 * there.  Then again what the next pictures are made of. */
static snow_status draw_anew(speed_session *session, speed_row *row,
                             row_samples *samples) {
    session->volume = session->changing;
    snow_status status = draw_still(session, row);
    session->volume = session->job->volume->volume;
    if (status != SNOW_STATUS_OK)
        return status;
    const snow_stats *stats = speed_stats(session, way_of(row));
    if (!has_encoded(stats) || samples->encodes == RUNS_MOST)
        return SNOW_STATUS_OK;
    /* Shear-warp classifies as it encodes. */
    bool sheared = stats->method == SNOW_METHOD_SHEAR_WARP;
    samples->encode[samples->encodes] =
        1e3 * (stats->seconds_encode + (sheared ? 0 : stats->seconds_classify));
    samples->anew[samples->encodes++] = 1e3 * stats->seconds_frame;
    return draw_still(session, row);
}

/* What other programs have not lengthened. */
static double least_of(const double *values, int count) {
    double least = values[0];
    for (int n = 1; n < count; n++)
        least = values[n] < least ? values[n] : least;
    return least;
}

/* Medians and minima out of the samples, which are sorted. */
static void sum_up(row_samples *samples, speed_row *row) {
    row->frames = samples->count;
    row->median = bench_median(samples->wall, samples->count);
    row->least = samples->wall[0];
    row->cpu = bench_median(samples->cpu, samples->count);
    row->encode = row->new_threshold = row->serial = row->longest = -1;
    if (row->threads == 1) {
        row->serial = least_of(samples->serial, samples->count);
        row->longest = least_of(samples->longest, samples->count);
    }
    if (samples->encodes) {
        row->encode = bench_median(samples->encode, samples->encodes);
        row->new_threshold = bench_median(samples->anew, samples->encodes);
    }
}

snow_status speed_time(speed_session *session, speed_result *result) {
    int runs = session->options->runs;
    snow_status status = SNOW_STATUS_OK;
    row_samples *all = calloc((size_t)result->count + 1, sizeof *all);
    if (!all)
        return SNOW_STATUS_NO_MEMORY;
    for (int run = 0; run < runs; run++)
        for (int i = 0; i < result->count && status == SNOW_STATUS_OK; i++)
            status = draw_burst(session, &result->rows[i], &all[i], run);
    /* A third as often: a new threshold is rarer than a new view. */
    for (int run = 0; run < (runs + 2) / 3; run++)
        for (int i = 0; i < result->count && status == SNOW_STATUS_OK; i++)
            if (!speed_is_baseline(result->rows[i].way))
                status = draw_anew(session, &result->rows[i], &all[i]);
    for (int i = 0; i < result->count && status == SNOW_STATUS_OK; i++)
        sum_up(&all[i], &result->rows[i]);
    free(all);
    return status;
}
