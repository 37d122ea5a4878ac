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

/* Defines a snow_format.read that does so. */
#define SNOW_READ_UNBUILT(function, what, package)                            \
    static snow_status function(snow_source *source,                          \
                                const snow_volume_options *options,           \
                                snow_volume_info *info, snow_volume **out) {  \
        (void)options, (void)info, (void)out;                                 \
        return snow_fail_unbuilt(snow_source_context(source), what, package); \
    }

/* One that calls the module of a name. */
#define SNOW_READ_BY_MODULE(function, name)                                  \
    static snow_status function(snow_source *source,                         \
                                const snow_volume_options *options,          \
                                snow_volume_info *info, snow_volume **out) { \
        const snow_module *module;                                           \
        SNOW_TRY(                                                            \
            snow_module_load(snow_source_context(source), name, &module));   \
        return module->volume->read(source, options, info, out);             \
    }

#endif
