/* snowglass/look_file.h - transfer functions from files, and into them.
 *
 *   snowglass   our own JSON: everything that snow_look has
 *   slicer-vp   3D Slicer's volume property (.vp)
 *   slicer-xml  presets of 3D Slicer: VolumeProperty elements of MRML
 *   paraview    ParaView's JSON: RGBPoints, Points, ColorSpace
 *   niivue      colour maps of niivue: R, G, B, A and I
 *   pal         palettes of Amrvis, 768 or 1024 bytes
 *   csv         value,red,green,blue,opacity or value,opacity, one a line
 *
 * What a file says is read by what it holds, not by its name; the name decides
 * where that leaves two readings.  Colours that a file joins in another colour
 * space are turned to points so close that straight lines between them are
 * nowhere off by more than 1/500.  What a file says and is not taken over is
 * told as a remark (snow_context_set_warning).
 *
 * These functions belong to libsnowglass-recipe, which has a JSON library. */
#ifndef SNOWGLASS_TF_H
#define SNOWGLASS_TF_H

#include <snowglass/transfer.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct snow_look_file snow_look_file;

/* The most points of a kind, and bytes of a file. */
#define SNOW_LOOK_POINTS_MAX 65536
#define SNOW_LOOK_BYTES_MAX (16 << 20)

/* Reads a file.  Of one with several transfer functions "FILE#NAME" names one
 * (letters of either case, dashes left out), and the first is taken where none
 * is named.  Errors: SNOW_STATUS_BAD_INPUT (no file, no transfer function, a
 * bad one: the message says where), SNOW_STATUS_NO_MEMORY.  Free with
 * snow_look_file_free. */
SNOW_API snow_status snow_look_load(snow_context *context, const char *path,
                                    snow_look_file **out);

/* The same of `size` bytes, which messages call `name`; `wanted` is the name of
 * one of several, or NULL. */
SNOW_API snow_status snow_look_parse(snow_context *context, const char *name,
                                     const void *bytes, size_t size,
                                     const char *wanted, snow_look_file **out);
SNOW_API void snow_look_file_free(snow_look_file *tf);

/* What it says; lives as long as it. */
SNOW_API const snow_look *snow_look_file_look(const snow_look_file *tf);

/* The name of its format, as above. */
SNOW_API const char *snow_look_file_format(const snow_look_file *tf);

/* Writes points as our JSON, which reads as the same points to the last bit, or
 * as CSV: one row for each value of either kind of points, which is as exact,
 * but has no gradient opacity, no logarithmic scale and no name.  Text goes to
 * `room` bytes, with a final zero byte, and *length says how many it has
 * without that: of a text that does not fit nothing but a zero byte is written,
 * and the call may be made again.  Errors: SNOW_STATUS_NO_MEMORY;
 * SNOW_STATUS_BAD_USAGE (CSV of points without colours or opacities). */
SNOW_API snow_status snow_look_write_json(snow_context *context,
                                          const snow_look *points, char *text,
                                          size_t room, size_t *length);
SNOW_API snow_status snow_look_write_csv(snow_context *context,
                                         const snow_look *points, char *text,
                                         size_t room, size_t *length);

#ifdef __cplusplus
}
#endif
#endif
