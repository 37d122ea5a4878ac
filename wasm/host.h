/* host.h - what the page's worker does for the engine (worker.js). */
#ifndef WASM_HOST_H
#define WASM_HOST_H

#include <stdbool.h>
#include <stddef.h>

#define HOST(name) __attribute__((import_module("env"), import_name(#name)))

#define HOST_NONE (-1)
#define HOST_FOLDER (-2)
#define HOST_FAILED (-3)

/* The first number of files of a server, which each thread has for itself
 * (remote.js). */
#define HOST_FAR (1 << 20)

/* The number of a file of the page, HOST_FOLDER for a folder of them,
 * HOST_NONE, or HOST_FAILED: nobody knows. */
HOST(host_find) int host_find(const char *path);

HOST(host_size) double host_size(int file);

/* Copies bytes of a file; false: it has failed. */
HOST(host_read) bool host_read(int file, double at, void *bytes, size_t size);

/* The name of entry `index` of a folder, cut to `size` bytes with its NUL: 1; 0
 * past the last; below 0: it has failed. */
HOST(host_name)
int host_name(const char *folder, int index, char *out, size_t size);

/* Why the last of these has failed in this thread, and what to do. */
HOST(host_fault) void host_fault(char *out, size_t size);

#endif
