/* recipe_file.h - the recipe that pages begin with; that of the picture at
 * rest, as a file for --config. */
#ifndef RECIPE_FILE_H
#define RECIPE_FILE_H

#include "draw/drawing.h"

/* With what only the command line can set.  Its paths are relative to the
 * volume's folder, as the file is meant to lie beside the volume; a path that
 * begins with / and leads elsewhere stays.  NULL: no memory. */
json_t *recipe_file_tree(const drawing *d);

/* The state that pages begin with; NULL: no memory. */
json_t *recipe_first(const options *opts);

/* What it has of the look alone: colours, opacity, range, shading.  It may be
 * given to any volume. */
json_t *look_file_tree(const drawing *d);

#endif
