/* default_name.h - the output of a picture that was not given one. */
#ifndef DEFAULT_NAME_H
#define DEFAULT_NAME_H

#include "options/options.h"

#define STEM_BYTES 256 /* of the name of a file */

/* Names the picture after its input, NAME.png in the working folder, if no
 * output is given, and refuses to replace a file under that name.  Returns
 * CONTINUE or an exit code. */
int default_name(options *opts);

/* "head" for scans/head.nii.gz, head.h5:/a/b, phantom:head, and a folder of
 * that name. */
void default_stem(const char *path, char out[STEM_BYTES]);

#endif
