/* times.c - implements times.h. */
#include "movies/times.h"
#include "commands/commands.h"
#include "draw/values.h"
#include "run/log.h"

#include <string.h>

#define PIECE_SECONDS 0.01

/* False where a step has no time, or cannot be read. */
static bool add_step(drawing *d, int64_t step) {
    char text[128];
    snow_volume_info info;
    snow_volume_options data = data_options(&d->opts);
    snow_volume_info_init(&info);
    data.time = step;
    data.each_time = true;
    data.mask = data.labels = NULL;
    memset(data.crop, 0, sizeof data.crop);
    memset(data.clip, 0, sizeof data.clip);
    if (snow_volume_inspect(d->state.context, d->opts.operands[0], &data,
                            &info) != SNOW_STATUS_OK ||
        !snow_time_text(&info, NULL, text, sizeof text))
        return false;
    json_t *made = json_string(text);
    return made && json_array_append_new(d->times, made) == 0;
}

int times_read(drawing *d, json_t **out) {
    const double begin = seconds_now();
    int64_t count = d->state.whole.times;
    if (!d->times)
        d->times = json_array();
    *out = d->times;
    if (d->times_are_known)
        return CONTINUE;
    if (count < 2 || count > TIMES_MOST)
        count = 0;
    show_warnings(&d->opts, d->state.context, false);
    int64_t next = (int64_t)json_array_size(d->times);
    while (next < count && seconds_now() - begin < PIECE_SECONDS) {
        const bool good = add_step(d, next);
        if (!good)
            json_array_clear(d->times);
        next = good ? next + 1 : count;
    }
    show_warnings(&d->opts, d->state.context, true);
    d->times_are_known = next >= count;
    return d->times_are_known ? CONTINUE : VALUES_MORE;
}
