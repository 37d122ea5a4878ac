/* outputs.h - where outputs go, and the one file that the tool writes itself:
 * the figures of --stats. */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* Whether a path is standard output, a pipe or a device: what a rename may not
 * replace, and what may wait for its reader for ever. */
bool is_special(const char *path);

/* Whether two paths name one file, also one that is not there yet. */
bool same_place(const char *a, const char *b);

/* Whether --stats can go where it shall: asked before rendering.  Answers GO_ON
 * or an exit code. */
int check_stats_path(const char *path, bool overwrite);

/* Writes an object to a file, aside and renamed, or through to what is no
 * plain file; "-" is standard output.  Frees it.  Answers an exit code. */
int write_json(json_t *object, const char *path, bool overwrite);

/* The same of any text. */
int write_text(const char *bytes, size_t count, const char *path,
               bool overwrite);

/* Where the last part of a path begins. */
size_t folder_length(const char *path);

/* Gives a finished file its name, which lies in the same folder or at least the
 * same file system; an existing one is replaced only with `overwrite`.  Makes
 * file and name last through a power cut.  Answers 0 or an error number. */
int place_output(const char *aside, const char *path, bool overwrite);

/* The same of a file that is synced already, without waiting for the disk. */
int name_output(const char *aside, const char *path, bool overwrite);

#endif
