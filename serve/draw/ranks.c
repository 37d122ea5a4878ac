/* ranks.c - implements ranks.h by broadcasts of the calls and what they are
 * given, as JSON.
 *
 * Between calls the first rank waits for its pages, perhaps for hours, and the
 * others wait for it without a limit. */
#include "draw/ranks.h"
#include "draw/pick.h"
#include "draw/small.h"
#include "draw/values.h"

#include "run/log.h"

#include <snowglass/comm.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct call_head {
    int32_t call;
    uint32_t length; /* of the text that follows */
} call_head;

/* A rank that cannot take part ends the job, by its launcher: the others would
 * wait for it in the call. */
static void give_up(void) {
    fprintf(stderr,
            "snowglass: rank %d: out of memory for what is to be shown;"
            " close other programs\n",
            process_rank());
    abort();
}

/* A fault shows in the call that follows. */
void ranks_broadcast(ranks_call call, json_t *arguments, double timeout) {
    snow_comm *comm = process_comm();
    char *text = arguments ? json_dumps(arguments, JSON_COMPACT) : NULL;
    if (arguments && !text)
        give_up();
    call_head head = {(int32_t)call, text ? (uint32_t)strlen(text) : 0};
    snow_comm_set_timeout(comm, timeout);
    if (snow_comm_broadcast(comm, &head, sizeof head, 0) == SNOW_STATUS_OK &&
        head.length)
        (void)snow_comm_broadcast(comm, text, head.length, 0);
    free(text);
    json_decref(arguments);
}

/* What the call was given. */
static json_t *receive_arguments(uint32_t length, snow_status *status) {
    char *text = length ? malloc(length) : NULL;
    json_t *tree = NULL;
    if (!length)
        return NULL;
    if (!text)
        give_up();
    *status = snow_comm_broadcast(process_comm(), text, length, 0);
    if (*status == SNOW_STATUS_OK &&
        !(tree = json_loadb(text, length, JSON_DECODE_ANY, NULL)))
        give_up();
    free(text);
    return tree;
}

static double number(const json_t *arguments, size_t i) {
    return json_number_value(json_array_get(arguments, i));
}

static void make_call(drawing *d, ranks_call call, const json_t *given) {
    snow_image *image = NULL;
    snow_overlay *overlay = NULL;
    thumbnail of;
    double ends[2], depth;
    uint64_t counts[VALUES_BINS];
    switch (call) {
    case RANKS_APPLY:
        (void)drawing_apply(d, given);
        break;
    case RANKS_FIT:
        json_decref(drawing_fit(d));
        break;
    case RANKS_RENDER:
        (void)drawing_render(d, (snow_quality)number(given, 0),
                             (int)number(given, 1), NULL, NULL, &image,
                             &overlay);
        break;
    case RANKS_THUMBNAIL:
        of = (thumbnail){json_string_value(json_array_get(given, 0)),
                         json_string_value(json_array_get(given, 1)),
                         json_is_true(json_array_get(given, 2)),
                         {0}};
        (void)small_thumbnail(d, &of, (int)number(given, 3), NULL, NULL,
                              &image);
        break;
    case RANKS_DEPTH:
        ends[0] = number(given, 2);
        ends[1] = number(given, 3);
        (void)pick_depth(d, number(given, 0), number(given, 1), ends, &depth);
        break;
    case RANKS_ENDS:
        values_ends(d, ends);
        break;
    case RANKS_WINDOW:
        values_window(d, ends);
        break;
    case RANKS_HISTOGRAM:
        (void)values_count(d, number(given, 0), number(given, 1), counts);
        break;
    case RANKS_END:
        break;
    }
    snow_overlay_free(overlay);
    snow_image_free(image);
}

int ranks_follow(drawing *d) {
    snow_comm *comm = process_comm();
    call_head head = {.call = RANKS_APPLY};
    snow_status status = SNOW_STATUS_OK;
    while (status == SNOW_STATUS_OK && head.call != RANKS_END &&
           !process_broken()) {
        snow_comm_set_timeout(comm, 0);
        status = snow_comm_broadcast(comm, &head, sizeof head, 0);
        snow_comm_set_timeout(comm, d->first.timeout);
        json_t *given = status == SNOW_STATUS_OK
                            ? receive_arguments(head.length, &status)
                            : NULL;
        if (status == SNOW_STATUS_OK)
            make_call(d, (ranks_call)head.call, given);
        json_decref(given);
    }
    return check_status(snow_comm_context(comm), status);
}
