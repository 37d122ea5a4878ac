/* scene.c - from a file to pictures.  Of many ranks each has its part of the
 * volume, and the first gets the pictures (snowglass/ranks.h). */
#include "scene.h"
#include "commands.h"
#include "launch.h"
#include "remarks.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* What every rank tells the others of a picture. */
typedef struct rank_figures {
    snow_stats stats;
    uint64_t peak;
} rank_figures;

int scene_check(const options *asked) {
    remark_unused(asked);
    if (launch_ranks() > 1 && strcmp(asked->operands[0], "-") == 0)
        return fail_usage("-: many ranks read a file, each its part; name one");
    return GO_ON;
}

int scene_new(const options *asked, scene *out) {
    *out = (scene){.asked = asked};
    int done = open_render_context(asked, &out->context);
    if (done == GO_ON) {
        snow_context_set_limit(out->context, asked->memory);
        size_t ranks = (size_t)launch_ranks();
        out->figures = calloc(ranks, sizeof(rank_figures));
        if (!out->figures) {
            say("no memory to begin with; close other programs");
            done = SNOW_NO_MEMORY;
        }
    }
    return launch_agree(done);
}

/* In any order but the context last; all of them accept NULL. */
void scene_free(scene *s) {
    snow_image_free(s->made);
    snow_frame_free(s->frame);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    free(s->figures);
    if (s->context)
        close_render_context(s->context);
}

/* --- a volume --------------------------------------------------------------
 */

static int place_camera(scene *s) {
    int done = make_view(s->context, s->asked, &s->whole, &s->view);
    return done == GO_ON ? make_settings(s->asked, &s->whole, &s->settings)
                         : done;
}

/* A look that was chosen for a volume without surfaces is not shaded, unless
 * that is asked for. */
static void choose_shade(scene *s) {
    if (s->transfer && snow_transfer_is_flat(s->transfer) &&
        !options_told(s->asked, "shade"))
        s->settings.shade = SNOW_SHADE_NONE;
}

/* Blocks of the encoding that grow leave gaps in the heap, which count as
 * memory of the process; blocks of pages of their own go back to the system. */
static void return_memory(void) {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 256 << 10);
#endif
}

/* In memory, or in its file. */
static int open_as_planned(scene *s, const options *step) {
    if (!s->plan.streams)
        return open_input(s->context, step, s->path, &s->volume);
    return_memory();
    snow_volume_options data = data_options(step);
    snow_status status = snow_volume_stream(s->context, s->path, &data,
                                            s->plan.slab_bytes, &s->volume);
    if (status != SNOW_OK)
        return fail_status(s->context, status);
    if (step->verbosity > 0)
        say("%s: stays in its file, of which slabs of %.1f MiB, or more "
            "slices where less will not do, are read at a time",
            s->path, (double)s->plan.slab_bytes / 0x1p20);
    if (step->verbosity >= 0 && s->plan.packed)
        say("note: %s is packed, and is unpacked anew for each slab; unpack it "
            "to be faster",
            s->path);
    return GO_ON;
}

static int plan_memory(scene *s, const options *step) {
    snow_volume_options data = data_options(step);
    bool tell = step->verbosity > 0 && !s->transfer;
    int done = memory_plan_for(step, s->path, &data, tell, &s->plan);
    if (done != GO_ON)
        return done;
    s->plan.streams = s->plan.streams || (s->in_slabs && s->plan.may_stream);
    snow_context_set_limit(s->context, s->plan.limit);
    return GO_ON;
}

/* The volume is in memory, and what is made of it does not fit beside it: it
 * goes back to its file, for all to be tried once more. */
static int leave_in_file(scene *s, const options *step) {
    snow_frame_free(s->frame);
    s->frame = NULL;
    snow_volume_close(s->volume);
    s->volume = NULL;
    s->in_slabs = s->plan.streams = true;
    return open_as_planned(s, step);
}

static bool may_leave(const scene *s, snow_status status) {
    return status == SNOW_NO_MEMORY && s->plan.may_stream && !s->plan.streams;
}

/* Reading slabs is not part of it. */
static snow_status make_look(scene *s, const options *step) {
    snow_look look = look_options(step);
    double begin = seconds_now(), before = snow_volume_read_seconds(s->volume);
    snow_status status = snow_transfer_make(s->volume, &look, &s->transfer);
    double reading = snow_volume_read_seconds(s->volume) - before;
    s->times.look += seconds_now() - begin - reading;
    s->times.read += reading;
    return status;
}

/* Decompression and conversion are part of the reading. */
static int open_alone(scene *s, const options *step) {
    int done = plan_memory(s, step);
    double begin = seconds_now();
    if (done == GO_ON)
        done = open_as_planned(s, step);
    s->times.read += seconds_now() - begin;
    if (done != GO_ON)
        return done;
    s->whole = *snow_volume_describe(s->volume);
    snow_status status = s->transfer ? SNOW_OK : make_look(s, step);
    if (may_leave(s, status)) {
        done = leave_in_file(s, step);
        status = done == GO_ON ? make_look(s, step) : SNOW_OK;
    }
    if (status != SNOW_OK)
        return fail_volume(s->context, status, name_of_input(s->path));
    if (done == GO_ON)
        done = place_camera(s);
    choose_shade(s);
    return done;
}

/* Eight bits are enough on the way where the picture is laid on its background
 * and rounded to them in the end. */
static snow_ranks_options how_of(const scene *s) {
    const options *asked = s->asked;
    bool coarse = asked->background.given && !asked->deterministic &&
                  !(asked->bits && asked->bits[0] == '1');
    return (snow_ranks_options){
        .size = sizeof(snow_ranks_options),
        .cut = (snow_cut)option_choice("cut", asked->cut),
        .combining = (snow_combining)option_choice("combine", asked->combine),
        .radix = (int)asked->radix,
        .pixel_bits = coarse ? 8 : 0,
        .turns = s->turns,
        .transfer = s->transfer};
}

/* The camera comes first: the volume is cut to suit it. */
static int inspect(scene *s, const snow_volume_options *data) {
    snow_status status =
        snow_volume_inspect(s->context, s->path, data, &s->whole);
    return status == SNOW_OK ? place_camera(s)
                             : fail_status(s->context, status);
}

/* Making the transfer function is part of the reading: it needs values of all
 * parts. */
static int open_part(scene *s, const options *step) {
    double begin = seconds_now();
    snow_volume_options data = data_options(step);
    snow_look look = look_options(step);
    snow_ranks_options how = how_of(s);
    snow_transfer *transfer = NULL;
    int done = launch_agree(inspect(s, &data));
    if (done != GO_ON)
        return done;
    snow_status status =
        snow_ranks_open(launch_comm(), s->path, &data, &look, &s->view,
                        &s->settings, &how, &s->volume, &transfer);
    if (status != SNOW_OK)
        return fail_status(s->context, status);
    if (!s->transfer)
        s->transfer = transfer;
    choose_shade(s);
    s->times.read += seconds_now() - begin;
    return GO_ON;
}

options scene_step(const scene *s, int64_t time) {
    options step = *s->asked;
    step.time = time;
    step.each_time = s->each_time;
    return step;
}

/* The old volume goes first: there is never room for two. */
int scene_open(scene *s, const char *path, int64_t time) {
    options step = scene_step(s, time);
    s->path = path;
    snow_volume_close(s->volume);
    s->volume = NULL;
    return launch_ranks() > 1 ? open_part(s, &step) : open_alone(s, &step);
}

/* --- a picture -------------------------------------------------------------
 */

/* Sums of what ranks have, seconds of the slowest at each stage. */
static void add_figures(snow_stats *sum, const snow_stats *stats) {
    const struct {
        double *to, from;
    } rows[] = {{&sum->seconds_classify, stats->seconds_classify},
                {&sum->seconds_shade, stats->seconds_shade},
                {&sum->seconds_encode, stats->seconds_encode},
                {&sum->seconds_splat, stats->seconds_splat},
                {&sum->seconds_composite, stats->seconds_composite},
                {&sum->seconds_warp, stats->seconds_warp},
                {&sum->seconds_frame, stats->seconds_frame},
                {&sum->seconds_combine, stats->seconds_combine},
                {&sum->seconds_gather, stats->seconds_gather}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].from > *rows[i].to)
            *rows[i].to = rows[i].from;
    sum->voxels += stats->voxels;
    sum->interesting += stats->interesting;
    sum->ea_bytes += stats->ea_bytes;
    sum->ia_bytes += stats->ia_bytes;
    sum->pa_bytes += stats->pa_bytes;
}

static void sum_up(scene *s) {
    const rank_figures *figures = s->figures;
    const int ranks = launch_ranks();
    int64_t most = 0;
    s->stats = figures[0].stats;
    s->peak = 0;
    for (int rank = 0; rank < ranks; rank++) {
        if (rank)
            add_figures(&s->stats, &figures[rank].stats);
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

static int take_figures(scene *s) {
    rank_figures mine = {*snow_frame_stats(s->frame),
                         snow_context_peak_bytes(s->context)};
    snow_status status = SNOW_OK;
    if (launch_ranks() > 1)
        status = snow_comm_share(launch_comm(), &mine, sizeof mine, s->figures);
    else
        memcpy(s->figures, &mine, sizeof mine);
    sum_up(s);
    return status == SNOW_OK ? GO_ON : fail_status(s->context, status);
}

static snow_status begin_part(scene *s) {
    snow_ranks_options how = how_of(s);
    snow_status status = SNOW_OK;
    if (s->turns)
        status =
            snow_ranks_balance(s->frame, launch_comm(), s->transfer, &s->view,
                               &s->settings, &how, s->left, &s->volume);
    return status == SNOW_OK
               ? snow_ranks_begin(s->frame, launch_comm(), s->volume,
                                  s->transfer, &s->view, &s->settings, &how)
               : status;
}

static int make_frame(scene *s) {
    if (s->frame) /* on all ranks */
        return GO_ON;
    snow_status status = snow_frame_new(s->context, &s->frame);
    return launch_agree(status == SNOW_OK ? GO_ON
                                          : fail_status(s->context, status));
}

static snow_status draw_alone(scene *s) {
    double before = snow_volume_read_seconds(s->volume);
    snow_status status = snow_frame_render(s->frame, s->volume, s->transfer,
                                           &s->view, &s->settings, &s->made);
    s->times.read += snow_volume_read_seconds(s->volume) - before;
    return status;
}

/* A rank that is lost makes both pictures under way fail: one message. */
static int fail_picture(scene *s, snow_status status, const char *path) {
    if (!s->fault)
        s->fault = fail_volume(s->context, status, name_of_input(path));
    return s->fault;
}

int scene_begin(scene *s, double azimuth) {
    snow_status status;
    int done = make_frame(s);
    if (done != GO_ON)
        return done;
    s->view.azimuth = azimuth;
    status = launch_ranks() > 1 ? begin_part(s) : draw_alone(s);
    if (may_leave(s, status)) {
        options step = scene_step(s, s->whole.time);
        done = leave_in_file(s, &step);
        if (done == GO_ON)
            done = make_frame(s);
        if (done != GO_ON)
            return done;
        status = draw_alone(s);
    }
    if (status != SNOW_OK)
        return fail_picture(s, status, s->path);
    s->begun[s->under_way++] = (scene_shot){s->path, s->whole};
    return GO_ON;
}

int scene_finish(scene *s, snow_image **image) {
    snow_image *made = s->made;
    snow_status status = SNOW_OK;
    if (launch_ranks() > 1)
        status = snow_ranks_finish(s->frame, &made);
    s->made = NULL;
    s->drawn = s->begun[0];
    s->begun[0] = s->begun[1];
    s->under_way--;
    if (status != SNOW_OK)
        return fail_picture(s, status, s->drawn.path);
    int done = take_figures(s);
    if (done == GO_ON)
        *image = made;
    else
        snow_image_free(made);
    return done;
}

int scene_draw(scene *s, double azimuth, snow_image **image) {
    int done = scene_begin(s, azimuth);
    return done == GO_ON ? scene_finish(s, image) : done;
}

/* --- what is told ----------------------------------------------------------
 */

render_report scene_report(const scene *s) {
    return (render_report){.volume = &s->drawn.whole,
                           .stats = &s->stats,
                           .peak = s->peak,
                           .load = s->load,
                           .settings = &s->settings,
                           .times = &s->times};
}

void scene_choices(const scene *s, char *out, size_t size) {
    const double *from = s->asked->position.at;
    const char *view = s->asked->view           ? s->asked->view
                       : s->drawn.whole.medical ? "anterior"
                                                : "+z";
    char place[96];
    if (s->asked->position.given) {
        snprintf(place, sizeof place, "from %g,%g,%g", from[0], from[1],
                 from[2]);
        view = place;
    }
    bool encoded = s->stats.encoding != SNOW_ENCODING_AUTO;
    char volume[256];
    describe_volume(&s->drawn.whole, volume, sizeof volume);
    bool over = s->settings.mode == SNOW_MODE_OVER;
    snprintf(out, size, "%s: %s; %s%s%s%s; view %s; %s%s%smethod %s%s%s",
             name_of_input(s->drawn.path), volume,
             snow_transfer_text(s->transfer), over ? "; opacity per " : "",
             !over                            ? ""
             : s->settings.opacity_length > 0 ? "mm"
                                              : "voxel",
             over && s->settings.shade == SNOW_SHADE_NONE ? "; not shaded" : "",
             view, over ? "" : "mode ",
             over ? "" : snow_mode_name(s->settings.mode),
             over                        ? ""
             : s->settings.threshold > 0 ? " of all voxels (no threshold), "
                                         : " of all voxels, ",
             snow_method_name(s->stats.method), encoded ? ", encoding " : "",
             encoded ? snow_encoding_name(s->stats.encoding) : "");
}
