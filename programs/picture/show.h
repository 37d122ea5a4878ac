/* show.h - shows a picture in the terminal. */
#ifndef SHOW_H
#define SHOW_H

#include "options/options.h"

/* Refuses --show where standard output is no terminal.  Returns CONTINUE or an
 * exit code. */
int show_check(const options *opts);

/* Draws the picture, on its background, at the cursor of the terminal.  Returns
 * CONTINUE or an exit code. */
int show_picture(const snow_image *image, const snow_image_options *form);

#endif
