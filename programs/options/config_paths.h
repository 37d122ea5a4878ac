/* config_paths.h - the paths in a configuration, which are relative to the
 * folder of its file. */
#ifndef CONFIG_PATHS_H
#define CONFIG_PATHS_H

#include <jansson.h>

/* Makes the paths of a tree that was read from `config` relative to the working
 * folder, and those of a tree that will be written there relative to its
 * folder. */
void config_paths_read(json_t *tree, const char *config);
void config_paths_write(json_t *tree, const char *config);

#endif
