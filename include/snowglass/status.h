/* snowglass/status.h - what a call returns, and the rules for all calls.
 *
 * Errors. A function that can fail returns a snow_status, which is 0
 * (SNOW_STATUS_OK) where it went well. The comments list a function's own
 * errors, without SNOW_STATUS_. Besides those, each call returns BAD_USAGE for
 * an argument out of its range, NO_MEMORY where it makes something and there is
 * no room, and STOPPED where it takes long and the caller's functions
 * (context.h) ask for it. The message, one line, is in the context. Messages
 * name options as the tool does: --z-scale is the field `z_scale`.
 *
 * Results leave through out-parameters. A failure does not change pointers,
 * records and single values; arrays and buffers that the caller provides
 * (counts, pixels, texts) may hold a part of the result.
 *
 * Pointers are not NULL, unless a comment allows it. Texts that are looked up
 * or opened are an exception: a name that is NULL is unknown, and a path that
 * is NULL is BAD_USAGE. Functions that free or close accept NULL. Records of
 * options, views, settings and looks that are only read may be NULL, for their
 * defaults.
 *
 * Ownership. What a call makes in `out` is the caller's, who frees it. A
 * pointer that a function returns belongs to the object that it was asked of,
 * and lives as long as that. Options, views, settings and looks are read during
 * the call and not kept, nor are their texts and arrays. A volume, transfer
 * function or view may go before the frame that has drawn it.
 *
 * The tool exits with the values of snow_status. */
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

/* X(NAME, value, text) of each status. */
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

/* Returns a line that describes a status; never NULL. */
SNOW_API const char *snow_status_description(snow_status status);

#endif
