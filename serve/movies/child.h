/* child.h - the tool as a program of its own, which gives way to all others: so
 * pictures of the viewer go on, and one algorithm makes all movies. */
#ifndef MOVIES_CHILD_H
#define MOVIES_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#define CHILD_LINE_BYTES 512

typedef struct child {
    pid_t process;               /* 0: none; and of its group */
    int messages;                /* the end of a pipe; -1: none */
    char text[CHILD_LINE_BYTES]; /* a line that is not whole yet */
    size_t used;
} child;

/* The largest file that it may write. */
#define CHILD_FILE_BYTES (INT64_C(2) << 30)

/* The words of a command as config_command prints it, with another output, and
 * asked to say how far it is: one allocation, which the caller frees, and which
 * points to `output`; NULL: no memory. */
char **child_words(const char *command, const char *output);

/* Starts the tool beside this program, or that of the PATH, in a group of its
 * own.  It ends when the thread that starts it does.  Returns 0 or an error
 * number. */
int child_start(char **words, child *out);

/* Waits for at most so many seconds for a line of what it says; false: none
 * came. */
bool child_read(child *c, double seconds, char line[CHILD_LINE_BYTES]);

/* Asks it to end, or ends it. */
void child_stop(const child *c, bool at_once);

/* Whether it has ended: its exit code, or 128 and a signal. */
bool child_ended(child *c, int *code);
void child_close(child *c);

#endif
