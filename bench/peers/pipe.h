/* bench/peers/pipe.h - what the workers in C share: commands in, answers out.
 *
 * Each command is a line on stdin, each answer a line on stdout; README.md
 * lists them.  A worker gives five functions and calls pipe_serve. */
#ifndef PEERS_PIPE_H
#define PEERS_PIPE_H

#include <stdio.h>

#define PIPE_VALUES 256 /* of 8-bit voxels, and so of every table */

/* A transfer function: red, green, blue, opacity of each value, 0 to 1. */
typedef double pipe_table[PIPE_VALUES][4];

typedef struct pipe_worker {
    const char *name; /* in messages */
    /* Reads the voxels; nothing is prepared yet. */
    void (*load)(void);
    /* Keeps a table for the next picture. */
    void (*take)(const pipe_table *table);
    /* Makes a picture; in it all that it needs and does not have yet. */
    void (*frame)(double azimuth, double elevation);
    /* Pixel (x, y) of the last picture over black, row 0 on top. */
    void (*pixel)(int x, int y, unsigned char rgb[3]);
    int size; /* pixels a side */
} pipe_worker;

/* Ends the process with a message. */
_Noreturn void pipe_fail(const pipe_worker *worker, const char *reason);

/* Serves until "quit" or the end of stdin. */
void pipe_serve(const pipe_worker *worker);

#endif
