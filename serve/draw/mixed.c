/* mixed.c - implements mixed.h.
 *
 * A channel that is switched off stays in memory, unless that is limited, so
 * that it comes back at once.  Its file is read again for one that never was
 * there. */
#include "draw/mixed.h"
#include "run/log.h"
#include "run/start.h"

#include <stdio.h>
#include <string.h>

int mixed_count(const drawing *d) {
    const int count = d->state.channels.list.count;
    return count ? count : 1;
}

/* The first one of the file where those meant gave way to a limit of memory. */
int64_t mixed_first(const drawing *d) {
    return d->state.channels.list.count ? d->shown.index[0] : d->opts.channel;
}

snow_volume **mixed_volume(drawing *d, int n) {
    return n ? &d->state.channels.volumes[n] : &d->state.volume;
}

/* What was said when the volume was opened is not said again. */
static int choose(const drawing *d, channel_list *list) {
    static options quiet; /* large; one thread draws */
    channel_set set = {.ground = d->state.channels.ground};
    quiet = d->opts;
    quiet.verbosity = -1;
    int done =
        channels_choose(&quiet, &d->state.whole, channels_hinder(&quiet), &set);
    *list = set.list;
    return done;
}

static shown_channels numbers_of(const drawing *d, const channel_list *list) {
    shown_channels now = {.count = list->count ? list->count : 1};
    now.index[0] = d->opts.channel;
    for (int n = 0; n < list->count; n++)
        now.index[n] = list->picks[n].index;
    return now;
}

/* --- which are open ------------------------------------------------------- */

/* What is drawn, and what was put away before. */
typedef struct open_channels {
    kept_channel all[2 * SNOW_CHANNELS_MAX];
    int count;
} open_channels;

static open_channels take_open(drawing *d) {
    open_channels o = {.count = 0};
    for (int n = 0; n < d->shown.count; n++) {
        o.all[o.count++] =
            (kept_channel){*mixed_volume(d, n), d->shown.index[n]};
        *mixed_volume(d, n) = NULL;
    }
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++) {
        if (d->away[n].volume)
            o.all[o.count++] = d->away[n];
        d->away[n].volume = NULL;
    }
    return o;
}

static snow_volume *take_one(open_channels *o, int64_t index) {
    for (int i = 0; i < o->count; i++)
        if (o->all[i].volume && o->all[i].index == index) {
            snow_volume *found = o->all[i].volume;
            o->all[i].volume = NULL;
            return found;
        }
    return NULL;
}

/* A limit of memory is for what is drawn. */
static void put_away(drawing *d, open_channels *o) {
    int kept = 0;
    for (int i = 0; i < o->count; i++)
        if (!o->all[i].volume)
            continue;
        else if (d->first.memory || d->state.plan.streams ||
                 kept == SNOW_CHANNELS_MAX)
            snow_volume_close(o->all[i].volume);
        else
            d->away[kept++] = o->all[i];
}

/* Whether all are there; then they are what is drawn, without a look. */
static bool rearrange(drawing *d, const channel_list *list,
                      const shown_channels *now) {
    render_state *s = &d->state;
    snow_volume *found[SNOW_CHANNELS_MAX];
    bool all = true;
    if (process_ranks() > 1 || mixed_count(d) != d->shown.count)
        return false; /* some gave way to a limit of memory */
    open_channels o = take_open(d);
    for (int n = 0; n < now->count; n++)
        all = (found[n] = take_one(&o, now->index[n])) && all;
    put_away(d, &o);
    channels_close(&s->channels);
    s->channels.list = *list;
    for (int n = 0; n < now->count; n++)
        *mixed_volume(d, n) = found[n];
    snow_transfer_free(s->transfer);
    s->transfer = NULL;
    if (all)
        s->whole = *snow_volume_get_info(s->volume);
    return all;
}

int mixed_follow(drawing *d, bool *anew, bool *other) {
    channel_list list;
    *anew = *other = false;
    if (!d->state.volume)
        return CONTINUE;
    int done = choose(d, &list);
    if (done != CONTINUE)
        return done;
    const shown_channels now = numbers_of(d, &list);
    const bool same = now.count == d->shown.count &&
                      memcmp(now.index, d->shown.index,
                             sizeof *now.index * (size_t)now.count) == 0;
    *other = !same;
    *anew = *other && !rearrange(d, &list, &now);
    d->shown = now;
    return CONTINUE;
}

int mixed_note(drawing *d) {
    channel_list list;
    mixed_forget(d);
    int done = choose(d, &list);
    d->shown = numbers_of(d, &list);
    return done;
}

void mixed_forget(drawing *d) {
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++) {
        snow_volume_close(d->away[n].volume);
        d->away[n].volume = NULL;
    }
}

/* --- looks ---------------------------------------------------------------- */

static snow_status make_look(drawing *d, channel_list *list, int n) {
    render_state *s = &d->state;
    snow_volume *volume = *mixed_volume(d, n);
    snow_transfer **look = n ? &s->channels.looks[n] : &s->transfer;
    snow_transfer *made = NULL;
    snow_status status = channels_look(
        NULL, &d->opts, n ? snow_volume_get_info(volume) : &s->whole,
        &list->picks[n], volume, &made);
    if (status != SNOW_STATUS_OK)
        return status;
    snow_transfer_free(*look);
    *look = made;
    return SNOW_STATUS_OK;
}

int mixed_restyle(drawing *d) {
    channel_list list;
    snow_status status = SNOW_STATUS_OK;
    int done = choose(d, &list);
    for (int n = 0; n < list.count && done == CONTINUE; n++) {
        status = make_look(d, &list, n);
        if (status != SNOW_STATUS_OK)
            done = fail_status(d->state.context, status);
    }
    d->state.channels.list = list;
    d->look_is_new = true;
    d->look_is_quick = false;
    return done;
}

/* --- texts ---------------------------------------------------------------- */

json_t *mixed_tree(const drawing *d) {
    json_t *list = json_array();
    for (int n = 0; n < d->shown.count; n++)
        json_array_append_new(list, json_integer(d->shown.index[n]));
    return list;
}

bool mixed_text(const drawing *d, char *out, size_t size) {
    const channel_set *c = &d->state.channels;
    channel_list list = c->list;
    for (int n = 0; n < list.count; n++) {
        range_value *range = &list.picks[n].range;
        if (range->kind != SNOW_RANGE_PERCENTILES)
            continue;
        snow_transfer_domain(n ? c->looks[n] : d->state.transfer, &range->low,
                             &range->high);
        range->kind =
            range->low < range->high ? SNOW_RANGE_VALUES : SNOW_RANGE_AUTO;
    }
    channels_text(&list, out, size);
    return list.count > 0;
}

void mixed_settle(const drawing *d, options *opts) {
    static char number[24]; /* one thread draws */
    if (mixed_count(d) == d->shown.count)
        return;
    snprintf(number, sizeof number, "%lld", (long long)mixed_first(d));
    opts->component = number; /* which a recipe has of 0 too */
}
