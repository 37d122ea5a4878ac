/* formats/features.h - readers whose library is not linked: a module has it, or
 * the build lacks it. */
#ifndef SNOW_FORMATS_FEATURES_H
#define SNOW_FORMATS_FEATURES_H

#include "base/module.h"
#include "formats/format.h"

/* Fails with the missing library and its Debian package. */
static inline snow_status snow_fail_unbuilt(snow_context *context,
                                            const char *what,
                                            const char *package) {
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "this build lacks %s; install %s and build again", what,
                     package);
}

/* A snow_format.read that calls the module of that name. */
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
