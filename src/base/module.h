/* base/module.h - parts of the library that are loaded when a file needs them.
 *
 * A module is a shared object of ours, libsnowglass-NAME.so, in the folder of
 * modules beside the library; module.c explains why and where. Files compiled
 * with SNOW_LOADS are the loading side: their readers only call the module. */
#ifndef SNOW_MODULE_H
#define SNOW_MODULE_H

#include "base/base.h"

#ifndef SNOW_LOADS
#define SNOW_LOADS 0
#endif

struct snow_format;
struct snow_image_format;
struct gdcm_frame;

/* The contents of a module; NULL for parts that it lacks. */
typedef struct snow_module {
    const char *stamp; /* of its build; always the first field */
    const struct snow_format *volume;
    const struct snow_image_format *picture;
    bool (*unpack)(struct gdcm_frame *frame, const void *packed, size_t size,
                   void *out,
                   size_t capacity); /* as formats/dicom/gdcm_bridge.h */
    snow_status (*expect_blosc)(snow_context *context, const char *name,
                                const unsigned char *packed, size_t size,
                                uint64_t bytes); /* as formats/zarr/zarr.h */
    snow_status (*unpack_blosc)(snow_context *context, const char *name,
                                const unsigned char *packed, unsigned char *out,
                                uint64_t bytes);
} snow_module;

/* The one symbol that a module exports: `SNOW_API const snow_module
 * SNOW_MODULE_SYMBOL = {...}`. */
#define SNOW_MODULE_SYMBOL snow_module_parts

/* The version, and a digest of the sources of both sides, which share internal
 * structures: these must come from one tree. */
extern const char snow_module_stamp[];

/* The module of a name ("hdf5"), which stays loaded until the process ends.
 * Thread-safe. Errors: SNOW_STATUS_BAD_INPUT, if it is missing, damaged, of
 * another build, writable by others than the program's owner, or lacks a
 * library. */
snow_status snow_module_load(snow_context *context, const char *name,
                             const snow_module **out);

/* Returns whether it exists, by its name alone: nothing is loaded. */
bool snow_module_is_there(const char *name);

#endif
