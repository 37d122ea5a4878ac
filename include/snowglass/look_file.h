/* snowglass/look_file.h - looks from files, and into them: snowglass (our
 * JSON), slicer-vp, slicer-xml, paraview, niivue, pal, csv (docs/looks.md).
 *
 * The content decides what a file is, and its name where that leaves two
 * readings. Content that is ignored is a warning. In libsnowglass-recipe. */
#ifndef SNOWGLASS_LOOK_FILE_H
#define SNOWGLASS_LOOK_FILE_H

#include <snowglass/transfer.h>

typedef struct snow_look_file snow_look_file;

/* The most points of a kind, and bytes of a file. */
#define SNOW_LOOK_POINTS_MAX 65536
#define SNOW_LOOK_BYTES_MAX (16 << 20)

/* Reads a file. "FILE#NAME" names one of several looks, else the first is
 * taken. Errors: BAD_INPUT (no file, no look, a bad one; the message says
 * where). */
SNOW_API snow_status snow_look_load(
    snow_context *context, const char *path, snow_look_file **out);

/* Reads the bytes of a file, which messages call `name`. `wanted` names one of
 * several looks, or is NULL. Errors: as above. */
SNOW_API snow_status snow_look_parse(snow_context *context, const char *name,
    const void *bytes, size_t size, const char *wanted, snow_look_file **out);
SNOW_API void snow_look_file_free(snow_look_file *file);

/* Returns the look, for snow_look.base; it is the file's. */
SNOW_API const snow_look *snow_look_file_look(const snow_look_file *file);

/* Returns the name of the file's format. */
SNOW_API const char *snow_look_file_format(const snow_look_file *file);

/* Writes a look's points as our JSON, exact to the last bit, with a zero at the
 * end. *length is that of the text. A text that does not fit in `room` bytes is
 * "": call again with *length + 1. */
SNOW_API snow_status snow_look_write_json(snow_context *context,
    const snow_look *look, char *text, size_t room, size_t *length);

/* The same as CSV, without gradient opacity, logarithm and name. Errors:
 * BAD_USAGE (a look without colours or opacities). */
SNOW_API snow_status snow_look_write_csv(snow_context *context,
    const snow_look *look, char *text, size_t room, size_t *length);

#endif
