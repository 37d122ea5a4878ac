/* snowglass/snowglass.h - everything.
 *
 * Order of use: a context; a volume (snow_volume_open); a transfer function
 * for it (snow_transfer_new_for_volume); a view (snow_view_default); a frame;
 * pictures (snow_frame_render, snow_image_save); then free all in any order,
 * the context last.
 *
 * Until version 1.0 the interface may change with each minor version, and with
 * it the name of the shared library (libsnowglass.so.0.1). */
#ifndef SNOWGLASS_SNOWGLASS_H
#define SNOWGLASS_SNOWGLASS_H

#include <snowglass/context.h>
#include <snowglass/image.h>
#include <snowglass/overlay.h>
#include <snowglass/render.h>
#include <snowglass/status.h>
#include <snowglass/transfer.h>
#include <snowglass/view.h>
#include <snowglass/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* "0.1.0": the version of the library that is linked; a constant string. */
SNOW_API const char *snow_version(void);

/* Instruction sets of this machine that Snowglass knows of, separated by
 * spaces and best last, and the one that its kernels use: constant strings. */
SNOW_API const char *snow_isa_found(void);
SNOW_API const char *snow_isa_used(void);

/* Processors that this process may use: its affinity, and the quota of its
 * control group rounded up.  At least 1. */
SNOW_API int snow_processors(void);

#ifdef __cplusplus
}
#endif
#endif
