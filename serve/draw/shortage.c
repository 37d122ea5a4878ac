/* shortage.c - implements shortage.h. */
#include "draw/shortage.h"
#include "run/log.h"

#include <stdio.h>

json_t *shortage_need(const json_t *recipe, int level) {
    static const char *const turns[] = {"azimuth", "elevation", "roll"};
    json_t *need = json_copy((json_t *)recipe);
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++)
        json_object_del(need, turns[i]);
    json_object_set_new(need, "quality", json_integer(level));
    return need;
}

void shortage_say(const options *opts, int level) {
    char limit[80] = "memory that there is";
    if (opts->memory > 0)
        snprintf(limit, sizeof limit, "--memory of %.1f MiB",
                 (double)opts->memory / (1 << 20));
    say("there is no room for %s of %lld x %lld pixels in the %s: make the "
        "window smaller, crop the volume, or begin with more memory",
        level == 2 ? "the final picture" : "a picture",
        (long long)opts->size[0], (long long)opts->size[1], limit);
}
