/* volume/optional.h - what readers say whose library the build lacks. */
#ifndef SNOW_VOLUME_OPTIONAL_H
#define SNOW_VOLUME_OPTIONAL_H

#include "volume/volume.h"

/* Fails with what is missing and the Debian package that has it. */
static inline snow_status snow_fail_unbuilt(snow_context *context,
                                            const char *what,
                                            const char *package) {
    return snow_fail(context, SNOW_BAD_INPUT,
                     "this build has no %s; install %s and build again", what,
                     package);
}

#endif
