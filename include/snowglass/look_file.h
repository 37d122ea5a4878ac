/* snowglass/look_file.h - looks from files, and into them: snowglass (our
 * JSON), slicer-vp, slicer-xml, paraview, niivue, pal, csv (docs/looks.md). The
 * content decides what a file is, and its name where that leaves two readings.
 * Content that is ignored is a warning. In libsnowglass-recipe. */
#ifndef SNOWGLASS_LOOK_FILE_H
#define SNOWGLASS_LOOK_FILE_H

#include <snowglass/transfer.h>

typedef struct snow_look_file snow_look_file;
/* The most points of a kind, and bytes of a file. */
#define SNOW_LOOK_POINTS_MAX 65536
#define SNOW_LOOK_BYTES_MAX (16 << 20)
/* "FILE#NAME" names one of several looks (else the first is taken). Errors:
 * BAD_INPUT (no file, no look, a bad one: the message says where). */
SNOW_API snow_status snow_look_load(
    snow_context *context, const char *path, snow_look_file **out);
/* Of bytes, which messages call `name`; `wanted` is one of several, or NULL. */
SNOW_API snow_status snow_look_parse(snow_context *context, const char *name,
    const void *bytes, size_t size, const char *wanted, snow_look_file **out);
SNOW_API void snow_look_file_free(snow_look_file *file);
/* Its look, for snow_look.base, and the name of its format. */
SNOW_API const snow_look *snow_look_file_look(const snow_look_file *file);
SNOW_API const char *snow_look_file_format(const snow_look_file *file);
/* Writes a look's points as our JSON, exact to the last bit, or as CSV (without
 * gradient opacity, logarithm, name), zero-terminated. *length is the text's; a
 * text that does not fit in `room` is "": call again with *length + 1. Errors:
 * BAD_USAGE (CSV without colours or opacities). */
SNOW_API snow_status snow_look_write_json(snow_context *context,
    const snow_look *look, char *text, size_t room, size_t *length);
SNOW_API snow_status snow_look_write_csv(snow_context *context,
    const snow_look *look, char *text, size_t room, size_t *length);

#endif
