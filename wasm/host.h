/* host.h - what the page's worker does for the engine (worker.js). */
#ifndef WASM_HOST_H
#define WASM_HOST_H

#include <stdbool.h>
#include <stddef.h>

#define HOST(name) __attribute__((import_module("env"), import_name(#name)))

#define HOST_NONE (-1)
#define HOST_FOLDER (-2)

/* The number of a file of the page, HOST_FOLDER for a folder of them, or
 * HOST_NONE. */
HOST(host_find) int host_find(const char *path);

HOST(host_size) double host_size(int file);

/* Copies bytes of a file; false where the browser cannot read it any more. */
HOST(host_read) bool host_read(int file, double at, void *bytes, size_t size);

/* The name of entry `index` of a folder, cut to `size` bytes with its NUL;
 * false past the last. */
HOST(host_name)
bool host_name(const char *folder, int index, char *out, size_t size);

#endif
