/* default_name.h - the output of a picture that was not given one. */
#ifndef DEFAULT_NAME_H
#define DEFAULT_NAME_H

#include "options/options.h"

/* Names the picture after its input, NAME.png in the working folder, if no
 * output is given, and refuses to replace a file under that name.  Returns
 * CONTINUE or an exit code. */
int default_name(options *opts);

#endif
