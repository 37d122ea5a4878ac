/* movie_steps.c - lists the volumes that a movie shows, in order, and makes one
 * transfer function for all. */
#define _XOPEN_SOURCE 700
#include "commands/commands.h"
#include "movie/movie_files.h"
#include "movie/movie_render.h"
#include "run/log.h"
#include "run/memory.h"
#include "run/paths.h"
#include "run/start.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whether the transfer function depends on the options alone: a preset with
 * values of its own, or one that is spread over given values. */
static bool look_is_fixed(const options *opts) {
    if (!opts->preset)
        return false;
    const char *name =
        snow_preset_name((size_t)snow_preset_from_name(opts->preset));
    snow_range range = options_range(opts).kind;
    return range == SNOW_RANGE_VALUES ||
           (strncmp(name, "ct-", 3) == 0 && range == SNOW_RANGE_AUTO);
}

/* The options of a step, and of one of the channels that are drawn. */
static options options_of(const render_state *s, const movie_shot *shot,
                          int channel) {
    options step = render_state_step(s, shot->time);
    if (channel < s->channels.list.count)
        step.channel = s->channels.list.picks[channel].index;
    return step;
}

/* Reads what the header says about a shot's volume. */
static int inspect(const shot_renderer *shots, const movie_shot *shot,
                   int channel, snow_volume_info *out) {
    options step = options_of(&shots->state, shot, channel);
    snow_volume_options data = data_options(&step);
    return check_status(
        shots->state.context,
        snow_volume_inspect(shots->state.context, shot->path, &data, out));
}

/* The last number in a file's name before its suffix: 10 for run_0010.nrrd;
 * `usual` if there is none. */
static int64_t number_in(const char *path, int64_t usual) {
    char file[PATH_MAX];
    file_of_input(path, file, sizeof file);
    const char *slash = strrchr(file, '/');
    const char *name = slash ? slash + 1 : file;
    const char *end = strrchr(name, '.');
    int64_t number = usual;
    while (*name && name != end) {
        size_t digits = strspn(name, "0123456789");
        if (digits > 0 && digits <= 15)
            number = strtoll(name, NULL, 10);
        name += digits ? digits : 1;
    }
    return number;
}

/* The steps of --time A:B among `*count`: from `*from` on. */
static int take_range(const options *opts, int64_t *from, int64_t *count) {
    int64_t end = opts->time_end;
    if (!opts->time_range)
        return CONTINUE;
    *from = opts->time < 0 ? *count + opts->time : opts->time;
    end = end == INT64_MAX ? *count : end < 0 ? *count + end : end;
    if (*from < 0 || end > *count || *from >= end)
        return fail_usage("--time: there are %" PRId64
                          " steps, counted from 0; give the first one and one "
                          "past the last, such as 0:%" PRId64,
                          *count, *count);
    *count = end - *from;
    return CONTINUE;
}

int steps_list(step_files *files, shot_renderer *shots, shot_list *out) {
    const options *opts = shots->state.opts;
    const bool given = options_given(opts, "time") && !opts->time_range;
    int done = given ? CONTINUE : steps_expand(opts, files);
    if (done != CONTINUE)
        return done;
    movie_shot first = {.path = files->paths[0],
                        .time = opts->time_range ? 0 : opts->time,
                        .azimuth = opts->azimuth};
    out->count = files->count;
    out->steps = true;
    shots->state.steps = true;
    shots->state.each_time = (files->count == 1 || files->times) && !given;
    shots->whole_files = files->count > 1 && !given && !files->times;
    if (shots->state.each_time && !files->times) {
        snow_volume_info info = {.size = sizeof info};
        done = inspect(shots, &first, 0, &info);
        if (done != CONTINUE)
            return done;
        out->count = info.times;
    }
    int64_t from = 0;
    done = take_range(opts, &from, &out->count);
    if (done != CONTINUE)
        return done;
    out->looked = look_is_fixed(opts) ? 0 : out->count;
    out->shots = calloc((size_t)out->count, sizeof *out->shots);
    if (!out->shots)
        return steps_fail_memory();
    for (int64_t i = 0; i < out->count; i++) {
        movie_shot *shot = &out->shots[i];
        *shot = first;
        if (files->times) {
            shot->path = files->paths[from + i];
            shot->time = files->times[from + i];
            shot->step = from + i;
        } else if (files->count > 1) {
            shot->path = files->paths[from + i];
            shot->step = number_in(shot->path, from + i);
        } else {
            shot->time = given ? first.time : from + i;
            shot->step = shot->time;
        }
    }
    return CONTINUE;
}

/* --- one transfer function for all steps ---------------------------------- */

/* The number of values taken from all steps together, and the minimum from
 * each: enough that the histogram looks the same. */
#define POOL_VALUES (INT64_C(1) << 22)
#define STEP_VALUES 1024

/* The most labels of a look. */
#define LABELS_MOST 4096

/* What a rank has read: the values of its share of a step, and their smallest
 * and largest. */
typedef struct step_values {
    int64_t count;
    double ends[2];
} step_values;

/* The values of all steps, in order. */
typedef struct value_pool {
    double *values;
    int64_t count;
    double *step;        /* values of the step that this rank has read */
    step_values given;   /* describes `step` */
    int64_t quota;       /* values of one step */
    bool sampled;        /* a step has more: two are its extremes */
    int group;           /* ranks that read a step together, one slab each */
    int channel;         /* of those that are drawn */
    snow_volume *volume; /* the step, if this rank has read all of it */
    bool labelled;       /* all steps so far are drawn as labels: */
    snow_label *labels;  /* of all, and behind them room for those of one */
    int64_t label_count;
} value_pool;

/* Sampled are pieces of rows, about so long: whether neighbours are noise is
 * part of a look.  All pieces of a step have one length; the last of a row ends
 * with it, and may begin within the one before. */
#define PIECE 64
#define PIECE_MOST 512 /* rows of small steps stay whole */

typedef struct pieces {
    int64_t of_row, length;
    int64_t stride; /* from one that is sampled to the next */
} pieces;

/* The stride has no common factor with the pieces of a slice, so that the
 * sample does not follow one column of them. */
static pieces pieces_of(const snow_volume_info *step, int64_t quota) {
    const int64_t *n = step->dims;
    const bool whole = n[0] <= PIECE_MOST && n[0] * n[1] * n[2] <= quota;
    pieces p = {.of_row = whole ? 1 : (n[0] + PIECE - 1) / PIECE, .stride = 1};
    p.length = (n[0] + p.of_row - 1) / p.of_row;
    const int64_t slice = p.of_row * n[1];
    const int64_t most = quota > p.length ? quota / p.length : 1;
    p.stride = (slice * n[2] + most - 1) / most;
    for (int64_t factor = 2; p.stride > 1 && factor != 1;) {
        int64_t b = slice;
        factor = p.stride;
        while (b) {
            const int64_t rest = factor % b;
            factor = b;
            b = rest;
        }
        p.stride += factor != 1;
    }
    return p;
}

/* Reads a stored value as a double. */
static double native(const void *voxels, snow_type type, int64_t i) {
    switch (type) {
#define NATIVE(name, c_type, text) \
    case SNOW_TYPE_##name:         \
        return (double)((const c_type *)voxels)[i];
        SNOW_TYPE_MAP(NATIVE)
#undef NATIVE
    default:
        return 0;
    }
}

/* Samples a step's data values and finds its extremes, which no sample may
 * miss, from slice `first` on of a step with the geometry `whole`.  The sample
 * does not depend on how many ranks share it. */
static void pool_slab(value_pool *pool, const snow_volume_info *whole,
                      int64_t first, const snow_volume *volume) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    const void *voxels = snow_volume_voxels(volume);
    const pieces p = pieces_of(whole, pool->quota);
    const int64_t width = info->dims[0], above = first * info->dims[1];
    const int64_t end = (above + info->dims[1] * info->dims[2]) * p.of_row;
    int64_t piece = (above * p.of_row + p.stride - 1) / p.stride * p.stride;
    snow_volume_statistics ends = {.size = sizeof ends};
    snow_volume_get_statistics(volume, &ends);
    pool->given = (step_values){0, {ends.min, ends.max}};
    for (; piece < end; piece += p.stride) {
        const int64_t last = width - p.length, x = piece % p.of_row * p.length;
        const int64_t at =
            (piece / p.of_row - above) * width + (x < last ? x : last);
        for (int64_t i = 0; i < p.length; i++)
            pool->step[pool->given.count++] =
                info->slope * native(voxels, info->type, at + i) +
                info->intercept;
    }
}

/* Whether the look of a step is not that of a field by more than its values
 * (snow_volume_may_be_field of the library): by its type, which the pool has
 * not, and by its format. */
static bool is_no_field(const snow_volume_info *step, bool slice) {
    static const char *const images[] = {"mrc", "tiff", "zarr"};
    bool image = false;
    for (size_t n = 0; n < sizeof images / sizeof *images; n++)
        image = image || strcmp(step->format, images[n]) == 0;
    return step->medical || *step->modality || (image && !*step->quantity) ||
           (snow_type_size(step->type) <= 2 && !(slice && *step->value_unit));
}

/* The sides of a pool with the shape of a step: a block, whose rows are pieces,
 * a slice or a row.  From 6 rows on it is no stack of few large slices, which
 * would be drawn as one.  What lacks to a side is repeated. */
static void shape_pool(const snow_volume_info *step, value_pool *pool,
                       int64_t dims[3]) {
    int axes = 0;
    for (int i = 0; i < 3; i++)
        axes += step->dims[i] > 1;
    const int64_t length = axes == 3 ? pieces_of(step, pool->quota).length : 1;
    const int64_t rows = pool->count / length, least = rows < 12 ? 2 : 6;
    int64_t side = axes == 3 ? least : axes;
    while (axes == 3 && rows % side && side < 10 * least)
        side++;
    if (axes == 3 && rows % side)
        side = least;
    side = side ? side : 1;
    for (int64_t n = 0; pool->count % (length * side); n++)
        pool->values[pool->count++] = pool->values[n];
    dims[0] = axes == 3 ? length : pool->count / side;
    dims[1] = side;
    dims[2] = pool->count / (dims[0] * side);
}

/* Makes the transfer function for a volume that consists of the pool and has
 * the shape of `step` (a block, a slice or a row), since the shape counts.
 * Missing values are NaN; memory for them is available where steps were
 * read. */
static int look_at_pool(render_state *s, const snow_volume_info *step,
                        value_pool *pool) {
    snow_volume_info info = {
        .size = sizeof info, .dims = {1, 1, 1}, .type = SNOW_TYPE_FLOAT64};
    shape_pool(step, pool, info.dims);
    if (is_no_field(step, info.dims[2] == 1))
        snprintf(info.modality, sizeof info.modality, "OT");
    info.whole = step->whole;
    info.eight_bits = step->eight_bits;
    memcpy(info.value_unit, step->value_unit, sizeof info.value_unit);
    if (step->type == SNOW_TYPE_FLOAT32 && step->slope == 1 &&
        step->intercept == 0) {
        float *values = (float *)pool->values; /* in place, from the front */
        for (int64_t i = 0; i < pool->count; i++) {
            const float value = (float)pool->values[i];
            memcpy(values + i, &value, sizeof value);
        }
        info.type = SNOW_TYPE_FLOAT32;
    }
    snow_volume *volume = NULL;
    snow_status status =
        snow_volume_wrap(s->context, &info, pool->values, &volume);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    const int n = pool->channel;
    if (s->channels.list.count)
        status =
            channels_look(NULL, s->opts, step, &s->channels.list.picks[n],
                          volume, n ? &s->channels.looks[n] : &s->transfer);
    int done = s->channels.list.count
                   ? check_status(s->context, status)
                   : open_look(s->context, s->opts, volume, &s->transfer);
    snow_volume_close(volume);
    return done;
}

/* The same for a volume that consists of the labels, one voxel each: a sample
 * would miss some.  A table of the options names them again. */
static int look_at_labels(render_state *s, const value_pool *pool) {
    static options as_labels; /* large */
    const snow_volume_options data = {
        .size = sizeof data, .label_table = data_options(s->opts).label_table};
    const size_t capacity = 128 + (size_t)pool->label_count * 320;
    char *text = malloc(capacity);
    size_t used = 0;
    int named = 0;
    if (!text)
        return steps_fail_memory();
#define PUT(...) \
    used += (size_t)snprintf(text + used, capacity - used, __VA_ARGS__)
    PUT("NRRD0004\ntype: int64\ndimension: 3\nsizes: %" PRId64
        " 1 1\nencoding: ascii\n",
        pool->label_count);
    for (int64_t n = 0; n < pool->label_count && !data.label_table; n++) {
        const snow_label *label = &pool->labels[n];
        if (!*label->name)
            continue;
        PUT("Segment%d_LabelValue:=%.0f\nSegment%d_Name:=%s\n", named,
            label->value, named, label->name);
        PUT("Segment%d_Color:=%.9g %.9g %.9g\n", named, label->color[0],
            label->color[1], label->color[2]);
        named++;
    }
    for (int64_t n = 0; n < pool->label_count; n++)
        PUT("\n%.0f", pool->labels[n].value);
#undef PUT
    snow_volume *volume = NULL;
    snow_status status = snow_volume_open_memory(s->context, "steps.nrrd", text,
                                                 used, &data, &volume);
    as_labels = *s->opts;
    as_labels.preset = "labels";
    int done = status == SNOW_STATUS_OK
                   ? open_look(s->context, &as_labels, volume, &s->transfer)
                   : fail_status(s->context, status);
    snow_volume_close(volume);
    free(text);
    return done;
}

/* Reads a share of a step, which may be the whole step. */
static int read_share(shot_renderer *shots, const movie_shot *shot, int member,
                      value_pool *pool) {
    render_state *s = &shots->state;
    snow_volume *volume = NULL;
    snow_volume_info whole = {.size = sizeof whole};
    int64_t slab[2];
    options step = options_of(s, shot, pool->channel);
    snow_volume_options data = data_options(&step);
    int done = inspect(shots, shot, pool->channel, &whole);
    if (done == CONTINUE)
        done = shots_check(shots, shot->path, &whole);
    if (done != CONTINUE)
        return done;
    const int64_t most = whole.dims[2];
    for (int end = 0; end < 2; end++)
        slab[end] = most / pool->group * (member + end) +
                    most % pool->group * (member + end) / pool->group;
    pool->given = (step_values){0, {NAN, NAN}};
    if (slab[0] == slab[1])
        return CONTINUE;
    data.crop[2][1] = data.crop[2][0] + slab[1];
    data.crop[2][0] += slab[0];
    snow_status status =
        snow_volume_open(s->context, shot->path, &data, &volume);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    pool_slab(pool, &whole, slab[0], volume);
    snow_volume_close(volume);
    return CONTINUE;
}

static int read_step(shot_renderer *shots, const movie_shot *shot,
                     value_pool *pool) {
    render_state *s = &shots->state;
    snow_volume *volume = NULL;
    options step = options_of(s, shot, pool->channel);
    snow_volume_options data = data_options(&step);
    int done = memory_check(&step, shot->path, &data);
    if (done == CONTINUE)
        done = open_input(s->context, &step, shot->path, &volume);
    if (done == CONTINUE)
        done = shots_check(shots, shot->path, snow_volume_get_info(volume));
    if (done == CONTINUE)
        pool_slab(pool, snow_volume_get_info(volume), 0, volume);
    pool->volume = volume;
    return done;
}

/* Appends what a rank has read, and finds the extremes of its step. */
static int append_share(value_pool *pool, int rank, double ends[2]) {
    double *to = pool->values + pool->count;
    step_values given = pool->given;
    snow_comm *comm = process_comm();
    snow_status status = SNOW_STATUS_OK;
    if (comm)
        status = snow_comm_broadcast(comm, &given, sizeof given, rank);
    size_t bytes = (size_t)given.count * sizeof *to;
    if (rank == process_rank())
        memcpy(to, pool->step, bytes);
    if (comm && status == SNOW_STATUS_OK)
        status = snow_comm_broadcast(comm, to, bytes, rank);
    pool->count += given.count;
    ends[0] = fmin(ends[0], given.ends[0]); /* NaN if there are none */
    ends[1] = fmax(ends[1], given.ends[1]);
    return status == SNOW_STATUS_OK
               ? CONTINUE
               : fail_status(snow_comm_context(comm), status);
}

#define SLAB ((uint64_t)1 << 20)

/* The labels of a step's own look; of a step that is shared one rank reads all,
 * slab by slab. */
static int find_labels(render_state *s, const movie_shot *shot,
                       value_pool *pool, int64_t *count) {
    const options step = render_state_step(s, shot->time);
    const snow_volume_options data = data_options(&step);
    snow_status status = SNOW_STATUS_OK;
    snow_transfer *own = NULL;
    const snow_label *label;
    if (!pool->volume)
        status = snow_volume_open_streamed(s->context, shot->path, &data, SLAB,
                                           &pool->volume);
    int done = status == SNOW_STATUS_OK
                   ? open_look(s->context, &step, pool->volume, &own)
                   : fail_status(s->context, status);
    while (done == CONTINUE && *count < LABELS_MOST &&
           (label = snow_transfer_label(own, (size_t)*count)))
        pool->labels[LABELS_MOST + (*count)++] = *label;
    snow_transfer_free(own);
    return done;
}

/* Adds what a step has; one that is no labels ends the search. */
static int append_labels(render_state *s, const movie_shot *shot, int rank,
                         value_pool *pool) {
    snow_label *found = pool->labels + LABELS_MOST;
    snow_comm *comm = process_comm();
    int64_t count = 0;
    snow_status status = SNOW_STATUS_OK;
    int done = CONTINUE;
    if (rank == process_rank())
        done = find_labels(s, shot, pool, &count);
    done = process_agree(done);
    if (comm && done == CONTINUE)
        status = snow_comm_broadcast(comm, &count, sizeof count, rank);
    if (comm && done == CONTINUE && status == SNOW_STATUS_OK)
        status = snow_comm_broadcast(comm, found, (size_t)count * sizeof *found,
                                     rank);
    pool->labelled = count > 0;
    for (int64_t n = 0; n < count; n++) {
        int64_t at = 0;
        while (at < pool->label_count &&
               pool->labels[at].value != found[n].value)
            at++;
        if (at < LABELS_MOST)
            pool->labels[at] = found[n];
        pool->label_count += at == pool->label_count && at < LABELS_MOST;
    }
    return status == SNOW_STATUS_OK
               ? done
               : fail_status(snow_comm_context(comm), status);
}

static int append_step(render_state *s, const movie_shot *shot, int group,
                       value_pool *pool) {
    double ends[2] = {NAN, NAN};
    int done = CONTINUE;
    const int64_t first = pool->count;
    for (int member = 0; member < pool->group && done == CONTINUE; member++)
        done = append_share(pool, group * pool->group + member, ends);
    if (pool->sampled && pool->count >= first + 2) {
        pool->values[first] = ends[0];
        pool->values[pool->count - 1] = ends[1];
    }
    if (done == CONTINUE && pool->labelled && ends[0] < ends[1])
        done = append_labels(s, shot, group * pool->group, pool);
    return done;
}

/* Reads steps from `first` on, one for each group of ranks. */
static int pool_round(const shot_list *list, int64_t first,
                      shot_renderer *shots, value_pool *pool) {
    const int groups = process_ranks() / pool->group;
    int mine = process_rank() / pool->group, done = CONTINUE;
    double begin = seconds_now();
    if (mine < groups && first + mine < list->count) {
        const movie_shot *shot = &list->shots[first + mine];
        done =
            pool->group == 1
                ? read_step(shots, shot, pool)
                : read_share(shots, shot, process_rank() % pool->group, pool);
    }
    shots->state.times.read += seconds_now() - begin;
    done = process_agree(done);
    for (int group = 0; group < groups && first + group < list->count; group++)
        if (done == CONTINUE)
            done = append_step(&shots->state, &list->shots[first + group],
                               group, pool);
    snow_volume_close(pool->volume);
    pool->volume = NULL;
    return done;
}

/* Chooses so many ranks per step that none is idle if there are few steps, and
 * more if a step is too large for so few. */
static int choose_group(const options *opts, const snow_volume_info *step,
                        int64_t steps) {
    const int ranks = process_ranks();
    int group = steps < ranks ? ranks / (int)steps : 1;
    snow_volume_info share = *step;
    for (; group < ranks; group++) {
        share.dims[2] = (step->dims[2] + group - 1) / group;
        if (!opts->memory || memory_needed(opts, &share).least <= opts->memory)
            break;
    }
    return group;
}

/* All ranks compare their steps with the first. */
static int pool_steps(const shot_list *list, shot_renderer *shots,
                      value_pool *pool) {
    snow_volume_info first = {.size = sizeof first};
    int done = inspect(shots, &list->shots[0], pool->channel, &first);
    if (done == CONTINUE)
        done = shots_check(shots, list->shots[0].path, &first);
    done = process_agree(done);
    if (done == CONTINUE)
        pool->group = choose_group(shots->state.opts, &first, list->count);
    pool->sampled =
        done == CONTINUE && pieces_of(&first, pool->quota).stride > 1;
    int groups = done == CONTINUE ? process_ranks() / pool->group : 1;
    for (int64_t i = 0; i < list->count && done == CONTINUE; i += groups) {
        char line[96];
        snprintf(line, sizeof line,
                 "reading values of step %" PRId64 " of %" PRId64, i + 1,
                 list->count);
        if (progress_is_live())
            progress(shots->state.opts, line);
        done = pool_round(list, i, shots, pool);
    }
    show_warnings(shots->state.opts, shots->state.context, true);
    if (done != CONTINUE)
        return done;
    bool labels = pool->labelled && pool->label_count > 0;
    return process_agree(labels ? look_at_labels(&shots->state, pool)
                                : look_at_pool(&shots->state, &first, pool));
}

static int look_at_steps(const shot_list *list, shot_renderer *shots,
                         int channel) {
    const options *opts = shots->state.opts;
    const bool labels = opts->preset && snow_preset_from_name(opts->preset) ==
                                            snow_preset_from_name("labels");
    value_pool pool = {.quota = POOL_VALUES / list->count,
                       .channel = channel,
                       .labelled = !shots->state.channels.list.count &&
                                   (opts->preset ? labels : !opts->tf)};
    if (pool.quota < STEP_VALUES)
        pool.quota = STEP_VALUES;
    const int64_t capacity = pool.quota;
    const int64_t all = capacity * (list->count + 1) + 6 * PIECE_MOST;
    pool.values = malloc((size_t)all * sizeof *pool.values);
    pool.labels = malloc(2 * LABELS_MOST * sizeof *pool.labels);
    int done = process_agree(pool.values && pool.labels ? CONTINUE
                                                        : steps_fail_memory());
    if (done == CONTINUE) {
        pool.step = pool.values + capacity * list->count;
        done = pool_steps(list, shots, &pool);
    }
    free(pool.values);
    free(pool.labels);
    return done;
}

/* Frames that are there have the look of the steps before.  Labels have colours
 * of their own, and those of later steps may be new. */
static int look_at_more(const shot_list *list, shot_renderer *shots) {
    render_state *s = &shots->state;
    if (!s->transfer || !snow_transfer_label(s->transfer, 0)) {
        if (s->opts->verbosity >= 0 && process_talks())
            say("note: the look is that of the first %" PRId64
                " step%s, as of the frames that are there; --overwrite without "
                "--resume chooses it from all",
                list->looked, list->looked == 1 ? "" : "s");
        return CONTINUE;
    }
    snow_transfer_free(s->transfer);
    s->transfer = NULL;
    int done = look_at_steps(list, shots, 0);
    if (done == CONTINUE && !snow_transfer_label(s->transfer, 0))
        done =
            fail_usage("--resume: the frames that are there show labels, and "
                       "a step that has come since has none; give another "
                       "output");
    return done;
}

int steps_look(const shot_list *list, shot_renderer *shots) {
    render_state *s = &shots->state;
    shot_list looked = *list;
    looked.count = list->looked;
    if (!looked.count)
        return CONTINUE;
    /* All steps are opened again later and cause the same notes.  They are
     * printed now, except if ranks read steps that rank 0 does not see now. */
    const bool later = process_ranks() > 1;
    show_warnings(s->opts, s->context, !later);
    snow_volume_info info = {.size = sizeof info};
    int done = inspect(shots, &list->shots[0], 0, &info), n = 0;
    if (done == CONTINUE) /* the channels that are drawn */
        done = channels_choose(s->opts, &info, channels_hinder(s->opts),
                               &s->channels);
    done = process_agree(done);
    do
        if (done == CONTINUE)
            done = look_at_steps(&looked, shots, n);
    while (++n < s->channels.list.count && done == CONTINUE);
    if (done == CONTINUE && list->looked < list->count)
        done = look_at_more(list, shots);
    show_warnings(s->opts, s->context, later);
    return done;
}
