/* snowglass/snowglass.h - volumes to pictures, in one process.
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
 * For many pictures of one volume: open it (snow_volume_open), make its
 * transfer function (snow_transfer_new_for_volume), place the camera
 * (snow_view_default, snow_view_fit), make one frame (snow_frame_new), and call
 * snow_frame_render_bytes, whose bytes a window shows, in a loop.
 *
 * This header includes status.h, context.h, image.h, volume.h, view.h,
 * transfer.h, render.h and overlay.h. Others are included by name: comm.h and
 * ranks.h (one picture by many processors), mpi.h, insitu.h (pictures of a
 * running simulation), channels.h, extend.h, and, in the library
 * libsnowglass-recipe, look_file.h and recipe.h.
 *
 * Words of these headers. "The paper" is Chih-Hsien Huang, Jen-Shiuh Liu and
 * Don-Lin Yang, "Efficient Parallel Splatting Algorithm", Feng Chia University;
 * its figures and sections are named by number. docs/NAME.md is a page of the
 * documentation, which is installed beside the examples (share/doc). A look
 * describes a transfer function before the volume is known: preset, colour map,
 * range. An interesting voxel is one that is not transparent: its opacity is
 * above the threshold. A sheet is the contribution of one slice, which is
 * composited with the others. A strip is the part of the picture at the right
 * that is left free for a legend.
 *
 * Until version 1.0 each minor version may change the interface. Within a minor
 * version records grow only as context.h says. */
#ifndef SNOWGLASS_SNOWGLASS_H
#define SNOWGLASS_SNOWGLASS_H

#include <snowglass/overlay.h>
#include <snowglass/render.h>

/* The version of these headers, and one number of it that rises with each: that
 * of 1.2.3 is 1002003. "#if SNOWGLASS_VERSION_NUMBER >= 2000" asks for 0.2.0.
 */
#define SNOWGLASS_VERSION_MAJOR 0
#define SNOWGLASS_VERSION_MINOR 1
#define SNOWGLASS_VERSION_PATCH 0
#define SNOWGLASS_VERSION_NUMBER                                          \
    (SNOWGLASS_VERSION_MAJOR * 1000000 + SNOWGLASS_VERSION_MINOR * 1000 + \
        SNOWGLASS_VERSION_PATCH)

/* Returns the version of the library that is linked, such as "0.1.0". */
SNOW_API const char *snow_version(void);

/* Returns the instruction sets that this machine has and the library uses,
 * separated by spaces, the best one last. */
SNOW_API const char *snow_isa_found(void);

/* Returns the instruction set that pictures use by default. */
SNOW_API const char *snow_isa_used(void);

/* Returns how many processors this process may use. */
SNOW_API int snow_processors(void);

#endif
