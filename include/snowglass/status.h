/* snowglass/status.h - what a call answers, and what holds for all calls.
 *
 * Results leave through out-parameters, which a failure does not change. New
 * objects belong to the caller, returned pointers to their object. Functions
 * that free or close accept NULL. Comments name errors without SNOW_STATUS_.
 * Besides those, an argument out of range is BAD_USAGE, and any call that makes
 * something can return NO_MEMORY. The tool exits with these values. */
#ifndef SNOWGLASS_STATUS_H
#define SNOWGLASS_STATUS_H

#ifdef __cplusplus
#define SNOW_LINKAGE extern "C"
#else
#define SNOW_LINKAGE
#endif
#if defined(__GNUC__)
#define SNOW_API SNOW_LINKAGE __attribute__((visibility("default")))
#define SNOW_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define SNOW_API SNOW_LINKAGE
#define SNOW_PRINTF(text, first)
#endif

/* One list makes the enum, the names and the texts (never NULL). */
#define SNOW_STATUS_MAP(X)                                               \
    X(OK, 0, "done")                                                     \
    X(FAILED, 1, "rendering failed")                                     \
    X(BAD_USAGE, 2, "an argument is out of its range")                   \
    X(BAD_INPUT, 3, "the input is missing, unreadable or unsupported")   \
    X(BAD_OUTPUT, 4, "the output cannot be written")                     \
    X(NO_MEMORY, 5, "more memory is needed than is allowed or there is") \
    X(DIFFERENT, 6, "the comparison found a difference")                 \
    X(STOPPED, 130, "stopped, as the caller asked")

typedef enum snow_status {
#define SNOW_STATUS_ENUM(name, value, text) SNOW_STATUS_##name = value,
    SNOW_STATUS_MAP(SNOW_STATUS_ENUM)
#undef SNOW_STATUS_ENUM
} snow_status;

SNOW_API const char *snow_status_description(snow_status status);

#endif
