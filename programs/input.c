/* input.c - from the data and look options to a volume and its transfer
 * function. */
#include "commands.h"
#include "report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* First room for standard input; it doubles from there. */
#define STREAM_BYTES ((size_t)1 << 20)

/* What was not told stays 0: the library refuses what does not fit a format,
 * and must see the difference between told and default. */
static snow_volume_options data_options(const options *asked) {
    snow_volume_options data = {
        .type = asked->type, .offset = asked->offset, .time = asked->time};
    for (int i = 0; i < 3; i++) {
        data.dims[i] = asked->dims[i];
        data.spacing[i] = asked->spacing[i];
    }
    if (asked->endian)
        data.endian = strcmp(asked->endian, "big") == 0 ? SNOW_ENDIAN_BIG
                                                        : SNOW_ENDIAN_LITTLE;
    return data;
}

int read_standard_input(char **out, size_t *size) {
    size_t room = STREAM_BYTES, used = 0;
    char *bytes = malloc(room);
    errno = 0;
    while (bytes) {
        used += fread(bytes + used, 1, room - used, stdin);
        if (used < room)
            break;
        char *grown = room <= SIZE_MAX / 2 ? realloc(bytes, room * 2) : NULL;
        if (!grown)
            free(bytes);
        bytes = grown;
        room *= 2;
    }
    if (bytes && !ferror(stdin)) {
        *out = bytes;
        *size = used;
        return GO_ON;
    }
    say("standard input: %s; give a file",
        bytes && errno ? strerror(errno) : "too large for the memory");
    int code = bytes ? SNOW_BAD_INPUT : SNOW_NO_MEMORY;
    free(bytes);
    return code;
}

/* The library reads bytes in memory, so a stream is gathered first; it cannot
 * be detached data, which lies beside its header. */
static int open_stream(snow_context *context, const snow_volume_options *data,
                       snow_volume **out) {
    char *bytes;
    size_t size;
    int done = read_standard_input(&bytes, &size);
    if (done != GO_ON)
        return done;
    snow_status status = snow_volume_open_memory(context, "standard input",
                                                 bytes, size, data, out);
    free(bytes);
    return status == SNOW_OK ? GO_ON : fail_status(context, status);
}

int open_input(snow_context *context, const options *asked, const char *path,
               snow_volume **out) {
    snow_volume_options data = data_options(asked);
    if (strcmp(path, "-") == 0)
        return open_stream(context, &data, out);
    snow_status status = snow_volume_open(context, path, &data, out);
    return status == SNOW_OK ? GO_ON : fail_status(context, status);
}

int check_look(const options *asked) {
    bool window = !isnan(asked->window), level = !isnan(asked->level);
    if (window != level)
        return fail_usage("--%s: needs --%s beside it",
                          window ? "window" : "level",
                          window ? "level" : "window");
    if (window && asked->range.kind != SNOW_RANGE_AUTO)
        return fail_usage("--window: does not go with --range; give one of "
                          "them");
    return GO_ON;
}

int open_look(snow_context *context, const options *asked,
              const snow_volume *volume, snow_transfer **out) {
    snow_look look = {.preset = asked->preset,
                      .colormap = asked->colormap,
                      .range = asked->range.kind,
                      .low = asked->range.low,
                      .high = asked->range.high};
    if (!isnan(asked->window)) { /* another way to write a range */
        look.range = SNOW_RANGE_VALUES;
        look.low = asked->level - asked->window / 2;
        look.high = asked->level + asked->window / 2;
    }
    if (asked->opacities.count) {
        look.opacities = asked->opacities.points;
        look.opacity_count = asked->opacities.count;
    }
    snow_status status = snow_transfer_make(volume, &look, out);
    return status == SNOW_OK ? GO_ON : fail_status(context, status);
}

void describe_volume(const snow_volume *volume, char *out, size_t size) {
    const snow_volume_info *info = snow_volume_describe(volume);
    snprintf(out, size, "%s %lldx%lldx%lld %s, spacing %gx%gx%g%s%s",
             info->format, (long long)info->dims[0], (long long)info->dims[1],
             (long long)info->dims[2], snow_type_name(info->type),
             info->spacing[0], info->spacing[1], info->spacing[2],
             info->unit[0] ? " " : "", info->unit);
}
