/* config.h - options from a file and into one: recipes (snowglass/recipe.h),
 * which simulations take for their pictures too. */
#ifndef CONFIG_H
#define CONFIG_H

#include "options.h"

/* Takes the options of --config, if that is there, but for those that stand on
 * the command line.  Answers GO_ON or an exit code. */
int config_take(options *out, const verb_row *verb);

/* Refuses a place that --save-config cannot write: asked before rendering.
 * Answers GO_ON or an exit code. */
int config_check(const options *asked);

/* Writes what --save-config asks for, if that is there.  Answers an exit code.
 */
int config_save(const options *asked);

#endif
