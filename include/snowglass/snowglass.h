/* snowglass/snowglass.h - volumes to pictures, in one process.
 *
 * Includes status, context, volume, transfer, view, render, image, overlay.
 * Not included: ranks and comm (many processors), insitu (running simulations),
 * mpi, look_file and recipe (files of looks and of whole renders, in
 * libsnowglass-recipe), extend (for libraries over this one).
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
 * For more than one picture: a volume (snow_volume_open), a transfer function
 * for it (snow_transfer_new_for_volume), a view (snow_view_default), a frame;
 * then pictures (snow_frame_render). Free all in any order, the context last.
 * Until version 1.0 each minor version may change interface and soname. */
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

/* Version of the linked library, "0.1.0"; instruction sets of this machine that
 * it knows, best last, separated by spaces, and the one that it uses. */
SNOW_API const char *snow_version(void);
SNOW_API const char *snow_isa_found(void);
SNOW_API const char *snow_isa_used(void);
SNOW_API int snow_processors(void); /* that this process may use */

#endif
