/* kept.c - implements kept.h. */
#include "draw/kept.h"
#include "commands/commands.h"
#include "draw/mixed.h"
#include "run/start.h"

#include <stdlib.h>
#include <string.h>

static const char *const base_keys[] = {
    "crop", "channel", "component", "labels", "time", "z-scale", "mask", NULL};

char *kept_key_of(const json_t *recipe, const char *const *names) {
    json_t *some = json_object();
    for (; *names; names++)
        if (json_object_get(recipe, *names))
            json_object_set(some, *names, json_object_get(recipe, *names));
    char *text = json_dumps(some, JSON_COMPACT | JSON_SORT_KEYS);
    json_decref(some);
    return text;
}

bool kept_take_key(char **key, char *now) {
    bool other = !*key || !now || strcmp(*key, now) != 0;
    free(*key);
    *key = now;
    return other;
}

static size_t count_clips(const snow_volume_options *data) {
    size_t count = 0;
    while (count < SNOW_CLIPS_MAX &&
           (data->clip[count][0] != 0 || data->clip[count][1] != 0 ||
            data->clip[count][2] != 0))
        count++;
    return count;
}

void kept_close(drawing *d) {
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++) {
        snow_volume_close(d->base[n]);
        d->base[n] = NULL;
    }
}

static snow_status open_base(drawing *d, int n) {
    const channel_list *list = &d->state.channels.list;
    snow_volume_options data = list->count
                                   ? channels_data(&d->opts, &list->picks[n])
                                   : data_options(&d->opts);
    memset(data.clip, 0, sizeof data.clip);
    return snow_volume_open(d->state.context, d->opts.operands[0], &data,
                            &d->base[n]);
}

/* The volumes without clip planes: those that were shown before there were any,
 * or opened once; false where they stay in their file, or do not fit. */
static bool find_bases(drawing *d) {
    snow_status status = SNOW_STATUS_OK;
    if (d->base[0] || d->state.plan.streams)
        return d->base[0];
    if (d->plain_key && d->base_key && !strcmp(d->plain_key, d->base_key)) {
        for (int n = 0; n < mixed_count(d); n++) {
            d->base[n] = *mixed_volume(d, n);
            *mixed_volume(d, n) = NULL;
        }
        kept_take_key(&d->plain_key, NULL);
        return true;
    }
    for (int n = 0; n < mixed_count(d) && status == SNOW_STATUS_OK; n++)
        status = open_base(d, n);
    if (status != SNOW_STATUS_OK)
        kept_close(d);
    return status == SNOW_STATUS_OK;
}

bool kept_clip(drawing *d) {
    render_state *s = &d->state;
    snow_volume_options data = data_options(&d->opts);
    size_t count = count_clips(&data);
    snow_volume *made[SNOW_CHANNELS_MAX] = {NULL};
    bool all = true;
    if (process_ranks() > 1 || !s->volume || !count || data.mask ||
        !find_bases(d))
        return false;
    for (int n = 0; n < mixed_count(d); n++)
        all = all && snow_volume_clip(d->base[n], d->opts.clip[0], count,
                                      &made[n]) == SNOW_STATUS_OK;
    for (int n = 0; n < mixed_count(d); n++) {
        snow_volume **shown = mixed_volume(d, n);
        snow_volume_close(all ? *shown : made[n]);
        *shown = all ? made[n] : *shown;
    }
    if (all)
        s->whole = *snow_volume_get_info(s->volume);
    return all;
}

bool drawing_is_clipped(const drawing *d) {
    snow_volume_options data = data_options(&d->opts);
    return count_clips(&data) > 0;
}

snow_volume *drawing_unclipped(drawing *d, int n) {
    return drawing_is_clipped(d) && find_bases(d) ? d->base[n]
                                                  : *mixed_volume(d, n);
}

void kept_drop(drawing *d, char *key) {
    if (kept_take_key(&d->base_key, key))
        kept_close(d);
}

char *kept_base_key(const drawing *d, const json_t *recipe) {
    json_t *tree = json_copy((json_t *)recipe);
    json_object_set_new(tree, "channel", mixed_tree(d));
    char *key = kept_key_of(tree, base_keys);
    json_decref(tree);
    return key;
}
