/* volume/optional.h - readers whose library is not linked here: another part of
 * the build has it, or none. */
#ifndef SNOW_VOLUME_OPTIONAL_H
#define SNOW_VOLUME_OPTIONAL_H

#include "base/module.h"
#include "volume/volume.h"

/* Fails with what is missing and the Debian package that has it. */
static inline snow_status snow_fail_unbuilt(snow_context *context,
                                            const char *what,
                                            const char *package) {
    return snow_fail(context, SNOW_BAD_INPUT,
                     "this build has no %s; install %s and build again", what,
                     package);
}

/* A snow_format.read that the module of that name does. */
static inline snow_status
snow_read_by_module(const char *module_name, snow_source *source,
                    const snow_volume_options *options, snow_volume_info *info,
                    snow_volume **out) {
    const snow_module *module;
    SNOW_TRY(
        snow_module_load(snow_source_context(source), module_name, &module));
    return module->volume->read(source, options, info, out);
}

#endif
