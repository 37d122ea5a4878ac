/* io/lookup.c - see lookup.h. */
#include "io/lookup.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

void snow_lookup_begin(snow_context *context) {
    *context->lost = 0;
}

snow_status snow_lookup_end(snow_context *context, snow_status status) {
    if (!*context->lost || status == SNOW_STATUS_NO_MEMORY ||
        status == SNOW_STATUS_STOPPED ||
        (status != SNOW_STATUS_OK && strstr(context->message, context->lost)))
        return status;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT, "%s", context->lost);
}

snow_status snow_lookup_keep(snow_context *context, snow_status status) {
    pthread_mutex_lock(&context->lock);
    if (status == SNOW_STATUS_BAD_INPUT && !*context->lost)
        snprintf(context->lost, sizeof context->lost, "%.*s",
                 (int)sizeof context->lost - 1, context->message);
    pthread_mutex_unlock(&context->lock);
    return status;
}

bool snow_is_dangling(const char *path) {
    struct stat about;
    return stat(path, &about) && errno == ENOENT && lstat(path, &about) == 0;
}

snow_status snow_lookup_fail(snow_context *context, const char *path,
                             const char *done) {
    const int number = errno;
    char why[1024];
    snow_explain(number, why, sizeof why);
    return snow_lookup_keep(
        context,
        number == ENOENT && snow_is_dangling(path)
            ? snow_fail(context, SNOW_STATUS_BAD_INPUT,
                        "%s: cannot be %s: it is a link to a file that is not "
                        "there; get that file, or remove the link",
                        path, done)
            : snow_fail(context, SNOW_STATUS_BAD_INPUT,
                        "%s: cannot be %s: %s", path, done, why));
}

snow_status snow_look_at_given(snow_context *context, const char *path,
                               mode_t *mode) {
    struct stat about;
    if (stat(path, &about))
        return snow_lookup_fail(context, path, "opened");
    *mode = about.st_mode;
    return SNOW_STATUS_OK;
}

/* A link that leads nowhere is a name that is there. */
snow_status snow_look_for(snow_context *context, const char *path,
                          mode_t *mode) {
    struct stat about;
    *mode = 0;
    if (lstat(path, &about))
        return errno == ENOENT || errno == ENOTDIR
                   ? SNOW_STATUS_OK
                   : snow_lookup_fail(context, path, "opened");
    if (S_ISLNK(about.st_mode))
        return snow_look_at_given(context, path, mode);
    *mode = about.st_mode;
    return SNOW_STATUS_OK;
}
