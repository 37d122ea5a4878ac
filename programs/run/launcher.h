/* launcher.h - what a launcher of parallel jobs says of this process in its
 * environment, whether or not it uses MPI. */
#ifndef LAUNCHER_H
#define LAUNCHER_H

/* How many processes were started together, this one included; 1 if no launcher
 * says so.  `name` becomes the launcher, `rank` the number of this process. */
long launcher_ranks(const char **name, long *rank);

/* The number of this process by the first launcher that gives one above 0. */
long launcher_rank(void);

#endif
