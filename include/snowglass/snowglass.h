/* snowglass/snowglass.h - volumes to pictures, in one process.
 *
 * Not included: ranks and comm (many processors), channels (mixed), insitu
 * (simulations), mpi, extend, look_file and recipe (in libsnowglass-recipe).
 *
 *   snow_context *context = NULL;
 *   snow_image *image = NULL;
 *   snow_status status = snow_context_new(NULL, &context);
 *   if (!status)
 *       status = snow_render_file(context, "phantom:head", NULL, NULL, &image);
 *   if (!status)
 *       status = snow_image_save(image, argc > 1 ? argv[1] : "head.png", NULL);
 *   if (status)
 *       fprintf(stderr, "%s\n", snow_context_message(context));
 *   snow_image_free(image);
 *   snow_context_free(context);
 *
 * In loops: snow_volume_open, snow_transfer_new_for_volume, snow_view_fit, a
 * frame and snow_frame_render_bytes, whose bytes a window shows, or
 * snow_frame_render. Until 1.0 each minor version may change the interface. */
#ifndef SNOWGLASS_SNOWGLASS_H
#define SNOWGLASS_SNOWGLASS_H

#include <snowglass/overlay.h>
#include <snowglass/render.h>

/* Version of these headers, for #if; snow_version: of the library, "0.1.0".
 * Instruction sets that this machine has, best last, and the one in use. */
#define SNOWGLASS_VERSION_MAJOR 0
#define SNOWGLASS_VERSION_MINOR 1
#define SNOWGLASS_VERSION_PATCH 0
SNOW_API const char *snow_version(void);
SNOW_API const char *snow_isa_found(void);
SNOW_API const char *snow_isa_used(void);
SNOW_API int snow_processors(void); /* that this process may use */

#endif
