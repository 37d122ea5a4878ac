/* config.h - reads options from a file and writes them to one.  The files are
 * recipes (snowglass/recipe.h), which in situ rendering uses too. */
#ifndef CONFIG_H
#define CONFIG_H

#include "options/options.h"

/* Applies the options of the --config file, if one is given, except those that
 * stand on the command line.  Returns CONTINUE or an exit code. */
int config_take(options *out, const verb_row *verb);

/* Refuses a --save-config file that cannot be written, before rendering.
 * Returns CONTINUE or an exit code. */
int config_check(const options *opts);

/* Writes the --save-config file, if one is given.  Returns an exit code. */
int config_save(const options *opts);

#endif
