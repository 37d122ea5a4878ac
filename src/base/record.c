/* base/record.c - records that grow at their end: snowglass/extend.h. */
#include "base/base.h"
#include "base/minmax.h"

#include <string.h>

/* A record that is so many bytes longer than ours was not initialised. */
#define GROWTH_MOST 4096

static size_t size_of(const void *record) {
    size_t size;
    memcpy(&size, record, sizeof size);
    return size;
}

static snow_status check_size(snow_context *context, const char *name,
                              size_t size, size_t known) {
    if (size >= sizeof size && size <= known + GROWTH_MOST)
        return SNOW_STATUS_OK;
    if (context)
        snow_fail(context, SNOW_STATUS_BAD_USAGE,
                  "%s: size is %zu; call %s_init first", name, size, name);
    return SNOW_STATUS_BAD_USAGE;
}

void snow_record_init(void *made, size_t size, const void *defaults,
                      size_t known) {
    memset(made, 0, size);
    if (defaults)
        memcpy(made, defaults, SNOW_MIN(size, known));
    memcpy(made, &size, sizeof size);
}

snow_status snow_record_read(snow_context *context, const char *name,
                             const void *given, void *copy, size_t known) {
    const unsigned char *bytes = given;
    if (!given)
        return SNOW_STATUS_OK;
    size_t size = size_of(given);
    SNOW_TRY(check_size(context, name, size, known));
    for (size_t n = known; n < size; n++)
        if (bytes[n]) {
            if (context)
                snow_fail(context, SNOW_STATUS_BAD_USAGE,
                          "%s: size is %zu, and a field beyond the %zu bytes "
                          "of this library's record is set; use the library "
                          "that the program was compiled for",
                          name, size, known);
            return SNOW_STATUS_BAD_USAGE;
        }
    memcpy(copy, given, SNOW_MIN(size, known));
    memcpy(copy, &known, sizeof known);
    return SNOW_STATUS_OK;
}

snow_status snow_record_fill(snow_context *context, const char *name,
                             const void *made, size_t known, void *out) {
    size_t size = size_of(out);
    SNOW_TRY(check_size(context, name, size, known));
    memcpy(out, made, SNOW_MIN(size, known));
    memcpy(out, &size, sizeof size);
    return SNOW_STATUS_OK;
}
