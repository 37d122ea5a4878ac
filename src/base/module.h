/* base/module.h - parts of the library that are loaded when a file needs them.
 *
 * A module is a shared object of ours, libsnowglass-NAME.so, in the folder of
 * modules beside the library; module.c tells why and where.  Files that are
 * compiled with SNOW_LOADS are the side that loads: of them, the readers are
 * but a face over the module. */
#ifndef SNOW_MODULE_H
#define SNOW_MODULE_H

#include "base/base.h"

#ifndef SNOW_LOADS
#define SNOW_LOADS 0
#endif

struct snow_format;
struct snow_image_format;
struct gdcm_frame;

/* What a module holds; NULL where it has no such part. */
typedef struct snow_module {
    const char *stamp; /* of its build; stays first, whatever comes behind it */
    const struct snow_format *volume;
    const struct snow_image_format *picture;
    bool (*unpack)(struct gdcm_frame *frame, const void *packed, size_t size,
                   void *out, size_t room); /* as volume/gdcm_bridge.h */
    snow_status (*expect_blosc)(snow_context *context, const char *name,
                                const unsigned char *packed, size_t size,
                                uint64_t bytes); /* as volume/zarr.h */
    snow_status (*unpack_blosc)(snow_context *context, const char *name,
                                const unsigned char *packed, unsigned char *out,
                                uint64_t bytes);
} snow_module;

/* The one name that a module shows: `SNOW_API const snow_module
 * SNOW_MODULE_SYMBOL = {...}`. */
#define SNOW_MODULE_SYMBOL snow_module_parts

/* The version, and a digest of the sources that both sides are made of: the
 * inner structures that they share are those of one tree only. */
extern const char snow_module_stamp[];

/* The module of a name ("hdf5"), which stays loaded until the process ends.
 * Any threads may ask at the same time.  Errors: SNOW_BAD_INPUT, when it is
 * missing, damaged, of another build, in the hands of others than the
 * program's owner, or lacks a library. */
snow_status snow_module_load(snow_context *context, const char *name,
                             const snow_module **out);

/* Whether it is there, by its name alone: nothing is loaded. */
bool snow_module_is_there(const char *name);

#endif
