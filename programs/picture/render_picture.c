/* render_picture.c - the pictures of a volume that is open, and what is said of
 * them. */
#include "commands/commands.h"
#include "options/config.h"
#include "picture/light.h"
#include "picture/render_state.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Sums over ranks for counts; for times the slowest rank of each stage. */
static void add_figures(snow_stats *sum, const snow_stats *stats) {
    const struct {
        double *to, from;
    } rows[] = {{&sum->seconds_classify, stats->seconds_classify},
                {&sum->seconds_shade, stats->seconds_shade},
                {&sum->seconds_encode, stats->seconds_encode},
                {&sum->seconds_splat, stats->seconds_splat},
                {&sum->seconds_composite, stats->seconds_composite},
                {&sum->seconds_warp, stats->seconds_warp},
                {&sum->seconds_frame, stats->seconds_frame}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].from > *rows[i].to)
            *rows[i].to = rows[i].from;
    sum->voxels += stats->voxels;
    sum->interesting += stats->interesting;
    sum->ea_bytes += stats->ea_bytes;
    sum->ia_bytes += stats->ia_bytes;
    sum->pa_bytes += stats->pa_bytes;
}

static void sum_up(render_state *s) {
    const rank_figures *figures = s->figures;
    const int ranks = process_ranks();
    int64_t most = 0;
    s->stats = figures[0].stats;
    s->combine = s->gather = 0;
    s->peak = 0;
    for (int rank = 0; rank < ranks; rank++) {
        if (rank)
            add_figures(&s->stats, &figures[rank].stats);
        s->combine = fmax(s->combine, figures[rank].combine);
        s->gather = fmax(s->gather, figures[rank].gather);
        if (figures[rank].peak > s->peak)
            s->peak = figures[rank].peak;
        if (figures[rank].stats.interesting > most)
            most = figures[rank].stats.interesting;
    }
    double mean = (double)s->stats.interesting / ranks;
    s->load = mean > 0 ? (double)most / mean : 1;
    if (s->stats.voxels && ranks > 1)
        s->stats.sparse_ratio =
            1 - (double)s->stats.interesting / (double)s->stats.voxels;
}

static int take_figures(render_state *s) {
    const snow_ranks_stats *shared = snow_frame_ranks_stats(s->frame);
    rank_figures mine = {*snow_frame_stats(s->frame), shared->seconds_combine,
                         shared->seconds_gather,
                         snow_context_peak_bytes(s->context)};
    snow_status status = SNOW_STATUS_OK;
    if (process_ranks() > 1)
        status =
            snow_comm_allgather(process_comm(), &mine, sizeof mine, s->figures);
    else
        memcpy(s->figures, &mine, sizeof mine);
    sum_up(s);
    return check_status(s->context, status);
}

/* Other modes than over have none; a frame may have those of a picture before.
 */
static snow_status set_layers(render_state *s) {
    static const layers none;
    static const channel_set alone;
    const bool over = s->settings.mode == SNOW_MODE_OVER;
    return layers_set(over ? &s->layers : &none, over ? &s->channels : &alone,
                      s->frame);
}

static snow_status begin_part(render_state *s) {
    snow_ranks_options how = render_state_how(s);
    snow_status status = set_layers(s);
    if (s->turns && status == SNOW_STATUS_OK)
        status = snow_ranks_repartition(process_comm(), s->transfer, &s->view,
                                        &s->settings, &how, &s->volume);
    return status == SNOW_STATUS_OK
               ? snow_ranks_begin(s->frame, process_comm(), s->volume,
                                  s->transfer, &s->view, &s->settings, &how)
               : status;
}

/* By this process, or by all ranks, whose parts serve each picture in turn. */
static snow_status project(render_state *s, snow_volume **volume,
                           const snow_transfer *look) {
    snow_comm *comm = process_comm();
    const snow_ranks_options how = render_state_how(s);
    if (process_ranks() == 1)
        return snow_frame_render(s->frame, *volume, look, &s->view,
                                 &s->settings, &s->made);
    snow_status status = snow_ranks_repartition(comm, look, &s->view,
                                                &s->settings, &how, volume);
    return status == SNOW_STATUS_OK
               ? snow_ranks_render(s->frame, comm, *volume, look, &s->view,
                                   &s->settings, &how, &s->made)
               : status;
}

static snow_status project_channels(render_state *s) {
    snow_image *sum = NULL;
    snow_status status = set_layers(s), added = SNOW_STATUS_OK;
    for (int n = 0; n < s->channels.list.count && status == SNOW_STATUS_OK;
         n++) {
        snow_image_free(s->made);
        s->made = NULL;
        status = project(s, n ? &s->channels.volumes[n] : &s->volume,
                         n ? s->channels.looks[n] : s->transfer);
        if (status == SNOW_STATUS_OK && s->made && added == SNOW_STATUS_OK)
            added = light_add(s->context, s->made,
                              s->channels.list.picks[n].opacity, &sum);
    }
    if (sum)
        light_limit(sum);
    snow_image_free(s->made);
    s->made = sum;
    return status == SNOW_STATUS_OK ? added : status;
}

static snow_status draw_volume(render_state *s) {
    if (render_state_is_sum(s))
        return project_channels(s);
    snow_status status = set_layers(s);
    return status == SNOW_STATUS_OK
               ? snow_frame_render(s->frame, s->volume, s->transfer, &s->view,
                                   &s->settings, &s->made)
               : status;
}

/* What pictures before this one left in the frame has to go where the limit of
 * memory is too low for both. */
static snow_status draw_alone(render_state *s) {
    double before = snow_volume_read_seconds(s->volume);
    snow_status status = draw_volume(s);
    if (status == SNOW_STATUS_NO_MEMORY && s->drawn.path) {
        render_state_drop_frame(s);
        status = snow_frame_new(s->context, &s->frame);
        if (status == SNOW_STATUS_OK)
            status = draw_volume(s);
    }
    s->times.read += snow_volume_read_seconds(s->volume) - before;
    return status;
}

/* A lost rank makes both pictures in flight fail; only one message is
 * printed. */
static int fail_picture(render_state *s, snow_status status, const char *path) {
    if (!s->fault)
        s->fault = fail_volume(s->context, status, name_of_input(path));
    return s->fault;
}

int render_state_begin(render_state *s, double azimuth) {
    int done = CONTINUE;
    if (!s->frame) /* on all ranks */
        done = process_agree(
            check_status(s->context, snow_frame_new(s->context, &s->frame)));
    if (done != CONTINUE)
        return done;
    s->view.azimuth = azimuth;
    snow_status status = process_ranks() == 1     ? draw_alone(s)
                         : render_state_is_sum(s) ? project_channels(s)
                                                  : begin_part(s);
    if (render_state_may_start_over(s, (int)status)) {
        const snow_view view = s->view;
        const snow_settings settings = s->settings;
        const int channels = s->channels.list.count;
        done = render_state_start_over(s, s->whole.time);
        if (s->channels.list.count == channels) { /* the viewer's, say */
            s->view = view;
            s->settings = settings;
        }
        return done == CONTINUE ? render_state_begin(s, azimuth) : done;
    }
    done =
        status == SNOW_STATUS_OK ? CONTINUE : fail_picture(s, status, s->path);
    if (render_state_is_sum(s)) /* rank 0 alone adds them */
        done = process_agree(done);
    if (done != CONTINUE)
        return done;
    s->begun[s->in_flight++] = (render_state_shot){s->path, s->whole, s->made};
    s->made = NULL;
    return CONTINUE;
}

int render_state_finish(render_state *s, snow_image **image) {
    snow_image *made = s->begun[0].made;
    snow_status status = SNOW_STATUS_OK;
    if (process_ranks() > 1 && !render_state_is_sum(s))
        status = snow_ranks_finish(s->frame, &made);
    s->drawn = s->begun[0];
    s->begun[0] = s->begun[1];
    s->in_flight--;
    if (status != SNOW_STATUS_OK)
        return fail_picture(s, status, s->drawn.path);
    int done = take_figures(s);
    if (done == CONTINUE)
        *image = made;
    else
        snow_image_free(made);
    return done;
}

int render_state_draw(render_state *s, double azimuth, snow_image **image) {
    int done = render_state_begin(s, azimuth);
    return done == CONTINUE ? render_state_finish(s, image) : done;
}

int render_state_measure(render_state *s, bool everywhere) {
    options step = render_state_step(s, s->whole.time);
    const snow_volume *here = process_ranks() == 1 ? s->volume : NULL;
    return process_agree(
        process_talks() ? measures_find(&step, s->context, s->path, &s->whole,
                                        here, everywhere, &s->measures)
                        : CONTINUE);
}

/* --- reports -------------------------------------------------------------- */

render_report render_state_report(const render_state *s) {
    return (render_report){.volume = &s->drawn.whole,
                           .stats = &s->stats,
                           .combine = s->combine,
                           .gather = s->gather,
                           .peak = s->peak,
                           .load = s->load,
                           .settings = &s->settings,
                           .times = &s->times};
}

void render_state_note(const render_state *s, const double painted[2]) {
    const char *view = s->opts->view;
    if (s->channels.list.count)
        config_note_channels(s->opts, &s->channels.list, s->settings.shade,
                             view ? view
                                  : snow_view_name_for(&s->drawn.whole, NULL));
    else
        config_note(s->opts, s->transfer, s->settings.shade,
                    view ? view : snow_view_name_for(&s->drawn.whole, NULL),
                    painted);
}

/* Of a range, by which rounding may move a point. */
#define ROUNDING 1e-12

/* The preset of data values that a range is for; NULL: none. */
static const snow_look *ranged_preset(const options *opts) {
    int preset = opts->preset ? snow_preset_from_name(opts->preset) : -1;
    if (preset < 0 || options_range(opts).kind == SNOW_RANGE_AUTO)
        return NULL;
    const snow_look *look = snow_preset_look((size_t)preset);
    return look->domain == SNOW_DOMAIN_DATA ? look : NULL;
}

/* A range stretches a preset of data values with its opacities, which few
 * expect of a window.  One as wide as the preset's own moves both ends of the
 * colours alike: those of the preset, or of a map over all of it. */
static void describe_squeeze(const render_state *s, char out[160]) {
    const snow_look *look = ranged_preset(s->opts);
    double ends[2];
    *out = 0;
    if (!look)
        return;
    double first = look->colors[0].value;
    double last = look->colors[look->color_count - 1].value;
    double low = fmin(first, look->opacities[0].value);
    double high = fmax(last, look->opacities[look->opacity_count - 1].value);
    bool mapped = s->opts->colormap != NULL;
    snow_transfer_domain(s->transfer, &ends[0], &ends[1]);
    ends[0] -= mapped ? low : first;
    ends[1] -= mapped ? high : last;
    if (fabs(ends[1] - ends[0]) <= ROUNDING * (high - low)) /* it is moved */
        return;
    snprintf(out, 160,
             "; the range squeezes or stretches the preset's own %g..%g and "
             "its opacities; one of the same width moves them",
             low, high);
}

const snow_transfer *render_state_ground(const render_state *s) {
    const channel_list *list = &s->channels.list;
    return list->count && !(list->picks[0].white > 0) ? NULL : s->transfer;
}

void render_state_choices(const render_state *s, char *out, size_t size) {
    const double *from = s->opts->position.at;
    const char *view = s->opts->view
                           ? s->opts->view
                           : snow_view_name_for(&s->drawn.whole, NULL);
    char place[96];
    if (s->opts->position.given) {
        snprintf(place, sizeof place, "from %g,%g,%g", from[0], from[1],
                 from[2]);
        view = place;
    }
    bool encoded = s->stats.encoding != SNOW_ENCODING_AUTO;
    char volume[256], squeeze[160], look[640];
    describe_squeeze(s, squeeze);
    if (s->channels.list.count)
        channels_describe(&s->channels, look, sizeof look);
    else
        snprintf(look, sizeof look, "%s",
                 snow_transfer_description(s->transfer));
    describe_volume(&s->drawn.whole, volume, sizeof volume);
    bool over = s->settings.mode == SNOW_MODE_OVER;
    snprintf(out, size, "%s: %s; %s%s%s%s%s; view %s; %s%s%s%smethod %s%s%s",
             name_of_input(s->drawn.path), volume, look, squeeze,
             over ? "; opacity per " : "",
             !over                            ? ""
             : s->settings.opacity_length > 0 ? "mm"
                                              : "voxel",
             over && s->settings.shade == SNOW_SHADE_NONE ? "; not shaded" : "",
             view, over ? "" : "mode ",
             over ? "" : snow_mode_name(s->settings.mode),
             s->opts->slab ? " for a slab (-m over shows its cut)," : "",
             over                        ? ""
             : s->settings.threshold > 0 ? " of all voxels (no threshold), "
                                         : " of all voxels, ",
             snow_method_name(s->stats.method), encoded ? ", encoding " : "",
             encoded ? snow_encoding_name(s->stats.encoding) : "");
}
