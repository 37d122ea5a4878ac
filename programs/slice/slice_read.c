/* slice_read.c - reads slices, what lies over them, and their look. */
#include "commands/commands.h"
#include "picture/annotations.h"
#include "run/log.h"
#include "run/memory.h"
#include "slice/slice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool slice_has_colors(const slice_work *w) {
    const int bits = snow_image_format_bits(w->opts.output);
    return bits > 0 || (bits < 0 && w->kind == SLICE_FRAMES) ||
           strcmp(w->opts.output, "-") == 0;
}

/* With the slices around it that a slab has. */
static void crop_to_slice(slice_work *w) {
    int64_t *crop = w->opts.crop[w->axis];
    const slab_slices slices =
        slab_around(&w->slabs[w->axis], &w->whole, w->axis, w->places[0].index);
    w->first = slices.first;
    crop[0] += slices.first;
    crop[1] = crop[0] + slices.count;
}

/* The slice in the place of the whole, as a crop would have read it. */
static int cut_slice(slice_work *w) {
    snow_volume_info info = w->whole;
    snow_volume *slice = NULL;
    const int64_t *dims = w->whole.dims, index = w->places[0].index;
    const size_t size = snow_type_size(info.type);
    const size_t steps[3] = {size, size * (size_t)dims[0],
                             size * (size_t)(dims[0] * dims[1])};
    const int u = w->axis == 0, v = w->axis == 2 ? 1 : 2;
    info.dims[w->axis] = 1;
    for (int row = 0; row < 3; row++)
        info.matrix[row][3] += info.matrix[row][w->axis] * (double)index;
    w->cut = malloc(size * (size_t)(dims[u] * dims[v]));
    if (!w->cut)
        return fail_memory("out of memory for the slice; close other programs");
    char *out = w->cut;
    const char *from = snow_volume_voxels(w->volume);
    from += (size_t)index * steps[w->axis];
    for (int64_t b = 0; b < dims[v]; b++)
        for (int64_t a = 0; a < dims[u]; a++, out += size)
            memcpy(out, from + (size_t)a * steps[u] + (size_t)b * steps[v],
                   size);
    snow_status status = snow_volume_wrap(w->context, &info, w->cut, &slice);
    if (status != SNOW_STATUS_OK)
        return fail_status(w->context, status);
    snow_volume_close(w->volume);
    w->volume = slice;
    if (!options_given(&w->opts, "crop"))
        w->layers.whole = &w->whole;
    crop_to_slice(w);
    return CONTINUE;
}

/* Standard input can be read only once, so all of it is. */
static int inspect_whole(slice_work *w) {
    if (strcmp(w->path, "-") == 0) {
        w->opts.mixes = true;
        int done = open_input(w->context, &w->opts, w->path, &w->volume);
        if (done == CONTINUE)
            w->whole = *snow_volume_get_info(w->volume);
        return done;
    }
    snow_volume_options data = data_options(&w->opts);
    snow_volume_info_init(&w->whole);
    show_warnings(&w->opts, w->context, false); /* they come again */
    int done = check_status(
        w->context, snow_volume_inspect(w->context, w->path, &data, &w->whole));
    show_warnings(&w->opts, w->context, true);
    return done;
}

int slice_inspect(slice_work *w) {
    int done = inspect_whole(w);
    for (int k = 0; k < 3 && done == CONTINUE; k++)
        done = slab_read(w->opts.thickness, &w->whole, k, &w->slabs[k]);
    if (done == CONTINUE)
        done = slice_find(w);
    snow_volume_info held = w->whole; /* in memory */
    if (w->kind == SLICE_ONE && done == CONTINUE)
        held.dims[w->axis] =
            slab_around(&w->slabs[w->axis], &held, w->axis, w->places[0].index)
                .count;
    if (done == CONTINUE)
        done = channels_choose(&w->opts, &held,
                               slice_has_colors(w) || w->opts.show
                                   ? channels_hinder(&w->opts)
                                   : "a file of numbers has one",
                               &w->channels);
    return done;
}

/* Those of the first channel. */
static snow_volume_options data_of(const slice_work *w) {
    return w->channels.list.count
               ? channels_data(&w->opts, &w->channels.list.picks[0])
               : data_options(&w->opts);
}

static int open_alone(slice_work *w, const snow_volume_options *data) {
    return check_status(
        w->context, snow_volume_open(w->context, w->path, data, &w->volume));
}

/* In memory, or where that has no room, in the file. */
static int open_several(slice_work *w) {
    const snow_volume_options data = data_of(w);
    memory_plan plan;
    int done = memory_plan_for(&w->opts, w->path, &data, w->channels.list.count,
                               false, &plan);
    if (done != CONTINUE || !plan.streams)
        return done == CONTINUE ? open_alone(w, &data) : done;
    w->in_file = true;
    if (w->opts.verbosity >= 0 && w->kind == SLICE_GRID && !w->opts.at)
        say("note: %s stays in its file, since it is larger than the memory: "
            "the slices are spread over all; --at A:B chooses",
            w->path);
    return check_volume(w->context,
                        snow_volume_open_streamed(w->context, w->path, &data,
                                                  plan.slab_bytes, &w->volume),
                        name_of_input(w->path));
}

static int read_volume(slice_work *w) {
    if (w->volume)
        return w->kind == SLICE_ONE && !w->slabs[w->axis].half ? cut_slice(w)
                                                               : CONTINUE;
    if (w->kind == SLICE_ONE)
        crop_to_slice(w);
    w->opts.mixes = true;
    const snow_volume_options data = data_of(w);
    return w->kind == SLICE_ONE ? open_alone(w, &data) : open_several(w);
}

int slice_read_alone(const slice_work *w, int64_t part, slice_work *out) {
    const snow_slice_place *place = &w->places[part];
    *out = *w;
    out->kind = SLICE_ONE;
    out->places = &w->places[part];
    out->count = 1;
    out->axis = place->axis;
    out->opts.size[0] = place->view.width;
    out->opts.size[1] = place->view.height;
    out->opts.verbosity = -1; /* it was said before */
    out->volume = NULL;
    out->layers = (layers){.whole = &w->whole};
    memset(out->channels.volumes, 0, sizeof out->channels.volumes);
    int done = read_volume(out);
    if (done == CONTINUE && w->transfer)
        done = check_volume(w->context,
                            channels_open(&out->opts, w->context, w->path,
                                          false, 0, &out->channels),
                            name_of_input(w->path));
    if (done == CONTINUE)
        done = layers_open(&out->opts, w->context, out->volume, &out->layers);
    return done;
}

void slice_close_alone(slice_work *w) {
    layers_close(&w->layers);
    channels_close_volumes(&w->channels);
    snow_volume_close(w->volume);
}

/* All directions are as bright where vectors are as long: up to the end of the
 * automatic range of lengths. */
static snow_status fit_lengths(slice_work *w) {
    channel_list *list = &w->channels.list;
    snow_volume_options data = data_options(&w->opts);
    const snow_look look = {.size = sizeof look,
                            .preset = "linear",
                            .range = automatic_range(&w->opts)};
    snow_volume *lengths = NULL;
    snow_transfer *seen = NULL;
    range_value range = {SNOW_RANGE_VALUES, 0, 0};
    if (options_range(&w->opts).kind != SNOW_RANGE_AUTO)
        return SNOW_STATUS_OK;
    data.channel = 0;
    data.component = "magnitude";
    snow_status status =
        w->in_file
            ? snow_volume_open_streamed(w->context, w->path, &data, 0, &lengths)
            : snow_volume_open(w->context, w->path, &data, &lengths);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(lengths, &look, &seen);
    if (status == SNOW_STATUS_OK)
        snow_transfer_domain(seen, &range.low, &range.high);
    range.low = 0;
    range.high = range.high > 0 ? range.high : 1;
    for (int n = 0; n < list->count; n++)
        if (list->picks[n].range.kind == SNOW_RANGE_AUTO)
            list->picks[n].range = range;
    snow_transfer_free(seen);
    snow_volume_close(lengths);
    return status;
}

/* Labels are drawn as such where nothing else is asked, as in a picture. */
int slice_open_colors(slice_work *w) {
    static options automatic; /* large */
    const options *opts = &w->opts;
    automatic = *opts;
    automatic.mode = "over";
    bool asked = opts->preset || opts->tf || opts->colormap ||
                 opts->scale.log || opts->scale.symlog != 0 ||
                 options_range(opts).kind != SNOW_RANGE_AUTO;
    int done = CONTINUE;
    if (w->channels.list.count) {
        snow_status status = w->channels.list.picks[0].absolute
                                 ? fit_lengths(w)
                                 : SNOW_STATUS_OK;
        if (status == SNOW_STATUS_OK)
            status =
                channels_look(NULL, opts, &w->whole, &w->channels.list.picks[0],
                              w->volume, &w->transfer);
        channels_close_volumes(&w->channels);
        if (status == SNOW_STATUS_OK)
            status = channels_open(opts, w->context, w->path, false, 0,
                                   &w->channels);
        return check_volume(w->context, status, name_of_input(w->path));
    }
    if (!asked)
        done = open_look(w->context, &automatic, w->volume, &w->transfer);
    if (done != CONTINUE ||
        (w->transfer && snow_transfer_label(w->transfer, 0)))
        return done;
    snow_transfer_free(w->transfer);
    w->transfer = NULL;
    return open_look(w->context, opts, w->volume, &w->transfer);
}

void slice_describe_slab(const slice_work *w, char *out, size_t size) {
    int64_t most = 0;
    *out = 0;
    for (int64_t n = 0; n < w->count; n++) {
        const snow_slice_place *place = &w->places[n];
        const slab *s = &w->slabs[place->axis];
        const slab_slices slices =
            slab_around(s, &w->whole, place->axis, place->index);
        if (!s->half || slices.count <= most)
            continue;
        most = slices.count;
        snprintf(out, size, "; ");
        slab_describe(s, most, out + 2, size - 2);
    }
}

void slice_describe_colors(const slice_work *w, char *out, size_t size) {
    if (w->transfer && w->channels.list.count) {
        channels_describe(&w->channels, out, size);
        return;
    }
    const char *text =
        w->transfer ? snow_transfer_description(w->transfer) : "data values";
    const char *opacity = strstr(text, "; opacity"), *reason = NULL;
    for (const char *at = opacity; at && (at = strstr(at, " ("));)
        reason = at++;
    snprintf(out, size, "%.*s%s",
             opacity ? (int)(opacity - text) : (int)strlen(text), text,
             reason ? reason : "");
}

int slice_measure(slice_work *w) {
    options own = w->opts;
    snow_volume_info whole = w->whole;
    if (w->kind == SLICE_ONE && own.measure) { /* a crop, counted in all */
        int64_t *crop = own.crop[w->axis];
        crop[0] -= w->first;
        crop[1] = crop[0] + w->whole.dims[w->axis];
    }
    annotations_find_unit(&own, w->volume, false, &whole);
    return measures_find(&own, w->context, w->path, &whole, w->volume, false,
                         &w->measures);
}

int slice_read(slice_work *w) {
    const double begin = w->begin;
    progress_begin(&w->opts, "reading");
    int done = read_volume(w);
    progress_end(&w->opts);
    w->times.read = seconds_now() - begin;
    if (done == CONTINUE && slice_has_colors(w))
        done = slice_open_colors(w);
    if (done == CONTINUE)
        done = slab_check(&w->slabs[w->axis], w->transfer);
    if (done == CONTINUE)
        done = slice_spread(w);
    if (done == CONTINUE)
        done = layers_open(&w->opts, w->context, w->volume, &w->layers);
    if (done == CONTINUE && w->transfer)
        done = slice_leave_strip(w);
    w->times.look = seconds_now() - begin - w->times.read;
    return done;
}
