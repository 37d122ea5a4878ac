/* config.h - reads options from a file and writes them to one.  The files are
 * recipes (snowglass/recipe.h), which in situ rendering uses too.  Paths in
 * them are relative to the folder of the file. */
#ifndef CONFIG_H
#define CONFIG_H

#include "options/options.h"

#include <jansson.h>

/* Applies the options of the --config file, if one is given, except those that
 * stand on the command line.  Returns CONTINUE or an exit code. */
int config_take(options *out, const verb_row *verb);

/* Applies the keys of a recipe's tree in the same way. */
int config_take_tree(options *out, const verb_row *verb, const json_t *tree);

/* The verb for words without one: that of the --config file among them, or
 * render. */
const verb_row *config_verb(int argc, char **argv);

/* The value of a key as it stands on the command line, among the texts of the
 * options; NULL if there is no more room. */
char *config_text(options *out, const char *key, const json_t *value);

/* A number with as few digits as bring it back. */
void config_real(double value, char text[40]);

/* Refuses a --save-config file that cannot be written, before rendering.
 * Returns CONTINUE or an exit code. */
int config_check(const options *opts);

/* Notes what a picture was made with, for config_save.  `painted` is the range
 * of values that a picture of means or sums was painted over; both 0: none. */
void config_note(const options *opts, const snow_transfer *transfer,
                 snow_shade shade, const char *view, const double painted[2]);

/* The same of channels; `view` NULL: of a slice. */
void config_note_channels(const options *opts, const channel_list *list,
                          snow_shade shade, const char *view);

/* The same for a slice across an axis, or for several (-1), or across all three
 * (NULL); `transfer` NULL: no colours. */
void config_note_slice(const options *opts, const snow_transfer *transfer,
                       const char *axis, int64_t index);

/* Sets what was noted in the tree of a recipe, and forgets it. */
void config_set_noted(json_t *tree);

/* The options as the tree of a recipe, a new reference; NULL: no memory. */
json_t *config_tree(const options *opts, const verb_row *verb);

/* The command that makes the same picture: options of a tree that differ from
 * their defaults. The caller frees it; NULL: no memory. */
char *config_command(const options *opts, const verb_row *verb,
                     const json_t *tree);

/* Writes the --save-config file, if one is given, and prints the command with
 * -v.  Returns an exit code. */
int config_save(const options *opts, const verb_row *verb);

#endif
