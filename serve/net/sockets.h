/* sockets.h - the sockets on which the viewer listens, and its URL. */
#ifndef SOCKETS_H
#define SOCKETS_H

#include "net/guard.h"
#include "options/options.h"

typedef struct sockets {
    int fds[2];
    int count;
    int port;         /* 0 for a Unix socket */
    char host[300];   /* of the URL: "127.0.0.1:8000" */
    const char *path; /* of the Unix socket, removed in the end; or NULL */
} sockets;

/* Opens what the options say, and allows its names.  Returns CONTINUE or an
 * exit code. */
int sockets_open(const options *opts, guard *g, sockets *out);
void sockets_close(sockets *s);

/* Takes the secret from the options' file, or makes one.  Returns CONTINUE or
 * an exit code. */
int secret_make(const options *opts, guard *g);

#endif
