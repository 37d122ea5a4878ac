/* sibling.h - programs that are installed beside this one. */
#ifndef SIBLING_H
#define SIBLING_H

#include <limits.h>
#include <stdbool.h>

/* The path of a program beside this one; false where that is not known, or
 * nothing is there to be run. */
bool sibling_find(const char *name, char path[PATH_MAX]);

/* Becomes the program of that name: the one in the folder of this program, else
 * one of PATH.  argv[0] is replaced.  Comes back only with an exit code, and
 * has said why then. */
int sibling_become(const char *name, char **argv);

/* Runs it as a process of its own, waits for its end, and answers its exit
 * code. */
int sibling_run(const char *name, char **argv);

#endif
